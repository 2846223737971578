// Boxes over the exact table of an OEM: `Sat` of crates/core/src/light/sat.rs, read from two textures of low
// and high words. The including file declares, in any group,
//   octagloss_table: OctaglossTable (uniform), octagloss_low, octagloss_high: texture_2d<u32>.
#include "common/octahedral.wgsl"
#include "common/sum.wgsl"

struct OctaglossTable {
    // Exponents F of red, green and blue energy and of solid angle.
    exponents: vec4<i32>,
    // Texels along an edge of the square, and of its border.
    inner: u32,
    border: u32,
}

// Sum of the texels with coordinates below (x, y), from the corner of the bordered table.
fn table_prefix(x: i32, y: i32) -> Sum {
    if x <= 0 || y <= 0 {
        return Sum();
    }
    let at = vec2<i32>(x - 1, y - 1);
    return Sum(textureLoad(octagloss_low, at, 0), textureLoad(octagloss_high, at, 0));
}

// Sum of the texels 0 <= x' < x, 0 <= y' < y of the square.
fn square_prefix(x: i32, y: i32) -> Sum {
    let b = i32(octagloss_table.border);
    return corners(
        table_prefix(b, b), table_prefix(x + b, b), table_prefix(b, y + b), table_prefix(x + b, y + b));
}

// The same in the unfolded plane, for any integers: wallpaper group p2 by parity.
fn plane_prefix(at: vec2<i32>) -> Sum {
    let n = i32(octagloss_table.inner);
    let column = divide_floor(octagloss_table.inner, at.x);
    let row = divide_floor(octagloss_table.inner, at.y);
    let i = column.x;
    let j = row.x;
    let x = column.y;
    let y = row.y;
    let odd_i = (i & 1) != 0;
    let odd_j = (j & 1) != 0;
    var ends = array<vec2<i32>, 6>(
        vec2<i32>(n, n), vec2<i32>(x, n), vec2<i32>(n, y), vec2<i32>(n - x, n), vec2<i32>(n, n - y),
        select(vec2<i32>(x, y), vec2<i32>(n - x, n - y), odd_i != odd_j));
    // A loop, because some compilers inline every call and take minutes over the result.
    var prefixes: array<Sum, 6>;
    for (var k = 0u; k < 6u; k++) {
        prefixes[k] = square_prefix(ends[k].x, ends[k].y);
    }
    let total = prefixes[0];
    let a = prefixes[1];
    let b = prefixes[2];
    let a_turned = prefixes[3];
    let b_turned = prefixes[4];
    // Count upright and rotated tiles below; >> rounds down.
    let upright_a = select((j + 1) >> 1u, j >> 1u, odd_i);
    let upright_b = select((i + 1) >> 1u, i >> 1u, odd_j);
    var sum = multiply_sum(i * j, total);
    sum = add_sums(sum, multiply_sum(upright_a, a));
    sum = add_sums(sum, multiply_sum(j - upright_a, subtract_sums(total, a_turned)));
    sum = add_sums(sum, multiply_sum(upright_b, b));
    sum = add_sums(sum, multiply_sum(i - upright_b, subtract_sums(total, b_turned)));
    if odd_i == odd_j {
        return add_sums(sum, prefixes[5]);
    }
    let rest = subtract_sums(subtract_sums(total, a_turned), b_turned);
    return add_sums(sum, add_sums(rest, prefixes[5]));
}

// An interval with fractional ends, as a partial texel, whole texels and a partial texel.
struct Spans {
    edges: vec4<i32>,
    shares: vec3<f32>,
}

fn fractional_spans(low: f32, high: f32) -> Spans {
    let first = floor(low);
    let last = ceil(high);
    let edge = i32(first);
    if last - first <= 1.0 {
        // Both ends lie in one texel.
        return Spans(vec4<i32>(edge, edge + 1, edge + 1, edge + 1), vec3<f32>(high - low, 0.0, 0.0));
    }
    let end = i32(last);
    return Spans(
        vec4<i32>(edge, edge + 1, end - 1, end),
        vec3<f32>(first + 1.0 - low, 1.0, high - (last - 1.0)));
}

// Sum of the texels low <= p < high of the unfolded plane, with sides up to twice the square's. Takes four
// reads if the box lies inside the border.
fn plane_box(low: vec2<i32>, high: vec2<i32>) -> Sum {
    let b = i32(octagloss_table.border);
    let most = i32(octagloss_table.inner) + b;
    if all(low >= vec2<i32>(-b)) && all(high <= vec2<i32>(most)) {
        return corners(
            table_prefix(low.x + b, low.y + b), table_prefix(high.x + b, low.y + b),
            table_prefix(low.x + b, high.y + b), table_prefix(high.x + b, high.y + b));
    }
    var sum = Sum();
    for (var k = 0u; k < 4u; k++) {
        let right = (k & 1u) != 0u;
        let lower = (k & 2u) != 0u;
        let prefix = plane_prefix(vec2<i32>(select(low.x, high.x, right), select(low.y, high.y, lower)));
        if right == lower {
            sum = add_sums(sum, prefix);
        } else {
            sum = subtract_sums(sum, prefix);
        }
    }
    return sum;
}

// Energy and solid angle of a box of the unfolded plane with fractional edges, in texels of the square. Units
// are such that their quotient is radiance.
fn box_energy(low: vec2<f32>, high: vec2<f32>) -> vec4<f32> {
    var columns = fractional_spans(low.x, high.x);
    var rows = fractional_spans(low.y, high.y);
    var sum = vec4<f32>();
    for (var j = 0; j < 3; j++) {
        for (var i = 0; i < 3; i++) {
            let share = columns.shares[i] * rows.shares[j];
            if share > 0.0 {
                let part = plane_box(
                    vec2<i32>(columns.edges[i], rows.edges[j]),
                    vec2<i32>(columns.edges[i + 1], rows.edges[j + 1]));
                sum += share * floats_from_sum(part);
            }
        }
    }
    let up = octagloss_table.exponents.a - octagloss_table.exponents.rgb;
    return vec4<f32>(
        scale_by_power(sum.r, up.r), scale_by_power(sum.g, up.g), scale_by_power(sum.b, up.b), sum.a);
}

// Energy and solid angle of the box of `solid_angle` around `direction` (any length but zero). A one-texel
// box is added in quadrature: solid angle 0 is bilinear interpolation. A weighted sum of several makes a
// stack; `rgb / a` is its radiance.
fn octagloss_box_energy(direction: vec3<f32>, solid_angle: f32) -> vec4<f32> {
    let n = f32(octagloss_table.inner);
    let uv = oct_from_direction(direction);
    let texels = solid_angle / solid_angle_density(uv) * (n * n / 4.0);
    let half = 0.5 * min(sqrt(texels + 1.0), 2.0 * n);
    let centre = (uv + 1.0) * (n / 2.0);
    return box_energy(centre - half, centre + half);
}

// Radiance of one box: the filter of the octahedron environment maps paper.
fn octagloss_box(direction: vec3<f32>, solid_angle: f32) -> vec3<f32> {
    let energy = octagloss_box_energy(direction, solid_angle);
    return energy.rgb / energy.a;
}

// Solid angle of the box for GGX of `roughness` in [0, 1]: the cap that holds the lobe's weight at its peak
// value.
fn octagloss_ggx_solid_angle(roughness: f32) -> f32 {
    let squared = roughness * roughness * roughness * roughness;
    if squared == 0.0 {
        return 0.0;
    }
    // 2 pi (t - ln(1 + t)) / t^2, by its series where it cancels.
    let t = (1.0 - squared) / (2.0 * squared);
    if t < 0.1 {
        var sum = 0.0;
        for (var k = 9; k >= 2; k--) {
            sum = 1.0 / f32(k) - t * sum;
        }
        return 6.2831853 * sum;
    }
    return 6.2831853 * (t - log(1.0 + t)) / t / t;
}

// Radiance of a GGX reflection around `direction` at `roughness` in [0, 1], by one box.
fn octagloss_ggx(direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    return octagloss_box(direction, octagloss_ggx_solid_angle(roughness));
}
