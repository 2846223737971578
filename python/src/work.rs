//! Long work: without the interpreter's lock, interruptible, in a pool of threads of this process.

use crate::errors::{raised, wrong};
use octagloss::Error;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Interval of looking for signals.
const INTERVAL: Duration = Duration::from_millis(50);

/// Most threads of a pool, as on the command line.
const MAX_THREADS: usize = 256;

/// Whether the caller still waits for the work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// # Errors
    /// [`Error::Cancelled`] if the caller was interrupted.
    pub(crate) fn check(&self) -> octagloss::Result<()> {
        if self.is_set() { Err(Error::Cancelled) } else { Ok(()) }
    }

    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Runs `work` in a thread of its own and waits for it, without the interpreter's lock. `work` runs parallel
/// parts in the pool that it is given.
///
/// If a signal handler raises, as that of Ctrl-C does, returns its exception at once; `work` ends when it
/// looks at its [`Cancel`], and must not write files after that.
///
/// # Errors
/// The exception for the error of `work`, or that of a signal handler.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Cancel, &ThreadPool) -> octagloss::Result<T> + Send + 'static,
) -> PyResult<T> {
    let pool = pool(None)?;
    let cancel = Cancel::default();
    let theirs = cancel.clone();
    let (send, receive) = mpsc::channel();
    let job = move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| work(&theirs, &pool)));
        // After an interrupt nobody receives it.
        drop(send.send(outcome));
    };
    let thread = std::thread::Builder::new().name("octagloss".to_owned());
    thread.spawn(job).map_err(|error| PyRuntimeError::new_err(format!("a thread: {error}")))?;
    // A receiver is not shared between threads; the lock is released around each wait.
    let receive = Mutex::new(receive);
    loop {
        match py.detach(|| held(&receive).recv_timeout(INTERVAL)) {
            Ok(Ok(outcome)) => return outcome.map_err(|error| raised(py, &error)),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a thread ended without an answer"));
            }
        }
        if let Err(error) = py.check_signals() {
            cancel.0.store(true, Ordering::Relaxed);
            return Err(error);
        }
    }
}

/// Locks `mutex`, also after a panic of another holder.
pub(crate) fn held<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The pool and the process that made it.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process; a new one of `threads` threads if given.
///
/// The global pool of rayon does not survive a fork, as of `multiprocessing` and of data loaders: the child
/// has none of its threads. A child makes a pool of its own.
fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let mut pool = held(&POOL);
    let process = std::process::id();
    if let (Some((maker, pool)), None) = (&*pool, threads)
        && *maker == process
    {
        return Ok(Arc::clone(pool));
    }
    let made = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let made = Arc::new(made.map_err(|error| PyRuntimeError::new_err(format!("threads: {error}")))?);
    if let Some((maker, old)) = pool.replace((process, Arc::clone(&made)))
        && maker != process
    {
        // Its threads do not exist in this process, so they cannot be ended.
        std::mem::forget(old);
    }
    Ok(made)
}

/// Sets the number of threads of all later calls: 1 to 256, or None for one per core. Results do not depend
/// on it. The environment variable RAYON_NUM_THREADS sets the default.
#[pyfunction]
#[pyo3(signature = (count=None))]
pub(crate) fn set_threads(count: Option<usize>) -> PyResult<()> {
    match count {
        Some(count) if !(1..=MAX_THREADS).contains(&count) => {
            Err(wrong(format!("`count` is {count}; it must be 1 to {MAX_THREADS}")))
        }
        count => pool(Some(count.unwrap_or(0))).map(drop),
    }
}
