// Glossy light by the split sum, the lobe around the mirrored view times the table, and diffuse light.
fn shaded(found: Sample, diffuse: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let glossy = radiance(frame.source_from_world * found.direction, found.roughness, pixel);
    return glossy * found.factor + diffuse;
}

// Errors are those of the lobes.
fn judged(found: Sample, pixel: vec2<f32>) -> vec3<f32> {
    return radiance(frame.source_from_world * found.direction, found.roughness, pixel);
}
