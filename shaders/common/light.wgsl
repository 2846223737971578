// Per-environment data of a pyramid: `OctaglossLight` of crates/core/src/pyramid/light.rs.

const SUNS = 8u;

// A sun: `Sun` of crates/core/src/pyramid/suns.rs. Unused ones have no energy.
struct OctaglossSun {
    // Mean direction of each channel, and the mean squared distance of its light from its disc's centre.
    red: vec4<f32>,
    green: vec4<f32>,
    blue: vec4<f32>,
    // Radiance times solid angle.
    energy: vec3<f32>,
    pad: f32,
}

struct OctaglossLight {
    // The rotation that takes a direction of the environment to one of the world.
    world_from_source: mat3x3<f32>,
    // The power of two that scales the maps, its inverse, and what the rest is clamped to, scaled.
    scale: f32,
    unscale: f32,
    clamp: f32,
    pad: f32,
    // Harmonics of the rest to order 4, scaled. The fourth components of the first 24 are the suns' half
    // axes, three for each: so 64 lights fit in a uniform buffer.
    harmonics: array<vec4<f32>, 25>,
    // Fills a multiple of 256 bytes, at which bindings may begin.
    @size(560) suns: array<OctaglossSun, SUNS>,
}
