//! Tables of several maps: exact sums, constants, convergence to exhaustive integration.

use glam::{DMat3, DVec2, DVec3};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::cpu::box_filter::{StackedBox, single_box};
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::kernel_integral;
use octagloss_core::sphere::cube::{Face, cube_from_direction, cube_point};
use octagloss_core::sphere::grid::Grid;
use octagloss_fixtures::common::{Random, landmarks, texel_from_direction};
use octagloss_workbench::laboratory::adaptive::Adaptive;
use octagloss_workbench::laboratory::boxes::{radiance, stack};
use octagloss_workbench::laboratory::cells::Cells;
use octagloss_workbench::laboratory::charts::{CHARTS, Charts, Piece};
use octagloss_workbench::laboratory::light::{Light, lamps};
use octagloss_workbench::laboratory::measure::{
    Method, Region, Row, Settings, default_environment, measure, seam_sites,
};
use octagloss_workbench::laboratory::subject::{Carrier, Choice, SUBJECTS};
use octagloss_workbench::laboratory::tables::{Tables, Texels};
use std::sync::Mutex;

/// A grid of `charts` whose texels, border included, are random.
fn random_texels(charts: &dyn Charts, size: u32, random: &mut Random) -> Texels {
    let grid = Grid::new(charts.named().map(), size).expect("a size");
    let border = charts.border(size, 1.0);
    let components = (0..grid.map().components())
        .map(|component| {
            let [columns, rows] = grid.sides(component).map(|side| side + 2 * border);
            let mut unit = || random.unit() as f32;
            (0..columns * rows).map(|_| [unit(), 1e4 * unit(), 1e-3 * unit(), 0.5 + unit()]).collect()
        })
        .collect();
    Texels { grid, border, components }
}

/// The texel in column `x`, row `y` of `component`, also outside its image, by the map's own continuation;
/// `None` where there is no such texel.
fn texel(charts: &dyn Charts, texels: &Texels, component: u32, x: i64, y: i64) -> Option<[f32; 4]> {
    let Texels { grid, border, components } = texels;
    let at = |component: u32, x: i64, y: i64| {
        let columns = i64::from(grid.sides(component)[0] + 2 * border);
        components[component as usize][((y + i64::from(*border)) * columns + x + i64::from(*border)) as usize]
    };
    match charts.name() {
        "tennis-ball" => Some(at(component, x, y)),
        "cube" => {
            let n = i64::from(grid.size());
            let out_of = |k: i64| if k < 0 { -1 } else { i64::from(k >= n) };
            let (i, j) = (out_of(x), out_of(y));
            let reach = x.max(-1 - x).max(y).max(-1 - y);
            if (i != 0 && j != 0) || reach >= 2 * n {
                return None;
            }
            // Turn the part of the plane beyond the edge by 90 degrees about it.
            let face = Face::ALL[component as usize];
            let st = (DVec2::new(x as f64, y as f64) + 0.5) * (2.0 / n as f64) - 1.0;
            let on_edge = st.clamp(DVec2::NEG_ONE, DVec2::ONE);
            let beyond = (st - on_edge).length();
            let point = cube_point(face, on_edge.x, on_edge.y) - cube_point(face, 0.0, 0.0) * beyond;
            let (face, s, t) = cube_from_direction(point);
            let index = |t: f64| ((t + 1.0) / 2.0 * n as f64) as i64;
            Some(at(face as u32, index(s), index(t)))
        }
        _ => {
            let place = grid.map().wrap_texel(grid.size(), component, x, y).expect("texels onto texels");
            Some(at(place.component, i64::from(place.x), i64::from(place.y)))
        }
    }
}

/// Sums of the quantised texels of a box, one by one.
fn direct_sum(
    charts: &dyn Charts,
    texels: &Texels,
    exponents: [i32; 4],
    component: u32,
    low: [i64; 2],
    high: [i64; 2],
) -> [u64; 4] {
    let mut sum = [0_u64; 4];
    for y in low[1]..high[1] {
        for x in low[0]..high[0] {
            let Some(texel) = texel(charts, texels, component, x, y) else { continue };
            for c in 0..4 {
                // Exact: 24 bits times a power of two.
                let integer = (f64::from(texel[c]) * f64::from(exponents[c]).exp2()).floor() as u64;
                sum[c] = sum[c].wrapping_add(integer);
            }
        }
    }
    sum
}

/// Sums of the same box over its parts.
fn sum_of_parts(tables: &Tables, component: u32, low: [i64; 2], high: [i64; 2]) -> [u64; 4] {
    let corner = |corner: [i64; 2]| DVec2::new(corner[0] as f64, corner[1] as f64);
    let mut sum = [0_u64; 4];
    let piece = Piece { component, low: corner(low), high: corner(high) };
    tables.charts.split(&tables.grid, piece, &mut |part: Piece| {
        let integers = |corner: DVec2| {
            assert_eq!(corner, corner.round(), "whole texels stay whole");
            [corner.x as i64, corner.y as i64]
        };
        let own = tables.sum(part.component, integers(part.low), integers(part.high));
        for c in 0..4 {
            sum[c] = sum[c].wrapping_add(own[c]);
        }
    });
    sum
}

#[test]
fn boxes_sum_their_texels_exactly_on_every_map() {
    let mut random = Random::new(11);
    for charts in CHARTS {
        for size in [1, 4, 7] {
            let texels = random_texels(charts, size, &mut random);
            let tables = Tables::new(charts, &texels);
            let exponents = tables.fixed.exponents;
            let components = texels.grid.map().components();
            let mut beyond = 0;
            for _ in 0..400 {
                let component = random.below(components);
                let sides = texels.grid.sides(component).map(i64::from);
                let border = i64::from(texels.border);
                let corners: [[i64; 2]; 2] = std::array::from_fn(|axis| {
                    // Panels end at their border; other boxes leave the chart by up to a side.
                    let reach = if border > 0 { border } else { sides[axis] };
                    let most =
                        if charts.name() == "equirect" { sides[axis] } else { sides[axis] + 2 * reach };
                    let a = i64::from(random.below((sides[axis] + 2 * reach + 1) as u32)) - reach;
                    let b = i64::from(random.below((sides[axis] + 2 * reach + 1) as u32)) - reach;
                    [a.min(b), a.max(b).min(a.min(b) + most)]
                });
                let (low, high) = ([corners[0][0], corners[1][0]], [corners[0][1], corners[1][1]]);
                beyond += usize::from((0..2).any(|k| low[k] < 0 || high[k] > sides[k]));
                let expected = direct_sum(charts, &texels, exponents, component, low, high);
                let found = sum_of_parts(&tables, component, low, high);
                assert_eq!(found, expected, "{} of {size}: {component} {low:?} {high:?}", charts.name());
            }
            assert!(beyond > 100, "{}: {beyond} boxes leave their chart", charts.name());

            // One texel brighter by one unit in the last place is noticed.
            let mut other = texels.clone();
            let first = &mut other.components[0][0][1];
            *first = f32::from_bits(first.to_bits() + 1);
            let sides = texels.grid.sides(0).map(i64::from);
            let low = [-i64::from(texels.border); 2];
            let wrong = direct_sum(charts, &other, exponents, 0, low, sides);
            assert_ne!(sum_of_parts(&tables, 0, low, sides), wrong, "{}", charts.name());
        }
    }
}

#[test]
fn maps_without_borders_hold_the_sphere_once() {
    let environment = lamps(12).expect("texels");
    let light = Light::new(&environment, DMat3::from_rotation_x(0.4)).expect("2:1");
    for charts in CHARTS {
        let grid = Grid::new(charts.named().map(), 12).expect("a size");
        let tables = Tables::new(charts, &Texels::new(charts, grid, 0, &light));
        let mut all = 0.0;
        for component in 0..grid.map().components() {
            let sum = tables.sum(component, [0, 0], grid.sides(component).map(i64::from));
            all += tables.fixed.values(sum)[3];
        }
        // Solid angles are rounded to float32 once.
        assert!((all / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-7, "{}: {all}", charts.name());
        let mut energy = 0.0;
        environment.for_each_texel(|_, solid_angle, rgb| energy += solid_angle * f64::from(rgb[0]));
        let mean = energy / (4.0 * std::f64::consts::PI);
        assert!((tables.mean_luminance() / mean - 1.0).abs() < 1e-6, "{}", charts.name());
    }
}

/// Landmarks, seams and random directions.
fn directions(charts: &dyn Charts, random: &mut Random) -> Vec<DVec3> {
    let seams = seam_sites(charts, 16).into_iter().map(|site| site.0);
    landmarks().into_iter().chain(seams).chain((0..40).map(|_| random.direction())).collect()
}

#[test]
fn a_constant_stays_constant_for_every_map_filter_and_direction() {
    let radiance = [0.7_f32, 3.0, 1e-3];
    let constant =
        Environment::new(Layout::Panorama { width: 32, height: 16 }, vec![radiance; 512]).expect("sound");
    let mut speckled = vec![radiance; 512];
    speckled[200][0] *= 1.01;
    let speckled = Environment::new(Layout::Panorama { width: 32, height: 16 }, speckled).expect("sound");
    // Resampling rounds a texel's radiance by 4 units of 2^-24, its energy and solid angle are rounded once
    // each; a box's quotient is a mean of such quotients. Adaptive answers are c + sum of k (E - c w) / W: c
    // and E/w are both that inexact, and the sum of k w over W is at most 1.2 with leaves this coarse.
    // Quantisation is below 2^-40.
    let unit = 1.0 / f64::from(1 << 24);
    let (of_boxes, of_cells) = (7.0 * unit, 7.0 * unit + 1.2 * 14.0 * unit);
    let mut random = Random::new(5);
    for subject in SUBJECTS {
        let off = |environment: &Environment, random: &mut Random| {
            let light = Light::new(environment, DMat3::from_rotation_z(0.3)).expect("2:1");
            let carrier = Carrier::new(subject, 1600, 7.0, &light).expect("texels");
            let mut off = [0.0_f64; 2];
            for direction in directions(subject.charts, random) {
                for roughness in [0.1_f64, 0.4, 1.0] {
                    let alpha = roughness * roughness;
                    let answers = [
                        (0, carrier.boxes(&[single_box(Lobe::Ggx, alpha)], direction)),
                        (0, carrier.boxes(&stack(Lobe::Ggx, alpha, 8), direction)),
                        (1, carrier.adaptive(Lobe::Ggx, alpha, 0.01, direction)),
                    ];
                    for (kind, answer) in answers {
                        for (found, expected) in answer.radiance.iter().zip(radiance) {
                            let error = (found / f64::from(expected) - 1.0).abs();
                            assert!(error.is_finite(), "{}: {found}", subject.name);
                            off[kind] = off[kind].max(error);
                        }
                    }
                }
            }
            off
        };
        let [boxes, cells] = off(&constant, &mut random);
        assert!(boxes <= of_boxes, "{}: {boxes:e} off by boxes", subject.name);
        assert!(cells <= of_cells, "{}: {cells:e} off adaptively", subject.name);
        let [boxes, cells] = off(&speckled, &mut random);
        assert!(boxes > of_boxes && cells > of_cells, "{}: 1 % more in a texel goes unnoticed", subject.name);
    }
}

#[test]
fn stacks_step_down_with_the_lobe_and_hold_its_energy() {
    for roughness in [0.2_f64, 0.5, 1.0] {
        let alpha = roughness * roughness;
        let boxes = stack(Lobe::Ggx, alpha, 8);
        assert_eq!(boxes.len(), 8);
        assert!(boxes.windows(2).all(|pair| pair[0].solid_angle < pair[1].solid_angle));
        assert!(boxes.iter().all(|one| one.weight > 0.0));
        let energy: f64 = boxes.iter().map(|one| one.weight * one.solid_angle).sum();
        let expected = kernel_integral(Lobe::Ggx, alpha);
        // Midpoints of 4096 steps in the logarithm.
        assert!((energy / expected - 1.0).abs() < 1e-4, "{roughness}: {energy} against {expected}");
        // The hemisphere: GGX ends at the horizon.
        assert!((boxes[7].solid_angle / std::f64::consts::TAU - 1.0).abs() < 1e-6);
    }
}

/// Root mean square error of adaptive answers against the oracle, relative to their mean.
fn adaptive_error(
    charts: &'static dyn Charts,
    environment: &Environment,
    turns: [DMat3; 2],
    size: u32,
    error: f64,
) -> f64 {
    let [filled, asked] = turns;
    let light = Light::new(environment, filled).expect("2:1");
    let grid = Grid::new(charts.named().map(), size).expect("a size");
    let tables = Tables::new(charts, &Texels::new(charts, grid, 0, &light));
    let cells = Cells::new(grid);
    let (roughness, alpha) = (0.5, 0.25);
    let adaptive = Adaptive::new(&tables, &cells, Lobe::Ggx, alpha, error);
    let oracle = Oracle::new(environment);
    let mut random = Random::new(3);
    let (mut squares, mut sum) = (0.0, 0.0);
    let all = directions(charts, &mut random);
    for direction in &all {
        let truth = oracle.reflect(Lobe::Ggx, roughness, asked.transpose() * *direction).expect("valid")[0];
        squares += (adaptive.radiance(*direction).0.radiance[0] - truth).powi(2);
        sum += truth;
    }
    (squares * all.len() as f64).sqrt() / sum
}

#[test]
fn adaptive_queries_converge_to_the_oracle_on_every_map() {
    let environment = lamps(12).expect("texels");
    let turn = DMat3::from_rotation_x(0.5) * DMat3::from_rotation_y(0.8);
    for charts in CHARTS {
        let components = charts.named().map().components();
        let size = |texels: f64| (texels / f64::from(components.min(6))).sqrt() as u32;
        let [coarse, fine] = [(256.0, 0.2), (16384.0, 1e-4)]
            .map(|(texels, error)| adaptive_error(charts, &environment, [turn; 2], size(texels), error));
        assert!(fine < 1e-3 && coarse > 10.0 * fine, "{}: {coarse:e} to {fine:e}", charts.name());
        // Tables in another orientation are noticed.
        let turned = [DMat3::from_rotation_y(0.2) * turn, turn];
        let wrong = adaptive_error(charts, &environment, turned, size(16384.0), 1e-4);
        assert!(wrong > 10.0 * fine, "{}: {wrong:e} in a wrong orientation", charts.name());
    }
}

#[test]
fn adaptive_bounds_hold_and_shrink() {
    let environment = lamps(24).expect("texels");
    let light = Light::new(&environment, DMat3::from_rotation_x(1.1)).expect("2:1");
    for charts in CHARTS {
        let grid = Grid::new(charts.named().map(), 16).expect("a size");
        let tables = Tables::new(charts, &Texels::new(charts, grid, 0, &light));
        let cells = Cells::new(grid);
        let alpha = 0.3;
        let lobe = |error: f64| Adaptive::new(&tables, &cells, Lobe::Ggx, alpha, error);
        let (exact, rough) = (lobe(1e-6), lobe(0.05));
        let (mut used, mut reads) = (0.0_f64, [0; 2]);
        for direction in directions(charts, &mut Random::new(8)) {
            let (fine, left) = exact.radiance(direction);
            let (coarse, bound) = rough.radiance(direction);
            let off = (coarse.radiance[0] - fine.radiance[0]).abs();
            assert!(off <= bound + left, "{} {direction}: {off:e} beyond {bound:e}", charts.name());
            assert!(left <= bound, "{}: the bound grows with more cells", charts.name());
            used = used.max(off / bound);
            reads = [reads[0] + fine.reads, reads[1] + coarse.reads];
        }
        assert!(used > 1.0 / 500.0, "{}: the bound is {} times the error", charts.name(), 1.0 / used);
        assert!(reads[0] > reads[1], "{}: {reads:?}", charts.name());
    }
}

#[test]
fn roughness_0_boxes_are_one_texel() {
    // A box of one texel around a texel's centre returns that texel.
    let environment = lamps(12).expect("texels");
    let light = Light::new(&environment, DMat3::IDENTITY).expect("2:1");
    let point = [StackedBox { solid_angle: 0.0, weight: 1.0 }];
    for charts in CHARTS {
        let grid = Grid::new(charts.named().map(), 12).expect("a size");
        let texels = Texels::new(charts, grid, charts.border(12, 0.1), &light);
        let tables = Tables::new(charts, &texels);
        let mut compared = 0;
        for place in grid.texels() {
            let direction = grid.direction_from_texel(place);
            if texel_from_direction(&grid, direction) != place {
                continue;
            }
            let [columns, _] = grid.sides(place.component).map(|side| (side + 2 * texels.border) as usize);
            let row = (place.y + texels.border) as usize;
            let [r, _, _, w] = texels.components[place.component as usize]
                [row * columns + (place.x + texels.border) as usize];
            let found = radiance(&tables, &point, direction).radiance[0];
            let expected = f64::from(r) / f64::from(w);
            // Coordinates round by 1e-14 of a texel, across which radiance changes by up to a thousandfold.
            assert!((found / expected - 1.0).abs() < 1e-9, "{} {place:?}: {found} {expected}", charts.name());
            compared += 1;
        }
        assert!(compared > 100, "{}: {compared} texels", charts.name());
    }
}

/// A comparison small enough for tests.
pub(crate) fn small() -> Settings {
    Settings { size: 24, turns: 1, directions: 60, roughnesses: vec![0.4, 1.0], ..Settings::default() }
}

#[test]
fn every_map_is_measured_with_every_filter() {
    let environment = default_environment().expect("an environment");
    let rows = measure(&small(), &environment, &|_, _| {}).expect("rows");
    // Adaptive queries read no border, so that the row for it has none.
    assert_eq!(rows.len(), SUBJECTS.len() * Method::ALL.len() - 1);
    for row in &rows {
        let name = format!("{} {:?}", row.subject.name, row.method);
        let inner = 32 * row.texels;
        if row.subject.with_border {
            assert!((400 * 32..=576 * 32).contains(&row.bytes), "{name}: {} bytes", row.bytes);
        } else {
            assert!((500..=660).contains(&row.texels), "{name}: {} texels", row.texels);
        }
        if row.subject.charts.name() == "tennis-ball" && row.method != Method::Adaptive {
            assert!(row.bytes > 2 * inner, "{name}: the border counts");
        } else {
            assert_eq!(row.bytes, inner, "{name}");
        }
        assert_eq!(row.errors.len(), 2);
        for error in &row.errors {
            let greatest = error.rms.iter().copied().fold(0.0, f64::max);
            assert!(greatest > 0.0 && greatest <= error.worst && error.worst < 2.0, "{name}: {error:?}");
            assert!(error.rms.iter().all(|rms| *rms > 0.0), "{name}: a region without directions");
            let least = match row.method {
                Method::Box => 16.0,
                Method::Stack => 128.0,
                Method::Adaptive => 4.0,
            } * if row.subject.choice == Choice::Blend { 2.0 } else { 1.0 };
            assert!(error.reads[0] >= least && error.reads[1] >= error.reads[0], "{name}: {error:?}");
        }
    }
    // Filters from coarse to fine are ever more accurate.
    for subject in SUBJECTS {
        let own = rows.iter().filter(|row| row.subject.name == subject.name);
        let errors: Vec<f64> = own.map(|row| row.errors[1].rms[Region::Sphere as usize]).collect();
        assert!(errors.windows(2).all(|pair| pair[0] > pair[1]), "{}: {errors:?}", subject.name);
    }
}

/// The figures of one filter show the numbers of the table of all.
#[test]
fn filters_are_measured_alike_alone_and_together() {
    let environment = default_environment().expect("an environment");
    let of = |methods: &[Method]| {
        let settings = Settings { methods: methods.to_vec(), directions: 20, ..small() };
        measure(&settings, &environment, &|_, _| {}).expect("rows")
    };
    let together = of(&Method::ALL);
    for method in Method::ALL {
        let alone = of(&[method]);
        let same: Vec<&Row> = together.iter().filter(|row| row.method == method).collect();
        assert_eq!(alone.len(), same.len());
        for (alone, row) in alone.iter().zip(same) {
            assert_eq!((alone.texels, alone.bytes), (row.texels, row.bytes), "{}", row.subject.name);
            assert_eq!(alone.errors, row.errors, "{} {method:?}", row.subject.name);
        }
    }
}

#[test]
fn fields_average_to_the_measured_errors() {
    let settings = Settings { roughnesses: vec![0.5], methods: vec![Method::Stack], ..small() };
    let environment = default_environment().expect("an environment");
    let rows = measure(&settings, &environment, &|_, _| {}).expect("rows");
    for row in &rows {
        let field = &row.errors[0].field;
        assert_eq!(field.len(), settings.directions);
        let squares: f64 = field.iter().map(|error| error * error).sum();
        let rms = (squares / field.len() as f64).sqrt();
        let expected = row.errors[0].rms[Region::Sphere as usize];
        assert!((rms / expected - 1.0).abs() < 1e-9, "{}: {rms} against {expected}", row.subject.name);
    }
}

#[test]
fn settings_that_cannot_be_measured_are_named() {
    let environment = default_environment().expect("an environment");
    let refused = |settings: Settings, words: &str| {
        let error = measure(&settings, &environment, &|_, _| {}).expect_err(words).to_string();
        assert!(error.contains(words), "{error} lacks {words:?}");
    };
    refused(Settings { size: 0, ..small() }, "`size` 0 must be 8 to 1024 texels");
    refused(Settings { size: 4096, ..small() }, "`size` 4096");
    refused(Settings { roughnesses: vec![0.5, 0.0], ..small() }, "`roughness` 0 must be 0.1 to 1");
    refused(Settings { roughnesses: vec![], ..small() }, "no `roughnesses`");
    refused(Settings { methods: vec![], ..small() }, "no `methods`");
    refused(Settings { turns: 0, ..small() }, "no `turns`");
    refused(Settings { error: f64::NAN, ..small() }, "`error` NaN");
    // Its border would take more texels than there are; the least size that leaves some is named.
    let without = Settings { size: 8, ..small() };
    refused(without.clone(), "`size` 8 leaves no texel to Tennis-ball with border (map tennis-ball)");
    let error = without.check().expect_err("too small").to_string();
    let least = error.split("choose ").nth(1).and_then(|rest| rest.split(' ').next()?.parse().ok());
    let least: u32 = least.unwrap_or_else(|| panic!("{error} names no size"));
    Settings { size: least, ..small() }.check().expect("the least size");
    Settings { size: least - 1, ..small() }.check().expect_err("less");
    let odd = Environment::new(Layout::Panorama { width: 1, height: 1 }, vec![[1.0; 3]]).expect("sound");
    let error = measure(&small(), &odd, &|_, _| {}).expect_err("not 2:1").to_string();
    assert!(error.contains("a panorama of 1x1"), "{error}");
}

/// Errors are relative to the mean luminance, which must not be 0.
#[test]
fn light_that_has_no_mean_is_named() {
    let of = |texels: Vec<[f32; 3]>| Environment::new(Layout::Cube { size: 2 }, texels).expect("sound");
    let black = of(vec![[0.0; 3]; 24]);
    let error = measure(&small(), &black, &|_, _| {}).expect_err("black").to_string();
    assert!(error.contains("the environment is black"), "{error}");
    // The least light that float32 holds, on one face.
    let mut faint = vec![[0.0; 3]; 24];
    faint[0] = [f32::from_bits(1); 3];
    let measured = measure(&small(), &of(faint), &|_, _| {});
    let sound = |rows: Vec<Row>| {
        rows.iter().flat_map(|row| &row.errors).all(|error| error.rms.iter().all(|rms| rms.is_finite()))
    };
    assert!(measured.map_or_else(|error| error.to_string().contains("the environment is black"), sound));
}

#[test]
fn progress_counts_every_integration_once() {
    let seen = Mutex::new(Vec::new());
    let settings = Settings { turns: 2, directions: 20, ..small() };
    let environment = default_environment().expect("an environment");
    measure(&settings, &environment, &|done, total| seen.lock().expect("no panic").push((done, total)))
        .expect("rows");
    let mut seen = seen.into_inner().expect("no panic");
    seen.sort_unstable();
    let total = seen.len() as u64;
    assert!(total > 2 * 20 * 2, "{total} integrations");
    assert_eq!(seen, (1..=total).map(|done| (done, total)).collect::<Vec<_>>());
}

#[test]
fn seams_are_found_all_over_the_map() {
    for charts in CHARTS {
        let sites = seam_sites(charts, 64);
        assert_eq!(sites.len(), 64, "{}", charts.name());
        let map = charts.named().map();
        for (site, region) in sites {
            assert_eq!(region, Region::Seams);
            // Around a point of a seam lie places that are far apart.
            let (a, b) = site.any_orthonormal_pair();
            let places: Vec<_> = (0..16)
                .map(|k| {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 16.0).sin_cos();
                    map.locate((site + (a * cos + b * sin) * 1e-4).normalize())
                })
                .collect();
            let apart = places.iter().any(|place| {
                place.component != places[0].component || (place.uv - places[0].uv).length() > 1e-2
            });
            assert!(apart, "{}: {site} is on no seam", charts.name());
        }
    }
}
