//! Packings as shader text, so that they can be run on a real GPU.

use super::Packing;

/// A pair as `pack` and `unpack` functions without any precision statement: the default precision of
/// the shader around them holds. Operations and their order are those of the Rust pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// GLSL ES, the same text for 1.00 and 3.00.
    pub glsl: &'static str,
    /// WGSL.
    pub wgsl: &'static str,
}

macro_rules! source {
    ($name:literal) => {
        Source {
            glsl: include_str!(concat!("shaders/", $name, ".glsl")),
            wgsl: include_str!(concat!("shaders/", $name, ".wgsl")),
        }
    };
}

/// The texts: to add one, write two files and one line.
const SOURCES: [(Packing, Source); 6] = [
    (Packing::R8, source!("r8")),
    (Packing::Book, source!("book")),
    (Packing::Upc, source!("upc")),
    (Packing::Aras2009, source!("aras-2009")),
    (Packing::ThreeRgba, source!("three-rgba")),
    (Packing::Digits24, source!("digits-24")),
];

impl Packing {
    /// The packings that have a [`Source`], in catalogue order.
    pub fn with_source() -> impl Iterator<Item = (Self, Source)> {
        SOURCES.into_iter()
    }
}
