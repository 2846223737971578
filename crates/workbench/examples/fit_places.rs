//! Finds where the reads of isotropic reflections stand and how wide they are: improves
//! `crates/core/src/pyramid/places.csv`.
//!
//! ```text
//! cargo run --release -p octagloss-workbench --example fit_places [STEPS]
//! ```
//!
//! 400 steps by default: 2.5 minutes on two cores. It lowers the sum over views of the logarithm of what a
//! node's fit leaves (`Fit` of `crates/core/src/pyramid/reads.rs`), by Adam (Kingma and Ba 2015), from the
//! table that is there.

#[path = "common/descent.rs"]
mod descent;

use descent::Descent;
use octagloss_core::pyramid::Levels;
use octagloss_core::pyramid::places::{CONTROLS, NUMBERS, READS, from_controls, numbers, places, shares};
use octagloss_core::pyramid::reads::Fit;
use rayon::prelude::*;

/// Views: evenly over the splines, between roughness .06 and 1 and n.v .05 and 1.
const VIEWS: [u32; 2] = [56, 28];

/// Bends of the splines count so much, times the square of alpha, of which the other is the least. Wide lobes
/// are fitted as well by places far apart, and with less these jump: what is read between two nodes was off
/// by up to three times what nodes are. Sharp lobes have no such choice.
const STIFFNESS: f64 = 1.6;
const LEAST_SQUARE: f64 = 8e-4;

/// Where control point `at` of `count` stands.
fn place(at: usize, count: usize) -> f64 {
    ((at as f64 - 1.0) / (count - 3) as f64).clamp(0.0, 1.0)
}

/// Roughness at a place of the splines.
fn roughness_of(place: f64) -> f64 {
    (11_f64.powf(place) - 1.0) / 10.0
}

/// Alpha of the control points `across`.
fn alpha(across: usize) -> f64 {
    roughness_of(place(across, CONTROLS[0])).powi(2)
}

/// A control point's numbers, and what they become.
type Controls = Vec<[f64; NUMBERS]>;

fn main() {
    let steps = descent::steps(400);
    let levels = Levels::over(512).expect("a size");
    let fits: Vec<(Fit, f64, f64)> = (0..VIEWS[0] * VIEWS[1])
        .into_par_iter()
        .map(|k| {
            let [x, y] = [k % VIEWS[0], k / VIEWS[0]];
            let [x, y] = [(x, VIEWS[0]), (y, VIEWS[1])].map(|(x, n)| f64::from(x) / f64::from(n - 1));
            let least = 1.6_f64.ln() / 11_f64.ln();
            let roughness = roughness_of(least + (1.0 - least) * x);
            let cosine = 0.05_f64.powf(0.98 * (1.0 - y)).min(0.995);
            (Fit::new(levels, roughness, cosine).for_places(), roughness, cosine)
        })
        .collect();
    let errors =
        fits.par_iter().map(|(fit, roughness, cosine)| fit.slopes(&places(*roughness, *cosine)).0.ln());
    println!("the table so far: {:.4}", errors.sum::<f64>() / fits.len() as f64);
    let mut controls: Controls = (0..CONTROLS[0] * CONTROLS[1]).map(numbers).collect();
    let mut descent = Descent::new(controls.as_flattened().len(), steps, 0.02);
    for step in 1..=steps {
        let slopes: Vec<(f64, [f64; NUMBERS])> = fits
            .par_iter()
            .map(|(fit, roughness, cosine)| {
                fit.slopes(&from_controls(|control| controls[control], *roughness, *cosine))
            })
            .collect();
        let mut down = bends(&controls);
        let mut sum = 0.0;
        for ((error, slopes), (_, roughness, cosine)) in slopes.iter().zip(&fits) {
            sum += error.ln();
            for (control, share) in shares(*roughness, *cosine) {
                down[control].iter_mut().zip(slopes).for_each(|(down, slope)| *down += share * slope / error);
            }
        }
        descent.step(controls.as_flattened_mut(), down.as_flattened());
        if step % 50 == 0 {
            println!("{step}: {:.4}", sum / fits.len() as f64);
        }
    }
    std::fs::write("crates/core/src/pyramid/places.csv", text(&controls)).expect("a file");
}

/// Slopes of the splines' bends: squared second differences along both axes.
fn bends(controls: &Controls) -> Controls {
    let mut down = vec![[0.0; NUMBERS]; controls.len()];
    let [across, up] = CONTROLS;
    for k in 0..controls.len() {
        let inner = [(k % across, across, 1), (k / across, up, across)];
        let stiffness = STIFFNESS * alpha(k % across).powi(2).max(LEAST_SQUARE);
        for (_, _, step) in inner.into_iter().filter(|(at, count, _)| (1..count - 1).contains(at)) {
            for c in 0..NUMBERS {
                let bend = controls[k - step][c] - 2.0 * controls[k][c] + controls[k + step][c];
                down[k - step][c] += 2.0 * stiffness * bend;
                down[k][c] -= 4.0 * stiffness * bend;
                down[k + step][c] += 2.0 * stiffness * bend;
            }
        }
    }
    down
}

/// The table as CSV, of three decimals.
fn text(controls: &Controls) -> String {
    let names = ["slope", "log width"].map(|name| (1..=READS).map(move |read| format!("{name} {read}")));
    let mut text = names.into_iter().flatten().collect::<Vec<_>>().join(",") + "\n";
    for control in controls {
        text += &(control.map(|number| format!("{number:.3}")).join(",") + "\n");
    }
    text
}
