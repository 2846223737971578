//! Radiance pictures (.hdr, .pic): in any orientation, of RGBE or XYZE, read; of RGBE, any radiance up to
//! 2^127, written.

mod scanlines;

use crate::common::error::{Result, wrong};
use crate::files::io::color::{self, Primaries};
use crate::files::io::key_values::value_of;
use crate::files::io::ktx2::write::ROUGHNESS_KEY;
use crate::files::io::map_header::MapHeader;
use crate::files::io::picture::{LevelHeader, Picture, Source, TEXEL_BYTES};
use crate::files::io::provenance::KEY_PREFIX;
use crate::light::environment::Rgb;

/// Content of a header.
struct Header<'a> {
    is_xyze: bool,
    /// Stored value over radiance, per channel: EXPOSURE times COLORCORR.
    exposure: [f64; 3],
    primaries: Option<Primaries>,
    /// A bake's key/value pairs.
    pairs: Vec<(String, String)>,
    scan: PixelOrder,
    /// Scanlines.
    data: &'a [u8],
}

/// Columns, rows and roughness of an image of a bake's level; `None` if its header has no roughness.
pub(super) fn level_header(source: &Source<'_>) -> Result<LevelHeader> {
    let header = read_header(source)?;
    let (width, height) = header.scan.sides();
    let roughness = value_of(&header.pairs, ROUGHNESS_KEY).and_then(|text| text.parse().ok());
    let roughness = roughness.filter(|roughness| (0.0..=1.0).contains(roughness));
    Ok(LevelHeader { width, height, roughness })
}

/// Pixel order: `lines` scanlines of `length` pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PixelOrder {
    lines: u32,
    length: u32,
    /// Scanlines are columns.
    by_columns: bool,
    /// The file starts at the right.
    from_right: bool,
    /// The file starts at the bottom.
    from_bottom: bool,
}

/// Decodes a Radiance picture.
pub(super) fn decode(source: &Source<'_>) -> Result<Picture> {
    let header = read_header(source)?;
    let scan = header.scan;
    let (width, height) = scan.sides();
    // A reordered copy is needed if the file's pixel order differs.
    let copies = if scan.is_plain() { 1 } else { 2 };
    source.check_memory(width, height, copies * TEXEL_BYTES)?;
    // A scanline takes at least one run of the old encoding; this rejects invalid headers before allocation.
    if u64::from(scan.lines) * 4 > header.data.len() as u64 {
        return Err(source.error(format!(
            "truncated: {} bytes cannot hold the {} scanlines of its header; copy it again",
            header.data.len(),
            scan.lines
        )));
    }

    let mut scanned = vec![Rgb::default(); width as usize * height as usize];
    scanlines::decode(source, header.data, scan.length as usize, &mut scanned)?;
    let mut texels = if scan.is_plain() { scanned } else { scan.upright(&scanned) };

    let mut warnings = Vec::new();
    let mut format = if header.is_xyze { "Radiance XYZE" } else { "Radiance RGBE" }.to_owned();
    if header.exposure != [1.0; 3] {
        let scale = header.exposure.map(|exposure| (1.0 / exposure) as f32);
        for texel in &mut texels {
            *texel = [texel[0] * scale[0], texel[1] * scale[1], texel[2] * scale[2]];
        }
        format += ", exposure divided out";
    }
    if header.is_xyze {
        color::transform(&mut texels, color::rec709_from_equal_energy_xyz());
    } else if let Some(primaries) = header.primaries {
        warnings.extend(primaries.converted("PRIMARIES", &mut texels));
    }
    let provenance = source.provenance(&header.pairs)?;
    let map = MapHeader::of_pairs(source, &header.pairs)?;
    Ok(Picture { width, height, texels, map, format, warnings, provenance, ..Picture::default() })
}

impl PixelOrder {
    const fn is_plain(self) -> bool {
        !(self.by_columns || self.from_right || self.from_bottom)
    }

    /// Columns and rows.
    const fn sides(self) -> (u32, u32) {
        if self.by_columns { (self.lines, self.length) } else { (self.length, self.lines) }
    }

    /// The pixels row by row from the top left.
    fn upright(self, scanned: &[Rgb]) -> Vec<Rgb> {
        let (lines, length) = (self.lines as usize, self.length as usize);
        let (width, height) = if self.by_columns { (lines, length) } else { (length, lines) };
        let mut texels = Vec::with_capacity(scanned.len());
        for y in 0..height {
            let down = if self.from_bottom { height - 1 - y } else { y };
            texels.extend((0..width).map(|x| {
                let across = if self.from_right { width - 1 - x } else { x };
                let (line, at) = if self.by_columns { (across, down) } else { (down, across) };
                scanned[line * length + at]
            }));
        }
        texels
    }
}

/// Reads up to the resolution line.
fn read_header<'a>(source: &Source<'a>) -> Result<Header<'a>> {
    let mut rest = source.bytes;
    let mut next_line = || -> Result<String> {
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
            return Err(source.error("truncated: the Radiance header does not end; copy it again"));
        };
        let line = String::from_utf8_lossy(&rest[..end]).trim_end_matches('\r').to_owned();
        rest = &rest[end + 1..];
        Ok(line)
    };
    let mut is_xyze = false;
    let mut exposure = [1.0; 3];
    let mut primaries = None;
    let mut pairs = Vec::new();
    // Skip the signature.
    next_line()?;
    loop {
        let line = next_line()?;
        if line.is_empty() {
            break;
        }
        let Some((key, value)) = line.split_once('=').filter(|_| !line.starts_with('#')) else { continue };
        let numbers =
            || -> Option<Vec<f64>> { value.split_whitespace().map(|word| word.parse().ok()).collect() };
        match key.trim() {
            "FORMAT" => match value.trim() {
                "32-bit_rle_rgbe" => {}
                "32-bit_rle_xyze" => is_xyze = true,
                other => {
                    let other: String = other.chars().take(40).collect();
                    return Err(source.error(format!(
                        "FORMAT={other} is not supported; 32-bit_rle_rgbe and 32-bit_rle_xyze are"
                    )));
                }
            },
            "EXPOSURE" => match numbers().as_deref() {
                Some(&[factor]) => exposure = exposure.map(|product| product * factor),
                _ => return Err(not_positive(source, &line)),
            },
            "COLORCORR" => match numbers().as_deref() {
                Some(&[r, g, b]) => exposure = [exposure[0] * r, exposure[1] * g, exposure[2] * b],
                _ => return Err(not_positive(source, &line)),
            },
            "PRIMARIES" => match numbers().as_deref() {
                Some(&[rx, ry, gx, gy, bx, by, wx, wy]) => {
                    primaries = Some(Primaries([[rx, ry], [gx, gy], [bx, by], [wx, wy]]));
                }
                _ => return Err(source.error("PRIMARIES needs eight numbers")),
            },
            key if key.starts_with(KEY_PREFIX) => pairs.push((key.to_owned(), value.trim().to_owned())),
            _ => {}
        }
        if !exposure.iter().all(|factor| factor.is_finite() && *factor > 0.0) {
            return Err(not_positive(source, &line));
        }
    }
    let resolution = next_line()?;
    let scan = parse_resolution(&resolution).ok_or_else(|| {
        let line: String = resolution.chars().take(40).collect();
        let is_huge = |word: &str| word.parse::<u128>().is_ok() && word.parse::<u32>().is_err();
        if resolution.split_whitespace().any(is_huge) {
            return source.error(format!("the resolution line \"{line}\" has more pixels than can be read"));
        }
        source.error(format!("the resolution line \"{line}\" is not like \"-Y 256 +X 512\""))
    })?;
    Ok(Header { is_xyze, exposure, primaries, pairs, scan, data: rest })
}

fn not_positive(source: &Source<'_>, line: &str) -> crate::common::error::Error {
    let line: String = line.chars().take(60).collect();
    source.error(format!("the header line {line} does not give positive numbers; fix or remove it"))
}

/// Parses `-Y 256 +X 512` and the seven other orientations; the first axis runs from scanline to scanline.
fn parse_resolution(line: &str) -> Option<PixelOrder> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [first, lines, second, length] = words[..] else { return None };
    let (by_columns, x, y) = match (first, second) {
        ("-Y" | "+Y", "-X" | "+X") => (false, second, first),
        ("-X" | "+X", "-Y" | "+Y") => (true, first, second),
        _ => return None,
    };
    Some(PixelOrder {
        lines: lines.parse().ok()?,
        length: length.parse().ok()?,
        by_columns,
        from_right: x == "-X",
        from_bottom: y == "+Y",
    })
}

/// Encodes a .hdr file of `width` x `height` row-major texels, with a header line `KEY=value` for each pair
/// of `metadata`.
///
/// # Errors
/// [`crate::common::error::Error::Parameter`] if the texels do not fill the image, and for keys and values
/// that a header line cannot hold.
pub fn hdr_bytes(width: u32, height: u32, texels: &[Rgb], metadata: &[(String, String)]) -> Result<Vec<u8>> {
    let breaks = |text: &str| text.contains(char::is_control);
    if let Some((key, _)) =
        metadata.iter().find(|(key, value)| breaks(key) || breaks(value) || key.contains('='))
    {
        return wrong(format!("{key:?} and its value cannot be a line of a .hdr header"));
    }
    if texels.is_empty() || texels.len() != width as usize * height as usize {
        return wrong(format!("a .hdr file of {width}x{height} cannot hold {} texels", texels.len()));
    }
    let lines: String = metadata.iter().map(|(key, value)| format!("{key}={value}\n")).collect();
    let header = format!("#?RADIANCE\n{lines}FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    let mut bytes = Vec::with_capacity(header.len() + texels.len() * 4);
    bytes.extend(header.into_bytes());
    scanlines::encode(width as usize, texels, &mut bytes);
    Ok(bytes)
}
