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
const uint octagloss_INTERVALS = 640u;
#ifndef OCTAGLOSS_CUBE
const int octagloss_MIRROR = 1;
const int octagloss_SHARP = 2;
const int octagloss_LEVELS = 0;
#endif
const uint octagloss_READS = 9u;
const uint octagloss_LAYERS = 18u;
const vec2 octagloss_NODES = vec2(46.0, 26.0);
const float octagloss_LEAST_COSINE = 0.01;
const vec2 octagloss_ALBEDO_NODES = vec2(91.0, 75.0);
const vec4 octagloss_DIP = vec4(0.222, 0.634, 0.098, 0.3126);
const float octagloss_LEAST_ALPHA = 1e-6;
const vec2 octagloss_TABLES = vec2(864.0, 39.0);
const vec4 octagloss_ROW_NODES = vec4(16.0, 10.0, 8.0, 7.0);
const uint octagloss_ROW_MIDDLE = 7u;
const uint octagloss_ROW_PAIRS = 8u;
const uint octagloss_ROW_LAYERS = 21u;
const vec4 octagloss_ROW_ALBEDO_NODES = vec4(16.0, 10.0, 8.0, 13.0);
const float octagloss_ROW_BLOCKS = 21.0;
const vec3 octagloss_ROW_SIZE = vec3(336.0, 80.0, 8.0);
const float octagloss_ROW_SHARP = 0.001;
const float octagloss_NARROWEST = 0.05;
const float octagloss_BLEND = 0.1;
const float octagloss_TILTED = 0.5;
const float octagloss_SKEWED = 0.2;

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
#ifndef OCTAGLOSS_CUBE
}

float octagloss_map_inner() {
    return (float(uvec2(textureSize(octagloss_maps, 0).xy).x) * 0.9411765);
}

float octagloss_map_border() {
    return (float(uvec2(textureSize(octagloss_maps, 0).xy).x) / 34.0);
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_place_of(vec3 direction_1) {
    return direction_1;
#else
vec2 octagloss_place_of(vec3 direction_1) {
    vec3 p = (direction_1 / vec3(((abs(direction_1.x) + abs(direction_1.y)) + abs(direction_1.z))));
    vec2 folded = (vec2(1.0) - abs(p.zx));
    vec2 turned = vec2(((p.x >= 0.0) ? folded.x : -(folded.x)), ((p.z >= 0.0) ? folded.y : -(folded.y)));
    vec2 uv = ((p.y >= 0.0) ? p.xz : turned);
    float _e36 = octagloss_map_inner();
    float _e39 = octagloss_map_border();
    return (vec2(0.5) + (uv * ((0.5 * _e36) / (_e36 + (2.0 * _e39)))));
#endif
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
#ifndef OCTAGLOSS_CUBE
}

vec3 octagloss_read_mirror(uint probe_2, vec2 at_1) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_1, octagloss_MIRROR), 0.0);
    return _e6.xyz;
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_read_mirror(uint probe_2, vec3 at_1) {
    vec4 _e5 = textureLod(octagloss_maps, vec3(at_1), 0.0);
    return _e5.xyz;
#else
vec3 octagloss_read_sharp(uint probe_3, vec2 at_2) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_2, octagloss_SHARP), 0.0);
    return _e6.xyz;
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_read_sharp(uint probe_3, vec3 at_2) {
    vec4 _e5 = textureLod(octagloss_maps, vec3(at_2), 1.0);
    return _e5.xyz;
#else
vec3 octagloss_read_levels(uint probe_4, vec2 at_3, float level) {
    vec4 _e6 = textureLod(octagloss_maps, vec3(at_3, octagloss_LEVELS), level);
    return _e6.xyz;
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_read_levels(uint probe_4, vec3 at_3, float level) {
    vec4 _e7 = textureLod(octagloss_maps, vec3(at_3), (level + 2.0));
    return _e7.xyz;
#else
vec2 octagloss_place_in_cosine(vec2 at_4) {
    float _e1 = octagloss_map_inner();
    float _e2 = octagloss_map_border();
    float size = (_e1 + (2.0 * _e2));
    float _e9 = octagloss_map_inner();
    return (vec2(0.5) + ((at_4 - vec2(0.5)) * ((size / _e9) * 0.9411765)));
#endif
}

#ifdef OCTAGLOSS_CUBE
vec3 octagloss_read_cosine(uint probe_5, vec3 at_4) {
    vec3 _e8 = octagloss_harmonics_around(probe_5, at_4, float[5](1.0, 0.6666667, 0.25, 0.0, -0.041666668));
    return _e8;
#else
vec3 octagloss_read_cosine(uint probe_5, vec2 at_5) {
    float _e2 = octagloss_map_inner();
    float last = roundEven(log2((_e2 / 32.0)));
    vec2 _e9 = octagloss_place_in_cosine(at_5);
    vec4 _e11 = textureLod(octagloss_maps, vec3(_e9, octagloss_MIRROR), last);
    return _e11.xyz;
#endif
}

vec3 octagloss_half_axis_of(uint probe_6, uint disc) {
    uint k_8 = (3u * (disc / 2u));
    float _e11 = octagloss_lights[probe_6].harmonics[k_8].w;
    float _e19 = octagloss_lights[probe_6].harmonics[(k_8 + 1u)].w;
    float _e27 = octagloss_lights[probe_6].harmonics[(k_8 + 2u)].w;
    vec3 half_axis = vec3(_e11, _e19, _e27);
    return (((disc % 2u) == 0u) ? half_axis : -(half_axis));
}

float octagloss_squared(vec3 v) {
    return dot(v, v);
}

vec3 octagloss_radiance_of(uint probe_7, vec3 direction_2, float roughness) {
    vec4 low[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    vec4 high[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    vec3 sum_1 = vec3(0.0);
    float levels[7] = float[7](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    uint level_1 = 0u;
    uint disc_1 = 0u;
    vec3 _e3 = octagloss_source_from_world(probe_7, direction_2);
#ifdef OCTAGLOSS_CUBE
    vec3 _e4 = octagloss_place_of(_e3);
#else
    vec2 _e4 = octagloss_place_of(_e3);
#endif
    float node_1 = (log2((1.0 + (50.0 * roughness))) * 112.826515);
    uint k_9 = min(uint(node_1), 639u);
    float share = (node_1 - float(k_9));
    vec4 _e17[4] = octagloss_node_weights(k_9);
    low = _e17;
    vec4 _e21[4] = octagloss_node_weights((k_9 + 1u));
    high = _e21;
    vec4 _e24 = low[0];
    vec4 _e26 = high[0];
    vec4 a_1 = mix(_e24, _e26, share);
    vec4 _e29 = low[1];
    vec4 _e31 = high[1];
    vec4 b_1 = mix(_e29, _e31, share);
    vec4 _e34 = low[2];
    vec4 _e36 = high[2];
    vec4 c_2 = mix(_e34, _e36, share);
    vec4 _e39 = low[3];
    vec4 _e41 = high[3];
    vec4 e = mix(_e39, _e41, share);
    if ((a_1.x != 0.0)) {
        vec3 _e48 = sum_1;
        vec3 _e50 = octagloss_read_mirror(probe_7, _e4);
        sum_1 = (_e48 + (a_1.x * _e50));
    }
    if ((a_1.y != 0.0)) {
        vec3 _e56 = sum_1;
        vec3 _e58 = octagloss_read_sharp(probe_7, _e4);
        sum_1 = (_e56 + (a_1.y * _e58));
    }
    levels = float[7](a_1.z, a_1.w, b_1.x, b_1.y, b_1.z, b_1.w, c_2.x);
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
                vec3 _e86 = octagloss_read_levels(probe_7, _e4, float(_e84));
                sum_1 = (_e80 + (_e83 * _e86));
            }
        }
    }
    if ((c_2.y != 0.0)) {
        vec3 _e95 = sum_1;
        vec3 _e97 = octagloss_read_cosine(probe_7, _e4);
        sum_1 = (_e95 + (c_2.y * _e97));
    }
    vec3 _e100 = sum_1;
    vec3 _e107 = octagloss_harmonics_around(probe_7, _e3, float[5](c_2.z, c_2.w, e.x, e.y, e.z));
    sum_1 = (_e100 + _e107);
    vec3 _e109 = sum_1;
    float _e115 = octagloss_lights[probe_7].unscale;
    sum_1 = (max(_e109, vec3(0.0)) * _e115);
    float a2_ = (((roughness * roughness) * roughness) * roughness);
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e225 = disc_1;
            disc_1 = (_e225 + 1u);
        }
        loop_init_4 = false;
        uint _e122 = disc_1;
        if ((_e122 < 16u)) {
        } else {
            break;
        }
        {
            uint _e128 = disc_1;
            OctaglossSun sun = octagloss_lights[probe_7].suns[(_e128 / 2u)];
            uint _e133 = disc_1;
            vec3 _e134 = octagloss_half_axis_of(probe_7, _e133);
            float _e135 = octagloss_squared(_e134);
            float nearer = (1.0 - (0.5 * _e135));
            vec3 to = (_e3 - _e134);
            float _e145 = octagloss_squared((to - (nearer * sun.red.xyz)));
            float _e150 = octagloss_squared((to - (nearer * sun.green.xyz)));
            float _e155 = octagloss_squared((to - (nearer * sun.blue.xyz)));
            vec3 apart = vec3(_e145, _e150, _e155);
            vec3 s = min((0.25 * apart), vec3(0.5));
            vec3 radius2_ = (0.5 * vec3(sun.red.w, sun.green.w, sun.blue.w));
            vec3 nearness = ((s + (a2_ * (vec3(1.0) - s))) - radius2_);
            vec3 root = max(sqrt(((nearness * nearness) + ((4.0 * a2_) * radius2_))), vec3(1e-30));
            vec3 outside = (vec3((2.0 * a2_)) / (root * max((root + nearness), vec3(1e-30))));
            vec3 inside = ((root - nearness) / ((2.0 * max(radius2_, vec3(1e-30))) * root));
            vec3 lobe = ((0.15915494 * mix(inside, outside, greaterThan(nearness, vec3(0.0)))) * (vec3(1.0) - (2.0 * s)));
            vec3 _e214 = sum_1;
            sum_1 = (_e214 + ((sun.energy * lobe) * (e.w * (1.0 - a_1.x))));
        }
    }
    vec3 _e227 = sum_1;
    return _e227;
}

vec3 octagloss_radiance(vec3 direction_3, float roughness_1) {
    vec3 _e3 = octagloss_radiance_of(0u, direction_3, roughness_1);
    return _e3;
}

vec3 octagloss_irradiance_of(uint probe_8, vec3 normal) {
    vec3 sum_2 = vec3(0.0);
    uint k_1 = 0u;
    vec3 _e2 = octagloss_source_from_world(probe_8, normal);
#ifdef OCTAGLOSS_CUBE
    vec3 _e3 = octagloss_place_of(_e2);
#else
    vec2 _e3 = octagloss_place_of(_e2);
#endif
    vec3 _e4 = octagloss_read_cosine(probe_8, _e3);
    float _e8 = octagloss_lights[probe_8].unscale;
    sum_2 = (_e4 * _e8);
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e41 = k_1;
            k_1 = (_e41 + 1u);
        }
        loop_init_5 = false;
        uint _e13 = k_1;
        if ((_e13 < octagloss_SUNS)) {
        } else {
            break;
        }
        {
            uint _e19 = k_1;
            OctaglossSun sun_1 = octagloss_lights[probe_8].suns[_e19];
            vec3 facing = vec3(dot(_e2, sun_1.red.xyz), dot(_e2, sun_1.green.xyz), dot(_e2, sun_1.blue.xyz));
            vec3 _e32 = sum_2;
            sum_2 = (_e32 + (sun_1.energy * (0.31830987 * max(facing, vec3(0.0)))));
        }
    }
    vec3 _e43 = sum_2;
    return _e43;
}

vec3 octagloss_irradiance(vec3 normal_1) {
    vec3 _e2 = octagloss_irradiance_of(0u, normal_1);
    return _e2;
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_read_reflections(uint layer, vec2 at_5) {
#else
vec4 octagloss_read_reflections(uint layer, vec2 at_6) {
#endif
    vec2 corner = vec2((1.0 + (float(layer) * 48.0)), 0.0);
#ifdef OCTAGLOSS_CUBE
    vec4 _e17 = textureLod(octagloss_tables, vec2((((at_5 * octagloss_NODES) + corner) / octagloss_TABLES)), 0.0);
#else
    vec4 _e17 = textureLod(octagloss_tables, vec2((((at_6 * octagloss_NODES) + corner) / octagloss_TABLES)), 0.0);
#endif
    return _e17;
}

vec4 octagloss_reflection_node(uint layer_1, float roughness_2, float cosine) {
    float sine = sqrt(max((1.0 - (cosine * cosine)), 0.0));
    vec2 place_2 = vec2((log2((1.0 + (10.0 * roughness_2))) * 0.28906482), sqrt((cosine * inversesqrt((1.0 + sine)))));
#ifdef OCTAGLOSS_CUBE
    vec2 at_7 = (((place_2 * vec2(45.0, 25.0)) + vec2(0.5)) / octagloss_NODES);
    vec4 _e31 = octagloss_read_reflections(layer_1, at_7);
#else
    vec2 at_8 = (((place_2 * vec2(45.0, 25.0)) + vec2(0.5)) / octagloss_NODES);
    vec4 _e31 = octagloss_read_reflections(layer_1, at_8);
#endif
    return _e31;
}

vec4 octagloss_read_albedo(uint texel) {
    vec4 _e9 = texelFetch(octagloss_tables, ivec2(uvec2((texel % 864u), (31u + (texel / 864u)))), 0);
    return _e9;
}

vec2 octagloss_round_albedo(float cosine_1, float roughness_3) {
    float seen = clamp(cosine_1, 0.0001, 1.0);
    vec2 places = vec2((log2((1.0 + (30.0 * roughness_3))) * 0.2018487), ((sqrt(sqrt(seen)) - 0.1) / 0.9));
    vec2 place_3 = (clamp(places, vec2(0.0), vec2(1.0)) * vec2(90.0, 74.0));
    vec2 node_2 = min(floor(place_3), vec2(89.0, 73.0));
    vec2 share_1 = (place_3 - node_2);
    uint first = uint((node_2.x + (91.0 * node_2.y)));
    vec4 _e39 = octagloss_read_albedo(first);
    vec4 _e42 = octagloss_read_albedo((first + 91u));
    vec4 pair_2 = mix(_e39, _e42, share_1.y);
    float t = (seen / max((roughness_3 * roughness_3), octagloss_LEAST_ALPHA));
    float left = (1.0 - ((0.222 * t) / (1.0 + (t * (0.634 + (t * (0.098 + (t * 0.3126))))))));
    return (left * mix(pair_2.xy, pair_2.zw, share_1.x));
}

vec3 octagloss_between_levels(uint probe_9, vec3 direction_4, float level_2) {
#ifdef OCTAGLOSS_CUBE
    vec3 _e3 = octagloss_place_of(direction_4);
#else
    vec2 _e3 = octagloss_place_of(direction_4);
#endif
    if ((level_2 >= 2.0)) {
        vec3 _e8 = octagloss_read_levels(probe_9, _e3, (level_2 - 2.0));
        return _e8;
    }
    if ((level_2 >= 1.0)) {
        vec3 _e11 = octagloss_read_sharp(probe_9, _e3);
        vec3 _e13 = octagloss_read_levels(probe_9, _e3, 0.0);
        return mix(_e11, _e13, (level_2 - 1.0));
    }
    vec3 _e17 = octagloss_read_mirror(probe_9, _e3);
    vec3 _e18 = octagloss_read_sharp(probe_9, _e3);
    return mix(_e17, _e18, level_2);
}

float octagloss_masking_of(vec3 w, vec2 alpha) {
    return length(vec3((alpha * w.xy), w.z));
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
    float along_2 = dot(h, l);
#ifdef OCTAGLOSS_CUBE
    float size = ((above * (2.0 - above)) / (length2_ * bend));
    float trace = (size * dot(shape, (vec3(1.0) - (l * l))));
#else
    float size_1 = ((above * (2.0 - above)) / (length2_ * bend));
    float trace = (size_1 * dot(shape, (vec3(1.0) - (l * l))));
#endif
    float _e60 = octagloss_squared(cross(l, bent));
#ifdef OCTAGLOSS_CUBE
    float aside_1 = (trace - ((size * _e60) / bend));
#else
    float aside_1 = (trace - ((size_1 * _e60) / bend));
#endif
    float _e64 = octagloss_masking_of(l, alpha_1);
#ifdef OCTAGLOSS_CUBE
    float determinant_ = (((size * size) * _e64) * _e64);
#else
    float determinant_ = (((size_1 * size_1) * _e64) * _e64);
#endif
    float near = (((shape.z * along_2) * along_2) / ((bend * _e64) * _e64));
#ifdef OCTAGLOSS_CUBE
    float last = (determinant_ * near);
#else
    float last_1 = (determinant_ * near);
#endif
    float linear = (1.0 - trace);
    x = max((0.5 * (linear + sqrt(((linear * linear) + ((4.0 * trace) * near))))), near);
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e140 = step_;
            step_ = (_e140 + 1u);
        }
        loop_init_6 = false;
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
#ifdef OCTAGLOSS_CUBE
            side = (((_e112 + aside_1) * _e114) + last);
#else
            side = (((_e112 + aside_1) * _e114) + last_1);
#endif
            float _e117 = x;
            float _e121 = x;
            float _e129 = x;
            float _e135 = x;
#ifdef OCTAGLOSS_CUBE
            slope = (((((((((_e117 + (2.0 * aside_1)) * _e121) + (3.0 * last)) + (trace * aside_1)) - determinant_) * _e129) + ((2.0 * trace) * last)) * _e135) + (determinant_ * last));
#else
            slope = (((((((((_e117 + (2.0 * aside_1)) * _e121) + (3.0 * last_1)) + (trace * aside_1)) - determinant_) * _e129) + ((2.0 * trace) * last_1)) * _e135) + (determinant_ * last_1));
#endif
        }
    }
    float _e143 = x;
#ifdef OCTAGLOSS_CUBE
    vec3 inverse_ = (vec3(1.0) / ((size * shape) + vec3(_e143)));
#else
    vec3 inverse_ = (vec3(1.0) / ((size_1 * shape) + vec3(_e143)));
#endif
    float _e152 = x;
#ifdef OCTAGLOSS_CUBE
    float towards = ((size * dot(l, (inverse_ * bent))) / (_e152 * dot(l, (inverse_ * l))));
#else
    float towards = ((size_1 * dot(l, (inverse_ * bent))) / (_e152 * dot(l, (inverse_ * l))));
#endif
    vec3 axis_1 = normalize((inverse_ * (h + (towards * l))));
    float cosine_10 = dot(view, axis_1);
    vec3 lit = (((2.0 * cosine_10) * axis_1) - view);
    float facing_1 = max(lit.z, 0.0);
    float _e169 = side;
    float _e170 = x;
    float _e171 = slope;
    float lobe_1 = ((sqrt((_e169 / (((_e170 * _e171) * bend) * dot(axis_1, (shape * axis_1))))) * shape.z) / (3.1415927 * bend));
    float share_2 = (pow(left_1, 1.25) * (1.0 - (0.5 * above)));
    float _e191 = octagloss_masking_of(view, alpha_1);
    float _e194 = octagloss_masking_of(lit, alpha_1);
    float visible = (facing_1 / ((facing_1 * _e191) + (view.z * _e194)));
    float value = ((((((share_2 * 2.0) * along_2) * cosine_10) / length2_) * lobe_1) * visible);
    return vec2(value, pow(max((1.0 - cosine_10), 0.0), 5.0));
}

vec3[5] octagloss_harmonic_orders(uint probe_10, vec3 d_2) {
    float basis_1[25] = float[25](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    vec3 sums[5] = vec3[5](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint order_1 = 0u;
    uint k_2 = 0u;
    float _e2[25] = octagloss_harmonic_basis(d_2);
    basis_1 = _e2;
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e43 = order_1;
            order_1 = (_e43 + 1u);
        }
        loop_init_7 = false;
        uint _e8 = order_1;
        if ((_e8 < 5u)) {
        } else {
            break;
        }
        {
            uint _e11 = order_1;
            uint _e12 = order_1;
            k_2 = (_e11 * _e12);
            bool loop_init_8 = true;
            while(true) {
                if (!loop_init_8) {
                    uint _e40 = k_2;
                    k_2 = (_e40 + 1u);
                }
                loop_init_8 = false;
                uint _e15 = k_2;
                uint _e16 = order_1;
                uint _e19 = order_1;
                if ((_e15 < ((_e16 + 1u) * (_e19 + 1u)))) {
                } else {
                    break;
                }
                {
                    uint _e24 = order_1;
                    vec3 _e26 = sums[_e24];
                    uint _e27 = k_2;
                    float _e29 = basis_1[_e27];
                    uint _e33 = k_2;
                    vec4 _e35 = octagloss_lights[probe_10].harmonics[_e33];
                    sums[_e24] = (_e26 + (_e29 * _e35.xyz));
                }
            }
        }
    }
    vec3 _e45[5] = sums;
    return _e45;
}

vec3 octagloss_cosine_light(uint probe_11, vec3 n) {
#ifdef OCTAGLOSS_CUBE
    vec3 _e2 = octagloss_place_of(n);
#else
    vec2 _e2 = octagloss_place_of(n);
#endif
    vec3 _e3 = octagloss_read_cosine(probe_11, _e2);
    return _e3;
}

vec3 octagloss_harmonics_reflected(uint probe_12, octagloss_SurfaceFrame surface, vec4 pairs[8], vec3 f0_, float f90_) {
    vec2 angles[5] = vec2[5](vec2(1.0, 0.0), vec2(0.309017, 0.95105654), vec2(-0.809017, 0.58778524), vec2(0.809017, 0.58778524), vec2(-0.309017, 0.95105654));
    vec4 texels[8] = vec4[8](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    vec3 sum_3 = vec3(0.0);
    uint pair = 0u;
    uint k_3 = 0u;
    vec3 orders[5] = vec3[5](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint order_2 = 0u;
    texels = pairs;
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e84 = k_3;
            k_3 = (_e84 + 1u);
        }
        loop_init_9 = false;
        uint _e29 = k_3;
        if ((_e29 < 5u)) {
        } else {
            break;
        }
        {
            uint _e33 = k_3;
            float _e36 = angles[_e33].x;
            uint _e39 = k_3;
            float _e42 = angles[_e39].y;
            vec3 _e45[5] = octagloss_harmonic_orders(probe_12, ((surface.normal * _e36) + (surface.towards * _e42)));
            orders = _e45;
            uint _e47 = k_3;
            order_2 = _e47;
            bool loop_init_10 = true;
            while(true) {
                if (!loop_init_10) {
                    uint _e81 = order_2;
                    order_2 = (_e81 + 1u);
                }
                loop_init_10 = false;
                uint _e49 = order_2;
                if ((_e49 < 5u)) {
                } else {
                    break;
                }
                {
                    uint _e52 = pair;
                    vec4 texel_2 = texels[(_e52 / 2u)];
                    uint _e59 = pair;
                    vec2 weights_2 = (((_e59 % 2u) == 0u) ? texel_2.xy : texel_2.zw);
                    vec3 _e65 = sum_3;
                    uint _e72 = order_2;
                    vec3 _e74 = orders[_e72];
                    sum_3 = (_e65 + (((f0_ * weights_2.x) + vec3((f90_ * weights_2.y))) * _e74));
                    uint _e78 = pair;
                    pair = (_e78 + 1u);
                }
            }
        }
    }
    vec3 _e86 = sum_3;
    return _e86;
#ifdef OCTAGLOSS_CUBE
}

float octagloss_map_inner() {
    return float(uvec2(textureSize(octagloss_maps, 0).xy).x);
#endif
}

vec3 octagloss_suns_reflected(uint probe_13, octagloss_SurfaceFrame surface_1, vec2 tangent, vec2 alpha_2, vec3 f0_1, float f90_1) {
    vec3 sum_4 = vec3(0.0);
    uint disc_2 = 0u;
    vec4 channels[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    vec2 values[3] = vec2[3](vec2(0.0), vec2(0.0), vec2(0.0));
    uint c = 0u;
    vec3 across = cross(surface_1.normal, surface_1.towards);
    vec3 x_2 = ((surface_1.towards * tangent.x) + (across * tangent.y));
    vec3 y_1 = ((across * tangent.x) - (surface_1.towards * tangent.y));
    vec3 view_5 = vec3((surface_1.sine * tangent.x), (-(surface_1.sine) * tangent.y), surface_1.cosine);
    float _e30 = octagloss_map_inner();
    vec2 wide = max(alpha_2, vec2((0.9 / _e30)));
    bool loop_init_11 = true;
    while(true) {
        if (!loop_init_11) {
            uint _e122 = disc_2;
            disc_2 = (_e122 + 1u);
        }
        loop_init_11 = false;
        uint _e39 = disc_2;
        if ((_e39 < 16u)) {
        } else {
            break;
        }
        {
            uint _e45 = disc_2;
            OctaglossSun sun_2 = octagloss_lights[probe_13].suns[(_e45 / 2u)];
            uint _e50 = disc_2;
            vec3 _e51 = octagloss_half_axis_of(probe_13, _e50);
            float _e52 = octagloss_squared(_e51);
            float nearer_1 = (1.0 - (0.5 * _e52));
            channels = vec4[3](sun_2.red, sun_2.green, sun_2.blue);
            values = vec2[3](vec2(0.0), vec2(0.0), vec2(0.0));
            c = 0u;
            bool loop_init_12 = true;
            while(true) {
                if (!loop_init_12) {
                    uint _e88 = c;
                    c = (_e88 + 1u);
                }
                loop_init_12 = false;
                uint _e66 = c;
                if ((_e66 < 3u)) {
                } else {
                    break;
                }
                {
                    uint _e69 = c;
                    vec4 _e71 = channels[_e69];
                    vec3 to_1 = ((nearer_1 * _e71.xyz) + _e51);
                    vec3 light_1 = vec3(dot(to_1, x_2), dot(to_1, y_1), dot(to_1, surface_1.normal));
                    uint _e80 = c;
                    uint _e82 = c;
                    float _e85 = channels[_e82].w;
                    vec2 _e86 = octagloss_brdf_around(view_5, light_1, wide, _e85);
                    values[_e80] = _e86;
                }
            }
            float _e92 = values[0].x;
            float _e95 = values[1].x;
            float _e98 = values[2].x;
            vec3 value_1 = vec3(_e92, _e95, _e98);
            float _e102 = values[0].y;
            float _e105 = values[1].y;
            float _e108 = values[2].y;
            vec3 fresnel = vec3(_e102, _e105, _e108);
            vec3 _e110 = sum_4;
            sum_4 = (_e110 + (((0.5 * sun_2.energy) * value_1) * (f0_1 + ((vec3(f90_1) - f0_1) * fresnel))));
        }
    }
    vec3 _e124 = sum_4;
    return _e124;
}

vec2 octagloss_albedo_share(vec2 albedo, vec2 sums_1) {
    return ((albedo + vec2(0.0001)) / (max(sums_1, vec2(0.0)) + vec2(0.0001)));
}

vec3 octagloss_reflected_isotropic(uint probe_14, octagloss_SurfaceFrame surface_2, float roughness_4, vec3 f0_2, float f90_2) {
    vec3 sum_5 = vec3(0.0);
    float in_mirror = 0.0;
    uint k_4 = 0u;
    vec4 pairs_1[8] = vec4[8](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    uint k_5 = 0u;
    vec3 n_1 = surface_2.normal;
    float cosine_11 = surface_2.cosine;
    vec3 along_3 = (surface_2.towards * surface_2.sine);
    vec3 v_1 = (along_3 + (n_1 * cosine_11));
    vec4 _e13 = octagloss_reflection_node(octagloss_READS, roughness_4, cosine_11);
    vec2 _e14 = octagloss_round_albedo(cosine_11, roughness_4);
    vec2 _e16 = octagloss_albedo_share(_e14, _e13.zw);
    vec3 scaled = (f0_2 * _e16.x);
    float grazing = (f90_2 * _e16.y);
    bool loop_init_13 = true;
    while(true) {
        if (!loop_init_13) {
            uint _e64 = k_4;
            k_4 = (_e64 + 1u);
        }
        loop_init_13 = false;
        uint _e27 = k_4;
        if ((_e27 < octagloss_READS)) {
        } else {
            break;
        }
        {
            uint _e30 = k_4;
            vec4 _e31 = octagloss_reflection_node(_e30, roughness_4, cosine_11);
            vec3 half_vector = normalize((n_1 + (_e31.x * along_3)));
            vec3 direction_5 = ((half_vector * (2.0 * dot(v_1, half_vector))) - v_1);
            vec3 _e41 = sum_5;
            vec3 _e49 = octagloss_between_levels(probe_14, direction_5, _e31.y);
            sum_5 = (_e41 + (((scaled * _e31.z) + vec3((grazing * _e31.w))) * _e49));
            float _e52 = in_mirror;
            in_mirror = (_e52 + ((_e31.z + _e31.w) * max((1.0 - _e31.y), 0.0)));
        }
    }
    vec3 _e66 = sum_5;
    vec3 _e73 = octagloss_cosine_light(probe_14, n_1);
    sum_5 = (_e66 + (((scaled * _e13.x) + vec3((grazing * _e13.y))) * _e73));
    bool loop_init_14 = true;
    while(true) {
        if (!loop_init_14) {
            uint _e90 = k_5;
            k_5 = (_e90 + 1u);
        }
        loop_init_14 = false;
        uint _e80 = k_5;
        if ((_e80 < 8u)) {
        } else {
            break;
        }
        {
            uint _e83 = k_5;
            uint _e86 = k_5;
            vec4 _e88 = octagloss_reflection_node((10u + _e86), roughness_4, cosine_11);
            pairs_1[_e83] = _e88;
        }
    }
    vec3 _e92 = sum_5;
    vec4 _e93[8] = pairs_1;
    vec3 _e94 = octagloss_harmonics_reflected(probe_14, surface_2, _e93, scaled, grazing);
    sum_5 = (_e92 + _e94);
    vec3 _e96 = sum_5;
    float _e102 = octagloss_lights[probe_14].unscale;
    sum_5 = (max(_e96, vec3(0.0)) * _e102);
    float _e104 = in_mirror;
    float share_3 = max((1.0 - (_e104 / (_e13.z + _e13.w))), 0.0);
    vec2 alpha_11 = vec2((roughness_4 * roughness_4));
    vec3 _e115 = sum_5;
    vec3 _e119 = octagloss_suns_reflected(probe_14, surface_2, vec2(1.0, 0.0), alpha_11, f0_2, f90_2);
    return (_e115 + (share_3 * _e119));
}

octagloss_SurfaceFrame octagloss_surface_of(uint probe_15, vec3 normal_2, vec3 view_1) {
    vec3 level_view = vec3(0.0);
    vec3 _e3 = octagloss_source_from_world(probe_15, normal_2);
    vec3 _e4 = octagloss_source_from_world(probe_15, view_1);
    float cosine_12 = clamp(dot(_e3, _e4), octagloss_LEAST_COSINE, 1.0);
    level_view = (_e4 - (_e3 * dot(_e3, _e4)));
    vec3 _e13 = level_view;
    vec3 _e14 = level_view;
    if ((dot(_e13, _e14) < 1e-10)) {
        level_view = ((abs(_e3.x) > 0.5) ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0));
    }
    vec3 _e31 = level_view;
    vec3 _e32 = level_view;
    vec3 towards_1 = normalize((_e31 - (_e3 * dot(_e3, _e32))));
    return octagloss_SurfaceFrame(_e3, towards_1, cosine_12, sqrt((1.0 - (cosine_12 * cosine_12))));
}

vec3 octagloss_reflect_isotropic(vec3 normal_3, vec3 view_2, float roughness_5, vec3 f0_3, float f90_3) {
    octagloss_SurfaceFrame _e7 = octagloss_surface_of(0u, normal_3, view_2);
    vec3 _e8 = octagloss_reflected_isotropic(0u, _e7, roughness_5, f0_3, f90_3);
    return _e8;
}

vec2 octagloss_row_alphas(float roughness_6, float anisotropy) {
    float alpha_12 = (roughness_6 * roughness_6);
    return vec2((alpha_12 + (((1.0 - alpha_12) * anisotropy) * anisotropy)), alpha_12);
}

float octagloss_row_share(vec2 alpha_3) {
    return smoothstep(0.0, 1.0, ((alpha_3.x - alpha_3.y) / (octagloss_BLEND * max(alpha_3.y, 1e-6))));
}

vec4 octagloss_row_places(vec2 alpha_4, float cosine_2, vec2 tangent_1) {
    float sharp = max(alpha_4.y, octagloss_ROW_SHARP);
    float azimuth = (atan(abs(tangent_1.y), abs(tangent_1.x)) * 0.63661975);
    vec4 places_1 = vec4((log2((1.0 + (5.0 * sqrt(alpha_4.y)))) * 0.3868528), sqrt(cosine_2), (1.0 - pow(max((1.0 - azimuth), 0.0), 0.6666667)), (log2((max(alpha_4.x, sharp) / sharp)) / -(log2(min(sharp, 0.999999)))));
    return clamp(places_1, vec4(0.0), vec4(1.0));
}

octagloss_RowPlace octagloss_row_place(vec2 alpha_5, float cosine_3, vec2 tangent_2) {
    vec4 _e3 = octagloss_row_places(alpha_5, cosine_3, tangent_2);
    vec4 place_4 = (_e3 * vec4(15.0, 9.0, 7.0, 6.0));
    float lower = min(floor(place_4.w), 5.0);
    vec2 inside_1 = clamp(place_4.xy, vec2(0.00390625), (vec2(15.0, 9.0) - vec2(0.00390625)));
    vec3 texel_3 = (vec3(inside_1.x, (inside_1.y + (10.0 * lower)), place_4.z) + vec3(0.5));
    return octagloss_RowPlace((texel_3 / octagloss_ROW_SIZE), (place_4.w - lower));
}

#ifdef OCTAGLOSS_CUBE
vec4 octagloss_read_rows(vec3 at_6) {
    vec4 _e4 = textureLod(octagloss_rows, vec3(at_6), 0.0);
#else
vec4 octagloss_read_rows(vec3 at_7) {
    vec4 _e4 = textureLod(octagloss_rows, vec3(at_7), 0.0);
#endif
    return _e4;
}

vec4 octagloss_row_node(uint layer_2, octagloss_RowPlace place) {
#ifdef OCTAGLOSS_CUBE
    vec3 at_8 = vec3((place.at.x + (float(layer_2) / 21.0)), place.at.yz);
    vec4 _e11 = octagloss_read_rows(at_8);
    vec4 _e18 = octagloss_read_rows(vec3(at_8.x, (at_8.y + 0.125), at_8.z));
#else
    vec3 at_9 = vec3((place.at.x + (float(layer_2) / 21.0)), place.at.yz);
    vec4 _e11 = octagloss_read_rows(at_9);
    vec4 _e18 = octagloss_read_rows(vec3(at_9.x, (at_9.y + 0.125), at_9.z));
#endif
    return mix(_e11, _e18, place.share);
}

vec4 octagloss_row_block(float block, vec3 place_1) {
    float row_2 = floor(((block + 0.5) / octagloss_ROW_BLOCKS));
    vec2 corner_1 = (vec2(16.0, 10.0) * vec2((block - (octagloss_ROW_BLOCKS * row_2)), row_2));
    vec3 first_1 = vec3(corner_1.x, (corner_1.y + 70.0), 0.0);
    vec4 _e27 = octagloss_read_rows((((first_1 + place_1) + vec3(0.5)) / octagloss_ROW_SIZE));
    return _e27;
}

vec4 octagloss_row_more(vec2 alpha_6, float cosine_4, vec2 tangent_3) {
    vec4 _e3 = octagloss_row_places(alpha_6, cosine_4, tangent_3);
    vec4 place_5 = (_e3 * vec4(15.0, 9.0, 7.0, 12.0));
    float lower_1 = min(floor(place_5.w), 11.0);
    vec3 inside_2 = vec3(clamp(place_5.xy, vec2(0.00390625), (vec2(15.0, 9.0) - vec2(0.00390625))), place_5.z);
    vec4 _e25 = octagloss_row_block(lower_1, inside_2);
    vec4 _e28 = octagloss_row_block((lower_1 + 1.0), inside_2);
    return mix(_e25, _e28, (place_5.w - lower_1));
}

vec2 octagloss_row_albedo(vec2 alpha_7, float cosine_5, float along, vec2 more) {
    vec2 squares = (alpha_7 * alpha_7);
    float mean_1 = sqrt((0.5 * (squares.x + squares.y)));
    float seen_1 = sqrt(mix(squares.y, squares.x, along));
    vec2 _e17 = octagloss_round_albedo(cosine_5, sqrt(mix(seen_1, mean_1, cosine_5)));
    return max((_e17 + more), vec2(0.0));
}

float octagloss_row_number(vec4 terms[3], vec4 a, vec4 b, vec4 c_1) {
    return ((dot(terms[0], a) + dot(terms[1], b)) + dot(terms[2], c_1));
}

octagloss_Row octagloss_row_of(vec2 alpha_8, vec2 tangent_4, float cosine_6) {
    vec2 axis = vec2(1.0, 0.0);
    vec2 squares_1 = (alpha_8 * alpha_8);
    float difference = (squares_1.x - squares_1.y);
    float along_4 = (squares_1.y + ((difference * tangent_4.x) * tangent_4.x));
    float across_1 = (((squares_1.y + ((difference * tangent_4.y) * tangent_4.y)) * cosine_6) * cosine_6);
    float mixed = (((difference * tangent_4.x) * tangent_4.y) * cosine_6);
    float apart_1 = (0.5 * (along_4 - across_1));
    float root_1 = length(vec2(apart_1, mixed));
    float greatest = max(((0.5 * (along_4 + across_1)) + root_1), 1e-30);
    if ((root_1 > 0.0)) {
        vec2 steep = vec2(abs(mixed), ((root_1 - apart_1) * ((mixed >= 0.0) ? 1.0 : -1.0)));
        axis = normalize((((apart_1 >= 0.0) ? vec2((apart_1 + root_1), mixed) : steep) / vec2(root_1)));
    }
    float x_3 = log(max((((alpha_8.x * alpha_8.y) * cosine_6) / greatest), octagloss_NARROWEST));
    float extent = sqrt(greatest);
    float y_2 = log((1.0 + (6.0 * extent)));
    float _e75 = axis.x;
    float tilt = (_e75 * smoothstep(0.0, octagloss_TILTED, sqrt((1.0 - (cosine_6 * cosine_6)))));
    float _e85 = axis.x;
    float e_1 = (_e85 * tilt);
    vec4 terms_1[3] = vec4[3](vec4(1.0, x_3, (x_3 * x_3), y_2), vec4((x_3 * y_2), (y_2 * y_2), e_1, (e_1 * x_3)), vec4(((x_3 * x_3) * x_3), ((y_2 * y_2) * y_2), ((x_3 * x_3) * y_2), ((x_3 * y_2) * y_2)));
    float _e119 = octagloss_row_number(terms_1, vec4(-0.252, -0.165, 0.077, -0.167), vec4(-0.046, -0.028, -0.39, -0.463), vec4(0.007, 0.174, 0.056, -0.059));
    float _e135 = octagloss_row_number(terms_1, vec4(-0.565, -0.078, 0.414, 0.009), vec4(0.349, -0.022, -0.094, 0.147), vec4(0.096, 0.148, 0.236, 0.258));
    float _e151 = octagloss_row_number(terms_1, vec4(-0.393, -0.205, 0.001, -0.283), vec4(0.234, -0.027, -0.572, -0.277), vec4(0.051, 0.164, 0.17, 0.2));
    float _e167 = octagloss_row_number(terms_1, vec4(0.413, 1.07, -0.1, -0.226), vec4(-0.344, -0.215, -0.033, -0.01), vec4(-0.044, 0.004, -0.121, -0.125));
    float _e183 = octagloss_row_number(terms_1, vec4(-0.373, 0.485, 0.057, 0.062), vec4(-0.546, 0.172, 0.007, -0.936), vec4(0.024, -0.418, -0.221, -0.237));
    float _e199 = octagloss_row_number(terms_1, vec4(0.477, 0.313, -0.017, -0.151), vec4(-0.234, -0.072, -0.068, -0.167), vec4(0.007, -0.011, -0.017, -0.022));
    float _e201 = axis.x;
    float _e203 = axis.y;
    float _e216 = axis.x;
    return octagloss_Row((vec2(_e201, (_e203 / cosine_6)) * sqrt((2.0 * root_1))), extent, (_e119 * tilt), exp(vec4(_e135, _e151, _e167, _e183)), exp(_e199), smoothstep(0.0, octagloss_SKEWED, _e216));
}

vec2 octagloss_row_read(octagloss_Row row_1, uint read) {
    float place_6 = (((float(read) - 7.0) * 0.5714286) + row_1.shift);
    float slope_1 = (((row_1.steps.z * row_1.steps.x) * sinh((row_1.steps.y * place_6))) / row_1.steps.y);
    float wider = (((read % 2u) == 1u) ? row_1.alternation : (1.0 / row_1.alternation));
    float growth = (row_1.steps.w * slope_1);
    float width = (((wider * row_1.steps.z) * sqrt((1.0 + (growth * growth)))) * row_1.extent);
    float _e44 = octagloss_map_inner();
#ifdef OCTAGLOSS_CUBE
    float last_1 = (log2(_e44) - 3.0);
    float sharp_1 = (last_1 + log2((max(width, 1e-9) / 0.35)));
#else
    float last_2 = (log2(_e44) - 3.0);
    float sharp_1 = (last_2 + log2((max(width, 1e-9) / 0.35)));
#endif
    float below = max((log2(((max(width, 1e-9) * _e44) / 1.8)) * 0.610706), 0.0);
#ifdef OCTAGLOSS_CUBE
    return vec2(slope_1, ((sharp_1 >= 1.0) ? min(sharp_1, last_1) : below));
#else
    return vec2(slope_1, ((sharp_1 >= 1.0) ? min(sharp_1, last_2) : below));
#endif
}

vec3 octagloss_reflect_in_row(uint probe_16, octagloss_SurfaceFrame surface_3, vec2 tangent_5, vec2 alpha_9, vec3 f0_4, float f90_4) {
    vec3 sum_6 = vec3(0.0);
    float in_mirror_1 = 0.0;
    uint distance_ = 0u;
    vec2 mean = vec2(0.0);
    vec2 skew = vec2(0.0);
    uint side_1 = 0u;
    vec4 pairs_2[8] = vec4[8](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    uint k_6 = 0u;
    vec3 aside[4] = vec3[4](vec3(0.4620342, 0.54655075, -0.6984316), vec3(0.8966183, 0.38650447, 0.21607853), vec3(0.11814805, 0.3835753, 0.91592085), vec3(0.14011177, 0.8172301, -0.5590202));
    vec4 texel_1 = vec4(0.0);
    uint pair_1 = 15u;
    uint k_7 = 0u;
    vec3 own_1[5] = vec3[5](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    vec3 other[5] = vec3[5](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    uint order_3 = 0u;
    vec3 n_2 = surface_3.normal;
    vec3 across_2 = cross(n_2, surface_3.towards);
    vec3 v_2 = ((surface_3.towards * surface_3.sine) + (n_2 * surface_3.cosine));
    octagloss_RowPlace _e16 = octagloss_row_place(alpha_9, surface_3.cosine, tangent_5);
    octagloss_Row _e18 = octagloss_row_of(alpha_9, tangent_5, surface_3.cosine);
    vec3 axis_2 = ((surface_3.towards * _e18.axis.x) + (across_2 * _e18.axis.y));
    vec4 _e28 = octagloss_row_more(alpha_9, surface_3.cosine, tangent_5);
    vec2 more_1 = _e28.xy;
    vec2 _e34 = octagloss_row_albedo(alpha_9, surface_3.cosine, (tangent_5.x * tangent_5.x), more_1);
    vec3 scaled_1 = (f0_4 * _e34.x);
    float grazing_1 = (f90_4 * _e34.y);
    bool loop_init_15 = true;
    while(true) {
        if (!loop_init_15) {
            uint _e142 = distance_;
            distance_ = (_e142 + 1u);
        }
        loop_init_15 = false;
        uint _e45 = distance_;
        if ((_e45 <= octagloss_ROW_MIDDLE)) {
        } else {
            break;
        }
        {
            uint _e48 = distance_;
            vec4 _e49 = octagloss_row_node(_e48, _e16);
            mean = _e49.xy;
            skew = vec2(0.0);
            uint _e54 = distance_;
            if ((_e54 == 0u)) {
                vec3 _e57 = sum_6;
                vec3 _e64 = octagloss_cosine_light(probe_16, n_2);
                sum_6 = (_e57 + (((scaled_1 * _e49.z) + vec3((grazing_1 * _e49.w))) * _e64));
            } else {
                mean = (0.5 * (_e49.xy + _e49.zw));
                skew = ((0.5 * _e18.skew) * (_e49.xy - _e49.zw));
            }
            side_1 = 0u;
            bool loop_init_16 = true;
            while(true) {
                if (!loop_init_16) {
                    uint _e139 = side_1;
                    side_1 = (_e139 + 1u);
                }
                loop_init_16 = false;
                uint _e81 = side_1;
                uint _e82 = distance_;
                if ((_e81 < min((_e82 + 1u), 2u))) {
                } else {
                    break;
                }
                {
                    vec2 _e88 = mean;
                    vec2 _e89 = skew;
                    vec2 _e91 = mean;
                    vec2 _e92 = skew;
                    uint _e94 = side_1;
                    vec2 weights_3 = ((_e94 == 0u) ? (_e91 + _e92) : (_e88 - _e89));
                    uint _e99 = distance_;
                    uint _e102 = distance_;
                    uint _e104 = side_1;
                    vec2 _e108 = octagloss_row_read(_e18, ((_e104 == 0u) ? (octagloss_ROW_MIDDLE + _e102) : (octagloss_ROW_MIDDLE - _e99)));
                    vec3 half_vector_1 = normalize((n_2 + (_e108.x * axis_2)));
                    vec3 direction_6 = ((half_vector_1 * (2.0 * dot(v_2, half_vector_1))) - v_2);
                    vec3 _e118 = sum_6;
                    vec3 _e126 = octagloss_between_levels(probe_16, direction_6, _e108.y);
                    sum_6 = (_e118 + (((scaled_1 * weights_3.x) + vec3((grazing_1 * weights_3.y))) * _e126));
                    float _e129 = in_mirror_1;
                    in_mirror_1 = (_e129 + (dot(_e34, weights_3) * max((1.0 - _e108.y), 0.0)));
                }
            }
        }
    }
    bool loop_init_17 = true;
    while(true) {
        if (!loop_init_17) {
            uint _e158 = k_6;
            k_6 = (_e158 + 1u);
        }
        loop_init_17 = false;
        uint _e148 = k_6;
        if ((_e148 < 8u)) {
        } else {
            break;
        }
        {
            uint _e151 = k_6;
            uint _e154 = k_6;
            vec4 _e156 = octagloss_row_node((octagloss_ROW_PAIRS + _e154), _e16);
            pairs_2[_e151] = _e156;
        }
    }
    vec3 _e160 = sum_6;
    vec4 _e161[8] = pairs_2;
    vec3 _e162 = octagloss_harmonics_reflected(probe_16, surface_3, _e161, scaled_1, grazing_1);
    sum_6 = (_e160 + _e162);
    vec3 mirrored = (across_2 * (((tangent_5.x * tangent_5.y) < 0.0) ? -1.0 : 1.0));
    vec4 _e192 = pairs_2[7];
    texel_1 = _e192;
    bool loop_init_18 = true;
    while(true) {
        if (!loop_init_18) {
            uint _e280 = k_7;
            k_7 = (_e280 + 1u);
        }
        loop_init_18 = false;
        uint _e198 = k_7;
        if ((_e198 < 4u)) {
        } else {
            break;
        }
        {
            uint _e202 = k_7;
            float _e205 = aside[_e202].x;
            uint _e207 = k_7;
            float _e210 = aside[_e207].z;
            vec3 level_4 = ((surface_3.towards * _e205) + (n_2 * _e210));
            uint _e213 = k_7;
            float _e216 = aside[_e213].y;
            vec3 _e219[5] = octagloss_harmonic_orders(probe_16, (level_4 + (mirrored * _e216)));
            own_1 = _e219;
            uint _e221 = k_7;
            float _e224 = aside[_e221].y;
            vec3 _e227[5] = octagloss_harmonic_orders(probe_16, (level_4 - (mirrored * _e224)));
            other = _e227;
            uint _e229 = k_7;
            order_3 = (_e229 + 1u);
            bool loop_init_19 = true;
            while(true) {
                if (!loop_init_19) {
                    uint _e277 = order_3;
                    order_3 = (_e277 + 1u);
                }
                loop_init_19 = false;
                uint _e233 = order_3;
                if ((_e233 < 5u)) {
                } else {
                    break;
                }
                {
                    uint _e236 = pair_1;
                    if (((_e236 % 2u) == 0u)) {
                        uint _e242 = pair_1;
                        vec4 _e246 = octagloss_row_node((octagloss_ROW_PAIRS + (_e242 / 2u)), _e16);
                        texel_1 = _e246;
                    }
                    vec4 _e247 = texel_1;
                    vec4 _e249 = texel_1;
                    uint _e251 = pair_1;
                    vec2 weights_4 = (((_e251 % 2u) == 0u) ? _e249.xy : _e247.zw);
                    vec3 _e257 = sum_6;
                    uint _e264 = order_3;
                    vec3 _e266 = own_1[_e264];
                    uint _e267 = order_3;
                    vec3 _e269 = other[_e267];
                    sum_6 = (_e257 + (((scaled_1 * weights_4.x) + vec3((grazing_1 * weights_4.y))) * (_e266 - _e269)));
                    uint _e274 = pair_1;
                    pair_1 = (_e274 + 1u);
                }
            }
        }
    }
    vec3 _e282 = sum_6;
    float _e288 = octagloss_lights[probe_16].unscale;
    sum_6 = (max(_e282, vec3(0.0)) * _e288);
    float _e290 = in_mirror_1;
    float share_4 = max((1.0 - (_e290 / (_e34.x + _e34.y))), 0.0);
    vec3 _e299 = sum_6;
    vec3 _e300 = octagloss_suns_reflected(probe_16, surface_3, tangent_5, alpha_9, f0_4, f90_4);
    return (_e299 + (share_4 * _e300));
}

vec3 octagloss_reflect_of(uint probe_17, vec3 normal_4, vec3 view_3, vec3 tangent_6, float roughness_7, float anisotropy_1, vec3 f0_5, float f90_5) {
    vec2 level_3 = vec2(0.0);
    bool local = false;
    octagloss_SurfaceFrame _e8 = octagloss_surface_of(probe_17, normal_4, view_3);
    if ((anisotropy_1 > 0.0)) {
        local = (dot(tangent_6, tangent_6) > 0.0);
    } else {
        local = false;
    }
    bool _e19 = local;
    if (_e19) {
        vec3 _e20 = octagloss_source_from_world(probe_17, tangent_6);
        vec3 across_3 = cross(_e8.normal, _e8.towards);
        level_3 = vec2(dot(_e20, _e8.towards), dot(_e20, across_3));
    }
    vec2 _e28 = level_3;
    vec2 _e29 = level_3;
    if ((dot(_e28, _e29) < 1e-10)) {
        vec3 _e33 = octagloss_reflected_isotropic(probe_17, _e8, roughness_7, f0_5, f90_5);
        return _e33;
    }
    vec2 _e36 = octagloss_row_alphas(roughness_7, min(anisotropy_1, 1.0));
    float _e37 = octagloss_row_share(_e36);
    vec2 _e38 = level_3;
    vec3 _e40 = octagloss_reflect_in_row(probe_17, _e8, normalize(_e38), _e36, f0_5, f90_5);
    vec3 sum_7 = (_e37 * _e40);
    if ((_e37 == 1.0)) {
        return sum_7;
    }
    float round_ = sqrt(sqrt((_e36.x * _e36.y)));
    vec3 _e51 = octagloss_reflected_isotropic(probe_17, _e8, round_, f0_5, f90_5);
    return (sum_7 + ((1.0 - _e37) * _e51));
}

vec3 octagloss_reflect(vec3 normal_5, vec3 view_4, vec3 tangent_7, float roughness_8, float anisotropy_2, vec3 f0_6, float f90_6) {
    vec3 _e8 = octagloss_reflect_of(0u, normal_5, view_4, tangent_7, roughness_8, anisotropy_2, f0_6, f90_6);
    return _e8;
}

vec2 octagloss_faded_albedo(vec2 alpha_10, float cosine_7, vec2 own_2) {
    vec2 _e8 = octagloss_round_albedo(cosine_7, sqrt(sqrt((alpha_10.x * alpha_10.y))));
    float _e9 = octagloss_row_share(alpha_10);
    return mix(_e8, own_2, _e9);
}

vec2 octagloss_albedo(float cosine_8, float roughness_9, float anisotropy_3) {
    if ((anisotropy_3 <= 0.0)) {
        vec2 _e5 = octagloss_round_albedo(cosine_8, roughness_9);
        return _e5;
    }
    vec2 _e8 = octagloss_row_alphas(roughness_9, min(anisotropy_3, 1.0));
    float seen_2 = clamp(cosine_8, octagloss_LEAST_COSINE, 1.0);
    vec4 _e15 = octagloss_row_more(_e8, seen_2, vec2(1.0, 0.0));
    vec2 more_2 = _e15.zw;
    vec2 _e18 = octagloss_row_albedo(_e8, seen_2, 0.5, more_2);
    vec2 _e19 = octagloss_faded_albedo(_e8, seen_2, _e18);
    return _e19;
}

vec2 octagloss_albedo_along(float cosine_9, float along_1, float roughness_10, float anisotropy_4) {
    if ((anisotropy_4 <= 0.0)) {
        vec2 _e6 = octagloss_round_albedo(cosine_9, roughness_10);
        return _e6;
    }
    vec2 _e9 = octagloss_row_alphas(roughness_10, min(anisotropy_4, 1.0));
    float seen_3 = clamp(cosine_9, octagloss_LEAST_COSINE, 1.0);
    float x_4 = min((abs(along_1) / max(sqrt((1.0 - (seen_3 * seen_3))), 0.0001)), 1.0);
    vec4 _e28 = octagloss_row_more(_e9, seen_3, vec2(x_4, sqrt((1.0 - (x_4 * x_4)))));
    vec2 more_3 = _e28.xy;
    vec2 _e31 = octagloss_row_albedo(_e9, seen_3, (x_4 * x_4), more_3);
    vec2 _e32 = octagloss_faded_albedo(_e9, seen_3, _e31);
    return _e32;
}
