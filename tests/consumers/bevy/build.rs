//! Takes the recipe from docs/engines.md.

use std::error::Error;
use std::path::PathBuf;

const PAGE: &str = "../../../docs/engines.md";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={PAGE}");
    let page = std::fs::read_to_string(PAGE).map_err(|error| format!("{PAGE}: {error}"))?;
    let between = |text: &str, from: &str, to: &str| {
        let (_, rest) = text.split_once(from)?;
        rest.split_once(to).map(|(inside, _)| inside.to_owned())
    };
    let section = between(&page, "\n## Bevy\n", "\n## ");
    let code = section.and_then(|section| between(&section, "```rust\n", "```"));
    let out = PathBuf::from(std::env::var("OUT_DIR")?).join("recipe.rs");
    Ok(std::fs::write(out, code.ok_or(format!("{PAGE}: no code in Rust under Bevy"))?)?)
}
