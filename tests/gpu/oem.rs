//! Gathering of OEMs and footprints: within a derived bound of the CPU's.

use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::geometry::footprints::footprints_over;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_fixtures::adapters::{exceeds, in_full, wait};
use octagloss_fixtures::common::{Look, Random, environment, texels};
use octagloss_gpu::device::readback;
use octagloss_gpu::stages::reparameterise::{self, upload};
use octagloss_gpu::{Context, OemPlanes};

/// Both engines add the same products, the CPU in double precision. In float32 a term takes two products.
/// Sums of 64 and then of n/64 parts take at most 64 + n/64 roundings, in the energy and in the solid angle
/// that divides it. The quotients (2.5 ulp each, one shared) and the last product make 8. All terms are
/// positive, so the relative error of the result is as many parts in 2^24.
fn bound(sources_a_texel: f64) -> f64 {
    let sum = 64.0_f64.min(sources_a_texel) + sources_a_texel / 64.0;
    (8.0 + 2.0 * sum) / f64::from(1_u32 << 24)
}

/// Error of the CPU's outlines over fine panoramas: 3e-5 of a texel's area at each of its four edges
/// (crates/core/src/geometry/overlap/sweep.rs), filled with the brightest radiance at worst. The GPU uses no
/// outlines.
fn misplaced(environment: &Environment) -> f64 {
    let brightest = environment.texels().iter().flatten().fold(0.0_f32, |most, value| most.max(*value));
    match environment.layout() {
        Layout::Panorama { height: 256.., .. } => 1.2e-4 * f64::from(brightest),
        _ => 0.0,
    }
}

/// Returns the first texel where `found` differs from `expected` by more than `bound` of it plus `misplaced`.
fn difference(expected: &[[f32; 4]], found: &[[f32; 4]], bound: f64, misplaced: f64) -> Option<String> {
    assert_eq!(expected.len(), found.len(), "texels");
    expected.iter().zip(found).enumerate().find_map(|(at, (expected, found))| {
        let area = f64::from(expected[3]);
        let far = (0..4).any(|c| {
            let (e, f) = (f64::from(expected[c]), f64::from(found[c]));
            let misplaced = if c < 3 { misplaced * area } else { 0.0 };
            // Subnormal products may become 0.
            exceeds((e - f).abs(), bound * e + misplaced + 2.4e-38)
        });
        far.then(|| format!("texel {at} is {found:?}, not {expected:?} within {bound:e}"))
    })
}

fn gathered(context: &Context, environment: &Environment, size: OemSize) -> Oem {
    let texture = upload(context, environment).expect("a small texture");
    let planes = OemPlanes::new(context, size).expect("small planes");
    let stage =
        reparameterise::stage(context, environment.layout(), &texture, &planes).expect("a small matrix");
    context.submit(|encoder| stage.record(encoder));
    wait(context, planes.read(context))
}

const LAYOUTS: [Layout; 7] = [
    Layout::Panorama { width: 64, height: 32 },
    Layout::Panorama { width: 33, height: 17 },
    Layout::Panorama { width: 512, height: 256 },
    Layout::Cube { size: 32 },
    Layout::Cube { size: 7 },
    Layout::Octahedral { size: 24 },
    Layout::Octahedral { size: 9 },
];

/// Compares maps of `sizes` (inner texels and border) from environments of `layouts` with the CPU's.
pub(super) fn maps(context: &Context, layouts: &[Layout], sizes: &[(u32, u32)]) {
    let mut random = Random::new(41);
    for &layout in layouts {
        for look in [Look::Noise, Look::Suns] {
            let environment = environment(layout, texels(&mut random, look, layout));
            for &(inner, border) in sizes {
                let size = OemSize { inner, border };
                let expected = oem_from_environment(&environment, size).expect("a small matrix");
                let found = gathered(context, &environment, size);
                let bound = bound(layout.texel_count() as f64);
                let far = difference(expected.texels(), found.texels(), bound, misplaced(&environment));
                assert_eq!(far, None, "{layout:?} {look:?} {size:?} on {}", context.describe());
            }
        }
    }
}

/// Compares footprints of cubes of `sizes` over environments of `layouts` with the CPU's.
pub(super) fn footprints(context: &Context, layouts: &[Layout], sizes: &[u32]) {
    let mut random = Random::new(42);
    for &layout in layouts {
        for turn in [0.0, 90.0, 33.0] {
            let environment = environment(layout, texels(&mut random, Look::Suns, layout))
                .rotated_y(turn)
                .expect("an angle");
            let texture = upload(context, &environment).expect("a small texture");
            for &size in sizes {
                let expected: Vec<[f32; 4]> = footprints_over(&environment, Layout::Cube { size })
                    .expect("a small matrix")
                    .iter()
                    .map(|[r, g, b]| [*r, *g, *b, 1.0])
                    .collect();
                let (stage, buffer) =
                    reparameterise::footprints(context, &environment, &texture, size).expect("a small cube");
                context.submit(|encoder| stage.record(encoder));
                let found: Vec<[f32; 4]> = wait(context, readback::read(context, &buffer));
                let bound = bound(layout.texel_count() as f64);
                let far = difference(&expected, &found, bound, misplaced(&environment));
                assert_eq!(far, None, "{layout:?} turned {turn} {size} on {}", context.describe());
            }
        }
    }
}

#[test]
fn oem_lies_within_its_bound_of_the_cpu() {
    let sizes = [(1, 0), (2, 1), (5, 3), (16, 8), (33, 7), (64, 0)];
    in_full("OEM", |context| maps(context, &LAYOUTS, &sizes));
}

#[test]
fn footprints_lie_within_their_bound_of_the_cpu() {
    in_full("footprints", |context| footprints(context, &LAYOUTS, &[1, 3, 16]));
}
