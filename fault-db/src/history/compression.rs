//! Zstd compression with a checksum of the content, so that decompression finds damage.

use std::io::{Error, Read as _, Result};

/// Compresses at a zstd level.
pub(crate) fn pack(text: &[u8], level: i32) -> Result<Vec<u8>> {
    let mut compressor = zstd::bulk::Compressor::new(level)?;
    compressor.include_checksum(true)?;
    compressor.compress(text)
}

/// Decompresses; an error if the result is longer than `most` bytes.
pub(crate) fn unpack(packed: &[u8], most: u64) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    let decoder = zstd::stream::read::Decoder::new(packed)?;
    let read = decoder.take(most + 1).read_to_end(&mut text)?;
    if read as u64 > most {
        return Err(Error::other(format!(
            "it unpacks to more than {most} bytes"
        )));
    }
    Ok(text)
}
