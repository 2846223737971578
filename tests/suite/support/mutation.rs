//! Mutated inputs for every reader: seeds of at most 32x16 texels, damaged at random.

use super::inputs::{self, Ktx2Pixel, Sample};
use cpu_time::ProcessTime;
use exr::prelude::{AnyChannel, Blocks, Compression, Image, Vec2};
use octagloss::internals::chain::{Chain, Level};
use octagloss::internals::format::Pixel;
use octagloss::internals::io::ktx1::write::ktx1_bytes;
use octagloss::internals::io::{self, ReadOptions, npy};
use peakmem_alloc::{PeakMemAlloc, PeakMemAllocTrait as _};
use std::alloc::System;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::time::Duration;

/// Memory limit of the readers during fuzzing.
pub(crate) const MEMORY_LIMIT: u64 = 64 << 20;
/// Peak allocation allowed for a reader: its limit and the fixed tables of decoders.
pub(crate) const PEAK_LIMIT: usize = MEMORY_LIMIT as usize + (8 << 20);
/// CPU time limit of one read, independent of other programs.
pub(crate) const TIME_LIMIT: Duration = Duration::from_secs(2);

/// Reads the bytes; returns whether that succeeds.
type Read = Box<dyn Fn(&[u8]) -> bool>;

/// A reader and its seed files.
pub(crate) struct Reader {
    pub(crate) name: &'static str,
    seeds: Vec<Vec<u8>>,
    read: Read,
}

/// Results of a reader's inputs.
#[derive(Debug)]
pub(crate) struct Tally {
    pub(crate) mutations: u32,
    pub(crate) errors: u32,
    pub(crate) reads: u32,
    pub(crate) panics: u32,
    pub(crate) slowest: Duration,
    pub(crate) peak_bytes: usize,
}

impl Tally {
    /// Whether no panic escaped and no limit was exceeded.
    pub(crate) fn holds(&self) -> bool {
        self.panics == 0 && self.slowest <= TIME_LIMIT && self.peak_bytes <= PEAK_LIMIT
    }
}

/// Tries `reader` on `count` mutated seeds.
pub(crate) fn fuzz(reader: &Reader, count: u32, memory: &PeakMemAlloc<System>) -> Tally {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut tally =
        Tally { mutations: 0, errors: 0, reads: 0, panics: 0, slowest: Duration::ZERO, peak_bytes: 0 };
    for seed in &reader.seeds {
        assert!((reader.read)(seed), "a seed of {} must be readable before it is damaged", reader.name);
    }
    for _ in 0..count {
        let bytes = mutated(&reader.seeds, &mut random);
        memory.reset_peak_memory();
        let start = ProcessTime::now();
        let outcome = panic::catch_unwind(AssertUnwindSafe(|| (reader.read)(&bytes)));
        tally.slowest = tally.slowest.max(start.elapsed());
        tally.peak_bytes = tally.peak_bytes.max(memory.get_peak_memory());
        tally.mutations += 1;
        match outcome {
            Ok(true) => tally.reads += 1,
            Ok(false) => tally.errors += 1,
            Err(_) => tally.panics += 1,
        }
    }
    tally
}

/// xorshift64*: the same inputs on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() >> 33) as usize % bound.max(1)
    }
}

/// A seed with one to four mutations.
fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            break;
        }
        // Half of them in the header, which contains the sizes.
        let reach = if random.below(2) == 0 { bytes.len().min(400) } else { bytes.len() };
        let at = random.below(reach);
        match random.below(7) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = random.next() as u8,
            2 => bytes[at] = [0x00, 0x01, 0x7f, 0x80, 0xff, b'9', b'-'][random.below(7)],
            3 => bytes.truncate(at),
            4 => {
                let donor = &seeds[random.below(seeds.len())];
                let from = random.below(donor.len());
                let piece = &donor[from..(from + random.below(64)).min(donor.len())];
                let end = if random.below(2) == 0 { at } else { (at + piece.len()).min(bytes.len()) };
                bytes.splice(at..end, piece.iter().copied());
            }
            5 => {
                let value =
                    [0, 1, u64::MAX, 1 << 31, (1 << 31) - 1, 1 << 16, 1 << 40, 1 << 62][random.below(8)];
                write_integer(&mut bytes[at..], value, random);
            }
            _ => {
                let mut low = [0; 4];
                let length = bytes[at..].len().min(4);
                low[..length].copy_from_slice(&bytes[at..at + length]);
                let near = u32::from_le_bytes(low).wrapping_add((random.next() % 33) as u32).wrapping_sub(16);
                write_integer(&mut bytes[at..], near.into(), random);
            }
        }
    }
    // Correct the checksums, so that the damage reaches the decoder.
    if random.below(4) > 0 && bytes.starts_with(b"\x89PNG") {
        mend_png_checksums(&mut bytes);
    }
    bytes
}

/// Corrects the checksum of every complete chunk of a PNG.
fn mend_png_checksums(bytes: &mut [u8]) {
    let crc32 = |bytes: &[u8]| {
        !bytes.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
        })
    };
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let end = at + 8 + length;
        if end + 4 > bytes.len() {
            return;
        }
        let crc = crc32(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&crc.to_be_bytes());
        at = end + 4;
    }
}

/// Overwrites one, two, four or eight bytes, little or big endian.
fn write_integer(bytes: &mut [u8], value: u64, random: &mut Random) {
    let width = (1 << random.below(4)).min(bytes.len());
    let little = value.to_le_bytes();
    let is_big = random.below(3) == 0;
    for k in 0..width {
        bytes[k] = little[if is_big { width - 1 - k } else { k }];
    }
}

/// Every reader with its seeds; `folder` receives the files of the level folder.
pub(crate) fn readers(folder: &Path) -> Vec<Reader> {
    let environment = |name: &'static str, seeds: Vec<Vec<u8>>| Reader {
        name,
        seeds,
        read: Box::new(move |bytes| io::read_from_memory(Path::new(name), bytes, &options()).is_ok()),
    };
    vec![
        environment("hdr", radiance_seeds()),
        environment("exr", exr_seeds()),
        environment("png", png_seeds()),
        environment("jpeg", jpeg_seeds()),
        environment("ktx2", ktx2_seeds()),
        environment("ktx", ktx1_seeds()),
        Reader {
            name: "ktx chain",
            seeds: ktx1_seeds(),
            read: Box::new(|bytes| io::read_chain_from_memory(Path::new("ktx"), bytes, MEMORY_LIMIT).is_ok()),
        },
        Reader {
            name: "ktx2 chain",
            seeds: ktx2_seeds().into_iter().take(3).collect(),
            read: Box::new(|bytes| {
                io::read_chain_from_memory(Path::new("ktx2"), bytes, MEMORY_LIMIT).is_ok()
            }),
        },
        level_folder(folder),
        Reader {
            name: "npy",
            seeds: npy_seeds(),
            read: Box::new(|bytes| npy::read_table(bytes, &[3, 4], 4_000_000).is_ok()),
        },
    ]
}

fn options() -> ReadOptions {
    ReadOptions { sanitize: true, memory_limit: MEMORY_LIMIT, ..ReadOptions::default() }
}

fn radiance_seeds() -> Vec<Vec<u8>> {
    let pixels = inputs::numbered(32, 16);
    let header = "# comment\nFORMAT=32-bit_rle_xyze\nEXPOSURE=2\nCOLORCORR=1 2 1\n\
                  PRIMARIES=.7 .3 .2 .7 .1 .1 .33 .33\n";
    vec![
        inputs::radiance("FORMAT=32-bit_rle_rgbe\n", "-Y 16 +X 32", &pixels),
        inputs::radiance(header, "+X 32 -Y 16", &pixels),
        inputs::radiance_with_runs(32, 16, &pixels),
        inputs::radiance_with_runs(32, 16, &vec![[0.5; 3]; 512]),
    ]
}

fn exr_seeds() -> Vec<Vec<u8>> {
    let size = (32, 16);
    let pixels = inputs::numbered(32, 16);
    let mut seeds = Vec::new();
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ] {
        for kind in [Sample::Half, Sample::Float] {
            seeds.push(inputs::exr_rgb(size, kind, compression, &pixels));
        }
        let tiled = inputs::layer(
            size,
            compression,
            Blocks::Tiles(Vec2(8, 8)),
            inputs::rgb_channels("", Sample::Half, &pixels),
        );
        seeds.push(inputs::exr_bytes(&Image::from_layer(tiled)));
    }
    let chroma = ["Y", "RY", "BY"]
        .map(|name| AnyChannel::new(name, inputs::samples(Sample::Half, pixels.iter().map(|rgb| rgb[0]))));
    for (kind, channels) in [
        (Compression::PIZ, chroma.to_vec()),
        (Compression::PIZ, chroma[..1].to_vec()),
        (Compression::ZIP16, inputs::rgb_channels("diffuse.", Sample::Uint, &pixels)),
    ] {
        let layer = inputs::layer(size, kind, Blocks::ScanLines, channels);
        seeds.push(inputs::exr_bytes(&Image::from_layer(layer)));
    }
    seeds.push(inputs::exr_mip_mapped(size, 8, &pixels));
    seeds
}

fn bytes_of_pixels() -> Vec<[u8; 3]> {
    inputs::numbered(32, 16).iter().map(|rgb| rgb.map(|value| (value * 3.0) as u8)).collect()
}

fn png_seeds() -> Vec<Vec<u8>> {
    let deep: Vec<[u16; 4]> = (0..512).map(|at| [at * 100, at, 65535 - at, at * 3]).collect();
    vec![inputs::ldr(32, 16, image::ImageFormat::Png, &bytes_of_pixels()), inputs::deep_png(32, 16, &deep)]
}

fn jpeg_seeds() -> Vec<Vec<u8>> {
    vec![
        inputs::ldr(32, 16, image::ImageFormat::Jpeg, &bytes_of_pixels()),
        inputs::ldr(16, 16, image::ImageFormat::Jpeg, &bytes_of_pixels()[..256]),
    ]
}

/// Three cubes with roughness, then a 2D image.
fn ktx2_seeds() -> Vec<Vec<u8>> {
    let roughness: &[(&str, &[u8])] = &[("octaglossRoughness", b"0,0.5,1\0")];
    let levels: Vec<_> = [4, 2, 1].map(|size| inputs::numbered(size, 6 * size)).to_vec();
    let cube = |pixel, zstd| inputs::ktx2((4, 4), 6, pixel, zstd, roughness, &levels);
    let orientation: &[(&str, &[u8])] = &[("KTXorientation", b"ru\0")];
    let flat = inputs::numbered(32, 16);
    vec![
        cube(Ktx2Pixel::Rgba16F, true),
        cube(Ktx2Pixel::Rgb9E5, true),
        cube(Ktx2Pixel::Rgba32F, false),
        inputs::ktx2((32, 16), 1, Ktx2Pixel::Rgba16F, false, orientation, &[flat]),
    ]
}

/// KTX 1 cubes with provenance.
fn ktx1_seeds() -> Vec<Vec<u8>> {
    let level = |(size, roughness)| Level::cube(size, roughness, inputs::numbered(size, 6 * size));
    let chain = Chain { levels: [(4, 0.0), (2, 0.5), (1, 1.0)].map(level).to_vec() };
    let sun = r#"{"direction":[1,0,0],"irradiance":[1,2,3],"solid_angle":0.1}"#;
    let recipe = format!(r#"{{"flip":"x","rotate_y":37,"lobe":"ggx","removed_suns":[{sun}]}}"#);
    let old = [("octaglossFlip", "x"), ("octaglossRotateY", "37"), ("octaglossSun", "1 0 0, 1 2 3, 0.1")];
    let seed = |(pixel, pairs): (Pixel, &[(&str, &str)])| {
        let pairs: Vec<_> = pairs.iter().map(|(key, text)| ((*key).to_owned(), (*text).to_owned())).collect();
        ktx1_bytes(&chain, pixel, &pairs).unwrap().bytes
    };
    let new = [("octaglossRecipe", &recipe[..])];
    [(Pixel::F16, &new[..]), (Pixel::F32, &old[..]), (Pixel::Rgb9e5, &new[..]), (Pixel::R11g11b10, &old[..])]
        .map(seed)
        .to_vec()
}

/// Arrays of three and four columns, float32 and float64, of both byte orders.
fn npy_seeds() -> Vec<Vec<u8>> {
    let values: Vec<f32> = (0..24_u8).map(f32::from).collect();
    let double = inputs::npy("<f8", true, (8, 3), &(0..192).collect::<Vec<u8>>());
    let big_endian = inputs::npy(">f4", false, (6, 4), &(0..96).collect::<Vec<u8>>());
    vec![npy::table_bytes(3, &values), npy::table_bytes(4, &values), double, big_endian]
}

/// Damages the report of a level folder; its faces stay intact.
fn level_folder(folder: &Path) -> Reader {
    for (level, size) in [(0, 4), (1, 2)] {
        for name in ["px", "nx", "py", "ny", "pz", "nz"] {
            let face = inputs::exr_rgb(
                (size, size),
                Sample::Half,
                Compression::ZIP16,
                &inputs::numbered(size, size),
            );
            std::fs::write(folder.join(format!("m{level}_{name}.exr")), face).unwrap();
        }
    }
    let report = br#"{"input":"sky.exr","levels":[{"level":0,"size":4,"roughness":0.0,"seconds":0.1},
        {"level":1,"size":2,"roughness":1.0,"seconds":0.1}],"warnings":[]}"#;
    let folder = folder.to_owned();
    Reader {
        name: "level folder",
        seeds: vec![report.to_vec()],
        read: Box::new(move |bytes| {
            std::fs::write(folder.join("report.json"), bytes).unwrap();
            io::read_chain(&folder).is_ok()
        }),
    }
}
