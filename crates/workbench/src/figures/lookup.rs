//! Draws look-ups in octahedral maps on the sphere, without and with each remedy of the octahedron paper's
//! section 4.2.

use super::globe::Globe;
use glam::{DVec2, DVec3};
use octagloss_core::analysis::delivered::even_directions;
use octagloss_core::files::image::oem_mips::{Addressing, OemMips, Weights};
use octagloss_core::light::environment::Rgb;
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::sphere::octahedral::{direction_from_oct, texel_centre, texel_solid_angle};
use octagloss_core::sphere::oem_lookup::{level_of_cell, quadratic_level};
use octagloss_drawing::page::{WIDTH, page};
use octagloss_drawing::scene::Anchor;
use octagloss_drawing::style::{Colour, INK, LABEL, PAPER, mix};
use octagloss_plot::figure::Figure;

/// Shows the lower hemisphere, where the unfolding cuts along x = 0 and z = 0.
const BELOW: DVec3 = DVec3::new(0.45, -1.0, 0.75);

/// Shows the equator, where the rectangular layout changes layers.
const BESIDE: DVec3 = DVec3::new(1.0, 0.35, 0.55);

/// Blocks of two colours, 1/`count` wide and tinted by the direction, so that no two directions look alike.
fn blocks(count: f64, direction: DVec3) -> Rgb {
    let block = (direction * count + DVec3::new(0.41, 0.13, 0.77)).floor();
    let is_odd = (block.x + block.y + block.z).rem_euclid(2.0) == 1.0;
    let colour = if is_odd { [0.93, 0.72, 0.24] } else { [0.08, 0.24, 0.50] };
    let DVec3 { x, z, .. } = direction;
    let tint = [0.6 + 0.4 * x, 0.6 + 0.4 * z, 0.6 - 0.4 * x];
    std::array::from_fn(|c| (colour[c] * tint[c]) as f32)
}

/// Light that is brightest in the middle of the octants.
fn octants(direction: DVec3) -> Rgb {
    [(0.05 + 5.0 * (direction.x * direction.y * direction.z).abs()) as f32; 3]
}

/// The octahedral map of `radiance`.
fn map_of(inner: u32, border: u32, radiance: impl Fn(DVec3) -> Rgb) -> Oem {
    let texels = (0..inner * inner).map(|k| {
        let (x, y) = (k % inner, k / inner);
        let w = texel_solid_angle(inner, x, y);
        let [r, g, b] = radiance(direction_from_oct(texel_centre(inner, x, y)));
        [r, g, b, 1.0].map(|value| (f64::from(value) * w) as f32)
    });
    Oem::from_square(OemSize { inner, border }, texels.collect())
}

/// The display colour of `radiance` in [0, 1], with the display's curve.
fn shown(radiance: [f64; 3]) -> Colour {
    radiance.map(|value| (value.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0).round() as u8)
}

/// Label of a sphere, and the colour of each direction in it.
type Panel<'a> = (&'a str, &'a (dyn Fn(&Globe, DVec3) -> Colour + Sync));

/// Two spheres seen from `eye`, with a label below each and the colour of each direction.
fn pair(title: &str, caption: &str, eye: DVec3, panels: [Panel<'_>; 2]) -> Figure {
    let (mut scene, body) = page(WIDTH, 470.0, title, caption);
    let radius = 205.0;
    for (k, (label, colour)) in panels.into_iter().enumerate() {
        let centre =
            DVec2::new(body.low.x + body.extent().x * (0.25 + 0.5 * k as f64), body.low.y + radius + 4.0);
        let globe = Globe::new(centre, radius, eye);
        globe.fill(&mut scene, |direction| colour(&globe, direction));
        globe.axes(&mut scene);
        scene.text(DVec2::new(centre.x, body.high.y - 6.0), label, LABEL, Anchor::Middle, INK);
    }
    Figure::new(title.to_owned(), caption.to_owned(), scene)
}

/// Pixels along the diameter of the spheres of [`level`].
const PIXELS: u32 = 110;

pub(super) fn level() -> Figure {
    let title = "Quadratic layout: the mip level of the mirrored cell";
    let caption = "A map of 256 texels with a border of 16, seen from below with 110 pixels across, at the \
                   level of equation 4 of Engelhardt and Dachsbacher 2008. Left: a pixel's cell that \
                   crosses x\u{a0}=\u{a0}0 or z\u{a0}=\u{a0}0 spans two far places of the texture, and its \
                   pixel shows the coarsest level. Right: the smaller level of the cell and of its \
                   reflection at y\u{a0}=\u{a0}0 (figure 3 of the paper).";
    let mips = OemMips::quadratic(&map_of(256, 16, |d| blocks(3.5, d)), Weights::SolidAngle);
    let panel = |globe: &Globe, direction: DVec3, level: &dyn Fn([DVec3; 3], u32) -> f64| {
        let cell = globe.cell(direction, PIXELS);
        shown(mips.radiance(cell[0], level(cell, mips.inner())))
    };
    let without = |globe: &Globe, direction: DVec3| panel(globe, direction, &level_of_cell);
    let with = |globe: &Globe, direction: DVec3| panel(globe, direction, &quadratic_level);
    pair(title, caption, BELOW, [("level of the cell", &without), ("with the mirrored cell", &with)])
}

pub(super) fn border() -> Figure {
    let title = "Quadratic layout: the safety border";
    let caption = "A map of 64 texels at mip level 2, seen from below. Left: no border and wrap-around \
                   access, which reads the opposite edge. Right: a border of 8 texels, which shows the \
                   texels that adjoin every edge on the sphere (figure 4 of Engelhardt and Dachsbacher \
                   2008).";
    let bare = OemMips::quadratic(&map_of(64, 0, |d| blocks(1.6, d)), Weights::SolidAngle);
    let safe = OemMips::quadratic(&map_of(64, 8, |d| blocks(1.6, d)), Weights::SolidAngle);
    let without = |_: &Globe, d: DVec3| shown(bare.look_up(bare.place(d), 2.0, Addressing::Repeat));
    let with = |_: &Globe, d: DVec3| shown(safe.look_up(safe.place(d), 2.0, Addressing::Clamp));
    pair(title, caption, BELOW, [("wrap-around access", &without), ("with a safety border", &with)])
}

pub(super) fn greatest() -> Figure {
    let title = "Quadratic layout: the greatest correct mip level";
    let caption = "Mip level 5 of two textures of 256 texels, border included, seen from below. Left: 252 \
                   texels and a border of 2, whose greatest correct level is 2: texels of level 5 reach \
                   beyond the border and are clamped. Right: 224 texels and a border of 16, which serves \
                   level 5.";
    let narrow = OemMips::quadratic(&map_of(252, 2, |d| blocks(1.2, d)), Weights::SolidAngle);
    let wide = OemMips::quadratic(&map_of(224, 16, |d| blocks(1.2, d)), Weights::SolidAngle);
    let without = |_: &Globe, d: DVec3| shown(narrow.look_up(narrow.place(d), 5.0, Addressing::Clamp));
    let with = |_: &Globe, d: DVec3| shown(wide.look_up(wide.place(d), 5.0, Addressing::Clamp));
    pair(
        title,
        caption,
        BELOW,
        [("border of 2, greatest level 2", &without), ("border of 16, greatest level 5", &with)],
    )
}

/// The error of a mean shown in full colour.
const FULL_ERROR: f64 = 0.2;

pub(super) fn weights() -> Figure {
    let title = "Mip levels: weights by solid angle";
    let caption = "Relative error of the texels of mip level 5 of 128 texels, against the mean of 400,000 \
                   directions: blue is 20\u{a0}% too dark, white is right, red is 20\u{a0}% too bright. The \
                   light is brightest in the middle of the octants. Left: equal weights, as \
                   ordinary mip maps have. A texel at a face's centre covers 5.2 times the solid angle of \
                   one at a vertex. Right: weights by solid angle.";
    let map = map_of(128, 0, octants);
    let [equal, right] =
        [Weights::Equal, Weights::SolidAngle].map(|weights| OemMips::quadratic(&map, weights));
    let (level, count) = (5, 400_000);
    let side = 128 >> level;
    let index = |mips: &OemMips, direction: DVec3| {
        let (_, uv) = mips.place(direction);
        let at = ((uv + 1.0) * 0.5 * f64::from(side))
            .floor()
            .clamp(DVec2::ZERO, DVec2::splat(f64::from(side - 1)));
        (at.y * f64::from(side) + at.x) as usize
    };
    // Directions of equal solid angle.
    let mut sums = vec![[0.0; 2]; (side * side) as usize];
    for direction in even_directions(count) {
        let sum = &mut sums[index(&right, direction)];
        *sum = [sum[0] + f64::from(octants(direction)[0]), sum[1] + 1.0];
    }
    let panel = |mips: &OemMips, direction: DVec3| {
        let texel = index(mips, direction);
        let exact = sums[texel][0] / sums[texel][1];
        let error = f64::from(mips.levels()[level].texels[texel][0]) / exact - 1.0;
        let full = if error > 0.0 { [178, 24, 43] } else { [33, 102, 172] };
        mix(PAPER, full, (error.abs() / FULL_ERROR).min(1.0))
    };
    let without = |_: &Globe, direction: DVec3| panel(&equal, direction);
    let with = |_: &Globe, direction: DVec3| panel(&right, direction);
    pair(title, caption, BESIDE, [("equal weights", &without), ("weighted by solid angle", &with)])
}

pub(super) fn rectangular() -> Figure {
    let title = "Rectangular layout: one array layer per hemisphere";
    let caption = "Layers of 64 texels at mip level 2, seen from the side. Left: clamped layers without a \
                   border; the hemispheres do not meet at the equator. Right: a border of 8 texels, which \
                   shows the other layer's texels.";
    let [bare, safe] =
        [0, 8].map(|border| OemMips::rectangular(64, border, Weights::SolidAngle, |d| blocks(1.6, d)));
    let without = |_: &Globe, d: DVec3| shown(bare.look_up(bare.place(d), 2.0, Addressing::Clamp));
    let with = |_: &Globe, d: DVec3| shown(safe.look_up(safe.place(d), 2.0, Addressing::Clamp));
    pair(title, caption, BESIDE, [("no border", &without), ("with a safety border", &with)])
}
