//! Help of `--target`, from the table of targets.

use crate::files::target::{Diffuse, TARGETS, Target, TargetPlan};
use crate::light::environment::Map;

/// Help text of `--target`, with each target's options and files.
pub(super) fn targets() -> String {
    let mut text = "Presets for engines, comma-separated\n\nExplicit options override the preset. OUT is a \
                    folder with the target's files and report.json, one subfolder per target for several. \
                    All targets share one octahedral map."
        .to_owned();
    for target in &TARGETS {
        let tested = match target.verified {
            Some(reader) => format!("tested with {reader}"),
            None => "untested in its engine".to_owned(),
        };
        text += &format!("\n\n{}: {} ({tested})\n{}\nFiles:", target.name, target.reader, expansion(target));
        for (path, _) in TargetPlan::new(target).files("NAME", 1, &[]) {
            text += &format!(" {path}");
        }
    }
    text
}

/// The options that `target` expands to.
fn expansion(target: &Target) -> String {
    let mut text = String::new();
    if target.has_container() {
        text += &format!("--format {} --pixel {} ", target.container.name(), target.pixel.name());
    }
    text += &format!("--size {} ", target.size);
    if target.map != Map::Panorama {
        text += &format!("--levels {} --ladder {} ", target.levels(target.size), target.ladder.name());
    }
    if target.map == Map::Cube {
        text += &format!("--flip {} ", target.flip.name());
    }
    text += &format!("--diffuse {}", target.diffuse.name());
    if matches!(target.diffuse, Diffuse::Cube | Diffuse::Both) {
        text += &format!(" --irradiance {}", target.irradiance_size);
    }
    if target.has_sheen() {
        text += ", and the same levels with --lobe charlie";
    }
    text
}
