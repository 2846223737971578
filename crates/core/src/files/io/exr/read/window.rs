//! Data and display windows of an EXR file.

use crate::common::error::Result;
use crate::files::io::picture::Source;
use ::exr::error::Error as ExrError;
use ::exr::meta::attribute::IntegerBounds;
use ::exr::meta::header::Header;

pub(super) fn exr_error(source: &Source<'_>, error: &ExrError) -> crate::common::error::Error {
    match error {
        ExrError::NotSupported(what) if what.contains("subsampling") => source
            .error("it has subsampled channels (luminance-chroma), which cannot be read; convert it to RGB"),
        ExrError::NotSupported(what) => source.error(format!("OpenEXR feature not supported: {what}")),
        other => source.decoder_error("OpenEXR", other),
    }
}

/// The display window, and the position of the data window in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) width: u32,
    pub(super) height: u32,
    /// The data window's top left corner, in pixels of the display window.
    pub(super) data_x: i64,
    pub(super) data_y: i64,
    pub(super) data_width: usize,
    pub(super) data_height: usize,
}

impl Window {
    /// The part `display` of the image: its display window, or its whole data window.
    pub(super) fn new(source: &Source<'_>, header: &Header, display: IntegerBounds) -> Result<Self> {
        let data = header.own_attributes.layer_position;
        let too_large = |_| source.error("its data or display window is larger than 32 bits can count");
        let window = Self {
            width: u32::try_from(display.size.x()).map_err(too_large)?,
            height: u32::try_from(display.size.y()).map_err(too_large)?,
            data_x: i64::from(data.x()) - i64::from(display.position.x()),
            data_y: i64::from(data.y()) - i64::from(display.position.y()),
            data_width: header.layer_size.x(),
            data_height: header.layer_size.y(),
        };
        let columns = overlap(window.data_x, window.data_width, window.width);
        let overlaps = columns.is_some() && window.visible_rows().is_some();
        if !overlaps && window.width > 0 && window.height > 0 {
            return Err(source.error(format!(
                "its {}x{} data window at ({}, {}) lies outside the {}x{} display window",
                window.data_width,
                window.data_height,
                window.data_x,
                window.data_y,
                window.width,
                window.height
            )));
        }
        Ok(window)
    }

    /// The rows of the display window that have data.
    pub(super) fn visible_rows(&self) -> Option<std::ops::Range<usize>> {
        overlap(self.data_y, self.data_height, self.height)
    }

    pub(super) fn warning(&self) -> Option<String> {
        let same = (self.data_x, self.data_y) == (0, 0)
            && (self.data_width, self.data_height) == (self.width as usize, self.height as usize);
        (!same).then(|| {
            format!(
                "its {}x{} data window at ({}, {}) was cropped to the {}x{} display window, the rest is \
                 black",
                self.data_width, self.data_height, self.data_x, self.data_y, self.width, self.height
            )
        })
    }
}

/// Intersection of 0..`shown` with `length` from `start`.
pub(super) fn overlap(start: i64, length: usize, shown: u32) -> Option<std::ops::Range<usize>> {
    let end = start.saturating_add(i64::try_from(length).ok()?).min(i64::from(shown));
    let start = start.max(0);
    (start < end)
        .then(|| usize::try_from(start).ok().zip(usize::try_from(end).ok()))
        .flatten()
        .map(|(a, b)| a..b)
}
