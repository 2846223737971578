//! Draws the sphere in orthographic projection.

use super::axes::AXES;
use super::sheet::boundary;
use glam::{DVec2, DVec3};
use octagloss_core::common::parallel;
use octagloss_core::sphere::map::SphereMap;
use octagloss_core::sphere::oem_lookup::Cell;
use octagloss_drawing::bitmap::Bitmap;
use octagloss_drawing::scene::{Frame, Scene};
use octagloss_drawing::style::{Colour, INK, PAPER};
use octagloss_plot::look::THIN;

/// Supersampling factor along each axis.
const FINENESS: u32 = 2;

/// A view of the unit sphere: orthographic, +Y up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Globe {
    pub(super) centre: DVec2,
    pub(super) radius: f64,
    right: DVec3,
    up: DVec3,
    eye: DVec3,
}

/// Eye direction of the front view: +X to the right, +Z to the left, from above.
pub(super) const FRONT: DVec3 = DVec3::new(1.0, 0.9, 1.5);

impl Globe {
    /// The sphere around `centre` in pixels, seen from the direction `eye`.
    pub(super) fn new(centre: DVec2, radius: f64, eye: DVec3) -> Self {
        let eye = eye.normalize();
        let right = DVec3::Y.cross(eye).normalize();
        Self { centre, radius, right, up: eye.cross(right), eye }
    }

    /// The pixel that shows `direction`, with its neighbours to the right and below, in a picture of `count`
    /// pixels along the diameter: the nearest one inwards if the pixel's centre is outside the sphere.
    pub(super) fn cell(&self, direction: DVec3, count: u32) -> Cell {
        let step = 2.0 / f64::from(count);
        let mut pixel = (DVec2::new(direction.dot(self.right), direction.dot(self.up)) / step).floor();
        while ((pixel + 0.5) * step).length() >= 1.0 {
            let centre = pixel + 0.5;
            if centre.x.abs() > centre.y.abs() {
                pixel.x -= centre.x.signum();
            } else {
                pixel.y -= centre.y.signum();
            }
        }
        let towards = |x: f64, y: f64| {
            let at = (pixel + DVec2::new(x, y) + 0.5) * step;
            // Neighbours beyond the rim are at the rim.
            let at = at / at.length().max(1.0);
            self.right * at.x + self.up * at.y + self.eye * (1.0 - at.length_squared()).max(0.0).sqrt()
        };
        [towards(0.0, 0.0), towards(1.0, 0.0), towards(0.0, -1.0)]
    }

    /// Projects `point`; also returns whether it is in front of the centre.
    pub(super) fn place(&self, point: DVec3) -> (DVec2, bool) {
        let across = DVec2::new(point.dot(self.right), -point.dot(self.up));
        (self.centre + across * self.radius, point.dot(self.eye) >= 0.0)
    }

    /// Depth of `point` towards the eye.
    pub(super) fn depth(&self, point: DVec3) -> f64 {
        point.dot(self.eye)
    }

    /// Fills the visible half with `colour` of each direction.
    pub(super) fn fill(&self, scene: &mut Scene, colour: impl Fn(DVec3) -> Colour + Sync) {
        let side = (2.0 * self.radius * f64::from(FINENESS)).ceil() as u32;
        let half = f64::from(side) / f64::from(2 * FINENESS);
        let pixel = |index: usize| {
            let (i, j) = (index as u32 % side, index as u32 / side);
            let at = (DVec2::new(f64::from(i), f64::from(j)) + 0.5) / f64::from(FINENESS) - half;
            let (x, y) = (at.x / self.radius, -at.y / self.radius);
            let squared = 1.0 - x * x - y * y;
            if squared < 0.0 {
                return PAPER;
            }
            colour(self.right * x + self.up * y + self.eye * squared.sqrt())
        };
        let pixels = Bitmap::new(side, side, parallel::values((side * side) as usize, pixel));
        scene.picture_at(self.centre - half, self.centre + half, pixels);
        scene.circle(self.centre, self.radius, 1.2, INK);
    }

    /// Fills the visible half with `colour` of each direction, with the rims of `map`, planes and axes.
    pub(super) fn show(
        &self,
        scene: &mut Scene,
        map: &dyn SphereMap,
        colour: impl Fn(DVec3) -> Colour + Sync,
    ) {
        self.fill(scene, colour);
        // Great circles of the planes x = 0, y = 0 and z = 0.
        for (a, b) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
            let circle: Vec<DVec3> = (0..=240)
                .map(|k| {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 240.0).sin_cos();
                    a * cos + b * sin
                })
                .collect();
            self.line(scene, &circle, 0.8, THIN);
        }
        for component in 0..map.components() {
            let rim: Vec<DVec3> =
                boundary(map, component, 400).into_iter().map(|uv| map.direction(component, uv)).collect();
            self.line(scene, &rim, 1.4, INK);
        }
        self.axes(scene);
    }

    /// The visible parts of the line through `points` of the sphere.
    pub(super) fn line(&self, scene: &mut Scene, points: &[DVec3], width: f64, colour: Colour) {
        for piece in self.pieces(points, true) {
            scene.line(piece, width, colour);
        }
    }

    /// Parts of the line through `points` on the visible or the hidden side.
    pub(super) fn pieces(&self, points: &[DVec3], visible: bool) -> Vec<Vec<DVec2>> {
        let places: Vec<(DVec2, bool)> = points.iter().map(|point| self.place(*point)).collect();
        let pieces = places.chunk_by(|a, b| a.1 == b.1).filter(|piece| piece[0].1 == visible);
        pieces.map(|piece| piece.iter().map(|(at, _)| *at).collect()).collect()
    }

    /// Dots and names of the axes on the visible side.
    pub(super) fn axes(&self, scene: &mut Scene) {
        let bounds = Frame::new(self.centre - self.radius * 1.2, self.centre + self.radius * 1.2);
        for (axis, name) in AXES {
            let (at, before) = self.place(axis);
            if before {
                scene.point(at, name, &bounds);
            }
        }
    }
}
