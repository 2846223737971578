//! Lists and draws the figures.

pub use super::content::FigureContent;
use super::{border, layout, lobes, lookup, panorama, sampling, seam, stretch, unfolding};
use crate::laboratory::measure::Method;
use octagloss_core::common::error::Result;
use octagloss_core::sphere::registry::{MAPS, NamedMap};
use octagloss_plot::figure::Figure;

/// Draws a figure of a map.
type DrawMap = fn(&'static NamedMap, &FigureContent) -> Figure;

/// The figures that every map has: their kinds and what draws them.
const OF_MAPS: [(&str, DrawMap); 4] = [
    ("solid-angle", |map, _| stretch::solid_angle(map)),
    ("anisotropy", |map, _| stretch::anisotropy(map)),
    ("layout", |map, _| layout::layout(map)),
    ("panorama", panorama::panorama),
];

/// Draws another figure.
type Draw = fn(&FigureContent) -> Result<Figure>;

/// The others.
const OTHERS: [(&str, Draw); 14] = [
    ("compared", |_| Ok(stretch::compared())),
    ("unfolding", |_| Ok(unfolding::unfolding())),
    ("border", |content| Ok(border::border(content.size, content.border))),
    ("seam", |_| Ok(seam::seam())),
    ("sampling", |_| sampling::sampling()),
    ("lookup-level", |_| Ok(lookup::level())),
    ("lookup-border", |_| Ok(lookup::border())),
    ("lookup-greatest", |_| Ok(lookup::greatest())),
    ("lookup-weights", |_| Ok(lookup::weights())),
    ("lookup-rectangular", |_| Ok(lookup::rectangular())),
    ("lobes-box", |content| lobes::over_roughness(Method::Box, &content.lobes)),
    ("lobes-stack", |content| lobes::over_roughness(Method::Stack, &content.lobes)),
    ("lobes-adaptive", |content| lobes::over_roughness(Method::Adaptive, &content.lobes)),
    ("lobes-sphere", |content| lobes::over_sphere(&content.lobes)),
];

/// The kinds of figures.
pub fn kinds() -> impl Iterator<Item = &'static str> {
    OF_MAPS.iter().map(|(kind, _)| *kind).chain(OTHERS.iter().map(|(kind, _)| *kind))
}

/// An available figure.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its kind.
    pub kind: &'static str,
    /// Its map, for a figure of one map.
    pub map: Option<&'static NamedMap>,
    with: With,
}

/// What draws a figure.
#[derive(Clone, Copy, Debug)]
enum With {
    OfMap(&'static NamedMap, DrawMap),
    Other(Draw),
}

/// All figures: map by map, then figures of several maps.
pub fn entries() -> Vec<Entry> {
    let of_map = |map| {
        let entry = move |(kind, draw)| Entry { kind, map: Some(map), with: With::OfMap(map, draw) };
        OF_MAPS.into_iter().map(entry)
    };
    let others = OTHERS.into_iter().map(|(kind, draw)| Entry { kind, map: None, with: With::Other(draw) });
    MAPS.iter().flat_map(of_map).chain(others).collect()
}

impl Entry {
    /// Name in files: the kind, and the map for a figure of one map.
    pub fn name(&self) -> String {
        match self.map {
            Some(map) => format!("{}-{}", self.kind, map.name),
            None => self.kind.to_owned(),
        }
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// As [`FigureContent::check`].
    pub fn draw(&self, content: &FigureContent) -> Result<Figure> {
        content.check()?;
        match self.with {
            With::OfMap(map, draw) => Ok(draw(map, content)),
            With::Other(draw) => draw(content),
        }
    }
}
