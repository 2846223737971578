// Resamples the environment to the OEM and to the cube of footprints. Each target texel gathers its source
// texels, weighted by the solid angle of their overlap in steradians. The matrix is `Overlaps` of
// crates/core/src/geometry/overlap.rs, which derives the mirroring of octants. The source holds radiance; the
// OEM receives energies (radiance times solid angle).
#include "common/octahedral.wgsl"
#include "common/reduce.wgsl"

const EDGE = 16u;

struct Gather {
    // Texels along an edge of the target, of its border, with both borders, and from row to row.
    edge: u32,
    border: u32,
    side: u32,
    pitch: u32,
    // Texels of a layer of the source.
    width: u32,
    height: u32,
    // 1 if the rows are those of the first octant and sources are packed.
    symmetric: u32,
    // Source texels of packed cells, by octant and family: texel of cell (0, 0), steps along i and j.
    source_maps: array<array<vec4<i32>, 3>, 8>,
}

@group(0) @binding(0) var<uniform> gather: Gather;
@group(0) @binding(1) var<storage, read> starts: array<u32>;
// Source index, and the solid angle of the overlap as float32 bits.
@group(0) @binding(2) var<storage, read> overlaps: array<vec2<u32>>;
@group(0) @binding(3) var source: texture_2d_array<f32>;
// Targets: planes of an OEM, whose solid angles are already filled, or radiance.
@group(0) @binding(4) var<storage, read> solid_angle: array<f32>;
@group(0) @binding(5) var<storage, read_write> red: array<f32>;
@group(0) @binding(6) var<storage, read_write> green: array<f32>;
@group(0) @binding(7) var<storage, read_write> blue: array<f32>;
@group(0) @binding(8) var<storage, read_write> footprint: array<vec4<f32>>;

// A row of the matrix, and the octant to read it for.
struct Row {
    octant: u32,
    row: u32,
}

// The rows of one target texel: one, or two on a fold diagonal.
struct Rows {
    count: u32,
    rows: array<Row, 2>,
}

fn mirror_fold(k: u32, half: u32) -> vec2<u32> {
    if k >= half {
        return vec2<u32>(0u, k - half);
    }
    return vec2<u32>(1u, half - 1u - k);
}

fn rows_of_oct(x: u32, y: u32) -> Rows {
    if gather.symmetric == 0u {
        return Rows(1u, array<Row, 2>(Row(0u, y * gather.edge + x), Row()));
    }
    let half = gather.edge / 2u;
    let fold_x = mirror_fold(x, half);
    let fold_y = mirror_fold(y, half);
    let octant = fold_x.x | (fold_y.x << 2u);
    let upper = Row(octant, fold_y.y * half + fold_x.y);
    let lower = Row(octant | 2u, (half - 1u - fold_x.y) * half + (half - 1u - fold_y.y));
    let sum = fold_x.y + fold_y.y;
    if sum + 1u < half {
        return Rows(1u, array<Row, 2>(upper, Row()));
    }
    if sum + 1u > half {
        return Rows(1u, array<Row, 2>(lower, Row()));
    }
    return Rows(2u, array<Row, 2>(upper, lower));
}

fn rows_of_cube(face: u32, i: u32, j: u32) -> Rows {
    let n = gather.edge;
    if gather.symmetric == 0u {
        return Rows(1u, array<Row, 2>(Row(0u, (face * n + j) * n + i), Row()));
    }
    let half = n / 2u;
    let s = select(0u, 1u, i >= half);
    let t = select(0u, 1u, j >= half);
    // Bits for x < 0, y < 0, z < 0, from the face table.
    var octant = 0u;
    switch face {
        case 0u: { octant = (t << 1u) | (s << 2u); }
        case 1u: { octant = 1u | (t << 1u) | ((1u - s) << 2u); }
        case 2u: { octant = (1u - s) | ((1u - t) << 2u); }
        case 3u: { octant = (1u - s) | 2u | (t << 2u); }
        case 4u: { octant = (1u - s) | (t << 1u); }
        default: { octant = s | (t << 1u) | 4u; }
    }
    let row = ((face / 2u) * half + mirror_fold(j, half).y) * half + mirror_fold(i, half).y;
    return Rows(1u, array<Row, 2>(Row(octant, row), Row()));
}

// Maps any texture value to a finite, non-negative one; NaN becomes 0.
fn finite(value: f32) -> f32 {
    let bits = bitcast<u32>(value);
    if bits > 0x7f800000u {
        return 0.0;
    }
    return bitcast<f32>(min(bits, 0x7f7fffffu));
}

fn radiance_at(octant: u32, packed: u32) -> vec3<f32> {
    var index = packed;
    if gather.symmetric != 0u {
        let map = gather.source_maps[octant][packed >> 30u];
        let i = i32(packed & 0x7fffu);
        let j = i32((packed >> 15u) & 0x7fffu);
        index = u32(map.x + i * map.y + j * map.z);
    }
    let y = index / gather.width;
    let at = vec2<u32>(index % gather.width, y % gather.height);
    let value = textureLoad(source, at, y / gather.height, 0).rgb;
    return vec3<f32>(finite(value.r), finite(value.g), finite(value.b));
}

// Sources summed before their sum joins the others, so that rounding does not grow with their number.
const CHUNK = 64u;

// The least radiance over every `lanes`-th source from source `lane` on. Sums run over the radiance above it:
// a constant map stays constant to the last bit, and nothing cancels.
fn darkest(rows: Rows, lane: u32, lanes: u32) -> vec3<f32> {
    var least = vec3<f32>(3.4e38);
    for (var r = 0u; r < rows.count; r++) {
        let row = rows.rows[r].row;
        for (var k = starts[row] + lane; k < starts[row + 1u]; k += lanes) {
            least = min(least, radiance_at(rows.rows[r].octant, overlaps[k].x));
        }
    }
    return least;
}

// Sums over every `lanes`-th chunk of a texel's sources from chunk `lane` on: radiance above `least` times
// shared solid angle, and that solid angle. Units are about the texel's own solid angle, so that no sum
// overflows.
fn shares(rows: Rows, least: vec3<f32>, per_unit: f32, lane: u32, lanes: u32) -> vec4<f32> {
    var sum = vec4<f32>();
    for (var r = 0u; r < rows.count; r++) {
        let row = rows.rows[r].row;
        let last = starts[row + 1u];
        for (var first = starts[row] + lane * CHUNK; first < last; first += lanes * CHUNK) {
            var part = vec4<f32>();
            for (var k = first; k < min(first + CHUNK, last); k++) {
                let overlap = overlaps[k];
                let share = bitcast<f32>(overlap.y) * per_unit;
                let above = radiance_at(rows.rows[r].octant, overlap.x) - least;
                part += vec4<f32>(above * share, share);
            }
            sum += part;
        }
    }
    return sum;
}

// With few sources per texel, one invocation serves a texel; with many, a workgroup does.
const GROUP_SIZE = 256u;

struct Reduced {
    least: vec3<f32>,
    sum: vec4<f32>,
}

fn combine(a: Reduced, b: Reduced) -> Reduced {
    return Reduced(min(a.least, b.least), a.sum + b.sum);
}

// Mean radiance of a texel's sources, by one invocation.
fn mean_radiance(rows: Rows, per_unit: f32) -> vec3<f32> {
    let least = darkest(rows, 0u, 1u);
    let sum = shares(rows, least, per_unit, 0u, 1u);
    return least + sum.rgb / sum.a;
}

// The same, by the whole workgroup.
fn mean_radiance_of_group(rows: Rows, per_unit: f32, lane: u32) -> vec3<f32> {
    let least = reduce(Reduced(darkest(rows, lane, GROUP_SIZE), vec4<f32>()), lane).least;
    let sum = reduce(Reduced(least, shares(rows, least, per_unit, lane, GROUP_SIZE)), lane).sum;
    return least + sum.rgb / sum.a;
}

fn oem_texel(id: vec2<u32>) -> vec2<u32> {
    return wrap_texel(gather.edge, vec2<i32>(id) - i32(gather.border));
}

fn store_oem(at: u32, radiance: vec3<f32>) {
    let energy = radiance * solid_angle[at];
    red[at] = energy.r;
    green[at] = energy.g;
    blue[at] = energy.b;
}

@compute @workgroup_size(EDGE, EDGE)
fn oem(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= gather.side || id.y >= gather.side {
        return;
    }
    let texel = oem_texel(id.xy);
    let at = id.y * gather.pitch + id.x;
    store_oem(at, mean_radiance(rows_of_oct(texel.x, texel.y), 1.0 / solid_angle[at]));
}

@compute @workgroup_size(GROUP_SIZE)
fn oem_by_groups(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let texel = oem_texel(id.xy);
    let at = id.y * gather.pitch + id.x;
    let radiance = mean_radiance_of_group(rows_of_oct(texel.x, texel.y), 1.0 / solid_angle[at], lane);
    if lane == 0u {
        store_oem(at, radiance);
    }
}

// 1 over the mean solid angle of a cube's texel.
fn cube_texels_per_steradian() -> f32 {
    return 6.0 * f32(gather.edge) * f32(gather.edge) / 12.566371;
}

@compute @workgroup_size(EDGE, EDGE)
fn footprints(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = gather.edge;
    if id.x >= n || id.y >= n {
        return;
    }
    let radiance = mean_radiance(rows_of_cube(id.z, id.x, id.y), cube_texels_per_steradian());
    footprint[(id.z * n + id.y) * n + id.x] = vec4<f32>(radiance, 1.0);
}

@compute @workgroup_size(GROUP_SIZE)
fn footprints_by_groups(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let n = gather.edge;
    let rows = rows_of_cube(id.z, id.x, id.y);
    let radiance = mean_radiance_of_group(rows, cube_texels_per_steradian(), lane);
    if lane == 0u {
        footprint[(id.z * n + id.y) * n + id.x] = vec4<f32>(radiance, 1.0);
    }
}
