//! What the panels of all content share.

use super::later::{Later, later, taken};
use crate::picture::present::Viewport;
use crate::picture::resources::Times;
use egui::{ComboBox, Grid, RichText, ScrollArea, Ui};
use octagloss_core::common::error::Result;
use octagloss_gpu::Context;
use std::path::Path;
use std::time::Duration;
use web_time::Instant;

/// Interval between measurements of the passes' times.
const INTERVAL: Duration = Duration::from_millis(500);

/// Width in points.
const WIDTH: f32 = 250.0;

/// Length of a slider in points.
pub(crate) const SLIDER: f32 = 130.0;

/// State of a panel, whatever its controls.
#[derive(Debug)]
pub(crate) struct PanelState {
    /// Name of the content.
    pub(crate) name: String,
    adapter: String,
    /// The message to the user, if any.
    pub(crate) message: Option<String>,
    pub(crate) is_hidden: bool,
    /// Passes and their times, as last measured.
    pub(crate) times: Times,
    pending: Option<Later<Times>>,
    measured: Option<Instant>,
}

impl PanelState {
    pub(crate) fn new(context: &Context, name: String) -> Self {
        Self {
            name,
            adapter: context.describe(),
            message: None,
            is_hidden: false,
            times: Times::new(),
            pending: None,
            measured: None,
        }
    }

    /// Names the content after the file `path`.
    pub(crate) fn set_name(&mut self, path: &Path) {
        self.name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    }

    /// Shows the error of `outcome`, or no message.
    pub(crate) fn report(&mut self, outcome: Result<()>) {
        self.message = outcome.err().map(|error| error.to_string());
    }

    /// Starts a measurement, whose times [`Self::poll`] takes.
    pub(crate) fn measure(
        &mut self,
        context: &Context,
        times: impl Future<Output = Result<Times>> + 'static,
    ) {
        self.pending = Some(later(context, times));
    }

    /// Takes the times of a finished measurement; returns whether there is one.
    pub(crate) fn poll(&mut self) -> Result<bool> {
        let Some(times) = taken(&mut self.pending) else { return Ok(false) };
        self.times = times?;
        Ok(true)
    }

    /// Whether it is time to measure; at most once an interval.
    pub(crate) fn is_due(&mut self, now: Instant) -> bool {
        let is_due = self.pending.is_none() && self.measured.is_none_or(|measured| now - measured > INTERVAL);
        if is_due {
            self.measured = Some(now);
        }
        is_due
    }

    /// Shows the panel's head: name and message.
    pub(crate) fn show_head(&self, ui: &mut Ui) {
        ui.add_space(6.0);
        ui.label(RichText::new("octagloss").heading());
        ui.label(&self.name);
        if let Some(message) = &self.message {
            ui.label(RichText::new(message).color(egui::Color32::from_rgb(255, 140, 120)));
        }
        ui.separator();
        ui.spacing_mut().slider_width = SLIDER;
    }

    /// Shows a box that switches measuring on, and below it the passes with their times in seconds.
    pub(crate) fn show_times(&self, ui: &mut Ui, timing: &mut bool, label: &str) {
        ui.checkbox(timing, label);
        if *timing {
            Grid::new("times").num_columns(2).show(ui, |ui| {
                for (pass, seconds) in &self.times {
                    ui.label(*pass);
                    ui.label(format!("{:.3} ms", 1e3 * seconds));
                    ui.end_row();
                }
            });
        }
    }

    /// Shows the panel's foot: the adapter and what `input` does.
    pub(crate) fn show_foot(&self, ui: &mut Ui, input: &str) {
        weak(ui, &self.adapter);
        weak(ui, input);
    }
}

/// Shows a panel with `contents`, unless it is hidden; returns what they do, the panel's right edge in
/// points, and the viewport beside it in a target of these sides.
pub(crate) fn beside_panel<T>(
    ui: &mut Ui,
    (width, height): (u32, u32),
    is_hidden: bool,
    contents: impl FnOnce(&mut Ui) -> T,
) -> (Option<T>, f32, Viewport) {
    if is_hidden {
        return (None, 0.0, Viewport { x: 0, y: 0, width, height });
    }
    let shown = egui::Panel::left("panel")
        .exact_size(WIDTH)
        .resizable(false)
        .show(ui, |ui| ScrollArea::vertical().show(ui, contents).inner);
    let right = shown.response.rect.right();
    let edge = (right * ui.ctx().pixels_per_point()).round() as u32;
    let x = edge.min(width.saturating_sub(1));
    (Some(shown.inner), right, Viewport { x, y: 0, width: width - x, height })
}

/// Shows a line of weak text.
pub(crate) fn weak(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).weak());
}

/// Shows a box that selects `value` among `choices`.
pub(crate) fn choice<'a, T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    value: &mut T,
    choices: impl IntoIterator<Item = (T, &'a str), IntoIter: Clone>,
) {
    ui.label(label);
    let choices = choices.into_iter();
    let shown = choices.clone().find(|(choice, _)| choice == value).map_or("", |(_, name)| name);
    ComboBox::from_id_salt(label).selected_text(shown).show_ui(ui, |ui| {
        for (choice, name) in choices {
            ui.selectable_value(value, choice, name);
        }
    });
    ui.end_row();
}
