//! Every map of the sphere, tested against one contract and against its source.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::{Place, SphereMap, Texel};
use octagloss_core::sphere::octahedral_perspective::{OctahedralPerspective, PLANAR};
use octagloss_core::sphere::polar_capped::{CONFORMAL, PolarCapped};
use octagloss_core::sphere::registry::{MAPS, named};
use octagloss_core::sphere::{cube, octahedral, tennis_ball};
use octagloss_fixtures::common::{Random, landmarks, texel_from_direction};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// Error of a round trip over the map's condition number; 2^-53 and some dozen roundings stay below a
/// hundredth of it.
const ROUND_TRIP: f64 = 1e-12;

/// Returns directions in every octant, on every axis, edge and diagonal, near them, and `count` random ones.
fn directions(count: u32) -> Vec<DVec3> {
    let mut all = landmarks();
    for landmark in landmarks() {
        for nudge in [1e-3, 1e-9, 1e-15] {
            all.extend(landmarks().iter().map(|other| (landmark + *other * nudge).normalize_or(landmark)));
        }
    }
    let mut random = Random::new(15);
    all.extend((0..count).map(|_| random.direction()));
    all
}

/// Returns the greatest movement of the direction per unit of (u, v) over eight steps, at least 1.
fn condition(map: &dyn SphereMap, place: Place) -> f64 {
    let step = 1e-9;
    let at = map.direction(place.component, place.uv);
    let ways = [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
    let moved = ways
        .into_iter()
        .flat_map(|(u, v)| [DVec2::new(u, v), -DVec2::new(u, v)])
        .map(|way| map.direction(place.component, place.uv + way * step).distance(at) / step);
    moved.fold(1.0, f64::max)
}

/// Returns the greatest distance of a direction from its round trip, over the condition number there.
fn worst_round_trip(map: &dyn SphereMap, count: u32, locate: impl Fn(DVec3) -> Place) -> f64 {
    let mut worst: f64 = 0.0;
    for d in directions(count) {
        let place = locate(d);
        let back = map.direction(place.component, place.uv);
        assert!(
            back.is_finite() && place.uv.is_finite(),
            "{map:?}: {d} goes to {place:?} and back to {back}"
        );
        worst = worst.max(back.distance(d) / condition(map, place));
    }
    worst
}

#[test]
fn directions_survive_every_map_within_its_domains() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let worst = worst_round_trip(*map, 100_000, |d| map.locate(d));
        assert!(worst <= ROUND_TRIP, "{name}: {worst:e}");
        for d in directions(10_000) {
            let Place { component, uv } = map.locate(d * 3.0);
            let rectangle = map.component(component);
            let rounding = 1e-12 * rectangle.extent();
            let inside =
                uv.cmpge(rectangle.low - rounding).all() && uv.cmple(rectangle.high + rounding).all();
            assert!(inside, "{name}: {d} lies at {uv} of component {component}, outside {rectangle:?}");
            // Move slightly towards the middle: rounding may carry a point of the rim across.
            let middle = (rectangle.low + rectangle.high) / 2.0;
            assert!(
                map.contains(component, uv.lerp(middle, 1e-9)),
                "{name}: {d} at {uv} is outside the domain"
            );
        }
    }
}

#[test]
fn the_round_trip_detects_a_wrong_sign() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let worst = worst_round_trip(*map, 100, |d| map.locate(DVec3::new(d.x, d.y, -d.z)));
        assert!(worst > 1e6 * ROUND_TRIP, "{name}: a mirrored inverse must be detected: {worst:e}");
    }
}

/// Returns points of every component's domain: a grid of `n` x `n`, off the folds.
fn domain_points(map: &dyn SphereMap, n: u32) -> Vec<Place> {
    let mut all = Vec::new();
    for component in 0..map.components() {
        let rectangle = map.component(component);
        for k in 0..n * n {
            let share = DVec2::new(f64::from(k % n) + 0.37, f64::from(k / n) + 0.41) / f64::from(n);
            let uv = rectangle.low + rectangle.extent() * share;
            if map.contains(component, uv) {
                all.push(Place { component, uv });
            }
        }
    }
    all
}

#[test]
fn coordinates_survive_the_sphere() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let points = domain_points(*map, 61);
        assert!(points.len() > 2000, "{name}: {} points", points.len());
        for Place { component, uv } in points {
            let back = map.locate(map.direction(component, uv));
            assert_eq!(back.component, component, "{name}: component at {uv}");
            // The inverse amplifies rounding by the reciprocal of the map's slope, at least 1/1000 here, near
            // poles and rims.
            assert!(back.uv.distance(uv) <= 1e-11, "{name}: {uv} comes back as {}", back.uv);
        }
    }
}

/// Sums the solid angles of all texels of a grid, column by column: long sums of equal terms round one way.
fn sphere(map: &'static dyn SphereMap, size: u32) -> f64 {
    let grid = Grid::new(map, size).expect("a size");
    let solid_angles: Vec<f64> = grid.texels().map(|texel| grid.solid_angle(texel)).collect();
    solid_angles.chunks(size as usize).map(|some| some.iter().sum::<f64>()).sum()
}

#[test]
fn solid_angles_sum_to_the_sphere() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        for size in [1, 2, 3, 5, 64] {
            let sum = sphere(*map, size);
            assert!((sum - 4.0 * PI).abs() <= 1e-12, "{name}, {size}: {:e} off", sum - 4.0 * PI);
        }
    }
}

/// Returns the greatest difference between texels' solid angles and the mean density over them, relative to
/// the greatest texel.
fn solid_angle_discrepancy(map: &'static dyn SphereMap, wrong: f64) -> f64 {
    let grid = Grid::new(map, 6).expect("a size");
    let (mut worst, mut greatest): (f64, f64) = (0.0, 0.0);
    for texel in grid.texels() {
        let rectangle = map.component(texel.component);
        let step = grid.step(&rectangle);
        let n = 48;
        let mut sum = 0.0;
        for k in 0..n * n {
            let share = DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n);
            let uv = grid.uv(texel.component, f64::from(texel.x) + share.x, f64::from(texel.y) + share.y);
            if map.contains(texel.component, uv) {
                sum += map.density(texel.component, uv);
            }
        }
        let expected = sum * step.x * step.y / f64::from(n * n);
        let solid_angle = grid.solid_angle(texel) * wrong;
        worst = worst.max((solid_angle - expected).abs());
        greatest = greatest.max(solid_angle);
    }
    worst / greatest
}

#[test]
fn solid_angles_are_integrals_of_the_density_over_the_domain() {
    // A rim shorter than two texels misplaces at most half a point per row and column: 2/(2 * 48).
    let bound = 1.0 / 48.0;
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let off = solid_angle_discrepancy(*map, 1.0);
        assert!(off <= bound, "{name}: {off:e}");
    }
    assert!(
        solid_angle_discrepancy(named("tennis-ball").expect("a map").map(), 1.05) > bound,
        "an error of 5 % must be detected"
    );
}

/// Returns the greatest difference between the density and that of a small square's image, over the greatest.
fn density_discrepancy(map: &dyn SphereMap, wrong: f64) -> f64 {
    let (mut worst, mut greatest): (f64, f64) = (0.0, 0.0);
    for Place { component, uv } in domain_points(map, 23) {
        let rectangle = map.component(component);
        let middle = (rectangle.low + rectangle.high) / 2.0;
        if !map.contains(component, middle.lerp(uv, 1.1)) {
            continue; // near a rim, where derivatives may be large
        }
        let step = 1e-5;
        let at = |u: f64, v: f64| map.direction(component, uv + DVec2::new(u, v) * step);
        let area =
            (at(1.0, 0.0) - at(-1.0, 0.0)).cross(at(0.0, 1.0) - at(0.0, -1.0)).length() / (4.0 * step * step);
        let density = map.density(component, uv) * wrong;
        worst = worst.max((density - area).abs());
        greatest = greatest.max(density);
    }
    worst / greatest
}

#[test]
fn densities_match_small_squares() {
    // Differences of 1e-5: third derivatives below 1000 add 2e-8, rounding 2^-52 / 1e-5.
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let off = density_discrepancy(*map, 1.0);
        assert!(off <= 1e-7, "{name}: {off:e}");
        assert!(density_discrepancy(*map, 1.0 + 1e-6) > 1e-7, "{name}: a wrong density must be detected");
    }
}

/// Counts texels in a border of `b` that are not where the map's continuation places them.
fn misplaced(map: &'static dyn SphereMap, size: u32, b: i64, shift: i64) -> Option<usize> {
    let grid = Grid::new(map, size).expect("a size");
    let mut wrong = 0;
    for component in 0..map.components() {
        let [width, height] = grid.sides(component).map(i64::from);
        for y in -b..height + b {
            for x in -b..width + b {
                let texel = map.wrap_texel(size, component, x, y + shift)?;
                let expected = map.direction(component, grid.uv(component, x as f64 + 0.5, y as f64 + 0.5));
                wrong += usize::from(grid.direction_from_texel(texel).distance(expected) > 1e-9);
            }
        }
    }
    Some(wrong)
}

/// Returns `direction` with its coordinate `axis` negated.
fn reflected(mut direction: DVec3, axis: usize) -> DVec3 {
    direction[axis] = -direction[axis];
    direction
}

/// Counts texels whose image in the plane of `axis` is not theirs again, or is not where `shown` is, the
/// plane of an axis; `None` if the map lacks the mirror.
fn misreflected(grid: &Grid, axis: usize, shown: usize) -> Option<usize> {
    let mut wrong = 0;
    for texel in grid.texels() {
        let image = grid.mirrored(texel, axis)?;
        let expected = reflected(grid.direction_from_texel(texel), shown);
        wrong += usize::from(
            grid.mirrored(image, axis) != Some(texel)
                || grid.direction_from_texel(image).distance(expected) > 1e-9,
        );
    }
    Some(wrong)
}

#[test]
fn mirrors_map_texels_onto_texels() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let axes: Vec<usize> = (0..3)
            .filter(|axis| {
                for size in [2, 6, 8] {
                    let grid = Grid::new(*map, size).expect("a size");
                    let Some(wrong) = misreflected(&grid, *axis, *axis) else { return false };
                    assert_eq!(wrong, 0, "{name}, axis {axis}, {size}");
                    let others = misreflected(&grid, *axis, (axis + 1) % 3).expect("a mirror");
                    assert!(others > grid.texel_count() / 4, "{name}: another plane must be detected");
                }
                true
            })
            .collect();
        let expected: &[usize] =
            if ["tennis-ball", "sphere-map"].contains(name) { &[0, 1] } else { &[0, 1, 2] };
        assert_eq!(axes, expected, "{name}");
    }
    // A fold through texels.
    let odd = Grid::new(named("octahedral").expect("a map").map(), 5).expect("a size");
    assert_eq!(misreflected(&odd, 1, 1), None);
    assert_eq!(misreflected(&odd, 0, 0), Some(0));
}

#[test]
fn texels_wrap_by_the_map_s_continuation() {
    let mut wrapped = Vec::new();
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        for size in [1, 2, 3, 4, 7, 16] {
            let Some(wrong) = misplaced(*map, size, 2 * i64::from(size), 0) else { continue };
            assert_eq!(wrong, 0, "{name}, {size}");
            wrapped.push(*name);
        }
        if let Some(wrong) = misplaced(*map, 8, 8, 1) {
            assert!(wrong > 100, "{name}: a shift by one row must be detected");
        }
    }
    wrapped.dedup();
    let expected =
        ["octahedral", "octahedral-rectangular", "octahedral-perspective", "low-distortion", "equirect"];
    assert_eq!(wrapped, expected, "maps whose texels continue onto texels");
}

#[test]
fn maps_are_continuous_outside_their_domains() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        for component in 0..map.components() {
            let rectangle = map.component(component);
            let step = rectangle.extent() / 64.0;
            // Two texels around the rectangle. The mirror ball ends at its rim, the polar squares of HEALPix
            // in a point.
            for k in 0..68 * 68 {
                let corner = rectangle.low + step * (DVec2::new(f64::from(k % 68), f64::from(k / 68)) - 2.0);
                let at = |u: f64, v: f64| map.direction(component, corner + step * DVec2::new(u, v));
                let far = at(0.2, 0.2).distance(at(0.8, 0.8));
                assert!(far.is_finite(), "{name}: finite at {corner} of component {component}");
                let singular = ["sphere-map", "healpix"].contains(name);
                assert!(singular || far < 0.3, "{name}: {far} at {corner} of component {component}");
            }
        }
    }
}

#[test]
fn grids_number_texels_and_find_them_again() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        let grid = Grid::new(*map, 5).expect("a size");
        let mut expected = 0;
        let mut found = 0;
        for texel in grid.texels() {
            assert_eq!(grid.index(texel), expected, "{name}: {texel:?}");
            expected += 1;
            let middle = grid.uv(texel.component, f64::from(texel.x) + 0.5, f64::from(texel.y) + 0.5);
            if map.contains(texel.component, middle) {
                let back = texel_from_direction(&grid, grid.direction_from_texel(texel));
                // Texels cut by a fold through their centre may be found on its other side.
                found += usize::from(back == texel);
            }
        }
        assert_eq!(expected, grid.texel_count(), "{name}: count");
        assert!(found * 4 >= expected * 3 - expected, "{name}: {found} of {expected} found again");
        for direction in directions(10_000) {
            let Texel { component, x, y } = texel_from_direction(&grid, direction);
            let [width, height] = grid.sides(component);
            assert!(x < width && y < height, "{name}: {direction}");
        }
    }
    assert!(
        Grid::new(MAPS[0].map(), 0).is_err() && Grid::new(MAPS[0].map(), 1 << 20).is_err(),
        "sizes are checked"
    );
}

#[test]
fn pictures_hold_every_component_once() {
    for entry in &MAPS {
        let (name, map) = (&entry.name, &entry.map());
        for border in [0, 3] {
            let grid = Grid::new(*map, 4).expect("a size");
            let [width, height] = grid.picture_sides(border);
            let mut taken = vec![false; (width * height) as usize];
            for component in 0..map.components() {
                let ([left, top], [w, h]) = (grid.picture_origin(component, border), grid.sides(component));
                for y in top - border..top + h + border {
                    for x in left - border..left + w + border {
                        let taken = &mut taken[(y * width + x) as usize];
                        assert!(!*taken, "{name}: ({x}, {y}) twice");
                        *taken = true;
                    }
                }
            }
        }
    }
}

#[test]
fn the_perspective_map_with_its_image_on_the_faces_is_the_planar_one() {
    let mut compared = 0;
    for d in directions(10_000) {
        let (planar, perspective) = (octahedral::oct_from_direction(d), PLANAR.locate(d).uv);
        assert!(planar.distance(perspective) <= 1e-14, "{d}: {planar} and {perspective}");
        compared += 1;
    }
    assert!(compared > 10_000, "{compared} directions");
    let other = OctahedralPerspective::with_image_plane(DVec3::new(1.0, 2.0, 1.0));
    assert!(worst_round_trip(&other, 1000, |d| other.locate(d)) <= ROUND_TRIP, "another plane round-trips");
    let (planar, other) = (octahedral::oct_from_direction(DVec3::ONE), other.locate(DVec3::ONE).uv);
    assert!(planar.distance(other) > 0.1, "but must be another map");
}

/// Minimum and maximum solid angle of a texel over the mean, for an image plane of normal `m`.
///
/// With (a, b, c) the normal and q barycentric, direction is (q1/a, q2/b, q3/c) and the density is 1 / (abc
/// |(q1/a, q2/b, q3/c)|^3): at the vertices a^2/(bc), b^2/(ac) and c^2/(ab), greatest where q is as (a^2,
/// b^2, c^2): ((a^2 + b^2 + c^2)^3)^(1/2) / (abc). The mean is pi.
fn relative_solid_angles(m: DVec3) -> [f64; 2] {
    let product = m.x * m.y * m.z;
    let squared = m.length_squared();
    [m.min_element().powi(3) / product, squared * squared.sqrt() / product].map(|d| d / PI)
}

#[test]
fn no_other_image_plane_samples_the_octahedron_as_evenly() {
    let spread = |a: f64, b: f64, c: f64| {
        let map = OctahedralPerspective::with_image_plane(DVec3::new(a, b, c));
        let [least, greatest] = relative_solid_angles(DVec3::new(a, b, c));
        // The closed form against the density on a grid.
        let all = domain_points(&map, 101).into_iter().map(|p| map.density(p.component, p.uv) / PI);
        let (low, high) = all.fold((f64::MAX, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
        assert!(
            low >= least && high <= greatest,
            "({a}, {b}, {c}): {low} to {high} in {least} to {greatest}"
        );
        assert!(low <= least * 1.1 && high >= greatest * 0.98, "({a}, {b}, {c}): both extremes are reached");
        greatest / least
    };
    let planar = spread(1.0, 1.0, 1.0);
    assert!((planar - 27_f64.sqrt()).abs() < 1e-12, "5.196: {planar}");
    for (a, b, c) in [(1.0, 1.1, 1.0), (1.0, 0.9, 1.0), (1.0, 2.0, 1.0), (1.0, 0.5, 1.0), (1.0, 1.2, 0.8)] {
        assert!(spread(a, b, c) > planar * 1.05, "({a}, {b}, {c})");
    }
}

#[test]
fn the_octahedral_layouts_follow_their_equations() {
    let rectangular = named("octahedral-rectangular").expect("a map").map();
    for d in directions(10_000) {
        let p = d / (d.x.abs() + d.y.abs() + d.z.abs());
        let expected = if p.y >= 0.0 {
            DVec2::new(p.x - p.z - 1.0, p.x + p.z)
        } else {
            DVec2::new(p.z - p.x + 1.0, p.x + p.z)
        };
        assert!(rectangular.locate(d).uv.distance(expected) <= 1e-14, "{d}");
    }
}

#[test]
fn the_tennis_ball_follows_its_equations() {
    let map = named("tennis-ball").expect("a map").map();
    let mut panels = [0; 2];
    for d in directions(10_000) {
        let (a, b, c) = (d.x, d.y, d.z);
        let h = FRAC_1_SQRT_2;
        let first = (c >= 0.0 && b.abs() <= h) || (c <= 0.0 && a.abs() >= h);
        let Place { component, uv } = map.locate(d);
        // On the seam, rounding decides the component.
        let near = if c >= 0.0 { (b.abs() - h).abs() } else { (a.abs() - h).abs() };
        assert!(near < 1e-14 || c == 0.0 || component == u32::from(!first), "{d}: component {component}");
        panels[component as usize] += 1;
        let (phi, theta) = (uv.x, -uv.y);
        // Equation 3.
        let expected = if component == 0 { (b.asin(), a.atan2(c)) } else { (a.asin(), b.atan2(-c)) };
        assert!((theta - expected.0).abs() < 1e-8 && (phi - expected.1).abs() < 1e-12, "{d}: {uv}");
        // Equation 1.
        let s = if component == 0 {
            DVec3::new(phi.sin() * theta.cos(), theta.sin(), phi.cos() * theta.cos())
        } else {
            DVec3::new(theta.sin(), phi.sin() * theta.cos(), -phi.cos() * theta.cos())
        };
        assert!(s.distance(d) < 1e-12, "{d}: {s}");
        // Equation 2.
        assert!(theta.abs() <= PI / 4.0 + 1e-12 && phi.abs() <= 0.75 * PI + 1e-12, "{d}: {uv}");
    }
    assert!((f64::from(panels[0]) / f64::from(panels[1]) - 1.0).abs() < 0.06, "congruent: {panels:?}");
    // Each panel covers half the sphere.
    let half = map.solid_angle(0, map.component(0).low, map.component(0).high);
    assert!((half - TAU).abs() < 1e-13, "{half}");
}

#[test]
fn the_seam_separates_the_panels() {
    // Table 2.
    let h = FRAC_1_SQRT_2;
    for (t, expected) in
        [(0.0, DVec3::new(h, h, 0.0)), (0.125, DVec3::new(0.0, h, h)), (0.375, DVec3::new(-h, 0.0, -h))]
    {
        assert!(tennis_ball::seam_point(t).distance(expected) < 1e-15, "{t}: {}", tennis_ball::seam_point(t));
    }
    let points: Vec<DVec3> = (0..4000).map(|k| tennis_ball::seam_point(f64::from(k) / 4000.0)).collect();
    for (k, p) in points.iter().enumerate() {
        assert!((p.length() - 1.0).abs() < 1e-15, "on the sphere: {p}");
        assert!(p.distance(points[(k + 1) % points.len()]) < 0.01, "one curve: {p}");
        // Across the seam, along the half planes' normals, lies the other panel.
        let across = if p.z >= 0.0 { DVec3::Y * p.y.signum() } else { DVec3::X * p.x.signum() } * 1e-6;
        let sides = [(*p + across).normalize(), (*p - across).normalize()].map(tennis_ball::panel);
        assert!(p.z.abs() < 1e-5 || sides[0] != sides[1], "{p}: {sides:?}");
        // The point is also on the rim of both domains.
        for component in 0..2 {
            let (up, along, forward) = if component == 0 { (p.y, p.x, p.z) } else { (p.x, p.y, -p.z) };
            let (phi, theta) = (along.atan2(forward), up.asin());
            assert!((tennis_ball::seam(phi.abs()) - theta.abs()).abs() < 1e-6, "{p} on panel {component}");
        }
    }
}

#[test]
fn capped_maps_meet_at_their_latitude() {
    for map in [named("polar-capped").expect("a map").map(), &CONFORMAL, &PolarCapped::conformal(PI / 4.0)] {
        let edge = map.component(0).high.y;
        for k in 0..100 {
            let u = f64::from(k) / 100.0 * TAU - PI;
            for (v, component) in [(-edge, 1), (edge, 2)] {
                let d = map.direction(0, DVec2::new(u, v));
                let on_cap = d - DVec3::Y * d.y;
                // A point slightly towards the pole is on the cap's rim.
                let place = map.locate((d - on_cap * 1e-9).normalize());
                assert_eq!(place.component, component, "{d}");
                assert!((place.uv.length() - map.component(component).high.x).abs() < 1e-8, "{d}: {place:?}");
            }
        }
    }
}

#[test]
fn mirror_balls_and_paraboloids_follow_their_sources() {
    let (ball, dual) =
        (named("sphere-map").expect("a map").map(), named("dual-paraboloid").expect("a map").map());
    for r in directions(10_000) {
        let m = 2.0 * (r.x * r.x + r.y * r.y + (r.z + 1.0).powi(2)).sqrt();
        if m > 1e-3 {
            let (s, t) = (r.x / m + 0.5, r.y / m + 0.5);
            assert!(ball.locate(r).uv.distance(DVec2::new(2.0 * s - 1.0, 1.0 - 2.0 * t)) < 1e-12, "{r}");
        }
        let expected = DVec2::new(if r.z < 0.0 { -r.x } else { r.x }, -r.y) / (1.0 + r.z.abs());
        assert!(dual.locate(r).uv.distance(expected) < 1e-15, "{r}");
    }
}

#[test]
fn cube_components_are_the_faces() {
    let map = named("cube").expect("a map").map();
    for d in directions(10_000) {
        let (face, s, t) = cube::cube_from_direction(d);
        assert_eq!(map.locate(d), Place { component: face as u32, uv: DVec2::new(s, t) });
    }
}

#[test]
fn healpix_has_the_published_pixel_centres() {
    // Gorski et al. 2005, equations 4, 5 and 8, 9: ring i, pixel j of N = 4.
    let map = named("healpix").expect("a map").map();
    let grid = Grid::new(map, 4).expect("a size");
    let n = 4.0;
    let mut published = Vec::new();
    for ring in 1..16 {
        let i = f64::from(ring);
        let (count, z, shift) = if ring < 4 {
            (4 * ring, 1.0 - i * i / (3.0 * n * n), 0.5)
        } else if ring <= 12 {
            (16, 4.0 / 3.0 - 2.0 * i / (3.0 * n), if ring % 2 == 0 { 0.5 } else { 0.0 })
        } else {
            let i = 16.0 - i;
            (4 * (16 - ring), i * i / (3.0 * n * n) - 1.0, 0.5)
        };
        for j in 0..count {
            let phi = (f64::from(j) + shift) / f64::from(count) * TAU;
            let across = (1.0_f64 - z * z).sqrt();
            published.push(DVec3::new(across * phi.cos(), z, across * phi.sin()));
        }
    }
    assert_eq!(published.len(), 192, "12 N^2 pixels");
    for texel in grid.texels() {
        let centre = grid.direction_from_texel(texel);
        let nearest = published.iter().map(|p| p.distance(centre)).fold(f64::MAX, f64::min);
        assert!(nearest < 1e-14, "{texel:?} at {centre}: {nearest:e} from any");
    }
}

#[test]
fn rhombi_have_the_solid_s_vertices() {
    let map = named("rhombic-dodecahedron").expect("a map").map();
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let mut counts = std::collections::BTreeMap::new();
    for component in 0..12 {
        for corner in corners {
            let d = map.direction(component, corner);
            let key = d.to_array().map(|c| (c * 1000.0).round() as i64);
            *counts.entry(key).or_insert(0) += 1;
        }
        // The face's middle lies between its two axes.
        let middle = map.direction(component, DVec2::splat(0.5));
        let axes = middle.abs().to_array().map(|c| (c * 1000.0).round() as i64);
        assert_eq!(axes.iter().filter(|c| **c == 707).count(), 2, "component {component}: {middle}");
    }
    // Six vertices on the axes, where four faces meet, and eight on the cube's corners, where three meet.
    assert_eq!(counts.len(), 14, "{counts:?}");
    assert_eq!(counts.values().filter(|count| **count == 4).count(), 6, "{counts:?}");
    assert_eq!(counts.values().filter(|count| **count == 3).count(), 8, "{counts:?}");
}

#[test]
fn equal_area_maps_have_constant_density() {
    for name in ["low-distortion", "healpix", "sphere-map"] {
        let map = named(name).expect("a map").map();
        let densities: Vec<f64> =
            domain_points(map, 31).into_iter().map(|p| map.density(p.component, p.uv)).collect();
        assert!(densities.iter().all(|d| *d == densities[0]), "{name}");
    }
}
