//! Suns as directional lights of glTF, by KHR_lights_punctual.

use crate::files::io::exr::write::SOFTWARE;
use crate::files::recipe::source::SunReport;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

const EXTENSION: &str = "KHR_lights_punctual";

/// A glTF scene with a node for each of `suns`: its light's colour times its intensity in lux is the
/// irradiance, for radiance in candela per square metre.
pub fn gltf(suns: &[SunReport]) -> Value {
    let name = |k: usize| if k == 0 { "sun".to_owned() } else { format!("sun {}", k + 1) };
    let light = |(k, sun): (usize, &SunReport)| {
        let intensity = sun.irradiance.into_iter().fold(0.0, f64::max);
        json!({ "type": "directional", "name": name(k), "color": sun.color, "intensity": intensity })
    };
    // A light shines along its node's -Z, from the sun, which is at its +Z.
    let node = |(k, sun): (usize, &SunReport)| {
        let towards = DVec3::from_array(sun.direction).normalize_or(DVec3::Z);
        let rotation = DQuat::from_rotation_arc(DVec3::Z, towards).normalize();
        let extensions = json!({ EXTENSION: { "light": k } });
        json!({ "name": name(k), "rotation": rotation.to_array(), "extensions": extensions })
    };
    let mut root =
        json!({ "asset": { "version": "2.0", "generator": SOFTWARE }, "scene": 0, "scenes": [{}] });
    if !suns.is_empty() {
        root["scenes"][0]["nodes"] = (0..suns.len()).collect();
        root["nodes"] = suns.iter().enumerate().map(node).collect();
        root["extensionsUsed"] = json!([EXTENSION]);
        root["extensions"] =
            json!({ EXTENSION: { "lights": suns.iter().enumerate().map(light).collect::<Vec<_>>() } });
    }
    root
}
