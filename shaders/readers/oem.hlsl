// Reads a bordered octahedral map (`octagloss bake --target oem`) through an ordinary sampler: trilinear,
// clamped to edge. Shader model 4.0 and newer. Right-handed, y up. The square's centre is +Y and its corners
// are -Y; u runs along x, v along z and downwards. The border halves with each level, down to one texel, so
// one mapping serves all levels and no look-up wraps.

// Coordinates in [-1, 1]^2 of `direction`, of any length but zero.
float2 oem_oct_from_direction(float3 direction) {
    float3 p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    float2 side = float2(p.x >= 0.0 ? 1.0 : -1.0, p.z >= 0.0 ? 1.0 : -1.0);
    return p.y >= 0.0 ? p.xz : (1.0 - abs(p.zx)) * side;
}

// Texture coordinates of `direction`, the same at every level; `side` is that of level 0 with its border.
float2 oem_uv_from_direction(float3 direction, float side, float levels) {
    float border = exp2(levels - 1.0);
    return 0.5 + oem_oct_from_direction(direction) * (0.5 - border / side);
}

// Radiance reflected by a surface of perceptual `roughness` around `direction`, the mirrored view vector.
float3 oem_radiance(Texture2D map, SamplerState trilinear, float3 direction, float roughness) {
    float width, height, levels;
    map.GetDimensions(0, width, height, levels);
    float2 uv = oem_uv_from_direction(direction, width, levels);
    return map.SampleLevel(trilinear, uv, roughness * (levels - 1.0)).rgb;
}
