//! Scenes at the hard cases of maps and arithmetic, through every stage.

use crate::boxes::{one_box, packed, radiance_difference, solid_angle};
use crate::transfer::read_sat;
use glam::DVec3;
use octagloss_core::cpu::reflector::{Reflector as CpuReflector, ReflectorSettings};
use octagloss_core::cpu::reparameterise::oem_from_environment;
use octagloss_core::geometry::footprints::footprints_over;
use octagloss_core::light::environment::{Environment, Layout, Rgb};
use octagloss_core::light::oem::{Oem, OemSize};
use octagloss_core::light::sat::{Sat, Scan};
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::{Bound, Filter};
use octagloss_core::sphere::cube::{Face, direction_from_cube};
use octagloss_fixtures::adapters::{UNIT, exceeds, in_full, wait, with_passes};
use octagloss_fixtures::bounds::ServedOracle;
use octagloss_fixtures::bounds::luminance;
use octagloss_fixtures::common::{environment, landmarks};
use octagloss_fixtures::oracles::oem::OemOracle;
use octagloss_gpu::device::readback;
use octagloss_gpu::engine::{Engine, GpuReflector};
use octagloss_gpu::stages::reparameterise::{self, upload};
use octagloss_gpu::stages::{box_filter, fixed_point, sat_scan};
use octagloss_gpu::{Context, OemPlanes, SatPlanes};

/// The greatest half float, the usual radiance of suns in files.
const BRIGHTEST: f32 = 65_504.0;

/// Returns texels that are black except the one nearest to `direction`.
fn lone(layout: Layout, direction: DVec3) -> Vec<Rgb> {
    let mut texels = vec![[0.0; 3]; layout.texel_count()];
    let (mut nearest, mut index) = ((f64::NEG_INFINITY, 0), 0);
    environment(layout, texels.clone()).for_each_texel(|centre, _, _| {
        if centre.dot(direction) > nearest.0 {
            nearest = (centre.dot(direction), index);
        }
        index += 1;
    });
    texels[nearest.1] = [BRIGHTEST; 3];
    texels
}

fn scenes(layout: Layout) -> Vec<(String, Environment)> {
    let count = layout.texel_count();
    let mut scenes = vec![
        ("black".to_owned(), vec![[0.0; 3]; count]),
        ("furnace".to_owned(), vec![[0.25, 1.0, 3e4]; count]),
        ("alternating".to_owned(), (0..count).map(|k| [BRIGHTEST * (k % 2) as f32; 3]).collect()),
        ("subnormals".to_owned(), (1..=count).map(|k| [f32::from_bits(k as u32 * 7); 3]).collect()),
    ];
    for (name, place) in [
        ("upper pole", DVec3::Y),
        ("lower pole, the square's corner", DVec3::NEG_Y),
        ("fold edge", DVec3::new(1.0, 0.0, 1.0)),
        ("edge of the lower half", DVec3::new(-1.0, -1.0, 0.0)),
        ("edge midpoint +X", DVec3::X),
        ("edge midpoint -Z", DVec3::NEG_Z),
        ("face centre", DVec3::new(1.0, 1.0, -1.0)),
        ("lower face centre", DVec3::new(-1.0, -1.0, -1.0)),
    ] {
        scenes.push((name.to_owned(), lone(layout, place.normalize())));
    }
    scenes.into_iter().map(|(name, texels)| (name, environment(layout, texels))).collect()
}

/// The bound derived in the OEM's test; subnormal products may become 0.
fn gather_bound(environment: &Environment) -> f64 {
    let sources = environment.layout().texel_count() as f64;
    (8.0 + 2.0 * (64.0_f64.min(sources) + sources / 64.0)) * UNIT
}

fn far(expected: f32, found: f32, bound: f64) -> bool {
    let (e, f) = (f64::from(expected), f64::from(found));
    exceeds((e - f).abs(), bound * e + 2.4e-38)
}

fn gathered(context: &Context, environment: &Environment, size: OemSize) -> OemPlanes {
    let texture = upload(context, environment).expect("a small texture");
    let planes = OemPlanes::new(context, size).expect("small planes");
    let layout = environment.layout();
    let stage = reparameterise::stage(context, layout, &texture, &planes).expect("a small matrix");
    context.submit(|encoder| stage.record(encoder));
    planes
}

#[test]
fn scenes_pass_every_stage() {
    let layouts = [Layout::Cube { size: 8 }, Layout::Panorama { width: 32, height: 16 }];
    let size = OemSize { inner: 16, border: 3 };
    let directions = landmarks();
    in_full("scenes", |context| {
        for layout in layouts {
            for (name, source) in scenes(layout) {
                let case = format!("{name} of {layout:?} on {}", context.describe());
                // OEM.
                let expected = oem_from_environment(&source, size).expect("a small matrix");
                let planes = gathered(context, &source, size);
                let own = wait(context, planes.read(context));
                let bound = gather_bound(&source);
                for (k, (e, f)) in expected.texels().iter().zip(own.texels()).enumerate() {
                    assert!((0..4).all(|c| !far(e[c], f[c], bound)), "texel {k}: {f:?}, not {e:?}; {case}");
                }
                // Table, word for word, of the GPU's own OEM.
                let sat = SatPlanes::new(context, size).expect("small planes");
                let stages =
                    [fixed_point::stage(context, &planes, &sat), sat_scan::stage(context, &planes, &sat)];
                context.submit(|encoder| stages.iter().for_each(|stage| stage.record(encoder)));
                let textures = packed(context, &sat);
                let (fixed, entries) = wait(context, read_sat(context, &sat));
                let table = Sat::new(&own, Scan::default());
                assert_eq!(fixed, table.fixed_point(), "{case}");
                assert!(entries == table.entries(), "entries; {case}");
                // Boxes.
                for roughness in [0.0, 0.3, 0.8] {
                    let alpha: f64 = roughness * roughness;
                    let stack = one_box(solid_angle(Lobe::Ggx, alpha));
                    let answers = box_filter::radiance(context, &textures, &directions, &stack);
                    let found = wait(context, answers);
                    if name != "subnormals" {
                        let far = radiance_difference(&own, &table, (Lobe::Ggx, alpha), &directions, &found);
                        assert_eq!(far, None, "{roughness}; {case}");
                    }
                }
                // Footprints.
                let texture = upload(context, &source).expect("a small texture");
                let (stage, buffer) =
                    reparameterise::footprints(context, &source, &texture, 5).expect("a small cube");
                context.submit(|encoder| stage.record(encoder));
                let found: Vec<[f32; 4]> = wait(context, readback::read(context, &buffer));
                let expected = footprints_over(&source, Layout::Cube { size: 5 }).expect("a small matrix");
                for (k, (e, f)) in expected.iter().zip(&found).enumerate() {
                    assert!(
                        (0..3).all(|c| !far(e[c], f[c], bound)),
                        "footprint {k}: {f:?}, not {e:?}; {case}"
                    );
                }
            }
        }
    });
}

#[test]
fn lobes_of_scenes_are_certified() {
    let layout = Layout::Cube { size: 8 };
    let settings = ReflectorSettings { oem_size: Some(16), ..ReflectorSettings::default() };
    // Exhaustive integration of every scene.
    let cases: Vec<_> = scenes(layout)
        .into_iter()
        .map(|(name, source)| {
            let truths = [0.1, 0.4, 1.0].map(|roughness| {
                let reflector = CpuReflector::new(&source, &settings).expect("a small OEM");
                // In the source's units.
                let per_unit = f64::from(-reflector.light_exponent()).exp2();
                let texel = |x: u32, y: u32| {
                    let [r, g, b, w] = reflector.oem().texel(x, y).map(f64::from);
                    [per_unit * r, per_unit * g, per_unit * b, w]
                };
                let oracle = ServedOracle::new(&source, OemOracle::of_texels(16, texel), 16);
                let truth = |d: &DVec3| luminance(oracle.reflect(Lobe::Ggx, roughness, *d));
                (roughness, landmarks().iter().map(truth).collect::<Vec<f64>>())
            });
            (name, source, truths)
        })
        .collect();
    let directions = landmarks();
    with_passes("lobes of scenes", |context, passes| {
        for (name, source, truths) in &cases {
            let reflector = GpuReflector::new(passes, source, &settings).expect("a small OEM");
            for (roughness, truths) in truths {
                let filter = Filter::Adaptive(0.005);
                let query = reflector.query(&directions, Lobe::Ggx, *roughness, filter);
                for ((answer, truth), direction) in wait(context, query).iter().zip(truths).zip(&directions) {
                    let value = luminance(answer.radiance.map(f64::from));
                    let bound = f64::from(answer.bound.expect("a certified bound").luminance);
                    // The oracle integrates the CPU's OEM to the bilinear share, whose energies equal the
                    // GPU's within the gather's bound.
                    let allowed = bound + (ServedOracle::accuracy(Lobe::Ggx) + gather_bound(source)) * truth;
                    assert!(
                        (value - truth).abs() <= allowed,
                        "{name} {roughness} {direction}: {value}, not {truth} within {bound} on {}",
                        context.describe()
                    );
                    if name == "black" {
                        assert_eq!(
                            (answer.radiance, answer.bound),
                            ([0.0; 3], Some(Bound::default())),
                            "black stays black"
                        );
                    }
                }
            }
        }
    });
}

/// Returns the label of a quarter of a face: no two are equal or proportional.
fn label(face: Face, right: bool, lower: bool) -> Rgb {
    let k = face.index() as u32 * 4 + u32::from(right) + 2 * u32::from(lower);
    [1.0 + (k % 5) as f32, 1.0 + 2.0 * (k / 5) as f32, 1.0 + ((k * 7) % 24) as f32 * 0.25]
}

/// Returns a cube with labelled faces, with the labels of faces `a` and `b` swapped.
fn labelled(size: u32, [a, b]: [Face; 2]) -> Environment {
    let mut texels = Vec::new();
    for face in Face::ALL {
        let shown = if face == a {
            b
        } else if face == b {
            a
        } else {
            face
        };
        for (i, j) in (0..size * size).map(|k| (k % size, k / size)) {
            texels.push(label(shown, 2 * i >= size, 2 * j >= size));
        }
    }
    environment(Layout::Cube { size }, texels)
}

/// Returns the centre of every quarter of every face, with its label.
fn labels() -> Vec<(DVec3, Rgb)> {
    let quarters = [(false, false), (true, false), (false, true), (true, true)];
    Face::ALL
        .into_iter()
        .flat_map(|face| {
            quarters.map(|(right, lower)| {
                let place = |far: bool| if far { 0.5 } else { -0.5 };
                (direction_from_cube(face, place(right), place(lower)), label(face, right, lower))
            })
        })
        .collect()
}

/// Counts directions of `labels` that return another label than their own.
fn misplaced(
    context: &Context,
    passes: &Engine,
    source: &Environment,
    filter: Filter,
    from_world: impl Fn(DVec3) -> DVec3,
) -> usize {
    let settings = ReflectorSettings { oem_size: Some(32), ..ReflectorSettings::default() };
    let reflector = GpuReflector::new(passes, source, &settings).expect("a small OEM");
    let labels = labels();
    let directions: Vec<DVec3> = labels.iter().map(|(direction, _)| from_world(*direction)).collect();
    let answers = wait(context, reflector.query(&directions, Lobe::Ggx, 0.1, filter));
    let distance = |a: Rgb, b: Rgb| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f32>();
    let wrong = |(answer, own): (&octagloss_core::lobe::filter::Answer, &(DVec3, Rgb))| {
        let nearest = labels
            .iter()
            .map(|(_, label)| *label)
            .min_by(|a, b| distance(*a, answer.radiance).total_cmp(&distance(*b, answer.radiance)));
        nearest != Some(own.1)
    };
    answers.iter().zip(&labels).filter(|pair| wrong(*pair)).count()
}

#[test]
fn labelled_faces_stay_where_they_are() {
    with_passes("labelled faces", |context, passes| {
        let own = [Face::ALL[0]; 2];
        for filter in [Filter::Box, Filter::Adaptive(0.005)] {
            let case = format!("{filter:?} on {}", context.describe());
            let source = labelled(16, own);
            assert_eq!(misplaced(context, passes, &source, filter, |d| d), 0, "{case}");
            // +90 carries +Z to +X.
            let turned = labelled(16, own).rotated_y(90.0).expect("an angle");
            let carried = |d: DVec3| DVec3::new(d.z, d.y, -d.x);
            assert_eq!(misplaced(context, passes, &turned, filter, carried), 0, "turned; {case}");
            assert!(
                misplaced(context, passes, &turned, filter, |d| d) >= 16,
                "the turn is not detected; {case}"
            );
            for pair in
                [[Face::ALL[0], Face::ALL[1]], [Face::ALL[2], Face::ALL[3]], [Face::ALL[4], Face::ALL[0]]]
            {
                let swapped = labelled(16, pair);
                assert_eq!(
                    misplaced(context, passes, &swapped, filter, |d| d),
                    8,
                    "{pair:?} swapped; {case}"
                );
            }
        }
        // Footprints of the source's own size are its texels.
        let source = labelled(16, own);
        let texture = upload(context, &source).expect("a small texture");
        let (stage, buffer) =
            reparameterise::footprints(context, &source, &texture, 16).expect("a small cube");
        context.submit(|encoder| stage.record(encoder));
        let found: Vec<[f32; 4]> = wait(context, readback::read(context, &buffer));
        for (k, (e, f)) in source.texels().iter().zip(&found).enumerate() {
            let off = (0..3).any(|c| far(e[c], f[c], gather_bound(&source)));
            assert!(!off, "texel {k} is {f:?}, not {e:?}, on {}", context.describe());
        }
    });
}

/// Returns the first texel that differs, for injected faults.
fn oem_difference(expected: &Oem, found: &Oem, bound: f64) -> Option<usize> {
    let pairs = expected.texels().iter().zip(found.texels());
    pairs.into_iter().position(|(e, f)| (0..4).any(|c| far(e[c], f[c], bound)))
}

#[test]
fn faults_in_oems_are_detected() {
    let size = OemSize { inner: 16, border: 3 };
    in_full("faults in OEMs", |context| {
        let source = labelled(8, [Face::ALL[0]; 2]);
        let expected = oem_from_environment(&source, size).expect("a small matrix");
        let bound = gather_bound(&source);
        let found = |source: &Environment| wait(context, gathered(context, source, size).read(context));
        assert_eq!(oem_difference(&expected, &found(&source), bound), None, "the correct OEM passes");

        let mut one = source.texels().to_vec();
        one[200][2] *= 1.001;
        let one = environment(source.layout(), one);
        assert!(oem_difference(&expected, &found(&one), bound).is_some(), "one wrong texel");
        let swapped = labelled(8, [Face::ALL[2], Face::ALL[5]]);
        assert!(oem_difference(&expected, &found(&swapped), bound).is_some(), "swapped faces");
        let narrower = OemSize { inner: 16, border: 2 };
        let planes = gathered(context, &source, narrower);
        let read = wait(context, planes.read(context));
        // The same square with the border's rule off by one: each texel displaced by one.
        let side = size.bordered() as usize;
        let mut texels = vec![[0.0; 4]; side * side];
        for (k, texel) in read.texels().iter().enumerate() {
            texels[(k / (side - 2) + 2) * side + k % (side - 2) + 1] = *texel;
        }
        let off = Oem::from_bordered(size, texels);
        assert!(oem_difference(&expected, &off, bound).is_some(), "a border off by one");
    });
}
