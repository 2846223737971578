//! Settings and state of the view side as JSON.

use super::super::look::{Finish, Look, Object, Paint, Technique};
use super::parsed;
use super::sides::Side;
use crate::interface::viewer::Viewer;
use crate::interface::window::WindowContent as _;
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::files::image::exposure::Exposure;
use serde::Deserialize;
use serde_json::{Value, json};
use wasm_bindgen::JsError;

/// Changes of a look; absent fields stay unchanged.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Change {
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

impl Side for Viewer {
    fn state(&self) -> Value {
        let look = &self.look;
        json!({
            "side": "view",
            "environment": self.panel.name,
            "message": self.panel.message,
            "adapter": self.context().describe(),
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
            "size": self.picture_size(),
            "settled": !self.is_busy(),
            "panel": !self.panel.is_hidden,
            // Left, top, right and bottom in CSS pixels.
            "roughness_slider": self.slider.map(|s| [s.left(), s.top(), s.right(), s.bottom()]),
        })
    }

    fn set(&mut self, change: &str) -> Result<(), JsError> {
        let change: Change = serde_json::from_str(change)?;
        let filter: Option<Technique> = parsed("filter", change.filter)?;
        let object: Option<Object> = parsed("object", change.object)?;
        let paint: Option<Paint> = parsed("paint", change.paint)?;
        let exposure = match change.exposure {
            Some(ExposureChange::Ev(ev)) => Some(Exposure::Ev(ev)),
            Some(ExposureChange::Text(text)) => parsed("exposure", Some(text))?,
            None => None,
        };
        let was = self.look;
        let look = Look {
            roughness: change.roughness.unwrap_or(was.roughness),
            backdrop: change.backdrop.or(was.backdrop),
            exposure: exposure.unwrap_or(was.exposure),
            roughness_factor: change.roughness_factor.unwrap_or(was.roughness_factor),
            finish: Finish {
                anisotropy: change.anisotropy.unwrap_or(was.finish.anisotropy),
                direction: change.direction.unwrap_or(was.finish.direction),
                clearcoat: change.clearcoat.unwrap_or(was.finish.clearcoat),
                coat_roughness: change.coat_roughness.unwrap_or(was.finish.coat_roughness),
            },
            turn: change.turn.unwrap_or(was.turn),
            filter: filter.unwrap_or(was.filter),
            object: object.unwrap_or(was.object),
            paint: paint.unwrap_or(was.paint),
            ..was
        };
        look.check()?;
        if look.object == Object::Mesh && !self.has_mesh {
            wrong::<()>("no mesh is loaded; open one first")?;
        }
        self.look = look;
        if change.panel.is_some_and(|shown| shown == self.panel.is_hidden) {
            self.toggle_panel();
        }
        Ok(())
    }
}
