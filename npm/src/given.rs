//! Options from JavaScript: an object whose keys are the command line's options in camel case.

use octagloss::{Error, Result};
use serde_json::{Map, Value};
use std::ops::RangeInclusive;

/// Fails with a message about parameters.
pub(crate) fn wrong<T>(message: impl Into<String>) -> Result<T> {
    Err(Error::Parameter(message.into()))
}

/// Names of options in the library's messages, and here.
const NAMES: [(&str, &str); 5] = [
    ("`container`", "`format`"),
    ("`oem_size`", "`oemSize`"),
    ("`out_layout`", "`outLayout`"),
    ("`sh_order`", "`shOrder`"),
    ("`sh_window`", "`shWindow`"),
];

/// Replaces the library's names of options in `text`.
pub(crate) fn with_options(text: &str) -> String {
    NAMES.iter().fold(text.to_owned(), |text, (theirs, own)| text.replace(theirs, own))
}

/// Options that have not been read yet.
pub(crate) struct Given {
    left: Map<String, Value>,
    /// Names of all options, for the error about others.
    known: Vec<&'static str>,
}

impl Given {
    /// Parses a JSON object.
    pub(crate) fn parsed(json: &str) -> Result<Self> {
        match serde_json::from_str(json) {
            Ok(Value::Object(left)) => Ok(Self { left, known: Vec::new() }),
            _ => wrong("the options are not an object; write { target: \"three\" }"),
        }
    }

    /// The value of `name`, if it is given and not null.
    fn value(&mut self, name: &'static str) -> Option<Value> {
        self.known.push(name);
        self.left.remove(name).filter(|value| !value.is_null())
    }

    pub(crate) fn text(&mut self, name: &'static str) -> Result<Option<String>> {
        match self.value(name) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => wrong(format!("`{name}` is {other}; a text is needed")),
        }
    }

    /// A text parsed by `parse`, whose error is a remedy.
    pub(crate) fn parsed_text<T>(
        &mut self,
        name: &'static str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>> {
        let Some(text) = self.text(name)? else { return Ok(None) };
        match parse(&text) {
            Ok(value) => Ok(Some(value)),
            Err(remedy) => wrong(format!("`{name}` is {text:?}; {remedy}")),
        }
    }

    /// One of `choices`, by its name.
    pub(crate) fn choice<T: Copy>(
        &mut self,
        name: &'static str,
        choices: &[(&'static str, T)],
    ) -> Result<Option<T>> {
        self.parsed_text(name, |text| {
            choices.iter().find(|(own, _)| *own == text).map(|(_, value)| *value).ok_or_else(|| {
                let names: Vec<_> = choices.iter().map(|(own, _)| *own).collect();
                format!("choose one of {}", names.join(", "))
            })
        })
    }

    pub(crate) fn whole(&mut self, name: &'static str, range: RangeInclusive<u32>) -> Result<Option<u32>> {
        let Some(value) = self.value(name) else { return Ok(None) };
        // JavaScript writes 256 for 256.0.
        let number = value.as_u64().and_then(|number| u32::try_from(number).ok());
        match number.filter(|number| range.contains(number)) {
            Some(number) => Ok(Some(number)),
            None => {
                let (least, most) = range.into_inner();
                wrong(format!("`{name}` is {value}; a whole number from {least} to {most} is needed"))
            }
        }
    }

    pub(crate) fn number(&mut self, name: &'static str) -> Result<Option<f64>> {
        match self.value(name) {
            None => Ok(None),
            Some(value) => match value.as_f64().filter(|number| number.is_finite()) {
                Some(number) => Ok(Some(number)),
                None => wrong(format!("`{name}` is {value}; a finite number is needed")),
            },
        }
    }

    pub(crate) fn flag(&mut self, name: &'static str) -> Result<bool> {
        match self.value(name) {
            None => Ok(false),
            Some(Value::Bool(value)) => Ok(value),
            Some(other) => wrong(format!("`{name}` is {other}; true or false is needed")),
        }
    }

    /// A flag, whose `true` is `brightest`, a number or a text.
    pub(crate) fn switch_number_or_text(&mut self, name: &'static str) -> Result<Option<String>> {
        match self.left.get(name) {
            Some(Value::Bool(_)) => Ok(self.flag(name)?.then(|| "brightest".to_owned())),
            _ => self.number_or_text(name),
        }
    }

    /// A whole number or a text.
    pub(crate) fn number_or_text(&mut self, name: &'static str) -> Result<Option<String>> {
        match self.value(name) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(Value::Number(number)) => Ok(Some(number.to_string())),
            Some(other) => wrong(format!("`{name}` is {other}; a number or a text is needed")),
        }
    }

    /// A text with commas, or an array of texts.
    pub(crate) fn list(&mut self, name: &'static str) -> Result<Vec<String>> {
        match self.value(name) {
            None => Ok(Vec::new()),
            Some(Value::String(text)) => Ok(text.split(',').map(|part| part.trim().to_owned()).collect()),
            Some(Value::Array(parts)) => parts
                .into_iter()
                .map(|part| match part {
                    Value::String(text) => Ok(text),
                    other => wrong(format!("`{name}` contains {other}; texts are needed")),
                })
                .collect(),
            Some(other) => wrong(format!("`{name}` is {other}; a text or an array of texts is needed")),
        }
    }

    /// Fails for an option that has not been read.
    pub(crate) fn finish(self) -> Result<()> {
        let Some(name) = self.left.keys().next() else { return Ok(()) };
        wrong(format!("there is no option `{name}`; there are {}", self.known.join(", ")))
    }
}
