//! Measures the times of stages by timestamp queries.

use super::context::Context;
use super::readback;
use super::stage::Stage;
use crate::error::{Error, Result};

/// Times a list of stages, each recorded as one pass.
#[derive(Debug)]
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    count: u32,
}

impl Timer {
    /// A timer for up to `count` stages.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the adapter has no timestamp queries.
    pub fn new(context: &Context, count: u32) -> Result<Self> {
        let device = context.device();
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(Error::Gpu(format!("{} has no timestamp queries", context.describe())));
        }
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("stages"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * count,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = context.buffer("timestamps", 16 * u64::from(count), usage);
        Ok(Self { queries, resolved, count })
    }

    /// Runs `stages` in order. Returns the seconds of each, and from the beginning of the first to the end of
    /// the last.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If there are no stages, or more than the timer supports.
    pub async fn run(&self, context: &Context, stages: &[&Stage]) -> Result<(Vec<f64>, f64)> {
        let count = stages.len() as u32;
        assert!((1..=self.count).contains(&count), "1 to {} stages", self.count);
        context.submit(|encoder| {
            for (place, stage) in (0..).zip(stages) {
                stage.record_timed(encoder, Some(self.compute_writes(place)));
            }
        });
        let spans = self.spans(context, count).await?;
        let whole = spans[stages.len() - 1].1 - spans[0].0;
        Ok((spans.iter().map(|(from, to)| to - from).collect(), whole))
    }

    /// Timestamp writes of the compute pass at `place`.
    #[must_use]
    pub(crate) const fn compute_writes(&self, place: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * place),
            end_of_pass_write_index: Some(2 * place + 1),
        }
    }

    /// Timestamp writes of the render pass at `place`.
    #[must_use]
    pub(crate) const fn render_writes(&self, place: u32) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * place),
            end_of_pass_write_index: Some(2 * place + 1),
        }
    }

    /// Seconds of each of the first `count` passes, which must have been submitted.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub async fn read(&self, context: &Context, count: u32) -> Result<Vec<f64>> {
        let spans = self.spans(context, count).await?;
        Ok(spans.into_iter().map(|(from, to)| to - from).collect())
    }

    /// Seconds of the first of `count` passes, which must have been submitted in order, and from its
    /// beginning to the end of the last.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If `count` is 0.
    pub(crate) async fn first_and_whole(&self, context: &Context, count: u32) -> Result<[f64; 2]> {
        let spans = self.spans(context, count).await?;
        Ok([spans[0].1, spans[spans.len() - 1].1])
    }

    /// Beginnings and ends in seconds since the first beginning.
    async fn spans(&self, context: &Context, count: u32) -> Result<Vec<(f64, f64)>> {
        context.submit(|encoder| encoder.resolve_query_set(&self.queries, 0..2 * count, &self.resolved, 0));
        let ticks: Vec<u64> = readback::read(context, &self.resolved).await?;
        let period = f64::from(context.queue().get_timestamp_period()) * 1e-9;
        let seconds = |tick: u64| tick.saturating_sub(ticks[0]) as f64 * period;
        Ok(ticks
            .chunks_exact(2)
            .take(count as usize)
            .map(|pair| (seconds(pair[0]), seconds(pair[1])))
            .collect())
    }
}
