//! Contact sheets: the panorama, and lit spheres over the roughness ladder, labelled. 8-bit sRGB,
//! deterministic.

use super::exposure::{Exposure, Rolloff};
use super::faces::{draw_cross, draw_outlined, shrunk};
use crate::analysis::sun::{Brightest, Sun};
use crate::common::error::{Result, wrong};
use crate::common::parallel;
use crate::geometry::footprints::footprints_over;
use crate::light::chain::{Chain, Level};
use crate::light::chain_lookup::ChainLookup;
use crate::light::environment::{Environment, Layout, Rgb, exact_luminance};
use crate::sphere::equirect::equirect_from_direction;
use glam::{DVec2, DVec3};
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::page::page;
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{GAP, INK, LABEL, MARGIN, PAPER, SMALL, SOFT, TINY};
use octagloss_drawing::tone::srgb;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Pixels along an edge of a sphere's tile.
const TILE: u32 = 240;
/// Pixels along an edge of a face in the cross below it; a cross is as wide as a tile.
const FACE: u32 = TILE / 4;
/// Pixels between a tile and the stored level below it.
const BETWEEN: f64 = 10.0;
/// Pixels above a tile for its labels.
const LABELS: f64 = 24.0;
/// Most tiles in a row.
const COLUMNS: usize = 5;
/// Tiles that the panorama takes.
const PANORAMA: usize = 2;
/// Samples along an edge of a pixel.
const SAMPLES: u32 = 4;
/// Samples along an edge of a tile from which the exposure is chosen.
const METERED: u32 = 48;

/// Distance of the camera from the sphere in radii.
const CAMERA_DISTANCE: f64 = 3.4;
/// Tangent of half the angle of view: the sphere fills about four fifths of its tile.
const HALF_VIEW: f64 = 0.385;
/// Roughness of the backdrop; the nearest level is used.
const BACKDROP_ROUGHNESS: f64 = 0.35;
/// Angle between the brightest light and the direction back over the camera's left shoulder, in turns: the
/// lit side faces the camera, and its highlight stands beside the camera's own reflection.
const OVER_SHOULDER: f64 = 35.0 / 360.0;

/// Description of the chain on a contact sheet.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin<'a> {
    /// Name of the environment or its file.
    pub name: &'a str,
    /// Target of the bake; empty for none.
    pub target: &'a str,
    /// The environment; `None` shows the first level instead.
    pub source: Option<&'a Environment>,
    /// Directions of lights that were removed from it.
    pub removed: &'a [DVec3],
}

/// Draws the contact sheet of a chain: the panorama with its brightest light marked, and for each level a
/// mirror sphere, shaded by the trilinear look-up that engines use at the level's roughness, in front of a
/// blurred backdrop, with the level as stored below. The camera has the first removed light, else the
/// brightest one, else the brighter side behind its left shoulder.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for a chain without levels,
/// [`crate::common::error::Error::Limit`] for an environment whose panorama does not fit.
pub fn contact_sheet(chain: &Chain, origin: Origin<'_>, exposure: Exposure) -> Result<Scene> {
    let distance = |level: &Level| (level.roughness - BACKDROP_ROUGHNESS).abs();
    let nearest = (0..chain.levels.len())
        .min_by(|a, b| distance(&chain.levels[*a]).total_cmp(&distance(&chain.levels[*b])));
    let Some(backdrop) = nearest else {
        return wrong("a preview needs at least one level");
    };
    let source = match origin.source {
        Some(environment) => Cow::Borrowed(environment),
        None => Cow::Owned(Environment::new(chain.levels[0].layout, chain.levels[0].texels.clone())?),
    };
    let lights = marked(&source, origin.removed);
    let key = lights.first().map(|(_, direction)| *direction).or_else(|| brighter_side(&source));
    let camera = Camera::lit_by(key);
    let lookup = ChainLookup::new(&chain.levels);
    let seen = Seen { lookup, backdrop: backdrop as f64, camera };
    let metered: Vec<Rgb> = (0..chain.levels.len()).flat_map(|level| seen.metered(level as f64)).collect();
    let rolloff = Rolloff::new(&metered, exposure);

    let tile = f64::from(TILE);
    let stored = f64::from(stored_sides(chain.levels[0].layout).1);
    let cell = DVec2::new(tile + GAP, LABELS + tile + BETWEEN + stored + GAP);
    let cells = PANORAMA + chain.levels.len();
    let rows = cells.div_ceil(COLUMNS);
    let columns = cells.div_ceil(rows);
    let extent = DVec2::new(columns as f64, rows as f64) * cell - GAP;
    let caption = caption(origin, exposure, rolloff.ev);
    let (mut scene, body) = page(extent.x + 2.0 * MARGIN, extent.y, origin.name, &caption);
    let width = PANORAMA as f64 * cell.x - GAP;
    let frame = Frame::new(body.low, body.low + DVec2::new(width, cell.y - GAP));
    draw_panorama(&mut scene, frame, &source, &lights, &rolloff)?;
    for (index, level) in chain.levels.iter().enumerate() {
        let at = PANORAMA + index;
        let low = body.low + DVec2::new((at % columns) as f64, (at / columns) as f64) * cell;
        let head = format!("roughness {:.3}", level.roughness);
        labels(&mut scene, low, tile, &head, level.layout);
        let corner = low + DVec2::new(0.0, LABELS);
        scene.picture_at(corner, corner + tile, seen.sphere(index as f64, &rolloff));
        draw_stored(&mut scene, corner + DVec2::new(0.0, tile + BETWEEN), level, &rolloff);
    }
    Ok(scene)
}

/// Draws `head` and the texels of `layout` above a picture of `width` pixels.
fn labels(scene: &mut Scene, low: DVec2, width: f64, head: &str, layout: Layout) {
    let baseline = low.y + LABEL;
    scene.text(DVec2::new(low.x, baseline), head, LABEL, Anchor::Start, INK);
    scene.text(DVec2::new(low.x + width, baseline), &sides(layout), SMALL, Anchor::End, SOFT);
}

fn caption(Origin { target, .. }: Origin<'_>, exposure: Exposure, ev: f64) -> String {
    let target = if target.is_empty() { String::new() } else { format!("Target {target}. ") };
    let automatic = if exposure == Exposure::Auto { ", automatic" } else { "" };
    let ev = signed(ev, 2);
    format!(
        "{target}Exposure {ev}\u{a0}EV{automatic}; highlights are compressed. Each sphere mirrors the light \
         at one roughness, looked up as engines do; the level as stored stands below."
    )
}

/// `value` with its sign and `digits` after the point.
fn signed(value: f64, digits: usize) -> String {
    format!("{value:+.digits$}").replace('-', "\u{2212}")
}

/// Texels of a map.
fn sides(layout: Layout) -> String {
    let (width, height) = layout.sides();
    match layout {
        Layout::Cube { size } => format!("6 \u{d7} {size}\u{b2}"),
        _ => format!("{width} \u{d7} {height}"),
    }
}

/// Stacks sheets.
pub fn stacked(sheets: &[Scene]) -> Bitmap {
    let width = sheets.iter().map(|sheet| sheet.width).max().unwrap_or(1);
    let height: u32 = sheets.iter().map(|sheet| sheet.height).sum();
    let mut all = Bitmap::filled(width, height.max(1), PAPER);
    let mut top = 0;
    for sheet in sheets {
        all.put(&sheet.picture(), 0, top);
        top += i64::from(sheet.height);
    }
    all
}

/// Names and directions of the lights that a sheet marks; removed lights first.
fn marked(source: &Environment, removed: &[DVec3]) -> Vec<(&'static str, DVec3)> {
    let sun = Sun::find(source)
        .map(|sun| (if sun.kind == Brightest::Sun { "sun" } else { "brightest light" }, sun.direction));
    removed.iter().map(|direction| ("removed light", *direction)).chain(sun).collect()
}

/// Least excess of the brighter side of an environment, as a share of all its light.
const LOPSIDED: f64 = 0.02;

/// Horizontal direction to the brighter side of `source`; `None` for even light.
fn brighter_side(source: &Environment) -> Option<DVec3> {
    let (mut sum, mut all) = (DVec3::ZERO, 0.0);
    source.for_each_texel(|direction, solid_angle, rgb| {
        let energy = solid_angle * exact_luminance(rgb);
        all += energy;
        sum += energy * direction;
    });
    let side = DVec3::new(sum.x, 0.0, sum.z);
    (side.length() > LOPSIDED * all).then_some(side)
}

/// A camera at the horizon that looks at a sphere around the origin.
#[derive(Clone, Copy)]
struct Camera {
    /// Unit vectors of its view and to its right.
    ahead: DVec3,
    right: DVec3,
}

impl Camera {
    /// Looks so that `light` is behind its left shoulder; along +X without one.
    fn lit_by(light: Option<DVec3>) -> Self {
        let azimuth = light.map_or(0.0, |light| light.z.atan2(light.x) + TAU * (0.5 - OVER_SHOULDER));
        let (sin, cos) = azimuth.sin_cos();
        Self { ahead: DVec3::new(cos, 0.0, sin), right: DVec3::new(-sin, 0.0, cos) }
    }

    /// Unit vector through `x`, `y` in [-1, 1], to the right and down.
    fn ray(self, x: f64, y: f64) -> DVec3 {
        (self.ahead + x * HALF_VIEW * self.right - y * HALF_VIEW * DVec3::Y).normalize()
    }

    /// Direction of the sphere's mirror reflection of `ray`; `None` beside the sphere.
    fn reflected(self, ray: DVec3) -> Option<DVec3> {
        let camera = -CAMERA_DISTANCE * self.ahead;
        let along = -camera.dot(ray);
        let discriminant = 1.0 - (camera + along * ray).length_squared();
        let normal = camera + (along - discriminant.max(0.0).sqrt()) * ray;
        (discriminant >= 0.0).then(|| ray - 2.0 * ray.dot(normal) * normal)
    }
}

/// The camera's view: a sphere before a backdrop.
struct Seen<'a> {
    lookup: ChainLookup<'a>,
    /// Level of detail of the backdrop.
    backdrop: f64,
    camera: Camera,
}

impl Seen<'_> {
    /// Reflections of the sphere at level of detail `lod`, for the choice of the exposure.
    fn metered(&self, lod: f64) -> Vec<Rgb> {
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(METERED) * 2.0 - 1.0;
        let rays = (0..METERED).flat_map(|j| (0..METERED).map(move |i| (place(i), place(j))));
        let reflected = rays.filter_map(|(x, y)| self.camera.reflected(self.camera.ray(x, y)));
        reflected.map(|direction| self.lookup.read(direction, lod).map(|c| c as f32)).collect()
    }

    /// Renders the tile of the sphere at level of detail `lod`.
    fn sphere(&self, lod: f64, rolloff: &Rolloff) -> Bitmap {
        let side = f64::from(TILE * SAMPLES);
        let place = |k: u32| (f64::from(k) + 0.5) / side * 2.0 - 1.0;
        let radiance = |x: f64, y: f64| {
            let ray = self.camera.ray(x, y);
            let seen = match self.camera.reflected(ray) {
                Some(direction) => self.lookup.read(direction, lod),
                None => self.lookup.read(ray, self.backdrop),
            };
            seen.map(|c| c as f32)
        };
        let pixel = |i: u32, j: u32| {
            // Tone-map before averaging, so that one bright sample does not dominate a pixel.
            let mut sum = [0.0; 3];
            for (y, x) in (0..SAMPLES).flat_map(|y| (0..SAMPLES).map(move |x| (y, x))) {
                let shown = rolloff.shown(radiance(place(i * SAMPLES + x), place(j * SAMPLES + y)));
                sum = std::array::from_fn(|c| sum[c] + shown[c]);
            }
            srgb(sum.map(|c| c / (SAMPLES * SAMPLES) as f32))
        };
        let rows = parallel::map(0..TILE, |j| (0..TILE).map(|i| pixel(i, j)).collect::<Vec<_>>());
        Bitmap::new(TILE, TILE, rows.concat())
    }
}

/// Draws `level` as stored, at `low`: a cube as a cross, other maps as one picture.
fn draw_stored(scene: &mut Scene, low: DVec2, level: &Level, rolloff: &Rolloff) {
    let colour = |texel: Rgb| srgb(rolloff.shown(texel));
    if let Layout::Cube { .. } = level.layout {
        return draw_cross(scene, low, FACE, level, colour);
    }
    let picture = shrunk(&level.texels, level.layout.sides(), stored_sides(level.layout), colour);
    draw_outlined(scene, low, picture);
}

/// Width and height in pixels of a level as stored.
const fn stored_sides(layout: Layout) -> (u32, u32) {
    match layout {
        Layout::Cube { .. } => (4 * FACE, 3 * FACE),
        Layout::Panorama { .. } => (TILE, TILE / 2),
        Layout::Octahedral { .. } => (3 * FACE, 3 * FACE),
    }
}

/// Draws the panorama of `source` into `frame`, marks `lights` and lists them below.
fn draw_panorama(
    scene: &mut Scene,
    frame: Frame,
    source: &Environment,
    lights: &[(&str, DVec3)],
    rolloff: &Rolloff,
) -> Result<()> {
    let width = frame.extent().x;
    labels(scene, frame.low, width, "environment", source.layout());
    let (columns, rows) = (width as u32, width as u32 / 2);
    let texels = footprints_over(source, Layout::Panorama { width: columns, height: rows })?;
    let pixels =
        Bitmap::from_fn(columns, rows, |i, j| srgb(rolloff.shown(texels[(j * columns + i) as usize])));
    let low = frame.low + DVec2::new(0.0, LABELS);
    draw_outlined(scene, low, pixels);
    let bounds = Frame::new(low, low + DVec2::new(width, f64::from(rows)));
    for (name, direction) in lights {
        let (u, v) = equirect_from_direction(*direction);
        let at = (low + DVec2::new(u, v) * bounds.extent()).clamp(low + RING, bounds.high - RING);
        for (stroke, colour) in [(4.5, INK), (2.0, PAPER)] {
            scene.circle(at, RING, stroke, colour);
        }
        scene.label(at, name, TINY, RING + 6.0, &bounds);
    }
    let degrees = |radians: f64| signed(radians.to_degrees(), 1);
    let mut lines: Vec<String> = (lights.iter().take(LISTED))
        .map(|(name, direction)| {
            let azimuth = degrees(direction.z.atan2(direction.x));
            let elevation = degrees(direction.y.atan2(direction.x.hypot(direction.z)));
            format!("{name}: azimuth {azimuth}\u{b0}, elevation {elevation}\u{b0}")
        })
        .collect();
    let more = lights.len().saturating_sub(LISTED);
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    let mut baseline = bounds.high.y + BETWEEN + SMALL;
    for line in lines {
        baseline = scene.paragraph(DVec2::new(frame.low.x, baseline), &line, SMALL, width);
    }
    Ok(())
}

/// Most lights listed below the panorama.
const LISTED: usize = 4;
/// Radius of the rings around lights, in pixels.
const RING: f64 = 9.0;
