//! Shader sources: plain WGSL files. A line `#include "common/name.wgsl"` inserts that file, once per shader.

use super::context::Context;

macro_rules! files {
    ($($path:literal),* $(,)?) => {
        [$(($path, include_str!(concat!("../../../shaders/", $path)))),*]
    };
}

/// Gives a struct that shaders read its `MEMBERS`: names and offsets in bytes, to be held to the shader's.
macro_rules! members {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $name {
            /// Every field with its offset in bytes.
            pub(crate) const MEMBERS: &'static [(&'static str, usize)] = {
                // No field is left out.
                let _ = |whole: Self| {
                    let Self { $($field: _),* } = whole;
                };
                &[$((stringify!($field), std::mem::offset_of!($name, $field))),*]
            };
        }
    };
}
pub(crate) use members;

/// Every file under `shaders/`, by its path there.
pub const FILES: &[(&str, &str)] = &files![
    "common/atlas.wgsl",
    "common/charlie.wgsl",
    "common/direct.wgsl",
    "common/direct_view.wgsl",
    "common/fitted.wgsl",
    "common/fixed_point.wgsl",
    "common/harmonics.wgsl",
    "common/kernel.wgsl",
    "common/light.wgsl",
    "common/live.wgsl",
    "common/luminance.wgsl",
    "common/octahedral.wgsl",
    "common/octants.wgsl",
    "common/octaves.wgsl",
    "common/oem_lookup.wgsl",
    "common/plane.wgsl",
    "common/planes.wgsl",
    "common/quad.wgsl",
    "common/reduce.wgsl",
    "common/reduction.wgsl",
    "common/rows.wgsl",
    "common/sat.wgsl",
    "common/scan.wgsl",
    "common/shadow.wgsl",
    "common/source_pieces.wgsl",
    "common/tints.wgsl",
    "common/sum.wgsl",
    "common/table.wgsl",
    "common/u64.wgsl",
    "common/view_draw.wgsl",
    "common/view_parts.wgsl",
    "common/view_scene.wgsl",
    "common/view_texture.wgsl",
    "adaptive.wgsl",
    "blur.wgsl",
    "box_filter.wgsl",
    "cells.wgsl",
    "copy.wgsl",
    "direct/cull.wgsl",
    "direct/draw.wgsl",
    "direct/offsets.wgsl",
    "direct/split.wgsl",
    "direct/unwrap.wgsl",
    "emitters.wgsl",
    "fitted.wgsl",
    "fixed_point.wgsl",
    "harmonics.wgsl",
    "lamp.wgsl",
    "least.wgsl",
    "mirror.wgsl",
    "pack.wgsl",
    "reparameterise.wgsl",
    "sat_f32.wgsl",
    "sat_hensley.wgsl",
    "sat_scan.wgsl",
    "view/box.wgsl",
    "view/fitted.wgsl",
    "view/levels.wgsl",
    "view/present.wgsl",
    "view/scene.wgsl",
    "view/scene_pose.wgsl",
    "view/truth.wgsl",
];

/// The text of `path` with its includes resolved. Each file appears once, before the files that include it.
///
/// # Panics
/// If the file does not exist; names are literals of this crate.
#[must_use]
pub fn source(path: &str) -> String {
    let mut text = String::new();
    append(path, &mut Vec::new(), &mut text);
    text
}

fn append(path: &str, included: &mut Vec<String>, text: &mut String) {
    if included.iter().any(|done| done == path) {
        return;
    }
    included.push(path.to_owned());
    let (_, content) = FILES.iter().find(|(name, _)| *name == path).expect("a file under shaders/");
    for line in content.lines() {
        match line.strip_prefix("#include \"").and_then(|rest| rest.strip_suffix('"')) {
            Some(included_path) => append(included_path, included, text),
            None => {
                text.push_str(line);
                text.push('\n');
            }
        }
    }
}

/// Queries for any shader, each with the group of its resources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Queries {
    /// Queries over [`crate::gpu::box_filter::SatTextures`]: `octagloss_ggx(direction, roughness)` and
    /// `octagloss_box(direction, solid_angle)`.
    Boxes(u32),
    /// The query over [`crate::gpu::fitted::FittedTables`]: `octagloss_fitted(direction, roughness)`.
    Fitted(u32),
    /// The same under a rotation, and irradiance, over a [`crate::gpu::live::LiveEnvironment`]:
    /// `octagloss_radiance(direction, roughness)` and `octagloss_irradiance(normal)`.
    Live(u32),
    /// The same over all of [`crate::gpu::live_probes::LiveProbes`]: `octagloss_radiance_of(probe, direction,
    /// roughness)` and `octagloss_irradiance_of(probe, normal)`.
    Probes(u32),
    /// Clip coordinates and ownership of pixels for draws into a [`crate::gpu::live::LiveEnvironment`]:
    /// `octagloss_direct_position(position)` and `octagloss_direct_owns(position)`.
    Draw(u32),
    /// The look-up in a [`crate::gpu::shadow::ShadowMap`]: `octagloss_lit(position, normal)`.
    Shadow(u32),
}

/// The resources of fitted lobes, by their bindings, with those of `lights`.
const fn fitted(lights: &'static str) -> [&'static str; 5] {
    [
        "var<uniform> octagloss_octaves: OctaglossOctaves",
        lights,
        "var<storage, read> octagloss_entries: array<Sum>",
        "var<storage, read> octagloss_parameters: array<vec4<u32>>",
        "var octagloss_oems: texture_2d_array<f32>",
    ]
}

const FITTED: [&str; 5] = fitted("var<uniform> octagloss_lights: array<OctaglossLight, 1>");
const PROBES: [&str; 5] = fitted("var<uniform> octagloss_lights: array<OctaglossLight, MAX_LIGHTS>");

/// The functions and resources of `queries`, for one shader; shared functions appear once.
#[must_use]
pub fn queries(queries: &[Queries]) -> String {
    let mut text = String::new();
    let mut included = Vec::new();
    for part in queries {
        let (group, declared, path): (_, Vec<&str>, _) = match part {
            Queries::Boxes(group) => (
                group,
                vec![
                    "var<uniform> octagloss_table: OctaglossTable",
                    "var octagloss_low: texture_2d<u32>",
                    "var octagloss_high: texture_2d<u32>",
                ],
                "common/sat.wgsl",
            ),
            Queries::Fitted(group) => (group, FITTED.to_vec(), "common/fitted.wgsl"),
            Queries::Live(group) => (group, FITTED.to_vec(), "common/live.wgsl"),
            Queries::Probes(group) => (group, PROBES.to_vec(), "common/live.wgsl"),
            Queries::Draw(group) => {
                (group, vec!["var<uniform> octagloss_view: OctaglossView"], "common/direct_view.wgsl")
            }
            Queries::Shadow(group) => (
                group,
                vec![
                    "var<uniform> octagloss_shadow: OctaglossShadow",
                    "var octagloss_shadow_depth: texture_depth_2d",
                ],
                "common/shadow.wgsl",
            ),
        };
        for (binding, declared) in declared.iter().enumerate() {
            text.push_str(&format!("@group({group}) @binding({binding}) {declared};\n"));
        }
        append(path, &mut included, &mut text);
    }
    text
}

/// Creates the module of file `path`.
pub(crate) fn module(context: &Context, path: &str) -> wgpu::ShaderModule {
    context.device().create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(path),
        source: wgpu::ShaderSource::Wgsl(source(path).into()),
    })
}

/// Creates the pipeline of one entry point, with its layout inferred from the shader.
pub(in crate::gpu) fn pipeline(
    context: &Context,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    context.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: None,
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}
