//! Roughness 0: the OEM's energy, bilinear between texel centres.

use crate::light::environment::Rgb;
use crate::light::oem::Oem;
use crate::sphere::octahedral::{oct_from_direction, solid_angle_density, wrap_texel};
use glam::DVec3;

/// Radiance along the unit vector `direction` in the OEM's space: the limit of lobes as roughness goes to 0.
///
/// c + sum over the four nearest texels of their share times (E - c w) over the solid angle of a texel's area
/// here, with c = `least` the least radiance of each channel in the OEM. A constant stays constant, and
/// energy is conserved.
pub fn radiance(oem: &Oem, least: Rgb, direction: DVec3) -> Rgb {
    let n = oem.size().inner;
    let uv = oct_from_direction(direction);
    let scale = f64::from(n) / 2.0;
    let at = (uv + 1.0) * scale - 0.5;
    let low = at.floor();
    let share = at - low;
    let texel = |dx: i64, dy: i64| {
        let (x, y) = wrap_texel(n, low.x as i64 + dx, low.y as i64 + dy);
        oem.texel(x, y).map(f64::from)
    };
    let corners = [
        (texel(0, 0), (1.0 - share.x) * (1.0 - share.y)),
        (texel(1, 0), share.x * (1.0 - share.y)),
        (texel(0, 1), (1.0 - share.x) * share.y),
        (texel(1, 1), share.x * share.y),
    ];
    let solid_angle = solid_angle_density(uv) / (scale * scale);
    std::array::from_fn(|c| {
        let least = f64::from(least[c]);
        let above: f64 = corners.iter().map(|(texel, share)| share * (texel[c] - least * texel[3])).sum();
        (least + above / solid_angle) as f32
    })
}
