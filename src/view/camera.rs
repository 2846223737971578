//! The camera: orbits the origin and looks at it.

use glam::{DMat4, DVec3};

/// An orbit around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Angle about +Y in radians. 0 is at -X, looking along +X, the centre of a panorama; increasing angles
    /// turn right.
    pub yaw: f64,
    /// Height above the horizon in radians, within (-pi/2, pi/2).
    pub pitch: f64,
    /// Distance from the origin, in units of an object's radius.
    pub distance: f64,
    /// Vertical angle of view in radians, for pictures of at least 3:2. Narrower pictures keep the horizontal
    /// angle of 3:2.
    pub angle: f64,
}

/// Least width over height of pictures that show the full vertical angle.
pub(crate) const WIDE: f64 = 1.5;

/// The yaw that looks along -Z, at the front of glTF models, which face +Z.
pub(crate) const FRONT: f64 = -std::f64::consts::FRAC_PI_2;

/// Steepest pitch: the up vector is undefined straight down.
pub(crate) const MAX_PITCH: f64 = 1.55;

impl Default for Camera {
    fn default() -> Self {
        Self { yaw: 0.0, pitch: 0.12, distance: 4.2, angle: 0.6 }
    }
}

/// Position and axes of a camera; right and up span half of the picture's width and height at distance 1.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Position.
    pub eye: DVec3,
    /// Viewing direction, a unit vector.
    pub forward: DVec3,
    /// Vector to the picture's right edge.
    pub right: DVec3,
    /// Vector to the picture's upper edge.
    pub up: DVec3,
    /// To clip space, with depth 0 to 1.
    pub clip_from_world: DMat4,
}

impl Camera {
    /// The frame of a picture `aspect` times as wide as high.
    #[must_use]
    pub fn frame(&self, aspect: f64) -> Frame {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.clamp(-MAX_PITCH, MAX_PITCH).sin_cos();
        let forward = DVec3::new(cos_yaw * cos_pitch, -sin_pitch, sin_yaw * cos_pitch);
        let eye = -self.distance * forward;
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let tangent = (0.5 * self.angle).tan() * (WIDE / aspect).max(1.0);
        let (right, up) = (right * tangent * aspect, up * tangent);
        // Clip space spans the picture at w = distance along the view.
        let (near, far) = (0.02 * self.distance, 100.0 * self.distance);
        let deep = far / (far - near);
        let row = |axis: DVec3, shift: f64| axis.extend(shift - axis.dot(eye));
        let rows = [
            row(right / right.length_squared(), 0.0),
            row(up / up.length_squared(), 0.0),
            row(deep * forward, -deep * near),
            row(forward, 0.0),
        ];
        let clip_from_world = DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
        Frame { eye, forward, right, up, clip_from_world }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_fits_pictures_of_every_shape() {
        let look = crate::view::Look { object: crate::view::Object::Row, ..Default::default() };
        for aspect in [0.3, 0.5, 1.0, 1.5, 1.8, 3.0] {
            let Frame { clip_from_world, .. } = Camera::default().frame(aspect);
            for ball in look.balls() {
                let centre = DVec3::from_array(ball.centre);
                for side in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
                    let seen = clip_from_world.project_point3(centre + ball.radius * side);
                    let inside = seen.x.abs() < 1.0 && seen.y.abs() < 1.0;
                    assert!(inside, "{ball:?} is cut off at {aspect}: {seen}");
                }
            }
        }
    }
}
