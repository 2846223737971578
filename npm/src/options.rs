//! Options from JavaScript: an object whose keys are the command line's options in camel case.

use octagloss::recipes::{from_json, with_settings};
use octagloss::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

/// Fails with a message about parameters.
pub(crate) fn wrong<T>(message: impl Into<String>) -> Result<T> {
    Err(Error::Parameter(message.into()))
}

/// Parses a JSON object of options.
pub(crate) fn parsed<T: Default + Serialize + DeserializeOwned>(text: &str) -> Result<T> {
    let Ok(Value::Object(given)) = serde_json::from_str(text) else {
        return wrong("the options are not an object; write { target: \"three\" }");
    };
    let option = |(name, value): (String, Value)| {
        let value = match (&name[..], value) {
            // The brightest sun, or none.
            ("extractSun", Value::Bool(asked)) => json!(asked.then_some("brightest")),
            (_, value) => value,
        };
        (snake_case(&name), value)
    };
    from_json(given.into_iter().map(option).collect::<Map<String, Value>>())
}

/// Names the library's settings in `text` as here.
pub(crate) fn with_options(text: &str) -> String {
    with_settings(text, &|setting| format!("`{}`", camel_case(setting)))
}

fn snake_case(name: &str) -> String {
    let letter =
        |c: char| if c.is_ascii_uppercase() { format!("_{}", c.to_ascii_lowercase()) } else { c.into() };
    name.chars().map(letter).collect()
}

fn camel_case(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |text, word| {
        let (head, rest) = word.split_at(word.len().min(1));
        text + &head.to_ascii_uppercase() + rest
    })
}
