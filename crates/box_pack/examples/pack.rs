//! `cargo run --release -p box_pack --example pack FILE PACKED` compresses a file for the page.

use std::{env, error::Error, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let [file, packed] = env::args()
        .skip(1)
        .collect::<Vec<_>>()
        .try_into()
        .map_err(|_| "usage: pack FILE PACKED")?;
    let mut output = fs::File::create(&packed).map_err(|error| format!("{packed}: {error}"))?;
    let data = fs::read(&file).map_err(|error| format!("{file}: {error}"))?;
    // The defaults are the highest quality, 11, and the largest window of RFC 7932, 16 MB.
    let parameters = brotli::enc::BrotliEncoderParams {
        lgwin: 24,
        size_hint: data.len(),
        ..Default::default()
    };
    brotli::BrotliCompress(&mut &data[..], &mut output, &parameters)?;
    Ok(())
}
