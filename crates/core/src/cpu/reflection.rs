//! The true reflection by adaptive quadrature, with a certified bound of the error.
//!
//! For a view v the BRDF times n.l is a function of the light's direction l in a few linear forms and two
//! norms. With w = l + v, |w|^2 = 2 (1 + v.l) for unit l, and A, G the forms of the distribution and of the
//! masking in the axes of the surface:
//!
//! ```text
//! f(l) = 2 (1 + v.l)^2 / (pi a_t a_b |w|_A^4)  (n.l) / (n.l |v|_G + n.v |l|_G)  F
//! F    = f0 + (1 - f0) (1 - sqrt((1 + v.l) / 2))^5
//! |w|_A^2 = (w.t / a_t)^2 + (w.b / a_b)^2 + (w.n)^2,   |l|_G^2 = (a_t l.t)^2 + (a_b l.b)^2 + (l.n)^2
//! ```
//!
//! (Heitz 2014; Walter et al. 2007; `KHR_materials_anisotropy` for a_t, a_b.) So written, f is smooth in a
//! ball of space, also off the sphere. The light of a cell has its centroid m, of each channel, in a ball
//! that holds the cell: the first-order term of the mean of f vanishes there, and f(m) is off by at most half
//! of the trace of the light's covariance times the greatest second derivative over the ball, which ranges
//! bound (`crates/core/src/cpu/range.rs`). Where the ball crosses the horizon, by the range of values.
//!
//! Cells whose bound, relative to the channel's mean, exceeds the tolerance are split: into their four
//! quarters, their texels, and the texels' own quarters. Texels are constant over their solid angles.

use super::cells::DIMMEST;
use super::range::Range;
use crate::common::frame::Frame;
use crate::cpu::reflector::source_oem_size;
use crate::geometry::exact::patch::{Patch, Sample, finest_rule};
use crate::geometry::exact::{ExactTexels, cube_texel, for_each_octahedral_piece, panorama_texel};
use crate::light::environment::{Environment, Layout, Rgb, exact_luminance};
use crate::lobe::filter::{Answer, Bound};
use crate::pyramid::albedo::albedo_at;
use crate::pyramid::brdf::alphas;
use crate::sphere::octahedral::oct_from_direction;
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::f64::consts::PI;

/// Most cells along an edge of the finest level.
const MAX_WIDTH: u32 = 512;

/// A cell's greatest bound, over tolerance times mean radiance. Cells are off by a tenth of their bounds,
/// with either sign, and sums by less than a hundredth. Lobes whose alphas' ratio is beyond [`LONG`] have
/// more cells, which along the ridge are all off with one sign: bounds are less in proportion.
const SHARE: f64 = 0.03;
const LONG: f64 = 4.0;

/// Levels of splitting within a texel, at most.
const DEPTH: u32 = 20;

/// Least roughness that is reflected: lobes are two hundredths of a degree wide.
pub const LEAST_ROUGHNESS: f64 = 0.01;

/// Rounding of sums in double precision, and of the answer to single precision.
const ROUNDING: f64 = 2e-7;

/// Light: energy, centroid and trace of the covariance of each channel, within a ball.
#[derive(Clone, Copy, Debug, Default)]
struct Light {
    centre: DVec3,
    radius: f64,
    energy: [f64; 3],
    mean: [DVec3; 3],
    spread: [f64; 3],
}

impl Light {
    /// Light of one `radiance` from an area.
    fn uniform(centre: DVec3, radius: f64, radiance: Rgb, (area, mean, spread): (f64, DVec3, f64)) -> Self {
        let energy = radiance.map(|channel| f64::from(channel) * area);
        Self { centre, radius, energy, mean: [mean; 3], spread: [spread; 3] }
    }

    /// All of `parts`.
    fn merged(parts: &[Self]) -> Self {
        let parts = || parts.iter().filter(|part| part.energy != [0.0; 3]);
        let mut union = Self::default();
        let middle: DVec3 = parts().map(|part| part.centre).sum();
        union.centre = middle.try_normalize().unwrap_or(DVec3::Y);
        for part in parts() {
            union.radius = union.radius.max(part.centre.distance(union.centre) + part.radius);
            for c in 0..3 {
                union.energy[c] += part.energy[c];
                union.mean[c] += part.energy[c] * part.mean[c];
            }
        }
        for c in 0..3 {
            union.mean[c] /= union.energy[c].max(f64::MIN_POSITIVE);
        }
        for part in parts() {
            for c in 0..3 {
                let apart = part.mean[c].distance_squared(union.mean[c]);
                union.spread[c] +=
                    part.energy[c] * (part.spread[c] + apart) / union.energy[c].max(f64::MIN_POSITIVE);
            }
        }
        union
    }
}

/// The light of an environment as a quadtree over its octahedral square, down to texels.
#[derive(Debug)]
pub struct ReflectedLight<'a> {
    environment: Cow<'a, Environment>,
    texels: ExactTexels,
    /// Levels from the root to the finest.
    levels: Vec<Vec<Light>>,
    /// First texel of each finest cell in `members`, and their number.
    starts: Vec<u32>,
    members: Vec<u32>,
    /// What errors of each channel are relative to.
    means: [f64; 3],
}

impl<'a> ReflectedLight<'a> {
    /// The light of `environment`.
    pub fn new(environment: &'a Environment) -> Self {
        Self::over(Cow::Borrowed(environment))
    }

    /// The light of `environment`, which it keeps.
    pub fn owning(environment: Environment) -> ReflectedLight<'static> {
        ReflectedLight::over(Cow::Owned(environment))
    }

    fn over(environment: Cow<'a, Environment>) -> Self {
        let (layout, texels) = (environment.layout(), ExactTexels::new(environment.layout()));
        let width = source_oem_size(layout).next_power_of_two().clamp(2, MAX_WIDTH);
        let count = layout.texel_count();
        let mut light = Self {
            environment,
            texels,
            levels: Vec::new(),
            starts: vec![0; width as usize * width as usize + 1],
            members: Vec::new(),
            means: [0.0; 3],
        };
        let lit: Vec<(u32, u32)> = (0..count)
            .filter(|index| light.environment.texels()[*index] != [0.0; 3])
            .map(|index| (cell_of(light.texel(index).mean[0], width), index as u32))
            .collect();
        for (cell, _) in &lit {
            light.starts[*cell as usize + 1] += 1;
        }
        for cell in 1..light.starts.len() {
            light.starts[cell] += light.starts[cell - 1];
        }
        let mut next = light.starts.clone();
        light.members = vec![0; lit.len()];
        for (cell, index) in lit {
            light.members[next[cell as usize] as usize] = index;
            next[cell as usize] += 1;
        }
        let finest = (0..width * width).map(|cell| {
            let texels: Vec<Light> = light.in_cell(cell).iter().map(|k| light.texel(*k as usize)).collect();
            Light::merged(&texels)
        });
        let mut levels = vec![finest.collect::<Vec<_>>()];
        let mut side = width;
        while side > 1 {
            let (below, half) = (levels.last().expect("the finest"), side / 2);
            let cell = |k: u32| {
                let (i, j) = (2 * (k % half), 2 * (k / half));
                let at = |i: u32, j: u32| below[(j * side + i) as usize];
                Light::merged(&[at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)])
            };
            levels.push((0..half * half).map(cell).collect());
            side = half;
        }
        levels.reverse();
        let means = levels[0][0].energy.map(|energy| energy / (4.0 * PI));
        let floor = exact_luminance(means) / DIMMEST;
        light.means = means.map(|mean| mean.max(floor).max(f64::MIN_POSITIVE));
        light.levels = levels;
        light
    }

    fn in_cell(&self, cell: u32) -> &[u32] {
        &self.members[self.starts[cell as usize] as usize..self.starts[cell as usize + 1] as usize]
    }

    /// Block and frame of texel `index`.
    fn place(&self, index: usize) -> (usize, usize) {
        let (blocks, frames) = (self.texels.blocks().len(), self.texels.frames().len());
        match self.environment.layout() {
            Layout::Panorama { .. } => (index / frames, index % frames),
            _ => (index % blocks, index / blocks),
        }
    }

    /// The light of texel `index`.
    fn texel(&self, index: usize) -> Light {
        let (block, frame) = self.place(index);
        let texel = &self.texels.blocks()[block];
        let back = self.texels.frames()[frame].transpose();
        let trace = texel.covariance.x_axis.x + texel.covariance.y_axis.y + texel.covariance.z_axis.z;
        let moments = (texel.solid_angle, back * texel.mean, trace);
        Light::uniform(back * texel.centre, texel.radius, self.environment.texels()[index], moments)
    }

    /// Radiance that a surface of `roughness` from [`LEAST_ROUGHNESS`] to 1, `anisotropy` in [0, 1] and
    /// reflectance `f0` of each channel (1 at grazing incidence) reflects to the viewer of `frame` (in the
    /// world), to a relRMSE of `error`. A frame without a tangent reflects isotropically.
    pub fn reflect(
        &self,
        frame: &Frame,
        roughness: f64,
        anisotropy: f64,
        f0: [f64; 3],
        error: f64,
    ) -> Answer {
        let anisotropy = if frame.has_tangent { anisotropy } else { 0.0 };
        let lobe = Lobe::new(
            self.environment.source_from_world() * frame.axes,
            frame.view,
            roughness,
            anisotropy,
            f0,
        );
        let [scale, bias] = albedo_at(roughness as f32, frame.view.z as f32).map(f64::from);
        let [along, across] = lobe.alpha;
        let share = SHARE * (LONG * across / along).min(1.0);
        let limit = |c: usize| share * error * (f0[c] * scale + bias).max(1e-3) * self.means[c];
        let mut sum = Sum { limits: [0, 1, 2].map(limit), light: [0.0; 3], error: [0.0; 3] };
        self.add_cell(&lobe, 0, 0, &mut sum);
        let radiance = sum.light.map(|light| light as f32);
        let channels: Rgb =
            std::array::from_fn(|c| ((sum.error[c] + ROUNDING * sum.light[c]) as f32).next_up());
        let luminance = exact_luminance(channels.map(f64::from)) as f32;
        Answer { radiance, bound: Some(Bound { channels, luminance: luminance.next_up() }) }
    }

    /// Adds cell `cell` of `level`, or its parts.
    fn add_cell(&self, lobe: &Lobe, level: usize, cell: u32, sum: &mut Sum) {
        if sum.takes(lobe, &self.levels[level][cell as usize]) {
            return;
        }
        if level + 1 < self.levels.len() {
            let side = 1 << level;
            let (i, j) = (2 * (cell % side), 2 * (cell / side));
            for (i, j) in [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)] {
                self.add_cell(lobe, level + 1, j * 2 * side + i, sum);
            }
            return;
        }
        for index in self.in_cell(cell) {
            let index = *index as usize;
            if sum.takes(lobe, &self.texel(index)) {
                continue;
            }
            let (block, frame) = self.place(index);
            let texel = Texel {
                back: self.texels.frames()[frame].transpose(),
                radiance: self.environment.texels()[index],
            };
            match self.environment.layout() {
                Layout::Panorama { width, height } => {
                    texel.add(lobe, &panorama_texel(width, height, block), DEPTH, sum);
                }
                Layout::Cube { size } => texel.add(lobe, &cube_texel(size, block), DEPTH, sum),
                Layout::Octahedral { size } => {
                    for_each_octahedral_piece(size, block, |piece| texel.add(lobe, &piece, DEPTH, sum));
                }
            }
        }
    }
}

/// The cell, of `width` x `width`, that contains `direction`.
fn cell_of(direction: DVec3, width: u32) -> u32 {
    let uv = oct_from_direction(direction);
    let place = |t: f64| (((t + 1.0) * 0.5 * f64::from(width)) as u32).min(width - 1);
    place(uv.y) * width + place(uv.x)
}

/// A texel that is split.
struct Texel {
    /// From its block's own space to the source's.
    back: DMat3,
    radiance: Rgb,
}

impl Texel {
    /// Adds `patch`, in the block's space, or its quarters.
    fn add<P: Patch>(&self, lobe: &Lobe, patch: &P, depth: u32, sum: &mut Sum) {
        let (centre, radius) = patch.cap();
        let (mut area, mut first) = (0.0, DVec3::ZERO);
        patch.sample(finest_rule(), &mut |s: Sample| {
            area += s.weight;
            first += s.point * (s.weight / s.length_squared.sqrt());
        });
        let mean = first / area.max(f64::MIN_POSITIVE);
        // Unit vectors spread by what their mean lacks.
        let spread = (1.0 - mean.length_squared()).clamp(0.0, radius * radius);
        let light =
            Light::uniform(self.back * centre, radius, self.radiance, (area, self.back * mean, spread));
        if depth == 0 {
            sum.add(lobe, &light);
        } else if !sum.takes(lobe, &light) {
            patch.split().iter().for_each(|quarter| self.add(lobe, quarter, depth - 1, sum));
        }
    }
}

/// Light that is reflected, with bounds of its error.
struct Sum {
    /// Greatest bound of a cell.
    limits: [f64; 3],
    light: [f64; 3],
    error: [f64; 3],
}

impl Sum {
    /// Adds `light`, unless a bound exceeds its limit.
    fn takes(&mut self, lobe: &Lobe, light: &Light) -> bool {
        if light.energy == [0.0; 3] {
            return true;
        }
        let Some(ranges) = lobe.ranges(light.centre, light.radius) else { return true };
        let bounds = bounds(&ranges, light);
        // NaN is none.
        if !(0..3).all(|c| bounds[c] <= self.limits[c]) {
            return false;
        }
        self.add_bounded(lobe, light, bounds);
        true
    }

    /// Adds `light`, whatever its bounds.
    fn add(&mut self, lobe: &Lobe, light: &Light) {
        if let Some(ranges) = lobe.ranges(light.centre, light.radius) {
            self.add_bounded(lobe, light, bounds(&ranges, light));
        }
    }

    fn add_bounded(&mut self, lobe: &Lobe, light: &Light, bounds: [f64; 3]) {
        for c in 0..3 {
            if light.energy[c] > 0.0 {
                self.light[c] += light.energy[c] * lobe.at(light.mean[c], c);
                self.error[c] += bounds[c];
            }
        }
    }
}

/// Bounds of the error of the value at the centroid of `light`, for each channel.
fn bounds(ranges: &[Range; 3], light: &Light) -> [f64; 3] {
    std::array::from_fn(|c| {
        let range = &ranges[c];
        // Of infinite derivatives only the values count; NaN is infinite times 0.
        let by_bend = 0.5 * range.bend * light.spread[c];
        let by_values = range.high - range.low;
        light.energy[c] * if by_bend < by_values { by_bend } else { by_values }
    })
}

/// A reflection in the source's space.
struct Lobe {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
    view: DVec3,
    alpha: [f64; 2],
    /// Of each channel.
    f0: [f64; 3],
    /// n.v, and |v|_G.
    cosine: f64,
    masking: f64,
    /// 2 / (pi a_t a_b).
    factor: f64,
}

impl Lobe {
    fn new(axes: DMat3, view: DVec3, roughness: f64, anisotropy: f64, f0: [f64; 3]) -> Self {
        let alpha = alphas(roughness, anisotropy).to_array();
        let DMat3 { x_axis: tangent, y_axis: bitangent, z_axis: normal } = axes;
        Self {
            tangent,
            bitangent,
            normal,
            view: axes * view,
            alpha,
            f0,
            cosine: view.z,
            masking: DVec3::new(alpha[0] * view.x, alpha[1] * view.y, view.z).length(),
            factor: 2.0 / (PI * alpha[0] * alpha[1]),
        }
    }

    /// |`w`|_A.
    fn slope_norm(&self, w: DVec3) -> f64 {
        let [along, across] = self.alpha;
        DVec3::new(w.dot(self.tangent) / along, w.dot(self.bitangent) / across, w.dot(self.normal)).length()
    }

    /// |`l`|_G.
    fn masking_norm(&self, l: DVec3) -> f64 {
        let [along, across] = self.alpha;
        DVec3::new(along * l.dot(self.tangent), across * l.dot(self.bitangent), l.dot(self.normal)).length()
    }

    /// f of `channel` at `light`, a unit vector or a mean of some.
    fn at(&self, light: DVec3, channel: usize) -> f64 {
        let towards = light.dot(self.normal);
        if towards <= 0.0 {
            return 0.0;
        }
        let half = (1.0 + self.view.dot(light)).max(0.0);
        let bend = self.slope_norm(light + self.view).powi(2);
        let masked = towards / (towards * self.masking + self.cosine * self.masking_norm(light));
        let grazing = (1.0 - (0.5 * half).sqrt()).max(0.0).powi(5);
        self.factor * (half / bend).powi(2) * masked * (self.f0[channel] + (1.0 - self.f0[channel]) * grazing)
    }

    /// The range of f over a ball, of each channel; `None` if all of it is below the horizon.
    fn ranges(&self, centre: DVec3, radius: f64) -> Option<[Range; 3]> {
        let height = centre.dot(self.normal);
        if height + radius <= 0.0 {
            return None;
        }
        let half = Range::linear(1.0 + self.view.dot(centre), 1.0, radius);
        let steep = 1.0 / self.alpha[0].min(self.alpha[1]);
        let slopes = Range::norm(self.slope_norm(centre + self.view), steep.max(1.0), radius);
        let distribution = half.times(slopes.squared().inverse()).squared();
        let towards = Range::linear(height, 1.0, radius);
        let masking = Range::norm(self.masking_norm(centre), 1.0, radius);
        let below = towards.scaled(self.masking).plus(masking.scaled(self.cosine));
        let masked = if height > radius {
            towards.times(below.inverse())
        } else {
            // n.l / (n.l |v|_G + n.v |l|_G) rises with n.l, and has a kink at 0.
            let high = towards.high / (towards.high * self.masking + self.cosine * masking.low);
            Range { low: 0.0, high, slope: f64::INFINITY, bend: f64::INFINITY }
        };
        let grazing = half.scaled(0.5).root().complement();
        let grazing = grazing.squared().squared().times(grazing);
        let unreflected = distribution.times(masked).scaled(self.factor);
        let channel = |f0: f64| {
            let fresnel = grazing.scaled(1.0 - f0);
            unreflected.times(Range { low: fresnel.low + f0, high: fresnel.high + f0, ..fresnel })
        };
        let [red, green, blue] = self.f0;
        if red == green && green == blue {
            return Some([channel(red); 3]);
        }
        Some(self.f0.map(channel))
    }
}
