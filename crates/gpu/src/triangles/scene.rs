//! The scene that measurements draw: about as many triangles as that of Engelhardt and Dachsbacher 2008.

use super::{Corner, Triangles};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Edges of the ground's grid along a side.
const GROUND: u32 = 100;

/// Balls, and the edges of each around and from pole to pole.
const BALLS: u32 = 81;
const AROUND: u32 = 32;
const ALONG: u32 = 16;

/// Distance of the nearest triangle, at least.
pub const NEAREST: f32 = 0.5;

/// A hilly ground, balls around the viewer, and a dome that encloses both: 104,992 triangles.
pub fn scene() -> Triangles {
    let mut parts = Parts::default();
    let mut ground = Vec::new();
    for j in 0..=GROUND {
        for i in 0..=GROUND {
            let [x, z] = [i, j].map(|k| 40.0 * (f64::from(k) / f64::from(GROUND) - 0.5));
            let height = -2.0 + 0.4 * (0.9 * x).sin() * (0.7 * z).cos();
            ground.push((DVec3::new(x, height, z), DVec3::new(0.3, 0.25, 0.15) * (1.0 + 0.5 * height.sin())));
        }
    }
    parts.grid(GROUND, &ground);
    for ball in 0..BALLS {
        // Directions of a spiral, which spreads them evenly, at three distances.
        let y = 1.0 - (2.0 * f64::from(ball) + 1.0) / f64::from(BALLS);
        let (sin, cos) = (f64::from(ball) * PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
        let ring = (1.0 - y * y).sqrt();
        let centre = DVec3::new(ring * cos, y, ring * sin) * (2.0 + 1.5 * f64::from(ball % 3));
        let hue = f64::from(ball) / f64::from(BALLS) * TAU;
        let colour = DVec3::new(hue.cos(), (hue + TAU / 3.0).cos(), (hue - TAU / 3.0).cos()) * 0.4 + 0.5;
        parts.ball(centre, 0.35 + 0.1 * f64::from(ball % 2), AROUND, ALONG, |normal| {
            colour * (0.6 + 0.4 * normal.y)
        });
    }
    parts.ball(DVec3::ZERO, 60.0, AROUND, 2 * ALONG, |normal| DVec3::new(0.4, 0.6, 0.9 + 0.5 * normal.y));
    Triangles::new(parts.corners, parts.indices).expect("a valid mesh")
}

#[derive(Default)]
struct Parts {
    corners: Vec<Corner>,
    indices: Vec<u32>,
}

impl Parts {
    fn corner(&mut self, position: DVec3, colour: DVec3) {
        let [x, y, z] = position.as_vec3().to_array();
        let [red, green, blue] = colour.as_vec3().to_array();
        self.corners.push(Corner::new([x, y, z], [red, green, blue, 1.0]));
    }

    /// Adds `width` edges along each row of `corners`, two triangles per cell.
    fn grid(&mut self, width: u32, corners: &[(DVec3, DVec3)]) {
        let first = self.corners.len() as u32;
        corners.iter().for_each(|(position, colour)| self.corner(*position, *colour));
        let rows = corners.len() as u32 / (width + 1) - 1;
        for j in 0..rows {
            for i in 0..width {
                let at = first + j * (width + 1) + i;
                let below = at + width + 1;
                self.indices.extend([at, at + 1, below, at + 1, below + 1, below]);
            }
        }
    }

    /// Adds a ball of `radius` whose colour depends on the normal.
    fn ball(&mut self, centre: DVec3, radius: f64, around: u32, along: u32, colour: impl Fn(DVec3) -> DVec3) {
        let mut corners = Vec::new();
        for j in 0..=along {
            let (ring, y) = (f64::from(j) / f64::from(along) * PI).sin_cos();
            for i in 0..=around {
                let (sin, cos) = (f64::from(i % around) / f64::from(around) * TAU).sin_cos();
                let normal = DVec3::new(ring * cos, y, ring * sin);
                corners.push((centre + radius * normal, colour(normal)));
            }
        }
        self.grid(around, &corners);
    }
}

#[cfg(test)]
mod tests {
    use super::{NEAREST, scene};

    #[test]
    fn the_scene_is_as_large_as_the_paper_s() {
        let scene = scene();
        assert_eq!(scene.count(), 104_992);
        let nearest = scene.corners().iter().map(|corner| {
            let [x, y, z] = corner.position;
            x.abs() + y.abs() + z.abs()
        });
        assert!(nearest.fold(f32::INFINITY, f32::min) > NEAREST);
    }
}
