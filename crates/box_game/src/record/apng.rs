//! Animated PNG: pictures of one size in, one small file out.
//!
//! The pictures share one palette of 255 colors (median cut; P. Heckbert, *Color image quantization for
//! frame buffer display*, 1982). After the first, each picture holds only the rectangle that changed, and
//! in it only the pixels that did: the rest is transparent and costs next to nothing.

use std::collections::HashMap;
use std::io::Write;

/// A picture: three bytes a pixel, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// \[pixels\]
    pub width: u32,
    /// \[pixels\]
    pub height: u32,
    /// sRGB, `3 · width · height` bytes.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// The part of it from (x, y) on, of at most this size.
    pub fn cropped(&self, x: u32, y: u32, width: u32, height: u32) -> Self {
        let (x, y) = (x.min(self.width), y.min(self.height));
        let (width, height) = (width.min(self.width - x), height.min(self.height - y));
        let mut rgb = Vec::with_capacity((3 * width * height) as usize);
        for row in y..y + height {
            let from = 3 * (row * self.width + x) as usize;
            rgb.extend_from_slice(&self.rgb[from..from + 3 * width as usize]);
        }
        Self { width, height, rgb }
    }

    /// A `factor`-th of the size: means of `factor` × `factor` pixels.
    pub fn reduced(&self, factor: u32) -> Self {
        let factor = factor.max(1);
        let (width, height) = (self.width / factor, self.height / factor);
        let mut rgb = Vec::with_capacity((3 * width * height) as usize);
        for y in 0..height {
            for x in 0..width {
                for channel in 0..3 {
                    let mut sum = 0;
                    for dy in 0..factor {
                        for dx in 0..factor {
                            let pixel = (y * factor + dy) * self.width + x * factor + dx;
                            sum += u32::from(self.rgb[(3 * pixel + channel) as usize]);
                        }
                    }
                    let n = factor * factor;
                    rgb.push(((sum + n / 2) / n) as u8);
                }
            }
        }
        Self { width, height, rgb }
    }

    fn pixels(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        self.rgb.chunks_exact(3).map(|p| [p[0], p[1], p[2]])
    }
}

/// Writes `pictures`, which all have the size of the first, `rate` a second, repeated for ever.
///
/// # Errors
/// What `to` or the encoder says; no pictures, or pictures of several sizes, are errors too.
pub fn write(to: impl Write, pictures: &[Picture], rate: u16) -> Result<(), png::EncodingError> {
    let refuse = |text: &str| png::EncodingError::IoError(std::io::Error::other(text.to_owned()));
    let Some(first) = pictures.first() else {
        return Err(refuse("no pictures"));
    };
    let (width, height) = (first.width, first.height);
    if pictures
        .iter()
        .any(|p| (p.width, p.height) != (width, height))
        || width * height == 0
    {
        return Err(refuse("pictures of several sizes, or of none"));
    }
    let palette = Palette::of(pictures);
    let mut encoder = png::Encoder::new(to, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(palette.bytes());
    // Only the first entry is transparent.
    encoder.set_trns(vec![0_u8]);
    encoder.set_animated(pictures.len() as u32, 0)?;
    encoder.set_frame_delay(1, rate.max(1))?;
    encoder.set_blend_op(png::BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    let mut shown: Vec<u8> = Vec::new();
    for picture in pictures {
        let indices = palette.indices(picture);
        if shown.is_empty() {
            writer.write_image_data(&indices)?;
        } else {
            let area = changed(&shown, &indices, width as usize);
            let (x, y, w, h) = area.unwrap_or((0, 0, 1, 1));
            writer.reset_frame_position()?;
            writer.set_frame_dimension(w as u32, h as u32)?;
            writer.set_frame_position(x as u32, y as u32)?;
            writer.write_image_data(&difference(&shown, &indices, width as usize, (x, y, w, h)))?;
        }
        shown = indices;
    }
    writer.finish()
}

/// The rectangle (x, y, width, height) in which two pictures differ.
fn changed(a: &[u8], b: &[u8], width: usize) -> Option<(usize, usize, usize, usize)> {
    let (mut left, mut right, mut top, mut bottom) = (usize::MAX, 0, usize::MAX, 0);
    for (k, _) in a.iter().zip(b).enumerate().filter(|(_, (a, b))| a != b) {
        let (x, y) = (k % width, k / width);
        left = left.min(x);
        right = right.max(x);
        top = top.min(y);
        bottom = bottom.max(y);
    }
    (left != usize::MAX).then(|| (left, top, right - left + 1, bottom - top + 1))
}

/// Of that rectangle the pixels that differ; transparent (0) where they do not.
fn difference(a: &[u8], b: &[u8], width: usize, area: (usize, usize, usize, usize)) -> Vec<u8> {
    let (x, y, w, h) = area;
    let mut out = Vec::with_capacity(w * h);
    for row in y..y + h {
        for k in row * width + x..row * width + x + w {
            out.push(if a[k] == b[k] { 0 } else { b[k] });
        }
    }
    out
}

/// At most 255 colors; index 0 is the transparent one.
struct Palette {
    colors: Vec<[u8; 3]>,
    nearest: HashMap<[u8; 3], u8>,
}

/// Colors are told apart to five bits a channel.
fn coarse(color: [u8; 3]) -> [u8; 3] {
    color.map(|c| c >> 3)
}

impl Palette {
    fn of(pictures: &[Picture]) -> Self {
        // Mean color and number of each coarse one.
        let mut counts: HashMap<[u8; 3], ([u64; 3], u64)> = HashMap::new();
        for pixel in pictures.iter().flat_map(Picture::pixels) {
            let (sum, count) = counts.entry(coarse(pixel)).or_default();
            for channel in 0..3 {
                sum[channel] += u64::from(pixel[channel]);
            }
            *count += 1;
        }
        let mut entries: Vec<Entry> = counts
            .into_iter()
            .map(|(key, (sum, count))| Entry {
                key,
                mean: sum.map(|s| (s / count) as u8),
                count,
            })
            .collect();
        // The order of a hash map is chance; the file shall not be.
        entries.sort_by_key(|e| e.key);
        let boxes = cut(entries);
        let mut palette = Self {
            colors: vec![[0; 3]],
            nearest: HashMap::new(),
        };
        for entries in boxes {
            let total: u64 = entries.iter().map(|e| e.count).sum();
            let mean = core::array::from_fn(|c| {
                let sum: u64 = entries.iter().map(|e| u64::from(e.mean[c]) * e.count).sum();
                (sum / total.max(1)) as u8
            });
            let index = palette.colors.len() as u8;
            palette.colors.push(mean);
            palette
                .nearest
                .extend(entries.iter().map(|e| (e.key, index)));
        }
        palette
    }

    fn bytes(&self) -> Vec<u8> {
        self.colors.concat()
    }

    fn indices(&self, picture: &Picture) -> Vec<u8> {
        picture
            .pixels()
            .map(|pixel| self.nearest.get(&coarse(pixel)).copied().unwrap_or(0))
            .collect()
    }
}

struct Entry {
    key: [u8; 3],
    mean: [u8; 3],
    count: u64,
}

/// Median cut: the box with the longest side times the root of its pixels is halved, until there are 255.
fn cut(entries: Vec<Entry>) -> Vec<Vec<Entry>> {
    let mut boxes = vec![entries];
    while boxes.len() < 255 {
        let weight = |entries: &Vec<Entry>| {
            let (_, side) = longest(entries);
            let pixels: u64 = entries.iter().map(|e| e.count).sum();
            f64::from(side) * (pixels as f64).sqrt()
        };
        let widest = (0..boxes.len())
            .filter(|&k| boxes[k].len() > 1)
            .max_by(|&a, &b| weight(&boxes[a]).total_cmp(&weight(&boxes[b])));
        let Some(k) = widest else {
            break;
        };
        let mut entries = boxes.swap_remove(k);
        let (channel, _) = longest(&entries);
        entries.sort_by_key(|e| (e.key[channel], e.key));
        let half = entries.iter().map(|e| e.count).sum::<u64>() / 2;
        let mut seen = 0;
        let middle = entries
            .iter()
            .position(|e| {
                seen += e.count;
                seen > half
            })
            .unwrap_or(0);
        let upper = entries.split_off((middle + 1).clamp(1, entries.len() - 1));
        boxes.push(entries);
        boxes.push(upper);
    }
    boxes
}

/// The channel in which the colors lie farthest apart, and how far.
fn longest(entries: &[Entry]) -> (usize, u8) {
    (0..3)
        .map(|c| {
            let values = || entries.iter().map(|e| e.mean[c]);
            let side = values().max().unwrap_or(0) - values().min().unwrap_or(0);
            (c, side)
        })
        .max_by_key(|&(_, side)| side)
        .unwrap_or((0, 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A white square that walks over a shaded ground.
    fn walk(frames: u32) -> Vec<Picture> {
        (0..frames)
            .map(|k| {
                let (width, height) = (64, 48);
                let mut rgb = Vec::new();
                for y in 0..height {
                    for x in 0..width {
                        let inside = (x >= 2 * k && x < 2 * k + 8) && (20..28).contains(&y);
                        let shade = (40 + x + y) as u8;
                        rgb.extend(if inside {
                            [255; 3]
                        } else {
                            [shade, shade / 2, 90]
                        });
                    }
                }
                Picture { width, height, rgb }
            })
            .collect()
    }

    #[test]
    fn a_film_decodes_to_what_was_filmed() {
        let pictures = walk(10);
        let mut file = Vec::new();
        write(&mut file, &pictures, 20).expect("encodable");
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file))
            .read_info()
            .expect("a PNG");
        let animation = reader.info().animation_control.expect("animated");
        assert_eq!((animation.num_frames, animation.num_plays), (10, 0));
        let palette = reader.info().palette.clone().expect("indexed").to_vec();
        let mut shown = vec![0_u8; 64 * 48];
        for picture in &pictures {
            let mut buffer = vec![0; reader.output_buffer_size().expect("small")];
            reader.next_frame(&mut buffer).expect("a frame");
            let control = *reader.info().frame_control().expect("animated");
            for row in 0..control.height {
                for column in 0..control.width {
                    let index = buffer[(row * control.width + column) as usize];
                    let at = (row + control.y_offset) * 64 + column + control.x_offset;
                    if index != 0 {
                        shown[at as usize] = index;
                    }
                }
            }
            for (pixel, &index) in picture.pixels().zip(&shown) {
                for (channel, wanted) in pixel.into_iter().enumerate() {
                    let got = palette[3 * usize::from(index) + channel];
                    assert!(got.abs_diff(wanted) <= 8, "{got} for {wanted}");
                }
            }
        }
        // Ten pictures cost far less than ten files.
        let mut one = Vec::new();
        write(&mut one, &pictures[..1], 20).expect("encodable");
        assert!(file.len() < 5 * one.len(), "{} {}", file.len(), one.len());
    }

    #[test]
    fn parts_and_halves() {
        let picture = &walk(1)[0];
        let part = picture.cropped(60, 40, 100, 100);
        assert_eq!((part.width, part.height, part.rgb.len()), (4, 8, 96));
        assert_eq!(part.rgb[0], 140);
        let half = picture.reduced(2);
        assert_eq!((half.width, half.height), (32, 24));
        assert_eq!(half.rgb[2], 90);
    }

    #[test]
    fn nothing_and_unequal_pictures_are_refused() {
        assert!(write(Vec::new(), &[], 10).is_err());
        let mut pictures = walk(2);
        pictures[1] = pictures[1].reduced(2);
        assert!(write(Vec::new(), &pictures, 10).is_err());
    }
}
