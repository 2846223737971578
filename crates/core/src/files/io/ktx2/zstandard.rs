//! Zstandard frames of known sizes, by the reference library; in WebAssembly, which lacks a C compiler, by
//! ruzstd.

use std::io;

/// Level 1 with longer matches and a larger table: on half-float faces of real panoramas as small as zstd's
/// default, level 3, in 0.6 of its time (level 1 as it is: 14 % larger). RGB9E5 grows by 3 %.
#[cfg(not(target_arch = "wasm32"))]
const LEVEL: i32 = 1;

/// Bytes of the shortest match.
#[cfg(not(target_arch = "wasm32"))]
const MIN_MATCH: u32 = 5;

/// Logarithm of the entries of the table of matches.
#[cfg(not(target_arch = "wasm32"))]
const HASH_LOG: u32 = 16;

/// Compresses `bytes` to a frame. Single-threaded and deterministic.
#[cfg(not(target_arch = "wasm32"))]
pub(in crate::files::io) fn compress(bytes: &[u8]) -> io::Result<Vec<u8>> {
    use zstd::zstd_safe::CParameter::{HashLog, MinMatch};
    let mut compressor = zstd::bulk::Compressor::new(LEVEL)?;
    compressor.set_parameter(MinMatch(MIN_MATCH))?;
    compressor.set_parameter(HashLog(HASH_LOG))?;
    compressor.compress(bytes)
}

/// Decompresses `frame`; fails if the content exceeds `most` bytes.
#[cfg(not(target_arch = "wasm32"))]
pub(in crate::files::io) fn decompress(frame: &[u8], most: usize) -> io::Result<Vec<u8>> {
    zstd::bulk::decompress(frame, most)
}

#[cfg(target_arch = "wasm32")]
pub(in crate::files::io) fn compress(bytes: &[u8]) -> io::Result<Vec<u8>> {
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    Ok(compress_to_vec(bytes, CompressionLevel::Fastest))
}

#[cfg(target_arch = "wasm32")]
pub(in crate::files::io) fn decompress(frame: &[u8], most: usize) -> io::Result<Vec<u8>> {
    use io::Read as _;
    let frame = ruzstd::decoding::StreamingDecoder::new(frame).map_err(io::Error::other)?;
    let mut bytes = Vec::new();
    frame.take(most as u64 + 1).read_to_end(&mut bytes)?;
    if bytes.len() > most {
        return Err(io::Error::other(format!("more than {most} bytes")));
    }
    Ok(bytes)
}
