// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2, octagloss_rows pyramid_rows.ktx2, of which isotropic reflections read
// nothing; octagloss_linear is a sampler, linear in texels and in mip levels and clamped to the edge.
// Directions are in the world, right-handed, y up. To use: octagloss_radiance, octagloss_irradiance,
// octagloss_reflect, octagloss_reflect_isotropic, octagloss_albedo and octagloss_albedo_along; `probe` is 0.
#ifdef OCTAGLOSS_CUBE
// The maps are one cube, of `--map cube`; in OpenGL enable GL_TEXTURE_CUBE_MAP_SEAMLESS.
// Translated from pyramid_cube.wgsl, FNV-1a 643dc7aafa1e0396.
#else
// Translated from pyramid.wgsl, FNV-1a 21f875d2524788b4.
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
    float inner[5];
};
#ifdef OCTAGLOSS_CUBE
typedef metal::float3 octagloss_MapPlace;
struct type_14 {
#else
typedef metal::float2 octagloss_MapPlace;
struct type_15 {
#endif
    metal::float4 inner[4];
};
#ifdef OCTAGLOSS_CUBE
struct type_16 {
#else
struct type_18 {
#endif
    float inner[7];
};
struct octagloss_SurfaceFrame {
    metal::float3 normal;
    metal::packed_float3 towards;
    float cosine;
    float sine;
    char _pad4[12];
};
#ifdef OCTAGLOSS_CUBE
struct type_18 {
#else
struct type_19 {
#endif
    metal::float3 inner[5];
};
#ifdef OCTAGLOSS_CUBE
struct type_19 {
#else
struct type_20 {
#endif
    metal::float4 inner[8];
};
#ifdef OCTAGLOSS_CUBE
struct type_20 {
#else
struct type_21 {
#endif
    metal::float2 inner[5];
};
#ifdef OCTAGLOSS_CUBE
struct type_21 {
#else
struct type_22 {
#endif
    metal::float4 inner[3];
};
#ifdef OCTAGLOSS_CUBE
struct type_22 {
#else
struct type_23 {
#endif
    metal::float2 inner[3];
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
#ifdef OCTAGLOSS_CUBE
struct type_23 {
#else
struct type_24 {
#endif
    metal::float3 inner[4];
};
constant uint octagloss_SUNS = 8u;
constant uint octagloss_INTERVALS = 640u;
#ifndef OCTAGLOSS_CUBE
constant int octagloss_MIRROR = 1;
constant int octagloss_SHARP = 2;
constant int octagloss_LEVELS = 0;
#endif
constant uint octagloss_READS = 9u;
constant uint octagloss_LAYERS = 18u;
constant metal::float2 octagloss_NODES = metal::float2(46.0, 26.0);
constant float octagloss_LEAST_COSINE = 0.01;
constant metal::float2 octagloss_ALBEDO_NODES = metal::float2(91.0, 75.0);
constant metal::float4 octagloss_DIP = metal::float4(0.222, 0.634, 0.098, 0.3126);
constant float octagloss_LEAST_ALPHA = 0.000001;
constant metal::float2 octagloss_TABLES = metal::float2(864.0, 39.0);
constant metal::float4 octagloss_ROW_NODES = metal::float4(16.0, 10.0, 8.0, 7.0);
constant uint octagloss_ROW_MIDDLE = 7u;
constant uint octagloss_ROW_PAIRS = 8u;
constant uint octagloss_ROW_LAYERS = 21u;
constant metal::float4 octagloss_ROW_ALBEDO_NODES = metal::float4(16.0, 10.0, 8.0, 13.0);
constant float octagloss_ROW_BLOCKS = 21.0;
constant metal::float3 octagloss_ROW_SIZE = metal::float3(336.0, 80.0, 8.0);
constant float octagloss_ROW_SHARP = 0.001;
constant float octagloss_NARROWEST = 0.05;
constant float octagloss_BLEND = 0.1;
constant float octagloss_TILTED = 0.5;
constant float octagloss_SKEWED = 0.2;

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

metal::float3 octagloss_harmonics_around(
    uint probe_1,
    metal::float3 d_1,
    type_13 weights,
    constant type_7& octagloss_lights
) {
    type_12 basis = {};
    metal::float3 sum = metal::float3 {};
    uint order = 0u;
    metal::float3 own = {};
    uint k = {};
    type_12 _e3 = octagloss_harmonic_basis(d_1);
    basis = _e3;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e50 = order;
            order = _e50 + 1u;
        }
        loop_init = false;
        uint _e9 = order;
        if (_e9 < 5u) {
        } else {
            break;
        }
        {
            own = metal::float3 {};
            uint _e14 = order;
            uint _e15 = order;
            k = _e14 * _e15;
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e41 = k;
                    k = _e41 + 1u;
                }
                loop_init_1 = false;
                uint _e18 = k;
                uint _e19 = order;
                uint _e22 = order;
                if (_e18 < ((_e19 + 1u) * (_e22 + 1u))) {
                } else {
                    break;
                }
                {
                    metal::float3 _e27 = own;
                    uint _e28 = k;
                    float _e30 = basis.inner[_e28];
                    uint _e34 = k;
                    metal::float4 _e36 = octagloss_lights.inner[probe_1].harmonics.inner[_e34];
                    own = _e27 + (_e30 * _e36.xyz);
                }
            }
            metal::float3 _e43 = sum;
            uint _e44 = order;
            metal::float3 _e46 = own;
            sum = _e43 + (weights.inner[_e44] * _e46);
        }
    }
    metal::float3 _e52 = sum;
    return _e52;
#ifndef OCTAGLOSS_CUBE
}

float octagloss_map_inner(
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    return static_cast<float>(metal::uint2(octagloss_maps.get_width(), octagloss_maps.get_height()).x) * 0.9411765;
}

float octagloss_map_border(
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    return static_cast<float>(metal::uint2(octagloss_maps.get_width(), octagloss_maps.get_height()).x) / 34.0;
#endif
}

octagloss_MapPlace octagloss_place_of(
#ifdef OCTAGLOSS_CUBE
    metal::float3 direction_1
#else
    metal::float3 direction_1,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
#ifdef OCTAGLOSS_CUBE
    return direction_1;
#else
    metal::float3 p = direction_1 / metal::float3((metal::abs(direction_1.x) + metal::abs(direction_1.y)) + metal::abs(direction_1.z));
    metal::float2 folded = metal::float2(1.0) - metal::abs(p.zx);
    metal::float2 turned = metal::float2((p.x >= 0.0) ? folded.x : -(folded.x), (p.z >= 0.0) ? folded.y : -(folded.y));
    metal::float2 uv = (p.y >= 0.0) ? p.xz : turned;
    float _e36 = octagloss_map_inner(octagloss_maps);
    float _e39 = octagloss_map_border(octagloss_maps);
    return metal::float2(0.5) + (uv * ((0.5 * _e36) / (_e36 + (2.0 * _e39))));
#endif
}

#ifdef OCTAGLOSS_CUBE
type_14 octagloss_node_weights(
#else
type_15 octagloss_node_weights(
#endif
    uint node,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
#ifdef OCTAGLOSS_CUBE
    type_14 weights_1 = type_14 {};
#else
    type_15 weights_1 = type_15 {};
#endif
    uint row = 0u;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e18 = row;
            row = _e18 + 1u;
        }
        loop_init_2 = false;
        uint _e5 = row;
        if (_e5 < 4u) {
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
#ifdef OCTAGLOSS_CUBE
    type_14 _e20 = weights_1;
#else
    type_15 _e20 = weights_1;
#endif
    return _e20;
}

metal::float3 octagloss_read_mirror(
    uint probe_2,
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace at,
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::float2 at,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e5 = octagloss_maps.sample(octagloss_linear, at, metal::level(0.0));
    return _e5.xyz;
#else
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at, octagloss_MIRROR, metal::level(0.0));
    return _e6.xyz;
#endif
}

metal::float3 octagloss_read_sharp(
    uint probe_3,
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace at_1,
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::float2 at_1,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e5 = octagloss_maps.sample(octagloss_linear, at_1, metal::level(1.0));
    return _e5.xyz;
#else
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at_1, octagloss_SHARP, metal::level(0.0));
    return _e6.xyz;
#endif
}

metal::float3 octagloss_read_levels(
    uint probe_4,
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace at_2,
#else
    metal::float2 at_2,
#endif
    float level,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear
#ifndef OCTAGLOSS_CUBE
) {
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at_2, octagloss_LEVELS, metal::level(level));
    return _e6.xyz;
}

octagloss_MapPlace octagloss_place_in_cosine(
    octagloss_MapPlace at_3,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e7 = octagloss_maps.sample(octagloss_linear, at_2, metal::level(level + 2.0));
    return _e7.xyz;
#else
    float _e1 = octagloss_map_inner(octagloss_maps);
    float _e2 = octagloss_map_border(octagloss_maps);
    float size = _e1 + (2.0 * _e2);
    float _e9 = octagloss_map_inner(octagloss_maps);
    return metal::float2(0.5) + ((at_3 - metal::float2(0.5)) * ((size / _e9) * 0.9411765));
#endif
}

metal::float3 octagloss_read_cosine(
    uint probe_5,
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace at_3,
    constant type_7& octagloss_lights
#else
    metal::float2 at_4,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e8 = octagloss_harmonics_around(probe_5, at_3, type_13 {{1.0, 0.6666667, 0.25, 0.0, -0.041666668}}, octagloss_lights);
    return _e8;
#else
    float _e2 = octagloss_map_inner(octagloss_maps);
    float last = metal::rint(metal::log2(_e2 / 32.0));
    octagloss_MapPlace _e9 = octagloss_place_in_cosine(at_4, octagloss_maps);
    metal::float4 _e11 = octagloss_maps.sample(octagloss_linear, _e9, octagloss_MIRROR, metal::level(last));
    return _e11.xyz;
#endif
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

metal::float3 octagloss_half_axis_of(
    uint probe_6,
    uint disc,
    constant type_7& octagloss_lights
) {
    uint k_8 = 3u * naga_div(disc, 2u);
    float _e11 = octagloss_lights.inner[probe_6].harmonics.inner[k_8].w;
    float _e19 = octagloss_lights.inner[probe_6].harmonics.inner[k_8 + 1u].w;
    float _e27 = octagloss_lights.inner[probe_6].harmonics.inner[k_8 + 2u].w;
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
    uint probe_7,
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
#ifdef OCTAGLOSS_CUBE
    type_14 low = {};
    type_14 high = {};
#else
    type_15 low = {};
    type_15 high = {};
#endif
    metal::float3 sum_1 = metal::float3 {};
#ifdef OCTAGLOSS_CUBE
    type_16 levels = {};
#else
    type_18 levels = {};
#endif
    uint level_1 = 0u;
    uint disc_1 = 0u;
    metal::float3 _e3 = octagloss_source_from_world(probe_7, direction_2, octagloss_lights);
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace _e4 = octagloss_place_of(_e3);
#else
    octagloss_MapPlace _e4 = octagloss_place_of(_e3, octagloss_maps);
#endif
    float node_1 = metal::log2(1.0 + (50.0 * roughness)) * 112.826515;
    uint k_9 = metal::min(naga_f2u32(node_1), 639u);
    float share = node_1 - static_cast<float>(k_9);
#ifdef OCTAGLOSS_CUBE
    type_14 _e17 = octagloss_node_weights(k_9, octagloss_tables);
#else
    type_15 _e17 = octagloss_node_weights(k_9, octagloss_tables);
#endif
    low = _e17;
#ifdef OCTAGLOSS_CUBE
    type_14 _e21 = octagloss_node_weights(k_9 + 1u, octagloss_tables);
#else
    type_15 _e21 = octagloss_node_weights(k_9 + 1u, octagloss_tables);
#endif
    high = _e21;
    metal::float4 _e24 = low.inner[0];
    metal::float4 _e26 = high.inner[0];
    metal::float4 a_1 = metal::mix(_e24, _e26, share);
    metal::float4 _e29 = low.inner[1];
    metal::float4 _e31 = high.inner[1];
    metal::float4 b_1 = metal::mix(_e29, _e31, share);
    metal::float4 _e34 = low.inner[2];
    metal::float4 _e36 = high.inner[2];
    metal::float4 c_2 = metal::mix(_e34, _e36, share);
    metal::float4 _e39 = low.inner[3];
    metal::float4 _e41 = high.inner[3];
    metal::float4 e = metal::mix(_e39, _e41, share);
    if (a_1.x != 0.0) {
        metal::float3 _e48 = sum_1;
        metal::float3 _e50 = octagloss_read_mirror(probe_7, _e4, octagloss_maps, octagloss_linear);
        sum_1 = _e48 + (a_1.x * _e50);
    }
    if (a_1.y != 0.0) {
        metal::float3 _e56 = sum_1;
        metal::float3 _e58 = octagloss_read_sharp(probe_7, _e4, octagloss_maps, octagloss_linear);
        sum_1 = _e56 + (a_1.y * _e58);
    }
#ifdef OCTAGLOSS_CUBE
    levels = type_16 {{a_1.z, a_1.w, b_1.x, b_1.y, b_1.z, b_1.w, c_2.x}};
#else
    levels = type_18 {{a_1.z, a_1.w, b_1.x, b_1.y, b_1.z, b_1.w, c_2.x}};
#endif
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e90 = level_1;
            level_1 = _e90 + 1u;
        }
        loop_init_3 = false;
        uint _e72 = level_1;
        if (_e72 < 7u) {
        } else {
            break;
        }
        {
            uint _e75 = level_1;
            float _e77 = levels.inner[_e75];
            if (_e77 != 0.0) {
                metal::float3 _e80 = sum_1;
                uint _e81 = level_1;
                float _e83 = levels.inner[_e81];
                uint _e84 = level_1;
                metal::float3 _e86 = octagloss_read_levels(probe_7, _e4, static_cast<float>(_e84), octagloss_maps, octagloss_linear);
                sum_1 = _e80 + (_e83 * _e86);
            }
        }
    }
    if (c_2.y != 0.0) {
        metal::float3 _e95 = sum_1;
#ifdef OCTAGLOSS_CUBE
        metal::float3 _e97 = octagloss_read_cosine(probe_7, _e4, octagloss_lights);
#else
        metal::float3 _e97 = octagloss_read_cosine(probe_7, _e4, octagloss_maps, octagloss_linear);
#endif
        sum_1 = _e95 + (c_2.y * _e97);
    }
    metal::float3 _e100 = sum_1;
    metal::float3 _e107 = octagloss_harmonics_around(probe_7, _e3, type_13 {{c_2.z, c_2.w, e.x, e.y, e.z}}, octagloss_lights);
    sum_1 = _e100 + _e107;
    metal::float3 _e109 = sum_1;
    float _e115 = octagloss_lights.inner[probe_7].unscale;
    sum_1 = metal::max(_e109, metal::float3 {}) * _e115;
    float a2_ = ((roughness * roughness) * roughness) * roughness;
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e225 = disc_1;
            disc_1 = _e225 + 1u;
        }
        loop_init_4 = false;
        uint _e122 = disc_1;
        if (_e122 < 16u) {
        } else {
            break;
        }
        {
            uint _e128 = disc_1;
            OctaglossSun sun = octagloss_lights.inner[probe_7].suns.inner[naga_div(_e128, 2u)];
            uint _e133 = disc_1;
            metal::float3 _e134 = octagloss_half_axis_of(probe_7, _e133, octagloss_lights);
            float _e135 = octagloss_squared(_e134);
            float nearer = 1.0 - (0.5 * _e135);
            metal::float3 to = _e3 - _e134;
            float _e145 = octagloss_squared(to - (nearer * sun.red.xyz));
            float _e150 = octagloss_squared(to - (nearer * sun.green.xyz));
            float _e155 = octagloss_squared(to - (nearer * sun.blue.xyz));
            metal::float3 apart = metal::float3(_e145, _e150, _e155);
            metal::float3 s = metal::min(0.25 * apart, metal::float3(0.5));
            metal::float3 radius2_ = 0.5 * metal::float3(sun.red.w, sun.green.w, sun.blue.w);
            metal::float3 nearness = (s + (a2_ * (metal::float3(1.0) - s))) - radius2_;
            metal::float3 root = metal::max(metal::sqrt((nearness * nearness) + ((4.0 * a2_) * radius2_)), metal::float3(0.000000000000000000000000000001));
            metal::float3 outside = metal::float3(2.0 * a2_) / (root * metal::max(root + nearness, metal::float3(0.000000000000000000000000000001)));
            metal::float3 inside = (root - nearness) / ((2.0 * metal::max(radius2_, metal::float3(0.000000000000000000000000000001))) * root);
            metal::float3 lobe = (0.15915494 * metal::select(inside, outside, nearness > metal::float3 {})) * (metal::float3(1.0) - (2.0 * s));
            metal::float3 _e214 = sum_1;
            sum_1 = _e214 + ((sun.energy * lobe) * (e.w * (1.0 - a_1.x)));
        }
    }
    metal::float3 _e227 = sum_1;
    return _e227;
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
    uint probe_8,
    metal::float3 normal,
#ifdef OCTAGLOSS_CUBE
    constant type_7& octagloss_lights
#else
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
    metal::float3 sum_2 = {};
    uint k_1 = 0u;
    metal::float3 _e2 = octagloss_source_from_world(probe_8, normal, octagloss_lights);
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace _e3 = octagloss_place_of(_e2);
    metal::float3 _e4 = octagloss_read_cosine(probe_8, _e3, octagloss_lights);
#else
    octagloss_MapPlace _e3 = octagloss_place_of(_e2, octagloss_maps);
    metal::float3 _e4 = octagloss_read_cosine(probe_8, _e3, octagloss_maps, octagloss_linear);
#endif
    float _e8 = octagloss_lights.inner[probe_8].unscale;
    sum_2 = _e4 * _e8;
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e41 = k_1;
            k_1 = _e41 + 1u;
        }
        loop_init_5 = false;
        uint _e13 = k_1;
        if (_e13 < octagloss_SUNS) {
        } else {
            break;
        }
        {
            uint _e19 = k_1;
            OctaglossSun sun_1 = octagloss_lights.inner[probe_8].suns.inner[_e19];
            metal::float3 facing = metal::float3(metal::dot(_e2, sun_1.red.xyz), metal::dot(_e2, sun_1.green.xyz), metal::dot(_e2, sun_1.blue.xyz));
            metal::float3 _e32 = sum_2;
            sum_2 = _e32 + (sun_1.energy * (0.31830987 * metal::max(facing, metal::float3 {})));
        }
    }
    metal::float3 _e43 = sum_2;
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
    uint layer,
#ifdef OCTAGLOSS_CUBE
    metal::float2 at_4,
#else
    metal::float2 at_5,
#endif
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float2 corner = metal::float2(1.0 + (static_cast<float>(layer) * 48.0), 0.0);
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e17 = octagloss_tables.sample(octagloss_linear, ((at_4 * octagloss_NODES) + corner) / octagloss_TABLES, metal::level(0.0));
#else
    metal::float4 _e17 = octagloss_tables.sample(octagloss_linear, ((at_5 * octagloss_NODES) + corner) / octagloss_TABLES, metal::level(0.0));
#endif
    return _e17;
}

metal::float4 octagloss_reflection_node(
    uint layer_1,
    float roughness_2,
    float cosine,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    float sine = metal::sqrt(metal::max(1.0 - (cosine * cosine), 0.0));
    metal::float2 place_2 = metal::float2(metal::log2(1.0 + (10.0 * roughness_2)) * 0.28906482, metal::sqrt(cosine * metal::rsqrt(1.0 + sine)));
#ifdef OCTAGLOSS_CUBE
    metal::float2 at_6 = ((place_2 * metal::float2(45.0, 25.0)) + metal::float2(0.5)) / octagloss_NODES;
    metal::float4 _e31 = octagloss_read_reflections(layer_1, at_6, octagloss_tables, octagloss_linear);
#else
    metal::float2 at_7 = ((place_2 * metal::float2(45.0, 25.0)) + metal::float2(0.5)) / octagloss_NODES;
    metal::float4 _e31 = octagloss_read_reflections(layer_1, at_7, octagloss_tables, octagloss_linear);
#endif
    return _e31;
}

metal::float4 octagloss_read_albedo(
    uint texel,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    metal::float4 _e9 = octagloss_tables.read(metal::uint2(metal::uint2(naga_mod(texel, 864u), 31u + naga_div(texel, 864u))), 0);
    return _e9;
}

metal::float2 octagloss_round_albedo(
    float cosine_1,
    float roughness_3,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    float seen = metal::clamp(cosine_1, 0.0001, 1.0);
    metal::float2 places = metal::float2(metal::log2(1.0 + (30.0 * roughness_3)) * 0.2018487, (metal::sqrt(metal::sqrt(seen)) - 0.1) / 0.9);
    metal::float2 place_3 = metal::clamp(places, metal::float2 {}, metal::float2(1.0)) * metal::float2(90.0, 74.0);
    metal::float2 node_2 = metal::min(metal::floor(place_3), metal::float2(89.0, 73.0));
    metal::float2 share_1 = place_3 - node_2;
    uint first = naga_f2u32(node_2.x + (91.0 * node_2.y));
    metal::float4 _e39 = octagloss_read_albedo(first, octagloss_tables);
    metal::float4 _e42 = octagloss_read_albedo(first + 91u, octagloss_tables);
    metal::float4 pair_2 = metal::mix(_e39, _e42, share_1.y);
    float t = seen / metal::max(roughness_3 * roughness_3, octagloss_LEAST_ALPHA);
    float left = 1.0 - ((0.222 * t) / (1.0 + (t * (0.634 + (t * (0.098 + (t * 0.3126)))))));
    return left * metal::mix(pair_2.xy, pair_2.zw, share_1.x);
}

metal::float3 octagloss_between_levels(
    uint probe_9,
    metal::float3 direction_4,
    float level_2,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps,
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
#endif
    metal::sampler octagloss_linear
) {
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace _e3 = octagloss_place_of(direction_4);
#else
    octagloss_MapPlace _e3 = octagloss_place_of(direction_4, octagloss_maps);
#endif
    if (level_2 >= 2.0) {
        metal::float3 _e8 = octagloss_read_levels(probe_9, _e3, level_2 - 2.0, octagloss_maps, octagloss_linear);
        return _e8;
    }
    if (level_2 >= 1.0) {
        metal::float3 _e11 = octagloss_read_sharp(probe_9, _e3, octagloss_maps, octagloss_linear);
        metal::float3 _e13 = octagloss_read_levels(probe_9, _e3, 0.0, octagloss_maps, octagloss_linear);
        return metal::mix(_e11, _e13, level_2 - 1.0);
    }
    metal::float3 _e17 = octagloss_read_mirror(probe_9, _e3, octagloss_maps, octagloss_linear);
    metal::float3 _e18 = octagloss_read_sharp(probe_9, _e3, octagloss_maps, octagloss_linear);
    return metal::mix(_e17, _e18, level_2);
}

float octagloss_masking_of(
    metal::float3 w,
    metal::float2 alpha
) {
    return metal::length(metal::float3(alpha * w.xy, w.z));
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
    float along_2 = metal::dot(h, l);
#ifdef OCTAGLOSS_CUBE
    float size = (above * (2.0 - above)) / (length2_ * bend);
    float trace = size * metal::dot(shape, metal::float3(1.0) - (l * l));
#else
    float size_1 = (above * (2.0 - above)) / (length2_ * bend);
    float trace = size_1 * metal::dot(shape, metal::float3(1.0) - (l * l));
#endif
    float _e60 = octagloss_squared(metal::cross(l, bent));
#ifdef OCTAGLOSS_CUBE
    float aside_1 = trace - ((size * _e60) / bend);
#else
    float aside_1 = trace - ((size_1 * _e60) / bend);
#endif
    float _e64 = octagloss_masking_of(l, alpha_1);
#ifdef OCTAGLOSS_CUBE
    float determinant = ((size * size) * _e64) * _e64;
#else
    float determinant = ((size_1 * size_1) * _e64) * _e64;
#endif
    float near = ((shape.z * along_2) * along_2) / ((bend * _e64) * _e64);
#ifdef OCTAGLOSS_CUBE
    float last = determinant * near;
#else
    float last_1 = determinant * near;
#endif
    float linear = 1.0 - trace;
    x = metal::max(0.5 * (linear + metal::sqrt((linear * linear) + ((4.0 * trace) * near))), near);
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e140 = step;
            step = _e140 + 1u;
        }
        loop_init_6 = false;
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
#ifdef OCTAGLOSS_CUBE
            side = ((_e112 + aside_1) * _e114) + last;
#else
            side = ((_e112 + aside_1) * _e114) + last_1;
#endif
            float _e117 = x;
            float _e121 = x;
            float _e129 = x;
            float _e135 = x;
#ifdef OCTAGLOSS_CUBE
            slope = ((((((((_e117 + (2.0 * aside_1)) * _e121) + (3.0 * last)) + (trace * aside_1)) - determinant) * _e129) + ((2.0 * trace) * last)) * _e135) + (determinant * last);
#else
            slope = ((((((((_e117 + (2.0 * aside_1)) * _e121) + (3.0 * last_1)) + (trace * aside_1)) - determinant) * _e129) + ((2.0 * trace) * last_1)) * _e135) + (determinant * last_1);
#endif
        }
    }
    float _e143 = x;
#ifdef OCTAGLOSS_CUBE
    metal::float3 inverse = metal::float3(1.0) / ((size * shape) + metal::float3(_e143));
#else
    metal::float3 inverse = metal::float3(1.0) / ((size_1 * shape) + metal::float3(_e143));
#endif
    float _e152 = x;
#ifdef OCTAGLOSS_CUBE
    float towards = (size * metal::dot(l, inverse * bent)) / (_e152 * metal::dot(l, inverse * l));
#else
    float towards = (size_1 * metal::dot(l, inverse * bent)) / (_e152 * metal::dot(l, inverse * l));
#endif
    metal::float3 axis_1 = metal::normalize(inverse * (h + (towards * l)));
    float cosine_10 = metal::dot(view, axis_1);
    metal::float3 lit = ((2.0 * cosine_10) * axis_1) - view;
    float facing_1 = metal::max(lit.z, 0.0);
    float _e169 = side;
    float _e170 = x;
    float _e171 = slope;
    float lobe_1 = (metal::sqrt(_e169 / (((_e170 * _e171) * bend) * metal::dot(axis_1, shape * axis_1))) * shape.z) / (3.1415927 * bend);
    float share_2 = metal::pow(left_1, 1.25) * (1.0 - (0.5 * above));
    float _e191 = octagloss_masking_of(view, alpha_1);
    float _e194 = octagloss_masking_of(lit, alpha_1);
    float visible = facing_1 / ((facing_1 * _e191) + (view.z * _e194));
    float value = (((((share_2 * 2.0) * along_2) * cosine_10) / length2_) * lobe_1) * visible;
    return metal::float2(value, metal::pow(metal::max(1.0 - cosine_10, 0.0), 5.0));
}

#ifdef OCTAGLOSS_CUBE
type_18 octagloss_harmonic_orders(
#else
type_19 octagloss_harmonic_orders(
#endif
    uint probe_10,
    metal::float3 d_2,
    constant type_7& octagloss_lights
) {
    type_12 basis_1 = {};
#ifdef OCTAGLOSS_CUBE
    type_18 sums = type_18 {};
#else
    type_19 sums = type_19 {};
#endif
    uint order_1 = 0u;
    uint k_2 = {};
    type_12 _e2 = octagloss_harmonic_basis(d_2);
    basis_1 = _e2;
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e43 = order_1;
            order_1 = _e43 + 1u;
        }
        loop_init_7 = false;
        uint _e8 = order_1;
        if (_e8 < 5u) {
        } else {
            break;
        }
        {
            uint _e11 = order_1;
            uint _e12 = order_1;
            k_2 = _e11 * _e12;
            bool loop_init_8 = true;
            while(true) {
                if (!loop_init_8) {
                    uint _e40 = k_2;
                    k_2 = _e40 + 1u;
                }
                loop_init_8 = false;
                uint _e15 = k_2;
                uint _e16 = order_1;
                uint _e19 = order_1;
                if (_e15 < ((_e16 + 1u) * (_e19 + 1u))) {
                } else {
                    break;
                }
                {
                    uint _e24 = order_1;
                    metal::float3 _e26 = sums.inner[_e24];
                    uint _e27 = k_2;
                    float _e29 = basis_1.inner[_e27];
                    uint _e33 = k_2;
                    metal::float4 _e35 = octagloss_lights.inner[probe_10].harmonics.inner[_e33];
                    sums.inner[_e24] = _e26 + (_e29 * _e35.xyz);
                }
            }
        }
    }
#ifdef OCTAGLOSS_CUBE
    type_18 _e45 = sums;
#else
    type_19 _e45 = sums;
#endif
    return _e45;
}

metal::float3 octagloss_cosine_light(
    uint probe_11,
    metal::float3 n,
#ifdef OCTAGLOSS_CUBE
    constant type_7& octagloss_lights
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
#endif
) {
#ifdef OCTAGLOSS_CUBE
    octagloss_MapPlace _e2 = octagloss_place_of(n);
    metal::float3 _e3 = octagloss_read_cosine(probe_11, _e2, octagloss_lights);
#else
    octagloss_MapPlace _e2 = octagloss_place_of(n, octagloss_maps);
    metal::float3 _e3 = octagloss_read_cosine(probe_11, _e2, octagloss_maps, octagloss_linear);
#endif
    return _e3;
}

metal::float3 octagloss_harmonics_reflected(
    uint probe_12,
    octagloss_SurfaceFrame surface,
#ifdef OCTAGLOSS_CUBE
    type_19 pairs,
#else
    type_20 pairs,
#endif
    metal::float3 f0_,
    float f90_,
    constant type_7& octagloss_lights
) {
#ifdef OCTAGLOSS_CUBE
    type_20 angles = type_20 {{metal::float2(1.0, 0.0), metal::float2(0.309017, 0.95105654), metal::float2(-0.809017, 0.58778524), metal::float2(0.809017, 0.58778524), metal::float2(-0.309017, 0.95105654)}};
    type_19 texels = {};
#else
    type_21 angles = type_21 {{metal::float2(1.0, 0.0), metal::float2(0.309017, 0.95105654), metal::float2(-0.809017, 0.58778524), metal::float2(0.809017, 0.58778524), metal::float2(-0.309017, 0.95105654)}};
    type_20 texels = {};
#endif
    metal::float3 sum_3 = metal::float3 {};
    uint pair = 0u;
    uint k_3 = 0u;
#ifdef OCTAGLOSS_CUBE
    type_18 orders = {};
#else
    type_19 orders = {};
#endif
    uint order_2 = {};
    texels = pairs;
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e84 = k_3;
            k_3 = _e84 + 1u;
        }
        loop_init_9 = false;
        uint _e29 = k_3;
        if (_e29 < 5u) {
        } else {
            break;
        }
        {
            uint _e33 = k_3;
            float _e36 = angles.inner[_e33].x;
            uint _e39 = k_3;
            float _e42 = angles.inner[_e39].y;
#ifdef OCTAGLOSS_CUBE
            type_18 _e45 = octagloss_harmonic_orders(probe_12, (surface.normal * _e36) + (surface.towards * _e42), octagloss_lights);
#else
            type_19 _e45 = octagloss_harmonic_orders(probe_12, (surface.normal * _e36) + (surface.towards * _e42), octagloss_lights);
#endif
            orders = _e45;
            uint _e47 = k_3;
            order_2 = _e47;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e81 = order_2;
                    order_2 = _e81 + 1u;
                }
                loop_init_10 = false;
                uint _e49 = order_2;
                if (_e49 < 5u) {
                } else {
                    break;
                }
                {
                    uint _e52 = pair;
                    metal::float4 texel_2 = texels.inner[naga_div(_e52, 2u)];
                    uint _e59 = pair;
                    metal::float2 weights_2 = (naga_mod(_e59, 2u) == 0u) ? texel_2.xy : texel_2.zw;
                    metal::float3 _e65 = sum_3;
                    uint _e72 = order_2;
                    metal::float3 _e74 = orders.inner[_e72];
                    sum_3 = _e65 + (((f0_ * weights_2.x) + metal::float3(f90_ * weights_2.y)) * _e74);
                    uint _e78 = pair;
                    pair = _e78 + 1u;
                }
            }
        }
    }
    metal::float3 _e86 = sum_3;
    return _e86;
#ifdef OCTAGLOSS_CUBE
}

float octagloss_map_inner(
    metal::texturecube<float, metal::access::sample> octagloss_maps
) {
    return static_cast<float>(metal::uint2(octagloss_maps.get_width()).x);
#endif
}

metal::float3 octagloss_suns_reflected(
    uint probe_13,
    octagloss_SurfaceFrame surface_1,
    metal::float2 tangent,
    metal::float2 alpha_2,
    metal::float3 f0_1,
    float f90_1,
    constant type_7& octagloss_lights,
#ifdef OCTAGLOSS_CUBE
    metal::texturecube<float, metal::access::sample> octagloss_maps
#else
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
#endif
) {
    metal::float3 sum_4 = metal::float3 {};
    uint disc_2 = 0u;
#ifdef OCTAGLOSS_CUBE
    type_21 channels = {};
    type_22 values = {};
#else
    type_22 channels = {};
    type_23 values = {};
#endif
    uint c = {};
    metal::float3 across = metal::cross(surface_1.normal, surface_1.towards);
    metal::float3 x_2 = (surface_1.towards * tangent.x) + (across * tangent.y);
    metal::float3 y_1 = (across * tangent.x) - (surface_1.towards * tangent.y);
    metal::float3 view_5 = metal::float3(surface_1.sine * tangent.x, -(surface_1.sine) * tangent.y, surface_1.cosine);
    float _e30 = octagloss_map_inner(octagloss_maps);
    metal::float2 wide = metal::max(alpha_2, metal::float2(0.9 / _e30));
    bool loop_init_11 = true;
    while(true) {
        if (!loop_init_11) {
            uint _e122 = disc_2;
            disc_2 = _e122 + 1u;
        }
        loop_init_11 = false;
        uint _e39 = disc_2;
        if (_e39 < 16u) {
        } else {
            break;
        }
        {
            uint _e45 = disc_2;
            OctaglossSun sun_2 = octagloss_lights.inner[probe_13].suns.inner[naga_div(_e45, 2u)];
            uint _e50 = disc_2;
            metal::float3 _e51 = octagloss_half_axis_of(probe_13, _e50, octagloss_lights);
            float _e52 = octagloss_squared(_e51);
            float nearer_1 = 1.0 - (0.5 * _e52);
#ifdef OCTAGLOSS_CUBE
            channels = type_21 {{sun_2.red, sun_2.green, sun_2.blue}};
            values = type_22 {};
#else
            channels = type_22 {{sun_2.red, sun_2.green, sun_2.blue}};
            values = type_23 {};
#endif
            c = 0u;
            bool loop_init_12 = true;
            while(true) {
                if (!loop_init_12) {
                    uint _e88 = c;
                    c = _e88 + 1u;
                }
                loop_init_12 = false;
                uint _e66 = c;
                if (_e66 < 3u) {
                } else {
                    break;
                }
                {
                    uint _e69 = c;
                    metal::float4 _e71 = channels.inner[_e69];
                    metal::float3 to_1 = (nearer_1 * _e71.xyz) + _e51;
                    metal::float3 light_1 = metal::float3(metal::dot(to_1, x_2), metal::dot(to_1, y_1), metal::dot(to_1, surface_1.normal));
                    uint _e80 = c;
                    uint _e82 = c;
                    float _e85 = channels.inner[_e82].w;
                    metal::float2 _e86 = octagloss_brdf_around(view_5, light_1, wide, _e85);
                    values.inner[_e80] = _e86;
                }
            }
            float _e92 = values.inner[0].x;
            float _e95 = values.inner[1].x;
            float _e98 = values.inner[2].x;
            metal::float3 value_1 = metal::float3(_e92, _e95, _e98);
            float _e102 = values.inner[0].y;
            float _e105 = values.inner[1].y;
            float _e108 = values.inner[2].y;
            metal::float3 fresnel = metal::float3(_e102, _e105, _e108);
            metal::float3 _e110 = sum_4;
            sum_4 = _e110 + (((0.5 * sun_2.energy) * value_1) * (f0_1 + ((metal::float3(f90_1) - f0_1) * fresnel)));
        }
    }
    metal::float3 _e124 = sum_4;
    return _e124;
}

metal::float2 octagloss_albedo_share(
    metal::float2 albedo,
    metal::float2 sums_1
) {
    return (albedo + metal::float2(0.0001)) / (metal::max(sums_1, metal::float2 {}) + metal::float2(0.0001));
}

metal::float3 octagloss_reflected_isotropic(
    uint probe_14,
    octagloss_SurfaceFrame surface_2,
    float roughness_4,
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
    metal::float3 sum_5 = metal::float3 {};
    float in_mirror = 0.0;
    uint k_4 = 0u;
#ifdef OCTAGLOSS_CUBE
    type_19 pairs_1 = type_19 {};
#else
    type_20 pairs_1 = type_20 {};
#endif
    uint k_5 = 0u;
    metal::float3 n_1 = surface_2.normal;
    float cosine_11 = surface_2.cosine;
    metal::float3 along_3 = surface_2.towards * surface_2.sine;
    metal::float3 v_1 = along_3 + (n_1 * cosine_11);
    metal::float4 _e13 = octagloss_reflection_node(octagloss_READS, roughness_4, cosine_11, octagloss_tables, octagloss_linear);
    metal::float2 _e14 = octagloss_round_albedo(cosine_11, roughness_4, octagloss_tables);
    metal::float2 _e16 = octagloss_albedo_share(_e14, _e13.zw);
    metal::float3 scaled = f0_2 * _e16.x;
    float grazing = f90_2 * _e16.y;
    bool loop_init_13 = true;
    while(true) {
        if (!loop_init_13) {
            uint _e64 = k_4;
            k_4 = _e64 + 1u;
        }
        loop_init_13 = false;
        uint _e27 = k_4;
        if (_e27 < octagloss_READS) {
        } else {
            break;
        }
        {
            uint _e30 = k_4;
            metal::float4 _e31 = octagloss_reflection_node(_e30, roughness_4, cosine_11, octagloss_tables, octagloss_linear);
            metal::float3 half_vector = metal::normalize(n_1 + (_e31.x * along_3));
            metal::float3 direction_5 = (half_vector * (2.0 * metal::dot(v_1, half_vector))) - v_1;
            metal::float3 _e41 = sum_5;
            metal::float3 _e49 = octagloss_between_levels(probe_14, direction_5, _e31.y, octagloss_maps, octagloss_linear);
            sum_5 = _e41 + (((scaled * _e31.z) + metal::float3(grazing * _e31.w)) * _e49);
            float _e52 = in_mirror;
            in_mirror = _e52 + ((_e31.z + _e31.w) * metal::max(1.0 - _e31.y, 0.0));
        }
    }
    metal::float3 _e66 = sum_5;
#ifdef OCTAGLOSS_CUBE
    metal::float3 _e73 = octagloss_cosine_light(probe_14, n_1, octagloss_lights);
#else
    metal::float3 _e73 = octagloss_cosine_light(probe_14, n_1, octagloss_maps, octagloss_linear);
#endif
    sum_5 = _e66 + (((scaled * _e13.x) + metal::float3(grazing * _e13.y)) * _e73);
    bool loop_init_14 = true;
    while(true) {
        if (!loop_init_14) {
            uint _e90 = k_5;
            k_5 = _e90 + 1u;
        }
        loop_init_14 = false;
        uint _e80 = k_5;
        if (_e80 < 8u) {
        } else {
            break;
        }
        {
            uint _e83 = k_5;
            uint _e86 = k_5;
            metal::float4 _e88 = octagloss_reflection_node(10u + _e86, roughness_4, cosine_11, octagloss_tables, octagloss_linear);
            pairs_1.inner[_e83] = _e88;
        }
    }
    metal::float3 _e92 = sum_5;
#ifdef OCTAGLOSS_CUBE
    type_19 _e93 = pairs_1;
#else
    type_20 _e93 = pairs_1;
#endif
    metal::float3 _e94 = octagloss_harmonics_reflected(probe_14, surface_2, _e93, scaled, grazing, octagloss_lights);
    sum_5 = _e92 + _e94;
    metal::float3 _e96 = sum_5;
    float _e102 = octagloss_lights.inner[probe_14].unscale;
    sum_5 = metal::max(_e96, metal::float3 {}) * _e102;
    float _e104 = in_mirror;
    float share_3 = metal::max(1.0 - (_e104 / (_e13.z + _e13.w)), 0.0);
    metal::float2 alpha_11 = metal::float2(roughness_4 * roughness_4);
    metal::float3 _e115 = sum_5;
    metal::float3 _e119 = octagloss_suns_reflected(probe_14, surface_2, metal::float2(1.0, 0.0), alpha_11, f0_2, f90_2, octagloss_lights, octagloss_maps);
    return _e115 + (share_3 * _e119);
}

octagloss_SurfaceFrame octagloss_surface_of(
    uint probe_15,
    metal::float3 normal_2,
    metal::float3 view_1,
    constant type_7& octagloss_lights
) {
    metal::float3 level_view = {};
    metal::float3 _e3 = octagloss_source_from_world(probe_15, normal_2, octagloss_lights);
    metal::float3 _e4 = octagloss_source_from_world(probe_15, view_1, octagloss_lights);
    float cosine_12 = metal::clamp(metal::dot(_e3, _e4), octagloss_LEAST_COSINE, 1.0);
    level_view = _e4 - (_e3 * metal::dot(_e3, _e4));
    metal::float3 _e13 = level_view;
    metal::float3 _e14 = level_view;
    if (metal::dot(_e13, _e14) < 0.0000000001) {
        level_view = (metal::abs(_e3.x) > 0.5) ? metal::float3(0.0, 1.0, 0.0) : metal::float3(1.0, 0.0, 0.0);
    }
    metal::float3 _e31 = level_view;
    metal::float3 _e32 = level_view;
    metal::float3 towards_1 = metal::normalize(_e31 - (_e3 * metal::dot(_e3, _e32)));
    return octagloss_SurfaceFrame {_e3, towards_1, cosine_12, metal::sqrt(1.0 - (cosine_12 * cosine_12))};
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
    octagloss_SurfaceFrame _e7 = octagloss_surface_of(0u, normal_3, view_2, octagloss_lights);
    metal::float3 _e8 = octagloss_reflected_isotropic(0u, _e7, roughness_5, f0_3, f90_3, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
    return _e8;
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
    float cosine_2,
    metal::float2 tangent_1
) {
    float sharp = metal::max(alpha_4.y, octagloss_ROW_SHARP);
    float azimuth = metal::atan2(metal::abs(tangent_1.y), metal::abs(tangent_1.x)) * 0.63661975;
    metal::float4 places_1 = metal::float4(metal::log2(1.0 + (5.0 * metal::sqrt(alpha_4.y))) * 0.3868528, metal::sqrt(cosine_2), 1.0 - metal::pow(metal::max(1.0 - azimuth, 0.0), 0.6666667), metal::log2(metal::max(alpha_4.x, sharp) / sharp) / -(metal::log2(metal::min(sharp, 0.999999))));
    return metal::clamp(places_1, metal::float4 {}, metal::float4(1.0));
}

octagloss_RowPlace octagloss_row_place(
    metal::float2 alpha_5,
    float cosine_3,
    metal::float2 tangent_2
) {
    metal::float4 _e3 = octagloss_row_places(alpha_5, cosine_3, tangent_2);
    metal::float4 place_4 = _e3 * metal::float4(15.0, 9.0, 7.0, 6.0);
    float lower = metal::min(metal::floor(place_4.w), 5.0);
    metal::float2 inside_1 = metal::clamp(place_4.xy, metal::float2(0.00390625), metal::float2(15.0, 9.0) - metal::float2(0.00390625));
    metal::float3 texel_3 = metal::float3(inside_1.x, inside_1.y + (10.0 * lower), place_4.z) + metal::float3(0.5);
    return octagloss_RowPlace {texel_3 / octagloss_ROW_SIZE, place_4.w - lower};
}

metal::float4 octagloss_read_rows(
#ifdef OCTAGLOSS_CUBE
    metal::float3 at_5,
#else
    metal::float3 at_6,
#endif
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
#ifdef OCTAGLOSS_CUBE
    metal::float4 _e4 = octagloss_rows.sample(octagloss_linear, at_5, metal::level(0.0));
#else
    metal::float4 _e4 = octagloss_rows.sample(octagloss_linear, at_6, metal::level(0.0));
#endif
    return _e4;
}

metal::float4 octagloss_row_node(
    uint layer_2,
    octagloss_RowPlace place,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
#ifdef OCTAGLOSS_CUBE
    metal::float3 at_7 = metal::float3(place.at[0] + (static_cast<float>(layer_2) / 21.0), metal::float3(place.at).yz);
    metal::float4 _e11 = octagloss_read_rows(at_7, octagloss_linear, octagloss_rows);
    metal::float4 _e18 = octagloss_read_rows(metal::float3(at_7.x, at_7.y + 0.125, at_7.z), octagloss_linear, octagloss_rows);
#else
    metal::float3 at_8 = metal::float3(place.at[0] + (static_cast<float>(layer_2) / 21.0), metal::float3(place.at).yz);
    metal::float4 _e11 = octagloss_read_rows(at_8, octagloss_linear, octagloss_rows);
    metal::float4 _e18 = octagloss_read_rows(metal::float3(at_8.x, at_8.y + 0.125, at_8.z), octagloss_linear, octagloss_rows);
#endif
    return metal::mix(_e11, _e18, place.share);
}

metal::float4 octagloss_row_block(
    float block,
    metal::float3 place_1,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    float row_2 = metal::floor((block + 0.5) / octagloss_ROW_BLOCKS);
    metal::float2 corner_1 = metal::float2(16.0, 10.0) * metal::float2(block - (octagloss_ROW_BLOCKS * row_2), row_2);
    metal::float3 first_1 = metal::float3(corner_1.x, corner_1.y + 70.0, 0.0);
    metal::float4 _e27 = octagloss_read_rows(((first_1 + place_1) + metal::float3(0.5)) / octagloss_ROW_SIZE, octagloss_linear, octagloss_rows);
    return _e27;
}

metal::float4 octagloss_row_more(
    metal::float2 alpha_6,
    float cosine_4,
    metal::float2 tangent_3,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    metal::float4 _e3 = octagloss_row_places(alpha_6, cosine_4, tangent_3);
    metal::float4 place_5 = _e3 * metal::float4(15.0, 9.0, 7.0, 12.0);
    float lower_1 = metal::min(metal::floor(place_5.w), 11.0);
    metal::float3 inside_2 = metal::float3(metal::clamp(place_5.xy, metal::float2(0.00390625), metal::float2(15.0, 9.0) - metal::float2(0.00390625)), place_5.z);
    metal::float4 _e25 = octagloss_row_block(lower_1, inside_2, octagloss_linear, octagloss_rows);
    metal::float4 _e28 = octagloss_row_block(lower_1 + 1.0, inside_2, octagloss_linear, octagloss_rows);
    return metal::mix(_e25, _e28, place_5.w - lower_1);
}

metal::float2 octagloss_row_albedo(
    metal::float2 alpha_7,
    float cosine_5,
    float along,
    metal::float2 more,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    metal::float2 squares = alpha_7 * alpha_7;
    float mean_1 = metal::sqrt(0.5 * (squares.x + squares.y));
    float seen_1 = metal::sqrt(metal::mix(squares.y, squares.x, along));
    metal::float2 _e17 = octagloss_round_albedo(cosine_5, metal::sqrt(metal::mix(seen_1, mean_1, cosine_5)), octagloss_tables);
    return metal::max(_e17 + more, metal::float2 {});
}

float octagloss_row_number(
#ifdef OCTAGLOSS_CUBE
    type_21 terms,
#else
    type_22 terms,
#endif
    metal::float4 a,
    metal::float4 b,
    metal::float4 c_1
) {
    return (metal::dot(terms.inner[0], a) + metal::dot(terms.inner[1], b)) + metal::dot(terms.inner[2], c_1);
}

octagloss_Row octagloss_row_of(
    metal::float2 alpha_8,
    metal::float2 tangent_4,
    float cosine_6
) {
    metal::float2 axis = metal::float2(1.0, 0.0);
    metal::float2 squares_1 = alpha_8 * alpha_8;
    float difference = squares_1.x - squares_1.y;
    float along_4 = squares_1.y + ((difference * tangent_4.x) * tangent_4.x);
    float across_1 = ((squares_1.y + ((difference * tangent_4.y) * tangent_4.y)) * cosine_6) * cosine_6;
    float mixed = ((difference * tangent_4.x) * tangent_4.y) * cosine_6;
    float apart_1 = 0.5 * (along_4 - across_1);
    float root_1 = metal::length(metal::float2(apart_1, mixed));
    float greatest = metal::max((0.5 * (along_4 + across_1)) + root_1, 0.000000000000000000000000000001);
    if (root_1 > 0.0) {
        metal::float2 steep = metal::float2(metal::abs(mixed), (root_1 - apart_1) * ((mixed >= 0.0) ? 1.0 : -1.0));
        axis = metal::normalize(((apart_1 >= 0.0) ? metal::float2(apart_1 + root_1, mixed) : steep) / metal::float2(root_1));
    }
    float x_3 = metal::log(metal::max(((alpha_8.x * alpha_8.y) * cosine_6) / greatest, octagloss_NARROWEST));
    float extent = metal::sqrt(greatest);
    float y_2 = metal::log(1.0 + (6.0 * extent));
    float _e75 = axis.x;
    float tilt = _e75 * metal::smoothstep(0.0, octagloss_TILTED, metal::sqrt(1.0 - (cosine_6 * cosine_6)));
    float _e85 = axis.x;
    float e_1 = _e85 * tilt;
#ifdef OCTAGLOSS_CUBE
    type_21 terms_1 = type_21 {{metal::float4(1.0, x_3, x_3 * x_3, y_2), metal::float4(x_3 * y_2, y_2 * y_2, e_1, e_1 * x_3), metal::float4((x_3 * x_3) * x_3, (y_2 * y_2) * y_2, (x_3 * x_3) * y_2, (x_3 * y_2) * y_2)}};
#else
    type_22 terms_1 = type_22 {{metal::float4(1.0, x_3, x_3 * x_3, y_2), metal::float4(x_3 * y_2, y_2 * y_2, e_1, e_1 * x_3), metal::float4((x_3 * x_3) * x_3, (y_2 * y_2) * y_2, (x_3 * x_3) * y_2, (x_3 * y_2) * y_2)}};
#endif
    float _e119 = octagloss_row_number(terms_1, metal::float4(-0.252, -0.165, 0.077, -0.167), metal::float4(-0.046, -0.028, -0.39, -0.463), metal::float4(0.007, 0.174, 0.056, -0.059));
    float _e135 = octagloss_row_number(terms_1, metal::float4(-0.565, -0.078, 0.414, 0.009), metal::float4(0.349, -0.022, -0.094, 0.147), metal::float4(0.096, 0.148, 0.236, 0.258));
    float _e151 = octagloss_row_number(terms_1, metal::float4(-0.393, -0.205, 0.001, -0.283), metal::float4(0.234, -0.027, -0.572, -0.277), metal::float4(0.051, 0.164, 0.17, 0.2));
    float _e167 = octagloss_row_number(terms_1, metal::float4(0.413, 1.07, -0.1, -0.226), metal::float4(-0.344, -0.215, -0.033, -0.01), metal::float4(-0.044, 0.004, -0.121, -0.125));
    float _e183 = octagloss_row_number(terms_1, metal::float4(-0.373, 0.485, 0.057, 0.062), metal::float4(-0.546, 0.172, 0.007, -0.936), metal::float4(0.024, -0.418, -0.221, -0.237));
    float _e199 = octagloss_row_number(terms_1, metal::float4(0.477, 0.313, -0.017, -0.151), metal::float4(-0.234, -0.072, -0.068, -0.167), metal::float4(0.007, -0.011, -0.017, -0.022));
    float _e201 = axis.x;
    float _e203 = axis.y;
    float _e216 = axis.x;
    return octagloss_Row {metal::float2(_e201, _e203 / cosine_6) * metal::sqrt(2.0 * root_1), extent, _e119 * tilt, metal::exp(metal::float4(_e135, _e151, _e167, _e183)), metal::exp(_e199), metal::smoothstep(0.0, octagloss_SKEWED, _e216)};
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
    float place_6 = ((static_cast<float>(read) - 7.0) * 0.5714286) + row_1.shift;
    float slope_1 = ((row_1.steps.z * row_1.steps.x) * metal::sinh(row_1.steps.y * place_6)) / row_1.steps.y;
    float wider = (naga_mod(read, 2u) == 1u) ? row_1.alternation : (1.0 / row_1.alternation);
    float growth = row_1.steps.w * slope_1;
    float width = ((wider * row_1.steps.z) * metal::sqrt(1.0 + (growth * growth))) * row_1.extent;
    float _e44 = octagloss_map_inner(octagloss_maps);
#ifdef OCTAGLOSS_CUBE
    float last_1 = metal::log2(_e44) - 3.0;
    float sharp_1 = last_1 + metal::log2(metal::max(width, 0.000000001) / 0.35);
#else
    float last_2 = metal::log2(_e44) - 3.0;
    float sharp_1 = last_2 + metal::log2(metal::max(width, 0.000000001) / 0.35);
#endif
    float below = metal::max(metal::log2((metal::max(width, 0.000000001) * _e44) / 1.8) * 0.610706, 0.0);
#ifdef OCTAGLOSS_CUBE
    return metal::float2(slope_1, (sharp_1 >= 1.0) ? metal::min(sharp_1, last_1) : below);
#else
    return metal::float2(slope_1, (sharp_1 >= 1.0) ? metal::min(sharp_1, last_2) : below);
#endif
}

metal::float3 octagloss_reflect_in_row(
    uint probe_16,
    octagloss_SurfaceFrame surface_3,
    metal::float2 tangent_5,
    metal::float2 alpha_9,
    metal::float3 f0_4,
    float f90_4,
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
    metal::float3 sum_6 = metal::float3 {};
    float in_mirror_1 = 0.0;
    uint distance = 0u;
    metal::float2 mean = {};
    metal::float2 skew = {};
    uint side_1 = {};
#ifdef OCTAGLOSS_CUBE
    type_19 pairs_2 = type_19 {};
#else
    type_20 pairs_2 = type_20 {};
#endif
    uint k_6 = 0u;
#ifdef OCTAGLOSS_CUBE
    type_23 aside = type_23 {{metal::float3(0.4620342, 0.54655075, -0.6984316), metal::float3(0.8966183, 0.38650447, 0.21607853), metal::float3(0.11814805, 0.3835753, 0.91592085), metal::float3(0.14011177, 0.8172301, -0.5590202)}};
#else
    type_24 aside = type_24 {{metal::float3(0.4620342, 0.54655075, -0.6984316), metal::float3(0.8966183, 0.38650447, 0.21607853), metal::float3(0.11814805, 0.3835753, 0.91592085), metal::float3(0.14011177, 0.8172301, -0.5590202)}};
#endif
    metal::float4 texel_1 = {};
    uint pair_1 = 15u;
    uint k_7 = 0u;
#ifdef OCTAGLOSS_CUBE
    type_18 own_1 = {};
    type_18 other = {};
#else
    type_19 own_1 = {};
    type_19 other = {};
#endif
    uint order_3 = {};
    metal::float3 n_2 = surface_3.normal;
    metal::float3 across_2 = metal::cross(n_2, surface_3.towards);
    metal::float3 v_2 = (surface_3.towards * surface_3.sine) + (n_2 * surface_3.cosine);
    octagloss_RowPlace _e16 = octagloss_row_place(alpha_9, surface_3.cosine, tangent_5);
    octagloss_Row _e18 = octagloss_row_of(alpha_9, tangent_5, surface_3.cosine);
    metal::float3 axis_2 = (surface_3.towards * _e18.axis.x) + (across_2 * _e18.axis.y);
    metal::float4 _e28 = octagloss_row_more(alpha_9, surface_3.cosine, tangent_5, octagloss_linear, octagloss_rows);
    metal::float2 more_1 = _e28.xy;
    metal::float2 _e34 = octagloss_row_albedo(alpha_9, surface_3.cosine, tangent_5.x * tangent_5.x, more_1, octagloss_tables);
    metal::float3 scaled_1 = f0_4 * _e34.x;
    float grazing_1 = f90_4 * _e34.y;
    bool loop_init_15 = true;
    while(true) {
        if (!loop_init_15) {
            uint _e142 = distance;
            distance = _e142 + 1u;
        }
        loop_init_15 = false;
        uint _e45 = distance;
        if (_e45 <= octagloss_ROW_MIDDLE) {
        } else {
            break;
        }
        {
            uint _e48 = distance;
            metal::float4 _e49 = octagloss_row_node(_e48, _e16, octagloss_linear, octagloss_rows);
            mean = _e49.xy;
            skew = metal::float2 {};
            uint _e54 = distance;
            if (_e54 == 0u) {
                metal::float3 _e57 = sum_6;
#ifdef OCTAGLOSS_CUBE
                metal::float3 _e64 = octagloss_cosine_light(probe_16, n_2, octagloss_lights);
#else
                metal::float3 _e64 = octagloss_cosine_light(probe_16, n_2, octagloss_maps, octagloss_linear);
#endif
                sum_6 = _e57 + (((scaled_1 * _e49.z) + metal::float3(grazing_1 * _e49.w)) * _e64);
            } else {
                mean = 0.5 * (_e49.xy + _e49.zw);
                skew = (0.5 * _e18.skew) * (_e49.xy - _e49.zw);
            }
            side_1 = 0u;
            bool loop_init_16 = true;
            while(true) {
                if (!loop_init_16) {
                    uint _e139 = side_1;
                    side_1 = _e139 + 1u;
                }
                loop_init_16 = false;
                uint _e81 = side_1;
                uint _e82 = distance;
                if (_e81 < metal::min(_e82 + 1u, 2u)) {
                } else {
                    break;
                }
                {
                    metal::float2 _e88 = mean;
                    metal::float2 _e89 = skew;
                    metal::float2 _e91 = mean;
                    metal::float2 _e92 = skew;
                    uint _e94 = side_1;
                    metal::float2 weights_3 = (_e94 == 0u) ? (_e91 + _e92) : (_e88 - _e89);
                    uint _e99 = distance;
                    uint _e102 = distance;
                    uint _e104 = side_1;
                    metal::float2 _e108 = octagloss_row_read(_e18, (_e104 == 0u) ? (octagloss_ROW_MIDDLE + _e102) : (octagloss_ROW_MIDDLE - _e99), octagloss_maps);
                    metal::float3 half_vector_1 = metal::normalize(n_2 + (_e108.x * axis_2));
                    metal::float3 direction_6 = (half_vector_1 * (2.0 * metal::dot(v_2, half_vector_1))) - v_2;
                    metal::float3 _e118 = sum_6;
                    metal::float3 _e126 = octagloss_between_levels(probe_16, direction_6, _e108.y, octagloss_maps, octagloss_linear);
                    sum_6 = _e118 + (((scaled_1 * weights_3.x) + metal::float3(grazing_1 * weights_3.y)) * _e126);
                    float _e129 = in_mirror_1;
                    in_mirror_1 = _e129 + (metal::dot(_e34, weights_3) * metal::max(1.0 - _e108.y, 0.0));
                }
            }
        }
    }
    bool loop_init_17 = true;
    while(true) {
        if (!loop_init_17) {
            uint _e158 = k_6;
            k_6 = _e158 + 1u;
        }
        loop_init_17 = false;
        uint _e148 = k_6;
        if (_e148 < 8u) {
        } else {
            break;
        }
        {
            uint _e151 = k_6;
            uint _e154 = k_6;
            metal::float4 _e156 = octagloss_row_node(octagloss_ROW_PAIRS + _e154, _e16, octagloss_linear, octagloss_rows);
            pairs_2.inner[_e151] = _e156;
        }
    }
    metal::float3 _e160 = sum_6;
#ifdef OCTAGLOSS_CUBE
    type_19 _e161 = pairs_2;
#else
    type_20 _e161 = pairs_2;
#endif
    metal::float3 _e162 = octagloss_harmonics_reflected(probe_16, surface_3, _e161, scaled_1, grazing_1, octagloss_lights);
    sum_6 = _e160 + _e162;
    metal::float3 mirrored = across_2 * (((tangent_5.x * tangent_5.y) < 0.0) ? -1.0 : 1.0);
    metal::float4 _e192 = pairs_2.inner[7];
    texel_1 = _e192;
    bool loop_init_18 = true;
    while(true) {
        if (!loop_init_18) {
            uint _e280 = k_7;
            k_7 = _e280 + 1u;
        }
        loop_init_18 = false;
        uint _e198 = k_7;
        if (_e198 < 4u) {
        } else {
            break;
        }
        {
            uint _e202 = k_7;
            float _e205 = aside.inner[_e202].x;
            uint _e207 = k_7;
            float _e210 = aside.inner[_e207].z;
            metal::float3 level_4 = (surface_3.towards * _e205) + (n_2 * _e210);
            uint _e213 = k_7;
            float _e216 = aside.inner[_e213].y;
#ifdef OCTAGLOSS_CUBE
            type_18 _e219 = octagloss_harmonic_orders(probe_16, level_4 + (mirrored * _e216), octagloss_lights);
#else
            type_19 _e219 = octagloss_harmonic_orders(probe_16, level_4 + (mirrored * _e216), octagloss_lights);
#endif
            own_1 = _e219;
            uint _e221 = k_7;
            float _e224 = aside.inner[_e221].y;
#ifdef OCTAGLOSS_CUBE
            type_18 _e227 = octagloss_harmonic_orders(probe_16, level_4 - (mirrored * _e224), octagloss_lights);
#else
            type_19 _e227 = octagloss_harmonic_orders(probe_16, level_4 - (mirrored * _e224), octagloss_lights);
#endif
            other = _e227;
            uint _e229 = k_7;
            order_3 = _e229 + 1u;
            bool loop_init_19 = true;
            while(true) {
                if (!loop_init_19) {
                    uint _e277 = order_3;
                    order_3 = _e277 + 1u;
                }
                loop_init_19 = false;
                uint _e233 = order_3;
                if (_e233 < 5u) {
                } else {
                    break;
                }
                {
                    uint _e236 = pair_1;
                    if (naga_mod(_e236, 2u) == 0u) {
                        uint _e242 = pair_1;
                        metal::float4 _e246 = octagloss_row_node(octagloss_ROW_PAIRS + naga_div(_e242, 2u), _e16, octagloss_linear, octagloss_rows);
                        texel_1 = _e246;
                    }
                    metal::float4 _e247 = texel_1;
                    metal::float4 _e249 = texel_1;
                    uint _e251 = pair_1;
                    metal::float2 weights_4 = (naga_mod(_e251, 2u) == 0u) ? _e249.xy : _e247.zw;
                    metal::float3 _e257 = sum_6;
                    uint _e264 = order_3;
                    metal::float3 _e266 = own_1.inner[_e264];
                    uint _e267 = order_3;
                    metal::float3 _e269 = other.inner[_e267];
                    sum_6 = _e257 + (((scaled_1 * weights_4.x) + metal::float3(grazing_1 * weights_4.y)) * (_e266 - _e269));
                    uint _e274 = pair_1;
                    pair_1 = _e274 + 1u;
                }
            }
        }
    }
    metal::float3 _e282 = sum_6;
    float _e288 = octagloss_lights.inner[probe_16].unscale;
    sum_6 = metal::max(_e282, metal::float3 {}) * _e288;
    float _e290 = in_mirror_1;
    float share_4 = metal::max(1.0 - (_e290 / (_e34.x + _e34.y)), 0.0);
    metal::float3 _e299 = sum_6;
    metal::float3 _e300 = octagloss_suns_reflected(probe_16, surface_3, tangent_5, alpha_9, f0_4, f90_4, octagloss_lights, octagloss_maps);
    return _e299 + (share_4 * _e300);
}

metal::float3 octagloss_reflect_of(
    uint probe_17,
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
    metal::float2 level_3 = metal::float2 {};
    bool local = {};
    octagloss_SurfaceFrame _e8 = octagloss_surface_of(probe_17, normal_4, view_3, octagloss_lights);
    if (anisotropy_1 > 0.0) {
        local = metal::dot(tangent_6, tangent_6) > 0.0;
    } else {
        local = false;
    }
    bool _e19 = local;
    if (_e19) {
        metal::float3 _e20 = octagloss_source_from_world(probe_17, tangent_6, octagloss_lights);
        metal::float3 across_3 = metal::cross(_e8.normal, _e8.towards);
        level_3 = metal::float2(metal::dot(_e20, _e8.towards), metal::dot(_e20, across_3));
    }
    metal::float2 _e28 = level_3;
    metal::float2 _e29 = level_3;
    if (metal::dot(_e28, _e29) < 0.0000000001) {
        metal::float3 _e33 = octagloss_reflected_isotropic(probe_17, _e8, roughness_7, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
        return _e33;
    }
    metal::float2 _e36 = octagloss_row_alphas(roughness_7, metal::min(anisotropy_1, 1.0));
    float _e37 = octagloss_row_share(_e36);
    metal::float2 _e38 = level_3;
    metal::float3 _e40 = octagloss_reflect_in_row(probe_17, _e8, metal::normalize(_e38), _e36, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear, octagloss_rows);
    metal::float3 sum_7 = _e37 * _e40;
    if (_e37 == 1.0) {
        return sum_7;
    }
    float round = metal::sqrt(metal::sqrt(_e36.x * _e36.y));
    metal::float3 _e51 = octagloss_reflected_isotropic(probe_17, _e8, round, f0_5, f90_5, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
    return sum_7 + ((1.0 - _e37) * _e51);
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

metal::float2 octagloss_faded_albedo(
    metal::float2 alpha_10,
    float cosine_7,
    metal::float2 own_2,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    metal::float2 _e8 = octagloss_round_albedo(cosine_7, metal::sqrt(metal::sqrt(alpha_10.x * alpha_10.y)), octagloss_tables);
    float _e9 = octagloss_row_share(alpha_10);
    return metal::mix(_e8, own_2, _e9);
}

metal::float2 octagloss_albedo(
    float cosine_8,
    float roughness_9,
    float anisotropy_3,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    if (anisotropy_3 <= 0.0) {
        metal::float2 _e5 = octagloss_round_albedo(cosine_8, roughness_9, octagloss_tables);
        return _e5;
    }
    metal::float2 _e8 = octagloss_row_alphas(roughness_9, metal::min(anisotropy_3, 1.0));
    float seen_2 = metal::clamp(cosine_8, octagloss_LEAST_COSINE, 1.0);
    metal::float4 _e15 = octagloss_row_more(_e8, seen_2, metal::float2(1.0, 0.0), octagloss_linear, octagloss_rows);
    metal::float2 more_2 = _e15.zw;
    metal::float2 _e18 = octagloss_row_albedo(_e8, seen_2, 0.5, more_2, octagloss_tables);
    metal::float2 _e19 = octagloss_faded_albedo(_e8, seen_2, _e18, octagloss_tables);
    return _e19;
}

metal::float2 octagloss_albedo_along(
    float cosine_9,
    float along_1,
    float roughness_10,
    float anisotropy_4,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear,
    metal::texture3d<float, metal::access::sample> octagloss_rows
) {
    if (anisotropy_4 <= 0.0) {
        metal::float2 _e6 = octagloss_round_albedo(cosine_9, roughness_10, octagloss_tables);
        return _e6;
    }
    metal::float2 _e9 = octagloss_row_alphas(roughness_10, metal::min(anisotropy_4, 1.0));
    float seen_3 = metal::clamp(cosine_9, octagloss_LEAST_COSINE, 1.0);
    float x_4 = metal::min(metal::abs(along_1) / metal::max(metal::sqrt(1.0 - (seen_3 * seen_3)), 0.0001), 1.0);
    metal::float4 _e28 = octagloss_row_more(_e9, seen_3, metal::float2(x_4, metal::sqrt(1.0 - (x_4 * x_4))), octagloss_linear, octagloss_rows);
    metal::float2 more_3 = _e28.xy;
    metal::float2 _e31 = octagloss_row_albedo(_e9, seen_3, x_4 * x_4, more_3, octagloss_tables);
    metal::float2 _e32 = octagloss_faded_albedo(_e9, seen_3, _e31, octagloss_tables);
    return _e32;
}
