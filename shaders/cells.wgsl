// Builds the quadtree of moments: `Cells` of crates/core/src/cpu/cells.rs, which derives them. Distances are
// chords on the unit sphere.
#include "common/quad.wgsl"
#include "common/planes.wgsl"

// Quads along an edge of a workgroup; four invocations per quad.
const EDGE = 8u;

// One level of the tree.
struct Level {
    // First quad and quads along an edge of this level, then of the finer level.
    first: u32,
    width: u32,
    finer_first: u32,
    finer_width: u32,
    // Cells along an edge, and texels along an edge of a cell, at the finest level.
    cells: u32,
    block: u32,
}

// Moments of a texel's spread, from the CPU, for the quadrant u, v >= 0.
struct Tent {
    centroid: vec3<f32>,
    radius: f32,
    diagonal: vec3<f32>,
    pad_0: f32,
    mixed: vec3<f32>,
    pad_1: f32,
}

// The least radiance of each channel.
@group(0) @binding(6) var<storage, read> least: array<vec4<f32>, 1>;
@group(0) @binding(7) var<storage, read> tents: array<Tent>;
@group(0) @binding(8) var<storage, read_write> quads: array<f32>;
@group(0) @binding(9) var<uniform> level: Level;

struct Cell {
    centroid: vec3<f32>,
    radius: f32,
    diagonal: vec3<f32>,
    luminance: f32,
    mixed: vec3<f32>,
    energy: vec3<f32>,
    red_tint: Tint,
    blue_tint: Tint,
}

// `Tint` of crates/core/src/geometry/tint.rs.
struct Tint {
    dipole: vec3<f32>,
    variation: f32,
    diagonal: vec3<f32>,
    mixed: vec3<f32>,
}

// Sums over the members before division by the luminance; see `absorb`.
struct Union {
    cell: Cell,
    offset: vec3<f32>,
}

// First pass over the members: sums energies, and centroids as differences from the first member's, which
// float32 resolves.
fn gather(all: ptr<function, Union>, member: Cell) {
    if member.luminance <= 0.0 {
        return;
    }
    if (*all).cell.luminance == 0.0 {
        (*all).cell.centroid = member.centroid;
    }
    (*all).cell.luminance += member.luminance;
    (*all).cell.energy += member.energy;
    (*all).offset += (member.centroid - (*all).cell.centroid) * member.luminance;
}

// Between the passes: computes the centroid.
fn centre(all: ptr<function, Union>) {
    if (*all).cell.luminance > 0.0 {
        (*all).cell.centroid += (*all).offset / (*all).cell.luminance;
    }
}

// `tint` with that of a part, `part` of `member`, whose centroid is `apart` from the whole's, and whose
// energy exceeds its share of the whole's, by luminance, by `excess`.
fn with_part(tint: Tint, part: Tint, member: Cell, apart: vec3<f32>, excess: f32) -> Tint {
    return Tint(
        tint.dipole + (part.dipole + apart * excess),
        tint.variation + (part.variation + abs(excess)) * (1.0 + 2e-6),
        tint.diagonal
            + (part.diagonal + 2.0 * apart * part.dipole + (member.diagonal + apart * apart) * excess),
        tint.mixed
            + (part.mixed + apart.yzx * part.dipole.zxy + apart.zxy * part.dipole.yzx
                + (member.mixed + apart.yzx * apart.zxy) * excess));
}

// Second pass: covariance, radius and tints around the centroid.
fn absorb(all: ptr<function, Union>, member: Cell) {
    if member.luminance <= 0.0 {
        return;
    }
    let apart = member.centroid - (*all).cell.centroid;
    let share = member.luminance / (*all).cell.luminance;
    (*all).cell.diagonal += (member.diagonal + apart * apart) * share;
    (*all).cell.mixed += (member.mixed + apart.yzx * apart.zxy) * share;
    let excess = member.energy - (*all).cell.energy * share;
    (*all).cell.red_tint = with_part((*all).cell.red_tint, member.red_tint, member, apart, excess.r);
    (*all).cell.blue_tint = with_part((*all).cell.blue_tint, member.blue_tint, member, apart, excess.b);
    (*all).cell.radius = max((*all).cell.radius, (length(apart) + member.radius) * (1.0 + 2e-6));
}

// A smaller share of a texel's energy above the least radiance is rounding error. Without the cut, black
// texels would enlarge the radius of their cells.
const RESIDUE = 1.0f / 2097152.0f;

// A channel's energy up to 2^-94 counts as zero: `FAINT` of crates/core/src/cpu/cells.rs.
const FAINT = 5.0487097934144756e-29f;

fn texel_cell(x: u32, y: u32) -> Cell {
    let n = table.inner;
    let half = (n + 1u) / 2u;
    let first = n - half;
    let fold_x = select(n - 1u - x - first, x - first, x >= first);
    let fold_y = select(n - 1u - y - first, y - first, y >= first);
    let signs = vec3<f32>(select(-1.0, 1.0, x >= first), 1.0, select(-1.0, 1.0, y >= first));
    let tent = tents[fold_y * half + fold_x];
    let at = place_in_plane(vec2<u32>(x, y));
    let all = energy_at(at);
    let above = all - least[0].rgb * solid_angle[at];
    let energy = select(vec3<f32>(), above, above > max(all * RESIDUE, vec3<f32>(FAINT)));
    return Cell(
        tent.centroid * signs, tent.radius, tent.diagonal, dot(energy, LUMINANCE),
        tent.mixed * signs.yzx * signs.zxy,
        energy, Tint(), Tint());
}

// Three fields of a cell, the first of them at `at`.
fn store_vector(at: u32, value: vec3<f32>) {
    quads[at] = value.x;
    quads[at + 4u] = value.y;
    quads[at + 8u] = value.z;
}

fn fetch_vector(at: u32) -> vec3<f32> {
    return vec3<f32>(quads[at], quads[at + 4u], quads[at + 8u]);
}

fn store_tint(at: u32, tint: Tint) {
    store_vector(at, tint.dipole);
    store_vector(at + 12u, tint.diagonal);
    store_vector(at + 24u, tint.mixed);
    quads[at + 36u] = tint.variation;
}

fn fetch_tint(at: u32) -> Tint {
    return Tint(fetch_vector(at), quads[at + 36u], fetch_vector(at + 12u), fetch_vector(at + 24u));
}

fn store(quad: u32, k: u32, cell: Cell) {
    let at = quad * QUAD_FIELDS * 4u + k;
    store_vector(at + 4u * FIELD_X, cell.centroid);
    store_vector(at + 4u * FIELD_COVARIANCE, cell.diagonal);
    store_vector(at + 4u * FIELD_COVARIANCE + 12u, cell.mixed);
    store_tint(at + 4u * FIELD_RED_TINT, cell.red_tint);
    store_tint(at + 4u * FIELD_BLUE_TINT, cell.blue_tint);
    quads[at + 4u * FIELD_RADIUS] = cell.radius;
    quads[at + 4u * FIELD_LUMINANCE] = cell.luminance;
    store_vector(at + 4u * FIELD_RED, cell.energy);
}

fn fetch(quad: u32, k: u32) -> Cell {
    let at = quad * QUAD_FIELDS * 4u + k;
    return Cell(
        fetch_vector(at + 4u * FIELD_X),
        quads[at + 4u * FIELD_RADIUS],
        fetch_vector(at + 4u * FIELD_COVARIANCE),
        quads[at + 4u * FIELD_LUMINANCE],
        fetch_vector(at + 4u * FIELD_COVARIANCE + 12u),
        fetch_vector(at + 4u * FIELD_RED),
        fetch_tint(at + 4u * FIELD_RED_TINT),
        fetch_tint(at + 4u * FIELD_BLUE_TINT));
}

// Work of one invocation of `finest` and `coarser`: id.x is quad column times four plus sibling, id.y is quad
// row.
struct Sibling {
    // Index in its quad, 0 to 3.
    index: u32,
    quad: vec2<u32>,
    // Position among the cells of its level.
    cell: vec2<u32>,
}

fn sibling(id: vec3<u32>) -> Sibling {
    let index = id.x & 3u;
    let quad = vec2<u32>(id.x >> 2u, id.y);
    return Sibling(index, quad, 2u * quad + vec2<u32>(index & 1u, index >> 1u));
}

fn store_sibling(own: Sibling, cell: Cell) {
    if all(own.quad < vec2<u32>(level.width)) {
        store(level.first + own.quad.y * level.width + own.quad.x, own.index, cell);
    }
}

// Blocks of texels to the finest quads.
@compute @workgroup_size(4u * EDGE, EDGE)
fn finest(@builtin(global_invocation_id) id: vec3<u32>) {
    let own = sibling(id);
    var result: Union;
    if all(own.cell < vec2<u32>(level.cells)) {
        let low = own.cell * level.block;
        let high = min(low + level.block, vec2<u32>(table.inner));
        if high.x - low.x == 1u && high.y - low.y == 1u {
            result.cell = texel_cell(low.x, low.y);
        } else {
            for (var y = low.y; y < high.y; y++) {
                for (var x = low.x; x < high.x; x++) {
                    gather(&result, texel_cell(x, y));
                }
            }
            centre(&result);
            for (var y = low.y; y < high.y; y++) {
                for (var x = low.x; x < high.x; x++) {
                    absorb(&result, texel_cell(x, y));
                }
            }
        }
    }
    store_sibling(own, result.cell);
}

// Quads to the cells of the next level.
@compute @workgroup_size(4u * EDGE, EDGE)
fn coarser(@builtin(global_invocation_id) id: vec3<u32>) {
    let own = sibling(id);
    var result: Union;
    if all(own.cell < vec2<u32>(level.finer_width)) {
        let below = level.finer_first + own.cell.y * level.finer_width + own.cell.x;
        for (var member = 0u; member < 4u; member++) {
            gather(&result, fetch(below, member));
        }
        centre(&result);
        for (var member = 0u; member < 4u; member++) {
            absorb(&result, fetch(below, member));
        }
    }
    store_sibling(own, result.cell);
}
