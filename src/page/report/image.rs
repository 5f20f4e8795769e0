//! Pictures: RGB bytes with a legend, and their PNG form.

use std::collections::HashMap;

use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder};

use super::palette::Colour;

/// A picture of classes or of a rendering.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Unique in the report; names the PNG file and the anchor.
    pub id: String,
    /// One sentence: what a reader should see.
    pub caption: String,
    /// What the picture shows, for people who cannot see it.
    pub alt: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// sRGB bytes, three a pixel, top row first.
    pub rgb: Vec<u8>,
    /// What the colours mean.
    pub legend: Vec<(Colour, String)>,
    /// How many page pixels a picture pixel takes across; 0 counts as 1.
    pub magnify: u32,
}

impl Picture {
    /// The PNG file, without dates or other ancillary data.
    ///
    /// # Panics
    /// Where `rgb` does not hold `width` × `height` pixels.
    #[must_use]
    pub fn to_png(&self) -> Vec<u8> {
        png(self.width, self.height, &self.rgb)
    }
}

/// PNG bytes of 8-bit RGB samples; with a palette where 256 colours suffice (plots, classes), which
/// halves the file and loses nothing.
///
/// # Panics
/// Where `rgb` does not hold `width` × `height` pixels.
pub(super) fn png(width: u32, height: u32, rgb: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let Some((colours, indices)) = palette(rgb) else {
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
            .write_image(rgb, width, height, ExtendedColorType::Rgb8)
            .expect("an image with as many samples as its size says encodes in memory");
        return bytes;
    };
    let mut encoder = ::png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(::png::ColorType::Indexed);
    encoder.set_palette(colours);
    encoder.set_filter(::png::Filter::NoFilter);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&indices))
        .expect("as many indices as pixels encode in memory");
    bytes
}

/// The distinct colours in order of appearance and each pixel's index; `None` beyond 256.
fn palette(rgb: &[u8]) -> Option<(Vec<u8>, Vec<u8>)> {
    let mut seen = HashMap::new();
    let mut colours = Vec::new();
    let mut indices = Vec::with_capacity(rgb.len() / 3);
    let mut last: &[u8] = &[];
    for pixel in rgb.chunks_exact(3) {
        // Neighbours are mostly alike.
        if pixel == last {
            indices.push(*indices.last().expect("a pixel came before"));
            continue;
        }
        last = pixel;
        let next = seen.len();
        let index = *seen.entry([pixel[0], pixel[1], pixel[2]]).or_insert(next);
        if index == next {
            colours.extend_from_slice(pixel);
        }
        indices.push(u8::try_from(index).ok()?);
    }
    Some((colours, indices))
}
