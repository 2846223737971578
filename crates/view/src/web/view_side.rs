//! Settings and state of the view side as JSON.

use super::super::look::{Finish, Look, Object, Paint, Technique};
use super::parsed;
use crate::interface::viewer::Viewer;
use crate::interface::window::WindowContent as _;
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::files::image::exposure::Exposure;
use serde::Deserialize;
use serde_json::{Value, json};

/// Changes of a look; absent fields stay unchanged.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Change {
    roughness: Option<f64>,
    roughness_factor: Option<f64>,
    anisotropy: Option<f64>,
    direction: Option<f64>,
    clearcoat: Option<f64>,
    coat_roughness: Option<f64>,
    backdrop: Option<f64>,
    exposure: Option<ExposureChange>,
    turn: Option<f64>,
    filter: Option<String>,
    object: Option<String>,
    paint: Option<String>,
    panel: Option<bool>,
}

/// `"auto"` or a number.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum ExposureChange {
    Ev(f64),
    Text(String),
}

/// The state reported to the page.
pub(super) fn state(viewer: &Viewer) -> Value {
    let look = &viewer.look;
    json!({
        "side": "view",
        "environment": viewer.panel.name,
        "message": viewer.panel.message,
        "adapter": viewer.context().describe(),
        "roughness": look.roughness,
        "roughness_factor": look.roughness_factor,
        "anisotropy": look.finish.anisotropy,
        "direction": look.finish.direction,
        "clearcoat": look.finish.clearcoat,
        "coat_roughness": look.finish.coat_roughness,
        "exposure": look.exposure.to_string(),
        "filter": look.filter.name(),
        "object": look.object.name(),
        "paint": look.paint.name(),
        // Samples of the picture, and whether it is final.
        "size": viewer.picture_size(),
        "settled": !viewer.is_busy(),
        "panel": !viewer.panel.is_hidden,
        // Left, top, right and bottom in CSS pixels.
        "roughness_slider": viewer.slider.map(|s| [s.left(), s.top(), s.right(), s.bottom()]),
    })
}

impl Change {
    /// Applies the change to `viewer`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] naming a value; nothing changes then.
    pub(super) fn apply(self, viewer: &mut Viewer) -> Result<()> {
        let filter: Option<Technique> = parsed("filter", self.filter)?;
        let object: Option<Object> = parsed("object", self.object)?;
        let paint: Option<Paint> = parsed("paint", self.paint)?;
        let exposure = match self.exposure {
            Some(ExposureChange::Ev(ev)) => Some(Exposure::Ev(ev)),
            Some(ExposureChange::Text(text)) => parsed("exposure", Some(text))?,
            None => None,
        };
        let was = viewer.look.clone();
        let look = Look {
            roughness: self.roughness.unwrap_or(was.roughness),
            backdrop: self.backdrop.or(was.backdrop),
            exposure: exposure.unwrap_or(was.exposure),
            roughness_factor: self.roughness_factor.unwrap_or(was.roughness_factor),
            finish: Finish {
                anisotropy: self.anisotropy.unwrap_or(was.finish.anisotropy),
                direction: self.direction.unwrap_or(was.finish.direction),
                clearcoat: self.clearcoat.unwrap_or(was.finish.clearcoat),
                coat_roughness: self.coat_roughness.unwrap_or(was.finish.coat_roughness),
            },
            turn: self.turn.unwrap_or(was.turn),
            filter: filter.unwrap_or(was.filter),
            object: object.unwrap_or(was.object),
            paint: paint.unwrap_or(was.paint),
            ..was
        };
        look.check()?;
        if look.object == Object::Mesh && !viewer.has_mesh {
            return wrong("no mesh is loaded; open one first");
        }
        viewer.look = look;
        if self.panel.is_some_and(|shown| shown == viewer.panel.is_hidden) {
            viewer.toggle_panel();
        }
        Ok(())
    }
}
