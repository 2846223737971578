//! The exact summed-area table: scans by equality, boxes by direct sums.

use glam::DVec2;
use octagloss_core::analysis::sat_f32::sat_f32;
use octagloss_core::bake::BakeSettings;
use octagloss_core::bake::{bake_all, unwatched};
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::cpu::sat_scan::scan;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{FixedPoint, Sat, Scan};
use octagloss_core::lobe::filter::Filter;
use octagloss_core::sphere::octahedral;
use octagloss_fixtures::common::Random;

const SCANS: [Scan; 7] = [
    Scan::Serial,
    Scan::Blocks,
    Scan::Hensley { radix: 2 },
    Scan::Hensley { radix: 3 },
    Scan::Hensley { radix: 4 },
    Scan::Hensley { radix: 8 },
    Scan::Hensley { radix: 16 },
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Random,
    Black,
    OneSun,
    Alternating,
    Subnormal,
    Decades,
}

const CONTENTS: [Content; 6] = [
    Content::Random,
    Content::Black,
    Content::OneSun,
    Content::Alternating,
    Content::Subnormal,
    Content::Decades,
];

/// Returns `count` texels, the fourth value a weight.
fn texels(content: Content, count: usize) -> Vec<[f32; 4]> {
    let mut random = Random::new(count as u64);
    let sun = count * 2 / 3;
    (0..count)
        .map(|k| {
            let mut unit = || random.unit() as f32;
            let weight = 0.5 + unit();
            let rgb = match content {
                Content::Random => [unit(), 100.0 * unit(), 1e-3 * unit()],
                Content::Black => [0.0; 3],
                Content::OneSun => [if k == sun { 1e6 } else { 0.4 }, if k == sun { 7.0 } else { 0.0 }, 0.4],
                Content::Alternating => [0.0, 65504.0, 65504.0 * (k % 2) as f32],
                Content::Subnormal => std::array::from_fn(|_| f32::from_bits((unit() * 8_388_607.0) as u32)),
                Content::Decades => std::array::from_fn(|_| 10_f32.powf(76.0 * unit() - 38.0)),
            };
            [rgb[0], rgb[1], rgb[2], weight]
        })
        .collect()
}

fn oem(content: Content, inner: u32, border: u32) -> Oem {
    Oem::from_square(OemSize { inner, border }, texels(content, (inner * inner) as usize))
}

/// Computes floor(value * 2^F) in 128 bits from the bits of `value`.
fn fixed(value: f32, exponent: i32) -> u64 {
    // value = mantissa * 2^power, exactly.
    let bits = value.to_bits();
    let (mantissa, power) = match bits >> 23 {
        0 => (bits & 0x7f_ffff, -149),
        e => ((bits & 0x7f_ffff) | 0x80_0000, e as i32 - 150),
    };
    let shift = power + exponent;
    let wide = u128::from(mantissa);
    let integer = if shift >= 0 { wide << shift.min(100) } else { wide >> (-shift).min(127) };
    u64::try_from(integer).expect("a texel fits")
}

fn quantised(point: FixedPoint, texel: [f32; 4]) -> [u64; 4] {
    std::array::from_fn(|c| fixed(texel[c], point.exponents[c]))
}

/// Computes the table by definition: sums down the columns, then along the rows.
fn naive_table(point: FixedPoint, texels: &[[f32; 4]], width: usize) -> Vec<[u64; 4]> {
    let mut table: Vec<[u64; 4]> = texels.iter().map(|t| quantised(point, *t)).collect();
    for k in width..table.len() {
        table[k] = std::array::from_fn(|c| table[k][c].wrapping_add(table[k - width][c]));
    }
    for k in 0..table.len() {
        if k % width > 0 {
            table[k] = std::array::from_fn(|c| table[k][c].wrapping_add(table[k - 1][c]));
        }
    }
    table
}

/// Counts entries that differ.
fn mismatches(a: &[[u64; 4]], b: &[[u64; 4]]) -> usize {
    assert!(!a.is_empty() && a.len() == b.len(), "{} entries against {}", a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// A float32 table with its mean bias.
struct FloatTable {
    side: u32,
    mean: [f32; 4],
    entries: Vec<[f32; 4]>,
}

impl FloatTable {
    fn new(oem: &Oem) -> Self {
        let (mean, entries) = sat_f32(oem);
        Self { side: oem.size().bordered(), mean, entries }
    }

    /// Sum of the texels `x0 <= x < x1`, `y0 <= y < y1`, counted from the bordered table's corner.
    fn sum(&self, x0: u32, y0: u32, x1: u32, y1: u32) -> [f32; 4] {
        let at = |x: u32, y: u32| match (x.checked_sub(1), y.checked_sub(1)) {
            (Some(x), Some(y)) => self.entries[(y * self.side + x) as usize],
            _ => [0.0; 4],
        };
        let area = ((x1 - x0) * (y1 - y0)) as f32;
        let (a, b, c, d) = (at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1));
        std::array::from_fn(|k| d[k] - b[k] - c[k] + a[k] + self.mean[k] * area)
    }
}

#[test]
fn all_scans_give_the_same_bits() {
    for content in CONTENTS {
        for inner in [1, 2, 3, 5, 17, 64, 1024] {
            let oem = oem(content, inner, 0);
            let point = FixedPoint::of_square(&oem);
            let expected = naive_table(point, oem.texels(), inner as usize);
            // One radix at the large size: small sizes compare all of them.
            for scan in
                SCANS.into_iter().take(if inner == 1024 && content != Content::OneSun { 3 } else { 7 })
            {
                let sat = Sat::new(&oem, scan);
                assert_eq!(sat.fixed_point(), point);
                let wrong = mismatches(sat.entries(), &expected);
                assert_eq!(wrong, 0, "{content:?} {inner} {scan:?}: {wrong} entries differ");
            }
        }
    }
}

#[test]
fn scans_of_a_table_that_is_not_square_agree() {
    let (width, height) = (300, 100);
    for content in CONTENTS {
        let texels = texels(content, width * height);
        // A scan works at any scale; entries may wrap and must wrap alike.
        for exponents in [[40, 30, 50, 40], [0; 4], [-10, 60, 149, 20]] {
            let point = FixedPoint { exponents };
            if !texels.iter().flatten().zip(exponents.iter().cycle()).all(|(v, e)| fits(*v, *e)) {
                continue;
            }
            for (width, texels) in [(width, &texels), (height, &texels)] {
                let expected = naive_table(point, texels, width);
                for method in SCANS {
                    let mut out = vec![[0; 4]; texels.len()];
                    scan(method, point, texels, width, &mut out);
                    assert_eq!(mismatches(&out, &expected), 0, "{content:?} {method:?} {width} wide");
                }
            }
        }
    }
}

/// Returns whether a texel's integer stays below 2^63 at this scale.
fn fits(value: f32, exponent: i32) -> bool {
    value == 0.0 || f64::from(value).log2() + f64::from(exponent) < 63.0
}

#[test]
fn scans_agree_whatever_the_thread_count() {
    let oem = oem(Content::Random, 129, 5);
    let expected = naive_table(FixedPoint::of_square(&oem), oem.texels(), 139);
    for threads in [1, 2, 3, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads");
        for scan in SCANS {
            let sat = pool.install(|| Sat::new(&oem, scan));
            assert_eq!(mismatches(sat.entries(), &expected), 0, "{threads} threads, {scan:?}");
        }
    }
}

#[test]
fn one_wrong_texel_is_detected_in_a_table() {
    let oem = oem(Content::Random, 17, 0);
    let expected = naive_table(FixedPoint::of_square(&oem), oem.texels(), 17);
    let mut texels = oem.texels().to_vec();
    // One unit in the last place, in the middle of the square and in its last corner.
    for k in [8 * 17 + 8, 17 * 17 - 1] {
        let value = texels[k][1];
        texels[k][1] = f32::from_bits(value.to_bits() + 1);
        let mut out = vec![[0; 4]; texels.len()];
        scan(Scan::Blocks, FixedPoint::of_square(&oem), &texels, 17, &mut out);
        assert!(mismatches(&out, &expected) > 0, "texel {k}");
        texels[k][1] = value;
    }
}

#[test]
fn scales_are_the_largest_that_fit() {
    let two_62 = 2_f64.powi(62);
    for content in CONTENTS {
        for inner in [1, 2, 3, 17, 64, 333] {
            let oem = oem(content, inner, 2);
            let point = FixedPoint::of_square(&oem);
            let totals = oem.totals();
            let count = f64::from(inner * inner);
            for c in 0..4 {
                let exponent = point.exponents[c];
                let scaled = totals[c] * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2);
                if totals[c] == 0.0 {
                    assert_eq!(exponent, 0, "{content:?} {inner}: a black channel");
                    continue;
                }
                assert!(scaled < two_62 - count, "{content:?} {inner} channel {c}: {scaled:e} fits");
                // The scale is derived from truncated integers: the last 2^-20 below the limit may stay
                // unused.
                assert!(
                    2.0 * scaled > (two_62 - count) * (1.0 - 1e-6),
                    "{content:?} {inner} channel {c}: {scaled:e}"
                );
            }
        }
    }
}

/// Returns the quantised texel of the square at (x, y) of the unfolded plane, by the continuous rule.
fn plane_texel(oem: &Oem, point: FixedPoint, x: i64, y: i64) -> [u64; 4] {
    let n = f64::from(oem.size().inner);
    let inside =
        (octahedral::wrap_oct((DVec2::new(x as f64, y as f64) + 0.5) * 2.0 / n - 1.0) + 1.0) / 2.0 * n;
    quantised(point, oem.texel(inside.x as u32, inside.y as u32))
}

/// Sums a box texel by texel in 128 bits.
fn direct_box(oem: &Oem, point: FixedPoint, [x0, y0, x1, y1]: [i64; 4]) -> [u128; 4] {
    let mut sum = [0; 4];
    for y in y0..y1 {
        for x in x0..x1 {
            for (sum, value) in sum.iter_mut().zip(plane_texel(oem, point, x, y)) {
                *sum += u128::from(value);
            }
        }
    }
    sum
}

#[test]
fn every_aligned_rectangle_of_an_8x8_table_is_exact() {
    for content in CONTENTS {
        let oem = oem(content, 8, 0);
        let sat = Sat::new(&oem, Scan::default());
        let mut compared = 0;
        for y0 in 0..=8 {
            for y1 in y0..=8 {
                for x0 in 0..=8 {
                    for x1 in x0..=8 {
                        let expected = direct_box(&oem, sat.fixed_point(), [x0, y0, x1, y1]);
                        assert_eq!(sat.bordered_box(x0, y0, x1, y1).map(u128::from), expected, "{content:?}");
                        assert_eq!(sat.plane_box(x0, y0, x1, y1).map(u128::from), expected, "{content:?}");
                        compared += 1;
                    }
                }
            }
        }
        assert_eq!(compared, 45 * 45);
    }
}

#[test]
fn one_wrong_texel_is_detected_in_a_box() {
    let right = oem(Content::Random, 8, 0);
    let mut texels = right.texels().to_vec();
    texels[27][2] = f32::from_bits(texels[27][2].to_bits() + 1);
    let wrong = Sat::new(&Oem::from_square(right.size(), texels), Scan::default());
    let point = FixedPoint::of_square(&right);
    assert_eq!(point, wrong.fixed_point(), "the same scale");
    let seen =
        |b: [i64; 4]| wrong.plane_box(b[0], b[1], b[2], b[3]).map(u128::from) != direct_box(&right, point, b);
    assert!(
        seen([3, 3, 4, 4]) && seen([0, 0, 8, 8]) && !seen([4, 4, 8, 8]),
        "exactly where the box contains it"
    );
}

#[test]
fn boxes_across_edges_and_corners_are_equal_to_the_last_bit() {
    for content in [Content::Random, Content::OneSun, Content::Subnormal] {
        for n in [1, 2, 3, 5, 8] {
            let oem = oem(content, n, n);
            let sat = Sat::new(&oem, Scan::default());
            let point = sat.fixed_point();
            let side = i64::from(n);
            let mut compared = 0;
            let step = if n == 8 { 3 } else { 1 };
            let places = || (-side..=2 * side).step_by(step);
            for (x0, y0) in places().flat_map(|x| places().map(move |y| (x, y))) {
                for x1 in places().filter(|x1| *x1 >= x0 && x1 - x0 <= 2 * side) {
                    for y1 in places().filter(|y1| *y1 >= y0 && y1 - y0 <= 2 * side) {
                        let parity = sat.plane_box(x0, y0, x1, y1);
                        let bordered = sat.bordered_box(x0, y0, x1, y1);
                        assert_eq!(parity, bordered, "{content:?} {n}: ({x0}, {y0}) .. ({x1}, {y1})");
                        let expected = direct_box(&oem, point, [x0, y0, x1, y1]);
                        assert_eq!(
                            parity.map(u128::from),
                            expected,
                            "{content:?} {n}: ({x0}, {y0}) .. ({x1}, {y1})"
                        );
                        compared += 1;
                    }
                }
            }
            assert!(compared >= 25, "n {n}: {compared} boxes");
        }
    }
}

#[test]
fn fractional_boxes_through_the_border_are_equal_to_those_by_parity() {
    let mut random = Random::new(23);
    let square = oem(Content::OneSun, 8, 0);
    let wide = oem(Content::OneSun, 8, 8);
    let (parity, bordered) = (Sat::new(&square, Scan::Blocks), Sat::new(&wide, Scan::Hensley { radix: 4 }));
    for k in 0..2000 {
        // Some leave the border.
        let mut place = || DVec2::new(random.between(-9.0, 16.0), random.between(-9.0, 16.0));
        let (a, b) = (place(), place());
        let (low, high) = (a.min(b), a.max(b).min(a.min(b) + 16.0));
        let (expected, found) = (parity.fractional_box(low, high), bordered.fractional_box(low, high));
        assert_eq!(found.map(f64::to_bits), expected.map(f64::to_bits), "{k}: {low} .. {high}");
    }
}

#[test]
fn scans_are_parsed_and_checked() {
    for scan in [Scan::Blocks, Scan::Hensley { radix: 2 }, Scan::Hensley { radix: 16 }] {
        assert_eq!(scan.to_string().parse(), Ok(scan));
        scan.check().expect("a scan of both engines");
        Filter::Box.check_scan(scan).expect("a filter over a table");
    }
    Filter::Reference.check_scan(Scan::Blocks).expect("the default");
    for filter in [Filter::Adaptive(0.005), Filter::Pyramid, Filter::Reference] {
        let error = filter.check_scan(Scan::Hensley { radix: 2 }).unwrap_err().to_string();
        assert!(error.starts_with("`scan` hensley:2 ") && error.ends_with("use `filter` box"), "{error}");
    }
    for radix in [0, 1, 3, 32, u32::MAX] {
        let scan = Scan::Hensley { radix };
        let error = Filter::Box.check_scan(scan).unwrap_err().to_string();
        assert_eq!(error, format!("`scan` hensley:{radix}: the samples of a pass must be 2, 4, 8 or 16"));
        assert!(scan.to_string().parse::<Scan>().is_err());
        let world = Environment::new(Layout::Octahedral { size: 4 }, vec![[1.0; 3]; 16]).expect("16 texels");
        let settings = ReflectorSettings { scan, ..ReflectorSettings::default() };
        assert!(matches!(
            Reflector::new(&world, &settings),
            Err(octagloss_core::common::error::Error::Parameter(_))
        ));
    }
}

#[test]
fn bakes_that_share_a_table_share_its_scan() {
    let world = Environment::new(Layout::Octahedral { size: 4 }, vec![[1.0; 3]; 16]).expect("16 texels");
    let settings = |filter, radix| BakeSettings {
        filter,
        scan: Scan::Hensley { radix },
        size: 2,
        ..BakeSettings::default()
    };
    let all = |settings: &[BakeSettings]| bake_all(&world, settings, &unwatched).map(drop);
    all(&[settings(Filter::Box, 2), settings(Filter::Box, 2)]).expect("one scan");
    // Quadrature has no part in it.
    all(&[BakeSettings { size: 2, ..BakeSettings::default() }, settings(Filter::Box, 8)]).expect("one scan");
    let error = all(&[settings(Filter::Box, 2), settings(Filter::Box, 4)]).unwrap_err().to_string();
    assert!(error.starts_with("`scan` hensley:2 and hensley:4 "), "{error}");
}

#[test]
fn boxes_far_out_on_the_plane_are_exact() {
    let mut random = Random::new(21);
    let mut compared = 0;
    for content in CONTENTS {
        for n in [1, 2, 3, 4, 7, 16] {
            let oem = oem(content, n, 0);
            let sat = Sat::new(&oem, Scan::default());
            for _ in 0..60 {
                let mut place = || random.between(-5.0 * f64::from(n), 5.0 * f64::from(n)) as i64;
                let (x0, y0) = (place(), place());
                let (w, h) = (random.below(2 * n + 1), random.below(2 * n + 1));
                let area = [x0, y0, x0 + i64::from(w), y0 + i64::from(h)];
                let value = sat.plane_box(area[0], area[1], area[2], area[3]).map(u128::from);
                assert_eq!(value, direct_box(&oem, sat.fixed_point(), area), "{content:?} {n} {area:?}");
                compared += 1;
            }
            // The greatest box: every texel four times, without wrapping.
            let side = i64::from(n);
            let greatest = sat.plane_box(-side / 2, 1, 2 * side - side / 2, 2 * side + 1).map(u128::from);
            let whole = direct_box(&oem, sat.fixed_point(), [0, 0, side, side]);
            assert_eq!(greatest, whole.map(|sum| 4 * sum), "{content:?} {n}");
        }
    }
    assert_eq!(compared, 6 * 6 * 60);
}

/// Sums a box with fractional edges directly by shares of texels.
fn direct_fractional(oem: &Oem, point: FixedPoint, low: DVec2, high: DVec2) -> [f64; 4] {
    let share = |t: i64, low: f64, high: f64| (high.min(t as f64 + 1.0) - low.max(t as f64)).max(0.0);
    let mut sum = [0.0; 4];
    for y in low.y.floor() as i64..high.y.ceil() as i64 {
        for x in low.x.floor() as i64..high.x.ceil() as i64 {
            let weight = share(x, low.x, high.x) * share(y, low.y, high.y);
            for (c, value) in plane_texel(oem, point, x, y).into_iter().enumerate() {
                sum[c] += weight * value as f64 * (-f64::from(point.exponents[c])).exp2();
            }
        }
    }
    sum
}

#[test]
fn fractional_boxes_are_their_shares() {
    let mut random = Random::new(22);
    let (mut compared, mut seen) = (0, 0);
    for content in CONTENTS {
        for n in [1, 2, 3, 5, 16] {
            let oem = oem(content, n, 0);
            let sat = Sat::new(&oem, Scan::default());
            for k in 0..100 {
                let span = f64::from(n);
                let mut place =
                    || DVec2::new(random.between(-span, 2.0 * span), random.between(-span, 2.0 * span));
                let mut low = place();
                let mut side = DVec2::new(random.between(0.0, 2.0 * span), random.between(0.0, 2.0 * span));
                match k % 4 {
                    0 => side *= 0.5 / span, // within a texel or two
                    1 => low = low.floor(),
                    2 => side = side.floor(),
                    _ => {}
                }
                let high = low + side;
                let value = sat.fractional_box(low, high);
                let expected = direct_fractional(&oem, sat.fixed_point(), low, high);
                for c in 0..4 {
                    // Nine products and a thousand shares in double precision. Edges are off by 2^-50 of a
                    // coordinate, and texels may be 1e76 times brighter than their neighbours: relative to
                    // the box's brightest.
                    let scale = expected[c]
                        .max(1e-2 * direct_fractional(&oem, sat.fixed_point(), low.floor(), high.ceil())[c]);
                    let off = (value[c] - expected[c]).abs();
                    assert!(off <= 1e-11 * scale, "{content:?} {n} {low} {high}: {value:?} {expected:?}");
                    let shifted =
                        direct_fractional(&oem, sat.fixed_point(), low, high + DVec2::new(1e-6, 0.0));
                    seen += usize::from((value[c] - shifted[c]).abs() > 1e-11 * scale);
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 6 * 5 * 100 * 4);
    assert!(
        seen > compared / 2,
        "an edge off by a millionth of a texel was detected in {seen} of {compared}"
    );
}

#[test]
fn float_tables_fail_where_exact_ones_do_not() {
    let (n, sky) = (1024, 0.4);
    let oem = oem(Content::OneSun, n, 0);
    let (exact, float) = (Sat::new(&oem, Scan::default()), FloatTable::new(&oem));
    let (mut worst_exact, mut worst_float) = (0.0_f64, 0.0_f64);
    let mut compared = 0;
    for y in (0..n).step_by(37) {
        for x in (0..n).step_by(41) {
            if oem.texel(x, y)[0] > 1.0 {
                continue;
            }
            let (column, row) = (i64::from(x), i64::from(y));
            let integer = exact.bordered_box(column, row, column + 1, row + 1)[0];
            let value = exact.fixed_point().value(0, integer);
            worst_exact = worst_exact.max((value - sky).abs());
            worst_float = worst_float.max((f64::from(float.sum(x, y, x + 1, y + 1)[0]) - sky).abs());
            compared += 1;
        }
    }
    assert!(compared > 600, "{compared} texels");
    // Exact except that 0.4 is a float32 and is truncated at 2^-F: 2^-25 of 0.4 and 1.4e6/2^62.
    assert!(worst_exact < 2e-8, "the exact table is off by {worst_exact:e}");
    // Partial sums of 4e5 and more are rounded by 2^-24 of themselves: 0.02 and more.
    assert!(worst_float > 0.02, "the float table is off by {worst_float:e}");
    // The error is within its stated bound: (4 d + 3) 2^-24 T / A with d = 20, A = 1 and T the sum of
    // |value - mean|.
    let mean = oem.totals()[0] / f64::from(n * n);
    let total: f64 = oem.texels().iter().map(|t| (f64::from(t[0]) - mean).abs()).sum();
    let bound = 83.0 / f64::from(1_u32 << 24) * total;
    assert!(worst_float <= bound, "{worst_float:e} within {bound:e}");
}

#[test]
fn float_tables_serve_ldr() {
    let n = 64;
    let oem = oem(Content::Random, n, 0);
    let float = FloatTable::new(&oem);
    let mut random = Random::new(23);
    for _ in 0..500 {
        let (x0, y0) = (random.below(n), random.below(n));
        let (x1, y1) = (x0 + 1 + random.below(n - x0), y0 + 1 + random.below(n - y0));
        let sum = float.sum(x0, y0, x1, y1);
        for c in 0..4 {
            let mut expected = 0.0;
            let mut total = 0.0;
            let mean = oem.totals()[c] / f64::from(n * n);
            for k in 0..n * n {
                let value = f64::from(oem.texel(k % n, k / n)[c]);
                total += (value - mean).abs();
                let inside = (x0..x1).contains(&(k % n)) && (y0..y1).contains(&(k / n));
                expected += if inside { value } else { 0.0 };
            }
            // The documented bound with d = 12, and the roundings of the mean times the area.
            let bound = (51.0 * total + 2.0 * expected) / f64::from(1_u32 << 24);
            assert!(
                (f64::from(sum[c]) - expected).abs() <= bound,
                "({x0}, {y0}) .. ({x1}, {y1}) channel {c}"
            );
        }
    }
}
