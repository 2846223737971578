// Integrates lobes over the cells by adaptive quadrature. crates/core/src/cpu/adaptive.rs and
// crates/core/src/cpu/subtexel.rs derive the method. Directions and distances are in units of the sphere's
// radius; energies are radiance times solid angle. Answers are radiance, with the certified bound of its
// luminance in w, then bounds of the channels.
//
// One workgroup serves a packet of LANES directions. It walks the tree with a stack, sixteen quads per step,
// one invocation per sibling. A cell that meets the tolerance becomes a leaf. Leaves are summed once there
// are enough to occupy all invocations: each invocation takes one direction and every fourth leaf. Positions
// on the stack and in the leaf list come from prefix counts, not from arrival order, so equal inputs give
// equal bits.
#include "common/kernel.wgsl"
#include "common/octahedral.wgsl"
#include "common/quad.wgsl"
#include "common/rows.wgsl"
#include "common/source_pieces.wgsl"
#include "common/tints.wgsl"

const LANES = 16u;
const GROUP_SIZE = 64u;
const PARTS = GROUP_SIZE / LANES;
// Quads visited per step.
const BATCH = GROUP_SIZE / 4u;
// One step pops 16 quads and pushes at most 64 children of one level: a net 48 per level, and 64 at the end.
const STACK = 1024u;
// Up to GROUP_SIZE - 1 leaves wait while up to GROUP_SIZE more arrive.
const LEAVES = 2u * GROUP_SIZE;
// Halvings of a texel of the OEM that 14 bits can address, and of one of the source that 11 bits can.
const DEPTH = 14u;
const SOURCE_DEPTH = 11u;
const LEVELS = 16u;
// Pieces with longer sides in (u, v) have no exact centroid.
const SMOOTH_SIDE = 0.03125f;

struct Lobe {
    shape: u32,
    first: f32,
    second: f32,
    third: f32,
    fourth: f32,
    // Greatest expected error of a leaf, divided by the mean luminance.
    tolerance_per_mean: f32,
    // Share of this part in the whole lobe; the same divided by the kernel's integral.
    share: f32,
    per_integral: f32,
    // Relative rounding error of a sum: a constant plus a term per leaf.
    rounding: f32,
    rounding_per_leaf: f32,
    // Texels along an edge of the OEM.
    inner: u32,
    // 1 if the tree reaches texels, which can be subdivided further.
    to_texels: u32,
    // Half the width of a texel's spread: 1/2, or 1 for bilinear reconstruction.
    reach: f32,
    // Level of the root.
    root: u32,
    // 1 to add to the existing results.
    add: u32,
    // Number of packets.
    count: u32,
    // Radiance that the omitted faint energies may add; loss to underflow per unit of energy.
    omitted: f32,
    underflow: f32,
    // Layout of the source whose texels the finest cells hold: 0 without one.
    source: u32,
    // Columns and rows of its texels, of one image; halvings of the texture's texels that lead to them.
    columns: u32,
    rows: u32,
    shift_x: u32,
    shift_y: u32,
    // Finest cells along an edge.
    cells: u32,
    // Per level: first quad, and quads along an edge.
    levels: array<vec4<u32>, LEVELS>,
}

struct Packet {
    // A point near the directions, exact in float32.
    axis: vec3<f32>,
    radius: f32,
    // Directions minus the axis.
    x: array<f32, LANES>,
    y: array<f32, LANES>,
    z: array<f32, LANES>,
}

@group(0) @binding(0) var<uniform> lobe: Lobe;
@group(0) @binding(1) var<storage, read> least: array<vec4<f32>, 1>;
@group(0) @binding(2) var<storage, read> quads: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> packets: array<Packet>;
// Two for each direction: radiance and the luminance's bound, then the bounds of red, green and blue.
@group(0) @binding(4) var<storage, read_write> results: array<vec4<f32>>;
// Leaves of each packet; INCOMPLETE if the walk stopped early.
@group(0) @binding(5) var<storage, read_write> leaf_counts: array<u32>;

// The source's texels by cells: first run of each cell, the number of runs, then each run's column, row
// (counted through all images) and number of texels.
@group(0) @binding(6) var<storage, read> members: array<u32>;
// Cosine and sine of the longitudes of a panorama's columns, then of the polar angles of its rows.
@group(0) @binding(7) var<storage, read> angles: array<vec2<f32>>;
@group(0) @binding(8) var source: texture_2d_array<f32>;

const INCOMPLETE = 0x80000000u;

// A cell, or a piece of a texel. `place` packs level | j | i in 4, 14 and 14 bits; level PIECES marks the
// pieces of texel (i, j) of the OEM. `piece` packs quadrant | depth | iy | ix in 2, 4, 13 and 13 bits; at
// depth 0 the pieces are the quadrants.
//
// Level MEMBERS marks texels of the source in a cell: `place` packs a run's first texel | runs in 6 and 20
// bits below 0 in 2 bits, `piece` is the first run. Three children are texels, the fourth is the rest. With 1
// in the 2 bits it is a piece of the texel `piece` (rows times columns, plus column): `place` packs depth |
// iy | ix in 4, 11 and 11 bits.
struct Node {
    place: u32,
    piece: u32,
}

const PIECES = 15u;
const MEMBERS = 14u;

var<workgroup> stack: array<Node, STACK>;
var<workgroup> stack_size: u32;

// Leaves: offset from the packet's axis, covariance, energy, radius, certified width per unit of energy for
// pieces without an exact centroid, and the cell.
const LEAF_FIELDS = 15u;
var<workgroup> leaves: array<f32, LEAF_FIELDS * LEAVES>;
var<workgroup> leaf_size: u32;
// Bit masks of the invocations that push a node, and of those that add a leaf.
var<workgroup> pushes: array<atomic<u32>, 2>;
var<workgroup> finds: array<atomic<u32>, 2>;

struct Leaf {
    offset: vec3<f32>,
    diagonal: vec3<f32>,
    mixed: vec3<f32>,
    radius: f32,
    energy: vec3<f32>,
    slack: f32,
    // The cell, quad times four plus sibling plus one, whose tints apply; 0 for a piece of one texel.
    cell: u32,
}

fn put_leaf(at: u32, leaf: Leaf) {
    for (var c = 0u; c < 3u; c++) {
        leaves[c * LEAVES + at] = leaf.offset[c];
        leaves[(3u + c) * LEAVES + at] = leaf.diagonal[c];
        leaves[(6u + c) * LEAVES + at] = leaf.mixed[c];
        leaves[(9u + c) * LEAVES + at] = leaf.energy[c];
    }
    leaves[12u * LEAVES + at] = leaf.radius;
    leaves[13u * LEAVES + at] = leaf.slack;
    // Drivers flush the patterns of subnormal numbers; this one is normal.
    leaves[14u * LEAVES + at] = bitcast<f32>(leaf.cell | 0x40000000u);
}

fn get_leaf(at: u32) -> Leaf {
    var leaf: Leaf;
    for (var c = 0u; c < 3u; c++) {
        leaf.offset[c] = leaves[c * LEAVES + at];
        leaf.diagonal[c] = leaves[(3u + c) * LEAVES + at];
        leaf.mixed[c] = leaves[(6u + c) * LEAVES + at];
        leaf.energy[c] = leaves[(9u + c) * LEAVES + at];
    }
    leaf.radius = leaves[12u * LEAVES + at];
    leaf.slack = leaves[13u * LEAVES + at];
    leaf.cell = bitcast<u32>(leaves[14u * LEAVES + at]) & 0x3fffffffu;
    return leaf;
}

fn kernel() -> Kernel {
    return Kernel(lobe.shape, lobe.first, lobe.second, lobe.third, lobe.fourth);
}

// One cell as a leaf, with the expected error of not splitting it.
struct Visit {
    leaf: Leaf,
    error: f32,
    luminance: f32,
}

// The packet's, see `Packet`.
var<private> packet_axis: vec3<f32>;
var<private> packet_radius: f32;

// Factors that make an error of a channel comparable with one of the luminance: see `channel_weights`.
var<private> weights: vec3<f32>;

// The energy whose error counts: that of the channel with the most, times its weight. The luminance is a mean
// of these, to a hundredth.
fn weighted(energy: vec3<f32>) -> f32 {
    let channels = energy * weights;
    return max(channels.r, max(channels.g, channels.b));
}

fn field(quad: u32, name: u32, k: u32) -> f32 {
    return quads[quad * QUAD_FIELDS + name][k];
}

// Three fields, from `name` on.
fn vector_at(quad: u32, name: u32, k: u32) -> vec3<f32> {
    return vec3<f32>(field(quad, name, k), field(quad, name + 1u, k), field(quad, name + 2u, k));
}

fn quad_at(level: u32, i: u32, j: u32) -> u32 {
    return lobe.levels[level].x + j * lobe.levels[level].y + i;
}

fn visit_cell(quad: u32, k: u32) -> Visit {
    var visit: Visit;
    visit.luminance = field(quad, FIELD_LUMINANCE, k);
    if visit.luminance == 0.0 {
        return visit;
    }
    let centroid = vector_at(quad, FIELD_X, k);
    visit.leaf.offset = centroid - packet_axis;
    visit.leaf.diagonal = vector_at(quad, FIELD_COVARIANCE, k);
    visit.leaf.mixed = vector_at(quad, FIELD_COVARIANCE + 3u, k);
    visit.leaf.energy = vector_at(quad, FIELD_RED, k);
    visit.leaf.radius = field(quad, FIELD_RADIUS, k);
    visit.leaf.cell = 4u * quad + k + 1u;
    let weight = weighted(visit.leaf.energy);
    let radius = visit.leaf.radius;
    let trace = visit.leaf.diagonal.x + visit.leaf.diagonal.y + visit.leaf.diagonal.z;
    // The channel that counts most may spread farther around the centroid. Over unit directions the
    // quadrupole's trace is -2 D.m.
    let red = -2.0 * dot(vector_at(quad, FIELD_RED_TINT, k), centroid);
    let blue = -2.0 * dot(vector_at(quad, FIELD_BLUE_TINT, k), centroid);
    let tints = vec3<f32>(red, -(red * LUMINANCE.r + blue * LUMINANCE.b) / LUMINANCE.g, blue);
    let spreads = weights * (visit.leaf.energy * trace + tints);
    let spread = max(spreads.r, max(spreads.g, spreads.b)) / max(weight, 1e-37);
    let light_trace = min(max(spread, trace), radius * radius);
    visit.error = weight
        * expected_error(kernel(), length(visit.leaf.offset), radius, packet_radius, light_trace);
    return visit;
}

// The spread's density on [a, b], 0 <= a <= b, along one axis: its mass, and two nodes that match its first
// three moments. `share` is the first node's share of the mass.
struct Slice {
    mass: f32,
    nodes: array<f32, 2>,
    share: f32,
}

fn slice(a: f32, b: f32) -> Slice {
    let width = b - a;
    let middle = 0.5 * (a + b);
    let squared = width * width / 12.0;
    if lobe.reach < 1.0 {
        let deviation = sqrt(squared);
        return Slice(width, array(middle - deviation, middle + deviation), 0.5);
    }
    let top = 1.0 - middle;
    let shift = -squared / top;
    // `shift` squared is at most a third of `squared`.
    let variance = squared - shift * shift;
    let deviation = sqrt(variance);
    let skew = shift * (shift * shift - 0.6 * squared) / (variance * deviation);
    let root = sqrt(1.0 + skew * skew);
    let mean = middle + shift;
    return Slice(
        width * top,
        array(mean + deviation * (skew - root), mean + deviation * (skew + root)),
        0.5 * (1.0 + skew / root),
    );
}

fn wrap_oct(uv: vec2<f32>) -> vec2<f32> {
    let tile = floor((uv + 1.0) / 2.0);
    let inside = uv - tile * 2.0;
    let odd = ((i32(tile.x) ^ i32(tile.y)) & 1) != 0;
    return select(inside, -inside, odd);
}

fn between(low: f32, high: f32, at: f32) -> bool {
    // Corners of pieces are rounded. A kink this close to an edge cuts off a negligible part.
    let tiny = 1e-6 / f32(lobe.inner);
    return low < at - tiny && high > at + tiny;
}

// Whether an axis, an edge of the square or a fold diagonal crosses the interior of the box from `a` to `b`.
fn crosses_kink(a: vec2<f32>, b: vec2<f32>) -> bool {
    let low = min(a, b);
    let high = max(a, b);
    for (var at = -1.0; at <= 1.0; at += 1.0) {
        if between(low.x, high.x, at) || between(low.y, high.y, at) {
            return true;
        }
    }
    let inside_a = abs(wrap_oct(a));
    let inside_b = abs(wrap_oct(b));
    let least_corner = min(inside_a, inside_b);
    let most_corner = max(inside_a, inside_b);
    return between(least_corner.x + least_corner.y, most_corner.x + most_corner.y, 1.0);
}

// A piece of texel (x, y): at `depth` >= 1, cell (ix, iy) of a grid of 2^(depth - 1) cells along an edge of
// its quadrant.
fn visit_piece(x: u32, y: u32, quadrant: u32, depth: u32, ix: u32, iy: u32) -> Visit {
    let quad = quad_at(0u, x >> 1u, y >> 1u);
    let k = (x & 1u) + 2u * (y & 1u);
    let h = 2.0 / f32(lobe.inner);
    let centre = (vec2<f32>(f32(x), f32(y)) + 0.5) * h - 1.0;
    let signs = vec2<f32>(select(1.0, -1.0, (quadrant & 1u) != 0u), select(1.0, -1.0, (quadrant & 2u) != 0u));
    let edge = lobe.reach / f32(1u << (depth - 1u));
    let low = vec2<f32>(f32(ix), f32(iy)) * edge;
    let high = low + edge;
    let across = slice(low.x, high.x);
    let down = slice(low.y, high.y);
    let share = across.mass * down.mass;

    var nodes: array<vec3<f32>, 4>;
    var weights: array<f32, 4>;
    var centroid = vec3<f32>();
    for (var n = 0u; n < 4u; n++) {
        let i = n & 1u;
        let j = n >> 1u;
        let node = vec2<f32>(across.nodes[i], down.nodes[j]);
        nodes[n] = direction_from_oct(wrap_oct(centre + signs * node * h)) - packet_axis;
        weights[n] = select(across.share, 1.0 - across.share, i == 1u)
            * select(down.share, 1.0 - down.share, j == 1u);
        centroid += weights[n] * nodes[n];
    }
    var visit: Visit;
    visit.leaf.offset = centroid;
    for (var n = 0u; n < 4u; n++) {
        let apart = nodes[n] - centroid;
        visit.leaf.diagonal += weights[n] * apart * apart;
        visit.leaf.mixed += weights[n] * apart.yzx * apart.zxy;
        let corner = vec2<f32>(select(low.x, high.x, (n & 1u) != 0u), select(low.y, high.y, (n & 2u) != 0u));
        let reached = direction_from_oct(wrap_oct(centre + signs * corner * h)) - packet_axis - centroid;
        visit.leaf.radius = max(visit.leaf.radius, length(reached));
    }
    // Float32 directions are in error by less than 2^-22.
    visit.leaf.radius += 5e-7;
    visit.leaf.energy = vector_at(quad, FIELD_RED, k) * share;
    visit.luminance = field(quad, FIELD_LUMINANCE, k) * share;
    let distance = length(centroid);
    if edge * h > SMOOTH_SIDE || crosses_kink(centre + signs * low * h, centre + signs * high * h) {
        // Directions move by at most 3 per unit of (u, v).
        visit.leaf.radius = min(max(visit.leaf.radius, 3.0 * length(high - low) * h), 2.0);
        visit.leaf.slack = first_order_width(kernel(), distance, visit.leaf.radius, packet_radius);
        visit.error = weighted(visit.leaf.energy) * visit.leaf.slack;
    } else {
        let trace = visit.leaf.diagonal.x + visit.leaf.diagonal.y + visit.leaf.diagonal.z;
        visit.error = weighted(visit.leaf.energy)
            * expected_error(kernel(), distance, visit.leaf.radius, packet_radius, trace);
    }
    return visit;
}

// The texels of the source in cell (i, j), as a node.
fn members_of(i: u32, j: u32) -> Node {
    let cell = j * lobe.cells + i;
    return Node((MEMBERS << 28u) | (members[cell + 1u] - members[cell]), members[cell]);
}

// Child `k` of a node of level MEMBERS.
fn member_child(node: Node, k: u32) -> Child {
    var child: Child;
    if ((node.place >> 26u) & 1u) != 0u {
        let depth = ((node.place >> 22u) & 15u) + 1u;
        let ix = 2u * (node.place & 0x7ffu) + (k & 1u);
        let iy = 2u * ((node.place >> 11u) & 0x7ffu) + (k >> 1u);
        let row = node.piece / lobe.columns;
        child.visit = visit_source(node.piece % lobe.columns, row, depth, ix, iy);
        child.node = Node((MEMBERS << 28u) | (1u << 26u) | (depth << 22u) | (iy << 11u) | ix, node.piece);
        child.splits = depth < SOURCE_DEPTH;
        return child;
    }
    var run = node.piece;
    var runs = node.place & 0xfffffu;
    var at = ((node.place >> 20u) & 63u) + k;
    let first = lobe.cells * lobe.cells + 1u;
    while runs > 0u && at >= members[first + 3u * run + 2u] {
        at -= members[first + 3u * run + 2u];
        run += 1u;
        runs -= 1u;
    }
    if runs == 0u {
        return child;
    }
    if k == 3u {
        child.node = Node((MEMBERS << 28u) | (at << 20u) | runs, run);
        child.rest = true;
        return child;
    }
    let column = members[first + 3u * run] + at;
    let row = members[first + 3u * run + 1u];
    child.visit = visit_source(column, row, 0u, 0u, 0u);
    child.node = Node((MEMBERS << 28u) | (1u << 26u), row * lobe.columns + column);
    child.splits = true;
    return child;
}

// Sums over the leaves for one direction.
struct Sums {
    radiance: vec3<f32>,
    // How far the luminance's true value can lie above and below the estimate; how far a channel's can.
    above: f32,
    below: f32,
    off: vec3<f32>,
    // Energy at s above 1/4 and not beyond the horizon.
    grazing: vec3<f32>,
    count: u32,
}

fn sum_leaf(leaf: Leaf, direction: vec3<f32>, sums: ptr<function, Sums>) {
    let apart = leaf.offset - direction;
    let squared = dot(apart, apart);
    let trace = leaf.diagonal.x + leaf.diagonal.y + leaf.diagonal.z;
    let along = dot(leaf.diagonal, apart * apart) + 2.0 * dot(leaf.mixed, apart.yzx * apart.zxy);
    let mean = interval(kernel(), squared, trace, along, leaf.radius);
    let luminance = dot(leaf.energy, LUMINANCE);
    let over = mean.greatest - mean.estimate + mean.rounding + leaf.slack;
    let under = mean.estimate - mean.least + mean.rounding + leaf.slack;
    (*sums).radiance += mean.estimate * leaf.energy;
    (*sums).above += over * luminance;
    (*sums).below += under * luminance;
    // Green's tint follows from those of the others, and may exceed its energy.
    let neglected = vec3<f32>(leaf.energy.r, luminance / LUMINANCE.g, leaf.energy.b);
    (*sums).off += max(over, under) * leaf.energy + NEGLIGIBLE_TINT * mean.spread * neglected;
    let distance = sqrt(squared);
    if distance + leaf.radius > 0.999 && distance - leaf.radius < 1.415 {
        (*sums).grazing += leaf.energy;
    }
    if leaf.cell != 0u && mean.spread > 0.0 {
        add_tints(leaf, apart, mean, sums);
    }
    (*sums).count += 1u;
}

// Number of bits set below `lane`, of 64.
fn rank(low: u32, high: u32, lane: u32) -> u32 {
    if lane < 32u {
        return countOneBits(low & ((1u << lane) - 1u));
    }
    return countOneBits(low) + countOneBits(high & ((1u << (lane - 32u)) - 1u));
}

fn root_sum(name: u32) -> f32 {
    return dot(quads[quad_at(lobe.root, 0u, 0u) * QUAD_FIELDS + name], vec4<f32>(1.0));
}

// The mean radiance over the sphere.
fn mean_radiance() -> vec3<f32> {
    let above_least = vec3<f32>(root_sum(FIELD_RED), root_sum(FIELD_RED + 1u), root_sum(FIELD_RED + 2u));
    return least[0].rgb + above_least / 12.566371;
}

// A channel whose mean is below the luminance's by more than this factor is nearly black.
const DIMMEST = 100.0f;

// The factors that make errors of the channels comparable with one of the luminance, for the `mean` radiance.
fn channel_weights(mean: vec3<f32>) -> vec3<f32> {
    let luminance = vec3<f32>(dot(mean, LUMINANCE));
    return select(vec3<f32>(DIMMEST), luminance / mean, luminance < DIMMEST * mean);
}

// A child of a node, as a leaf and as a node.
struct Child {
    visit: Visit,
    node: Node,
    // Whether it may be split further.
    splits: bool,
    // Whether it is the rest of a list, which must be visited.
    rest: bool,
}

fn child_of(node: Node, k: u32) -> Child {
    let level = node.place >> 28u;
    let i = node.place & 0x3fffu;
    let j = (node.place >> 14u) & 0x3fffu;
    if level == MEMBERS {
        return member_child(node, k);
    }
    if level == PIECES {
        let depth = ((node.piece >> 26u) & 15u) + 1u;
        var quadrant = node.piece >> 30u;
        var ix = 2u * (node.piece & 0x1fffu) + (k & 1u);
        var iy = 2u * ((node.piece >> 13u) & 0x1fffu) + (k >> 1u);
        if depth == 1u {
            quadrant = k;
            ix = 0u;
            iy = 0u;
        }
        return Child(
            visit_piece(i, j, quadrant, depth, ix, iy),
            Node(node.place, (quadrant << 30u) | (depth << 26u) | (iy << 13u) | ix),
            depth < DEPTH,
            false,
        );
    }
    let x = 2u * i + (k & 1u);
    let y = 2u * j + (k >> 1u);
    // Below the finest level, nodes are pieces of texels.
    let below = select(PIECES, level - 1u, level > 0u);
    var child = Child(
        visit_cell(quad_at(level, i, j), k),
        Node((below << 28u) | (y << 14u) | x, 0u),
        level > 0u || lobe.to_texels != 0u,
        false,
    );
    if level == 0u && lobe.source != 0u && child.visit.luminance > 0.0 {
        child.node = members_of(x, y);
    }
    return child;
}

// Adds the partial sums of one direction, stored in the leaves' memory by `leave_sums`.
fn gather_sums(lane: u32) -> Sums {
    var sums: Sums;
    for (var at = lane; at < GROUP_SIZE; at += LANES) {
        for (var c = 0u; c < 3u; c++) {
            sums.radiance[c] += leaves[c * GROUP_SIZE + at];
            sums.off[c] += leaves[(3u + c) * GROUP_SIZE + at];
            sums.grazing[c] += leaves[(6u + c) * GROUP_SIZE + at];
        }
        sums.above += leaves[9u * GROUP_SIZE + at];
        sums.below += leaves[10u * GROUP_SIZE + at];
        sums.count += bitcast<u32>(leaves[11u * GROUP_SIZE + at]) & 0x3fffffffu;
    }
    return sums;
}

fn leave_sums(lane: u32, sums: Sums) {
    for (var c = 0u; c < 3u; c++) {
        leaves[c * GROUP_SIZE + lane] = sums.radiance[c];
        leaves[(3u + c) * GROUP_SIZE + lane] = sums.off[c];
        leaves[(6u + c) * GROUP_SIZE + lane] = sums.grazing[c];
    }
    leaves[9u * GROUP_SIZE + lane] = sums.above;
    leaves[10u * GROUP_SIZE + lane] = sums.below;
    // Store the pattern of a normal number: drivers flush subnormals.
    leaves[11u * GROUP_SIZE + lane] = bitcast<f32>(sums.count | 0x40000000u);
}

// The answer, as `results` has it, from the sums over `count` leaves.
fn answer(sums: Sums, count: u32) -> array<vec4<f32>, 2> {
    let radiance = max(sums.radiance, vec3<f32>()) * lobe.per_integral;
    let rounding = lobe.rounding + lobe.rounding_per_leaf * f32(count);
    // Where k is near 0, an absolute error in s counts more than a relative error in k. On the CPU s is in
    // error by 8 2^-24; here directions are in error by 2^-22, and distances by the same again.
    let grazed = sums.grazing * grazing_slope(kernel()) * 1.5e-6 * lobe.per_integral;
    let mean = mean_radiance();
    // The least radiance and every E - c w are float32 differences, in error by 2^-21 of the whole; omitted
    // residues add at most as much.
    let omitted = lobe.omitted + lobe.underflow * 12.566371 * mean;
    let fixed = grazed + 9.6e-7 * least[0].rgb * lobe.share
        + select(vec3<f32>(), omitted, dot(mean, LUMINANCE) > 0.0);
    let luminance_bound =
        max(sums.above, sums.below) * lobe.per_integral + dot(rounding * radiance + fixed, LUMINANCE);
    // Tints are rounded like centroids.
    let channel_bounds = sums.off * lobe.per_integral + 3.0 * rounding * radiance + fixed;
    return array<vec4<f32>, 2>(
        vec4<f32>(lobe.share * least[0].rgb + radiance, luminance_bound), vec4<f32>(channel_bounds, 0.0));
}

@compute @workgroup_size(GROUP_SIZE)
fn adaptive(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = index_in_rows(group);
    if index >= lobe.count {
        return;
    }
    packet_axis = packets[index].axis;
    packet_radius = packets[index].radius;
    let own = lane % LANES;
    let direction = vec3<f32>(packets[index].x[own], packets[index].y[own], packets[index].z[own]);
    let mean = mean_radiance();
    let tolerance = lobe.tolerance_per_mean * dot(mean, LUMINANCE);
    weights = channel_weights(mean);

    if lane == 0u {
        stack[0] = Node(lobe.root << 28u, 0u);
        stack_size = 1u;
        leaf_size = 0u;
    }
    var sums: Sums;
    var leaf_total = 0u;
    loop {
        let size = workgroupUniformLoad(&stack_size);
        if size == 0u {
            break;
        }
        if lane < 2u {
            atomicStore(&pushes[lane], 0u);
            atomicStore(&finds[lane], 0u);
        }
        workgroupBarrier();
        // Four invocations per node, one per child.
        let taken = min(size, BATCH);
        var child: Child;
        var push = false;
        if (lane >> 2u) < taken {
            child = child_of(stack[size - taken + (lane >> 2u)], lane & 3u);
            // A full stack only yields coarser leaves; the bound accounts for them. Cells without luminance
            // contribute nothing; skip them.
            push = child.visit.error > tolerance && child.splits && size + GROUP_SIZE <= STACK
                && child.visit.luminance > 0.0;
            // A rest takes the place of the node it came from.
            push = push || child.rest;
            let bit = 1u << (lane & 31u);
            if push {
                atomicOr(&pushes[lane >> 5u], bit);
            } else if child.visit.luminance > 0.0 {
                atomicOr(&finds[lane >> 5u], bit);
            }
        }
        workgroupBarrier();
        let push_low = atomicLoad(&pushes[0]);
        let push_high = atomicLoad(&pushes[1]);
        let find_low = atomicLoad(&finds[0]);
        let find_high = atomicLoad(&finds[1]);
        let waiting = workgroupUniformLoad(&leaf_size);
        if push {
            stack[size - taken + rank(push_low, push_high, lane)] = child.node;
        } else if child.visit.luminance > 0.0 {
            put_leaf(waiting + rank(find_low, find_high, lane), child.visit.leaf);
        }
        let found = waiting + countOneBits(find_low) + countOneBits(find_high);
        let next = size - taken + countOneBits(push_low) + countOneBits(push_high);
        let flush = found >= GROUP_SIZE || next == 0u;
        workgroupBarrier();
        if lane == 0u {
            stack_size = next;
            leaf_size = select(found, 0u, flush);
        }
        if flush {
            for (var at = lane / LANES; at < found; at += PARTS) {
                sum_leaf(get_leaf(at), direction, &sums);
            }
            leaf_total += found;
        }
        workgroupBarrier();
    }

    leave_sums(lane, sums);
    workgroupBarrier();
    if lane >= LANES {
        return;
    }
    sums = gather_sums(lane);
    var own_answer = answer(sums, leaf_total);
    let at = 2u * (index * LANES + lane);
    for (var k = 0u; k < 2u; k++) {
        if lobe.add != 0u {
            own_answer[k] += results[at + k];
        }
        results[at + k] = own_answer[k];
    }
    if lane == 0u {
        // Some drivers end long loops without reporting it.
        let complete = sums.count == leaf_total && stack_size == 0u;
        leaf_counts[index] = select(INCOMPLETE, leaf_total, complete);
    }
}
