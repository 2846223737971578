//! Names of an enum's values: the same in options, files, reports, the viewer's panels and on the page.

/// Gives an enum `ALL`, `name` and `named`, and implements [`std::fmt::Display`] and [`std::str::FromStr`].
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($type:ident { $($value:ident = $name:literal),+ $(,)? }) => {
        #[allow(dead_code, unreachable_pub, reason = "not every enum is public and needs all of them")]
        impl $type {
            /// All values.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$value),+];

            /// Name on the command line, in reports and in files.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$value => $name),+ }
            }

            /// The value called `name`.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|value| value.name() == name)
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        /// Parses the output of [`std::fmt::Display`].
        impl std::str::FromStr for $type {
            type Err = String;

            fn from_str(text: &str) -> std::result::Result<Self, String> {
                Self::named(text).ok_or_else(|| $crate::common::names::unknown(&[$($name),+]))
            }
        }
    };
}
#[doc(hidden)]
pub use named;

/// The message for a value that is none of `names`.
pub fn unknown(names: &[&str]) -> String {
    let (last, others) = names.split_last().expect("an enum has values");
    format!("must be {} or {last}", others.join(", "))
}
