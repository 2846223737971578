//! Provenance: origin and orientation of the light in a file, in one set of keys for every container.
//!
//! # The world of a file
//!
//! A file's world is its content with its flip and quarter turns undone. The rotation, mirroring and sun
//! removal that a bake applied are part of this world. All readers of `io` return files in their world,
//! so `query`, `view`, `info` and another `bake` agree. Only `compare BAKE SOURCE` goes further: it applies
//! the bake's rotation, mirroring and sun removal to the source before it compares.
//!
//! # Storage
//!
//! A file of a bake has the bake's recipe under one key, as JSON, with what is of this file alone: its
//! content, its quarter turns, and the suns that its light lacks. KTX and KTX2 store it as a key/value pair,
//! OpenEXR as an attribute, Radiance .hdr as a header line. DDS stores its flip in reserved words of its
//! header; the rest is in the report of the bake, which lists the BLAKE3 hash of every file. A report that
//! lists another hash for a file is ignored. The file takes precedence over its report. Files of versions 0.1
//! and 0.2 have a key for each value.

use super::key_values::value_of;
use super::pad::Pad;
use crate::files::target::{Flip, flipped, flipped_texels};
use crate::light::chain::{Chain, ChainKind};
use crate::light::environment::{Layout, Rgb};
use crate::lobe::Lobe;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Number, Value, json};

/// Prefix of all keys.
pub(crate) const KEY_PREFIX: &str = "octagloss";
/// Key of the recipe.
pub(crate) const RECIPE_KEY: &str = "octaglossRecipe";
/// Key of the flip in versions 0.1 and 0.2, and of the mark in DDS files.
pub(super) const FLIP_KEY: &str = "octaglossFlip";

/// Keys of versions 0.1 and 0.2 with the fields that they hold.
const OLD_KEYS: [(&str, &str); 14] = [
    ("octaglossTarget", "target"),
    ("octaglossContent", "content"),
    (FLIP_KEY, "flip"),
    ("octaglossQuarterTurns", "quarter_turns"),
    ("octaglossRotateY", "rotate_y"),
    ("octaglossMirror", "mirror"),
    ("octaglossSun", "removed_suns"),
    ("octaglossScale", "scale"),
    ("octaglossCrop", "crop"),
    ("octaglossPad", "pad"),
    ("octaglossLobe", "lobe"),
    ("octaglossFilter", "filter"),
    ("octaglossLadder", "ladder"),
    ("octaglossChain", "chain"),
];

/// The content of an irradiance cube.
pub(crate) const IRRADIANCE: &str = "irradiance over pi";

/// A sun removed from the source before the bake.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TakenSun {
    /// Unit vector towards it, in the world.
    pub direction: [f64; 3],
    /// Irradiance on a surface that faces it.
    pub irradiance: [f64; 3],
    /// Steradians.
    pub solid_angle: f64,
}

/// What a file or its report records of its bake, for readers; `None` for values that it does not record. All
/// but the first four are options of the recipe.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Provenance {
    /// Content of the file, if it is not the levels of a bake.
    pub content: Option<String>,
    /// Right shift of a panorama's columns, in quarters of the width.
    pub quarter_turns: Option<u32>,
    /// The suns removed from the source, in order.
    #[serde(rename = "removed_suns", skip_serializing_if = "Vec::is_empty")]
    pub suns: Vec<TakenSun>,
    /// Name of the target.
    pub target: Option<String>,
    /// Axis along which the texels are flipped.
    pub flip: Option<Flip>,
    /// Rotation of the source about +Y in degrees.
    pub rotate_y: Option<f64>,
    /// Whether the source was mirrored.
    pub mirror: Option<bool>,
    /// Factor applied to the source's radiance; `None` for 1.
    pub scale: Option<f64>,
    /// Whether black bars of the source were removed; `None` if not.
    pub crop: Option<bool>,
    /// Padding of a source that is not 2:1.
    pub pad: Option<Pad>,
    /// The lobe of the levels; `None` for one of another version.
    #[serde(deserialize_with = "known")]
    pub lobe: Option<Lobe>,
    /// The filter, in command-line syntax.
    pub filter: Option<String>,
    /// The scan of the summed-area table, in command-line syntax. Only reports record it: the files of all
    /// scans are equal.
    pub scan: Option<String>,
    /// The ladder, in command-line syntax.
    pub ladder: Option<String>,
    /// Content of the levels' texels; `None` for one of another version.
    #[serde(deserialize_with = "known")]
    pub chain: Option<ChainKind>,
}

/// A value of this version, if it is one.
fn known<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    Ok(T::deserialize(Value::deserialize(deserializer)?).ok())
}

impl Provenance {
    /// Parses the key/value pairs of a file.
    ///
    /// # Errors
    /// A message that names the key with an invalid value.
    pub(super) fn of_pairs(pairs: &[(String, String)]) -> Result<Self, String> {
        let refused = |key: &str, text: &str| {
            let text: String = text.chars().take(40).collect();
            format!("{key} is {text:?}, which no bake wrote; bake it again")
        };
        if let Some(text) = value_of(pairs, RECIPE_KEY) {
            let recipe = serde_json::from_str(text.trim()).ok().filter(Self::is_sound);
            return recipe.ok_or_else(|| refused(RECIPE_KEY, text));
        }
        let mut fields = Map::new();
        for (key, field) in OLD_KEYS {
            let Some(text) = value_of(pairs, key) else { continue };
            fields.insert(field.to_owned(), old_value(field, text.trim()));
            if !serde_json::from_value(Value::Object(fields.clone())).is_ok_and(|own: Self| own.is_sound()) {
                return Err(refused(key, text));
            }
        }
        Ok(serde_json::from_value(Value::Object(fields)).expect("checked"))
    }

    fn is_sound(&self) -> bool {
        self.quarter_turns.is_none_or(|turns| turns < 4) && self.scale.is_none_or(|scale| scale > 0.0)
    }

    /// Fills missing values from `other`.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        let fields = |own: &Self| match json!(own) {
            Value::Object(fields) => fields.into_iter().filter(|(_, value)| !value.is_null()),
            _ => unreachable!("a struct is an object"),
        };
        let all: Map<String, Value> = fields(&other).chain(fields(&self)).collect();
        serde_json::from_value(Value::Object(all)).expect("fields of such values")
    }

    /// Whether a report can add to it.
    pub(super) fn is_partial(&self) -> bool {
        // Only the filter over a summed-area table has a scan.
        let has_scan = self.filter.as_deref() == Some("box");
        self.rotate_y.is_none() || (has_scan && self.scan.is_none())
    }

    /// Whether nothing is recorded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Converts `texels` from the file's orientation to the world.
    ///
    /// # Errors
    /// A message for quarter turns of anything but a panorama whose width is a multiple of 4.
    pub(super) fn world_texels(&self, layout: Layout, texels: Vec<Rgb>) -> Result<Vec<Rgb>, String> {
        let turns = self.quarter_turns.unwrap_or(0);
        let texels = match layout {
            _ if turns == 0 => texels,
            Layout::Panorama { width, .. } if width % 4 == 0 => {
                let shift = (turns * width / 4) as usize;
                rows(texels, width, |row| row.rotate_left(shift))
            }
            _ => {
                return Err(format!(
                    "{turns} quarter turns are recorded; a panorama of 4n columns is needed"
                ));
            }
        };
        let flip = self.flip.unwrap_or_default();
        Ok(match (flip, layout) {
            (Flip::None, _) => texels,
            (_, Layout::Cube { size }) => flipped_texels(&texels, size, flip),
            // Azimuths run from -Z over +X and +Z, so that -z reverses the columns.
            (Flip::Z, Layout::Panorama { width, .. }) => rows(texels, width, <[Rgb]>::reverse),
            (Flip::X, Layout::Panorama { width, .. }) => {
                let half = width as usize / 2;
                rows(texels, width, |row| {
                    row.reverse();
                    row.rotate_left(half);
                })
            }
            // Columns run along x, rows along z.
            (Flip::X, Layout::Octahedral { size }) => rows(texels, size, <[Rgb]>::reverse),
            (Flip::Z, Layout::Octahedral { size }) => {
                texels.chunks_exact(size as usize).rev().flatten().copied().collect()
            }
        })
    }

    /// Checks that nothing is flipped or moved, for maps that cannot be.
    ///
    /// # Errors
    /// A message that names the flip or the quarter turns.
    pub(super) fn check_unturned(&self) -> Result<(), String> {
        match (self.flip.unwrap_or_default(), self.quarter_turns.unwrap_or(0)) {
            (Flip::None, 0) => Ok(()),
            (Flip::None, _) => Err("quarter turns are for panoramas; bake it again".to_owned()),
            _ => Err("a flip is for cubes, panoramas and octahedral squares; bake it again".to_owned()),
        }
    }

    /// Converts the texels of `chain` to the world.
    ///
    /// # Errors
    /// As [`Provenance::world_texels`].
    pub(super) fn world_chain(&self, chain: Chain) -> Result<Chain, String> {
        if self.quarter_turns.unwrap_or(0) != 0 {
            return Err("quarter turns are for panoramas; bake it again".to_owned());
        }
        Ok(match self.flip.unwrap_or_default() {
            Flip::None => chain,
            _ if !chain.levels.iter().all(|level| matches!(level.layout, Layout::Cube { .. })) => {
                return Err("a flip is for cubes; bake it again".to_owned());
            }
            flip => Chain { levels: flipped(&chain.levels, flip).into_owned() },
        })
    }
}

fn rows(mut texels: Vec<Rgb>, width: u32, change: impl Fn(&mut [Rgb])) -> Vec<Rgb> {
    texels.chunks_exact_mut(width as usize).for_each(change);
    texels
}

/// The value of `field` as versions 0.1 and 0.2 wrote it, in JSON.
fn old_value(field: &str, text: &str) -> Value {
    match (field, text) {
        ("mirror" | "crop", "yes" | "no") => json!(text == "yes"),
        ("quarter_turns" | "rotate_y" | "scale", _) => {
            text.parse::<Number>().map_or_else(|_| json!(text), Value::Number)
        }
        ("removed_suns", _) => {
            // Separated by semicolons.
            let suns: Option<Vec<TakenSun>> = text.split(';').map(taken_sun).collect();
            suns.map_or_else(|| json!(text), |suns| json!(suns))
        }
        _ => json!(text),
    }
}

/// Parses `x y z, r g b, steradians`.
fn taken_sun(text: &str) -> Option<TakenSun> {
    let finite = |word: &str| word.parse().ok().filter(|value: &f64| value.is_finite());
    let numbers = |part: &str| -> Option<Vec<f64>> { part.split_whitespace().map(finite).collect() };
    let [direction, irradiance, solid_angle] =
        <[Vec<f64>; 3]>::try_from(text.split(',').map(numbers).collect::<Option<Vec<_>>>()?).ok()?;
    let [solid_angle] = solid_angle[..] else { return None };
    Some(TakenSun {
        direction: direction.try_into().ok()?,
        irradiance: irradiance.try_into().ok()?,
        solid_angle,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn full() -> Provenance {
        Provenance {
            target: Some("three".to_owned()),
            content: Some(IRRADIANCE.to_owned()),
            flip: Some(Flip::X),
            quarter_turns: Some(3),
            rotate_y: Some(-37.125),
            mirror: Some(true),
            suns: vec![
                TakenSun { direction: [0.6, 0.0, -0.8], irradiance: [1e-5, 2.5, 1e30], solid_angle: 6.8e-5 },
                TakenSun { direction: [0.0, 1.0, 0.0], irradiance: [0.5; 3], solid_angle: 1e-3 },
            ],
            scale: Some(0.1),
            crop: Some(true),
            pad: Some(Pad::Edge),
            lobe: Some(Lobe::Phong),
            filter: Some("adaptive:0.005".to_owned()),
            scan: None,
            ladder: Some("linear".to_owned()),
            chain: Some(ChainKind::Solved),
        }
    }

    #[test]
    fn what_files_record_is_read_back_whole() {
        let pairs = |value: Value| vec![(RECIPE_KEY.to_owned(), value.to_string())];
        assert_eq!(Provenance::of_pairs(&pairs(json!(full()))), Ok(full()));
        assert_eq!(Provenance::of_pairs(&[]), Ok(Provenance::default()));
        assert!(Provenance::default().is_empty());
        let flipped = Provenance { flip: Some(Flip::Z), ..Provenance::default() };
        assert_eq!(flipped.or(full()), Provenance { flip: Some(Flip::Z), ..full() });
        // Options of other versions, and lobes of them.
        let other = json!({"rotate_y": 5.0, "lobe": "lambert", "sparkle": [1]});
        let rotated = Provenance { rotate_y: Some(5.0), ..Provenance::default() };
        assert_eq!(Provenance::of_pairs(&pairs(other)), Ok(rotated));
    }

    #[test]
    fn what_version_0_2_recorded_is_read_back_whole() {
        let pairs = [
            ("octaglossTarget", "three"),
            ("octaglossContent", IRRADIANCE),
            ("octaglossFlip", "x"),
            ("octaglossQuarterTurns", "3"),
            ("octaglossRotateY", "-37.125"),
            ("octaglossMirror", "yes"),
            (
                "octaglossSun",
                "0.6 0 -0.8, 0.00001 2.5 1000000000000000000000000000000, 0.000068; \
                 0 1 0, 0.5 0.5 0.5, 0.001",
            ),
            ("octaglossScale", "0.1"),
            ("octaglossCrop", "yes"),
            ("octaglossPad", "edge"),
            ("octaglossLobe", "phong"),
            ("octaglossFilter", "adaptive:0.005"),
            ("octaglossLadder", "linear"),
            ("octaglossChain", "solved"),
        ];
        let pairs = pairs.map(|(key, text)| (key.to_owned(), text.to_owned()));
        assert_eq!(Provenance::of_pairs(&pairs), Ok(full()));
    }

    #[test]
    fn values_that_make_no_sense_are_named() {
        for (key, value) in [
            ("octaglossFlip", "y"),
            ("octaglossQuarterTurns", "4"),
            ("octaglossRotateY", "inf"),
            ("octaglossMirror", "true"),
            ("octaglossSun", "0 1, 1 1 1, 1"),
            ("octaglossSun", "0 1 0, 1 1 1, 1;"),
            ("octaglossScale", "0"),
            ("octaglossCrop", "1"),
            ("octaglossPad", "white"),
            (RECIPE_KEY, "{\"rotate_y\": 1e999}"),
            (RECIPE_KEY, "{\"quarter_turns\": 4}"),
            (RECIPE_KEY, "{}}"),
        ] {
            let error = Provenance::of_pairs(&[(key.to_owned(), value.to_owned())]).unwrap_err();
            assert!(error.starts_with(&format!("{key} is {value:?}, ")), "{error}");
        }
    }

    /// For every layout, flip and turn: the world's texel at a direction equals the file's texel at that
    /// direction, turned and flipped.
    #[test]
    fn texels_come_back_to_the_world() {
        let layouts = [
            Layout::Cube { size: 4 },
            Layout::Octahedral { size: 6 },
            Layout::Panorama { width: 16, height: 8 },
        ];
        for layout in layouts {
            let images = if matches!(layout, Layout::Cube { .. }) { 6 } else { 1 };
            let (width, height) = layout.sides();
            let places =
                (0..images).flat_map(|k| (0..height).flat_map(move |j| (0..width).map(move |i| (k, i, j))));
            let directions: Vec<DVec3> =
                places.map(|(k, i, j)| layout.direction_from_texel(k, i, j)).collect();
            let turns = if matches!(layout, Layout::Panorama { .. }) { 0..4 } else { 0..1 };
            for (flip, turns) in [Flip::None, Flip::X, Flip::Z]
                .into_iter()
                .flat_map(|flip| turns.clone().map(move |t| (flip, t)))
            {
                // The writer flips, then shifts columns to the right, which increases the azimuth.
                let file_from_world = |world: DVec3| {
                    let flipped = flip.apply(world);
                    let (sin, cos) = (f64::from(turns) * std::f64::consts::FRAC_PI_2).sin_cos();
                    DVec3::new(
                        cos * flipped.x - sin * flipped.z,
                        flipped.y,
                        sin * flipped.x + cos * flipped.z,
                    )
                };
                // A texel of the file holds its own direction.
                let texels = directions.iter().map(|direction| direction.as_vec3().to_array()).collect();
                let provenance =
                    Provenance { flip: Some(flip), quarter_turns: Some(turns), ..Provenance::default() };
                let world = provenance.world_texels(layout, texels).unwrap();
                for (direction, texel) in directions.iter().zip(world) {
                    let expected = file_from_world(*direction).as_vec3();
                    let off = (glam::Vec3::from_array(texel) - expected).length();
                    assert!(off < 1e-5, "{layout:?} {flip:?} {turns}: {texel:?} for {expected}");
                }
            }
        }
    }
}
