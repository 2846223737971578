//! The maps of the sphere: round trips, solid angles, wrapping.

mod maps;

use glam::{DVec2, DVec3};
use octagloss_core::sphere::{cube, equirect, octahedral};
use octagloss_fixtures::common::{Random, landmarks};
use std::f64::consts::{PI, TAU};

/// Fewer than 16 roundings of 2^-53 per round trip, none amplified more than threefold: the steepest map, the
/// octahedral one, moves a direction by at most 3 per unit of (u, v).
const ROUND_TRIP: f64 = 16.0 * 3.0 / (1_u64 << 53) as f64;

/// Returns directions in every octant, on every axis, edge and diagonal, near them, and everywhere.
fn directions() -> Vec<DVec3> {
    let mut all = landmarks();
    for landmark in landmarks() {
        for nudge in [1e-3, 1e-9, 1e-15] {
            for other in landmarks() {
                all.push((landmark + other * nudge).normalize_or(landmark));
            }
        }
    }
    let mut random = Random::new(1);
    all.extend((0..20_000).map(|_| random.direction()));
    all
}

/// Returns the greatest distance between a direction and its round trip.
fn worst_round_trip(there_and_back: impl Fn(DVec3) -> DVec3) -> f64 {
    let all = directions();
    assert!(all.len() > 20_000, "directions were compared");
    all.into_iter().map(|d| there_and_back(d).distance(d)).fold(0.0, f64::max)
}

#[test]
fn directions_survive_every_map() {
    let octahedral = worst_round_trip(|d| octahedral::direction_from_oct(octahedral::oct_from_direction(d)));
    assert!(octahedral <= ROUND_TRIP, "octahedral {octahedral:e}");
    let cube = worst_round_trip(|d| {
        let (face, s, t) = cube::cube_from_direction(d);
        cube::direction_from_cube(face, s, t)
    });
    assert!(cube <= ROUND_TRIP, "cube {cube:e}");
    let panorama = worst_round_trip(|d| {
        let (u, v) = equirect::equirect_from_direction(d);
        equirect::direction_from_equirect(u, v)
    });
    assert!(panorama <= ROUND_TRIP, "panorama {panorama:e}");
}

#[test]
fn the_round_trip_detects_a_wrong_sign_and_a_wrong_fold() {
    let turned = worst_round_trip(|d| {
        let uv = octahedral::oct_from_direction(d);
        octahedral::direction_from_oct(DVec2::new(uv.x, -uv.y))
    });
    assert!(turned > 1.0, "a flipped v is not detected: {turned}");
    // Equation 2 as printed, with a sign in place of the absolute value.
    let printed = worst_round_trip(|d| {
        let p = d / (d.x.abs() + d.y.abs() + d.z.abs());
        let sign = |t: f64| 1.0_f64.copysign(t);
        let uv = if p.y >= 0.0 {
            DVec2::new(p.x, p.z)
        } else {
            DVec2::new((1.0 - sign(p.z)) * sign(p.x), (1.0 - sign(p.x)) * sign(p.z))
        };
        octahedral::direction_from_oct(uv.clamp(DVec2::NEG_ONE, DVec2::ONE))
    });
    assert!(printed > 1.0, "the printed equation is not detected: {printed}");
}

#[test]
fn coordinates_survive_the_sphere() {
    let mut random = Random::new(2);
    for _ in 0..20_000 {
        let uv = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        let back = octahedral::oct_from_direction(octahedral::direction_from_oct(uv));
        assert!(back.distance(uv) <= ROUND_TRIP, "octahedral {uv} comes back as {back}");
        for face in cube::Face::ALL {
            let (other, s, t) = cube::cube_from_direction(cube::direction_from_cube(face, uv.x, uv.y));
            assert_eq!(other, face, "face at {uv}");
            let back = DVec2::new(s, t);
            assert!(back.distance(uv) <= ROUND_TRIP, "{face:?} {uv} comes back as {back}");
        }
        let (u, v) = ((uv.x + 1.0) / 2.0, (uv.y + 1.0) / 2.0);
        let direction = equirect::direction_from_equirect(u, v);
        let (back_u, back_v) = equirect::equirect_from_direction(direction);
        // The error of longitude grows towards the poles by 1/sin of the polar angle.
        assert!((back_v - v).abs() <= ROUND_TRIP, "v {v} comes back as {back_v}");
        assert!((back_u - u).abs() * (v * PI).sin() <= ROUND_TRIP, "u {u} comes back as {back_u}");
    }
}

#[test]
fn the_conventions_are_the_documented_ones() {
    use octahedral::direction_from_oct;
    let at = |u: f64, v: f64| direction_from_oct(DVec2::new(u, v));
    assert_eq!(at(0.0, 0.0), DVec3::Y);
    for (u, v, direction) in
        [(1.0, 0.0, DVec3::X), (-1.0, 0.0, -DVec3::X), (0.0, 1.0, DVec3::Z), (0.0, -1.0, -DVec3::Z)]
    {
        assert_eq!(at(u, v), direction, "edge midpoint ({u}, {v})");
    }
    for (u, v) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        assert_eq!(at(u, v), -DVec3::Y, "corner ({u}, {v})");
    }
    let panorama = |u: f64, v: f64| equirect::direction_from_equirect(u, v);
    assert!(panorama(0.5, 0.5).distance(DVec3::X) < ROUND_TRIP, "the centre looks along +X");
    assert!(panorama(0.75, 0.5).distance(DVec3::Z) < ROUND_TRIP, "the right half along +Z");
    assert!(panorama(0.3, 0.0).distance(DVec3::Y) < ROUND_TRIP, "the top along +Y");
    // The s_c/t_c table of OpenGL, texel (0, 0) top left.
    let corner = |face| cube::direction_from_cube(face, -1.0, -1.0) * 3_f64.sqrt();
    let table = [
        (cube::Face::PosX, DVec3::new(1.0, 1.0, 1.0)),
        (cube::Face::NegX, DVec3::new(-1.0, 1.0, -1.0)),
        (cube::Face::PosY, DVec3::new(-1.0, 1.0, -1.0)),
        (cube::Face::NegY, DVec3::new(-1.0, -1.0, 1.0)),
        (cube::Face::PosZ, DVec3::new(-1.0, 1.0, 1.0)),
        (cube::Face::NegZ, DVec3::new(1.0, 1.0, -1.0)),
    ];
    for (face, direction) in table {
        assert!(corner(face).distance(direction) < ROUND_TRIP, "{face:?}");
    }
}

const SIZES: [u32; 6] = [1, 2, 3, 5, 64, 100];

fn octahedral_sum(n: u32) -> f64 {
    (0..n * n).map(|k| octahedral::texel_solid_angle(n, k % n, k / n)).sum()
}

#[test]
fn solid_angles_sum_to_the_sphere() {
    // 10^4 terms of relative 1e-15 each.
    let whole = |sum: f64| (sum - 4.0 * PI).abs() <= 1e-12;
    for n in SIZES {
        let octahedral = octahedral_sum(n);
        assert!(whole(octahedral), "octahedral {n}: {octahedral}");
        let cube: f64 = (0..n * n).map(|k| 6.0 * cube::texel_solid_angle(n, k % n, k / n)).sum();
        assert!(whole(cube), "cube {n}: {cube}");
        let rows: f64 = (0..n).map(|j| equirect::texel_solid_angle(2 * n, n, j) * f64::from(2 * n)).sum();
        assert!(whole(rows), "panorama {n}: {rows}");
    }
    assert!(
        !whole(octahedral_sum(64) + 1e-9 * octahedral::texel_solid_angle(64, 0, 0) * 1e6),
        "an error must be detected"
    );
}

/// Area of the spherical triangle by L'Huilier's theorem, which is independent of the library's formula.
fn l_huilier(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let side = |p: DVec3, q: DVec3| 2.0 * (p.distance(q) / 2.0).asin();
    let (x, y, z) = (side(b, c), side(c, a), side(a, b));
    let half = (x + y + z) / 2.0;
    let product =
        [half, half - x, half - y, half - z].iter().map(|t| (t.max(0.0) / 2.0).tan()).product::<f64>();
    4.0 * product.sqrt().atan()
}

/// Area of a square of a map, as 4 x 4 parts of two triangles each; `rising` selects the diagonal of a part.
fn triangulated(
    low: DVec2,
    high: DVec2,
    direction: impl Fn(DVec2) -> DVec3,
    rising: impl Fn(DVec2) -> bool,
) -> f64 {
    let step = (high - low) / 4.0;
    let mut sum = 0.0;
    for k in 0..16 {
        let corner = low + step * DVec2::new(f64::from(k % 4), f64::from(k / 4));
        let at = |a: f64, b: f64| direction(corner + step * DVec2::new(a, b));
        let [p00, p10, p11, p01] = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        sum += if rising(corner + step / 2.0) {
            l_huilier(p00, p10, p11) + l_huilier(p00, p11, p01)
        } else {
            l_huilier(p00, p10, p01) + l_huilier(p10, p11, p01)
        };
    }
    sum
}

/// Returns the relative difference of texel (x, y)'s solid angle from the triangles'.
fn octahedral_discrepancy(n: u32, x: u32, y: u32, solid_angle: f64) -> f64 {
    let half = DVec2::splat(1.0 / f64::from(n));
    let centre = octahedral::texel_centre(n, x, y);
    // Great circles are straight on each face, so no triangle may straddle a fold: |u| + |v| = const falls
    // where u v > 0.
    let expected =
        triangulated(centre - half, centre + half, octahedral::direction_from_oct, |p| p.x * p.y < 0.0);
    (solid_angle / expected - 1.0).abs()
}

/// L'Huilier subtracts nearly equal sides: 32 triangles of at least 1/400 of a radian, each exact to
/// 2^-53 / (1/400)^2.
const TRIANGLES: f64 = 32.0 * 160_000.0 / (1_u64 << 53) as f64;

#[test]
fn solid_angles_match_a_triangulation() {
    let mut compared = 0;
    for n in SIZES {
        for k in 0..n * n {
            let (x, y) = (k % n, k / n);
            let solid_angle = octahedral::texel_solid_angle(n, x, y);
            let off = octahedral_discrepancy(n, x, y, solid_angle);
            assert!(off <= TRIANGLES, "octahedral {n} ({x}, {y}): {off:e}");
            let low = DVec2::new(f64::from(x), f64::from(y)) * 2.0 / f64::from(n) - 1.0;
            let high = low + 2.0 / f64::from(n);
            let face = |p: DVec2| cube::direction_from_cube(cube::Face::NegY, p.x, p.y);
            let expected = triangulated(low, high, face, |_| true);
            let off = (cube::texel_solid_angle(n, x, y) / expected - 1.0).abs();
            assert!(off <= TRIANGLES, "cube {n} ({x}, {y}): {off:e}");
            compared += 2;
        }
    }
    assert!(compared > 28_000, "{compared} texels compared");
    let n = 5;
    let wrong = octahedral::texel_solid_angle(n, 2, 2) * (1.0 + 2.0 * TRIANGLES);
    assert!(octahedral_discrepancy(n, 2, 2, wrong) > TRIANGLES, "a wrong texel must be detected");
}

#[test]
fn panorama_rows_match_simpson_s_rule() {
    for (width, height) in [(2, 1), (6, 3), (10, 5), (200, 100), (8192, 4096)] {
        for j in 0..height {
            let edge = |k: u32| f64::from(k) / f64::from(height) * PI;
            let (a, b) = (edge(j), edge(j + 1));
            // 64 panels: the error is (b - a)^5 / (2880 * 64^4), relatively below 1e-7 in the widest row and
            // far less in others.
            let panels = 64;
            let step = (b - a) / f64::from(panels);
            let at = |t: f64| (a + t * step).sin();
            let sum: f64 = (0..panels)
                .map(f64::from)
                .map(|k| (at(k) + 4.0 * at(k + 0.5) + at(k + 1.0)) * step / 6.0)
                .sum();
            let expected = sum * TAU / f64::from(width);
            let off = (equirect::texel_solid_angle(width, height, j) / expected - 1.0).abs();
            assert!(off <= 1e-7, "row {j} of {width}x{height}: {off:e}");
        }
    }
}

#[test]
fn the_density_is_that_of_small_texels() {
    // A texel's mean density equals its centre's to second order: h^2/24 times a second derivative below 100.
    let n = 256;
    let area = (2.0 / f64::from(n)).powi(2);
    let mut greatest: f64 = 0.0;
    let mut compared = 0;
    for k in 0..n * n {
        let (x, y) = (k % n, k / n);
        if x == y || x + y == n - 1 || (x + n / 2) % n == y || (x + y + 1) % n == n / 2 {
            continue; // cut by a fold, where the density has a kink
        }
        let density = octahedral::solid_angle_density(octahedral::texel_centre(n, x, y));
        let mean = octahedral::texel_solid_angle(n, x, y) / area;
        assert!((density / mean - 1.0).abs() <= 100.0 * area / 24.0, "({x}, {y}): {density} against {mean}");
        greatest = greatest.max(density);
        compared += 1;
    }
    assert!(compared > 60_000, "{compared} texels compared");
    assert!((greatest / 3_f64.powf(1.5) - 1.0).abs() < 0.01, "5.196 at the face centres, got {greatest}");
}

/// Counts the texels of the square and its border of `b` for which `wrap` disagrees with the continuous rule
/// at the centre, and all texels.
fn disagreements(n: u32, b: i64, wrap: impl Fn(i64, i64) -> (i64, i64)) -> (usize, usize) {
    let size = i64::from(n);
    let (mut wrong, mut compared) = (0, 0);
    for y in -b..size + b {
        for x in -b..size + b {
            let centre = (DVec2::new(x as f64, y as f64) + 0.5) * (2.0 / f64::from(n)) - 1.0;
            let inside = (octahedral::wrap_oct(centre) + 1.0) * f64::from(n) / 2.0;
            let expected = (inside.x.floor() as i64, inside.y.floor() as i64);
            wrong += usize::from(wrap(x, y) != expected);
            compared += 1;
        }
    }
    (wrong, compared)
}

#[test]
fn integer_wrap_is_the_continuous_one() {
    let wrap = |n| {
        move |x, y| {
            let (x, y) = octahedral::wrap_texel(n, x, y);
            (i64::from(x), i64::from(y))
        }
    };
    for n in [1, 2, 3, 4, 7, 64] {
        for b in 0..=i64::from(n) {
            let (wrong, compared) = disagreements(n, b, wrap(n));
            assert!(compared > 0, "n {n} b {b}: texels were compared");
            assert_eq!(wrong, 0, "n {n} b {b}: {wrong} of {compared} texels");
        }
        // Corners and distant tiles.
        assert_eq!(disagreements(n, 5 * i64::from(n), wrap(n)).0, 0, "n {n}, five tiles around");
    }
}

#[test]
fn the_wrap_detects_the_rule_that_is_off_by_one_on_the_low_edges() {
    // A known renderer maps texel -1 to 1, but n to n - 1.
    let off_by_one = |n: i64| {
        move |mut x: i64, mut y: i64| {
            if x < 0 {
                (x, y) = (-x, n - 1 - y);
            } else if x >= n {
                (x, y) = (2 * n - 1 - x, n - 1 - y);
            }
            if y < 0 {
                (x, y) = (n - 1 - x, -y);
            } else if y >= n {
                (x, y) = (n - 1 - x, 2 * n - 1 - y);
            }
            (x, y)
        }
    };
    for n in [1_u32, 2, 3, 4, 7, 64] {
        let (wrong, _) = disagreements(n, 1, off_by_one(i64::from(n)));
        assert!(wrong as u32 >= 2 * n, "n {n}: the low edges are wrong, only {wrong} detected");
    }
}

/// Returns the greatest step of the direction across the square's edges, per distance in (u, v).
fn steepest_step(wrap: impl Fn(DVec2) -> DVec2) -> f64 {
    let mut steepest: f64 = 0.0;
    let epsilon = 1e-6;
    for k in 0..=1000 {
        let along = f64::from(k) / 500.0 - 1.0;
        for out in [-1.0, 1.0] {
            for [inside, outside] in [
                [DVec2::new(out * (1.0 - epsilon), along), DVec2::new(out * (1.0 + epsilon), along)],
                [DVec2::new(along, out * (1.0 - epsilon)), DVec2::new(along, out * (1.0 + epsilon))],
            ] {
                let direction = |uv| octahedral::direction_from_oct(wrap(uv));
                steepest = steepest.max(direction(inside).distance(direction(outside)) / (2.0 * epsilon));
            }
        }
    }
    steepest
}

#[test]
fn directions_are_continuous_over_wrapped_edges() {
    // |dl| <= |dp| / |p| <= sqrt(3) |dp| and |dp| <= sqrt(3) |d(u, v)| on a face.
    let steepest = steepest_step(octahedral::wrap_oct);
    assert!(steepest > 0.5 && steepest <= 3.0, "{steepest} a unit of (u, v)");
    let torus = steepest_step(|uv| (uv + 1.0).rem_euclid(DVec2::splat(2.0)) - 1.0);
    assert!(torus > 1000.0, "the wrap of a torus must be discontinuous: {torus}");
}
