// Reads a bordered octahedral map (`octagloss bake --target oem`) through an ordinary sampler: linear,
// clamped to edge. Right-handed, y up. The square's centre is +Y and its corners are -Y; u runs along x, v
// along z and downwards. The border halves with each level, down to one texel, so one mapping serves all
// levels and no look-up wraps.

// Coordinates in [-1, 1]^2 of `direction`, of any length but zero.
fn oem_oct_from_direction(direction: vec3<f32>) -> vec2<f32> {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let folded = 1.0 - abs(p.zx);
    let turned = vec2<f32>(select(-folded.x, folded.x, p.x >= 0.0), select(-folded.y, folded.y, p.z >= 0.0));
    return select(turned, p.xz, p.y >= 0.0);
}

// Texture coordinates of `direction`, the same at every level; `side` is that of level 0 with its border.
fn oem_uv_from_direction(direction: vec3<f32>, side: f32, levels: f32) -> vec2<f32> {
    let border = exp2(levels - 1.0);
    return 0.5 + oem_oct_from_direction(direction) * (0.5 - border / side);
}

// Radiance reflected by a surface of perceptual `roughness` around `direction`, the mirrored view vector.
fn oem_radiance(map: texture_2d<f32>, linear: sampler, direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    let levels = f32(textureNumLevels(map));
    let uv = oem_uv_from_direction(direction, f32(textureDimensions(map).x), levels);
    return textureSampleLevel(map, linear, uv, roughness * (levels - 1.0)).rgb;
}
