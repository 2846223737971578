//! Extraction of suns: parts an environment into lamps, which directional lights replace, and the rest.

use crate::analysis::delivered::even_directions;
use crate::analysis::sun::{Brightest, Peak, SUN_CONTRAST, SUN_SOLID_ANGLE, Sun, disc_radius, largest};
use crate::common::direction::units;
use crate::common::error::Result;
use crate::common::parallel;
use crate::light::environment::{Environment, Layout, Rgb, exact_luminance};
use crate::light::sh::scale::{ShScale, scaled};
use crate::light::sh::{MAX_ORDER, basis, spherical_harmonics};
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

/// Greatest number of lamps.
pub const MAX_LAMPS: usize = 32;

/// Largest change of the irradiance on any surface by all lamps together, as a share of the greatest
/// irradiance, in any channel. Below the promised 1 %, because the normals are sampled.
const IRRADIANCE_CHANGE: f64 = 0.0095;

/// A light chosen by its direction is at most this far from it.
const TOWARDS_DEGREES: f64 = 10.0;

/// Least share of the light for the strongest lamps.
const MIN_SHARE: f64 = 1e-3;

/// Least share of the light of a region that is mentioned because it stays.
const MENTIONED_SHARE: f64 = 0.01;

/// Greatest number of peaks that are examined, and near a direction.
const MAX_PEAKS: usize = 256;
const MAX_PEAKS_TOWARDS: usize = 64;

/// A glow that stays is mentioned from this share of its lamp on.
const MENTIONED_GLOW: f64 = 0.1;

/// Approximate number of rim texels averaged for a replaced texel; more cost time without a smoother result.
const RIM: usize = 512;

/// Normals over the sphere, and around a lamp's horizon, at which a lamp is compared with what it replaces.
const NORMALS: usize = 512;
const HORIZON_TURNS: usize = 48;
const HORIZON_STEPS: i32 = 8;

/// The lights to extract.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Suns {
    /// The brightest one, by the radiance of its brightest texel.
    #[default]
    Brightest,
    /// This many, from the greatest irradiance on.
    Strongest(usize),
    /// One near each of these directions of the world, of any length but zero.
    Towards(Vec<DVec3>),
}

/// A lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    /// Its irradiance and direction are those of the removed radiance: the region's radiance minus its
    /// replacement. Its solid angle and texels are those that changed.
    pub sun: Sun,
    /// Its share of the environment's energy, by luminance.
    pub energy_share: f64,
    /// The share of its glow that stays, because the whole would cover too much.
    pub glow_share: f64,
}

/// A light that was not extracted.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// Its region, see [`Sun`].
    pub region: Sun,
    /// Its share of the environment's energy, by luminance.
    pub energy_share: f64,
    /// Why it was not extracted.
    pub why: Why,
}

/// Why a light was not extracted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Why {
    /// It covers too much.
    Large,
    /// It reaches too far for what it covers.
    Long,
    /// It is not bright enough.
    Dim,
    /// A lamp in its place would change the irradiance by this share of the greatest irradiance.
    Spread(f64),
}

/// An environment split into lamps and the rest.
#[derive(Clone, Debug)]
pub struct Extraction {
    /// The extracted lamps, in the order in which they were asked for.
    pub lamps: Vec<Lamp>,
    /// Lights that one might expect among them.
    pub kept: Vec<Kept>,
    /// Directions asked for without a light near them.
    pub dark: Vec<DVec3>,
    /// The environment without the lamps.
    pub sunless: Environment,
    /// The number asked for.
    asked: usize,
}

/// Splits `environment` into the lamps that `suns` selects and the rest; their energies add up to its own.
///
/// A light is a peak with the region of [`Sun`] and its glow, which is connected to it: texels of at least
/// eight times the surroundings' luminance and a thousandth of the peak's, near the peak, from the brightest
/// on until the whole covers what a sun may, and a margin of one texel, as far as it fits, for blurred edges
/// and compression ringing. The texels are replaced by the mean of the texels around the region, weighted by
/// the inverse squared distance, which in a disc is the harmonic (smoothest) continuation of its rim. No
/// channel becomes brighter than it was.
///
/// A light of [`Brightest::Region`] stays, and so does one that a lamp cannot replace: in every channel all
/// lamps together change the irradiance on no surface by more than a hundredth of the greatest irradiance.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for a direction that is zero or not finite.
pub fn extract(environment: &Environment, suns: &Suns) -> Result<Extraction> {
    let mut parting = Parting::new(environment);
    let (mut dark, mut asked) = (Vec::new(), 1);
    match suns {
        Suns::Brightest => {
            let brightest = Peak::brightest(environment).filter(Peak::stands_out);
            let light = brightest.map(|peak| parting.light(peak));
            light.into_iter().for_each(|light| parting.take(&light));
        }
        Suns::Strongest(count) => {
            asked = *count;
            let (suns, others): (Vec<Light>, Vec<Light>) =
                parting.strongest(*count).into_iter().partition(|light| light.region.kind == Brightest::Sun);
            for light in &suns {
                if parting.lamps.len() < *count {
                    parting.take(light);
                }
            }
            let lacks = parting.lamps.len() < *count;
            let least = parting.lamps.iter().map(|lamp| lamp.energy_share).fold(1.0, f64::min);
            for light in &others {
                if parting.share(&light.region) >= if lacks { MENTIONED_SHARE } else { least } {
                    parting.take(light);
                }
            }
        }
        Suns::Towards(directions) => {
            asked = directions.len();
            for direction in units(directions)? {
                match parting.towards(direction) {
                    Some(light) => parting.take(&light),
                    None => dark.push(direction),
                }
            }
        }
    }
    let Parting { lamps, kept, rest, .. } = parting;
    Ok(Extraction { lamps, kept, dark, sunless: environment.with_texels(rest), asked })
}

/// A peak and its region.
struct Light {
    peak: Peak,
    region: Sun,
}

/// An environment while lamps are extracted.
struct Parting<'a> {
    environment: &'a Environment,
    grid: Layout,
    luminances: Vec<f64>,
    energy: f64,
    /// Greatest irradiance of each channel.
    greatest: [f64; 3],
    /// Sum of the lamps' changes of the irradiance.
    change: [f64; 3],
    rest: Vec<Rgb>,
    lamps: Vec<Lamp>,
    kept: Vec<Kept>,
    /// Texels of the regions of all lights taken or kept.
    known: HashSet<usize>,
}

impl<'a> Parting<'a> {
    fn new(environment: &'a Environment) -> Self {
        let grid = environment.layout();
        let texels = environment.texels();
        let luminances = parallel::values(texels.len(), |index| exact_luminance(texels[index]));
        let energy = (0..luminances.len()).map(|at| grid.solid_angle_at(at) * luminances[at]).sum();
        let irradiance =
            scaled(&spherical_harmonics(environment, MAX_ORDER).expect("the highest"), ShScale::Irradiance);
        let mut greatest = [0.0; 3];
        for normal in even_directions(4 * NORMALS) {
            let basis = basis(normal);
            for (c, greatest) in greatest.iter_mut().enumerate() {
                let sum: f64 = basis.iter().zip(&irradiance).map(|(value, rgb)| value * rgb[c]).sum();
                *greatest = sum.max(*greatest);
            }
        }
        Self {
            environment,
            grid,
            luminances,
            energy,
            greatest,
            change: [0.0; 3],
            rest: environment.texels().to_vec(),
            lamps: Vec::new(),
            kept: Vec::new(),
            known: HashSet::new(),
        }
    }

    fn light(&self, peak: Peak) -> Light {
        Light { peak, region: Sun::at(self.environment, &peak) }
    }

    fn share(&self, sun: &Sun) -> f64 {
        if self.energy > 0.0 { exact_luminance(sun.irradiance) / self.energy } else { 0.0 }
    }

    /// The lights at the peaks among the texels `order`, which begins with the brightest one. Stops when
    /// `enough`, which is called with a peak's luminance and the lights so far, and after `most` peaks.
    fn lights(&self, order: &[usize], most: usize, enough: impl Fn(f64, &[Light]) -> bool) -> Vec<Light> {
        let mut owned = vec![false; self.luminances.len()];
        let (mut lights, mut peaks) = (Vec::new(), 0);
        for &at in order {
            let luminance = self.luminances[at];
            if enough(luminance, &lights) || peaks == most {
                break;
            }
            // The flank of a light that is known, or whose peak is not among these texels.
            let is_flank = |next: usize| owned[next] || self.luminances[next] > luminance;
            if owned[at] || self.grid.around(at).into_iter().any(is_flank) {
                owned[at] = true;
                continue;
            }
            peaks += 1;
            let peak = Peak::at(self.environment, at);
            let is_new = |at: usize| !owned[at] && self.luminances[at] >= peak.edge();
            let mut texels = self.grid.region(at, is_new);
            if peak.stands_out() {
                texels.extend(self.texels_of(&peak).0);
                lights.push(self.light(peak));
            }
            texels.into_iter().for_each(|at| owned[at] = true);
        }
        lights
    }

    /// Suns and area lights, from the greatest irradiance on: all that can be among the `count` strongest.
    fn strongest(&self, count: usize) -> Vec<Light> {
        let strength = |light: &Light| exact_luminance(light.region.irradiance);
        let largest = largest(self.environment.layout());
        let least = MIN_SHARE * self.energy;
        let mut order: Vec<usize> =
            (0..self.luminances.len()).filter(|at| self.luminances[*at] * largest >= least).collect();
        order.par_sort_unstable_by_key(|at| (Reverse(self.luminances[*at].to_bits()), *at));
        let enough = |luminance: f64, lights: &[Light]| {
            let stronger = |light: &&Light| {
                light.region.kind == Brightest::Sun && strength(light) >= luminance * largest
            };
            lights.iter().filter(stronger).count() >= count
        };
        let mut lights = self.lights(&order, MAX_PEAKS, enough);
        lights.retain(|light| {
            light.peak.luminance >= SUN_CONTRAST * light.peak.surroundings && strength(light) >= least
        });
        lights.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
        lights
    }

    /// The sun nearest to `direction`, else the nearest other light.
    fn towards(&self, direction: DVec3) -> Option<Light> {
        let towards = self.environment.source_from_world() * direction;
        let nearest = TOWARDS_DEGREES.to_radians().cos();
        let mut order: Vec<usize> = (0..self.luminances.len())
            .filter(|at| self.luminances[*at] > 0.0 && self.grid.direction_at(*at).dot(towards) >= nearest)
            .collect();
        order.sort_unstable_by_key(|at| (Reverse(self.luminances[*at].to_bits()), *at));
        // Peaks so near to each other have similar surroundings: what is this dim is no sun.
        let enough = |luminance: f64, lights: &[Light]| {
            lights.iter().any(|light| luminance < 0.1 * SUN_CONTRAST * light.peak.surroundings)
        };
        let taken = |light: &Light| self.rest[light.peak.at] != self.environment.texels()[light.peak.at];
        let mut lights = self.lights(&order, MAX_PEAKS_TOWARDS, enough);
        lights.retain(|light| !taken(light));
        lights.into_iter().min_by(|a, b| {
            let rank = |light: &Light| {
                (light.region.kind != Brightest::Sun, light.region.direction.angle_between(direction))
            };
            let ((a_kind, a), (b_kind, b)) = (rank(a), rank(b));
            a_kind.cmp(&b_kind).then(a.total_cmp(&b))
        })
    }

    /// The texels of the light at `peak` in order: its region and its glow, without the margin. And the
    /// energy of the glow that exceeds what a sun may cover.
    fn texels_of(&self, peak: &Peak) -> (Vec<usize>, f64) {
        let (edge, glow, luminances) = (peak.edge(), peak.glow(), &self.luminances);
        let largest = largest(self.environment.layout());
        let middle = self.grid.direction_at(peak.at);
        let [near, far] = [1.0, 2.0].map(|times| (times * disc_radius(largest)).cos());
        // Beyond the light's own radius, its glow does not climb to another light.
        let belongs = |at: usize| {
            let (luminance, cosine) = (luminances[at], self.grid.direction_at(at).dot(middle));
            let is_glow = luminance > glow && cosine > far && (luminance < edge || cosine > near);
            luminance <= peak.luminance && is_glow
        };
        let mut seen = HashSet::from([peak.at]);
        let mut heap = BinaryHeap::from([(peak.luminance.to_bits(), peak.at)]);
        let (mut texels, mut solid_angle, mut beyond) = (Vec::new(), 0.0, 0.0);
        while let Some((_, at)) = heap.pop() {
            solid_angle += self.grid.solid_angle_at(at);
            if solid_angle <= largest || at == peak.at {
                texels.push(at);
            } else {
                beyond += self.grid.solid_angle_at(at) * luminances[at];
            }
            for next in self.grid.around(at) {
                if (luminances[next] >= edge || belongs(next)) && seen.insert(next) {
                    heap.push((luminances[next].to_bits(), next));
                }
            }
        }
        texels.sort_unstable();
        (texels, beyond)
    }

    /// Replaces `light` by a lamp, or keeps it with the reason.
    fn take(&mut self, light: &Light) {
        let Light { peak, region } = light;
        let texels = peak.region(self.environment);
        let is_known = texels.iter().any(|at| self.known.contains(at));
        self.known.extend(texels);
        let why = match region.kind {
            Brightest::Sun => match self.replaced(peak) {
                Ok(()) => return,
                Err(change) => Why::Spread(change),
            },
            Brightest::Region if peak.luminance < SUN_CONTRAST * peak.surroundings => Why::Dim,
            Brightest::Region if region.solid_angle <= largest(self.environment.layout()) => Why::Long,
            Brightest::Region => Why::Large,
        };
        // What surrounds a light that is known is the same light.
        if !is_known {
            self.kept.push(Kept { region: region.clone(), energy_share: self.share(region), why });
        }
    }

    /// Replaces the light at `peak` by a lamp; else returns how much that would change the irradiance.
    fn replaced(&mut self, peak: &Peak) -> Result<(), f64> {
        let (texels, beyond) = self.texels_of(peak);
        let texels = self.with_margin(texels);
        let replacements = self.continued(&texels);
        let rest = |k: usize| -> [f64; 3] {
            std::array::from_fn(|c| f64::from(self.rest[texels[k]][c]) - f64::from(replacements[k][c]))
        };
        let removed: Vec<(usize, [f64; 3])> = (0..texels.len())
            .filter(|k| self.rest[texels[*k]] != replacements[*k])
            .map(|k| (texels[k], rest(k)))
            .collect();
        let changed: Vec<usize> = removed.iter().map(|(at, _)| *at).collect();
        let radiance = |at: usize| removed[changed.binary_search(&at).expect("one of them")].1;
        let sun = Sun::over(self.environment, peak, &changed, radiance);
        let change = self.change_by(&removed, &sun);
        let total: [f64; 3] = std::array::from_fn(|c| self.change[c] + change[c]);
        let worst = total.into_iter().fold(0.0, f64::max);
        if worst > IRRADIANCE_CHANGE || exact_luminance(sun.irradiance) <= 0.0 {
            return Err(worst);
        }
        self.change = total;
        for (at, replacement) in texels.into_iter().zip(replacements) {
            self.rest[at] = replacement;
        }
        // The glow and the margin do not change the kind.
        let sun = Sun { kind: Brightest::Sun, ..sun };
        let energy_share = self.share(&sun);
        self.lamps.push(Lamp { sun, energy_share, glow_share: beyond / self.energy });
        Ok(())
    }

    /// Adds the brightest texels around `texels`, which are sorted, as far as a sun may reach.
    fn with_margin(&self, mut texels: Vec<usize>) -> Vec<usize> {
        let largest = largest(self.environment.layout());
        let mut solid_angle: f64 = texels.iter().map(|at| self.grid.solid_angle_at(*at)).sum();
        let mut rim = self.grid.rim(&texels);
        rim.sort_by_key(|at| (Reverse(self.luminances[*at].to_bits()), *at));
        texels.extend(rim.into_iter().take_while(|at| {
            solid_angle += self.grid.solid_angle_at(*at);
            solid_angle <= largest
        }));
        texels.sort_unstable();
        texels
    }

    /// What the texels around `texels`, which are sorted, continue into them.
    fn continued(&self, texels: &[usize]) -> Vec<Rgb> {
        let rim = self.grid.rim(texels);
        let rim: Vec<(DVec3, f64, Rgb)> = rim
            .iter()
            .step_by(rim.len().div_ceil(RIM).max(1))
            .map(|&at| (self.grid.direction_at(at), self.grid.solid_angle_at(at), self.rest[at]))
            .collect();
        let continued = |index: usize| {
            let at = texels[index];
            let direction = self.grid.direction_at(at);
            let (mut sum, mut total) = (DVec3::ZERO, f64::MIN_POSITIVE);
            for (place, solid_angle, radiance) in &rim {
                let weight = solid_angle / place.distance_squared(direction);
                total += weight;
                sum += weight * DVec3::from(radiance.map(f64::from));
            }
            std::array::from_fn(|c| self.rest[at][c].min((sum[c] / total) as f32))
        };
        parallel::values(texels.len(), continued)
    }

    /// Greatest change of the irradiance when `sun` replaces the radiance `removed` from texels, as a share
    /// of the greatest irradiance of each channel.
    fn change_by(&self, removed: &[(usize, [f64; 3])], sun: &Sun) -> [f64; 3] {
        let direction = self.environment.source_from_world() * sun.direction;
        // A texel is a square; the mean of its cosines is that of four points, wherever a horizon cuts it.
        let points: Vec<(DVec3, [f64; 3])> = removed
            .iter()
            .flat_map(|(at, radiance)| {
                let (middle, solid_angle) = (self.grid.direction_at(*at), self.grid.solid_angle_at(*at));
                let (u, v) = middle.any_orthonormal_pair();
                let quarter = solid_angle.sqrt() / 4.0;
                [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| {
                    let point = (middle + quarter * (x * u + y * v)).normalize();
                    (point, radiance.map(|value| value * solid_angle / 4.0))
                })
            })
            .collect();
        let spread = points.iter().map(|(point, _)| point.angle_between(direction)).fold(0.0, f64::max);
        let (u, v) = direction.any_orthonormal_pair();
        let horizon = (0..HORIZON_TURNS).flat_map(|turn| {
            let (sin, cos) = (TAU * turn as f64 / HORIZON_TURNS as f64).sin_cos();
            let across = cos * u + sin * v;
            (-HORIZON_STEPS..=HORIZON_STEPS).map(move |step| {
                let (sin, cos) = (FRAC_PI_2 + spread * f64::from(step) / f64::from(HORIZON_STEPS)).sin_cos();
                cos * direction + sin * across
            })
        });
        let normals: Vec<DVec3> = even_directions(NORMALS).into_iter().chain(horizon).collect();
        let change = |normal: &DVec3| {
            let cosine = normal.dot(direction).max(0.0);
            let mut change = sun.irradiance.map(|value| -value * cosine);
            for (point, energy) in &points {
                let cosine = normal.dot(*point).max(0.0);
                (0..3).for_each(|c| change[c] += cosine * energy[c]);
            }
            change.map(f64::abs)
        };
        let most = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|c| a[c].max(b[c]));
        let worst = parallel::map(&normals, change).into_iter().fold([0.0; 3], most);
        std::array::from_fn(|c| if worst[c] > 0.0 { worst[c] / self.greatest[c] } else { 0.0 })
    }
}

impl Suns {
    /// Parses `brightest`, a number of lights, or directions separated by colons: two numbers are an azimuth
    /// and an elevation in degrees as in [`Sun`], three a vector.
    ///
    /// # Errors
    /// What is needed.
    pub fn parsed(text: &str) -> Result<Self, String> {
        const NEEDED: &str = "a number of lights from 1 to 32, or directions separated by colons, each an \
                              azimuth and an elevation in degrees (135,35) or a vector (-0.58,0.57,0.58), \
                              is needed";
        let text = text.trim();
        if text == Self::Brightest.to_string() {
            return Ok(Self::Brightest);
        }
        if let Ok(count) = text.parse::<usize>() {
            return match count {
                1..=MAX_LAMPS => Ok(Self::Strongest(count)),
                _ => Err(NEEDED.to_owned()),
            };
        }
        let direction = |text: &str| -> Option<DVec3> {
            let numbers: Option<Vec<f64>> = text
                .split(',')
                .map(|number| number.trim().parse().ok().filter(|n: &f64| n.is_finite()))
                .collect();
            match numbers?[..] {
                [azimuth, elevation] if elevation.abs() <= 90.0 => {
                    let (sin, cos) = azimuth.to_radians().sin_cos();
                    let (height, width) = elevation.to_radians().sin_cos();
                    Some(DVec3::new(width * cos, height, width * sin))
                }
                [x, y, z] => {
                    let vector = DVec3::new(x, y, z);
                    (vector / vector.abs().max_element()).try_normalize()
                }
                _ => None,
            }
        };
        let directions: Option<Vec<DVec3>> = text.split(':').map(direction).collect();
        match directions {
            Some(directions) if directions.len() <= MAX_LAMPS => Ok(Self::Towards(directions)),
            _ => Err(NEEDED.to_owned()),
        }
    }
}

impl fmt::Display for Suns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Brightest => f.write_str("brightest"),
            Self::Strongest(count) => write!(f, "{count}"),
            Self::Towards(directions) => {
                let texts: Vec<String> =
                    directions.iter().map(|d| format!("{},{},{}", d.x, d.y, d.z)).collect();
                f.write_str(&texts.join(":"))
            }
        }
    }
}

/// Direction, share and size of a light.
fn described(sun: &Sun, energy_share: f64) -> String {
    // Without a negative 0.
    let rounded = |value: f64, digits: f64| (value * digits).round() / digits + 0.0;
    let [x, y, z] = sun.direction.to_array().map(|value| rounded(value, 1e4));
    format!(
        "azimuth {:.1}, elevation {:.1} ({x:.4} {y:.4} {z:.4}), {:.2} % of the light, {:.2e} sr ({:.1} \
         degrees across)",
        rounded(sun.azimuth_degrees(), 10.0),
        rounded(sun.elevation_degrees(), 10.0),
        100.0 * energy_share,
        sun.solid_angle,
        sun.diameter_degrees(),
    )
}

impl Extraction {
    /// What was extracted, one line for each lamp.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let note = |lamp: &Lamp| format!("removed a sun: {}", described(&lamp.sun, lamp.energy_share));
        self.lamps.iter().map(note).collect()
    }

    /// What was not extracted, and why.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        const MENTIONED: usize = 3;
        let lacking = match self.lamps.len() {
            0 => Some("no sun detected, so none was removed".to_owned()),
            found if found < self.asked => Some(format!("{found} of {} suns found and removed", self.asked)),
            _ => None,
        };
        let mut warnings: Vec<String> = lacking.into_iter().collect();
        let dark = |direction: &DVec3| {
            let [x, y, z] = direction.to_array();
            format!("no light stands out within {TOWARDS_DEGREES} degrees of {x:.4} {y:.4} {z:.4}")
        };
        warnings.extend(self.dark.iter().map(dark));
        warnings.extend(self.kept.iter().take(MENTIONED).map(|kept| {
            let why = match kept.why {
                Why::Large => {
                    format!("a sun covers at most {SUN_SOLID_ANGLE} sr, or nine texels up to 0.2 sr")
                }
                Why::Long => "it reaches further from its centre than a sun of 0.01 sr".to_owned(),
                Why::Dim => format!(
                    "it is {:.0} times as bright as its surroundings, and a sun is at least {SUN_CONTRAST}",
                    f64::from(crate::light::environment::luminance(kept.region.peak))
                        / kept.region.surroundings
                ),
                Why::Spread(change) => format!(
                    "with a lamp in its place the irradiance would change by {:.1} %, and 1 % is allowed",
                    100.0 * change
                ),
            };
            format!("a light stays: {}; {why}", described(&kept.region, kept.energy_share))
        }));
        if self.kept.len() > MENTIONED {
            warnings.push(format!("and {} more", self.kept.len() - MENTIONED));
        }
        let glowing = |lamp: &&Lamp| lamp.glow_share > MENTIONED_GLOW * lamp.energy_share;
        warnings.extend(self.lamps.iter().filter(glowing).map(|lamp| {
            format!(
                "glow around the sun at azimuth {:.1}, elevation {:.1} stays, {:.2} % of the light: a sun \
                 covers at most {SUN_SOLID_ANGLE} sr",
                lamp.sun.azimuth_degrees(),
                lamp.sun.elevation_degrees(),
                100.0 * lamp.glow_share,
            )
        }));
        warnings
    }
}
