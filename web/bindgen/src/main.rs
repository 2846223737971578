//! Writes the JavaScript and the final module of a WebAssembly file for browsers: `octagloss-bindgen
//! MODULE.wasm FOLDER`. Without names, debug information and types.

use anyhow::{Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [module, folder] = &arguments[..] else { bail!("usage: octagloss-bindgen MODULE.wasm FOLDER") };
    Bindgen::new()
        .web(true)?
        .input_path(module)
        .typescript(false)
        .omit_default_module_path(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
}
