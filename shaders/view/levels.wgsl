// Viewer pipeline for a prefiltered cube chain as engines use it: trilinear between levels of ascending
// roughness. Levels hold radiance.
@group(1) @binding(0) var levels: texture_cube<f32>;
@group(1) @binding(1) var trilinear: sampler;
#include "common/view_draw.wgsl"
#include "common/view_split.wgsl"

fn ladder_at(level: u32) -> f32 {
    return frame.ladder[level / 4u][level % 4u];
}

// Fractional level for `roughness`, clamped to the first and last.
fn level_of(roughness: f32) -> f32 {
    var level = 0.0;
    for (var k = 0u; k + 1u < MAX_LEVELS; k++) {
        let low = ladder_at(k);
        // Unused levels have a roughness of 0.
        let width = ladder_at(k + 1u) - low;
        level += select(0.0, clamp((roughness - low) / width, 0.0, 1.0), width > 0.0);
    }
    return level;
}

fn radiance(direction: vec3<f32>, roughness: f32, pixel: vec2<f32>) -> vec3<f32> {
    let own = frame.levels_from_source * direction;
    return textureSampleLevel(levels, trilinear, own, level_of(roughness)).rgb * frame.levels_scale;
}
