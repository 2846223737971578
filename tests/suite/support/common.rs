//! Generated inputs: deterministic numbers, directions, environments and OEMs.

use glam::DVec3;
use octagloss::internals::environment::of_sound;
use octagloss::internals::oem::{Oem, OemSize};
use octagloss::internals::sphere::octahedral;
use octagloss::{Environment, Layout, Rgb};

/// SplitMix64 (Steele, Lea and Flood 2014): a seed gives the same numbers on every machine.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In 0..count.
    pub(crate) fn below(&mut self, count: u32) -> u32 {
        (self.unit() * f64::from(count)) as u32
    }

    /// Uniform over the sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        let y = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        DVec3::new(radius * cos, y, radius * sin)
    }
}

/// Number of cases of a sweep: `brief`, or `full` if `tests/run --every-case` asks for all (the environment
/// variable OCTAGLOSS_EVERY_CASE).
pub(crate) fn sweep<T>(brief: T, full: T) -> T {
    if std::env::var_os("OCTAGLOSS_EVERY_CASE").is_some() { full } else { brief }
}

/// The 26 directions where maps have vertices, edge midpoints and face centres.
pub(crate) fn landmarks() -> Vec<DVec3> {
    let mut all = Vec::new();
    for x in [-1.0, 0.0, 1.0] {
        for y in [-1.0, 0.0, 1.0] {
            for z in [-1.0, 0.0, 1.0] {
                if (x, y, z) != (0.0, 0.0, 0.0) {
                    all.push(DVec3::new(x, y, z).normalize());
                }
            }
        }
    }
    all
}

/// Kinds of random environments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// Independent texels, over four decades.
    Noise,
    /// A dim gradient with a few texels up to 1e6 times brighter.
    Suns,
    /// Black except one texel.
    Lone,
    /// A few low frequencies.
    Smooth,
    /// A different value in each half.
    Split,
}

impl Look {
    pub(crate) const ALL: [Self; 5] = [Self::Noise, Self::Suns, Self::Lone, Self::Smooth, Self::Split];
}

/// Texels of `layout` in a `look`, with independent channels.
pub(crate) fn texels(random: &mut Random, look: Look, layout: Layout) -> Vec<Rgb> {
    let count = layout.texel_count();
    let blank = of_sound(layout, vec![[0.0; 3]; count]).expect("a layout of at least one texel");
    let tint: [f64; 3] = std::array::from_fn(|_| random.between(0.2, 1.0));
    let (axis, other) = (random.direction(), random.direction());
    let level = random.between(0.01, 1.0);
    let mut texels = Vec::with_capacity(count);
    blank.for_each_texel(|direction, _, _| {
        let value = match look {
            Look::Noise => 10_f64.powf(random.between(-2.0, 2.0)),
            Look::Suns => level * (1.2 + direction.y),
            Look::Lone => 0.0,
            Look::Smooth => level * (1.5 + direction.dot(axis) + 0.4 * (3.0 * direction.dot(other)).sin()),
            Look::Split => level * if direction.y > 0.0 { 1.0 } else { 0.25 },
        };
        texels.push(tint.map(|t| (t * value) as f32));
    });
    if matches!(look, Look::Suns | Look::Lone) {
        for _ in 0..if look == Look::Suns { 3 } else { 1 } {
            let power = 10_f64.powf(random.between(2.0, 6.0));
            texels[random.below(count as u32) as usize] = tint.map(|t| (power * t) as f32);
        }
    }
    texels
}

/// An environment of `texels`.
pub(crate) fn environment(layout: Layout, texels: Vec<Rgb>) -> Environment {
    // Also panoramas that are not 2:1, whose parts files and users cannot make.
    of_sound(layout, texels).expect("as many texels")
}

/// An OEM whose texels hold `radiance` over their exact solid angles.
pub(crate) fn oem(size: OemSize, radiance: &[Rgb]) -> Oem {
    let n = size.inner;
    let square = (0..n * n)
        .zip(radiance)
        .map(|(k, rgb)| {
            let w = octahedral::texel_solid_angle(n, k % n, k / n) as f32;
            [rgb[0] * w, rgb[1] * w, rgb[2] * w, w]
        })
        .collect();
    Oem::from_square(size, square)
}
