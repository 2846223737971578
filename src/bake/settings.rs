//! What to bake.

use super::solve::{self, Node};
use crate::chain::{ChainKind, LevelSpec};
use crate::environment::Map;
use crate::error::{Error, Result};
use crate::filter::Filter;
use crate::ladder::{DEFAULT_CUBE_SIZE, Ladder};
use crate::lobe::Lobe;
use crate::sh::window::ShWindow;

/// What to bake. `Default` is what `octagloss bake INPUT` does.
#[derive(Clone, Debug)]
pub struct BakeSettings {
    /// What the levels' texels cover.
    pub map: Map,
    /// Texels along an edge of level 0; of a panorama its height.
    pub size: u32,
    /// Number of levels; `None` for [`Ladder::default_levels`].
    pub levels: Option<u32>,
    /// Roughness of each level.
    pub ladder: Ladder,
    /// The lobe.
    pub lobe: Lobe,
    /// The filter.
    pub filter: Filter,
    /// Texels along an edge of the OEM without its border; `None` for the source's own.
    pub oem_size: Option<u32>,
    /// Border of the OEM in texels; `None` for the filter's own.
    pub border: Option<u32>,
    /// Keep every texel's error bound in the levels.
    pub bounds: bool,
    /// Edge of an irradiance cube (cosine lobe, divided by pi) to bake as well.
    pub irradiance: Option<u32>,
    /// The highest band of the spherical harmonics, at most [`crate::sh::MAX_ORDER`].
    pub sh_order: u32,
    /// What their bands are multiplied by.
    pub sh_window: ShWindow,
    /// What the texels of the levels are. Irradiance and sheen are always sampled.
    pub chain: ChainKind,
    /// Bake the sizes and roughnesses of the chain with the Charlie lobe (sheen) as well.
    pub sheen: bool,
}

impl Default for BakeSettings {
    fn default() -> Self {
        Self {
            map: Map::Cube,
            size: DEFAULT_CUBE_SIZE,
            levels: None,
            ladder: Ladder::Linear,
            lobe: Lobe::Ggx,
            filter: Filter::Adaptive(0.005),
            oem_size: None,
            border: None,
            bounds: false,
            irradiance: None,
            sh_order: 2,
            sh_window: ShWindow::None,
            chain: ChainKind::Sampled,
            sheen: false,
        }
    }
}

impl BakeSettings {
    /// Size and roughness of every level.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no size, no levels, more levels than reach a size of 1, or a filter that the
    /// lobe does not have.
    pub fn level_specs(&self) -> Result<Vec<LevelSpec>> {
        if self.size == 0 {
            return Err(Error::Parameter("`size` must be at least 1".to_owned()));
        }
        self.filter.check(self.lobe, self.oem_size)?;
        if self.chain == ChainKind::Solved {
            if self.map != Map::Cube || self.lobe != Lobe::Ggx {
                return Err(Error::Parameter("`chain` solved is for cubes of the lobe ggx".to_owned()));
            }
            if self.bounds {
                return Err(Error::Parameter(
                    "`bounds` are those of sampled texels; `chain` solved has none".to_owned(),
                ));
            }
        }
        if self.sheen {
            self.filter.beside().check(Lobe::Charlie, None)?;
        }
        let most = self.map.most_levels(self.size);
        let own = match self.lobe {
            // Irradiance knows no roughness.
            Lobe::Cosine => 1,
            _ => self.ladder.default_levels(self.map, self.size),
        };
        let levels = self.levels.unwrap_or(own);
        if levels == 0 {
            return Err(Error::Parameter("`levels` must be at least 1".to_owned()));
        }
        if levels > most {
            return Err(Error::Parameter(format!(
                "`levels` {levels} is more than reach a size of 1 from `size` {}; at most {most}",
                self.size
            )));
        }
        let roughness = |level| self.ladder.roughness(level, levels, self.size);
        Ok((0..levels)
            .map(|level| LevelSpec { layout: self.map.layout(self.size, level), roughness: roughness(level) })
            .collect())
    }

    /// The lobes between the levels that a solved chain is made of; none for a sampled one.
    pub(crate) fn nodes(&self, levels: usize) -> Vec<Node> {
        match self.chain {
            ChainKind::Sampled => Vec::new(),
            ChainKind::Solved => solve::nodes(self.size, levels as u32, self.ladder),
        }
    }
}
