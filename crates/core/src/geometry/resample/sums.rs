//! Sums of shares over target texels, and their means.

use super::band::Band;
use super::mirrors::Mirrors;
use crate::common::parallel;
use crate::light::environment::Rgb;
use crate::sphere::grid::Grid;

/// Places whose sums are converted at once, after which their memory is free.
const CHUNK: usize = 1 << 13;

/// Place of a target texel without sums.
const NONE: u32 = u32::MAX;

/// Bytes per target texel without mirrors, which share them: its place, the place's texel and sums, and its
/// image.
pub(super) const MAX_BYTES: usize = 4 + 4 + 4 * size_of::<f64>() + 4;

/// Sums over target texels: for every image red, green and blue, then the solid angle of one image.
pub(super) struct Sums<'a> {
    mirrors: &'a Mirrors,
    target: &'a Grid,
    /// Place of each target texel in `targets`, or [`NONE`].
    slots: Vec<u32>,
    /// Target texels with sums, in the order in which shares met them.
    targets: Vec<u32>,
    /// The sums by place.
    chunks: Vec<Vec<f64>>,
}

impl<'a> Sums<'a> {
    /// Sums over the texels of `target`, of which `mirrors` give the images.
    pub(super) fn new(mirrors: &'a Mirrors, target: &'a Grid) -> Self {
        let slots = vec![NONE; target.texel_count()];
        Self { mirrors, target, slots, targets: Vec::new(), chunks: Vec::new() }
    }

    /// Numbers of a place.
    fn stride(&self) -> usize {
        3 * self.mirrors.images() + 1
    }

    /// Adds the shares of `bands` of the radiances `texels`. Shares that rounding carried behind one of the
    /// mirrors count where that reflects them. `None` if an image of a texel of the target is not a texel.
    pub(super) fn add(&mut self, bands: &[Band], texels: &[Rgb]) -> Option<()> {
        for share in bands.iter().flat_map(|band| &band.shares) {
            if self.slots[share.target as usize] == NONE {
                self.slots[share.target as usize] = self.slot_of(share.target)?;
            }
        }
        let (images, stride) = (self.mirrors.images(), self.stride());
        self.chunks.resize_with(self.targets.len().div_ceil(CHUNK), || vec![0.0; CHUNK * stride]);
        // Every thread sums its own range of slots, in the order of the sources.
        let per_thread = self.chunks.len().div_ceil(rayon::current_num_threads()).max(1);
        let slots = &self.slots;
        parallel::for_each(self.chunks.chunks_mut(per_thread).enumerate(), |(thread, chunks)| {
            let first = thread * per_thread * CHUNK;
            for band in bands {
                for share in &band.shares {
                    let place = slots[share.target as usize] as usize;
                    let Some(place) = place.checked_sub(first) else { continue };
                    let Some(chunk) = chunks.get_mut(place / CHUNK) else { continue };
                    let sums = &mut chunk[place % CHUNK * stride..][..stride];
                    let sources = &band.sources[share.source as usize * images..][..images];
                    let weight = f64::from(share.solid_angle);
                    for (sums, source) in sums.chunks_exact_mut(3).zip(sources) {
                        for (sum, value) in sums.iter_mut().zip(texels[*source as usize]) {
                            *sum += weight * f64::from(value);
                        }
                    }
                    sums[stride - 1] += weight;
                }
            }
        });
        Some(())
    }

    /// The slot of the target texel `index`, or a new one: that of its image that is not behind a mirror.
    fn slot_of(&mut self, index: u32) -> Option<u32> {
        let mut owner = index;
        if self.mirrors.images() > 1 {
            let ahead = self.mirrors.ahead(self.target, self.target.texel(index as usize))?;
            owner = u32::try_from(self.target.index(ahead)).expect("texels fit");
        }
        if self.slots[owner as usize] == NONE {
            self.slots[owner as usize] = u32::try_from(self.targets.len()).expect("texels fit");
            self.targets.push(owner);
        }
        Some(self.slots[owner as usize])
    }

    /// The mean radiance of every texel of the target, and their totals; NaN for texels without sums. `None`
    /// if an image of a texel is not a texel.
    pub(super) fn means(mut self) -> Option<(Vec<Rgb>, Totals)> {
        let (mirrors, target, stride) = (self.mirrors, self.target, self.stride());
        let chunks = self.chunks.iter_mut().zip(self.targets.chunks(CHUNK));
        let parts = parallel::map(chunks, |(sums, targets)| {
            let mut totals = Totals::default();
            let mut images = Vec::with_capacity(mirrors.images() * targets.len());
            for (sums, index) in sums.chunks_exact_mut(stride).zip(targets) {
                let texel = target.texel(*index as usize);
                let first = images.len();
                mirrors.append(target, texel, &mut images)?;
                to_means(sums, &images[first..], target.solid_angle(texel), &mut totals);
            }
            Some((images, totals))
        });
        let parts: Vec<(Vec<u32>, Totals)> = parts.into_iter().collect::<Option<_>>()?;
        let totals = parts.iter().fold(Totals::default(), |sum, (_, term)| sum.plus(term));
        let mut texels = vec![[f32::NAN; 3]; self.slots.len()];
        for (sums, (images, _)) in self.chunks.into_iter().zip(parts) {
            for (sums, images) in sums.chunks_exact(stride).zip(images.chunks_exact(mirrors.images())) {
                for (image, mean) in images.iter().zip(sums.chunks_exact(3)) {
                    // Keeps NaN.
                    texels[*image as usize] =
                        std::array::from_fn(|c| (mean[c] as f32).clamp(f32::MIN, f32::MAX));
                }
            }
        }
        Some((texels, totals))
    }
}

/// Totals of each channel.
#[derive(Clone, Copy, Default)]
pub(super) struct Totals {
    /// Energy that arrived from the source.
    arrived: [f64; 3],
    /// Energy that the texels hold.
    held: [f64; 3],
    /// Integral of the texels' squared radiance.
    squares: [f64; 3],
}

impl Totals {
    /// Those of `radiance` over `solid_angle`, of which nothing arrived.
    pub(super) fn new(radiance: [f64; 3], solid_angle: f64) -> Self {
        let held = radiance.map(|value| value * solid_angle);
        let squares = radiance.map(|value| value * value * solid_angle);
        Self { arrived: [0.0; 3], held, squares }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let sum = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|c| a[c] + b[c]);
        Self {
            arrived: sum(self.arrived, other.arrived),
            held: sum(self.held, other.held),
            squares: sum(self.squares, other.squares),
        }
    }

    /// Corrects `texels`, which have these totals, to the energy that arrived: each by its radiance squared,
    /// which is the least change relative to the radiance. One bright texel on a rim is the likely error; a
    /// common factor would tint the whole picture.
    pub(super) fn correct(&self, texels: &mut [Rgb]) {
        let rates: [f64; 3] = std::array::from_fn(|c| {
            if self.squares[c] > 0.0 { (self.arrived[c] - self.held[c]) / self.squares[c] } else { 0.0 }
        });
        parallel::for_each(texels.chunks_mut(CHUNK), |texels| {
            for (value, rate) in texels.iter_mut().flat_map(|texel| texel.iter_mut().zip(rates)) {
                let exact = f64::from(*value);
                *value = ((exact * (1.0 + rate * exact).max(0.0)) as f32).clamp(f32::MIN, f32::MAX);
            }
        });
    }
}

/// Turns the sums of one place into the means of the texels `images`, each of `solid_angle`; adds theirs to
/// `totals`. Texels without shares get NaN.
fn to_means(sums: &mut [f64], images: &[u32], solid_angle: f64, totals: &mut Totals) {
    let (sums, weight) = sums.split_at_mut(3 * images.len());
    for (first, image) in images.iter().enumerate() {
        if images[..first].contains(image) {
            continue;
        }
        // A texel that a mirror cuts is its own image: its sums are in two or more parts.
        let parts = || (first..images.len()).filter(|part| images[*part] == *image);
        let total = weight[0] * parts().count() as f64;
        let arrived: [f64; 3] = std::array::from_fn(|c| parts().map(|part| sums[3 * part + c]).sum());
        let means = arrived.map(|sum| sum / total);
        if total > 0.0 {
            *totals = totals.plus(&Totals { arrived, ..Totals::new(means, solid_angle) });
        }
        for part in parts() {
            sums[3 * part..3 * part + 3].copy_from_slice(&means);
        }
    }
}
