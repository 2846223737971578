//! What both forms of the bake command share: circumstances of the report, compression, containers.

use crate::cli::engine::Baker;
use crate::cli::input::{Opened, Source};
use crate::cli::output::Stored;
use crate::cli::shared_args::InputArgs;
use octagloss::bake::overflow::Overflow;
use octagloss::bake::report::{Circumstances, InputFileReport};
use std::time::Instant;

/// What a report tells of an environment and its bake, however it is stored.
pub(super) struct Told<'a> {
    pub(super) source: &'a Source,
    pub(super) input_files: Vec<InputFileReport>,
    pub(super) opened: &'a Opened,
    pub(super) input: &'a InputArgs,
    pub(super) sunless: bool,
    pub(super) overflow: Overflow,
    pub(super) preview: bool,
    pub(super) baker: &'a Baker,
    pub(super) start: Instant,
}

impl Told<'_> {
    pub(super) fn circumstances(
        &self,
        stored: Stored,
        clamped_energy_share: f64,
        warnings: Vec<String>,
    ) -> Circumstances {
        Circumstances {
            input: self.source.path().display().to_string(),
            input_files: self.input_files.clone(),
            engine: self.baker.engine.to_owned(),
            adapter: self.baker.adapter.clone(),
            repaired: self.opened.repaired.into(),
            layout: self.opened.layout.to_owned(),
            rotate_y: self.input.rotate_y.unwrap_or(0.0),
            mirror: self.input.mirror,
            sanitize: self.input.sanitize,
            strict: self.input.strict,
            extract_sun: self.input.extract_sun,
            sunless: self.sunless,
            overflow: self.overflow,
            preview: self.preview,
            sun: self.opened.sun.clone(),
            format: stored.format.to_owned(),
            pixel: stored.pixel.to_owned(),
            level_pixels: stored.pixels,
            clamped: stored.clamped,
            clamped_energy_share,
            warnings,
            seconds: self.start.elapsed().as_secs_f64(),
        }
    }
}
