// Boxes in the unfolded plane from the table of the square, and their fractional edges: `Sat` of
// crates/core/src/light/sat.rs.
#include "common/octahedral.wgsl"
#include "common/sum.wgsl"

// Wallpaper group p2 by parity. Ends of the six sums from the square's corner that make up the sum of the
// texels below `at` of the plane, for any integers.
fn prefix_ends(inner: u32, at: vec2<i32>) -> array<vec2<i32>, 6> {
    let n = i32(inner);
    let column = divide_floor(inner, at.x);
    let row = divide_floor(inner, at.y);
    let x = column.y;
    let y = row.y;
    let turned = ((column.x ^ row.x) & 1) != 0;
    return array<vec2<i32>, 6>(
        vec2<i32>(n, n), vec2<i32>(x, n), vec2<i32>(n, y), vec2<i32>(n - x, n), vec2<i32>(n, n - y),
        select(vec2<i32>(x, y), vec2<i32>(n - x, n - y), turned));
}

// That sum, from the six.
fn unfolded_prefix(inner: u32, at: vec2<i32>, prefixes: array<Sum, 6>) -> Sum {
    let i = divide_floor(inner, at.x).x;
    let j = divide_floor(inner, at.y).x;
    let odd_i = (i & 1) != 0;
    let odd_j = (j & 1) != 0;
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
