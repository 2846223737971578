//! `octagloss bench --direct`: times the ways of drawing triangles into maps of the sphere, next to Table 1
//! of Engelhardt and Dachsbacher 2008, and prints JSON.

use super::args::BenchArgs;
use super::engine::any_adapter;
use super::outcome::{Outcome, print_pretty};
use super::timing::timing;
use crate::{Layout, OemSize, wgpu};
use octagloss_gpu::device::context::is_hardware;
use octagloss_gpu::device::readback;
use octagloss_gpu::device::timer::{Timer, accounts_for};
use octagloss_gpu::direct::unwrap::{Remedy, Unwrap, UnwrapFrame};
use octagloss_gpu::direct::{Direct, DirectFrame, DirectMesh, DirectTarget, Method, Overlap};
use octagloss_gpu::stages::reparameterise;
use octagloss_gpu::triangles::DirectMap;
use octagloss_gpu::triangles::scene::{NEAREST, scene};
use octagloss_gpu::{Context, OemPlanes, Stage, block_on};
use serde_json::{Value, json};
use std::time::Instant;

/// The paper's maps, of about as many pixels.
const QUADRATIC: DirectMap = DirectMap::Octahedral { size: 512 };
const RECTANGULAR: DirectMap = DirectMap::Rectangular { size: 362 };
const CUBE: DirectMap = DirectMap::Cube { size: 209 };

/// The same number for tennis-ball maps.
const TENNIS_BALL: DirectMap = DirectMap::TennisBall { size: 209 };

/// Frames per second of the paper's cube.
const PAPER_CUBE: f64 = 250.0;

/// Passes of a frame, at most: a list, six faces and the reparameterisation.
const PASSES: u32 = 8;

/// Texels of half floats.
type Picture = Vec<[u16; 4]>;

/// A way to fill a map.
struct Way<'a> {
    name: &'static str,
    target: &'a DirectTarget,
    frame: Frame,
    /// Cube to octahedral map.
    then: Option<Stage>,
    paper: Option<(&'static str, f64)>,
    seconds: Vec<f64>,
    list_seconds: Vec<f64>,
}

/// Draws into a map: projected triangles, or unwrapped ones.
enum Frame {
    Direct(DirectFrame),
    Unwrap(UnwrapFrame),
}

pub(super) fn run(args: &BenchArgs) -> Outcome {
    let adapter = any_adapter(args.engine.adapter.as_deref())?;
    let context = &block_on(None, Context::new(&adapter))??;
    let scene = scene();
    let mesh = DirectMesh::upload(context, &scene)?;
    // Half floats, as renderers have them.
    let format = wgpu::TextureFormat::Rgba16Float;
    let direct = Direct::new(context, format, Overlap::Nearest)?;
    let unwrap = Unwrap::new(context, format)?;
    let [square, rectangle, cube, ball] =
        [QUADRATIC, RECTANGULAR, CUBE, TENNIS_BALL].map(|map| DirectTarget::new(context, map, format));
    let (square, rectangle, cube, ball) = (&square?, &rectangle?, &cube?, &ball?);
    let planes = OemPlanes::new(context, OemSize { inner: QUADRATIC.size(), border: 0 })?;
    let layout = Layout::Cube { size: CUBE.size() };
    let resample = reparameterise::stage(context, layout, &cube.colour, &planes)?;

    let way = |name, target, method, then, paper| -> Outcome<Way<'_>> {
        let frame = Frame::Direct(direct.frame(method, &mesh, target, NEAREST)?);
        Ok(Way { name, target, frame, then, paper, seconds: Vec::new(), list_seconds: Vec::new() })
    };
    let unwrapped = |name, remedy| -> Outcome<Way<'_>> {
        let frame = Frame::Unwrap(unwrap.frame(remedy, &mesh, ball, NEAREST)?);
        let (target, seconds, list_seconds) = (ball, Vec::new(), Vec::new());
        Ok(Way { name, target, frame, then: None, paper: None, seconds, list_seconds })
    };
    let mut ways = vec![
        way("octants", square, Method::Octants, None, None)?,
        way("clip mask", square, Method::ClipMask, None, Some(("Perspective QL, clip mask", 95.0)))?,
        way("strict split", square, Method::StrictSplit, None, Some(("Planar QL, strict split", 16.0)))?,
        way("per corner", square, Method::PerCorner, None, None)?,
        way("octants", rectangle, Method::Octants, None, None)?,
        way("XZ-split", rectangle, Method::XzSplit, None, Some(("Planar RL, XZ-split", 34.0)))?,
        way("edge strip", rectangle, Method::EdgeStrip, None, Some(("Planar RL, edge strip", 3.0)))?,
        way("cube", cube, Method::Cube, None, None)?,
        way("whole cube", cube, Method::WholeCube, None, Some(("Cube Map", PAPER_CUBE)))?,
        way("cube, reparameterised", cube, Method::Cube, Some(resample), None)?,
        unwrapped("unwrapped, dropped", Remedy::Drop)?,
        unwrapped("unwrapped, one side", Remedy::OneSide)?,
        unwrapped("unwrapped, alpha", Remedy::Alpha)?,
        unwrapped("unwrapped, kept", Remedy::Keep)?,
    ];
    let timer = timer(context, &ways)?;
    // In turn, so that other load on the machine meets all ways; the first turn warms up.
    for turn in 0..=args.runs {
        for way in &mut ways {
            let (list, seconds) = way.time(context, timer.as_ref())?;
            if turn > 0 {
                way.seconds.push(seconds);
                way.list_seconds.extend(list);
            }
        }
    }
    let median = |name: &str| {
        let way = ways.iter().find(|way| way.name == name).expect("a way of the list");
        timing(way.seconds.clone()).median_seconds
    };
    let (over_cube, over_whole_cube) = (median("cube"), median("whole cube"));
    let picture = |way: &Way<'_>| -> Outcome<Option<Picture>> {
        if way.target.map() == CUBE {
            return Ok(None);
        }
        context.submit(|encoder| way.frame.record(encoder, None));
        Ok(Some(block_on(Some(context), readback::read_texture(context, &way.target.colour))??))
    };
    // The first method of each layout.
    let mut exact: Option<(DirectMap, Picture)> = None;
    let methods = ways.iter().map(|way| {
        let (map, own) = (way.target.map(), picture(way)?);
        if let Some(own) = own.as_ref().filter(|_| exact.as_ref().is_none_or(|(other, _)| *other != map)) {
            exact = Some((map, own.clone()));
        }
        let differing = own.as_ref().zip(exact.as_ref()).map(|(own, (_, exact))| differing(exact, own));
        let drawn = way.frame.triangles(context)?;
        let time = timing(way.seconds.clone());
        Ok(json!({
            "method": way.name,
            // Of the octahedral map, or another map.
            "layout": match map {
                QUADRATIC => "quadratic",
                RECTANGULAR => "rectangular",
                TENNIS_BALL => "tennis ball",
                _ => "cube",
            },
            "pixels": map.pixels(),
            // Triangles of all draws, or pieces of triangles.
            "drawn": drawn,
            "time": time,
            // Of that, the pass that lists or cuts triangles.
            "list": (!way.list_seconds.is_empty()).then(|| timing(way.list_seconds.clone())),
            // Time relative to the cube's, drawn with lists of triangles and without.
            "over_cube": time.median_seconds / over_cube,
            "over_whole_cube": time.median_seconds / over_whole_cube,
            // Share of pixels that differ by more than a 64th from those of the first method in the same
            // layout.
            "differing": differing,
            // The row of Table 1, its frames per second, and its time relative to the paper's cube.
            "paper": way.paper.map(|(name, _)| name),
            "paper_frames_per_second": way.paper.map(|(_, rate)| rate),
            "paper_over_cube": way.paper.map(|(_, rate)| PAPER_CUBE / rate),
        }))
    });
    let methods = methods.collect::<Outcome<Vec<Value>>>()?;
    context.check()?;
    print_pretty(&json!({
        "version": env!("CARGO_PKG_VERSION"),
        "adapter": context.describe(),
        "software": !is_hardware(&context.device().adapter_info()),
        // What measures: timestamp queries, or the time from submission to completion.
        "clock": if timer.is_some() { "timestamps" } else { "submission to completion" },
        "triangles": scene.count(),
        "runs": args.runs,
        "methods": methods,
    }))
}

/// Share of the texels of half floats that differ by more than a 64th in a channel.
fn differing(exact: &[[u16; 4]], other: &[[u16; 4]]) -> f64 {
    let number = |bits: u16| half::f16::from_bits(bits).to_f32();
    let differs = |(a, b): &(&[u16; 4], &[u16; 4])| {
        a.iter().zip(*b).any(|(a, b)| (number(*a) - number(*b)).abs() > 1.0 / 64.0)
    };
    exact.iter().zip(other).filter(differs).count() as f64 / exact.len() as f64
}

impl Frame {
    const fn has_list(&self) -> bool {
        match self {
            Self::Direct(frame) => frame.has_list(),
            Self::Unwrap(_) => false,
        }
    }

    fn passes(&self) -> u32 {
        match self {
            Self::Direct(frame) => frame.passes(),
            Self::Unwrap(_) => 1,
        }
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder, timer: Option<&Timer>) {
        match self {
            Self::Direct(frame) => frame.record(encoder, timer),
            Self::Unwrap(frame) => frame.record(encoder, timer),
        }
    }

    /// Triangles of all draws.
    fn triangles(&self, context: &Context) -> Outcome<u64> {
        Ok(match self {
            Self::Direct(frame) => {
                block_on(Some(context), frame.triangles(context))??.into_iter().map(u64::from).sum()
            }
            Self::Unwrap(frame) => u64::from(frame.triangles()),
        })
    }
}

/// Timestamps for `ways`, if the adapter has them and they agree with the time from submission to completion.
/// Draws each of the ways by both clocks.
fn timer(context: &Context, ways: &[Way<'_>]) -> Outcome<Option<Timer>> {
    let Ok(timer) = Timer::new(context, PASSES) else { return Ok(None) };
    for way in ways {
        let (_, seconds) = way.time(context, Some(&timer))?;
        // Other programs may hold up a run.
        let mut tries = 3;
        while !accounts_for(seconds, way.time(context, None)?.1) {
            tries -= 1;
            if tries == 0 {
                return Ok(None);
            }
        }
    }
    Ok(Some(timer))
}

impl Way<'_> {
    /// Seconds of a frame's list, if known, and from the beginning of its first pass to the end of its last;
    /// without a `timer` from submission to completion.
    fn time(&self, context: &Context, timer: Option<&Timer>) -> Outcome<(Option<f64>, f64)> {
        let start = Instant::now();
        let passes = self.frame.passes();
        context.submit(|encoder| {
            self.frame.record(encoder, timer);
            if let Some(stage) = &self.then {
                stage.record_timed(encoder, timer.map(|timer| timer.compute_writes(passes)));
            }
        });
        if let Some(timer) = timer {
            let passes = passes + u32::from(self.then.is_some());
            let [first, whole] = block_on(Some(context), timer.first_and_whole(context, passes))??;
            return Ok((self.frame.has_list().then_some(first), whole));
        }
        context.device().poll(wgpu::PollType::wait_indefinitely()).map_err(|error| {
            crate::Error::Gpu(format!("{} stopped responding: {error}", context.describe()))
        })?;
        Ok((None, start.elapsed().as_secs_f64()))
    }
}
