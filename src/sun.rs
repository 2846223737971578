//! Where the sun is: the region of an environment that outshines its surroundings.

use crate::environment::{Environment, Layout, Rgb, luminance};
use crate::sphere::{cube, equirect, octahedral};
use glam::DVec3;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// The surroundings of the peak begin at this angle from it, or at two texels where those are wider.
const SURROUNDINGS_DEGREES: f64 = 10.0;

/// They end at this many times that angle.
const SURROUNDINGS_REACH: f64 = 3.0;

/// A peak this many times as bright as its surroundings is a sun (or a lamp); less is weather.
const CONTRAST: f64 = 8.0;

/// The sun reaches to where luminance has fallen to this share of the way from its surroundings to its peak.
const EDGE: f64 = 0.1;

/// The brightest region of an environment.
///
/// It is the region connected to the texel of greatest luminance, over texels that touch by a side or a corner
/// (across cube edges, the panorama's seam and its poles as well), whose luminance is at least a tenth of the way up
/// from the surroundings to the peak. The surroundings' luminance is the median between 10 and 30 degrees from the
/// peak (further where texels are coarse), and a peak below eight times that is no sun.
#[derive(Clone, Debug, PartialEq)]
pub struct Sun {
    /// Unit direction in the world: the region's centre of energy.
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

impl Sun {
    /// The sun of `environment`, where there is one.
    #[must_use]
    pub fn find(environment: &Environment) -> Option<Self> {
        let texels = environment.texels();
        let (mut peak_at, mut peak) = (0, 0.0);
        for (at, texel) in texels.iter().enumerate() {
            let l = luminance(*texel);
            if l > peak {
                (peak_at, peak) = (at, l);
            }
        }
        let peak = f64::from(peak);
        let grid = Grid(environment.layout());
        let surroundings = surroundings(environment, grid.direction(peak_at))?;
        if peak <= 0.0 || peak < CONTRAST * surroundings {
            return None;
        }
        let threshold = surroundings + EDGE * (peak - surroundings);
        let region = grid.region(peak_at, |at| f64::from(luminance(texels[at])) >= threshold);

        let (mut irradiance, mut solid_angle, mut centre) = ([0.0; 3], 0.0, DVec3::ZERO);
        for &at in &region {
            let w = grid.solid_angle(at);
            solid_angle += w;
            centre += grid.direction(at) * w * f64::from(luminance(texels[at]));
            for (sum, value) in irradiance.iter_mut().zip(texels[at]) {
                *sum += f64::from(value) * w;
            }
        }
        let world_from_source = environment.source_from_world().transpose();
        let direction = centre.try_normalize().unwrap_or_else(|| grid.direction(peak_at));
        Some(Self {
            direction: world_from_source * direction,
            peak: texels[peak_at],
            irradiance,
            solid_angle,
            texels: region.len(),
            surroundings,
        })
    }

    /// Degrees from +X towards +Z, in (-180, 180]: the panorama's centre is 0, its right half is positive.
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

/// Median luminance of the texels around `peak` (a direction of the source), or of all where none is that near.
fn surroundings(environment: &Environment, peak: DVec3) -> Option<f64> {
    let begin = SURROUNDINGS_DEGREES.to_radians().max(2.0 * texel_width(environment.layout()));
    let [inner, outer] = [begin, SURROUNDINGS_REACH * begin].map(|angle| angle.min(PI).cos());
    let peak = environment.source_from_world().transpose() * peak;
    let mut around = Vec::new();
    environment.for_each_texel(|direction, _, texel| {
        let cosine = direction.dot(peak);
        if outer < cosine && cosine < inner {
            around.push(luminance(texel));
        }
    });
    if around.is_empty() {
        around = environment.texels().iter().map(|texel| luminance(*texel)).collect();
    }
    let middle = around.len() / 2;
    (!around.is_empty()).then(|| f64::from(*around.select_nth_unstable_by(middle, f32::total_cmp).1))
}

/// Angle across a texel, roughly.
pub(crate) fn texel_width(layout: Layout) -> f64 {
    match layout {
        Layout::Panorama { height, .. } => PI / f64::from(height),
        Layout::Cube { size } => PI / 2.0 / f64::from(size),
        Layout::Octahedral { size } => PI / f64::from(size),
    }
}

/// The texels of a layout by index, in the source's own space.
#[derive(Clone, Copy)]
struct Grid(Layout);

impl Grid {
    /// (column, row, face) of texel `at`.
    fn place(self, at: usize) -> (u32, u32, usize) {
        let (width, area) = match self.0 {
            Layout::Panorama { width, height } => (width as usize, width as usize * height as usize),
            Layout::Cube { size } | Layout::Octahedral { size } => {
                (size as usize, size as usize * size as usize)
            }
        };
        let inside = at % area;
        ((inside % width) as u32, (inside / width) as u32, at / area)
    }

    fn direction(self, at: usize) -> DVec3 {
        let (i, j, face) = self.place(at);
        match self.0 {
            Layout::Panorama { width, height } => equirect::direction_from_equirect(
                (f64::from(i) + 0.5) / f64::from(width),
                (f64::from(j) + 0.5) / f64::from(height),
            ),
            Layout::Cube { size } => cube::direction_from_texel(cube::Face::ALL[face], size, i, j),
            Layout::Octahedral { size } => {
                octahedral::direction_from_oct(octahedral::texel_centre(size, i, j))
            }
        }
    }

    fn solid_angle(self, at: usize) -> f64 {
        let (i, j, _) = self.place(at);
        match self.0 {
            Layout::Panorama { width, height } => equirect::texel_solid_angle(width, height, j),
            Layout::Cube { size } => cube::texel_solid_angle(size, i, j),
            Layout::Octahedral { size } => octahedral::texel_solid_angle(size, i, j),
        }
    }

    /// The texel beside texel `at`, (`right`, `down`) of it, across whatever edge lies between.
    fn neighbour(self, at: usize, right: i64, down: i64) -> usize {
        let (i, j, face) = self.place(at);
        let (x, y) = (i64::from(i) + right, i64::from(j) + down);
        match self.0 {
            Layout::Panorama { width, height } => {
                let (width, height) = (i64::from(width), i64::from(height));
                // Over a pole the meridian goes on half a turn away.
                let over = y < 0 || y >= height;
                let column = (x + if over { width / 2 } else { 0 }).rem_euclid(width);
                (y.clamp(0, height - 1) * width + column) as usize
            }
            Layout::Cube { size } => beside(size, cube::Face::ALL[face], x, y),
            Layout::Octahedral { size } => {
                let (x, y) = octahedral::wrap_texel(size, x, y);
                y as usize * size as usize + x as usize
            }
        }
    }

    /// The texels connected to `seed` for which `belongs` holds.
    fn region(self, seed: usize, belongs: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut seen = vec![false; self.0.texel_count()];
        let mut region = Vec::new();
        let mut queue = VecDeque::from([seed]);
        seen[seed] = true;
        while let Some(at) = queue.pop_front() {
            region.push(at);
            for (right, down) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let next = self.neighbour(at, right, down);
                if !seen[next] && belongs(next) {
                    seen[next] = true;
                    queue.push_back(next);
                }
            }
        }
        region
    }
}

/// Index of the cube texel at (`x`, `y`) of `face`, which may lie a texel beyond its edges.
pub(crate) fn beside(size: u32, face: cube::Face, x: i64, y: i64) -> usize {
    let n = f64::from(size);
    let coordinate = |k: i64| (k as f64 + 0.5) / n * 2.0 - 1.0;
    let (face, s, t) = cube::cube_from_direction(cube::cube_point(face, coordinate(x), coordinate(y)));
    // A texel's width beyond an edge projects to the row along it, at the same place: s/(1 + 1/n) stays in its texel.
    let texel = |c: f64| (((c + 1.0) / 2.0 * n) as usize).min(size as usize - 1);
    (face.index() * size as usize + texel(t)) * size as usize + texel(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sky of 1 with a sun of 1000 where `direction` is within `degrees` of `centre`.
    fn sky(layout: Layout, centre: DVec3, degrees: f64) -> Environment {
        let grid = Grid(layout);
        let lit = |at| grid.direction(at).dot(centre) > degrees.to_radians().cos();
        let texels = (0..layout.texel_count()).map(|at| if lit(at) { [1000.0; 3] } else { [1.0; 3] });
        Environment::new(layout, texels.collect()).expect("valid")
    }

    #[test]
    fn a_sun_is_found_across_every_kind_of_edge() {
        let layouts = [
            Layout::Panorama { width: 128, height: 64 },
            Layout::Cube { size: 32 },
            Layout::Octahedral { size: 64 },
        ];
        let places = [DVec3::Y, DVec3::NEG_Y, DVec3::NEG_X, DVec3::ONE, DVec3::new(1.0, 0.0, 1.0)];
        for layout in layouts {
            for place in places.map(DVec3::normalize) {
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
        let environment = sky(Layout::Panorama { width: 128, height: 64 }, DVec3::Z, 4.0).rotated_y(90.0);
        let sun = Sun::find(&environment).expect("a sun");
        assert!(sun.direction.dot(DVec3::X) > 0.999, "{}", sun.direction);
        assert!(sun.azimuth_degrees().abs() < 1.0 && sun.elevation_degrees().abs() < 1.0, "{sun:?}");
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
