//! `octagloss info` of files that are neither environments nor bakes: maps that only `convert` reads,
//! pictures without light, and files of data.

use super::console;
use super::info::listed;
use crate::Rgb;
use crate::read::ReadOptions;
use octagloss_core::files::format::container::ENV_MAGIC;
use octagloss_core::files::io::regular::read_regular;
use octagloss_core::files::io::{
    DEFAULT_MEMORY_LIMIT, Format, LoadedMap, MapLight, levels_path, npy, read_map, read_plain,
};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;

/// `--json` output.
#[derive(Default, Serialize)]
pub(super) struct OtherInfo {
    /// `map`, `picture` or `data`.
    kind: &'static str,
    input: String,
    format: String,
    /// Size of the file.
    bytes: u64,
    /// Kind of content.
    content: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<u32>,
    /// Least and greatest value of each channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<[Rgb; 2]>,
}

/// Describes the file `path` of `bytes`, which is no environment because of `error`, if this program writes
/// such files.
pub(super) fn described(path: &Path, bytes: u64, error: &crate::Error) -> Option<OtherInfo> {
    // A target's folder is described by its file.
    let file = levels_path(path).ok().filter(|file| file.is_file())?;
    let path = &file;
    let content = read_regular(path, DEFAULT_MEMORY_LIMIT).ok()?;
    let other = OtherInfo { input: path.display().to_string(), bytes, ..OtherInfo::default() };
    if let Some((format, content)) = known_data(path, &content) {
        return Some(OtherInfo { kind: "data", format: format.to_owned(), content, ..other });
    }
    let Ok(picture) = read_plain(path, DEFAULT_MEMORY_LIMIT) else {
        let (format, content, [width, height]) = known_texture(&content)?;
        let (format, width, height) = (format.to_owned(), Some(width), Some(height));
        return Some(OtherInfo { kind: "picture", format, content, width, height, ..other });
    };
    let (kind, content) = match read_map(path, None, &ReadOptions::default()) {
        Ok(LoadedMap { light: MapLight::Components(grid, _), map, .. }) => {
            let (title, texels) = (map.map_or("a map", |map| map.title), grid.texel_count());
            ("map", format!("{title}, {texels} texels; convert makes an environment of it"))
        }
        Ok(_) => return None,
        Err(_) => ("picture", console::with_options(&format!("no environment: {error}"))),
    };
    let range = picture.texels.iter().fold(None, |range: Option<[Rgb; 2]>, texel| {
        let [mut least, mut most] = range.unwrap_or([*texel; 2]);
        for c in 0..3 {
            (least[c], most[c]) = (least[c].min(texel[c]), most[c].max(texel[c]));
        }
        Some([least, most])
    });
    // JSON has no NaN.
    let range = range.filter(|range| range.as_flattened().iter().all(|value| value.is_finite()));
    Some(OtherInfo {
        kind,
        format: picture.format,
        content,
        width: Some(picture.width),
        height: Some(picture.height),
        range,
        ..other
    })
}

/// Format, content and size of a picture or texture that holds no radiance.
fn known_texture(bytes: &[u8]) -> Option<(&'static str, String, [u32; 2])> {
    let at = |place: usize| Some(u32::from_be_bytes(bytes.get(place..place + 4)?.try_into().ok()?));
    if Format::sniff(bytes) == Some(Format::Png) {
        return Some(("PNG", "a picture".to_owned(), [at(16)?, at(20)?]));
    }
    let header = ktx2::Reader::new(bytes).ok()?.header();
    let pixels = header.format.map_or_else(|| "unnamed".to_owned(), |format| format!("{format:?}"));
    let content = match header.layer_count {
        0 | 1 => format!("a table or texture of pixels {pixels}"),
        layers => format!("an array of {layers} textures of pixels {pixels}, such as the maps of a pyramid"),
    };
    Some(("KTX2", content, [header.pixel_width, header.pixel_height]))
}

/// Format and content of a file of data.
fn known_data(path: &Path, bytes: &[u8]) -> Option<(&'static str, String)> {
    if bytes.starts_with(&ENV_MAGIC) {
        let end = bytes.iter().position(|byte| *byte == 0)?;
        let manifest: Value = serde_json::from_slice(bytes.get(8..end)?).ok()?;
        let levels = manifest["specular"]["mipmaps"].as_array()?.len() / 6;
        let width = &manifest["width"];
        return Some(("Babylon.js .env", format!("prefiltered cube, faces of {width}, {levels} levels")));
    }
    if bytes.starts_with(b"glTF") {
        let length = u32::from_le_bytes(bytes.get(12..16)?.try_into().ok()?) as usize;
        let root: Value = serde_json::from_slice(bytes.get(20..20 + length)?).ok()?;
        let light = &root["extensions"]["EXT_lights_image_based"]["lights"][0];
        let levels = light["specularImages"].as_array().map_or(0, Vec::len);
        let content = format!("{levels} levels of light by EXT_lights_image_based");
        return Some(("binary glTF", if levels > 0 { content } else { "a scene".to_owned() }));
    }
    if bytes.starts_with(&npy::MAGIC) {
        let table = npy::read_table(bytes, &[1, 2, 3, 4], usize::MAX >> 8).ok()?;
        let (rows, columns) = (table.values.len() / table.columns, table.columns);
        return Some(("NumPy array", format!("{rows} rows of {columns} numbers")));
    }
    let extension = path.extension()?.to_string_lossy().to_ascii_lowercase();
    let text = || std::str::from_utf8(bytes).ok().filter(|text| !text.contains('\0'));
    match extension.as_str() {
        "gltf" => {
            let root: Value = serde_json::from_slice(bytes).ok()?;
            let lights = root["extensions"]["KHR_lights_punctual"]["lights"].as_array().map_or(0, Vec::len);
            let content = format!("{lights} lights by KHR_lights_punctual");
            Some(("glTF", if lights > 0 { content } else { "a scene".to_owned() }))
        }
        "json" => {
            let value: Value = serde_json::from_slice(bytes).ok()?;
            if value.is_null() {
                return Some(("JSON", "no sun was found".to_owned()));
            }
            if let Some(list) = value.as_array() {
                return Some(("JSON", format!("a list of {}, such as extracted suns", list.len())));
            }
            let keys: Vec<&str> = value.as_object()?.keys().map(String::as_str).collect();
            let has = |names: &[&str]| names.iter().all(|name| keys.contains(name));
            let content = if has(&["generator", "levels"]) {
                let target =
                    value["target"]["name"].as_str().map_or(String::new(), |name| format!(" for {name}"));
                format!("report of a bake of {}{target}", value["input"].as_str().unwrap_or("an environment"))
            } else if has(&["suns", "harmonics", "uniform"]) {
                "the light of a pyramid without its maps".to_owned()
            } else if has(&["coefficients"]) {
                "spherical harmonics".to_owned()
            } else if has(&["direction", "irradiance"]) {
                "an extracted sun".to_owned()
            } else {
                format!("keys {}", keys.join(", "))
            };
            Some(("JSON", content))
        }
        "csv" | "txt" | "wgsl" | "glsl" | "hlsl" | "metal" | "svg" => {
            Some(("text", format!("{} lines", text()?.lines().count())))
        }
        _ => None,
    }
}

impl OtherInfo {
    pub(super) fn text(&self) -> String {
        let mut rows = vec![("content", console::escaped(&self.content))];
        let pixels = self.width.zip(self.height);
        rows.extend(pixels.map(|(width, height)| ("pixels", format!("{width}x{height}"))));
        rows.push(("size", console::bytes(self.bytes)));
        rows.extend(self.range.map(|[least, most]| {
            let [r, g, b] = [0, 1, 2].map(|c| format!("{:.4} to {:.4}", least[c], most[c]));
            ("range", format!("R {r}, G {g}, B {b}"))
        }));
        listed(&format!("{}: {}", self.input, self.format), rows)
    }
}
