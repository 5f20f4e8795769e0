//! OpenEXR images of measured values: one unnamed part that viewers open and that is byte-stable.

use std::io::Cursor;

use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image,
    Layer, LayerAttributes, LineOrder, Text, WritableImage,
};

/// Name of the one text attribute.
const ATTRIBUTE: &str = "gnomon";

/// Measured values, one `f32` channel per quantity.
#[derive(Clone, Debug, Default)]
pub struct ExrImage {
    /// Unique in the report; names the EXR file.
    pub id: String,
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Channel name and values, top row first. Dots make layers; an RGB preview is called `R`,
    /// `G`, `B`.
    pub channels: Vec<(String, Vec<f32>)>,
    /// What channels and codes mean; becomes the JSON text attribute `gnomon`.
    pub metadata: serde_json::Value,
}

/// A JSON text in ASCII: EXR's texts know Latin-1 alone.
fn ascii(value: &serde_json::Value) -> String {
    let escaped = |c: char| {
        let units = c.encode_utf16(&mut [0; 2]).iter().map(|u| format!("\\u{u:04x}")).collect();
        if c.is_ascii() { c.to_string() } else { units }
    };
    value.to_string().chars().map(escaped).collect()
}

impl ExrImage {
    /// The file: ZIP in blocks of 16 scan lines, increasing, channels sorted by name. This is the
    /// combination that gives the same bytes in every run.
    ///
    /// # Panics
    /// Where a channel does not hold `width` × `height` values or the image has no channel.
    #[must_use]
    pub fn to_exr(&self) -> Vec<u8> {
        let size = (self.width, self.height);
        let channel = |(name, values): &(String, Vec<f32>)| {
            assert_eq!(values.len(), size.0 * size.1, "channel {name} has another size");
            AnyChannel::new(name.as_str(), FlatSamples::F32(values.clone()))
        };
        let channels = AnyChannels::sort(self.channels.iter().map(channel).collect());
        let encoding = Encoding {
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        };
        let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
        let mut image = Image::from_layer(layer);
        let text = AttributeValue::Text(Text::from(ascii(&self.metadata).as_str()));
        image.attributes.other.insert(Text::from(ATTRIBUTE), text);
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).expect("an image with channels encodes in memory");
        bytes.into_inner()
    }

    /// Channel names in file order.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<_> = self.channels.iter().map(|(name, _)| name.as_str()).collect();
        names.sort_unstable();
        names
    }
}
