// Looks reflections up for lists of frames in the map's space. A query is the normal with perceptual
// roughness in w, the view with f90 in w, f0 with anisotropy in w, and the tangent; answers are radiance, and
// the albedo for f0 in w, along the tangent, or the mean if that is zero. After the shader code for callers.

@group(1) @binding(0) var<storage, read> queries: array<array<vec4<f32>, 4>>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4<f32>>;

@compute @workgroup_size(64)
fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    let k = id.x;
    if k < arrayLength(&queries) {
        let asked = queries[k];
        let normal = asked[0].xyz;
        let tangent = asked[3].xyz;
        let roughness = asked[0].w;
        let anisotropy = asked[2].w;
        let light =
            octagloss_reflect(normal, asked[1].xyz, tangent, roughness, anisotropy, asked[2].xyz, asked[1].w);
        // The axes of the map's space, which queries are in, are the world's.
        let surface = octagloss_surface_of(0u, normal, asked[1].xyz);
        let level = tangent - surface.normal * dot(tangent, surface.normal);
        let along = surface.sine * dot(surface.towards, level) / max(length(level), 1e-9);
        let mean = octagloss_albedo(surface.cosine, roughness, anisotropy).x;
        let own = octagloss_albedo_along(surface.cosine, along, roughness, anisotropy).x;
        answers[k] = vec4<f32>(light, select(own, mean, dot(tangent, tangent) == 0.0));
    }
}
