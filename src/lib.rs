//! Glossy reflections of any roughness from one table over the sphere: HDR environments into prefiltered cube
//! chains, or into the answer to a single query, without sampling noise and with a certified error bound.
//!
//! ```text
//! environment            OEM, bordered            cells                      lobes
//! cube / panorama  --->  L*w and w per texel ---> energy, centroid,   --->   adaptive quadrature, bound
//!       |                (w = solid angle)        covariance                      |
//!       |                      |                                                  +--> query: any direction, roughness
//!       |                      +----> exact 64-bit SAT ---> boxes, fitted lobes   +--> bake: a cube chain
//!       +----> oracle: exhaustive integration, to check all of it by
//! ```
//!
//! In the order in which they run:
//! 1. [`environment`]: radiance on a panorama, a cube or an octahedral square; [`io`] reads it from files.
//! 2. [`oem`] and [`cpu::reparameterise`]: the octahedral environment map (OEM), filled by exact overlap
//!    areas, so that every texel's energy arrives and a constant stays one.
//! 3. [`sat`] and [`cpu::sat_scan`]: its summed-area table (SAT) in 64-bit fixed point, for boxes.
//! 4. [`cpu::cells`]: a quadtree whose nodes know the first three moments of their energy.
//! 5. [`cpu::adaptive`]: a [`lobe`] by the coarsest cells that are fine enough, with bounds from two-point
//!    distributions.
//! 6. [`realtime::emitters`], [`cpu::blur`] and [`realtime::tables`], instead of 4 and 5: a GGX lobe by its own
//!    values where light is brightest, and a few soft boxes and harmonics, found by [`realtime::fit`], for
//!    the rest.
//! 7. [`reflector`]: all of these for point queries; [`bake`]: for cube chains ([`chain`]), which [`io`]
//!    writes.
//!
//! `gpu` (feature `gpu`) runs steps 2 to 7 as compute passes, held to the CPU's results by the tests.
//!
//! `view` (feature `view`, not in the defaults) shows objects under an environment by all of these, in a
//! window or as pictures.
//!
//! [`analysis::oracle`] integrates exhaustively in double precision and shares no code with the engine but
//! the maps of [`sphere`]; [`analysis::compare`] measures a bake by it.
//!
//! # Conventions
//!
//! | thing | convention |
//! |---|---|
//! | space | right-handed, y up; directions are unit vectors that point away from the viewer's centre |
//! | panorama | u = 1/2 + atan2(z, x)/2pi, v = acos(y)/pi, v downwards: the image's centre looks along +X, its right half along +Z |
//! | cube | faces +X -X +Y -Y +Z -Z, by the table of OpenGL, Vulkan and Direct3D: texel (i, j) at s = (i+1/2)/n\*2-1, t likewise and downwards: +X (1,-t,-s), -X (-1,-t,s), +Y (s,1,t), -Y (s,-1,-t), +Z (s,-t,1), -Z (-s,-t,-1). Seen from inside such images are mirrored, as in every engine; the panorama is not |
//! | rotation | turning by +90 degrees about y carries what was at +Z to +X |
//! | octahedral square | (u, v) in \[-1,1\]^2, u along x, v along z; the centre is +Y, the four corners are -Y, the edge midpoints are +-X and +-Z |
//! | texel centres | half-integer, everywhere |
//! | radiance | linear RGB in any unit, kept as it came; finite and never negative |
//! | roughness | perceptual r in \[0,1\], alpha = r^2; glossiness = 1 - r |
//! | GGX lobe | N = V = R (the split sum): K(theta) = D(theta/2) cos(theta) for theta < 90 degrees, D = a^2 / (pi (s + a^2 (1-s))^2), a = alpha, s = sin^2(theta/2); divided by its integral over the sphere |
//! | other lobes | Phong cos^n, n = 2/alpha^2 - 2; cone of half-angle r\*pi/2; cosine (irradiance over pi; no roughness); Charlie (sheen), sin(theta/2)^(1/alpha) cos(theta) |
//! | angles | radians |
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
//! # assert_eq!(octagloss::io::read_chain("sky.ktx2".as_ref())?.levels.len(), 3);
//! # Ok::<(), octagloss::Error>(())
//! ```
//!
//! # From an environment to a chain
//!
//! ```
//! use glam::DVec3;
//! use octagloss::analysis::oracle;
//! use octagloss::bake::{BakeSettings, bake};
//! use octagloss::filter::Filter;
//! use octagloss::lobe::Lobe;
//! use octagloss::reflector::{Reflector, ReflectorSettings};
//! use octagloss::sphere::cube::{Face, direction_from_texel};
//! use octagloss::{Environment, Layout};
//!
//! // A dim panorama with one lamp where it looks along +X.
//! let mut texels = vec![[0.1; 3]; 32 * 16];
//! texels[8 * 32 + 16] = [100.0, 80.0, 60.0];
//! let environment = Environment::new(Layout::Panorama { width: 32, height: 16 }, texels)?;
//!
//! // Three levels of roughness 0, 0.5 and 1, of 16, 8 and 4 texels a side.
//! let settings = BakeSettings { size: 16, levels: Some(3), bounds: true, ..BakeSettings::default() };
//! let baked = bake(&environment, &settings)?;
//! let level = &baked.chain.levels[1];
//! assert_eq!((level.size(), level.roughness), (8, 0.5));
//!
//! // The texel at column 4, row 3 of +X sees the lamp, its like on -X does not.
//! let [red, green, _] = level.face(Face::PosX)[3 * 8 + 4];
//! assert!(red > 1.2 * green && red > 5.0 * level.face(Face::NegX)[3 * 8 + 4][0]);
//!
//! // The same lobe as a query, for any direction and roughness; and integrated exhaustively.
//! let reflector = Reflector::new(&environment, &ReflectorSettings::default())?;
//! let direction = direction_from_texel(Face::PosX, 8, 4, 3);
//! let answer = reflector.query(direction, 0.5, Lobe::Ggx, Filter::Adaptive(0.005))?;
//! let exact = oracle::reflect(&environment, Lobe::Ggx, 0.5, direction);
//! assert!((f64::from(answer.radiance[0]) / exact[0] - 1.0).abs() < 0.01);
//! assert!(answer.bound.is_some());
//!
//! // Away from the lamp there is what there is.
//! let dim = reflector.query(-DVec3::X, 0.1, Lobe::Ggx, Filter::Adaptive(0.005))?;
//! assert!((dim.radiance[0] - 0.1).abs() < 0.01);
//! # Ok::<(), octagloss::Error>(())
//! ```

pub mod analysis;
pub mod bake;
pub mod chain;
pub mod chain_lookup;
pub mod cpu;
pub mod environment;
pub mod error;
pub mod export;
pub mod filter;
mod finite;
pub mod format;
pub mod geometry;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod image;
pub mod io;
pub mod ladder;
mod light_scale;
pub mod lobe;
pub mod memory;
#[cfg(feature = "mesh")]
pub mod mesh;
pub mod oem;
pub mod realtime;
pub mod reflector;
pub mod sat;
pub mod sh;
pub mod sphere;
pub mod synth;
mod table_bytes;
pub mod target;
#[cfg(feature = "view")]
pub mod view;

pub use bake::{BakeSettings, bake};
pub use environment::{Environment, Layout, Map, Rgb};
pub use error::{Error, Result};
pub use export::write::WriteOptions;
#[cfg(feature = "gpu")]
pub use wgpu;
