//! Settings of a bake.

use super::solve::{self, Node};
use crate::common::error::{Result, wrong};
use crate::light::chain::{ChainKind, LevelSpec};
use crate::light::environment::{Layout, Map};
use crate::light::sat::Scan;
use crate::light::sh::window::ShWindow;
use crate::lobe::Lobe;
use crate::lobe::filter::Filter;
use crate::lobe::ladder::{DEFAULT_CUBE_SIZE, Ladder};

/// Size of a skybox.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skybox {
    /// Edge of its faces.
    Edge(u32),
    /// Same texel size as the source.
    Source,
}

/// As [`Skybox::parsed`] reads it.
impl std::fmt::Display for Skybox {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Edge(edge) => edge.fmt(f),
            Self::Source => f.write_str("source"),
        }
    }
}

/// Greatest edge of any level: bytes of larger ones are beyond 64 bits.
const MAX_EDGE: u32 = 65_536;

/// Maximum edge of a skybox.
const MAX_SKYBOX: u32 = 16_384;

impl Skybox {
    /// Parses an edge, or `source`.
    ///
    /// # Errors
    /// A remedy.
    pub fn parsed(text: &str) -> Result<Self, String> {
        match text {
            "source" => Ok(Self::Source),
            _ => match text.parse() {
                Ok(edge) if (1..=MAX_SKYBOX).contains(&edge) => Ok(Self::Edge(edge)),
                _ => Err(format!("must be 1 to {MAX_SKYBOX}, or source")),
            },
        }
    }

    /// The edge of the cube for a source of `layout`.
    #[must_use]
    pub fn edge(self, layout: Layout) -> u32 {
        match self {
            Self::Edge(edge) => edge,
            Self::Source => layout.face_edge().clamp(1, MAX_SKYBOX),
        }
    }
}

/// Settings of a bake. `Default` corresponds to `octagloss bake INPUT`.
#[derive(Clone, Debug)]
pub struct BakeSettings {
    /// Map of the levels' texels.
    pub map: Map,
    /// Texels along an edge of level 0; for a panorama its height.
    pub size: u32,
    /// Number of levels; `None` for [`Ladder::default_levels`].
    pub levels: Option<u32>,
    /// Roughness of each level.
    pub ladder: Ladder,
    /// The lobe.
    pub lobe: Lobe,
    /// The filter.
    pub filter: Filter,
    /// Texels along an edge of the OEM without its border; `None` to derive it from the source.
    pub oem_size: Option<u32>,
    /// Border of the OEM in texels; `None` for the filter's default.
    pub border: Option<u32>,
    /// How the summed-area table is scanned, for filters that read one; every choice gives the same bits.
    pub scan: Scan,
    /// Store every texel's error bound in the levels.
    pub bounds: bool,
    /// Edge of an additional irradiance cube (cosine lobe, divided by pi).
    pub irradiance: Option<u32>,
    /// Edge of a cube of the unfiltered environment to bake as well; where the levels are panoramas, it is a
    /// panorama of four times as many columns.
    pub skybox: Option<u32>,
    /// The highest band of the spherical harmonics, at most [`crate::light::sh::MAX_ORDER`].
    pub sh_order: u32,
    /// Window applied to their bands.
    pub sh_window: ShWindow,
    /// Content of the levels' texels; `None` for [`BakeSettings::default_chain`]. Irradiance and sheen are
    /// always sampled.
    pub chain: Option<ChainKind>,
    /// Also bake the chain's sizes and roughnesses with the Charlie lobe (sheen).
    pub sheen: bool,
    /// Also build the pyramid over a map of `size` texels along an edge.
    pub pyramid: bool,
    /// Measure [`crate::bake::Bake::typical_error`], which takes a few per cent of the bake's time.
    pub measure: bool,
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
            scan: Scan::default(),
            bounds: false,
            irradiance: None,
            skybox: None,
            sh_order: 2,
            sh_window: ShWindow::None,
            chain: None,
            sheen: false,
            pyramid: false,
            measure: false,
        }
    }
}

impl BakeSettings {
    /// Size and roughness of every level.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a size of 0 or above 65,536, no levels, more levels
    /// than down to a size of 1, or a filter that does not support the lobe or the scan.
    pub fn level_specs(&self) -> Result<Vec<LevelSpec>> {
        if self.size == 0 {
            return wrong("`size` must be at least 1");
        }
        let edges = [("size", Some(self.size)), ("irradiance", self.irradiance), ("skybox", self.skybox)];
        for (name, edge) in edges {
            if let Some(edge) = edge.filter(|edge| *edge > MAX_EDGE) {
                return wrong(format!("`{name}` {edge} is above {MAX_EDGE}"));
            }
        }
        self.filter.check(self.lobe, self.oem_size)?;
        self.filter.check_scan(self.scan)?;
        if let Some(kind) = self.chain.filter(|kind| *kind != ChainKind::Sampled) {
            let name = kind.name();
            if self.map != Map::Cube || self.lobe != Lobe::Ggx {
                return wrong(format!("`chain` {name} is for cubes of the lobe ggx"));
            }
            if self.bounds {
                return wrong(format!("`bounds` are those of sampled texels; `chain` {name} has none"));
            }
        }
        if self.sheen {
            self.filter.for_other_lobes().check(Lobe::Charlie, None)?;
        }
        let most = self.map.most_levels(self.size);
        let own = match self.lobe {
            // Irradiance has no roughness.
            Lobe::Cosine => 1,
            _ => self.ladder.default_levels(self.map, self.size),
        };
        let levels = self.levels.unwrap_or(own);
        if levels == 0 {
            return wrong("`levels` must be at least 1");
        }
        if levels > most {
            return wrong(format!("`levels` {levels} is too many for `size` {}; at most {most}", self.size));
        }
        let roughness = |level| self.ladder.roughness(level, levels, self.size);
        Ok((0..levels)
            .map(|level| LevelSpec { layout: self.map.layout(self.size, level), roughness: roughness(level) })
            .collect())
    }

    /// Content of the levels' texels.
    #[must_use]
    pub fn chain(&self) -> ChainKind {
        self.chain.unwrap_or_else(|| self.default_chain())
    }

    /// Mixed for cubes of GGX on the linear ladder by certified quadrature, whose bounds are not kept; else
    /// sampled.
    #[must_use]
    pub fn default_chain(&self) -> ChainKind {
        let Self { map, ladder, lobe, filter, bounds, .. } = self;
        match (map, ladder, lobe, filter, bounds) {
            (Map::Cube, Ladder::Linear, Lobe::Ggx, Filter::Adaptive(_), false) => ChainKind::Mixed,
            _ => ChainKind::Sampled,
        }
    }

    /// The lobes between the levels that a solved chain is made of; none for a sampled one.
    pub(crate) fn nodes(&self, levels: usize) -> Vec<Node> {
        solve::nodes(self.chain(), self.size, levels as u32, self.ladder)
    }
}
