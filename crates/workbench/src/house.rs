//! `octagloss-workbench house`: draws the crates of the workspace and what each uses, from their manifests.

use anyhow::{Context as _, anyhow};
use clap::Args as ClapArgs;
use glam::DVec2;
use octagloss::cli::outcome::{Outcome, check_png};
use octagloss_core::files::io::output::{Existing, write_file};
use octagloss_drawing::page::page;
use octagloss_drawing::scene::{Anchor, Frame, Scene};
use octagloss_drawing::style::{Colour, INK, LABEL, SMALL, SOFT, rgb};
use octagloss_plot::figure::{Figure, Form};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Width of the picture, edges of a box, and the height of a row.
const WIDTH: f64 = 900.0;
const BOX: DVec2 = DVec2::new(150.0, 58.0);
const ROW: f64 = 112.0;

#[derive(Debug, ClapArgs)]
pub(crate) struct HouseArgs {
    /// The picture
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
}

/// A member of the workspace.
struct Member {
    /// Lines of its sources that are neither blank nor comments, in thousands.
    lines: f64,
    /// The members that it uses.
    uses: Vec<String>,
}

pub(crate) fn run(args: &HouseArgs) -> Outcome {
    check_png("-o", &args.output)?;
    let figure = drawn(&members()?);
    Ok(write_file(&args.output, Existing::Replace, |file| file.write_all(&figure.bytes(Form::Png)))?)
}

/// The members, by their names without ours.
fn members() -> anyhow::Result<BTreeMap<String, Member>> {
    let run = Command::new("cargo").args(["metadata", "--no-deps", "--format-version", "1"]).output();
    let run = run.context("cargo metadata")?;
    let metadata: Value = serde_json::from_slice(&run.stdout).context("cargo metadata in a checkout")?;
    let packages = metadata["packages"].as_array().ok_or_else(|| anyhow!("cargo metadata: no packages"))?;
    let short = |name: &Value| name.as_str().unwrap_or_default().replace("octagloss-", "");
    let mut members = BTreeMap::new();
    for package in packages {
        let manifest = Path::new(package["manifest_path"].as_str().unwrap_or_default());
        let folder = manifest.parent().context("a folder")?;
        let inside = if folder.join("src").is_dir() { folder.join("src") } else { folder.to_owned() };
        let dependencies = package["dependencies"].as_array().into_iter().flatten();
        let ours = dependencies.filter(|one| one["kind"].is_null() && !one["path"].is_null());
        let uses = ours.map(|one| short(&one["name"])).collect();
        let lines = f64::from(lines_of(&inside)?) / 1000.0;
        members.insert(short(&package["name"]), Member { lines, uses });
    }
    Ok(members)
}

/// Lines of Rust and WGSL in `folder` that are neither blank nor comments.
fn lines_of(folder: &Path) -> anyhow::Result<u32> {
    let mut lines = 0;
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            lines += lines_of(&path)?;
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "wgsl") {
            let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            let is_code = |line: &&str| !line.is_empty() && !line.starts_with("//");
            lines += text.lines().map(str::trim).filter(is_code).count() as u32;
        }
    }
    Ok(lines)
}

/// The storey of `name`: one above the highest that it uses.
fn storey(members: &BTreeMap<String, Member>, name: &str) -> usize {
    let below = members[name].uses.iter().map(|used| 1 + storey(members, used));
    below.max().unwrap_or(0)
}

/// Whether `name` is `used`, or uses it at any depth.
fn reaches(members: &BTreeMap<String, Member>, name: &str, used: &str) -> bool {
    name == used || members[name].uses.iter().any(|next| reaches(members, next, used))
}

fn drawn(members: &BTreeMap<String, Member>) -> Figure {
    let mut storeys: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
    for name in members.keys() {
        storeys.entry(storey(members, name)).or_default().push(name);
    }
    // The largest left.
    for names in storeys.values_mut() {
        names.sort_by(|a, b| members[*b].lines.total_cmp(&members[*a].lines));
    }
    let title = "The crates of octagloss";
    let caption = "Numbers are thousands of lines of code. Arrows lead down to what a crate uses, \
                   but for what it uses through others as well.";
    let (mut scene, body) = page(WIDTH, storeys.len() as f64 * ROW, title, caption);
    let mut places: BTreeMap<&str, Frame> = BTreeMap::new();
    for (storey, names) in &storeys {
        for (index, name) in names.iter().enumerate() {
            let share = (index as f64 + 0.5) / names.len() as f64;
            // Alternate rows lean, so that arrows do not cross boxes.
            let x = body.low.x + body.extent().x * share + if storey % 2 == 0 { -40.0 } else { 40.0 };
            let y = body.high.y - (*storey as f64 + 0.5) * ROW;
            let centre = DVec2::new(x, y);
            places.insert(name, Frame::new(centre - BOX / 2.0, centre + BOX / 2.0));
        }
    }
    for (name, member) in members {
        let through =
            |used: &String| member.uses.iter().any(|other| other != used && reaches(members, other, used));
        for used in member.uses.iter().filter(|used| !through(used)) {
            let (from, to) = (&places[name.as_str()], &places[used.as_str()]);
            // Ends spread over the edges.
            let lean = (to.low.x - from.low.x).clamp(-BOX.x, BOX.x) * 0.4;
            let start = DVec2::new((from.low.x + from.high.x) / 2.0 + lean, from.high.y);
            let end = DVec2::new((to.low.x + to.high.x) / 2.0 - lean, to.low.y);
            scene.arrow(start, end, 1.2, SOFT);
        }
    }
    for (name, frame) in &places {
        draw_box(&mut scene, frame, name, members[*name].lines);
    }
    Figure::new(title.to_owned(), caption.to_owned(), scene)
}

fn draw_box(scene: &mut Scene, frame: &Frame, name: &str, lines: f64) {
    let fill: Colour = match name {
        "workbench" | "fixtures" => rgb(0xe9_e6_f2),
        "octagloss" => rgb(0xfb_e3_bf),
        _ => rgb(0xd5_e6_f4),
    };
    scene.polygon(frame.corners(), fill);
    scene.outline(frame.corners(), 1.2, INK);
    let centre = (frame.low + frame.high) / 2.0;
    scene.text(centre - DVec2::new(0.0, 3.0), name, LABEL, Anchor::Middle, INK);
    scene.text(centre + DVec2::new(0.0, 19.0), &format!("{lines:.1}"), SMALL, Anchor::Middle, SOFT);
}
