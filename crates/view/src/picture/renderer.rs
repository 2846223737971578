//! Draws a [`Look`] under a [`Light`]: first a linear picture, then, by [`super::present`], its tone-mapped
//! form.

use super::frame::{LadderUniform, ViewFrame};
use super::light::Light;
use super::model::{Model, Surface};
use super::present::{Display, Presenter};
use super::resources::{PICTURE, Targets, Times, draw_pass, target};
use super::roughness_map::{self, roughness_map};
use super::truth::PixelQuery;
use crate::look::{Look, Object, Show, Technique, Tone};
use bytemuck::Zeroable as _;
use half::f16;
use octagloss_core::bake::dfg::{DfgBlue, DfgForm, dfg_table};
use octagloss_core::common::error::Result;
use octagloss_core::cpu::reflector::ReflectorSettings;
use octagloss_core::light::environment::Environment;
use octagloss_gpu::Context;
use octagloss_gpu::device::readback;
use octagloss_gpu::device::resources::{
    Draw, SAMPLER, UNIFORM, group, group_layout, texture_binding, texture_of, trilinear,
};
use octagloss_gpu::device::timer::Timer;
use octagloss_gpu::stages::box_filter::SatTextures;
use octagloss_gpu::stages::pyramid::PyramidMaps;
use octagloss_gpu::stages::reflection::{self, Surfaces};
use octagloss_mesh::{Mesh, SubMesh, Vertex};
use std::collections::HashMap;
use std::ops::Range;

/// Texels along an edge of the split-sum table.
const SPLIT_SUM: u32 = 64;

const SAMPLES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// What a pass draws into each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Drawn {
    /// What the look shows.
    Shown(Show),
    /// Of the pixel's query: world direction and roughness.
    Lobe,
    /// The surface's normal and anisotropy.
    Normal,
    /// Its tangent.
    Tangent,
    /// Its reflectance at normal incidence.
    Reflectance,
}

impl Drawn {
    /// Whether it is of a scene, by a technique, and not of tables.
    const fn is_of_scene(self) -> bool {
        !matches!(self, Self::Shown(Show::Oem | Show::Sat))
    }

    const fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Shown(_) => PICTURE,
            Self::Lobe | Self::Normal | Self::Tangent | Self::Reflectance => SAMPLES,
        }
    }

    /// Entry points of the vertex and the fragment shader, of meshes or of the triangle that covers the
    /// picture.
    const fn entry_points(self, of_mesh: bool) -> [&'static str; 2] {
        let pixels = match self {
            Self::Shown(Show::Scene) => ["cover_picture", "mesh_picture"],
            Self::Shown(Show::Error) => ["cover_error", "mesh_error"],
            Self::Lobe => ["cover_samples", "mesh_samples"],
            Self::Normal => ["cover_normals", "mesh_normals"],
            Self::Tangent => ["cover_tangents", "mesh_tangents"],
            Self::Reflectance => ["cover_reflectances", "mesh_reflectances"],
            Self::Shown(Show::Oem) => ["oem"; 2],
            Self::Shown(Show::Sat) => ["sat"; 2],
        };
        [if of_mesh { "transform" } else { "cover" }, pixels[of_mesh as usize]]
    }
}

/// Pipelines and resources for drawing on one device.
#[derive(Debug)]
pub struct Renderer {
    context: Context,
    frame: wgpu::Buffer,
    frame_layout: wgpu::BindGroupLayout,
    /// Of the group that each technique has besides.
    layouts: HashMap<Technique, wgpu::BindGroupLayout>,
    pipelines: HashMap<(Technique, Drawn, bool), wgpu::RenderPipeline>,
    split_sum: wgpu::TextureView,
    roughness: wgpu::TextureView,
    /// An even roughness map.
    even: wgpu::TextureView,
    trilinear: wgpu::Sampler,
    /// Material of everything except meshes with their own materials.
    plain: Surface,
    knot: Model,
    mesh: Option<Model>,
    truth: wgpu::TextureView,
    /// The current picture, and the one in progress.
    shown: Option<Targets>,
    next: Option<Targets>,
    /// Timer of the next picture, and its place in it.
    timer: Option<(Timer, u32)>,
    presenter: Presenter,
}

impl Renderer {
    /// Compiles the common pipelines; others are compiled on first use.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if a shader fails to compile.
    pub fn new(context: Context) -> Result<Self> {
        let (stages, fragment) = (wgpu::ShaderStages::VERTEX_FRAGMENT, wgpu::ShaderStages::FRAGMENT);
        let texture =
            |filterable, dimension| texture_binding(wgpu::TextureSampleType::Float { filterable }, dimension);
        let flat = texture(false, wgpu::TextureViewDimension::D2);
        let image = texture(true, wgpu::TextureViewDimension::D2);
        let cube = texture(true, wgpu::TextureViewDimension::Cube);
        // Entries of the picture, then those of the material.
        let frame_entries = [UNIFORM, flat, flat, flat, UNIFORM, UNIFORM, image, SAMPLER, image, SAMPLER];
        let roughness = |size, texels: &[u8]| {
            texture_of(&context, "roughness map", wgpu::TextureFormat::R8Unorm, [size; 2], texels)
        };
        let table = dfg_table(SPLIT_SUM, DfgForm::SplitSum, DfgBlue::Empty)?;
        let split_sum: Vec<[f32; 2]> = table.texels.iter().map(|[scale, bias, _]| [*scale, *bias]).collect();
        let renderer = Self {
            frame: context.uniform("view frame", &ViewFrame::zeroed()),
            frame_layout: group_layout(&context, "view frame", stages, &frame_entries),
            layouts: HashMap::from([
                (Technique::Box, SatTextures::bind_group_layout(&context, fragment)),
                (Technique::Pyramid, PyramidMaps::bind_group_layout(&context, fragment)),
                (Technique::Reflect, reflection::bind_group_layout(&context, fragment)),
                (Technique::Levels, group_layout(&context, "prefiltered cube", fragment, &[cube, SAMPLER])),
            ]),
            pipelines: HashMap::new(),
            split_sum: texture_of(
                &context,
                "split sum",
                wgpu::TextureFormat::Rg32Float,
                [SPLIT_SUM; 2],
                bytemuck::cast_slice(&split_sum),
            ),
            roughness: roughness(roughness_map::SIZE, &roughness_map()),
            even: roughness(1, &[255]),
            trilinear: trilinear(&context),
            plain: Surface::plain(&context),
            knot: Model::new(&context, &Mesh::knot())?,
            mesh: None,
            truth: texture_of(&context, "truth", SAMPLES, [1; 2], bytemuck::cast_slice(&[0.0_f32; 4])),
            shown: None,
            next: None,
            timer: None,
            presenter: Presenter::new(&context),
            context,
        };
        renderer.context.check()?;
        Ok(renderer)
    }

    /// The device.
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// Prepares `environment` on an OEM of the size, border and scan of `table`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an OEM of no texels,
    /// [`octagloss_core::common::error::Error::Limit`] if the tables do not fit the device,
    /// [`octagloss_core::common::error::Error::Unsupported`] for a scan that runs on the CPU only.
    pub fn light(&mut self, environment: &Environment, table: &ReflectorSettings) -> Result<Light> {
        Light::new(&self.context, environment, table)
    }

    /// Sets the mesh of [`Object::Mesh`].
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] and
    /// [`octagloss_core::common::error::Error::Parameter`] if it does not fit the device.
    pub fn set_mesh(&mut self, mesh: &Mesh) -> Result<()> {
        self.mesh = Some(Model::new(&self.context, mesh)?);
        self.context.check()
    }

    /// Whether the mesh has materials of its own.
    pub fn has_materials(&self) -> bool {
        self.mesh.as_ref().is_some_and(|mesh| !mesh.surfaces.is_empty())
    }

    /// Draws the linear picture with `width` x `height` samples.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for an unsupported look,
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    pub fn draw(&mut self, look: &Look, light: &Light, width: u32, height: u32) -> Result<()> {
        self.draw_rows(look, light, (width, height), 0..height)
    }

    /// Draws some rows of a picture of `size`. Row 0 starts a new picture; with the last row it replaces the
    /// current one. Slow pictures are drawn in bands of one look and size.
    ///
    /// # Errors
    /// Those of [`Renderer::draw`].
    pub fn draw_rows(
        &mut self,
        look: &Look,
        light: &Light,
        size: (u32, u32),
        rows: Range<u32>,
    ) -> Result<()> {
        look.check()?;
        self.make_next(size)?;
        let drawn = Drawn::Shown(look.show);
        let source = if drawn.is_of_scene() { look.filter } else { Technique::Box };
        let picture = self.next.as_ref().expect("made").picture.clone();
        let done = rows.end >= size.1;
        self.draw_into(&picture, source, drawn, look, light, rows)?;
        if done {
            std::mem::swap(&mut self.shown, &mut self.next);
        }
        self.context.check()
    }

    /// Reads back the query of every pixel.
    ///
    /// # Errors
    /// Those of [`Renderer::draw`].
    pub fn samples(
        &mut self,
        look: &Look,
        light: &Light,
        width: u32,
        height: u32,
    ) -> Result<impl Future<Output = Result<Vec<PixelQuery>>> + use<>> {
        look.check()?;
        self.make_next((width, height))?;
        let draw = |drawn: Drawn| -> Result<wgpu::Texture> {
            let texture = target(&self.context, "samples", SAMPLES, [width, height]);
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            self.draw_into(&view, Technique::Adaptive, drawn, look, light, 0..height)?;
            Ok(texture)
        };
        let all = [Drawn::Lobe, Drawn::Normal, Drawn::Tangent, Drawn::Reflectance];
        let drawn = if look.judges_reflections() { &all[..] } else { &all[..1] };
        let textures: Vec<wgpu::Texture> = drawn.iter().copied().map(draw).collect::<Result<_>>()?;
        let context = self.context.clone();
        Ok(async move {
            let mut texels: Vec<Vec<[f32; 4]>> = Vec::new();
            for texture in &textures {
                texels.push(readback::read_texture(&context, texture).await?);
            }
            let query = |(index, lobe): (usize, &[f32; 4])| {
                let surface = texels.get(1..4).map(|parts| [0, 1, 2].map(|k: usize| parts[k][index]));
                // The backdrop has no normal.
                PixelQuery {
                    lobe: *lobe,
                    surface: surface.filter(|[[x, y, z, _], ..]| [*x, *y, *z] != [0.0; 3]),
                }
            };
            Ok(texels[0].iter().enumerate().map(query).collect())
        })
    }

    /// Seconds of every stage of the light and of a picture of `width` x `height` samples; runs each once
    /// more.
    ///
    /// # Errors
    /// Those of [`Renderer::draw`], and [`octagloss_core::common::error::Error::Gpu`] if the adapter has no
    /// timestamp queries.
    pub fn times(
        &mut self,
        look: &Look,
        light: &Light,
        width: u32,
        height: u32,
    ) -> Result<impl Future<Output = Result<Times>> + use<>> {
        let stages = light.stages();
        let timer = Timer::new(&self.context, stages.len() as u32 + 1)?;
        for (place, stage) in (0..).zip(stages) {
            let writes = timer.compute_writes(place);
            self.context.submit(|encoder| stage.record_timed(encoder, Some(writes)));
        }
        self.timer = Some((timer, stages.len() as u32));
        let drawn = self.draw(look, light, width, height);
        let (timer, _) = self.timer.take().expect("put there");
        drawn?;
        let labels: Vec<&'static str> =
            stages.iter().map(|stage| stage.label()).chain(std::iter::once("picture")).collect();
        let context = self.context.clone();
        Ok(async move {
            let seconds = timer.read(&context, labels.len() as u32).await?;
            Ok(labels.into_iter().zip(seconds).collect())
        })
    }

    /// Sets the answers to a picture's samples, `width` per row.
    pub fn set_truth(&mut self, answers: &[[f32; 4]], width: u32) {
        let size = [width, answers.len() as u32 / width];
        self.truth = texture_of(&self.context, "truth", SAMPLES, size, bytemuck::cast_slice(answers));
    }

    fn make_next(&mut self, size: (u32, u32)) -> Result<()> {
        if self.next.as_ref().is_none_or(|had| had.size != size) {
            self.next = Some(Targets::new(&self.context, size)?);
        }
        Ok(())
    }

    fn draw_into(
        &mut self,
        view: &wgpu::TextureView,
        source: Technique,
        drawn: Drawn,
        look: &Look,
        light: &Light,
        rows: Range<u32>,
    ) -> Result<()> {
        let has_mesh = drawn.is_of_scene() && matches!(look.object, Object::Knot | Object::Mesh);
        self.pipeline(source, drawn, false);
        if has_mesh {
            self.pipeline(source, drawn, true);
        }
        let cube = if source == Technique::Levels { Some(light.levels(&self.context)?) } else { None };
        let Targets { size: (width, height), depth, .. } = self.next.as_ref().expect("made before");
        let frame = look.camera.frame(f64::from(*width) / f64::from(*height), look.field());
        let uniform = ViewFrame::new(
            look,
            &frame,
            light.scaled_ev(look.exposure.ev(light.exposure())),
            light.texel_angle(),
            light.source_from_world(look.turn),
            [*width, *height],
            &cube.map_or_else(LadderUniform::default, |cube| cube.ladder),
        );
        self.context.queue().write_buffer(&self.frame, 0, bytemuck::bytes_of(&uniform));

        let mesh = match look.object {
            Object::Knot => Some(&self.knot),
            Object::Mesh => self.mesh.as_ref(),
            Object::Sphere | Object::Row => None,
        }
        .filter(|_| has_mesh);
        let plain = self.frame_group(look, light, &self.plain);
        let surface = |part: &SubMesh| {
            let own = part.material.filter(|_| look.shows_materials());
            own.and_then(|index| mesh?.surfaces.get(index))
        };
        let parts: Vec<(Range<u32>, Option<wgpu::BindGroup>)> = mesh
            .iter()
            .flat_map(|mesh| &mesh.parts)
            .map(|part| {
                let group = surface(part).map(|surface| self.frame_group(look, light, surface));
                (part.indices.clone(), group)
            })
            .collect();
        let answers = match source {
            Technique::Box => Some(light.boxes.bind_group(&self.context, &self.layouts[&source])),
            Technique::Pyramid => Some(light.pyramid.bind_group(&self.context, &self.layouts[&source])),
            Technique::Reflect => {
                let is_brushed = look.finish.anisotropy > 0.0 || mesh.is_some_and(|mesh| mesh.is_brushed);
                let surfaces = if is_brushed { Surfaces::Any } else { Surfaces::Isotropic };
                Some(light.reflections(&self.context, surfaces, &self.layouts[&source]))
            }
            Technique::Levels => cube.map(|cube| {
                let view = wgpu::BindingResource::TextureView(&cube.view);
                let sampler = wgpu::BindingResource::Sampler(&self.trilinear);
                group(&self.context, "prefiltered cube", &self.layouts[&source], [view, sampler])
            }),
            Technique::Adaptive => None,
        };
        let (first, last) = (rows.start == 0, rows.end >= *height);
        self.context.submit(|encoder| {
            let store = if last { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
            let writes = self.timer.as_ref().map(|(timer, place)| timer.render_writes(*place));
            let mut pass = draw_pass(encoder, "picture", view, first, Some((depth, store)), writes);
            pass.set_scissor_rect(0, rows.start, *width, rows.end.min(*height) - rows.start);
            pass.set_bind_group(0, &plain, &[]);
            if let Some(answers) = &answers {
                pass.set_bind_group(1, answers, &[]);
            }
            pass.set_pipeline(&self.pipelines[&(source, drawn, false)]);
            pass.draw(0..3, 0..1);
            if let Some(Model { vertices, indices, .. }) = mesh {
                pass.set_pipeline(&self.pipelines[&(source, drawn, true)]);
                pass.set_vertex_buffer(0, vertices.slice(..));
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                for (indices, group) in &parts {
                    pass.set_bind_group(0, group.as_ref().unwrap_or(&plain), &[]);
                    pass.draw_indexed(indices.clone(), 0, 0..1);
                }
            }
        });
        Ok(())
    }

    /// Bind group 0 for pictures of `look` under `light`, for surfaces of one material.
    fn frame_group(&self, look: &Look, light: &Light, surface: &Surface) -> wgpu::BindGroup {
        let roughness = if look.textured { &self.roughness } else { &self.even };
        let textures = [&self.split_sum, roughness, &self.truth].map(wgpu::BindingResource::TextureView);
        let picture = std::iter::once(self.frame.as_entire_binding()).chain(textures);
        let resources = picture.chain([light.diffuse.as_entire_binding()]).chain(surface.resources());
        group(&self.context, "view frame", &self.frame_layout, resources)
    }

    /// Compiles the pipeline for `drawn`: for meshes, or for the triangle that covers the picture.
    fn pipeline(&mut self, source: Technique, drawn: Drawn, of_mesh: bool) {
        if self.pipelines.contains_key(&(source, drawn, of_mesh)) {
            return;
        }
        let groups: Vec<_> = std::iter::once(&self.frame_layout).chain(self.layouts.get(&source)).collect();
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![
                0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x2, 4 => Float32x2
            ],
        };
        let compare = if of_mesh { wgpu::CompareFunction::LessEqual } else { wgpu::CompareFunction::Always };
        let draw = Draw {
            file: source.file(),
            entries: drawn.entry_points(of_mesh),
            groups: &groups,
            corners: of_mesh.then_some(corners),
            target: drawn.format().into(),
            depth: Some((of_mesh, compare)),
        };
        self.pipelines.insert((source, drawn, of_mesh), draw.pipeline(&self.context));
    }

    /// Reads back the last picture, if there is one: linear and exposed; in the fourth channel an error, or 1
    /// where a table is shown.
    pub fn values(&self) -> Option<impl Future<Output = Result<Vec<[f16; 4]>>> + use<>> {
        let picture = self.shown.as_ref()?.picture.clone();
        let context = self.context.clone();
        Some(async move { readback::read_texture(&context, picture.texture()).await })
    }

    /// Draws the last picture to `display`, tone-mapped, in sRGB.
    ///
    /// # Panics
    /// If no picture was drawn.
    pub fn present(&mut self, display: Display<'_>, look: &Look) {
        let picture = &self.shown.as_ref().expect("a picture was drawn").picture;
        // Errors have display colours, which tone mapping must not change.
        let tone = if look.show == Show::Error { Tone::Linear } else { look.tone };
        self.presenter.present(picture, display, tone);
    }
}
