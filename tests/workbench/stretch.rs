//! Stretch metrics of the maps: numeric values against closed forms, and the table against the paper's
//! printed values.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::polar_capped::PolarCapped;
use octagloss_core::sphere::registry::MAPS;
use octagloss_workbench::map_table::{Row, rows};
use octagloss_workbench::stretch::{Metrics, Stretch, measure};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, SQRT_2};
use std::sync::LazyLock;

/// The table, computed once for all tests.
static ROWS: LazyLock<Vec<Row>> = LazyLock::new(rows);

/// Returns the metrics of the map `name`.
fn measured(name: &str) -> Metrics {
    ROWS.iter().find(|row| row.name == Some(name)).expect("a map").metrics
}

/// Bound of numeric metrics. Extremes are extrapolated over cells of 1/96: the second-order rest is below
/// (1e-3/96)^2 times curvatures of at most 1000, and differences round by 2^-53 / 4e-9.
const CLOSED: f64 = 1e-6;

/// Returns the greatest anisotropy a of a map whose Jacobian has the squared Frobenius norm f and the
/// determinant d: a + 1/a is f/d.
fn anisotropy_of(ratio: f64) -> f64 {
    (ratio + (ratio * ratio - 4.0).sqrt()) / 2.0
}

/// Returns closed forms: sampling requirement, anisotropy, lattice requirement.
fn closed_form(name: &str) -> [f64; 3] {
    // Concentric squares, at a wedge's edge: [[g, 0], [-pi/4, pi/4]] with g = 1 at the pole and 2 at the
    // equator, the lower row divided by g.
    let quarter = FRAC_PI_4 * FRAC_PI_4;
    let pole = anisotropy_of((1.0 + 2.0 * quarter) / FRAC_PI_4);
    let equator = anisotropy_of((2.0 + quarter) / FRAC_PI_4);
    let golden = (3.0 + 5.0_f64.sqrt()) / 2.0;
    let conformal_latitude = (42.2_f64).to_radians();
    let capped = 4.0 * PI * (FRAC_PI_4 + conformal_latitude / 2.0).tan().ln()
        + 32.0 * ((FRAC_PI_2 - conformal_latitude) / 2.0).tan().powi(2);
    match name {
        "tennis-ball" | "polar-capped" => [1.5 * PI * PI, SQRT_2, 1.5 * PI * PI],
        "polar-capped-conformal" => [capped, 1.0, capped],
        "dual-equidistant" => [2.0 * PI * PI, FRAC_PI_2, 2.0 * PI * PI],
        "low-distortion" => [4.0 * PI * equator, equator, 2.0 * PI * PI],
        "equirect" => [2.0 * PI * PI, f64::INFINITY, 2.0 * PI * PI],
        "cube" => [24.0, 3_f64.sqrt(), 24.0],
        "dual-paraboloid" => [32.0, 1.0, 32.0],
        "sphere-map" => [f64::INFINITY; 3],
        "octahedral" | "octahedral-perspective" => [36.0, golden, 18.0],
        "octahedral-rectangular" => [36.0, golden, 36.0],
        // Eight squares reach a pole; the others stretch most at |sin(latitude)| = 2/3: twice (2/3)^2 over
        // 5/9.
        "healpix" => [8.0 * PI / 3.0 * pole + 4.0 * 1.6, pole, 8.0 * PI / 3.0 * FRAC_PI_2 + 4.0 * PI / 3.0],
        "rhombic-dodecahedron" => [24.0, 3_f64.sqrt(), 16.0],
        other => panic!("no closed form for {other}"),
    }
}

/// Error at the poles of the equal-area squares, where stretch depends on the direction of approach and is
/// greatest along an axis. The points nearest to one are 1/500 of their distance to the pole off, at an
/// angle of at most pi/2 times that, which costs less than three times its square.
const CONE: f64 = 7.4 / (500.0 * 500.0);

fn agrees(measured: f64, exact: f64, bound: f64) -> bool {
    measured == exact || (measured / exact - 1.0).abs() <= bound
}

#[test]
fn numeric_metrics_are_the_closed_forms() {
    for map in &MAPS {
        let metrics = measured(map.name);
        let [sampling, anisotropy, lattice] = closed_form(map.name);
        let name = map.name;
        let bound = if ["low-distortion", "healpix"].contains(&name) { CONE } else { CLOSED };
        assert!(agrees(metrics.sampling, sampling, bound), "{name}: Y {} for {sampling}", metrics.sampling);
        assert!(
            agrees(metrics.anisotropy, anisotropy, bound),
            "{name}: {} for {anisotropy}",
            metrics.anisotropy
        );
        assert!(agrees(metrics.lattice, lattice, bound), "{name}: M {} for {lattice}", metrics.lattice);
        assert!(metrics.lattice <= metrics.sampling * (1.0 + CLOSED), "{name}: M is at most Y");
        // No map samples the sphere with fewer than its area, nor M with fewer than a hexagonal lattice.
        assert!(metrics.sampling >= 4.0 * PI - 1e-5, "{name}");
        assert!(metrics.lattice >= 4.0 * PI * 0.75_f64.sqrt() - 1e-5, "{name}");
    }
    assert!(!agrees(36.0 * (1.0 + 2.0 * CLOSED), 36.0, CLOSED), "an error must be detected");
}

#[test]
fn relative_solid_angles_are_the_closed_forms() {
    let sphere = 4.0 * PI;
    // Densities at the extreme points times the area of all rectangles, over 4 pi.
    let expected = [
        ("octahedral", [4.0 / sphere, 4.0 * 27_f64.sqrt() / sphere]),
        ("octahedral-rectangular", [4.0 / sphere, 4.0 * 27_f64.sqrt() / sphere]),
        ("cube", [24.0 / sphere / 27_f64.sqrt(), 24.0 / sphere]),
        ("tennis-ball", [0.75 * PI * PI * 2.0 * (0.5_f64).sqrt() / sphere, 0.75 * PI * PI * 2.0 / sphere]),
        ("dual-paraboloid", [8.0 / sphere, 32.0 / sphere]),
        ("dual-equidistant", [8.0 * FRAC_PI_2 / sphere, 8.0 * FRAC_PI_2 * FRAC_PI_2 / sphere]),
        ("low-distortion", [1.0; 2]),
        ("healpix", [1.0; 2]),
        ("equirect", [0.0, FRAC_PI_2]),
    ];
    for (name, [least, greatest]) in expected {
        let measured = measured(name).relative_solid_angle;
        assert!(
            (measured[0] - least).abs() <= 1e-5 && (measured[1] / greatest - 1.0).abs() <= 1e-5,
            "{name}: {measured:?}"
        );
    }
}

#[test]
fn domains_have_the_areas_of_their_figures() {
    // On 1024^2 points a rim is off by less than one point per row, either way.
    for (name, share) in
        [("dual-paraboloid", FRAC_PI_4), ("sphere-map", FRAC_PI_4), ("cube", 1.0), ("octahedral", 1.0)]
    {
        let used = measured(name).used;
        assert!((used - share).abs() < 1e-3, "{name}: {used}");
    }
}

#[test]
fn singular_values_of_a_known_jacobian_match() {
    let turned =
        |angle: f64| (DVec3::new(angle.cos(), angle.sin(), 0.0), DVec3::new(-angle.sin(), angle.cos(), 0.0));
    for angle in [0.0, 0.4, FRAC_PI_4, 2.0] {
        let (x, y) = turned(angle);
        // Stretched by 3 and 1/2 along axes turned by `angle`.
        let along = |way: DVec3| x * way.dot(x) * 3.0 + y * way.dot(y) * 0.5;
        let stretch = Stretch::from_derivatives(along(DVec3::X), along(DVec3::Y));
        assert!((stretch.greatest - 3.0).abs() < 1e-14 && (stretch.least - 0.5).abs() < 1e-14, "{stretch:?}");
        assert!(
            (stretch.anisotropy() - 6.0).abs() < 1e-13 && (stretch.area() - 1.5).abs() < 1e-14,
            "{stretch:?}"
        );
    }
    // Ten to one along a diagonal: dual vectors (1, 0), (0, 1) and their sum, by hand.
    let (x, y) = turned(FRAC_PI_4);
    let along = |way: DVec3| x * way.dot(x) * 10.0 + y * way.dot(y);
    let stretch = Stretch::from_derivatives(along(DVec3::X), along(DVec3::Y));
    let dual = |i: f64, j: f64| {
        let way = DVec3::new(i, j, 0.0);
        DVec2::new(way.dot(x) / 10.0, way.dot(y)).length()
    };
    let mut shortest = f64::MAX;
    for i in -20..=20 {
        for j in -20..=20 {
            if (i, j) != (0, 0) {
                shortest = shortest.min(dual(f64::from(i), f64::from(j)));
            }
        }
    }
    assert!((stretch.spacing * shortest - 1.0).abs() < 1e-12, "{} and {shortest}", stretch.spacing);
}

/// Returns whether `value` rounds to `printed`, at its number of digits.
fn prints_as(value: f64, printed: &str) -> bool {
    let digits = printed.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    format!("{value:.digits$}") == printed
}

#[test]
fn the_table_matches_the_printed_digits_or_has_a_note() {
    let mut met = 0;
    for Row { title, printed, metrics, note, .. } in ROWS.iter() {
        let Some(printed) = printed else { continue };
        let components = metrics.components.map_or_else(|| "inf".to_owned(), |count| count.to_string());
        assert_eq!(components, printed.components, "{title}");
        if prints_as(metrics.sampling, printed.sampling) && prints_as(metrics.anisotropy, printed.anisotropy)
        {
            met += 1;
        } else {
            assert!(note.is_some(), "{title}: {metrics:?} needs a note");
            // Both rows that are not Y are M.
            assert!(prints_as(metrics.lattice, printed.sampling), "{title}: {metrics:?}");
        }
    }
    assert_eq!(met, 9, "nine of the paper's eleven rows as printed");
    assert_eq!(ROWS.len(), MAPS.len() + 2, "every map and two limits");
    assert!(!prints_as(36.06, "36.0") && prints_as(f64::INFINITY, "inf"), "a wrong digit must be detected");
    let planar = measured("octahedral");
    assert!(prints_as(planar.sampling, "36.0") && prints_as(planar.anisotropy, "2.62"));
}

#[test]
fn the_printed_conformal_row_needs_another_latitude() {
    // 4 pi ln tan(pi/4 + l/2) + 32 tan^2((pi/2 - l)/2).
    let at = |degrees: f64| measure(&PolarCapped::conformal(degrees.to_radians())).sampling;
    assert!(prints_as(at(42.2), "16.5") && prints_as(at(45.0), "16.6"), "{} and {}", at(42.2), at(45.0));
}
