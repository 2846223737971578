//! Small procedural environments, written by `octagloss synth NAME` and stored in `hdr/`.
//!
//! Supersampled: a texel approximates the mean radiance over its solid angle.

mod marks;

use crate::common::error::{Result, wrong};
use crate::common::parallel;
use crate::common::smoothstep::smoothstep;
use crate::light::environment::{Environment, Layout, Rgb};
use crate::sphere::cube::{self, Face};
use crate::sphere::equirect;
use glam::DVec3;
use std::f64::consts::PI;

/// A synthetic environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Recipe {
    /// Name on the command line.
    pub name: &'static str,
    /// Its purpose in a few words.
    pub purpose: &'static str,
    /// File name in `hdr/`.
    pub file_name: &'static str,
}

/// All recipes.
pub const RECIPES: [Recipe; 5] = [
    Recipe {
        name: "sky",
        purpose: "a clear sky with a sun disc over dry ground; one small, very bright light",
        file_name: "sky.exr",
    },
    Recipe {
        name: "studio",
        purpose: "softboxes of different sizes and colours in a dark room; sharp edges, as .hdr",
        file_name: "studio.hdr",
    },
    Recipe {
        name: "labelled",
        purpose: "cube faces with distinct colours, names and up arrows; reveals rotated and mirrored images",
        file_name: "labelled.exr",
    },
    Recipe {
        name: "labelled-cube",
        purpose: "the same environment as a horizontal cross; face images are mirrored, as in every engine",
        file_name: "labelled-cube.exr",
    },
    Recipe {
        name: "furnace",
        purpose: "constant radiance 1; every baked texel must be 1",
        file_name: "furnace.exr",
    },
];

/// Unit direction of the centre of the sun of `sky`: 35 degrees up, between +X and +Z.
pub fn sun_direction() -> DVec3 {
    let (azimuth, elevation) = (0.6_f64, 35_f64.to_radians());
    DVec3::new(elevation.cos() * azimuth.cos(), elevation.sin(), elevation.cos() * azimuth.sin())
}

/// Angular radius of the sun in `sky`: that of the real sun, 0.2665 degrees.
pub const SUN_RADIUS: f64 = 0.2665 * PI / 180.0;

/// Radiance of the sun's disc in `sky`.
pub const SUN_RADIANCE: Rgb = [68_000.0, 62_000.0, 52_000.0];

/// Creates the environment called `name`, one of [`RECIPES`].
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] for an unknown name; the message lists the known ones.
pub fn synth(name: &str) -> Result<Environment> {
    match name {
        "sky" => panorama(512, 256, 2, sky),
        "studio" => panorama(256, 128, 4, studio),
        "labelled" => panorama(512, 256, 4, labelled),
        "labelled-cube" => labelled_cube(128),
        "furnace" => panorama(64, 32, 1, |_| [1.0; 3]),
        _ => {
            let names: Vec<&str> = RECIPES.iter().map(|recipe| recipe.name).collect();
            wrong(format!("no environment is called {name:?}; known names: {}", names.join(", ")))
        }
    }
}

/// The `labelled` environment as six faces of `size` x `size` texels.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if `size` is zero.
pub fn labelled_cube(size: u32) -> Result<Environment> {
    let texels = Face::ALL
        .into_iter()
        .flat_map(|face| (0..size).flat_map(move |j| (0..size).map(move |i| (face, i, j))))
        .map(|(face, i, j)| {
            mean(4, |x, y| {
                let at = |k: u32, f: f64| (f64::from(k) + f) / f64::from(size) * 2.0 - 1.0;
                labelled(cube::direction_from_cube(face, at(i, x), at(j, y)))
            })
        })
        .collect();
    Environment::new(Layout::Cube { size }, texels)
}

/// Renders a panorama with `samples` x `samples` points a texel, 32 x 32 near the sun.
fn panorama(width: u32, height: u32, samples: u32, radiance: fn(DVec3) -> Rgb) -> Result<Environment> {
    let texel_angle = PI / f64::from(height);
    let near_sun = (SUN_RADIUS + texel_angle).cos();
    let texel = |i: u32, j: u32| {
        let direction = |x: f64, y: f64| {
            equirect::direction_from_equirect(
                (f64::from(i) + x) / f64::from(width),
                (f64::from(j) + y) / f64::from(height),
            )
        };
        let samples = if direction(0.5, 0.5).dot(sun_direction()) > near_sun { 32 } else { samples };
        mean(samples, |x, y| radiance(direction(x, y)))
    };
    let rows = parallel::map(0..height, |j| (0..width).map(|i| texel(i, j)).collect::<Vec<Rgb>>());
    Environment::new(Layout::Panorama { width, height }, rows.concat())
}

/// Mean over a grid of `samples` x `samples` points of the unit square.
fn mean(samples: u32, radiance: impl Fn(f64, f64) -> Rgb) -> Rgb {
    let mut sum = [0.0_f64; 3];
    let place = |k: u32| (f64::from(k) + 0.5) / f64::from(samples);
    for y in 0..samples {
        for x in 0..samples {
            let sample = radiance(place(x), place(y));
            for (sum, sample) in sum.iter_mut().zip(sample) {
                *sum += f64::from(sample);
            }
        }
    }
    sum.map(|s| (s / f64::from(samples * samples)) as f32)
}

/// 0 on the side of `low`, 1 on that of `high`.
fn between(low: f64, high: f64, x: f64) -> f64 {
    smoothstep((x - low) / (high - low))
}

fn lerp(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * t)
}

/// Clear sky after Preetham, Shirley and Smits 1999 (turbidity 3), luminance in units of 10 kcd/m^2, with a
/// sun disc and dry grass that fades into haze at the horizon.
fn sky(direction: DVec3) -> Rgb {
    if direction.angle_between(sun_direction()) < SUN_RADIUS {
        return SUN_RADIANCE;
    }
    let horizon = preetham(DVec3::new(direction.x, 0.004, direction.z).normalize());
    let colour = if direction.y > 0.004 {
        preetham(direction)
    } else {
        let haze = between(0.25, 0.0, -direction.y).powi(2);
        lerp([0.115, 0.105, 0.07], horizon.map(|c| c * 0.6), haze)
    };
    colour.map(|c| c as f32)
}

/// Linear RGB of the Preetham sky in `direction`, which must point upwards.
fn preetham(direction: DVec3) -> [f64; 3] {
    const TURBIDITY: f64 = 3.0;
    let t = TURBIDITY;
    let sun = sun_direction();
    let (theta_sun, cos_theta) = (sun.y.acos(), direction.y.max(1e-3));
    // Perez coefficients and zenith values of the paper's appendix A.2, for Y, x and y.
    let perez = [
        [
            0.1787 * t - 1.4630,
            -0.3554 * t + 0.4275,
            -0.0227 * t + 5.3251,
            0.1206 * t - 2.5771,
            -0.0670 * t + 0.3703,
        ],
        [
            -0.0193 * t - 0.2592,
            -0.0665 * t + 0.0008,
            -0.0004 * t + 0.2125,
            -0.0641 * t - 0.8989,
            -0.0033 * t + 0.0452,
        ],
        [
            -0.0167 * t - 0.2608,
            -0.0950 * t + 0.0092,
            -0.0079 * t + 0.2102,
            -0.0441 * t - 1.6537,
            -0.0109 * t + 0.0529,
        ],
    ];
    let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta_sun);
    let chromaticity = |rows: [[f64; 4]; 3]| {
        let cubic = |r: [f64; 4]| ((r[0] * theta_sun + r[1]) * theta_sun + r[2]) * theta_sun + r[3];
        (cubic(rows[0]) * t + cubic(rows[1])) * t + cubic(rows[2])
    };
    let zenith = [
        (4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192,
        chromaticity([
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        ]),
        chromaticity([
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        ]),
    ];
    let distribution = |[a, b, c, d, e]: [f64; 5], cos_theta: f64, gamma: f64| {
        (1.0 + a * (b / cos_theta).exp()) * (1.0 + c * (d * gamma).exp() + e * gamma.cos().powi(2))
    };
    let gamma = direction.angle_between(sun);
    let value = |k: usize| {
        zenith[k] * distribution(perez[k], cos_theta, gamma) / distribution(perez[k], 1.0, theta_sun)
    };
    // kcd/m^2 to 10 kcd/m^2, xyY to XYZ to linear sRGB (IEC 61966-2-1).
    let (luminance, x, y) = (value(0) / 10.0, value(1), value(2));
    let (cx, cz) = (luminance * x / y, luminance * (1.0 - x - y) / y);
    [
        3.2406 * cx - 1.5372 * luminance - 0.4986 * cz,
        -0.9689 * cx + 1.8758 * luminance + 0.0415 * cz,
        0.0557 * cx - 0.2040 * luminance + 1.0570 * cz,
    ]
    .map(|c| c.max(0.0))
}

/// A light of `studio`: a rectangle in the plane at distance 1 along `towards`.
struct Softbox {
    towards: DVec3,
    half_width: f64,
    half_height: f64,
    radiance: [f64; 3],
}

/// Softboxes in a dark room with a grey floor.
fn studio(direction: DVec3) -> Rgb {
    let boxes = [
        // Key, fill, a tall strip light, a small hot spot, and an overhead panel.
        Softbox {
            towards: DVec3::new(1.0, 0.45, 0.7),
            half_width: 0.42,
            half_height: 0.3,
            radiance: [14.0, 12.6, 10.8],
        },
        Softbox {
            towards: DVec3::new(0.5, 0.2, -1.0),
            half_width: 0.6,
            half_height: 0.45,
            radiance: [1.6, 2.2, 3.4],
        },
        Softbox {
            towards: DVec3::new(-1.0, 0.1, 0.25),
            half_width: 0.07,
            half_height: 0.9,
            radiance: [9.0, 3.2, 6.4],
        },
        Softbox {
            towards: DVec3::new(-0.7, 0.8, -0.6),
            half_width: 0.05,
            half_height: 0.05,
            radiance: [320.0, 300.0, 260.0],
        },
        Softbox {
            towards: DVec3::new(0.05, 1.0, 0.0),
            half_width: 0.5,
            half_height: 0.25,
            radiance: [4.0, 4.0, 4.0],
        },
    ];
    for light in &boxes {
        let forward = light.towards.normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let depth = direction.dot(forward);
        if depth > 0.0 {
            let x = (direction.dot(right) / depth / light.half_width).abs();
            let y = (direction.dot(up) / depth / light.half_height).abs();
            if x < 1.0 && y < 1.0 {
                // A diffuser is slightly darker towards its edge.
                let falloff = 1.0 - 0.25 * (x * x + y * y);
                return light.radiance.map(|c| (c * falloff) as f32);
            }
        }
    }
    let wall = lerp([0.03, 0.031, 0.034], [0.075, 0.075, 0.08], between(-0.2, 0.9, direction.y));
    // Light the floor around the nadir.
    let floor = [0.24, 0.23, 0.22].map(|c| c * (0.25 + 0.75 * between(0.3, 1.0, -direction.y)));
    lerp(wall, floor, between(0.1, 0.13, -direction.y)).map(|c| c as f32)
}

/// Cube faces, each with its colour, a frame, its name and an up arrow.
fn labelled(direction: DVec3) -> Rgb {
    const INK: Rgb = [0.02; 3];
    let (face, s, t) = cube::cube_from_direction(direction);
    let (name, colour) = [
        ("+X", [0.9, 0.25, 0.2]),
        ("-X", [0.2, 0.75, 0.75]),
        ("+Y", [0.35, 0.8, 0.25]),
        ("-Y", [0.75, 0.3, 0.75]),
        ("+Z", [0.25, 0.4, 0.95]),
        ("-Z", [0.9, 0.8, 0.25]),
    ][face.index()];
    // Seen from inside, the face's s runs to the left.
    let (right, down) = (-s, t);
    if right.abs().max(down.abs()) > 0.94 {
        return [1.0; 3];
    }
    let inked = |text: &str, cell: f64, top: f64| {
        let x = (right / cell + f64::from(marks::text_width(text)) / 2.0).floor();
        let y = ((down - top) / cell).floor();
        x >= 0.0 && y >= 0.0 && marks::is_inked(text, x as u32, y as u32)
    };
    if inked(name, 0.11, -0.17) || inked("^", 0.07, -0.75) {
        return INK;
    }
    // A faint checkerboard shows the scale of reflections.
    let odd = ((right * 8.0).floor() + (down * 8.0).floor()).rem_euclid(2.0);
    colour.map(|c| c * if odd == 0.0 { 1.0 } else { 0.85 })
}
