//! Textures of moving scenes: pictures and maps of probes against a look-up of the image at the point that a
//! ray meets, and against the scene's own triangles.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::octahedral::{direction_from_oct, texel_centre};
use octagloss_fixtures::adapters::{in_full, wait};
use octagloss_fixtures::oracles::triangles::TriangleOracle;
use octagloss_gpu::Context;
use octagloss_gpu::direct::Method;
use octagloss_gpu::triangles::{DirectMap, Triangles};
use octagloss_view::scene::{
    Gloss, Part, Scene, SceneCorner, SceneLight, SceneLook, SceneRenderer, SceneSettings,
};
use octagloss_view::{Image, Texture, Wrap};

/// Edge of the probe's map.
const MAP: u32 = 64;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 64;

/// Half sides of the square with textures.
const HALF: f64 = 1.5;

/// The coordinates of textures are from 0 to this.
const UV: DVec2 = DVec2::new(2.0, 1.5);

/// Its albedo and its emission.
const ALBEDO: f64 = 0.5;
const EMISSION: f64 = 0.8;

/// Distance of the square from the probe.
const AWAY: f64 = 1.9;

/// Rounding of half floats, relative, and what 32-bit coordinates, levels and powers are off.
const HALVES: f64 = 1.0 / 2048.0;
const ROUNDING: f64 = 1e-3;

/// Greatest light of half a step of a byte in sRGB: 2.4 / 1.055 of an encoded 0.5 / 255.
const STEP: f64 = 0.0045;

fn light(byte: u8) -> f64 {
    let x = f64::from(byte) / 255.0;
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

fn byte(light: f64) -> u8 {
    let x = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * x).round() as u8
}

/// An image of `side` x `side` texels, in linear light by the coordinates of their centres.
fn image(side: u32, colour: impl Fn(DVec2) -> DVec3) -> Image {
    let centre = |k: u32| (DVec2::new(f64::from(k % side), f64::from(k / side)) + 0.5) / f64::from(side);
    let texel = |k: u32| {
        let [red, green, blue] = colour(centre(k)).to_array().map(byte);
        [red, green, blue, 255]
    };
    Image { width: side, height: side, texels: (0..side * side).map(texel).collect() }
}

/// The next mip level of `image`.
fn halved(from: &Image) -> Image {
    let texel = |x: u32, y: u32| {
        let [red, green, blue, _] = from.texels[(y * from.width + x) as usize];
        DVec3::from_array([red, green, blue].map(light))
    };
    image(from.width / 2, |uv| {
        let [x, y] = (uv * f64::from(from.width)).to_array().map(|x| x as u32);
        (texel(x - 1, y - 1) + texel(x, y - 1) + texel(x - 1, y) + texel(x, y)) / 4.0
    })
}

/// Red along u and green along v.
fn ramps(side: u32) -> Image {
    image(side, |uv| uv.extend(0.0))
}

/// Two by two blue squares.
fn checks(side: u32) -> Image {
    image(side, |uv| DVec3::Z * f64::from((uv.x < 0.5) != (uv.y < 0.5)))
}

/// What the CPU expects of the square's textures.
#[derive(Clone, Debug)]
struct Expected {
    base: Image,
    glow: Image,
    wrap: [Wrap; 2],
    flipped: bool,
    nearest: bool,
}

impl Expected {
    fn new(base: Image, glow: Image) -> Self {
        Self { base, glow, wrap: [Wrap::Mirror, Wrap::Repeat], flipped: false, nearest: false }
    }

    /// Others, each with one fault, which no comparison may accept.
    fn faults(&self) -> [Self; 4] {
        let Self { base, glow, .. } = self.clone();
        [
            Self { wrap: [Wrap::Repeat; 2], ..self.clone() },
            Self { wrap: [Wrap::Clamp, Wrap::Repeat], ..self.clone() },
            Self { flipped: true, ..self.clone() },
            Self { base: glow, glow: base, ..self.clone() },
        ]
    }

    /// The scene of the square at x = `x` and of a glossy ball at the origin, in a light of 1 from
    /// everywhere.
    fn scene(&self, x: f64) -> Scene {
        let texture = |image| Some(Texture { image, wrap: self.wrap, nearest: self.nearest });
        let corner = |uv: DVec2| {
            let [y, z] = [1.0 - 2.0 * uv.y, 2.0 * uv.x - 1.0].map(|side| (side * HALF) as f32);
            let uv = (uv * UV).as_vec2().to_array();
            SceneCorner::new([x as f32, y, z], [-1.0, 0.0, 0.0], [ALBEDO as f32; 3], [EMISSION as f32; 3])
                .at(uv)
        };
        let square = Part {
            corners: [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].map(corner).to_vec(),
            indices: vec![0, 1, 2, 0, 2, 3],
            base_texture: texture(0),
            emission_texture: texture(1),
            ..Part::default()
        };
        let gloss = Some(Gloss { reflectance: [0.9; 3], roughness: 0.3 });
        let ball = Part { gloss, ..Part::ball(0.1, 8, [0.0; 3], [0.0; 3]) };
        let light = SceneLight { lamp: [0.0; 3], above: [1.0; 3], below: [1.0; 3], ..SceneLight::default() };
        let images = [self.base.clone(), self.glow.clone()];
        Scene::textured(vec![square, ball], &images, light).expect("a scene")
    }

    /// Light of the texels around `uv` of `image`, with their weights.
    fn texels(&self, image: &Image, uv: DVec2) -> [(f64, DVec3); 4] {
        let uv = if self.flipped { DVec2::new(uv.x, UV.y - uv.y) } else { uv };
        let side = i64::from(image.width);
        let at = uv * side as f64 - if self.nearest { 0.0 } else { 0.5 };
        let low = at.floor();
        let share = if self.nearest { DVec2::ZERO } else { at - low };
        let place = |at: i64, wrap: Wrap| match wrap {
            Wrap::Repeat => at.rem_euclid(side),
            Wrap::Clamp => at.clamp(0, side - 1),
            Wrap::Mirror => {
                let around = at.rem_euclid(2 * side);
                around.min(2 * side - 1 - around)
            }
        };
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
            let x = place(low.x as i64 + i, self.wrap[0]);
            let y = place(low.y as i64 + j, self.wrap[1]);
            let [red, green, blue, _] = image.texels[(y * side + x) as usize];
            let of = |k: i64, share: f64| if k == 0 { 1.0 - share } else { share };
            (of(i, share.x) * of(j, share.y), DVec3::from_array([red, green, blue].map(light)))
        })
    }

    /// Radiance of the square at `uv`, by the finest texels.
    fn radiance(&self, uv: DVec2) -> DVec3 {
        ALBEDO * self.colour(&self.base, uv) + EMISSION * self.colour(&self.glow, uv)
    }

    fn colour(&self, image: &Image, uv: DVec2) -> DVec3 {
        self.texels(image, uv).into_iter().map(|(weight, light)| weight * light).sum()
    }

    /// Radiance of a corner at `uv` whose farthest neighbour is `spread` away along u or v: by the two mip
    /// levels whose texels are nearest that wide.
    fn radiance_of_corner(&self, uv: DVec2, spread: f64) -> DVec3 {
        let colour = |image: &Image| {
            let level = (spread * f64::from(image.width)).max(1.0).log2().min(f64::from(image.width).log2());
            let mut levels = vec![image.clone()];
            while levels.len() as f64 <= level.ceil() {
                levels.push(halved(&levels[levels.len() - 1]));
            }
            let [fine, coarse] = [level.floor(), level.ceil()].map(|k| self.colour(&levels[k as usize], uv));
            fine.lerp(coarse, level.fract())
        };
        ALBEDO * colour(&self.base) + EMISSION * colour(&self.glow)
    }

    /// Least and greatest radiance of texels as far as `reach` along u and v.
    fn range(&self, uv: DVec2, reach: f64) -> [DVec3; 2] {
        let steps = (2.0 * reach * f64::from(self.base.width.max(self.glow.width))).ceil() as i32;
        let offsets = || (-steps..=steps).map(|k| f64::from(k) / f64::from(steps) * reach);
        let mut all = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for offset in offsets().flat_map(|du| offsets().map(move |dv| DVec2::new(du, dv))) {
            let radiance = self.radiance(uv + offset);
            all = [all[0].min(radiance), all[1].max(radiance)];
        }
        all
    }
}

/// Coordinates of the textures where a ray meets the square at x = `x`; on its plane if outside of it.
fn met(eye: DVec3, direction: DVec3, x: f64) -> Option<DVec2> {
    let at = eye + (x - eye.x) / direction.x * direction;
    (direction.x * (x - eye.x) > 0.0).then(|| 0.5 * (DVec2::new(at.z, -at.y) / HALF + 1.0) * UV)
}

/// How far `uv` is inside of the square, in sides.
fn inside(uv: DVec2) -> f64 {
    (uv / UV).min(1.0 - uv / UV).min_element()
}

fn within(found: f64, [low, high]: [f64; 2], more: f64) -> bool {
    let more = more + ROUNDING + HALVES * high;
    found >= low - more && found <= high + more
}

/// The first pixel of the probe's map that no mean of texels in the reach of its corners explains.
fn map_difference(found: &[[f32; 4]], expected: &Expected) -> Option<String> {
    // Edges between corners are a 64th of the radius at most.
    let spread = (2.0_f64.sqrt() * HALF / 64.0) / (2.0 * HALF) * UV.max_element();
    // A corner reaches 1.5 texels of a level, which are up to twice the spread; pixels lie within a spread of
    // their corners. Drivers move corners by a sixteenth of a pixel, which is 0.1 at most here: 0.005 of u.
    let reach = 4.0 * spread + 0.005;
    let mut compared = [0; 2];
    for (k, found) in (0..).zip(found) {
        let direction = direction_from_oct(texel_centre(MAP, k % MAP, k / MAP));
        let uv = met(DVec3::ZERO, direction, AWAY);
        let depth = uv.map_or(-1.0, inside);
        if depth.abs() < 0.1 {
            continue;
        }
        compared[usize::from(depth > 0.0)] += 1;
        let [low, high] = match uv.filter(|_| depth > 0.0) {
            Some(uv) => expected.range(uv, reach),
            None => [DVec3::ZERO; 2],
        };
        for c in 0..3 {
            // Two levels, each of which rounds to bytes.
            if !within(f64::from(found[c]), [low[c], high[c]], 2.0 * STEP) {
                return Some(format!("pixel {k}, channel {c}: {found:?} is not within {low} to {high}"));
            }
        }
    }
    assert!(compared.iter().all(|count| *count > 100), "{compared:?} pixels");
    None
}

fn renderer(context: &Context, scene: Scene, method: Method) -> SceneRenderer {
    let settings = SceneSettings { size: MAP, method, ..SceneSettings::default() };
    SceneRenderer::new(context.clone(), scene, settings).expect("a small scene")
}

#[test]
fn maps_of_probes_show_textures() {
    let expected = Expected::new(ramps(64), checks(64));
    let scene = expected.scene(AWAY);
    in_full("textures in maps of probes", |context| {
        for method in [Method::Octants, Method::StrictSplit] {
            let mut renderer = renderer(context, scene.clone(), method);
            renderer.update(&[0]).expect("an update");
            let found = wait(context, renderer.map(0));
            assert_eq!(map_difference(&found, &expected), None, "{method:?}");
            for fault in expected.faults() {
                assert!(map_difference(&found, &fault).is_some(), "{method:?} {:?}", fault.wrap);
            }
        }
    });
}

#[test]
fn maps_of_probes_are_those_of_the_scene_s_triangles() {
    let expected = Expected::new(ramps(16), checks(16));
    let scene = expected.scene(AWAY);
    let all = scene.triangles(1).expect("triangles");
    let position = |index: u32| DVec3::from_array(all.corners()[index as usize].position.map(f64::from));
    let uv = |index: u32| met(DVec3::ZERO, position(index), AWAY).expect("a corner of the square");
    // Without those of the ball, which are points.
    let indices: Vec<u32> = all.indices().iter().copied().filter(|k| position(*k) != DVec3::ZERO).collect();
    let mut spreads = vec![0.0_f64; all.corners().len()];
    for [a, b, c] in indices.as_chunks().0 {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            let spread = (uv(from) - uv(to)).abs().max_element();
            for end in [from, to].map(|index| index as usize) {
                spreads[end] = spreads[end].max(spread);
            }
        }
    }
    let mut corners = all.corners().to_vec();
    for index in &indices {
        let radiance = expected.radiance_of_corner(uv(*index), spreads[*index as usize]);
        corners[*index as usize].value = radiance.as_vec3().extend(1.0).to_array();
    }
    let triangles = Triangles::new(corners, indices).expect("the square");
    let map = DirectMap::Octahedral { size: MAP };
    let oracle = TriangleOracle::new(&triangles, map, 0.02).expect("a valid map");
    let decided: Vec<_> = (0..MAP * MAP)
        .filter(|k| {
            let uv = met(DVec3::ZERO, direction_from_oct(texel_centre(MAP, k % MAP, k / MAP)), AWAY);
            uv.is_some_and(|uv| inside(uv) > 0.0)
        })
        .filter_map(|k| match oracle.pixel(k % MAP, k / MAP) {
            (hits, 0) if hits.len() == 1 => Some((k as usize, hits[0])),
            _ => None,
        })
        .collect();
    assert!(decided.len() > 50, "{}", decided.len());
    let difference = |found: &[[f32; 4]]| {
        decided.iter().find(|(k, hit)| {
            (0..4).any(|c| {
                let value = hit.value[c];
                // Drivers move corners by a sixteenth of a pixel.
                !within(f64::from(found[*k][c]), [value; 2], hit.value_change[c] / 16.0)
            })
        })
    };
    in_full("textures on triangles", |context| {
        let mut renderer = renderer(context, scene.clone(), Method::Octants);
        renderer.update(&[0]).expect("an update");
        let mut found = wait(context, renderer.map(0));
        let first = difference(&found);
        assert!(first.is_none(), "{first:?}: {:?}", first.map(|(k, _)| found[*k]));
        found[decided[20].0][0] += 0.1;
        assert!(difference(&found).is_some(), "the comparison sees a wrong pixel");
    });
}

/// The first pixel of a picture of the square at x = 0 that differs from its textures.
fn picture_difference(found: &[[f32; 3]], look: &SceneLook, expected: &Expected) -> Option<String> {
    let frame = look.camera.frame(f64::from(WIDTH) / f64::from(HEIGHT), 0.3_f64.tan() * DVec2::new(1.5, 1.0));
    let seen = |x: f64, y: f64| {
        let [x, y] = [2.0 * x / f64::from(WIDTH) - 1.0, 1.0 - 2.0 * y / f64::from(HEIGHT)];
        met(frame.eye, frame.forward + x * frame.right + y * frame.up, 0.0)
    };
    let mut compared = 0;
    for (k, found) in (0..).zip(found) {
        let centre = DVec2::new(f64::from(k % WIDTH), f64::from(k / WIDTH)) + 0.5;
        let Some(uv) = seen(centre.x, centre.y).filter(|uv| inside(*uv) > 0.05) else { continue };
        // The glossy ball is before the square.
        if ((uv / UV - 0.5) * 2.0 * HALF).length() < 0.3 {
            continue;
        }
        compared += 1;
        // Drivers move corners by a sixteenth of a pixel.
        let next = seen(centre.x + 1.0, centre.y + 1.0).expect("the plane");
        let [low, high] = expected.range(uv, (next - uv).abs().max_element() / 16.0);
        for c in 0..3 {
            if !within(f64::from(found[c]), [low[c], high[c]], 0.0) {
                return Some(format!("pixel {k}, channel {c}: {found:?} is not within {low} to {high}"));
            }
        }
    }
    assert!(compared > 1000, "{compared} pixels");
    None
}

fn picture(context: &Context, expected: &Expected) -> Vec<[f32; 3]> {
    let mut renderer = renderer(context, expected.scene(0.0), Method::Octants);
    renderer.draw(&SceneLook::default(), (WIDTH, HEIGHT)).expect("a picture");
    wait(context, renderer.pixels())
}

#[test]
fn pictures_show_textures() {
    // Texels are larger than pixels.
    let smooth = Expected::new(ramps(16), checks(16));
    let nearest = Expected { nearest: true, ..smooth.clone() };
    in_full("textures in pictures", |context| {
        for expected in [&smooth, &nearest] {
            let found = picture(context, expected);
            let look = SceneLook::default();
            assert_eq!(picture_difference(&found, &look, expected), None, "nearest: {}", expected.nearest);
            let other = Expected { nearest: !expected.nearest, ..expected.clone() };
            for fault in expected.faults().into_iter().chain([other]) {
                assert!(picture_difference(&found, &look, &fault).is_some(), "{:?}", fault.wrap);
            }
        }
    });
}

#[test]
fn distant_textures_are_means() {
    let grain = image(1024, |uv| {
        let odd = |x: f64| (1024.0 * x) as u32 % 2 == 1;
        DVec3::splat(f64::from(odd(uv.x) != odd(uv.y)))
    });
    let expected = Expected::new(grain, image(1, |_| DVec3::ZERO));
    let grey = ALBEDO * light(188);
    in_full("distant textures", |context| {
        let found = picture(context, &expected);
        let off = |pixel: &&[f32; 3]| pixel.iter().any(|x| (f64::from(*x) - grey).abs() > STEP);
        assert!(off(&&[0.0; 3]) && off(&&[ALBEDO as f32; 3]), "single texels are no mean");
        // Left of the glossy ball.
        let column = found.iter().skip(24).step_by(WIDTH as usize).skip(10).take(44);
        assert_eq!(column.clone().count(), 44);
        assert_eq!(column.filter(off).count(), 0, "{grey}: {:?}", &found[(20 * WIDTH) as usize..][..30]);
    });
}
