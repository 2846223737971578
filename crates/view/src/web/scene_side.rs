//! Settings and state of the scene side as JSON, by the names of the command line's options.

use super::super::look::{Technique, Tone};
use super::super::scene::{Controls, MAX_BUDGET, Proxy, SceneViewer, check_scene_filter};
use super::parsed;
use super::sides::Side;
use crate::interface::window::WindowContent as _;
use octagloss_core::common::error::{Result, wrong};
use octagloss_gpu::direct::Method;
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use wasm_bindgen::JsError;

/// Changes of the controls; absent fields stay unchanged.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Change {
    /// `null` for the objects' own.
    #[serde(default, deserialize_with = "given")]
    roughness: Option<Option<f64>>,
    exposure: Option<f64>,
    tone: Option<String>,
    scene_time: Option<f64>,
    moving: Option<bool>,
    probes: Option<usize>,
    /// Milliseconds; `null` for none.
    #[serde(default, deserialize_with = "given")]
    probe_budget: Option<Option<f64>>,
    proxy: Option<String>,
    direct: Option<String>,
    filter: Option<String>,
    oem_size: Option<u32>,
    gpu_times: Option<bool>,
    panel: Option<bool>,
}

/// A field that is given, perhaps as `null`.
fn given<'de, D: Deserializer<'de>, T: Deserialize<'de>>(field: D) -> Result<Option<T>, D::Error> {
    T::deserialize(field).map(Some)
}

/// Edges of maps.
const SIZES: RangeInclusive<u32> = 16..=8192;

/// Checks that every value is in its range, as the command line's parser does.
fn check(controls: &Controls) -> Result<()> {
    controls.look.check()?;
    if !(0.0..=MAX_BUDGET).contains(&controls.budget) {
        let message = format!("`probe_budget` {}; use 0 to {MAX_BUDGET} milliseconds", controls.budget);
        return wrong(message);
    }
    let size = controls.settings.size;
    if !(SIZES.contains(&size) && size.is_power_of_two()) {
        let [least, most] = [SIZES.start(), SIZES.end()];
        return wrong(format!("`oem_size` {size}; use a power of two from {least} to {most}"));
    }
    Ok(())
}

impl Side for SceneViewer {
    fn state(&self) -> Value {
        let Controls { look, settings, time, moving, budget, limited, .. } = self.controls;
        json!({
            "side": "scene",
            "scene": self.panel.name,
            "message": self.panel.message,
            "adapter": self.context().describe(),
            "roughness": look.roughness,
            "exposure": look.exposure,
            "tone": look.tone.name(),
            "scene_time": time,
            "moving": moving,
            "probes": settings.probes,
            "probe_budget": limited.then_some(budget),
            "proxy": look.proxy.name(),
            "direct": settings.method.name(),
            "filter": Technique::Pyramid.name(),
            "oem_size": settings.size,
            "triangles": self.renderer.triangles(),
            // Seconds of the passes, if they were measured.
            "gpu_times": self.panel.times.iter().copied().collect::<BTreeMap<_, _>>(),
            // Samples of the picture, and whether it is final.
            "size": self.picture_size(),
            "settled": !self.is_busy(),
            "panel": !self.panel.is_hidden,
        })
    }

    fn set(&mut self, change: &str) -> Result<(), JsError> {
        let change: Change = serde_json::from_str(change)?;
        let tone: Option<Tone> = parsed("tone", change.tone)?;
        let proxy: Option<Proxy> = parsed("proxy", change.proxy)?;
        let method: Option<Method> = parsed("direct", change.direct)?;
        parsed("filter", change.filter)?.map_or(Ok(()), check_scene_filter)?;
        let mut controls = self.controls;
        let Controls { look, settings, time, moving, budget, limited, timing } = &mut controls;
        look.roughness = change.roughness.unwrap_or(look.roughness);
        look.exposure = change.exposure.unwrap_or(look.exposure);
        look.tone = tone.unwrap_or(look.tone);
        look.proxy = proxy.unwrap_or(look.proxy);
        settings.method = method.unwrap_or(settings.method);
        settings.probes = change.probes.unwrap_or(settings.probes);
        settings.size = change.oem_size.unwrap_or(settings.size);
        *time = change.scene_time.unwrap_or(*time);
        *moving = change.moving.unwrap_or(*moving);
        if let Some(given) = change.probe_budget {
            (*limited, *budget) = (given.is_some(), given.unwrap_or(*budget));
        }
        *timing = change.gpu_times.unwrap_or(*timing);
        check(&controls)?;
        controls.settings.probes = controls.settings.probes.min(self.renderer.scene().glossy_parts());
        self.configure(controls.settings)?;
        self.controls = controls;
        if change.panel.is_some_and(|shown| shown == self.panel.is_hidden) {
            self.toggle_panel();
        }
        Ok(())
    }
}
