//! The roughness map of plain surfaces.

use octagloss_core::common::smoothstep::smoothstep;

/// Texels along an edge.
pub(super) const SIZE: u32 = 256;

/// Factors of roughness, 0 to 255 for 0 to 1, row-major; u runs along rows and v down, and both wrap: bands
/// and discs between polished and rough, with soft edges.
pub(super) fn roughness_map() -> Vec<u8> {
    let texel = |index: u32| {
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(SIZE);
        let (u, v) = (place(index % SIZE), place(index / SIZE));
        // Eight by six cells with a disc in every other one, on bands that vary along v.
        let cell = |x: f64, count: f64| (x * count).fract() - 0.5;
        let far = cell(u, 8.0).hypot(cell(v, 6.0));
        let odd = ((u * 8.0) as u32 + (v * 6.0) as u32) % 2 == 1;
        let disc = if odd { smoothstep((0.4 - far) / 0.08) } else { 0.0 };
        let band = 0.5 + 0.5 * (std::f64::consts::TAU * (3.0 * v + u)).sin();
        let factor = 0.35 + 0.65 * band;
        ((factor * (1.0 - disc) + 0.08 * disc) * 255.0).round() as u8
    };
    (0..SIZE * SIZE).map(texel).collect()
}
