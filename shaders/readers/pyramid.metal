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
// Metal; the resources are arguments of each function.
// language: metal1.0
#include <metal_stdlib>
#include <simd/simd.h>

using metal::uint;

struct OctaglossSun {
    metal::float4 red;
    metal::float4 green;
    metal::float4 blue;
    metal::packed_float3 energy;
    float pad;
};
struct type_5 {
    metal::float4 inner[25];
};
struct type_6 {
    OctaglossSun inner[8];
};
struct OctaglossLight {
    metal::float3x3 world_from_source;
    float scale;
    float unscale;
    float clamp;
    float pad;
    type_5 harmonics;
    type_6 suns;
    char _pad7[48];
};
struct type_7 {
    OctaglossLight inner[1];
};
struct type_12 {
    float inner[25];
};
struct type_13 {
    metal::float3 inner[5];
};
struct type_14 {
    float inner[5];
};
typedef metal::float3 octagloss_MapPlace;
struct type_15 {
    metal::float4 inner[5];
};
#ifdef OCTAGLOSS_CUBE
struct type_17 {
#else
struct type_18 {
#endif
    float inner[10];
};
struct octagloss_SurfaceFrame {
    metal::float3 normal;
    metal::packed_float3 towards;
    float cosine;
    float sine;
    char _pad4[12];
};
struct type_20 {
    metal::float4 inner[8];
};
struct octagloss_RowPlace {
    metal::packed_float3 at;
    float share;
};
struct octagloss_Row {
    metal::float2 axis;
    float extent;
    float shift;
    metal::float4 steps;
    float alternation;
    float skew;
    char _pad6[8];
};
struct type_22 {
    metal::float4 inner[3];
};
constant uint octagloss_SUNS = 8u;
constant uint octagloss_INTERVALS = 860u;
#ifndef OCTAGLOSS_CUBE
constant uint octagloss_SQUARES = 3u;
#endif
constant uint octagloss_READS = 10u;
constant uint octagloss_LAYERS = 18u;
constant float octagloss_COSINE_FROM = 0.435;
constant metal::float2 octagloss_NODES = metal::float2(46.0, 26.0);
constant float octagloss_LEAST_COSINE = 0.01;
constant metal::float2 octagloss_ALBEDO_NODES = metal::float2(91.0, 75.0);
constant metal::float4 octagloss_DIP = metal::float4(0.222, 0.634, 0.098, 0.3126);
constant float octagloss_LEAST_ALPHA = 0.000001;
constant metal::float2 octagloss_TABLES = metal::float2(864.0, 40.0);
constant metal::float4 octagloss_ROW_NODES = metal::float4(16.0, 10.0, 8.0, 7.0);
constant uint octagloss_ROW_MIDDLE = 7u;
constant uint octagloss_ROW_PAIRS = 8u;
constant uint octagloss_ROW_LAYERS = 21u;
constant metal::float2 octagloss_BLEND_ALBEDO_NODES = metal::float2(84.0, 61.0);
constant metal::float2 octagloss_BLEND_SHARE_NODES = metal::float2(49.0, 11.0);
constant metal::float2 octagloss_BLEND_MEAN_NODES = metal::float2(84.0, 21.0);
constant float octagloss_BLEND_RATIO_NODES = 33.0;
constant float octagloss_BLEND_STRIP = 20.0;
constant float octagloss_BLEND_SHARES_AT = 252.0;
constant float octagloss_BLEND_RATIOS_AT = 302.0;
constant metal::float3 octagloss_ROW_SIZE = metal::float3(336.0, 91.0, 8.0);
constant float octagloss_ROW_SHARP = 0.001;
constant float octagloss_NARROWEST = 0.05;
constant float octagloss_BLEND = 0.1;
constant float octagloss_TILTED = 0.5;
constant float octagloss_SKEWED = 0.2;
#ifdef OCTAGLOSS_CUBE
constant float octagloss_LEVEL_OCTAVES = 1.0;
#else
constant float octagloss_LEVEL_OCTAVES = 0.864;
#endif

type_12 octagloss_harmonic_basis(
    metal::float3 d
) {
    float x_1 = d.x;
    float y = d.y;
    float z = d.z;
    float xx = x_1 * x_1;
    float yy = y * y;
    float zz = z * z;
    return type_12 {{0.28209478, 0.48860252 * y, 0.48860252 * z, 0.48860252 * x_1, (1.0925485 * x_1) * y, (1.0925485 * y) * z, 0.31539157 * ((3.0 * zz) - 1.0), (1.0925485 * x_1) * z, 0.54627424 * (xx - yy), (0.5900436 * y) * ((3.0 * xx) - yy), ((2.8906114 * x_1) * y) * z, (0.4570458 * y) * ((5.0 * zz) - 1.0), (0.37317634 * z) * ((5.0 * zz) - 3.0), (0.4570458 * x_1) * ((5.0 * zz) - 1.0), (1.4453057 * z) * (xx - yy), (0.5900436 * x_1) * (xx - (3.0 * yy)), ((2.5033429 * x_1) * y) * (xx - yy), ((1.7701308 * y) * z) * ((3.0 * xx) - yy), ((0.9461747 * x_1) * y) * ((7.0 * zz) - 1.0), ((0.6690465 * y) * z) * ((7.0 * zz) - 3.0), 0.10578555 * ((((35.0 * zz) * zz) - (30.0 * zz)) + 3.0), ((0.6690465 * x_1) * z) * ((7.0 * zz) - 3.0), (0.47308734 * (xx - yy)) * ((7.0 * zz) - 1.0), ((1.7701308 * x_1) * z) * (xx - (3.0 * yy)), 0.6258357 * (((xx * xx) - ((6.0 * xx) * yy)) + (yy * yy))}};
}

metal::float3 octagloss_source_from_world(
    uint probe,
    metal::float3 direction,
    constant type_7& octagloss_lights
) {
    metal::float3x3 axes = octagloss_lights.inner[probe].world_from_source;
    return metal::normalize(metal::float3(metal::dot(direction, axes[0]), metal::dot(direction, axes[1]), metal::dot(direction, axes[2])));
}

metal::float3 octagloss_harmonic(
    uint probe_1,
    uint k,
    constant type_7& octagloss_lights
) {
    metal::float4 _e6 = octagloss_lights.inner[probe_1].harmonics.inner[k];
    return _e6.xyz;
}

type_13 octagloss_orders_of(
    uint probe_2,
    type_12 b,
    constant type_7& octagloss_lights
) {
    metal::float3 _e4 = octagloss_harmonic(probe_2, 0u, octagloss_lights);
    metal::float3 _e8 = octagloss_harmonic(probe_2, 1u, octagloss_lights);
    metal::float3 _e12 = octagloss_harmonic(probe_2, 2u, octagloss_lights);
    metal::float3 _e17 = octagloss_harmonic(probe_2, 3u, octagloss_lights);
    metal::float3 _e22 = octagloss_harmonic(probe_2, 4u, octagloss_lights);
    metal::float3 _e26 = octagloss_harmonic(probe_2, 5u, octagloss_lights);
    metal::float3 _e31 = octagloss_harmonic(probe_2, 6u, octagloss_lights);
    metal::float3 _e36 = octagloss_harmonic(probe_2, 7u, octagloss_lights);
    metal::float3 _e41 = octagloss_harmonic(probe_2, 8u, octagloss_lights);
    metal::float3 _e46 = octagloss_harmonic(probe_2, 9u, octagloss_lights);
    metal::float3 _e50 = octagloss_harmonic(probe_2, 10u, octagloss_lights);
    metal::float3 _e55 = octagloss_harmonic(probe_2, 11u, octagloss_lights);
    metal::float3 _e60 = octagloss_harmonic(probe_2, 12u, octagloss_lights);
    metal::float3 _e65 = octagloss_harmonic(probe_2, 13u, octagloss_lights);
    metal::float3 _e70 = octagloss_harmonic(probe_2, 14u, octagloss_lights);
    metal::float3 _e75 = octagloss_harmonic(probe_2, 15u, octagloss_lights);
    metal::float3 _e80 = octagloss_harmonic(probe_2, 16u, octagloss_lights);
    metal::float3 _e84 = octagloss_harmonic(probe_2, 17u, octagloss_lights);
    metal::float3 _e89 = octagloss_harmonic(probe_2, 18u, octagloss_lights);
    metal::float3 _e94 = octagloss_harmonic(probe_2, 19u, octagloss_lights);
    metal::float3 _e99 = octagloss_harmonic(probe_2, 20u, octagloss_lights);
    metal::float3 _e104 = octagloss_harmonic(probe_2, 21u, octagloss_lights);
    metal::float3 _e109 = octagloss_harmonic(probe_2, 22u, octagloss_lights);
    metal::float3 _e114 = octagloss_harmonic(probe_2, 23u, octagloss_lights);
    metal::float3 _e119 = octagloss_harmonic(probe_2, 24u, octagloss_lights);
    return type_13 {{b.inner[0] * _e4, ((b.inner[1] * _e8) + (b.inner[2] * _e12)) + (b.inner[3] * _e17), ((((b.inner[4] * _e22) + (b.inner[5] * _e26)) + (b.inner[6] * _e31)) + (b.inner[7] * _e36)) + (b.inner[8] * _e41), ((((((b.inner[9] * _e46) + (b.inner[10] * _e50)) + (b.inner[11] * _e55)) + (b.inner[12] * _e60)) + (b.inner[13] * _e65)) + (b.inner[14] * _e70)) + (b.inner[15] * _e75), ((((((((b.inner[16] * _e80) + (b.inner[17] * _e84)) + (b.inner[18] * _e89)) + (b.inner[19] * _e94)) + (b.inner[20] * _e99)) + (b.inner[21] * _e104)) + (b.inner[22] * _e109)) + (b.inner[23] * _e114)) + (b.inner[24] * _e119)}};
}

metal::float3 octagloss_harmonics_around(
    uint probe_3,
    metal::float3 d_1,
    type_14 weights,
    constant type_7& octagloss_lights
) {
    type_12 _e3 = octagloss_harmonic_basis(d_1);
    type_13 _e4 = octagloss_orders_of(probe_3, _e3, octagloss_lights);
    return ((((weights.inner[0] * _e4.inner[0]) + (weights.inner[1] * _e4.inner[1])) + (weights.inner[2] * _e4.inner[2])) + (weights.inner[3] * _e4.inner[3])) + (weights.inner[4] * _e4.inner[4]);
}

octagloss_MapPlace octagloss_place_of(
    metal::float3 direction_1
) {
#ifdef OCTAGLOSS_CUBE
    return direction_1;
#else
    return direction_1 / metal::float3((metal::abs(direction_1.x) + metal::abs(direction_1.y)) + metal::abs(direction_1.z));
#endif
}

type_15 octagloss_node_weights(
    uint node,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    type_15 weights_1 = type_15 {};
    uint row = 0u;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e18 = row;
            row = _e18 + 1u;
        }
        loop_init = false;
        uint _e5 = row;
        if (_e5 < 5u) {
        } else {
            break;
        }
        {
            uint _e8 = row;
            uint _e12 = row;
            metal::float4 _e16 = octagloss_tables.read(metal::uint2(metal::uint2(node, 27u + _e12)), 0);
            weights_1.inner[_e8] = _e16;
        }
    }
    type_15 _e20 = weights_1;
    return _e20;
#ifndef OCTAGLOSS_CUBE
}

float octagloss_map_side(
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    return static_cast<float>(metal::uint2(octagloss_maps.get_width(), octagloss_maps.get_height()).x);
}

uint octagloss_map_octave(
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    float _e0 = octagloss_map_side(octagloss_maps);
    return (as_type<uint>(_e0) >> 23u) - 127u;
#endif
}

#ifdef OCTAGLOSS_CUBE
metal::float3 octagloss_read_map(
#else
metal::float3 octagloss_read_square(
#endif
    uint probe_4,
    octagloss_MapPlace at,
#ifdef OCTAGLOSS_CUBE
    uint map,
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    uint layer,
    uint mip,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at, metal::level(static_cast<float>(map)));
    return _e6.xyz;
#else
    uint _e5 = octagloss_map_octave(octagloss_maps);
    float inner = static_cast<float>(1u << _e5);
    float edge = static_cast<float>(1u << mip) / inner;
    metal::float3 rounded = metal::max(metal::abs(at), metal::float3(edge, 0.0, edge));
    metal::float2 p = at.xz / metal::float2((rounded.x + rounded.y) + rounded.z);
    metal::float2 folded = metal::float2(1.0) - metal::abs(p.yx);
    metal::float2 turned = metal::float2((p.x >= 0.0) ? folded.x : -(folded.x), (p.y >= 0.0) ? folded.y : -(folded.y));
    metal::float2 uv = (at.y >= 0.0) ? p : turned;
    float _e50 = octagloss_map_side(octagloss_maps);
    metal::float2 place_3 = metal::float2(0.5) + (uv * ((0.5 * inner) / _e50));
    metal::float4 _e62 = octagloss_maps.sample(octagloss_linear, place_3, (octagloss_SQUARES * probe_4) + layer, metal::level(static_cast<float>(mip)));
    return _e62.xyz;
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
#endif
}

#ifdef OCTAGLOSS_CUBE
metal::float3 octagloss_read_cosine(
#else
metal::float3 octagloss_read_map(
#endif
    uint probe_5,
    octagloss_MapPlace at_1,
#ifdef OCTAGLOSS_CUBE
    constant type_7& octagloss_lights
#else
    uint map,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e8 = octagloss_harmonics_around(probe_5, at_1, type_14 {{1.0, 0.6666667, 0.25, 0.0, -0.041666668}}, octagloss_lights);
    return _e8;
#else
    metal::float3 _e7 = octagloss_read_square(probe_5, at_1, naga_mod(map, octagloss_SQUARES), naga_div(map, octagloss_SQUARES), octagloss_maps, octagloss_linear);
    return _e7;
#endif
}

#ifdef OCTAGLOSS_CUBE
uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
#else
uint octagloss_last_mip(
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    uint _e0 = octagloss_map_octave(octagloss_maps);
    return metal::max(_e0 - ((_e0 > 8u) ? 6u : 5u), 1u);
#endif
}

#ifdef OCTAGLOSS_CUBE
uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
#else
metal::float3 octagloss_read_cosine(
    uint probe_6,
    octagloss_MapPlace at_2,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    uint _e3 = octagloss_last_mip(octagloss_maps);
    metal::float3 _e4 = octagloss_read_square(probe_6, at_2, 2u, _e3, octagloss_maps, octagloss_linear);
    return _e4;
#endif
}

metal::float3 octagloss_half_axis_of(
#ifdef OCTAGLOSS_CUBE
    uint probe_6,
#else
    uint probe_7,
#endif
    uint disc,
    constant type_7& octagloss_lights
) {
    uint k_4 = 3u * naga_div(disc, 2u);
#ifdef OCTAGLOSS_CUBE
    float _e11 = octagloss_lights.inner[probe_6].harmonics.inner[k_4].w;
    float _e19 = octagloss_lights.inner[probe_6].harmonics.inner[k_4 + 1u].w;
    float _e27 = octagloss_lights.inner[probe_6].harmonics.inner[k_4 + 2u].w;
#else
    float _e11 = octagloss_lights.inner[probe_7].harmonics.inner[k_4].w;
    float _e19 = octagloss_lights.inner[probe_7].harmonics.inner[k_4 + 1u].w;
    float _e27 = octagloss_lights.inner[probe_7].harmonics.inner[k_4 + 2u].w;
#endif
    metal::float3 half_axis = metal::float3(_e11, _e19, _e27);
    return (naga_mod(disc, 2u) == 0u) ? half_axis : -(half_axis);
}

float octagloss_squared(
    metal::float3 v
) {
    return metal::dot(v, v);
}

uint naga_f2u32(float value) {
    return static_cast<uint>(metal::clamp(value, 0.0, 4294967000.0));
}

metal::float3 octagloss_radiance_of(
#ifdef OCTAGLOSS_CUBE
    uint probe_7,
#else
    uint probe_8,
#endif
    metal::float3 direction_2,
    float roughness,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float3 sum = metal::float3 {};
#ifdef OCTAGLOSS_CUBE
    type_17 maps = {};
#else
    type_18 maps = {};
#endif
    uint map_1 = 0u;
    uint disc_1 = 0u;
    metal::float3 lobe = {};
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e3 = octagloss_source_from_world(probe_7, direction_2, octagloss_lights);
#else
    metal::float3 _e3 = octagloss_source_from_world(probe_8, direction_2, octagloss_lights);
#endif
    octagloss_MapPlace _e4 = octagloss_place_of(_e3);
    float node_1 = metal::log2(1.0 + (30.0 * roughness)) * 173.59021;
    uint k_5 = metal::min(naga_f2u32(node_1), 859u);
    float share = node_1 - static_cast<float>(k_5);
    type_15 _e17 = octagloss_node_weights(k_5, octagloss_tables);
    type_15 _e20 = octagloss_node_weights(k_5 + 1u, octagloss_tables);
    metal::float4 a_1 = metal::mix(_e17.inner[0], _e20.inner[0], share);
    metal::float4 b_2 = metal::mix(_e17.inner[1], _e20.inner[1], share);
    metal::float4 c_2 = metal::mix(_e17.inner[2], _e20.inner[2], share);
    metal::float4 e = metal::mix(_e17.inner[3], _e20.inner[3], share);
    metal::float4 f = metal::mix(_e17.inner[4], _e20.inner[4], share);
#ifdef OCTAGLOSS_CUBE
    maps = type_17 {{a_1.x, a_1.y, a_1.z, a_1.w, b_2.x, b_2.y, b_2.z, b_2.w, c_2.x, c_2.y}};
#else
    maps = type_18 {{a_1.x, a_1.y, a_1.z, a_1.w, b_2.x, b_2.y, b_2.z, b_2.w, c_2.x, c_2.y}};
#endif
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            uint _e69 = map_1;
            map_1 = _e69 + 1u;
        }
        loop_init_1 = false;
        uint _e52 = map_1;
        if (_e52 < 10u) {
        } else {
            break;
        }
        {
            uint _e55 = map_1;
            float _e57 = maps.inner[_e55];
            if (_e57 != 0.0) {
                metal::float3 _e60 = sum;
                uint _e61 = map_1;
                float _e63 = maps.inner[_e61];
                uint _e64 = map_1;
#ifdef OCTAGLOSS_CUBE
                metal::float3 _e65 = octagloss_read_map(probe_7, _e4, _e64, octagloss_maps, octagloss_linear);
#else
                metal::float3 _e65 = octagloss_read_map(probe_8, _e4, _e64, octagloss_maps, octagloss_linear);
#endif
                sum = _e60 + (_e63 * _e65);
            }
        }
    }
    if (c_2.z != 0.0) {
        metal::float3 _e74 = sum;
#ifdef OCTAGLOSS_CUBE
        metal::float3 _e76 = octagloss_read_cosine(probe_7, _e4, octagloss_lights);
#else
        metal::float3 _e76 = octagloss_read_cosine(probe_8, _e4, octagloss_maps, octagloss_linear);
#endif
        sum = _e74 + (c_2.z * _e76);
    }
    metal::float3 _e79 = sum;
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e86 = octagloss_harmonics_around(probe_7, _e3, type_14 {{c_2.w, e.x, e.y, e.z, e.w}}, octagloss_lights);
#else
    metal::float3 _e86 = octagloss_harmonics_around(probe_8, _e3, type_14 {{c_2.w, e.x, e.y, e.z, e.w}}, octagloss_lights);
#endif
    sum = _e79 + _e86;
    metal::float3 _e88 = sum;
#ifdef OCTAGLOSS_CUBE
    float _e94 = octagloss_lights.inner[probe_7].unscale;
#else
    float _e94 = octagloss_lights.inner[probe_8].unscale;
#endif
    sum = metal::max(_e88, metal::float3 {}) * _e94;
    float a2_ = metal::max(((roughness * roughness) * roughness) * roughness, 0.000000000001);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e220 = disc_1;
            disc_1 = _e220 + 1u;
        }
        loop_init_2 = false;
        uint _e103 = disc_1;
        if (_e103 < 16u) {
        } else {
            break;
        }
        {
            uint _e109 = disc_1;
#ifdef OCTAGLOSS_CUBE
            OctaglossSun sun = octagloss_lights.inner[probe_7].suns.inner[naga_div(_e109, 2u)];
#else
            OctaglossSun sun = octagloss_lights.inner[probe_8].suns.inner[naga_div(_e109, 2u)];
#endif
            uint _e114 = disc_1;
#ifdef OCTAGLOSS_CUBE
            metal::float3 _e115 = octagloss_half_axis_of(probe_7, _e114, octagloss_lights);
#else
            metal::float3 _e115 = octagloss_half_axis_of(probe_8, _e114, octagloss_lights);
#endif
            float _e116 = octagloss_squared(_e115);
            float nearer = 1.0 - (0.5 * _e116);
            metal::float3 to = _e3 - _e115;
            float _e126 = octagloss_squared(to - (nearer * sun.red.xyz));
            float _e131 = octagloss_squared(to - (nearer * sun.green.xyz));
            float _e136 = octagloss_squared(to - (nearer * sun.blue.xyz));
            metal::float3 apart = metal::float3(_e126, _e131, _e136);
            metal::float3 s = metal::min(0.25 * apart, metal::float3(0.5));
            metal::float3 radius2_ = 0.5 * metal::float3(sun.red.w, sun.green.w, sun.blue.w);
            metal::float3 nearness = (s + (a2_ * (metal::float3(1.0) - s))) - radius2_;
            lobe = metal::float3 {};
            if (metal::all(radius2_ < (0.03 * nearness))) {
                lobe = metal::float3(a2_) / ((nearness * nearness) + ((3.0 * a2_) * radius2_));
            } else {
                metal::float3 root = metal::max(metal::sqrt((nearness * nearness) + ((4.0 * a2_) * radius2_)), metal::float3(0.000000000000000000000000000001));
                metal::float3 outside = metal::float3(2.0 * a2_) / (root * metal::max(root + nearness, metal::float3(0.000000000000000000000000000001)));
                metal::float3 inside = (root - nearness) / ((2.0 * metal::max(radius2_, metal::float3(0.000000000000000000000000000001))) * root);
                lobe = metal::select(inside, outside, nearness > metal::float3 {});
            }
            metal::float3 _e200 = sum;
            metal::float3 _e202 = lobe;
            sum = _e200 + (sun.energy * ((_e202 * (metal::float3(1.0) - (2.0 * s))) * ((0.15915494 * f.x) * (1.0 - a_1.x))));
        }
    }
    metal::float3 _e222 = sum;
    return _e222;
}

metal::float3 octagloss_radiance(
    metal::float3 direction_3,
    float roughness_1,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float3 _e3 = octagloss_radiance_of(0u, direction_3, roughness_1, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
    return _e3;
}

metal::float3 octagloss_irradiance_of(
#ifdef OCTAGLOSS_CUBE
    uint probe_8,
#else
    uint probe_9,
#endif
    metal::float3 normal,
#ifdef OCTAGLOSS_CUBE
    constant type_7& octagloss_lights
#else
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
    metal::float3 sum_1 = {};
    uint k_1 = 0u;
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e2 = octagloss_source_from_world(probe_8, normal, octagloss_lights);
#else
    metal::float3 _e2 = octagloss_source_from_world(probe_9, normal, octagloss_lights);
#endif
    octagloss_MapPlace _e3 = octagloss_place_of(_e2);
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e4 = octagloss_read_cosine(probe_8, _e3, octagloss_lights);
    float _e8 = octagloss_lights.inner[probe_8].unscale;
#else
    metal::float3 _e4 = octagloss_read_cosine(probe_9, _e3, octagloss_maps, octagloss_linear);
    float _e8 = octagloss_lights.inner[probe_9].unscale;
#endif
    sum_1 = _e4 * _e8;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e41 = k_1;
            k_1 = _e41 + 1u;
        }
        loop_init_3 = false;
        uint _e13 = k_1;
        if (_e13 < octagloss_SUNS) {
        } else {
            break;
        }
        {
            uint _e19 = k_1;
#ifdef OCTAGLOSS_CUBE
            OctaglossSun sun_1 = octagloss_lights.inner[probe_8].suns.inner[_e19];
#else
            OctaglossSun sun_1 = octagloss_lights.inner[probe_9].suns.inner[_e19];
#endif
            metal::float3 facing = metal::float3(metal::dot(_e2, sun_1.red.xyz), metal::dot(_e2, sun_1.green.xyz), metal::dot(_e2, sun_1.blue.xyz));
            metal::float3 _e32 = sum_1;
            sum_1 = _e32 + (sun_1.energy * (0.31830987 * metal::max(facing, metal::float3 {})));
        }
    }
    metal::float3 _e43 = sum_1;
    return _e43;
}

metal::float3 octagloss_irradiance(
    metal::float3 normal_1,
#ifdef OCTAGLOSS_CUBE
    constant type_7& octagloss_lights
#else
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e2 = octagloss_irradiance_of(0u, normal_1, octagloss_lights);
#else
    metal::float3 _e2 = octagloss_irradiance_of(0u, normal_1, octagloss_lights, octagloss_maps, octagloss_linear);
#endif
    return _e2;
}

metal::float4 octagloss_read_reflections(
#ifdef OCTAGLOSS_CUBE
    uint layer,
    metal::float2 at_2,
#else
    uint layer_1,
    metal::float2 at_3,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
#ifdef OCTAGLOSS_CUBE
    metal::float2 corner = metal::float2(1.0 + (static_cast<float>(layer) * 48.0), 0.0);
    metal::float4 _e17 = octagloss_tables.sample(octagloss_linear, ((at_2 * octagloss_NODES) + corner) / octagloss_TABLES, metal::level(0.0));
#else
    metal::float2 corner = metal::float2(1.0 + (static_cast<float>(layer_1) * 48.0), 0.0);
    metal::float4 _e17 = octagloss_tables.sample(octagloss_linear, ((at_3 * octagloss_NODES) + corner) / octagloss_TABLES, metal::level(0.0));
#endif
    return _e17;
}

metal::float4 octagloss_reflection_node(
#ifdef OCTAGLOSS_CUBE
    uint layer_1,
#else
    uint layer_2,
#endif
    float roughness_2,
    float cosine,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    float sine = metal::sqrt(metal::max(1.0 - (cosine * cosine), 0.0));
#ifdef OCTAGLOSS_CUBE
    metal::float2 place_3 = metal::float2(metal::log2(1.0 + (10.0 * roughness_2)) * 0.28906482, metal::sqrt(cosine * metal::rsqrt(1.0 + sine)));
    metal::float2 at_5 = ((place_3 * metal::float2(45.0, 25.0)) + metal::float2(0.5)) / octagloss_NODES;
    metal::float4 _e31 = octagloss_read_reflections(layer_1, at_5, octagloss_tables, octagloss_linear);
#else
    metal::float2 place_4 = metal::float2(metal::log2(1.0 + (10.0 * roughness_2)) * 0.28906482, metal::sqrt(cosine * metal::rsqrt(1.0 + sine)));
    metal::float2 at_6 = ((place_4 * metal::float2(45.0, 25.0)) + metal::float2(0.5)) / octagloss_NODES;
    metal::float4 _e31 = octagloss_read_reflections(layer_2, at_6, octagloss_tables, octagloss_linear);
#endif
    return _e31;
}

metal::float4 octagloss_read_albedo(
    uint texel,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    metal::float4 _e9 = octagloss_tables.read(metal::uint2(metal::uint2(naga_mod(texel, 864u), 32u + naga_div(texel, 864u))), 0);
    return _e9;
}

metal::float2 octagloss_round_albedo(
    float cosine_1,
    float roughness_3,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    float seen = metal::clamp(cosine_1, 0.0001, 1.0);
    metal::float2 places = metal::float2(metal::log2(1.0 + (30.0 * roughness_3)) * 0.2018487, (metal::sqrt(metal::sqrt(seen)) - 0.1) / 0.9);
#ifdef OCTAGLOSS_CUBE
    metal::float2 place_4 = metal::clamp(places, metal::float2 {}, metal::float2(1.0)) * metal::float2(90.0, 74.0);
    metal::float2 node_2 = metal::min(metal::floor(place_4), metal::float2(89.0, 73.0));
    metal::float2 share_1 = place_4 - node_2;
#else
    metal::float2 place_5 = metal::clamp(places, metal::float2 {}, metal::float2(1.0)) * metal::float2(90.0, 74.0);
    metal::float2 node_2 = metal::min(metal::floor(place_5), metal::float2(89.0, 73.0));
    metal::float2 share_1 = place_5 - node_2;
#endif
    uint first_2 = naga_f2u32(node_2.x + (91.0 * node_2.y));
    metal::float4 _e39 = octagloss_read_albedo(first_2, octagloss_tables);
    metal::float4 _e42 = octagloss_read_albedo(first_2 + 91u, octagloss_tables);
    metal::float4 pair = metal::mix(_e39, _e42, share_1.y);
    float t = seen / metal::max(roughness_3 * roughness_3, octagloss_LEAST_ALPHA);
    float left = 1.0 - ((0.222 * t) / (1.0 + (t * (0.634 + (t * (0.098 + (t * 0.3126)))))));
    return left * metal::mix(pair.xy, pair.zw, share_1.x);
}

metal::float3 octagloss_between_levels(
#ifdef OCTAGLOSS_CUBE
    uint probe_9,
#else
    uint probe_10,
#endif
    metal::float3 direction_4,
    float level,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear
) {
    octagloss_MapPlace _e3 = octagloss_place_of(direction_4);
    uint finer = naga_f2u32(level);
    float share_2 = metal::fract(level);
    uint coarser = (share_2 > 0.0) ? (finer + 1u) : finer;
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e11 = octagloss_read_map(probe_9, _e3, finer, octagloss_maps, octagloss_linear);
    metal::float3 _e12 = octagloss_read_map(probe_9, _e3, coarser, octagloss_maps, octagloss_linear);
#else
    metal::float3 _e11 = octagloss_read_map(probe_10, _e3, finer, octagloss_maps, octagloss_linear);
    metal::float3 _e12 = octagloss_read_map(probe_10, _e3, coarser, octagloss_maps, octagloss_linear);
#endif
    return metal::mix(_e11, _e12, share_2);
}

float octagloss_masking_of(
    metal::float3 w,
    metal::float2 alpha
) {
    return metal::length(metal::float3(alpha * w.xy, w.z));
}

float octagloss_fresnel_of(
    float cosine_2
) {
    float rest = metal::max(1.0 - cosine_2, 0.0);
    return (((rest * rest) * rest) * rest) * rest;
}

metal::float2 octagloss_brdf_around(
    metal::float3 view,
    metal::float3 light,
    metal::float2 alpha_1,
    float spread
) {
    float x = {};
    float side = 0.0;
    float slope = 1.0;
    uint step = 0u;
    float radius = metal::sqrt(2.0 * spread);
    if (light.z <= -(radius)) {
        return metal::float2 {};
    }
    float left_1 = metal::min((0.5 * (light.z + radius)) / metal::max(radius, 0.000000001), 1.0);
    metal::float3 l = metal::normalize(metal::float3(light.xy, metal::max(light.z, left_1 * radius)));
    float above = (spread * left_1) * left_1;
    metal::float3 middle = view + ((1.0 - above) * l);
    float length2_ = metal::dot(middle, middle);
    metal::float3 h = middle * metal::rsqrt(length2_);
    metal::float3 shape = metal::float3(alpha_1.y / alpha_1.x, alpha_1.x / alpha_1.y, alpha_1.x * alpha_1.y);
    metal::float3 bent = shape * h;
    float bend = metal::dot(h, bent);
    float along_1 = metal::dot(h, l);
    float size = (above * (2.0 - above)) / (length2_ * bend);
    float trace = size * metal::dot(shape, metal::float3(1.0) - (l * l));
    float _e60 = octagloss_squared(metal::cross(l, bent));
    float aside = trace - ((size * _e60) / bend);
    float _e64 = octagloss_masking_of(l, alpha_1);
    float determinant = ((size * size) * _e64) * _e64;
    float near = ((shape.z * along_1) * along_1) / ((bend * _e64) * _e64);
    float last = determinant * near;
    float linear = 1.0 - trace;
    x = metal::max(0.5 * (linear + metal::sqrt((linear * linear) + ((4.0 * trace) * near))), near);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e140 = step;
            step = _e140 + 1u;
        }
        loop_init_4 = false;
        uint _e94 = step;
        if (_e94 < 3u) {
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
            x = _e97 + ((_e98 * (_e99 - ((((_e100 + trace) * _e102) + determinant) * _e105))) / _e109);
            float _e112 = x;
            float _e114 = x;
            side = ((_e112 + aside) * _e114) + last;
            float _e117 = x;
            float _e121 = x;
            float _e129 = x;
            float _e135 = x;
            slope = ((((((((_e117 + (2.0 * aside)) * _e121) + (3.0 * last)) + (trace * aside)) - determinant) * _e129) + ((2.0 * trace) * last)) * _e135) + (determinant * last);
        }
    }
    float _e143 = x;
    metal::float3 inverse = metal::float3(1.0) / ((size * shape) + metal::float3(_e143));
    float _e152 = x;
    float towards = (size * metal::dot(l, inverse * bent)) / (_e152 * metal::dot(l, inverse * l));
    metal::float3 axis_1 = metal::normalize(inverse * (h + (towards * l)));
    float cosine_11 = metal::dot(view, axis_1);
    metal::float3 lit = ((2.0 * cosine_11) * axis_1) - view;
    float facing_1 = metal::max(lit.z, 0.0);
    float _e169 = side;
    float _e170 = x;
    float _e171 = slope;
    float lobe_1 = (metal::sqrt(_e169 / (((_e170 * _e171) * bend) * metal::dot(axis_1, shape * axis_1))) * shape.z) / (3.1415927 * bend);
    float share_3 = metal::pow(left_1, 1.25) * (1.0 - (0.5 * above));
    float _e191 = octagloss_masking_of(view, alpha_1);
    float _e194 = octagloss_masking_of(lit, alpha_1);
    float visible = facing_1 / ((facing_1 * _e191) + (view.z * _e194));
    float _e205 = octagloss_fresnel_of(cosine_11);
    return metal::float2((((((share_3 * 2.0) * along_1) * cosine_11) / length2_) * lobe_1) * visible, _e205);
}

metal::float3 octagloss_cosine_light(
#ifdef OCTAGLOSS_CUBE
    uint probe_10,
#else
    uint probe_11,
#endif
    metal::float3 n,
#ifdef OCTAGLOSS_CUBE
    constant type_7& octagloss_lights
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
    octagloss_MapPlace _e2 = octagloss_place_of(n);
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e3 = octagloss_read_cosine(probe_10, _e2, octagloss_lights);
#else
    metal::float3 _e3 = octagloss_read_cosine(probe_11, _e2, octagloss_maps, octagloss_linear);
#endif
    return _e3;
}

metal::float2x3 octagloss_weighed(
    metal::float3 light_1,
    metal::float2 weights_2
) {
    return metal::float2x3(light_1 * weights_2.x, light_1 * weights_2.y);
}

metal::float2x3 octagloss_harmonics_reflected(
#ifdef OCTAGLOSS_CUBE
    uint probe_11,
#else
    uint probe_12,
#endif
    octagloss_SurfaceFrame surface,
    type_20 pairs,
    constant type_7& octagloss_lights
) {
    metal::float3 n_1 = surface.normal;
    metal::float3 t_1 = surface.towards;
    type_12 _e5 = octagloss_harmonic_basis(n_1);
#ifdef OCTAGLOSS_CUBE
    type_13 _e6 = octagloss_orders_of(probe_11, _e5, octagloss_lights);
#else
    type_13 _e6 = octagloss_orders_of(probe_12, _e5, octagloss_lights);
#endif
    type_12 _e12 = octagloss_harmonic_basis((n_1 * 0.309017) + (t_1 * 0.95105654));
#ifdef OCTAGLOSS_CUBE
    type_13 _e13 = octagloss_orders_of(probe_11, _e12, octagloss_lights);
#else
    type_13 _e13 = octagloss_orders_of(probe_12, _e12, octagloss_lights);
#endif
    type_12 _e19 = octagloss_harmonic_basis((n_1 * -0.809017) + (t_1 * 0.58778524));
#ifdef OCTAGLOSS_CUBE
    type_13 _e20 = octagloss_orders_of(probe_11, _e19, octagloss_lights);
#else
    type_13 _e20 = octagloss_orders_of(probe_12, _e19, octagloss_lights);
#endif
    type_12 _e26 = octagloss_harmonic_basis((n_1 * 0.809017) + (t_1 * 0.58778524));
#ifdef OCTAGLOSS_CUBE
    type_13 _e27 = octagloss_orders_of(probe_11, _e26, octagloss_lights);
#else
    type_13 _e27 = octagloss_orders_of(probe_12, _e26, octagloss_lights);
#endif
    type_12 _e33 = octagloss_harmonic_basis((n_1 * -0.309017) + (t_1 * 0.95105654));
#ifdef OCTAGLOSS_CUBE
    type_13 _e34 = octagloss_orders_of(probe_11, _e33, octagloss_lights);
#else
    type_13 _e34 = octagloss_orders_of(probe_12, _e33, octagloss_lights);
#endif
    metal::float2x3 _e38 = octagloss_weighed(_e6.inner[0], pairs.inner[0].xy);
    metal::float2x3 _e42 = octagloss_weighed(_e6.inner[1], pairs.inner[0].zw);
    metal::float2x3 _e47 = octagloss_weighed(_e6.inner[2], pairs.inner[1].xy);
    metal::float2x3 _e52 = octagloss_weighed(_e6.inner[3], pairs.inner[1].zw);
    metal::float2x3 _e57 = octagloss_weighed(_e6.inner[4], pairs.inner[2].xy);
    metal::float2x3 _e62 = octagloss_weighed(_e13.inner[1], pairs.inner[2].zw);
    metal::float2x3 _e67 = octagloss_weighed(_e13.inner[2], pairs.inner[3].xy);
    metal::float2x3 _e72 = octagloss_weighed(_e13.inner[3], pairs.inner[3].zw);
    metal::float2x3 _e77 = octagloss_weighed(_e13.inner[4], pairs.inner[4].xy);
    metal::float2x3 _e82 = octagloss_weighed(_e20.inner[2], pairs.inner[4].zw);
    metal::float2x3 _e87 = octagloss_weighed(_e20.inner[3], pairs.inner[5].xy);
    metal::float2x3 _e92 = octagloss_weighed(_e20.inner[4], pairs.inner[5].zw);
    metal::float2x3 _e97 = octagloss_weighed(_e27.inner[3], pairs.inner[6].xy);
    metal::float2x3 _e102 = octagloss_weighed(_e27.inner[4], pairs.inner[6].zw);
    metal::float2x3 _e107 = octagloss_weighed(_e34.inner[4], pairs.inner[7].xy);
    return (((((((((((((_e38 + _e42) + _e47) + _e52) + _e57) + _e62) + _e67) + _e72) + _e77) + _e82) + _e87) + _e92) + _e97) + _e102) + _e107;
}

float octagloss_map_inner(
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
#ifdef OCTAGLOSS_CUBE
    return static_cast<float>(metal::uint2(octagloss_maps.get_width()).x);
#else
    uint _e1 = octagloss_map_octave(octagloss_maps);
    return static_cast<float>(1u << _e1);
#endif
}

metal::float3 octagloss_suns_reflected(
#ifdef OCTAGLOSS_CUBE
    uint probe_12,
#else
    uint probe_13,
#endif
    octagloss_SurfaceFrame surface_1,
    metal::float2 tangent,
    metal::float2 alpha_2,
    metal::float3 f0_,
    float f90_,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
    metal::float3 sum_2 = metal::float3 {};
    uint disc_2 = 0u;
    uint c = {};
    metal::float3 across_2 = metal::cross(surface_1.normal, surface_1.towards);
    metal::float3 x_2 = (surface_1.towards * tangent.x) + (across_2 * tangent.y);
    metal::float3 y_1 = (across_2 * tangent.x) - (surface_1.towards * tangent.y);
    metal::float3 view_5 = metal::float3(surface_1.sine * tangent.x, -(surface_1.sine) * tangent.y, surface_1.cosine);
    float _e30 = octagloss_map_inner(octagloss_maps);
    metal::float2 wide = metal::max(alpha_2, metal::float2(0.9 / _e30));
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e105 = disc_2;
            disc_2 = _e105 + 1u;
        }
        loop_init_5 = false;
        uint _e39 = disc_2;
        if (_e39 < 16u) {
        } else {
            break;
        }
        {
            uint _e45 = disc_2;
#ifdef OCTAGLOSS_CUBE
            OctaglossSun sun_2 = octagloss_lights.inner[probe_12].suns.inner[naga_div(_e45, 2u)];
#else
            OctaglossSun sun_2 = octagloss_lights.inner[probe_13].suns.inner[naga_div(_e45, 2u)];
#endif
            uint _e50 = disc_2;
#ifdef OCTAGLOSS_CUBE
            metal::float3 _e51 = octagloss_half_axis_of(probe_12, _e50, octagloss_lights);
#else
            metal::float3 _e51 = octagloss_half_axis_of(probe_13, _e50, octagloss_lights);
#endif
            float _e52 = octagloss_squared(_e51);
            float nearer_1 = 1.0 - (0.5 * _e52);
            c = 0u;
            bool loop_init_6 = true;
            while(true) {
                if (!loop_init_6) {
                    uint _e102 = c;
                    c = _e102 + 1u;
                }
                loop_init_6 = false;
                uint _e59 = c;
                if (_e59 < 3u) {
                } else {
                    break;
                }
                {
                    uint _e62 = c;
                    metal::bool3 own = metal::uint3(_e62) == metal::uint3(0u, 1u, 2u);
                    metal::float4 channel = own.x ? sun_2.red : (own.y ? sun_2.green : sun_2.blue);
                    metal::float3 to_1 = (nearer_1 * channel.xyz) + _e51;
                    metal::float3 light_2 = metal::float3(metal::dot(to_1, x_2), metal::dot(to_1, y_1), metal::dot(to_1, surface_1.normal));
                    metal::float2 _e85 = octagloss_brdf_around(view_5, light_2, wide, channel.w);
                    metal::float3 reflected = ((0.5 * sun_2.energy) * _e85.x) * (f0_ + ((metal::float3(f90_) - f0_) * _e85.y));
                    metal::float3 _e97 = sum_2;
                    sum_2 = _e97 + metal::select(metal::float3 {}, reflected, own);
                }
            }
        }
    }
    metal::float3 _e107 = sum_2;
    return _e107;
}

metal::float2 octagloss_albedo_share(
    metal::float2 albedo,
    metal::float2 sums
) {
    return (albedo + metal::float2(0.0001)) / (metal::max(sums, metal::float2 {}) + metal::float2(0.0001));
}

metal::float3 octagloss_lit_of(
#ifdef OCTAGLOSS_CUBE
    uint probe_13,
#else
    uint probe_14,
#endif
    metal::float2x3 sum_3,
    metal::float3 f0_1,
    float f90_1,
    constant type_7& octagloss_lights
) {
#ifdef OCTAGLOSS_CUBE
    float _e14 = octagloss_lights.inner[probe_13].unscale;
#else
    float _e14 = octagloss_lights.inner[probe_14].unscale;
#endif
    return metal::max((f0_1 * sum_3[0]) + (f90_1 * sum_3[1]), metal::float3 {}) * _e14;
}

metal::float3 octagloss_reflected_isotropic(
#ifdef OCTAGLOSS_CUBE
    uint probe_14,
#else
    uint probe_15,
#endif
    octagloss_SurfaceFrame surface_2,
    float roughness_4,
    metal::float2 albedo_1,
    metal::float3 f0_2,
    float f90_2,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float2x3 sum_4 = {};
    metal::float2 white = {};
    uint reads = octagloss_READS;
    float in_mirror = 0.0;
    uint k_2 = 0u;
    metal::float3 n_2 = surface_2.normal;
    float cosine_12 = surface_2.cosine;
    metal::float3 along_2 = surface_2.towards * surface_2.sine;
    metal::float3 v_1 = along_2 + (n_2 * cosine_12);
    metal::float4 _e14 = octagloss_reflection_node(octagloss_READS, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e16 = octagloss_reflection_node(11u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e18 = octagloss_reflection_node(12u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e20 = octagloss_reflection_node(13u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e22 = octagloss_reflection_node(14u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e24 = octagloss_reflection_node(15u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e26 = octagloss_reflection_node(16u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    metal::float4 _e28 = octagloss_reflection_node(17u, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
    type_20 pairs_1 = type_20 {{_e14, _e16, _e18, _e20, _e22, _e24, _e26, _e28}};
#ifdef OCTAGLOSS_CUBE
    metal::float2x3 _e30 = octagloss_harmonics_reflected(probe_14, surface_2, pairs_1, octagloss_lights);
#else
    metal::float2x3 _e30 = octagloss_harmonics_reflected(probe_15, surface_2, pairs_1, octagloss_lights);
#endif
    sum_4 = _e30;
    white = pairs_1.inner[0].xy + pairs_1.inner[7].zw;
    if (roughness_4 > octagloss_COSINE_FROM) {
        metal::float2x3 _e42 = sum_4;
#ifdef OCTAGLOSS_CUBE
        metal::float3 _e43 = octagloss_cosine_light(probe_14, n_2, octagloss_lights);
#else
        metal::float3 _e43 = octagloss_cosine_light(probe_15, n_2, octagloss_maps, octagloss_linear);
#endif
        metal::float2x3 _e46 = octagloss_weighed(_e43, pairs_1.inner[7].zw);
        sum_4 = _e42 + _e46;
        uint _e48 = reads;
        reads = _e48 - 1u;
    }
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e90 = k_2;
            k_2 = _e90 + 1u;
        }
        loop_init_7 = false;
        uint _e55 = k_2;
        uint _e56 = reads;
        if (_e55 < _e56) {
        } else {
            break;
        }
        {
            uint _e58 = k_2;
            metal::float4 _e59 = octagloss_reflection_node(_e58, roughness_4, cosine_12, octagloss_tables, octagloss_linear);
            metal::float3 half_vector = metal::normalize(n_2 + (_e59.x * along_2));
            metal::float3 direction_5 = (half_vector * (2.0 * metal::dot(v_1, half_vector))) - v_1;
            metal::float2x3 _e69 = sum_4;
#ifdef OCTAGLOSS_CUBE
            metal::float3 _e71 = octagloss_between_levels(probe_14, direction_5, _e59.y, octagloss_maps, octagloss_linear);
#else
            metal::float3 _e71 = octagloss_between_levels(probe_15, direction_5, _e59.y, octagloss_maps, octagloss_linear);
#endif
            metal::float2x3 _e73 = octagloss_weighed(_e71, _e59.zw);
            sum_4 = _e69 + _e73;
            metal::float2 _e75 = white;
            white = _e75 + _e59.zw;
            float _e78 = in_mirror;
            in_mirror = _e78 + ((_e59.z + _e59.w) * metal::max(1.0 - _e59.y, 0.0));
        }
    }
    metal::float2 _e92 = white;
    metal::float2 _e93 = octagloss_albedo_share(albedo_1, _e92);
    metal::float2x3 _e94 = sum_4;
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e99 = octagloss_lit_of(probe_14, _e94, f0_2 * _e93.x, f90_2 * _e93.y, octagloss_lights);
#else
    metal::float3 _e99 = octagloss_lit_of(probe_15, _e94, f0_2 * _e93.x, f90_2 * _e93.y, octagloss_lights);
#endif
    float _e100 = in_mirror;
    float _e102 = white.x;
    float _e104 = white.y;
    float share_4 = metal::max(1.0 - (_e100 / (_e102 + _e104)), 0.0);
    metal::float2 alpha_11 = metal::float2(roughness_4 * roughness_4);
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e116 = octagloss_suns_reflected(probe_14, surface_2, metal::float2(1.0, 0.0), alpha_11, f0_2, f90_2, octagloss_lights, octagloss_maps);
#else
    metal::float3 _e116 = octagloss_suns_reflected(probe_15, surface_2, metal::float2(1.0, 0.0), alpha_11, f0_2, f90_2, octagloss_lights, octagloss_maps);
#endif
    return _e99 + (share_4 * _e116);
}

octagloss_SurfaceFrame octagloss_surface_of(
#ifdef OCTAGLOSS_CUBE
    uint probe_15,
#else
    uint probe_16,
#endif
    metal::float3 normal_2,
    metal::float3 view_1,
    constant type_7& octagloss_lights
) {
    metal::float3 level_view = {};
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e3 = octagloss_source_from_world(probe_15, normal_2, octagloss_lights);
    metal::float3 _e4 = octagloss_source_from_world(probe_15, view_1, octagloss_lights);
#else
    metal::float3 _e3 = octagloss_source_from_world(probe_16, normal_2, octagloss_lights);
    metal::float3 _e4 = octagloss_source_from_world(probe_16, view_1, octagloss_lights);
#endif
    float cosine_13 = metal::clamp(metal::dot(_e3, _e4), octagloss_LEAST_COSINE, 1.0);
    level_view = _e4 - (_e3 * metal::dot(_e3, _e4));
    metal::float3 _e13 = level_view;
    metal::float3 _e14 = level_view;
    if (metal::dot(_e13, _e14) < 0.0000000001) {
        level_view = (metal::abs(_e3.x) > 0.5) ? metal::float3(0.0, 1.0, 0.0) : metal::float3(1.0, 0.0, 0.0);
    }
    metal::float3 _e31 = level_view;
    metal::float3 _e32 = level_view;
    metal::float3 towards_1 = metal::normalize(_e31 - (_e3 * metal::dot(_e3, _e32)));
    return octagloss_SurfaceFrame {_e3, towards_1, cosine_13, metal::sqrt(1.0 - (cosine_13 * cosine_13))};
}

metal::float3 octagloss_reflect_isotropic(
    metal::float3 normal_3,
    metal::float3 view_2,
    float roughness_5,
    metal::float3 f0_3,
    float f90_3,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    octagloss_SurfaceFrame _e6 = octagloss_surface_of(0u, normal_3, view_2, octagloss_lights);
    metal::float2 _e9 = octagloss_round_albedo(_e6.cosine, roughness_5, octagloss_tables);
    metal::float3 _e10 = octagloss_reflected_isotropic(0u, _e6, roughness_5, _e9, f0_3, f90_3, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
    return _e10;
}

metal::float2 octagloss_row_alphas(
    float roughness_6,
    float anisotropy
) {
    float alpha_12 = roughness_6 * roughness_6;
    return metal::float2(alpha_12 + (((1.0 - alpha_12) * anisotropy) * anisotropy), alpha_12);
}

float octagloss_row_share(
    metal::float2 alpha_3
) {
    return metal::smoothstep(0.0, 1.0, (alpha_3.x - alpha_3.y) / (octagloss_BLEND * metal::max(alpha_3.y, 0.000001)));
}

metal::float4 octagloss_row_places(
    metal::float2 alpha_4,
    float cosine_3,
    metal::float2 tangent_1
) {
    float sharp = metal::max(alpha_4.y, octagloss_ROW_SHARP);
    float azimuth = metal::atan2(metal::abs(tangent_1.y), metal::abs(tangent_1.x)) * 0.63661975;
    metal::float4 places_1 = metal::float4(metal::log2(1.0 + (5.0 * metal::sqrt(alpha_4.y))) * 0.3868528, metal::sqrt(cosine_3), 1.0 - metal::pow(metal::max(1.0 - azimuth, 0.0), 0.6666667), metal::log2(metal::max(alpha_4.x, sharp) / sharp) / -(metal::log2(metal::min(sharp, 0.999999))));
    return metal::clamp(places_1, metal::float4 {}, metal::float4(1.0));
}

octagloss_RowPlace octagloss_row_place(
    metal::float2 alpha_5,
    float cosine_4,
    metal::float2 tangent_2
) {
    metal::float4 _e3 = octagloss_row_places(alpha_5, cosine_4, tangent_2);
#ifdef OCTAGLOSS_CUBE
    metal::float4 place_5 = _e3 * metal::float4(15.0, 9.0, 7.0, 6.0);
    float lower = metal::min(metal::floor(place_5.w), 5.0);
    metal::float2 inside_1 = metal::clamp(place_5.xy, metal::float2(0.00390625), metal::float2(15.0, 9.0) - metal::float2(0.00390625));
    metal::float3 texel_1 = metal::float3(inside_1.x, inside_1.y + (10.0 * lower), place_5.z) + metal::float3(0.5);
    return octagloss_RowPlace {texel_1 / octagloss_ROW_SIZE, place_5.w - lower};
#else
    metal::float4 place_6 = _e3 * metal::float4(15.0, 9.0, 7.0, 6.0);
    float lower = metal::min(metal::floor(place_6.w), 5.0);
    metal::float2 inside_1 = metal::clamp(place_6.xy, metal::float2(0.00390625), metal::float2(15.0, 9.0) - metal::float2(0.00390625));
    metal::float3 texel_1 = metal::float3(inside_1.x, inside_1.y + (10.0 * lower), place_6.z) + metal::float3(0.5);
    return octagloss_RowPlace {texel_1 / octagloss_ROW_SIZE, place_6.w - lower};
#endif
}

metal::float4 octagloss_read_rows(
#ifdef OCTAGLOSS_CUBE
    metal::float3 at_3,
#else
    metal::float3 at_4,
#endif
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e4 = octagloss_rows.sample(octagloss_linear, at_3, metal::level(0.0));
#else
    metal::float4 _e4 = octagloss_rows.sample(octagloss_linear, at_4, metal::level(0.0));
#endif
    return _e4;
}

metal::float4 octagloss_row_node(
#ifdef OCTAGLOSS_CUBE
    uint layer_2,
#else
    uint layer_3,
#endif
    octagloss_RowPlace place,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
#ifdef OCTAGLOSS_CUBE
    metal::float3 at_6 = metal::float3(place.at[0] + (static_cast<float>(layer_2) / 21.0), metal::float3(place.at).yz);
    metal::float4 _e11 = octagloss_read_rows(at_6, octagloss_linear, octagloss_rows);
    metal::float4 _e18 = octagloss_read_rows(metal::float3(at_6.x, at_6.y + 0.10989011, at_6.z), octagloss_linear, octagloss_rows);
#else
    metal::float3 at_7 = metal::float3(place.at[0] + (static_cast<float>(layer_3) / 21.0), metal::float3(place.at).yz);
    metal::float4 _e11 = octagloss_read_rows(at_7, octagloss_linear, octagloss_rows);
    metal::float4 _e18 = octagloss_read_rows(metal::float3(at_7.x, at_7.y + 0.10989011, at_7.z), octagloss_linear, octagloss_rows);
#endif
    return metal::mix(_e11, _e18, place.share);
}

metal::float3 octagloss_blend_at(
    metal::float2 place_1,
    metal::float2 nodes,
    float column
) {
    metal::float2 inside_2 = metal::clamp(place_1, metal::float2(0.00390625), (nodes - metal::float2(1.0)) - metal::float2(0.00390625));
    return (metal::float3(column + inside_2.x, inside_2.y + 70.0, 0.0) + metal::float3(0.5)) / octagloss_ROW_SIZE;
}

metal::float4 octagloss_blend_texel(
#ifdef OCTAGLOSS_CUBE
    metal::float3 at_4,
    uint layer_3,
#else
    metal::float3 at_5,
    uint layer_4,
#endif
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e9 = octagloss_read_rows(at_4 + metal::float3(0.0, 0.0, static_cast<float>(layer_3) / 8.0), octagloss_linear, octagloss_rows);
#else
    metal::float4 _e9 = octagloss_read_rows(at_5 + metal::float3(0.0, 0.0, static_cast<float>(layer_4) / 8.0), octagloss_linear, octagloss_rows);
#endif
    return _e9;
}

metal::float2 octagloss_blend_place(
    float alpha_6,
    float cosine_5,
    metal::float2 nodes_1
) {
    float x_3 = metal::log2(1.0 + (15.0 * metal::sqrt(alpha_6))) * 0.25;
    float y_2 = (metal::sqrt(metal::sqrt(cosine_5)) - 0.31622776) / 0.6837722;
    return metal::clamp(metal::float2(x_3, y_2), metal::float2 {}, metal::float2(1.0)) * (nodes_1 - metal::float2(1.0));
}

metal::float2 octagloss_blend_of(
    metal::float2 first,
    metal::float3 shares,
    uint texels,
    metal::float3 blended,
#ifdef OCTAGLOSS_CUBE
    uint layer_4,
#else
    uint layer_5,
#endif
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float2 sum_5 = {};
    uint k_3 = 0u;
    sum_5 = first;
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e42 = k_3;
            k_3 = _e42 + 1u;
        }
        loop_init_8 = false;
        uint _e8 = k_3;
        if (_e8 < texels) {
        } else {
            break;
        }
        {
            uint _e10 = k_3;
            metal::float4 _e11 = octagloss_blend_texel(shares, _e10, octagloss_linear, octagloss_rows);
            uint _e13 = k_3;
#ifdef OCTAGLOSS_CUBE
            metal::float4 _e16 = octagloss_blend_texel(blended, layer_4 + (2u * _e13), octagloss_linear, octagloss_rows);
#else
            metal::float4 _e16 = octagloss_blend_texel(blended, layer_5 + (2u * _e13), octagloss_linear, octagloss_rows);
#endif
            uint _e18 = k_3;
#ifdef OCTAGLOSS_CUBE
            metal::float4 _e23 = octagloss_blend_texel(blended, (layer_4 + (2u * _e18)) + 1u, octagloss_linear, octagloss_rows);
#else
            metal::float4 _e23 = octagloss_blend_texel(blended, (layer_5 + (2u * _e18)) + 1u, octagloss_linear, octagloss_rows);
#endif
            metal::float2 _e24 = sum_5;
            sum_5 = _e24 + ((((_e11.x * _e16.xy) + (_e11.y * _e16.zw)) + (_e11.z * _e23.xy)) + (_e11.w * _e23.zw));
        }
    }
    metal::float2 _e44 = sum_5;
    return metal::max(_e44, metal::float2 {});
}

metal::float2 octagloss_blended_albedo(
    metal::float2 alpha_7,
    float cosine_6,
    metal::float2 tangent_3,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float2 squares = alpha_7 * alpha_7;
    metal::float2 seen_1 = metal::sqrt(metal::float2(squares.y) + (((squares.x - squares.y) * tangent_3) * tangent_3));
    float round = metal::min((alpha_7.x * alpha_7.y) / metal::max(seen_1.x * seen_1.y, 0.000000000001), 1.0);
    metal::float2 _e26 = octagloss_blend_place(seen_1.x, cosine_6, octagloss_BLEND_ALBEDO_NODES);
    float block = metal::min(metal::floor(_e26.y / octagloss_BLEND_STRIP), 2.0);
    metal::float2 size_1 = metal::float2(84.0, 21.0);
    metal::float3 _e43 = octagloss_blend_at(_e26 - metal::float2(0.0, octagloss_BLEND_STRIP * block), size_1, 84.0 * block);
    metal::float2 between = metal::float2(metal::sqrt(seen_1.y), round) * metal::float2(48.0, 10.0);
    metal::float3 _e53 = octagloss_blend_at(between, octagloss_BLEND_SHARE_NODES, octagloss_BLEND_SHARES_AT);
    metal::float2 _e59 = octagloss_blend_of(metal::float2(1.0, 0.0), _e53, 4u, _e43, 0u, octagloss_linear, octagloss_rows);
    return _e59;
}

metal::float2 octagloss_blended_mean(
    metal::float2 alpha_8,
    float cosine_7,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float2 _e4 = octagloss_blend_place(alpha_8.x, cosine_7, octagloss_BLEND_MEAN_NODES);
    metal::float3 _e7 = octagloss_blend_at(_e4, octagloss_BLEND_MEAN_NODES, octagloss_BLEND_SHARES_AT);
    float ratio = metal::sqrt(alpha_8.y / metal::max(alpha_8.x, 0.000000000001)) * 32.0;
    metal::float2 size_2 = metal::float2(33.0, 21.0);
    metal::float3 _e22 = octagloss_blend_at(metal::float2(ratio, 0.0), size_2, octagloss_BLEND_RATIOS_AT);
    metal::float2 _e25 = octagloss_round_albedo(cosine_7, metal::sqrt(alpha_8.x), octagloss_tables);
    metal::float2 _e28 = octagloss_blend_of(_e25, _e22, 2u, _e7, 4u, octagloss_linear, octagloss_rows);
    return _e28;
}

float octagloss_row_number(
    type_22 terms,
    metal::float4 a,
    metal::float4 b_1,
    metal::float4 c_1
) {
    return (metal::dot(terms.inner[0], a) + metal::dot(terms.inner[1], b_1)) + metal::dot(terms.inner[2], c_1);
}

octagloss_Row octagloss_row_of(
    metal::float2 alpha_9,
    metal::float2 tangent_4,
    float cosine_8
) {
    metal::float2 axis = metal::float2(1.0, 0.0);
    metal::float2 squares_1 = alpha_9 * alpha_9;
    float difference = squares_1.x - squares_1.y;
    float along_3 = squares_1.y + ((difference * tangent_4.x) * tangent_4.x);
    float across_3 = ((squares_1.y + ((difference * tangent_4.y) * tangent_4.y)) * cosine_8) * cosine_8;
    float mixed = ((difference * tangent_4.x) * tangent_4.y) * cosine_8;
    float apart_1 = 0.5 * (along_3 - across_3);
    float root_1 = metal::length(metal::float2(apart_1, mixed));
    float greatest = metal::max((0.5 * (along_3 + across_3)) + root_1, 0.000000000000000000000000000001);
    if (root_1 > 0.0) {
        metal::float2 steep = metal::float2(metal::abs(mixed), (root_1 - apart_1) * ((mixed >= 0.0) ? 1.0 : -1.0));
        axis = metal::normalize(((apart_1 >= 0.0) ? metal::float2(apart_1 + root_1, mixed) : steep) / metal::float2(root_1));
    }
    float x_4 = metal::log(metal::max(((alpha_9.x * alpha_9.y) * cosine_8) / greatest, octagloss_NARROWEST));
    float extent = metal::sqrt(greatest);
    float y_3 = metal::log(1.0 + (6.0 * extent));
    float _e75 = axis.x;
    float tilt = _e75 * metal::smoothstep(0.0, octagloss_TILTED, metal::sqrt(1.0 - (cosine_8 * cosine_8)));
    float _e85 = axis.x;
    float e_1 = _e85 * tilt;
    type_22 terms_1 = type_22 {{metal::float4(1.0, x_4, x_4 * x_4, y_3), metal::float4(x_4 * y_3, y_3 * y_3, e_1, e_1 * x_4), metal::float4((x_4 * x_4) * x_4, (y_3 * y_3) * y_3, (x_4 * x_4) * y_3, (x_4 * y_3) * y_3)}};
    float _e119 = octagloss_row_number(terms_1, metal::float4(-0.55, -0.357, -0.024, -0.112), metal::float4(-0.155, -0.099, 0.179, -0.206), metal::float4(-0.04, 0.145, -0.024, -0.063));
    float _e135 = octagloss_row_number(terms_1, metal::float4(-0.554, -0.031, 0.533, -0.071), metal::float4(0.392, 0.14, -0.295, 0.008), metal::float4(0.133, 0.121, 0.231, 0.259));
    float _e151 = octagloss_row_number(terms_1, metal::float4(-0.215, 0.021, 0.069, -0.271), metal::float4(0.356, 0.057, -0.463, -0.223), metal::float4(0.047, 0.086, 0.153, 0.094));
    float _e167 = octagloss_row_number(terms_1, metal::float4(0.55, 1.256, -0.003, -0.371), metal::float4(-0.377, -0.126, -0.001, 0.019), metal::float4(-0.02, 0.034, -0.066, -0.01));
    float _e183 = octagloss_row_number(terms_1, metal::float4(-0.516, 0.484, 0.15, 0.012), metal::float4(-0.583, 0.111, -0.02, -0.968), metal::float4(0.055, -0.352, -0.216, -0.214));
    float _e199 = octagloss_row_number(terms_1, metal::float4(0.5, 0.259, -0.071, -0.267), metal::float4(-0.373, -0.066, -0.039, -0.122), metal::float4(-0.014, -0.027, -0.072, -0.048));
    float _e201 = axis.x;
    float _e203 = axis.y;
    float _e216 = axis.x;
    return octagloss_Row {metal::float2(_e201, _e203 / cosine_8) * metal::sqrt(2.0 * root_1), extent, _e119 * tilt, metal::exp(metal::float4(_e135, _e151, _e167, _e183)), metal::exp(_e199), metal::smoothstep(0.0, octagloss_SKEWED, _e216)};
}

float octagloss_last_map(
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
#ifdef OCTAGLOSS_CUBE
    float _e0 = octagloss_map_inner(octagloss_maps);
    return metal::log2(_e0) - 3.0;
#else
    uint _e0 = octagloss_map_octave(octagloss_maps);
    return 1.0 + metal::floor((static_cast<float>(_e0) - 3.237039) / octagloss_LEVEL_OCTAVES);
#endif
}

metal::float2 octagloss_row_read(
    octagloss_Row row_1,
    uint read,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
#ifdef OCTAGLOSS_CUBE
    float place_6 = ((static_cast<float>(read) - 7.0) * 0.5714286) + row_1.shift;
    float slope_1 = ((row_1.steps.z * row_1.steps.x) * metal::sinh(row_1.steps.y * place_6)) / row_1.steps.y;
#else
    float place_7 = ((static_cast<float>(read) - 7.0) * 0.5714286) + row_1.shift;
    float slope_1 = ((row_1.steps.z * row_1.steps.x) * metal::sinh(row_1.steps.y * place_7)) / row_1.steps.y;
#endif
    float wider = (naga_mod(read, 2u) == 1u) ? row_1.alternation : (1.0 / row_1.alternation);
    float growth = row_1.steps.w * slope_1;
    float width = ((wider * row_1.steps.z) * metal::sqrt(1.0 + (growth * growth))) * row_1.extent;
    float _e44 = octagloss_last_map(octagloss_maps);
    float _e45 = octagloss_map_inner(octagloss_maps);
    float widest = metal::log2(_e45 * 0.19444445);
    float octaves = widest + metal::log2(metal::max(width, 0.000000001) / 0.35);
    float gaussian = _e44 + ((octaves - widest) / octagloss_LEVEL_OCTAVES);
    float below = metal::max(octaves / (widest - ((_e44 - 1.0) * octagloss_LEVEL_OCTAVES)), 0.0);
    return metal::float2(slope_1, (gaussian >= 1.0) ? metal::min(gaussian, _e44) : below);
}

type_13 octagloss_orders_aside(
#ifdef OCTAGLOSS_CUBE
    uint probe_16,
#else
    uint probe_17,
#endif
    octagloss_SurfaceFrame surface_3,
    metal::float3 across,
    metal::float3 d_2,
    constant type_7& octagloss_lights
) {
    metal::float3 level_2 = (surface_3.towards * d_2.x) + (surface_3.normal * d_2.z);
    type_12 _e14 = octagloss_harmonic_basis(level_2 + (across * d_2.y));
    type_12 _e18 = octagloss_harmonic_basis(level_2 - (across * d_2.y));
    type_12 difference_1 = type_12 {{_e14.inner[0] - _e18.inner[0], _e14.inner[1] - _e18.inner[1], _e14.inner[2] - _e18.inner[2], _e14.inner[3] - _e18.inner[3], _e14.inner[4] - _e18.inner[4], _e14.inner[5] - _e18.inner[5], _e14.inner[6] - _e18.inner[6], _e14.inner[7] - _e18.inner[7], _e14.inner[8] - _e18.inner[8], _e14.inner[9] - _e18.inner[9], _e14.inner[10] - _e18.inner[10], _e14.inner[11] - _e18.inner[11], _e14.inner[12] - _e18.inner[12], _e14.inner[13] - _e18.inner[13], _e14.inner[14] - _e18.inner[14], _e14.inner[15] - _e18.inner[15], _e14.inner[16] - _e18.inner[16], _e14.inner[17] - _e18.inner[17], _e14.inner[18] - _e18.inner[18], _e14.inner[19] - _e18.inner[19], _e14.inner[20] - _e18.inner[20], _e14.inner[21] - _e18.inner[21], _e14.inner[22] - _e18.inner[22], _e14.inner[23] - _e18.inner[23], _e14.inner[24] - _e18.inner[24]}};
#ifdef OCTAGLOSS_CUBE
    type_13 _e95 = octagloss_orders_of(probe_16, difference_1, octagloss_lights);
#else
    type_13 _e95 = octagloss_orders_of(probe_17, difference_1, octagloss_lights);
#endif
    return _e95;
}

metal::float2x3 octagloss_harmonics_aside(
#ifdef OCTAGLOSS_CUBE
    uint probe_17,
#else
    uint probe_18,
#endif
    octagloss_SurfaceFrame surface_4,
    metal::float3 across_1,
    octagloss_RowPlace place_2,
    metal::float2 first_1,
    constant type_7& octagloss_lights,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
#ifdef OCTAGLOSS_CUBE
    type_13 _e9 = octagloss_orders_aside(probe_17, surface_4, across_1, metal::float3(0.4620342, 0.54655075, -0.6984316), octagloss_lights);
    type_13 _e14 = octagloss_orders_aside(probe_17, surface_4, across_1, metal::float3(0.8966183, 0.38650447, 0.21607853), octagloss_lights);
    type_13 _e19 = octagloss_orders_aside(probe_17, surface_4, across_1, metal::float3(0.11814805, 0.3835753, 0.91592085), octagloss_lights);
    type_13 _e24 = octagloss_orders_aside(probe_17, surface_4, across_1, metal::float3(0.14011177, 0.8172301, -0.5590202), octagloss_lights);
#else
    type_13 _e9 = octagloss_orders_aside(probe_18, surface_4, across_1, metal::float3(0.4620342, 0.54655075, -0.6984316), octagloss_lights);
    type_13 _e14 = octagloss_orders_aside(probe_18, surface_4, across_1, metal::float3(0.8966183, 0.38650447, 0.21607853), octagloss_lights);
    type_13 _e19 = octagloss_orders_aside(probe_18, surface_4, across_1, metal::float3(0.11814805, 0.3835753, 0.91592085), octagloss_lights);
    type_13 _e24 = octagloss_orders_aside(probe_18, surface_4, across_1, metal::float3(0.14011177, 0.8172301, -0.5590202), octagloss_lights);
#endif
    metal::float4 _e26 = octagloss_row_node(16u, place_2, octagloss_linear, octagloss_rows);
    metal::float4 _e28 = octagloss_row_node(17u, place_2, octagloss_linear, octagloss_rows);
    metal::float4 _e30 = octagloss_row_node(18u, place_2, octagloss_linear, octagloss_rows);
    metal::float4 _e32 = octagloss_row_node(19u, place_2, octagloss_linear, octagloss_rows);
    metal::float2x3 _e34 = octagloss_weighed(_e9.inner[1], first_1);
    metal::float2x3 _e37 = octagloss_weighed(_e9.inner[2], _e26.xy);
    metal::float2x3 _e41 = octagloss_weighed(_e9.inner[3], _e26.zw);
    metal::float2x3 _e45 = octagloss_weighed(_e9.inner[4], _e28.xy);
    metal::float2x3 _e49 = octagloss_weighed(_e14.inner[2], _e28.zw);
    metal::float2x3 _e53 = octagloss_weighed(_e14.inner[3], _e30.xy);
    metal::float2x3 _e57 = octagloss_weighed(_e14.inner[4], _e30.zw);
    metal::float2x3 _e61 = octagloss_weighed(_e19.inner[3], _e32.xy);
    metal::float2x3 _e65 = octagloss_weighed(_e19.inner[4], _e32.zw);
    metal::float4 _e69 = octagloss_row_node(20u, place_2, octagloss_linear, octagloss_rows);
    metal::float2x3 _e71 = octagloss_weighed(_e24.inner[4], _e69.xy);
    return ((((((((_e34 + _e37) + _e41) + _e45) + _e49) + _e53) + _e57) + _e61) + _e65) + _e71;
}

metal::float3 octagloss_reflect_in_row(
#ifdef OCTAGLOSS_CUBE
    uint probe_18,
#else
    uint probe_19,
#endif
    octagloss_SurfaceFrame surface_5,
    metal::float2 tangent_5,
    metal::float2 alpha_10,
    metal::float2 albedo_2,
    metal::float3 f0_4,
    float f90_4,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float2x3 sum_6 = metal::float2x3 {};
    metal::float2 in_mirror_1 = metal::float2 {};
    metal::float2 white_1 = metal::float2 {};
    uint distance = 0u;
    metal::float2 mean = {};
    metal::float2 skew = {};
    uint side_1 = {};
    metal::float3 n_3 = surface_5.normal;
    metal::float3 across_4 = metal::cross(n_3, surface_5.towards);
    metal::float3 v_2 = (surface_5.towards * surface_5.sine) + (n_3 * surface_5.cosine);
    octagloss_RowPlace _e17 = octagloss_row_place(alpha_10, surface_5.cosine, tangent_5);
    octagloss_Row _e19 = octagloss_row_of(alpha_10, tangent_5, surface_5.cosine);
    metal::float3 axis_2 = (surface_5.towards * _e19.axis.x) + (across_4 * _e19.axis.y);
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e126 = distance;
            distance = _e126 + 1u;
        }
        loop_init_9 = false;
        uint _e36 = distance;
        if (_e36 <= octagloss_ROW_MIDDLE) {
        } else {
            break;
        }
        {
            uint _e39 = distance;
            metal::float4 _e40 = octagloss_row_node(_e39, _e17, octagloss_linear, octagloss_rows);
            mean = _e40.xy;
            skew = metal::float2 {};
            uint _e45 = distance;
            if (_e45 == 0u) {
                metal::float2x3 _e48 = sum_6;
#ifdef OCTAGLOSS_CUBE
                metal::float3 _e49 = octagloss_cosine_light(probe_18, n_3, octagloss_lights);
#else
                metal::float3 _e49 = octagloss_cosine_light(probe_19, n_3, octagloss_maps, octagloss_linear);
#endif
                metal::float2x3 _e51 = octagloss_weighed(_e49, _e40.zw);
                sum_6 = _e48 + _e51;
                metal::float2 _e53 = white_1;
                white_1 = _e53 + _e40.zw;
            } else {
                mean = 0.5 * (_e40.xy + _e40.zw);
                skew = (0.5 * _e19.skew) * (_e40.xy - _e40.zw);
            }
            side_1 = 0u;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e123 = side_1;
                    side_1 = _e123 + 1u;
                }
                loop_init_10 = false;
                uint _e70 = side_1;
                uint _e71 = distance;
                if (_e70 < metal::min(_e71 + 1u, 2u)) {
                } else {
                    break;
                }
                {
                    metal::float2 _e77 = mean;
                    metal::float2 _e78 = skew;
                    metal::float2 _e80 = mean;
                    metal::float2 _e81 = skew;
                    uint _e83 = side_1;
                    metal::float2 weights_3 = (_e83 == 0u) ? (_e80 + _e81) : (_e77 - _e78);
                    uint _e88 = distance;
                    uint _e91 = distance;
                    uint _e93 = side_1;
                    metal::float2 _e97 = octagloss_row_read(_e19, (_e93 == 0u) ? (octagloss_ROW_MIDDLE + _e91) : (octagloss_ROW_MIDDLE - _e88), octagloss_maps);
                    metal::float3 half_vector_1 = metal::normalize(n_3 + (_e97.x * axis_2));
                    metal::float3 direction_6 = (half_vector_1 * (2.0 * metal::dot(v_2, half_vector_1))) - v_2;
                    metal::float2x3 _e107 = sum_6;
#ifdef OCTAGLOSS_CUBE
                    metal::float3 _e109 = octagloss_between_levels(probe_18, direction_6, _e97.y, octagloss_maps, octagloss_linear);
#else
                    metal::float3 _e109 = octagloss_between_levels(probe_19, direction_6, _e97.y, octagloss_maps, octagloss_linear);
#endif
                    metal::float2x3 _e110 = octagloss_weighed(_e109, weights_3);
                    sum_6 = _e107 + _e110;
                    metal::float2 _e112 = white_1;
                    white_1 = _e112 + weights_3;
                    metal::float2 _e114 = in_mirror_1;
                    in_mirror_1 = _e114 + (weights_3 * metal::max(1.0 - _e97.y, 0.0));
                }
            }
        }
    }
    metal::float4 _e129 = octagloss_row_node(octagloss_ROW_PAIRS, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e131 = octagloss_row_node(9u, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e133 = octagloss_row_node(10u, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e135 = octagloss_row_node(11u, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e137 = octagloss_row_node(12u, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e139 = octagloss_row_node(13u, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e141 = octagloss_row_node(14u, _e17, octagloss_linear, octagloss_rows);
    metal::float4 _e143 = octagloss_row_node(15u, _e17, octagloss_linear, octagloss_rows);
    type_20 pairs_2 = type_20 {{_e129, _e131, _e133, _e135, _e137, _e139, _e141, _e143}};
    metal::float2x3 _e145 = sum_6;
#ifdef OCTAGLOSS_CUBE
    metal::float2x3 _e146 = octagloss_harmonics_reflected(probe_18, surface_5, pairs_2, octagloss_lights);
#else
    metal::float2x3 _e146 = octagloss_harmonics_reflected(probe_19, surface_5, pairs_2, octagloss_lights);
#endif
    sum_6 = _e145 + _e146;
    metal::float2 _e148 = white_1;
    white_1 = _e148 + pairs_2.inner[0].xy;
    metal::float3 mirrored = across_4 * (((tangent_5.x * tangent_5.y) < 0.0) ? -1.0 : 1.0);
    metal::float2x3 _e161 = sum_6;
#ifdef OCTAGLOSS_CUBE
    metal::float2x3 _e164 = octagloss_harmonics_aside(probe_18, surface_5, mirrored, _e17, pairs_2.inner[7].zw, octagloss_lights, octagloss_linear, octagloss_rows);
#else
    metal::float2x3 _e164 = octagloss_harmonics_aside(probe_19, surface_5, mirrored, _e17, pairs_2.inner[7].zw, octagloss_lights, octagloss_linear, octagloss_rows);
#endif
    sum_6 = _e161 + _e164;
    metal::float2 _e166 = white_1;
    metal::float2 shares_1 = albedo_2 / _e166;
    metal::float2x3 _e168 = sum_6;
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e173 = octagloss_lit_of(probe_18, _e168, f0_4 * shares_1.x, f90_4 * shares_1.y, octagloss_lights);
#else
    metal::float3 _e173 = octagloss_lit_of(probe_19, _e168, f0_4 * shares_1.x, f90_4 * shares_1.y, octagloss_lights);
#endif
    metal::float2 _e174 = in_mirror_1;
    float share_5 = metal::max(1.0 - (metal::dot(shares_1, _e174) / (albedo_2.x + albedo_2.y)), 0.0);
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e184 = octagloss_suns_reflected(probe_18, surface_5, tangent_5, alpha_10, f0_4, f90_4, octagloss_lights, octagloss_maps);
#else
    metal::float3 _e184 = octagloss_suns_reflected(probe_19, surface_5, tangent_5, alpha_10, f0_4, f90_4, octagloss_lights, octagloss_maps);
#endif
    return _e173 + (share_5 * _e184);
}

metal::float3 octagloss_reflect_of(
#ifdef OCTAGLOSS_CUBE
    uint probe_19,
#else
    uint probe_20,
#endif
    metal::float3 normal_4,
    metal::float3 view_3,
    metal::float3 tangent_6,
    float roughness_7,
    float anisotropy_1,
    metal::float3 f0_5,
    float f90_5,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float2 level_1 = metal::float2 {};
    bool local = {};
#ifdef OCTAGLOSS_CUBE
    octagloss_SurfaceFrame _e8 = octagloss_surface_of(probe_19, normal_4, view_3, octagloss_lights);
#else
    octagloss_SurfaceFrame _e8 = octagloss_surface_of(probe_20, normal_4, view_3, octagloss_lights);
#endif
    if (anisotropy_1 > 0.0) {
        local = metal::dot(tangent_6, tangent_6) > 0.0;
    } else {
        local = false;
    }
    bool _e19 = local;
    if (_e19) {
#ifdef OCTAGLOSS_CUBE
        metal::float3 _e20 = octagloss_source_from_world(probe_19, tangent_6, octagloss_lights);
#else
        metal::float3 _e20 = octagloss_source_from_world(probe_20, tangent_6, octagloss_lights);
#endif
        metal::float3 across_5 = metal::cross(_e8.normal, _e8.towards);
        level_1 = metal::float2(metal::dot(_e20, _e8.towards), metal::dot(_e20, across_5));
    }
    metal::float2 _e28 = level_1;
    metal::float2 _e29 = level_1;
    if (metal::dot(_e28, _e29) < 0.0000000001) {
        metal::float2 _e34 = octagloss_round_albedo(_e8.cosine, roughness_7, octagloss_tables);
#ifdef OCTAGLOSS_CUBE
        metal::float3 _e35 = octagloss_reflected_isotropic(probe_19, _e8, roughness_7, _e34, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
#else
        metal::float3 _e35 = octagloss_reflected_isotropic(probe_20, _e8, roughness_7, _e34, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
#endif
        return _e35;
    }
    metal::float2 _e38 = octagloss_row_alphas(roughness_7, metal::min(anisotropy_1, 1.0));
    float _e39 = octagloss_row_share(_e38);
    metal::float2 _e40 = level_1;
    metal::float2 unit_level = metal::normalize(_e40);
    metal::float2 _e43 = octagloss_blended_albedo(_e38, _e8.cosine, unit_level, octagloss_linear, octagloss_rows);
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e44 = octagloss_reflect_in_row(probe_19, _e8, unit_level, _e38, _e43, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_linear, octagloss_rows);
#else
    metal::float3 _e44 = octagloss_reflect_in_row(probe_20, _e8, unit_level, _e38, _e43, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_linear, octagloss_rows);
#endif
    metal::float3 sum_7 = _e39 * _e44;
    if (_e39 == 1.0) {
        return sum_7;
    }
    float round_1 = metal::sqrt(metal::sqrt(_e38.x * _e38.y));
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e55 = octagloss_reflected_isotropic(probe_19, _e8, round_1, _e43, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
#else
    metal::float3 _e55 = octagloss_reflected_isotropic(probe_20, _e8, round_1, _e43, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
#endif
    return sum_7 + ((1.0 - _e39) * _e55);
}

metal::float3 octagloss_reflect(
    metal::float3 normal_5,
    metal::float3 view_4,
    metal::float3 tangent_7,
    float roughness_8,
    float anisotropy_2,
    metal::float3 f0_6,
    float f90_6,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float3 _e8 = octagloss_reflect_of(0u, normal_5, view_4, tangent_7, roughness_8, anisotropy_2, f0_6, f90_6, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear, octagloss_rows);
    return _e8;
}

metal::float2 octagloss_albedo(
    float cosine_9,
    float roughness_9,
    float anisotropy_3,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    if (anisotropy_3 <= 0.0) {
        metal::float2 _e5 = octagloss_round_albedo(cosine_9, roughness_9, octagloss_tables);
        return _e5;
    }
    metal::float2 _e8 = octagloss_row_alphas(roughness_9, metal::min(anisotropy_3, 1.0));
    metal::float2 _e12 = octagloss_blended_mean(_e8, metal::clamp(cosine_9, octagloss_LEAST_COSINE, 1.0), octagloss_tables, octagloss_linear, octagloss_rows);
    return _e12;
}

metal::float2 octagloss_albedo_along(
    float cosine_10,
    float along,
    float roughness_10,
    float anisotropy_4,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    if (anisotropy_4 <= 0.0) {
        metal::float2 _e6 = octagloss_round_albedo(cosine_10, roughness_10, octagloss_tables);
        return _e6;
    }
    float seen_2 = metal::clamp(cosine_10, octagloss_LEAST_COSINE, 1.0);
    float x_5 = metal::min(metal::abs(along) / metal::max(metal::sqrt(1.0 - (seen_2 * seen_2)), 0.0001), 1.0);
    metal::float2 _e22 = octagloss_row_alphas(roughness_10, metal::min(anisotropy_4, 1.0));
    metal::float2 _e28 = octagloss_blended_albedo(_e22, seen_2, metal::float2(x_5, metal::sqrt(1.0 - (x_5 * x_5))), octagloss_linear, octagloss_rows);
    return _e28;
}
