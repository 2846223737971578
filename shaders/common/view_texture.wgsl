// Textures of moving scenes: crates/view/src/scene/texture.rs. Images of all sizes lie in one buffer. They
// are filtered by hand, so that texels are at the same positions with every driver. The including file
// declares scene_texels: array<u32> (storage), four bytes in sRGB each.

// Address modes along u; those along v are in the next two bits. 0 repeats the image.
const MIRROR = 1u;
const CLAMP = 2u;
// Magnified without interpolation.
const NEAREST = 16u;

struct SceneTexture {
    // Place of the finest level, after which come the others, each of half the sides.
    first: u32,
    // 0 for no texture.
    width: u32,
    height: u32,
    modes: u32,
}

// The coordinate within the image.
fn address(x: f32, mode: u32) -> f32 {
    let mirrored = 1.0 - abs(x - 2.0 * floor(0.5 * x) - 1.0);
    let repeated = select(x - floor(x), mirrored, mode == MIRROR);
    return select(repeated, clamp(x, 0.0, 1.0), mode == CLAMP);
}

// The index of a texel of the image or next to its sides.
fn address_texel(at: i32, side: i32, mode: u32) -> u32 {
    let repeated = select(select(at, at + side, at < 0), at - side, at >= side);
    return u32(select(repeated, clamp(at, 0, side - 1), mode != 0u));
}

fn linear_texel(index: u32) -> vec3<f32> {
    let x = unpack4x8unorm(scene_texels[index]).rgb;
    return select(pow((x + 0.055) / 1.055, vec3<f32>(2.4)), x / 12.92, x <= vec3<f32>(0.04045));
}

// The colour at a level, bilinear unless `is_nearest`.
fn texture_at_level(shown: SceneTexture, uv: vec2<f32>, level: u32, is_nearest: bool) -> vec3<f32> {
    var first = shown.first;
    var side = vec2<u32>(shown.width, shown.height);
    for (var k = 0u; k < level; k++) {
        first += side.x * side.y;
        side = max(side / 2u, vec2<u32>(1u));
    }
    let modes = (vec2<u32>(shown.modes) >> vec2<u32>(0u, 2u)) & vec2<u32>(3u);
    let unit = vec2<f32>(address(uv.x, modes.x), address(uv.y, modes.y));
    let at = unit * vec2<f32>(side) - select(0.5, 0.0, is_nearest);
    let share = select(at - floor(at), vec2<f32>(), is_nearest);
    let low = vec2<i32>(floor(at));
    let sides = vec2<i32>(side);
    let left = address_texel(low.x, sides.x, modes.x);
    let right = address_texel(low.x + 1, sides.x, modes.x);
    let top = first + side.x * address_texel(low.y, sides.y, modes.y);
    let bottom = first + side.x * address_texel(low.y + 1, sides.y, modes.y);
    let upper = mix(linear_texel(top + left), linear_texel(top + right), share.x);
    let lower = mix(linear_texel(bottom + left), linear_texel(bottom + right), share.x);
    return mix(upper, lower, share.y);
}

// The linear colour at `uv` for a distance of `spread` texels to the next sample; white without a texture.
fn texture_colour(shown: SceneTexture, uv: vec2<f32>, spread: f32) -> vec3<f32> {
    if shown.width == 0u {
        return vec3<f32>(1.0);
    }
    let last = firstLeadingBit(max(shown.width, shown.height));
    let level = min(log2(max(spread, 1.0)), f32(last));
    let fine = u32(level);
    let is_nearest = spread <= 1.0 && (shown.modes & NEAREST) != 0u;
    let colour = texture_at_level(shown, uv, fine, is_nearest);
    let share = level - f32(fine);
    if share == 0.0 {
        return colour;
    }
    return mix(colour, texture_at_level(shown, uv, fine + 1u, false), share);
}

// The colour at a pixel where `uv` changes by `across` and `down` to the next ones.
fn texture_of_pixel(shown: SceneTexture, uv: vec2<f32>, across: vec2<f32>, down: vec2<f32>) -> vec3<f32> {
    let sides = vec2<f32>(f32(shown.width), f32(shown.height));
    return texture_colour(shown, uv, max(length(across * sides), length(down * sides)));
}

// The colour at a corner whose neighbours are as far as `spread` along u or v.
fn texture_of_corner(shown: SceneTexture, uv: vec2<f32>, spread: f32) -> vec3<f32> {
    return texture_colour(shown, uv, spread * f32(max(shown.width, shown.height)));
}
