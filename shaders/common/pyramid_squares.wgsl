// Reads of a pyramid's octahedral squares. `Levels` of crates/core/src/pyramid/mod.rs says where each map
// stands among three layers with MIP levels: the mirror, then the Gaussians from fine to coarse, three a MIP
// level; the last one of the last layer has the cosine.

// Layers of an environment.
const SQUARES = 3u;

// Octaves between the widths of levels.
const LEVEL_OCTAVES = 0.864f;

// A point of the octahedron |x| + |y| + |z| = 1.
alias MapPlace = vec3<f32>;

fn place_of(direction: vec3<f32>) -> MapPlace {
    return direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
}

// Texels along an edge of the finest squares.
fn map_side() -> f32 {
    return f32(textureDimensions(octagloss_maps).x);
}

// The logarithm of those without borders, which are fewer: as exponents of floats have it.
fn map_octave() -> u32 {
    return (bitcast<u32>(map_side()) >> 23u) - 127u;
}

// The coarsest MIP level has 64 texels along an edge, of maps of less than 512 texels 32; it is no finer than
// the second.
fn last_mip() -> u32 {
    let octave = map_octave();
    return max(octave - select(5u, 6u, octave > 8u), 1u);
}

fn read_square(probe: u32, at: MapPlace, layer: u32, mip: u32) -> vec3<f32> {
    // Where the octahedron's faces meet, at x = 0 and z = 0, a read between the texels on either side does
    // not bend as the faces do: there |x| and |z| count as those of the texels.
    let inner = f32(1u << map_octave());
    let edge = f32(1u << mip) / inner;
    let rounded = max(abs(at), vec3<f32>(edge, 0.0, edge));
    let p = at.xz / (rounded.x + rounded.y + rounded.z);
    let folded = 1.0 - abs(p.yx);
    let turned = vec2<f32>(select(-folded.x, folded.x, p.x >= 0.0), select(-folded.y, folded.y, p.y >= 0.0));
    let uv = select(turned, p, at.y >= 0.0);
    let place = 0.5 + uv * (0.5 * inner / map_side());
    return textureSampleLevel(octagloss_maps, octagloss_linear, place, SQUARES * probe + layer, f32(mip)).xyz;
}

// The widest level: the finest Gaussian has at least 3.3 texels. log2(3.3 / 0.35).
fn last_map() -> f32 {
    return 1.0 + floor((f32(map_octave()) - 3.23703914) / LEVEL_OCTAVES);
}

// A map: 0 is the mirror, then come the Gaussians from fine to coarse.
fn read_map(probe: u32, at: MapPlace, map: u32) -> vec3<f32> {
    return read_square(probe, at, map % SQUARES, map / SQUARES);
}

fn read_cosine(probe: u32, at: MapPlace) -> vec3<f32> {
    return read_square(probe, at, SQUARES - 1u, last_mip());
}
