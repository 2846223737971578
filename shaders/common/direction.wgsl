// The direction of `sum`, 0 if there is none. Its squares may be too small or large for floats.
fn direction_of_sum(sum: vec3<f32>) -> vec3<f32> {
    let most = max(max(abs(sum.x), abs(sum.y)), abs(sum.z));
    return select(vec3<f32>(), normalize(sum / most), most > 1e-37);
}

fn squared(v: vec3<f32>) -> f32 {
    return dot(v, v);
}
