//! Signal handling: removes temporary files before the process ends; turns a file size limit into a write
//! error.

/// Installs the handlers. SIGINT, SIGTERM and SIGHUP remove temporary files and end the process with 128 + n.
/// Signals ignored by the parent process, as with `nohup`, stay ignored. SIGXFSZ becomes a write error.
#[cfg(unix)]
pub(super) fn watch() {
    use octagloss_core::files::io::output::remove_temporaries;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::{flag, iterator::Signals, low_level};
    use std::sync::{Arc, atomic::AtomicBool};

    // The flag is unused: a handled signal does not end the process, so the write fails.
    drop(flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false))));
    let ignored = ignored_signals();
    let handled = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| match ignored {
        Some(mask) => mask >> (signal - 1) & 1 == 0,
        // The mask of ignored signals is unavailable.
        None => *signal != SIGHUP,
    });
    let handled: Vec<_> = handled.collect();
    // The handling thread installs the handlers; without it, signals keep their default action.
    let wait = move || {
        let signal = Signals::new(handled).ok().and_then(|mut signals| signals.forever().next());
        if let Some(signal) = signal {
            remove_temporaries();
            // Skip destructors: other threads are still running.
            low_level::exit(128 + signal);
        }
    };
    drop(std::thread::Builder::new().name("signals".to_owned()).stack_size(1 << 18).spawn(wait));
}

/// Installs the handler of Ctrl-C, Ctrl-Break and a closed console, which removes temporary files and ends
/// the process with the status that Windows gives interrupted ones.
#[cfg(windows)]
pub(super) fn watch() {
    // STATUS_CONTROL_C_EXIT.
    const INTERRUPTED: i32 = 0xc000_013a_u32.cast_signed();
    // Without the handler the system ends the process, and the next run cleans up.
    let handler = ctrlc::set_handler(|| {
        octagloss_core::files::io::output::remove_temporaries();
        std::process::exit(INTERRUPTED);
    });
    drop(handler);
}

#[cfg(not(any(unix, windows)))]
pub(super) fn watch() {}

/// The mask of ignored signals, from Linux's /proc.
#[cfg(unix)]
fn ignored_signals() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}
