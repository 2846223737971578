//! Panorama to panorama: rotations are about the polar axis only, so rows and columns separate.

use crate::common::parallel;
use crate::light::environment::{Environment, Rgb};
use std::f64::consts::{PI, TAU};

/// Mean radiance of `environment`, a panorama of `source_width` x `source_height`, over every texel of
/// another panorama in the world.
pub(super) fn mean_radiances(
    environment: &Environment,
    [source_width, source_height]: [u32; 2],
    [width, height]: [u32; 2],
) -> Vec<Rgb> {
    // Longitude in the source runs with the world's, or against it if the source is mirrored.
    let turn = environment.source_from_world();
    let first = turn.x_axis.z.atan2(turn.x_axis.x) / TAU;
    let sense = (turn.x_axis.x * turn.z_axis.z - turn.z_axis.x * turn.x_axis.z).signum();
    let columns: Vec<Vec<(usize, f64)>> = (0..width)
        .map(|i| {
            let place = |k: u32| {
                let longitude = first + sense * (f64::from(k) / f64::from(width) - 0.5);
                snapped((longitude + 0.5) * f64::from(source_width))
            };
            let (a, b) = (place(i), place(i + 1));
            spans(a.min(b), a.max(b))
                .map(|(k, from, to)| (k.rem_euclid(i64::from(source_width)) as usize, to - from))
                .collect()
        })
        .collect();
    let rows: Vec<Vec<(usize, f64)>> = (0..height)
        .map(|j| {
            let place = |k: u32| snapped(f64::from(k) / f64::from(height) * f64::from(source_height));
            // Solid angle between parallels, as a product: no cancellation at the poles.
            let band = |a: f64, b: f64| {
                let [a, b] = [a, b].map(|k| k / f64::from(source_height) * PI);
                2.0 * ((a + b) / 2.0).sin() * ((b - a) / 2.0).sin()
            };
            spans(place(j), place(j + 1)).map(|(k, a, b)| (k as usize, band(a, b))).collect()
        })
        .collect();
    let texel = |row: &[(usize, f64)], column: &[(usize, f64)]| {
        let (mut sums, mut total) = ([0.0_f64; 3], 0.0);
        for (j, height) in row {
            for (i, width) in column {
                let weight = height * width;
                total += weight;
                let radiance = environment.texels()[j * source_width as usize + i];
                for (sum, value) in sums.iter_mut().zip(radiance) {
                    *sum += weight * f64::from(value);
                }
            }
        }
        sums.map(|sum| (sum / total) as f32)
    };
    parallel::map(&rows, |row| columns.iter().map(|column| texel(row, column)).collect::<Vec<Rgb>>()).concat()
}

/// Snaps a position to a texel edge within rounding.
fn snapped(place: f64) -> f64 {
    if (place - place.round()).abs() < 1e-9 { place.round() } else { place }
}

/// The texels between `a` and `b`, with the overlapped part of each.
fn spans(a: f64, b: f64) -> impl Iterator<Item = (i64, f64, f64)> {
    let (first, last) = (a.floor() as i64, b.ceil() as i64);
    (first..last.max(first + 1)).map(move |k| (k, a.max(k as f64), b.min((k + 1) as f64)))
}
