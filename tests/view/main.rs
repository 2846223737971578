//! Tests of the viewer: pictures on every adapter, meshes, legends.

mod framing;
mod legend;
mod present;
mod view;
mod view_meshes;
mod view_scenes;
mod view_textures;
