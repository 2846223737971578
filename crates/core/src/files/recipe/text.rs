//! Options as text in JSON, as on the command line. Texts of numbers are numbers.

use crate::analysis::extraction::Suns;
use crate::bake::Skybox;
use crate::common::names::unknown;
use crate::files::format::container::Container;
use crate::files::format::overflow::Overflow;
use crate::files::format::{OutputLayout, Pixel};
use crate::files::image::exposure::Exposure;
use crate::files::io::{InputLayout, Pad};
use crate::files::target::{Diffuse, Flip, PyramidMap, TARGETS, Target};
use crate::light::chain::ChainKind;
use crate::light::sat::Scan;
use crate::light::sh::window::{self, ShWindow};
use crate::lobe::Lobe;
use crate::lobe::filter::{self, Filter};
use crate::lobe::ladder::Ladder;
use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};
use serde_json::{Number, Value};

/// Writes `text`, a number as such.
fn write<S: Serializer>(text: &str, serializer: S) -> Result<S::Ok, S::Error> {
    match text.parse::<Number>() {
        Ok(number) => number.serialize(serializer),
        Err(_) => text.serialize(serializer),
    }
}

/// Reads a text, or a number as text.
fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::String(text) => Ok(text),
        Value::Number(number) => Ok(number.to_string()),
        _ => Err(D::Error::custom("a text is needed")),
    }
}

/// Implements `Serialize` and `Deserialize` by the text of `Display` and its parser.
macro_rules! as_text {
    ($($type:ty: $parse:expr;)+) => {$(
        impl Serialize for $type {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                write(&self.to_string(), serializer)
            }
        }

        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $parse(&read(deserializer)?).map_err(D::Error::custom)
            }
        }
    )+};
}

as_text! {
    ChainKind: str::parse;
    Container: str::parse;
    Diffuse: str::parse;
    Exposure: str::parse;
    Filter: filter::parsed;
    Flip: str::parse;
    InputLayout: str::parse;
    Ladder: str::parse;
    Lobe: str::parse;
    OutputLayout: str::parse;
    Overflow: str::parse;
    Pad: str::parse;
    Pixel: pixel;
    PyramidMap: str::parse;
    Scan: str::parse;
    ShWindow: window::parsed;
    Skybox: Skybox::parsed;
    Suns: Suns::parsed;
}

/// Parses the name of a pixel format that a recipe can choose.
fn pixel(text: &str) -> Result<Pixel, String> {
    let names = Pixel::CHOICES.map(Pixel::name);
    Pixel::CHOICES.into_iter().find(|pixel| pixel.name() == text).ok_or_else(|| unknown(&names))
}

/// Parses a target's name.
pub(super) fn target(text: &str) -> Result<&'static Target, String> {
    Target::named(text).ok_or_else(|| {
        let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
        format!("there are {}", names.join(", "))
    })
}

/// Parses a number of the command line.
#[cfg(feature = "cli")]
pub fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

/// Names of targets: a text with commas, or a list; null for none.
pub(super) mod targets {
    use super::{Deserialize, Deserializer, Error as _, Serialize, Serializer, Target, Value, target};

    pub(in crate::files::recipe) fn serialize<S: Serializer>(
        targets: &[&'static Target],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let names: Vec<&str> = targets.iter().map(|target| target.name).collect();
        Some(names.join(",")).filter(|names| !names.is_empty()).serialize(serializer)
    }

    pub(in crate::files::recipe) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<&'static Target>, D::Error> {
        let names: Vec<String> = match Value::deserialize(deserializer)? {
            Value::Null => Vec::new(),
            Value::String(text) => text.split(',').map(|name| name.trim().to_owned()).collect(),
            list => {
                Vec::deserialize(list).map_err(|_| D::Error::custom("a text or a list of texts is needed"))?
            }
        };
        names.iter().map(|name| target(name).map_err(D::Error::custom)).collect()
    }
}
