// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2; octagloss_linear is a sampler, linear in texels and in mip levels and
// clamped to the edge. Directions are in the world, right-handed, y up. To use: octagloss_radiance,
// octagloss_irradiance, octagloss_reflect and octagloss_albedo; `probe` is 0.
// Translated from pyramid.wgsl, FNV-1a 2da02ca0c45fb865.
// HLSL, shader model 5.0 and newer.
struct OctaglossSun {
    float4 red;
    float4 green;
    float4 blue;
    float3 energy;
    float pad;
};

struct OctaglossLight {
    row_major float3x3 world_from_source;
    int _pad1_0;
    float scale;
    float unscale;
    float clamp_;
    float pad;
    float4 harmonics[25];
    OctaglossSun suns[8];
    int _end_pad_0;
    int _end_pad_1;
    int _end_pad_2;
    int _end_pad_3;
    int _end_pad_4;
    int _end_pad_5;
    int _end_pad_6;
    int _end_pad_7;
    int _end_pad_8;
    int _end_pad_9;
    int _end_pad_10;
    int _end_pad_11;
};

static const uint octagloss_SUNS = 8u;
static const uint octagloss_INTERVALS = 640u;
static const int octagloss_MIRROR = int(1);
static const int octagloss_SHARP = int(2);
static const int octagloss_LEVELS = int(0);
static const uint octagloss_READS = 9u;
static const float2 octagloss_NODES = float2(46.0, 26.0);
static const float octagloss_LEAST_COSINE = 0.01;
static const float2 octagloss_TABLES = float2(864.0, 31.0);

cbuffer octagloss_lights : register(b0) { OctaglossLight octagloss_lights[1]; }
Texture2DArray<float4> octagloss_maps : register(t1);
Texture2D<float4> octagloss_tables : register(t2);
SamplerState octagloss_linear : register(s0);

typedef float ret_Constructarray25_float_[25];
ret_Constructarray25_float_ Constructarray25_float_(float arg0, float arg1, float arg2, float arg3, float arg4, float arg5, float arg6, float arg7, float arg8, float arg9, float arg10, float arg11, float arg12, float arg13, float arg14, float arg15, float arg16, float arg17, float arg18, float arg19, float arg20, float arg21, float arg22, float arg23, float arg24) {
    float ret[25] = { arg0, arg1, arg2, arg3, arg4, arg5, arg6, arg7, arg8, arg9, arg10, arg11, arg12, arg13, arg14, arg15, arg16, arg17, arg18, arg19, arg20, arg21, arg22, arg23, arg24 };
    return ret;
}

typedef float ret_octagloss_harmonic_basis[25];
ret_octagloss_harmonic_basis octagloss_harmonic_basis(float3 d)
{
    float x = d.x;
    float y = d.y;
    float z = d.z;
    float xx = (x * x);
    float yy = (y * y);
    float zz = (z * z);
    return Constructarray25_float_(0.28209478, (0.48860252 * y), (0.48860252 * z), (0.48860252 * x), ((1.0925485 * x) * y), ((1.0925485 * y) * z), (0.31539157 * ((3.0 * zz) - 1.0)), ((1.0925485 * x) * z), (0.54627424 * (xx - yy)), ((0.5900436 * y) * ((3.0 * xx) - yy)), (((2.8906114 * x) * y) * z), ((0.4570458 * y) * ((5.0 * zz) - 1.0)), ((0.37317634 * z) * ((5.0 * zz) - 3.0)), ((0.4570458 * x) * ((5.0 * zz) - 1.0)), ((1.4453057 * z) * (xx - yy)), ((0.5900436 * x) * (xx - (3.0 * yy))), (((2.5033429 * x) * y) * (xx - yy)), (((1.7701308 * y) * z) * ((3.0 * xx) - yy)), (((0.9461747 * x) * y) * ((7.0 * zz) - 1.0)), (((0.6690465 * y) * z) * ((7.0 * zz) - 3.0)), (0.10578555 * ((((35.0 * zz) * zz) - (30.0 * zz)) + 3.0)), (((0.6690465 * x) * z) * ((7.0 * zz) - 3.0)), ((0.47308734 * (xx - yy)) * ((7.0 * zz) - 1.0)), (((1.7701308 * x) * z) * (xx - (3.0 * yy))), (0.6258357 * (((xx * xx) - ((6.0 * xx) * yy)) + (yy * yy))));
}

float3 octagloss_source_from_world(uint probe, float3 direction)
{
    float3x3 axes = octagloss_lights[probe].world_from_source;
    return normalize(float3(dot(direction, axes[0]), dot(direction, axes[1]), dot(direction, axes[2])));
}

uint2 NagaDimensions2DArray(Texture2DArray<float4> tex)
{
    uint4 ret;
    tex.GetDimensions(0, ret.x, ret.y, ret.z, ret.w);
    return ret.xy;
}

float octagloss_map_inner()
{
    return (float(NagaDimensions2DArray(octagloss_maps).x) * 0.9411765);
}

float octagloss_map_border()
{
    return (float(NagaDimensions2DArray(octagloss_maps).x) / 34.0);
}

float2 octagloss_place_of(float3 direction_1)
{
    float3 p = (direction_1 / (((abs(direction_1.x) + abs(direction_1.y)) + abs(direction_1.z))).xxx);
    float2 folded = ((1.0).xx - abs(p.zx));
    float2 turned = float2(((p.x >= 0.0) ? folded.x : -(folded.x)), ((p.z >= 0.0) ? folded.y : -(folded.y)));
    float2 uv = ((p.y >= 0.0) ? p.xz : turned);
    const float _e36 = octagloss_map_inner();
    const float _e39 = octagloss_map_border();
    return ((0.5).xx + (uv * ((0.5 * _e36) / (_e36 + (2.0 * _e39)))));
}

float3 ZeroValuefloat3() {
    return (float3)0;
}

float3 octagloss_harmonics_around(uint probe_1, float3 d_1, float weights[5])
{
    float basis[25] = { (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0 };
    float3 sum = ZeroValuefloat3();
    uint order = 0u;
    float3 own = (float3)0;
    uint k = (uint)0;

    const float _e3[25] = octagloss_harmonic_basis(d_1);
    basis = _e3;
    uint2 loop_bound = uint2(4294967295u, 4294967295u);
    bool loop_init = true;
    while(true) {
        if (all(loop_bound == uint2(0u, 0u))) { break; }
        loop_bound -= uint2(loop_bound.y == 0u, 1u);
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
            own = ZeroValuefloat3();
            uint _e14 = order;
            uint _e15 = order;
            k = (_e14 * _e15);
            uint2 loop_bound_1 = uint2(4294967295u, 4294967295u);
            bool loop_init_1 = true;
            while(true) {
                if (all(loop_bound_1 == uint2(0u, 0u))) { break; }
                loop_bound_1 -= uint2(loop_bound_1.y == 0u, 1u);
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
                    float3 _e27 = own;
                    uint _e28 = k;
                    float _e30 = basis[min(uint(_e28), 24u)];
                    uint _e34 = k;
                    float4 _e36 = octagloss_lights[probe_1].harmonics[_e34];
                    own = (_e27 + (_e30 * _e36.xyz));
                }
            }
            float3 _e43 = sum;
            uint _e44 = order;
            float3 _e46 = own;
            sum = (_e43 + (weights[min(uint(_e44), 4u)] * _e46));
        }
    }
    float3 _e52 = sum;
    return _e52;
}

typedef float4 ret_ZeroValuearray4_float4_[4];
ret_ZeroValuearray4_float4_ ZeroValuearray4_float4_() {
    float4 zeros[4] = { (float4)0, (float4)0, (float4)0, (float4)0 };
    return zeros;
}

typedef float4 ret_octagloss_node_weights[4];
ret_octagloss_node_weights octagloss_node_weights(uint node)
{
    float4 weights_1[4] = ZeroValuearray4_float4_();
    uint row = 0u;

    uint2 loop_bound_2 = uint2(4294967295u, 4294967295u);
    bool loop_init_2 = true;
    while(true) {
        if (all(loop_bound_2 == uint2(0u, 0u))) { break; }
        loop_bound_2 -= uint2(loop_bound_2.y == 0u, 1u);
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
            float4 _e16 = octagloss_tables.Load(int3(uint2(node, (27u + _e12)), int(0)));
            weights_1[min(uint(_e8), 3u)] = _e16;
        }
    }
    float4 _e20[4] = weights_1;
    return _e20;
}

float3 octagloss_read_mirror(uint probe_2, float2 at)
{
    float4 _e6 = octagloss_maps.SampleLevel(octagloss_linear, float3(at, octagloss_MIRROR), 0.0);
    return _e6.xyz;
}

float3 octagloss_read_sharp(uint probe_3, float2 at_1)
{
    float4 _e6 = octagloss_maps.SampleLevel(octagloss_linear, float3(at_1, octagloss_SHARP), 0.0);
    return _e6.xyz;
}

float3 octagloss_read_levels(uint probe_4, float2 at_2, float level)
{
    float4 _e6 = octagloss_maps.SampleLevel(octagloss_linear, float3(at_2, octagloss_LEVELS), level);
    return _e6.xyz;
}

float3 octagloss_read_cosine(uint probe_5, float2 at_3)
{
    const float _e2 = octagloss_map_inner();
    float last = round(log2((_e2 / 32.0)));
    float4 _e10 = octagloss_maps.SampleLevel(octagloss_linear, float3(at_3, octagloss_MIRROR), last);
    return _e10.xyz;
}

float2 octagloss_place_in_cosine(float2 at_4)
{
    const float _e1 = octagloss_map_inner();
    const float _e2 = octagloss_map_border();
    float size = (_e1 + (2.0 * _e2));
    const float _e9 = octagloss_map_inner();
    return ((0.5).xx + ((at_4 - (0.5).xx) * ((size / _e9) * 0.9411765)));
}

float octagloss_squared(float3 v)
{
    return dot(v, v);
}

typedef float ret_Constructarray7_float_[7];
ret_Constructarray7_float_ Constructarray7_float_(float arg0, float arg1, float arg2, float arg3, float arg4, float arg5, float arg6) {
    float ret[7] = { arg0, arg1, arg2, arg3, arg4, arg5, arg6 };
    return ret;
}

typedef float ret_Constructarray5_float_[5];
ret_Constructarray5_float_ Constructarray5_float_(float arg0, float arg1, float arg2, float arg3, float arg4) {
    float ret[5] = { arg0, arg1, arg2, arg3, arg4 };
    return ret;
}

uint naga_f2u32(float value) {
    return uint(clamp(value, 0.0, 4294967000.0));
}

float3 octagloss_radiance_of(uint probe_6, float3 direction_2, float roughness)
{
    float4 low[4] = { (float4)0, (float4)0, (float4)0, (float4)0 };
    float4 high[4] = { (float4)0, (float4)0, (float4)0, (float4)0 };
    float3 sum_1 = ZeroValuefloat3();
    float levels[7] = { (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0 };
    uint level_1 = 0u;
    uint k_1 = 0u;

    const float3 _e3 = octagloss_source_from_world(probe_6, direction_2);
    const float2 _e4 = octagloss_place_of(_e3);
    float node_1 = (log2((1.0 + (50.0 * roughness))) * 112.826515);
    uint k_7 = min(naga_f2u32(node_1), 639u);
    float share = (node_1 - float(k_7));
    const float4 _e17[4] = octagloss_node_weights(k_7);
    low = _e17;
    const float4 _e21[4] = octagloss_node_weights((k_7 + 1u));
    high = _e21;
    float4 _e24 = low[0];
    float4 _e26 = high[0];
    float4 a = lerp(_e24, _e26, share);
    float4 _e29 = low[1];
    float4 _e31 = high[1];
    float4 b = lerp(_e29, _e31, share);
    float4 _e34 = low[2];
    float4 _e36 = high[2];
    float4 c_1 = lerp(_e34, _e36, share);
    float4 _e39 = low[3];
    float4 _e41 = high[3];
    float4 e = lerp(_e39, _e41, share);
    if ((a.x != 0.0)) {
        float3 _e48 = sum_1;
        const float3 _e50 = octagloss_read_mirror(probe_6, _e4);
        sum_1 = (_e48 + (a.x * _e50));
    }
    if ((a.y != 0.0)) {
        float3 _e56 = sum_1;
        const float3 _e58 = octagloss_read_sharp(probe_6, _e4);
        sum_1 = (_e56 + (a.y * _e58));
    }
    levels = Constructarray7_float_(a.z, a.w, b.x, b.y, b.z, b.w, c_1.x);
    uint2 loop_bound_3 = uint2(4294967295u, 4294967295u);
    bool loop_init_3 = true;
    while(true) {
        if (all(loop_bound_3 == uint2(0u, 0u))) { break; }
        loop_bound_3 -= uint2(loop_bound_3.y == 0u, 1u);
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
            float _e77 = levels[min(uint(_e75), 6u)];
            if ((_e77 != 0.0)) {
                float3 _e80 = sum_1;
                uint _e81 = level_1;
                float _e83 = levels[min(uint(_e81), 6u)];
                uint _e84 = level_1;
                const float3 _e86 = octagloss_read_levels(probe_6, _e4, float(_e84));
                sum_1 = (_e80 + (_e83 * _e86));
            }
        }
    }
    if ((c_1.y != 0.0)) {
        float3 _e95 = sum_1;
        const float2 _e97 = octagloss_place_in_cosine(_e4);
        const float3 _e98 = octagloss_read_cosine(probe_6, _e97);
        sum_1 = (_e95 + (c_1.y * _e98));
    }
    float3 _e101 = sum_1;
    const float3 _e108 = octagloss_harmonics_around(probe_6, _e3, Constructarray5_float_(c_1.z, c_1.w, e.x, e.y, e.z));
    sum_1 = (_e101 + _e108);
    float3 _e110 = sum_1;
    float _e116 = octagloss_lights[probe_6].unscale;
    sum_1 = (max(_e110, ZeroValuefloat3()) * _e116);
    float alpha_1 = (roughness * roughness);
    uint2 loop_bound_4 = uint2(4294967295u, 4294967295u);
    bool loop_init_4 = true;
    while(true) {
        if (all(loop_bound_4 == uint2(0u, 0u))) { break; }
        loop_bound_4 -= uint2(loop_bound_4.y == 0u, 1u);
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
            const float _e133 = octagloss_squared((_e3 - sun.red.xyz));
            const float _e137 = octagloss_squared((_e3 - sun.green.xyz));
            const float _e141 = octagloss_squared((_e3 - sun.blue.xyz));
            float3 apart = float3(_e133, _e137, _e141);
            float3 s = min((0.25 * apart), (0.5).xxx);
            float3 spread_1 = float3(sun.red.w, sun.green.w, sun.blue.w);
            float3 a2_ = min((((alpha_1 * alpha_1)).xxx + (0.5 * spread_1)), (1.0).xxx);
            float3 bend = (s + (a2_ * ((1.0).xxx - s)));
            float3 lobe = (((0.31830987 * a2_) / (bend * bend)) * ((1.0).xxx - (2.0 * s)));
            float3 _e178 = sum_1;
            sum_1 = (_e178 + ((sun.energy * lobe) * (e.w * (1.0 - a.x))));
        }
    }
    float3 _e191 = sum_1;
    return _e191;
}

float3 octagloss_radiance(float3 direction_3, float roughness_1)
{
    const float3 _e3 = octagloss_radiance_of(0u, direction_3, roughness_1);
    return _e3;
}

float3 octagloss_irradiance_of(uint probe_7, float3 normal)
{
    float3 sum_2 = (float3)0;
    uint k_2 = 0u;

    const float3 _e2 = octagloss_source_from_world(probe_7, normal);
    const float2 _e3 = octagloss_place_of(_e2);
    const float2 _e4 = octagloss_place_in_cosine(_e3);
    const float3 _e5 = octagloss_read_cosine(probe_7, _e4);
    float _e9 = octagloss_lights[probe_7].unscale;
    sum_2 = (_e5 * _e9);
    uint2 loop_bound_5 = uint2(4294967295u, 4294967295u);
    bool loop_init_5 = true;
    while(true) {
        if (all(loop_bound_5 == uint2(0u, 0u))) { break; }
        loop_bound_5 -= uint2(loop_bound_5.y == 0u, 1u);
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
            float3 facing = float3(dot(_e2, sun_1.red.xyz), dot(_e2, sun_1.green.xyz), dot(_e2, sun_1.blue.xyz));
            float3 _e33 = sum_2;
            sum_2 = (_e33 + (sun_1.energy * (0.31830987 * max(facing, ZeroValuefloat3()))));
        }
    }
    float3 _e44 = sum_2;
    return _e44;
}

float3 octagloss_irradiance(float3 normal_1)
{
    const float3 _e2 = octagloss_irradiance_of(0u, normal_1);
    return _e2;
}

float4 octagloss_read_reflections(uint layer, float2 at_5)
{
    float2 corner = float2((1.0 + (float(layer) * 48.0)), 0.0);
    float4 _e17 = octagloss_tables.SampleLevel(octagloss_linear, (((at_5 * octagloss_NODES) + corner) / octagloss_TABLES), 0.0);
    return _e17;
}

float4 octagloss_reflection_node(uint layer_1, float roughness_2, float cosine)
{
    float2 place = float2((log2((1.0 + (10.0 * roughness_2))) * 0.28906482), sqrt(cosine));
    float2 at_6 = (((place * float2(45.0, 25.0)) + (0.5).xx) / octagloss_NODES);
    const float4 _e21 = octagloss_read_reflections(layer_1, at_6);
    return _e21;
}

float3 octagloss_between_levels(uint probe_8, float3 direction_4, float level_2)
{
    const float2 _e3 = octagloss_place_of(direction_4);
    if ((level_2 >= 2.0)) {
        const float3 _e8 = octagloss_read_levels(probe_8, _e3, (level_2 - 2.0));
        return _e8;
    }
    if ((level_2 >= 1.0)) {
        const float3 _e11 = octagloss_read_sharp(probe_8, _e3);
        const float3 _e13 = octagloss_read_levels(probe_8, _e3, 0.0);
        return lerp(_e11, _e13, (level_2 - 1.0));
    }
    const float3 _e17 = octagloss_read_mirror(probe_8, _e3);
    const float3 _e18 = octagloss_read_sharp(probe_8, _e3);
    return lerp(_e17, _e18, level_2);
}

float2 ZeroValuefloat2() {
    return (float2)0;
}

float2 octagloss_brdf_around(float3 view, float3 light, float2 alpha, float spread)
{
    if ((light.z <= 0.0)) {
        return ZeroValuefloat2();
    }
    float3 half_vector = normalize((view + light));
    float cosine_2 = dot(view, half_vector);
    float2 across = (float2(-(view.y), view.x) / (cosine_2).xx);
    float2 squares = ((alpha * alpha) + ((0.5 * spread) * ((1.0).xx + (across * across))));
    float mixed = (((0.5 * spread) * across.x) * across.y);
    float determinant_ = ((squares.x * squares.y) - (mixed * mixed));
    float2 h = half_vector.xy;
    float slopes = ((((squares.y * h.x) * h.x) - (((2.0 * mixed) * h.x) * h.y)) + ((squares.x * h.y) * h.y));
    float bend_1 = ((slopes / determinant_) + (half_vector.z * half_vector.z));
    float masking = ((light.z * length(float3((alpha * view.xy), view.z))) + (view.z * length(float3((alpha * light.xy), light.z))));
    float value = ((0.5 * light.z) / ((((masking * 3.1415927) * sqrt(determinant_)) * bend_1) * bend_1));
    return float2(value, pow(max((1.0 - cosine_2), 0.0), 5.0));
}

typedef float3 ret_ZeroValuearray5_float3_[5];
ret_ZeroValuearray5_float3_ ZeroValuearray5_float3_() {
    float3 zeros[5] = { (float3)0, (float3)0, (float3)0, (float3)0, (float3)0 };
    return zeros;
}

typedef float3 ret_octagloss_harmonic_orders[5];
ret_octagloss_harmonic_orders octagloss_harmonic_orders(uint probe_9, float3 d_2)
{
    float basis_1[25] = { (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0, (float)0 };
    float3 sums[5] = ZeroValuearray5_float3_();
    uint order_1 = 0u;
    uint k_3 = (uint)0;

    const float _e2[25] = octagloss_harmonic_basis(d_2);
    basis_1 = _e2;
    uint2 loop_bound_6 = uint2(4294967295u, 4294967295u);
    bool loop_init_6 = true;
    while(true) {
        if (all(loop_bound_6 == uint2(0u, 0u))) { break; }
        loop_bound_6 -= uint2(loop_bound_6.y == 0u, 1u);
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
            uint2 loop_bound_7 = uint2(4294967295u, 4294967295u);
            bool loop_init_7 = true;
            while(true) {
                if (all(loop_bound_7 == uint2(0u, 0u))) { break; }
                loop_bound_7 -= uint2(loop_bound_7.y == 0u, 1u);
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
                    float3 _e26 = sums[min(uint(_e24), 4u)];
                    uint _e27 = k_3;
                    float _e29 = basis_1[min(uint(_e27), 24u)];
                    uint _e33 = k_3;
                    float4 _e35 = octagloss_lights[probe_9].harmonics[_e33];
                    sums[min(uint(_e24), 4u)] = (_e26 + (_e29 * _e35.xyz));
                }
            }
        }
    }
    float3 _e45[5] = sums;
    return _e45;
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % (rhs == 0u ? 1u : rhs);
}

uint naga_div(uint lhs, uint rhs) {
    return lhs / (rhs == 0u ? 1u : rhs);
}

typedef float2 ret_Constructarray5_float2_[5];
ret_Constructarray5_float2_ Constructarray5_float2_(float2 arg0, float2 arg1, float2 arg2, float2 arg3, float2 arg4) {
    float2 ret[5] = { arg0, arg1, arg2, arg3, arg4 };
    return ret;
}

typedef float4 ret_Constructarray3_float4_[3];
ret_Constructarray3_float4_ Constructarray3_float4_(float4 arg0, float4 arg1, float4 arg2) {
    float4 ret[3] = { arg0, arg1, arg2 };
    return ret;
}

float4 ZeroValuefloat4() {
    return (float4)0;
}

typedef float2 ret_ZeroValuearray3_float2_[3];
ret_ZeroValuearray3_float2_ ZeroValuearray3_float2_() {
    float2 zeros[3] = { (float2)0, (float2)0, (float2)0 };
    return zeros;
}

float3 octagloss_reflect_of(uint probe_10, float3 normal_2, float3 view_1, float roughness_3, float3 f0_, float f90_)
{
    float3 level_view = (float3)0;
    float3 sum_3 = ZeroValuefloat3();
    float in_mirror = 0.0;
    uint k_4 = 0u;
    float2 angles[5] = Constructarray5_float2_(float2(1.0, 0.0), float2(0.309017, 0.95105654), float2(-0.809017, 0.58778524), float2(0.809017, 0.58778524), float2(-0.309017, 0.95105654));
    uint pair = 0u;
    float4 texel = ZeroValuefloat4();
    uint k_5 = 0u;
    float3 orders[5] = { (float3)0, (float3)0, (float3)0, (float3)0, (float3)0 };
    uint order_2 = (uint)0;
    uint k_6 = 0u;
    float4 channels[3] = { (float4)0, (float4)0, (float4)0 };
    float2 values[3] = { (float2)0, (float2)0, (float2)0 };
    uint c = (uint)0;

    const float3 _e6 = octagloss_source_from_world(probe_10, normal_2);
    const float3 _e7 = octagloss_source_from_world(probe_10, view_1);
    float cosine_3 = clamp(dot(_e6, _e7), octagloss_LEAST_COSINE, 1.0);
    level_view = (_e7 - (_e6 * dot(_e6, _e7)));
    float3 _e16 = level_view;
    float3 _e17 = level_view;
    if ((dot(_e16, _e17) < 1e-10)) {
        level_view = ((abs(_e6.x) > 0.5) ? float3(0.0, 1.0, 0.0) : float3(1.0, 0.0, 0.0));
    }
    float3 _e34 = level_view;
    float3 _e35 = level_view;
    float3 towards = normalize((_e34 - (_e6 * dot(_e6, _e35))));
    float sine = sqrt((1.0 - (cosine_3 * cosine_3)));
    float3 along = (towards * sine);
    float3 v_1 = (along + (_e6 * cosine_3));
    uint2 loop_bound_8 = uint2(4294967295u, 4294967295u);
    bool loop_init_8 = true;
    while(true) {
        if (all(loop_bound_8 == uint2(0u, 0u))) { break; }
        loop_bound_8 -= uint2(loop_bound_8.y == 0u, 1u);
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
            const float4 _e57 = octagloss_reflection_node(_e56, roughness_3, cosine_3);
            float3 half_vector_1 = normalize((_e6 + (_e57.x * along)));
            float3 direction_5 = ((half_vector_1 * (2.0 * dot(v_1, half_vector_1))) - v_1);
            float3 _e67 = sum_3;
            const float3 _e75 = octagloss_between_levels(probe_10, direction_5, _e57.y);
            sum_3 = (_e67 + (((f0_ * _e57.z) + ((f90_ * _e57.w)).xxx) * _e75));
            float _e78 = in_mirror;
            in_mirror = (_e78 + ((_e57.z + _e57.w) * max((1.0 - _e57.y), 0.0)));
        }
    }
    const float4 _e93 = octagloss_reflection_node(octagloss_READS, roughness_3, cosine_3);
    float3 _e94 = sum_3;
    const float2 _e101 = octagloss_place_of(_e6);
    const float2 _e102 = octagloss_place_in_cosine(_e101);
    const float3 _e103 = octagloss_read_cosine(probe_10, _e102);
    sum_3 = (_e94 + (((f0_ * _e93.x) + ((f90_ * _e93.y)).xxx) * _e103));
    uint2 loop_bound_9 = uint2(4294967295u, 4294967295u);
    bool loop_init_9 = true;
    while(true) {
        if (all(loop_bound_9 == uint2(0u, 0u))) { break; }
        loop_bound_9 -= uint2(loop_bound_9.y == 0u, 1u);
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
            float _e135 = angles[min(uint(_e132), 4u)].x;
            uint _e137 = k_5;
            float _e140 = angles[min(uint(_e137), 4u)].y;
            const float3 _e143[5] = octagloss_harmonic_orders(probe_10, ((_e6 * _e135) + (towards * _e140)));
            orders = _e143;
            uint _e145 = k_5;
            order_2 = _e145;
            uint2 loop_bound_10 = uint2(4294967295u, 4294967295u);
            bool loop_init_10 = true;
            while(true) {
                if (all(loop_bound_10 == uint2(0u, 0u))) { break; }
                loop_bound_10 -= uint2(loop_bound_10.y == 0u, 1u);
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
                    if ((naga_mod(_e150, 2u) == 0u)) {
                        uint _e156 = pair;
                        const float4 _e160 = octagloss_reflection_node((10u + naga_div(_e156, 2u)), roughness_3, cosine_3);
                        texel = _e160;
                    }
                    float4 _e161 = texel;
                    float4 _e163 = texel;
                    uint _e165 = pair;
                    float2 weights_2 = ((naga_mod(_e165, 2u) == 0u) ? _e163.xy : _e161.zw);
                    float3 _e171 = sum_3;
                    uint _e178 = order_2;
                    float3 _e180 = orders[min(uint(_e178), 4u)];
                    sum_3 = (_e171 + (((f0_ * weights_2.x) + ((f90_ * weights_2.y)).xxx) * _e180));
                    uint _e184 = pair;
                    pair = (_e184 + 1u);
                }
            }
        }
    }
    float3 _e192 = sum_3;
    float _e198 = octagloss_lights[probe_10].unscale;
    sum_3 = (max(_e192, ZeroValuefloat3()) * _e198);
    float _e200 = in_mirror;
    float share_1 = max((1.0 - (_e200 / (_e93.z + _e93.w))), 0.0);
    const float _e210 = octagloss_map_inner();
    float alpha_2 = max((roughness_3 * roughness_3), (0.9 / _e210));
    float3 across_1 = cross(_e6, towards);
    uint2 loop_bound_11 = uint2(4294967295u, 4294967295u);
    bool loop_init_11 = true;
    while(true) {
        if (all(loop_bound_11 == uint2(0u, 0u))) { break; }
        loop_bound_11 -= uint2(loop_bound_11.y == 0u, 1u);
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
            channels = Constructarray3_float4_(sun_2.red, sun_2.green, sun_2.blue);
            values = ZeroValuearray3_float2_();
            c = 0u;
            uint2 loop_bound_12 = uint2(4294967295u, 4294967295u);
            bool loop_init_12 = true;
            while(true) {
                if (all(loop_bound_12 == uint2(0u, 0u))) { break; }
                loop_bound_12 -= uint2(loop_bound_12.y == 0u, 1u);
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
                    float4 _e240 = channels[min(uint(_e238), 2u)];
                    float3 to = _e240.xyz;
                    float3 light_1 = float3(dot(to, towards), dot(to, across_1), dot(to, _e6));
                    uint _e246 = c;
                    uint _e251 = c;
                    float _e254 = channels[min(uint(_e251), 2u)].w;
                    const float2 _e255 = octagloss_brdf_around(float3(sine, 0.0, cosine_3), light_1, (alpha_2).xx, _e254);
                    values[min(uint(_e246), 2u)] = _e255;
                }
            }
            float _e261 = values[0].x;
            float _e264 = values[1].x;
            float _e267 = values[2].x;
            float3 value_1 = float3(_e261, _e264, _e267);
            float _e271 = values[0].y;
            float _e274 = values[1].y;
            float _e277 = values[2].y;
            float3 fresnel = float3(_e271, _e274, _e277);
            float3 _e279 = sum_3;
            sum_3 = (_e279 + ((sun_2.energy * (share_1 * value_1)) * (f0_ + (((f90_).xxx - f0_) * fresnel))));
        }
    }
    float3 _e292 = sum_3;
    return _e292;
}

float3 octagloss_reflect(float3 normal_3, float3 view_2, float roughness_4, float3 f0_1, float f90_1)
{
    const float3 _e6 = octagloss_reflect_of(0u, normal_3, view_2, roughness_4, f0_1, f90_1);
    return _e6;
}

float2 octagloss_albedo(float cosine_1, float roughness_5)
{
    const float4 _e6 = octagloss_reflection_node(octagloss_READS, roughness_5, clamp(cosine_1, octagloss_LEAST_COSINE, 1.0));
    return _e6.zw;
}
