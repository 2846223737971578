//! All maps by name.

use super::cube::Cube;
use super::dual;
use super::equirect::Equirect;
use super::healpix::Healpix;
use super::low_distortion::LowDistortion;
use super::map::{Component, Place, SphereMap};
use super::octahedral_perspective::PLANAR;
use super::octahedral_rectangular::OctahedralRectangular;
use super::polar_capped;
use super::rhombic_dodecahedron::RhombicDodecahedron;
use super::tennis_ball::TennisBall;
use crate::common::direction::units;
use crate::common::error::{Result, wrong};
use glam::DVec3;

/// A row of the table of maps.
#[derive(Clone, Copy, Debug)]
pub struct NamedMap {
    /// Name on the command line.
    pub name: &'static str,
    /// Name in tables and captions.
    pub title: &'static str,
    /// Publication.
    pub source: &'static str,
    pub(crate) map: &'static dyn SphereMap,
}

impl NamedMap {
    /// The map.
    #[doc(hidden)]
    #[must_use]
    pub const fn map(&self) -> &'static dyn SphereMap {
        self.map
    }

    /// Number of components, at least 1.
    #[must_use]
    pub fn components(&self) -> u32 {
        self.map.components()
    }

    /// Rectangle and image of component `index`, from 0.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a component that there is not.
    pub fn component(&self, index: u32) -> Result<Component> {
        if index < self.components() {
            return Ok(self.map.component(index));
        }
        let last = self.components() - 1;
        wrong(format!("`component` is {index}; {} has 0 to {last}", self.name))
    }

    /// The place of `direction`, of any length but zero.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a direction that is zero or not finite.
    pub fn place(&self, direction: DVec3) -> Result<Place> {
        Ok(self.map.locate(units(&[direction])?[0]))
    }

    /// Unit direction at `place`. In the parts of its rectangle that show no direction it is continued from
    /// the others.
    ///
    /// # Errors
    /// [`crate::common::error::Error::Parameter`] for a component that there is not, and a point outside its
    /// rectangle.
    pub fn direction(&self, place: Place) -> Result<DVec3> {
        self.check(place)?;
        Ok(self.map.direction(place.component, place.uv))
    }

    /// Steradians per unit of area at `place`; 0 where the map shows no direction.
    ///
    /// # Errors
    /// Those of [`Self::direction`].
    pub fn density(&self, place: Place) -> Result<f64> {
        self.check(place)?;
        let Place { component, uv } = place;
        Ok(if self.map.contains(component, uv) { self.map.density(component, uv) } else { 0.0 })
    }

    fn check(&self, Place { component, uv }: Place) -> Result<()> {
        let Component { low, high, .. } = self.component(component)?;
        if uv.cmpge(low).all() && uv.cmple(high).all() {
            return Ok(());
        }
        wrong(format!("the point {uv} is outside the rectangle from {low} to {high}"))
    }
}

/// A row of [`MAPS`].
const fn row(
    name: &'static str,
    title: &'static str,
    source: &'static str,
    map: &'static dyn SphereMap,
) -> NamedMap {
    NamedMap { name, title, source, map }
}

/// All maps.
pub static MAPS: [NamedMap; 14] = [
    row("octahedral", "Octahedral", "Engelhardt and Dachsbacher 2008, equations 1 and 2", &PLANAR),
    row(
        "octahedral-rectangular",
        "Octahedral (rectangular)",
        "Engelhardt and Dachsbacher 2008, equation 3",
        &OctahedralRectangular,
    ),
    row(
        "octahedral-perspective",
        "Octahedral (perspective)",
        "Engelhardt and Dachsbacher 2008, section 3.2",
        &PLANAR,
    ),
    row("tennis-ball", "Tennis-ball", "Herron, equations 1 to 3", &TennisBall),
    row(
        "polar-capped",
        "Polar-capped (stretch-invariant)",
        "Snyder and Mitchell 2001",
        &polar_capped::STRETCH_INVARIANT,
    ),
    row(
        "polar-capped-conformal",
        "Polar-capped (conformal)",
        "Snyder and Mitchell 2001",
        &polar_capped::CONFORMAL,
    ),
    row("dual-equidistant", "Dual equidistant", "Snyder and Mitchell 2001", &dual::EQUIDISTANT),
    row(
        "low-distortion",
        "Low-distortion equal-area",
        "Snyder and Mitchell 2001; Shirley and Chiu 1997; Clarberg 2008",
        &LowDistortion,
    ),
    row("equirect", "Latitude-longitude", "Blinn and Newell 1976", &Equirect),
    row("cube", "Cube", "Greene 1986; OpenGL 1.3, table 3.19", &Cube),
    row("dual-paraboloid", "Dual paraboloid", "Heidrich and Seidel 1998", &dual::PARABOLOID),
    row("sphere-map", "OpenGL sphere map", "OpenGL 1.1, section 2.10.4", &dual::MIRROR_BALL),
    row("healpix", "HEALPix", "Gorski et al. 2005; Calabretta and Roukema 2007", &Healpix),
    row("rhombic-dodecahedron", "Rhombic dodecahedron", "Fu et al. 2009", &RhombicDodecahedron),
];

/// The map called `name`, one of [`MAPS`].
#[must_use]
pub fn named(name: &str) -> Option<&'static NamedMap> {
    MAPS.iter().find(|row| row.name == name)
}
