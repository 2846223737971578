//! Boxes over the packed table: integer sums equal the CPU's; radiance lies within the error of float32
//! coordinates.

use crate::look;
use crate::transfer::{Upload as _, joined};
use glam::{DVec2, DVec3};
use octagloss_core::cpu::box_filter::{BoxFilter, StackedBox};
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{Sat, Scan};
use octagloss_core::lobe::{Lobe, kernel, kernel_integral};
use octagloss_core::sphere::octahedral::{oct_from_direction, solid_angle_density, wrap_texel};
use octagloss_fixtures::adapters::{UNIT, exceeds, in_full, wait};
use octagloss_fixtures::common::{Look, Random, landmarks, oem, texels};
use octagloss_gpu::stages::box_filter::{self, SatTextures};
use octagloss_gpu::{Context, SatPlanes};

/// Packs `planes` into textures.
pub(super) fn packed(context: &Context, planes: &SatPlanes) -> SatTextures {
    let textures = SatTextures::new(context, planes).expect("small textures");
    let stage = box_filter::pack(context, planes, &textures);
    context.submit(|encoder| stage.record(encoder));
    textures
}

fn random_sat(random: &mut Random, size: OemSize, look: Look) -> (Oem, Sat) {
    let oem = oem(size, &texels(random, look, Layout::Octahedral { size: size.inner }));
    let sat = Sat::new(&oem, Scan::default());
    (oem, sat)
}

/// Returns boxes inside the square and its border, across every edge and corner, far outside, empty, and as
/// large as possible.
fn boxes(random: &mut Random, size: OemSize) -> Vec<[i32; 4]> {
    let (n, b) = (size.inner as i32, size.border as i32);
    let mut boxes = vec![[0, 0, n, n], [-b, -b, n + b, n + b], [1, 1, 1, 1], [0, 0, 2 * n, 2 * n]];
    // Every position at an edge, along both axes: the low or high end on it or one texel off.
    let edges: Vec<i32> =
        [-n, -b, 0, n, n + b, 2 * n].iter().flat_map(|edge| [edge - 1, *edge, edge + 1]).collect();
    for _ in 0..120 {
        let mut edge = || edges[random.below(edges.len() as u32) as usize];
        let (x, y) = (edge(), edge());
        let (w, h) = (1 + random.below(2 * size.inner) as i32, 1 + random.below(2 * size.inner) as i32);
        boxes.push([x, y, x + w, y + h]);
        boxes.push([x - w, y - h, x, y]);
        boxes.push([x - w / 2, y - h / 2, x - w / 2 + w, y - h / 2 + h]);
    }
    // Distant tiles, on both sides of zero.
    for reach in [5, 250] {
        for _ in 0..120 {
            let mut place = || random.between(-1.0, 1.0) * f64::from(reach * n);
            let (x, y) = (place().floor() as i32, place().floor() as i32);
            let (w, h) = (random.below(2 * size.inner + 1) as i32, random.below(2 * size.inner + 1) as i32);
            boxes.push([x, y, x + w, y + h]);
        }
    }
    boxes
}

/// Returns the first box whose sum differs.
fn difference(sat: &Sat, boxes: &[[i32; 4]], found: &[[u64; 4]]) -> Option<String> {
    assert!(!boxes.is_empty() && boxes.len() == found.len(), "{} sums of {}", found.len(), boxes.len());
    boxes.iter().zip(found).find_map(|(area, found)| {
        let [x0, y0, x1, y1] = area.map(i64::from);
        let expected = sat.plane_box(x0, y0, x1, y1);
        (*found != expected).then(|| format!("{area:?} is {found:x?}, not {expected:x?}"))
    })
}

/// Integer sums of boxes of the unfolded plane: low x, low y, high x, high y.
const SUMS: &str = "
@group(0) @binding(0) var<uniform> octagloss_table: OctaglossTable;
@group(0) @binding(1) var octagloss_low: texture_2d<u32>;
@group(0) @binding(2) var octagloss_high: texture_2d<u32>;
@group(0) @binding(3) var<storage, read> boxes: array<vec4<i32>>;
@group(0) @binding(4) var<storage, read_write> sums: array<Sum>;

@compute @workgroup_size(64) fn look(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&boxes) {
        sums[id.x] = plane_box(boxes[id.x].xy, boxes[id.x].zw);
    }
}
";

/// Sums of `boxes` by the GPU.
fn sums(context: &Context, textures: &SatTextures, boxes: &[[i32; 4]]) -> Vec<[u64; 4]> {
    let map = [
        textures.header.as_entire_binding(),
        wgpu::BindingResource::TextureView(&textures.low),
        wgpu::BindingResource::TextureView(&textures.high),
    ];
    let source = octagloss_shaders::source("common/sat.wgsl") + SUMS;
    look::answers::<_, [[u32; 4]; 2]>(context, &source, &map, boxes).iter().map(joined).collect()
}

/// Compares integer sums of boxes over squares of `sizes` with the CPU's.
pub(super) fn integer_sums(context: &Context, sizes: &[u32]) {
    let mut random = Random::new(61);
    for &inner in sizes {
        for border in [0, 1, 3, inner] {
            let size = OemSize { inner, border };
            let look = Look::ALL[((inner + border) % 5) as usize];
            let (_, sat) = random_sat(&mut random, size, look);
            let planes = SatPlanes::upload(context, &sat).expect("small planes");
            let textures = packed(context, &planes);
            let boxes = boxes(&mut random, size);
            let found = sums(context, &textures, &boxes);
            let difference = difference(&sat, &boxes, &found);
            assert_eq!(difference, None, "{look:?} {size:?} on {}", context.describe());
        }
    }
}

#[test]
fn integer_sums_equal_the_cpu() {
    in_full("integer boxes", |context| {
        integer_sums(context, &[1, 2, 3, 5, 8, 17, 64]);
    });
}

#[test]
fn faults_in_tables_are_detected() {
    in_full("faults in tables", |context| {
        let mut random = Random::new(62);
        let size = OemSize { inner: 17, border: 4 };
        let (oem, sat) = random_sat(&mut random, size, Look::Noise);
        let boxes = boxes(&mut random, size);
        let seen = |planes: &SatPlanes| {
            let textures = packed(context, planes);
            let found = sums(context, &textures, &boxes);
            difference(&sat, &boxes, &found).is_some()
        };
        let upload = |sat: &Sat| SatPlanes::upload(context, sat).expect("small planes");
        assert!(!seen(&upload(&sat)), "the correct table passes");

        // One unit in the last place of one texel.
        let mut square: Vec<[f32; 4]> = (0..17 * 17).map(|k| oem.texel(k % 17, k / 17)).collect();
        square[123][0] = f32::from_bits(square[123][0].to_bits() ^ 1);
        let wrong = Sat::new(&Oem::from_square(size, square.clone()), Scan::default());
        assert_eq!(wrong.fixed_point(), sat.fixed_point(), "the same scale");
        assert!(seen(&upload(&wrong)), "one wrong texel");

        // Swapped faces of the octahedron: the outer half of a quadrant with its neighbour's.
        square[123][0] = f32::from_bits(square[123][0].to_bits() ^ 1);
        for (x, y) in (0..17 * 17).map(|k| (k % 17, k / 17)).filter(|(x, y)| x + y < 8) {
            square.swap(y * 17 + x, y * 17 + 16 - x);
        }
        assert!(seen(&upload(&Sat::new(&Oem::from_square(size, square), Scan::default()))), "swapped faces");

        // A border declared one texel too wide: the same entries, read at the wrong positions.
        let off = OemSize { inner: 15, border: 5 };
        let off = SatPlanes::new(context, off).expect("small planes");
        let right = upload(&sat);
        context.submit(|encoder| {
            let pairs = right.planes.iter().zip(&off.planes);
            for (from, to) in pairs.chain([(&right.exponents, &off.exponents)]) {
                encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size());
            }
        });
        assert!(seen(&off), "a border off by one");

        // A lost carry: the high word of one entry one too small.
        let dropped = upload(&sat);
        let pitch = 25_u64.next_multiple_of(4);
        let (x, y) = (12_u64, 9_u64);
        let high = (sat.entries()[(y * 25 + x) as usize][2] >> 32) as u32;
        let at = 8 * (y * pitch + x) + 4;
        context.queue().write_buffer(&dropped.planes[2], at, &high.wrapping_sub(1).to_le_bytes());
        assert!(seen(&dropped), "a dropped carry");
    });
}

/// Returns the box of the CPU's filter around `direction`, in texels.
fn box_around(n: f64, direction: DVec3, solid_angle: f64) -> (DVec2, f64) {
    let uv = oct_from_direction(direction);
    let texels = solid_angle / solid_angle_density(uv) * (n * n / 4.0);
    ((uv + 1.0) * (n / 2.0), 0.5 * (texels + 1.0).sqrt().min(2.0 * n))
}

/// Bounds the difference of a box's radiance from the CPU's, per channel.
///
/// In float32, coordinates (u, v) take 6 roundings of values up to 1 and their scaling to texels one of n.
/// The density takes 8; its square root and quotients take 8 more of the half side, which is at most n; each
/// end of a side takes one more: together below 24 n units. Moving every edge by that much exchanges as many
/// texels of its side, up to 5.2 times heavier than others, whose radiances are `spread` apart. Nine
/// non-negative products, 64-bit conversions and the quotient make 24 units of the value.
fn bound(oem: &Oem, direction: DVec3, solid_angle: f64, value: [f64; 3]) -> [f64; 3] {
    let n = oem.size().inner;
    let (centre, half) = box_around(f64::from(n), direction, solid_angle);
    let mut range = [[f64::INFINITY, 0.0_f64]; 3];
    // One more texel per side, for edges that move across a texel.
    for y in (centre.y - half).floor() as i64 - 1..=(centre.y + half).ceil() as i64 {
        for x in (centre.x - half).floor() as i64 - 1..=(centre.x + half).ceil() as i64 {
            let (x, y) = wrap_texel(n, x, y);
            for (range, value) in range.iter_mut().zip(oem.radiance(x, y)) {
                *range = [range[0].min(f64::from(value)), range[1].max(f64::from(value))];
            }
        }
    }
    let moved = 24.0 * f64::from(n) * UNIT;
    let share = 4.0 * 5.2 * moved / (2.0 * half);
    std::array::from_fn(|c| share * (range[c][1] - range[c][0]) + 24.0 * UNIT * value[c])
}

/// Returns the first direction whose radiance is beyond its bound.
pub(super) fn radiance_difference(
    oem: &Oem,
    sat: &Sat,
    (lobe, alpha): (Lobe, f64),
    directions: &[DVec3],
    found: &[[f32; 3]],
) -> Option<String> {
    assert!(!directions.is_empty() && directions.len() == found.len(), "one answer per direction");
    let filter = BoxFilter::new(sat, lobe, alpha);
    let solid_angle = solid_angle(lobe, alpha);
    directions.iter().zip(found).find_map(|(direction, found)| {
        let expected = filter.radiance(*direction).map(f64::from);
        let bound = bound(oem, *direction, solid_angle, expected);
        let far = (0..3).any(|c| exceeds((f64::from(found[c]) - expected[c]).abs(), bound[c]));
        far.then(|| format!("{lobe:?} {alpha} {direction}: {found:?}, not {expected:?} within {bound:?}"))
    })
}

pub(super) fn solid_angle(lobe: Lobe, alpha: f64) -> f64 {
    if alpha > 0.0 { kernel_integral(lobe, alpha) / kernel(lobe, alpha, 0.0) } else { 0.0 }
}

/// Returns a stack of one box.
pub(super) fn one_box(solid_angle: f64) -> [StackedBox; 1] {
    [StackedBox { solid_angle, weight: 1.0 }]
}

/// Compares the weighted sums only: single boxes have their own tests.
#[test]
fn stacks_of_boxes_match_the_cpu() {
    in_full("stacks of boxes", |context| {
        let mut random = Random::new(64);
        let directions: Vec<DVec3> = (0..40).map(|_| random.direction()).collect();
        let (_, sat) = random_sat(&mut random, OemSize { inner: 64, border: 0 }, Look::Smooth);
        let textures = packed(context, &SatPlanes::upload(context, &sat).expect("small planes"));
        let stack = [(0.05, 3.0), (0.2, 1.0), (0.9, 0.25)]
            .map(|(solid_angle, weight)| StackedBox { solid_angle, weight });
        let filter = BoxFilter::stacked(&sat, stack.into());
        let difference = |stack: &[StackedBox]| {
            let found = wait(context, box_filter::radiance(context, &textures, &directions, stack));
            let relative = |(direction, found): (&DVec3, &[f32; 3])| {
                let expected = filter.radiance(*direction);
                (0..3).map(|c| f64::from(found[c] / expected[c] - 1.0).abs()).fold(0.0, f64::max)
            };
            directions.iter().zip(&found).map(relative).fold(0.0, f64::max)
        };
        // Edges move by 2^-22 of the square; a smooth sky changes by a few times its own value over it.
        assert!(difference(&stack) < 64.0 * 8.0 / f64::from(1_u32 << 22), "{}", difference(&stack));
        let [first, second, third] = stack;
        let lighter = StackedBox { weight: 2.9, ..first };
        assert!(
            difference(&[lighter, second, third]) > 64.0 * 8.0 / f64::from(1_u32 << 22),
            "wrong weights are not detected"
        );
    });
}

#[test]
fn radiance_lies_within_its_bound_of_the_cpu() {
    in_full("box radiance", |context| {
        let mut random = Random::new(63);
        let mut directions = landmarks();
        directions.extend((0..40).map(|_| random.direction()));
        let (mut seen, mut compared) = (0, 0);
        for (inner, border) in [(1, 0), (3, 3), (16, 0), (32, 5), (63, 0)] {
            for look in Look::ALL {
                let (oem, sat) = random_sat(&mut random, OemSize { inner, border }, look);
                let planes = SatPlanes::upload(context, &sat).expect("small planes");
                let textures = packed(context, &planes);
                for (lobe, roughness) in [
                    (Lobe::Ggx, 0.0),
                    (Lobe::Ggx, 0.1),
                    (Lobe::Ggx, 0.4),
                    (Lobe::Cone, 0.7),
                    (Lobe::Ggx, 1.0),
                ] {
                    let alpha: f64 = roughness * roughness;
                    let ask = |solid_angle| {
                        let stack = one_box(solid_angle);
                        let answers = box_filter::radiance(context, &textures, &directions, &stack);
                        wait(context, answers)
                    };
                    let size = solid_angle(lobe, alpha);
                    let far = radiance_difference(&oem, &sat, (lobe, alpha), &directions, &ask(size));
                    assert_eq!(far, None, "{look:?} {inner} + {border} on {}", context.describe());
                    // The comparator detects a box 5 % larger where the image has contrast.
                    if inner >= 16 && look == Look::Noise && roughness > 0.3 {
                        let wrong = ask(size * 1.05);
                        let far = radiance_difference(&oem, &sat, (lobe, alpha), &directions, &wrong);
                        seen += u32::from(far.is_some());
                        compared += 1;
                    }
                }
            }
        }
        assert_eq!(seen, compared, "boxes 5 % larger are detected");
        assert_eq!(compared, 9);
    });
}
