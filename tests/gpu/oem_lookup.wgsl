// Look-ups in mip-mapped octahedral maps with a safety border: crates/core/src/sphere/oem_lookup.rs and
// crates/core/src/files/image/oem_mips.rs. Engelhardt and Dachsbacher 2008, section 4.2. After
// common/octahedral.wgsl.
//
// Maps are texture arrays: one layer in the quadratic layout, one per hemisphere in the rectangular layout.
// A fragment shader has the directions of its neighbours as direction + dpdx(direction) and direction +
// dpdy(direction).

// Texture coordinates in [0, 1]^2 of `direction` in the quadratic layout: the paper's listing, with the axes
// and the signs at 0 corrected.
fn quadratic_coordinates(direction: vec3<f32>) -> vec2<f32> {
    return oct_from_direction(direction) * 0.5 + 0.5;
}

// Equation 4: the level of a cell with these corners in texels of level 0.
fn level_of_corners(own: vec2<f32>, right: vec2<f32>, below: vec2<f32>) -> f32 {
    let dx = right - own;
    let dy = below - own;
    return 0.5 * log2(max(dot(dx, dx), dot(dy, dy)));
}

// Equation 4 for a cell of directions in the quadratic layout, as it is.
fn level_of_cell(own: vec3<f32>, right: vec3<f32>, below: vec3<f32>, inner: f32) -> f32 {
    return level_of_corners(
        quadratic_coordinates(own) * inner, quadratic_coordinates(right) * inner,
        quadratic_coordinates(below) * inner);
}

// The smaller of the levels of the cell and of its reflection at y = 0, of which one is contiguous.
fn quadratic_level(own: vec3<f32>, right: vec3<f32>, below: vec3<f32>, inner: f32) -> f32 {
    let mirror = vec3<f32>(1.0, -1.0, 1.0);
    return min(
        level_of_cell(own, right, below, inner),
        level_of_cell(own * mirror, right * mirror, below * mirror, inner));
}

// Coordinates in [-1, 1]^2 and layer of `direction` in the rectangular layout: equation 3 without its shift.
fn rectangular_place(direction: vec3<f32>) -> vec3<f32> {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    if p.y >= 0.0 {
        return vec3<f32>(p.x - p.z, p.x + p.z, 0.0);
    }
    return vec3<f32>(p.z - p.x, p.x + p.z, 1.0);
}

fn nearer(to: vec2<f32>, a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    return select(b, a, dot(a - to, a - to) <= dot(b - to, b - to));
}

// The coordinates of `direction` that continue the layer of `own`, nearest to `own`.
fn rectangular_corner(own: vec3<f32>, direction: vec3<f32>) -> vec2<f32> {
    let at = rectangular_place(direction);
    if at.z == own.z {
        return at.xy;
    }
    let shifted = nearer(own.xy, at.xy + vec2<f32>(2.0, 0.0), at.xy - vec2<f32>(2.0, 0.0));
    let turned = nearer(own.xy, vec2<f32>(-at.x, 2.0 - at.y), vec2<f32>(-at.x, -2.0 - at.y));
    return nearer(own.xy, shifted, turned);
}

fn rectangular_level(own: vec3<f32>, right: vec3<f32>, below: vec3<f32>, inner: f32) -> f32 {
    let place = rectangular_place(own);
    let half = inner / 2.0;
    return level_of_corners(
        place.xy * half, rectangular_corner(place, right) * half, rectangular_corner(place, below) * half);
}

// Bilinear look-up at `place`, in texels of level 0 from the corner of the bordered texture; clamped.
fn oem_bilinear(map: texture_2d_array<f32>, layer: i32, place: vec2<f32>, level: i32) -> vec3<f32> {
    let last = vec2<i32>(textureDimensions(map, level)) - 1;
    let at = place / f32(1u << u32(level)) - 0.5;
    let share = at - floor(at);
    let low = vec2<i32>(floor(at));
    let a = clamp(low, vec2<i32>(0), last);
    let b = clamp(low + 1, vec2<i32>(0), last);
    let above = mix(
        textureLoad(map, a, layer, level).rgb, textureLoad(map, vec2<i32>(b.x, a.y), layer, level).rgb,
        share.x);
    let under = mix(
        textureLoad(map, vec2<i32>(a.x, b.y), layer, level).rgb, textureLoad(map, b, layer, level).rgb,
        share.x);
    return mix(above, under, share.y);
}

// Trilinear look-up at the coordinates `uv` in [-1, 1]^2 of `layer`. The caller clamps `level` to the
// greatest one that the border serves.
fn oem_trilinear(
    map: texture_2d_array<f32>, layer: i32, uv: vec2<f32>, inner: f32, border: f32, level: f32,
) -> vec3<f32> {
    let most = f32(textureNumLevels(map) - 1u);
    let kept = clamp(level, 0.0, most);
    let place = (uv + 1.0) * (inner / 2.0) + border;
    let fine = i32(floor(kept));
    let near = oem_bilinear(map, layer, place, fine);
    let far = oem_bilinear(map, layer, place, min(fine + 1, i32(most)));
    return mix(near, far, kept - floor(kept));
}
