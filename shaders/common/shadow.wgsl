// Looks shadows up in an octahedral map of depth around a lamp: crates/gpu/src/shadow.rs. The including
// shader declares octagloss_shadow: OctaglossShadow (uniform) and octagloss_shadow_depth: texture_depth_2d.
//
// A texel holds near / w of the nearest surface, w = |x| + |y| + |z| from the lamp; 0 where there is none.
// Over a plane this is linear in the point of the octahedron, also across folds: the receiver's own depth at
// the centre of a texel is known, and no bias has to cover the slope.
#include "common/octahedral.wgsl"

struct OctaglossShadow {
    // Position in the world.
    lamp: vec3<f32>,
    // Texels along an edge.
    size: u32,
    near: f32,
    // Share of its distance by which a surface is taken to be farther from the lamp.
    bias: f32,
}

// Share of the lamp's light that reaches `position` on a surface whose plane has unit `normal`: between 0 and
// 1 over a texel at the edge of a shadow.
fn octagloss_lit(position: vec3<f32>, normal: vec3<f32>) -> f32 {
    let from_lamp = position - octagloss_shadow.lamp;
    let w = abs(from_lamp.x) + abs(from_lamp.y) + abs(from_lamp.z);
    let depth = octagloss_shadow.near / w;
    let along = dot(normal, from_lamp);
    let distance = select(along, 1e-20, along == 0.0);
    let edge = f32(octagloss_shadow.size);
    // Drivers snap corners to a sixteenth of a pixel along rows and columns at the coarsest: sqrt(2) / 16 of
    // 2 / edge. In a unit of the square the depth of a plane at distance 1 changes by 2 at most.
    let snap = 0.36 / edge * octagloss_shadow.near / abs(distance);
    // Rounding of interpolated depths, the greatest of which is 1.
    let slack = snap + 2e-6;
    let at = (oct_from_direction(from_lamp) * 0.5 + 0.5) * edge - 0.5;
    let low = floor(at);
    let share = at - low;
    var lit = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let next = vec2<u32>(k & 1u, k >> 1u);
        let weights = select(1.0 - share, share, next == vec2<u32>(1u));
        let texel = wrap_texel(octagloss_shadow.size, vec2<i32>(low) + vec2<i32>(next));
        let towards = octahedron_from_oct((vec2<f32>(texel) + 0.5) * (2.0 / edge) - 1.0);
        // A plane that is seen from its edge leaves the texel.
        let slope = clamp(dot(normal, towards) * w / distance, 0.5, 2.0);
        let nearest = textureLoad(octagloss_shadow_depth, texel, 0);
        let is_lit = nearest * (1.0 - octagloss_shadow.bias) <= depth * slope + slack;
        lit += select(0.0, weights.x * weights.y, is_lit);
    }
    return lit;
}
