//! What is said on standard error.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use octagloss::bake::Progress;
use std::collections::BTreeSet;
use std::io::{IsTerminal as _, Write as _};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Notes, warnings and the progress bar; `--quiet` leaves errors only.
pub(super) struct Talk {
    quiet: bool,
    warned: Mutex<BTreeSet<String>>,
}

impl Talk {
    pub(super) fn new(quiet: bool) -> Self {
        Self { quiet, warned: Mutex::new(BTreeSet::new()) }
    }

    pub(super) fn note(&self, text: &str) {
        if !self.quiet {
            line("", text);
        }
    }

    /// Says each warning once.
    pub(super) fn warn(&self, text: &str) {
        let fresh = self.warned.lock().expect("no one panics holding it").insert(text.to_owned());
        if fresh && !self.quiet {
            line("warning: ", text);
        }
    }

    /// A bar for one piece of work: hidden at first, and for good where no one sees it.
    pub(super) fn bar(&self, name: &str) -> Bar {
        let seen = !self.quiet && std::io::stderr().is_terminal();
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{prefix} {wide_bar} {percent:>3} %, {eta} left")
            .expect("the template is a literal");
        bar.set_style(style);
        bar.set_prefix(name.to_owned());
        Bar { bar, start: seen.then(Instant::now), shown: Mutex::new(false) }
    }
}

/// A progress bar on standard error, taken away when dropped.
pub(super) struct Bar {
    bar: ProgressBar,
    start: Option<Instant>,
    shown: Mutex<bool>,
}

impl Bar {
    /// `done` of `total`; from any thread, in any order.
    pub(super) fn at(&self, done: u64, total: u64) {
        let Some(start) = self.start else { return };
        if start.elapsed() < PATIENCE {
            return;
        }
        // A thread that finds the lock taken has nothing newer to show.
        let Ok(mut shown) = self.shown.try_lock() else { return };
        if !*shown {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            *shown = true;
        }
        self.bar.set_length(total);
        self.bar.set_position(done.max(self.bar.position()));
    }

    pub(super) fn bake(&self, progress: Progress) {
        self.at(progress.done, progress.total);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Says what went wrong, on one line.
pub(super) fn error(text: &str) {
    line("error: ", text);
}

fn line(kind: &str, text: &str) {
    let text: Vec<_> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    // There is no one left to tell when standard error is closed.
    writeln!(std::io::stderr(), "octagloss: {kind}{}", text.join(" ")).ok();
}

/// `1234567` bytes as `1.2 MB`.
pub(super) fn bytes(count: u64) -> String {
    let count = count as f64;
    match count {
        c if c < 1e3 => format!("{c} B"),
        c if c < 1e6 => format!("{:.1} kB", c / 1e3),
        c if c < 1e9 => format!("{:.1} MB", c / 1e6),
        c => format!("{:.1} GB", c / 1e9),
    }
}

/// A span of time in words, for estimates.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "less than a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} seconds"),
        s if s < 7200.0 => format!("{:.0} minutes", s / 60.0),
        s if s < 172_800.0 => format!("{:.0} hours", s / 3600.0),
        s => format!("{:.0} days", s / 86_400.0),
    }
}
