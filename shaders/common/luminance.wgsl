// Weights of linear red, green and blue in luminance: `LUMINANCE` of crates/core/src/light/environment.rs.

const LUMINANCE = vec3<f32>(0.2126, 0.7152, 0.0722);
