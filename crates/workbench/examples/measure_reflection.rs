//! Measures reflections of a pyramid against the oracle: `cargo run --release -p octagloss-workbench
//! --example measure_reflection -- PANORAMA...`; the environment's FRAMES is the number of frames of a cell,
//! 40 if unset, and ANISOTROPIC leaves out the isotropic cells. For each roughness, anisotropy and n.v, the
//! relRMSE of the worst channel over random frames (F = 1), of the median and the worst panorama; and
//! epsilon, rms error over rms truth, of frames whose reflection meets the brightest texel within 6 alpha.

#[path = "common/measure.rs"]
mod measure;

use glam::DVec3;
use measure::{Random, brightest, measures, median};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::analysis::oracle::reflection::reflection;
use octagloss_core::common::frame::Frame;
use octagloss_core::light::environment::Environment;
use octagloss_core::pyramid::reads;
use octagloss_core::pyramid::{Levels, Pyramid};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Texels along an edge of the map.
const SIZE: u32 = 512;

/// Roughness, anisotropy, n.v, and the goals for median and worst panorama; 0 where there is none.
const CELLS: [(f64, f64, f64, [f64; 2]); 35] = [
    (0.2, 0.0, 1.0, [0.0, 0.0]),
    (0.2, 0.0, 0.7, [0.02, 0.15]),
    (0.2, 0.0, 0.5, [0.02, 0.15]),
    (0.2, 0.0, 0.3, [0.05, 0.5]),
    (0.2, 0.0, 0.15, [0.05, 0.5]),
    (0.3, 0.0, 1.0, [0.0, 0.0]),
    (0.3, 0.0, 0.7, [0.01, 0.05]),
    (0.3, 0.0, 0.3, [0.015, 0.1]),
    (0.3, 0.0, 0.15, [0.035, 0.4]),
    (0.4, 0.0, 0.4, [0.0, 0.0]),
    (0.5, 0.0, 1.0, [0.0, 0.0]),
    (0.5, 0.0, 0.7, [0.01, 0.04]),
    (0.5, 0.0, 0.3, [0.015, 0.05]),
    (0.5, 0.0, 0.15, [0.02, 0.08]),
    (0.6, 0.0, 0.6, [0.0, 0.0]),
    (0.7, 0.0, 1.0, [0.0, 0.0]),
    (0.7, 0.0, 0.7, [0.012, 0.04]),
    (0.7, 0.0, 0.3, [0.018, 0.05]),
    (0.7, 0.0, 0.15, [0.02, 0.06]),
    (1.0, 0.0, 0.5, [0.0, 0.0]),
    (0.3, 0.5, 1.0, [0.0, 0.0]),
    (0.3, 0.5, 0.7, [0.05, 0.3]),
    (0.3, 0.5, 0.3, [0.05, 0.3]),
    (0.3, 0.5, 0.15, [0.0, 0.0]),
    (0.5, 0.5, 1.0, [0.0, 0.0]),
    (0.5, 0.5, 0.7, [0.05, 0.3]),
    (0.5, 0.5, 0.3, [0.05, 0.3]),
    (0.5, 0.5, 0.15, [0.0, 0.0]),
    (0.2, 0.3, 0.7, [0.0, 0.0]),
    (0.2, 0.5, 0.7, [0.0, 0.0]),
    (0.3, 0.1, 0.5, [0.0, 0.0]),
    (0.3, 0.2, 0.5, [0.0, 0.0]),
    (0.4, 0.3, 0.5, [0.0, 0.0]),
    (0.4, 0.8, 0.5, [0.0, 0.0]),
    (0.6, 1.0, 0.5, [0.0, 0.0]),
];

/// A frame of n.v whose mirror direction is `reflected`.
fn frame(random: &mut Random, reflected: DVec3, nv: f64) -> Frame {
    let aside = random.direction();
    let aside = (aside - reflected * aside.dot(reflected)).normalize();
    let normal = reflected * nv + aside * (1.0 - nv * nv).sqrt();
    let view = normal * (2.0 * nv) - reflected;
    Frame::new(normal, view, random.direction()).expect("finite")
}

fn main() {
    let frames: usize = std::env::var("FRAMES").ok().and_then(|count| count.parse().ok()).unwrap_or(40);
    let started = std::time::Instant::now();
    let levels = Levels::over(SIZE).expect("a size");
    let nodes = reads::table(levels).len();
    println!("table of {nodes} nodes: {:.3} s", started.elapsed().as_secs_f64());
    let only = std::env::var("ANISOTROPIC").is_ok();
    let cells: Vec<_> = CELLS.into_iter().filter(|cell| cell.1 > 0.0 || !only).collect();
    let mut rows = vec![(Vec::new(), Vec::new()); cells.len()];
    for path in std::env::args().skip(1) {
        let environment = Environment::read(&path).expect("a panorama");
        let pyramid = Pyramid::build(&environment, SIZE).expect("a power of two");
        let oracle = Oracle::new(&environment);
        let sun = brightest(&environment);
        let mut random = Random(7);
        for ((roughness, anisotropy, nv, _), (errors, epsilons)) in cells.iter().copied().zip(&mut rows) {
            let anywhere: Vec<Frame> = (0..frames)
                .map(|_| {
                    let reflected = random.direction();
                    frame(&mut random, reflected, nv)
                })
                .collect();
            let around: Vec<Frame> = (0..frames)
                .map(|_| {
                    let reflected = random.within(sun, (6.0 * roughness * roughness).min(TAU / 4.0));
                    frame(&mut random, reflected, nv)
                })
                .collect();
            let look = |frames: &[Frame]| {
                let found: Vec<DVec3> = frames
                    .par_iter()
                    .map(|f| pyramid.reflect(f, roughness as f32, anisotropy as f32, [1.0; 3], 1.0))
                    .map(|found| DVec3::from(found.map(f64::from)))
                    .collect();
                let truth: Vec<DVec3> = frames
                    .par_iter()
                    .map(|f| DVec3::from(reflection(&oracle, f, roughness, anisotropy)[0]))
                    .collect();
                measures(&found, &truth)
            };
            let [error, ..] = look(&anywhere);
            let [_, epsilon, _] = look(&around);
            errors.push(error);
            epsilons.push(epsilon);
        }
        println!(
            "{path}: {:?}",
            rows.iter()
                .map(|row| row.0.last().expect("a row"))
                .map(|e| (e * 1e4).round() / 1e4)
                .collect::<Vec<_>>()
        );
    }
    for ((roughness, anisotropy, nv, goal), (errors, epsilons)) in cells.iter().copied().zip(rows) {
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let (middle, worst) = (median(errors.clone()), most(&errors));
        let missed = goal[0] > 0.0 && (middle > goal[0] || worst > goal[1]);
        println!(
            "r {roughness:.2} a {anisotropy:.1} n.v {nv:.2}: {middle:.4} / {worst:.3} of {:.3} / {:.2}{}; \
             sun: {:.3} / {:.3}",
            goal[0],
            goal[1],
            if missed { " missed" } else { "" },
            median(epsilons.clone()),
            most(&epsilons)
        );
    }
}
