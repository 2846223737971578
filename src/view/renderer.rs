//! Draws a [`Look`] at a [`Light`]: a linear picture first, then, by [`super::present`], what a display shows of it.

use super::camera::Frame;
use super::light::{Light, Passes};
use super::look::{Ball, Filter, Look, Object, ROW, Show};
use super::mesh::{Mesh, Vertex};
use super::present::{Presenter, Viewport};
use super::roughness_map::RoughnessMap;
use super::textures::{roughness_texture, target, texture_of};
use super::truth::Asked;
use crate::dfg::{DfgForm, dfg_table};
use crate::environment::Environment;
use crate::error::{Error, Result};
use crate::gpu::box_filter::SatTextures;
use crate::gpu::fitted::FittedTables;
use crate::gpu::timer::Timer;
use crate::gpu::{Context, readback, shader};
use glam::{DMat3, DVec3};
use std::collections::HashMap;
use std::ops::Range;

/// Texels along an edge of the split sum's table.
const SPLIT_SUM: u32 = 64;

const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const SAMPLES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct BallUniform {
    centre: [f32; 3],
    radius: f32,
    roughness: f32,
    pad: [f32; 3],
}

/// The uniform of a picture.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct ViewFrame {
    eye: [f32; 3],
    exposure: f32,
    right: [f32; 3],
    roughness: f32,
    up: [f32; 3],
    backdrop: f32,
    forward: [f32; 3],
    levels: f32,
    metal: [f32; 3],
    pad: f32,
    size: [f32; 2],
    pad_size: [f32; 2],
    source_from_world: [[f32; 4]; 3],
    clip_from_world: [[f32; 4]; 4],
    ball: [BallUniform; ROW as usize],
}

/// What answers a pixel's question: a shader file, and what it is bound to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Source {
    Box,
    Fitted,
    Levels,
    Truth,
}

impl Source {
    const fn file(self) -> &'static str {
        match self {
            Self::Box => "view/box.wgsl",
            Self::Fitted => "view/fitted.wgsl",
            Self::Levels => "view/levels.wgsl",
            Self::Truth => "view/truth.wgsl",
        }
    }
}

/// What a pass leaves in every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Output {
    Picture,
    Error,
    Samples,
    Oem,
    Sat,
}

impl Output {
    const fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Samples => SAMPLES,
            Self::Picture | Self::Error | Self::Oem | Self::Sat => PICTURE,
        }
    }
}

/// A mesh on the GPU.
#[derive(Debug)]
struct Buffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
    roughness: Option<wgpu::TextureView>,
}

/// Textures as large as the picture.
#[derive(Debug)]
struct Targets {
    width: u32,
    height: u32,
    picture: wgpu::TextureView,
    depth: wgpu::TextureView,
}

/// Everything on a device that draws.
#[derive(Debug)]
pub struct Renderer {
    context: Context,
    passes: Passes,
    frame: wgpu::Buffer,
    frame_layout: wgpu::BindGroupLayout,
    levels_layout: wgpu::BindGroupLayout,
    boxes_layout: wgpu::BindGroupLayout,
    fitted_layout: wgpu::BindGroupLayout,
    pipelines: HashMap<(Source, Output, bool), wgpu::RenderPipeline>,
    split_sum: wgpu::TextureView,
    roughness: wgpu::TextureView,
    /// A roughness map that changes nothing.
    even: wgpu::TextureView,
    trilinear: wgpu::Sampler,
    knot: Buffers,
    mesh: Option<Buffers>,
    truth: wgpu::TextureView,
    /// The prefiltered cube of the light that was drawn last, and its levels.
    levels: Option<(wgpu::TextureView, u32)>,
    /// The picture that is there, and the one that is being drawn.
    shown: Option<Targets>,
    next: Option<Targets>,
    /// What takes the next picture's time, and where in it.
    timer: Option<(Timer, u32)>,
    presenter: Presenter,
}

impl Renderer {
    /// Compiles what every picture needs; the rest when it is first drawn.
    ///
    /// # Errors
    /// [`Error::Gpu`] where a shader fails.
    pub fn new(context: Context) -> Result<Self> {
        let device = context.device();
        let uniform = |label, size| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty,
            count: None,
        };
        let buffer = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = |filterable, view_dimension| wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let flat = texture(false, wgpu::TextureViewDimension::D2);
        let cube = texture(true, wgpu::TextureViewDimension::Cube);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let frame_entries = [entry(0, buffer), entry(1, flat), entry(2, flat), entry(3, flat)];
        let table = dfg_table(SPLIT_SUM, DfgForm::SplitSum, false)?;
        let split_sum: Vec<[f32; 2]> = table.texels.iter().map(|[scale, bias, _]| [*scale, *bias]).collect();
        let renderer = Self {
            passes: Passes::new(&context),
            frame: uniform("view frame", size_of::<ViewFrame>() as u64),
            frame_layout: layout("view frame", &frame_entries),
            levels_layout: layout("prefiltered cube", &[entry(0, cube), entry(1, sampler)]),
            boxes_layout: SatTextures::bind_group_layout(device, wgpu::ShaderStages::FRAGMENT),
            fitted_layout: FittedTables::bind_group_layout(device, wgpu::ShaderStages::FRAGMENT),
            pipelines: HashMap::new(),
            split_sum: texture_of(
                &context,
                "split sum",
                wgpu::TextureFormat::Rg32Float,
                [SPLIT_SUM; 2],
                bytemuck::cast_slice(&split_sum),
            ),
            roughness: roughness_texture(&context, &RoughnessMap::own())?,
            even: roughness_texture(&context, &RoughnessMap::even())?,
            trilinear: device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
            knot: Buffers::new(&context, &Mesh::knot())?,
            mesh: None,
            truth: texture_of(&context, "truth", SAMPLES, [1; 2], bytemuck::cast_slice(&[0.0_f32; 4])),
            levels: None,
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
    #[must_use]
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// Makes `environment` ready, on an OEM of `inner` texels or as many as suit it.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an OEM of no texels, [`Error::Limit`] where the tables do not fit the device.
    pub fn light(&mut self, environment: &Environment, inner: Option<u32>) -> Result<Light> {
        let light = Light::new(&self.context, &self.passes, environment, inner)?;
        self.levels = None;
        Ok(light)
    }

    /// Takes `mesh` as the object [`Object::Mesh`].
    ///
    /// # Errors
    /// [`Error::Limit`] where it does not fit the device.
    pub fn set_mesh(&mut self, mesh: &Mesh) -> Result<()> {
        self.mesh = Some(Buffers::new(&self.context, mesh)?);
        Ok(())
    }

    /// Draws the linear picture, `width` x `height` pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a look that cannot be shown, [`Error::Gpu`] where the device fails.
    pub fn draw(&mut self, look: &Look, light: &Light, width: u32, height: u32) -> Result<()> {
        self.draw_rows(look, light, (width, height), 0..height)
    }

    /// Draws some rows of a picture of `size`: the first begin another, and with the last it takes the place of the one that was
    /// there. What takes long is drawn in bands, of one look and one size.
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
        let (source, output) = match (look.show, look.filter) {
            (Show::Oem, _) => (Source::Box, Output::Oem),
            (Show::Sat, _) => (Source::Box, Output::Sat),
            (Show::Scene, filter) => (source_of(filter), Output::Picture),
            (Show::Error, filter) => (source_of(filter), Output::Error),
        };
        if let Filter::Fitted(count) = look.filter {
            light.fitted().set_count(&self.context, count)?;
        }
        if source == Source::Levels && self.levels.is_none() {
            self.levels = Some(light.prefiltered(&self.context)?);
        }
        let picture = self.next.as_ref().expect("made").picture.clone();
        let done = rows.end >= size.1;
        self.draw_into(&picture, source, output, look, light, rows);
        if done {
            std::mem::swap(&mut self.shown, &mut self.next);
        }
        self.context.check()
    }

    /// What every pixel of a picture asks of the environment, read back: direction of the world and roughness.
    ///
    /// # Errors
    /// Those of [`Renderer::draw`].
    pub(super) fn samples(
        &mut self,
        look: &Look,
        light: &Light,
        width: u32,
        height: u32,
    ) -> Result<impl Future<Output = Result<Vec<Asked>>> + use<>> {
        look.check()?;
        self.make_next((width, height))?;
        let texture = target(&self.context, "samples", Output::Samples.format(), [width, height]);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.draw_into(&view, Source::Truth, Output::Samples, look, light, 0..height);
        let context = self.context.clone();
        Ok(async move { readback::read_texture(&context, &texture).await })
    }

    /// Seconds of every stage of the light and of a picture of `width` x `height` samples, made once more.
    ///
    /// # Errors
    /// Those of [`Renderer::draw`], and [`Error::Gpu`] where the adapter has no timestamp queries.
    pub(super) fn times(
        &mut self,
        look: &Look,
        light: &Light,
        width: u32,
        height: u32,
    ) -> Result<impl Future<Output = Result<Vec<(&'static str, f64)>>> + use<>> {
        let stages: Vec<_> = light.stages().iter().collect();
        let timer = Timer::new(&self.context, stages.len() as u32 + 1)?;
        for (place, stage) in (0..).zip(&stages) {
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

    /// Takes answers to a picture's samples, `width` to a row.
    pub(super) fn set_truth(&mut self, answers: &[[f32; 4]], width: u32) {
        let size = [width, answers.len() as u32 / width];
        self.truth = texture_of(&self.context, "truth", SAMPLES, size, bytemuck::cast_slice(answers));
    }

    fn make_next(&mut self, (width, height): (u32, u32)) -> Result<()> {
        let most = self.context.device().limits().max_texture_dimension_2d;
        if !(1..=most).contains(&width) || !(1..=most).contains(&height) {
            return Err(Error::Parameter(format!(
                "a picture of {width} x {height} pixels; each side must be 1 to {most}"
            )));
        }
        if self.next.as_ref().is_none_or(|had| (had.width, had.height) != (width, height)) {
            let view = |label, format| {
                target(&self.context, label, format, [width, height])
                    .create_view(&wgpu::TextureViewDescriptor::default())
            };
            let (picture, depth) = (view("picture", PICTURE), view("depth", DEPTH));
            self.next = Some(Targets { width, height, picture, depth });
        }
        Ok(())
    }

    fn draw_into(
        &mut self,
        view: &wgpu::TextureView,
        source: Source,
        output: Output,
        look: &Look,
        light: &Light,
        rows: Range<u32>,
    ) {
        let has_mesh = matches!(output, Output::Picture | Output::Error | Output::Samples)
            && matches!(look.object, Object::Knot | Object::Mesh);
        self.pipeline(source, output, false);
        if has_mesh {
            self.pipeline(source, output, true);
        }
        let Targets { width, height, depth, .. } = self.next.as_ref().expect("made before");
        let frame = look.camera.frame(f64::from(*width) / f64::from(*height));
        let levels = self.levels.as_ref().map_or(1, |(_, count)| *count);
        let uniform =
            ViewFrame::new(look, &frame, light.source_from_world(look.turn), [*width, *height], levels);
        self.context.queue().write_buffer(&self.frame, 0, bytemuck::bytes_of(&uniform));

        let mesh = match look.object {
            Object::Knot => Some(&self.knot),
            Object::Mesh => self.mesh.as_ref(),
            Object::Sphere | Object::Row => None,
        }
        .filter(|_| has_mesh);
        let device = self.context.device();
        let roughness = match mesh.and_then(|mesh| mesh.roughness.as_ref()) {
            _ if !look.textured => &self.even,
            Some(own) => own,
            None => &self.roughness,
        };
        let textures = [&self.split_sum, roughness, &self.truth];
        let textures = (1..).zip(textures).map(|(binding, view)| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        });
        let frame = wgpu::BindGroupEntry { binding: 0, resource: self.frame.as_entire_binding() };
        let entries: Vec<_> = std::iter::once(frame).chain(textures).collect();
        let frame = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view frame"),
            layout: &self.frame_layout,
            entries: &entries,
        });
        let answers = match source {
            Source::Box => Some(light.boxes().bind_group(device, &self.boxes_layout)),
            Source::Fitted => Some(light.fitted().bind_group(device, &self.fitted_layout)),
            Source::Levels => {
                let (view, _) = self.levels.as_ref().expect("made before it is drawn");
                Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("prefiltered cube"),
                    layout: &self.levels_layout,
                    entries: &[
                        wgpu::BindGroupEntry {
                            binding: 0,
                            resource: wgpu::BindingResource::TextureView(view),
                        },
                        wgpu::BindGroupEntry {
                            binding: 1,
                            resource: wgpu::BindingResource::Sampler(&self.trilinear),
                        },
                    ],
                }))
            }
            Source::Truth => None,
        };
        let (first, last) = (rows.start == 0, rows.end >= *height);
        self.context.submit(|encoder| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("picture"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: if first {
                            wgpu::LoadOp::Clear(wgpu::Color::BLACK)
                        } else {
                            wgpu::LoadOp::Load
                        },
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: depth,
                    depth_ops: Some(wgpu::Operations {
                        load: if first { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load },
                        store: if last { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: self.timer.as_ref().map(|(timer, place)| timer.render_writes(*place)),
                ..Default::default()
            });
            pass.set_scissor_rect(0, rows.start, *width, rows.end.min(*height) - rows.start);
            pass.set_bind_group(0, &frame, &[]);
            if let Some(answers) = &answers {
                pass.set_bind_group(1, answers, &[]);
            }
            pass.set_pipeline(&self.pipelines[&(source, output, false)]);
            pass.draw(0..3, 0..1);
            if let Some(Buffers { vertices, indices, count, .. }) = mesh {
                pass.set_pipeline(&self.pipelines[&(source, output, true)]);
                pass.set_vertex_buffer(0, vertices.slice(..));
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..*count, 0, 0..1);
            }
        });
    }

    /// Compiles what leaves `output`, for what covers the picture or for meshes.
    fn pipeline(&mut self, source: Source, output: Output, of_mesh: bool) {
        if self.pipelines.contains_key(&(source, output, of_mesh)) {
            return;
        }
        let device = self.context.device();
        let module = shader::module(&self.context, source.file());
        let group = match source {
            Source::Box => Some(&self.boxes_layout),
            Source::Fitted => Some(&self.fitted_layout),
            Source::Levels => Some(&self.levels_layout),
            Source::Truth => None,
        };
        let groups: Vec<_> = std::iter::once(&self.frame_layout).chain(group).map(Some).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(source.file()),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let fragment = match (output, of_mesh) {
            (Output::Picture, false) => "cover_picture",
            (Output::Picture, true) => "mesh_picture",
            (Output::Error, false) => "cover_error",
            (Output::Error, true) => "mesh_error",
            (Output::Samples, false) => "cover_samples",
            (Output::Samples, true) => "mesh_samples",
            (Output::Oem, _) => "oem",
            (Output::Sat, _) => "sat",
        };
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2],
        };
        let buffers = [Some(corners)];
        let depth_compare =
            if of_mesh { wgpu::CompareFunction::LessEqual } else { wgpu::CompareFunction::Always };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(if of_mesh { "transform" } else { "cover" }),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: if of_mesh { &buffers } else { &[] },
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(of_mesh),
                depth_compare: Some(depth_compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(output.format().into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        self.pipelines.insert((source, output, of_mesh), pipeline);
    }

    /// Shows the picture drawn last in `viewport` of `view`, tone-mapped, in sRGB; `encoder` has passes before and after.
    ///
    /// # Panics
    /// Where nothing was drawn.
    pub fn present(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        viewport: Viewport,
        look: &Look,
    ) {
        let picture = &self.shown.as_ref().expect("a picture was drawn").picture;
        self.presenter.present(picture, encoder, view, format, viewport, look);
    }
}

/// What answers for `filter`.
const fn source_of(filter: Filter) -> Source {
    match filter {
        Filter::Box => Source::Box,
        Filter::Fitted(_) => Source::Fitted,
        Filter::Levels => Source::Levels,
        Filter::Adaptive => Source::Truth,
    }
}

impl ViewFrame {
    fn new(look: &Look, frame: &Frame, source_from_world: DMat3, size: [u32; 2], levels: u32) -> Self {
        let three = |v: DVec3| v.as_vec3().to_array();
        let mut ball = [BallUniform::default(); ROW as usize];
        for (uniform, Ball { centre, radius, roughness }) in ball.iter_mut().zip(look.balls()) {
            *uniform = BallUniform {
                centre: centre.map(|c| c as f32),
                radius: radius as f32,
                roughness: roughness as f32,
                pad: [0.0; 3],
            };
        }
        Self {
            eye: three(frame.eye),
            exposure: look.exposure.exp2() as f32,
            right: three(frame.right),
            roughness: look.roughness as f32,
            up: three(frame.up),
            backdrop: look.backdrop as f32,
            forward: three(frame.forward),
            levels: levels as f32,
            metal: look.metal,
            pad: 0.0,
            size: size.map(|side| side as f32),
            pad_size: [0.0; 2],
            source_from_world: [0, 1, 2].map(|c| {
                let [x, y, z] = three(source_from_world.col(c));
                [x, y, z, 0.0]
            }),
            clip_from_world: frame.clip_from_world.as_mat4().to_cols_array_2d(),
            ball,
        }
    }
}

impl Buffers {
    fn new(context: &Context, mesh: &Mesh) -> Result<Self> {
        let buffer = |label, usage, bytes: &[u8]| {
            let most = context.device().limits().max_buffer_size;
            if bytes.len() as u64 > most {
                return Err(Error::Limit {
                    what: format!("the mesh's {label}"),
                    needed: bytes.len() as u64,
                    available: most,
                    remedy: "use a mesh of fewer triangles".to_owned(),
                });
            }
            let buffer = context.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes.len() as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            context.queue().write_buffer(&buffer, 0, bytes);
            Ok(buffer)
        };
        Ok(Self {
            vertices: buffer("corners", wgpu::BufferUsages::VERTEX, bytemuck::cast_slice(&mesh.vertices))?,
            indices: buffer("triangles", wgpu::BufferUsages::INDEX, bytemuck::cast_slice(&mesh.indices))?,
            count: mesh.indices.len() as u32,
            roughness: mesh.roughness.as_ref().map(|map| roughness_texture(context, map)).transpose()?,
        })
    }
}
