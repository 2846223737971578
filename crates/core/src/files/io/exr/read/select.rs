//! Selects the layer of an OpenEXR file to read.

use crate::common::error::{Result, quoted};
use crate::files::io::picture::Source;
use ::exr::meta::header::Header;

/// Channels to read, by index in the header's list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channels {
    /// R, G, B.
    Rgb([usize; 3]),
    /// Y only.
    Luminance([usize; 1]),
    /// Y, RY, BY.
    LuminanceChroma([usize; 3]),
}

impl Channels {
    pub(super) fn indices(&self) -> &[usize] {
        match self {
            Self::Rgb(indices) | Self::LuminanceChroma(indices) => indices,
            Self::Luminance(indices) => indices,
        }
    }
}

/// The selected layer.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    /// Index of its header, that is of its part.
    pub(super) header: usize,
    pub(super) channels: Channels,
    /// Its name; empty for the unnamed layer.
    name: String,
    /// Names of the other layers; none before the choice.
    others: Vec<String>,
}

impl Selection {
    /// Warning about the selection.
    pub(super) fn warning(&self) -> Option<String> {
        let layer = |name: &str| match name {
            "" => "the unnamed layer".to_owned(),
            plain if plain.len() <= 60 && !plain.contains(char::is_control) => format!("layer {plain}"),
            other => format!("layer {}", quoted(other)),
        };
        let chosen = layer(&self.name);
        if self.others.is_empty() {
            (!self.name.is_empty()).then(|| format!("read {chosen}; there is no unnamed one"))
        } else {
            let others: Vec<String> = self.others.iter().map(|name| layer(name)).collect();
            Some(format!("read {chosen}; ignored: {}", others.join(", ")))
        }
    }
}

/// Suffixes of layer names that renderers use for the final image, in order of preference.
const WHOLE_PICTURE: [&str; 5] = ["", "combined", "beauty", "rgba", "color"];

/// Selects the layer most likely to be the environment: the unnamed one, else one named as the final image,
/// else the first; colour before luminance.
pub(super) fn select(source: &Source<'_>, headers: &[Header]) -> Result<Selection> {
    let mut candidates: Vec<Selection> =
        headers.iter().enumerate().flat_map(|(index, header)| candidates_of(index, header)).collect();
    let rank = |candidate: &Selection| {
        let last_word = candidate.name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        let named = WHOLE_PICTURE.iter().position(|name| *name == last_word).unwrap_or(WHOLE_PICTURE.len());
        (matches!(candidate.channels, Channels::Luminance(_)), named)
    };
    candidates.sort_by_key(rank);
    if candidates.is_empty() {
        let names: Vec<String> = headers
            .iter()
            .flat_map(|header| &header.channels.list)
            .take(12)
            .map(|c| c.name.to_string())
            .collect();
        return Err(source.error(format!(
            "no channels R, G, B and no Y among {}; rename or convert them",
            names.join(", ")
        )));
    }
    let chosen = candidates.remove(0);
    Ok(Selection { others: candidates.into_iter().map(|candidate| candidate.name).collect(), ..chosen })
}

/// The colour channels of one part.
pub(super) fn of_part(index: usize, header: &Header) -> Option<Selection> {
    candidates_of(index, header).into_iter().find(|layer| matches!(layer.channels, Channels::Rgb(_)))
}

/// The layers of one header: channels with the same name up to the last dot.
fn candidates_of(index: usize, header: &Header) -> Vec<Selection> {
    let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let split = |name: &str| -> (String, String) {
        let (prefix, channel) = name.rsplit_once('.').unwrap_or(("", name));
        (prefix.to_owned(), channel.to_ascii_uppercase())
    };
    let mut prefixes: Vec<String> = names.iter().map(|name| split(name).0).collect();
    prefixes.dedup();
    let part = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
    let candidate = |prefix: &String| {
        let find = |channels: &[&str]| {
            names.iter().position(|name| {
                let (own_prefix, channel) = split(name);
                own_prefix == *prefix && channels.contains(&channel.as_str())
            })
        };
        let triple = |a: &[&str], b: &[&str], c: &[&str]| Some([find(a)?, find(b)?, find(c)?]);
        let rgb = triple(&["R", "RED"], &["G", "GREEN"], &["B", "BLUE"]).map(Channels::Rgb);
        let chroma = || triple(&["Y"], &["RY"], &["BY"]).map(Channels::LuminanceChroma);
        // Y with X or Z is a coordinate.
        let luminance =
            || find(&["Y"]).filter(|_| find(&["X", "Z"]).is_none()).map(|index| Channels::Luminance([index]));
        let channels = rgb.or_else(chroma).or_else(luminance)?;
        let words: Vec<&str> =
            [part.as_str(), prefix.as_str()].into_iter().filter(|word| !word.is_empty()).collect();
        Some(Selection { header: index, channels, name: words.join("."), others: Vec::new() })
    };
    prefixes.iter().filter_map(candidate).collect()
}
