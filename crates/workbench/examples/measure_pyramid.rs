//! Measures the pyramid against exhaustive sums over panoramas: `cargo run --release -p octagloss-workbench
//! --example measure_pyramid -- PANORAMA...`. Prints, for each roughness, the relRMSE of the worst channel at
//! random directions; epsilon and the greatest error over the peak within 6 alpha of the brightest texel;
//! with `--cones` the error around +-X and +-Z over that elsewhere, over 20 rotations; with `--cube` all of
//! that on cubes.

#[path = "common/measure.rs"]
mod measure;

use glam::{DMat3, DQuat, DVec3};
use measure::{Random, brightest, measures, median};
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::OemSize;
use octagloss_core::pyramid::Pyramid;
use octagloss_core::sphere::octahedral::{direction_from_oct, texel_centre};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

const ROUGHNESS: [f64; 12] = [0.07, 0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0];

/// Texels along an edge of the map.
const SIZE: u32 = 512;

fn rotation(random: &mut Random) -> DMat3 {
    let arc = DQuat::from_rotation_arc(DVec3::Y, random.direction());
    DMat3::from_quat(arc * DQuat::from_rotation_y(TAU * random.unit()))
}

/// Mean radiance under the lobe of `roughness`: texels are constant, and points of texels near the lobe are
/// summed, as in `verify_bake.py`.
fn truth(environment: &Environment, roughness: f64, direction: DVec3) -> DVec3 {
    let Layout::Panorama { width, height } = environment.layout() else { panic!("a panorama") };
    let fine = match roughness {
        ..0.12 => 7,
        0.12..0.2 => 5,
        0.2..0.35 => 3,
        _ => 1,
    };
    let a2 = roughness.powi(4);
    let kernel = |cosine: f64| cosine.max(0.0) / (1.0 + (a2 - 1.0) * (1.0 + cosine) / 2.0).powi(2);
    // Points of a row, and of a column: what they add to the cosine, and the row's solid angle.
    let columns = |points: u32| -> Vec<f64> {
        let angle = |x: u32| TAU * ((f64::from(x) + 0.5) / f64::from(width * points) - 0.5);
        (0..width * points).map(|x| direction.dot(DVec3::new(angle(x).cos(), 0.0, angle(x).sin()))).collect()
    };
    let rows = |points: u32| -> Vec<[f64; 3]> {
        let angle = |y: f64| PI * y / f64::from(height * points);
        let row = |y: f64| {
            [angle(y + 0.5).sin(), direction.y * angle(y + 0.5).cos(), angle(y).cos() - angle(y + 1.0).cos()]
        };
        (0..height * points).map(|y| row(f64::from(y))).collect()
    };
    let (centre_columns, centre_rows) = (columns(1), rows(1));
    let (fine_columns, fine_rows) = (columns(fine), rows(fine));
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for (y, [sine, up, area]) in centre_rows.into_iter().enumerate() {
        for (x, along) in centre_columns.iter().enumerate() {
            let cosine = sine * along + up;
            let weight = if cosine > 0.8 && fine > 1 {
                let fine = fine as usize;
                let mut weight = 0.0;
                for [sine, up, area] in &fine_rows[y * fine..(y + 1) * fine] {
                    let row = fine_columns[x * fine..(x + 1) * fine].iter();
                    weight += area * row.map(|along| kernel(sine * along + up)).sum::<f64>();
                }
                weight / fine as f64
            } else {
                area * kernel(cosine)
            };
            let texel = environment.texels()[y * width as usize + x];
            sum += weight * DVec3::from_array(texel.map(f64::from));
            total += weight;
        }
    }
    sum / total
}

/// The greatest jump of slope over the greatest slope along a line of pixels of a sphere, 600 pixels wide,
/// whose reflection passes through `sun`: the second differences that the truth does not have.
fn kinks(pyramid: &Pyramid, environment: &Environment, roughness: f64, sun: DVec3) -> f64 {
    // The sun is reflected a quarter from the left.
    let view = (sun + DVec3::new(0.3, 0.5, 0.8).cross(sun).normalize()).normalize();
    let normal = (sun + view).normalize();
    let across = (normal - view * normal.dot(view)).normalize();
    let up = view.cross(across);
    let directions: Vec<DVec3> = (0..600)
        .map(|pixel| (f64::from(pixel) + 0.5) / 300.0 - 1.0)
        .map(|x| {
            let y = 0.013;
            let normal = across * x + up * y + view * (1.0_f64 - x * x - y * y).max(0.0).sqrt();
            (normal * (2.0 * normal.dot(view)) - view).normalize()
        })
        .collect();
    let luminance = |rgb: DVec3| rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let truth: Vec<f64> =
        directions.par_iter().map(|direction| luminance(truth(environment, roughness, *direction))).collect();
    let lobes = pyramid.lobes(roughness as f32);
    let found = directions
        .iter()
        .map(|direction| luminance(DVec3::from_array(lobes.radiance(*direction).map(f64::from))));
    let off: Vec<f64> = found.zip(&truth).map(|(found, truth)| found - truth).collect();
    let slope = truth.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    off.windows(3).map(|three| (three[0] - 2.0 * three[1] + three[2]).abs()).fold(0.0, f64::max) / slope
}

/// `environment` seen in turned axes, as an octahedral map: means of 16 points a texel.
fn turned(environment: &Environment, source_from_map: DMat3) -> Environment {
    let Layout::Panorama { width, height } = environment.layout() else { panic!("a panorama") };
    let texels = (0..SIZE * SIZE)
        .into_par_iter()
        .map(|k| {
            let mut sum = DVec3::ZERO;
            for point in 0..16 {
                let at = [k % SIZE * 4 + point % 4, k / SIZE * 4 + point / 4];
                let to = source_from_map * direction_from_oct(texel_centre(4 * SIZE, at[0], at[1]));
                let x = (to.z.atan2(to.x) / TAU + 0.5) * f64::from(width);
                let y = to.y.clamp(-1.0, 1.0).acos() / PI * f64::from(height);
                let place = (y as u32).min(height - 1) * width + (x as u32).min(width - 1);
                sum += DVec3::from_array(environment.texels()[place as usize].map(f64::from)) / 16.0;
            }
            sum.to_array().map(|value| value as f32)
        })
        .collect();
    Environment::new(Layout::Octahedral { size: SIZE }, texels).expect("a map")
}

/// CPU time of this process so far, on Linux.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks = text.split_whitespace().skip(13).take(2).filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}

fn main() {
    let (mut cones, mut cube) = (false, false);
    let mut paths = Vec::new();
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--cones" => cones = true,
            "--cube" => cube = true,
            _ => paths.push(argument),
        }
    }
    let on_map = |pyramid: Pyramid| if cube { pyramid.on_cubes() } else { pyramid };
    let mut random_rows = vec![Vec::new(); ROUGHNESS.len()];
    let mut cone_rows = vec![Vec::new(); ROUGHNESS.len()];
    // Epsilon, greatest error over the peak, kinks.
    let mut sun_rows = vec![[const { Vec::new() }; 3]; ROUGHNESS.len()];
    for path in &paths {
        let environment = Environment::read(path).expect("a panorama");
        let start = Instant::now();
        let oem = oem_from_environment(&environment, OemSize { inner: SIZE, border: 0 }).expect("small");
        let between = Instant::now();
        let cpu = cpu_seconds();
        let pyramid = on_map(Pyramid::of_oem(&oem).expect("a power of two"));
        let cpu = cpu_seconds() - cpu;
        println!(
            "{path}: map {:.3} s, pyramid {:.3} s, {cpu:.3} s of CPUs",
            (between - start).as_secs_f64(),
            between.elapsed().as_secs_f64()
        );
        let sun = brightest(&environment);
        let mut random = Random(7);
        let anywhere: Vec<DVec3> = (0..300).map(|_| random.direction()).collect();
        for (k, roughness) in ROUGHNESS.into_iter().enumerate() {
            let lobes = pyramid.lobes(roughness as f32);
            let look = |direction: &DVec3| DVec3::from_array(lobes.radiance(*direction).map(f64::from));
            let exact = |directions: &[DVec3]| -> Vec<DVec3> {
                directions.par_iter().map(|direction| truth(&environment, roughness, *direction)).collect()
            };
            let true_anywhere = exact(&anywhere);
            let found: Vec<DVec3> = anywhere.iter().map(look).collect();
            let [relative, ..] = measures(&found, &true_anywhere);
            random_rows[k].push(relative);
            let around: Vec<DVec3> =
                (0..500).map(|_| random.within(sun, (6.0 * roughness * roughness).min(TAU / 4.0))).collect();
            let true_around = exact(&around);
            let found: Vec<DVec3> = around.iter().map(look).collect();
            let [_, epsilon, peak] = measures(&found, &true_around);
            let kinks = kinks(&pyramid, &environment, roughness, sun);
            println!(
                "  r {roughness:4.2} random {relative:.4}, \
                 sun: epsilon {epsilon:.4} of peak {peak:.4} kinks {kinks:.3}"
            );
            sun_rows[k].iter_mut().zip([epsilon, peak, kinks]).for_each(|(row, own)| row.push(own));
        }
        if cones {
            let mut near = vec![(Vec::new(), Vec::new()); ROUGHNESS.len()];
            let mut far = near.clone();
            for _ in 0..20 {
                let rotation = rotation(&mut random);
                let turned = turned(&environment, rotation);
                let pyramid = on_map(Pyramid::build(&turned, SIZE).expect("a pyramid"));
                let cones: Vec<DVec3> = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z]
                    .into_iter()
                    .map(|cone| random.within(cone, 0.2))
                    .collect();
                let elsewhere: Vec<DVec3> = (0..4).map(|_| random.direction()).collect();
                for (k, roughness) in ROUGHNESS.into_iter().enumerate() {
                    let lobes = pyramid.lobes(roughness as f32);
                    for (rows, directions) in [(&mut near[k], &cones), (&mut far[k], &elsewhere)] {
                        for direction in directions {
                            let found = lobes.radiance(*direction);
                            rows.0.push(DVec3::from_array(found.map(f64::from)));
                            rows.1.push(truth(&environment, roughness, rotation * *direction));
                        }
                    }
                }
            }
            for (k, roughness) in ROUGHNESS.into_iter().enumerate() {
                let ratio = measures(&near[k].0, &near[k].1)[1] / measures(&far[k].0, &far[k].1)[1];
                println!("  r {roughness:4.2} around +-X, +-Z over elsewhere: {ratio:.3}");
                cone_rows[k].push(ratio);
            }
        }
    }
    for (k, roughness) in ROUGHNESS.into_iter().enumerate() {
        let most = random_rows[k].iter().copied().fold(0.0, f64::max);
        print!("r {roughness:4.2}: median {:.4} worst {most:.4}", median(random_rows[k].clone()));
        for (name, row) in ["epsilon", "of peak", "kinks"].into_iter().zip(&sun_rows[k]) {
            print!("; {name} {:.4} {:.4}", median(row.clone()), row.iter().copied().fold(0.0, f64::max));
        }
        if cones {
            print!("; cones {:.3}", median(cone_rows[k].clone()));
        }
        println!();
    }
}
