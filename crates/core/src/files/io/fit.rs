//! Crops and pads panoramas that are not 2:1.
//!
//! A panorama covers the whole sphere, so it must be 2:1. Pictures of 360 x 120 degrees, of half the sphere
//! or letterboxed ones are not.

use super::ReadOptions;
use super::layout::InputLayout;
use super::pad::Pad;
use super::picture::{Picture, TEXEL_BYTES, limit};
use crate::common::error::{Error, Result, wrong};
use crate::light::environment::Rgb;
use std::path::Path;

/// Maximum black value in a JPEG, 4 of 255; black bars in JPEG are rarely 0.
const JPEG_BLACK: f32 = 4.0 / 255.0 / 12.92;

/// Tolerance in texels of the 2:1 shape and of the difference between opposite bars.
const TOLERANCE: u32 = 2;

/// Two opposite bars of an image: top and bottom, or left and right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Bars {
    first: u32,
    last: u32,
}

impl Bars {
    const fn both(self) -> u32 {
        self.first + self.last
    }

    /// Takes `count` of these lines as evenly as possible from both sides; all if there are fewer.
    fn taking(self, count: u32) -> Self {
        let count = count.min(self.both());
        let first = (count / 2).clamp(count.saturating_sub(self.last), self.first);
        Self { first, last: count - first }
    }

    fn words(self, lines: &str, [before, after]: [&str; 2]) -> Option<String> {
        let Self { first, last } = self;
        match (first, last) {
            (0, 0) => None,
            (_, 0) => Some(format!("{first} {lines} {before}")),
            (0, _) => Some(format!("{last} {lines} {after}")),
            _ if first == last => Some(format!("{first} {lines} {before} and {after}")),
            _ => Some(format!("{first} {lines} {before} and {last} {after}")),
        }
    }
}

/// Such as `12 black rows above and below, 1 black columns left`; empty if there are none.
fn words(colour: &str, rows: Bars, columns: Bars) -> String {
    let rows = rows.words(&format!("{colour} rows"), ["above", "below"]);
    let columns = columns.words(&format!("{colour} columns"), ["left", "right"]);
    rows.into_iter().chain(columns).collect::<Vec<_>>().join(", ")
}

/// Crops and pads `picture` according to `options`, adds warnings about it, and returns its layout: `layout`,
/// or a panorama if that is automatic.
pub(super) fn fit(
    path: &Path,
    picture: &mut Picture,
    mut layout: InputLayout,
    options: &ReadOptions,
) -> Result<InputLayout> {
    // Cubes have no bars.
    if picture.is_cube || !(options.crop || options.pad.is_some()) {
        return Ok(layout);
    }
    if !matches!(layout, InputLayout::Auto | InputLayout::Equirect) {
        let Some(header) = &picture.map else {
            return wrong("`pad` and `crop` are for panoramas; omit `layout`");
        };
        let map = header.map.name;
        let message = format!(
            "`pad` and `crop` are for panoramas, and its header says that its map is {map}; omit them"
        );
        return Err(Error::input(path, message));
    }
    if options.crop && crop(picture) {
        layout = InputLayout::Equirect;
    }
    if let Some(pad) = options.pad {
        layout = InputLayout::Equirect;
        filled(path, picture, pad, options.memory_limit)?;
    }
    Ok(layout)
}

/// Removes black bars as far as needed for 2:1; returns whether there were any.
fn crop(picture: &mut Picture) -> bool {
    let (width, height) = (picture.width, picture.height);
    let (rows, columns) = bars(picture);
    let (inner_width, inner_height) = (width - columns.both(), height - rows.both());
    let is_even = |bars: Bars| bars.first.abs_diff(bars.last) <= TOLERANCE;
    let (rows, columns) = if is_even(rows)
        && is_even(columns)
        && rows.both() > 0
        && columns.both() > 0
        && inner_width >= width / 2
        && inner_width.abs_diff(inner_height.saturating_mul(2)) <= TOLERANCE
    {
        // A frame around a 2:1 picture; one line more or less gives the exact shape. A smaller picture is a
        // lamp in a dark room.
        let inner_height = inner_height.min(inner_width / 2);
        (rows.taking_or_more(height - inner_height), columns.taking_or_more(width - 2 * inner_height))
    } else {
        // Remove only the excess: ground and sky may also be black.
        let over = (height.saturating_sub(width / 2), width.saturating_sub(height.saturating_mul(2)));
        (rows.taking(over.0), columns.taking(over.1))
    };
    let said = words("black", rows, columns);
    if said.is_empty() {
        return false;
    }
    picture.warnings.push(format!("cropped {said}"));
    let columns = columns.first as usize..(width - columns.last) as usize;
    let lines = picture.texels.chunks_exact(width as usize);
    let lines = lines.skip(rows.first as usize).take((height - rows.both()) as usize);
    picture.texels = lines.flat_map(|line| &line[columns.clone()]).copied().collect();
    picture.width = columns.len() as u32;
    picture.height = height - rows.both();
    true
}

impl Bars {
    /// Like [`Self::taking`], but extends beyond the bars by a texel or two if `count` is larger.
    fn taking_or_more(self, count: u32) -> Self {
        let more = count.saturating_sub(self.both());
        Self { first: self.first, last: self.last + more }.taking(count)
    }
}

/// Black rows at top and bottom, and black columns at left and right; none if the whole image is black.
fn bars(picture: &Picture) -> (Bars, Bars) {
    let black = if picture.format.starts_with("JPEG") { JPEG_BLACK } else { 0.0 };
    // NaN is not black.
    let is_lit = |texel: &Rgb| texel.iter().any(|c| c.is_nan() || *c > black);
    let width = picture.width as usize;
    let (mut left, mut right) = (width, 0);
    let mut lit_rows: Option<(u32, u32)> = None;
    for (line, y) in picture.texels.chunks_exact(width).zip(0..) {
        let Some(first) = line.iter().position(is_lit) else { continue };
        let last = line.iter().rposition(is_lit).unwrap_or(first);
        (left, right) = (left.min(first), right.max(last));
        lit_rows = Some((lit_rows.map_or(y, |(top, _)| top), y));
    }
    let Some((top, bottom)) = lit_rows else { return Default::default() };
    let columns = Bars { first: left as u32, last: (width - 1 - right) as u32 };
    (Bars { first: top, last: picture.height - 1 - bottom }, columns)
}

/// Centres `picture` in the smallest 2:1 panorama that holds it.
fn filled(path: &Path, picture: &mut Picture, pad: Pad, memory_limit: u64) -> Result<()> {
    let (width, height) = (u64::from(picture.width), u64::from(picture.height));
    let rows = height.max(width.div_ceil(2));
    let columns = 2 * rows;
    if (columns, rows) == (width, height) {
        return Ok(());
    }
    let bytes = rows.saturating_mul(columns).saturating_add(width * height).saturating_mul(TEXEL_BYTES);
    let sides = u32::try_from(columns).ok().zip(u32::try_from(rows).ok());
    let Some((columns, rows)) = sides.filter(|_| bytes <= memory_limit) else {
        let what = format!("{width}x{height} padded to {columns}x{rows} pixels");
        return Err(limit(path, &what, bytes, memory_limit));
    };
    let around = |all: u32, own: u32| Bars { first: (all - own) / 2, last: all - own - (all - own) / 2 };
    let (above, at_sides) = (around(rows, picture.height), around(columns, picture.width));
    let width = picture.width as usize;
    let wide = |line: &[Rgb]| -> Vec<Rgb> {
        let ends = match pad {
            Pad::Black => [[0.0; 3]; 2],
            Pad::Edge => [line[0], line[width - 1]],
        };
        let mut wide = vec![ends[0]; at_sides.first as usize];
        wide.extend_from_slice(line);
        wide.resize(columns as usize, ends[1]);
        wide
    };
    let mut texels = Vec::with_capacity(columns as usize * rows as usize);
    let lines: Vec<&[Rgb]> = picture.texels.chunks_exact(width).collect();
    let rim = |line: &[Rgb], count: u32, texels: &mut Vec<Rgb>| {
        let line = match pad {
            Pad::Black => vec![[0.0; 3]; columns as usize],
            Pad::Edge => wide(line),
        };
        (0..count).for_each(|_| texels.extend_from_slice(&line));
    };
    rim(lines[0], above.first, &mut texels);
    lines.iter().for_each(|line| texels.extend(wide(line)));
    rim(lines[lines.len() - 1], above.last, &mut texels);
    picture.texels = texels;
    (picture.width, picture.height) = (columns, rows);
    picture.warnings.push(format!("padded with {}", words(pad.name(), above, at_sides)));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::io::provenance::Provenance;

    fn picture(width: u32, height: u32, radiance: impl Fn(u32, u32) -> f32) -> Picture {
        let texels = (0..width * height).map(|k| [radiance(k % width, k / width); 3]).collect();
        Picture {
            width,
            height,
            texels,
            is_cube: false,
            map: None,
            format: "test".to_owned(),
            warnings: Vec::new(),
            provenance: Provenance::default(),
        }
    }

    fn cropped(mut picture: Picture) -> (u32, u32, String) {
        crop(&mut picture);
        assert_eq!(picture.texels.len() as u32, picture.width * picture.height, "as many as are said");
        (picture.width, picture.height, picture.warnings.join("; "))
    }

    fn padded(mut picture: Picture, pad: Pad) -> (u32, u32, String, Vec<f32>) {
        filled(Path::new("a"), &mut picture, pad, 1 << 20).expect("small");
        assert_eq!(picture.texels.len() as u32, picture.width * picture.height, "as many as are said");
        let first_column = picture.texels.iter().step_by(picture.width as usize).map(|texel| texel[0]);
        (picture.width, picture.height, picture.warnings.join("; "), first_column.collect())
    }

    #[test]
    fn bars_above_and_below_go_as_far_as_two_to_one() {
        let letterbox = picture(16, 12, |_, y| if (2..10).contains(&y) { 1.0 } else { 0.0 });
        assert_eq!(cropped(letterbox), (16, 8, "cropped 2 black rows above and below".to_owned()));
        // A black ground is not a bar.
        let ground = picture(16, 12, |_, y| if (2..6).contains(&y) { 1.0 } else { 0.0 });
        assert_eq!(cropped(ground), (16, 8, "cropped 2 black rows above and below".to_owned()));
        let uneven = picture(16, 12, |_, y| if (1..9).contains(&y) { 1.0 } else { 0.0 });
        assert_eq!(cropped(uneven), (16, 8, "cropped 1 black rows above and 3 below".to_owned()));
        let all_below = picture(16, 12, |_, y| if y < 8 { 1.0 } else { 0.0 });
        assert_eq!(cropped(all_below), (16, 8, "cropped 4 black rows below".to_owned()));
        let too_few = picture(16, 12, |_, y| if y > 0 { 1.0 } else { 0.0 });
        assert_eq!(cropped(too_few), (16, 11, "cropped 1 black rows above".to_owned()));
    }

    #[test]
    fn columns_and_frames_go_and_black_pictures_stay() {
        let pillars = picture(24, 8, |x, _| if (4..20).contains(&x) { 1.0 } else { 0.0 });
        assert_eq!(cropped(pillars), (16, 8, "cropped 4 black columns left and right".to_owned()));
        let inside = |x: u32, y: u32| (4..20).contains(&x) && (2..10).contains(&y);
        let frame = picture(24, 12, |x, y| if inside(x, y) { 1.0 } else { 0.0 });
        let words = "cropped 2 black rows above and below, 4 black columns left and right";
        assert_eq!(cropped(frame), (16, 8, words.to_owned()));
        // A lamp in a dark room, 2:1 already.
        let lamp = picture(16, 8, |x, y| if (x, y) == (8, 3) { 1.0 } else { 0.0 });
        assert_eq!(cropped(lamp), (16, 8, String::new()));
        assert_eq!(cropped(picture(16, 12, |_, _| 0.0)), (16, 12, String::new()));
        assert_eq!(cropped(picture(16, 12, |_, _| 1.0)), (16, 12, String::new()));
        let nan = picture(4, 4, |_, y| if y == 0 { f32::NAN } else { 0.0 });
        assert_eq!(cropped(nan), (4, 2, "cropped 2 black rows below".to_owned()));
    }

    #[test]
    fn panoramas_are_centred_in_two_to_one() {
        let band = || picture(8, 2, |_, y| y as f32 + 1.0);
        let (width, height, words, column) = padded(band(), Pad::Black);
        assert_eq!((width, height, &words[..]), (8, 4, "padded with 1 black rows above and below"));
        assert_eq!(column, [0.0, 1.0, 2.0, 0.0]);
        assert_eq!(padded(band(), Pad::Edge).3, [1.0, 1.0, 2.0, 2.0]);
        let half = padded(picture(4, 4, |x, _| x as f32 + 1.0), Pad::Edge);
        assert_eq!((half.0, half.1, &half.2[..]), (8, 4, "padded with 2 edge columns left and right"));
        assert_eq!(half.3, [1.0; 4]);
        // An odd width gets one more column.
        assert_eq!(padded(picture(7, 4, |_, _| 1.0), Pad::Black).2, "padded with 1 black columns right");
        assert_eq!(padded(picture(1, 1, |_, _| 1.0), Pad::Black).2, "padded with 1 black columns right");
        assert_eq!(padded(picture(8, 4, |_, _| 1.0), Pad::Black).2, "");
    }

    #[test]
    fn what_would_take_too_much_memory_is_refused() {
        let mut tall = picture(1, 400, |_, _| 1.0);
        let error = filled(Path::new("a"), &mut tall, Pad::Black, 1 << 20).expect_err("3.8 MB");
        assert!(matches!(error, Error::Limit { .. }), "{error}");
    }
}
