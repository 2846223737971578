//! Renders the output of `octagloss bake --target bevy` in Bevy with its asset loader, shading and skybox,
//! without a window.
//!
//! `octagloss-consumers-bevy FOLDER <JOBS >PICTURES`: a job is a line of words, its files beneath FOLDER;
//! `metal ROUGHNESS SPECULAR DIFFUSE X Y Z` and `diffuse ROUGHNESS SPECULAR DIFFUSE X Y Z` show a unit sphere
//! seen from (X, Y, Z), `sky ROUGHNESS SPECULAR DIFFUSE X Y Z` the skybox towards there, 90 degrees wide.
//! `recipe ROUGHNESS SPECULAR DIFFUSE X Y Z` is `metal` in the light of docs/engines.md, whose files are in
//! FOLDER. A picture is SIZE x SIZE pixels of four floats, rows upwards, of the radiance at the camera.

use std::error::Error;
use std::io::{BufRead, Write};

use bevy::camera::{Exposure, Hdr, RenderTarget, ScalingMode};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::image::Image;
use bevy::light::{EnvironmentMapLight, GlobalAmbientLight, Skybox};
use bevy::log::{Level, LogPlugin};
use bevy::prelude::*;
use bevy::render::gpu_readback::{Readback, ReadbackComplete};
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::window::ExitCondition;

mod recipe {
    include!(concat!(env!("OUT_DIR"), "/recipe.rs"));
}

const SIZE: u32 = 256;
/// Frames until a change is in the picture; the first compiles pipelines.
const SETTLED: usize = 3;
/// Frames to wait for files and pictures before it is an error.
const PATIENCE: usize = 10_000;

#[derive(Clone, Copy, PartialEq)]
enum Subject {
    Metal,
    Diffuse,
    Sky,
    Recipe,
}

struct Job {
    subject: Subject,
    roughness: f32,
    specular: String,
    diffuse: String,
    eye: Vec3,
}

impl Job {
    fn parse(line: &str) -> Result<Self, Box<dyn Error>> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [subject, roughness, specular, diffuse, x, y, z] = words[..] else {
            return Err(format!("seven words are needed: {line}").into());
        };
        let subject = match subject {
            "metal" => Subject::Metal,
            "diffuse" => Subject::Diffuse,
            "sky" => Subject::Sky,
            "recipe" => Subject::Recipe,
            _ => return Err(format!("no such subject: {subject}").into()),
        };
        let eye = Vec3::new(x.parse()?, y.parse()?, z.parse()?);
        Ok(Self {
            subject,
            roughness: roughness.parse()?,
            specular: specular.into(),
            diffuse: diffuse.into(),
            eye,
        })
    }
}

/// State changed by the jobs.
#[derive(Resource)]
struct Scene {
    camera: Entity,
    sphere: Entity,
    material: Handle<StandardMaterial>,
    picture: Handle<Image>,
}

#[derive(Resource, Default)]
struct Received(Option<Vec<u8>>);

fn set_up(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    let mut picture = Image::new_target_texture(SIZE, SIZE, TextureFormat::Rgba32Float, None);
    picture.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let picture = images.add(picture);
    let material = materials.add(StandardMaterial::default());
    let sphere = commands
        .spawn((Mesh3d(meshes.add(Sphere::new(1.0).mesh().uv(256, 128))), MeshMaterial3d(material.clone())))
        .id();
    let camera = commands
        .spawn((
            Camera3d::default(),
            Hdr,
            Msaa::Off,
            Tonemapping::None,
            // Exposure 1: the camera receives the maps' radiance.
            Exposure { ev100: -1.2_f32.log2() },
            RenderTarget::from(picture.clone()),
        ))
        .id();
    commands.insert_resource(Scene { camera, sphere, material, picture });
}

/// Puts the job's maps, material and view in the scene; returns the maps.
fn arrange(world: &mut World, job: &Job) -> [Handle<Image>; 2] {
    let assets = world.resource::<AssetServer>();
    let [specular_map, diffuse_map] = [assets.load(&job.specular), assets.load(&job.diffuse)];
    let light = recipe::sky_light(assets);
    let &Scene { camera, sphere, .. } = world.resource();
    let material = world.resource::<Scene>().material.clone();
    let metallic = if job.subject == Subject::Diffuse { 0.0 } else { 1.0 };
    world
        .resource_mut::<Assets<StandardMaterial>>()
        .insert(
            &material,
            // A dielectric without reflectance is only diffuse.
            StandardMaterial {
                base_color: Color::WHITE,
                metallic,
                reflectance: 0.0,
                perceptual_roughness: job.roughness,
                ..default()
            },
        )
        .expect("the material is the scene's own");
    let up = if job.eye.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
    let visible = if job.subject == Subject::Sky { Visibility::Hidden } else { Visibility::Visible };
    world.entity_mut(sphere).insert(visible);
    let mut camera = world.entity_mut(camera);
    if job.subject == Subject::Sky {
        camera.remove::<EnvironmentMapLight>().insert((
            Skybox { image: Some(specular_map.clone()), brightness: 1.0, ..default() },
            Transform::default().looking_to(job.eye, up),
            Projection::from(PerspectiveProjection { fov: std::f32::consts::FRAC_PI_2, ..default() }),
        ));
        return [specular_map, diffuse_map];
    }
    camera.remove::<Skybox>().insert((
        EnvironmentMapLight { diffuse_map, specular_map, intensity: 1.0, ..default() },
        Transform::from_translation(3.0 * job.eye).looking_at(Vec3::ZERO, up),
        Projection::from(OrthographicProjection {
            scaling_mode: ScalingMode::Fixed { width: 2.0, height: 2.0 },
            ..OrthographicProjection::default_3d()
        }),
    ));
    if job.subject == Subject::Recipe {
        camera.insert(light);
    }
    let light = camera.get::<EnvironmentMapLight>().expect("inserted");
    [light.specular_map.clone(), light.diffuse_map.clone()]
}

/// Updates until `done`.
fn wait(app: &mut App, what: &str, mut done: impl FnMut(&mut World) -> bool) -> Result<(), Box<dyn Error>> {
    for _ in 0..PATIENCE {
        if done(app.world_mut()) {
            return Ok(());
        }
        app.update();
    }
    Err(format!("no {what} after {PATIENCE} frames").into())
}

fn picture_of(app: &mut App, job: &Job) -> Result<Vec<u8>, Box<dyn Error>> {
    let maps = arrange(app.world_mut(), job);
    for map in &maps {
        wait(app, "map", |world| {
            let assets = world.resource::<AssetServer>();
            assets.is_loaded_with_dependencies(map) || assets.load_state(map).is_failed()
        })?;
        if app.world().resource::<AssetServer>().load_state(map).is_failed() {
            return Err(format!("{} or {} cannot be loaded", job.specular, job.diffuse).into());
        }
    }
    for _ in 0..SETTLED {
        app.update();
    }
    let world = app.world_mut();
    let picture = world.resource::<Scene>().picture.clone();
    let readback = world
        .spawn(Readback::texture(picture))
        .observe(|event: On<ReadbackComplete>, mut received: ResMut<Received>| {
            received.0 = Some(event.data.clone())
        })
        .id();
    wait(app, "picture", |world| world.resource::<Received>().0.is_some())?;
    app.world_mut().despawn(readback);
    Ok(app.world_mut().resource_mut::<Received>().0.take().unwrap_or_default())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: octagloss-consumers-bevy FOLDER <JOBS >PICTURES")?;
    let jobs =
        std::io::stdin().lock().lines().map(|line| Job::parse(&line?)).collect::<Result<Vec<_>, _>>()?;

    let mut app = App::new();
    app.add_plugins(
        DefaultPlugins
            .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
            .set(AssetPlugin { file_path: folder, ..default() })
            .set(LogPlugin { level: Level::WARN, ..default() }),
    )
    .insert_resource(GlobalAmbientLight::NONE)
    .init_resource::<Received>()
    .add_systems(Startup, set_up);
    app.finish();
    app.cleanup();
    app.update();

    let mut out = std::io::stdout().lock();
    for job in &jobs {
        let picture = picture_of(&mut app, job)?;
        let row = 16 * SIZE as usize;
        if picture.len() != row * SIZE as usize {
            return Err(format!("a picture of {} bytes", picture.len()).into());
        }
        for texels in picture.rchunks(row) {
            out.write_all(texels)?;
        }
    }
    Ok(())
}
