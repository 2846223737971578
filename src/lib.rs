//! Glossy reflections of any roughness from one table over the sphere: prefilters HDR environments into cube
//! chains, and answers single queries, without sampling noise and with a certified error bound.
//!
//! ```text
//! environment           cells                        lobes
//! cube / panorama  ---> energy, centroid,     --->   adaptive quadrature, bound
//!       |               covariance                     |
//!       |                                              +--> query: one direction
//!       |                                              +--> bake: a cube chain
//!       +----> OEM, bordered: L*w and w per texel (w = solid angle)
//!       |        +----> exact 64-bit SAT ---> boxes
//!       |        +----> pyramid of Gaussians ---> the real-time tier
//!       +----> oracle: exhaustive integration, the reference of the tests
//! ```
//!
//! A quadtree over the environment's texels with the first three moments of their energy serves adaptive
//! lobes with bounds. The octahedral environment map (OEM) is resampled by exact overlap areas: no energy is
//! lost, and a constant stays constant. Its summed-area table (SAT) in 64-bit fixed point serves boxes, a mip
//! chain of Gaussians over it the real-time tier. The GPU engine runs the same stages as compute passes, and
//! the tests compare its results with the CPU's. `docs/architecture.md` draws the modules,
//! `docs/algorithm.md` explains the mathematics.
//!
//! # Conventions
//!
//! - Space: right-handed, y up; directions are unit vectors that point away from the viewer's centre.
//! - Panorama: u = 1/2 + atan2(z, x)/2pi, v = acos(y)/pi, v downwards: the image's centre looks along +X, its
//!   right half along +Z.
//! - Cube: faces +X -X +Y -Y +Z -Z, by the table of OpenGL, Vulkan and Direct3D: texel (i, j) at s =
//!   (i+1/2)/n\*2-1, t downwards by the same formula: +X (1,-t,-s), -X (-1,-t,s), +Y (s,1,t), -Y (s,-1,-t),
//!   +Z (s,-t,1), -Z (-s,-t,-1). Seen from inside such images are mirrored, as in every engine; the panorama
//!   is not.
//! - Rotation: turning by +90 degrees about y carries what was at +Z to +X.
//! - Octahedral square: (u, v) in \[-1,1\]^2, u along x, v along z; the centre is +Y, the four corners are
//!   -Y, the edge midpoints are +-X and +-Z.
//! - Texel centres: half-integer, everywhere.
//! - Radiance: linear RGB in any unit; finite and never negative.
//! - Roughness: perceptual r in \[0,1\], alpha = r^2; glossiness = 1 - r.
//! - GGX lobe: N = V = R (the split sum): K(theta) = D(theta/2) cos(theta) for theta < 90 degrees, D = a^2 /
//!   (pi (s + a^2 (1-s))^2), a = alpha, s = sin^2(theta/2); divided by its integral over the sphere.
//! - Other lobes: Phong cos^n, n = 2/alpha^2 - 2; cone of half-angle r\*pi/2; cosine (irradiance over pi; no
//!   roughness); Charlie (sheen), sin(theta/2)^(1/alpha) cos(theta).
//! - Angles: radians.
//!
//! # Bake and write
//!
//! ```
//! use octagloss::{BakeSettings, Environment, Layout, WriteOptions, bake};
//!
//! let environment = Environment::new(Layout::Panorama { width: 32, height: 16 }, vec![[1.0; 3]; 512])?;
//! let settings = BakeSettings { size: 16, levels: Some(3), ..BakeSettings::default() };
//! # let folder = tempfile::tempdir().expect("a folder");
//! # std::env::set_current_dir(folder.path()).expect("a folder");
//! bake(&environment, &settings)?.write("sky.ktx2", &WriteOptions::default())?;
//! # assert_eq!(Environment::read("sky.ktx2")?.layout(), Layout::Cube { size: 16 });
//! # Ok::<(), octagloss::Error>(())
//! ```
//!
//! # Query
//!
//! ```
//! use glam::DVec3;
//! use octagloss::{Environment, Filter, Layout, Lobe, Reflector, ReflectorSettings};
//!
//! // A dim panorama with one lamp where it looks along +X.
//! let mut texels = vec![[0.1; 3]; 32 * 16];
//! texels[8 * 32 + 16] = [100.0, 80.0, 60.0];
//! let environment = Environment::new(Layout::Panorama { width: 32, height: 16 }, texels)?;
//!
//! let reflector = Reflector::new(&environment, &ReflectorSettings::default())?;
//! let lit = reflector.query(DVec3::X, 0.5, Lobe::Ggx, Filter::Adaptive(0.005))?;
//! assert!(lit.radiance[0] > 1.2 * lit.radiance[1]);
//! assert!(lit.bound.is_some());
//! let dim = reflector.query(-DVec3::X, 0.1, Lobe::Ggx, Filter::Adaptive(0.005))?;
//! assert!((dim.radiance[0] - 0.1).abs() < 0.01);
//! # Ok::<(), octagloss::Error>(())
//! ```
//!
//! # In a renderer
//!
//! With the feature `gpu`. The renderer owns device, queue and encoder; `examples/render.rs` is a whole
//! program.
//!
#![cfg_attr(feature = "gpu", doc = "```no_run")]
#![cfg_attr(not(feature = "gpu"), doc = "```ignore")]
//! use octagloss::{LiveEnvironment, wgpu};
//!
//! # fn frame(device: wgpu::Device, queue: wgpu::Queue, radiance: wgpu::Texture) -> octagloss::Result<()> {
//! let mut live = LiveEnvironment::new(&device, &queue, 512)?;
//! let shader = LiveEnvironment::wgsl(0) + "/* calls octagloss_radiance(direction, roughness) */";
//!
//! // Whenever the light has changed.
//! let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
//! live.update(&mut encoder, &radiance)?;
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```
//!
//! A scene that moves is drawn straight into the octahedral map, by `LiveEnvironment::draw`:
//! `examples/direct.rs`. `ShadowMap` draws the shadows of a lamp the same way: `examples/shadows.rs`.

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod recipes;

pub use octagloss_core::analysis::oracle::Oracle;
pub use octagloss_core::analysis::statistics::{HalfLoss, Statistics};
pub use octagloss_core::pyramid::BakedPyramid;

pub use octagloss_core::bake::{
    Bake, BakeSettings, LevelStats, OnProgress, Processor, Progress, Skybox, bake, bake_all, unwatched,
};
pub use octagloss_core::common::error::{Error, Result};
pub use octagloss_core::cpu::reflector::{Lobes, Reflector, ReflectorSettings, Workspace};
pub use octagloss_core::files::export::write::WriteOptions;
pub use octagloss_core::light::chain::{Chain, ChainKind, Level, LevelSpec};
pub use octagloss_core::light::environment::{
    Environment, LUMINANCE, Layout, MAX_DEGREES, Map, Rgb, exact_luminance, luminance,
};
pub use octagloss_core::light::oem::OemSize;
pub use octagloss_core::light::sat::Scan;
pub use octagloss_core::lobe::filter::{Answer, Bound, Filter};
pub use octagloss_core::lobe::ladder::Ladder;
pub use octagloss_core::lobe::{LOBES, Lobe};
#[cfg(feature = "gpu")]
pub use octagloss_gpu::live::LiveEnvironment;
#[cfg(feature = "gpu")]
pub use octagloss_gpu::live_probes::LiveProbes;
#[cfg(feature = "gpu")]
pub use octagloss_gpu::shadow::ShadowMap;
#[cfg(feature = "gpu")]
pub use octagloss_gpu::wgpu;

/// Types of the fields of [`WriteOptions`], and atomic outputs.
pub mod files {
    pub use octagloss_core::files::export::files::Made;
    pub use octagloss_core::files::export::write::write_files;
    pub use octagloss_core::files::format::container::Container;
    pub use octagloss_core::files::format::overflow::Overflow;
    pub use octagloss_core::files::format::{OutputLayout, Pixel};
    pub use octagloss_core::files::io::output::{Existing, check_file, check_folder, recover};
}

/// Spherical harmonics of environments.
pub mod harmonics {
    pub use octagloss_core::light::sh::scale::{ShScale, scaled};
    pub use octagloss_core::light::sh::window::{ShWindow, parsed as parsed_window};
    pub use octagloss_core::light::sh::{MAX_ORDER, spherical_harmonics};
}

/// Maps of the sphere: directions of points, and points of directions.
pub mod maps {
    pub use octagloss_core::sphere::cube::Face;
    pub use octagloss_core::sphere::map::{Component, Place};
    pub use octagloss_core::sphere::registry::{MAPS, NamedMap, named};
}

/// Queries of many directions, and the words for them.
pub mod queries {
    pub use octagloss_core::bake::query::Query;
    pub use octagloss_core::common::direction::unit;
    pub use octagloss_core::cpu::reflector::{check_answers, sharpest};
    pub use octagloss_core::lobe::filter::parsed as parsed_filter;
}

/// Readers of environments and prefiltered chains.
pub mod read {
    pub use octagloss_core::files::io::provenance::{Provenance, TakenSun};
    pub use octagloss_core::files::io::{
        InputLayout, Loaded, Pad, ReadOptions, Repairs, read, read_chain, read_faces, read_from_memory,
    };
}

/// The reflectance of surfaces: the table of the split sum, and that of reflections along a tangent.
pub mod reflectance {
    pub use octagloss_core::bake::dfg::{DfgBlue, DfgForm, DfgTable, dfg_table};
    pub use octagloss_core::files::io::pyramid_write::anisotropic_table;
}

/// Suns of environments, which can be taken out of them.
pub mod suns {
    pub use octagloss_core::analysis::extraction::{Extraction, Kept, Lamp, Suns, Why, extract};
    pub use octagloss_core::analysis::sun::{Brightest, Sun};
}

/// The engines that bakes are made for.
pub mod targets {
    pub use octagloss_core::files::format::{LevelName, Shown};
    pub use octagloss_core::files::target::{
        Content, Diffuse, FileSpec, Flip, PyramidMap, TARGETS, Target, TargetPlan,
    };
}

/// Runs the program on the arguments of the process; `licenses` are those of the crates in it.
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use cli::main as run_program;
