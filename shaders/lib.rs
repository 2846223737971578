//! The shaders of octagloss as text: plain WGSL files. A line `#include "common/name.wgsl"` inserts that
//! file, once per shader.

pub mod names;

use names::prefixed;
use std::borrow::Cow;

/// Every shader under `shaders/` but those of `readers`, by its path there; `build.rs` finds them.
pub const FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/files.rs"));

/// What `pyramid.wgsl` and `pyramid_cube.wgsl` of [`reader`] include. Programs that have no GPU link no other
/// shader.
const LOOK_UPS: &[(&str, &str)] = &[
    ("common/anisotropic.wgsl", include_str!("common/anisotropic.wgsl")),
    ("common/harmonics.wgsl", include_str!("common/harmonics.wgsl")),
    ("common/light.wgsl", include_str!("common/light.wgsl")),
    ("common/pyramid.wgsl", include_str!("common/pyramid.wgsl")),
    ("common/pyramid_file.wgsl", include_str!("common/pyramid_file.wgsl")),
    ("common/pyramid_file_cube.wgsl", include_str!("common/pyramid_file_cube.wgsl")),
    ("common/pyramid_file_tables.wgsl", include_str!("common/pyramid_file_tables.wgsl")),
    ("common/pyramid_squares.wgsl", include_str!("common/pyramid_squares.wgsl")),
    ("common/reflect.wgsl", include_str!("common/reflect.wgsl")),
];

/// Shader code for reading octahedral maps and pyramids, by file name. Those of pyramids have lines for the
/// octahedral map and lines for the cube, as `on_map` sorts them.
pub const READERS: [(&str, &str); 6] = [
    ("oem.wgsl", include_str!("readers/oem.wgsl")),
    ("oem.glsl", include_str!("readers/oem.glsl")),
    ("oem.hlsl", include_str!("readers/oem.hlsl")),
    ("pyramid.glsl", include_str!("readers/pyramid.glsl")),
    ("pyramid.hlsl", include_str!("readers/pyramid.hlsl")),
    ("pyramid.metal", include_str!("readers/pyramid.metal")),
];

/// The file of that name of [`READERS`], or `pyramid.wgsl`, which is made of the shaders; `pyramid_cube.*`
/// are those of pyramids on cubes.
pub fn reader(name: &str) -> Option<Cow<'static, str>> {
    let on_cube = name.strip_prefix("pyramid_cube.");
    let own = on_cube.map_or_else(|| name.to_owned(), |extension| format!("pyramid.{extension}"));
    if own == "pyramid.wgsl" {
        return Some(pyramid_wgsl(on_cube.is_some()).into());
    }
    let (_, code) = READERS.iter().find(|(name, _)| *name == own)?;
    Some(if own.starts_with("pyramid") { on_map(code, on_cube.is_some()).into() } else { (*code).into() })
}

/// `code` without directives and what they keep for the other map.
fn on_map(code: &str, is_cube: bool) -> String {
    let mut is_kept = true;
    let mut text = String::with_capacity(code.len());
    for line in code.lines() {
        match line {
            "#ifdef OCTAGLOSS_CUBE" => is_kept = is_cube,
            "#ifndef OCTAGLOSS_CUBE" => is_kept = !is_cube,
            "#else" => is_kept = !is_kept,
            "#endif" => is_kept = true,
            _ if is_kept => text.extend([line, "\n"]),
            _ => {}
        }
    }
    text
}

/// The text of `path` with its includes resolved. Each file appears once, before the files that include it.
///
/// # Panics
/// If the file does not exist; names are literals of this crate.
#[must_use]
pub fn source(path: &str) -> String {
    source_of(path, FILES)
}

fn source_of(path: &str, files: &[(&str, &str)]) -> String {
    let mut text = String::new();
    append(path, files, &mut Vec::new(), &mut text);
    text
}

fn append(path: &str, files: &[(&str, &str)], included: &mut Vec<String>, text: &mut String) {
    if included.iter().any(|done| done == path) {
        return;
    }
    included.push(path.to_owned());
    let (_, content) = files.iter().find(|(name, _)| *name == path).expect("a file under shaders/");
    for line in content.lines() {
        match line.strip_prefix("#include \"").and_then(|rest| rest.strip_suffix('"')) {
            Some(included_path) => append(included_path, files, included, text),
            None => {
                text.push_str(line);
                text.push('\n');
            }
        }
    }
}

/// WGSL for callers' shaders: the file `path` with its includes, and its `resources` at their bindings of
/// group `group`. Whatever lacks our prefix at module scope gets `prefix`, which begins with it.
pub fn for_callers(path: &str, resources: &[&str], group: u32, prefix: &str) -> String {
    with_resources(&source(path), resources, group, prefix)
}

fn with_resources(source: &str, resources: &[&str], group: u32, prefix: &str) -> String {
    let declare =
        |(binding, resource): (u32, &&str)| format!("@group({group}) @binding({binding}) {resource};\n");
    let declared: String = (0..).zip(resources).map(declare).collect();
    prefixed(&(declared + source), prefix)
}

/// How the look-ups of files are used.
const READER: &str = "\
// Reads files of `octagloss bake --target pyramid`: reflections of any roughness and view, and irradiance.
// octagloss_lights holds the 256 floats `uniform` of NAME_pyramid.json, octagloss_maps NAME_pyramid.ktx2,
// octagloss_tables pyramid_tables.ktx2, octagloss_rows pyramid_rows.ktx2, of which isotropic reflections read
// nothing; octagloss_linear is a sampler, linear in texels and in mip levels and clamped to the edge.
// Directions are in the world, right-handed, y up. To use: octagloss_radiance, octagloss_irradiance,
// octagloss_reflect, octagloss_reflect_isotropic, octagloss_albedo and octagloss_albedo_along; `probe` is 0.
";

/// Added for cubes.
const ON_CUBE: &str = "\
// The maps are one cube, of `--map cube`, the tables pyramid_cube_tables.ktx2, and rows those of `octagloss
// reader --rows FILE --map cube`; in OpenGL enable GL_TEXTURE_CUBE_MAP_SEAMLESS.
";

/// WGSL of the look-ups of pyramids in files, with their resources in group 0.
fn pyramid_wgsl(is_cube: bool) -> String {
    let (file, maps, usage) = match is_cube {
        true => ("common/pyramid_file_cube.wgsl", "var octagloss_maps: texture_cube<f32>", ON_CUBE),
        false => ("common/pyramid_file.wgsl", "var octagloss_maps: texture_2d_array<f32>", ""),
    };
    let resources = [
        "var<uniform> octagloss_lights: array<OctaglossLight, 1>",
        maps,
        "var octagloss_tables: texture_2d<f32>",
        "var octagloss_linear: sampler",
        "var octagloss_rows: texture_3d<f32>",
    ];
    let source = source_of(file, LOOK_UPS);
    format!("{READER}{usage}{}", with_resources(&source, &resources, 0, "octagloss"))
}
