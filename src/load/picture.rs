//! The alpha channel of a picture file: PNG or WebP; a JPEG has none.

use gnomon_core::size::Size;
use image::{ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Alpha as UNORM8, row by row from the top, with width and height.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Alpha {
    pub(super) size: [u32; 2],
    pub(super) values: Vec<u8>,
}

/// What a picture is, by its first bytes.
fn format(bytes: &[u8]) -> std::result::Result<ImageFormat, String> {
    let kinds: [(&[u8], &str); 7] = [
        (b"\xabKTX 20", "KTX2"),
        (b"\xabKTX 11", "KTX"),
        (b"DDS ", "DDS"),
        (b"GIF8", "GIF"),
        (b"BM", "BMP"),
        (b"version https://git-lfs", "a Git LFS pointer without its content"),
        (b"", "no PNG, JPEG or WebP"),
    ];
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Ok(ImageFormat::Png),
        [0xff, 0xd8, 0xff, ..] => Ok(ImageFormat::Jpeg),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Ok(ImageFormat::WebP),
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => Err("AVIF or HEIF".into()),
        _ => {
            let kind = kinds.iter().find(|(magic, _)| bytes.starts_with(magic));
            Err(kind.map_or("", |(_, name)| name).into())
        }
    }
}

/// The alpha of a picture in at most `memory` bytes; `None` where all of it is 1.
///
/// # Errors
/// What the picture is, or why it cannot be decoded.
pub(super) fn alpha(bytes: &[u8], memory: u64) -> std::result::Result<Option<Alpha>, String> {
    let format = format(bytes)?;
    if format == ImageFormat::Jpeg {
        return Ok(None);
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let [width, height] = ImageReader::with_format(Cursor::new(bytes), format)
        .into_dimensions()
        .map(|(width, height)| [width, height])
        .map_err(|e| e.to_string())?;
    // Four channels of up to 16 bits beside the decoder's own.
    let need = u64::from(width) * u64::from(height) * 16;
    if need > memory {
        return Err(format!("{width} x {height}, which needs {}", Size(need)));
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(memory);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| e.to_string())?;
    if !picture.color().has_alpha() {
        return Ok(None);
    }
    let values: Vec<u8> = picture.into_rgba8().pixels().map(|pixel| pixel.0[3]).collect();
    let opaque = values.iter().all(|&a| a == u8::MAX);
    Ok((!opaque).then_some(Alpha { size: [width, height], values }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(pixels: &[[u8; 4]], width: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let raw: Vec<u8> = pixels.concat();
        let height = pixels.len() as u32 / width;
        image::RgbaImage::from_raw(width, height, raw)
            .expect("its size")
            .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
            .expect("a PNG");
        bytes
    }

    #[test]
    fn alpha_is_read_from_what_has_it_and_the_rest_is_named() {
        let holed = png(&[[1, 2, 3, 0], [1, 2, 3, 255], [1, 2, 3, 127], [1, 2, 3, 128]], 2);
        let expected = Alpha { size: [2, 2], values: vec![0, 255, 127, 128] };
        assert_eq!(alpha(&holed, 1 << 20), Ok(Some(expected)));
        assert_eq!(alpha(&png(&[[9, 9, 9, 255]; 4], 2), 1 << 20), Ok(None));
        assert_eq!(alpha(b"\xff\xd8\xff\xe0", 1 << 20), Ok(None), "a JPEG has no alpha");
        for (bytes, word) in [
            (&b"\xabKTX 20\xbb"[..], "KTX2"),
            (b"DDS |", "DDS"),
            (b"version https://git-lfs.x", "LFS"),
            (b"", "no PNG"),
            (holed.get(..40).unwrap_or_default(), ""),
        ] {
            let error = alpha(bytes, 1 << 20).expect_err(word);
            assert!(error.contains(word), "{error}");
        }
        assert!(alpha(&holed, 8).expect_err("too large").contains("2 x 2"));
    }
}
