//! A quick measurement of what renderers read from a chain: the typical error of its trilinear look-ups.
//!
//! [`super::delivered`] measures tens of thousands of directions per roughness; this takes a few dozen,
//! chosen where the error is: half of them evenly over the sphere, half in proportion to the light, so that
//! small suns are hit. Each counts by the solid angle that it stands for.

use super::channels::{relative, scales};
use super::compare::is_measurable;
use super::delivered::default_roughnesses;
use crate::geometry::quadrant::Quadrant;
use crate::light::chain::{Chain, Level};
use crate::light::chain_lookup::ChainLookup;
use crate::light::environment::{Layout, Rgb};
use crate::lobe::Lobe;
use crate::lobe::ladder::Ladder;
use glam::DVec3;

/// Directions per roughness. With these, the typical error of default bakes of eight photographed panoramas
/// and of `hdr/` is within a factor of 1.5 of that over 20,000 directions.
const DIRECTIONS: usize = 64;

/// Directions at one roughness at which look-ups are compared with lobes.
#[derive(Clone, Debug)]
pub(crate) struct Probe {
    pub(crate) roughness: f64,
    /// The level of detail that the ladder assigns to it.
    lod: f64,
    pub(crate) directions: Vec<DVec3>,
    /// Solid angle that each direction stands for, up to a factor.
    weights: Vec<f64>,
    /// What errors of each channel are relative to.
    means: [f64; 3],
}

/// Returns the probes of `chain`, lobes of `lobe` by `ladder` over a source in `layout`: at the roughnesses
/// of [`default_roughnesses`] that the source resolves; those of the levels themselves if there are no
/// others.
pub(crate) fn probes(chain: &Chain, ladder: Ladder, lobe: Lobe, source: Layout) -> Vec<Probe> {
    let mut roughnesses = default_roughnesses(chain);
    if roughnesses.is_empty() {
        roughnesses = chain.levels.iter().map(|level| level.roughness).collect();
        // Irradiance has no roughness.
        roughnesses.retain(|roughness| *roughness > 0.0 || !lobe.has_mirror());
    }
    roughnesses.retain(|roughness| is_measurable(&Level::cube(1, *roughness, Vec::new()), lobe, source));
    let (size, levels) = (chain.levels[0].size(), chain.levels.len() as u32);
    let mut lights: Vec<Option<Lights>> = chain.levels.iter().map(|_| None).collect();
    let probe = |roughness: f64| {
        let lod = ladder.lod(roughness, levels, size);
        let at = lod.round() as usize;
        let (level, lights) = (&chain.levels[at], &mut lights[at]);
        let lights = lights.get_or_insert_with(|| Lights::new(level));
        let (directions, weights) = lights.directions(level.layout);
        Probe { roughness, lod, directions, weights, means: lights.means }
    };
    roughnesses.into_iter().map(probe).collect()
}

impl Probe {
    /// Root mean square error of look-ups against `lobes`, the radiance along the directions, relative to the
    /// mean: of the worst channel.
    pub(crate) fn error(&self, lookup: &ChainLookup<'_>, lobes: impl Iterator<Item = Rgb>) -> f64 {
        let mut squares = [0.0; 3];
        for ((direction, weight), lobe) in self.directions.iter().zip(&self.weights).zip(lobes) {
            let read = lookup.read(*direction, self.lod);
            for c in 0..3 {
                squares[c] += weight * (read[c] - f64::from(lobe[c])).powi(2);
            }
        }
        let whole: f64 = self.weights.iter().sum();
        let error = |c: usize| relative((squares[c] / whole).sqrt(), self.means[c]);
        (0..3).map(error).fold(0.0, f64::max)
    }
}

/// Median of `errors`; `None` if there are none.
pub(crate) fn median(mut errors: Vec<f64>) -> Option<f64> {
    let middle = errors.len() / 2;
    (!errors.is_empty()).then(|| *errors.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The distribution of a level's light, to draw directions from.
struct Lights {
    /// Solid angle of each texel of an image.
    solid_angles: Vec<f64>,
    /// Shares of the directions, summed up to each texel.
    sums: Vec<f64>,
    means: [f64; 3],
}

impl Lights {
    fn new(level: &Level) -> Self {
        let (width, height) = level.layout.sides();
        // The same on every face.
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let solid_angles: Vec<f64> = match level.layout {
            Layout::Cube { size } => {
                let quadrant = Quadrant::new(size, |x, y| level.layout.texel_solid_angle(x, y));
                places.map(|(x, y)| quadrant.at(x, y)).collect()
            }
            layout => places.map(|(x, y)| layout.texel_solid_angle(x, y)).collect(),
        };
        let weighted = || level.texels.iter().zip(solid_angles.iter().cycle());
        let (mut sums, mut whole) = ([0.0; 3], 0.0);
        for (texel, weight) in weighted() {
            whole += weight;
            sums = std::array::from_fn(|c| sums[c] + weight * f64::from(texel[c]));
        }
        let [_, red, green, blue] = scales(sums);
        let means = [red, green, blue].map(|sum| sum / whole);
        // Of the channel that is brightest, over its mean.
        let per_mean = means.map(|mean| 1.0 / mean.max(f64::MIN_POSITIVE));
        let light = |texel: &Rgb| (0..3).map(|c| f64::from(texel[c]) * per_mean[c]).fold(0.0, f64::max);
        let all: f64 = weighted().map(|(texel, weight)| weight * light(texel)).sum();
        let (per_whole, per_all) = (1.0 / whole, if all > 0.0 { 1.0 / all } else { 0.0 });
        let mut sum = 0.0;
        let summed = weighted().map(|(texel, weight)| {
            sum += weight * light(texel).mul_add(per_all, per_whole);
            sum
        });
        let sums = summed.collect();
        Self { solid_angles, sums, means }
    }

    /// Directions at equal steps of the distribution, and their weights.
    fn directions(&self, layout: Layout) -> (Vec<DVec3>, Vec<f64>) {
        let Self { solid_angles, sums, .. } = self;
        let total = sums.last().copied().unwrap_or_default();
        let of = |k: usize| {
            let place = (k as f64 + 0.5) / DIRECTIONS as f64 * total;
            let at = sums.partition_point(|sum| *sum < place).min(sums.len() - 1);
            let share = sums[at] - at.checked_sub(1).map_or(0.0, |before| sums[before]);
            let (image, i, j) = layout.place(at);
            // A plane sequence of low discrepancy (Roberts 2018): any place within the texel.
            let fraction = |step: f64| (0.5 + step * k as f64).fract();
            let x = f64::from(i) + fraction(0.754_877_666_246_693);
            let y = f64::from(j) + fraction(0.569_840_290_998_053);
            let (direction, _) = layout.direction_within(image, x, y);
            (direction, solid_angles[at % solid_angles.len()] / share)
        };
        (0..DIRECTIONS).map(of).unzip()
    }
}
