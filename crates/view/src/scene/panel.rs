//! The panel of a moving scene.

use super::super::look::Tone;
use super::look::{Proxy, SceneLook};
use super::renderer::SceneSettings;
use crate::interface::panel::{PanelState, choice, weak};
use egui::{Grid, Slider, SliderClamping, Ui};
#[cfg(target_arch = "wasm32")]
use octagloss_core::common::error::{Result, wrong};
use octagloss_gpu::direct::Method;
#[cfg(target_arch = "wasm32")]
use std::ops::RangeInclusive;

/// Greatest budget of the probes in milliseconds.
pub const MAX_BUDGET: f64 = 1e4;

/// Edges of maps.
#[cfg(target_arch = "wasm32")]
const SIZES: RangeInclusive<u32> = 16..=8192;

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

/// Information that the panel displays.
#[derive(Debug)]
pub(super) struct Status<'a> {
    pub(super) panel: &'a PanelState,
    /// Glossy parts of the scene.
    pub(super) glossy: usize,
    pub(super) triangles: usize,
    /// Probes updated in the last frame, and all.
    pub(super) updated: [usize; 2],
    /// Seconds from frame to frame.
    pub(super) frame: f64,
}

/// The command line's parser checks its options itself.
#[cfg(target_arch = "wasm32")]
impl Controls {
    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] naming the value and its range.
    pub(super) fn check(&self) -> Result<()> {
        self.look.check()?;
        if !(0.0..=MAX_BUDGET).contains(&self.budget) {
            let message = format!("`probe_budget` {}; use 0 to {MAX_BUDGET} milliseconds", self.budget);
            return wrong(message);
        }
        let size = self.settings.size;
        if !(SIZES.contains(&size) && size.is_power_of_two()) {
            let [least, most] = [SIZES.start(), SIZES.end()];
            let message = format!("`oem_size` {size}; use a power of two from {least} to {most}");
            return wrong(message);
        }
        Ok(())
    }
}

/// Shows the panel's contents.
pub(super) fn show_controls(ui: &mut Ui, controls: &mut Controls, status: &Status<'_>) {
    let Controls { look, settings, time, moving, budget, limited, timing } = controls;
    status.panel.show_head(ui);
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
        choice(ui, "Direct", &mut settings.method, &Method::ALL.map(|value| (value, value.name())), None);
        choice(ui, "Proxy", &mut look.proxy, &Proxy::ALL.map(|value| (value, value.name())), None);
        let sizes = [(64, "64"), (128, "128"), (256, "256"), (512, "512"), (1024, "1024")];
        let own = (settings.size, "other");
        let further = sizes.iter().all(|(size, _)| *size != own.0).then_some(own);
        choice(ui, "OEM size", &mut settings.size, &sizes, further);
        choice(ui, "Tone", &mut look.tone, &Tone::ALL.map(|value| (value, value.name())), None);
    });
    if !settings.method.is_exact() {
        weak(ui, "This method draws wrong maps.");
    }
    ui.label("Exposure");
    ui.add(Slider::new(&mut look.exposure, -8.0..=8.0).step_by(0.01).suffix(" EV"));
    ui.separator();
    ui.label("Probes");
    let most = status.glossy;
    settings.probes = settings.probes.min(most);
    ui.add_enabled(most > 1, Slider::new(&mut settings.probes, most.min(1)..=most));
    ui.checkbox(limited, "probe budget");
    ui.add_enabled(*limited, Slider::new(budget, 0.1..=50.0).logarithmic(true).suffix(" ms"));
    let [updated, probes] = status.updated;
    weak(ui, &format!("{updated} of {probes} in this frame"));
    ui.separator();
    status.panel.show_times(ui, timing, "GPU times, of one probe and the picture");
    weak(ui, &format!("{} triangles", status.triangles));
    weak(ui, &format!("{:.1} ms from frame to frame", 1e3 * status.frame));
    let input = "Drag to turn, scroll or pinch to zoom; drop a scene. H hides the panel.";
    status.panel.show_foot(ui, input);
}
