//! Outlines of shapes and characters.

use glam::DVec2;

/// Closed outlines. Areas that several outlines of one direction cover count once.
#[derive(Clone, Debug, Default)]
pub struct Path {
    pub(super) pieces: Vec<[DVec2; 3]>,
}

impl Path {
    pub fn line(&mut self, [from, to]: [DVec2; 2]) {
        self.pieces.push([from, from.midpoint(to), to]);
    }

    /// Adds a quadratic curve by its start, control point and end.
    pub fn curve(&mut self, points: [DVec2; 3]) {
        self.pieces.push(points);
    }

    pub fn polygon(&mut self, points: &[DVec2]) {
        for (k, from) in points.iter().enumerate() {
            self.line([*from, points[(k + 1) % points.len()]]);
        }
    }

    pub(super) fn disc(&mut self, centre: DVec2, radius: f64) {
        let count = (8.0 + 4.0 * radius).min(96.0) as u32;
        // In the direction of `stroke`.
        let turn = |k: u32| -std::f64::consts::TAU * f64::from(k) / f64::from(count);
        let points: Vec<DVec2> = (0..count).map(|k| centre + DVec2::from_angle(turn(k)) * radius).collect();
        self.polygon(&points);
    }

    /// Adds a line through `points`, `width` pixels wide, with round joints.
    pub(super) fn stroke(&mut self, points: &[DVec2], width: f64) {
        let mut before: Option<DVec2> = None;
        for pair in points.windows(2) {
            let Some(way) = (pair[1] - pair[0]).try_normalize() else { continue };
            let across = way.perp() * width / 2.0;
            self.polygon(&[pair[0] + across, pair[1] + across, pair[1] - across, pair[0] - across]);
            if before.is_some_and(|before| before.dot(way) < 0.99) {
                self.disc(pair[0], width / 2.0);
            }
            before = Some(way);
        }
    }
}
