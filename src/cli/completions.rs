//! `octagloss completions`: prints completion scripts for shells.

use super::outcome::{Outcome, print_bytes};
use clap::{Args as ClapArgs, Command};
use clap_complete::Shell;

#[derive(Debug, ClapArgs)]
pub(super) struct CompletionsArgs {
    /// bash, zsh, fish, elvish or powershell
    ///
    /// bash: octagloss completions bash > ~/.local/share/bash-completion/completions/octagloss. zsh: a file
    /// _octagloss in a folder of $fpath. fish: ~/.config/fish/completions/octagloss.fish.
    #[arg(value_name = "SHELL", hide_possible_values = true)]
    shell: Shell,
}

pub(super) fn run(args: &CompletionsArgs, mut program: Command) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "octagloss", &mut script);
    print_bytes(&script)
}
