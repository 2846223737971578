//! Exhaustive integration over the texels of an OEM: the lobe that the engines serve.

use glam::{DVec2, DVec3};
use octagloss::internals::analysis::oracle::integrate::integrate;
use octagloss::internals::analysis::oracle::kernel::{Kernel, MIRROR, Profile};
use octagloss::internals::geometry::exact::for_each_flat_of_quadrant;
use octagloss::internals::geometry::exact::patch::{Accuracy, Sample};
use octagloss::internals::lobe::Lobe;
use octagloss::internals::oem::{Oem, bilinear_share};
use octagloss::internals::sphere::octahedral;
use octagloss::internals::sphere::quadrature::gauss_legendre;
use std::f64::consts::PI;

/// Relative accuracy of the kernel's integral over a quadrant of a texel.
const QUADRANT_ACCURACY: f64 = 1e-9;

/// Levels of splitting at the edge of a cone, down to pieces that are cut along a chord.
const CONE_LEVELS: u32 = 40;

/// An OEM made ready for exhaustive integration.
///
/// The answer is L = c + sum_t Kbar_t * (E_t - c w_t) / W in each channel: c is the least radiance of the
/// channel in the OEM, W the kernel's integral over the sphere, and Kbar_t the kernel averaged over texel t
/// in (u, v), to the share that [`bilinear_share`] says with a tent two texels wide on the unfolded plane,
/// evenly for the rest. Summed over t that is the kernel times the bilinear (or constant) interpolation of
/// (E_t - c w_t) per (u, v) area, integrated over the square; it is done quadrant by quadrant of each texel,
/// where interpolation, map and fold have no kinks.
#[derive(Debug)]
pub(crate) struct OemOracle {
    size: u32,
    /// Least radiance of each channel.
    least: [f64; 3],
    /// (E_t - c w_t) per (u, v) area, with a border of one texel.
    density: Vec<[f64; 3]>,
}

impl OemOracle {
    /// Takes the square of `oem`; its border is not looked at.
    pub(crate) fn new(oem: &Oem) -> Self {
        Self::of_texels(oem.size().inner, |x, y| oem.texel(x, y).map(f64::from))
    }

    /// Takes the square whose texel (x, y) has the energies and the solid angle `texel(x, y)`, in double
    /// precision: light that float32 holds, but whose energies it does not.
    pub(crate) fn of_texels(size: u32, texel: impl Fn(u32, u32) -> [f64; 4]) -> Self {
        let mut least = [f64::INFINITY; 3];
        for y in 0..size {
            for x in 0..size {
                let [energy @ .., solid_angle] = texel(x, y);
                for (least, energy) in least.iter_mut().zip(energy) {
                    *least = least.min(energy / solid_angle);
                }
            }
        }
        let texel_area = (2.0 / f64::from(size)).powi(2);
        let side = i64::from(size) + 2;
        let mut density = Vec::with_capacity((side * side) as usize);
        for y in -1..=i64::from(size) {
            for x in -1..=i64::from(size) {
                // The texel in the square that this one is a copy of, by the continuous rule at its centre.
                let centre = (DVec2::new(x as f64, y as f64) + 0.5) * (2.0 / f64::from(size)) - 1.0;
                let inside = (octahedral::wrap_oct(centre) + 1.0) / 2.0 * f64::from(size);
                let [energy @ .., solid_angle] = texel(inside.x as u32, inside.y as u32);
                density.push([0, 1, 2].map(|c| (energy[c] - least[c] * solid_angle) / texel_area));
            }
        }
        Self { size, least, density }
    }

    /// The densities at the four sites 00 10 01 11 around a point of quadrant (`i`, `j`).
    fn densities(&self, i: usize, j: usize) -> [[f64; 3]; 4] {
        let side = self.size as usize + 2;
        // Column k of the bordered table stands at texel k - 1.
        let (x, y) = (i.div_ceil(2), j.div_ceil(2));
        let at = |x: usize, y: usize| self.density[y * side + x];
        [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)]
    }

    /// The lobe's radiance around `direction` (any length but zero), relative error below 1e-7 (of the cone
    /// 1e-5).
    ///
    /// At roughness 0 it is c plus the interpolated density at `direction` over the solid angle per (u, v)
    /// area.
    pub(crate) fn reflect(&self, lobe: Lobe, roughness: f64, direction: DVec3) -> [f64; 3] {
        let share = bilinear_share(lobe, roughness * roughness, self.size);
        self.reflect_with_share(lobe, roughness, direction, share)
    }

    /// The same with the share of bilinear interpolation, in [0, 1], as said.
    pub(crate) fn reflect_with_share(
        &self,
        lobe: Lobe,
        roughness: f64,
        direction: DVec3,
        bilinear: f64,
    ) -> [f64; 3] {
        Self::reflect_each(&[self], lobe, roughness, direction, bilinear)[0]
    }

    /// The same over several OEMs of one size, for little more than one costs: what is integrated depends on
    /// the size alone.
    ///
    /// # Panics
    /// Where the sizes differ.
    pub(crate) fn reflect_each(
        oems: &[&Self],
        lobe: Lobe,
        roughness: f64,
        direction: DVec3,
        bilinear: f64,
    ) -> Vec<[f64; 3]> {
        let Some(size) = oems.first().map(|oem| oem.size) else {
            return Vec::new();
        };
        assert!(oems.iter().all(|oem| oem.size == size), "OEMs of one size");
        if roughness < MIRROR && lobe.has_mirror() {
            return oems.iter().map(|oem| oem.mirror(direction)).collect();
        }
        let kernel = Kernel::new(lobe, roughness, direction.normalize());
        let accuracy = Accuracy::new(QUADRANT_ACCURACY);
        let texels_per_unit = f64::from(size) / 2.0;
        let mut sums = vec![[0.0; 3]; oems.len()];
        for j in 0..2 * size as usize {
            for i in 0..2 * size as usize {
                let first = first_site(size, i, j);
                // The kernel times 1, a, b and ab, (a, b) the place between the sites.
                let mut moments = [0.0; 4];
                let mut add = |s: Sample, value: f64| {
                    // On the octahedron, the solid angle of du dv is 1/|point|^3.
                    let weighted = s.weight * s.length_squared * s.length_squared.sqrt() * value;
                    let place = (octahedral::oct_from_direction(s.point) - first) * texels_per_unit;
                    moments[0] += weighted;
                    moments[1] += weighted * place.x;
                    moments[2] += weighted * place.y;
                    moments[3] += weighted * place.x * place.y;
                };
                for_each_flat_of_quadrant(size, i, j, &mut |flat| {
                    integrate(&flat, &kernel, &accuracy, CONE_LEVELS, &mut add);
                });
                let [m, a, b, ab] = moments;
                let mut weights = [m - a - b + ab, a - ab, b - ab, ab].map(|weight| weight * bilinear);
                // The quadrant's own texel is the second site of a left or upper half, the first of the
                // other.
                weights[(1 - i % 2) + 2 * (1 - j % 2)] += m * (1.0 - bilinear);
                for (sum, oem) in sums.iter_mut().zip(oems) {
                    for (density, weight) in oem.densities(i, j).iter().zip(weights) {
                        for (sum, density) in sum.iter_mut().zip(density) {
                            *sum += weight * density;
                        }
                    }
                }
            }
        }
        let integral = integral(&kernel);
        let answer = |(oem, sum): (&&Self, [f64; 3])| [0, 1, 2].map(|c| oem.least[c] + sum[c] / integral);
        oems.iter().zip(sums).map(answer).collect()
    }

    fn mirror(&self, direction: DVec3) -> [f64; 3] {
        let uv = octahedral::oct_from_direction(direction);
        let half_texel =
            |t: f64| (((t + 1.0) * f64::from(self.size)) as usize).min(2 * self.size as usize - 1);
        let (i, j) = (half_texel(uv.x), half_texel(uv.y));
        let (first, sites) = (first_site(self.size, i, j), self.densities(i, j));
        let place = (uv - first) * f64::from(self.size) / 2.0;
        let weights = [
            (1.0 - place.x) * (1.0 - place.y),
            place.x * (1.0 - place.y),
            (1.0 - place.x) * place.y,
            place.x * place.y,
        ];
        let jacobian = octahedral::solid_angle_density(uv);
        [0, 1, 2].map(|c| {
            let density: f64 = sites.iter().zip(weights).map(|(site, weight)| site[c] * weight).sum();
            self.least[c] + density / jacobian
        })
    }
}

/// The (u, v) of the first of the four sites around a point of quadrant (`i`, `j`): half-texel i lies between
/// texels (i - 1)/2 and (i + 1)/2.
fn first_site(size: u32, i: usize, j: usize) -> DVec2 {
    (DVec2::new(i.div_ceil(2) as f64, j.div_ceil(2) as f64) - 0.5) * (2.0 / f64::from(size)) - 1.0
}

/// [`OemOracle::reflect`] for a single question.
pub(crate) fn reflect_oem(oem: &Oem, lobe: Lobe, roughness: f64, direction: DVec3) -> [f64; 3] {
    OemOracle::new(oem).reflect(lobe, roughness, direction)
}

/// The kernel's integral over the sphere.
pub(crate) fn integral(kernel: &Kernel) -> f64 {
    match kernel.profile {
        Profile::Ggx { alpha_squared } => {
            // 4 pi times the integral of the kernel over s in [0, 1/2]; s = a^2 (e^t - 1) makes it
            // smooth, and panels of width below 1/4 leave Gauss's eighth order nothing to miss.
            let end = (0.5 / alpha_squared).ln_1p();
            let panels = (4.0 * end).ceil();
            let rule = gauss_legendre(8);
            let mut sum = 0.0;
            for panel in 0..panels as u32 {
                for &(node, weight) in &rule {
                    let t = (f64::from(panel) + node) * end / panels;
                    let half = alpha_squared * t.exp_m1();
                    let spread = alpha_squared + (1.0 - alpha_squared) * half;
                    sum += weight * (1.0 - 2.0 * half) / (spread * spread) * (half + alpha_squared);
                }
            }
            4.0 * alpha_squared * sum * end / panels
        }
        Profile::Phong { exponent } => 2.0 * PI / (exponent + 1.0),
        Profile::Cone { half_angle, .. } => 4.0 * PI * (half_angle / 2.0).sin().powi(2),
        Profile::Cosine => PI,
        // With x = 1 - cos: the integral of x^power - x^(power + 1) over [0, 1].
        Profile::Charlie { power } => 2.0 * PI * (1.0 / (power + 1.0) - 1.0 / (power + 2.0)),
    }
}
