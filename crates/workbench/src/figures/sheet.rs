//! Draws a map's components side by side, as placed by `convert`, with axes and labels.

use super::axes::AXES;
use glam::{DVec2, DVec3};
use octagloss_core::common::parallel;
use octagloss_core::sphere::grid::Grid;
use octagloss_core::sphere::map::{Component, Place, SphereMap};
use octagloss_core::sphere::registry::NamedMap;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::font::text_width;
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{Colour, FAINT, INK, SMALL, TINY, rgb};
use octagloss_plot::look::{LATITUDE, LONGITUDE, OCTANTS, OUTSIDE};
use octagloss_plot::ticks::rectangle_ticks;
use std::f64::consts::TAU;

/// Margin in pixels around every component, for its label and ticks.
const BORDER: u32 = 19;

/// A map's components in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheet {
    row: &'static NamedMap,
    /// Grid with one texel per pixel.
    pub(super) grid: Grid,
    origin: DVec2,
}

impl Sheet {
    /// The largest sheet of `row` that fits `most` pixels.
    pub(super) fn fitting(row: &'static NamedMap, most: DVec2) -> Self {
        let of_size = |size: u32| {
            let grid = Grid::new(row.map(), size).expect("a size of a figure");
            Self { row, grid, origin: DVec2::ZERO }
        };
        let sizes = (1..=most.max_element() as u32).rev().map(of_size);
        sizes.into_iter().find(|sheet| sheet.extent().cmple(most).all()).unwrap_or_else(|| of_size(1))
    }

    /// Width and height in pixels.
    pub(super) fn extent(&self) -> DVec2 {
        let ends = (0..self.map().components()).map(|k| {
            let frame = self.frame(k);
            frame.high - self.origin + f64::from(BORDER)
        });
        ends.fold(DVec2::ZERO, DVec2::max)
    }

    /// Origin of `component` in cells: as in pictures of the map, but with the cube's row split in two.
    fn cell(&self, component: u32) -> [u32; 2] {
        if self.row.name == "cube" {
            return [component % 3, component / 3];
        }
        self.map().component(component).at
    }

    /// One-based rank of the column (`axis` 0) or row (1) where `component` begins, among all starting
    /// columns or rows.
    fn rank(&self, component: u32, axis: usize) -> u32 {
        let begins = |place: &u32| (0..self.map().components()).any(|k| self.cell(k)[axis] == *place);
        (0..=self.cell(component)[axis]).filter(begins).count() as u32
    }

    /// Moves the sheet to the top centre of `frame`.
    pub(super) fn placed(self, frame: &Frame) -> Self {
        let left = (frame.low.x + frame.high.x - self.extent().x) / 2.0;
        Self { origin: DVec2::new(left, frame.low.y).round(), ..self }
    }

    fn map(&self) -> &'static dyn SphereMap {
        self.row.map()
    }

    /// Rectangle of `component`.
    pub(super) fn frame(&self, component: u32) -> Frame {
        let cell = self.cell(component);
        let start = [0, 1].map(|axis| {
            f64::from(cell[axis] * self.grid.size() + BORDER * (2 * self.rank(component, axis) - 1))
        });
        let low = self.origin + DVec2::from(start);
        Frame::new(low, low + DVec2::from(self.grid.sides(component).map(f64::from)))
    }

    /// Pixel position of `place`.
    pub(super) fn at(&self, place: Place) -> DVec2 {
        let component = self.map().component(place.component);
        let low = self.frame(place.component).low;
        low + (place.uv - component.low) / self.grid.step(&component)
    }

    /// Fills domains with `colour` of component and coordinates, and the rest of the rectangles with one
    /// colour.
    pub(super) fn fill(
        &self,
        scene: &mut Scene,
        fineness: u32,
        colour: impl Fn(u32, DVec2) -> Colour + Sync,
    ) {
        let map = self.map();
        for component in 0..map.components() {
            let [width, height] = self.grid.sides(component).map(|side| side * fineness);
            let pixel = |index: usize| {
                let (x, y) = (index as u32 % width, index as u32 / width);
                let at = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(fineness);
                let uv = self.grid.uv(component, at.x, at.y);
                if map.contains(component, uv) { colour(component, uv) } else { OUTSIDE }
            };
            let pixels = Bitmap::new(width, height, parallel::values((width * height) as usize, pixel));
            let frame = self.frame(component);
            scene.picture_at(frame.low, frame.high, pixels);
        }
    }

    /// Fills every domain with the colours of octants.
    pub(super) fn fill_octants(&self, scene: &mut Scene) {
        let map = self.map();
        self.fill(scene, 2, |component, uv| {
            let d = map.direction(component, uv);
            rgb(OCTANTS[octant(d)])
        });
    }

    /// Draws outlines of rectangles and domains, ticks, and component names.
    pub(super) fn frames(&self, scene: &mut Scene) {
        let map = self.map();
        let components: Vec<_> = (0..map.components()).map(|k| map.component(k)).collect();
        for (component, k) in components.iter().zip(0..) {
            let frame = self.frame(k);
            scene.outline(frame.corners(), 1.0, FAINT);
            let rim: Vec<DVec2> =
                boundary(map, k, 240).into_iter().map(|uv| self.at(Place { component: k, uv })).collect();
            scene.outline(rim, 1.4, INK);
            let own = self.cell(k);
            let mut cells = (0..map.components()).map(|other| self.cell(other));
            let below = cells.clone().any(|other| other[0] == own[0] && other[1] > own[1]);
            let left = cells.any(|other| other[1] == own[1] && other[0] < own[0]);
            // Components of other extents have their own ticks.
            let is_like = |other: &Component| other.low == component.low && other.high == component.high;
            let alike = components.iter().all(is_like);
            let sides = [!below || !alike, !left || !alike];
            rectangle_ticks(scene, &frame, component.low, component.high, sides);
            let name = component_name(self.row.name, k);
            if !name.is_empty() {
                scene.text(frame.low + DVec2::new(9.0, -6.0), &name, SMALL, Anchor::Start, INK);
            }
        }
    }

    /// Draws parallels and meridians every `degrees`; the equator and the planes x = 0 and z = 0 are thick.
    pub(super) fn graticule(&self, scene: &mut Scene, degrees: i32) {
        // Offset slightly from the planes, where maps are cut.
        let hair = 1e-9;
        let point = |latitude: f64, longitude: f64| {
            let ((up, across), (sin, cos)) = (latitude.sin_cos(), longitude.sin_cos());
            DVec3::new(across * cos, up, across * sin)
        };
        for longitude in (0..360).filter(|longitude| longitude % degrees == 0) {
            let width = if longitude % 90 == 0 { 1.5 } else { 0.7 };
            let longitude = f64::from(longitude).to_radians() + hair;
            let quarter = TAU / 4.0 - 1e-6;
            let meridian = |latitude| point(latitude, longitude);
            self.curve(scene, meridian, [-quarter, quarter], 180, width, LONGITUDE);
        }
        for latitude in (-89..90).rev().filter(|latitude| latitude % degrees == 0) {
            let width = if latitude == 0 { 1.5 } else { 0.7 };
            let latitude = f64::from(latitude).to_radians() + hair;
            let parallel = |longitude| point(latitude, longitude);
            self.curve(scene, parallel, [hair, TAU + hair], 360, width, LATITUDE);
        }
    }

    /// Draws the curve of `point` over `range` in `steps` pieces, split where it jumps on the sheet.
    pub(super) fn curve(
        &self,
        scene: &mut Scene,
        point: impl Fn(f64) -> DVec3,
        range: [f64; 2],
        steps: u32,
        width: f64,
        colour: Colour,
    ) {
        let place = |t: f64| self.map().locate(point(t));
        let at = |k: u32| range[0] + (range[1] - range[0]) * f64::from(k) / f64::from(steps);
        // Exceeds any step of a smooth curve.
        let far = 0.06 * self.extent().max_element();
        let apart = |a: Place, b: Place| a.component != b.component || self.at(a).distance(self.at(b)) > far;
        let mut line = vec![self.at(place(at(0)))];
        for k in 1..=steps {
            let (mut from, mut to) = (at(k - 1), at(k));
            if apart(place(from), place(to)) {
                // Exit and entry points of the jump.
                for _ in 0..40 {
                    let middle = (from + to) / 2.0;
                    if nearer_first(self, place(from), place(middle), place(to)) {
                        from = middle;
                    } else {
                        to = middle;
                    }
                }
                // At a singular direction the ends are arbitrary; leave a gap of one step.
                let is_near = |a: DVec2, b: DVec2| a.distance(b) <= far;
                let (end, start) = (self.at(place(from)), self.at(place(to)));
                if line.last().is_some_and(|last| is_near(*last, end)) {
                    line.push(end);
                }
                scene.line(std::mem::take(&mut line), width, colour);
                if is_near(start, self.at(place(at(k)))) {
                    line.push(start);
                }
            }
            line.push(self.at(place(at(k))));
        }
        scene.line(line, width, colour);
    }

    /// Draws dots at the six axes, at every position of each.
    pub(super) fn axes(&self, scene: &mut Scene) {
        for (axis, name) in AXES {
            let places = self.places(axis);
            // A singular direction maps to a line.
            if places.len() > 4 {
                let frame = self.frame(places[0].component);
                let middle = (frame.low + frame.high) / 2.0;
                let distance = |place: &Place| self.at(*place).distance(middle);
                let nearest = places.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                let at = self.at(*nearest.expect("more than four"));
                scene.label(at, &format!("{name}: the whole line"), TINY, 9.0, &frame);
                continue;
            }
            for place in places {
                let frame = self.frame(place.component);
                scene.point(self.at(place), name, &frame);
            }
        }
    }

    /// Every position that directions around `direction` approach.
    fn places(&self, direction: DVec3) -> Vec<Place> {
        let across = direction.any_orthonormal_vector();
        let mut places: Vec<Place> = Vec::new();
        for k in 0..24 {
            let (sin, cos) = (TAU * (f64::from(k) + 0.02) / 24.0).sin_cos();
            let near = direction + (across * cos + direction.cross(across) * sin) * 1e-7;
            let place = self.map().locate(near);
            let known = |other: &Place| {
                other.component == place.component && self.at(*other).distance(self.at(place)) < 12.0
            };
            if !places.iter().any(known) {
                places.push(place);
            }
        }
        places
    }

    /// Draws the names of the eight octants, centred in their parts of a one-component map.
    pub(super) fn octant_names(&self, scene: &mut Scene) {
        for k in 0..8_u32 {
            let sign = |bit: u32| if k & bit == 0 { 1.0 } else { -1.0 };
            let direction = DVec3::new(sign(1), sign(2), sign(4));
            let text =
                |bit: u32, name: &str| format!("{}{name}", if k & bit == 0 { "+" } else { "\u{2212}" });
            let name = format!("{} {} {}", text(1, "X"), text(2, "Y"), text(4, "Z"));
            let at = self.at(self.map().locate(direction));
            let half = DVec2::new(text_width(&name, TINY) / 2.0 + 2.0, 0.55 * TINY);
            scene.polygon(Frame::new(at - half, at + half).corners(), rgb(OCTANTS[k as usize]));
            scene.centred(at, &name, TINY, INK);
        }
    }
}

/// Whether `middle` is on the side of `a` rather than `b`.
fn nearer_first(sheet: &Sheet, a: Place, middle: Place, b: Place) -> bool {
    match (a.component == middle.component, b.component == middle.component) {
        (true, false) => true,
        (false, true) => false,
        _ => sheet.at(a).distance(sheet.at(middle)) < sheet.at(b).distance(sheet.at(middle)),
    }
}

/// Sign bits of `d`: bit 0 is set where x is negative, bit 1 for y, bit 2 for z.
pub(super) fn octant(d: DVec3) -> usize {
    usize::from(d.x < 0.0) | usize::from(d.y < 0.0) << 1 | usize::from(d.z < 0.0) << 2
}

/// Outline of the domain of `component`, clockwise, with `steps` points per side of its rectangle.
pub(super) fn boundary(map: &dyn SphereMap, component: u32, steps: u32) -> Vec<DVec2> {
    let rectangle = map.component(component);
    let middle = (rectangle.low + rectangle.high) / 2.0;
    let corners = Frame::new(rectangle.low, rectangle.high).corners();
    let mut rim = Vec::new();
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        for k in 0..steps {
            let outer = from.lerp(to, f64::from(k) / f64::from(steps));
            // Domains are star-shaped around their centre.
            let (mut inside, mut outside) = (0.0, 1.0);
            if map.contains(component, middle.lerp(outer, 1.0 - 1e-12)) {
                rim.push(outer);
                continue;
            }
            for _ in 0..50 {
                let share = (inside + outside) / 2.0;
                let is_inside = map.contains(component, middle.lerp(outer, share));
                *(if is_inside { &mut inside } else { &mut outside }) = share;
            }
            rim.push(middle.lerp(outer, inside));
        }
    }
    rim.push(rim[0]);
    rim
}

/// The name of a component of the map `map`; empty if there is only one.
fn component_name(map: &str, component: u32) -> String {
    let k = component as usize;
    match map {
        "cube" => format!("{k}: {}", AXES[k].1),
        "tennis-ball" => ["C\u{2081}", "C\u{2082}"][k].to_owned(),
        "polar-capped" | "polar-capped-conformal" => ["band", "cap +Y", "cap \u{2212}Y"][k].to_owned(),
        "dual-equidistant" | "dual-paraboloid" => ["0: +Z", "1: \u{2212}Z"][k].to_owned(),
        "healpix" | "rhombic-dodecahedron" => k.to_string(),
        _ => String::new(),
    }
}
