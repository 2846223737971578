// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2, octagloss_rows pyramid_rows.ktx2, of which isotropic reflections read
// nothing; octagloss_linear is a sampler, linear in texels and in mip levels and clamped to the edge.
// Directions are in the world, right-handed, y up. To use: octagloss_radiance, octagloss_irradiance,
// octagloss_reflect, octagloss_reflect_isotropic, octagloss_albedo and octagloss_albedo_along; `probe` is 0.
#ifdef OCTAGLOSS_CUBE
// The maps are one cube, of `--map cube`, the tables pyramid_cube_tables.ktx2, and rows those of `octagloss
// reader --rows FILE --map cube`; in OpenGL enable GL_TEXTURE_CUBE_MAP_SEAMLESS.
// Translated from pyramid_cube.wgsl, FNV-1a e91d6d689c16b349.
#else
// Translated from pyramid.wgsl, FNV-1a 46e412c03f6c9571.
#endif
// GLSL ES 3.00, GLSL 3.30 and newer, after the version and, in ES, the precision of float and int.
struct OctaglossSun {
    vec4 red;
    vec4 green;
    vec4 blue;
    vec3 energy;
    float pad;
};
struct OctaglossLight {
    mat3x3 world_from_source;
    float scale;
    float unscale;
    float clamp_;
    float pad;
    vec4 harmonics[25];
    OctaglossSun suns[8];
};
struct octagloss_SurfaceFrame {
    vec3 normal;
    vec3 towards;
    float cosine;
    float sine;
};
struct octagloss_RowPlace {
    vec3 at;
    float share;
};
struct octagloss_Row {
    vec2 axis;
    float extent;
    float shift;
    vec4 steps;
    float alternation;
    float skew;
};
const uint octagloss_SUNS = 8u;
const uint octagloss_INTERVALS = 860u;
#ifndef OCTAGLOSS_CUBE
const uint octagloss_SQUARES = 3u;
#endif
const uint octagloss_READS = 10u;
const uint octagloss_LAYERS = 18u;
const float octagloss_COSINE_FROM = 0.435;
const vec2 octagloss_NODES = vec2(46.0, 26.0);
const float octagloss_LEAST_COSINE = 0.01;
const vec2 octagloss_ALBEDO_NODES = vec2(91.0, 75.0);
const vec4 octagloss_DIP = vec4(0.222, 0.634, 0.098, 0.3126);
const float octagloss_LEAST_ALPHA = 1e-6;
const vec2 octagloss_TABLES = vec2(864.0, 40.0);
const vec4 octagloss_ROW_NODES = vec4(16.0, 10.0, 8.0, 7.0);
const uint octagloss_ROW_MIDDLE = 7u;
const uint octagloss_ROW_PAIRS = 8u;
const uint octagloss_ROW_LAYERS = 21u;
const vec2 octagloss_BLEND_ALBEDO_NODES = vec2(84.0, 61.0);
const vec2 octagloss_BLEND_SHARE_NODES = vec2(49.0, 11.0);
const vec2 octagloss_BLEND_MEAN_NODES = vec2(84.0, 21.0);
const float octagloss_BLEND_RATIO_NODES = 33.0;
const float octagloss_BLEND_STRIP = 20.0;
const float octagloss_BLEND_SHARES_AT = 252.0;
const float octagloss_BLEND_RATIOS_AT = 302.0;
const vec3 octagloss_ROW_SIZE = vec3(336.0, 91.0, 8.0);
const float octagloss_ROW_SHARP = 0.001;
const float octagloss_NARROWEST = 0.05;
const float octagloss_BLEND = 0.1;
const float octagloss_TILTED = 0.5;
const float octagloss_SKEWED = 0.2;
#ifdef OCTAGLOSS_CUBE
const float octagloss_LEVEL_OCTAVES = 1.0;
#else
const float octagloss_LEVEL_OCTAVES = 0.864;
#endif

layout(std140) uniform OctaglossLights { OctaglossLight octagloss_lights[1]; };

#ifdef OCTAGLOSS_CUBE
uniform highp samplerCube octagloss_maps;
#else
uniform highp sampler2DArray octagloss_maps;
#endif

uniform highp sampler2D octagloss_tables;

uniform highp sampler3D octagloss_rows;

float[25] octagloss_harmonic_basis(vec3 d) {
    float x_1 = d.x;
    float y = d.y;
    float z = d.z;
    float xx = (x_1 * x_1);
    float yy = (y * y);
    float zz = (z * z);
    return float[25](0.28209478, (0.48860252 * y), (0.48860252 * z), (0.48860252 * x_1), ((1.0925485 * x_1) * y), ((1.0925485 * y) * z), (0.31539157 * ((3.0 * zz) - 1.0)), ((1.0925485 * x_1) * z), (0.54627424 * (xx - yy)), ((0.5900436 * y) * ((3.0 * xx) - yy)), (((2.8906114 * x_1) * y) * z), ((0.4570458 * y) * ((5.0 * zz) - 1.0)), ((0.37317634 * z) * ((5.0 * zz) - 3.0)), ((0.4570458 * x_1) * ((5.0 * zz) - 1.0)), ((1.4453057 * z) * (xx - yy)), ((0.5900436 * x_1) * (xx - (3.0 * yy))), (((2.5033429 * x_1) * y) * (xx - yy)), (((1.7701308 * y) * z) * ((3.0 * xx) - yy)), (((0.9461747 * x_1) * y) * ((7.0 * zz) - 1.0)), (((0.6690465 * y) * z) * ((7.0 * zz) - 3.0)), (0.10578555 * ((((35.0 * zz) * zz) - (30.0 * zz)) + 3.0)), (((0.6690465 * x_1) * z) * ((7.0 * zz) - 3.0)), ((0.47308734 * (xx - yy)) * ((7.0 * zz) - 1.0)), (((1.7701308 * x_1) * z) * (xx - (3.0 * yy))), (0.6258357 * (((xx * xx) - ((6.0 * xx) * yy)) + (yy * yy))));
}

vec3 octagloss_source_from_world(uint probe, vec3 direction) {
    mat3x3 axes = octagloss_lights[probe].world_from_source;
    return normalize(vec3(dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])));
}

vec3 octagloss_harmonic(uint probe_1, uint k) {
    vec4 _e6 = octagloss_lights[probe_1].harmonics[k];
    return _e6.xyz;
}

vec3[5] octagloss_orders_of(uint probe_2, float b[25]) {
    vec3 _e4 = octagloss_harmonic(probe_2, 0u);
    vec3 _e8 = octagloss_harmonic(probe_2, 1u);
    vec3 _e12 = octagloss_harmonic(probe_2, 2u);
    vec3 _e17 = octagloss_harmonic(probe_2, 3u);
    vec3 _e22 = octagloss_harmonic(probe_2, 4u);
    vec3 _e26 = octagloss_harmonic(probe_2, 5u);
    vec3 _e31 = octagloss_harmonic(probe_2, 6u);
    vec3 _e36 = octagloss_harmonic(probe_2, 7u);
    vec3 _e41 = octagloss_harmonic(probe_2, 8u);
    vec3 _e46 = octagloss_harmonic(probe_2, 9u);
    vec3 _e50 = octagloss_harmonic(probe_2, 10u);
    vec3 _e55 = octagloss_harmonic(probe_2, 11u);
    vec3 _e60 = octagloss_harmonic(probe_2, 12u);
    vec3 _e65 = octagloss_harmonic(probe_2, 13u);
    vec3 _e70 = octagloss_harmonic(probe_2, 14u);
    vec3 _e75 = octagloss_harmonic(probe_2, 15u);
    vec3 _e80 = octagloss_harmonic(probe_2, 16u);
    vec3 _e84 = octagloss_harmonic(probe_2, 17u);
    vec3 _e89 = octagloss_harmonic(probe_2, 18u);
    vec3 _e94 = octagloss_harmonic(probe_2, 19u);
    vec3 _e99 = octagloss_harmonic(probe_2, 20u);
    vec3 _e104 = octagloss_harmonic(probe_2, 21u);
    vec3 _e109 = octagloss_harmonic(probe_2, 22u);
    vec3 _e114 = octagloss_harmonic(probe_2, 23u);
    vec3 _e119 = octagloss_harmonic(probe_2, 24u);
    return vec3[5]((b[0] * _e4), (((b[1] * _e8) + (b[2] * _e12)) + (b[3] * _e17)), (((((b[4] * _e22) + (b[5] * _e26)) + (b[6] * _e31)) + (b[7] * _e36)) + (b[8] * _e41)), (((((((b[9] * _e46) + (b[10] * _e50)) + (b[11] * _e55)) + (b[12] * _e60)) + (b[13] * _e65)) + (b[14] * _e70)) + (b[15] * _e75)), (((((((((b[16] * _e80) + (b[17] * _e84)) + (b[18] * _e89)) + (b[19] * _e94)) + (b[20] * _e99)) + (b[21] * _e104)) + (b[22] * _e109)) + (b[23] * _e114)) + (b[24] * _e119)));
}

vec3 octagloss_harmonics_around(uint probe_3, vec3 d_1, float weights[5]) {
    float _e3[25] = octagloss_harmonic_basis(d_1);
    vec3 _e4[5] = octagloss_orders_of(probe_3, _e3);
    return (((((weights[0] * _e4[0]) + (weights[1] * _e4[1])) + (weights[2] * _e4[2])) + (weights[3] * _e4[3])) + (weights[4] * _e4[4]));
}

vec3 octagloss_place_of(vec3 direction_1) {
#ifdef OCTAGLOSS_CUBE
    return direction_1;
#else
    return (direction_1 / vec3(((abs(direction_1.x) + abs(direction_1.y)) + abs(direction_1.z))));
#endif
}

vec4[5] octagloss_node_weights(uint node) {
    vec4 weights_1[5] = vec4[5](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    uint row = 0u;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e18 = row;
            row = (_e18 + 1u);
        }
        loop_init = false;
        uint _e5 = row;
        if ((_e5 < 5u)) {
        } else {
            break;
        }
        {
            uint _e8 = row;
            uint _e12 = row;
            vec4 _e16 = texelFetch(octagloss_tables, ivec2(uvec2(node, (27u + _e12))), 0);
            weights_1[_e8] = _e16;
        }
    }
    vec4 _e20[5] = weights_1;
    return _e20;
#ifndef OCTAGLOSS_CUBE
}

float octagloss_map_side() {
    return float(uvec2(textureSize(octagloss_maps, 0).xy).x);
}

uint octagloss_map_octave() {
    float _e0 = octagloss_map_side();
    return ((floatBitsToUint(_e0) >> 23u) - 127u);
}

vec3 octagloss_read_square(uint probe_4, vec3 at_1, uint layer, uint mip) {
    uint _e5 = octagloss_map_octave();
    float inner = float((1u << _e5));
    float edge = (float((1u << mip)) / inner);
    vec3 rounded = max(abs(at_1), vec3(edge, 0.0, edge));
    vec2 p = (at_1.xz / vec2(((rounded.x + rounded.y) + rounded.z)));
    vec2 folded = (vec2(1.0) - abs(p.yx));
    vec2 turned = vec2(((p.x >= 0.0) ? folded.x : -(folded.x)), ((p.y >= 0.0) ? folded.y : -(folded.y)));
    vec2 uv = ((at_1.y >= 0.0) ? p : turned);
    float _e50 = octagloss_map_side();
    vec2 place_3 = (vec2(0.5) + (uv * ((0.5 * inner) / _e50)));
    vec4 _e62 = textureLod(octagloss_maps, vec3(place_3, ((octagloss_SQUARES * probe_4) + layer)), float(mip));
    return _e62.xyz;
}

vec3 octagloss_read_map(uint probe_5, vec3 at_2, uint map) {
    vec3 _e7 = octagloss_read_square(probe_5, at_2, (map % octagloss_SQUARES), (map / octagloss_SQUARES));
    return _e7;
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_read_map(uint probe_4, vec3 at_1, uint map) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_1), float(map));
    return _e6.xyz;
#else
uint octagloss_last_mip() {
    uint _e0 = octagloss_map_octave();
    return max((_e0 - ((_e0 > 8u) ? 6u : 5u)), 1u);
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_read_cosine(uint probe_5, vec3 at_2) {
    vec3 _e8 = octagloss_harmonics_around(probe_5, at_2, float[5](1.0, 0.6666667, 0.25, 0.0, -0.041666668));
    return _e8;
#else
vec3 octagloss_read_cosine(uint probe_6, vec3 at_3) {
    uint _e3 = octagloss_last_mip();
    vec3 _e4 = octagloss_read_square(probe_6, at_3, 2u, _e3);
    return _e4;
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_half_axis_of(uint probe_6, uint disc) {
#else
vec3 octagloss_half_axis_of(uint probe_7, uint disc) {
#endif
    uint k_4 = (3u * (disc / 2u));
#ifdef OCTAGLOSS_CUBE
    float _e11 = octagloss_lights[probe_6].harmonics[k_4].w;
    float _e19 = octagloss_lights[probe_6].harmonics[(k_4 + 1u)].w;
    float _e27 = octagloss_lights[probe_6].harmonics[(k_4 + 2u)].w;
#else
    float _e11 = octagloss_lights[probe_7].harmonics[k_4].w;
    float _e19 = octagloss_lights[probe_7].harmonics[(k_4 + 1u)].w;
    float _e27 = octagloss_lights[probe_7].harmonics[(k_4 + 2u)].w;
#endif
    vec3 half_axis = vec3(_e11, _e19, _e27);
    return (((disc % 2u) == 0u) ? half_axis : -(half_axis));
}

float octagloss_squared(vec3 v) {
    return dot(v, v);
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_radiance_of(uint probe_7, vec3 direction_2, float roughness) {
#else
vec3 octagloss_radiance_of(uint probe_8, vec3 direction_2, float roughness) {
#endif
    vec3 sum = vec3(0.0);
    float maps[10] = float[10](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    uint map_1 = 0u;
    uint disc_1 = 0u;
    vec3 lobe = vec3(0.0);
#ifdef OCTAGLOSS_CUBE
    vec3 _e3 = octagloss_source_from_world(probe_7, direction_2);
#else
    vec3 _e3 = octagloss_source_from_world(probe_8, direction_2);
#endif
    vec3 _e4 = octagloss_place_of(_e3);
    float node_1 = (log2((1.0 + (30.0 * roughness))) * 173.59021);
    uint k_5 = min(uint(node_1), 859u);
    float share = (node_1 - float(k_5));
    vec4 _e17[5] = octagloss_node_weights(k_5);
    vec4 _e20[5] = octagloss_node_weights((k_5 + 1u));
    vec4 a_1 = mix(_e17[0], _e20[0], share);
    vec4 b_2 = mix(_e17[1], _e20[1], share);
    vec4 c_2 = mix(_e17[2], _e20[2], share);
    vec4 e = mix(_e17[3], _e20[3], share);
    vec4 f = mix(_e17[4], _e20[4], share);
    maps = float[10](a_1.x, a_1.y, a_1.z, a_1.w, b_2.x, b_2.y, b_2.z, b_2.w, c_2.x, c_2.y);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e69 = map_1;
            map_1 = (_e69 + 1u);
        }
        loop_init_1 = false;
        uint _e52 = map_1;
        if ((_e52 < 10u)) {
        } else {
            break;
        }
        {
            uint _e55 = map_1;
            float _e57 = maps[_e55];
            if ((_e57 != 0.0)) {
                vec3 _e60 = sum;
                uint _e61 = map_1;
                float _e63 = maps[_e61];
                uint _e64 = map_1;
#ifdef OCTAGLOSS_CUBE
                vec3 _e65 = octagloss_read_map(probe_7, _e4, _e64);
#else
                vec3 _e65 = octagloss_read_map(probe_8, _e4, _e64);
#endif
                sum = (_e60 + (_e63 * _e65));
            }
        }
    }
    if ((c_2.z != 0.0)) {
        vec3 _e74 = sum;
#ifdef OCTAGLOSS_CUBE
        vec3 _e76 = octagloss_read_cosine(probe_7, _e4);
#else
        vec3 _e76 = octagloss_read_cosine(probe_8, _e4);
#endif
        sum = (_e74 + (c_2.z * _e76));
    }
    vec3 _e79 = sum;
#ifdef OCTAGLOSS_CUBE
    vec3 _e86 = octagloss_harmonics_around(probe_7, _e3, float[5](c_2.w, e.x, e.y, e.z, e.w));
#else
    vec3 _e86 = octagloss_harmonics_around(probe_8, _e3, float[5](c_2.w, e.x, e.y, e.z, e.w));
#endif
    sum = (_e79 + _e86);
    vec3 _e88 = sum;
#ifdef OCTAGLOSS_CUBE
    float _e94 = octagloss_lights[probe_7].unscale;
#else
    float _e94 = octagloss_lights[probe_8].unscale;
#endif
    sum = (max(_e88, vec3(0.0)) * _e94);
    float a2_ = max((((roughness * roughness) * roughness) * roughness), 1e-12);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e220 = disc_1;
            disc_1 = (_e220 + 1u);
        }
        loop_init_2 = false;
        uint _e103 = disc_1;
        if ((_e103 < 16u)) {
        } else {
            break;
        }
        {
            uint _e109 = disc_1;
#ifdef OCTAGLOSS_CUBE
            OctaglossSun sun = octagloss_lights[probe_7].suns[(_e109 / 2u)];
#else
            OctaglossSun sun = octagloss_lights[probe_8].suns[(_e109 / 2u)];
#endif
            uint _e114 = disc_1;
#ifdef OCTAGLOSS_CUBE
            vec3 _e115 = octagloss_half_axis_of(probe_7, _e114);
#else
            vec3 _e115 = octagloss_half_axis_of(probe_8, _e114);
#endif
            float _e116 = octagloss_squared(_e115);
            float nearer = (1.0 - (0.5 * _e116));
            vec3 to = (_e3 - _e115);
            float _e126 = octagloss_squared((to - (nearer * sun.red.xyz)));
            float _e131 = octagloss_squared((to - (nearer * sun.green.xyz)));
            float _e136 = octagloss_squared((to - (nearer * sun.blue.xyz)));
            vec3 apart = vec3(_e126, _e131, _e136);
            vec3 s = min((0.25 * apart), vec3(0.5));
            vec3 radius2_ = (0.5 * vec3(sun.red.w, sun.green.w, sun.blue.w));
            vec3 nearness = ((s + (a2_ * (vec3(1.0) - s))) - radius2_);
            lobe = vec3(0.0);
            if (all(lessThan(radius2_, (0.03 * nearness)))) {
                lobe = (vec3(a2_) / ((nearness * nearness) + ((3.0 * a2_) * radius2_)));
            } else {
                vec3 root = max(sqrt(((nearness * nearness) + ((4.0 * a2_) * radius2_))), vec3(1e-30));
                vec3 outside = (vec3((2.0 * a2_)) / (root * max((root + nearness), vec3(1e-30))));
                vec3 inside = ((root - nearness) / ((2.0 * max(radius2_, vec3(1e-30))) * root));
                lobe = mix(inside, outside, greaterThan(nearness, vec3(0.0)));
            }
            vec3 _e200 = sum;
            vec3 _e202 = lobe;
            sum = (_e200 + (sun.energy * ((_e202 * (vec3(1.0) - (2.0 * s))) * ((0.15915494 * f.x) * (1.0 - a_1.x)))));
        }
    }
    vec3 _e222 = sum;
    return _e222;
}

vec3 octagloss_radiance(vec3 direction_3, float roughness_1) {
    vec3 _e3 = octagloss_radiance_of(0u, direction_3, roughness_1);
    return _e3;
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_irradiance_of(uint probe_8, vec3 normal) {
#else
vec3 octagloss_irradiance_of(uint probe_9, vec3 normal) {
#endif
    vec3 sum_1 = vec3(0.0);
    uint k_1 = 0u;
#ifdef OCTAGLOSS_CUBE
    vec3 _e2 = octagloss_source_from_world(probe_8, normal);
#else
    vec3 _e2 = octagloss_source_from_world(probe_9, normal);
#endif
    vec3 _e3 = octagloss_place_of(_e2);
#ifdef OCTAGLOSS_CUBE
    vec3 _e4 = octagloss_read_cosine(probe_8, _e3);
    float _e8 = octagloss_lights[probe_8].unscale;
#else
    vec3 _e4 = octagloss_read_cosine(probe_9, _e3);
    float _e8 = octagloss_lights[probe_9].unscale;
#endif
    sum_1 = (_e4 * _e8);
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e41 = k_1;
            k_1 = (_e41 + 1u);
        }
        loop_init_3 = false;
        uint _e13 = k_1;
        if ((_e13 < octagloss_SUNS)) {
        } else {
            break;
        }
        {
            uint _e19 = k_1;
#ifdef OCTAGLOSS_CUBE
            OctaglossSun sun_1 = octagloss_lights[probe_8].suns[_e19];
#else
            OctaglossSun sun_1 = octagloss_lights[probe_9].suns[_e19];
#endif
            vec3 facing = vec3(dot(_e2, sun_1.red.xyz), dot(_e2, sun_1.green.xyz), dot(_e2, sun_1.blue.xyz));
            vec3 _e32 = sum_1;
            sum_1 = (_e32 + (sun_1.energy * (0.31830987 * max(facing, vec3(0.0)))));
        }
    }
    vec3 _e43 = sum_1;
    return _e43;
}

vec3 octagloss_irradiance(vec3 normal_1) {
    vec3 _e2 = octagloss_irradiance_of(0u, normal_1);
    return _e2;
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_read_reflections(uint layer, vec2 at_3) {
    vec2 corner = vec2((1.0 + (float(layer) * 48.0)), 0.0);
    vec4 _e17 = textureLod(octagloss_tables, vec2((((at_3 * octagloss_NODES) + corner) / octagloss_TABLES)), 0.0);
#else
vec4 octagloss_read_reflections(uint layer_1, vec2 at_4) {
    vec2 corner = vec2((1.0 + (float(layer_1) * 48.0)), 0.0);
    vec4 _e17 = textureLod(octagloss_tables, vec2((((at_4 * octagloss_NODES) + corner) / octagloss_TABLES)), 0.0);
#endif
    return _e17;
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_reflection_node(uint layer_1, float roughness_2, float cosine) {
#else
vec4 octagloss_reflection_node(uint layer_2, float roughness_2, float cosine) {
#endif
    float sine = sqrt(max((1.0 - (cosine * cosine)), 0.0));
#ifdef OCTAGLOSS_CUBE
    vec2 place_3 = vec2((log2((1.0 + (10.0 * roughness_2))) * 0.28906482), sqrt((cosine * inversesqrt((1.0 + sine)))));
    vec2 at_6 = (((place_3 * vec2(45.0, 25.0)) + vec2(0.5)) / octagloss_NODES);
    vec4 _e31 = octagloss_read_reflections(layer_1, at_6);
#else
    vec2 place_4 = vec2((log2((1.0 + (10.0 * roughness_2))) * 0.28906482), sqrt((cosine * inversesqrt((1.0 + sine)))));
    vec2 at_7 = (((place_4 * vec2(45.0, 25.0)) + vec2(0.5)) / octagloss_NODES);
    vec4 _e31 = octagloss_read_reflections(layer_2, at_7);
#endif
    return _e31;
}

vec4 octagloss_read_albedo(uint texel) {
    vec4 _e9 = texelFetch(octagloss_tables, ivec2(uvec2((texel % 864u), (32u + (texel / 864u)))), 0);
    return _e9;
}

vec2 octagloss_round_albedo(float cosine_1, float roughness_3) {
    float seen = clamp(cosine_1, 0.0001, 1.0);
    vec2 places = vec2((log2((1.0 + (30.0 * roughness_3))) * 0.2018487), ((sqrt(sqrt(seen)) - 0.1) / 0.9));
#ifdef OCTAGLOSS_CUBE
    vec2 place_4 = (clamp(places, vec2(0.0), vec2(1.0)) * vec2(90.0, 74.0));
    vec2 node_2 = min(floor(place_4), vec2(89.0, 73.0));
    vec2 share_1 = (place_4 - node_2);
#else
    vec2 place_5 = (clamp(places, vec2(0.0), vec2(1.0)) * vec2(90.0, 74.0));
    vec2 node_2 = min(floor(place_5), vec2(89.0, 73.0));
    vec2 share_1 = (place_5 - node_2);
#endif
    uint first_2 = uint((node_2.x + (91.0 * node_2.y)));
    vec4 _e39 = octagloss_read_albedo(first_2);
    vec4 _e42 = octagloss_read_albedo((first_2 + 91u));
    vec4 pair = mix(_e39, _e42, share_1.y);
    float t = (seen / max((roughness_3 * roughness_3), octagloss_LEAST_ALPHA));
    float left = (1.0 - ((0.222 * t) / (1.0 + (t * (0.634 + (t * (0.098 + (t * 0.3126))))))));
    return (left * mix(pair.xy, pair.zw, share_1.x));
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_between_levels(uint probe_9, vec3 direction_4, float level) {
#else
vec3 octagloss_between_levels(uint probe_10, vec3 direction_4, float level) {
#endif
    vec3 _e3 = octagloss_place_of(direction_4);
    uint finer = uint(level);
    float share_2 = fract(level);
    uint coarser = ((share_2 > 0.0) ? (finer + 1u) : finer);
#ifdef OCTAGLOSS_CUBE
    vec3 _e11 = octagloss_read_map(probe_9, _e3, finer);
    vec3 _e12 = octagloss_read_map(probe_9, _e3, coarser);
#else
    vec3 _e11 = octagloss_read_map(probe_10, _e3, finer);
    vec3 _e12 = octagloss_read_map(probe_10, _e3, coarser);
#endif
    return mix(_e11, _e12, share_2);
}

float octagloss_masking_of(vec3 w, vec2 alpha) {
    return length(vec3((alpha * w.xy), w.z));
}

float octagloss_fresnel_of(float cosine_2) {
    float rest = max((1.0 - cosine_2), 0.0);
    return ((((rest * rest) * rest) * rest) * rest);
}

vec2 octagloss_brdf_around(vec3 view, vec3 light, vec2 alpha_1, float spread) {
    float x = 0.0;
    float side = 0.0;
    float slope = 1.0;
    uint step_ = 0u;
    float radius = sqrt((2.0 * spread));
    if ((light.z <= -(radius))) {
        return vec2(0.0);
    }
    float left_1 = min(((0.5 * (light.z + radius)) / max(radius, 1e-9)), 1.0);
    vec3 l = normalize(vec3(light.xy, max(light.z, (left_1 * radius))));
    float above = ((spread * left_1) * left_1);
    vec3 middle = (view + ((1.0 - above) * l));
    float length2_ = dot(middle, middle);
    vec3 h = (middle * inversesqrt(length2_));
    vec3 shape = vec3((alpha_1.y / alpha_1.x), (alpha_1.x / alpha_1.y), (alpha_1.x * alpha_1.y));
    vec3 bent = (shape * h);
    float bend = dot(h, bent);
    float along_1 = dot(h, l);
    float size = ((above * (2.0 - above)) / (length2_ * bend));
    float trace = (size * dot(shape, (vec3(1.0) - (l * l))));
    float _e60 = octagloss_squared(cross(l, bent));
    float aside = (trace - ((size * _e60) / bend));
    float _e64 = octagloss_masking_of(l, alpha_1);
    float determinant_ = (((size * size) * _e64) * _e64);
    float near = (((shape.z * along_1) * along_1) / ((bend * _e64) * _e64));
    float last = (determinant_ * near);
    float linear = (1.0 - trace);
    x = max((0.5 * (linear + sqrt(((linear * linear) + ((4.0 * trace) * near))))), near);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e140 = step_;
            step_ = (_e140 + 1u);
        }
        loop_init_4 = false;
        uint _e94 = step_;
        if ((_e94 < 3u)) {
        } else {
            break;
        }
        {
            float _e97 = x;
            float _e98 = side;
            float _e99 = side;
            float _e100 = x;
            float _e102 = x;
            float _e105 = x;
            float _e109 = slope;
            x = (_e97 + ((_e98 * (_e99 - ((((_e100 + trace) * _e102) + determinant_) * _e105))) / _e109));
            float _e112 = x;
            float _e114 = x;
            side = (((_e112 + aside) * _e114) + last);
            float _e117 = x;
            float _e121 = x;
            float _e129 = x;
            float _e135 = x;
            slope = (((((((((_e117 + (2.0 * aside)) * _e121) + (3.0 * last)) + (trace * aside)) - determinant_) * _e129) + ((2.0 * trace) * last)) * _e135) + (determinant_ * last));
        }
    }
    float _e143 = x;
    vec3 inverse_ = (vec3(1.0) / ((size * shape) + vec3(_e143)));
    float _e152 = x;
    float towards = ((size * dot(l, (inverse_ * bent))) / (_e152 * dot(l, (inverse_ * l))));
    vec3 axis_1 = normalize((inverse_ * (h + (towards * l))));
    float cosine_11 = dot(view, axis_1);
    vec3 lit = (((2.0 * cosine_11) * axis_1) - view);
    float facing_1 = max(lit.z, 0.0);
    float _e169 = side;
    float _e170 = x;
    float _e171 = slope;
    float lobe_1 = ((sqrt((_e169 / (((_e170 * _e171) * bend) * dot(axis_1, (shape * axis_1))))) * shape.z) / (3.1415927 * bend));
    float share_3 = (pow(left_1, 1.25) * (1.0 - (0.5 * above)));
    float _e191 = octagloss_masking_of(view, alpha_1);
    float _e194 = octagloss_masking_of(lit, alpha_1);
    float visible = (facing_1 / ((facing_1 * _e191) + (view.z * _e194)));
    float _e205 = octagloss_fresnel_of(cosine_11);
    return vec2(((((((share_3 * 2.0) * along_1) * cosine_11) / length2_) * lobe_1) * visible), _e205);
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_cosine_light(uint probe_10, vec3 n) {
#else
vec3 octagloss_cosine_light(uint probe_11, vec3 n) {
#endif
    vec3 _e2 = octagloss_place_of(n);
#ifdef OCTAGLOSS_CUBE
    vec3 _e3 = octagloss_read_cosine(probe_10, _e2);
#else
    vec3 _e3 = octagloss_read_cosine(probe_11, _e2);
#endif
    return _e3;
}

mat2x3 octagloss_weighed(vec3 light_1, vec2 weights_2) {
    return mat2x3((light_1 * weights_2.x), (light_1 * weights_2.y));
}

#ifdef OCTAGLOSS_CUBE
mat2x3 octagloss_harmonics_reflected(uint probe_11, octagloss_SurfaceFrame surface, vec4 pairs[8]) {
#else
mat2x3 octagloss_harmonics_reflected(uint probe_12, octagloss_SurfaceFrame surface, vec4 pairs[8]) {
#endif
    vec3 n_1 = surface.normal;
    vec3 t_1 = surface.towards;
    float _e5[25] = octagloss_harmonic_basis(n_1);
#ifdef OCTAGLOSS_CUBE
    vec3 _e6[5] = octagloss_orders_of(probe_11, _e5);
#else
    vec3 _e6[5] = octagloss_orders_of(probe_12, _e5);
#endif
    float _e12[25] = octagloss_harmonic_basis(((n_1 * 0.309017) + (t_1 * 0.95105654)));
#ifdef OCTAGLOSS_CUBE
    vec3 _e13[5] = octagloss_orders_of(probe_11, _e12);
#else
    vec3 _e13[5] = octagloss_orders_of(probe_12, _e12);
#endif
    float _e19[25] = octagloss_harmonic_basis(((n_1 * -0.809017) + (t_1 * 0.58778524)));
#ifdef OCTAGLOSS_CUBE
    vec3 _e20[5] = octagloss_orders_of(probe_11, _e19);
#else
    vec3 _e20[5] = octagloss_orders_of(probe_12, _e19);
#endif
    float _e26[25] = octagloss_harmonic_basis(((n_1 * 0.809017) + (t_1 * 0.58778524)));
#ifdef OCTAGLOSS_CUBE
    vec3 _e27[5] = octagloss_orders_of(probe_11, _e26);
#else
    vec3 _e27[5] = octagloss_orders_of(probe_12, _e26);
#endif
    float _e33[25] = octagloss_harmonic_basis(((n_1 * -0.309017) + (t_1 * 0.95105654)));
#ifdef OCTAGLOSS_CUBE
    vec3 _e34[5] = octagloss_orders_of(probe_11, _e33);
#else
    vec3 _e34[5] = octagloss_orders_of(probe_12, _e33);
#endif
    mat2x3 _e38 = octagloss_weighed(_e6[0], pairs[0].xy);
    mat2x3 _e42 = octagloss_weighed(_e6[1], pairs[0].zw);
    mat2x3 _e47 = octagloss_weighed(_e6[2], pairs[1].xy);
    mat2x3 _e52 = octagloss_weighed(_e6[3], pairs[1].zw);
    mat2x3 _e57 = octagloss_weighed(_e6[4], pairs[2].xy);
    mat2x3 _e62 = octagloss_weighed(_e13[1], pairs[2].zw);
    mat2x3 _e67 = octagloss_weighed(_e13[2], pairs[3].xy);
    mat2x3 _e72 = octagloss_weighed(_e13[3], pairs[3].zw);
    mat2x3 _e77 = octagloss_weighed(_e13[4], pairs[4].xy);
    mat2x3 _e82 = octagloss_weighed(_e20[2], pairs[4].zw);
    mat2x3 _e87 = octagloss_weighed(_e20[3], pairs[5].xy);
    mat2x3 _e92 = octagloss_weighed(_e20[4], pairs[5].zw);
    mat2x3 _e97 = octagloss_weighed(_e27[3], pairs[6].xy);
    mat2x3 _e102 = octagloss_weighed(_e27[4], pairs[6].zw);
    mat2x3 _e107 = octagloss_weighed(_e34[4], pairs[7].xy);
    return ((((((((((((((_e38 + _e42) + _e47) + _e52) + _e57) + _e62) + _e67) + _e72) + _e77) + _e82) + _e87) + _e92) + _e97) + _e102) + _e107);
}

float octagloss_map_inner() {
#ifdef OCTAGLOSS_CUBE
    return float(uvec2(textureSize(octagloss_maps, 0).xy).x);
#else
    uint _e1 = octagloss_map_octave();
    return float((1u << _e1));
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_suns_reflected(uint probe_12, octagloss_SurfaceFrame surface_1, vec2 tangent, vec2 alpha_2, vec3 f0_, float f90_) {
#else
vec3 octagloss_suns_reflected(uint probe_13, octagloss_SurfaceFrame surface_1, vec2 tangent, vec2 alpha_2, vec3 f0_, float f90_) {
#endif
    vec3 sum_2 = vec3(0.0);
    uint disc_2 = 0u;
    uint c = 0u;
    vec3 across_2 = cross(surface_1.normal, surface_1.towards);
    vec3 x_2 = ((surface_1.towards * tangent.x) + (across_2 * tangent.y));
    vec3 y_1 = ((across_2 * tangent.x) - (surface_1.towards * tangent.y));
    vec3 view_5 = vec3((surface_1.sine * tangent.x), (-(surface_1.sine) * tangent.y), surface_1.cosine);
    float _e30 = octagloss_map_inner();
    vec2 wide = max(alpha_2, vec2((0.9 / _e30)));
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e105 = disc_2;
            disc_2 = (_e105 + 1u);
        }
        loop_init_5 = false;
        uint _e39 = disc_2;
        if ((_e39 < 16u)) {
        } else {
            break;
        }
        {
            uint _e45 = disc_2;
#ifdef OCTAGLOSS_CUBE
            OctaglossSun sun_2 = octagloss_lights[probe_12].suns[(_e45 / 2u)];
#else
            OctaglossSun sun_2 = octagloss_lights[probe_13].suns[(_e45 / 2u)];
#endif
            uint _e50 = disc_2;
#ifdef OCTAGLOSS_CUBE
            vec3 _e51 = octagloss_half_axis_of(probe_12, _e50);
#else
            vec3 _e51 = octagloss_half_axis_of(probe_13, _e50);
#endif
            float _e52 = octagloss_squared(_e51);
            float nearer_1 = (1.0 - (0.5 * _e52));
            c = 0u;
            bool loop_init_6 = true;
            while(true) {
                if (!loop_init_6) {
                    uint _e102 = c;
                    c = (_e102 + 1u);
                }
                loop_init_6 = false;
                uint _e59 = c;
                if ((_e59 < 3u)) {
                } else {
                    break;
                }
                {
                    uint _e62 = c;
                    bvec3 own = equal(uvec3(_e62), uvec3(0u, 1u, 2u));
                    vec4 channel = (own.x ? sun_2.red : (own.y ? sun_2.green : sun_2.blue));
                    vec3 to_1 = ((nearer_1 * channel.xyz) + _e51);
                    vec3 light_2 = vec3(dot(to_1, x_2), dot(to_1, y_1), dot(to_1, surface_1.normal));
                    vec2 _e85 = octagloss_brdf_around(view_5, light_2, wide, channel.w);
                    vec3 reflected = (((0.5 * sun_2.energy) * _e85.x) * (f0_ + ((vec3(f90_) - f0_) * _e85.y)));
                    vec3 _e97 = sum_2;
                    sum_2 = (_e97 + mix(vec3(0.0), reflected, own));
                }
            }
        }
    }
    vec3 _e107 = sum_2;
    return _e107;
}

vec2 octagloss_albedo_share(vec2 albedo, vec2 sums) {
    return ((albedo + vec2(0.0001)) / (max(sums, vec2(0.0)) + vec2(0.0001)));
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_lit_of(uint probe_13, mat2x3 sum_3, vec3 f0_1, float f90_1) {
    float _e14 = octagloss_lights[probe_13].unscale;
#else
vec3 octagloss_lit_of(uint probe_14, mat2x3 sum_3, vec3 f0_1, float f90_1) {
    float _e14 = octagloss_lights[probe_14].unscale;
#endif
    return (max(((f0_1 * sum_3[0]) + (f90_1 * sum_3[1])), vec3(0.0)) * _e14);
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_reflected_isotropic(uint probe_14, octagloss_SurfaceFrame surface_2, float roughness_4, vec2 albedo_1, vec3 f0_2, float f90_2) {
#else
vec3 octagloss_reflected_isotropic(uint probe_15, octagloss_SurfaceFrame surface_2, float roughness_4, vec2 albedo_1, vec3 f0_2, float f90_2) {
#endif
    mat2x3 sum_4 = mat2x3(0.0);
    vec2 white = vec2(0.0);
    uint reads = octagloss_READS;
    float in_mirror = 0.0;
    uint k_2 = 0u;
    vec3 n_2 = surface_2.normal;
    float cosine_12 = surface_2.cosine;
    vec3 along_2 = (surface_2.towards * surface_2.sine);
    vec3 v_1 = (along_2 + (n_2 * cosine_12));
    vec4 _e14 = octagloss_reflection_node(octagloss_READS, roughness_4, cosine_12);
    vec4 _e16 = octagloss_reflection_node(11u, roughness_4, cosine_12);
    vec4 _e18 = octagloss_reflection_node(12u, roughness_4, cosine_12);
    vec4 _e20 = octagloss_reflection_node(13u, roughness_4, cosine_12);
    vec4 _e22 = octagloss_reflection_node(14u, roughness_4, cosine_12);
    vec4 _e24 = octagloss_reflection_node(15u, roughness_4, cosine_12);
    vec4 _e26 = octagloss_reflection_node(16u, roughness_4, cosine_12);
    vec4 _e28 = octagloss_reflection_node(17u, roughness_4, cosine_12);
    vec4 pairs_1[8] = vec4[8](_e14, _e16, _e18, _e20, _e22, _e24, _e26, _e28);
#ifdef OCTAGLOSS_CUBE
    mat2x3 _e30 = octagloss_harmonics_reflected(probe_14, surface_2, pairs_1);
#else
    mat2x3 _e30 = octagloss_harmonics_reflected(probe_15, surface_2, pairs_1);
#endif
    sum_4 = _e30;
    white = (pairs_1[0].xy + pairs_1[7].zw);
    if ((roughness_4 > octagloss_COSINE_FROM)) {
        mat2x3 _e42 = sum_4;
#ifdef OCTAGLOSS_CUBE
        vec3 _e43 = octagloss_cosine_light(probe_14, n_2);
#else
        vec3 _e43 = octagloss_cosine_light(probe_15, n_2);
#endif
        mat2x3 _e46 = octagloss_weighed(_e43, pairs_1[7].zw);
        sum_4 = (_e42 + _e46);
        uint _e48 = reads;
        reads = (_e48 - 1u);
    }
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e90 = k_2;
            k_2 = (_e90 + 1u);
        }
        loop_init_7 = false;
        uint _e55 = k_2;
        uint _e56 = reads;
        if ((_e55 < _e56)) {
        } else {
            break;
        }
        {
            uint _e58 = k_2;
            vec4 _e59 = octagloss_reflection_node(_e58, roughness_4, cosine_12);
            vec3 half_vector = normalize((n_2 + (_e59.x * along_2)));
            vec3 direction_5 = ((half_vector * (2.0 * dot(v_1, half_vector))) - v_1);
            mat2x3 _e69 = sum_4;
#ifdef OCTAGLOSS_CUBE
            vec3 _e71 = octagloss_between_levels(probe_14, direction_5, _e59.y);
#else
            vec3 _e71 = octagloss_between_levels(probe_15, direction_5, _e59.y);
#endif
            mat2x3 _e73 = octagloss_weighed(_e71, _e59.zw);
            sum_4 = (_e69 + _e73);
            vec2 _e75 = white;
            white = (_e75 + _e59.zw);
            float _e78 = in_mirror;
            in_mirror = (_e78 + ((_e59.z + _e59.w) * max((1.0 - _e59.y), 0.0)));
        }
    }
    vec2 _e92 = white;
    vec2 _e93 = octagloss_albedo_share(albedo_1, _e92);
    mat2x3 _e94 = sum_4;
#ifdef OCTAGLOSS_CUBE
    vec3 _e99 = octagloss_lit_of(probe_14, _e94, (f0_2 * _e93.x), (f90_2 * _e93.y));
#else
    vec3 _e99 = octagloss_lit_of(probe_15, _e94, (f0_2 * _e93.x), (f90_2 * _e93.y));
#endif
    float _e100 = in_mirror;
    float _e102 = white.x;
    float _e104 = white.y;
    float share_4 = max((1.0 - (_e100 / (_e102 + _e104))), 0.0);
    vec2 alpha_11 = vec2((roughness_4 * roughness_4));
#ifdef OCTAGLOSS_CUBE
    vec3 _e116 = octagloss_suns_reflected(probe_14, surface_2, vec2(1.0, 0.0), alpha_11, f0_2, f90_2);
#else
    vec3 _e116 = octagloss_suns_reflected(probe_15, surface_2, vec2(1.0, 0.0), alpha_11, f0_2, f90_2);
#endif
    return (_e99 + (share_4 * _e116));
}

#ifdef OCTAGLOSS_CUBE
octagloss_SurfaceFrame octagloss_surface_of(uint probe_15, vec3 normal_2, vec3 view_1) {
#else
octagloss_SurfaceFrame octagloss_surface_of(uint probe_16, vec3 normal_2, vec3 view_1) {
#endif
    vec3 level_view = vec3(0.0);
#ifdef OCTAGLOSS_CUBE
    vec3 _e3 = octagloss_source_from_world(probe_15, normal_2);
    vec3 _e4 = octagloss_source_from_world(probe_15, view_1);
#else
    vec3 _e3 = octagloss_source_from_world(probe_16, normal_2);
    vec3 _e4 = octagloss_source_from_world(probe_16, view_1);
#endif
    float cosine_13 = clamp(dot(_e3, _e4), octagloss_LEAST_COSINE, 1.0);
    level_view = (_e4 - (_e3 * dot(_e3, _e4)));
    vec3 _e13 = level_view;
    vec3 _e14 = level_view;
    if ((dot(_e13, _e14) < 1e-10)) {
        level_view = ((abs(_e3.x) > 0.5) ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0));
    }
    vec3 _e31 = level_view;
    vec3 _e32 = level_view;
    vec3 towards_1 = normalize((_e31 - (_e3 * dot(_e3, _e32))));
    return octagloss_SurfaceFrame(_e3, towards_1, cosine_13, sqrt((1.0 - (cosine_13 * cosine_13))));
}

vec3 octagloss_reflect_isotropic(vec3 normal_3, vec3 view_2, float roughness_5, vec3 f0_3, float f90_3) {
    octagloss_SurfaceFrame _e6 = octagloss_surface_of(0u, normal_3, view_2);
    vec2 _e9 = octagloss_round_albedo(_e6.cosine, roughness_5);
    vec3 _e10 = octagloss_reflected_isotropic(0u, _e6, roughness_5, _e9, f0_3, f90_3);
    return _e10;
}

vec2 octagloss_row_alphas(float roughness_6, float anisotropy) {
    float alpha_12 = (roughness_6 * roughness_6);
    return vec2((alpha_12 + (((1.0 - alpha_12) * anisotropy) * anisotropy)), alpha_12);
}

float octagloss_row_share(vec2 alpha_3) {
    return smoothstep(0.0, 1.0, ((alpha_3.x - alpha_3.y) / (octagloss_BLEND * max(alpha_3.y, 1e-6))));
}

vec4 octagloss_row_places(vec2 alpha_4, float cosine_3, vec2 tangent_1) {
    float sharp = max(alpha_4.y, octagloss_ROW_SHARP);
    float azimuth = (atan(abs(tangent_1.y), abs(tangent_1.x)) * 0.63661975);
    vec4 places_1 = vec4((log2((1.0 + (5.0 * sqrt(alpha_4.y)))) * 0.3868528), sqrt(cosine_3), (1.0 - pow(max((1.0 - azimuth), 0.0), 0.6666667)), (log2((max(alpha_4.x, sharp) / sharp)) / -(log2(min(sharp, 0.999999)))));
    return clamp(places_1, vec4(0.0), vec4(1.0));
}

octagloss_RowPlace octagloss_row_place(vec2 alpha_5, float cosine_4, vec2 tangent_2) {
    vec4 _e3 = octagloss_row_places(alpha_5, cosine_4, tangent_2);
#ifdef OCTAGLOSS_CUBE
    vec4 place_5 = (_e3 * vec4(15.0, 9.0, 7.0, 6.0));
    float lower = min(floor(place_5.w), 5.0);
    vec2 inside_1 = clamp(place_5.xy, vec2(0.00390625), (vec2(15.0, 9.0) - vec2(0.00390625)));
    vec3 texel_1 = (vec3(inside_1.x, (inside_1.y + (10.0 * lower)), place_5.z) + vec3(0.5));
    return octagloss_RowPlace((texel_1 / octagloss_ROW_SIZE), (place_5.w - lower));
#else
    vec4 place_6 = (_e3 * vec4(15.0, 9.0, 7.0, 6.0));
    float lower = min(floor(place_6.w), 5.0);
    vec2 inside_1 = clamp(place_6.xy, vec2(0.00390625), (vec2(15.0, 9.0) - vec2(0.00390625)));
    vec3 texel_1 = (vec3(inside_1.x, (inside_1.y + (10.0 * lower)), place_6.z) + vec3(0.5));
    return octagloss_RowPlace((texel_1 / octagloss_ROW_SIZE), (place_6.w - lower));
#endif
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_read_rows(vec3 at_4) {
    vec4 _e4 = textureLod(octagloss_rows, vec3(at_4), 0.0);
#else
vec4 octagloss_read_rows(vec3 at_5) {
    vec4 _e4 = textureLod(octagloss_rows, vec3(at_5), 0.0);
#endif
    return _e4;
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_row_node(uint layer_2, octagloss_RowPlace place) {
    vec3 at_7 = vec3((place.at.x + (float(layer_2) / 21.0)), place.at.yz);
    vec4 _e11 = octagloss_read_rows(at_7);
    vec4 _e18 = octagloss_read_rows(vec3(at_7.x, (at_7.y + 0.10989011), at_7.z));
#else
vec4 octagloss_row_node(uint layer_3, octagloss_RowPlace place) {
    vec3 at_8 = vec3((place.at.x + (float(layer_3) / 21.0)), place.at.yz);
    vec4 _e11 = octagloss_read_rows(at_8);
    vec4 _e18 = octagloss_read_rows(vec3(at_8.x, (at_8.y + 0.10989011), at_8.z));
#endif
    return mix(_e11, _e18, place.share);
}

vec3 octagloss_blend_at(vec2 place_1, vec2 nodes, float column) {
    vec2 inside_2 = clamp(place_1, vec2(0.00390625), ((nodes - vec2(1.0)) - vec2(0.00390625)));
    return ((vec3((column + inside_2.x), (inside_2.y + 70.0), 0.0) + vec3(0.5)) / octagloss_ROW_SIZE);
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_blend_texel(vec3 at_5, uint layer_3) {
    vec4 _e9 = octagloss_read_rows((at_5 + vec3(0.0, 0.0, (float(layer_3) / 8.0))));
#else
vec4 octagloss_blend_texel(vec3 at_6, uint layer_4) {
    vec4 _e9 = octagloss_read_rows((at_6 + vec3(0.0, 0.0, (float(layer_4) / 8.0))));
#endif
    return _e9;
}

vec2 octagloss_blend_place(float alpha_6, float cosine_5, vec2 nodes_1) {
    float x_3 = (log2((1.0 + (15.0 * sqrt(alpha_6)))) * 0.25);
    float y_2 = ((sqrt(sqrt(cosine_5)) - 0.31622776) / 0.6837722);
    return (clamp(vec2(x_3, y_2), vec2(0.0), vec2(1.0)) * (nodes_1 - vec2(1.0)));
}

#ifdef OCTAGLOSS_CUBE
vec2 octagloss_blend_of(vec2 first, vec3 shares, uint texels, vec3 blended, uint layer_4) {
#else
vec2 octagloss_blend_of(vec2 first, vec3 shares, uint texels, vec3 blended, uint layer_5) {
#endif
    vec2 sum_5 = vec2(0.0);
    uint k_3 = 0u;
    sum_5 = first;
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e42 = k_3;
            k_3 = (_e42 + 1u);
        }
        loop_init_8 = false;
        uint _e8 = k_3;
        if ((_e8 < texels)) {
        } else {
            break;
        }
        {
            uint _e10 = k_3;
            vec4 _e11 = octagloss_blend_texel(shares, _e10);
            uint _e13 = k_3;
#ifdef OCTAGLOSS_CUBE
            vec4 _e16 = octagloss_blend_texel(blended, (layer_4 + (2u * _e13)));
#else
            vec4 _e16 = octagloss_blend_texel(blended, (layer_5 + (2u * _e13)));
#endif
            uint _e18 = k_3;
#ifdef OCTAGLOSS_CUBE
            vec4 _e23 = octagloss_blend_texel(blended, ((layer_4 + (2u * _e18)) + 1u));
#else
            vec4 _e23 = octagloss_blend_texel(blended, ((layer_5 + (2u * _e18)) + 1u));
#endif
            vec2 _e24 = sum_5;
            sum_5 = (_e24 + ((((_e11.x * _e16.xy) + (_e11.y * _e16.zw)) + (_e11.z * _e23.xy)) + (_e11.w * _e23.zw)));
        }
    }
    vec2 _e44 = sum_5;
    return max(_e44, vec2(0.0));
}

vec2 octagloss_blended_albedo(vec2 alpha_7, float cosine_6, vec2 tangent_3) {
    vec2 squares = (alpha_7 * alpha_7);
    vec2 seen_1 = sqrt((vec2(squares.y) + (((squares.x - squares.y) * tangent_3) * tangent_3)));
    float round_ = min(((alpha_7.x * alpha_7.y) / max((seen_1.x * seen_1.y), 1e-12)), 1.0);
    vec2 _e26 = octagloss_blend_place(seen_1.x, cosine_6, octagloss_BLEND_ALBEDO_NODES);
    float block = min(floor((_e26.y / octagloss_BLEND_STRIP)), 2.0);
    vec2 size_1 = vec2(84.0, 21.0);
    vec3 _e43 = octagloss_blend_at((_e26 - vec2(0.0, (octagloss_BLEND_STRIP * block))), size_1, (84.0 * block));
    vec2 between = (vec2(sqrt(seen_1.y), round_) * vec2(48.0, 10.0));
    vec3 _e53 = octagloss_blend_at(between, octagloss_BLEND_SHARE_NODES, octagloss_BLEND_SHARES_AT);
    vec2 _e59 = octagloss_blend_of(vec2(1.0, 0.0), _e53, 4u, _e43, 0u);
    return _e59;
}

vec2 octagloss_blended_mean(vec2 alpha_8, float cosine_7) {
    vec2 _e4 = octagloss_blend_place(alpha_8.x, cosine_7, octagloss_BLEND_MEAN_NODES);
    vec3 _e7 = octagloss_blend_at(_e4, octagloss_BLEND_MEAN_NODES, octagloss_BLEND_SHARES_AT);
    float ratio = (sqrt((alpha_8.y / max(alpha_8.x, 1e-12))) * 32.0);
    vec2 size_2 = vec2(33.0, 21.0);
    vec3 _e22 = octagloss_blend_at(vec2(ratio, 0.0), size_2, octagloss_BLEND_RATIOS_AT);
    vec2 _e25 = octagloss_round_albedo(cosine_7, sqrt(alpha_8.x));
    vec2 _e28 = octagloss_blend_of(_e25, _e22, 2u, _e7, 4u);
    return _e28;
}

float octagloss_row_number(vec4 terms[3], vec4 a, vec4 b_1, vec4 c_1) {
    return ((dot(terms[0], a) + dot(terms[1], b_1)) + dot(terms[2], c_1));
}

octagloss_Row octagloss_row_of(vec2 alpha_9, vec2 tangent_4, float cosine_8) {
    vec2 axis = vec2(1.0, 0.0);
    vec2 squares_1 = (alpha_9 * alpha_9);
    float difference = (squares_1.x - squares_1.y);
    float along_3 = (squares_1.y + ((difference * tangent_4.x) * tangent_4.x));
    float across_3 = (((squares_1.y + ((difference * tangent_4.y) * tangent_4.y)) * cosine_8) * cosine_8);
    float mixed = (((difference * tangent_4.x) * tangent_4.y) * cosine_8);
    float apart_1 = (0.5 * (along_3 - across_3));
    float root_1 = length(vec2(apart_1, mixed));
    float greatest = max(((0.5 * (along_3 + across_3)) + root_1), 1e-30);
    if ((root_1 > 0.0)) {
        vec2 steep = vec2(abs(mixed), ((root_1 - apart_1) * ((mixed >= 0.0) ? 1.0 : -1.0)));
        axis = normalize((((apart_1 >= 0.0) ? vec2((apart_1 + root_1), mixed) : steep) / vec2(root_1)));
    }
    float x_4 = log(max((((alpha_9.x * alpha_9.y) * cosine_8) / greatest), octagloss_NARROWEST));
    float extent = sqrt(greatest);
    float y_3 = log((1.0 + (6.0 * extent)));
    float _e75 = axis.x;
    float tilt = (_e75 * smoothstep(0.0, octagloss_TILTED, sqrt((1.0 - (cosine_8 * cosine_8)))));
    float _e85 = axis.x;
    float e_1 = (_e85 * tilt);
    vec4 terms_1[3] = vec4[3](vec4(1.0, x_4, (x_4 * x_4), y_3), vec4((x_4 * y_3), (y_3 * y_3), e_1, (e_1 * x_4)), vec4(((x_4 * x_4) * x_4), ((y_3 * y_3) * y_3), ((x_4 * x_4) * y_3), ((x_4 * y_3) * y_3)));
    float _e119 = octagloss_row_number(terms_1, vec4(-0.55, -0.357, -0.024, -0.112), vec4(-0.155, -0.099, 0.179, -0.206), vec4(-0.04, 0.145, -0.024, -0.063));
    float _e135 = octagloss_row_number(terms_1, vec4(-0.554, -0.031, 0.533, -0.071), vec4(0.392, 0.14, -0.295, 0.008), vec4(0.133, 0.121, 0.231, 0.259));
    float _e151 = octagloss_row_number(terms_1, vec4(-0.215, 0.021, 0.069, -0.271), vec4(0.356, 0.057, -0.463, -0.223), vec4(0.047, 0.086, 0.153, 0.094));
    float _e167 = octagloss_row_number(terms_1, vec4(0.55, 1.256, -0.003, -0.371), vec4(-0.377, -0.126, -0.001, 0.019), vec4(-0.02, 0.034, -0.066, -0.01));
    float _e183 = octagloss_row_number(terms_1, vec4(-0.516, 0.484, 0.15, 0.012), vec4(-0.583, 0.111, -0.02, -0.968), vec4(0.055, -0.352, -0.216, -0.214));
    float _e199 = octagloss_row_number(terms_1, vec4(0.5, 0.259, -0.071, -0.267), vec4(-0.373, -0.066, -0.039, -0.122), vec4(-0.014, -0.027, -0.072, -0.048));
    float _e201 = axis.x;
    float _e203 = axis.y;
    float _e216 = axis.x;
    return octagloss_Row((vec2(_e201, (_e203 / cosine_8)) * sqrt((2.0 * root_1))), extent, (_e119 * tilt), exp(vec4(_e135, _e151, _e167, _e183)), exp(_e199), smoothstep(0.0, octagloss_SKEWED, _e216));
}

float octagloss_last_map() {
#ifdef OCTAGLOSS_CUBE
    float _e0 = octagloss_map_inner();
    return (log2(_e0) - 3.0);
#else
    uint _e0 = octagloss_map_octave();
    return (1.0 + floor(((float(_e0) - 3.237039) / octagloss_LEVEL_OCTAVES)));
#endif
}

vec2 octagloss_row_read(octagloss_Row row_1, uint read) {
#ifdef OCTAGLOSS_CUBE
    float place_6 = (((float(read) - 7.0) * 0.5714286) + row_1.shift);
    float slope_1 = (((row_1.steps.z * row_1.steps.x) * sinh((row_1.steps.y * place_6))) / row_1.steps.y);
#else
    float place_7 = (((float(read) - 7.0) * 0.5714286) + row_1.shift);
    float slope_1 = (((row_1.steps.z * row_1.steps.x) * sinh((row_1.steps.y * place_7))) / row_1.steps.y);
#endif
    float wider = (((read % 2u) == 1u) ? row_1.alternation : (1.0 / row_1.alternation));
    float growth = (row_1.steps.w * slope_1);
    float width = (((wider * row_1.steps.z) * sqrt((1.0 + (growth * growth)))) * row_1.extent);
    float _e44 = octagloss_last_map();
    float _e45 = octagloss_map_inner();
    float widest = log2((_e45 * 0.19444445));
    float octaves = (widest + log2((max(width, 1e-9) / 0.35)));
    float gaussian = (_e44 + ((octaves - widest) / octagloss_LEVEL_OCTAVES));
    float below = max((octaves / (widest - ((_e44 - 1.0) * octagloss_LEVEL_OCTAVES))), 0.0);
    return vec2(slope_1, ((gaussian >= 1.0) ? min(gaussian, _e44) : below));
}

#ifdef OCTAGLOSS_CUBE
vec3[5] octagloss_orders_aside(uint probe_16, octagloss_SurfaceFrame surface_3, vec3 across, vec3 d_2) {
#else
vec3[5] octagloss_orders_aside(uint probe_17, octagloss_SurfaceFrame surface_3, vec3 across, vec3 d_2) {
#endif
    vec3 level_2 = ((surface_3.towards * d_2.x) + (surface_3.normal * d_2.z));
    float _e14[25] = octagloss_harmonic_basis((level_2 + (across * d_2.y)));
    float _e18[25] = octagloss_harmonic_basis((level_2 - (across * d_2.y)));
    float difference_1[25] = float[25]((_e14[0] - _e18[0]), (_e14[1] - _e18[1]), (_e14[2] - _e18[2]), (_e14[3] - _e18[3]), (_e14[4] - _e18[4]), (_e14[5] - _e18[5]), (_e14[6] - _e18[6]), (_e14[7] - _e18[7]), (_e14[8] - _e18[8]), (_e14[9] - _e18[9]), (_e14[10] - _e18[10]), (_e14[11] - _e18[11]), (_e14[12] - _e18[12]), (_e14[13] - _e18[13]), (_e14[14] - _e18[14]), (_e14[15] - _e18[15]), (_e14[16] - _e18[16]), (_e14[17] - _e18[17]), (_e14[18] - _e18[18]), (_e14[19] - _e18[19]), (_e14[20] - _e18[20]), (_e14[21] - _e18[21]), (_e14[22] - _e18[22]), (_e14[23] - _e18[23]), (_e14[24] - _e18[24]));
#ifdef OCTAGLOSS_CUBE
    vec3 _e95[5] = octagloss_orders_of(probe_16, difference_1);
#else
    vec3 _e95[5] = octagloss_orders_of(probe_17, difference_1);
#endif
    return _e95;
}

#ifdef OCTAGLOSS_CUBE
mat2x3 octagloss_harmonics_aside(uint probe_17, octagloss_SurfaceFrame surface_4, vec3 across_1, octagloss_RowPlace place_2, vec2 first_1) {
    vec3 _e9[5] = octagloss_orders_aside(probe_17, surface_4, across_1, vec3(0.4620342, 0.54655075, -0.6984316));
    vec3 _e14[5] = octagloss_orders_aside(probe_17, surface_4, across_1, vec3(0.8966183, 0.38650447, 0.21607853));
    vec3 _e19[5] = octagloss_orders_aside(probe_17, surface_4, across_1, vec3(0.11814805, 0.3835753, 0.91592085));
    vec3 _e24[5] = octagloss_orders_aside(probe_17, surface_4, across_1, vec3(0.14011177, 0.8172301, -0.5590202));
#else
mat2x3 octagloss_harmonics_aside(uint probe_18, octagloss_SurfaceFrame surface_4, vec3 across_1, octagloss_RowPlace place_2, vec2 first_1) {
    vec3 _e9[5] = octagloss_orders_aside(probe_18, surface_4, across_1, vec3(0.4620342, 0.54655075, -0.6984316));
    vec3 _e14[5] = octagloss_orders_aside(probe_18, surface_4, across_1, vec3(0.8966183, 0.38650447, 0.21607853));
    vec3 _e19[5] = octagloss_orders_aside(probe_18, surface_4, across_1, vec3(0.11814805, 0.3835753, 0.91592085));
    vec3 _e24[5] = octagloss_orders_aside(probe_18, surface_4, across_1, vec3(0.14011177, 0.8172301, -0.5590202));
#endif
    vec4 _e26 = octagloss_row_node(16u, place_2);
    vec4 _e28 = octagloss_row_node(17u, place_2);
    vec4 _e30 = octagloss_row_node(18u, place_2);
    vec4 _e32 = octagloss_row_node(19u, place_2);
    mat2x3 _e34 = octagloss_weighed(_e9[1], first_1);
    mat2x3 _e37 = octagloss_weighed(_e9[2], _e26.xy);
    mat2x3 _e41 = octagloss_weighed(_e9[3], _e26.zw);
    mat2x3 _e45 = octagloss_weighed(_e9[4], _e28.xy);
    mat2x3 _e49 = octagloss_weighed(_e14[2], _e28.zw);
    mat2x3 _e53 = octagloss_weighed(_e14[3], _e30.xy);
    mat2x3 _e57 = octagloss_weighed(_e14[4], _e30.zw);
    mat2x3 _e61 = octagloss_weighed(_e19[3], _e32.xy);
    mat2x3 _e65 = octagloss_weighed(_e19[4], _e32.zw);
    vec4 _e69 = octagloss_row_node(20u, place_2);
    mat2x3 _e71 = octagloss_weighed(_e24[4], _e69.xy);
    return (((((((((_e34 + _e37) + _e41) + _e45) + _e49) + _e53) + _e57) + _e61) + _e65) + _e71);
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_reflect_in_row(uint probe_18, octagloss_SurfaceFrame surface_5, vec2 tangent_5, vec2 alpha_10, vec2 albedo_2, vec3 f0_4, float f90_4) {
#else
vec3 octagloss_reflect_in_row(uint probe_19, octagloss_SurfaceFrame surface_5, vec2 tangent_5, vec2 alpha_10, vec2 albedo_2, vec3 f0_4, float f90_4) {
#endif
    mat2x3 sum_6 = mat2x3(0.0);
    vec2 in_mirror_1 = vec2(0.0);
    vec2 white_1 = vec2(0.0);
    uint distance_ = 0u;
    vec2 mean = vec2(0.0);
    vec2 skew = vec2(0.0);
    uint side_1 = 0u;
    vec3 n_3 = surface_5.normal;
    vec3 across_4 = cross(n_3, surface_5.towards);
    vec3 v_2 = ((surface_5.towards * surface_5.sine) + (n_3 * surface_5.cosine));
    octagloss_RowPlace _e17 = octagloss_row_place(alpha_10, surface_5.cosine, tangent_5);
    octagloss_Row _e19 = octagloss_row_of(alpha_10, tangent_5, surface_5.cosine);
    vec3 axis_2 = ((surface_5.towards * _e19.axis.x) + (across_4 * _e19.axis.y));
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e126 = distance_;
            distance_ = (_e126 + 1u);
        }
        loop_init_9 = false;
        uint _e36 = distance_;
        if ((_e36 <= octagloss_ROW_MIDDLE)) {
        } else {
            break;
        }
        {
            uint _e39 = distance_;
            vec4 _e40 = octagloss_row_node(_e39, _e17);
            mean = _e40.xy;
            skew = vec2(0.0);
            uint _e45 = distance_;
            if ((_e45 == 0u)) {
                mat2x3 _e48 = sum_6;
#ifdef OCTAGLOSS_CUBE
                vec3 _e49 = octagloss_cosine_light(probe_18, n_3);
#else
                vec3 _e49 = octagloss_cosine_light(probe_19, n_3);
#endif
                mat2x3 _e51 = octagloss_weighed(_e49, _e40.zw);
                sum_6 = (_e48 + _e51);
                vec2 _e53 = white_1;
                white_1 = (_e53 + _e40.zw);
            } else {
                mean = (0.5 * (_e40.xy + _e40.zw));
                skew = ((0.5 * _e19.skew) * (_e40.xy - _e40.zw));
            }
            side_1 = 0u;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e123 = side_1;
                    side_1 = (_e123 + 1u);
                }
                loop_init_10 = false;
                uint _e70 = side_1;
                uint _e71 = distance_;
                if ((_e70 < min((_e71 + 1u), 2u))) {
                } else {
                    break;
                }
                {
                    vec2 _e77 = mean;
                    vec2 _e78 = skew;
                    vec2 _e80 = mean;
                    vec2 _e81 = skew;
                    uint _e83 = side_1;
                    vec2 weights_3 = ((_e83 == 0u) ? (_e80 + _e81) : (_e77 - _e78));
                    uint _e88 = distance_;
                    uint _e91 = distance_;
                    uint _e93 = side_1;
                    vec2 _e97 = octagloss_row_read(_e19, ((_e93 == 0u) ? (octagloss_ROW_MIDDLE + _e91) : (octagloss_ROW_MIDDLE - _e88)));
                    vec3 half_vector_1 = normalize((n_3 + (_e97.x * axis_2)));
                    vec3 direction_6 = ((half_vector_1 * (2.0 * dot(v_2, half_vector_1))) - v_2);
                    mat2x3 _e107 = sum_6;
#ifdef OCTAGLOSS_CUBE
                    vec3 _e109 = octagloss_between_levels(probe_18, direction_6, _e97.y);
#else
                    vec3 _e109 = octagloss_between_levels(probe_19, direction_6, _e97.y);
#endif
                    mat2x3 _e110 = octagloss_weighed(_e109, weights_3);
                    sum_6 = (_e107 + _e110);
                    vec2 _e112 = white_1;
                    white_1 = (_e112 + weights_3);
                    vec2 _e114 = in_mirror_1;
                    in_mirror_1 = (_e114 + (weights_3 * max((1.0 - _e97.y), 0.0)));
                }
            }
        }
    }
    vec4 _e129 = octagloss_row_node(octagloss_ROW_PAIRS, _e17);
    vec4 _e131 = octagloss_row_node(9u, _e17);
    vec4 _e133 = octagloss_row_node(10u, _e17);
    vec4 _e135 = octagloss_row_node(11u, _e17);
    vec4 _e137 = octagloss_row_node(12u, _e17);
    vec4 _e139 = octagloss_row_node(13u, _e17);
    vec4 _e141 = octagloss_row_node(14u, _e17);
    vec4 _e143 = octagloss_row_node(15u, _e17);
    vec4 pairs_2[8] = vec4[8](_e129, _e131, _e133, _e135, _e137, _e139, _e141, _e143);
    mat2x3 _e145 = sum_6;
#ifdef OCTAGLOSS_CUBE
    mat2x3 _e146 = octagloss_harmonics_reflected(probe_18, surface_5, pairs_2);
#else
    mat2x3 _e146 = octagloss_harmonics_reflected(probe_19, surface_5, pairs_2);
#endif
    sum_6 = (_e145 + _e146);
    vec2 _e148 = white_1;
    white_1 = (_e148 + pairs_2[0].xy);
    vec3 mirrored = (across_4 * (((tangent_5.x * tangent_5.y) < 0.0) ? -1.0 : 1.0));
    mat2x3 _e161 = sum_6;
#ifdef OCTAGLOSS_CUBE
    mat2x3 _e164 = octagloss_harmonics_aside(probe_18, surface_5, mirrored, _e17, pairs_2[7].zw);
#else
    mat2x3 _e164 = octagloss_harmonics_aside(probe_19, surface_5, mirrored, _e17, pairs_2[7].zw);
#endif
    sum_6 = (_e161 + _e164);
    vec2 _e166 = white_1;
    vec2 shares_1 = (albedo_2 / _e166);
    mat2x3 _e168 = sum_6;
#ifdef OCTAGLOSS_CUBE
    vec3 _e173 = octagloss_lit_of(probe_18, _e168, (f0_4 * shares_1.x), (f90_4 * shares_1.y));
#else
    vec3 _e173 = octagloss_lit_of(probe_19, _e168, (f0_4 * shares_1.x), (f90_4 * shares_1.y));
#endif
    vec2 _e174 = in_mirror_1;
    float share_5 = max((1.0 - (dot(shares_1, _e174) / (albedo_2.x + albedo_2.y))), 0.0);
#ifdef OCTAGLOSS_CUBE
    vec3 _e184 = octagloss_suns_reflected(probe_18, surface_5, tangent_5, alpha_10, f0_4, f90_4);
#else
    vec3 _e184 = octagloss_suns_reflected(probe_19, surface_5, tangent_5, alpha_10, f0_4, f90_4);
#endif
    return (_e173 + (share_5 * _e184));
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_reflect_of(uint probe_19, vec3 normal_4, vec3 view_3, vec3 tangent_6, float roughness_7, float anisotropy_1, vec3 f0_5, float f90_5) {
#else
vec3 octagloss_reflect_of(uint probe_20, vec3 normal_4, vec3 view_3, vec3 tangent_6, float roughness_7, float anisotropy_1, vec3 f0_5, float f90_5) {
#endif
    vec2 level_1 = vec2(0.0);
    bool local = false;
#ifdef OCTAGLOSS_CUBE
    octagloss_SurfaceFrame _e8 = octagloss_surface_of(probe_19, normal_4, view_3);
#else
    octagloss_SurfaceFrame _e8 = octagloss_surface_of(probe_20, normal_4, view_3);
#endif
    if ((anisotropy_1 > 0.0)) {
        local = (dot(tangent_6, tangent_6) > 0.0);
    } else {
        local = false;
    }
    bool _e19 = local;
    if (_e19) {
#ifdef OCTAGLOSS_CUBE
        vec3 _e20 = octagloss_source_from_world(probe_19, tangent_6);
#else
        vec3 _e20 = octagloss_source_from_world(probe_20, tangent_6);
#endif
        vec3 across_5 = cross(_e8.normal, _e8.towards);
        level_1 = vec2(dot(_e20, _e8.towards), dot(_e20, across_5));
    }
    vec2 _e28 = level_1;
    vec2 _e29 = level_1;
    if ((dot(_e28, _e29) < 1e-10)) {
        vec2 _e34 = octagloss_round_albedo(_e8.cosine, roughness_7);
#ifdef OCTAGLOSS_CUBE
        vec3 _e35 = octagloss_reflected_isotropic(probe_19, _e8, roughness_7, _e34, f0_5, f90_5);
#else
        vec3 _e35 = octagloss_reflected_isotropic(probe_20, _e8, roughness_7, _e34, f0_5, f90_5);
#endif
        return _e35;
    }
    vec2 _e38 = octagloss_row_alphas(roughness_7, min(anisotropy_1, 1.0));
    float _e39 = octagloss_row_share(_e38);
    vec2 _e40 = level_1;
    vec2 unit_level = normalize(_e40);
    vec2 _e43 = octagloss_blended_albedo(_e38, _e8.cosine, unit_level);
#ifdef OCTAGLOSS_CUBE
    vec3 _e44 = octagloss_reflect_in_row(probe_19, _e8, unit_level, _e38, _e43, f0_5, f90_5);
#else
    vec3 _e44 = octagloss_reflect_in_row(probe_20, _e8, unit_level, _e38, _e43, f0_5, f90_5);
#endif
    vec3 sum_7 = (_e39 * _e44);
    if ((_e39 == 1.0)) {
        return sum_7;
    }
    float round_1 = sqrt(sqrt((_e38.x * _e38.y)));
#ifdef OCTAGLOSS_CUBE
    vec3 _e55 = octagloss_reflected_isotropic(probe_19, _e8, round_1, _e43, f0_5, f90_5);
#else
    vec3 _e55 = octagloss_reflected_isotropic(probe_20, _e8, round_1, _e43, f0_5, f90_5);
#endif
    return (sum_7 + ((1.0 - _e39) * _e55));
}

vec3 octagloss_reflect(vec3 normal_5, vec3 view_4, vec3 tangent_7, float roughness_8, float anisotropy_2, vec3 f0_6, float f90_6) {
    vec3 _e8 = octagloss_reflect_of(0u, normal_5, view_4, tangent_7, roughness_8, anisotropy_2, f0_6, f90_6);
    return _e8;
}

vec2 octagloss_albedo(float cosine_9, float roughness_9, float anisotropy_3) {
    if ((anisotropy_3 <= 0.0)) {
        vec2 _e5 = octagloss_round_albedo(cosine_9, roughness_9);
        return _e5;
    }
    vec2 _e8 = octagloss_row_alphas(roughness_9, min(anisotropy_3, 1.0));
    vec2 _e12 = octagloss_blended_mean(_e8, clamp(cosine_9, octagloss_LEAST_COSINE, 1.0));
    return _e12;
}

vec2 octagloss_albedo_along(float cosine_10, float along, float roughness_10, float anisotropy_4) {
    if ((anisotropy_4 <= 0.0)) {
        vec2 _e6 = octagloss_round_albedo(cosine_10, roughness_10);
        return _e6;
    }
    float seen_2 = clamp(cosine_10, octagloss_LEAST_COSINE, 1.0);
    float x_5 = min((abs(along) / max(sqrt((1.0 - (seen_2 * seen_2))), 0.0001)), 1.0);
    vec2 _e22 = octagloss_row_alphas(roughness_10, min(anisotropy_4, 1.0));
    vec2 _e28 = octagloss_blended_albedo(_e22, seen_2, vec2(x_5, sqrt((1.0 - (x_5 * x_5)))));
    return _e28;
}
