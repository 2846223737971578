// Per-environment data shared by all queries: `LIGHT` of src/gpu/fitted.rs.

const EMITTERS = 127u;
// Most environments that share buffers: their lights fit 64 KiB, WebGPU's least limit of a uniform.
const MAX_LIGHTS = 14u;

// A point emitter: `Emitter` of src/realtime/emitters.rs.
struct OctaglossEmitter {
    direction: vec3<f32>,
    // Mean squared distance of its light from `direction`.
    spread: f32,
    // Radiance times solid angle; 0 for unused emitters.
    energy: vec3<f32>,
    pad: f32,
}

struct OctaglossLight {
    // The least radiance of each channel.
    least: vec4<f32>,
    // Two powers of two whose product scales quotients of energy over solid angle to radiance.
    scale: array<vec4<f32>, 2>,
    // Harmonics of radiance and of 1, to order 4, in units of 2^60 of the table's.
    harmonics: array<vec4<f32>, 25>,
    emitters: array<OctaglossEmitter, EMITTERS>,
    // The rotation that takes a direction of the environment to one of the world. Fills a multiple of 256
    // bytes, at which bindings may begin.
    @size(96) world_from_source: mat3x3<f32>,
}
