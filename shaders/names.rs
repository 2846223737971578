//! Renames what a shader source declares, so that the source can stand in one shader several times.

use std::collections::BTreeSet;

/// Prefix of the functions and resources that other shaders use.
const OURS: &str = "octagloss_";

/// `source` with every identifier that it declares at module scope renamed: `octagloss_x` becomes `name_x`,
/// and any other `y` becomes `name_y`.
///
/// # Errors
/// What is wrong, in words, if `name` does not begin with an ASCII letter, or has characters other than
/// ASCII letters, digits and single underscores.
pub fn named(source: &str, name: &str) -> Result<String, String> {
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_word || name.contains("__") || name.ends_with('_') {
        return Err(format!(
            "`name` {name:?} is no prefix of identifiers in WGSL; use ASCII letters, digits and single \
             underscores between them, and begin with a letter"
        ));
    }
    Ok(renamed(source, |word| format!("{name}_{}", word.strip_prefix(OURS).unwrap_or(word))))
}

/// `source` with `prefix_` before every identifier that it declares at module scope without our own prefix.
pub(crate) fn prefixed(source: &str, prefix: &str) -> String {
    renamed(source, |word| match word.starts_with(OURS) || word.starts_with("Octagloss") {
        true => word.to_owned(),
        false => format!("{prefix}_{word}"),
    })
}

/// `source` with every identifier that it declares at module scope replaced by what `rename` makes of it.
fn renamed(source: &str, rename: impl Fn(&str) -> String) -> String {
    let declared: BTreeSet<&str> = source.lines().filter_map(declared).collect();
    let mut text = String::with_capacity(2 * source.len());
    let mut rest = source;
    while !rest.is_empty() {
        let (word, after) = rest.split_at(rest.find(|c| !is_part(c)).unwrap_or(rest.len()));
        if declared.contains(word) {
            text.push_str(&rename(word))
        } else {
            text.push_str(word)
        }
        let (between, next) = after.split_at(after.find(is_part).unwrap_or(after.len()));
        text.push_str(between);
        rest = next;
    }
    text
}

/// Whether an identifier or a number may contain `c`.
fn is_part(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The identifier that a line of a source declares at module scope, where lines begin without space.
fn declared(line: &str) -> Option<&str> {
    let mut rest = line;
    while let Some(attribute) = rest.strip_prefix('@') {
        rest = attribute.trim_start_matches(is_part);
        if let Some(arguments) = rest.strip_prefix('(') {
            rest = arguments.split_once(')')?.1;
        }
        rest = rest.trim_start();
    }
    let (keyword, after) = rest.split_at(rest.find(|c| !is_part(c))?);
    let named = match keyword {
        "fn" | "struct" | "const" | "override" | "alias" => after,
        "var" => after.strip_prefix('<').map_or(Some(after), |kind| Some(kind.split_once('>')?.1))?,
        _ => return None,
    };
    let named = named.trim_start();
    Some(&named[..named.find(|c| !is_part(c)).unwrap_or(named.len())])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_of_every_kind_are_renamed_wherever_they_are_used() {
        let source = "\
@group(1) @binding(0) var<storage, read> octagloss_words: array<Word>;
var octagloss_map: texture_2d<f32>;
const COUNT = 2u;
struct Word {
    value: f32,
}
fn octagloss_sum(word: Word) -> f32 {
    let count = f32(COUNT) + 1.0;
    return count * octagloss_words[0].value + word.value;
}
";
        let expected = "\
@group(1) @binding(0) var<storage, read> left_words: array<left_Word>;
var left_map: texture_2d<f32>;
const left_COUNT = 2u;
struct left_Word {
    value: f32,
}
fn left_sum(word: left_Word) -> f32 {
    let count = f32(left_COUNT) + 1.0;
    return count * left_words[0].value + word.value;
}
";
        assert_eq!(named(source, "left").expect("a name"), expected);
    }

    #[test]
    fn names_that_are_no_identifiers_are_refused() {
        for wrong in ["", "1st", "_a", "a__b", "a_", "a b", "a-b", "é"] {
            let error = named("", wrong).expect_err(wrong);
            assert!(error.contains(&format!("{wrong:?}")), "{error}");
        }
    }
}
