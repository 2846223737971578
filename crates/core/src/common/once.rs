//! Values that are made at first use, by loops over threads.

use rayon::ThreadPoolBuilder;
use std::panic::resume_unwind;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

/// A value that is made at its first use, whichever thread needs it, by a pool of its own.
///
/// A thread of rayon that waits for its loop runs other work of its pool meanwhile. If that work needs the
/// value which the loop makes, the thread waits for what is suspended on its own stack, for ever. So no pool
/// makes a value that its threads may wait for.
#[derive(Debug)]
pub struct Once<T>(OnceLock<T>);

impl<T: Send + Sync> Once<T> {
    /// No value yet.
    pub const fn new() -> Self {
        Self(OnceLock::new())
    }

    /// The value, if it was made.
    pub fn get(&self) -> Option<&T> {
        self.0.get()
    }

    /// The value, which `make` makes at the first use.
    ///
    /// # Panics
    /// If `make` does; then there is no value, and the next use makes it.
    pub fn get_or_make(&self, make: impl FnOnce() -> T + Send) -> &T {
        // WebAssembly has no threads, and nothing runs meanwhile.
        self.0.get_or_init(|| if cfg!(target_arch = "wasm32") { make() } else { in_own_pool(make) })
    }
}

impl<T: Send + Sync> Default for Once<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> From<T> for Once<T> {
    fn from(value: T) -> Self {
        Self(OnceLock::from(value))
    }
}

/// Values of a table's nodes, each made at its first use.
#[derive(Debug)]
pub(crate) struct Known<T> {
    nodes: OnceLock<Vec<OnceLock<T>>>,
    count: usize,
}

impl<T> Known<T> {
    /// `count` nodes without values yet.
    pub(crate) const fn new(count: usize) -> Self {
        Self { nodes: OnceLock::new(), count }
    }

    /// The value of node `index`, which `make` makes at its first use, without loops over threads.
    pub(crate) fn get_or_init(&self, index: usize, make: impl FnOnce() -> T) -> &T {
        let nodes = self.nodes.get_or_init(|| (0..self.count).map(|_| OnceLock::new()).collect());
        nodes[index].get_or_init(make)
    }
}

/// What `make` makes in a pool as large as the current one, or of one thread where the system refuses more.
fn in_own_pool<T: Send>(make: impl FnOnce() -> T + Send) -> T {
    let threads = rayon::current_num_threads();
    let make = Mutex::new(Some(make));
    let run = || {
        let make = make.lock().unwrap_or_else(PoisonError::into_inner).take().expect("run once");
        let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build();
        match pool(threads).or_else(|_| pool(1)) {
            Ok(pool) => pool.install(make),
            Err(_) => make(),
        }
    };
    // A thread of one pool that waits for another runs work of its own pool, too: a thread of none waits.
    thread::scope(|scope| match thread::Builder::new().spawn_scoped(scope, run) {
        Ok(waiting) => waiting.join().unwrap_or_else(|panic| resume_unwind(panic)),
        Err(_) => run(),
    })
}
