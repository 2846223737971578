//! A cube chain as a file in memory, and the checks common to all containers.

use crate::common::error::{Result, wrong};
use crate::files::format::Pixel;
use crate::light::chain::{Chain, Level};

/// A file in memory.
#[derive(Clone, Debug)]
pub struct CubeFile {
    /// Its content.
    pub bytes: Vec<u8>,
    /// Number of texels with a channel clamped to the pixel format's maximum, per level.
    pub clamped: Vec<u64>,
}

impl CubeFile {
    /// A file of `levels` in `pixel`.
    pub(in crate::files) fn new(bytes: Vec<u8>, levels: &[Level], pixel: Pixel) -> Self {
        let clamped = levels.iter().map(|level| pixel.clamped(&level.texels)).collect();
        Self { bytes, clamped }
    }

    /// A file without texels that are counted.
    pub(in crate::files) const fn plain(bytes: Vec<u8>) -> Self {
        Self { bytes, clamped: Vec::new() }
    }
}

/// Checks that a file of `format` can hold `chain`: sizes halve and faces are complete. Returns the edge of
/// level 0.
pub(super) fn check_sizes(format: &str, chain: &Chain) -> Result<u32> {
    let Some(first) = chain.levels.first() else {
        return wrong(format!("a {format} file needs at least one level"));
    };
    let most = first.size().checked_ilog2().map_or(0, |log2| log2 as usize + 1);
    if chain.levels.len() > most {
        return wrong(format!(
            "{} levels are more than the {most} that {format} allows a cube of {}",
            chain.levels.len(),
            first.size()
        ));
    }
    for (index, level) in chain.levels.iter().enumerate() {
        let size = first.size() >> index;
        if level.size() != size || level.texels.len() != 6 * size as usize * size as usize {
            return wrong(format!(
                "level {index} of a {format} cube of {} must have 6 faces of {size}, not {} texels in faces \
                 of {}",
                first.size(),
                level.texels.len(),
                level.size()
            ));
        }
    }
    Ok(first.size())
}
