// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2; octagloss_linear is a sampler, linear in texels and in mip levels and
// clamped to the edge. Directions are in the world, right-handed, y up. To use: octagloss_radiance,
// octagloss_irradiance, octagloss_reflect and octagloss_albedo; `probe` is 0.
// Translated from pyramid.wgsl, FNV-1a 2da02ca0c45fb865.
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
struct type_11 {
    float inner[25];
};
struct type_13 {
    float inner[5];
};
struct type_14 {
    metal::float4 inner[4];
};
struct type_17 {
    float inner[7];
};
struct type_18 {
    metal::float3 inner[5];
};
struct type_19 {
    metal::float2 inner[5];
};
struct type_20 {
    metal::float4 inner[3];
};
struct type_21 {
    metal::float2 inner[3];
};
constant uint octagloss_SUNS = 8u;
constant uint octagloss_INTERVALS = 640u;
constant int octagloss_MIRROR = 1;
constant int octagloss_SHARP = 2;
constant int octagloss_LEVELS = 0;
constant uint octagloss_READS = 9u;
constant metal::float2 octagloss_NODES = metal::float2(46.0, 26.0);
constant float octagloss_LEAST_COSINE = 0.01;
constant metal::float2 octagloss_TABLES = metal::float2(864.0, 31.0);

type_11 octagloss_harmonic_basis(
    metal::float3 d
) {
    float x = d.x;
    float y = d.y;
    float z = d.z;
    float xx = x * x;
    float yy = y * y;
    float zz = z * z;
    return type_11 {{0.28209478, 0.48860252 * y, 0.48860252 * z, 0.48860252 * x, (1.0925485 * x) * y, (1.0925485 * y) * z, 0.31539157 * ((3.0 * zz) - 1.0), (1.0925485 * x) * z, 0.54627424 * (xx - yy), (0.5900436 * y) * ((3.0 * xx) - yy), ((2.8906114 * x) * y) * z, (0.4570458 * y) * ((5.0 * zz) - 1.0), (0.37317634 * z) * ((5.0 * zz) - 3.0), (0.4570458 * x) * ((5.0 * zz) - 1.0), (1.4453057 * z) * (xx - yy), (0.5900436 * x) * (xx - (3.0 * yy)), ((2.5033429 * x) * y) * (xx - yy), ((1.7701308 * y) * z) * ((3.0 * xx) - yy), ((0.9461747 * x) * y) * ((7.0 * zz) - 1.0), ((0.6690465 * y) * z) * ((7.0 * zz) - 3.0), 0.10578555 * ((((35.0 * zz) * zz) - (30.0 * zz)) + 3.0), ((0.6690465 * x) * z) * ((7.0 * zz) - 3.0), (0.47308734 * (xx - yy)) * ((7.0 * zz) - 1.0), ((1.7701308 * x) * z) * (xx - (3.0 * yy)), 0.6258357 * (((xx * xx) - ((6.0 * xx) * yy)) + (yy * yy))}};
}

metal::float3 octagloss_source_from_world(
    uint probe,
    metal::float3 direction,
    constant type_7& octagloss_lights
) {
    metal::float3x3 axes = octagloss_lights.inner[probe].world_from_source;
    return metal::normalize(metal::float3(metal::dot(direction, axes[0]), metal::dot(direction, axes[1]), metal::dot(direction, axes[2])));
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
}

metal::float2 octagloss_place_of(
    metal::float3 direction_1,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    metal::float3 p = direction_1 / metal::float3((metal::abs(direction_1.x) + metal::abs(direction_1.y)) + metal::abs(direction_1.z));
    metal::float2 folded = metal::float2(1.0) - metal::abs(p.zx);
    metal::float2 turned = metal::float2((p.x >= 0.0) ? folded.x : -(folded.x), (p.z >= 0.0) ? folded.y : -(folded.y));
    metal::float2 uv = (p.y >= 0.0) ? p.xz : turned;
    float _e36 = octagloss_map_inner(octagloss_maps);
    float _e39 = octagloss_map_border(octagloss_maps);
    return metal::float2(0.5) + (uv * ((0.5 * _e36) / (_e36 + (2.0 * _e39))));
}

metal::float3 octagloss_harmonics_around(
    uint probe_1,
    metal::float3 d_1,
    type_13 weights,
    constant type_7& octagloss_lights
) {
    type_11 basis = {};
    metal::float3 sum = metal::float3 {};
    uint order = 0u;
    metal::float3 own = {};
    uint k = {};
    type_11 _e3 = octagloss_harmonic_basis(d_1);
    basis = _e3;
    uint2 loop_bound = uint2(4294967295u);
    bool loop_init = true;
    while(true) {
        if (metal::all(loop_bound == uint2(0u))) { break; }
        loop_bound -= uint2(loop_bound.y == 0u, 1u);
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
            uint2 loop_bound_1 = uint2(4294967295u);
            bool loop_init_1 = true;
            while(true) {
                if (metal::all(loop_bound_1 == uint2(0u))) { break; }
                loop_bound_1 -= uint2(loop_bound_1.y == 0u, 1u);
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
}

type_14 octagloss_node_weights(
    uint node,
    metal::texture2d<float, metal::access::sample> octagloss_tables
) {
    type_14 weights_1 = type_14 {};
    uint row = 0u;
    uint2 loop_bound_2 = uint2(4294967295u);
    bool loop_init_2 = true;
    while(true) {
        if (metal::all(loop_bound_2 == uint2(0u))) { break; }
        loop_bound_2 -= uint2(loop_bound_2.y == 0u, 1u);
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
    type_14 _e20 = weights_1;
    return _e20;
}

metal::float3 octagloss_read_mirror(
    uint probe_2,
    metal::float2 at,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at, octagloss_MIRROR, metal::level(0.0));
    return _e6.xyz;
}

metal::float3 octagloss_read_sharp(
    uint probe_3,
    metal::float2 at_1,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at_1, octagloss_SHARP, metal::level(0.0));
    return _e6.xyz;
}

metal::float3 octagloss_read_levels(
    uint probe_4,
    metal::float2 at_2,
    float level,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    metal::float4 _e6 = octagloss_maps.sample(octagloss_linear, at_2, octagloss_LEVELS, metal::level(level));
    return _e6.xyz;
}

metal::float3 octagloss_read_cosine(
    uint probe_5,
    metal::float2 at_3,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    float _e2 = octagloss_map_inner(octagloss_maps);
    float last = metal::rint(metal::log2(_e2 / 32.0));
    metal::float4 _e10 = octagloss_maps.sample(octagloss_linear, at_3, octagloss_MIRROR, metal::level(last));
    return _e10.xyz;
}

metal::float2 octagloss_place_in_cosine(
    metal::float2 at_4,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps
) {
    float _e1 = octagloss_map_inner(octagloss_maps);
    float _e2 = octagloss_map_border(octagloss_maps);
    float size = _e1 + (2.0 * _e2);
    float _e9 = octagloss_map_inner(octagloss_maps);
    return metal::float2(0.5) + ((at_4 - metal::float2(0.5)) * ((size / _e9) * 0.9411765));
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
    uint probe_6,
    metal::float3 direction_2,
    float roughness,
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    type_14 low = {};
    type_14 high = {};
    metal::float3 sum_1 = metal::float3 {};
    type_17 levels = {};
    uint level_1 = 0u;
    uint k_1 = 0u;
    metal::float3 _e3 = octagloss_source_from_world(probe_6, direction_2, octagloss_lights);
    metal::float2 _e4 = octagloss_place_of(_e3, octagloss_maps);
    float node_1 = metal::log2(1.0 + (50.0 * roughness)) * 112.826515;
    uint k_7 = metal::min(naga_f2u32(node_1), 639u);
    float share = node_1 - static_cast<float>(k_7);
    type_14 _e17 = octagloss_node_weights(k_7, octagloss_tables);
    low = _e17;
    type_14 _e21 = octagloss_node_weights(k_7 + 1u, octagloss_tables);
    high = _e21;
    metal::float4 _e24 = low.inner[0];
    metal::float4 _e26 = high.inner[0];
    metal::float4 a = metal::mix(_e24, _e26, share);
    metal::float4 _e29 = low.inner[1];
    metal::float4 _e31 = high.inner[1];
    metal::float4 b = metal::mix(_e29, _e31, share);
    metal::float4 _e34 = low.inner[2];
    metal::float4 _e36 = high.inner[2];
    metal::float4 c_1 = metal::mix(_e34, _e36, share);
    metal::float4 _e39 = low.inner[3];
    metal::float4 _e41 = high.inner[3];
    metal::float4 e = metal::mix(_e39, _e41, share);
    if (a.x != 0.0) {
        metal::float3 _e48 = sum_1;
        metal::float3 _e50 = octagloss_read_mirror(probe_6, _e4, octagloss_maps, octagloss_linear);
        sum_1 = _e48 + (a.x * _e50);
    }
    if (a.y != 0.0) {
        metal::float3 _e56 = sum_1;
        metal::float3 _e58 = octagloss_read_sharp(probe_6, _e4, octagloss_maps, octagloss_linear);
        sum_1 = _e56 + (a.y * _e58);
    }
    levels = type_17 {{a.z, a.w, b.x, b.y, b.z, b.w, c_1.x}};
    uint2 loop_bound_3 = uint2(4294967295u);
    bool loop_init_3 = true;
    while(true) {
        if (metal::all(loop_bound_3 == uint2(0u))) { break; }
        loop_bound_3 -= uint2(loop_bound_3.y == 0u, 1u);
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
                metal::float3 _e86 = octagloss_read_levels(probe_6, _e4, static_cast<float>(_e84), octagloss_maps, octagloss_linear);
                sum_1 = _e80 + (_e83 * _e86);
            }
        }
    }
    if (c_1.y != 0.0) {
        metal::float3 _e95 = sum_1;
        metal::float2 _e97 = octagloss_place_in_cosine(_e4, octagloss_maps);
        metal::float3 _e98 = octagloss_read_cosine(probe_6, _e97, octagloss_maps, octagloss_linear);
        sum_1 = _e95 + (c_1.y * _e98);
    }
    metal::float3 _e101 = sum_1;
    metal::float3 _e108 = octagloss_harmonics_around(probe_6, _e3, type_13 {{c_1.z, c_1.w, e.x, e.y, e.z}}, octagloss_lights);
    sum_1 = _e101 + _e108;
    metal::float3 _e110 = sum_1;
    float _e116 = octagloss_lights.inner[probe_6].unscale;
    sum_1 = metal::max(_e110, metal::float3 {}) * _e116;
    float alpha_1 = roughness * roughness;
    uint2 loop_bound_4 = uint2(4294967295u);
    bool loop_init_4 = true;
    while(true) {
        if (metal::all(loop_bound_4 == uint2(0u))) { break; }
        loop_bound_4 -= uint2(loop_bound_4.y == 0u, 1u);
        if (!loop_init_4) {
            uint _e189 = k_1;
            k_1 = _e189 + 1u;
        }
        loop_init_4 = false;
        uint _e121 = k_1;
        if (_e121 < octagloss_SUNS) {
        } else {
            break;
        }
        {
            uint _e127 = k_1;
            OctaglossSun sun = octagloss_lights.inner[probe_6].suns.inner[_e127];
            float _e133 = octagloss_squared(_e3 - sun.red.xyz);
            float _e137 = octagloss_squared(_e3 - sun.green.xyz);
            float _e141 = octagloss_squared(_e3 - sun.blue.xyz);
            metal::float3 apart = metal::float3(_e133, _e137, _e141);
            metal::float3 s = metal::min(0.25 * apart, metal::float3(0.5));
            metal::float3 spread_1 = metal::float3(sun.red.w, sun.green.w, sun.blue.w);
            metal::float3 a2_ = metal::min(metal::float3(alpha_1 * alpha_1) + (0.5 * spread_1), metal::float3(1.0));
            metal::float3 bend = s + (a2_ * (metal::float3(1.0) - s));
            metal::float3 lobe = ((0.31830987 * a2_) / (bend * bend)) * (metal::float3(1.0) - (2.0 * s));
            metal::float3 _e178 = sum_1;
            sum_1 = _e178 + ((sun.energy * lobe) * (e.w * (1.0 - a.x)));
        }
    }
    metal::float3 _e191 = sum_1;
    return _e191;
}

metal::float3 octagloss_radiance(
    metal::float3 direction_3,
    float roughness_1,
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float3 _e3 = octagloss_radiance_of(0u, direction_3, roughness_1, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
    return _e3;
}

metal::float3 octagloss_irradiance_of(
    uint probe_7,
    metal::float3 normal,
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    metal::float3 sum_2 = {};
    uint k_2 = 0u;
    metal::float3 _e2 = octagloss_source_from_world(probe_7, normal, octagloss_lights);
    metal::float2 _e3 = octagloss_place_of(_e2, octagloss_maps);
    metal::float2 _e4 = octagloss_place_in_cosine(_e3, octagloss_maps);
    metal::float3 _e5 = octagloss_read_cosine(probe_7, _e4, octagloss_maps, octagloss_linear);
    float _e9 = octagloss_lights.inner[probe_7].unscale;
    sum_2 = _e5 * _e9;
    uint2 loop_bound_5 = uint2(4294967295u);
    bool loop_init_5 = true;
    while(true) {
        if (metal::all(loop_bound_5 == uint2(0u))) { break; }
        loop_bound_5 -= uint2(loop_bound_5.y == 0u, 1u);
        if (!loop_init_5) {
            uint _e42 = k_2;
            k_2 = _e42 + 1u;
        }
        loop_init_5 = false;
        uint _e14 = k_2;
        if (_e14 < octagloss_SUNS) {
        } else {
            break;
        }
        {
            uint _e20 = k_2;
            OctaglossSun sun_1 = octagloss_lights.inner[probe_7].suns.inner[_e20];
            metal::float3 facing = metal::float3(metal::dot(_e2, sun_1.red.xyz), metal::dot(_e2, sun_1.green.xyz), metal::dot(_e2, sun_1.blue.xyz));
            metal::float3 _e33 = sum_2;
            sum_2 = _e33 + (sun_1.energy * (0.31830987 * metal::max(facing, metal::float3 {})));
        }
    }
    metal::float3 _e44 = sum_2;
    return _e44;
}

metal::float3 octagloss_irradiance(
    metal::float3 normal_1,
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    metal::float3 _e2 = octagloss_irradiance_of(0u, normal_1, octagloss_lights, octagloss_maps, octagloss_linear);
    return _e2;
}

metal::float4 octagloss_read_reflections(
    uint layer,
    metal::float2 at_5,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float2 corner = metal::float2(1.0 + (static_cast<float>(layer) * 48.0), 0.0);
    metal::float4 _e17 = octagloss_tables.sample(octagloss_linear, ((at_5 * octagloss_NODES) + corner) / octagloss_TABLES, metal::level(0.0));
    return _e17;
}

metal::float4 octagloss_reflection_node(
    uint layer_1,
    float roughness_2,
    float cosine,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float2 place = metal::float2(metal::log2(1.0 + (10.0 * roughness_2)) * 0.28906482, metal::sqrt(cosine));
    metal::float2 at_6 = ((place * metal::float2(45.0, 25.0)) + metal::float2(0.5)) / octagloss_NODES;
    metal::float4 _e21 = octagloss_read_reflections(layer_1, at_6, octagloss_tables, octagloss_linear);
    return _e21;
}

metal::float3 octagloss_between_levels(
    uint probe_8,
    metal::float3 direction_4,
    float level_2,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::sampler octagloss_linear
) {
    metal::float2 _e3 = octagloss_place_of(direction_4, octagloss_maps);
    if (level_2 >= 2.0) {
        metal::float3 _e8 = octagloss_read_levels(probe_8, _e3, level_2 - 2.0, octagloss_maps, octagloss_linear);
        return _e8;
    }
    if (level_2 >= 1.0) {
        metal::float3 _e11 = octagloss_read_sharp(probe_8, _e3, octagloss_maps, octagloss_linear);
        metal::float3 _e13 = octagloss_read_levels(probe_8, _e3, 0.0, octagloss_maps, octagloss_linear);
        return metal::mix(_e11, _e13, level_2 - 1.0);
    }
    metal::float3 _e17 = octagloss_read_mirror(probe_8, _e3, octagloss_maps, octagloss_linear);
    metal::float3 _e18 = octagloss_read_sharp(probe_8, _e3, octagloss_maps, octagloss_linear);
    return metal::mix(_e17, _e18, level_2);
}

metal::float2 octagloss_brdf_around(
    metal::float3 view,
    metal::float3 light,
    metal::float2 alpha,
    float spread
) {
    if (light.z <= 0.0) {
        return metal::float2 {};
    }
    metal::float3 half_vector = metal::normalize(view + light);
    float cosine_2 = metal::dot(view, half_vector);
    metal::float2 across = metal::float2(-(view.y), view.x) / metal::float2(cosine_2);
    metal::float2 squares = (alpha * alpha) + ((0.5 * spread) * (metal::float2(1.0) + (across * across)));
    float mixed = ((0.5 * spread) * across.x) * across.y;
    float determinant = (squares.x * squares.y) - (mixed * mixed);
    metal::float2 h = half_vector.xy;
    float slopes = (((squares.y * h.x) * h.x) - (((2.0 * mixed) * h.x) * h.y)) + ((squares.x * h.y) * h.y);
    float bend_1 = (slopes / determinant) + (half_vector.z * half_vector.z);
    float masking = (light.z * metal::length(metal::float3(alpha * view.xy, view.z))) + (view.z * metal::length(metal::float3(alpha * light.xy, light.z)));
    float value = (0.5 * light.z) / ((((masking * 3.1415927) * metal::sqrt(determinant)) * bend_1) * bend_1);
    return metal::float2(value, metal::pow(metal::max(1.0 - cosine_2, 0.0), 5.0));
}

type_18 octagloss_harmonic_orders(
    uint probe_9,
    metal::float3 d_2,
    constant type_7& octagloss_lights
) {
    type_11 basis_1 = {};
    type_18 sums = type_18 {};
    uint order_1 = 0u;
    uint k_3 = {};
    type_11 _e2 = octagloss_harmonic_basis(d_2);
    basis_1 = _e2;
    uint2 loop_bound_6 = uint2(4294967295u);
    bool loop_init_6 = true;
    while(true) {
        if (metal::all(loop_bound_6 == uint2(0u))) { break; }
        loop_bound_6 -= uint2(loop_bound_6.y == 0u, 1u);
        if (!loop_init_6) {
            uint _e43 = order_1;
            order_1 = _e43 + 1u;
        }
        loop_init_6 = false;
        uint _e8 = order_1;
        if (_e8 < 5u) {
        } else {
            break;
        }
        {
            uint _e11 = order_1;
            uint _e12 = order_1;
            k_3 = _e11 * _e12;
            uint2 loop_bound_7 = uint2(4294967295u);
            bool loop_init_7 = true;
            while(true) {
                if (metal::all(loop_bound_7 == uint2(0u))) { break; }
                loop_bound_7 -= uint2(loop_bound_7.y == 0u, 1u);
                if (!loop_init_7) {
                    uint _e40 = k_3;
                    k_3 = _e40 + 1u;
                }
                loop_init_7 = false;
                uint _e15 = k_3;
                uint _e16 = order_1;
                uint _e19 = order_1;
                if (_e15 < ((_e16 + 1u) * (_e19 + 1u))) {
                } else {
                    break;
                }
                {
                    uint _e24 = order_1;
                    metal::float3 _e26 = sums.inner[_e24];
                    uint _e27 = k_3;
                    float _e29 = basis_1.inner[_e27];
                    uint _e33 = k_3;
                    metal::float4 _e35 = octagloss_lights.inner[probe_9].harmonics.inner[_e33];
                    sums.inner[_e24] = _e26 + (_e29 * _e35.xyz);
                }
            }
        }
    }
    type_18 _e45 = sums;
    return _e45;
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % metal::select(rhs, 1u, rhs == 0u);
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / metal::select(rhs, 1u, rhs == 0u);
}

metal::float3 octagloss_reflect_of(
    uint probe_10,
    metal::float3 normal_2,
    metal::float3 view_1,
    float roughness_3,
    metal::float3 f0_,
    float f90_,
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float3 level_view = {};
    metal::float3 sum_3 = metal::float3 {};
    float in_mirror = 0.0;
    uint k_4 = 0u;
    type_19 angles = type_19 {{metal::float2(1.0, 0.0), metal::float2(0.309017, 0.95105654), metal::float2(-0.809017, 0.58778524), metal::float2(0.809017, 0.58778524), metal::float2(-0.309017, 0.95105654)}};
    uint pair = 0u;
    metal::float4 texel = metal::float4 {};
    uint k_5 = 0u;
    type_18 orders = {};
    uint order_2 = {};
    uint k_6 = 0u;
    type_20 channels = {};
    type_21 values = {};
    uint c = {};
    metal::float3 _e6 = octagloss_source_from_world(probe_10, normal_2, octagloss_lights);
    metal::float3 _e7 = octagloss_source_from_world(probe_10, view_1, octagloss_lights);
    float cosine_3 = metal::clamp(metal::dot(_e6, _e7), octagloss_LEAST_COSINE, 1.0);
    level_view = _e7 - (_e6 * metal::dot(_e6, _e7));
    metal::float3 _e16 = level_view;
    metal::float3 _e17 = level_view;
    if (metal::dot(_e16, _e17) < 0.0000000001) {
        level_view = (metal::abs(_e6.x) > 0.5) ? metal::float3(0.0, 1.0, 0.0) : metal::float3(1.0, 0.0, 0.0);
    }
    metal::float3 _e34 = level_view;
    metal::float3 _e35 = level_view;
    metal::float3 towards = metal::normalize(_e34 - (_e6 * metal::dot(_e6, _e35)));
    float sine = metal::sqrt(1.0 - (cosine_3 * cosine_3));
    metal::float3 along = towards * sine;
    metal::float3 v_1 = along + (_e6 * cosine_3);
    uint2 loop_bound_8 = uint2(4294967295u);
    bool loop_init_8 = true;
    while(true) {
        if (metal::all(loop_bound_8 == uint2(0u))) { break; }
        loop_bound_8 -= uint2(loop_bound_8.y == 0u, 1u);
        if (!loop_init_8) {
            uint _e90 = k_4;
            k_4 = _e90 + 1u;
        }
        loop_init_8 = false;
        uint _e53 = k_4;
        if (_e53 < octagloss_READS) {
        } else {
            break;
        }
        {
            uint _e56 = k_4;
            metal::float4 _e57 = octagloss_reflection_node(_e56, roughness_3, cosine_3, octagloss_tables, octagloss_linear);
            metal::float3 half_vector_1 = metal::normalize(_e6 + (_e57.x * along));
            metal::float3 direction_5 = (half_vector_1 * (2.0 * metal::dot(v_1, half_vector_1))) - v_1;
            metal::float3 _e67 = sum_3;
            metal::float3 _e75 = octagloss_between_levels(probe_10, direction_5, _e57.y, octagloss_maps, octagloss_linear);
            sum_3 = _e67 + (((f0_ * _e57.z) + metal::float3(f90_ * _e57.w)) * _e75);
            float _e78 = in_mirror;
            in_mirror = _e78 + ((_e57.z + _e57.w) * metal::max(1.0 - _e57.y, 0.0));
        }
    }
    metal::float4 _e93 = octagloss_reflection_node(octagloss_READS, roughness_3, cosine_3, octagloss_tables, octagloss_linear);
    metal::float3 _e94 = sum_3;
    metal::float2 _e101 = octagloss_place_of(_e6, octagloss_maps);
    metal::float2 _e102 = octagloss_place_in_cosine(_e101, octagloss_maps);
    metal::float3 _e103 = octagloss_read_cosine(probe_10, _e102, octagloss_maps, octagloss_linear);
    sum_3 = _e94 + (((f0_ * _e93.x) + metal::float3(f90_ * _e93.y)) * _e103);
    uint2 loop_bound_9 = uint2(4294967295u);
    bool loop_init_9 = true;
    while(true) {
        if (metal::all(loop_bound_9 == uint2(0u))) { break; }
        loop_bound_9 -= uint2(loop_bound_9.y == 0u, 1u);
        if (!loop_init_9) {
            uint _e190 = k_5;
            k_5 = _e190 + 1u;
        }
        loop_init_9 = false;
        uint _e129 = k_5;
        if (_e129 < 5u) {
        } else {
            break;
        }
        {
            uint _e132 = k_5;
            float _e135 = angles.inner[_e132].x;
            uint _e137 = k_5;
            float _e140 = angles.inner[_e137].y;
            type_18 _e143 = octagloss_harmonic_orders(probe_10, (_e6 * _e135) + (towards * _e140), octagloss_lights);
            orders = _e143;
            uint _e145 = k_5;
            order_2 = _e145;
            uint2 loop_bound_10 = uint2(4294967295u);
            bool loop_init_10 = true;
            while(true) {
                if (metal::all(loop_bound_10 == uint2(0u))) { break; }
                loop_bound_10 -= uint2(loop_bound_10.y == 0u, 1u);
                if (!loop_init_10) {
                    uint _e187 = order_2;
                    order_2 = _e187 + 1u;
                }
                loop_init_10 = false;
                uint _e147 = order_2;
                if (_e147 < 5u) {
                } else {
                    break;
                }
                {
                    uint _e150 = pair;
                    if (naga_mod(_e150, 2u) == 0u) {
                        uint _e156 = pair;
                        metal::float4 _e160 = octagloss_reflection_node(10u + naga_div(_e156, 2u), roughness_3, cosine_3, octagloss_tables, octagloss_linear);
                        texel = _e160;
                    }
                    metal::float4 _e161 = texel;
                    metal::float4 _e163 = texel;
                    uint _e165 = pair;
                    metal::float2 weights_2 = (naga_mod(_e165, 2u) == 0u) ? _e163.xy : _e161.zw;
                    metal::float3 _e171 = sum_3;
                    uint _e178 = order_2;
                    metal::float3 _e180 = orders.inner[_e178];
                    sum_3 = _e171 + (((f0_ * weights_2.x) + metal::float3(f90_ * weights_2.y)) * _e180);
                    uint _e184 = pair;
                    pair = _e184 + 1u;
                }
            }
        }
    }
    metal::float3 _e192 = sum_3;
    float _e198 = octagloss_lights.inner[probe_10].unscale;
    sum_3 = metal::max(_e192, metal::float3 {}) * _e198;
    float _e200 = in_mirror;
    float share_1 = metal::max(1.0 - (_e200 / (_e93.z + _e93.w)), 0.0);
    float _e210 = octagloss_map_inner(octagloss_maps);
    float alpha_2 = metal::max(roughness_3 * roughness_3, 0.9 / _e210);
    metal::float3 across_1 = metal::cross(_e6, towards);
    uint2 loop_bound_11 = uint2(4294967295u);
    bool loop_init_11 = true;
    while(true) {
        if (metal::all(loop_bound_11 == uint2(0u))) { break; }
        loop_bound_11 -= uint2(loop_bound_11.y == 0u, 1u);
        if (!loop_init_11) {
            uint _e290 = k_6;
            k_6 = _e290 + 1u;
        }
        loop_init_11 = false;
        uint _e217 = k_6;
        if (_e217 < octagloss_SUNS) {
        } else {
            break;
        }
        {
            uint _e223 = k_6;
            OctaglossSun sun_2 = octagloss_lights.inner[probe_10].suns.inner[_e223];
            channels = type_20 {{sun_2.red, sun_2.green, sun_2.blue}};
            values = type_21 {};
            c = 0u;
            uint2 loop_bound_12 = uint2(4294967295u);
            bool loop_init_12 = true;
            while(true) {
                if (metal::all(loop_bound_12 == uint2(0u))) { break; }
                loop_bound_12 -= uint2(loop_bound_12.y == 0u, 1u);
                if (!loop_init_12) {
                    uint _e257 = c;
                    c = _e257 + 1u;
                }
                loop_init_12 = false;
                uint _e235 = c;
                if (_e235 < 3u) {
                } else {
                    break;
                }
                {
                    uint _e238 = c;
                    metal::float4 _e240 = channels.inner[_e238];
                    metal::float3 to = _e240.xyz;
                    metal::float3 light_1 = metal::float3(metal::dot(to, towards), metal::dot(to, across_1), metal::dot(to, _e6));
                    uint _e246 = c;
                    uint _e251 = c;
                    float _e254 = channels.inner[_e251].w;
                    metal::float2 _e255 = octagloss_brdf_around(metal::float3(sine, 0.0, cosine_3), light_1, metal::float2(alpha_2), _e254);
                    values.inner[_e246] = _e255;
                }
            }
            float _e261 = values.inner[0].x;
            float _e264 = values.inner[1].x;
            float _e267 = values.inner[2].x;
            metal::float3 value_1 = metal::float3(_e261, _e264, _e267);
            float _e271 = values.inner[0].y;
            float _e274 = values.inner[1].y;
            float _e277 = values.inner[2].y;
            metal::float3 fresnel = metal::float3(_e271, _e274, _e277);
            metal::float3 _e279 = sum_3;
            sum_3 = _e279 + ((sun_2.energy * (share_1 * value_1)) * (f0_ + ((metal::float3(f90_) - f0_) * fresnel)));
        }
    }
    metal::float3 _e292 = sum_3;
    return _e292;
}

metal::float3 octagloss_reflect(
    metal::float3 normal_3,
    metal::float3 view_2,
    float roughness_4,
    metal::float3 f0_1,
    float f90_1,
    constant type_7& octagloss_lights,
    metal::texture2d_array<float, metal::access::sample> octagloss_maps,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float3 _e6 = octagloss_reflect_of(0u, normal_3, view_2, roughness_4, f0_1, f90_1, octagloss_lights, octagloss_maps, octagloss_tables, octagloss_linear);
    return _e6;
}

metal::float2 octagloss_albedo(
    float cosine_1,
    float roughness_5,
    metal::texture2d<float, metal::access::sample> octagloss_tables,
    metal::sampler octagloss_linear
) {
    metal::float4 _e6 = octagloss_reflection_node(octagloss_READS, roughness_5, metal::clamp(cosine_1, octagloss_LEAST_COSINE, 1.0), octagloss_tables, octagloss_linear);
    return _e6.zw;
}
