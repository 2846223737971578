//! Settings and state of the scene side as JSON, by the names of the command line's options.

use super::super::look::{Technique, Tone};
use super::super::scene::{Controls, Proxy, SceneViewer, check_scene_filter};
use super::parsed;
use crate::interface::window::WindowContent as _;
use octagloss_core::common::error::Result;
use octagloss_gpu::direct::Method;
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Changes of the controls; absent fields stay unchanged.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Change {
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

/// The state reported to the page.
pub(super) fn state(viewer: &SceneViewer) -> Value {
    let Controls { look, settings, time, moving, budget, limited, .. } = viewer.controls;
    json!({
        "side": "scene",
        "scene": viewer.panel.name,
        "message": viewer.panel.message,
        "adapter": viewer.context().describe(),
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
        "triangles": viewer.renderer.triangles(),
        // Seconds of the passes, if they were measured.
        "gpu_times": viewer.panel.times.iter().copied().collect::<BTreeMap<_, _>>(),
        // Samples of the picture, and whether it is final.
        "size": viewer.picture_size(),
        "settled": !viewer.is_busy(),
        "panel": !viewer.panel.is_hidden,
    })
}

impl Change {
    /// Applies the change to `viewer`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] naming a value; nothing changes then.
    pub(super) fn apply(self, viewer: &mut SceneViewer) -> Result<()> {
        let tone: Option<Tone> = parsed("tone", self.tone)?;
        let proxy: Option<Proxy> = parsed("proxy", self.proxy)?;
        let method: Option<Method> = parsed("direct", self.direct)?;
        parsed("filter", self.filter)?.map_or(Ok(()), check_scene_filter)?;
        let mut controls = viewer.controls;
        let Controls { look, settings, time, moving, budget, limited, timing } = &mut controls;
        look.roughness = self.roughness.unwrap_or(look.roughness);
        look.exposure = self.exposure.unwrap_or(look.exposure);
        look.tone = tone.unwrap_or(look.tone);
        look.proxy = proxy.unwrap_or(look.proxy);
        settings.method = method.unwrap_or(settings.method);
        settings.probes = self.probes.unwrap_or(settings.probes);
        settings.size = self.oem_size.unwrap_or(settings.size);
        *time = self.scene_time.unwrap_or(*time);
        *moving = self.moving.unwrap_or(*moving);
        if let Some(given) = self.probe_budget {
            (*limited, *budget) = (given.is_some(), given.unwrap_or(*budget));
        }
        *timing = self.gpu_times.unwrap_or(*timing);
        viewer.set_controls(controls)?;
        if self.panel.is_some_and(|shown| shown == viewer.panel.is_hidden) {
            viewer.toggle_panel();
        }
        Ok(())
    }
}
