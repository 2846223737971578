//! Loops over the threads of rayon's pool.
//!
//! All of them are one loop over indices, whose closure is called through a pointer: rayon compiled once for
//! every loop of its own was a fifth of what this crate compiles to.

use crate::common::error::Result;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard};

/// Values that one task of [`values`] makes.
const BLOCK: usize = 1024;

/// Calls `work` with each of `tasks`, which are long enough to be worth scheduling.
pub fn for_each<T: Send>(tasks: impl IntoIterator<Item = T>, work: impl Fn(T) + Sync) {
    map(tasks, work);
}

/// What `work` makes of each of `tasks`, in their order.
pub fn map<T: Send, R: Send>(tasks: impl IntoIterator<Item = T>, work: impl Fn(T) -> R + Sync) -> Vec<R> {
    map_with(tasks, || (), |(), task| work(task))
}

/// [`map`] with a workspace, made by `start`, that one task after the other uses.
pub fn map_with<W: Send, T: Send, R: Send>(
    tasks: impl IntoIterator<Item = T>,
    start: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, T) -> R + Sync,
) -> Vec<R> {
    let slots: Vec<Mutex<(Option<T>, Option<R>)>> =
        tasks.into_iter().map(|task| Mutex::new((Some(task), None))).collect();
    let idle = Mutex::new(Vec::new());
    run(slots.len(), &|index| {
        let task = lock(&slots[index]).0.take().expect("each task is run once");
        let popped = lock(&idle).pop();
        let mut workspace = popped.unwrap_or_else(&start);
        let made = work(&mut workspace, task);
        lock(&slots[index]).1 = Some(made);
        lock(&idle).push(workspace);
    });
    slots.iter().map(|slot| lock(slot).1.take().expect("each task is run")).collect()
}

/// [`map_with`] for work that may fail: after an error no task begins.
///
/// # Errors
/// The first of those that were met, by the order of the tasks.
pub fn try_map_with<W: Send, T: Send, R: Send>(
    tasks: impl IntoIterator<Item = T>,
    start: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, T) -> Result<R> + Sync,
) -> Result<Vec<R>> {
    let failed = AtomicBool::new(false);
    let made = map_with(tasks, start, |workspace, task| {
        if failed.load(Ordering::Relaxed) {
            return None;
        }
        let made = work(workspace, task);
        failed.fetch_or(made.is_err(), Ordering::Relaxed);
        Some(made)
    });
    made.into_iter().flatten().collect()
}

/// `make` of 0, 1, ... `count` - 1: many values that are quickly made.
pub fn values<T: Copy + Default + Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut values = vec![T::default(); count];
    for_each(values.chunks_mut(BLOCK).enumerate(), |(block, values)| {
        values.iter_mut().zip(block * BLOCK..).for_each(|(value, index)| *value = make(index));
    });
    values
}

/// Calls `work` with 0, 1, ... `count` - 1.
fn run(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

/// What `mutex` guards.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect("nothing panics while it is locked")
}
