//! Reads only the files that another file references.

use octagloss_core::common::error::{Error, Result, quoted};
use octagloss_core::files::io::regular::open_regular;
use std::fs;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

/// Longest relative path that messages show whole, in bytes.
const MAX_PATH: usize = 255;

/// Reads the URIs of a file: data URIs, and regular files below one folder.
#[derive(Debug)]
pub(crate) struct Confined<'a> {
    /// The referencing file.
    path: &'a Path,
    /// The base folder of relative URIs and the root folder of all files; `None` for a file in memory.
    folders: Option<(PathBuf, PathBuf)>,
    /// Bytes that may still be read in total.
    limit: u64,
    left: u64,
}

impl<'a> Confined<'a> {
    /// Allows files below the folder of `path`, or below `root` if given, of at most `limit` bytes in total.
    ///
    /// # Errors
    /// [`Error::Io`] for a folder that does not exist, [`Error::Input`] if `path` is outside `root`.
    pub(crate) fn below(path: &'a Path, root: Option<&Path>, limit: u64) -> Result<Self> {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let resolved = |folder: &Path| fs::canonicalize(folder).map_err(|error| Error::io(folder, error));
        let base = resolved(parent.unwrap_or_else(|| Path::new(".")))?;
        let top = root.map(resolved).transpose()?.unwrap_or_else(|| base.clone());
        if !base.starts_with(&top) {
            let message = format!("outside of `mesh_root` {}; give a folder above it", top.display());
            return Err(Error::input(path, message));
        }
        Ok(Self { path, folders: Some((base, top)), limit, left: limit })
    }

    /// Allows only data URIs, of at most `limit` bytes in total.
    pub(crate) fn inside(path: &'a Path, limit: u64) -> Self {
        Self { path, folders: None, limit, left: limit }
    }

    /// Reads the content of `uri`.
    ///
    /// # Errors
    /// [`Error::Input`] for a URI that is not allowed, [`Error::Io`] for a file that cannot be read,
    /// [`Error::Limit`] if the limit is exceeded. Each names the file.
    pub(crate) fn read(&mut self, uri: &str) -> Result<Vec<u8>> {
        let bytes = match uri.strip_prefix("data:") {
            Some(data) => decoded(data).map_err(|message| Error::input(self.path, message))?,
            None => self.file(uri)?,
        };
        self.left = self.left.checked_sub(bytes.len() as u64).ok_or_else(|| Error::Limit {
            what: format!("{}: {} with the files before it", self.path.display(), quoted(uri)),
            needed: self.limit.saturating_add(1),
            available: self.limit,
            remedy: "use a smaller mesh".to_owned(),
        })?;
        Ok(bytes)
    }

    fn file(&self, uri: &str) -> Result<Vec<u8>> {
        let refuse = |why: &str| Error::input(self.path, format!("refers to {}: {why}", quoted(uri)));
        let name = urlencoding::decode(uri).map_err(|_| refuse("not text in UTF-8"))?;
        // Reject drive letters.
        if name.contains([':', '\0']) {
            return Err(refuse("only files by their relative paths and data: URIs are read"));
        }
        let Some((base, top)) = &self.folders else {
            return Err(refuse("a file in memory cannot reference others; use one that holds all its data"));
        };
        // Check the name first, so that nothing outside is accessed.
        let mut place = base.clone();
        for component in Path::new(&*name).components() {
            match component {
                Component::Normal(part) => place.push(part),
                Component::CurDir => {}
                Component::ParentDir if place != *top => {
                    place.pop();
                }
                Component::ParentDir => {
                    return Err(refuse(
                        "outside of the mesh's folder; `mesh_root` DIR allows files below DIR",
                    ));
                }
                Component::RootDir | Component::Prefix(_) => {
                    return Err(refuse("an absolute path; only relative ones are read"));
                }
            }
        }
        // Follow links only within the folder.
        let missing = |error: std::io::Error| {
            if name.len() > MAX_PATH || name.contains(char::is_control) {
                refuse(&error.to_string())
            } else {
                Error::io(&place, error)
            }
        };
        let real = fs::canonicalize(&place).map_err(missing)?;
        if !real.starts_with(top) {
            return Err(refuse("a link out of the mesh's folder; `mesh_root` DIR allows files below DIR"));
        }
        let file = open_regular(&real)?;
        let mut bytes = Vec::new();
        file.take(self.left.saturating_add(1)).read_to_end(&mut bytes).map_err(missing)?;
        Ok(bytes)
    }
}

/// The data of a `data:` URI, without that prefix.
fn decoded(data: &str) -> Result<Vec<u8>, String> {
    let Some((kind, data)) = data.split_once(',') else {
        return Err("a data: URI without a comma".to_owned());
    };
    if kind.ends_with(";base64") {
        base64::decode(data).map_err(|error| format!("a data: URI that is not base64: {error}"))
    } else {
        Ok(urlencoding::decode_binary(data.as_bytes()).into_owned())
    }
}
