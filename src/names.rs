//! Names of an enum's values: the same in options, in the viewer's panels and on the page.

/// Implements `NAMES`, [`std::fmt::Display`] and [`std::str::FromStr`] for an enum.
macro_rules! named {
    ($type:ident { $($value:ident = $name:literal),+ $(,)? }) => {
        impl $type {
            /// All values with their names.
            pub(crate) const NAMES: &[(Self, &str)] = &[$((Self::$value, $name)),+];
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(match self { $(Self::$value => $name),+ })
            }
        }

        /// Parses the output of [`std::fmt::Display`].
        impl std::str::FromStr for $type {
            type Err = String;

            fn from_str(text: &str) -> std::result::Result<Self, String> {
                $crate::names::value_named(Self::NAMES, text)
            }
        }
    };
}
pub(crate) use named;

/// The value called `text`.
///
/// # Errors
/// All names, if there is none.
pub(crate) fn value_named<T: Copy>(names: &[(T, &str)], text: &str) -> Result<T, String> {
    let found = names.iter().find(|(_, name)| *name == text);
    found.map(|(value, _)| *value).ok_or_else(|| {
        let names: Vec<&str> = names.iter().map(|(_, name)| *name).collect();
        let (last, others) = names.split_last().expect("an enum has values");
        format!("must be {} or {last}", others.join(", "))
    })
}
