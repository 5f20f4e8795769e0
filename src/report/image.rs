//! Pictures: RGB bytes with a legend, and their PNG form.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

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
        png(self.width, self.height, &self.rgb, ExtendedColorType::Rgb8)
    }
}

/// PNG bytes of 8-bit samples.
pub(super) fn png(width: u32, height: u32, samples: &[u8], colour: ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(samples, width, height, colour)
        .expect("an image with as many samples as its size says encodes in memory");
    bytes
}
