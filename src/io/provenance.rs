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
//! KTX and KTX2 store these keys as key/value pairs, OpenEXR as attributes, Radiance .hdr as header lines.
//! DDS stores its flip in reserved words of its header; the rest is in the report of the bake, which lists
//! the BLAKE3 hash of every file. A report that lists another hash for a file is ignored. The file takes
//! precedence over its report.

use super::pad::Pad;
use crate::analysis::sun::Sun;
use crate::chain::{Chain, ChainKind, Level};
use crate::environment::{Layout, Rgb};
use crate::lobe::{LOBE_KEY, Lobe};
use crate::target::Flip;

/// Prefix of all keys.
pub(crate) const KEY_PREFIX: &str = "octagloss";
/// Key of the target's name.
pub(crate) const TARGET_KEY: &str = "octaglossTarget";
/// Key of the axis along which the texels are flipped: `none`, `x` or `z`.
pub(crate) const FLIP_KEY: &str = "octaglossFlip";
/// Key of the right shift of a panorama's columns, in quarters of the width.
pub(crate) const QUARTER_TURNS_KEY: &str = "octaglossQuarterTurns";
/// Key of the source's rotation about +Y in degrees.
pub(crate) const ROTATE_KEY: &str = "octaglossRotateY";
/// Key of whether the source was mirrored: `yes` or `no`.
pub(crate) const MIRROR_KEY: &str = "octaglossMirror";
/// Key of the suns removed from the source.
pub(crate) const SUN_KEY: &str = "octaglossSun";
/// Key of the factor applied to the source's radiance; absent for 1.
pub(crate) const SCALE_KEY: &str = "octaglossScale";
/// Key that marks removed black bars of the source: `yes`, or absent.
pub(crate) const CROP_KEY: &str = "octaglossCrop";
/// Key of the fill of a source that is not 2:1: `black` or `edge`, or absent.
pub(crate) const PAD_KEY: &str = "octaglossPad";
/// Key of the filter.
pub(crate) const FILTER_KEY: &str = "octaglossFilter";
/// Key of the ladder.
pub(crate) const LADDER_KEY: &str = "octaglossLadder";
/// Key of the content of the levels' texels: `sampled` or `solved`.
pub(crate) const CHAIN_KEY: &str = "octaglossChain";
/// Key of the content, if it is not the levels of a bake.
pub(crate) const CONTENT_KEY: &str = "octaglossContent";

/// The value of [`CONTENT_KEY`] for an irradiance cube.
pub(crate) const IRRADIANCE: &str = "irradiance over pi";

/// A sun removed from the source before the bake.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TakenSun {
    /// Unit vector towards it, in the world.
    pub direction: [f64; 3],
    /// Irradiance on a surface that faces it.
    pub irradiance: [f64; 3],
    /// Steradians.
    pub solid_angle: f64,
}

impl From<&Sun> for TakenSun {
    fn from(sun: &Sun) -> Self {
        Self { direction: sun.direction.to_array(), irradiance: sun.irradiance, solid_angle: sun.solid_angle }
    }
}

/// Origin and orientation recorded in a file; `None` for values that it does not record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Name of the target.
    pub target: Option<String>,
    /// Content of the file, if it is not the levels of a bake.
    pub content: Option<String>,
    /// Axis along which the texels are flipped.
    pub flip: Option<Flip>,
    /// Right shift of a panorama's columns, in quarters of the width.
    pub quarter_turns: Option<u32>,
    /// Rotation of the source about +Y in degrees.
    pub rotate_y: Option<f64>,
    /// Whether the source was mirrored.
    pub mirror: Option<bool>,
    /// The suns removed from the source, in order.
    pub suns: Vec<TakenSun>,
    /// Factor applied to the source's radiance; `None` for 1.
    pub scale: Option<f64>,
    /// Whether black bars of the source were removed; `None` if not.
    pub crop: Option<bool>,
    /// Padding of a source that is not 2:1.
    pub pad: Option<Pad>,
    /// The lobe of the levels.
    pub lobe: Option<Lobe>,
    /// The filter, in command-line syntax.
    pub filter: Option<String>,
    /// The scan of the summed-area table, in command-line syntax. Only reports record it: the files of all
    /// scans are equal.
    pub scan: Option<String>,
    /// The ladder, in command-line syntax.
    pub ladder: Option<String>,
    /// Content of the levels' texels.
    pub chain: Option<ChainKind>,
}

impl Provenance {
    /// The key/value pairs that every container writes, in a fixed order.
    #[must_use]
    pub fn pairs(&self) -> Vec<(String, String)> {
        let sun = |sun: &TakenSun| {
            let words = |values: [f64; 3]| values.map(|value| value.to_string()).join(" ");
            format!("{}, {}, {}", words(sun.direction), words(sun.irradiance), sun.solid_angle)
        };
        let suns: Vec<String> = self.suns.iter().map(sun).collect();
        let suns = (!suns.is_empty()).then(|| suns.join("; "));
        let pairs = [
            (TARGET_KEY, self.target.clone()),
            (CONTENT_KEY, self.content.clone()),
            (FLIP_KEY, self.flip.map(|flip| flip.name().to_owned())),
            (QUARTER_TURNS_KEY, self.quarter_turns.map(|turns| turns.to_string())),
            (ROTATE_KEY, self.rotate_y.map(|degrees| degrees.to_string())),
            (MIRROR_KEY, self.mirror.map(|mirror| if mirror { "yes" } else { "no" }.to_owned())),
            (SUN_KEY, suns),
            (SCALE_KEY, self.scale.map(|scale| scale.to_string())),
            (CROP_KEY, self.crop.map(|crop| if crop { "yes" } else { "no" }.to_owned())),
            (PAD_KEY, self.pad.map(|pad| pad.name().to_owned())),
            (LOBE_KEY, self.lobe.map(|lobe| lobe.name().to_owned())),
            (FILTER_KEY, self.filter.clone()),
            (LADDER_KEY, self.ladder.clone()),
            (CHAIN_KEY, self.chain.map(|chain| chain.name().to_owned())),
        ];
        pairs.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?))).collect()
    }

    /// Parses the pairs; `text` returns the value of a key.
    ///
    /// # Errors
    /// A message that names the key with an invalid value.
    pub(super) fn of_texts(text: &dyn Fn(&str) -> Option<String>) -> Result<Self, String> {
        fn parsed<T>(
            key: &str,
            text: Option<String>,
            needed: &str,
            parse: impl Fn(&str) -> Option<T>,
        ) -> Result<Option<T>, String> {
            let Some(text) = text else { return Ok(None) };
            parse(text.trim()).map(Some).ok_or_else(|| {
                let text: String = text.chars().take(40).collect();
                format!("{key} is {text:?}; {needed} is needed, bake it again")
            })
        }
        let of = |key: &str| text(key);
        Ok(Self {
            target: of(TARGET_KEY),
            content: of(CONTENT_KEY),
            flip: parsed(FLIP_KEY, of(FLIP_KEY), "none, x or z", Flip::named)?,
            quarter_turns: parsed(QUARTER_TURNS_KEY, of(QUARTER_TURNS_KEY), "0, 1, 2 or 3", |word| {
                word.parse().ok().filter(|turns| *turns < 4)
            })?,
            rotate_y: parsed(ROTATE_KEY, of(ROTATE_KEY), "a number of degrees", finite)?,
            mirror: parsed(MIRROR_KEY, of(MIRROR_KEY), "yes or no", yes_or_no)?,
            suns: parsed(SUN_KEY, of(SUN_KEY), "a direction, an irradiance and a solid angle", taken_suns)?
                .unwrap_or_default(),
            scale: parsed(SCALE_KEY, of(SCALE_KEY), "a number above 0", |word| {
                finite(word).filter(|scale| *scale > 0.0)
            })?,
            crop: parsed(CROP_KEY, of(CROP_KEY), "yes or no", yes_or_no)?,
            pad: parsed(PAD_KEY, of(PAD_KEY), "black or edge", Pad::named)?,
            // Other versions may write other lobes.
            lobe: of(LOBE_KEY).and_then(|name| Lobe::named(name.trim())),
            filter: of(FILTER_KEY),
            scan: None,
            ladder: of(LADDER_KEY),
            chain: of(CHAIN_KEY).and_then(|name| ChainKind::named(name.trim())),
        })
    }

    /// Fills missing values from `other`.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            target: self.target.or(other.target),
            content: self.content.or(other.content),
            flip: self.flip.or(other.flip),
            quarter_turns: self.quarter_turns.or(other.quarter_turns),
            rotate_y: self.rotate_y.or(other.rotate_y),
            mirror: self.mirror.or(other.mirror),
            suns: if self.suns.is_empty() { other.suns } else { self.suns },
            scale: self.scale.or(other.scale),
            crop: self.crop.or(other.crop),
            pad: self.pad.or(other.pad),
            lobe: self.lobe.or(other.lobe),
            filter: self.filter.or(other.filter),
            scan: self.scan.or(other.scan),
            ladder: self.ladder.or(other.ladder),
            chain: self.chain.or(other.chain),
        }
    }

    /// Whether a report can add to it.
    pub(super) fn is_partial(&self) -> bool {
        // Only filters over a summed-area table have a scan.
        let has_scan =
            self.filter.as_ref().is_some_and(|filter| filter == "box" || filter.starts_with("fitted:"));
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
            _ => return Err(format!("{QUARTER_TURNS_KEY} is {turns}; a panorama of 4n columns is needed")),
        };
        let flip = self.flip.unwrap_or_default();
        Ok(match (flip, layout) {
            (Flip::None, _) => texels,
            (_, Layout::Cube { size }) => flip.level(&Level::cube(size, 0.0, texels)).texels,
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
            (Flip::None, _) => Err(format!("{QUARTER_TURNS_KEY} is for panoramas; bake it again")),
            _ => Err(format!("{FLIP_KEY} is for cubes, panoramas and octahedral squares; bake it again")),
        }
    }

    /// Converts the texels of `chain` to the world.
    ///
    /// # Errors
    /// As [`Provenance::world_texels`].
    pub(super) fn world_chain(&self, chain: Chain) -> Result<Chain, String> {
        if self.quarter_turns.unwrap_or(0) != 0 {
            return Err(format!("{QUARTER_TURNS_KEY} is for panoramas; bake it again"));
        }
        Ok(match self.flip.unwrap_or_default() {
            Flip::None => chain,
            _ if !chain.levels.iter().all(|level| matches!(level.layout, Layout::Cube { .. })) => {
                return Err(format!("{FLIP_KEY} is for cubes; bake it again"));
            }
            flip => flip.chain(&chain),
        })
    }
}

/// Converts the pairs of a bake's levels to those of its irradiance: cosine lobe, no ladder, no chain kind.
#[must_use]
pub(crate) fn irradiance_pairs(pairs: &[(String, String)]) -> Vec<(String, String)> {
    let own = [(CONTENT_KEY, IRRADIANCE), (LOBE_KEY, Lobe::Cosine.name())];
    let others = |key: &str| ![CONTENT_KEY, LOBE_KEY, LADDER_KEY, CHAIN_KEY].contains(&key);
    let own = own.map(|(key, value)| (key.to_owned(), value.to_owned()));
    own.into_iter().chain(pairs.iter().filter(|(key, _)| others(key)).cloned()).collect()
}

fn rows(mut texels: Vec<Rgb>, width: u32, change: impl Fn(&mut [Rgb])) -> Vec<Rgb> {
    texels.chunks_exact_mut(width as usize).for_each(change);
    texels
}

fn finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| value.is_finite())
}

fn yes_or_no(word: &str) -> Option<bool> {
    match word {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    }
}

/// Parses suns separated by semicolons.
fn taken_suns(text: &str) -> Option<Vec<TakenSun>> {
    text.split(';').map(taken_sun).collect()
}

/// Parses `x y z, r g b, steradians`.
fn taken_sun(text: &str) -> Option<TakenSun> {
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
    use crate::io::key_values::value_of;
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

    fn read(pairs: &[(String, String)]) -> Result<Provenance, String> {
        Provenance::of_texts(&|key| value_of(pairs, key))
    }

    #[test]
    fn pairs_are_read_back_whole() {
        assert_eq!(read(&full().pairs()), Ok(full()));
        assert_eq!(read(&[]), Ok(Provenance::default()));
        assert!(Provenance::default().is_empty() && Provenance::default().pairs().is_empty());
        let flipped = Provenance { flip: Some(Flip::Z), ..Provenance::default() };
        assert_eq!(flipped.or(full()), Provenance { flip: Some(Flip::Z), ..full() });
    }

    #[test]
    fn values_that_make_no_sense_are_named() {
        for (key, value) in [
            (FLIP_KEY, "y"),
            (QUARTER_TURNS_KEY, "4"),
            (ROTATE_KEY, "inf"),
            (MIRROR_KEY, "true"),
            (SUN_KEY, "0 1, 1 1 1, 1"),
            (SUN_KEY, "0 1 0, 1 1 1, 1;"),
            (SCALE_KEY, "0"),
            (CROP_KEY, "1"),
            (PAD_KEY, "white"),
        ] {
            let error = read(&[(key.to_owned(), value.to_owned())]).unwrap_err();
            assert!(error.starts_with(&format!("{key} is {value:?}; ")), "{error}");
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
