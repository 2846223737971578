//! Results of futures: at once in a program, later in a browser.

use octagloss_core::common::error::Result;
use octagloss_gpu::Context;
use std::cell::RefCell;
use std::rc::Rc;

/// Slot for the result of a future.
pub(crate) type Later<T> = Rc<RefCell<Option<Result<T>>>>;

/// Runs `future` to completion; in a browser, asynchronously.
pub(crate) fn later<T: 'static>(
    context: &Context,
    future: impl Future<Output = Result<T>> + 'static,
) -> Later<T> {
    let slot: Later<T> = Rc::default();
    #[cfg(not(target_arch = "wasm32"))]
    {
        let outcome = octagloss_gpu::block_on(Some(context), future).and_then(|outcome| outcome);
        *slot.borrow_mut() = Some(outcome);
    }
    #[cfg(target_arch = "wasm32")]
    {
        let _ = context;
        let place = Rc::clone(&slot);
        wasm_bindgen_futures::spawn_local(async move {
            let outcome = future.await;
            *place.borrow_mut() = Some(outcome);
        });
    }
    slot
}

/// Takes the result out of `slot` and empties it, once there is one.
pub(crate) fn taken<T>(slot: &mut Option<Later<T>>) -> Option<Result<T>> {
    let found = slot.as_ref()?.borrow_mut().take()?;
    *slot = None;
    Some(found)
}
