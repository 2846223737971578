//! Compares the viewer's pictures with the CPU's of the same view, ray by ray.

use glam::{DMat3, DVec2, DVec3};
use octagloss_core::bake::dfg;
use octagloss_core::common::error::Error;
use octagloss_core::common::frame::Frame;
use octagloss_core::cpu::reflection::ReflectedLight;
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::files::image::exposure::Exposure;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::synth::synth;
use octagloss_core::lobe::Lobe;
use octagloss_core::pyramid::Pyramid;
use octagloss_drawing::scale::RELATIVE_ERROR;
use octagloss_fixtures::adapters::{PerAdapter, in_full, on_every_adapter, wait};
use octagloss_fixtures::common::{self, Random, texels};
use octagloss_gpu::Context;
use octagloss_gpu::block_on;
use octagloss_gpu::device::readback;
use octagloss_gpu::stages::lamp::Lamp;
use octagloss_view::screenshot;
use octagloss_view::{
    Camera, Display, Finish, Ground, Light, Look, Mesh, Object, Renderer, Screenshot, Show, Technique, Tone,
    Truth, Viewport,
};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Settings for an OEM of `inner` texels along an edge.
fn table(inner: u32) -> ReflectorSettings {
    ReflectorSettings { oem_size: Some(inner), ..ReflectorSettings::default() }
}

const WIDTH: u32 = 96;
const HEIGHT: u32 = 64;
const OEM: u32 = 128;

/// Greatest error of a display byte, two steps: its own rounding, half floats (2^-11 of the radiance, an
/// eighth of a step where the display is brightest), float32 directions and the split sum's table.
const STEPS: i32 = 2;

/// Greatest share of pixels beyond that: at silhouettes, where a ray may pass on the other side, and at a
/// sun's edge, where rounding may flip a tone-mapped pixel.
const SILHOUETTE: f64 = 0.01;

/// The same share for a mesh: vertices are snapped to a sixteenth of a pixel at the coarsest (Vulkan's four
/// bits), which moves silhouettes and, on small triangles, normals.
const SNAPPED: f64 = 0.03;

/// Returns the share of pixels that differ by more than [`STEPS`].
fn difference(found: &[[u8; 3]], expected: &[[u8; 3]]) -> f64 {
    assert_eq!(found.len(), expected.len(), "pixels");
    let off = |(a, b): (&[u8; 3], &[u8; 3])| {
        a.iter().zip(b).any(|(a, b)| (i32::from(*a) - i32::from(*b)).abs() > STEPS)
    };
    found.iter().zip(expected).filter(|pair| off(*pair)).count() as f64 / found.len() as f64
}

/// What one ray hits: the mirrored direction, the roughness, and how the metal scales the answer.
struct Seen {
    direction: DVec3,
    roughness: f64,
    factor: DVec3,
    /// Of a surface its normal, the direction to the viewer, and the factor of multiple scattering.
    surface: Option<[DVec3; 3]>,
}

/// Returns the CPU's picture of `look`, computed without the viewer's code.
fn expected(look: &Look, environment: &Environment, mesh: Option<&Mesh>) -> Vec<[u8; 3]> {
    let settings = ReflectorSettings { oem_size: Some(OEM), ..ReflectorSettings::default() };
    let turned = environment.clone().rotated_y(look.turn).expect("an angle");
    let reflector = Reflector::new(&turned, &settings).expect("an OEM");
    let filter = match look.filter {
        Technique::Box => octagloss_core::lobe::filter::Filter::Box,
        Technique::Pyramid | Technique::Reflect => octagloss_core::lobe::filter::Filter::Pyramid,
        Technique::Adaptive | Technique::Levels => octagloss_core::lobe::filter::Filter::Adaptive(0.001),
    };
    // Angle of a texel at the horizon: of the environment or the map, the coarser.
    let quarter = match environment.layout() {
        Layout::Panorama { width, .. } => width / 4,
        Layout::Cube { size } => size,
        Layout::Octahedral { size } => size / 2,
    };
    let texel = FRAC_PI_2 / f64::from(quarter.min(OEM / 2));
    let pyramid =
        (look.filter == Technique::Reflect).then(|| Pyramid::build(environment, OEM).expect("a size"));
    let source_from_world = DMat3::from_rotation_y(look.turn.to_radians()).transpose();
    (0..WIDTH * HEIGHT)
        .into_par_iter()
        .map(|index| {
            let at = DVec2::new(f64::from(index % WIDTH) + 0.5, f64::from(index / WIDTH) + 0.5);
            let seen = look_along(look, at, mesh, texel);
            if let (Some(pyramid), Some([normal, view, again])) = (&pyramid, seen.surface) {
                // Spheres are brushed around the vertical axis.
                let around = DVec3::Y.cross(normal);
                let tangent = DMat3::from_axis_angle(normal, look.finish.direction.to_radians()) * around;
                let [normal, view, tangent] = [normal, view, tangent].map(|d| source_from_world * d);
                let frame = Frame::new(normal, view, tangent).expect("a frame");
                let [roughness, anisotropy] = [seen.roughness, look.finish.anisotropy].map(|x| x as f32);
                let light = pyramid.reflect(&frame, roughness, anisotropy, look.metal, 1.0);
                // The mean over tangents.
                let [a, b] = pyramid.albedo(normal.dot(view) as f32, roughness, anisotropy);
                let more =
                    DVec3::from_array(look.metal.map(f64::from)) * (1.0 / f64::from(a + b) - 1.0) + 1.0;
                let again = if anisotropy > 0.0 { more } else { again };
                let light = DVec3::from_array(light.map(f64::from)) * again;
                let coat = look.finish.coat_roughness as f32;
                let [a, b] = pyramid.albedo(normal.dot(view) as f32, coat, 0.0);
                let taken = look.finish.clearcoat * f64::from(0.04 * a + b);
                let coated = pyramid.reflect(&frame, coat, 0.0, [0.04; 3], 1.0).map(f64::from);
                let light = light * (1.0 - taken) + DVec3::from_array(coated) * look.finish.clearcoat;
                return display(look.tone, light * look.exposure.ev(0.0).exp2());
            }
            let answer = reflector.query(seen.direction, seen.roughness, Lobe::Ggx, filter).expect("a lobe");
            let light = DVec3::from_array(answer.radiance.map(f64::from));
            display(look.tone, light * seen.factor * look.exposure.ev(0.0).exp2())
        })
        .collect()
}

fn look_along(look: &Look, at: DVec2, mesh: Option<&Mesh>, texel: f64) -> Seen {
    let Camera { yaw, pitch, distance, angle } = look.camera;
    let turn = DMat3::from_rotation_y(-yaw) * DMat3::from_rotation_z(-pitch);
    let [forward, up, right] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn * axis);
    let (width, height) = (f64::from(WIDTH), f64::from(HEIGHT));
    let field = look.field();
    let half = angle.map_or(field.y.max(field.x * height / width), |angle| (angle / 2.0).tan());
    let x = (2.0 * at.x / width - 1.0) * half * width / height;
    let y = (1.0 - 2.0 * at.y / height) * half;
    let ray = (forward + x * right + y * up).normalize();
    let eye = -distance * forward;
    let balls: Vec<(DVec3, f64, f64)> = match look.object {
        Object::Sphere => vec![(DVec3::ZERO, 1.0, look.roughness)],
        Object::Row => (0..9)
            .map(|k| (DVec3::new(0.0, 0.0, (f64::from(k) / 4.0 - 1.0) * 1.7), 0.2, f64::from(k) / 8.0))
            .collect(),
        Object::Knot | Object::Mesh => Vec::new(),
    };
    let ball_hits = balls.iter().filter_map(|(centre, radius, roughness)| {
        let from = eye - *centre;
        let along = from.dot(ray);
        let discriminant = along * along - from.length_squared() + radius * radius;
        let reach = -along - discriminant.max(0.0).sqrt();
        (discriminant > 0.0 && reach > 0.0).then(|| (reach, (from + reach * ray) / *radius, *roughness))
    });
    let corners = |mesh: &Mesh| -> Vec<[usize; 3]> {
        mesh.indices.chunks_exact(3).map(|three| [0, 1, 2].map(|k| three[k] as usize)).collect()
    };
    let mesh_hits: Vec<(f64, DVec3, f64)> = mesh
        .map(|mesh| {
            let hit = |triangle: [usize; 3]| {
                let place = |k: usize| DVec3::from_array(mesh.vertices[triangle[k]].position.map(f64::from));
                let normal = |k: usize| DVec3::from_array(mesh.vertices[triangle[k]].normal.map(f64::from));
                // Moeller and Trumbore 1997.
                let (b, c) = (place(1) - place(0), place(2) - place(0));
                let cross = ray.cross(c);
                let determinant = b.dot(cross);
                let from = eye - place(0);
                let u = from.dot(cross) / determinant;
                let v = ray.dot(from.cross(b)) / determinant;
                let reach = c.dot(from.cross(b)) / determinant;
                let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && reach > 0.0;
                let normal = (1.0 - u - v) * normal(0) + u * normal(1) + v * normal(2);
                inside.then(|| (reach, normal.normalize(), look.roughness))
            };
            corners(mesh).into_iter().filter_map(hit).collect()
        })
        .unwrap_or_default();
    let nearest = ball_hits.chain(mesh_hits).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, normal, roughness)) = nearest else {
        let factor = DVec3::splat(ground_light(look, eye, ray, &balls));
        let roughness = look.backdrop_roughness(texel, half);
        return Seen { direction: ray, roughness, factor, surface: None };
    };
    let cosine = -ray.dot(normal);
    let [scale, bias] = split_sum(cosine, roughness);
    let metal = DVec3::from_array(look.metal.map(f64::from));
    let again = DVec3::ONE + metal * (1.0 / (scale + bias) - 1.0);
    let direction = ray + 2.0 * cosine * normal;
    let surface = Some([normal, -ray, again]);
    Seen { direction, roughness, factor: (metal * scale + bias) * again, surface }
}

/// The split sum, interpolated between 257 cosines: integrating it for every pixel takes seconds.
fn split_sum(cosine: f64, roughness: f64) -> [f64; 2] {
    const LEAST: f64 = 1.0 / 128.0;
    static TABLES: Mutex<BTreeMap<u64, Vec<[f64; 2]>>> = Mutex::new(BTreeMap::new());
    let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
    let table = tables.entry(roughness.to_bits()).or_insert_with(|| {
        let cosine = |k: u32| (f64::from(k) / 256.0).max(LEAST);
        (0..=256).map(|k| dfg::ggx(cosine(k), roughness.max(LEAST))).collect()
    });
    let at = 256.0 * cosine.clamp(LEAST, 1.0);
    let low = (at as usize).min(255);
    let part = at - low as f64;
    std::array::from_fn(|c| table[low][c] * (1.0 - part) + table[low + 1][c] * part)
}

/// The share of an even light that `balls` leave on the plane that they touch from above.
fn ground_light(look: &Look, eye: DVec3, ray: DVec3, balls: &[(DVec3, f64, f64)]) -> f64 {
    let Some((_, radius, _)) = balls.first().filter(|_| look.ground == Ground::Shadow) else { return 1.0 };
    let above = eye.y + radius;
    if ray.y >= 0.0 || above <= 0.0 {
        return 1.0;
    }
    let at = eye - ray * above / ray.y;
    let hidden = |(centre, radius, _): &(DVec3, f64, f64)| {
        let way = centre - at;
        (radius / way.length()).powi(2) * way.normalize().y
    };
    balls.iter().map(|ball| 1.0 - hidden(ball).min(1.0)).product()
}

fn display(tone: Tone, colour: DVec3) -> [u8; 3] {
    let mapped = match tone {
        Tone::Linear => colour,
        Tone::Reinhard => colour / (DVec3::ONE + colour),
        Tone::Aces => {
            let x = colour;
            x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
        }
        Tone::Neutral => {
            let least = colour.min_element();
            let moved = colour - if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
            let peak = moved.max_element();
            if peak < 0.76 {
                moved
            } else {
                let compressed = 1.0 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
                let white = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
                (moved * (compressed / peak)).lerp(DVec3::splat(compressed), white)
            }
        }
    };
    mapped.to_array().map(|x| {
        let x = x.clamp(0.0, 1.0);
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

/// One renderer per adapter, for one test at a time.
static RENDERERS: PerAdapter<Mutex<Renderer>> =
    PerAdapter::new(|context| Mutex::new(Renderer::new(context.clone()).expect("shaders that compile")));

pub(super) fn renderer(context: &Context) -> MutexGuard<'static, Renderer> {
    // A failed test leaves no state that affects others.
    RENDERERS.get(context).lock().unwrap_or_else(PoisonError::into_inner)
}

fn shot(context: &Context, look: &Look, environment: &Environment) -> Vec<[u8; 3]> {
    let mut renderer = renderer(context);
    let light = renderer.light(environment, &table(OEM)).expect("tables that fit");
    shot_by(context, &mut renderer, look, &light)
}

fn shot_by(context: &Context, renderer: &mut Renderer, look: &Look, light: &Light) -> Vec<[u8; 3]> {
    let truth = look.needs_truth().then(|| Truth::new(light.environment()).expect("an OEM"));
    let size = Screenshot { width: WIDTH, height: HEIGHT, samples: 1 };
    let picture = wait(context, screenshot(renderer, look, light, truth.as_ref(), size));
    picture.bytes().as_chunks().0.to_vec()
}

fn looks() -> Vec<(&'static str, Look)> {
    let look = Look { exposure: Exposure::Ev(-1.0), ..Look::default() };
    let camera = |yaw, pitch| Camera { yaw, pitch, ..Camera::default() };
    vec![
        ("box", Look { filter: Technique::Box, roughness: 0.4, ..look }),
        ("pyramid", Look { roughness: 0.7, tone: Tone::Aces, ..look }),
        ("a row by the pyramid", Look { object: Object::Row, tone: Tone::Reinhard, ..look }),
        (
            "a pyramid from below",
            Look {
                camera: camera(2.1, -1.0),
                turn: 77.0,
                backdrop: Some(0.5),
                tone: Tone::Linear,
                metal: [1.0, 0.7, 0.3],
                ..look
            },
        ),
        (
            "the true reflection",
            Look {
                filter: Technique::Reflect,
                turn: 77.0,
                roughness: 0.3,
                tone: Tone::Linear,
                metal: [1.0, 0.7, 0.3],
                ..look
            },
        ),
        (
            "brushed and coated",
            Look {
                filter: Technique::Reflect,
                turn: 77.0,
                roughness: 0.4,
                finish: Finish { anisotropy: 0.5, direction: 30.0, clearcoat: 0.6, coat_roughness: 0.2 },
                tone: Tone::Linear,
                metal: [1.0, 0.7, 0.3],
                ..look
            },
        ),
        ("a knot by the pyramid", Look { object: Object::Knot, camera: camera(0.5, 0.6), ..look }),
        ("adaptive", Look { filter: Technique::Adaptive, roughness: 0.25, backdrop: Some(0.3), ..look }),
    ]
}

#[test]
fn pictures_match_the_cpu() {
    let environment = synth("studio").expect("a recipe");
    let knot = Mesh::knot();
    let looks = looks();
    let expected: Vec<_> = looks
        .iter()
        .map(|(_, look)| expected(look, &environment, (look.object == Object::Knot).then_some(&knot)))
        .collect();
    in_full("view", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(OEM)).expect("tables that fit");
        for ((name, look), expected) in looks.iter().zip(&expected) {
            compare(name, look, &shot_by(context, &mut renderer, look, &light), expected);
        }
    });
}

fn compare(name: &str, look: &Look, found: &[[u8; 3]], expected: &[[u8; 3]]) {
    let off = difference(found, expected);
    let most = if look.object == Object::Knot { SNAPPED } else { SILHOUETTE };
    assert!(off <= most, "{name}: {:.2} % of the pixels are off", 100.0 * off);
}

/// One picture of a small environment, by the filter whose shader compiles fastest.
#[test]
fn a_picture_matches_the_cpu() {
    on_every_adapter("brief: picture", |context| {
        let layout = Layout::Panorama { width: 32, height: 16 };
        let texels = texels(&mut Random::new(140), common::Look::Smooth, layout);
        let environment = Environment::new(layout, texels).expect("as many texels");
        let (name, look) = &looks()[0];
        compare(name, look, &shot(context, look, &environment), &expected(look, &environment, None));
    });
}

#[test]
fn another_look_is_another_picture() {
    let environment = synth("studio").expect("a recipe");
    // A sphere that fills the picture's height.
    let camera = Camera { angle: Some(0.5), ..Camera::default() };
    let look = Look {
        filter: Technique::Box,
        roughness: 0.4,
        exposure: Exposure::Ev(-1.0),
        camera,
        ..Look::default()
    };
    let here = expected(&look, &environment, None);
    let changed = [
        Look { roughness: 0.43, ..look },
        Look { turn: 2.0, ..look },
        Look { exposure: Exposure::Ev(-0.95), ..look },
        Look { tone: Tone::Aces, ..look },
        Look { metal: [0.9, 0.93, 0.88], ..look },
        Look { backdrop: Some(0.4), camera: Camera { angle: None, ..camera }, ..look },
    ];
    for other in changed {
        let off = difference(&expected(&other, &environment, None), &here);
        assert!(off > 2.0 * SNAPPED, "{other:?} differs by {off} only");
    }
}

#[test]
fn pictures_are_the_same_every_time() {
    let environment = synth("sky").expect("a recipe");
    in_full("view twice", |context| {
        for (_, look) in looks().into_iter().skip(4).step_by(2) {
            let [first, second] = [(); 2].map(|()| shot(context, &look, &environment));
            assert_eq!(first, second, "{look:?}");
        }
    });
}

#[test]
fn bands_make_the_same_picture() {
    let environment = synth("sky").expect("a recipe");
    let format = wgpu::TextureFormat::Rgba8Unorm;
    in_full("view in bands", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(OEM)).expect("tables that fit");
        let shown = |renderer: &mut Renderer, look: &Look| {
            let texture = context.device().create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            let viewport = Viewport { x: 0, y: 0, width: WIDTH, height: HEIGHT };
            context.submit(|encoder| {
                renderer.present(Display { encoder, view: &view, format, viewport }, look);
            });
            wait(context, readback::read_texture::<[u8; 4]>(context, &texture))
        };
        for object in [Object::Row, Object::Knot] {
            let look = Look { object, ..Look::default() };
            renderer.draw(&look, &light, WIDTH, HEIGHT).expect("a picture");
            let whole = shown(&mut renderer, &look);
            let other = Look { exposure: Exposure::Ev(2.0), ..look };
            renderer.draw(&other, &light, WIDTH, HEIGHT).expect("another picture");
            let before = shown(&mut renderer, &other);
            assert_ne!(before, whole, "{object:?}: another picture");
            for rows in [0..1, 1..23, 23..63, 63..64] {
                assert_eq!(shown(&mut renderer, &other), before, "{object:?} before rows {rows:?}");
                renderer.draw_rows(&look, &light, (WIDTH, HEIGHT), rows).expect("a band");
            }
            assert_eq!(shown(&mut renderer, &look), whole, "{object:?}: in bands");
        }
    });
}

#[test]
fn a_furnace_is_white() {
    let environment = synth("furnace").expect("a recipe");
    in_full("white furnace", |context| {
        // A white metal that reflects all light, once or many times, is invisible.
        let white = Look {
            metal: [1.0; 3],
            ground: Ground::None,
            tone: Tone::Linear,
            exposure: Exposure::Ev(-1.0),
            ..Look::default()
        };
        let looks = [
            (Object::Row, Technique::Box),
            (Object::Row, Technique::Levels),
            (Object::Row, Technique::Pyramid),
            (Object::Knot, Technique::Pyramid),
            (Object::Row, Technique::Reflect),
            (Object::Row, Technique::Adaptive),
        ];
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(OEM)).expect("tables that fit");
        for (object, filter) in looks {
            let look = Look { object, filter, ..white };
            let found = shot_by(context, &mut renderer, &look, &light);
            let grey = display(Tone::Linear, DVec3::splat(0.5))[0];
            let off = |pixel: &[u8; 3]| pixel.iter().any(|c| c.abs_diff(grey) > 1);
            assert_eq!(found.iter().filter(|pixel| off(pixel)).count(), 0, "{object:?} by {filter:?}");
        }
        // A coat takes as much as it gives. Along a tangent, albedos are between nodes, and multiple
        // scattering is that of their mean.
        for (anisotropy, most) in [(0.0, 1), (0.5, 12)] {
            let finish = Finish { anisotropy, clearcoat: 0.7, coat_roughness: 0.3, ..Finish::NONE };
            let look = Look { filter: Technique::Reflect, roughness: 0.5, finish, ..white };
            let found = shot_by(context, &mut renderer, &look, &light);
            let grey = display(Tone::Linear, DVec3::splat(0.5))[0];
            let off = found.iter().flatten().map(|c| c.abs_diff(grey)).max();
            assert!(off <= Some(most), "a coat over anisotropy {anisotropy}: off by {off:?}");
        }
    });
}

#[test]
fn errors_are_black_where_there_are_none() {
    let environment = synth("furnace").expect("a recipe");
    in_full("view errors", |context| {
        let look = Look { show: Show::Error, filter: Technique::Pyramid, ..Look::default() };
        let dark = shot(context, &look, &environment);
        assert!(dark.iter().flatten().all(|c| *c < 60), "a furnace has no errors above 1e-4");
        let bright = shot(context, &look, &synth("sky").expect("a recipe"));
        let off = bright.iter().filter(|pixel| pixel[0] > 100).count();
        assert!(off > 100, "errors of a sky must be visible: {off} pixels");
    });
}

/// Errors of true reflections, of a metal of three reflectances, brushed or not: those of the CPU's look-ups
/// against the certified tier, pixel by pixel.
#[test]
fn errors_of_reflections_are_against_the_surfaces_own() {
    let layout = Layout::Panorama { width: 64, height: 32 };
    let environment = common::environment(layout, texels(&mut Random::new(14), common::Look::Suns, layout));
    let look = Look {
        show: Show::Error,
        filter: Technique::Reflect,
        roughness: 0.3,
        turn: 40.0,
        metal: [1.0, 0.5, 0.1],
        ..Look::default()
    };
    let brushed = Look { finish: Finish { anisotropy: 0.5, direction: 20.0, ..Finish::NONE }, ..look };
    let light = ReflectedLight::new(&environment);
    let pyramid = Pyramid::build(&environment, OEM).expect("a size");
    let source_from_world = DMat3::from_rotation_y(look.turn.to_radians()).transpose();
    let error = |look: &Look, index: u32| {
        let at = DVec2::new(f64::from(index % WIDTH) + 0.5, f64::from(index / WIDTH) + 0.5);
        let [normal, view, _] = look_along(look, at, None, 0.1).surface?;
        let around = DVec3::Y.cross(normal);
        let tangent = DMat3::from_axis_angle(normal, look.finish.direction.to_radians()) * around;
        let [normal, view, tangent] = [normal, view, tangent].map(|d| source_from_world * d);
        let frame = Frame::new(normal, view, tangent).expect("a frame");
        let anisotropy = look.finish.anisotropy;
        let truth =
            light.reflect(&frame, look.roughness, anisotropy, look.metal.map(f64::from), 1e-3).radiance;
        let given = pyramid.reflect(&frame, look.roughness as f32, anisotropy as f32, look.metal, 1.0);
        let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        Some(f64::from((luminance(given) / luminance(truth) - 1.0).abs()))
    };
    let looks = [look, brushed];
    let expected: Vec<Vec<Option<f64>>> = looks
        .iter()
        .map(|look| (0..WIDTH * HEIGHT).into_par_iter().map(|index| error(look, index)).collect())
        .collect();
    in_full("view errors of reflections", |context| {
        for (look, expected) in looks.iter().zip(&expected) {
            let found = shot(context, look, &environment);
            let far = |(found, error): (&[u8; 3], &Option<f64>)| {
                let Some(error) = error else { return false };
                // GPU and CPU differ by less than a hundredth: errors of that size may be any.
                let colours = (0..=40).map(|k| {
                    let error = error + 0.004 * (f64::from(k) / 20.0 - 1.0);
                    RELATIVE_ERROR.colour(error.abs().max(1e-6))
                });
                !colours.into_iter().any(|colour| (0..3).all(|c| colour[c].abs_diff(found[c]) <= 8))
            };
            let surface = expected.iter().flatten().count();
            let off = found.iter().zip(expected).filter(|pair| far(*pair)).count();
            assert!(surface > 500 && off * 50 < surface, "{off} of {surface} pixels are off: {look:?}");
            let seen = expected.iter().flatten().filter(|error| **error > 0.006).count();
            assert!(seen * 20 > surface, "errors must be visible: {seen} of {surface}");
        }
    });
}

#[test]
fn a_lamp_lights_what_is_seen() {
    let layout = Layout::Octahedral { size: OEM };
    let dark = Environment::new(layout, vec![[0.2; 3]; layout.texel_count()]).expect("an environment");
    let lamp = Lamp::new(DVec3::new(-0.5, 0.6, 0.3), 40.0, 0.1, 0.13);
    let lit = (0..layout.texel_count() as u32).map(|k| {
        let radiance = lamp.radiance_towards(layout.direction_from_texel(0, k % OEM, k / OEM));
        [(0.2 + radiance) as f32; 3]
    });
    let lit = Environment::new(layout, lit.collect()).expect("an environment");
    let look = Look { roughness: 0.4, exposure: Exposure::Ev(0.0), ..Look::default() };
    let [without, with] = [&dark, &lit].map(|environment| expected(&look, environment, None));
    assert!(difference(&without, &with) > 0.05, "the lamp must be visible");
    in_full("view of a lamp", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&dark, &table(OEM)).expect("tables that fit");
        for (lamp, expected) in [(Some(lamp), &with), (None, &without)] {
            light.set_lamp(context, lamp);
            let off = difference(&shot_by(context, &mut renderer, &look, &light), expected);
            assert!(off <= SILHOUETTE, "{lamp:?}: {:.2} % of the pixels are off", 100.0 * off);
        }
    });
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let environment = synth("furnace").expect("a recipe");
    let wrong = [
        Look { roughness: 1.5, ..Look::default() },
        Look { exposure: Exposure::Ev(f64::NAN), ..Look::default() },
        Look { camera: Camera { distance: 0.5, ..Camera::default() }, ..Look::default() },
    ];
    in_full("view refusals", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(32)).expect("tables that fit");
        let mut ask = |look: &Look, width| {
            let size = Screenshot { width, height: 8, samples: 1 };
            block_on(Some(context), screenshot(&mut renderer, look, &light, None, size)).expect("a device")
        };
        for look in &wrong {
            assert!(matches!(ask(look, 8), Err(Error::Parameter(_))), "{look:?}");
        }
        for width in [0, 100_000] {
            assert!(matches!(ask(&Look::default(), width), Err(Error::Parameter(_))), "{width} columns");
        }
        // A refusal does not affect later draws.
        assert!(ask(&Look::default(), 8).is_ok());
    });
}
