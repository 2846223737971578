//! Compares BC6H encoders on baked levels: PSNR in decibels of log2 radiance, and CPU seconds.
//!
//! `octagloss-consumers-bc6h PROGRAM INPUT...` bakes levels of 64, 32, 16 and 8 texels of every input and
//! prints a Markdown table with one encoder per row.

use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::{env, fs, process};

use block_compression::{BC6HSettings, CompressionVariant, encode::compress_rgba16};
use ctt_compressonator::bc6h as amd;
use ctt_intel_texture_compressor::{RgbaF16Surface, bc6h as intel};
use half::f16;

type Result<T> = std::result::Result<T, Box<dyn Error>>;
type Rgb = [f32; 3];

const FACES: usize = 6;
const SIZES: [usize; 4] = [64, 32, 16, 8];
/// Bytes of a DDS file before its texels: the magic number, the header and its extension for DXGI's formats.
const HEADER: usize = 148;

/// A face of a level, and its blocks as the program wrote them.
struct Face {
    level: usize,
    size: usize,
    texels: Vec<Rgb>,
    blocks: Vec<u8>,
}

/// The faces of `input`, baked once as floats and once as BC6H: a DDS file stores all levels of a face
/// together.
fn faces(program: &str, input: &str, folder: &Path) -> Result<Vec<Face>> {
    let bake = |pixel: &str| -> Result<Vec<u8>> {
        let output = folder.join(format!("{pixel}.dds"));
        let levels = SIZES.len().to_string();
        let size = SIZES[0].to_string();
        let status = Command::new(program)
            .args(["bake", input, "--quiet", "--force", "--format", "dds", "--pixel", pixel])
            .args(["--size", &size, "--levels", &levels, "-o"])
            .arg(&output)
            .status()?;
        if !status.success() {
            return Err(format!("{program} bake {input}: {status}").into());
        }
        Ok(fs::read(output)?[HEADER..].to_vec())
    };
    let (floats, blocks) = (bake("f32")?, bake("bc6h")?);
    let (mut floats, mut blocks) = (&floats[..], &blocks[..]);
    let mut faces = Vec::new();
    for _ in 0..FACES {
        for (level, size) in SIZES.into_iter().enumerate() {
            let (own, rest) =
                floats.split_at_checked(16 * size * size).ok_or("the file of floats is short")?;
            let texels = own.chunks_exact(16).map(|texel| {
                let channel = |c: usize| f32::from_le_bytes(std::array::from_fn(|k| texel[4 * c + k]));
                std::array::from_fn(channel)
            });
            let (own, left) = blocks.split_at_checked(size * size).ok_or("the file of blocks is short")?;
            faces.push(Face { level, size, texels: texels.collect(), blocks: own.to_vec() });
            (floats, blocks) = (rest, left);
        }
    }
    if floats.is_empty() && blocks.is_empty() { Ok(faces) } else { Err("the files are long".into()) }
}

/// Texels as RGBA half floats.
fn halves(texels: &[Rgb]) -> Vec<f16> {
    texels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0].map(f16::from_f32)).collect()
}

fn as_the_program(face: &Face) -> Result<Vec<u8>> {
    let mut blocks = vec![0; face.size * face.size];
    let size = face.size as u32;
    let variant = CompressionVariant::BC6H(BC6HSettings::basic());
    compress_rgba16(variant, &halves(&face.texels), &mut blocks, size, size, 4 * size);
    if blocks == face.blocks { Ok(blocks) } else { Err("the program encodes otherwise".into()) }
}

fn with_intel(settings: &intel::EncodeSettings, face: &Face) -> Vec<u8> {
    let (halves, size) = (halves(&face.texels), face.size as u32);
    let bits: Vec<u16> = halves.iter().map(|half| half.to_bits()).collect();
    let data = bytemuck::cast_slice(&bits);
    intel::compress_blocks(settings, &RgbaF16Surface { width: size, height: size, stride: 8 * size, data })
}

fn with_amd(quality: f32, face: &Face) -> Result<Vec<u8>> {
    let mut options = amd::Options::new()?;
    options.set_quality(quality)?;
    options.set_signed(false)?;
    let bits: Vec<u16> = face.texels.as_flattened().iter().map(|v| f16::from_f32(*v).to_bits()).collect();
    Ok(amd::compress_blocks(&bits, face.size as u32, face.size as u32, &options)?)
}

/// The blocks of a face.
type Encode = fn(&Face) -> Result<Vec<u8>>;

const ENCODERS: [(&str, Encode); 6] = [
    ("octagloss (`block_compression`, basic)", as_the_program),
    ("Intel ISPC, basic", |face| Ok(with_intel(&intel::basic_settings(), face))),
    ("Intel ISPC, very slow", |face| Ok(with_intel(&intel::very_slow_settings(), face))),
    ("AMD Compressonator, quality 0.05", |face| with_amd(0.05, face)),
    ("AMD Compressonator, quality 0.5", |face| with_amd(0.5, face)),
    ("AMD Compressonator, quality 1", |face| with_amd(1.0, face)),
];

fn decoded(size: usize, blocks: &[u8]) -> Vec<Rgb> {
    let across = size / 4;
    let mut texels = vec![[0.0; 3]; size * size];
    for (index, block) in blocks.chunks_exact(16).enumerate() {
        let mut rgb = [0.0_f32; 48];
        bcdec_rs::bc6h_float(block, &mut rgb, 12, false);
        for (at, texel) in rgb.as_chunks::<3>().0.iter().enumerate() {
            texels[(index / across * 4 + at / 4) * size + index % across * 4 + at % 4] = *texel;
        }
    }
    texels
}

/// PSNR in decibels of log2 of every channel; the peak is the level's own range.
fn log_psnr(exact: &[Rgb], stored: &[Rgb]) -> f64 {
    let stops = |texels: &[Rgb]| -> Vec<f64> {
        texels.as_flattened().iter().map(|v| f64::from(v.max(1e-6)).log2()).collect()
    };
    let (exact, stored) = (stops(exact), stops(stored));
    let least = exact.iter().copied().fold(f64::INFINITY, f64::min);
    let most = exact.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let noise = exact.iter().zip(&stored).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / exact.len() as f64;
    10.0 * ((most - least).powi(2) / noise).log10()
}

/// CPU time of this process in seconds, with a resolution of 1/100 (proc(5)).
fn cpu_seconds() -> Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    let after_name = stat.rsplit(')').next().ok_or("no fields")?;
    let ticks = after_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
    Ok(ticks.sum::<std::result::Result<f64, _>>()? / 100.0)
}

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [program, inputs @ ..] = &arguments[..] else {
        return Err("usage: octagloss-consumers-bc6h PROGRAM INPUT...".into());
    };
    let folder = env::temp_dir().join(format!("octagloss-bc6h-{}", process::id()));
    fs::create_dir(&folder)?;
    let baked: Result<Vec<Vec<Face>>> = inputs.iter().map(|input| faces(program, input, &folder)).collect();
    fs::remove_dir_all(&folder)?;
    let baked = baked?;

    let columns = inputs.iter().flat_map(|input| SIZES.map(|size| format!(" `{input}` {size} |")));
    println!("| encoder |{} CPU seconds |", columns.collect::<String>());
    println!("|---|{}---|", "---|".repeat(inputs.len() * SIZES.len()));
    for (name, encode) in ENCODERS {
        let from = cpu_seconds()?;
        let encoded: Vec<Vec<Vec<u8>>> =
            baked.iter().map(|faces| faces.iter().map(encode).collect()).collect::<Result<_>>()?;
        let seconds = cpu_seconds()? - from;
        let mut cells = String::new();
        for (faces, blocks) in baked.iter().zip(&encoded) {
            for level in 0..SIZES.len() {
                let (mut exact, mut stored) = (Vec::new(), Vec::new());
                for (face, blocks) in faces.iter().zip(blocks).filter(|(face, _)| face.level == level) {
                    exact.extend_from_slice(&face.texels);
                    stored.extend(decoded(face.size, blocks));
                }
                cells += &format!(" {:.1} |", log_psnr(&exact, &stored));
            }
        }
        println!("| {name} |{cells} {seconds:.2} |");
    }
    Ok(())
}
