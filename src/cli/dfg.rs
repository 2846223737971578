//! `octagloss dfg`: the table of what rough surfaces reflect of white.

use super::args::DfgArgs;
use super::talk::{self, Talk};
use super::values::DfgFormArg;
use super::{Outcome, usage};
use octagloss::dfg::{DfgForm, dfg_table};
use octagloss::io::exr_write::{Attribute, Samples, exr_bytes};
use octagloss::io::output::{self, Existing};
use octagloss::io::pixels::Pixel;
use octagloss::io::table_write::{Channels, table_bytes};

pub(super) fn run(args: DfgArgs) -> Outcome {
    let path = &args.output;
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    let is_ktx2 = match extension.as_deref().and_then(|extension| extension.to_str()) {
        Some("ktx2") => true,
        Some("exr") => false,
        _ => return usage(format!("-o {} must end in .ktx2 or .exr", path.display())),
    };
    let existing = if args.force { Existing::Replace } else { Existing::Keep };
    output::check_file(path, existing)?;
    let (form, name) = match args.form {
        DfgFormArg::SplitSum => (DfgForm::SplitSum, "red: scale of f0, green: bias"),
        DfgFormArg::MultipleScattering => {
            (DfgForm::MultipleScattering, "red: reflected at f0 = 0, green: at f0 = 1")
        }
    };
    let blue = if args.charlie { ", blue: Charlie" } else { "" };
    let description = format!("{name}{blue}; columns: cosine 0 to 1, rows: perceptual roughness 0 to 1");
    let table = dfg_table(args.size, form, args.charlie)?;
    let bytes = if is_ktx2 {
        let channels = if args.charlie { Channels::Four } else { Channels::Two };
        table_bytes(table.size, &table.texels, channels, &description)?
    } else {
        let attributes = [("comments".to_owned(), Attribute::Text(description))];
        exr_bytes(table.size, table.size, Samples::Rgb(&table.texels), Pixel::F16, &attributes)?
    };
    output::write_file(path, existing, |file| file.write_all(&bytes))?;
    Talk::new(args.quiet).note(&format!("{}: {}", path.display(), talk::bytes(bytes.len() as u64)));
    Ok(())
}
