// Reads a bordered octahedral map (`octagloss bake --target oem`) through an ordinary sampler: trilinear,
// clamped to edge. GLSL 1.30, GLSL ES 3.00 and newer. Right-handed, y up. The square's centre is +Y and its
// corners are -Y; u runs along x, v along z and downwards (row 0 is the first in memory, at t = 0). The
// border halves with each level, down to one texel, so one mapping serves all levels and no look-up wraps.

// Coordinates in [-1, 1]^2 of `direction`, of any length but zero.
vec2 oem_oct_from_direction(vec3 direction) {
    vec3 p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    vec2 side = vec2(p.x >= 0.0 ? 1.0 : -1.0, p.z >= 0.0 ? 1.0 : -1.0);
    return p.y >= 0.0 ? p.xz : (1.0 - abs(p.zx)) * side;
}

// Texture coordinates of `direction`, the same at every level; `side` is that of level 0 with its border.
vec2 oem_uv_from_direction(vec3 direction, float side, float levels) {
    float border = exp2(levels - 1.0);
    return 0.5 + oem_oct_from_direction(direction) * (0.5 - border / side);
}

// Radiance reflected by a surface of perceptual `roughness` around `direction`, the mirrored view vector.
// `levels` is the level count of the texture, which older GLSL cannot query.
vec3 oem_radiance(sampler2D map, float levels, vec3 direction, float roughness) {
    vec2 uv = oem_uv_from_direction(direction, float(textureSize(map, 0).x), levels);
    return textureLod(map, uv, roughness * (levels - 1.0)).rgb;
}
