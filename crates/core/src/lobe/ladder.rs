//! Roughness ladders: roughness as a function of the level's index.

mod look_up_error;

use crate::common::names::named;
use crate::light::environment::Map;
use crate::lobe::Lobe;

/// Roughness as a function of the level's index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Ladder {
    /// r = level/(levels - 1): glTF, Bevy, the Khronos sampler.
    #[default]
    Linear,
    /// r = 1 - sqrt(1 - level/(levels - 1)): Filament, three.js.
    Filament,
    /// r (1.7 - 0.7 r) = level/(levels - 1): Unity.
    Unity,
    /// alpha = 2^(level/0.8)/size, at most 1: Babylon.js.
    Babylon,
}

named!(Ladder { Linear = "linear", Filament = "filament", Unity = "unity", Babylon = "babylon" });

impl Ladder {
    /// Perceptual roughness of level `level` of `levels`, with `size` texels along an edge of level 0; levels
    /// beyond the last have the last one's, and 0 levels or texels count as 1.
    #[must_use]
    pub fn roughness(self, level: u32, levels: u32, size: u32) -> f64 {
        let last = levels.max(1) - 1;
        let step = if last == 0 { 0.0 } else { f64::from(level.min(last)) / f64::from(last) };
        match self {
            _ if step == 0.0 => 0.0,
            Self::Linear => step,
            Self::Filament => 1.0 - (1.0 - step).sqrt(),
            // Exact at the last level; the square root would round.
            Self::Unity if step == 1.0 => 1.0,
            Self::Unity => (1.7 - (2.89 - 2.8 * step).sqrt()) / 1.4,
            Self::Babylon => {
                ((f64::from(level.min(last)) / 0.8).exp2() / f64::from(size.max(1))).min(1.0).sqrt()
            }
        }
    }

    /// The level of detail that a renderer looks up for perceptual roughness `roughness` in a chain of
    /// `levels` below a level 0 of `size` texels: the inverse of [`Ladder::roughness`] between its levels. A
    /// roughness outside [0, 1] counts as the nearest in it.
    #[must_use]
    pub fn lod(self, roughness: f64, levels: u32, size: u32) -> f64 {
        let last = f64::from(levels.max(1) - 1);
        let r = roughness.clamp(0.0, 1.0);
        let lod = match self {
            Self::Linear => last * r,
            Self::Filament => last * r * (2.0 - r),
            Self::Unity => last * r * (1.7 - 0.7 * r),
            Self::Babylon => 0.8 * (r * r * f64::from(size)).log2(),
        };
        // Babylon's is negative for lobes within a texel.
        lod.max(0.0).min(last)
    }

    /// Default edge of level 0; for a panorama its height.
    ///
    /// For a linear GGX cube chain: the smallest size whose trilinear look-ups are at most 5 % off at the
    /// roughnesses listed in the README. A panorama needs twice that edge, an octahedral square three times.
    /// Other ladders use the engines' size of 256; other lobes were not measured.
    #[must_use]
    pub const fn default_size(self, map: Map, lobe: Lobe) -> u32 {
        match (self, lobe) {
            (Self::Linear, Lobe::Ggx) => edges_of_a_face(map) * DEFAULT_CUBE_SIZE,
            _ => ENGINE_SIZE,
        }
    }

    /// Default number of levels for a level 0 of `size`.
    ///
    /// The error of a trilinear look-up has two sources: the difference between the lobes of two levels, and
    /// bilinear interpolation within a small level. A small last level costs more than a long step between
    /// levels; `LAST_TEXELS` gives the fewest levels for each last size.
    #[must_use]
    pub fn default_levels(self, map: Map, size: u32) -> u32 {
        let most = map.most_levels(size).max(1);
        match self {
            Self::Linear => {
                let face = size / edges_of_a_face(map);
                let down_to = |texels: u32| (face / texels).checked_ilog2().map_or(0, |log2| log2 + 1);
                let found = LAST_TEXELS.iter().find(|(texels, fewest)| down_to(*texels) >= *fewest);
                found.map_or(most, |(texels, _)| down_to(*texels))
            }
            Self::Babylon => most,
            Self::Unity => most.min(UNITY_LEVELS),
            // Down to 16 texels: five levels for 256.
            Self::Filament => most.saturating_sub(4).max(1),
        }
    }
}

/// Edge of a map over that of a cube face at equal look-up accuracy.
const fn edges_of_a_face(map: Map) -> u32 {
    match map {
        Map::Cube => 1,
        Map::Panorama => 2,
        Map::Octahedral => 3,
    }
}

/// Edge of level 0 of the default cube.
pub(crate) const DEFAULT_CUBE_SIZE: u32 = 640;

/// Levels that Unity looks up, at any size: six steps (UNITY_SPECCUBE_LOD_STEPS).
pub(crate) const UNITY_LEVELS: u32 = 7;

/// Edge of level 0 for the engines' ladders.
const ENGINE_SIZE: u32 = 256;

/// Texels along an edge of the last level of the default linear ladder, with the fewest levels for it. The
/// first pair that the size allows applies. Worst relative RMS error of trilinear look-ups over eight
/// panoramas, roughness 0.6 to 1: 0.057 for a last level of four texels and 0.040 for five; by number of
/// levels 0.46 for four, 0.08 to 0.11 for six or seven, 0.057 for eight.
const LAST_TEXELS: [(u32, u32); 3] = [(5, 8), (4, 5), (2, 3)];
