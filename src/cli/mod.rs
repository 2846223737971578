//! The command line: arguments are parsed (`args`), checked into a plan, then run, one file a subcommand.
//!
//! Standard output is data and standard error is talk. Exit status: 0 done, 1 failed, 2 usage.

mod args;
mod bake;
mod bake_targets;
mod bench;
#[cfg(feature = "gpu")]
mod bench_gpu;
mod compare;
mod dfg;
mod engine;
mod info;
mod input;
mod output;
mod query;
mod synth;
mod talk;
mod unchanged;
mod values;
#[cfg(feature = "view")]
mod view;

use args::{Args, Command};
use clap::Parser as _;
use clap::error::ErrorKind;
use std::io::Write as _;
use std::process::ExitCode;

/// Why a subcommand stopped early.
#[derive(Debug)]
enum Failure {
    /// What was asked for makes no sense; exit status 2.
    Usage(String),
    /// It made sense and went wrong; exit status 1.
    Failed(anyhow::Error),
    /// Like `Failed`, told already: one of several inputs went wrong.
    Told,
    /// Whoever read standard output has seen enough, which is not an error.
    Closed,
}

type Outcome<T = ()> = Result<T, Failure>;

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Failed(error)
    }
}

impl From<octagloss::Error> for Failure {
    fn from(error: octagloss::Error) -> Self {
        Self::Failed(error.into())
    }
}

/// A usage error.
fn usage<T>(message: impl Into<String>) -> Outcome<T> {
    Err(Failure::Usage(message.into()))
}

/// Runs the program on the process's own arguments.
pub(crate) fn main() -> ExitCode {
    let outcome = match Args::try_parse() {
        Ok(args) => run(args.command),
        Err(error) => refuse(&error),
    };
    match outcome {
        Ok(()) | Err(Failure::Closed) => ExitCode::SUCCESS,
        Err(Failure::Told) => ExitCode::from(1),
        Err(Failure::Failed(error)) => {
            talk::error(&format!("{error:#}"));
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            talk::error(&message);
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Outcome {
    match command {
        Command::Bake(args) => bake::run(args),
        Command::Query(args) => query::run(args),
        Command::Info(args) => info::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Synth(args) => synth::run(args),
        Command::Dfg(args) => dfg::run(args),
        #[cfg(feature = "view")]
        Command::View(args) => view::run(*args),
    }
}

/// Help and version go to standard output; what clap objects to becomes one line.
fn refuse(error: &clap::Error) -> Outcome {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => print(&error.render().to_string()),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => usage(
            "a subcommand is missing: bake, query, info, compare, bench, synth, dfg or view; see octagloss --help",
        ),
        _ => {
            let text = error.render().to_string();
            let said: Vec<_> = text
                .lines()
                .map(str::trim)
                .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
                .filter(|line| !line.is_empty())
                .collect();
            let said = said.join(" ").replace(" tip: ", "; ");
            usage(said.strip_prefix("error: ").unwrap_or(&said))
        }
    }
}

/// Writes data to standard output.
fn print(text: &str) -> Outcome {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Err(Failure::Closed),
        Err(error) => Err(anyhow::Error::new(error).context("standard output").into()),
    }
}

/// Runs `work` on `threads` threads of its own, or on as many as there are cores.
fn on_threads<T: Send>(threads: Option<u32>, work: impl FnOnce() -> Outcome<T> + Send) -> Outcome<T> {
    match threads {
        None => work(),
        Some(count) => rayon::ThreadPoolBuilder::new()
            .num_threads(count as usize)
            .build()
            .map_err(|error| anyhow::Error::new(error).context(format!("--threads {count}")))?
            .install(work),
    }
}
