//! Brotli decompression for the game's page, which decompresses its own download.
//!
//! Browsers decompress Brotli only if the host names it in a header, and many static hosts send gzip at best. Not every
//! browser lets scripts decompress it. The example `pack` compresses.

use std::io::{Error, Write};

use brotli_decompressor::DecompressorWriter;
#[cfg(target_family = "wasm")]
use wasm_bindgen::prelude::wasm_bindgen;

/// Streaming decompressor for Brotli (RFC 7932).
#[cfg_attr(target_family = "wasm", wasm_bindgen)]
pub struct Unpacker(DecompressorWriter<Vec<u8>>);

impl Unpacker {
    /// Decompresses the next `packed` bytes.
    ///
    /// # Errors
    /// The data are not Brotli.
    pub fn next(&mut self, packed: &[u8]) -> Result<Vec<u8>, Error> {
        self.0.write_all(packed)?;
        Ok(std::mem::take(self.0.get_mut()))
    }

    /// Returns the last decompressed bytes.
    ///
    /// # Errors
    /// The data end too early.
    pub fn last(&mut self) -> Result<Vec<u8>, Error> {
        self.0.close()?;
        Ok(std::mem::take(self.0.get_mut()))
    }
}

impl Default for Unpacker {
    fn default() -> Self {
        Self(DecompressorWriter::new(Vec::new(), 1 << 16))
    }
}

/// Functions for the page.
#[cfg(target_family = "wasm")]
mod page {
    use wasm_bindgen::prelude::{JsError, wasm_bindgen};

    use super::Unpacker;

    #[wasm_bindgen]
    impl Unpacker {
        /// Creates an unpacker at the start of the data.
        #[wasm_bindgen(constructor)]
        pub fn new() -> Self {
            Self::default()
        }

        /// [`Unpacker::next`]
        ///
        /// # Errors
        /// The data are not Brotli.
        #[wasm_bindgen(js_name = next)]
        pub fn page_next(&mut self, packed: &[u8]) -> Result<Vec<u8>, JsError> {
            Ok(self.next(packed)?)
        }

        /// [`Unpacker::last`]
        ///
        /// # Errors
        /// The data end too early.
        #[wasm_bindgen(js_name = last)]
        pub fn page_last(&mut self) -> Result<Vec<u8>, JsError> {
            Ok(self.last()?)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Unpacker;

    fn pack(data: &[u8]) -> Vec<u8> {
        let mut packed = Vec::new();
        brotli::BrotliCompress(
            &mut &data[..],
            &mut packed,
            &brotli::enc::BrotliEncoderParams::default(),
        )
        .expect("a vector takes all");
        packed
    }

    /// 300 kB that are neither constant nor random.
    fn data() -> Vec<u8> {
        (0..300_000_u32)
            .map(|k| (k.wrapping_mul(k >> 7) >> 11) as u8)
            .collect()
    }

    #[test]
    fn pieces_of_any_length_give_the_data() {
        let (data, packed) = (data(), pack(&data()));
        for length in [1, 7, 4096, packed.len()] {
            let mut unpacker = Unpacker::default();
            let mut whole: Vec<u8> = packed
                .chunks(length)
                .flat_map(|piece| unpacker.next(piece).expect("as packed"))
                .collect();
            whole.extend(unpacker.last().expect("complete"));
            assert!(whole == data, "pieces of {length}");
        }
    }

    #[test]
    fn what_is_cut_or_damaged_is_an_error() {
        let packed = pack(&data());
        let mut unpacker = Unpacker::default();
        unpacker
            .next(&packed[..packed.len() / 2])
            .expect("good so far");
        unpacker.last().expect_err("half is missing");
        Unpacker::default()
            .next(&[0xff; 64])
            .expect_err("not Brotli");
    }
}
