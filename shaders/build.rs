//! Lists the shaders under this folder but those of `readers`, with their texts.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder = |name| env::var_os(name).map(PathBuf::from).ok_or(io::Error::other(name));
    let (root, out) = (folder("CARGO_MANIFEST_DIR")?, folder("OUT_DIR")?);
    let mut files = Vec::new();
    find(&root, &mut files)?;
    files.sort();
    let mut list = String::new();
    for file in files {
        let path = file.strip_prefix(&root).map_err(io::Error::other)?;
        if !path.starts_with("readers") {
            let name = path.to_string_lossy().replace('\\', "/");
            list += &format!("({name:?}, include_str!({file:?})),\n");
        }
    }
    fs::write(out.join("files.rs"), format!("&[\n{list}]"))
}

/// Appends the shaders below `folder`.
fn find(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            find(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "wgsl") {
            files.push(path);
        }
    }
    Ok(())
}
