//! The viewer's meshes and levels from files: colours follow from the materials, texels equal the file's.

use crate::view::renderer;
use glam::{DMat3, DVec3};
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::bake::dfg;
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::files::image::exposure::{self, Exposure};
use octagloss_core::light::chain::{Chain, Level};
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter as Bake;
use octagloss_core::sphere::cube::Face;
use octagloss_fixtures::adapters::{on_every_adapter, wait};
use octagloss_fixtures::common::Random;
use octagloss_mesh::Mesh;
use octagloss_view::screenshot;
use octagloss_view::{Levels, Light, Look, Object, Paint, Renderer, Screenshot, Technique, Tone};
use serde_json::{Value, json};

/// Settings for an OEM of `inner` texels along an edge.
fn table(inner: u32) -> ReflectorSettings {
    ReflectorSettings { oem_size: Some(inner), ..ReflectorSettings::default() }
}

/// Pixels along an edge: the middle one sees the origin.
const SIDE: u32 = 9;

/// Error of half floats, the split sum's table and the display's rounding.
const STEPS: u8 = 2;

fn picture(renderer: &mut Renderer, look: &Look, light: &Light) -> Vec<[u8; 3]> {
    let context = renderer.context().clone();
    let size = Screenshot { width: SIDE, height: SIDE, samples: 1 };
    let picture = wait(&context, screenshot(renderer, look, light, None, size));
    picture.bytes().as_chunks().0.to_vec()
}

fn middle(pixels: &[[u8; 3]]) -> [u8; 3] {
    pixels[(SIDE * SIDE / 2) as usize]
}

fn encoded(colour: DVec3) -> [u8; 3] {
    colour.to_array().map(|x| {
        let x = x.clamp(0.0, 1.0);
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

fn near(found: [u8; 3], expected: [u8; 3], what: &str) {
    let off = found.iter().zip(expected).any(|(a, b)| a.abs_diff(b) > STEPS);
    assert!(!off, "{what}: {found:?} instead of {expected:?}");
}

/// Builds a glTF of two squares across z with `materials` and a texture of `texels`; the second faces -Z.
fn squares(materials: &Value, texels: &[[u8; 4]]) -> Vec<u8> {
    let mut numbers: Vec<f32> = Vec::new();
    for (z, side) in [(0.1, 1.0), (-0.1, -1.0)] {
        numbers.extend([-side, -1.0, z, side, -1.0, z, side, 1.0, z, -side, 1.0, z]);
    }
    // Texture coordinates: the middle of the texture for all corners.
    numbers.extend([0.5; 8]);
    let mut bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 2, 3]);
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(texels.len() as u32, 1, |x, _| image::Rgba(texels[x as usize]));
    image.write_to(&mut png, image::ImageFormat::Png).expect("a picture");
    let uri = |bytes: &[u8]| format!("data:;base64,{}", base64::encode(bytes));
    let bounds = json!({"min": [-1, -1, -1], "max": [1, 1, 1]});
    let positions = |offset: u32| {
        json!({"bufferView": 0, "byteOffset": offset, "componentType": 5126, "count": 4, "type": "VEC3",
            "min": bounds["min"], "max": bounds["max"]})
    };
    let square = |positions: u32, material: usize| {
        json!({
            "attributes": {"POSITION": positions, "TEXCOORD_0": 2},
            "indices": 3,
            "material": material
        })
    };
    let json = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [square(0, 0), square(1, 1)]}],
        "materials": materials, "textures": [{"source": 0}], "images": [{"uri": uri(png.get_ref())}],
        "buffers": [{"byteLength": bytes.len(), "uri": uri(&bytes)}],
        "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "accessors": [positions(0), positions(48),
            {"bufferView": 0, "byteOffset": 96, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 0, "byteOffset": 128, "componentType": 5121, "count": 6, "type": "SCALAR"}]
    });
    json.to_string().into_bytes()
}

/// Returns the material `front`, and a blue one for the square behind.
fn materials(front: Value) -> Value {
    json!([{"pbrMetallicRoughness": front},
        {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 1, 1], "metallicFactor": 0}}])
}

/// Returns the share of white that a surface reflects at normal incidence.
fn reflected(f0: DVec3, roughness: f64) -> DVec3 {
    let [scale, bias] = dfg::ggx(1.0, roughness);
    (f0 * scale + bias) * (DVec3::ONE + f0 * (1.0 / (scale + bias) - 1.0))
}

fn front_look() -> Look {
    let look = Look {
        object: Object::Mesh,
        filter: Technique::Box,
        tone: Tone::Linear,
        exposure: Exposure::Ev(0.0),
        ..Look::default()
    };
    let mut camera = look.first_camera();
    camera.pitch = 0.0;
    Look { camera, ..look }
}

#[test]
fn materials_reflect_their_expected_colours() {
    let environment = octagloss_core::light::synth::synth("furnace").expect("a recipe");
    let gold = DVec3::new(1.0, 0.766, 0.336);
    let factors = |base: DVec3, metallic: f64, roughness: f64| {
        json!({"baseColorFactor": [base.x, base.y, base.z, 1], "metallicFactor": metallic,
            "roughnessFactor": roughness})
    };
    let plastic = |base: DVec3, roughness: f64| {
        let reflected = reflected(DVec3::splat(0.04), roughness);
        reflected + base * (DVec3::ONE - reflected)
    };
    // sRGB 188 is 0.5029 linear.
    let painted = json!({"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.5});
    let half = DVec3::new(0.5029, 1.0, 0.0);
    let worn = json!({"metallicRoughnessTexture": {"index": 0}, "baseColorFactor": [0.5, 0.5, 0.5, 1]});
    let grey = DVec3::splat(0.5);
    let (texel, other) = ([188, 255, 0, 255], [0, 102, 0, 255]);
    let tint = DVec3::new(0.5, 1.0, 0.25);
    let look = front_look();
    let tinted = Look { tint: tint.as_vec3().to_array(), roughness_factor: 0.5, ..look };
    let plain = Look { paint: Paint::Plain, metal: [0.9, 0.5, 0.1], roughness: 0.6, ..look };
    let cases = [
        ("gold", factors(gold, 1.0, 0.3), texel, &look, reflected(gold, 0.3)),
        ("black plastic", factors(DVec3::ZERO, 0.0, 0.3), texel, &look, plastic(DVec3::ZERO, 0.3)),
        ("red plastic", factors(DVec3::X, 0.0, 0.3), texel, &look, plastic(DVec3::X, 0.3)),
        ("white plastic", factors(DVec3::ONE, 0.0, 0.7), texel, &look, DVec3::ONE),
        ("a painted square", painted, texel, &look, plastic(half, 0.5)),
        // Green 102 is a roughness of 0.4; blue 0 is not metallic.
        ("a worn square", worn, other, &look, plastic(grey, 0.4)),
        ("tinted gold", factors(gold, 1.0, 0.6), texel, &tinted, reflected(gold * tint, 0.3)),
        ("a plain metal", factors(gold, 0.0, 0.1), texel, &plain, reflected(DVec3::new(0.9, 0.5, 0.1), 0.6)),
    ];
    on_every_adapter("view of materials", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(32)).expect("tables that fit");
        for (name, front, texel, look, expected) in &cases {
            let bytes = squares(&materials(front.clone()), &[*texel]);
            renderer
                .set_mesh(&Mesh::read_from_memory("squares.gltf".as_ref(), &bytes).expect("a mesh"))
                .expect("a small mesh");
            near(middle(&picture(&mut renderer, look, &light)), encoded(*expected), name);
        }
    });
}

#[test]
fn the_front_is_seen_first_and_masks_have_holes() {
    let environment = octagloss_core::light::synth::synth("furnace").expect("a recipe");
    let red = json!({"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 0});
    let mut hole = materials(json!({"baseColorTexture": {"index": 0}, "metallicFactor": 0}));
    hole[0]["alphaMode"] = json!("MASK");
    on_every_adapter("view of fronts", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(32)).expect("tables that fit");
        let mut seen = |bytes: &[u8], look: &Look| {
            renderer
                .set_mesh(&Mesh::read_from_memory("squares.gltf".as_ref(), bytes).expect("a mesh"))
                .expect("a small mesh");
            middle(&picture(&mut renderer, look, &light))
        };
        let squares_of_red = squares(&materials(red.clone()), &[[255; 4]]);
        let [r, g, b] = seen(&squares_of_red, &front_look());
        assert!(r > 200 && g < 128 && b < 128, "red must be in front: {r} {g} {b}");
        let mut behind = front_look();
        behind.camera.yaw += std::f64::consts::PI;
        let [r, _, b] = seen(&squares_of_red, &behind);
        assert!(b > 200 && r < 128, "from behind, blue must be in front: {r} {b}");
        // The hole shows the back of the blue square.
        let [r, _, b] = seen(&squares(&hole, &[[255, 0, 0, 100]]), &front_look());
        assert!(b > 200 && r < 128, "a hole: {r} {b}");
        let [r, _, b] = seen(&squares(&hole, &[[255, 0, 0, 200]]), &front_look());
        assert!(r > b, "no hole: {r} {b}");
    });
}

#[test]
fn diffuse_light_is_the_irradiance() {
    // A smooth environment that differs on every side.
    let layout = Layout::Panorama { width: 64, height: 32 };
    let radiance = |d: DVec3| [0.4 + 0.3 * d.z, 0.4 + 0.3 * d.y, 0.4 - 0.3 * d.x * d.z].map(|c| c as f32);
    let texels = (0..32).flat_map(|j| (0..64).map(move |i| (i, j)));
    let texels: Vec<Rgb> = texels.map(|(i, j)| radiance(layout.direction_from_texel(0, i, j))).collect();
    let environment =
        Environment::new(layout, texels).expect("an environment").rotated_y(25.0).expect("an angle");
    let settings = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
    let turned = environment.clone().rotated_y(30.0).expect("an angle");
    let reflector = Reflector::new(&turned, &settings).expect("an OEM");
    let glossy =
        reflector.query(DVec3::Z, 0.8, Lobe::Ggx, Bake::Box).expect("a lobe").radiance.map(f64::from);
    let reflected = reflected(DVec3::splat(0.04), 0.8);
    let diffuse =
        DVec3::from_array(Oracle::new(&turned).reflect(Lobe::Cosine, 0.0, DVec3::Z).expect("valid"));
    let base = DVec3::new(0.8, 0.6, 1.0);
    let expected = reflected * DVec3::from_array(glossy) + base * (DVec3::ONE - reflected) * diffuse;
    let front = json!({"baseColorFactor": [0.8, 0.6, 1, 1], "metallicFactor": 0, "roughnessFactor": 0.8});
    let bytes = squares(&materials(front), &[[255; 4]]);
    on_every_adapter("view of diffuse light", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(64)).expect("tables that fit");
        renderer
            .set_mesh(&Mesh::read_from_memory("squares.gltf".as_ref(), &bytes).expect("a mesh"))
            .expect("a small mesh");
        let look = Look { turn: 30.0, ..front_look() };
        near(middle(&picture(&mut renderer, &look, &light)), encoded(expected), "a white wall");
    });
}

/// Returns a chain with one colour per face in every level, times `scale`.
fn chain(scale: f32) -> Chain {
    let mut random = Random::new(7);
    let levels = [(4, 0.0), (2, 0.3), (1, 1.0)].map(|(size, roughness)| {
        let mut texels = Vec::new();
        for _ in Face::ALL {
            let colour: Rgb = std::array::from_fn(|_| scale * random.between(0.05, 0.95) as f32);
            texels.extend(vec![colour; (size * size) as usize]);
        }
        Level::cube(size, roughness, texels)
    });
    Chain { levels: levels.to_vec() }
}

#[test]
fn own_levels_are_shown_as_they_are() {
    let quarter = |degrees: f64| {
        Environment::new(Layout::Cube { size: 1 }, vec![[0.0; 3]; 6])
            .expect("an environment")
            .rotated_y(degrees)
            .expect("an angle")
            .source_from_world()
    };
    on_every_adapter("view of own levels", |context| {
        let mut renderer = renderer(context);
        for (scale, ev) in [(1.0, 0.0), (4096.0 * 4096.0, -24.0), (2.0_f32.powi(-20), 20.0)] {
            let chain = chain(scale);
            let level0 = Environment::new(Layout::Cube { size: 4 }, chain.levels[0].texels.clone())
                .expect("an environment");
            for turn in [0.0, 90.0] {
                let turned = level0.clone().rotated_y(turn).expect("an angle");
                let mut light = renderer.light(&turned, &table(32)).expect("tables that fit");
                let levels = Levels::new(chain.clone(), quarter(turn)).expect("levels").expect("several");
                light.set_levels(context, &levels).expect("a small cube");
                // The face that contains the world's +X.
                let face = if turn == 0.0 { Face::PosX } else { Face::PosZ };
                let texel = |level: usize| {
                    DVec3::from_array(chain.levels[level].face(face)[0].map(f64::from)) / f64::from(scale)
                };
                let cases =
                    [(0.0, texel(0)), (0.3, texel(1)), (0.65, 0.5 * (texel(1) + texel(2))), (1.0, texel(2))];
                // The last level is one texel per face: in the middle of a face no other contributes.
                for (roughness, expected) in cases {
                    let mut look = Look {
                        object: Object::Row,
                        filter: Technique::Levels,
                        backdrop: Some(roughness),
                        tone: Tone::Linear,
                        exposure: Exposure::Ev(ev),
                        ..Look::default()
                    };
                    look.camera.pitch = 0.0;
                    // Place the spheres far away, smaller than a pixel.
                    look.camera.distance = 900.0;
                    look.camera.angle = Some(0.02);
                    let pixels = picture(&mut renderer, &look, &light);
                    let above = pixels[(SIDE * (SIDE / 2 - 1) + SIDE / 2) as usize];
                    near(above, encoded(expected), &format!("roughness {roughness}, turned {turn}, {scale}"));
                }
            }
        }
    });
}

#[test]
fn levels_that_cannot_be_shown_are_refused() {
    let whole = chain(1.0);
    let one = Chain { levels: whole.levels[..1].to_vec() };
    assert!(Levels::new(one, DMat3::IDENTITY).expect("sound").is_none(), "one level is an environment");
    let mut falling = whole.clone();
    falling.levels[2].roughness = 0.2;
    let mut uneven = whole.clone();
    uneven.levels.remove(1);
    for (chain, words) in [(falling, "roughness 0.2 follows 0.3"), (uneven, "level 1 has 1 texels per side")]
    {
        let error = Levels::new(chain, DMat3::IDENTITY).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn automatic_exposure_is_that_of_the_environment() {
    let texels = chain(1000.0).levels.swap_remove(0).texels;
    let environment = Environment::new(Layout::Cube { size: 4 }, texels).expect("an environment");
    on_every_adapter("view by automatic exposure", |context| {
        let mut renderer = renderer(context);
        let light = renderer.light(&environment, &table(32)).expect("tables that fit");
        let expected = exposure::of_environment(&environment);
        assert!((light.exposure() - expected).abs() < 1e-9, "{} and {expected}", light.exposure());
        let look = Look { filter: Technique::Box, ..Look::default() };
        assert_eq!(look.exposure, Exposure::Auto, "the default");
        let fixed = Look { exposure: Exposure::Ev(expected), ..look };
        let other = Look { exposure: Exposure::Ev(0.0), ..look };
        let [automatic, fixed, other] = [look, fixed, other].map(|l| picture(&mut renderer, &l, &light));
        assert_eq!(automatic, fixed);
        assert_ne!(automatic, other);
        assert!(automatic.iter().flatten().any(|c| (64..192).contains(c)), "neither black nor white");
    });
}
