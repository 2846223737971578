//! Triangles drawn straight into octahedral maps and cubes, against rays through the pixels.
//!
//! Values are positions and a 1: added up without depth, the ones count the triangles over a pixel; with
//! depth, the position must be the point that the pixel's ray hits.

use glam::DVec3;
use half::f16;
use octagloss_core::common::error::Error;
use octagloss_core::light::environment::Layout;
use octagloss_core::light::oem::OemSize;
use octagloss_core::sphere::cube::{Face, direction_from_texel};
use octagloss_core::sphere::octahedral::{direction_from_oct, texel_centre};
use octagloss_fixtures::adapters::{PerAdapter, in_full, wait};
use octagloss_fixtures::common::Random;
use octagloss_fixtures::meshes::{closed, mesh};
use octagloss_fixtures::oracles::triangles::{Hit, TriangleOracle, corners_of};
use octagloss_gpu::device::readback;
use octagloss_gpu::direct::{Direct, DirectMesh, DirectTarget, Method, Overlap};
use octagloss_gpu::stages::reparameterise;
use octagloss_gpu::triangles::{Corner, DirectMap, Triangles};
use octagloss_gpu::{Context, OemPlanes};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::cell::Cell;
use std::f64::consts::{PI, SQRT_2};

/// The exact methods for octahedral maps.
const METHODS: [Method; 3] = [Method::Octants, Method::ClipMask, Method::StrictSplit];

/// Movement of corners by the rasteriser, in pixels: a sixteenth along rows and along columns at the coarsest
/// (Vulkan's four bits).
const SNAP: f64 = SQRT_2 / 16.0;

/// Rounding of interpolated numbers, relative to the greatest of the triangle: float32 planes of 1/w, whose
/// greatest value at the near surface a far pixel cancels.
const ROUNDING: f64 = 5e-6;

/// Scenes of random triangles.
const CASES: u32 = 64;

/// The pipelines of an adapter.
struct Pipelines {
    sum: Direct,
    nearest: Direct,
}

static PIPELINES: PerAdapter<Pipelines> = PerAdapter::new(|context| {
    let direct = |format, overlap| Direct::new(context, format, overlap).expect("pipelines");
    Pipelines {
        sum: direct(wgpu::TextureFormat::Rgba16Float, Overlap::Sum),
        nearest: direct(wgpu::TextureFormat::Rgba32Float, Overlap::Nearest),
    }
});

/// Draws `triangles` and returns the target.
fn draw(
    context: &Context,
    direct: &Direct,
    format: wgpu::TextureFormat,
    method: Method,
    triangles: &Triangles,
    map: DirectMap,
    near: f32,
) -> DirectTarget {
    let mesh = DirectMesh::upload(context, triangles).expect("a mesh that fits");
    let target = DirectTarget::new(context, map, format).expect("a target");
    let frame = direct.frame(method, &mesh, &target, near).expect("a frame");
    context.submit(|encoder| frame.record(encoder, None));
    target
}

/// How many triangles every pixel of layer `layer` shows.
fn counts(
    context: &Context,
    method: Method,
    triangles: &Triangles,
    map: DirectMap,
    near: f32,
    layer: u32,
) -> Vec<usize> {
    let direct = &PIPELINES.get(context).sum;
    let target = draw(context, direct, wgpu::TextureFormat::Rgba16Float, method, triangles, map, near);
    let texels: Vec<[u16; 4]> = wait(context, readback::read_layer(context, &target.colour, layer));
    texels.iter().map(|texel| f16::from_bits(texel[3]).to_f32().round() as usize).collect()
}

/// The nearest triangle's values and depth in every pixel.
fn nearest(
    context: &Context,
    method: Method,
    triangles: &Triangles,
    map: DirectMap,
    near: f32,
    layer: u32,
) -> (Vec<[f32; 4]>, Vec<f32>) {
    let direct = &PIPELINES.get(context).nearest;
    let target = draw(context, direct, wgpu::TextureFormat::Rgba32Float, method, triangles, map, near);
    let values = wait(context, readback::read_layer(context, &target.colour, layer));
    (values, wait(context, readback::read_layer(context, &target.depth, layer)))
}

/// [`in_full`] without SwiftShader, which drops pixels where a corner's w is exactly 0 in a neighbouring
/// octant.
fn in_full_with_zero_w(name: &str, test: impl Fn(&Context)) {
    in_full(name, |context| {
        if !context.device().adapter_info().name.contains("SwiftShader") {
            test(context);
        }
    });
}

/// What the rays of a map's pixels hit.
struct Expected {
    map: DirectMap,
    pixels: Vec<(Vec<Hit>, usize)>,
    /// The greatest value of the mesh.
    scale: f64,
}

impl Expected {
    fn new(triangles: &Triangles, map: DirectMap, near: f32) -> Self {
        let oracle = TriangleOracle::new(triangles, map, near).expect("a valid map");
        let width = map.squares() * map.size();
        let pixels = (0..map.pixels()).map(|k| oracle.pixel(k % width, k / width)).collect();
        let values = triangles.corners().iter().flat_map(|corner| corner.value);
        let scale = values.fold(1.0, |most: f64, value| most.max(f64::from(value.abs())));
        Self { map, pixels, scale }
    }

    /// Column and row of pixel `k`.
    fn place(&self, k: usize) -> (usize, usize) {
        let width = (self.map.squares() * self.map.size()) as usize;
        (k % width, k / width)
    }

    /// Describes every pixel whose count is impossible.
    fn wrong_counts(&self, counts: &[usize]) -> impl Iterator<Item = String> {
        assert_eq!(counts.len(), self.pixels.len());
        self.pixels.iter().zip(counts).enumerate().filter_map(|(k, ((hits, doubtful), count))| {
            let allowed = hits.len()..=hits.len() + doubtful;
            (!allowed.contains(count)).then(|| format!("{count} at {:?}, not {allowed:?}", self.place(k)))
        })
    }

    /// Describes every pixel that shows something else than its nearest hit, or one as near.
    fn wrong_values(&self, values: &[[f32; 4]], depths: &[f32]) -> impl Iterator<Item = String> {
        assert_eq!((values.len(), depths.len()), (self.pixels.len(), self.pixels.len()));
        self.pixels.iter().zip(values.iter().zip(depths)).enumerate().filter_map(|(k, (pixel, shown))| {
            let (hits, doubtful) = pixel;
            let (value, depth) = (shown.0.map(f64::from), f64::from(*shown.1));
            if *doubtful > 0 {
                return None;
            }
            // Cuts at the near surface and at the square's sides round as far corners do.
            let slack = |hit: &Hit| SNAP * hit.depth_change + ROUNDING * (1.0 + self.scale * hit.depth);
            let is = |hit: &Hit| {
                let near = (hit.depth - depth).abs() <= slack(hit);
                // The nearer to the viewer, the less cancels.
                let rounding = ROUNDING * self.scale / hit.depth;
                let same =
                    (0..4).all(|c| (hit.value[c] - value[c]).abs() <= SNAP * hit.value_change[c] + rounding);
                near && same
            };
            let front = hits.iter().map(|hit| hit.depth - slack(hit)).fold(0.0, f64::max);
            let right = match hits.len() {
                0 => value == [0.0; 4] && depth == 0.0,
                _ => hits.iter().filter(|hit| hit.depth + slack(hit) >= front).any(is),
            };
            let place = self.place(k);
            (!right).then(|| format!("{value:?} at depth {depth} in {place:?}, not {hits:?}"))
        })
    }

    /// The first wrong count.
    fn wrong_count(&self, counts: &[usize]) -> Option<String> {
        self.wrong_counts(counts).next()
    }

    /// The first wrong value.
    fn wrong_value(&self, values: &[[f32; 4]], depths: &[f32]) -> Option<String> {
        self.wrong_values(values, depths).next()
    }

    /// Share of pixels that are decided.
    fn decided(&self) -> f64 {
        let decided = self.pixels.iter().filter(|(_, doubtful)| *doubtful == 0).count();
        decided as f64 / self.pixels.len() as f64
    }

    fn hits(&self) -> usize {
        self.pixels.iter().map(|(hits, _)| hits.len()).sum()
    }
}

/// Describes the first difference between the oracle and any exact method.
fn difference(
    context: &Context,
    triangles: &Triangles,
    map: DirectMap,
    near: f32,
) -> Result<Expected, String> {
    let expected = Expected::new(triangles, map, near);
    for method in METHODS {
        if let Some(wrong) = expected.wrong_count(&counts(context, method, triangles, map, near, 0)) {
            return Err(format!("{method:?}, {map:?}: {wrong}"));
        }
    }
    for method in METHODS {
        let (values, depths) = nearest(context, method, triangles, map, near, 0);
        if let Some(wrong) = expected.wrong_value(&values, &depths) {
            return Err(format!("{method:?}, {map:?}: {wrong}"));
        }
    }
    Ok(expected)
}

/// Corners anywhere, on axes and coordinate planes, close to the centre, far away, and on a coarse grid,
/// which repeats corners and puts triangles into planes through the centre.
fn corner() -> impl Strategy<Value = DVec3> {
    let within = |most: f64| (-most..most, -most..most, -most..most).prop_map(DVec3::from);
    prop_oneof![
        4 => within(3.0),
        2 => (within(3.0), 0..3_usize).prop_map(|(mut at, axis)| {
            at[axis] = 0.0;
            at
        }),
        1 => (-3.0..3.0_f64, 0..3_usize).prop_map(|(at, axis)| DVec3::AXES[axis] * at),
        1 => within(0.3),
        1 => within(300.0),
        2 => (-2..=2_i32, -2..=2_i32, -2..=2_i32)
            .prop_map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z))),
    ]
}

fn triangle() -> impl Strategy<Value = [DVec3; 3]> {
    prop_oneof![
        6 => [corner(), corner(), corner()],
        // The centre inside, or in the plane.
        1 => (corner(), corner(), 0.2..2.0_f64, 0.2..2.0_f64).prop_map(|(a, b, s, t)| [a, b, -s * a - t * b]),
        1 => (corner(), corner(), -2.0..2.0_f64, -2.0..2.0_f64)
            .prop_map(|(a, b, s, t)| [a, b, s * a + t * b]),
        1 => [corner(), corner()].prop_map(|[a, b]| [a, b, a]),
    ]
}

#[test]
fn any_triangles_match_the_oracle() {
    in_full_with_zero_w("direct: triangles", |context| {
        let config = Config { cases: CASES, failure_persistence: None, ..Config::default() };
        let seed = [7; 32];
        let random =
            proptest::test_runner::TestRng::from_seed(proptest::test_runner::RngAlgorithm::ChaCha, &seed);
        let mut runner = TestRunner::new_with_rng(config, random);
        let scenes = (
            proptest::collection::vec(triangle(), 1..10),
            prop_oneof![Just(2_u32), Just(6), Just(16), Just(34)].prop_flat_map(|size| {
                prop_oneof![Just(DirectMap::Octahedral { size }), Just(DirectMap::Rectangular { size })]
            }),
            prop_oneof![Just(0.02_f32), Just(0.3), Just(1.0)],
        );
        let (decided, hits) = (Cell::new(0.0), Cell::new(0));
        let test = |(triangles, map, near): (Vec<[DVec3; 3]>, DirectMap, f32)| {
            let expected = difference(context, &mesh(&triangles), map, near).map_err(TestCaseError::fail)?;
            decided.set(decided.get() + expected.decided() / f64::from(CASES));
            hits.set(hits.get() + expected.hits());
            Ok(())
        };
        runner.run(&scenes, test).unwrap_or_else(|error| panic!("{error}"));
        let (decided, hits) = (decided.get(), hits.get());
        assert!(decided > 0.7 && hits > 3000, "{decided} of the pixels are decided, {hits} hits");
    });
}

#[test]
fn chosen_triangles_match_the_oracle() {
    let v = DVec3::new;
    let around = |height: f64| {
        let corner = |k: f64| v((k * PI / 1.5 + 0.3).cos() * 2.0, height, (k * PI / 1.5 + 0.3).sin() * 2.0);
        [corner(0.0), corner(1.0), corner(2.0)]
    };
    let chosen = [
        // Around both poles, and with the centre inside.
        vec![around(1.0), around(-0.7), around(0.0)],
        // Over seven octants.
        vec![[v(3.0, -1.0, -1.1), v(-1.2, 3.0, -1.0), v(-1.0, -1.3, 3.0)]],
        vec![[v(-3.0, 1.0, 1.1), v(1.2, -3.0, 1.0), v(1.0, 1.3, -3.0)]],
        // Corners on axes; an edge through a pole; edges on folds.
        vec![[DVec3::X, DVec3::Y, DVec3::Z], [-DVec3::X, -DVec3::Y, -DVec3::Z]],
        vec![[v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.2, -1.0, 1.5)]],
        vec![
            [v(1.0, 0.0, -2.0), v(1.0, 0.0, 2.0), v(1.0, 1.5, 0.0)],
            [v(1.0, 0.0, -2.0), v(1.0, 0.0, 2.0), v(1.0, -1.5, 0.0)],
        ],
        // Cut by the near surface, and wholly within it.
        vec![
            [v(0.1, 0.1, 0.1), v(2.0, 0.3, -0.5), v(-0.5, 2.0, 0.8)],
            [v(0.1, 0.0, 0.1), v(0.0, 0.1, 0.1), v(0.1, 0.1, 0.0)],
        ],
        // One through the other.
        vec![
            [v(2.0, -1.0, -1.0), v(2.0, 1.0, -1.0), v(-1.0, 0.5, 3.0)],
            [v(3.0, -1.0, 1.0), v(1.0, 1.0, 1.2), v(1.0, -0.5, -2.0)],
        ],
        // A plain that leaves the near surface for the horizon.
        vec![[v(-1e3, -0.8, -1e3), v(1e3, -0.8, -1e3), v(0.0, -0.8, 2e3)]],
    ];
    in_full_with_zero_w("direct: chosen triangles", |context| {
        for (k, triangles) in chosen.iter().enumerate() {
            let (square, rectangle) =
                (DirectMap::Octahedral { size: 48 }, DirectMap::Rectangular { size: 34 });
            for (map, near) in [(square, 0.05), (square, 0.4), (rectangle, 0.1)] {
                let expected = difference(context, &mesh(triangles), map, near);
                let expected = expected.unwrap_or_else(|wrong| panic!("scene {k}: {wrong}"));
                assert!(expected.decided() > 0.7 && expected.hits() > 0, "scene {k}");
            }
        }
    });
}

/// The direction of the centre of pixel `k` of a square map, row by row.
fn ray(size: u32, k: u32) -> DVec3 {
    direction_from_oct(texel_centre(size, k % size, k / size))
}

/// Draws closed surfaces of so many parts into maps: every pixel shows one triangle, at the point on the
/// pixel's ray.
pub(super) fn closed_surfaces(context: &Context, cases: &[(i32, DirectMap)]) {
    for (parts, map) in cases {
        let size = map.size();
        for turn in [None, Some(u64::from(size))] {
            let surface = closed(*parts, turn, 0.8..2.0);
            for method in METHODS {
                let counts = counts(context, method, &surface, *map, 0.1, 0);
                let others = counts.iter().filter(|count| **count != 1).count();
                assert_eq!(others, 0, "{method:?}, {parts} parts, {map:?}, turn {turn:?}");
            }
            if map.squares() == 2 {
                continue;
            }
            let (values, depths) = nearest(context, Method::Octants, &surface, *map, 0.1, 0);
            // A pixel is 2 / size of the square's unit, which spans an angle of 3 at most, in faces' centres.
            let moved = SNAP * 2.0 * 3.0 / f64::from(size);
            for (k, ([x, y, z, one], depth)) in (0..).zip(values.iter().zip(depths)) {
                let ray = ray(size, k);
                let at = DVec3::from_array([*x, *y, *z].map(f64::from));
                assert!(at.cross(ray).length() < moved * at.length(), "{at} along {ray}");
                assert!(at.dot(ray) > 0.0 && (one - 1.0).abs() < 1e-5);
                assert!((f64::from(depth) * at.abs().element_sum() / 0.1 - 1.0).abs() < 0.02);
            }
        }
    }
}

#[test]
fn closed_surfaces_have_no_crack_and_no_double_cover() {
    in_full_with_zero_w("direct: closed surfaces", |context| {
        // Corners on corners of pixels, edges through centres of pixels, and several triangles per pixel.
        let squares = [(1, 2), (1, 64), (2, 6), (5, 64), (32, 64), (40, 16), (7, 250)]
            .map(|(parts, size)| (parts, DirectMap::Octahedral { size }));
        let rectangles = [(1, 2), (1, 32), (2, 6), (16, 32), (40, 16)]
            .map(|(parts, size)| (parts, DirectMap::Rectangular { size }));
        closed_surfaces(context, &[&squares[..], &rectangles].concat());
    });
}

/// The approximate methods, with the layout that each is for.
const APPROXIMATE: [(Method, DirectMap); 3] = [
    (Method::XzSplit, DirectMap::Rectangular { size: 46 }),
    (Method::EdgeStrip, DirectMap::Rectangular { size: 46 }),
    (Method::PerCorner, DirectMap::Octahedral { size: 64 }),
];

const APPROXIMATE_NEAR: f32 = 0.1;

/// Triangles with corners in octant `octant` each, or in two octants on either side of y = 0.
fn within_octants(across_horizon: bool) -> Triangles {
    let mut random = Random::new(12);
    let mut within = |octant: i32| {
        let sign = |bit: i32| if octant & bit == 0 { 1.0 } else { -1.0 };
        DVec3::from_array([sign(1), sign(2), sign(4)].map(|sign| sign * random.between(0.1, 2.0)))
    };
    let other = if across_horizon { 2 } else { 0 };
    let triangles: Vec<[DVec3; 3]> =
        (0..120).map(|k| [k % 8, k % 8, (k % 8) ^ other].map(&mut within)).collect();
    mesh(&triangles)
}

/// Describes what `method` shows wrongly.
fn wrong(context: &Context, method: Method, expected: &Expected, triangles: &Triangles) -> Wrong {
    let (map, near) = (expected.map, APPROXIMATE_NEAR);
    let counts = counts(context, method, triangles, map, near, 0);
    let (values, depths) = nearest(context, method, triangles, map, near, 0);
    let share = |count: usize| count as f64 / counts.len() as f64;
    let mut angles: Vec<f64> = expected
        .pixels
        .iter()
        .zip(&values)
        .filter(|((hits, doubtful), value)| hits.len() == 1 && *doubtful == 0 && value[3] != 0.0)
        .map(|((hits, _), value)| {
            let [a, b] = [hits[0].value, value.map(f64::from)].map(|[x, y, z, _]| DVec3::new(x, y, z));
            a.angle_between(b)
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    Wrong {
        counts: share(expected.wrong_counts(&counts).count()),
        values: share(expected.wrong_values(&values, &depths).count()),
        mean: angles.iter().sum::<f64>() / angles.len().max(1) as f64,
        most: angles.last().copied().unwrap_or(0.0),
    }
}

/// Errors of a picture of triangles whose values are their positions.
#[derive(Debug, PartialEq)]
struct Wrong {
    /// Share of pixels that show too many triangles or too few.
    counts: f64,
    /// Share of pixels that show another point than the ray's, or nothing.
    values: f64,
    /// Angle between the point that is shown and the pixel's ray: mean and greatest of covered pixels.
    mean: f64,
    most: f64,
}

impl Wrong {
    fn is_none(&self) -> bool {
        self.counts == 0.0 && self.values == 0.0
    }
}

/// Draws by approximate methods triangles that each lie within an octant, or leave it by the plane that the
/// method cuts at; then a surface of triangles that leave octants by all planes.
pub(super) fn approximate(context: &Context) {
    for (method, map) in APPROXIMATE {
        for across_horizon in [false, true] {
            let triangles = within_octants(across_horizon);
            let expected = Expected::new(&triangles, map, APPROXIMATE_NEAR);
            assert!(expected.hits() > 200, "{} hits", expected.hits());
            let wrong = wrong(context, method, &expected, &triangles);
            let is_exact = !across_horizon || method != Method::PerCorner;
            assert_eq!(wrong.is_none(), is_exact, "{method:?}, {across_horizon}: {wrong:?}");
        }
    }
}

#[test]
fn approximate_methods_are_exact_where_they_cut() {
    in_full("direct: approximate methods", approximate);
}

#[test]
fn approximate_methods_are_wrong_where_triangles_leave_an_octant() {
    // Triangles of 20 degrees, as measured on llvmpipe; other drivers round and snap differently.
    let about = |measured: f64| measured / 1.5..measured * 1.5;
    in_full("direct: errors of approximate methods", |context| {
        let surface = closed(5, Some(1), 0.8..2.0);
        for ((method, map), [counts, values, mean, most]) in APPROXIMATE.into_iter().zip([
            [0.0090, 0.336, 0.0151, 0.140],
            [0.0156, 0.079, 0.0020, 0.113],
            [0.940, 0.731, 0.813, 3.09],
        ]) {
            let expected = Expected::new(&surface, map, APPROXIMATE_NEAR);
            for exact in METHODS {
                let wrong = wrong(context, exact, &expected, &surface);
                // A sixteenth of a pixel, which spans an angle of 3 in the square's unit at most.
                let moved = SNAP * 2.0 * 3.0 / f64::from(map.size());
                assert!(wrong.is_none() && wrong.most < moved, "{exact:?}: {wrong:?}");
            }
            let wrong = wrong(context, method, &expected, &surface);
            for (found, measured) in
                [(wrong.counts, counts), (wrong.values, values), (wrong.mean, mean), (wrong.most, most)]
            {
                assert!(about(measured).contains(&found), "{method:?}: {wrong:?}");
            }
        }
    });
}

#[test]
fn culling_leaves_the_picture_as_it_is() {
    in_full("direct: culling", |context| {
        let mut random = Random::new(4);
        let mut corner = |most: f64| DVec3::from_array([0; 3].map(|_| random.between(-most, most)));
        let triangles: Vec<[DVec3; 3]> = (0..700)
            .map(|_| {
                let at = corner(4.0);
                [at + corner(1.0), at + corner(1.0), at + corner(1.0)]
            })
            .collect();
        let triangles = mesh(&triangles);
        let map = DirectMap::Octahedral { size: 64 };
        let drawn = |method| nearest(context, method, &triangles, map, 0.1, 0);
        assert!(drawn(Method::Octants) == drawn(Method::ClipMask), "octahedral maps differ");
        let map = DirectMap::Cube { size: 33 };
        for layer in 0..6 {
            let drawn = |method| nearest(context, method, &triangles, map, 0.1, layer);
            assert!(drawn(Method::Cube) == drawn(Method::WholeCube), "cubes differ in layer {layer}");
        }
        let listed = |method, map| {
            let mesh = DirectMesh::upload(context, &triangles).expect("a mesh that fits");
            let target = DirectTarget::new(context, map, wgpu::TextureFormat::Rgba32Float);
            let target = target.expect("a target");
            let frame = PIPELINES.get(context).nearest.frame(method, &mesh, &target, 0.1);
            let frame = frame.expect("a frame");
            context.submit(|encoder| frame.record(encoder, None));
            wait(context, frame.triangles(context))
        };
        // Every list has the triangles with a corner well inside of its octant, and some besides.
        let inside = |octant: u32| {
            let signs = [1, 2, 4].map(|bit| if octant & bit == 0 { 1.0 } else { -1.0 });
            let is_inside =
                |corner: &Corner| corner.position.iter().zip(signs).all(|(x, sign)| x * sign > 0.2);
            (0..triangles.count()).filter(|k| corners_of(&triangles, *k).iter().any(is_inside)).count() as u32
        };
        let lists = listed(Method::Octants, DirectMap::Octahedral { size: 64 });
        for (octant, count) in (0..).zip(&lists) {
            assert!((inside(octant)..inside(octant) + 200).contains(count), "{octant}: {lists:?}");
        }
        assert_eq!(lists.len(), 8);
        assert_eq!(listed(Method::Cube, map).len(), 6);
        assert_eq!(listed(Method::WholeCube, map), [700; 6]);
    });
}

/// Draws closed surfaces of so many parts into cubes with faces of so many pixels, by both methods.
pub(super) fn cubes(context: &Context, cases: &[(i32, u32)]) {
    for (parts, size) in cases {
        let surface = closed(*parts, Some(9), 0.8..2.0);
        let map = DirectMap::Cube { size: *size };
        for method in [Method::Cube, Method::WholeCube] {
            for face in Face::ALL {
                let layer = face.index() as u32;
                let counts = counts(context, method, &surface, map, 0.1, layer);
                assert!(counts.iter().all(|count| *count == 1), "{method:?}, {face:?}: {counts:?}");
                let (values, depths) = nearest(context, method, &surface, map, 0.1, layer);
                for (k, ([x, y, z, _], depth)) in (0..).zip(values.iter().zip(depths)) {
                    let ray = direction_from_texel(face, *size, k % size, k / size);
                    let at = DVec3::from_array([*x, *y, *z].map(f64::from));
                    let moved = SNAP * 2.0 / f64::from(*size);
                    assert!(at.cross(ray).length() < moved * at.length() && at.dot(ray) > 0.0);
                    assert!((f64::from(depth) * at.abs().max_element() / 0.1 - 1.0).abs() < 0.02);
                }
            }
        }
    }
}

#[test]
fn cubes_show_every_direction_once() {
    in_full("direct: cubes", |context| cubes(context, &[(4, 7), (6, 32)]));
}

#[test]
fn a_reparameterised_cube_is_close_to_the_direct_map() {
    in_full("direct: reparameterised", |context| {
        // Radiance that is smooth over the sphere.
        let surface = closed(24, Some(3), 1.0..1.0001);
        let bright = |corner: &Corner| {
            let [x, y, z] = corner.position;
            Corner::new(corner.position, [1.0 + 0.5 * x, 1.0 + 0.5 * y, 1.0 + 0.5 * z, 1.0])
        };
        let corners = surface.corners().iter().map(bright).collect();
        let surface = Triangles::new(corners, surface.indices().to_vec()).expect("a valid mesh");
        let (size, face) = (64, 26);
        let (direct, _) = nearest(context, Method::Octants, &surface, DirectMap::Octahedral { size }, 0.1, 0);
        let cube = DirectMap::Cube { size: face };
        let pipelines = &PIPELINES.get(context).nearest;
        let format = wgpu::TextureFormat::Rgba32Float;
        let target = draw(context, pipelines, format, Method::Cube, &surface, cube, 0.1);
        let planes = OemPlanes::new(context, OemSize { inner: size, border: 0 }).expect("planes");
        let stage = reparameterise::stage(context, Layout::Cube { size: face }, &target.colour, &planes);
        context.submit(|encoder| stage.as_ref().expect("a stage").record(encoder));
        let oem = wait(context, planes.read(context));
        for (energy, drawn) in oem.texels().iter().zip(direct) {
            for c in 0..3 {
                // A texel of the cube spans a thirteenth of the unit that radiance changes by a half over.
                assert!((energy[c] / energy[3] - drawn[c]).abs() < 0.04, "{energy:?} {drawn:?}");
            }
        }
    });
}

#[test]
fn comparators_notice_one_wrong_pixel() {
    in_full("direct: comparators", |context| {
        let surface = closed(3, Some(5), 0.8..2.0);
        let (size, near) = (16, 0.1);
        let map = DirectMap::Octahedral { size };
        let expected = Expected::new(&surface, map, near);
        let counts = counts(context, Method::Octants, &surface, map, near, 0);
        let (values, depths) = nearest(context, Method::Octants, &surface, map, near, 0);
        assert_eq!((expected.wrong_count(&counts), expected.wrong_value(&values, &depths)), (None, None));
        let place = (0..counts.len()).find(|k| expected.pixels[*k].1 == 0).expect("a decided pixel");
        for wrong in [0, 2] {
            let mut counts = counts.clone();
            counts[place] = wrong;
            assert!(expected.wrong_count(&counts).is_some());
        }
        let mut moved = values.clone();
        moved[place][0] += 0.05;
        assert!(expected.wrong_value(&moved, &depths).is_some());
        let mut nearer = depths.clone();
        nearer[place] *= 1.05;
        assert!(expected.wrong_value(&values, &nearer).is_some());
        // The other half of the square's octants: what dropping none of their pixels would show.
        let mut mirrored = values.clone();
        mirrored.reverse();
        assert!(expected.wrong_value(&mirrored, &depths).is_some());
    });
}

#[test]
fn bad_targets_are_errors_that_name_the_remedy() {
    in_full("direct: errors", |context| {
        let failure =
            |outcome: octagloss_core::common::error::Result<()>| outcome.expect_err("an error").to_string();
        let half = wgpu::TextureFormat::Rgba16Float;
        let target = |map, format| DirectTarget::new(context, map, format);
        let square = |size| DirectMap::Octahedral { size };
        let rectangle = |size| DirectMap::Rectangular { size };
        for (outcome, parts) in [
            (target(square(7), half), ["`size` 7", "even"]),
            (target(square(0), half), ["`size` 0", "even number"]),
            (target(square(1 << 20), half), ["1048576", "from 2 to"]),
            (target(rectangle(7), half), ["`size` 7", "even"]),
            (target(rectangle(6000), half), ["`size` 6000", "from 2 to 4096"]),
            (target(square(8), wgpu::TextureFormat::Rgba8Unorm), ["Rgba8Unorm", "Rgba16Float"]),
        ] {
            let message = failure(outcome.map(|_| ()));
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        }
        let sum = Direct::new(context, wgpu::TextureFormat::Rgba32Float, Overlap::Sum);
        assert!(matches!(sum, Err(Error::Parameter(_))));
        let direct = &PIPELINES.get(context).sum;
        let mesh = DirectMesh::upload(context, &closed(1, None, 1.0..2.0)).expect("a mesh that fits");
        // Beyond 128 MiB of pieces.
        let surface = closed(1, None, 1.0..2.0);
        let indices = surface.indices().iter().copied().cycle().take(3 * 107_547).collect();
        let large = Triangles::new(surface.corners().to_vec(), indices).expect("a valid mesh");
        let large = DirectMesh::upload(context, &large).expect("a mesh that fits");
        let map = target(square(8), half).expect("a target");
        let cube = target(DirectMap::Cube { size: 8 }, half).expect("a target");
        let float = target(square(8), wgpu::TextureFormat::Rgba32Float).expect("a target");
        for (outcome, part) in [
            (direct.frame(Method::Cube, &mesh, &map, 0.1), "choose a cube"),
            (direct.frame(Method::Octants, &mesh, &cube, 0.1), "choose an octahedral map"),
            (direct.frame(Method::Octants, &mesh, &float, 0.1), "Rgba32Float"),
            (direct.frame(Method::Octants, &mesh, &map, f32::NAN), "`near` is NaN"),
            (direct.frame(Method::Octants, &mesh, &map, 0.0), "`near` is 0"),
            (direct.frame(Method::StrictSplit, &large, &map, 0.1), "parts of at most 107546 triangles"),
        ] {
            let message = failure(outcome.map(|_| ()));
            assert!(message.contains(part), "{message}");
        }
    });
}
