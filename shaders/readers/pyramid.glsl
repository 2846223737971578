// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2; octagloss_linear is a sampler, linear in texels and in mip levels and
// clamped to the edge. Directions are in the world, right-handed, y up. To use: octagloss_radiance,
// octagloss_irradiance, octagloss_reflect and octagloss_albedo; `probe` is 0.
// Translated from pyramid.wgsl, FNV-1a 2da02ca0c45fb865.
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
const uint octagloss_SUNS = 8u;
const uint octagloss_INTERVALS = 640u;
const int octagloss_MIRROR = 1;
const int octagloss_SHARP = 2;
const int octagloss_LEVELS = 0;
const uint octagloss_READS = 9u;
const vec2 octagloss_NODES = vec2(46.0, 26.0);
const float octagloss_LEAST_COSINE = 0.01;
const vec2 octagloss_TABLES = vec2(864.0, 31.0);

layout(std140) uniform OctaglossLights { OctaglossLight octagloss_lights[1]; };

uniform highp sampler2DArray octagloss_maps;

uniform highp sampler2D octagloss_tables;

float[25] octagloss_harmonic_basis(vec3 d) {
    float x = d.x;
    float y = d.y;
    float z = d.z;
    float xx = (x * x);
    float yy = (y * y);
    float zz = (z * z);
    return float[25](0.28209478, (0.48860252 * y), (0.48860252 * z), (0.48860252 * x), ((1.0925485 * x) * y), ((1.0925485 * y) * z), (0.31539157 * ((3.0 * zz) - 1.0)), ((1.0925485 * x) * z), (0.54627424 * (xx - yy)), ((0.5900436 * y) * ((3.0 * xx) - yy)), (((2.8906114 * x) * y) * z), ((0.4570458 * y) * ((5.0 * zz) - 1.0)), ((0.37317634 * z) * ((5.0 * zz) - 3.0)), ((0.4570458 * x) * ((5.0 * zz) - 1.0)), ((1.4453057 * z) * (xx - yy)), ((0.5900436 * x) * (xx - (3.0 * yy))), (((2.5033429 * x) * y) * (xx - yy)), (((1.7701308 * y) * z) * ((3.0 * xx) - yy)), (((0.9461747 * x) * y) * ((7.0 * zz) - 1.0)), (((0.6690465 * y) * z) * ((7.0 * zz) - 3.0)), (0.10578555 * ((((35.0 * zz) * zz) - (30.0 * zz)) + 3.0)), (((0.6690465 * x) * z) * ((7.0 * zz) - 3.0)), ((0.47308734 * (xx - yy)) * ((7.0 * zz) - 1.0)), (((1.7701308 * x) * z) * (xx - (3.0 * yy))), (0.6258357 * (((xx * xx) - ((6.0 * xx) * yy)) + (yy * yy))));
}

vec3 octagloss_source_from_world(uint probe, vec3 direction) {
    mat3x3 axes = octagloss_lights[probe].world_from_source;
    return normalize(vec3(dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])));
}

float octagloss_map_inner() {
    return (float(uvec2(textureSize(octagloss_maps, 0).xy).x) * 0.9411765);
}

float octagloss_map_border() {
    return (float(uvec2(textureSize(octagloss_maps, 0).xy).x) / 34.0);
}

vec2 octagloss_place_of(vec3 direction_1) {
    vec3 p = (direction_1 / vec3(((abs(direction_1.x) + abs(direction_1.y)) + abs(direction_1.z))));
    vec2 folded = (vec2(1.0) - abs(p.zx));
    vec2 turned = vec2(((p.x >= 0.0) ? folded.x : -(folded.x)), ((p.z >= 0.0) ? folded.y : -(folded.y)));
    vec2 uv = ((p.y >= 0.0) ? p.xz : turned);
    float _e36 = octagloss_map_inner();
    float _e39 = octagloss_map_border();
    return (vec2(0.5) + (uv * ((0.5 * _e36) / (_e36 + (2.0 * _e39)))));
}

vec3 octagloss_harmonics_around(uint probe_1, vec3 d_1, float weights[5]) {
    float basis[25] = float[25](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    vec3 sum = vec3(0.0);
    uint order = 0u;
    vec3 own = vec3(0.0);
    uint k = 0u;
    float _e3[25] = octagloss_harmonic_basis(d_1);
    basis = _e3;
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            uint _e50 = order;
            order = (_e50 + 1u);
        }
        loop_init = false;
        uint _e9 = order;
        if ((_e9 < 5u)) {
        } else {
            break;
        }
        {
            own = vec3(0.0);
            uint _e14 = order;
            uint _e15 = order;
            k = (_e14 * _e15);
            bool loop_init_1 = true;
            while(true) {
                if (!loop_init_1) {
                    uint _e41 = k;
                    k = (_e41 + 1u);
                }
                loop_init_1 = false;
                uint _e18 = k;
                uint _e19 = order;
                uint _e22 = order;
                if ((_e18 < ((_e19 + 1u) * (_e22 + 1u)))) {
                } else {
                    break;
                }
                {
                    vec3 _e27 = own;
                    uint _e28 = k;
                    float _e30 = basis[_e28];
                    uint _e34 = k;
                    vec4 _e36 = octagloss_lights[probe_1].harmonics[_e34];
                    own = (_e27 + (_e30 * _e36.xyz));
                }
            }
            vec3 _e43 = sum;
            uint _e44 = order;
            vec3 _e46 = own;
            sum = (_e43 + (weights[_e44] * _e46));
        }
    }
    vec3 _e52 = sum;
    return _e52;
}

vec4[4] octagloss_node_weights(uint node) {
    vec4 weights_1[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    uint row = 0u;
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e18 = row;
            row = (_e18 + 1u);
        }
        loop_init_2 = false;
        uint _e5 = row;
        if ((_e5 < 4u)) {
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
    vec4 _e20[4] = weights_1;
    return _e20;
}

vec3 octagloss_read_mirror(uint probe_2, vec2 at_1) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_1, octagloss_MIRROR), 0.0);
    return _e6.xyz;
}

vec3 octagloss_read_sharp(uint probe_3, vec2 at_2) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_2, octagloss_SHARP), 0.0);
    return _e6.xyz;
}

vec3 octagloss_read_levels(uint probe_4, vec2 at_3, float level) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_3, octagloss_LEVELS), level);
    return _e6.xyz;
}

vec3 octagloss_read_cosine(uint probe_5, vec2 at_4) {
    float _e2 = octagloss_map_inner();
    float last = roundEven(log2((_e2 / 32.0)));
    vec4 _e10 = textureLod(octagloss_maps, vec3(at_4, octagloss_MIRROR), last);
    return _e10.xyz;
}

vec2 octagloss_place_in_cosine(vec2 at_5) {
    float _e1 = octagloss_map_inner();
    float _e2 = octagloss_map_border();
    float size = (_e1 + (2.0 * _e2));
    float _e9 = octagloss_map_inner();
    return (vec2(0.5) + ((at_5 - vec2(0.5)) * ((size / _e9) * 0.9411765)));
}

float octagloss_squared(vec3 v) {
    return dot(v, v);
}

vec3 octagloss_radiance_of(uint probe_6, vec3 direction_2, float roughness) {
    vec4 low[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    vec4 high[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    vec3 sum_1 = vec3(0.0);
    float levels[7] = float[7](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    uint level_1 = 0u;
    uint k_1 = 0u;
    vec3 _e3 = octagloss_source_from_world(probe_6, direction_2);
    vec2 _e4 = octagloss_place_of(_e3);
    float node_1 = (log2((1.0 + (50.0 * roughness))) * 112.826515);
    uint k_7 = min(uint(node_1), 639u);
    float share = (node_1 - float(k_7));
    vec4 _e17[4] = octagloss_node_weights(k_7);
    low = _e17;
    vec4 _e21[4] = octagloss_node_weights((k_7 + 1u));
    high = _e21;
    vec4 _e24 = low[0];
    vec4 _e26 = high[0];
    vec4 a = mix(_e24, _e26, share);
    vec4 _e29 = low[1];
    vec4 _e31 = high[1];
    vec4 b = mix(_e29, _e31, share);
    vec4 _e34 = low[2];
    vec4 _e36 = high[2];
    vec4 c_1 = mix(_e34, _e36, share);
    vec4 _e39 = low[3];
    vec4 _e41 = high[3];
    vec4 e = mix(_e39, _e41, share);
    if ((a.x != 0.0)) {
        vec3 _e48 = sum_1;
        vec3 _e50 = octagloss_read_mirror(probe_6, _e4);
        sum_1 = (_e48 + (a.x * _e50));
    }
    if ((a.y != 0.0)) {
        vec3 _e56 = sum_1;
        vec3 _e58 = octagloss_read_sharp(probe_6, _e4);
        sum_1 = (_e56 + (a.y * _e58));
    }
    levels = float[7](a.z, a.w, b.x, b.y, b.z, b.w, c_1.x);
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e90 = level_1;
            level_1 = (_e90 + 1u);
        }
        loop_init_3 = false;
        uint _e72 = level_1;
        if ((_e72 < 7u)) {
        } else {
            break;
        }
        {
            uint _e75 = level_1;
            float _e77 = levels[_e75];
            if ((_e77 != 0.0)) {
                vec3 _e80 = sum_1;
                uint _e81 = level_1;
                float _e83 = levels[_e81];
                uint _e84 = level_1;
                vec3 _e86 = octagloss_read_levels(probe_6, _e4, float(_e84));
                sum_1 = (_e80 + (_e83 * _e86));
            }
        }
    }
    if ((c_1.y != 0.0)) {
        vec3 _e95 = sum_1;
        vec2 _e97 = octagloss_place_in_cosine(_e4);
        vec3 _e98 = octagloss_read_cosine(probe_6, _e97);
        sum_1 = (_e95 + (c_1.y * _e98));
    }
    vec3 _e101 = sum_1;
    vec3 _e108 = octagloss_harmonics_around(probe_6, _e3, float[5](c_1.z, c_1.w, e.x, e.y, e.z));
    sum_1 = (_e101 + _e108);
    vec3 _e110 = sum_1;
    float _e116 = octagloss_lights[probe_6].unscale;
    sum_1 = (max(_e110, vec3(0.0)) * _e116);
    float alpha_1 = (roughness * roughness);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e189 = k_1;
            k_1 = (_e189 + 1u);
        }
        loop_init_4 = false;
        uint _e121 = k_1;
        if ((_e121 < octagloss_SUNS)) {
        } else {
            break;
        }
        {
            uint _e127 = k_1;
            OctaglossSun sun = octagloss_lights[probe_6].suns[_e127];
            float _e133 = octagloss_squared((_e3 - sun.red.xyz));
            float _e137 = octagloss_squared((_e3 - sun.green.xyz));
            float _e141 = octagloss_squared((_e3 - sun.blue.xyz));
            vec3 apart = vec3(_e133, _e137, _e141);
            vec3 s = min((0.25 * apart), vec3(0.5));
            vec3 spread_1 = vec3(sun.red.w, sun.green.w, sun.blue.w);
            vec3 a2_ = min((vec3((alpha_1 * alpha_1)) + (0.5 * spread_1)), vec3(1.0));
            vec3 bend = (s + (a2_ * (vec3(1.0) - s)));
            vec3 lobe = (((0.31830987 * a2_) / (bend * bend)) * (vec3(1.0) - (2.0 * s)));
            vec3 _e178 = sum_1;
            sum_1 = (_e178 + ((sun.energy * lobe) * (e.w * (1.0 - a.x))));
        }
    }
    vec3 _e191 = sum_1;
    return _e191;
}

vec3 octagloss_radiance(vec3 direction_3, float roughness_1) {
    vec3 _e3 = octagloss_radiance_of(0u, direction_3, roughness_1);
    return _e3;
}

vec3 octagloss_irradiance_of(uint probe_7, vec3 normal) {
    vec3 sum_2 = vec3(0.0);
    uint k_2 = 0u;
    vec3 _e2 = octagloss_source_from_world(probe_7, normal);
    vec2 _e3 = octagloss_place_of(_e2);
    vec2 _e4 = octagloss_place_in_cosine(_e3);
    vec3 _e5 = octagloss_read_cosine(probe_7, _e4);
    float _e9 = octagloss_lights[probe_7].unscale;
    sum_2 = (_e5 * _e9);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e42 = k_2;
            k_2 = (_e42 + 1u);
        }
        loop_init_5 = false;
        uint _e14 = k_2;
        if ((_e14 < octagloss_SUNS)) {
        } else {
            break;
        }
        {
            uint _e20 = k_2;
            OctaglossSun sun_1 = octagloss_lights[probe_7].suns[_e20];
            vec3 facing = vec3(dot(_e2, sun_1.red.xyz), dot(_e2, sun_1.green.xyz), dot(_e2, sun_1.blue.xyz));
            vec3 _e33 = sum_2;
            sum_2 = (_e33 + (sun_1.energy * (0.31830987 * max(facing, vec3(0.0)))));
        }
    }
    vec3 _e44 = sum_2;
    return _e44;
}

vec3 octagloss_irradiance(vec3 normal_1) {
    vec3 _e2 = octagloss_irradiance_of(0u, normal_1);
    return _e2;
}

vec4 octagloss_read_reflections(uint layer, vec2 at_6) {
    vec2 corner = vec2((1.0 + (float(layer) * 48.0)), 0.0);
    vec4 _e17 = textureLod(octagloss_tables, vec2((((at_6 * octagloss_NODES) + corner) / octagloss_TABLES)), 0.0);
    return _e17;
}

vec4 octagloss_reflection_node(uint layer_1, float roughness_2, float cosine) {
    vec2 place = vec2((log2((1.0 + (10.0 * roughness_2))) * 0.28906482), sqrt(cosine));
    vec2 at_7 = (((place * vec2(45.0, 25.0)) + vec2(0.5)) / octagloss_NODES);
    vec4 _e21 = octagloss_read_reflections(layer_1, at_7);
    return _e21;
}

vec3 octagloss_between_levels(uint probe_8, vec3 direction_4, float level_2) {
    vec2 _e3 = octagloss_place_of(direction_4);
    if ((level_2 >= 2.0)) {
        vec3 _e8 = octagloss_read_levels(probe_8, _e3, (level_2 - 2.0));
        return _e8;
    }
    if ((level_2 >= 1.0)) {
        vec3 _e11 = octagloss_read_sharp(probe_8, _e3);
        vec3 _e13 = octagloss_read_levels(probe_8, _e3, 0.0);
        return mix(_e11, _e13, (level_2 - 1.0));
    }
    vec3 _e17 = octagloss_read_mirror(probe_8, _e3);
    vec3 _e18 = octagloss_read_sharp(probe_8, _e3);
    return mix(_e17, _e18, level_2);
}

vec2 octagloss_brdf_around(vec3 view, vec3 light, vec2 alpha, float spread) {
    if ((light.z <= 0.0)) {
        return vec2(0.0);
    }
    vec3 half_vector = normalize((view + light));
    float cosine_2 = dot(view, half_vector);
    vec2 across = (vec2(-(view.y), view.x) / vec2(cosine_2));
    vec2 squares = ((alpha * alpha) + ((0.5 * spread) * (vec2(1.0) + (across * across))));
    float mixed = (((0.5 * spread) * across.x) * across.y);
    float determinant_ = ((squares.x * squares.y) - (mixed * mixed));
    vec2 h = half_vector.xy;
    float slopes = ((((squares.y * h.x) * h.x) - (((2.0 * mixed) * h.x) * h.y)) + ((squares.x * h.y) * h.y));
    float bend_1 = ((slopes / determinant_) + (half_vector.z * half_vector.z));
    float masking = ((light.z * length(vec3((alpha * view.xy), view.z))) + (view.z * length(vec3((alpha * light.xy), light.z))));
    float value = ((0.5 * light.z) / ((((masking * 3.1415927) * sqrt(determinant_)) * bend_1) * bend_1));
    return vec2(value, pow(max((1.0 - cosine_2), 0.0), 5.0));
}

vec3[5] octagloss_harmonic_orders(uint probe_9, vec3 d_2) {
    float basis_1[25] = float[25](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    vec3 sums[5] = vec3[5](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint order_1 = 0u;
    uint k_3 = 0u;
    float _e2[25] = octagloss_harmonic_basis(d_2);
    basis_1 = _e2;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e43 = order_1;
            order_1 = (_e43 + 1u);
        }
        loop_init_6 = false;
        uint _e8 = order_1;
        if ((_e8 < 5u)) {
        } else {
            break;
        }
        {
            uint _e11 = order_1;
            uint _e12 = order_1;
            k_3 = (_e11 * _e12);
            bool loop_init_7 = true;
            while(true) {
                if (!loop_init_7) {
                    uint _e40 = k_3;
                    k_3 = (_e40 + 1u);
                }
                loop_init_7 = false;
                uint _e15 = k_3;
                uint _e16 = order_1;
                uint _e19 = order_1;
                if ((_e15 < ((_e16 + 1u) * (_e19 + 1u)))) {
                } else {
                    break;
                }
                {
                    uint _e24 = order_1;
                    vec3 _e26 = sums[_e24];
                    uint _e27 = k_3;
                    float _e29 = basis_1[_e27];
                    uint _e33 = k_3;
                    vec4 _e35 = octagloss_lights[probe_9].harmonics[_e33];
                    sums[_e24] = (_e26 + (_e29 * _e35.xyz));
                }
            }
        }
    }
    vec3 _e45[5] = sums;
    return _e45;
}

vec3 octagloss_reflect_of(uint probe_10, vec3 normal_2, vec3 view_1, float roughness_3, vec3 f0_, float f90_) {
    vec3 level_view = vec3(0.0);
    vec3 sum_3 = vec3(0.0);
    float in_mirror = 0.0;
    uint k_4 = 0u;
    vec2 angles[5] = vec2[5](vec2(1.0, 0.0), vec2(0.309017, 0.95105654), vec2(-0.809017, 0.58778524), vec2(0.809017, 0.58778524), vec2(-0.309017, 0.95105654));
    uint pair = 0u;
    vec4 texel = vec4(0.0);
    uint k_5 = 0u;
    vec3 orders[5] = vec3[5](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint order_2 = 0u;
    uint k_6 = 0u;
    vec4 channels[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    vec2 values[3] = vec2[3](vec2(0.0), vec2(0.0), vec2(0.0));
    uint c = 0u;
    vec3 _e6 = octagloss_source_from_world(probe_10, normal_2);
    vec3 _e7 = octagloss_source_from_world(probe_10, view_1);
    float cosine_3 = clamp(dot(_e6, _e7), octagloss_LEAST_COSINE, 1.0);
    level_view = (_e7 - (_e6 * dot(_e6, _e7)));
    vec3 _e16 = level_view;
    vec3 _e17 = level_view;
    if ((dot(_e16, _e17) < 1e-10)) {
        level_view = ((abs(_e6.x) > 0.5) ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0));
    }
    vec3 _e34 = level_view;
    vec3 _e35 = level_view;
    vec3 towards = normalize((_e34 - (_e6 * dot(_e6, _e35))));
    float sine = sqrt((1.0 - (cosine_3 * cosine_3)));
    vec3 along = (towards * sine);
    vec3 v_1 = (along + (_e6 * cosine_3));
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e90 = k_4;
            k_4 = (_e90 + 1u);
        }
        loop_init_8 = false;
        uint _e53 = k_4;
        if ((_e53 < octagloss_READS)) {
        } else {
            break;
        }
        {
            uint _e56 = k_4;
            vec4 _e57 = octagloss_reflection_node(_e56, roughness_3, cosine_3);
            vec3 half_vector_1 = normalize((_e6 + (_e57.x * along)));
            vec3 direction_5 = ((half_vector_1 * (2.0 * dot(v_1, half_vector_1))) - v_1);
            vec3 _e67 = sum_3;
            vec3 _e75 = octagloss_between_levels(probe_10, direction_5, _e57.y);
            sum_3 = (_e67 + (((f0_ * _e57.z) + vec3((f90_ * _e57.w))) * _e75));
            float _e78 = in_mirror;
            in_mirror = (_e78 + ((_e57.z + _e57.w) * max((1.0 - _e57.y), 0.0)));
        }
    }
    vec4 _e93 = octagloss_reflection_node(octagloss_READS, roughness_3, cosine_3);
    vec3 _e94 = sum_3;
    vec2 _e101 = octagloss_place_of(_e6);
    vec2 _e102 = octagloss_place_in_cosine(_e101);
    vec3 _e103 = octagloss_read_cosine(probe_10, _e102);
    sum_3 = (_e94 + (((f0_ * _e93.x) + vec3((f90_ * _e93.y))) * _e103));
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e190 = k_5;
            k_5 = (_e190 + 1u);
        }
        loop_init_9 = false;
        uint _e129 = k_5;
        if ((_e129 < 5u)) {
        } else {
            break;
        }
        {
            uint _e132 = k_5;
            float _e135 = angles[_e132].x;
            uint _e137 = k_5;
            float _e140 = angles[_e137].y;
            vec3 _e143[5] = octagloss_harmonic_orders(probe_10, ((_e6 * _e135) + (towards * _e140)));
            orders = _e143;
            uint _e145 = k_5;
            order_2 = _e145;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e187 = order_2;
                    order_2 = (_e187 + 1u);
                }
                loop_init_10 = false;
                uint _e147 = order_2;
                if ((_e147 < 5u)) {
                } else {
                    break;
                }
                {
                    uint _e150 = pair;
                    if (((_e150 % 2u) == 0u)) {
                        uint _e156 = pair;
                        vec4 _e160 = octagloss_reflection_node((10u + (_e156 / 2u)), roughness_3, cosine_3);
                        texel = _e160;
                    }
                    vec4 _e161 = texel;
                    vec4 _e163 = texel;
                    uint _e165 = pair;
                    vec2 weights_2 = (((_e165 % 2u) == 0u) ? _e163.xy : _e161.zw);
                    vec3 _e171 = sum_3;
                    uint _e178 = order_2;
                    vec3 _e180 = orders[_e178];
                    sum_3 = (_e171 + (((f0_ * weights_2.x) + vec3((f90_ * weights_2.y))) * _e180));
                    uint _e184 = pair;
                    pair = (_e184 + 1u);
                }
            }
        }
    }
    vec3 _e192 = sum_3;
    float _e198 = octagloss_lights[probe_10].unscale;
    sum_3 = (max(_e192, vec3(0.0)) * _e198);
    float _e200 = in_mirror;
    float share_1 = max((1.0 - (_e200 / (_e93.z + _e93.w))), 0.0);
    float _e210 = octagloss_map_inner();
    float alpha_2 = max((roughness_3 * roughness_3), (0.9 / _e210));
    vec3 across_1 = cross(_e6, towards);
    bool loop_init_11 = true;
    while(true) {
        if (!loop_init_11) {
            uint _e290 = k_6;
            k_6 = (_e290 + 1u);
        }
        loop_init_11 = false;
        uint _e217 = k_6;
        if ((_e217 < octagloss_SUNS)) {
        } else {
            break;
        }
        {
            uint _e223 = k_6;
            OctaglossSun sun_2 = octagloss_lights[probe_10].suns[_e223];
            channels = vec4[3](sun_2.red, sun_2.green, sun_2.blue);
            values = vec2[3](vec2(0.0), vec2(0.0), vec2(0.0));
            c = 0u;
            bool loop_init_12 = true;
            while(true) {
                if (!loop_init_12) {
                    uint _e257 = c;
                    c = (_e257 + 1u);
                }
                loop_init_12 = false;
                uint _e235 = c;
                if ((_e235 < 3u)) {
                } else {
                    break;
                }
                {
                    uint _e238 = c;
                    vec4 _e240 = channels[_e238];
                    vec3 to = _e240.xyz;
                    vec3 light_1 = vec3(dot(to, towards), dot(to, across_1), dot(to, _e6));
                    uint _e246 = c;
                    uint _e251 = c;
                    float _e254 = channels[_e251].w;
                    vec2 _e255 = octagloss_brdf_around(vec3(sine, 0.0, cosine_3), light_1, vec2(alpha_2), _e254);
                    values[_e246] = _e255;
                }
            }
            float _e261 = values[0].x;
            float _e264 = values[1].x;
            float _e267 = values[2].x;
            vec3 value_1 = vec3(_e261, _e264, _e267);
            float _e271 = values[0].y;
            float _e274 = values[1].y;
            float _e277 = values[2].y;
            vec3 fresnel = vec3(_e271, _e274, _e277);
            vec3 _e279 = sum_3;
            sum_3 = (_e279 + ((sun_2.energy * (share_1 * value_1)) * (f0_ + ((vec3(f90_) - f0_) * fresnel))));
        }
    }
    vec3 _e292 = sum_3;
    return _e292;
}

vec3 octagloss_reflect(vec3 normal_3, vec3 view_2, float roughness_4, vec3 f0_1, float f90_1) {
    vec3 _e6 = octagloss_reflect_of(0u, normal_3, view_2, roughness_4, f0_1, f90_1);
    return _e6;
}

vec2 octagloss_albedo(float cosine_1, float roughness_5) {
    vec4 _e6 = octagloss_reflection_node(octagloss_READS, roughness_5, clamp(cosine_1, octagloss_LEAST_COSINE, 1.0));
    return _e6.zw;
}
