//! Times of stages, by timestamp queries.

use super::{Context, Stage, readback};
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
    /// [`Error::Gpu`] where the adapter has no timestamp queries.
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
        let resolved = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("timestamps"),
            size: 16 * u64::from(count),
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Ok(Self { queries, resolved, count })
    }

    /// Runs `stages` one after the other; seconds of each, and from the beginning of the first to the end of the last.
    ///
    /// # Errors
    /// [`Error::Gpu`] where the device fails.
    ///
    /// # Panics
    /// Where there are no stages, or more than the timer has room for.
    pub async fn run(&self, context: &Context, stages: &[&Stage]) -> Result<(Vec<f64>, f64)> {
        let count = stages.len() as u32;
        assert!((1..=self.count).contains(&count), "1 to {} stages", self.count);
        context.submit(|encoder| {
            for (first, stage) in (0..).step_by(2).zip(stages) {
                let writes = wgpu::ComputePassTimestampWrites {
                    query_set: &self.queries,
                    beginning_of_pass_write_index: Some(first),
                    end_of_pass_write_index: Some(first + 1),
                };
                stage.record_timed(encoder, Some(writes));
            }
            encoder.resolve_query_set(&self.queries, 0..2 * count, &self.resolved, 0);
        });
        let ticks: Vec<u64> = readback::read(context, &self.resolved).await?;
        let period = f64::from(context.queue().get_timestamp_period()) * 1e-9;
        let seconds = |from: u64, to: u64| to.saturating_sub(from) as f64 * period;
        let each = ticks.chunks_exact(2).take(stages.len()).map(|pair| seconds(pair[0], pair[1])).collect();
        Ok((each, seconds(ticks[0], ticks[2 * stages.len() - 1])))
    }
}
