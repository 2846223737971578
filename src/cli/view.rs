//! `octagloss view`: renders objects lit by an environment, in a window or to a picture.

use super::console::Console;
use super::outcome::{Outcome, or_usage, usage, write_output};
use super::view_args::ViewArgs;
use super::{input, view_scene};
use crate::{Environment, Layout, ReflectorSettings};
use octagloss_core::files::io::LoadedChain;
use octagloss_core::files::io::ldr::png_bytes;
use octagloss_core::light::synth::synth;
use octagloss_core::pyramid;
use octagloss_gpu::block_on;
use octagloss_view::{
    Levels, Mesh, Renderer, Screenshot, Start, Technique, Truth, run as run_window, screenshot,
};
use std::sync::Arc;

pub(super) fn run(args: ViewArgs) -> Outcome {
    let mut look = args.look.look();
    or_usage(look.check())?;
    or_usage(args.oem_size.map(pyramid::Levels::over).transpose())?;
    if args.scene.scene.is_some() {
        return view_scene::run(args);
    }
    let console = Console::new(args.quiet);
    let root = args.look.mesh_root.as_deref();
    let mesh = args.look.mesh.as_deref().map(|path| Mesh::read_within(path, root)).transpose()?;
    let (environment, name) = environment(&args, &console)?;
    let levels = levels(&args, &environment, &console)?;
    if levels.is_some() && args.look.filter.is_none() && !args.look.has_finish() {
        look.filter = Technique::Levels;
    }
    if args.look.has_finish() && look.filter != Technique::Reflect {
        return usage(format!(
            "--anisotropy and --clearcoat are for --filter reflect; --filter {} shows neither",
            look.filter
        ));
    }
    let table = ReflectorSettings {
        oem_size: args.oem_size,
        border: Some(args.border),
        scan: args.scan.unwrap_or_default(),
        ..ReflectorSettings::default()
    };
    let Some(path) = &args.screenshot else {
        let ViewArgs { adapter, size, .. } = args;
        return Ok(run_window(Start { environment, name, levels, mesh, look, table, adapter, size })?);
    };
    if let Some(scan) = args.scan.filter(|_| !look.reads_sat()) {
        return usage(format!(
            "--scan {scan} is for pictures from a summed-area table, but --filter {} reads none; use box, or \
             omit --scan",
            look.filter
        ));
    }
    let inputs = args.inputs.iter().chain(&args.look.mesh);
    let (existing, context) = args.prepared(path, inputs, &console)?;
    let mut renderer = Renderer::new(context.clone())?;
    if let Some(mesh) = &mesh {
        renderer.set_mesh(mesh)?;
    }
    let mut light = renderer.light(&environment, &table)?;
    if let Some(levels) = &levels {
        light.set_levels(&context, levels)?;
    }
    let truth = look.needs_truth().then(|| Truth::new(light.environment())).transpose()?;
    let (width, height) = args.size;
    let shot = Screenshot { width, height, samples: args.samples };
    let picture = block_on(Some(&context), screenshot(&mut renderer, &look, &light, truth.as_ref(), shot))??;
    write_output(path, existing, &png_bytes(&picture)?)
}

/// The given environment, or the built-in sky, and its name.
fn environment(args: &ViewArgs, console: &Console) -> Outcome<(Environment, String)> {
    if args.inputs.is_empty() {
        return Ok((synth("sky")?, "sky".to_owned()));
    }
    let source = input::single_source(args.inputs.clone(), &args.input)?;
    let environment = source.open(&args.input, console)?.environment;
    Ok((Arc::unwrap_or_clone(environment), source.stem()))
}

/// The levels of the input, if it is a bake with several. `None` with `--extract-sun`: the levels still
/// contain the sun.
fn levels(args: &ViewArgs, environment: &Environment, console: &Console) -> Outcome<Option<Levels>> {
    let ([path], false) = (&args.inputs[..], args.input.extract_sun.is_some()) else { return Ok(None) };
    let Some(LoadedChain { mut chain, .. }) = input::read_bake(path)? else { return Ok(None) };
    if let Some(scale) = args.input.scale {
        let values = chain.levels.iter_mut().flat_map(|level| level.texels.as_flattened_mut());
        values.for_each(|value| *value = ((f64::from(*value) * scale) as f32).min(f32::MAX));
    }
    if environment.layout() != (Layout::Cube { size: chain.levels[0].size() }) {
        return Ok(None);
    }
    let mut turned = Environment::new(Layout::Cube { size: 1 }, vec![[0.0; 3]; 6])?;
    if args.input.mirror {
        turned = turned.mirrored();
    }
    if let Some(degrees) = args.input.rotate_y {
        turned = turned.rotated_y(degrees)?;
    }
    Ok(Levels::new(chain, turned.source_from_world()).unwrap_or_else(|error| {
        console.warn(&format!("{}: {error}; filtering its level 0 instead", path.display()));
        None
    }))
}
