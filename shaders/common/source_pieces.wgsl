// Pieces of the source's texels as leaves of adaptive quadrature. crates/core/src/cpu/subtexel.rs derives the
// rule. Reads `lobe`, `angles`, `source` and the packet of adaptive.wgsl.

const PANORAMA = 1u;
const CUBE = 2u;

// A direction, and the solid angle of a unit of area in texels around it.
struct Direction {
    towards: vec3<f32>,
    density: f32,
}

fn projected(point: vec3<f32>, area: f32) -> Direction {
    let per_length = inverseSqrt(dot(point, point));
    return Direction(point * per_length, area * per_length * per_length * per_length);
}

// Sine and cosine of up to a tenth.
fn small_angle(angle: f32) -> vec2<f32> {
    let squared = angle * angle;
    return vec2<f32>(
        angle * (1.0 - squared / 6.0 * (1.0 - squared / 20.0)),
        1.0 - squared / 2.0 * (1.0 - squared / 12.0),
    );
}

// Cosine and sine of the angle whose cosine and sine are `base`, plus `angle`.
fn turned(base: vec2<f32>, angle: f32) -> vec2<f32> {
    let small = small_angle(angle);
    return vec2<f32>(base.x * small.y - base.y * small.x, base.y * small.y + base.x * small.x);
}

fn point_of_cube(face: u32, st: vec2<f32>) -> vec3<f32> {
    switch face {
        case 0u: { return vec3<f32>(1.0, -st.y, -st.x); }
        case 1u: { return vec3<f32>(-1.0, -st.y, st.x); }
        case 2u: { return vec3<f32>(st.x, 1.0, st.y); }
        case 3u: { return vec3<f32>(st.x, -1.0, -st.y); }
        case 4u: { return vec3<f32>(st.x, -st.y, 1.0); }
        default: { return vec3<f32>(-st.x, -st.y, -1.0); }
    }
}

// The place `at`, in texels from the corner of the texel in the grid's column and row `texel` of `image`.
// `lower` selects the side of the fold for points on it.
fn source_direction(texel: vec2<f32>, image: u32, at: vec2<f32>, lower: bool) -> Direction {
    let sides = vec2<f32>(f32(lobe.columns), f32(lobe.rows));
    if lobe.source == PANORAMA {
        let step = vec2<f32>(6.2831853, 3.14159265) / sides;
        let off = (at - 0.5) * step;
        let column = turned(angles[u32(texel.x)], off.x);
        let row = turned(angles[lobe.columns + u32(texel.y)], off.y);
        let sine = max(row.y, 0.0);
        return Direction(vec3<f32>(sine * column.x, row.x, sine * column.y), sine * step.x * step.y);
    }
    let half = 0.5 * sides;
    let from_axis = (texel - half) + at;
    if lobe.source == CUBE {
        let st = from_axis / half;
        return projected(point_of_cube(image, st), 1.0 / (half.x * half.y));
    }
    // No texel crosses an axis.
    let signs = select(vec2<f32>(-1.0), vec2<f32>(1.0), texel >= half);
    let ab = from_axis * signs;
    let up = half.x - ab.x - ab.y;
    let xz = select(ab, half - ab.yx, lower);
    return projected(vec3<f32>(signs.x * xz.x, up, signs.y * xz.y) / half.x, 1.0 / (half.x * half.y));
}

// Gauss and Legendre's node `k` of three on [0, 1], and its weight.
fn gauss(k: u32) -> vec2<f32> {
    return vec2<f32>(0.5 + 0.3872983346 * (f32(k) - 1.0), select(0.2777777778, 0.4444444444, k == 1u));
}

// Piece (ix, iy) of the 2^depth x 2^depth of the texel in `column` of `row`, counted through all images.
fn visit_source(column: u32, row: u32, depth: u32, ix: u32, iy: u32) -> Visit {
    var visit: Visit;
    let image = row / lobe.rows;
    let own_row = row % lobe.rows;
    let texel = vec2<u32>(column >> lobe.shift_x, own_row >> lobe.shift_y);
    let above = max(textureLoad(source, texel, image, 0).rgb - least[0].rgb, vec3<f32>());
    if dot(above, LUMINANCE) <= 0.0 {
        return visit;
    }
    let side = 1.0 / f32(1u << depth);
    let low = vec2<f32>(f32(ix), f32(iy)) * side;
    let place = vec2<f32>(f32(column), f32(own_row));

    // On the fold diagonal of an octahedral square a piece is two triangles.
    var corner = low;
    var along = vec2<f32>(side);
    var triangles = false;
    var below = false;
    if lobe.source > CUBE {
        let half = f32(lobe.rows / 2u);
        let outwards = place >= vec2<f32>(half);
        let first = select(half - place - low - side, place - half + low, outwards);
        let sum = first.x + first.y;
        triangles = sum < half && sum + 2.0 * side > half;
        below = sum >= half;
        // The corner nearest to the axes.
        corner = select(low + side, low, outwards);
        along = select(vec2<f32>(-side), vec2<f32>(side), outwards);
    }
    var nodes: array<vec3<f32>, 18>;
    var weights: array<f32, 18>;
    var centroid = vec3<f32>();
    var total = 0.0;
    let count = select(9u, 18u, triangles);
    for (var n = 0u; n < count; n++) {
        let u = gauss(n % 3u);
        let v = gauss(n / 3u % 3u);
        var weight = u.y * v.y * side * side;
        var at = corner + along * vec2<f32>(u.x, v.x);
        var lower = below;
        if triangles {
            // Nodes shrink towards the corner off the diagonal.
            lower = n >= 9u;
            let offset = along * vec2<f32>(1.0 - v.x, v.x) * u.x;
            at = select(corner + offset, corner + along - offset, lower);
            weight *= u.x;
        }
        let node = source_direction(place, image, at, lower);
        nodes[n] = node.towards - packet_axis;
        weights[n] = weight * node.density;
        centroid += weights[n] * nodes[n];
        total += weights[n];
    }
    centroid /= total;
    visit.leaf.offset = centroid;
    for (var n = 0u; n < count; n++) {
        let apart = nodes[n] - centroid;
        let share = weights[n] / total;
        visit.leaf.diagonal += share * apart * apart;
        visit.leaf.mixed += share * apart.yzx * apart.zxy;
    }
    for (var n = 0u; n < 4u; n++) {
        let at = corner + along * vec2<f32>(f32(n & 1u), f32(n >> 1u));
        let direction = source_direction(place, image, at, select(below, n == 3u, triangles)).towards;
        let reached = direction - packet_axis - centroid;
        visit.leaf.radius = max(visit.leaf.radius, length(reached));
    }
    // Float32 directions are in error by less than 2^-22.
    visit.leaf.radius += 5e-7;
    visit.leaf.energy = above * total;
    visit.luminance = dot(visit.leaf.energy, LUMINANCE);
    let trace = visit.leaf.diagonal.x + visit.leaf.diagonal.y + visit.leaf.diagonal.z;
    visit.error = weighted(visit.leaf.energy)
        * expected_error(kernel(), length(centroid), visit.leaf.radius, packet_radius, trace);
    return visit;
}
