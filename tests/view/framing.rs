//! Cameras show all objects, and fill pictures of every shape with them.

use glam::DVec3;
use octagloss_view::{Camera, Look, Object, field_around};
use std::f64::consts::FRAC_PI_2;

/// `count` spheres in a row along z.
fn row(count: u32, radius: f64) -> Vec<(DVec3, f64)> {
    let step = 2.2 * radius;
    let place = |k: u32| (f64::from(k) - f64::from(count - 1) / 2.0) * step;
    (0..count).map(|k| (DVec3::new(0.0, 0.0, place(k)), radius)).collect()
}

/// The greatest coordinates of the spheres' silhouettes in clip space, where the picture's edges are at 1.
fn reach(camera: Camera, aspect: f64, spheres: &[(DVec3, f64)]) -> [f64; 2] {
    let frame = camera.frame(aspect, field_around(spheres.iter().copied()));
    let mut most = [0.0_f64; 2];
    for (centre, radius) in spheres {
        // Rays that touch the sphere.
        let way = centre - frame.eye;
        let (distance, across) = (way.length(), way.normalize().any_orthonormal_pair());
        let sine = radius / distance;
        let circle = centre - way.normalize() * radius * sine;
        for k in 0..360 {
            let (sin, cos) = f64::from(k).to_radians().sin_cos();
            let rim = circle + (cos * across.0 + sin * across.1) * radius * (1.0 - sine * sine).sqrt();
            let seen = frame.clip_from_world.project_point3(rim);
            most = [most[0].max(seen.x.abs()), most[1].max(seen.y.abs())];
        }
    }
    most
}

#[test]
fn rows_of_any_number_fill_the_width_of_pictures_of_every_shape() {
    let camera = Camera { pitch: 0.0, ..Camera::default() };
    for count in [1, 2, 3, 5, 9, 20] {
        for aspect in [0.3, 0.5, 1.0, 1.5, 16.0 / 9.0, 3.0, 8.0] {
            let [x, y] = reach(camera, aspect, &row(count, 0.2));
            assert!(x < 1.0 && y < 1.0, "{count} at {aspect}: cut off at {x}, {y}");
            // The width, or the height where the objects are too high for that.
            let full = (x - 0.92).abs() < 1e-3 || (y - 0.66).abs() < 1e-3;
            assert!(full, "{count} at {aspect}: fills {x} by {y}");
        }
    }
    let [x, y] = reach(Camera { angle: Some(0.2), ..camera }, 1.5, &row(9, 0.2));
    assert!(x > 1.0 && y < 0.66, "a given angle stays: {x}, {y}");
}

#[test]
fn default_cameras_cut_nothing_off() {
    let unit = (DVec3::ZERO, 1.0);
    let row: Vec<_> = (0..9).map(|k| (DVec3::new(0.0, 0.0, (f64::from(k) / 4.0 - 1.0) * 1.7), 0.2)).collect();
    for (object, spheres) in [
        (Object::Sphere, vec![unit]),
        (Object::Knot, vec![unit]),
        (Object::Mesh, vec![unit]),
        (Object::Row, row),
    ] {
        let look = Look { object, ..Look::default() };
        assert_eq!(look.field(), field_around(spheres.iter().copied()), "{object:?}");
        for aspect in [0.3, 1.0, 1.78, 4.0] {
            let [x, y] = reach(look.camera, aspect, &spheres);
            assert!(x < 1.0 && y < 1.0, "{object:?} at {aspect}: {x}, {y}");
        }
    }
}

#[test]
fn backdrops_are_blurred_as_much_as_their_texels_are_coarse() {
    let look = Look::default();
    let half_height = 0.371;
    // Panoramas of 256 to 16384 columns; finer texels than pixels need no blur.
    let roughness: Vec<f64> =
        (6..=12).map(|k| look.backdrop_roughness(FRAC_PI_2 / f64::from(1 << k), half_height)).collect();
    assert!(roughness.windows(2).all(|pair| pair[1] < pair[0] || pair == [0.0, 0.0]), "{roughness:?}");
    assert_eq!(roughness[roughness.len() - 2..], [0.0, 0.0], "{roughness:?}");
    // Half the lobe's width at half its height, 1.29 of the squared roughness, spans at least a texel.
    let texel = FRAC_PI_2 / 128.0;
    let blur = roughness[1].powi(2) * 1.29;
    assert!(blur > texel && blur < 2.0 * texel, "{blur} for {texel}");
    assert_eq!(Look { backdrop: Some(0.0), ..look }.backdrop_roughness(texel, half_height), 0.0);
}
