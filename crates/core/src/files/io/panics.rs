//! Contains panics of third-party decoders: a panic becomes an [`Error::Input`] and prints nothing.

use crate::common::error::{Error, Result};
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Once;

thread_local! {
    /// Whether this thread runs a guarded decoder, whose panics must not be printed to stderr.
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `decode`; a panic becomes an error about `path`.
///
/// The first call installs a panic hook that forwards all panics except guarded ones to the previous hook.
pub fn catching_panics<T>(path: &Path, decode: impl FnOnce() -> Result<T>) -> Result<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !CONTAINED.try_with(Cell::get).unwrap_or(false) {
                previous(info);
            }
        }));
    });
    let outer = CONTAINED.replace(true);
    let outcome = panic::catch_unwind(AssertUnwindSafe(decode));
    CONTAINED.set(outer);
    outcome.unwrap_or_else(|_| Err(Error::input(path, "corrupt: the decoder failed; re-export the file")))
}

#[cfg(test)]
mod tests {
    use super::catching_panics;
    use std::path::Path;

    #[test]
    fn panic_becomes_a_one_line_error() {
        let error = catching_panics::<()>(Path::new("a.exr"), || panic!("index out of bounds")).unwrap_err();
        assert_eq!(error.to_string(), "a.exr: corrupt: the decoder failed; re-export the file");
    }

    #[test]
    fn nested_calls_keep_the_outer_one_contained() {
        let error = catching_panics::<()>(Path::new("outer"), || {
            catching_panics::<()>(Path::new("inner"), || panic!("inside")).unwrap_err();
            panic!("outside")
        });
        assert!(error.unwrap_err().to_string().starts_with("outer: corrupt"), "the outer file is named");
    }
}
