//! The command line. Parses arguments (`args`), checks them into a plan and runs it; one file per subcommand.
//!
//! Data goes to standard output, messages to standard error. Exit status: 0 success, 1 failure, 2 usage
//! error.

mod args;
mod bake;
mod bake_plan;
mod bench;
#[cfg(feature = "gpu")]
mod bench_direct;
#[cfg(feature = "gpu")]
mod bench_gpu;
mod compare;
mod compare_many;
mod compare_pair;
mod compare_parts;
mod compare_sources;
mod comparison;
mod completions;
pub mod console;
mod convert;
mod dfg;
mod elsewhere;
mod engine;
mod expand;
mod fingerprint;
mod gate;
mod info;
mod info_other;
mod input;
mod licenses;
mod look_ups;
mod man;
mod measures;
pub mod outcome;
pub mod output;
mod query;
mod reader;
pub mod rows;
mod shell;
mod signals;
mod summary;
mod synth;
mod timing;
pub mod values;
mod verify;
#[cfg(feature = "view")]
mod view;
#[cfg(feature = "view")]
mod view_args;
#[cfg(feature = "view")]
mod view_scene;

use anyhow::Context as _;
use args::{Args, Command};
use clap::error::ErrorKind;
use clap::{Arg, CommandFactory as _, Parser};
use outcome::{Failure, Outcome, print, usage};
use std::any::TypeId;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Runs the program with the process's arguments; `licenses` are those of other crates, if the program has
/// them.
pub fn main(licenses: Option<&str>) -> ExitCode {
    execute(|args: Args| run(args.command, licenses))
}

/// Parses the process's arguments and runs them; prints what fails.
pub fn execute<A: Parser>(run: impl FnOnce(A) -> Outcome) -> ExitCode {
    signals::watch();
    let matches = with_negative_numbers(A::command()).try_get_matches();
    let outcome = match matches.and_then(|mut matches| A::from_arg_matches_mut(&mut matches)) {
        Ok(args) => run(args),
        Err(error) => refuse(&error, &A::command()),
    };
    match outcome {
        Ok(()) | Err(Failure::Closed) => ExitCode::SUCCESS,
        Err(Failure::Reported) => ExitCode::from(1),
        Err(Failure::Failed(error)) => {
            console::error(&format!("{error:#}"));
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            console::error(&message);
            ExitCode::from(2)
        }
    }
}

/// Takes negative numbers for values of options, so that the refusal of one names its option. Names of files
/// do not begin like options.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let takes_numbers = |arg: &Arg| {
        !arg.is_positional()
            && arg.get_action().takes_values()
            && arg.get_value_parser().type_id() != TypeId::of::<PathBuf>()
    };
    command
        .mut_args(move |arg| if takes_numbers(&arg) { arg.allow_negative_numbers(true) } else { arg })
        .mut_subcommands(with_negative_numbers)
}

fn run(command: Command, licenses: Option<&str>) -> Outcome {
    cap_environment_threads()?;
    match command {
        Command::Bake(args) => bake::run(args),
        Command::Query(args) => query::run(args),
        Command::Info(args) => info::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Synth(args) => synth::run(args),
        Command::Dfg(args) => dfg::run(args),
        Command::Analyze(args) => args.refuse(
            "analyze is in the workbench; in a checkout of the sources",
            "-p octagloss-workbench -- analyze",
        ),
        Command::Convert(args) => convert::run(&args),
        Command::Completions(args) => completions::run(&args, Args::command()),
        Command::Man(args) => man::run(&args, Args::command()),
        Command::Reader(args) => reader::run(&args),
        Command::Licenses => licenses::run(licenses),
        #[cfg(feature = "view")]
        Command::View(args) => view::run(*args),
        #[cfg(not(feature = "view"))]
        Command::View(args) => args.refuse("view is not part of this build;", "--features view -- view"),
    }
}

/// Prints help and version to standard output; joins clap's errors to one line.
fn refuse(error: &clap::Error, command: &clap::Command) -> Outcome {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => print(&error.render().to_string()),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let shown = command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set());
            let names: Vec<_> = shown.map(clap::Command::get_name).collect();
            let (names, program) = (names.join(", "), command.get_name());
            usage(format!("missing subcommand; choose one of {names}; see {program} --help"))
        }
        // clap names neither the option nor the value.
        ErrorKind::InvalidUtf8 => usage(not_utf8(std::env::args_os())),
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

/// Names the arguments that are not UTF-8, with the options before them.
fn not_utf8(arguments: impl Iterator<Item = OsString>) -> String {
    let mut previous = String::new();
    let mut named = Vec::new();
    for argument in arguments {
        let text = argument.to_string_lossy().into_owned();
        if argument.to_str().is_none() {
            let option = if previous.starts_with('-') { format!("{previous} ") } else { String::new() };
            named.push(format!("{option}{text}"));
        }
        previous = text;
    }
    format!("invalid UTF-8 in {}", named.join(" and "))
}

/// Caps rayon's thread count from the environment at the number of cores; more are slower, and too many fail
/// to start.
fn cap_environment_threads() -> Outcome {
    let asked = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"].map(|name| std::env::var(name).ok());
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let Some(threads) = capped_threads(asked.iter().flatten().map(String::as_str), cores) else {
        return Ok(());
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    Ok(pool.with_context(|| format!("{threads} threads"))?)
}

/// The number of threads to set if a value in `asked` exceeds `cores`.
fn capped_threads<'a>(asked: impl Iterator<Item = &'a str>, cores: usize) -> Option<usize> {
    let mut asked = asked.map(str::trim).filter(|text| !text.is_empty());
    // Treat a number that overflows usize as a large number.
    let too_many = |text: &str| {
        text.bytes().all(|byte| byte.is_ascii_digit())
            && text.parse().map_or(true, |count: usize| count > cores)
    };
    asked.any(too_many).then_some(cores)
}

#[cfg(test)]
mod tests {
    use super::{capped_threads, not_utf8};
    use std::ffi::OsString;

    #[cfg(unix)]
    #[test]
    fn arguments_that_are_no_text_are_named_with_their_options() {
        use std::os::unix::ffi::OsStringExt as _;
        let arguments = [&b"octagloss"[..], b"analyze", b"--map", b"cu\xffbe", b"--size=\xfe"];
        let arguments = arguments.map(|bytes| OsString::from_vec(bytes.to_vec()));
        let named = not_utf8(arguments.into_iter());
        assert_eq!(named, "invalid UTF-8 in --map cu\u{fffd}be and --size=\u{fffd}");
    }

    #[test]
    fn threads_of_the_environment_are_capped_at_the_cores() {
        let capped = |asked: &str| capped_threads(std::iter::once(asked), 4);
        assert_eq!([capped("5"), capped("1000"), capped(" 99999999999999999999999 ")], [Some(4); 3]);
        assert_eq!([capped("4"), capped("1"), capped("0"), capped(""), capped("many")], [None; 5]);
    }
}
