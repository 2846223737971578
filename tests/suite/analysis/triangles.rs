//! The oracle of triangles: hits lie on their rays, closed surfaces are hit once, changes are slopes.

use crate::support::common::Random;
use crate::support::meshes::{closed, mesh};
use glam::DVec3;
use octagloss::internals::analysis::oracle::{Cover, TriangleOracle};
use octagloss::internals::direct::Triangles;
use octagloss::internals::sphere::octahedral::{direction_from_oct, texel_centre};

const NEAR: f32 = 0.25;

fn soup(seed: u64) -> Triangles {
    let mut random = Random::new(seed);
    let mut corner = || DVec3::from_array([0; 3].map(|_| random.between(-3.0, 3.0)));
    mesh(&(0..24).map(|_| [corner(), corner(), corner()]).collect::<Vec<_>>())
}

#[test]
fn hits_lie_on_the_ray_and_in_front() {
    let size = 24;
    let mut hits = 0;
    for seed in 0..8 {
        let soup = soup(seed);
        let oracle = TriangleOracle::new(&soup, size, NEAR).expect("a valid map");
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
            let ray = direction_from_oct(texel_centre(size, x, y));
            for hit in oracle.pixel(x, y).0 {
                let [a, b, c, one] = hit.value;
                let at = DVec3::new(a, b, c);
                assert!(at.cross(ray).length() < 1e-9 * at.length() && at.dot(ray) > 0.0, "{at} along {ray}");
                assert!((hit.depth - f64::from(NEAR) / at.abs().element_sum()).abs() < 1e-12);
                assert!(hit.depth <= 1.0 && (one - 1.0).abs() < 1e-9);
                // In the triangle's plane.
                let [p, q, r] = soup
                    .triangle(hit.triangle)
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
    let (surface, size) = (closed(4, Some(7), 0.5..2.0), 34);
    let oracle = TriangleOracle::new(&surface, size, NEAR).expect("a valid map");
    let mut doubts = 0;
    for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
        let (hits, doubtful) = oracle.pixel(x, y);
        assert!(hits.len() == 1 || hits.is_empty() && doubtful > 0, "({x}, {y})");
        doubts += usize::from(hits.is_empty());
    }
    // A band of an eighth of a pixel around about 200 edges.
    assert!(doubts < 34 * 34 / 3, "{doubts} doubtful pixels");
}

#[test]
fn changes_are_slopes() {
    let size = 256;
    let step = |from: f64, to: f64, slope: f64| (to - from).abs() <= 1.05 * slope + 1e-9;
    let (mut steps, mut steep) = (0, 0);
    let soup = soup(3);
    let oracle = TriangleOracle::new(&soup, size, NEAR).expect("a valid map");
    // A row within one octant.
    for x in 130..180 {
        for index in 0..soup.count() {
            let [here, next] = [x, x + 1].map(|x| oracle.cover(x, 140, index));
            if let (Cover::Inside(here), Cover::Inside(next)) = (here, next) {
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
    }
    assert!(steps > 50 && steep > 10, "{steep} of {steps}");
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
        let oracle = TriangleOracle::new(&triangle, size, NEAR).expect("a valid map");
        let mut doubtful = 0;
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
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
fn odd_maps_are_errors() {
    let soup = soup(1);
    for size in [0, 7] {
        let message = TriangleOracle::new(&soup, size, NEAR).expect_err("a bad size").to_string();
        assert!(message.contains(&size.to_string()) && message.contains("even"), "{message}");
    }
}
