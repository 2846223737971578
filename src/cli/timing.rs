//! Timing of repeated runs, and the environment used.

use super::args::BenchArgs;
use super::console::Console;
use super::input;
use super::outcome::Outcome;
use crate::{Environment, Layout, Rgb};
use octagloss_core::sphere::equirect::direction_from_equirect;
use serde::Serialize;
use std::borrow::Cow;
use std::sync::Arc;

#[derive(Clone, Copy, Serialize)]
pub(super) struct Timing {
    pub(super) median_seconds: f64,
    least_seconds: f64,
}

pub(super) fn timing(mut seconds: Vec<f64>) -> Timing {
    seconds.sort_by(f64::total_cmp);
    let middle = seconds.len() / 2;
    let median =
        if seconds.len() % 2 == 1 { seconds[middle] } else { (seconds[middle - 1] + seconds[middle]) / 2.0 };
    Timing { median_seconds: median, least_seconds: seconds[0] }
}

/// The light to time: an input's, or a sky of any size.
pub(super) struct TimedLight {
    /// The input's path and environment.
    given: Option<(String, Environment)>,
}

impl TimedLight {
    pub(super) fn new(args: &BenchArgs) -> Outcome<Self> {
        if args.inputs.is_empty() {
            return Ok(Self { given: None });
        }
        let source = input::single_source(args.inputs.clone(), &args.input)?;
        let opened = source.open(&args.input, &Console::new(false))?;
        Ok(Self {
            given: Some((source.path().display().to_string(), Arc::unwrap_or_clone(opened.environment))),
        })
    }

    /// Path of the input.
    pub(super) fn name(&self) -> Option<String> {
        self.given.as_ref().map(|(name, _)| name.clone())
    }

    /// The input's environment, or the sky as a panorama of `width` columns.
    pub(super) fn environment(&self, width: u32) -> crate::Result<Cow<'_, Environment>> {
        match &self.given {
            Some((_, environment)) => Ok(Cow::Borrowed(environment)),
            None => Ok(Cow::Owned(sky(width)?)),
        }
    }
}

/// A panorama of `width` columns: textured sky and ground with a sun.
fn sky(width: u32) -> crate::Result<Environment> {
    let height = width / 2;
    let radiance = |k: u32| -> Rgb {
        let (u, v) = (f64::from(k % width) + 0.5, f64::from(k / width) + 0.5);
        let d = direction_from_equirect(u / f64::from(width), v / f64::from(height));
        let texture = 1.0 + 0.3 * (40.0 * d.x).sin() * (50.0 * d.z).sin() * (30.0 * d.y).cos();
        let base = if d.y > 0.0 { [0.4, 0.7, 1.0 + d.y] } else { [0.2, 0.15, 0.1] };
        let sun = if d.x + 0.5 * d.y > 1.117 { 2e4 } else { 0.0 };
        base.map(|c| (c * texture + sun) as f32)
    };
    Environment::new(Layout::Panorama { width, height }, (0..width * height).map(radiance).collect())
}
