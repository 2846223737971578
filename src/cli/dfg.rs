//! `octagloss dfg`: writes the split-sum DFG (BRDF integration) lookup table.

use super::args::DfgArgs;
use super::console::{self, Console};
use super::outcome::{Outcome, check_output, usage, write_output};
use super::output::extension;
use crate::files::Pixel;
use crate::reflectance::{DfgBlue, DfgForm};
use octagloss_core::bake::dfg::dfg_table_with;
use octagloss_core::files::io::exr::write::{Attribute, Samples, exr_bytes};
use octagloss_core::files::io::ktx2::lookup_table::{Channels, table_bytes};

pub(super) fn run(args: DfgArgs) -> Outcome {
    let path = &args.output;
    let is_ktx2 = match extension(path).as_deref() {
        Some("ktx2") => true,
        Some("exr") => false,
        None if path.as_os_str() == "-" => true,
        _ => return usage(format!("-o {} must end in .ktx2 or .exr", path.display())),
    };
    let existing = check_output(path, args.force)?;
    let name = match args.form {
        DfgForm::SplitSum => "red: scale of f0, green: bias",
        DfgForm::MultipleScattering => "red: reflected at f0 = 0, green: at f0 = 1",
    };
    let (blue, blue_name, channels) = if args.charlie {
        (DfgBlue::Charlie, ", blue: Charlie", Channels::Four)
    } else {
        (DfgBlue::Empty, "", Channels::Two)
    };
    let description = format!("{name}{blue_name}; columns: cosine 0 to 1, rows: perceptual roughness 0 to 1");
    let console = Console::new(args.quiet);
    let bar = console.bar("integrating");
    let table = dfg_table_with(args.size, args.form, blue, &|done, total| bar.at(done, total))?;
    drop(bar);
    let bytes = if is_ktx2 {
        table_bytes(table.size, &table.texels, channels, &description)?
    } else {
        let attributes = [("comments".to_owned(), Attribute::Text(description))];
        exr_bytes(table.size, table.size, Samples::Rgb(&table.texels), Pixel::F16, &attributes)?
    };
    write_output(path, existing, &bytes)?;
    console.note(&format!("{}: {}", path.display(), console::bytes(bytes.len() as u64)));
    Ok(())
}
