//! What a pyramid has besides its maps: suns, harmonics and scale.

use crate::files::io::pyramid_write::{KEY, VERSION};
use crate::pyramid::BakedPyramid;
use crate::pyramid::light::OctaglossSun;
use serde_json::{Value, json};

/// `metadata` with the light.
pub(super) fn metadata(baked: &BakedPyramid, metadata: &[(String, String)]) -> Vec<(String, String)> {
    let own =
        [("octaglossContent".to_owned(), "pyramid".to_owned()), (KEY.to_owned(), light(baked).to_string())];
    [&own[..], metadata].concat()
}

/// The light as a file.
pub(super) fn light_json(baked: &BakedPyramid) -> String {
    serde_json::to_string_pretty(&light(baked)).expect("keys are strings") + "\n"
}

fn light(baked: &BakedPyramid) -> Value {
    let (levels, light) = (baked.levels(), &baked.light);
    let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
    let columns = light.world_from_source.map(rgb);
    let harmonics = light.harmonics.map(|harmonic| rgb(harmonic).map(|c| c * light.unscale));
    let lit = light.suns.iter().enumerate().filter(|(_, sun)| sun.energy != [0.0; 3]);
    let sun = |(k, sun): (usize, &OctaglossSun)| {
        let channels = [sun.red, sun.green, sun.blue];
        json!({
            "directions": channels.map(|[x, y, z, _]| [x, y, z]),
            "spreads": channels.map(|[.., spread]| spread),
            "half_axis": light.half_axis(k),
            "energies": sun.energy,
        })
    };
    let suns: Vec<Value> = lit.map(sun).collect();
    let uniform: &[f32] = bytemuck::cast_slice(std::slice::from_ref(light));
    json!({
        "version": VERSION,
        "size": levels.inner(),
        "border": levels.size(0).border,
        "scale": light.unscale,
        "world_from_source": columns,
        "harmonics": harmonics,
        "suns": suns,
        "uniform": uniform,
    })
}
