//! HEALPix: twelve squares of equal area on rings of constant latitude.
//!
//! Gorski et al. 2005, in the planar form of Calabretta and Roukema 2007 (*Mapping on the HEALPix grid*):
//! longitude against Lambert's cylindrical height where |sin(latitude)| <= 2/3, Collignon's triangles
//! above. The polar axis is y, longitude that of the panorama, atan2(z, x).
//!
//! Components 0 to 3 are the squares around +Y, 4 to 7 those around the equator (4 at +X, 5 at +Z), 8 to 11
//! those around -Y. u runs towards the north-east, v towards the north-west, as in the paper's face
//! coordinates x and y. Outside a square the plane continues, and beyond a polar triangle's side its
//! parallels continue. Kinks at |sin(latitude)| = 2/3 and singular directions at the poles, where four
//! squares meet.

use super::map::{Component, Place, SphereMap};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_4, PI};

/// The map.
#[derive(Clone, Copy, Debug)]
pub struct Healpix;

/// Middle of a square in the plane, in eighths of the equator: longitude and height.
fn middle(component: u32) -> DVec2 {
    let (row, column) = (component / 4, f64::from(component % 4));
    match row {
        0 => DVec2::new(2.0 * column + 1.0, 1.0),
        1 => DVec2::new(2.0 * column, 0.0),
        _ => DVec2::new(2.0 * column + 1.0, -1.0),
    }
}

impl SphereMap for Healpix {
    fn components(&self) -> u32 {
        12
    }

    fn component(&self, index: u32) -> Component {
        Component { low: DVec2::ZERO, high: DVec2::ONE, cells: [1, 1], at: [index % 4, index / 4] }
    }

    fn direction(&self, component: u32, uv: DVec2) -> DVec3 {
        let middle = middle(component);
        let place = middle + DVec2::new(uv.x - uv.y, uv.x + uv.y - 1.0);
        let (longitude, height, across) = if place.y.abs() <= 1.0 {
            let height = place.y * 2.0 / 3.0;
            (place.x, height, (1.0 - height * height).sqrt())
        } else {
            let sigma = (2.0 - place.y.abs()).max(0.0);
            // The polar triangle that contains this part of the square.
            let centre = if component / 4 == 1 { (place.x / 2.0).floor() * 2.0 + 1.0 } else { middle.x };
            let along = if sigma == 0.0 { 0.0 } else { (place.x - centre) / sigma };
            let squared = sigma * sigma / 3.0;
            // sqrt(1 - z^2) with z = 1 - squared.
            (centre + along, (1.0 - squared).copysign(place.y), (squared * (2.0 - squared)).sqrt())
        };
        let (sin, cos) = (longitude * FRAC_PI_4).sin_cos();
        DVec3::new(across * cos, height, across * sin)
    }

    fn locate(&self, direction: DVec3) -> Place {
        let d = direction.normalize();
        let longitude = (d.z.atan2(d.x) / FRAC_PI_4).rem_euclid(8.0);
        let (place, component) = if d.y.abs() <= 2.0 / 3.0 {
            let place = DVec2::new(longitude, d.y * 1.5);
            // Columns of squares rising to the right and to the left.
            let rising = ((place.x + place.y + 1.0) / 2.0).floor();
            let falling = ((place.x - place.y + 1.0) / 2.0).floor();
            let (row, column) = if rising == falling {
                (1, rising)
            } else if rising > falling {
                (0, falling)
            } else {
                (2, rising)
            };
            (place, row * 4 + column.rem_euclid(4.0) as u32)
        } else {
            let sigma = (3.0 * (d.x * d.x + d.z * d.z) / (1.0 + d.y.abs())).sqrt();
            let column = (longitude / 2.0).floor().min(3.0);
            let centre = 2.0 * column + 1.0;
            let place = DVec2::new(centre + (longitude - centre) * sigma, (2.0 - sigma).copysign(d.y));
            (place, column as u32 + if d.y > 0.0 { 0 } else { 8 })
        };
        let mut off = place - middle(component);
        // The square at +X crosses the end of the circle.
        if off.x > 4.0 {
            off.x -= 8.0;
        }
        let uv = DVec2::new(off.y + off.x + 1.0, off.y - off.x + 1.0) / 2.0;
        Place { component, uv: uv.clamp(DVec2::ZERO, DVec2::ONE) }
    }

    fn density(&self, _: u32, _: DVec2) -> f64 {
        PI / 3.0
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        (high.x - low.x) * (high.y - low.y) * (PI / 3.0)
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        let Place { component, uv } = place;
        let (row, column) = (component / 4, component % 4);
        // Longitudes are negated by z, and subtracted from half a circle by x: both exchange east and west.
        let turned = |sum: u32| if row == 1 { (sum + 1 - column) % 4 } else { (sum - column) % 4 };
        Some(match axis {
            0 => Place { component: 4 * row + turned(5), uv: DVec2::new(uv.y, uv.x) },
            1 => Place { component: 4 * (2 - row) + column, uv: DVec2::new(1.0 - uv.y, 1.0 - uv.x) },
            _ => Place { component: 4 * row + turned(3), uv: DVec2::new(uv.y, uv.x) },
        })
    }
}
