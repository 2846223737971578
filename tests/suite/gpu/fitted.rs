//! The real-time tier: blurred tables equal the CPU's to the last bit, harmonics and radiance within what float32 allows.

use super::{UNIT, exceeds, wait, with_passes};
use crate::adaptive::{ask, reflector};
use crate::common::{Look, Random, environment, landmarks, oem, texels};
use glam::{DVec2, DVec3};
use octagloss::Layout;
use octagloss::bake::Filter;
use octagloss::cpu::blur::blurred;
use octagloss::fitted::triangle::triangle_from_oct;
use octagloss::fitted::{COUNTS, SoftBox, Table};
use octagloss::gpu::engine::Engine;
use octagloss::gpu::fitted::FittedTables;
use octagloss::gpu::{Context, OemPlanes, SatPlanes};
use octagloss::lobe::Lobe;
use octagloss::oem::{Oem, OemSize};
use octagloss::sat::{Sat, Scan};
use octagloss::sh;
use octagloss::sphere::octahedral::{direction_from_oct, oct_from_direction, wrap_texel};

/// The octaves whose tables are read over `inner` texels.
fn octaves(inner: u32) -> std::ops::RangeInclusive<u32> {
    1..=(inner / 4).ilog2().min(6)
}

fn random_oem(random: &mut Random, size: OemSize, look: Look) -> Oem {
    oem(size, &texels(random, look, Layout::Octahedral { size: size.inner }))
}

/// Tables over `oem`, all stages from its planes on run on the GPU.
fn tables(context: &Context, passes: &Engine, oem: &Oem, count: u32) -> FittedTables {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let sat = SatPlanes::new(context, oem.size()).expect("small planes");
    let tables = FittedTables::new(context, oem.size().inner, count).expect("small tables");
    let made =
        [passes.fixed_point.stage(context, &planes, &sat), passes.sat_scan.stage(context, &planes, &sat)];
    let after = passes.fitted_stages(&planes, &sat, &tables);
    context.submit(|encoder| made.iter().chain(&after).for_each(|stage| stage.record(encoder)));
    tables
}

/// The first entry of the bordered table that is not what the CPU's table says of the unfolded plane.
fn difference(expected: &Sat, entries: &[[u64; 4]], [inner, border]: [u32; 2]) -> Option<String> {
    assert_eq!(expected.size().inner, inner, "texels of the blurred square");
    let (n, b) = (i64::from(inner), i64::from(border));
    let side = n + 2 * b + 1;
    assert_eq!(entries.len() as i64, side * side, "entries");
    (0..side * side).find_map(|k| {
        let (x, y) = (k % side, k / side);
        let found = entries[k as usize];
        let expected = expected.plane_box(-b, -b, x - b, y - b);
        (found != expected).then(|| format!("entry ({x}, {y}): {found:x?}, not {expected:x?}"))
    })
}

#[test]
fn blurred_tables_are_the_cpu_s_to_the_last_bit() {
    with_passes("blurred tables", |context, passes| {
        let mut random = Random::new(91);
        for (inner, border) in [(16, 0), (32, 3), (64, 0), (128, 5), (256, 0)] {
            let size = OemSize { inner, border };
            for look in [Look::Noise, Look::Suns] {
                let oem = random_oem(&mut random, size, look);
                let sat = Sat::new(&oem, Scan::default());
                let tables = tables(context, passes, &oem, 4);
                for octave in octaves(inner) {
                    let expected = blurred(&sat, octave);
                    let (mut entries, size) = wait(context, tables.read_blurred(context, octave));
                    let wrong = difference(&expected, &entries, size);
                    assert_eq!(
                        wrong,
                        None,
                        "{look:?} {inner} + {border} octave {octave} on {}",
                        context.describe()
                    );
                    // One unit of one channel of one entry shows.
                    let at = random.below(entries.len() as u32) as usize;
                    entries[at][random.below(4) as usize] ^= 1;
                    assert!(difference(&expected, &entries, size).is_some(), "one wrong bit");
                }
            }
        }
    });
}

/// The first coefficient that is further from the CPU's than float32 sums are.
fn harmonics_difference(expected: &[[f64; 4]; 25], found: &[[f64; 4]; 25]) -> Option<String> {
    (0..25).flat_map(|k| (0..4).map(move |c| (k, c))).find_map(|(k, c)| {
        let (e, f) = (expected[k][c], found[k][c]);
        // Each term takes 24 roundings, its basis of at most sqrt((2n + 1)/4pi) among them, and then goes through 128
        // sums of a batch, 4 of a workgroup and 128 of all; the integral of the basis is at most that of its greatest value.
        let order = (k as f64).sqrt().floor();
        let total = expected[0][c] * (4.0 * std::f64::consts::PI).sqrt();
        let bound =
            (24.0 + 260.0) * UNIT * total * ((2.0 * order + 1.0) / (4.0 * std::f64::consts::PI)).sqrt();
        exceeds((e - f).abs(), bound)
            .then(|| format!("coefficient {k}, channel {c}: {f}, not {e} within {bound}"))
    })
}

#[test]
fn harmonics_are_the_cpu_s() {
    with_passes("harmonics", |context, passes| {
        let mut random = Random::new(92);
        for (inner, border) in [(16, 0), (64, 7), (512, 0)] {
            for look in [Look::Noise, Look::Suns, Look::Lone] {
                let oem = random_oem(&mut random, OemSize { inner, border }, look);
                let sat = Sat::new(&oem, Scan::default());
                let tables = tables(context, passes, &oem, 4);
                let expected = sh::table_harmonics(&sat);
                let mut found = wait(context, tables.read_harmonics(context, sat.fixed_point()));
                let wrong = harmonics_difference(&expected, &found);
                assert_eq!(wrong, None, "{look:?} {inner} + {border} on {}", context.describe());
                found[7][1] += 1e-4 * expected[0][1];
                assert!(harmonics_difference(&expected, &found).is_some(), "a ten-thousandth shows");
            }
        }
    });
}

#[test]
fn probe() {
    with_passes("probe", |context, passes| {
        let mut random = Random::new(93);
        for (inner, look) in [(16, Look::Noise), (64, Look::Smooth), (64, Look::Suns), (256, Look::Noise)] {
            let layout = Layout::Octahedral { size: inner };
            let source = environment(layout, texels(&mut random, look, layout));
            let cpu = reflector(&source, inner);
            let mut directions = landmarks();
            directions.extend((0..200).map(|_| random.direction()));
            let peak = cpu.oem().texels().iter().map(|t| f64::from(t[0] / t[3])).fold(0.0, f64::max);
            let tables = tables(context, passes, cpu.oem(), 4);
            for count in COUNTS {
                tables.set_count(context, count).expect("a count");
                for roughness in [0.0, 0.05, 0.13, 0.2, 0.3, 0.33, 0.5, 0.6, 0.7, 0.8, 1.0] {
                    let queries: Vec<_> = directions.iter().map(|d| (*d, roughness)).collect();
                    let found = wait(context, passes.fitted.radiance(context, &tables, &queries));
                    let expected = ask(&cpu, Lobe::Ggx, roughness, Filter::Fitted(count), &directions);
                    let mut worst = (0.0_f64, 0.0, 0.0, DVec3::ZERO);
                    for ((d, e), f) in directions.iter().zip(&expected).zip(&found) {
                        let off = (e[0] - f64::from(f[0])).abs();
                        if !(off <= worst.0) {
                            worst = (off, e[0], f64::from(f[0]), *d);
                        }
                    }
                    println!(
                        "{look:?} {inner} fitted:{count} {roughness}: off {:e} of {} ({}) at {}; of peak {:e} units",
                        worst.0,
                        worst.1,
                        worst.2,
                        worst.3,
                        worst.0 / peak / UNIT
                    );
                }
            }
        }
    });
}
