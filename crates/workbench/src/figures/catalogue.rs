//! Lists and draws the figures.

pub use super::content::FigureContent;
use super::{border, layout, lobes, lookup, panorama, sampling, seam, stretch, unfolding};
use crate::laboratory::measure::Method;
use octagloss_core::common::error::Result;
use octagloss_core::common::names::named;
use octagloss_core::sphere::registry::{MAPS, NamedMap};
use octagloss_plot::figure::Figure;

/// Kinds of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Relative solid angle on the sphere.
    SolidAngle,
    /// Anisotropy on the sphere.
    Anisotropy,
    /// The domain with faces, parallels and meridians.
    Layout,
    /// A panorama in the layout.
    Panorama,
    /// Relative solid angles of three maps side by side.
    Compared,
    /// The unfolding of the octahedron.
    Unfolding,
    /// The border of the octahedral square.
    Border,
    /// The seam of the tennis ball.
    Seam,
    /// Sampling requirement against anisotropy.
    Sampling,
    /// Look-ups at the mip level of a cell, and of the mirrored cell.
    LookupLevel,
    /// Look-ups without and with a safety border.
    LookupBorder,
    /// Look-ups beyond and at the greatest correct mip level.
    LookupGreatest,
    /// Mip levels by equal weights and by solid angles.
    LookupWeights,
    /// Look-ups in one layer per hemisphere, without and with a border.
    LookupRectangular,
    /// Errors of lobes by the single box over roughness.
    LobesBox,
    /// Errors of lobes by a stack of boxes over roughness.
    LobesStack,
    /// Errors of lobes by adaptive quadrature over roughness.
    LobesAdaptive,
    /// Errors of lobes by a stack of boxes on the sphere.
    LobesSphere,
}

named!(Kind {
    SolidAngle = "solid-angle",
    Anisotropy = "anisotropy",
    Layout = "layout",
    Panorama = "panorama",
    Compared = "compared",
    Unfolding = "unfolding",
    Border = "border",
    Seam = "seam",
    Sampling = "sampling",
    LookupLevel = "lookup-level",
    LookupBorder = "lookup-border",
    LookupGreatest = "lookup-greatest",
    LookupWeights = "lookup-weights",
    LookupRectangular = "lookup-rectangular",
    LobesBox = "lobes-box",
    LobesStack = "lobes-stack",
    LobesAdaptive = "lobes-adaptive",
    LobesSphere = "lobes-sphere",
});

impl Kind {
    /// Whether every map has such a figure.
    pub const fn is_of_a_map(self) -> bool {
        matches!(self, Self::SolidAngle | Self::Anisotropy | Self::Layout | Self::Panorama)
    }
}

/// An available figure.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its kind.
    pub kind: Kind,
    /// Its map, for a figure of one map.
    pub map: Option<&'static NamedMap>,
}

/// All figures: map by map, then figures of several maps.
pub fn entries() -> Vec<Entry> {
    let of_maps = MAPS.iter().flat_map(|map| {
        let kinds = Kind::ALL.into_iter().filter(|kind| kind.is_of_a_map());
        kinds.map(move |kind| Entry { kind, map: Some(map) })
    });
    let others = Kind::ALL.into_iter().filter(|kind| !kind.is_of_a_map());
    of_maps.chain(others.map(|kind| Entry { kind, map: None })).collect()
}

impl Entry {
    /// Name in files: the kind, and the map for a figure of one map.
    pub fn name(&self) -> String {
        match self.map {
            Some(map) => format!("{}-{}", self.kind.name(), map.name),
            None => self.kind.name().to_owned(),
        }
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// As [`FigureContent::check`].
    ///
    /// # Panics
    /// If a figure of one map has no map.
    pub fn draw(&self, content: &FigureContent) -> Result<Figure> {
        content.check()?;
        let map = || self.map.expect("a figure of a map has a map");
        Ok(match self.kind {
            Kind::SolidAngle => stretch::solid_angle(map()),
            Kind::Anisotropy => stretch::anisotropy(map()),
            Kind::Layout => layout::layout(map()),
            Kind::Panorama => panorama::panorama(map(), content),
            Kind::Compared => stretch::compared(),
            Kind::Unfolding => unfolding::unfolding(),
            Kind::Border => border::border(content.size, content.border),
            Kind::Seam => seam::seam(),
            Kind::Sampling => sampling::sampling()?,
            Kind::LookupLevel => lookup::level(),
            Kind::LookupBorder => lookup::border(),
            Kind::LookupGreatest => lookup::greatest(),
            Kind::LookupWeights => lookup::weights(),
            Kind::LookupRectangular => lookup::rectangular(),
            Kind::LobesBox => lobes::over_roughness(Method::Box, &content.lobes)?,
            Kind::LobesStack => lobes::over_roughness(Method::Stack, &content.lobes)?,
            Kind::LobesAdaptive => lobes::over_roughness(Method::Adaptive, &content.lobes)?,
            Kind::LobesSphere => lobes::over_sphere(&content.lobes)?,
        })
    }
}
