//! Signals: temporary files are removed before the process ends, and a file size limit is an error of
//! writing.

/// Reacts to signals from now on. SIGINT, SIGTERM and SIGHUP remove temporary files and end the process with
/// 128 + n; those that the parent process has set to be ignored, as `nohup` does, stay ignored. SIGXFSZ
/// becomes an error of writing.
#[cfg(unix)]
pub(super) fn watch() {
    use crate::io::output::remove_temporaries;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::{flag, iterator::Signals, low_level};
    use std::sync::{Arc, atomic::AtomicBool};

    // Nobody reads the flag: handled, the signal does not end the process, and the write fails.
    drop(flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false))));
    let ignored = ignored_signals();
    let wanted = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| match ignored {
        Some(mask) => mask >> (signal - 1) & 1 == 0,
        // Whether nohup is at work is not known.
        None => *signal != SIGHUP,
    });
    let wanted: Vec<_> = wanted.collect();
    // Handlers are set by the thread that reacts: without it, signals do what they do by default.
    let wait = move || {
        let signal = Signals::new(wanted).ok().and_then(|mut signals| signals.forever().next());
        if let Some(signal) = signal {
            remove_temporaries();
            // Without destructors: other threads are still at work.
            low_level::exit(128 + signal);
        }
    };
    drop(std::thread::Builder::new().name("signals".to_owned()).stack_size(1 << 18).spawn(wait));
}

#[cfg(not(unix))]
pub(super) fn watch() {}

/// The mask of ignored signals; Linux tells it.
#[cfg(unix)]
fn ignored_signals() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}
