// Places in a pyramid's octahedral squares. Borders are a thirty-second of a square's edge in all, so that a
// direction has the same texture coordinates in each.

// Texture coordinates.
alias MapPlace = vec2<f32>;

fn place_of(direction: vec3<f32>) -> MapPlace {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let folded = 1.0 - abs(p.zx);
    let turned = vec2<f32>(select(-folded.x, folded.x, p.x >= 0.0), select(-folded.y, folded.y, p.z >= 0.0));
    let uv = select(turned, p.xz, p.y >= 0.0);
    return 0.5 + uv * (8.0 / 17.0);
}
