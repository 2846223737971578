// Look-ups in an atlas of octahedral maps, after oem_lookup.wgsl. Engelhardt and Dachsbacher 2008,
// section 5.3. The atlas is a texture of radiance; tiles have a border of at least one texel, so that
// look-ups stay inside them.

// A tile: its first texel in the atlas, its texels along an edge with the border, its border.
struct AtlasTile {
    x: u32,
    y: u32,
    side: u32,
    border: u32,
}

// Where `uv` in [-1, 1]^2 of the map of `tile` is in the atlas, in texels.
fn atlas_place(tile: AtlasTile, uv: vec2<f32>) -> vec2<f32> {
    let inner = f32(tile.side - 2u * tile.border);
    return vec2<f32>(vec2<u32>(tile.x, tile.y) + tile.border) + (uv + 1.0) * (0.5 * inner);
}

// Radiance of `tile` along `direction`, of any length but zero, for a map of the sphere.
fn atlas_sphere(atlas: texture_2d<f32>, tile: AtlasTile, direction: vec3<f32>) -> vec3<f32> {
    return atlas_bilinear(atlas, atlas_place(tile, oct_from_direction(direction)));
}

// Radiance of `tile` along `direction` with y >= 0, of any length but zero, for a map of the hemisphere.
fn atlas_hemisphere(atlas: texture_2d<f32>, tile: AtlasTile, direction: vec3<f32>) -> vec3<f32> {
    let upper = vec3<f32>(direction.x, max(direction.y, 0.0), direction.z);
    return atlas_bilinear(atlas, atlas_place(tile, rectangular_place(upper).xy));
}

// Bilinear at `at`, in texels.
fn atlas_bilinear(atlas: texture_2d<f32>, at: vec2<f32>) -> vec3<f32> {
    let low = floor(at - 0.5);
    let share = at - 0.5 - low;
    let first = vec2<i32>(low);
    let upper = mix(
        textureLoad(atlas, first, 0).rgb, textureLoad(atlas, first + vec2<i32>(1, 0), 0).rgb, share.x);
    let lower = mix(
        textureLoad(atlas, first + vec2<i32>(0, 1), 0).rgb,
        textureLoad(atlas, first + vec2<i32>(1, 1), 0).rgb, share.x);
    return mix(upper, lower, share.y);
}
