//! Look-ups in mip-mapped octahedral maps: coordinates, levels of cells, borders, weights, both layouts.

use glam::{DVec2, DVec3};
use octagloss_core::files::image::oem_mips::{Addressing, OemMips, Weights};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::sphere::map::SphereMap as _;
use octagloss_core::sphere::octahedral::{direction_from_oct, texel_centre, texel_solid_angle, wrap_oct};
use octagloss_core::sphere::octahedral_rectangular::OctahedralRectangular;
use octagloss_core::sphere::oem_lookup::{
    greatest_level, level_of_cell, level_of_corners, quadratic_coordinates, quadratic_level,
    rectangular_place,
};
use octagloss_fixtures::common::Random;
use octagloss_fixtures::oracles::oem_mips::rectangular_level;

/// Random directions, and those on axes, folds, cuts and beside them.
fn directions(count: usize) -> Vec<DVec3> {
    let mut random = Random::new(77);
    let mut all: Vec<DVec3> = (0..count)
        .map(|_| DVec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0))).normalize())
        .collect();
    let steps = [-1.0, -0.6, -0.2, 0.0, 1e-9, 0.3, 1.0];
    for (x, y, z) in steps
        .into_iter()
        .flat_map(|x| steps.into_iter().flat_map(move |y| steps.into_iter().map(move |z| (x, y, z))))
    {
        let direction = DVec3::new(x, y, z);
        if direction.length() > 0.1 {
            all.push(direction.normalize());
        }
    }
    all
}

/// The listing as the paper prints it.
fn printed_listing(direction: DVec3) -> DVec2 {
    let d = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let sign = |value: f64| if value == 0.0 { 0.0 } else { value.signum() };
    let xy = if d.y < 0.0 {
        DVec2::new((1.0 - d.z.abs()) * sign(d.x), (1.0 - d.x.abs()) * sign(d.z))
    } else {
        DVec2::new(d.x, d.y)
    };
    xy * 0.5 + 0.5
}

#[test]
fn the_corrected_listing_comes_back_to_its_direction() {
    let off = |coordinates: fn(DVec3) -> DVec2, direction: DVec3| {
        direction_from_oct(coordinates(direction) * 2.0 - 1.0).distance(direction)
    };
    let (mut printed_upper, mut printed_cut) = (0.0_f64, 0.0_f64);
    for direction in directions(2000) {
        // A few roundings of numbers up to 2, times the map's condition, at most 3^(3/2).
        assert!(off(quadratic_coordinates, direction) < 1e-14, "{direction}");
        let printed = off(printed_listing, direction);
        if direction.y >= 0.0 {
            printed_upper = printed_upper.max(printed);
        } else if direction.x == 0.0 || direction.z == 0.0 {
            printed_cut = printed_cut.max(printed);
        }
    }
    assert!(
        printed_upper > 0.5 && printed_cut > 0.1,
        "the listing as printed: {printed_upper} {printed_cut}"
    );
}

/// Derivative of the texture coordinates along `step` at the unit vector `d`, from the quotient rule on the
/// octant's plane s.p = 1: p' = (step - p (s.step)) / (s.d), and both foldings keep lengths along x and z,
/// exchanged in the lower hemisphere.
fn derivative(d: DVec3, step: DVec3, inner: f64) -> f64 {
    let s = DVec3::new(1_f64.copysign(d.x), 1_f64.copysign(d.y), 1_f64.copysign(d.z));
    let p = d / s.dot(d);
    let moved = (step - p * s.dot(step)) / s.dot(d);
    DVec2::new(moved.x, moved.z).length() * inner / 2.0
}

/// Whether all of `cell` is in one octant, and no coordinate is within `margin` of 0.
fn is_in_one_octant(cell: [DVec3; 3], margin: f64) -> bool {
    (0..3).all(|axis| {
        let values = cell.map(|d| d[axis]);
        values.iter().all(|v| *v > margin) || values.iter().all(|v| *v < -margin)
    })
}

fn cell_around(own: DVec3, step: f64) -> [DVec3; 3] {
    let right = own.any_orthonormal_vector();
    [own, own + right * step, own + own.cross(right) * (0.7 * step)]
}

#[test]
fn levels_of_cells_are_those_of_the_derivative() {
    let (inner, step) = (512, 1e-5);
    let mut compared = 0;
    for own in directions(4000) {
        let cell = cell_around(own, step);
        if !is_in_one_octant(cell, 1e-4) {
            continue;
        }
        let lengths = [1, 2].map(|k| derivative(own, cell[k] - own, f64::from(inner)));
        let exact = lengths[0].max(lengths[1]).log2();
        // p'' = -2 (s.a) p' / (s.d) is at most 2 sqrt(3) |p'| step long: a relative error of sqrt(3) step in
        // each length, log2(e) times that in its logarithm. Rounding: 1e-16 over a step of 1e-5.
        let bound = std::f64::consts::LOG2_E * (3_f64.sqrt() * step + 1e-10);
        for level in [level_of_cell(cell, inner), quadratic_level(cell, inner)] {
            assert!((level - exact).abs() <= bound, "{own}: {level}, not {exact}");
        }
        // A layer's coordinates are turned by 45 degrees and longer by sqrt(2).
        let level = rectangular_level(cell, inner);
        assert!((level - exact - 0.5).abs() <= bound, "{own}: {level}, not {exact} + 1/2");
        // The comparison detects a twentieth of a level.
        assert!((quadratic_level(cell, inner + 20) - exact).abs() > bound);
        compared += 1;
    }
    assert!(compared > 3000, "{compared}");
}

#[test]
fn the_mirrored_cell_mends_the_levels_at_the_cuts() {
    let inner = 1024;
    let mut worst = 0.0_f64;
    for k in 1..200 {
        // Half a pixel before a cut of the lower hemisphere; the neighbour is its mirror image.
        let angle = f64::from(k) / 200.0 * std::f64::consts::FRAC_PI_2;
        let pixel = 0.004;
        for (along, across) in [(DVec3::X, DVec3::Z), (DVec3::NEG_X, DVec3::Z), (DVec3::Z, DVec3::X)] {
            let on_cut = along * angle.cos() - DVec3::Y * angle.sin();
            let [own, right] = [0.5, -0.5].map(|side| on_cut + across * (side * pixel));
            let cell = [own, right, own + on_cut.cross(across) * (0.1 * pixel)];
            // Both project to the same sum s.d, so the contiguous distance is the difference over it.
            let sum = own.x.abs() + own.y.abs() + own.z.abs();
            let exact = (pixel / sum * f64::from(inner) / 2.0).log2();
            let level = quadratic_level(cell, inner);
            // Both are the same closed form; the other side of the cell is shorter.
            assert!((level - exact).abs() < 1e-9, "{on_cut}: {level}, not {exact}");
            // Across the cut the coordinates jump by twice |y| over the sum.
            let jump = (on_cut.y.abs() / sum * f64::from(inner)).log2();
            let plain = level_of_cell(cell, inner);
            assert!(plain >= jump - 1e-9, "{on_cut}: {plain} below {jump}");
            worst = worst.max(plain - exact);
        }
    }
    assert!(worst > 8.0, "without the mirrored cell, levels are up to {worst} too coarse");
    // Around the cone points both cells jump, by no more than a few times the cell.
    for own in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
        let mut random = Random::new(5);
        for _ in 0..2000 {
            let mut near = || {
                let shift = DVec3::from_array(std::array::from_fn(|_| random.between(-0.004, 0.004)));
                (own + shift).normalize()
            };
            let cell = [near(), near(), near()];
            let longest = cell[0].distance(cell[1]).max(cell[0].distance(cell[2]));
            // |dp| is at most (1 + sqrt 3) |d - d'|, and the jump at a cone point at most twice the distance
            // of the cell's corners from it, below 0.004 * 2 sqrt(3).
            let most = ((1.0 + 3_f64.sqrt()) * longest + 4.0 * 0.004 * 3_f64.sqrt()) * f64::from(inner) / 2.0;
            assert!(quadratic_level(cell, inner) <= most.log2(), "{cell:?}");
        }
    }
}

#[test]
fn levels_in_one_layer_per_hemisphere_are_continuous_across_the_equator() {
    let inner = 512;
    let mut jumps = 0;
    for k in 0..400 {
        let angle = (f64::from(k) + 0.5) / 400.0 * std::f64::consts::TAU;
        let pixel = 0.003;
        let on_equator = DVec3::new(angle.cos(), 0.0, angle.sin());
        let [own, below] = [0.5, -0.5].map(|side| on_equator + DVec3::Y * (side * pixel));
        for cell in [[own, own, below], [below, own, below]] {
            // p.y is half a pixel over the sum on either side, and one texel of p.y is one unit of u or v.
            let sum = own.x.abs() + own.y.abs() + own.z.abs();
            let exact = (2.0 * (0.5 * pixel / sum) * f64::from(inner) / 2.0).log2();
            let level = rectangular_level(cell, inner);
            assert!((level - exact).abs() < 1e-9, "{on_equator}: {level}, not {exact}");
            let places = cell.map(|d| rectangular_place(d).1 * (f64::from(inner) / 2.0));
            jumps += usize::from(level_of_corners(places) > exact + 1.0);
        }
    }
    assert!(jumps > 600, "layers' own coordinates jump at the equator: {jumps}");
}

/// Random texels of the quadratic layout.
fn random_oem(inner: u32, border: u32) -> Oem {
    let mut random = Random::new(u64::from(inner));
    let texels = (0..inner * inner).map(|k| {
        let w = texel_solid_angle(inner, k % inner, k / inner);
        let mut channel = || (random.unit() * w) as f32;
        [channel(), channel(), channel(), w as f32]
    });
    Oem::from_square(OemSize { inner, border }, texels.collect())
}

/// Bilinear interpolation, at `uv` of the square, between means of the unfolded plane over blocks of 2^level
/// texels that start `border` texels before the square; `texel` has energy and solid angle at a point of the
/// plane in units of its domain.
fn plane_look_up(
    texel: &dyn Fn(DVec2) -> [f64; 4],
    (inner, border): (u32, u32),
    uv: DVec2,
    level: u32,
) -> [f64; 3] {
    let (side, step) = (f64::from(1_u32 << level), 2.0 / f64::from(inner));
    let at = ((uv + 1.0) / step + f64::from(border)) / side - 0.5;
    let mut value = [0.0; 3];
    for (right, below) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let corner = at.floor() + DVec2::new(right, below);
        let mut sum = [0.0; 4];
        for k in 0..1_u32 << (2 * level) {
            let inside = DVec2::new(f64::from(k % (1 << level)), f64::from(k >> level)) + 0.5;
            let point = (corner * side + inside - f64::from(border)) * step - 1.0;
            sum.iter_mut().zip(texel(point)).for_each(|(sum, value)| *sum += value);
        }
        let share = at - at.floor();
        let weight = (1.0 - (share.x - right).abs()) * (1.0 - (share.y - below).abs());
        (0..3).for_each(|c| value[c] += weight * sum[c] / sum[3]);
    }
    value
}

/// Places on the square's edges and corners, and inside.
fn places() -> Vec<DVec2> {
    let mut random = Random::new(3);
    let mut places = vec![DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(0.0, -1.0)];
    places.extend([(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, y)| DVec2::new(x, y)));
    for _ in 0..24 {
        let along = random.between(-1.0, 1.0);
        places.extend([DVec2::new(1.0, along), DVec2::new(-1.0, along)]);
        places.extend([DVec2::new(along, 1.0), DVec2::new(along, -1.0)]);
        places.push(DVec2::new(random.between(-1.0, 1.0), along));
    }
    places
}

/// Texels are in [0, 1], stored as float32 and summed from float32: half a unit in the last place each.
const STORED: f64 = 2.0 / (1_u32 << 24) as f64;

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max)
}

#[test]
fn every_level_up_to_the_greatest_is_right_at_every_edge_and_none_above() {
    let mut above = 0;
    for (inner, border, expected) in [
        (16, 0, None),
        (16, 1, Some(1)),
        (16, 2, Some(2)),
        (12, 2, Some(2)),
        (16, 3, Some(1)),
        (24, 4, Some(3)),
        (16, 8, Some(4)),
        (32, 16, Some(5)),
        (7, 3, Some(0)),
    ] {
        let oem = random_oem(inner, border);
        let texel = |point: DVec2| {
            let at = ((wrap_oct(point) + 1.0) * (f64::from(inner) / 2.0)).floor();
            oem.texel(at.x as u32, at.y as u32).map(f64::from)
        };
        let mips = OemMips::quadratic(&oem, Weights::SolidAngle);
        assert_eq!(mips.greatest_level(), expected, "{inner} + {border}");
        assert_eq!(greatest_level(inner, border), expected);
        let worst = |level: u32, addressing: Addressing| {
            let off = places().into_iter().map(|uv| {
                let found = mips.look_up((0, uv), f64::from(level), addressing);
                distance(found, plane_look_up(&texel, (inner, border), uv, level))
            });
            off.fold(0.0, f64::max)
        };
        for level in expected.into_iter().flat_map(|greatest| 0..=greatest) {
            let off = worst(level, Addressing::Clamp);
            assert!(off <= STORED, "{inner} + {border}, level {level}: {off}");
        }
        let next = expected.map_or(0, |greatest| greatest + 1);
        // A texel of the plane's whole period is the mean of the sphere wherever it starts.
        if (next as usize) < mips.levels().len() && 1 << next < 2 * inner {
            let off = worst(next, Addressing::Clamp);
            assert!(off > 0.01, "{inner} + {border}, level {next} is right: {off}");
            above += 1;
        }
        if border == 0 {
            let off = worst(0, Addressing::Repeat);
            assert!(off > 0.1, "wrap-around access is wrong: {off}");
        }
    }
    assert!(above >= 2, "{above} sizes have levels above the greatest");
}

#[test]
fn every_texel_of_every_level_is_the_mean_over_the_plane() {
    let (inner, border) = (16, 8);
    let oem = random_oem(inner, border);
    let texel = |point: DVec2| {
        let at = ((wrap_oct(point) + 1.0) * (f64::from(inner) / 2.0)).floor();
        oem.texel(at.x as u32, at.y as u32).map(f64::from)
    };
    let worst = |mips: &OemMips| {
        let mut worst = 0.0_f64;
        for (level, own) in (0..).zip(mips.levels()) {
            let (side, step) = (f64::from(1_u32 << level), 2.0 / f64::from(inner));
            for (k, found) in (0..own.side * own.side).zip(&own.texels) {
                // The centre of the texel, where bilinear interpolation is its value.
                let centre = DVec2::new(f64::from(k % own.side), f64::from(k / own.side)) + 0.5;
                let uv = (centre * side - f64::from(border)) * step - 1.0;
                let expected = plane_look_up(&texel, (inner, border), uv, level);
                worst = worst.max(distance(found.map(f64::from), expected));
            }
        }
        worst
    };
    let off = worst(&OemMips::quadratic(&oem, Weights::SolidAngle));
    assert!(off <= STORED, "{off}");
    let off = worst(&OemMips::quadratic(&oem, Weights::Equal));
    assert!(off > 0.01, "equal weights are detected: {off}");
}

#[test]
fn the_coarsest_level_is_the_mean_over_the_sphere() {
    // Bright in the middle of the octants, where texels have the largest solid angles.
    let inner = 32;
    let texels = (0..inner * inner).map(|k| {
        let (x, y) = (k % inner, k / inner);
        let (w, d) = (texel_solid_angle(inner, x, y), direction_from_oct(texel_centre(inner, x, y)));
        [5.0 * (d.x * d.y * d.z).abs(), 0.0, 0.0, 1.0].map(|value| (value * w) as f32)
    });
    let oem = Oem::from_square(OemSize { inner, border: 0 }, texels.collect());
    let [red, _, _, sphere] = oem.totals();
    let coarsest = |weights| {
        let mips = OemMips::quadratic(&oem, weights);
        let last = mips.levels().last().expect("levels");
        assert_eq!(last.side, 1);
        f64::from(last.texels[0][0])
    };
    assert!((coarsest(Weights::SolidAngle) - red / sphere).abs() <= STORED);
    assert!((coarsest(Weights::Equal) - red / sphere).abs() > 0.05, "equal weights");
}

#[test]
fn layers_of_hemispheres_are_right_across_the_equator() {
    let (inner, border) = (16_u32, 4);
    let mut random = Random::new(12);
    let table: Vec<[f32; 3]> =
        (0..2 * inner * inner).map(|_| std::array::from_fn(|_| random.unit() as f32)).collect();
    // The texel of a direction, by the map's own place.
    let index = |direction: DVec3| {
        let uv = OctahedralRectangular.locate(direction).uv;
        let at = ((uv + DVec2::new(2.0, 1.0)) * (f64::from(inner) / 2.0)).floor();
        let (x, y) = (at.x.clamp(0.0, f64::from(2 * inner - 1)), at.y.clamp(0.0, f64::from(inner - 1)));
        (x as usize, y as usize)
    };
    let radiance = |direction: DVec3| {
        let (x, y) = index(direction);
        table[y * 2 * inner as usize + x]
    };
    let step = 2.0 / f64::from(inner);
    let texel = |layer: f64, point: DVec2| {
        // Points of the plane go through directions, not through texels.
        let direction = OctahedralRectangular.direction(0, point + DVec2::new(2.0 * layer - 1.0, 0.0));
        let (x, y) = index(direction);
        let low = DVec2::new(x as f64 * step - 2.0, y as f64 * step - 1.0);
        let w = OctahedralRectangular.solid_angle(0, low, low + step);
        let [r, g, b] = radiance(direction).map(|channel| f64::from(channel) * w);
        [r, g, b, w]
    };
    let worst = |mips: &OemMips, border: u32, level: u32| {
        let mut worst = 0.0_f64;
        for (layer, uv) in places().into_iter().flat_map(|uv| [(0, uv), (1, uv)]) {
            let expected = plane_look_up(&|point| texel(f64::from(layer), point), (inner, border), uv, level);
            worst =
                worst.max(distance(mips.look_up((layer, uv), f64::from(level), Addressing::Clamp), expected));
        }
        worst
    };
    let mips = OemMips::rectangular(inner, border, Weights::SolidAngle, radiance);
    assert_eq!(mips.greatest_level(), Some(3));
    for level in 0..=3 {
        let off = worst(&mips, border, level);
        assert!(off <= STORED, "level {level}: {off}");
    }
    let bare = OemMips::rectangular(inner, 0, Weights::SolidAngle, radiance);
    assert!(worst(&bare, 0, 0) > 0.1 && worst(&bare, 0, 2) > 0.1, "without a border");
    // The same direction from both layers: no step at the equator.
    for k in 0..100 {
        let angle = f64::from(k) * 0.0628 + 0.01;
        let [above, below] = [1e-9, -1e-9].map(|y| DVec3::new(angle.cos(), y, angle.sin()));
        for level in [0.0, 1.0, 2.5, 3.0] {
            let step = distance(mips.radiance(above, level), mips.radiance(below, level));
            assert!(step < 1e-6, "{angle}, level {level}: {step}");
        }
    }
}
