//! Measures the times of stages: by timestamp queries where they are true, else from submission to
//! completion.

use super::context::Context;
use super::readback;
use super::stage::Stage;
use octagloss_core::common::error::{Error, Result};
use web_time::Instant;

/// A clock for stages and frames of one device.
///
/// Timestamps of some drivers leave out work. lavapipe (Mesa 22.3) queues them for its rasteriser, which it
/// next flushes at a barrier or a timestamp, and runs dispatches at once: the timestamp at the beginning of a
/// pass without barriers is written after its dispatch. So [`Clock::of`] compares timestamps with the time
/// from submission to completion.
#[derive(Debug)]
pub struct Clock {
    /// None if timestamps are missing or untrue.
    timer: Option<Timer>,
}

/// Seconds of stages.
#[derive(Clone, Debug)]
pub struct Times {
    /// Of each.
    pub each: Vec<f64>,
    /// From the beginning of the first to the end of the last.
    pub whole: f64,
    /// From the submission of the first to the completion of the last.
    pub wall: f64,
}

/// Submitting and waiting may take as long, in seconds, whatever the work.
const OVERHEAD: f64 = 0.005;

/// Whether timestamps account for work that took `wall` seconds from submission to completion: for half of
/// what no overhead explains.
pub fn accounts_for(timestamps: f64, wall: f64) -> bool {
    2.0 * timestamps + OVERHEAD >= wall
}

impl Clock {
    /// The clock for lists of stages. Runs each list once, and each stage once more by itself.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If a list has no stages.
    pub async fn of(context: &Context, lists: &[&[&Stage]]) -> Result<Self> {
        let most = lists.iter().map(|list| list.len()).max().unwrap_or(0);
        let Ok(timer) = Timer::new(context, most as u32) else { return Ok(Self { timer: None }) };
        for list in lists {
            let (timestamps, _) = timer.run(context, list).await?;
            for (stage, own) in list.iter().zip(timestamps) {
                // Other programs may hold up a run.
                let mut tries = 3;
                while !accounts_for(own, time_of(context, stage).await?) {
                    tries -= 1;
                    if tries == 0 {
                        return Ok(Self { timer: None });
                    }
                }
            }
        }
        Ok(Self { timer: Some(timer) })
    }

    /// What it measures.
    pub const fn name(&self) -> &'static str {
        match self.timer {
            Some(_) => "timestamps",
            None => "submission to completion",
        }
    }

    /// Runs `stages` in order: at once, or one by one if timestamps cannot tell them apart.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    ///
    /// # Panics
    /// If there are no stages, or more than the timer supports.
    pub async fn time(&self, context: &Context, stages: &[&Stage]) -> Result<Times> {
        let start = Instant::now();
        let timed = match &self.timer {
            Some(timer) => Some(timer.run(context, stages).await?),
            None => None,
        };
        if let Some((each, whole)) = timed {
            return Ok(Times { each, whole, wall: start.elapsed().as_secs_f64() });
        }
        let mut each = Vec::with_capacity(stages.len());
        for stage in stages {
            each.push(time_of(context, stage).await?);
        }
        let wall = start.elapsed().as_secs_f64();
        Ok(Times { each, whole: wall, wall })
    }
}

/// Seconds from the submission of `stage` to its completion.
async fn time_of(context: &Context, stage: &Stage) -> Result<f64> {
    let start = Instant::now();
    context.submit(|encoder| stage.record(encoder));
    readback::finished(context).await?;
    Ok(start.elapsed().as_secs_f64())
}

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
    pub const fn compute_writes(&self, place: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * place),
            end_of_pass_write_index: Some(2 * place + 1),
        }
    }

    /// Timestamp writes of the render pass at `place`.
    pub const fn render_writes(&self, place: u32) -> wgpu::RenderPassTimestampWrites<'_> {
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
    pub async fn first_and_whole(&self, context: &Context, count: u32) -> Result<[f64; 2]> {
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
