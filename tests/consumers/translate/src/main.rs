//! Translates the WGSL readers of pyramids into GLSL, HLSL and Metal's language. Lines that differ with the
//! map stand between directives.
//!
//!     translate SQUARES CUBE FOLDER     readers of both maps; the others are written into FOLDER

use naga::back::{glsl, hlsl, msl};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use std::error::Error;
use std::path::Path;

/// GLSL is written for an entry point. This one reaches everything and is cut off again.
const ENTRY: &str = "
@fragment
fn entry_of_translation(@location(0) at: vec3<f32>) -> @location(0) vec4<f32> {
    let light = octagloss_radiance(at, 0.5) + octagloss_irradiance(at)
        + octagloss_reflect(at, at, at, 0.5, 0.5, at, 1.0)
        + octagloss_reflect_isotropic(at, at, 0.5, at, 1.0);
    let albedo = octagloss_albedo(at.x, 0.5, 0.5) + octagloss_albedo_along(at.x, 0.0, 0.5, 0.5);
    return vec4<f32>(light, albedo.x);
}
";

fn main() -> Result<(), Box<dyn Error>> {
    let [squares, cube, folder] = <[String; 3]>::try_from(std::env::args().skip(1).collect::<Vec<_>>())
        .map_err(|_| "usage: translate SQUARES CUBE FOLDER")?;
    let (squares, cube) = (translations(&squares)?, translations(&cube)?);
    for ((name, squares), (_, cube)) in squares.iter().zip(&cube) {
        std::fs::write(Path::new(&folder).join(name), merged(squares, cube))?;
    }
    Ok(())
}

/// The file `wgsl` in every other language, by the names of the files.
fn translations(wgsl: &str) -> Result<[(&'static str, String); 3], Box<dyn Error>> {
    let source = std::fs::read_to_string(wgsl)?;
    let name = Path::new(wgsl).file_name().ok_or("no file")?.display();
    // The comments before the code say how it is used.
    let usage: String =
        source.lines().take_while(|line| line.starts_with("//")).map(|line| format!("{line}\n")).collect();
    let hash = source
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    let head =
        |resources: &str| format!("{usage}// Translated from {name}, FNV-1a {hash:016x}.\n{resources}\n");
    let (module, info) = parsed(&source)?;
    Ok([
        ("pyramid.glsl", head(GLSL) + &glsl_of(&source)?),
        ("pyramid.hlsl", head(HLSL) + &hlsl_of(&module, &info)?),
        ("pyramid.metal", head(METAL) + &metal_of(&module, &info)?),
    ])
}

/// Both texts in one, by the longest sequence of lines that they share.
fn merged(squares: &str, cube: &str) -> String {
    let [squares, cube]: [Vec<&str>; 2] = [squares, cube].map(|text| text.lines().collect());
    // Shared lines from a place in each text on.
    let mut shared = vec![vec![0_u32; cube.len() + 1]; squares.len() + 1];
    for i in (0..squares.len()).rev() {
        for j in (0..cube.len()).rev() {
            shared[i][j] = match squares[i] == cube[j] {
                true => shared[i + 1][j + 1] + 1,
                false => shared[i + 1][j].max(shared[i][j + 1]),
            };
        }
    }
    let (mut i, mut j, mut text) = (0, 0, Vec::new());
    while i < squares.len() || j < cube.len() {
        let (from, other) = (i, j);
        while i < squares.len() && shared[i + 1][j] == shared[i][j] {
            i += 1;
        }
        while j < cube.len() && shared[i][j + 1] == shared[i][j] {
            j += 1;
        }
        let (own, others) = (&squares[from..i], &cube[other..j]);
        match (own, others) {
            ([], []) => {}
            (_, []) => text.extend([&["#ifndef OCTAGLOSS_CUBE"], own, &["#endif"]].concat()),
            ([], _) => text.extend([&["#ifdef OCTAGLOSS_CUBE"], others, &["#endif"]].concat()),
            _ => text.extend([&["#ifdef OCTAGLOSS_CUBE"], others, &["#else"], own, &["#endif"]].concat()),
        }
        if i < squares.len() && j < cube.len() {
            text.push(squares[i]);
            (i, j) = (i + 1, j + 1);
        }
    }
    text.join("\n") + "\n"
}

const GLSL: &str =
    "// GLSL ES 3.00, GLSL 3.30 and newer, after the version and, in ES, the precision of float and int.";
const HLSL: &str = "// HLSL, shader model 5.0 and newer.";
const METAL: &str = "// Metal; the resources are arguments of each function.";

fn parsed(source: &str) -> Result<(Module, ModuleInfo), Box<dyn Error>> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module)?;
    Ok((module, info))
}

fn glsl_of(source: &str) -> Result<String, Box<dyn Error>> {
    let (module, info) = parsed(&format!("{source}{ENTRY}"))?;
    let options = glsl::Options {
        version: glsl::Version::Embedded { version: 300, is_webgl: true },
        ..Default::default()
    };
    let pipeline = glsl::PipelineOptions {
        shader_stage: ShaderStage::Fragment,
        entry_point: "entry_of_translation".to_owned(),
        multiview: None,
    };
    let mut text = String::new();
    let reflection =
        glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, BoundsCheckPolicies::default())?
            .write()?;
    // Resources get the names that they have in WGSL.
    for (name, mapping) in &reflection.texture_mapping {
        let own =
            module.global_variables[mapping.texture].name.as_deref().ok_or("a texture without a name")?;
        text = text.replace(name.as_str(), own);
    }
    for (handle, name) in &reflection.uniforms {
        let own = module.global_variables[*handle].name.as_deref().ok_or("a uniform without a name")?;
        text = text.replace(name.as_str(), "OctaglossLights").replace("_group_0_binding_0_fs", own);
    }
    let text = &text[..text.find("void main()").ok_or("no entry point")?];
    let is_kept = |line: &&str| {
        !["#version", "precision ", "smooth in", "layout(location"]
            .iter()
            .any(|start| line.starts_with(start))
    };
    Ok(joined(text.lines().filter(is_kept)))
}

// All loops end and all indices are within their arrays: limits on them would only lengthen the shader.
fn hlsl_of(module: &Module, info: &ModuleInfo) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let options =
        hlsl::Options { force_loop_bounding: false, restrict_indexing: false, ..Default::default() };
    let pipeline = hlsl::PipelineOptions::default();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None)?;
    // Samplers come out of heaps that only wgpu has.
    let is_heap = |line: &str| line.contains("nagaSamplerHeap") || line.contains("SamplerIndexArray");
    let line = |line: &str| match line.split_once("static const SamplerState ") {
        Some((_, rest)) => Some(format!("SamplerState {} : register(s0);", rest.split(' ').next()?)),
        None if is_heap(line) || line.contains("nagaComparisonSamplerHeap") => None,
        None => Some(with_zeros(line).unwrap_or_else(|| line.to_owned())),
    };
    let lines: Vec<String> = text.lines().filter_map(line).collect();
    Ok(joined(lines.iter().map(String::as_str)))
}

/// `line` with an array of zeros spelled out, which glslang does not cast.
fn with_zeros(line: &str) -> Option<String> {
    let (before, _) = line.split_once("])0;")?;
    let (before, array) = before.rsplit_once('(')?;
    let (kind, count) = array.split_once('[')?;
    let zeros = vec![format!("({kind})0"); count.parse().ok()?].join(", ");
    Some(match before.trim() {
        "return" => format!("    {kind} zeros[{count}] = {{ {zeros} }};\n    return zeros;"),
        _ => format!("{before}{{ {zeros} }};"),
    })
}

fn metal_of(module: &Module, info: &ModuleInfo) -> Result<String, Box<dyn Error>> {
    let options =
        msl::Options { fake_missing_bindings: true, force_loop_bounding: false, ..Default::default() };
    let (text, _) = msl::write_string(module, info, &options, &msl::PipelineOptions::default())?;
    Ok(joined(text.lines()))
}

/// Lines without spaces at their ends, and with at most one empty line between them.
fn joined<'a>(lines: impl Iterator<Item = &'a str>) -> String {
    let mut text = String::new();
    for line in lines.map(str::trim_end) {
        if !(line.is_empty() && (text.is_empty() || text.ends_with("\n\n"))) {
            text += line;
            text += "\n";
        }
    }
    text.trim_end().to_owned() + "\n"
}
