//! Tennis-ball maps by unwrapped corners, against rays through the pixels.

use glam::{DVec2, DVec3};
use octagloss_core::sphere::map::SphereMap as _;
use octagloss_core::sphere::tennis_ball::TennisBall;
use octagloss_fixtures::adapters::{PerAdapter, in_full, wait};
use octagloss_fixtures::meshes::closed;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;
use octagloss_gpu::direct::unwrap::{Remedy, Unwrap};
use octagloss_gpu::direct::{Direct, DirectMesh, DirectTarget, Method, Overlap};
use octagloss_gpu::triangles::{DirectMap, Triangles};

/// Pixels across a panel.
const SIZE: u32 = 40;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

static PIPELINES: PerAdapter<Unwrap> =
    PerAdapter::new(|context| Unwrap::new(context, FORMAT).expect("pipelines"));

/// An angle, in radians, that wrong triangles exceed.
const FAR: f64 = 0.1;

/// Draws a surface whose values are its positions; returns the values and the directions of the pixels in the
/// panels.
fn draw(context: &Context, surface: &Triangles, remedy: Remedy) -> Vec<([f32; 4], DVec3)> {
    let unwrap = PIPELINES.get(context);
    let mesh = DirectMesh::upload(context, surface).expect("a mesh that fits");
    let target = DirectTarget::new(context, DirectMap::TennisBall { size: SIZE }, FORMAT).expect("a target");
    let frame = unwrap.frame(remedy, &mesh, &target, 0.1).expect("a frame");
    context.submit(|encoder| frame.record(encoder, None));
    let values: Vec<[f32; 4]> = wait(context, readback::read_texture(context, &target.colour));
    let in_panels = values.into_iter().zip(0..).filter_map(|(value, k): ([f32; 4], u32)| {
        let (x, y) = (k % (3 * SIZE), k / (3 * SIZE));
        let panel = y / SIZE;
        let place = DVec2::new(f64::from(x) + 0.5, f64::from(y % SIZE) + 0.5) / f64::from(SIZE);
        let rectangle = TennisBall.component(panel);
        let uv = rectangle.low + place * rectangle.extent() / DVec2::new(3.0, 1.0);
        TennisBall.contains(panel, uv).then(|| (value, TennisBall.direction(panel, uv)))
    });
    in_panels.collect()
}

/// Angles between the points that pixels show and their rays; pi where they show nothing.
fn angles(pixels: &[([f32; 4], DVec3)]) -> Vec<f64> {
    let angle = |([x, y, z, covered], ray): &([f32; 4], DVec3)| match *covered {
        0.0 => std::f64::consts::PI,
        _ => DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)).angle_between(*ray),
    };
    pixels.iter().map(angle).collect()
}

fn mean(angles: &[f64]) -> f64 {
    angles.iter().sum::<f64>() / angles.len() as f64
}

/// Draws by each remedy; those of the paper give one picture, which is close to the rays'.
pub(super) fn remedies(context: &Context) {
    let surface = closed(12, Some(3), 1.0..1.0001);
    let kept = draw(context, &surface, Remedy::Keep);
    assert!(kept.len() > 2 * 80 * 40, "{} pixels", kept.len());
    let wrong = angles(&kept).iter().filter(|angle| **angle > FAR).count();
    assert!(wrong * 20 > kept.len(), "{wrong} pixels of {} show torn triangles", kept.len());
    let dropped = draw(context, &surface, Remedy::Drop);
    let greatest = angles(&dropped).into_iter().fold(0.0, f64::max);
    assert!(greatest < FAR, "{greatest}");
    for remedy in [Remedy::OneSide, Remedy::Alpha] {
        assert!(draw(context, &surface, remedy) == dropped, "{remedy:?}");
    }
}

#[test]
fn every_remedy_removes_triangles_across_the_seam() {
    in_full("unwrapped: remedies", remedies);
}

#[test]
fn errors_vanish_with_the_square_of_the_triangles_size() {
    in_full("unwrapped: errors", |context| {
        let off = |parts| mean(&angles(&draw(context, &closed(parts, Some(3), 1.0..1.0001), Remedy::Drop)));
        let [coarse, middle, fine] = [6, 12, 24].map(off);
        for ratio in [coarse / middle, middle / fine] {
            assert!((3.0..5.0).contains(&ratio), "{coarse}, {middle}, {fine}");
        }
    });
}

#[test]
fn other_targets_are_errors_that_name_the_remedy() {
    in_full("unwrapped: errors of targets", |context| {
        let target = |map, format| DirectTarget::new(context, map, format).expect("a target");
        let mesh = DirectMesh::upload(context, &closed(1, None, 1.0..2.0)).expect("a mesh that fits");
        let unwrap = PIPELINES.get(context);
        let tennis_ball = DirectMap::TennisBall { size: 8 };
        let half = wgpu::TextureFormat::Rgba16Float;
        for (target, near, part) in [
            (target(DirectMap::Octahedral { size: 8 }, FORMAT), 0.1, "choose a tennis-ball map"),
            (target(tennis_ball, half), 0.1, "Rgba16Float"),
            (target(tennis_ball, FORMAT), 0.0, "`near` is 0"),
        ] {
            let message = unwrap.frame(Remedy::Drop, &mesh, &target, near).expect_err("an error").to_string();
            assert!(message.contains(part), "{message}");
        }
        let direct = Direct::new(context, FORMAT, Overlap::Nearest).expect("pipelines");
        for method in [Method::Octants, Method::Cube] {
            let target = target(tennis_ball, FORMAT);
            let message = direct.frame(method, &mesh, &target, 0.1).expect_err("an error").to_string();
            assert!(message.contains("choose a"), "{message}");
        }
        Unwrap::new(context, wgpu::TextureFormat::Rgba8Unorm).expect_err("a format that is not drawn in");
    });
}
