//! Sun detection: finds the region that outshines its surroundings.

use crate::common::names::named;
use crate::light::environment::{Environment, Layout, Rgb, exact_luminance};
use crate::sphere::cube::{Face, texel_around};
use crate::sphere::octahedral;
use glam::DVec3;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// The peak's surroundings start at this angle from it, or at two texels if that is wider.
const SURROUNDINGS_DEGREES: f64 = 10.0;

/// Outer angle of the surroundings over the inner one.
const SURROUNDINGS_REACH: f64 = 3.0;

/// Minimum contrast of a peak to its surroundings; lower contrasts are ordinary sky.
const CONTRAST: f64 = 8.0;

/// Minimum contrast of a sun to its surroundings. Over eight photographed panoramas the lowest contrast of a
/// sun is 170 (in haze, at the horizon); a gap in a canopy of leaves has 50.
pub(super) const SUN_CONTRAST: f64 = 100.0;

/// Maximum solid angle of a sun in steradians, a disc of 6.5 degrees. It includes the glow of lens and haze;
/// the largest sun in those panoramas covers 0.0005 above a tenth of its peak. A window covers 0.5.
pub(super) const SUN_SOLID_ANGLE: f64 = 0.01;

/// Maximum texels of a sun at coarse resolutions: the extent of a resampled point.
const SUN_TEXELS: f64 = 9.0;

/// Maximum solid angle at any resolution: texels wider than this show no sun.
const COARSE_SOLID_ANGLE: f64 = 0.2;

/// A sun's region ends within this many times the radius of a disc of its maximum solid angle; longer ones
/// are tubes and edges of windows.
const REACH: f64 = 2.0;

/// Luminance threshold of the sun's region, as a fraction of the range from surroundings to peak.
const EDGE: f64 = 0.1;

/// Least luminance of a sun's glow, as a fraction of the peak.
const GLOW: f64 = 1e-3;

/// Texels that are visited for the median of the surroundings.
const SELECTION: usize = 1 << 18;

/// The brightest region of an environment.
///
/// It is the region connected to the texel of greatest luminance, over texels that share a side or a corner
/// (also across cube edges, the panorama's seam and its poles), whose luminance is at least a tenth of the
/// way from the surroundings to the peak. The surroundings' luminance is the median between 10 and 30 degrees
/// from the peak (further for coarse texels); a peak below eight times that does not stand out. [`Sun::kind`]
/// classifies the region.
#[derive(Clone, Debug, PartialEq)]
pub struct Sun {
    /// Whether it is a sun or a larger or dimmer region.
    pub kind: Brightest,
    /// Unit direction in the world of the region's energy centroid.
    pub direction: DVec3,
    /// Radiance of its brightest texel.
    pub peak: Rgb,
    /// Radiance integrated over the region: the irradiance on a surface that faces it.
    pub irradiance: [f64; 3],
    /// Solid angle of the region in steradians.
    pub solid_angle: f64,
    /// Number of texels in the region.
    pub texels: usize,
    /// Median luminance of its surroundings.
    pub surroundings: f64,
}

/// Classification of the brightest region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Brightest {
    /// At least 100 times as bright as its surroundings, and at most 0.01 steradians or nine texels: a
    /// directional light can replace it.
    Sun,
    /// Larger or dimmer: a window, an area light, a bright patch of sky.
    Region,
}

named!(Brightest { Sun = "sun", Region = "brightest region" });

/// Maximum solid angle of a sun.
pub(super) fn largest(layout: Layout) -> f64 {
    (SUN_TEXELS * texel_width(layout).powi(2)).clamp(SUN_SOLID_ANGLE, COARSE_SOLID_ANGLE)
}

/// Angular radius of the disc that covers `solid_angle`.
pub(super) fn disc_radius(solid_angle: f64) -> f64 {
    (1.0 - solid_angle / (2.0 * PI)).clamp(-1.0, 1.0).acos()
}

/// A texel that is no darker than its neighbours, and its surroundings.
#[derive(Clone, Copy)]
pub(super) struct Peak {
    pub(super) at: usize,
    pub(super) luminance: f64,
    pub(super) surroundings: f64,
}

impl Peak {
    /// The peak of `environment`; `None` for a black one.
    pub(super) fn brightest(environment: &Environment) -> Option<Self> {
        let luminances = environment.texels().iter().map(|texel| exact_luminance(*texel)).enumerate();
        let (at, luminance) = luminances.reduce(|best, other| if other.1 > best.1 { other } else { best })?;
        (luminance > 0.0).then(|| Self::at(environment, at))
    }

    pub(super) fn at(environment: &Environment, at: usize) -> Self {
        let surroundings = surroundings(environment, at);
        Self { at, luminance: exact_luminance(environment.texels()[at]), surroundings }
    }

    pub(super) fn stands_out(&self) -> bool {
        self.luminance >= CONTRAST * self.surroundings
    }

    /// Luminance threshold of the region.
    pub(super) fn edge(&self) -> f64 {
        self.surroundings + EDGE * (self.luminance - self.surroundings)
    }

    /// Luminance threshold of the glow around the region.
    pub(super) fn glow(&self) -> f64 {
        (CONTRAST * self.surroundings).max(GLOW * self.luminance)
    }

    /// The texels around it that are at least as bright as its edge.
    pub(super) fn region(&self, environment: &Environment) -> Vec<usize> {
        let texels = environment.texels();
        environment.layout().region(self.at, |at| exact_luminance(texels[at]) >= self.edge())
    }
}

impl Sun {
    /// Finds the brightest region of `environment`; `None` if none stands out.
    #[must_use]
    pub fn find(environment: &Environment) -> Option<Self> {
        let peak = Peak::brightest(environment).filter(Peak::stands_out)?;
        Some(Self::at(environment, &peak))
    }

    /// The region around `peak`.
    pub(super) fn at(environment: &Environment, peak: &Peak) -> Self {
        let texels = environment.texels();
        Self::over(environment, peak, &peak.region(environment), |at| texels[at].map(f64::from))
    }

    /// Integrates `radiance` over the texels of `region`.
    pub(super) fn over(
        environment: &Environment,
        peak: &Peak,
        region: &[usize],
        radiance: impl Fn(usize) -> [f64; 3],
    ) -> Self {
        let grid = environment.layout();
        let (mut irradiance, mut solid_angle, mut centre) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        for &at in region {
            let (w, radiance) = (grid.solid_angle_at(at), radiance(at));
            solid_angle += w;
            centre += grid.direction_at(at) * w * exact_luminance(radiance);
            irradiance += DVec3::from(radiance) * w;
        }
        let world_from_source = environment.source_from_world().transpose();
        let direction = centre.try_normalize().unwrap_or_else(|| grid.direction_at(peak.at));
        let radius = |radius: f64, at: &usize| radius.max(grid.direction_at(*at).angle_between(direction));
        let radius = region.iter().fold(0.0, radius);
        let is_small = solid_angle <= largest(grid) && radius <= REACH * disc_radius(largest(grid));
        let is_sun = is_small && peak.luminance >= SUN_CONTRAST * peak.surroundings;
        Self {
            kind: if is_sun { Brightest::Sun } else { Brightest::Region },
            direction: world_from_source * direction,
            peak: environment.texels()[peak.at],
            irradiance: irradiance.to_array(),
            solid_angle,
            texels: region.len(),
            surroundings: peak.surroundings,
        }
    }

    /// Diameter in degrees of the disc of its solid angle.
    #[must_use]
    pub fn diameter_degrees(&self) -> f64 {
        2.0 * disc_radius(self.solid_angle).to_degrees()
    }

    /// Degrees from +X towards +Z, in (-180, 180]: 0 at the panorama's centre, positive in its right half.
    #[must_use]
    pub fn azimuth_degrees(&self) -> f64 {
        self.direction.z.atan2(self.direction.x).to_degrees()
    }

    /// Degrees above the horizon, in [-90, 90].
    #[must_use]
    pub fn elevation_degrees(&self) -> f64 {
        self.direction.y.atan2(self.direction.x.hypot(self.direction.z)).to_degrees()
    }
}

/// Median luminance of the texels around texel `peak`, or of all texels if none is in range. Of large
/// pictures an even selection.
fn surroundings(environment: &Environment, peak: usize) -> f64 {
    let grid = environment.layout();
    let begin = SURROUNDINGS_DEGREES.to_radians().max(2.0 * texel_width(environment.layout()));
    let [inner, outer] = [begin, SURROUNDINGS_REACH * begin].map(|angle| angle.min(PI).cos());
    let peak = grid.direction_at(peak);
    let texels = environment.texels();
    // An odd step visits all columns of a width that is a power of two.
    let selected = || (0..texels.len()).step_by((texels.len() / SELECTION).max(1) | 1);
    let is_around = |at: &usize| {
        let cosine = grid.direction_at(*at).dot(peak);
        outer < cosine && cosine < inner
    };
    let luminance = |at: usize| exact_luminance(texels[at]);
    let mut around: Vec<f64> = selected().filter(is_around).map(luminance).collect();
    if around.is_empty() {
        around = selected().map(luminance).collect();
    }
    let middle = around.len() / 2;
    *around.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Approximate angular width of a texel.
pub(crate) fn texel_width(layout: Layout) -> f64 {
    match layout {
        Layout::Panorama { height, .. } => PI / f64::from(height),
        Layout::Cube { size } => PI / 2.0 / f64::from(size),
        Layout::Octahedral { size } => PI / f64::from(size),
    }
}

/// Neighbours of texels by index, in the source's space.
impl Layout {
    /// The texel at offset (`right`, `down`) from texel `at`, also across edges.
    fn neighbour(self, at: usize, right: i64, down: i64) -> usize {
        let (face, i, j) = self.place(at);
        let (x, y) = (i64::from(i) + right, i64::from(j) + down);
        match self {
            Self::Panorama { width, height } => {
                let (width, height) = (i64::from(width), i64::from(height));
                // Across a pole the meridian continues half a turn away.
                let over = y < 0 || y >= height;
                let column = (x + if over { width / 2 } else { 0 }).rem_euclid(width);
                (y.clamp(0, height - 1) * width + column) as usize
            }
            Self::Cube { size } => texel_around(size, Face::ALL[face as usize], x, y),
            Self::Octahedral { size } => {
                let (x, y) = octahedral::wrap_texel(size, x, y);
                y as usize * size as usize + x as usize
            }
        }
    }

    /// The texels that share a side or a corner with texel `at`.
    pub(super) fn around(self, at: usize) -> [usize; 8] {
        [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]
            .map(|(right, down)| self.neighbour(at, right, down))
    }

    /// The texels around `region`, which is sorted, in order.
    pub(super) fn rim(self, region: &[usize]) -> Vec<usize> {
        let around = region.iter().flat_map(|&at| self.around(at));
        let mut rim: Vec<usize> = around.filter(|at| region.binary_search(at).is_err()).collect();
        rim.sort_unstable();
        rim.dedup();
        rim
    }

    /// The texels connected to `seed` for which `belongs` holds.
    pub(super) fn region(self, seed: usize, belongs: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut seen = vec![false; self.texel_count()];
        let mut region = Vec::new();
        let mut queue = VecDeque::from([seed]);
        seen[seed] = true;
        while let Some(at) = queue.pop_front() {
            region.push(at);
            for next in self.around(at) {
                if !seen[next] && belongs(next) {
                    seen[next] = true;
                    queue.push_back(next);
                }
            }
        }
        region
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUTS: [Layout; 3] = [
        Layout::Panorama { width: 128, height: 64 },
        Layout::Cube { size: 32 },
        Layout::Octahedral { size: 64 },
    ];

    /// The poles, the panorama's seam, a cube's corner and edge, an octahedral fold.
    const PLACES: [DVec3; 5] = [DVec3::Y, DVec3::NEG_Y, DVec3::NEG_X, DVec3::ONE, DVec3::new(1.0, 0.0, 1.0)];

    /// Sky of 1 with a sun of 1000 where `direction` is within `degrees` of `centre`.
    fn sky(layout: Layout, centre: DVec3, degrees: f64) -> Environment {
        let lit = |at| layout.direction_at(at).dot(centre) > degrees.to_radians().cos();
        let texels = (0..layout.texel_count()).map(|at| if lit(at) { [1000.0; 3] } else { [1.0; 3] });
        Environment::new(layout, texels.collect()).expect("valid")
    }

    #[test]
    fn a_sun_is_found_across_every_kind_of_edge() {
        for layout in LAYOUTS {
            for place in PLACES.map(DVec3::normalize) {
                let sun = Sun::find(&sky(layout, place, 8.0)).expect("a sun");
                let whole = std::f64::consts::TAU * (1.0 - 8_f64.to_radians().cos());
                assert!(sun.direction.dot(place) > 0.9995, "{layout:?} {place}: {}", sun.direction);
                assert!((sun.solid_angle / whole - 1.0).abs() < 0.15, "{layout:?} {place}: {sun:?}");
                assert!((sun.irradiance[1] / (1000.0 * sun.solid_angle) - 1.0).abs() < 1e-9, "{sun:?}");
            }
        }
    }

    #[test]
    fn a_turned_environment_has_its_sun_elsewhere() {
        let environment = sky(Layout::Panorama { width: 128, height: 64 }, DVec3::Z, 4.0)
            .rotated_y(90.0)
            .expect("an angle");
        let sun = Sun::find(&environment).expect("a sun");
        assert!(sun.direction.dot(DVec3::X) > 0.999, "{}", sun.direction);
        assert!(sun.azimuth_degrees().abs() < 1.0 && sun.elevation_degrees().abs() < 1.0, "{sun:?}");
    }

    #[test]
    fn a_window_and_a_dim_peak_are_no_suns() {
        let mut regions = 0;
        for layout in LAYOUTS {
            // 3 degrees: 0.0086 sr.
            assert_eq!(Sun::find(&sky(layout, DVec3::Z, 3.0)).expect("it stands out").kind, Brightest::Sun);
            // Windows of 0.06 and 0.5 sr of the same radiance; a peak inside the large one is surrounded by
            // the window itself.
            for degrees in [8.0, 23.0] {
                let window = sky(layout, DVec3::Z, degrees);
                let found = Sun::find(&window).map(|found| found.kind);
                assert_ne!(found, Some(Brightest::Sun), "{layout:?} {degrees}");
                regions += usize::from(found.is_some());
            }
            // As small as the sun above, and twenty times as bright as the sky.
            let mut texels = sky(layout, DVec3::Z, 3.0).texels().to_vec();
            texels.iter_mut().filter(|texel| texel[0] > 1.0).for_each(|texel| *texel = [20.0; 3]);
            let dim = Environment::new(layout, texels).expect("valid");
            assert_eq!(Sun::find(&dim).expect("it stands out").kind, Brightest::Region, "{layout:?}");
        }
        assert!(regions > 0, "some windows stand out");
    }

    #[test]
    fn an_even_sky_has_none() {
        for value in [0.0, 3.0] {
            let layout = Layout::Cube { size: 8 };
            let environment =
                Environment::new(layout, vec![[value; 3]; layout.texel_count()]).expect("valid");
            assert_eq!(Sun::find(&environment), None);
        }
    }
}
