//! Packings as shader text, so that they can be run on a real GPU.

/// A pair as `pack` and `unpack` functions without any precision statement: the default precision of
/// the shader around them holds. Operations and their order are those of the Rust pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// GLSL ES, the same text for 1.00 and 3.00.
    pub glsl: &'static str,
    /// WGSL.
    pub wgsl: &'static str,
}

/// The texts of two files.
macro_rules! source {
    ($name:literal) => {
        Some(Source {
            glsl: include_str!(concat!("shaders/", $name, ".glsl")),
            wgsl: include_str!(concat!("shaders/", $name, ".wgsl")),
        })
    };
}
