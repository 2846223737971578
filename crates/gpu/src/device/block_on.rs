//! Blocks on a future, for native programs without an event loop.

use super::context::Context;
use octagloss_core::common::error::{Error, Result};
use std::future::Future;
use std::pin::pin;
use std::task::{Poll, Waker};

/// Waits for `future`, polling the device of `context`. Native programs only; in a browser the event loop
/// drives futures.
///
/// # Errors
/// [`Error::Gpu`] if the device stops responding.
pub fn block_on<F: Future>(context: Option<&Context>, future: F) -> Result<F::Output> {
    let mut future = pin!(future);
    let mut task = std::task::Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut task) {
            return Ok(output);
        }
        match context {
            Some(context) => {
                context.device().poll(wgpu::PollType::wait_indefinitely()).map_err(|error| {
                    Error::Gpu(format!("{} stopped responding: {error}", context.describe()))
                })?;
            }
            None => std::thread::yield_now(),
        }
    }
}
