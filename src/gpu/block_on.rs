//! Futures driven to their end, where no event loop does it.

use super::Context;
use crate::error::{Error, Result};
use std::future::Future;
use std::pin::pin;
use std::task::{Poll, Waker};

/// Waits for `future`, driving the device of `context` meanwhile. For programs; a browser's event loop drives futures
/// by itself.
///
/// # Errors
/// [`Error::Gpu`] where the device stops answering.
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
                    Error::Gpu(format!("{} stopped answering: {error}", context.describe()))
                })?;
            }
            None => std::thread::yield_now(),
        }
    }
}
