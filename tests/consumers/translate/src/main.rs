//! Translates the WGSL reader of pyramids into GLSL, HLSL and Metal's language.
//!
//!     translate WGSL FOLDER     WGSL is the reader; the others are written into FOLDER

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
    let [wgsl, folder] = <[String; 2]>::try_from(std::env::args().skip(1).collect::<Vec<_>>())
        .map_err(|_| "usage: translate WGSL FOLDER")?;
    let folder = Path::new(&folder);
    let source = std::fs::read_to_string(wgsl)?;
    // The comments before the code say how it is used.
    let usage: String =
        source.lines().take_while(|line| line.starts_with("//")).map(|line| format!("{line}\n")).collect();
    let hash = source
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    let head = |resources: &str| {
        format!("{usage}// Translated from pyramid.wgsl, FNV-1a {hash:016x}.\n{resources}\n")
    };
    let (module, info) = parsed(&source)?;
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text);
    write("pyramid.glsl", head(GLSL) + &glsl_of(&source)?)?;
    write("pyramid.hlsl", head(HLSL) + &hlsl_of(&module, &info)?)?;
    write("pyramid.metal", head(METAL) + &metal_of(&module, &info)?)?;
    Ok(())
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
