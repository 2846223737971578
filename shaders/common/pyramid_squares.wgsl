// Places in a pyramid's octahedral squares, the same in all with borders that halve with the texels.

// Texture coordinates.
alias MapPlace = vec2<f32>;

fn place_of(direction: vec3<f32>) -> MapPlace {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let folded = 1.0 - abs(p.zx);
    let turned = vec2<f32>(select(-folded.x, folded.x, p.x >= 0.0), select(-folded.y, folded.y, p.z >= 0.0));
    let uv = select(turned, p.xz, p.y >= 0.0);
    let inner = map_inner();
    return 0.5 + uv * (0.5 * inner / (inner + 2.0 * map_border()));
}

// The same place in the cosine map, which has a border of one texel around 32.
fn place_in_cosine(at: MapPlace) -> MapPlace {
    let size = map_inner() + 2.0 * map_border();
    return 0.5 + (at - 0.5) * (size / map_inner() * (32.0 / 34.0));
}
