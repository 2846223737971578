//! Scanlines of Radiance pictures: run lengths of each of four planes, or pixels whose repetitions are
//! counted, as before 1991 (Ward, "Real Pixels", Graphics Gems II; Radiance's color.c).
//!
//! Of the crates that read them one fills truncated runs with black, and the other's code for all other
//! pictures took a fifteenth of the program's build.

use crate::common::error::Result;
use crate::files::format::RGBE_MAX;
use crate::files::io::picture::Source;
use crate::light::environment::Rgb;

/// Lengths of scanlines of planes.
const PLANAR: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// The longest run, and the longest stretch without one.
const MAX_RUN: usize = 127;
const MAX_STRETCH: usize = 128;

/// The shortest run that is worth two bytes.
const MIN_RUN: usize = 4;

/// Decodes scanlines of `length` pixels from `data`, the rest of `source`, until `texels` are full.
pub(super) fn decode(source: &Source<'_>, data: &[u8], length: usize, texels: &mut [Rgb]) -> Result<()> {
    let mut rest = Bytes { source, data, line: 0 };
    let mut pixels = vec![[0; 4]; length];
    for (line, texels) in texels.chunks_exact_mut(length).enumerate() {
        rest.line = line;
        rest.scanline(&mut pixels)?;
        texels.iter_mut().zip(&pixels).for_each(|(texel, pixel)| *texel = radiance(*pixel));
    }
    Ok(())
}

/// What of a picture is not decoded yet.
struct Bytes<'a> {
    source: &'a Source<'a>,
    data: &'a [u8],
    /// The scanline that is being decoded.
    line: usize,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let Some((taken, rest)) = self.data.split_at_checked(count) else {
            return Err(self.source.truncated("Radiance HDR"));
        };
        self.data = rest;
        Ok(taken)
    }

    fn pixel(&mut self) -> Result<[u8; 4]> {
        let pixel = self.take(4)?;
        Ok([pixel[0], pixel[1], pixel[2], pixel[3]])
    }

    fn corrupt<T>(&self, what: &str) -> Result<T> {
        Err(self.source.error(format!("corrupt: scanline {} {what}; re-export the file", self.line)))
    }

    fn scanline(&mut self, pixels: &mut [[u8; 4]]) -> Result<()> {
        match self.data {
            [2, 2, high @ 0..128, low, ..] if PLANAR.contains(&pixels.len()) => {
                if usize::from(u16::from_be_bytes([*high, *low])) != pixels.len() {
                    return self.corrupt("has another length than the picture");
                }
                self.take(4)?;
                (0..4).try_for_each(|plane| self.plane(plane, pixels))
            }
            _ => self.repetitions(pixels),
        }
    }

    /// One plane of `pixels`, in runs and stretches without.
    fn plane(&mut self, plane: usize, pixels: &mut [[u8; 4]]) -> Result<()> {
        let mut at = 0;
        while at < pixels.len() {
            let code = usize::from(self.take(1)?[0]);
            let is_run = code > 128;
            let count = if is_run { code - 128 } else { code };
            let Some(places) = pixels.get_mut(at..at + count) else {
                return self.corrupt("has a run beyond its end");
            };
            let values = self.take(if is_run { 1 } else { count })?;
            if is_run {
                places.iter_mut().for_each(|place| place[plane] = values[0]);
            } else {
                places.iter_mut().zip(values).for_each(|(place, value)| place[plane] = *value);
            }
            at += count;
        }
        Ok(())
    }

    /// `pixels` one by one; the pixel (1, 1, 1, n) repeats the one before n times, and those that follow it
    /// count in units of 256, 65536, ...
    fn repetitions(&mut self, pixels: &mut [[u8; 4]]) -> Result<()> {
        let (mut at, mut unit) = (0, 1_usize);
        while at < pixels.len() {
            let pixel = self.pixel()?;
            if let [1, 1, 1, count] = pixel {
                let count = usize::from(count).saturating_mul(unit);
                let last = at.checked_sub(1).map(|last| pixels[last]);
                let (Some(last), Some(places)) = (last, pixels.get_mut(at..at.saturating_add(count))) else {
                    return self.corrupt("repeats a pixel beyond its ends");
                };
                places.fill(last);
                at += count;
                unit = unit.saturating_mul(256);
            } else {
                pixels[at] = pixel;
                at += 1;
                unit = 1;
            }
        }
        Ok(())
    }
}

fn radiance([red, green, blue, exponent]: [u8; 4]) -> Rgb {
    if exponent == 0 {
        return [0.0; 3];
    }
    // 2 to the power of the exponent less 136: a bias of 128, and eight bits of mantissa.
    let quantum = f64::from_bits((1023 - 136 + u64::from(exponent)) << 52);
    [red, green, blue].map(|value| (f64::from(value) * quantum) as f32)
}

/// Appends scanlines of `length` of the `texels`, each the nearest colour.
pub(super) fn encode(length: usize, texels: &[Rgb], bytes: &mut Vec<u8>) {
    for texels in texels.chunks_exact(length) {
        let pixels: Vec<[u8; 4]> = texels.iter().copied().map(nearest).collect();
        if !PLANAR.contains(&length) {
            bytes.extend(pixels.as_flattened());
            continue;
        }
        bytes.extend([2, 2]);
        bytes.extend((length as u16).to_be_bytes());
        for plane in 0..4 {
            let values: Vec<u8> = pixels.iter().map(|pixel| pixel[plane]).collect();
            push_runs(&values, bytes);
        }
    }
}

/// Appends `values` in runs and stretches without.
fn push_runs(values: &[u8], bytes: &mut Vec<u8>) {
    let mut stretch = 0;
    let flush = |range: std::ops::Range<usize>, bytes: &mut Vec<u8>| {
        for part in values[range].chunks(MAX_STRETCH) {
            bytes.push(part.len() as u8);
            bytes.extend(part);
        }
    };
    let mut at = 0;
    while at < values.len() {
        let run = values[at..].iter().take(MAX_RUN).take_while(|value| **value == values[at]).count();
        if run >= MIN_RUN {
            flush(stretch..at, bytes);
            bytes.extend([128 + run as u8, values[at]]);
            stretch = at + run;
        }
        at += run;
    }
    flush(stretch..at, bytes);
}

/// The nearest colour to `rgb`; truncation would darken by 0.25 % on average.
fn nearest(rgb: Rgb) -> [u8; 4] {
    let clamped = rgb.map(|c| f64::from(c.clamp(0.0, RGBE_MAX)));
    let greatest = clamped[0].max(clamped[1]).max(clamped[2]);
    if greatest < f64::from(f32::MIN_POSITIVE) {
        return [0; 4];
    }
    let rounded = |exponent: i32| clamped.map(|c| (c / f64::from(exponent - 8).exp2()).round());
    let mut exponent = ((greatest as f32).to_bits() >> 23) as i32 - 126;
    let mut values = rounded(exponent);
    // The maximum may round up to the next power of two, where the quantum doubles.
    if values.iter().any(|value| *value > 255.0) {
        exponent += 1;
        values = rounded(exponent);
    }
    let [red, green, blue] = values.map(|value| value as u8);
    [red, green, blue, (exponent + 128) as u8]
}
