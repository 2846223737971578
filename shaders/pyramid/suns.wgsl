// Moments of an OEM's light above the clamp, around the seed that is nearest to it: `Sun` of
// crates/core/src/pyramid/suns.rs.
#include "common/areas.wgsl"
#include "common/excess.wgsl"

const_assert MOMENTS_OF_AREA == GROUP_SIZE;
// No sun.
const NONE = 0xffffffffu;

@group(0) @binding(5) var<storage, read> areas: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> found: Seeds;
@group(0) @binding(7) var<storage, read_write> excess: Excess;

// Of a texel: its sun, the light that it gives to that, and moments of one unit of it.
var<workgroup> sun_of: array<u32, GROUP_SIZE>;
var<workgroup> given: array<array<f32, 3>, GROUP_SIZE>;
var<workgroup> of_one: array<array<f32, MOMENTS>, GROUP_SIZE>;
var<workgroup> bright: atomic<u32>;
var<workgroup> bright_all: u32;

// One area a workgroup, one moment of a sun an invocation.
@compute @workgroup_size(GROUP_SIZE)
fn moments(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let area = group.x;
    let is_bright = bitcast<f32>(areas[area].x + HALF) * found.scale > found.clamp;
    if lane == 0u {
        excess.is_bright[area] = u32(is_bright);
    }
    if !is_bright {
        return;
    }
    let sun = lane / MOMENTS_OF_SUN;
    let channel = min(lane % MOMENTS_OF_SUN / MOMENTS, 2u);
    let moment = lane % MOMENTS_OF_SUN % MOMENTS;
    var sum = 0.0;
    for (var first = 0u; first < texels_of_area(); first += GROUP_SIZE) {
        if lane == 0u {
            atomicStore(&bright, 0u);
        }
        workgroupBarrier();
        if first + lane < texels_of_area() {
            visit(texel_of(counted_in(area, first + lane)), lane);
        }
        workgroupBarrier();
        if lane == 0u {
            bright_all = atomicLoad(&bright);
        }
        if workgroupUniformLoad(&bright_all) > 0u {
            for (var k = 0u; k < min(texels_of_area(), GROUP_SIZE); k++) {
                if sun_of[k] == sun {
                    sum += given[k][channel] * of_one[k][moment];
                }
            }
        }
    }
    excess.moments[area][lane] = sum;
}

fn visit(texel: vec2<u32>, lane: u32) {
    let at = place_in_plane(texel);
    let brightness = brightness_at(at) * found.scale;
    sun_of[lane] = NONE;
    if brightness > found.clamp {
        let direction = direction_of(texel);
        let own = nearest_seed(direction);
        // Scaled: squares of energies overflow.
        let energy = energy_at(at) * found.scale * (1.0 - found.clamp / brightness);
        let offset = direction - found.directions[own].xyz;
        // The light of the texel's area is at its centre.
        let width = 2.0 / f32(table.inner);
        let steps = steps_from_oct(uv_of(texel));
        let u = steps[0] * width;
        let v = steps[1] * width;
        let squares = offset * offset - (u * u + v * v) / 12.0;
        let products = offset * offset.yzx - (u * u.yzx + v * v.yzx) / 12.0;
        sun_of[lane] = own;
        given[lane] = array<f32, 3>(energy.x, energy.y, energy.z);
        of_one[lane] = array<f32, MOMENTS>(
            offset.x, offset.y, offset.z, 1.0, squares.x, squares.y, squares.z, products.x, products.y,
            products.z);
        atomicAdd(&bright, 1u);
    }
}

fn nearest_seed(direction: vec3<f32>) -> u32 {
    var nearest = 0u;
    var least = squared(direction - found.directions[0].xyz);
    for (var k = 1u; k < SUNS; k++) {
        let own = squared(direction - found.directions[k].xyz);
        if own < least {
            nearest = k;
            least = own;
        }
    }
    return nearest;
}
