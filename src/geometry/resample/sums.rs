//! Sums of shares over target texels, and their means.

use super::band::Band;
use super::mirrors::Mirrors;
use crate::environment::Rgb;
use crate::sphere::grid::Grid;
use rayon::prelude::*;

/// Places whose sums are converted at once, after which their memory is free.
const CHUNK: usize = 1 << 13;

/// Place of a target texel without sums.
const NONE: u32 = u32::MAX;

/// Bytes per target texel without mirrors, which share them: its place, the place's texel and sums, and its
/// image.
pub(super) const MOST_BYTES: usize = 4 + 4 + 4 * size_of::<f64>() + 4;

/// Sums over target texels: for every image red, green and blue, then the solid angle of one image.
pub(super) struct Sums {
    /// Number of images.
    images: usize,
    /// Place of each target texel in `targets`, or [`NONE`].
    slots: Vec<u32>,
    /// Target texels with sums, in the order in which shares met them.
    targets: Vec<u32>,
    /// The sums by place.
    chunks: Vec<Vec<f64>>,
}

impl Sums {
    pub(super) fn new(images: usize, targets: usize) -> Self {
        Self { images, slots: vec![NONE; targets], targets: Vec::new(), chunks: Vec::new() }
    }

    /// Numbers of a place.
    const fn stride(&self) -> usize {
        3 * self.images + 1
    }

    /// Adds the shares of `bands` of the radiances `texels`.
    pub(super) fn add(&mut self, bands: &[Band], texels: &[Rgb]) {
        for share in bands.iter().flat_map(|band| &band.shares) {
            let place = &mut self.slots[share.target as usize];
            if *place == NONE {
                *place = u32::try_from(self.targets.len()).expect("texels fit");
                self.targets.push(share.target);
            }
        }
        let (images, stride) = (self.images, self.stride());
        self.chunks.resize_with(self.targets.len().div_ceil(CHUNK), || vec![0.0; CHUNK * stride]);
        // Every thread sums its own range of slots, in the order of the sources.
        let per_thread = self.chunks.len().div_ceil(rayon::current_num_threads()).max(1);
        let slots = &self.slots;
        self.chunks.par_chunks_mut(per_thread).enumerate().for_each(|(thread, chunks)| {
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
    }

    /// The mean radiance of every texel of `target`, of which `mirrors` give the images; NaN for texels
    /// without sums. `None` if an image of a texel is not a texel.
    pub(super) fn means(mut self, mirrors: &Mirrors, target: &Grid) -> Option<Vec<Rgb>> {
        let stride = self.stride();
        // Images of the targets, each channel's energy that arrived, and that the means hold.
        type ChunkMeans = (Vec<u32>, [[f64; 3]; 2]);
        let parts: Vec<ChunkMeans> = self
            .chunks
            .par_iter_mut()
            .zip(self.targets.par_chunks(CHUNK))
            .map(|(sums, targets)| {
                let mut energies = [[0.0; 3]; 2];
                let mut images = Vec::with_capacity(self.images * targets.len());
                for (sums, index) in sums.chunks_exact_mut(stride).zip(targets) {
                    let texel = target.texel(*index as usize);
                    let first = images.len();
                    mirrors.append(target, texel, &mut images)?;
                    to_means(sums, &images[first..], target.solid_angle(texel), &mut energies);
                }
                Some((images, energies))
            })
            .collect::<Option<_>>()?;
        // Correct the energy error of each channel from rounding and curvature by one factor.
        let [arrived, held] = parts.iter().fold([[0.0; 3]; 2], |sum: [[f64; 3]; 2], (_, term)| {
            std::array::from_fn(|k| std::array::from_fn(|c| sum[k][c] + term[k][c]))
        });
        let scale: [f64; 3] = std::array::from_fn(|c| if held[c] > 0.0 { arrived[c] / held[c] } else { 1.0 });
        let mut means = vec![[f32::NAN; 3]; self.slots.len()];
        for (sums, (images, _)) in self.chunks.into_iter().zip(parts) {
            for (sums, images) in sums.chunks_exact(stride).zip(images.chunks_exact(self.images)) {
                for (image, mean) in images.iter().zip(sums.chunks_exact(3)) {
                    // Keeps NaN.
                    means[*image as usize] =
                        std::array::from_fn(|c| ((mean[c] * scale[c]) as f32).clamp(f32::MIN, f32::MAX));
                }
            }
        }
        Some(means)
    }
}

/// Turns the sums of one place into the means of the texels `images`, each of `solid_angle`; adds the energy
/// that arrived there, and that the means hold, to `energies`. Texels without shares get NaN.
fn to_means(sums: &mut [f64], images: &[u32], solid_angle: f64, energies: &mut [[f64; 3]; 2]) {
    let (sums, weight) = sums.split_at_mut(3 * images.len());
    for (first, image) in images.iter().enumerate() {
        if images[..first].contains(image) {
            continue;
        }
        // A texel that a mirror cuts is its own image: its sums are in two or more parts.
        let parts = || (first..images.len()).filter(|part| images[*part] == *image);
        let total = weight[0] * parts().count() as f64;
        for channel in 0..3 {
            let sum: f64 = parts().map(|part| sums[3 * part + channel]).sum();
            let mean = sum / total;
            if total > 0.0 {
                energies[0][channel] += sum;
                energies[1][channel] += mean * solid_angle;
            }
            parts().for_each(|part| sums[3 * part + channel] = mean);
        }
    }
}
