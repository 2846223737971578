//! Compares a lamp added to an OEM with the CPU's, within a derived bound.

use crate::transfer::Upload as _;
use glam::{DVec2, DVec3};
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::sphere::octahedral::{direction_from_oct, wrap_texel};
use octagloss_fixtures::adapters::{UNIT, exceeds, in_full, wait};
use octagloss_fixtures::common::{Look, Random, landmarks, oem, texels};
use octagloss_gpu::stages::lamp::Lamp;
use octagloss_gpu::{Context, OemPlanes};

const DISC: f64 = 0.06;
const EDGE: f64 = 0.08;

/// Samples of the lamp along an edge of a texel, as in `shaders/lamp.wgsl`.
const PLACES: u32 = 4;

/// Returns the mean radiance of `lamp` over texel (`x`, `y`) of a square of `inner`.
fn mean(lamp: &Lamp, inner: u32, x: u32, y: u32) -> f64 {
    let places = f64::from(PLACES);
    let at = |k: u32| {
        let part = DVec2::new(f64::from(k % PLACES), f64::from(k / PLACES)) + 0.5;
        let texel = DVec2::new(f64::from(x), f64::from(y)) + part / places;
        lamp.radiance_towards(direction_from_oct(texel * 2.0 / f64::from(inner) - 1.0))
    };
    (0..PLACES * PLACES).map(at).sum::<f64>() / (places * places)
}

/// A direction's components are off by 8 units: two roundings of (u, v), two of the octahedron's point, its
/// length and the quotient. A squared distance d^2 at the lamp's edge is off by 2 sqrt(3) d times that,
/// divided by the difference of the squared distances of edge and disc. 16 terms, the product and the sum
/// round once each.
fn bound(radiance: f64) -> f64 {
    let [disc, edge] = [DISC, EDGE].map(|angle| 2.0 * (angle / 2.0).sin());
    let share = 2.0 * 3.0_f64.sqrt() * edge * 8.0 * UNIT / (edge * edge - disc * disc);
    radiance * (share + 20.0 * UNIT)
}

/// Returns the first texel of `found` that is not the sum of `before` and `lamp`.
fn difference(found: &Oem, before: &Oem, lamp: &Lamp, radiance: f64) -> Option<String> {
    let OemSize { inner, border } = before.size();
    let side = before.size().bordered();
    (0..side * side).find_map(|k| {
        let [x, y] = [k % side, k / side].map(|place| i64::from(place) - i64::from(border));
        let (x, y) = wrap_texel(inner, x, y);
        let added = mean(lamp, inner, x, y);
        let (was, is) = (before.texels()[k as usize], found.texels()[k as usize]);
        let w = f64::from(was[3]);
        let far = (0..4).any(|c| {
            let expected = f64::from(was[c]) + if c < 3 { added * w } else { 0.0 };
            exceeds((f64::from(is[c]) - expected).abs(), bound(radiance) * w + UNIT * expected)
        });
        far.then(|| format!("texel {k} is {is:?}, was {was:?}, the lamp's radiance there {added}"))
    })
}

fn lit(context: &Context, before: &Oem, lamp: &Lamp) -> Oem {
    let planes = OemPlanes::upload(context, before).expect("small planes");
    let stage = octagloss_gpu::stages::lamp::stage(context, &lamp.buffer(context), &planes);
    context.submit(|encoder| stage.record(encoder));
    wait(context, planes.read(context))
}

/// Compares lamps over squares (inner texels, border) with the CPU's.
pub(super) fn lamps(context: &Context, sizes: &[(u32, u32)]) {
    let mut random = Random::new(120);
    let places: Vec<DVec3> = landmarks().into_iter().chain((0..10).map(|_| random.direction())).collect();
    for &(inner, border) in sizes {
        let radiance = texels(&mut Random::new(121), Look::Smooth, Layout::Octahedral { size: inner });
        let before = oem(OemSize { inner, border }, &radiance);
        for towards in &places {
            let lamp = Lamp::new(*towards, 100.0, DISC, EDGE);
            let after = lit(context, &before, &lamp);
            assert_eq!(difference(&after, &before, &lamp, 100.0), None, "{inner} + {border}, {towards}");
        }
        let none = lit(context, &before, &Lamp::default());
        assert_eq!(none.texels(), before.texels(), "{inner} + {border}: no lamp");
    }
}

#[test]
fn lamps_match_the_cpu() {
    in_full("lamp", |context| lamps(context, &[(64, 0), (33, 5), (8, 8), (1, 0)]));
}

#[test]
fn a_displaced_or_brighter_lamp_is_detected() {
    in_full("lamp faults", |context| {
        let radiance = texels(&mut Random::new(122), Look::Smooth, Layout::Octahedral { size: 64 });
        let before = oem(OemSize { inner: 64, border: 0 }, &radiance);
        let lamp = Lamp::new(DVec3::new(0.6, 0.3, -0.5), 100.0, DISC, EDGE);
        let wrong = [
            Lamp::new(DVec3::new(0.6, 0.3, -0.501), 100.0, DISC, EDGE),
            Lamp::new(DVec3::new(0.6, 0.3, -0.5), 100.1, DISC, EDGE),
            Lamp::new(DVec3::new(0.6, 0.3, -0.5), 100.0, DISC, 1.01 * EDGE),
        ];
        for other in wrong {
            let after = lit(context, &before, &other);
            assert!(difference(&after, &before, &lamp, 100.0).is_some(), "{other:?}");
        }
    });
}
