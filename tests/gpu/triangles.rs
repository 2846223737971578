//! The oracle of triangles: hits lie on their rays, closed surfaces are hit once, changes are slopes.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::map::SphereMap as _;
use octagloss_core::sphere::octahedral::texel_centre;
use octagloss_core::sphere::octahedral_perspective::PLANAR;
use octagloss_core::sphere::octahedral_rectangular::OctahedralRectangular;
use octagloss_fixtures::common::Random;
use octagloss_fixtures::meshes::{closed, mesh};
use octagloss_fixtures::oracles::triangles::{Cover, TriangleOracle, corners_of};
use octagloss_gpu::triangles::{DirectMap, Triangles};

const NEAR: f32 = 0.25;

/// Both layouts.
fn maps(size: u32) -> [DirectMap; 2] {
    [DirectMap::Octahedral { size }, DirectMap::Rectangular { size }]
}

fn pixels(map: DirectMap) -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = (map.squares() * map.size(), map.size());
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// The direction of a pixel's centre.
fn ray(map: DirectMap, x: u32, y: u32) -> DVec3 {
    if map.squares() == 1 {
        return PLANAR.direction(0, texel_centre(map.size(), x, y));
    }
    // A pixel spans as much in both layouts; the rectangle begins at u = -2.
    OctahedralRectangular.direction(0, texel_centre(map.size(), x, y) - DVec2::X)
}

fn soup(seed: u64) -> Triangles {
    let mut random = Random::new(seed);
    let mut corner = || DVec3::from_array([0; 3].map(|_| random.between(-3.0, 3.0)));
    mesh(&(0..24).map(|_| [corner(), corner(), corner()]).collect::<Vec<_>>())
}

#[test]
fn hits_lie_on_the_ray_and_in_front() {
    let size = 24;
    let mut hits = 0;
    for (seed, map) in (0..8).flat_map(|seed| maps(size).map(|map| (seed, map))) {
        let soup = soup(seed);
        let oracle = TriangleOracle::new(&soup, map, NEAR).expect("a valid map");
        for (x, y) in pixels(map) {
            let ray = ray(map, x, y);
            for hit in oracle.pixel(x, y).0 {
                let [a, b, c, one] = hit.value;
                let at = DVec3::new(a, b, c);
                assert!(at.cross(ray).length() < 1e-9 * at.length() && at.dot(ray) > 0.0, "{at} along {ray}");
                assert!((hit.depth - f64::from(NEAR) / at.abs().element_sum()).abs() < 1e-12);
                assert!(hit.depth <= 1.0 && (one - 1.0).abs() < 1e-9);
                // In the triangle's plane.
                let [p, q, r] = corners_of(&soup, hit.triangle)
                    .map(|corner| DVec3::from_array(corner.position.map(f64::from)));
                let normal = (q - p).cross(r - p).normalize();
                assert!((at - p).dot(normal).abs() < 1e-9, "{at}");
                hits += 1;
            }
        }
    }
    assert!(hits > 1000, "{hits} hits");
}

#[test]
fn a_closed_surface_is_hit_once() {
    let surface = closed(4, Some(7), 0.5..2.0);
    for map in maps(34) {
        let oracle = TriangleOracle::new(&surface, map, NEAR).expect("a valid map");
        let mut doubts = 0;
        for (x, y) in pixels(map) {
            let (hits, doubtful) = oracle.pixel(x, y);
            assert!(hits.len() == 1 || hits.is_empty() && doubtful > 0, "({x}, {y})");
            doubts += u32::from(hits.is_empty());
        }
        // A band of an eighth of a pixel around about 200 edges.
        assert!(doubts < map.pixels() / 3, "{doubts} doubtful pixels");
    }
}

#[test]
fn changes_are_slopes() {
    let step = |from: f64, to: f64, slope: f64| (to - from).abs() <= 1.05 * slope + 1e-9;
    let soup = soup(3);
    // Pixels of rows and columns within one octant.
    for (map, columns, rows) in [
        (DirectMap::Octahedral { size: 256 }, 130..180, 140..145),
        (DirectMap::Rectangular { size: 256 }, 90..140, 190..195),
        (DirectMap::Rectangular { size: 256 }, 490..495, 90..140),
    ] {
        let oracle = TriangleOracle::new(&soup, map, NEAR).expect("a valid map");
        let (mut steps, mut steep) = (0, 0);
        let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        for ((x, y), index) in places.flat_map(|at| (0..soup.count()).map(move |index| (at, index))) {
            let Cover::Inside(here) = oracle.cover(x, y, index) else { continue };
            for next in [oracle.cover(x + 1, y, index), oracle.cover(x, y + 1, index)] {
                let Cover::Inside(next) = next else { continue };
                assert!(step(here.depth, next.depth, here.depth_change));
                for k in 0..4 {
                    // Between the pixels the slope of a quotient is between theirs.
                    let slope = here.value_change[k].max(next.value_change[k]);
                    assert!(step(here.value[k], next.value[k], slope));
                }
                steps += 1;
                steep += usize::from((next.depth - here.depth).abs() > 0.3 * here.depth_change);
            }
        }
        assert!(steps > 200 && steep > 40, "{steep} of {steps} in {map:?}");
    }
}

#[test]
fn planes_through_the_centre_are_seen_from_their_edge() {
    let flat = |corners: [[f64; 3]; 3]| mesh(&[corners.map(DVec3::from_array)]);
    let size = 32;
    for (triangle, most) in [
        // The centre inside, beside, on a corner; a segment; a point.
        (flat([[1.0, 0.3, 0.1], [-1.0, 0.2, 0.4], [0.0, -0.5, -0.5]]), 32 * 6),
        (flat([[1.0, 0.5, 0.0], [2.0, -1.0, 0.0], [1.0, 1.0, 0.0]]), 32 * 6),
        (flat([[0.0, 0.0, 0.0], [2.0, -1.0, 0.5], [1.0, 1.0, 0.3]]), 32 * 6),
        (flat([[1.0, 1.0, 0.2], [1.0, 1.0, 0.2], [-1.0, 0.4, 0.2]]), 32 * 6),
        (flat([[1.0, 1.0, 0.2], [2.0, 2.0, 0.4], [3.0, 3.0, 0.6]]), 64),
    ] {
        let map = DirectMap::Octahedral { size };
        let oracle = TriangleOracle::new(&triangle, map, NEAR).expect("a valid map");
        let mut doubtful = 0;
        for (x, y) in pixels(map) {
            match oracle.cover(x, y, 0) {
                Cover::Inside(hit) => panic!("{hit:?} at ({x}, {y})"),
                Cover::Doubtful => doubtful += 1,
                Cover::Outside => {}
            }
        }
        assert!(doubtful <= most, "{doubtful} doubtful pixels");
    }
}

#[test]
fn odd_maps_and_cubes_are_errors() {
    let soup = soup(1);
    let message =
        |map| TriangleOracle::new(&soup, map, NEAR).expect_err("a map without an oracle").to_string();
    for (size, map) in [0, 7].into_iter().flat_map(|size| maps(size).map(|map| (size, map))) {
        let message = message(map);
        assert!(message.contains(&size.to_string()) && message.contains("even"), "{message}");
    }
    let message = message(DirectMap::Cube { size: 8 });
    assert!(message.contains("choose an octahedral map"), "{message}");
}
