//! Messages and progress on standard error.

use crate::recipes::with_settings;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::collections::BTreeSet;
use std::io::{IsTerminal as _, Write as _};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Maximum message length in bytes; paths may have 4096.
const LONGEST: usize = 6000;

/// Shorter work shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Work that runs this long gets an estimate,
const ESTIMATE_AFTER: Duration = Duration::from_secs(4);
/// if at least this much of it is left.
const WORTH_SAYING: f64 = 15.0;

/// Notes, warnings and the progress bar; `--quiet` leaves errors only.
pub struct Console {
    quiet: bool,
    warned: Mutex<BTreeSet<String>>,
}

impl Console {
    pub fn new(quiet: bool) -> Self {
        Self { quiet, warned: Mutex::new(BTreeSet::new()) }
    }

    pub fn note(&self, text: &str) {
        if !self.quiet {
            line("", text);
        }
    }

    /// Prints each warning once.
    pub fn warn(&self, text: &str) {
        let fresh = self.warned.lock().expect("no holder of the lock panics").insert(text.to_owned());
        if fresh && !self.quiet {
            line("warning: ", text);
        }
    }

    /// [`Self::warn`] of `warnings` about the file `path`.
    pub(super) fn warn_of<'a>(&self, path: &Path, warnings: impl IntoIterator<Item = &'a String>) {
        warnings.into_iter().for_each(|warning| self.warn(&format!("{}: {warning}", path.display())));
    }

    /// Progress of one task: an estimate for long work, and on a terminal a bar that appears after a delay.
    pub fn bar(&self, name: &str) -> Bar {
        self.bar_of(name, None)
    }

    /// [`Self::bar`], or the progress of one of several files: on a terminal a bar with an estimate for all
    /// files; otherwise nothing.
    pub(super) fn bar_of(&self, name: &str, files: Option<Files>) -> Bar {
        let template = match files {
            None => "{prefix} {wide_bar} {percent:>3} %, {eta} left",
            Some(_) => "{prefix} {wide_bar} {percent:>3} %{msg}",
        };
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::hidden());
        bar.set_style(ProgressStyle::with_template(template).expect("the template is a literal"));
        bar.set_prefix(printable(name));
        Bar {
            bar,
            start: (!self.quiet).then(Instant::now),
            files,
            is_terminal: std::io::stderr().is_terminal(),
            is_estimated: Mutex::new(false),
        }
    }
}

/// Progress of a run over several files.
#[derive(Clone, Copy)]
pub(super) struct Files {
    /// Start of the first file.
    pub(super) start: Instant,
    pub(super) done: usize,
    /// Number of finished files.
    pub(super) total: usize,
}

/// A progress bar on standard error; removed when dropped.
pub struct Bar {
    bar: ProgressBar,
    /// `None` if nothing is printed.
    start: Option<Instant>,
    files: Option<Files>,
    is_terminal: bool,
    /// Whether the estimate was due; locked while one thread updates the bar.
    is_estimated: Mutex<bool>,
}

impl Bar {
    /// `done` of `total`; from any thread, in any order.
    pub fn at(&self, done: u64, total: u64) {
        let Some(start) = self.start else { return };
        let elapsed = self.files.map_or(start, |files| files.start).elapsed();
        if elapsed < PATIENCE {
            return;
        }
        // Skip the update if another thread holds the lock.
        let Ok(mut is_estimated) = self.is_estimated.try_lock() else { return };
        if let Some(files) = self.files {
            self.bar.set_message(files.left(elapsed, done as f64 / total.max(1) as f64));
        } else if elapsed >= ESTIMATE_AFTER && !*is_estimated && done > 0 {
            *is_estimated = true;
            if let Some(estimate) = estimate(elapsed, done, total) {
                // The bar is locked while it is suspended.
                let prefix = self.bar.prefix();
                self.bar.suspend(|| line("", &format!("{prefix}: {estimate}")));
            }
        }
        if self.is_terminal {
            if self.bar.is_hidden() {
                self.bar.set_draw_target(ProgressDrawTarget::stderr());
            }
            self.bar.set_length(total);
            self.bar.set_position(done.max(self.bar.position()));
        }
    }
}

impl Files {
    /// Estimated time left for all files, in words; empty before the first estimate. `share` of the current
    /// file is done.
    fn left(self, elapsed: Duration, share: f64) -> String {
        let done = self.done as f64 + share;
        if done == 0.0 {
            return String::new();
        }
        let rest = elapsed.as_secs_f64() * (self.total as f64 - done).max(0.0) / done;
        format!(", {} left in all", duration(rest))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Estimated time left after `elapsed` for `done` of `total`, in words; `None` if little is left.
fn estimate(elapsed: Duration, done: u64, total: u64) -> Option<String> {
    let rest = elapsed.as_secs_f64() * total.saturating_sub(done) as f64 / done as f64;
    (rest >= WORTH_SAYING).then(|| {
        let percent = (100.0 * done as f64 / total as f64).round();
        format!("{percent} % done, about {} left", duration(rest))
    })
}

/// Prints an error on one line.
pub fn error(text: &str) {
    line("error: ", text);
}
/// Remedies in the library's errors, and those of this program.
const REMEDIES: [(&str, &str); 3] = [
    (
        "is one of the program's own streams, not a file; name a file",
        "is one of the program's own streams, not a file; -o - writes to standard output",
    ),
    ("is not a regular file; name one", "is not a regular file; name one, or -o - for standard output"),
    ("convert it to equirect first", "run octagloss convert INPUT -o OUT --layout equirect"),
];

/// Writes the library's settings in `text` as this program's options.
pub fn with_options(text: &str) -> String {
    let text = with_settings(text, &|setting| format!("--{}", setting.replace('_', "-")));
    REMEDIES.iter().fold(text, |text, (remedy, own)| text.replace(remedy, own))
}

/// Prints a line that `--quiet` does not silence.
pub fn tell(text: &str) {
    line("", text);
}

fn line(kind: &str, text: &str) {
    let text = &with_options(text);
    let text: Vec<_> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    // Ignore a closed standard error.
    writeln!(std::io::stderr(), "octagloss: {kind}{}", printable(&text.join(" "))).ok();
}

/// Escapes control characters in `text`.
pub fn escaped(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { c.escape_default().to_string() } else { c.to_string() })
        .collect()
}

/// Escapes control characters, which would reach the terminal, and shortens long text in the middle.
fn printable(text: &str) -> String {
    let escaped = escaped(text);
    if escaped.len() <= LONGEST {
        return escaped;
    }
    let (head, tail) =
        (escaped.floor_char_boundary(LONGEST / 2), escaped.ceil_char_boundary(escaped.len() - LONGEST / 2));
    format!("{} ... {}", &escaped[..head], &escaped[tail..])
}

/// Formats `1234567` bytes as `1.2 MB`.
pub fn bytes(count: u64) -> String {
    let count = count as f64;
    match count {
        c if c < 1e3 => format!("{c} B"),
        c if c < 1e6 => format!("{:.1} kB", c / 1e3),
        c if c < 1e9 => format!("{:.1} MB", c / 1e6),
        c => format!("{:.1} GB", c / 1e9),
    }
}

/// Formats a duration in words, for estimates.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "less than a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} seconds"),
        s if s < 7200.0 => format!("{:.0} minutes", s / 60.0),
        s if s < 172_800.0 => format!("{:.0} hours", s / 3600.0),
        s => format!("{:.0} days", s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::{Console, ESTIMATE_AFTER, Files, estimate};
    use std::sync::mpsc;
    use std::thread;
    use std::time::{Duration, Instant};

    #[test]
    fn an_estimate_is_printed_without_waiting_for_itself() {
        let (sender, done) = mpsc::channel();
        thread::spawn(move || {
            let mut bar = Console::new(false).bar("long");
            bar.start = Instant::now().checked_sub(2 * ESTIMATE_AFTER);
            assert!(bar.start.is_some(), "a clock that has run for some seconds");
            bar.at(1, 100);
            sender.send(()).expect("still waited for");
        });
        // Ample timeout; a deadlock would wait forever.
        done.recv_timeout(Duration::from_secs(120)).expect("the bar waits for itself");
    }

    #[test]
    fn several_files_are_estimated_together() {
        let files = Files { start: Instant::now(), done: 2, total: 18 };
        assert_eq!(files.left(Duration::from_secs(10), 0.0), ", 80 seconds left in all");
        assert_eq!(files.left(Duration::from_secs(10), 0.5), ", 62 seconds left in all");
        assert_eq!(Files { done: 0, ..files }.left(Duration::from_secs(10), 0.0), "");
    }

    #[test]
    fn long_work_is_estimated_and_short_work_is_not() {
        let words = estimate(Duration::from_secs(4), 10, 400).expect("156 seconds are left");
        assert_eq!(words, "3 % done, about 3 minutes left");
        assert_eq!(estimate(Duration::from_secs(4), 90, 100), None);
    }
}
