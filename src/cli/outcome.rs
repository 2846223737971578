//! Outcomes and output of subcommands.

use crate::files::Existing;
use anyhow::{Context as _, anyhow};
use octagloss_core::files::io::output as output_file;
use serde::Serialize;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

/// Reasons for a subcommand to stop early.
#[derive(Debug)]
pub enum Failure {
    /// Invalid options; exit status 2.
    Usage(String),
    /// A failure of valid options; exit status 1.
    Failed(anyhow::Error),
    /// Like `Failed`, but already reported: one of several inputs failed.
    Reported,
    /// The reader closed standard output; not an error.
    Closed,
}

pub type Outcome<T = ()> = Result<T, Failure>;

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// Returns a usage error.
pub fn usage<T>(message: impl Into<String>) -> Outcome<T> {
    Err(Failure::Usage(message.into()))
}

/// Returns a failure of valid options.
pub fn failed<T>(message: impl Into<String>) -> Outcome<T> {
    Err(Failure::Failed(anyhow::Error::msg(message.into())))
}

/// `error` of reading, with this subcommand's own words for some of the reader's settings.
pub fn renamed(error: &crate::Error, names: &[(&str, &str)]) -> Failure {
    let replace = |text: String, (setting, own): &(&str, &str)| text.replace(setting, own);
    Failure::Failed(anyhow!(names.iter().fold(error.to_string(), replace)))
}

/// Writes text to standard output.
pub fn print(text: &str) -> Outcome {
    print_bytes(text.as_bytes())
}

/// Writes data to standard output. A closed pipe is not an error.
pub fn print_bytes(bytes: &[u8]) -> Outcome {
    write_stdout(bytes).map_err(|error| match error.kind() {
        std::io::ErrorKind::BrokenPipe => Failure::Closed,
        _ => anyhow::Error::new(error).context("standard output").into(),
    })
}

/// Prints `value` as JSON on one line.
pub fn print_json(value: &impl Serialize) -> Outcome {
    print(&(serde_json::to_string(value)? + "\n"))
}

/// Prints `value` as indented JSON.
pub fn print_pretty(value: &impl Serialize) -> Outcome {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// A table as CSV, headed by the names of its columns.
pub fn csv_text(header: &str, rows: impl IntoIterator<Item = Vec<String>>) -> Outcome<String> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    let records = std::iter::once(header.split(',').map(str::to_owned).collect()).chain(rows);
    for record in records {
        csv.write_record(&record)?;
    }
    Ok(String::from_utf8(csv.into_inner().expect("written to memory"))?)
}

/// Writes to the descriptor directly: the standard library silently ignores an unwritable one.
#[cfg(unix)]
fn write_stdout(bytes: &[u8]) -> std::io::Result<()> {
    use std::os::fd::AsFd as _;
    std::fs::File::from(std::io::stdout().as_fd().try_clone_to_owned()?).write_all(bytes)
}

#[cfg(not(unix))]
fn write_stdout(bytes: &[u8]) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()
}

/// Whether standard output was closed at startup. The standard library then opens the null device for reading
/// and writing instead; shells open it for writing only.
#[cfg(unix)]
fn stdout_was_closed() -> bool {
    use rustix::fs::{OFlags, fcntl_getfl, fstat, stat};
    let out = std::io::stdout();
    let is_null = fstat(&out).ok().zip(stat("/dev/null").ok()).is_some_and(|(a, b)| a.st_rdev == b.st_rdev);
    is_null && fcntl_getfl(&out).is_ok_and(|flags| flags.contains(OFlags::RDWR))
}

#[cfg(not(unix))]
const fn stdout_was_closed() -> bool {
    false
}

/// Whether the output `path` is standard output; fails if that is a terminal or closed.
pub fn is_stdout(path: &Path) -> Outcome<bool> {
    // Compare the literal text: `./-` is a file.
    let is_stdout = path.as_os_str() == "-";
    if is_stdout && std::io::stdout().is_terminal() {
        return usage(
            "-o - writes binary data, but standard output is a terminal; redirect it to a file or a pipe",
        );
    }
    if is_stdout && stdout_was_closed() {
        return failed("-o - needs standard output, which is closed; name a file with -o");
    }
    Ok(is_stdout)
}

/// Writes `bytes` to the file `path`, or to standard output for `-`.
pub fn write_output(path: &Path, existing: Existing, bytes: &[u8]) -> Outcome {
    if is_stdout(path)? {
        return print_bytes(bytes);
    }
    Ok(output_file::write_file(path, existing, |file| file.write_all(bytes))?)
}

/// Checks that the path of `option` names a PNG file.
pub fn check_png(option: &str, path: &Path) -> Outcome {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Ok(());
    }
    usage(format!("{option} {} must end in .png", path.display()))
}

/// Checks that [`write_output`] can write to `path`, by `force` over a file that exists, and cleans up after
/// killed runs in its folder.
pub fn check_output(path: &Path, force: bool) -> Outcome<Existing> {
    let existing = Existing::by_force(force);
    if !is_stdout(path)? {
        output_file::recover(path);
        output_file::check_file(path, existing)?;
    }
    Ok(existing)
}

/// Refuses the first of `options` that was given, by a message about its name.
pub fn refuse_given(options: &[(bool, &str)], message: impl FnOnce(&str) -> String) -> Outcome {
    match options.iter().find(|(is_given, _)| *is_given) {
        Some((_, option)) => usage(message(option)),
        None => Ok(()),
    }
}

/// `result`, whose error is one of usage.
pub fn or_usage<T>(result: crate::Result<T>) -> Outcome<T> {
    result.or_else(|error| usage(error.to_string()))
}

/// Runs `work` in a pool of `threads` threads, by default one per core.
pub fn on_threads<T: Send>(threads: Option<u32>, work: impl FnOnce() -> Outcome<T> + Send) -> Outcome<T> {
    match threads {
        None => work(),
        Some(count) => rayon::ThreadPoolBuilder::new()
            .num_threads(count as usize)
            .build()
            .with_context(|| format!("--threads {count}"))?
            .install(work),
    }
}

/// Rejects the output `path` if it is one of `inputs`, with links resolved.
pub fn check_not_input<'a>(path: &Path, inputs: impl IntoIterator<Item = &'a PathBuf>) -> Outcome {
    let Ok(real) = path.canonicalize() else { return Ok(()) };
    if inputs.into_iter().any(|input| input.canonicalize().is_ok_and(|input| input.starts_with(&real))) {
        return usage(format!("{} is an input; name another output", path.display()));
    }
    Ok(())
}
