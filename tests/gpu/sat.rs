//! Exponents and planes equal the CPU's, word for word.

use crate::transfer::{Upload as _, read_sat};
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{Sat, Scan};
use octagloss_fixtures::adapters::{in_full, wait};
use octagloss_fixtures::common::{Look, Random, oem, sweep, texels};
use octagloss_gpu::stages::{fixed_point, sat_hensley, sat_scan};
use octagloss_gpu::{Context, OemPlanes, SatPlanes, Stage};

/// Describes which exponents and entries differ, in words; None if all are equal.
fn difference(
    expected: &Sat,
    fixed: octagloss_core::light::sat::FixedPoint,
    entries: &[[u64; 4]],
) -> Option<String> {
    if expected.fixed_point() != fixed {
        return Some(format!("exponents {fixed:?} for {:?}", expected.fixed_point()));
    }
    let side = expected.size().bordered() as usize;
    if entries.len() != expected.entries().len() {
        return Some(format!("{} entries for {}", entries.len(), expected.entries().len()));
    }
    let at = entries.iter().zip(expected.entries()).position(|(found, expected)| found != expected)?;
    Some(format!(
        "entry ({}, {}) is {:x?}, not {:x?}",
        at % side,
        at / side,
        entries[at],
        expected.entries()[at]
    ))
}

fn scanned(
    context: &Context,
    oem: &Oem,
    stage: impl Fn(&OemPlanes, &SatPlanes) -> Stage,
) -> (octagloss_core::light::sat::FixedPoint, Vec<[u64; 4]>) {
    let planes = OemPlanes::upload(context, oem).expect("small planes");
    let sat = SatPlanes::new(context, oem.size()).expect("small planes");
    let exponents = fixed_point::stage(context, &planes, &sat);
    let scan = stage(&planes, &sat);
    context.submit(|encoder| {
        exponents.record(encoder);
        scan.record(encoder);
    });
    wait(context, read_sat(context, &sat))
}

fn random_oem(random: &mut Random, size: OemSize, look: Look) -> Oem {
    oem(size, &texels(random, look, Layout::Octahedral { size: size.inner }))
}

const SIZES: [u32; 9] = [1, 2, 3, 5, 17, 64, 100, 257, 1024];

/// Compares the production scan over squares of `sizes` with the CPU's table.
pub(super) fn scan(context: &Context, sizes: &[u32]) {
    let mut random = Random::new(31);
    for &inner in sizes {
        // Of the largest square one border: it has all kinds of tiles.
        for border in if inner < 1000 { vec![0, 1, 7, inner / 2] } else { vec![7] } {
            let oem = random_oem(&mut random, OemSize { inner, border }, Look::Suns);
            let (fixed, entries) =
                scanned(context, &oem, |planes, sat| sat_scan::stage(context, planes, sat));
            let found = difference(&Sat::new(&oem, Scan::Blocks), fixed, &entries);
            assert_eq!(found, None, "{inner} + {border} on {}", context.describe());
        }
    }
}

/// Compares recursive doubling with each of `radices` over squares of `sizes` with the CPU's table.
pub(super) fn doubling(context: &Context, radices: &[u32], sizes: &[u32]) {
    let mut random = Random::new(32);
    for &radix in radices {
        for &inner in sizes {
            for border in [0, 1, 7, inner / 2] {
                let oem = random_oem(&mut random, OemSize { inner, border }, Look::Suns);
                let (fixed, entries) =
                    scanned(context, &oem, |planes, sat| sat_hensley::stage(context, radix, planes, sat));
                let found = difference(&Sat::new(&oem, Scan::Blocks), fixed, &entries);
                assert_eq!(found, None, "radix {radix}, {inner} + {border} on {}", context.describe());
            }
        }
    }
}

#[test]
fn production_scan_equals_the_cpu() {
    in_full("production scan", |context| scan(context, &SIZES));
}

#[test]
fn recursive_doubling_equals_the_cpu() {
    in_full("recursive doubling", |context| {
        doubling(context, &[2, 4, 8, 16], sweep(&[1, 2, 3, 17, 100], &[1, 2, 3, 17, 257]))
    });
}
