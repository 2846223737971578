//! Pictures of moving scenes: reflections against the CPU's of what rays from the probe see, from frame to
//! frame, and by every way to draw the probes.

use glam::{DVec2, DVec3};
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_core::sphere::octahedral::{direction_from_oct, texel_centre};
use octagloss_fixtures::adapters::{exceeds, in_full, wait};
use octagloss_fixtures::common::sweep;
use octagloss_gpu::Context;
use octagloss_gpu::direct::Method;
use octagloss_view::scene::{
    Gloss, Motion, Part, Proxy, Scene, SceneLight, SceneLook, SceneRenderer, SceneSettings,
    screenshot_of_scene,
};
use octagloss_view::{Camera, Screenshot, Tone};

const SIZE: u32 = 64;
const WIDTH: u32 = 48;
const HEIGHT: u32 = 32;

/// Half edges of the room, which the camera is in.
const ROOM: f64 = 6.0;

/// Radius of the glossy ball at the origin.
const BALL: f64 = 0.8;

fn settings() -> SceneSettings {
    SceneSettings { size: SIZE, ..SceneSettings::default() }
}

fn glossy(roughness: f64) -> Part {
    let gloss = Some(Gloss { reflectance: [0.9, 0.8, 0.7], roughness });
    Part { gloss, ..Part::ball(BALL, 48, [0.0; 3], [0.0; 3]) }
}

/// A room of grey walls with half edges of [`ROOM`].
fn room() -> Part {
    Part::room(DVec3::splat(ROOM), 1, |axis, _| [[0.4; 3], [0.1 + 0.1 * axis.x.abs() as f32; 3]])
}

/// Places and emission of two balls: a red one to the left of the default camera, which is at -X, and a blue
/// one to the right.
const LIT: [([f64; 3], [f32; 3]); 2] =
    [([-0.6, 0.1, -1.8], [3.0, 0.1, 0.1]), ([-0.6, 0.1, 1.8], [0.1, 0.1, 3.0])];

/// Their radius.
const RADIUS: f64 = 0.5;

/// A glossy ball in a room, between the two.
fn pair(roughness: f64) -> Scene {
    let lit = LIT.map(|(place, emission)| Part {
        place: DVec3::from_array(place),
        ..Part::ball(RADIUS, 24, [0.1; 3], emission)
    });
    let parts = [vec![room(), glossy(roughness)], lit.to_vec()].concat();
    Scene::new(parts, SceneLight::default()).expect("a scene")
}

/// Draws `scene` at `time`, with all probes up to date.
fn picture(renderer: &mut SceneRenderer, look: &SceneLook, time: f64) -> Vec<[f32; 3]> {
    renderer.set_time(time, look.roughness);
    let all: Vec<usize> = (0..renderer.probes()).collect();
    renderer.update(&all).expect("an update");
    renderer.draw(look, (WIDTH, HEIGHT)).expect("a picture");
    let pixels = wait(renderer.context(), renderer.pixels());
    assert!(pixels.iter().flatten().all(|value| value.is_finite()), "no pixel is NaN");
    pixels
}

fn renderer(context: &Context, scene: Scene, settings: SceneSettings) -> SceneRenderer {
    SceneRenderer::new(context.clone(), scene, settings).expect("a small scene")
}

/// The point of the ball at the origin that a pixel shows, if it is not close to the silhouette, and the unit
/// direction from the eye.
fn seen(look: &SceneLook, x: u32, y: u32) -> Option<[DVec3; 2]> {
    let frame = look.camera.frame(f64::from(WIDTH) / f64::from(HEIGHT), 0.3_f64.tan() * DVec2::new(1.5, 1.0));
    let place = DVec2::new(
        (f64::from(x) + 0.5) / f64::from(WIDTH) * 2.0 - 1.0,
        1.0 - (f64::from(y) + 0.5) / f64::from(HEIGHT) * 2.0,
    );
    let direction = (frame.forward + place.x * frame.right + place.y * frame.up).normalize();
    let along = frame.eye.dot(direction);
    // Away from the silhouette, where facets of the ball show.
    let beyond = along * along - frame.eye.length_squared() + (0.9 * BALL).powi(2);
    let under = along * along - frame.eye.length_squared() + BALL * BALL;
    (beyond > 0.0 && along < 0.0).then(|| [frame.eye - (along + under.sqrt()) * direction, direction])
}

/// Radiance of a matte surface in the default light.
fn matte(normal: DVec3, albedo: f64, emission: DVec3) -> DVec3 {
    let SceneLight { towards, lamp, above, below } = SceneLight::default();
    let three = |rgb: Rgb| DVec3::from_array(rgb.map(f64::from));
    let ambient = three(below).lerp(three(above), 0.5 + 0.5 * normal.y);
    albedo * (ambient + normal.dot(towards.normalize()).max(0.0) * three(lamp)) + emission
}

/// What a ray from the origin sees in the scene of [`pair`], by spheres and planes instead of triangles.
fn radiance(direction: DVec3) -> DVec3 {
    for (place, emission) in LIT {
        let centre = DVec3::from_array(place);
        let along = direction.dot(centre);
        let inside = along * along - centre.length_squared() + RADIUS * RADIUS;
        if along > 0.0 && inside > 0.0 {
            let normal = ((along - inside.sqrt()) * direction - centre) / RADIUS;
            return matte(normal, 0.1, DVec3::from_array(emission.map(f64::from)));
        }
    }
    let axis =
        DVec3::AXES.into_iter().max_by(|a, b| direction.dot(*a).abs().total_cmp(&direction.dot(*b).abs()));
    let axis = axis.expect("three axes");
    matte(-axis * direction.dot(axis).signum(), 0.4, DVec3::splat(0.1 + 0.1 * axis.x))
}

/// The probe's map as rays through its pixels see it.
fn map() -> Environment {
    let texel = |k: u32| -> Rgb {
        radiance(direction_from_oct(texel_centre(SIZE, k % SIZE, k / SIZE))).as_vec3().to_array()
    };
    let texels = (0..SIZE * SIZE).map(texel).collect();
    Environment::new(Layout::Octahedral { size: SIZE }, texels).expect("an environment")
}

/// Describes the first pixel of the ball that differs from the CPU's by more than the tolerance.
fn difference(
    pixels: &[[f32; 3]],
    look: &SceneLook,
    environment: &Environment,
    roughness: f64,
) -> Option<String> {
    let settings = ReflectorSettings { oem_size: Some(SIZE), pyramid: true, ..ReflectorSettings::default() };
    let reflector = Reflector::new(environment, &settings).expect("a small map");
    let mut compared = 0;
    for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
        let Some([at, direction]) = seen(look, x, y) else { continue };
        compared += 1;
        let normal = at.normalize();
        let mirrored = direction - 2.0 * direction.dot(normal) * normal;
        let towards = match look.proxy {
            Proxy::None => mirrored,
            // Out of the room.
            Proxy::Box => {
                let far = (ROOM * mirrored.signum() - at) / mirrored;
                at + far.min_element() * mirrored
            }
            Proxy::Sphere => {
                let (b, c) = (at.dot(mirrored), at.length_squared() - 3.0 * ROOM * ROOM);
                at + ((b * b - c).sqrt() - b) * mirrored
            }
        };
        let answer = reflector.query(towards, roughness, Lobe::Ggx, Filter::Pyramid).expect("a pyramid");
        for (c, reflectance) in [0.9, 0.8, 0.7].into_iter().enumerate() {
            let expected = reflectance * f64::from(answer.radiance[c]);
            let off = (f64::from(pixels[(y * WIDTH + x) as usize][c]) - expected).abs();
            // Silhouettes in a coarse map, and normals between corners.
            if exceeds(off, 0.03 + 0.05 * expected) {
                return Some(format!(
                    "pixel ({x}, {y}), channel {c}: {pixels:?}, not {expected}",
                    pixels = pixels[(y * WIDTH + x) as usize]
                ));
            }
        }
    }
    assert!(compared > 100, "{compared} pixels of the ball");
    None
}

#[test]
fn reflections_are_those_of_what_rays_from_the_probe_see() {
    let roughness = 0.4;
    let scene = pair(roughness);
    let environment = map();
    in_full("a reflecting scene", |context| {
        let mut renderer = renderer(context, scene.clone(), settings());
        for proxy in [Proxy::None, Proxy::Box, Proxy::Sphere] {
            let look = SceneLook { proxy, ..SceneLook::default() };
            let pixels = picture(&mut renderer, &look, 0.0);
            assert_eq!(difference(&pixels, &look, &environment, roughness), None, "{proxy:?}");
            // The comparison sees another proxy, and another roughness.
            let other = if proxy == Proxy::None { Proxy::Box } else { Proxy::None };
            let other = SceneLook { proxy: other, ..look };
            assert!(difference(&pixels, &other, &environment, roughness).is_some(), "{proxy:?}");
            assert!(difference(&pixels, &look, &environment, 0.2).is_some(), "{proxy:?}");
        }
        // The red ball is on the left, the blue one on the right.
        let look = SceneLook { roughness: Some(0.1), ..SceneLook::default() };
        let pixels = picture(&mut renderer, &look, 0.0);
        let of_ball = |left: bool, channel: usize| {
            let side = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
            side.filter(|(x, y)| (*x < WIDTH / 2) == left && seen(&look, *x, *y).is_some())
                .map(|(x, y)| pixels[(y * WIDTH + x) as usize][channel])
                .sum::<f32>()
        };
        assert!(of_ball(true, 0) > 1.2 * of_ball(false, 0), "red");
        assert!(of_ball(false, 2) > 1.2 * of_ball(true, 2), "blue");
    });
}

#[test]
fn all_exact_methods_give_one_picture() {
    let scene = pair(0.3);
    in_full("methods in a scene", |context| {
        let look = SceneLook::default();
        let mut renderer = renderer(context, scene.clone(), settings());
        let first = picture(&mut renderer, &look, 0.0);
        let ball: Vec<usize> = (0..WIDTH * HEIGHT)
            .filter(|k| seen(&look, k % WIDTH, k / WIDTH).is_some())
            .map(|k| k as usize)
            .collect();
        // Greatest and mean difference of the ball's pixels, relative to their radiance.
        let off = |other: &[[f32; 3]]| {
            let places = ball.iter().flat_map(|k| (0..3).map(move |c| (*k, c)));
            let all: Vec<f32> =
                places.map(|(k, c)| (first[k][c] - other[k][c]).abs() / (0.1 + first[k][c])).collect();
            (all.iter().copied().fold(0.0, f32::max), all.iter().sum::<f32>() / all.len() as f32)
        };
        for (method, greatest, mean) in [
            (Method::ClipMask, 1e-3, 1e-3),
            (Method::StrictSplit, 0.05, 1e-3),
            // Other texels, resampled.
            (Method::Cube, 0.5, 0.05),
            (Method::WholeCube, 0.5, 0.05),
        ] {
            renderer.configure(SceneSettings { method, ..settings() }).expect("a method");
            let off = off(&picture(&mut renderer, &look, 0.0));
            assert!(off.0 < greatest && off.1 < mean, "{method:?} differs by {off:?}");
        }
        renderer.configure(SceneSettings { method: Method::PerCorner, ..settings() }).expect("a method");
        let off = off(&picture(&mut renderer, &look, 0.0));
        assert!(off.1 > 0.1, "the comparison sees wrong projections: {off:?}");
    });
}

/// A bright ball on a great circle around the glossy one, through +X, +Y and the fold diagonals.
fn orbit(across: DVec3) -> Scene {
    let motion = Motion { axis: 2.4 * DVec3::X, across: 2.4 * across, rate: 1.0, phase: 0.0, spin: 0.0 };
    let lamp = Part { motion, ..Part::ball(0.45, 16, [0.1; 3], [4.0; 3]) };
    Scene::new(vec![room(), glossy(0.35), lamp], SceneLight::default()).expect("a scene")
}

#[test]
fn reflections_of_moving_objects_do_not_jump() {
    const STEPS: usize = 24;
    in_full("frames", |context| {
        // The lamp starts at the cone point +X. The first circle is in the horizon, which is a fold, the
        // second leads through the pole, and the third over folds between.
        let circles = [DVec3::Z, DVec3::Y, DVec3::new(0.0, -0.6, 0.8)];
        for across in circles.into_iter().take(sweep(1, 3)) {
            let mut renderer = renderer(context, orbit(across), settings());
            // A 24th of a round before and after +X, seen by a camera on the lamp's side.
            let look = SceneLook { camera: Camera { yaw: 4.0, ..Camera::default() }, ..SceneLook::default() };
            let frames: Vec<Vec<[f32; 3]>> = (0..=STEPS)
                .map(|k| (k as f64 / STEPS as f64 - 0.5) / 12.0)
                .map(|time| picture(&mut renderer, &look, time.rem_euclid(1.0)))
                .collect();
            let ball: Vec<usize> = (0..WIDTH * HEIGHT)
                .filter(|k| seen(&look, k % WIDTH, k / WIDTH).is_some())
                .map(|k| k as usize)
                .collect();
            let change = |a: &[[f32; 3]], b: &[[f32; 3]]| {
                let off = |k: &usize| f64::from((a[*k][1] - b[*k][1]).abs());
                ball.iter().map(off).fold(0.0, f64::max)
            };
            let mut changes: Vec<f64> = frames.windows(2).map(|pair| change(&pair[0], &pair[1])).collect();
            let worst = changes.iter().copied().fold(0.0, f64::max);
            changes.sort_by(f64::total_cmp);
            let median = changes[STEPS / 2];
            assert!(median > 0.0, "the lamp moves");
            assert!(worst < 2.5 * median, "{across}: a change of {worst}, where {median} is usual");
            // The measure sees a leap.
            let skipped = change(&frames[8], &frames[16]);
            assert!(skipped > 2.5 * median, "{skipped} {median}");
        }
    });
}

#[test]
fn probes_blend_and_reflect_each_other() {
    let gloss = |z: f64, roughness| Part { place: DVec3::new(0.0, 0.0, z), ..glossy(roughness) };
    let lamp = Part { place: DVec3::new(0.0, 2.4, 0.0), ..Part::ball(0.5, 12, [0.1; 3], [4.0; 3]) };
    let scene = Scene::new(vec![room(), gloss(-1.0, 0.2), gloss(1.0, 0.2), lamp], SceneLight::default())
        .expect("a scene");
    in_full("probes", |context| {
        let look = SceneLook::default();
        let mut renderer = renderer(context, scene.clone(), settings());
        assert_eq!(renderer.probes(), 2);
        let first = picture(&mut renderer, &look, 0.0);
        let second = picture(&mut renderer, &look, 0.0);
        let third = picture(&mut renderer, &look, 0.0);
        let change = |a: &[[f32; 3]], b: &[[f32; 3]]| {
            let pairs = a.as_flattened().iter().zip(b.as_flattened());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        let (once, twice) = (change(&first, &second), change(&second, &third));
        assert!(once > 0.01, "the first probe saw a black ball at first: {once}");
        assert!(twice < 0.3 * once, "reflections of reflections converge: {once}, {twice}");
        // One probe serves both balls; the second then reflects what the first one's probe sees.
        renderer.configure(SceneSettings { probes: 1, ..settings() }).expect("one probe");
        let one = picture(&mut renderer, &look, 0.0);
        assert!(change(&one, &third) > 0.01, "the second ball has no probe");
        let bright = |pixels: &[[f32; 3]]| pixels.as_flattened().iter().sum::<f32>();
        assert!((bright(&one) / bright(&third) - 1.0).abs() < 0.1, "shares of probes sum to 1");
    });
}

/// Describes the first pixel of the ball at the origin that differs by more than the tolerance from what the
/// probes at `centres` see in their maps, blended by `weight` of the squared distance.
fn blend_difference(
    pixels: &[[f32; 3]],
    look: &SceneLook,
    centres: &[DVec3],
    maps: &[Reflector<'_>],
    weight: impl Fn(f64) -> f64,
) -> Option<String> {
    let mut compared = 0;
    for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
        let Some([at, direction]) = seen(look, x, y) else { continue };
        compared += 1;
        let towards = direction.reflect(at.normalize());
        let weights: Vec<f64> = centres.iter().map(|centre| weight(at.distance_squared(*centre))).collect();
        let sum: f64 = weights.iter().sum();
        let mut expected = DVec3::ZERO;
        for (map, weight) in maps.iter().zip(weights) {
            let answer = map.query(towards, 0.3, Lobe::Ggx, Filter::Pyramid).expect("a pyramid");
            expected += weight / sum * DVec3::from_array(answer.radiance.map(f64::from));
        }
        let expected = expected * DVec3::new(0.9, 0.8, 0.7);
        let found = DVec3::from_array(pixels[(y * WIDTH + x) as usize].map(f64::from));
        // Normals between corners.
        if (found - expected).abs().cmpgt(0.01 + 0.04 * expected).any() {
            return Some(format!("pixel ({x}, {y}): {found}, not {expected}"));
        }
    }
    assert!(compared > 100, "{compared} pixels of the ball");
    None
}

#[test]
fn parts_without_a_probe_blend_all_in_one_draw() {
    let places = [DVec3::new(0.4, -0.3, -2.0), DVec3::new(-0.3, 0.5, 1.8), DVec3::new(1.2, 2.0, 0.2)];
    let others = places.map(|place| Part { place, ..glossy(0.3) });
    let lit = LIT.map(|(place, emission)| Part {
        place: 1.6 * DVec3::from_array(place),
        ..Part::ball(RADIUS, 24, [0.1; 3], emission)
    });
    // The ball at the origin comes last.
    let parts = [vec![room()], others.to_vec(), vec![glossy(0.3)], lit.to_vec()].concat();
    let scene = Scene::new(parts, SceneLight::default()).expect("a scene");
    in_full("blended probes", |context| {
        let look = SceneLook::default();
        let mut renderer = renderer(context, scene.clone(), SceneSettings { probes: 3, ..settings() });
        let pixels = picture(&mut renderer, &look, 0.0);
        let maps = [0, 1, 2].map(|probe| {
            let texels = wait(context, renderer.map(probe)).into_iter().map(|[r, g, b, _]| [r, g, b]);
            let layout = Layout::Octahedral { size: SIZE };
            Environment::new(layout, texels.collect()).expect("an environment")
        });
        let settings =
            ReflectorSettings { oem_size: Some(SIZE), pyramid: true, ..ReflectorSettings::default() };
        let maps = maps.each_ref().map(|map| Reflector::new(map, &settings).expect("a small map"));
        let judge = |centres: &[DVec3], weight: fn(f64) -> f64| {
            blend_difference(&pixels, &look, centres, &maps, weight)
        };
        assert_eq!(judge(&places, f64::recip), None, "on {}", context.describe());
        let [first, second, third] = places;
        assert!(judge(&[second, first, third], f64::recip).is_some(), "other places");
        assert!(judge(&places, |_| 1.0).is_some(), "equal shares");
        assert!(judge(&places[..1], f64::recip).is_some(), "one probe");
    });
}

#[test]
fn screenshots_are_deterministic_and_show_the_time() {
    in_full("scene screenshots", |context| {
        let look = SceneLook { tone: Tone::Linear, proxy: Proxy::Box, ..SceneLook::default() };
        let shot = Screenshot { width: WIDTH, height: HEIGHT, samples: 1 };
        let gallery = || Scene::gallery().expect("a scene");
        let taken = |time: f64| {
            let mut renderer = renderer(context, gallery(), settings());
            wait(context, screenshot_of_scene(&mut renderer, &look, time, shot, |_, _| {}))
        };
        let first = taken(1.0);
        assert_eq!(first, taken(1.0));
        assert_ne!(first, taken(1.5));
        let mut renderer = renderer(context, gallery(), settings());
        for (look, size) in [
            (look, (0, 8)),
            (SceneLook { roughness: Some(1.5), ..look }, (8, 8)),
            (SceneLook { exposure: f64::NAN, ..look }, (8, 8)),
        ] {
            renderer.draw(&look, size).expect_err("a picture that cannot be");
        }
        renderer.configure(SceneSettings { probes: 0, ..settings() }).expect_err("no probes");
    });
}
