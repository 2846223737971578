//! Loops over threads.

use octagloss_core::common::error::{Error, Result};
use octagloss_core::common::parallel::{for_each, map, map_with, try_map_with, values};
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn what_is_made_is_in_the_order_of_the_tasks() {
    let squares = |count: usize| -> Vec<usize> { (0..count).map(|k| k * k).collect() };
    for count in [0, 1, 2, 1023, 1024, 1025, 5000] {
        assert_eq!(values(count, |k| k * k), squares(count));
        assert_eq!(map(0..count, |k| k * k), squares(count));
        let mut places = vec![0; count];
        for_each(places.iter_mut().enumerate(), |(k, place)| *place = k * k);
        assert_eq!(places, squares(count));
    }
}

#[test]
fn a_workspace_serves_one_task_at_a_time() {
    let made = AtomicUsize::new(0);
    let start = || {
        made.fetch_add(1, Ordering::Relaxed);
        0_usize
    };
    let busy = map_with(0..1000, start, |used, task| {
        *used += 1;
        (task, *used)
    });
    assert!(busy.iter().map(|(task, _)| *task).eq(0..1000));
    let made = made.into_inner();
    assert!(made <= rayon::current_num_threads(), "{made} workspaces");
    assert_eq!(busy.iter().filter(|(_, used)| *used == 1).count(), made, "each has one first task");
}

#[test]
fn after_an_error_no_task_begins() {
    let begun = AtomicUsize::new(0);
    let failing = |(): &mut (), task: usize| -> Result<usize> {
        begun.fetch_add(1, Ordering::Relaxed);
        if task == 0 { Err(Error::Parameter("no".to_owned())) } else { Ok(task) }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let failed = pool.install(|| try_map_with(0..1000, || (), failing));
    assert!(matches!(failed, Err(Error::Parameter(text)) if text == "no"));
    assert_eq!(begun.load(Ordering::Relaxed), 1);
    assert_eq!(try_map_with(1..1000, || (), failing).unwrap(), (1..1000).collect::<Vec<_>>());
}

#[test]
fn panics_reach_the_caller() {
    let caught = std::panic::catch_unwind(|| map(0..10, |k| assert_ne!(k, 7)));
    assert!(caught.is_err());
}
