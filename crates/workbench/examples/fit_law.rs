//! Finds the law by which the reads of anisotropic reflections stand: writes
//! `crates/core/src/pyramid/anisotropic/law.rs`, and its numbers in `shaders/common/anisotropic.wgsl`.
//!
//! ```text
//! cargo run --release -p octagloss-workbench --example fit_law [STEPS]
//! ```
//!
//! 110 steps by default: 60 s on one core. It lowers the sum over lobes of the logarithm of what a node's
//! fit leaves (`Fit` of `crates/core/src/pyramid/anisotropic.rs`), from the law of before. The same numbers
//! come of any number of threads. After a change, `tests/consumers/translate/run` translates the shader.

#[path = "common/descent.rs"]
mod descent;

use descent::Descent;
use glam::DVec2;
use octagloss_core::common::parallel;
use octagloss_core::pyramid::Levels;
use octagloss_core::pyramid::anisotropic::{Fit, LAW, Law, NODES, NUMBERS, TERMS, fit_of_node};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

/// Lobes, and the least and the greatest of their roughness, anisotropy and n.v. Thinner ones no row follows.
const LOBES: u32 = 480;
const ROUGHNESS: [f64; 2] = [0.15, 1.0];
const ANISOTROPY: [f64; 2] = [0.15, 0.9];
const COSINE: [f64; 2] = [0.1, 1.0];

/// Squares of the law's numbers count so much, constants aside: weights between nodes are interpolated, and
/// of two laws with the same error at nodes the one that changes less is better there.
const STIFFNESS: f64 = 3e-3;

/// The first rate.
const RATE: f64 = 0.08;

/// Where descent begins: a law of which no program is left. From plain rows (reads as wide as the lobe,
/// evenly spaced, or where the descent of isotropic ones begins) it ends where fits leave 1 to 6 % more, and
/// weights between nodes 6 to 18 %.
#[rustfmt::skip]
const START: Law = [
    [-0.822, -0.434, 0.191, 0.225, -0.113, -0.022, -0.153, -0.163, -0.008, 0.111, -0.063, -0.064],
    [-0.509, -0.287, 0.427, -0.088, 0.234, -0.052, -0.085, 0.361, 0.054, 0.157, 0.012, 0.191],
    [-0.565, -0.221, -0.153, -0.803, -0.329, 0.168, -0.066, -0.018, -0.016, 0.148, -0.022, 0.161],
    [0.284, 1.090, -0.036, -0.148, -0.071, -0.010, -0.058, -0.113, -0.009, -0.116, -0.045, -0.229],
    [-0.150, 0.374, 0.152, 0.064, -0.469, -0.105, 0.057, -0.678, 0.099, -0.303, 0.036, -0.038],
    [0.399, 0.142, -0.070, -0.052, -0.032, -0.014, -0.090, -0.173, 0.032, -0.020, 0.144, 0.075],
];

/// Units of the numbers that are written.
const UNITS: f64 = 1000.0;

/// A lobe of [`LOBES`]. They are spread as evenly as four axes allow, by multiples of powers of a root of
/// x^5 = x + 1 (Roberts 2018): over roughness in log(1 + 5 r) and over n.v in its root, as nodes are.
fn fit(levels: Levels, lobe: u32) -> Fit {
    let root = 1.167_303_978_261_418_7_f64;
    let [a, b, c, d] = [1, 2, 3, 4].map(|power| (0.5 + f64::from(lobe) * root.powi(-power)).fract());
    let between = |[from, to]: [f64; 2], share: f64| from + (to - from) * share;
    let roughness = between(ROUGHNESS.map(|roughness| (5.0 * roughness).ln_1p()), a).exp_m1() / 5.0;
    let cosine = between(COSINE.map(f64::sqrt), b).powi(2);
    let anisotropy = between(ANISOTROPY, d);
    let alpha = roughness * roughness;
    let along = alpha + (1.0 - alpha) * anisotropy * anisotropy;
    Fit::new(levels, DVec2::new(along, alpha), cosine, FRAC_PI_2 * c).for_places()
}

fn main() {
    let steps = descent::steps(110);
    let levels = Levels::over(512).expect("a size");
    let lobes = parallel::map(0..LOBES, |lobe| fit(levels, lobe));
    println!("the law so far: {}", errors(levels, &lobes, &LAW));
    let basis = basis(&lobes);
    // The numbers of the basis.
    let mut numbers = START.map(|own| in_basis(&basis, own));
    let mut descent = Descent::new(NUMBERS * TERMS, steps, RATE);
    for step in 1..=steps {
        let law = numbers.map(|own| in_terms(&basis, own));
        let slopes = parallel::map(&lobes, |fit| fit.slopes(&law));
        let mut down = law.map(|own| own.map(|number| 2.0 * STIFFNESS * f64::from(LOBES) * number));
        down.iter_mut().for_each(|down| down[0] = 0.0);
        let mut sum = 0.0;
        for (error, slopes) in &slopes {
            sum += error.ln();
            for (down, slope) in down.as_flattened_mut().iter_mut().zip(slopes.as_flattened()) {
                *down += slope / error;
            }
        }
        let down = down.map(|down| basis.map(|function| dot(&function, &down)));
        descent.step(numbers.as_flattened_mut(), down.as_flattened());
        if step % 10 == 0 {
            println!("{step}: {:.4}", sum / f64::from(LOBES));
        }
    }
    let rounded = |number: f64| (number * UNITS).round() / UNITS + 0.0;
    let law = numbers.map(|own| in_terms(&basis, own).map(rounded));
    println!("now: {}", errors(levels, &lobes, &law));
    std::fs::write("crates/core/src/pyramid/anisotropic/law.rs", text(&law)).expect("a file");
    let shader = "shaders/common/anisotropic.wgsl";
    let before = std::fs::read_to_string(shader).expect("the shader");
    std::fs::write(shader, in_shader(&before, &law)).expect("a file");
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Sums of the law's terms that are orthonormal over `lobes`, each of one term more: powers are nearly
/// dependent, and descent would be slow along them.
fn basis(lobes: &[Fit]) -> [[f64; TERMS]; TERMS] {
    let product = |a: &[f64; TERMS], b: &[f64; TERMS]| {
        lobes.iter().map(|fit| dot(a, &fit.terms()) * dot(b, &fit.terms())).sum::<f64>() / f64::from(LOBES)
    };
    let mut basis = [[0.0; TERMS]; TERMS];
    for k in 0..TERMS {
        let mut own = [0.0; TERMS];
        own[k] = 1.0;
        // Twice, for what rounding leaves.
        for other in [&basis[..k], &basis[..k]].concat() {
            let share = product(&own, &other);
            own.iter_mut().zip(other).for_each(|(own, other)| *own -= share * other);
        }
        let norm = product(&own, &own).sqrt();
        basis[k] = own.map(|number| number / norm);
    }
    basis
}

/// The numbers of the terms, by those of the `basis`.
fn in_terms(basis: &[[f64; TERMS]; TERMS], numbers: [f64; TERMS]) -> [f64; TERMS] {
    std::array::from_fn(|term| numbers.iter().zip(basis).map(|(number, own)| number * own[term]).sum())
}

/// The numbers of the `basis`, by those of the terms.
fn in_basis(basis: &[[f64; TERMS]; TERMS], mut left: [f64; TERMS]) -> [f64; TERMS] {
    let mut numbers = [0.0; TERMS];
    for k in (0..TERMS).rev() {
        numbers[k] = left[k] / basis[k][k];
        left.iter_mut().zip(basis[k]).for_each(|(left, own)| *left -= numbers[k] * own);
    }
    numbers
}

/// What fits by `law` leave: the mean logarithm at `lobes`; and the root at all nodes of the table.
fn errors(levels: Levels, lobes: &[Fit], law: &Law) -> String {
    let own = parallel::map(lobes, |fit| fit.slopes(law).0.ln());
    let mut nodes =
        parallel::values(NODES.iter().product(), |index| fit_of_node(levels, index).slopes(law).0.sqrt());
    nodes.sort_by(f64::total_cmp);
    let [median, most, worst] =
        [0.5, 0.9, 1.0].map(|share| nodes[((nodes.len() - 1) as f64 * share) as usize]);
    let mean = own.iter().sum::<f64>() / f64::from(LOBES);
    format!("{mean:.4}; at nodes {median:.4} in the median, {most:.4} in nine of ten, {worst:.4} at worst")
}

/// The law as Rust.
fn text(law: &Law) -> String {
    let mut text = "//! Made by `examples/fit_law.rs`.\n\nuse super::Law;\n\n\
                    /// Numbers of the terms: for the shift, step, bend, width, growth and alternation.\n\
                    #[rustfmt::skip]\n\
                    pub const LAW: Law = [\n"
        .to_owned();
    for own in law {
        writeln!(text, "    [{}],", own.map(|number| format!("{number:.3}")).join(", ")).expect("text");
    }
    text + "];\n"
}

/// The shader with `law` for its vectors of four numbers.
fn in_shader(shader: &str, law: &Law) -> String {
    let mut fours = law.as_flattened().chunks(4);
    let line = |line: &str| {
        let numbers = line.trim_start().strip_prefix("vec4<f32>(").and_then(|rest| rest.split_once(')'));
        match numbers {
            Some((numbers, after)) if numbers.split(", ").all(|number| number.parse::<f64>().is_ok()) => {
                let own = fours.next().expect("eighteen vectors").iter().map(|number| format!("{number:.3}"));
                let indent = &line[..line.len() - line.trim_start().len()];
                format!("{indent}vec4<f32>({}){after}\n", own.collect::<Vec<_>>().join(", "))
            }
            _ => format!("{line}\n"),
        }
    };
    let text = shader.lines().map(line).collect();
    assert!(fours.next().is_none(), "eighteen vectors");
    text
}
