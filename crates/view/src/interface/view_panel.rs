//! Controls of the viewer of environments.

use super::panel::{SLIDER, choice, weak};
use super::viewer::{Refinement, Viewer};
use crate::look::camera::MAX_PITCH;
use crate::look::{Ground, Look, Object, Paint, Show, Technique, Tone};
use egui::{DragValue, Grid, Rect, Slider, SliderClamping, Ui};
use octagloss_core::files::image::exposure::{self, Exposure};

/// Settings of the panel outside the look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Motion {
    /// Rotate the environment about +Y.
    pub(super) turning: bool,
    /// Move a lamp and rebuild the tables every frame.
    pub(super) lamp: bool,
    /// Measure the times of the passes.
    pub(super) timing: bool,
}

impl Viewer {
    /// Shows the panel's contents beside a picture `aspect` times as wide as high; returns the position of
    /// the roughness slider.
    pub(super) fn show_controls(&mut self, ui: &mut Ui, aspect: f64) -> Rect {
        let has_materials = self.renderer.has_materials();
        let half_height = self.look.camera.frame(aspect, self.look.field()).up.length();
        let Self { panel, look, motion, light, .. } = self;
        let automatic_backdrop =
            Look { backdrop: None, ..*look }.backdrop_roughness(light.texel_angle(), half_height);
        panel.show_head(ui);
        let painted = look.shows_materials() && has_materials;
        ui.label(if painted { "Roughness, times the mesh's" } else { "Roughness" });
        let value = if painted { &mut look.roughness_factor } else { &mut look.roughness };
        let roughness = Slider::new(value, 0.0..=1.0).max_decimals(3);
        let roughness = ui.add_enabled(look.object != Object::Row, roughness).rect;
        ui.add_enabled(!painted, egui::Checkbox::new(&mut look.textured, "vary over the surface"));
        if look.object == Object::Mesh && has_materials {
            let mut own = look.paint == Paint::File;
            if ui.checkbox(&mut own, "the mesh's own materials").changed() {
                look.paint = if own { Paint::File } else { Paint::Plain };
            }
        }
        ui.separator();
        Grid::new("look").num_columns(2).show(ui, |ui| {
            let objects =
                [(Object::Sphere, "sphere"), (Object::Row, "row of spheres"), (Object::Knot, "torus knot")];
            let objects = objects.into_iter().chain(self.has_mesh.then_some((Object::Mesh, "mesh")));
            choice(ui, "Object", &mut look.object, objects);
            let levels =
                if light.own_levels { "the bake's own levels" } else { "split sum of prefiltered levels" };
            let filters = [
                (Technique::Box, "box"),
                (Technique::Pyramid, "N = V = R, pyramid"),
                (Technique::Reflect, "true reflection"),
                (Technique::Levels, levels),
                (Technique::Adaptive, "adaptive"),
            ];
            choice(ui, "Filter", &mut look.filter, filters);
            choice(ui, "Show", &mut look.show, Show::ALL);
            choice(ui, "Tone", &mut look.tone, Tone::ALL.map(|value| (value, value.name())));
            ui.label(if painted { "Tint" } else { "Metal" });
            ui.color_edit_button_rgb(if painted { &mut look.tint } else { &mut look.metal });
            ui.end_row();
        });
        if look.filter == Technique::Reflect {
            ui.separator();
            let finish = &mut look.finish;
            ui.add_enabled_ui(!painted, |ui| {
                ui.label("Anisotropy");
                ui.add(Slider::new(&mut finish.anisotropy, 0.0..=1.0).max_decimals(3));
                let direction = Slider::new(&mut finish.direction, 0.0..=180.0).step_by(1.0);
                ui.add_enabled(finish.anisotropy > 0.0, direction.suffix("\u{b0}"));
                ui.label("Clear coat");
                ui.add(Slider::new(&mut finish.clearcoat, 0.0..=1.0).max_decimals(3));
                let roughness = Slider::new(&mut finish.coat_roughness, 0.0..=1.0).max_decimals(3);
                ui.add_enabled(finish.clearcoat > 0.0, roughness.text("roughness"));
            });
        }
        ui.separator();
        ui.label("Exposure");
        let mut automatic = look.exposure == Exposure::Auto;
        let mut ev = look.exposure.ev(light.exposure());
        let slider = Slider::new(&mut ev, -8.0..=8.0);
        let slider = slider.clamping(SliderClamping::Never).step_by(0.01).suffix(" EV");
        if ui.add(slider).changed() {
            look.exposure = Exposure::Ev(ev.clamp(*exposure::RANGE.start(), *exposure::RANGE.end()));
        } else if ui.checkbox(&mut automatic, "automatic").changed() {
            let fixed = ev.clamp(*exposure::RANGE.start(), *exposure::RANGE.end());
            look.exposure = if automatic { Exposure::Auto } else { Exposure::Ev(fixed) };
        }
        ui.label("Backdrop roughness");
        let mut automatic = look.backdrop.is_none();
        let mut backdrop = look.backdrop.unwrap_or(automatic_backdrop);
        // Other clampings round the automatic value, which counts as a change.
        let slider = Slider::new(&mut backdrop, 0.0..=1.0).clamping(SliderClamping::Edits).max_decimals(3);
        if ui.add(slider).changed() {
            look.backdrop = Some(backdrop);
        } else if ui.checkbox(&mut automatic, "hide the environment's texels").changed() {
            look.backdrop = (!automatic).then_some(backdrop);
        }
        let mut shadow = look.ground == Ground::Shadow;
        if ui.checkbox(&mut shadow, "shadow of spheres on the ground").changed() {
            look.ground = if shadow { Ground::Shadow } else { Ground::None };
        }
        ui.label("Environment rotation");
        look.turn = look.turn.rem_euclid(360.0);
        ui.add(Slider::new(&mut look.turn, 0.0..=360.0).step_by(0.1).suffix("\u{b0}"));
        ui.checkbox(&mut motion.turning, "rotate continuously");
        let lamp = egui::Checkbox::new(&mut motion.lamp, "moving lamp (tables every frame)");
        ui.add_enabled(look.follows_lamp(), lamp);
        ui.separator();
        ui.collapsing("Camera", |ui| {
            Grid::new("camera").num_columns(2).show(ui, |ui| {
                degrees(ui, "Yaw", &mut look.camera.yaw, f64::INFINITY);
                degrees(ui, "Pitch", &mut look.camera.pitch, MAX_PITCH);
                ui.label("Distance");
                ui.add(DragValue::new(&mut look.camera.distance).range(1.05..=100.0).speed(0.02));
                ui.end_row();
            });
        });
        ui.separator();
        panel.show_times(ui, &mut motion.timing, "GPU times");
        self.reported_size = self.picture_size();
        let (width, height) = self.reported_size;
        weak(ui, &format!("{width} x {height} samples"));
        if let Some(Refinement { asked, answers, .. }) = &self.work {
            weak(ui, &format!("adaptive: {:.0} %", 100.0 * answers.len() as f64 / asked.len().max(1) as f64));
        }
        let input =
            "Drag to turn, scroll or pinch to zoom; drop an environment or a mesh. H hides the panel.";
        self.panel.show_foot(ui, input);
        // Exclude the slider's number field.
        roughness.with_max_x(roughness.left() + SLIDER)
    }
}

fn degrees(ui: &mut Ui, label: &str, radians: &mut f64, most: f64) {
    ui.label(label);
    let mut value = radians.to_degrees();
    let limit = most.to_degrees();
    if ui.add(DragValue::new(&mut value).range(-limit..=limit).speed(0.5).suffix("\u{b0}")).changed() {
        *radians = value.to_radians();
    }
    ui.end_row();
}
