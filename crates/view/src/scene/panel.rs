//! The panel of a moving scene.

use super::super::look::Tone;
use super::look::{Proxy, SceneLook};
use super::renderer::SceneSettings;
use super::viewer::SceneViewer;
use crate::interface::panel::{choice, weak};
use egui::{Grid, Slider, SliderClamping, Ui};
use octagloss_gpu::direct::Method;

/// Greatest budget of the probes in milliseconds.
pub const MAX_BUDGET: f64 = 1e4;

/// Everything that the panel changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Controls {
    pub(crate) look: SceneLook,
    pub(crate) settings: SceneSettings,
    /// Time of the scene in seconds, and whether it passes.
    pub(crate) time: f64,
    pub(crate) moving: bool,
    /// Milliseconds of a frame for the probes, if they are limited.
    pub(crate) budget: f64,
    pub(crate) limited: bool,
    /// Measure the times of the passes.
    pub(crate) timing: bool,
}

impl SceneViewer {
    /// Shows the panel's contents.
    pub(super) fn show_controls(&mut self, ui: &mut Ui) {
        let Self { panel, controls, renderer, .. } = self;
        let Controls { look, settings, time, moving, budget, limited, timing } = controls;
        panel.show_head(ui);
        ui.label("Roughness");
        let mut own = look.roughness.is_none();
        let mut roughness = look.roughness.unwrap_or(0.3);
        if ui.add(Slider::new(&mut roughness, 0.0..=1.0).max_decimals(3)).changed() {
            (own, look.roughness) = (false, Some(roughness));
        }
        if ui.checkbox(&mut own, "the objects' own").changed() {
            look.roughness = (!own).then_some(roughness);
        }
        ui.separator();
        ui.label("Scene time");
        ui.add(Slider::new(time, 0.0..=60.0).clamping(SliderClamping::Never).suffix(" s"));
        ui.checkbox(moving, "move");
        ui.separator();
        Grid::new("scene").num_columns(2).show(ui, |ui| {
            choice(ui, "Direct", &mut settings.method, Method::ALL.map(|value| (value, value.name())));
            choice(ui, "Proxy", &mut look.proxy, Proxy::ALL.map(|value| (value, value.name())));
            let sizes = [(64, "64"), (128, "128"), (256, "256"), (512, "512"), (1024, "1024")];
            let own = (settings.size, "other");
            let further = sizes.iter().all(|(size, _)| *size != own.0).then_some(own);
            choice(ui, "OEM size", &mut settings.size, sizes.into_iter().chain(further));
            choice(ui, "Tone", &mut look.tone, Tone::ALL.map(|value| (value, value.name())));
        });
        if !settings.method.is_exact() {
            weak(ui, "This method draws wrong maps.");
        }
        ui.label("Exposure");
        ui.add(Slider::new(&mut look.exposure, -8.0..=8.0).step_by(0.01).suffix(" EV"));
        ui.separator();
        ui.label("Probes");
        let most = renderer.scene().glossy_parts();
        settings.probes = settings.probes.min(most);
        ui.add_enabled(most > 1, Slider::new(&mut settings.probes, most.min(1)..=most));
        ui.checkbox(limited, "probe budget");
        ui.add_enabled(*limited, Slider::new(budget, 0.1..=50.0).logarithmic(true).suffix(" ms"));
        weak(ui, &format!("{} of {} in this frame", self.updated, renderer.probes()));
        ui.separator();
        panel.show_times(ui, timing, "GPU times, of one probe and the picture");
        weak(ui, &format!("{} triangles", renderer.triangles()));
        weak(ui, &format!("{:.1} ms from frame to frame", 1e3 * self.passed.as_secs_f64()));
        let input = "Drag to turn, scroll or pinch to zoom; drop a scene. H hides the panel.";
        panel.show_foot(ui, input);
    }
}
