//! Values made at first use.

use octagloss_core::common::once::Once;
use octagloss_core::common::parallel::{for_each, map};
use octagloss_core::cpu::reflector::{Reflector, ReflectorSettings};
use octagloss_core::light::synth::synth;
use octagloss_core::lobe::Lobe;
use octagloss_core::lobe::filter::Filter;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Calls `work` in a pool of `threads`, and fails if it does not end.
fn in_a_pool(threads: usize, work: impl FnOnce() + Send + 'static) {
    let (done, ended) = mpsc::channel();
    thread::spawn(move || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(work);
        done.send(()).expect("the test waits");
    });
    ended.recv_timeout(Duration::from_secs(60)).expect("the pool must not wait for itself");
}

/// What a thread takes over while it waits for its own loop needs the value that the loop makes. A pool whose
/// threads made values themselves came to a halt here within some rounds.
#[test]
fn work_that_needs_a_value_in_the_making_ends() {
    in_a_pool(4, || {
        for _ in 0..300 {
            let made = AtomicUsize::new(0);
            let once = Once::new();
            let make = || {
                made.fetch_add(1, Ordering::Relaxed);
                map(0..8, |k| {
                    thread::sleep(Duration::from_micros(100));
                    k
                })
            };
            rayon::scope(|scope| {
                for k in 0..16 {
                    let (once, make) = (&once, &make);
                    scope.spawn(move |_| match k % 3 {
                        // Threads that are free a little later take parts of the loop.
                        0 => thread::sleep(Duration::from_micros(150)),
                        _ => assert_eq!(once.get_or_make(make).len(), 8),
                    });
                }
            });
            assert_eq!(made.into_inner(), 1);
        }
    });
}

#[test]
fn threads_in_and_out_of_a_pool_get_one_value() {
    let (once, calls) = (Once::new(), AtomicUsize::new(0));
    let make = || map(0..100, |_| calls.fetch_add(1, Ordering::Relaxed)).len();
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(*once.get_or_make(make), 100));
            scope.spawn(|| for_each(0..20, |_| assert_eq!(*once.get_or_make(make), 100)));
        }
    });
    assert_eq!((once.get(), calls.load(Ordering::Relaxed)), (Some(&100), 100), "made once");
    assert_eq!(Once::from(3).get_or_make(|| unreachable!("there is one")), &3);
}

#[test]
fn panics_reach_the_caller_and_leave_no_value() {
    let once = Once::<u32>::new();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for in_pool in [false, true] {
        let attempt = || once.get_or_make(|| panic!("no value"));
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            if in_pool { *pool.install(attempt) } else { *attempt() }
        }));
        assert!(caught.is_err());
        assert_eq!(once.get(), None);
    }
    assert_eq!(*once.get_or_make(|| 5), 5);
}

/// Rays of a picture that share a reflector ask for its tables at once.
#[test]
fn queries_on_many_threads_make_the_tables() {
    in_a_pool(8, || {
        let environment = synth("sky").expect("a recipe");
        let settings = ReflectorSettings { oem_size: Some(64), ..ReflectorSettings::default() };
        for filter in [Filter::Box, Filter::Pyramid, Filter::Adaptive(0.01)] {
            for roughness in [0.05, 0.5] {
                let reflector = Reflector::new(&environment, &settings).expect("a size");
                let ask = |x: u32| {
                    let direction = glam::DVec3::new(f64::from(x) - 20.5, 1.0, 0.0);
                    reflector.query(direction, roughness, Lobe::Ggx, filter).expect("an answer").radiance
                };
                let all = map(0..40, ask);
                assert_eq!(all, (0..40).map(ask).collect::<Vec<_>>(), "{filter:?}");
            }
        }
    });
}
