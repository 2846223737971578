//! Values that are made at first use, by loops over threads.

use rayon::ThreadPoolBuilder;
use std::panic::resume_unwind;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

/// A value that is made at its first use, whichever thread needs it.
///
/// A thread of rayon that waits for its loop runs other work of its pool meanwhile. If that needs the value
/// that is being made, it waits for what lies below it on its own stack. So no thread of a pool makes a
/// value: a pool of its own does.
#[derive(Debug)]
pub struct Once<T> {
    value: OnceLock<T>,
    /// Held while a thread of no pool makes the value.
    turn: Mutex<()>,
}

impl<T: Send + Sync> Once<T> {
    /// No value yet.
    pub const fn new() -> Self {
        Self { value: OnceLock::new(), turn: Mutex::new(()) }
    }

    /// The value, if it was made.
    pub fn get(&self) -> Option<&T> {
        self.value.get()
    }

    /// The value; `make` is called at the first use, rarely twice.
    pub fn get_or_make(&self, make: impl FnOnce() -> T + Send) -> &T {
        if let Some(value) = self.value.get() {
            return value;
        }
        if rayon::current_thread_index().is_some() {
            return self.value.get_or_init(|| in_own_pool(make));
        }
        // Threads of a pool may wait for the value while loops of that pool make it: nothing that they wait
        // for is held meanwhile.
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        if self.value.get().is_none() {
            let made = make();
            return self.value.get_or_init(|| made);
        }
        self.value.get().expect("made")
    }
}

impl<T> From<T> for Once<T> {
    fn from(value: T) -> Self {
        Self { value: OnceLock::from(value), turn: Mutex::new(()) }
    }
}

/// What `make` makes in a pool of its own, as large as the current one.
fn in_own_pool<T: Send>(make: impl FnOnce() -> T + Send) -> T {
    match ThreadPoolBuilder::new().num_threads(rayon::current_num_threads()).build() {
        // A thread of a pool would run other work while it waits for another pool.
        Ok(pool) => thread::scope(|scope| {
            scope.spawn(|| pool.install(make)).join().unwrap_or_else(|panic| resume_unwind(panic))
        }),
        // Where there are no threads, nothing runs meanwhile.
        Err(_) => make(),
    }
}
