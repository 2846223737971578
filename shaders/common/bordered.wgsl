// Maps with borders that continue across the square's edges.

// A map to write.
struct Level {
    // Texels along an edge, and of the border.
    inner: u32,
    border: u32,
    // The same of the map to read.
    finer_inner: u32,
    finer_border: u32,
    // Variance of the Gaussian between the two, and its bend.
    variance: f32,
    bend: f32,
    pad_a: u32,
    pad_b: u32,
    // Reads around a Gaussian of covariance 1, and their weights.
    taps: array<vec4<f32>, 25>,
}

@group(0) @binding(7) var<uniform> level: Level;
@group(0) @binding(8) var map: texture_storage_2d<rgba16float, write>;

// Each value rounded to the nearest half: drivers may cut off, and levels from levels would darken.
fn halves(light: vec3<f32>) -> vec3<f32> {
    let bits = bitcast<vec3<u32>>(light);
    let even = (bits >> vec3<u32>(13u)) & vec3<u32>(1u);
    return bitcast<vec3<f32>>((bits + 0xfffu + even) & vec3<u32>(0xffffe000u));
}

// Writes texel `at` of the square, also where the border has it.
fn store(at: vec2<i32>, light: vec3<f32>) {
    let value = vec4<f32>(halves(light), 1.0);
    let n = i32(level.inner);
    let b = i32(level.border);
    textureStore(map, at + b, value);
    let low = at < vec2<i32>(b);
    let high = at >= vec2<i32>(n - b);
    let turned = n - 1 - at;
    let beyond = select(2 * n - 1 - at, -1 - at, low);
    let near = low | high;
    if near.x {
        textureStore(map, vec2<i32>(beyond.x, turned.y) + b, value);
    }
    if near.y {
        textureStore(map, vec2<i32>(turned.x, beyond.y) + b, value);
    }
    if all(near) {
        textureStore(map, at + select(vec2<i32>(-n), vec2<i32>(n), low) + b, value);
    }
}
