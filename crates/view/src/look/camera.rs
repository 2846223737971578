//! The camera: orbits the origin and looks at it.

use glam::{DMat4, DVec2, DVec3};

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
    /// Vertical angle of view in radians, for pictures of at least 3:2; narrower pictures keep the horizontal
    /// angle of 3:2. `None` fits the objects to pictures of any shape.
    pub angle: Option<f64>,
}

/// Least width over height of pictures that show the full vertical angle.
const WIDE: f64 = 1.5;

/// Distance at which objects fill the picture, in units of an object's radius.
const DISTANCE: f64 = 4.2;

/// Shares of a picture's width and height that objects fill: a row its width, a single object part of its
/// height, with the surroundings around it.
const FILL: DVec2 = DVec2::new(0.92, 0.66);

/// The yaw that looks along -Z, at the front of glTF models, which face +Z.
pub const FRONT: f64 = -std::f64::consts::FRAC_PI_2;

/// Steepest pitch: the up vector is undefined straight down.
pub(crate) const MAX_PITCH: f64 = 1.55;

impl Default for Camera {
    fn default() -> Self {
        Self { yaw: 0.0, pitch: 0.07, distance: DISTANCE, angle: None }
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

/// Half the width and the height, at distance 1, that a picture shows around `spheres`, by centre and radius,
/// from the default camera's distance. Either may exceed it, by the picture's shape.
pub fn field_around(spheres: impl IntoIterator<Item = (DVec3, f64)>) -> DVec2 {
    let reach = |offset: f64, radius: f64| {
        let outer = (offset / DISTANCE).atan() + (radius / DISTANCE.hypot(offset)).asin();
        outer.min(1.5).tan()
    };
    let reaches = spheres
        .into_iter()
        .map(|(centre, radius)| DVec2::new(reach(centre.z.abs(), radius), reach(centre.y.abs(), radius)));
    reaches.fold(DVec2::ZERO, DVec2::max) / FILL
}

/// The field of an angle of view.
pub fn field_of_angle(angle: f64) -> DVec2 {
    (0.5 * angle).tan() * DVec2::new(WIDE, 1.0)
}

impl Camera {
    /// The frame of a picture `aspect` times as wide as high, which shows at least `field`, half its width
    /// and height at distance 1, unless the camera has an angle of view.
    pub fn frame(&self, aspect: f64, field: DVec2) -> Frame {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.clamp(-MAX_PITCH, MAX_PITCH).sin_cos();
        let forward = DVec3::new(cos_yaw * cos_pitch, -sin_pitch, sin_yaw * cos_pitch);
        let eye = -self.distance * forward;
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let field = self.angle.map_or(field, field_of_angle);
        let tangent = field.y.max(field.x / aspect);
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
