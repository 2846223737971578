//! Quotes shell arguments for messages.

use std::ffi::OsStr;

/// This process's arguments, each after a space.
#[cfg(not(feature = "plot"))]
pub(super) fn own_arguments() -> String {
    listed(std::env::args_os().skip(1))
}

/// `arguments`, each after a space.
pub(super) fn listed(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> String {
    arguments.into_iter().map(|argument| format!(" {}", quoted(argument.as_ref()))).collect()
}

/// Quotes `argument` for a POSIX shell.
fn quoted(argument: &OsStr) -> String {
    let text = argument.to_string_lossy();
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.into_owned();
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}
