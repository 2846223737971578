// The octahedral map in its quadratic layout: crates/core/src/sphere/octahedral.rs.

fn octahedron_from_oct(uv: vec2<f32>) -> vec3<f32> {
    let y = 1.0 - abs(uv.x) - abs(uv.y);
    if y >= 0.0 {
        return vec3<f32>(uv.x, y, uv.y);
    }
    let folded = 1.0 - abs(uv.yx);
    return vec3<f32>(select(-folded.x, folded.x, uv.x >= 0.0), y, select(-folded.y, folded.y, uv.y >= 0.0));
}

fn direction_from_oct(uv: vec2<f32>) -> vec3<f32> {
    return normalize(octahedron_from_oct(uv));
}

// How direction_from_oct changes with u and with v: tangents of the sphere.
fn steps_from_oct(uv: vec2<f32>) -> array<vec3<f32>, 2> {
    let point = octahedron_from_oct(uv);
    let far = length(point);
    let d = point / far;
    let s = select(vec2<f32>(-1.0), vec2<f32>(1.0), uv >= vec2<f32>());
    let upper = point.y >= 0.0;
    let by_u = select(vec3<f32>(0.0, -s.x, -s.x * s.y), vec3<f32>(1.0, -s.x, 0.0), upper);
    let by_v = select(vec3<f32>(-s.x * s.y, -s.y, 0.0), vec3<f32>(0.0, -s.y, 1.0), upper);
    return array<vec3<f32>, 2>((by_u - d * dot(by_u, d)) / far, (by_v - d * dot(by_v, d)) / far);
}

// `direction` of any length but zero.
fn oct_from_direction(direction: vec3<f32>) -> vec2<f32> {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    if p.y >= 0.0 {
        return p.xz;
    }
    let folded = 1.0 - abs(p.zx);
    return vec2<f32>(select(-folded.x, folded.x, p.x >= 0.0), select(-folded.y, folded.y, p.z >= 0.0));
}

// Solid angle per unit of (u, v) area.
fn solid_angle_density(uv: vec2<f32>) -> f32 {
    let p = octahedron_from_oct(uv);
    let squared = dot(p, p);
    return 1.0 / (squared * sqrt(squared));
}

// Quotient and remainder with the remainder in 0 .. n - 1. Avoids `/` and `%` on negative numbers, which some
// drivers compute wrongly.
fn divide_floor(n: u32, x: i32) -> vec2<i32> {
    if x >= 0 {
        return vec2<i32>(i32(u32(x) / n), i32(u32(x) % n));
    }
    let below = u32(-1 - x);
    return vec2<i32>(-1 - i32(below / n), i32(n - 1u - below % n));
}

// The texel of the n x n square that corresponds to texel `at` of the unfolded plane.
fn wrap_texel(n: u32, at: vec2<i32>) -> vec2<u32> {
    let x = divide_floor(n, at.x);
    let y = divide_floor(n, at.y);
    let inside = vec2<u32>(u32(x.y), u32(y.y));
    return select(inside, vec2<u32>(n - 1u) - inside, ((x.x ^ y.x) & 1) != 0);
}
