//! A bake stops when its progress callback requests it.

use octagloss_core::bake::{BakeSettings, Progress, bake_all};
use octagloss_core::common::error::Error;
use octagloss_core::light::environment::Environment;
use octagloss_core::light::synth::synth;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bakes `environment` until `most` rows are done; returns the outcome, the texels done and the total.
fn baked_until(environment: &Environment, most: u64) -> (Result<(), Error>, u64, u64) {
    let settings = BakeSettings { size: 64, levels: Some(3), ..BakeSettings::default() };
    let (calls, done, total) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
    let progress = |progress: Progress| {
        done.fetch_max(progress.done, Ordering::Relaxed);
        total.store(progress.total, Ordering::Relaxed);
        let is_enough = calls.fetch_add(1, Ordering::Relaxed) + 1 >= most;
        if is_enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let outcome = bake_all(environment, &[settings], &progress).map(drop);
    (outcome, done.into_inner(), total.into_inner())
}

#[test]
fn a_bake_stops_where_its_progress_breaks() {
    let sky = synth("sky").expect("a known name");
    // The mirror reports once, level 1 row by row.
    let (outcome, done, total) = baked_until(&sky, 3);
    assert!(matches!(outcome, Err(Error::Cancelled)), "{outcome:?}");
    assert!(done < total, "{done} of {total}");
    let (outcome, done, total) = baked_until(&sky, u64::MAX);
    assert!(outcome.is_ok() && done == total, "{outcome:?}: {done} of {total}");
}
