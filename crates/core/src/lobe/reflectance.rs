//! What rough surfaces reflect of a white world: GGX with height-correlated Smith visibility (Heitz 2014) and
//! Schlick's Fresnel, and Charlie with Neubelt's visibility, by quadrature over half vectors.

use crate::sphere::quadrature::gauss_legendre;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::sync::LazyLock;

/// Nodes of [`ggx_albedo`]: twice as many differ by less than 1e-4, or 3e-4 where n.v is below 0.02.
pub(crate) const ALBEDO_NODES: u32 = 32;

/// [`ggx`] by [`ALBEDO_NODES`].
pub(crate) fn ggx_albedo(cosine: f64, roughness: f64) -> [f64; 2] {
    static RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| gauss_legendre(ALBEDO_NODES));
    ggx(cosine, roughness, &RULE)
}

/// Scale and bias of f0 for GGX at the view's `cosine` in (0, 1] and the perceptual `roughness` in \[0, 1\]:
/// what it reflects of a white world, without and with the factor (1 - v.h)^5, the second taken from the
/// first. `rule` is a Gauss-Legendre rule over \[0, 1\].
pub(crate) fn ggx(cosine: f64, roughness: f64, rule: &[(f64, f64)]) -> [f64; 2] {
    let alpha = roughness * roughness;
    let fresnel = (1.0 - cosine).powi(5);
    // Below this alpha the lobe is a mirror to nine digits.
    if alpha < 1e-9 {
        return [1.0 - fresnel, fresnel];
    }
    let a2 = alpha * alpha;
    let smith = |z: f64| (z * z * (1.0 - a2) + a2).sqrt();
    let smith_view = smith(cosine);
    // Coordinate of the distribution, w = tan^2/(tan^2 + alpha^2): D cos dw_h becomes dw dphi/(2 pi).
    let from_angle = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        sin * sin / (sin * sin + a2 * cos * cos)
    };
    let to_angle = |w: f64| (a2 * w).sqrt().atan2((1.0 - w).max(0.0).sqrt());
    integrate(
        cosine,
        rule,
        from_angle,
        to_angle,
        |_| 1.0,
        |half| {
            let visibility = 0.5 / (half.light * smith_view + cosine * smith(half.light));
            let weight = 4.0 * visibility * half.light * half.view / half.normal / (2.0 * PI);
            let bias = (1.0 - half.view).max(0.0).powi(5);
            [weight * (1.0 - bias), weight * bias]
        },
    )
}

/// The reflectance of a Charlie lobe at the perceptual sheen `roughness`, likewise.
pub(crate) fn charlie(cosine: f64, roughness: f64, rule: &[(f64, f64)]) -> f64 {
    // Clamped as in Khronos's shader.
    let alpha = roughness.max(1e-3).powi(2);
    let scale = (2.0 + 1.0 / alpha) / (2.0 * PI);
    let ring = |sin: f64| 4.0 * scale * sin.powf(1.0 / alpha) * sin;
    let sum = integrate(
        cosine,
        rule,
        |theta| theta,
        |theta| theta,
        ring,
        |half| {
            let visibility = 1.0 / (4.0 * (half.light + cosine - half.light * cosine));
            [visibility * half.light * half.view, 0.0]
        },
    );
    sum[0]
}

/// Cosines of a half vector to the normal and to the view (and light), and of the light to the normal.
struct Half {
    normal: f64,
    view: f64,
    light: f64,
}

/// Integrates `ring` times `f` dw dphi over all half vectors whose light is above the horizon. `w` is a
/// coordinate of the half vector's angle; `ring` holds the factors that depend only on that angle, given its
/// sine.
///
/// With the view at angle v, half vectors up to (pi/2 - v)/2 have all their lights above the horizon, those
/// beyond (pi/2 + v)/2 none, and those between up to an azimuth. Each piece is smooth inside with square-root
/// behaviour at the ends, which cosine-spaced nodes remove.
fn integrate(
    cosine: f64,
    rule: &[(f64, f64)],
    from_angle: impl Fn(f64) -> f64,
    to_angle: impl Fn(f64) -> f64,
    ring: impl Fn(f64) -> f64,
    f: impl Fn(Half) -> [f64; 2],
) -> [f64; 2] {
    let view_angle = cosine.clamp(0.0, 1.0).acos();
    let view_sin = (1.0 - cosine * cosine).max(0.0).sqrt();
    let [first, last] = [FRAC_PI_4 - view_angle / 2.0, FRAC_PI_4 + view_angle / 2.0];
    // At grazing views visibility changes on the scale of the first end, which is far below the second.
    let between = std::iter::successors(Some(first * 4.0), |end| Some(end * 4.0));
    let mut ends = vec![0.0, from_angle(first)];
    ends.extend(between.take_while(|end| first > 1e-9 && *end < last).map(&from_angle));
    ends.push(from_angle(last));
    // Azimuths use the same spacing, because visibility rises steeply from the horizon at grazing views.
    let spaced: Vec<(f64, f64)> = rule
        .iter()
        .map(|(x, weight)| ((1.0 - (PI * x).cos()) / 2.0, weight * FRAC_PI_2 * (PI * x).sin()))
        .collect();
    let mut sum = [0.0; 2];
    for piece in ends.windows(2).filter(|piece| piece[1] > piece[0]) {
        for &(t, t_weight) in &spaced {
            let w = piece[0] + (piece[1] - piece[0]) * t;
            let (sin, normal) = to_angle(w).sin_cos();
            let w_weight = t_weight * (piece[1] - piece[0]) * ring(sin);
            // The light is above the horizon if the azimuth's cosine is greater than this.
            let least = (cosine / (2.0 * normal) - cosine * normal) / (view_sin * sin);
            let widest = if least.is_nan() { PI } else { least.clamp(-1.0, 1.0).acos() };
            for &(share, share_weight) in &spaced {
                let view = view_sin * sin * (widest * share).cos() + cosine * normal;
                let light = (2.0 * view * normal - cosine).max(0.0);
                let weight = 2.0 * w_weight * share_weight * widest;
                let values = f(Half { normal, view: view.clamp(0.0, 1.0), light: light.min(1.0) });
                sum = [sum[0] + weight * values[0], sum[1] + weight * values[1]];
            }
        }
    }
    sum
}
