//! Zstandard frames of known sizes, by the reference library; in WebAssembly, which lacks a C compiler, by
//! ruzstd.

use std::io;

/// zstd's default. On half-float faces of a real panorama level 1 is three times as fast and 14 % larger;
/// level 19 takes sixty times as long and is 11 % smaller.
#[cfg(not(target_arch = "wasm32"))]
const LEVEL: i32 = 3;

/// Compresses `bytes` to a frame. Single-threaded and deterministic.
#[cfg(not(target_arch = "wasm32"))]
pub(in crate::files::io) fn compress(bytes: &[u8]) -> io::Result<Vec<u8>> {
    zstd::bulk::compress(bytes, LEVEL)
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
