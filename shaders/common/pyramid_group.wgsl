// Look-ups of one pyramid, with its resources in group 1.
@group(1) @binding(0) var octagloss_weights: texture_2d<f32>;
@group(1) @binding(1) var<uniform> octagloss_lights: array<OctaglossLight, 1>;
@group(1) @binding(2) var octagloss_maps: texture_2d_array<f32>;
@group(1) @binding(3) var octagloss_linear: sampler;
#include "common/pyramid_maps.wgsl"
