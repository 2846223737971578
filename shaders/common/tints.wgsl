// What tints (crates/core/src/geometry/tint.rs) of red and blue add to the channels of a leaf;
// crates/core/src/cpu/adaptive.rs derives it. Reads `field`, `vector_at`, `Leaf` and `Sums` of adaptive.wgsl.

// A tint with a smaller share of its channel's energy is rounding error.
const NEGLIGIBLE_TINT = 1.0f / 1048576.0f;

// Error of a dipole, over its channel's energy times the cell's reach.
const TINT_ROUNDING = 1.0f / 524288.0f;

// Where the series' error may exceed the kernel's variation by this factor, it is not used.
const USELESS = 1000.0f;

// What the tint at field `name` of cell `k` of `quad` adds to a channel.
fn tint_share(quad: u32, k: u32, name: u32, apart: vec3<f32>, slope: f32, bend: f32) -> f32 {
    let diagonal = vector_at(quad, name + 3u, k);
    let mixed = vector_at(quad, name + 6u, k);
    let first = 0.5 * dot(vector_at(quad, name, k), apart) + 0.25 * (diagonal.x + diagonal.y + diagonal.z);
    let second = 0.25 * dot(diagonal, apart * apart) + 0.5 * dot(mixed, apart.yzx * apart.zxy);
    return slope * first + bend * second;
}

// Adds the tints of `leaf`, a cell.
fn add_tints(leaf: Leaf, apart: vec3<f32>, mean: Interval, sums: ptr<function, Sums>) {
    let quad = (leaf.cell - 1u) >> 2u;
    let k = (leaf.cell - 1u) & 3u;
    let red_variation = field(quad, FIELD_RED_TINT + TINT_FIELDS - 1u, k);
    let blue_variation = field(quad, FIELD_BLUE_TINT + TINT_FIELDS - 1u, k);
    if red_variation <= NEGLIGIBLE_TINT * leaf.energy.r && blue_variation <= NEGLIGIBLE_TINT * leaf.energy.b {
        return;
    }
    // Elsewhere slopes may be infinite.
    let useful = mean.rest < USELESS * mean.spread;
    let slope = select(0.0, mean.slope, useful);
    let bend = select(0.0, mean.bend, useful);
    let rest = select(2.0 * mean.spread, min(mean.rest, 2.0 * mean.spread), useful);
    // Truth lies within: clipping brings the series nearer to it, and within twice that.
    let most = mean.spread * vec2<f32>(red_variation, blue_variation);
    let red = clamp(tint_share(quad, k, FIELD_RED_TINT, apart, slope, bend), -most.x, most.x);
    let blue = clamp(tint_share(quad, k, FIELD_BLUE_TINT, apart, slope, bend), -most.y, most.y);
    let rounding = TINT_ROUNDING * leaf.radius * abs(slope);
    let red_off = rest * red_variation + rounding * leaf.energy.r;
    let blue_off = rest * blue_variation + rounding * leaf.energy.b;
    // The luminance's tint is zero.
    let per_green = LUMINANCE / LUMINANCE.g;
    (*sums).radiance += vec3<f32>(red, -(red * per_green.r + blue * per_green.b), blue);
    (*sums).off += vec3<f32>(red_off, red_off * per_green.r + blue_off * per_green.b, blue_off);
}
