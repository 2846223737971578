//! Failures are reported as errors; nothing hangs or panics.

use crate::transfer::{Upload as _, bake_one};
use octagloss_core::bake::BakeSettings;
use octagloss_core::common::error::Error;
use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::geometry::tent::Reconstruction;
use octagloss_core::light::environment::{Environment, Layout};
use octagloss_core::light::oem::OemSize;
use octagloss_core::light::sat::Scan;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use octagloss_fixtures::adapters::{is_brief, wait, with_passes};
use octagloss_fixtures::common::{environment, oem};
use octagloss_gpu::engine::{Engine, GpuReflector};
use octagloss_gpu::stages::box_filter::SatTextures;
use octagloss_gpu::stages::cells;
use octagloss_gpu::stages::pyramid::PyramidMaps;
use octagloss_gpu::stages::reparameterise::{self, upload};
use octagloss_gpu::{Context, OemPlanes, SatPlanes, adapters, block_on};
use std::sync::mpsc;
use std::time::Duration;

/// Runs `test` with a separate device on every adapter that runs all tests, so that breaking it affects no
/// other test.
fn on_devices_of_their_own(limits: wgpu::Limits, test: impl Fn(Context)) {
    let adapters = block_on(None, adapters()).expect("no device to wait for");
    assert!(!adapters.is_empty(), "no adapter");
    for adapter in adapters.iter().filter(|adapter| !is_brief(&adapter.get_info().name)) {
        let context = Context::with_limits(adapter, limits.clone());
        test(block_on(None, context).and_then(|context| context).expect("a device"));
    }
}

/// Limits small enough to reach: one mebibyte per binding, textures of 256.
fn small() -> wgpu::Limits {
    wgpu::Limits {
        max_storage_buffer_binding_size: 1 << 20,
        max_texture_dimension_2d: 256,
        ..wgpu::Limits::default()
    }
}

/// Returns the last number of a limit error's remedy.
fn largest<T>(outcome: Result<T, Error>) -> u32 {
    match outcome {
        Err(Error::Limit { remedy, needed, available, what }) => {
            assert!(needed > available, "{what}: {needed} of {available}");
            let mut numbers = remedy.split(|c: char| !c.is_ascii_digit()).filter(|digits| !digits.is_empty());
            numbers.next_back().and_then(|digits| digits.parse().ok()).expect("a size in the remedy")
        }
        Err(other) => panic!("expected a limit error: {other}"),
        Ok(_) => panic!("must exceed a limit"),
    }
}

fn square(inner: u32) -> OemSize {
    OemSize { inner, border: 0 }
}

#[test]
fn limits_name_the_largest_size_that_fits() {
    on_devices_of_their_own(small(), |context| {
        let context = &context;
        // At four bytes per entry, 512 x 512 fits. At eight, 362 x 364 does not: rows are padded to a
        // multiple of four, so the remedy names 360.
        let fits = largest(OemPlanes::new(context, square(513)));
        assert_eq!(fits, 512);
        assert!(OemPlanes::new(context, square(fits)).is_ok());
        assert_eq!(
            largest(OemPlanes::new(context, OemSize { inner: 500, border: 7 })),
            512,
            "with its border"
        );
        let fits = largest(SatPlanes::new(context, square(400)));
        assert_eq!(fits, 360);
        assert!(SatPlanes::new(context, square(fits)).is_ok());
        assert!(SatPlanes::new(context, square(364)).is_err());

        let sat = SatPlanes::new(context, square(300)).expect("planes that fit");
        assert_eq!(largest(SatTextures::new(context, &sat)), 256);
        let sat = SatPlanes::new(context, square(256)).expect("planes that fit");
        assert!(SatTextures::new(context, &sat).is_ok());

        // 256 texels and their border are more than the device's textures of 256.
        let fits = largest(PyramidMaps::new(context, 512));
        assert_eq!(fits, 128);
        assert!(PyramidMaps::new(context, fits).is_ok());

        let tree = |inner| {
            let planes = OemPlanes::new(context, square(inner)).expect("planes that fit");
            cells::stage(context, &planes, 1, Reconstruction::Constant)
        };
        let fits = largest(tree(300));
        assert!((60..300).contains(&fits) && tree(fits).is_ok(), "{fits} fits");

        let wide = Layout::Panorama { width: 300, height: 150 };
        let wide = environment(wide, vec![[1.0; 3]; wide.texel_count()]);
        assert_eq!(largest(upload(context, &wide)), 256);

        let engine = Engine::new(context.clone()).expect("shaders that compile");
        let source = environment(Layout::Octahedral { size: 4 }, vec![[1.0; 3]; 16]);
        let settings = ReflectorSettings { oem_size: Some(600), ..ReflectorSettings::default() };
        assert_eq!(largest(GpuReflector::new(&engine, &source, &settings)), 512);
        let bake = |oem_size| {
            let settings = BakeSettings { size: 2, oem_size: Some(oem_size), ..BakeSettings::default() };
            wait_for(context, bake_one(&engine, &source, &settings))
        };
        // The cells have the tightest limit. A bake of the size named succeeds, and no error damaged the
        // device.
        let fits = largest(bake(600));
        assert!((60..512).contains(&fits), "{fits}");
        bake(fits).expect("an OEM that fits");
        context.check().expect("a usable device");
    });
}

fn wait_for<T>(
    context: &Context,
    future: impl Future<Output = octagloss_core::common::error::Result<T>>,
) -> octagloss_core::common::error::Result<T> {
    block_on(Some(context), future).and_then(|outcome| outcome)
}

#[test]
fn parameters_that_cannot_be_served_are_named() {
    with_passes("refused parameters", |context, engine| {
        let (layout, other) =
            (Layout::Panorama { width: 8, height: 4 }, Layout::Panorama { width: 8, height: 5 });
        let source = environment(layout, vec![[1.0; 3]; 32]);
        let texture = upload(context, &source).expect("a small texture");
        let planes = OemPlanes::new(context, square(4)).expect("small planes");
        for wrong in [other, Layout::Cube { size: 8 }, Layout::Octahedral { size: 8 }] {
            let outcome = reparameterise::stage(context, wrong, &texture, &planes);
            assert!(matches!(outcome, Err(Error::Parameter(_))), "{wrong:?} from {layout:?}");
        }
        assert!(reparameterise::stage(context, layout, &texture, &planes).is_ok());
        let turned = environment(other, vec![[1.0; 3]; 40]);
        let outcome = reparameterise::footprints(context, &turned, &texture, 2);
        assert!(matches!(outcome, Err(Error::Parameter(_))), "a texture of another environment");

        let settings = ReflectorSettings { oem_size: Some(8), ..ReflectorSettings::default() };
        let reflector = GpuReflector::new(engine, &source, &settings).expect("a small OEM");
        let up = [glam::DVec3::Y];
        for (roughness, filter) in [
            (-0.1, Filter::Box),
            (1.1, Filter::Box),
            (f64::NAN, Filter::Box),
            (0.5, Filter::Adaptive(0.0)),
            (0.5, Filter::Adaptive(1.0)),
            (0.5, Filter::Adaptive(f64::NAN)),
            (0.5, Filter::Pyramid),
        ] {
            let outcome = wait_for(context, reflector.query(&up, Lobe::Ggx, roughness, filter));
            assert!(matches!(outcome, Err(Error::Parameter(_))), "{roughness} {filter:?}");
        }
        let outcome = wait_for(context, reflector.query(&up, Lobe::Ggx, 0.5, Filter::Reference));
        assert!(matches!(outcome, Err(Error::Unsupported { .. })), "the reference filter");
        let serial = ReflectorSettings { scan: Scan::Serial, ..settings };
        let on_cpu = GpuReflector::new(engine, &source, &serial).expect("a small OEM");
        let outcome = wait_for(context, on_cpu.query(&up, Lobe::Ggx, 0.5, Filter::Box));
        assert!(matches!(outcome, Err(Error::Unsupported { .. })), "the serial scan");
        for inner in [16, 48, 4096] {
            let outcome = PyramidMaps::new(context, inner);
            assert!(matches!(outcome, Err(Error::Parameter(_))), "over {inner}");
        }
        let none = ReflectorSettings { oem_size: Some(0), ..ReflectorSettings::default() };
        assert!(matches!(GpuReflector::new(engine, &source, &none), Err(Error::Parameter(_))));
        // No directions give no answers.
        for filter in [Filter::Box, Filter::Adaptive(0.005)] {
            assert!(wait(context, reflector.query(&[], Lobe::Ggx, 0.5, filter)).is_empty(), "{filter:?}");
        }
        context.check().expect("a usable device");
    });
}

/// Runs `work` on its own thread and returns its result. Fails if it panics or hangs: half an hour exceeds
/// its time on a machine under any load.
fn in_time<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    let thread = std::thread::spawn(move || sender.send(work()));
    let outcome = receiver.recv_timeout(Duration::from_secs(1800)).expect("the work ends without a panic");
    thread.join().expect("no panic").expect("the receiver is alive");
    outcome
}

fn small_source() -> Environment {
    environment(Layout::Octahedral { size: 4 }, (0..16).map(|k| [k as f32; 3]).collect())
}

#[test]
fn a_lost_device_is_an_error() {
    on_devices_of_their_own(wgpu::Limits::default(), |context| {
        let name = context.describe();
        let engine = Engine::new(context.clone()).expect("shaders that compile");
        let settings =
            BakeSettings { size: 4, oem_size: Some(8), irradiance: Some(2), ..BakeSettings::default() };
        let bake = {
            let context = context.clone();
            move || wait_for(&context, bake_one(&engine, &small_source(), &settings)).map(|_| ())
        };
        bake().expect("a bake while the device is there");
        context.device().destroy();
        let outcome = in_time(bake);
        assert!(matches!(outcome, Err(Error::Gpu(_))), "{outcome:?} on {name}");
        let again = in_time(move || Engine::new(context).map(|_| ()));
        assert!(matches!(again, Err(Error::Gpu(_))), "{again:?} on {name}");
    });
}

#[test]
fn a_device_lost_in_the_middle_is_an_error() {
    on_devices_of_their_own(wgpu::Limits::default(), |context| {
        let name = context.describe();
        let source = oem(square(4), &[[1.0; 3]; 16]);
        let planes = OemPlanes::upload(&context, &source).expect("small planes");
        context.device().destroy();
        let outcome = in_time(move || wait_for(&context, planes.read(&context)).map(|_| ()));
        assert!(matches!(outcome, Err(Error::Gpu(_))), "{outcome:?} on {name}");
    });
}

#[test]
fn invalid_commands_are_errors_not_panics() {
    on_devices_of_their_own(wgpu::Limits::default(), |context| {
        context.check().expect("a usable device");
        // Exceeds the largest buffer size.
        let _ = context.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("too large"),
            size: 1 << 60,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let outcome = context.check();
        assert!(matches!(outcome, Err(Error::Gpu(_))), "{outcome:?}");
    });
}
