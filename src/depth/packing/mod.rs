//! Packings: window depth → four UNORM8 channels → depth, each in its own order of operations.

mod base256;

crate::catalogue! {
    /// A pack/unpack pair over RGBA8.
    pub enum Packing {
        /// The depth in the red channel alone (document 000, Shadow.js).
        R8 = "r8",
        /// Base 256, R most significant (documents 000 and 004).
        Book = "book",
        /// Base 256, A most significant (document 001, corrected).
        Upc = "upc",
    }
}

impl Packing {
    /// The shader's channel values before the RGBA8 store, every operation rounded to f32, no FMA.
    #[must_use]
    pub fn pack(self, z: f32) -> [f32; 4] {
        match self {
            Self::R8 => [z, 0.0, 0.0, 0.0],
            Self::Book => base256::pack_book(z),
            Self::Upc => base256::pack_upc(z),
        }
    }

    /// The depth of four sampled channels, every operation rounded to f32, no FMA.
    #[must_use]
    pub fn unpack(self, c: [f32; 4]) -> f32 {
        match self {
            Self::R8 => c[0],
            Self::Book => base256::unpack_book(c),
            Self::Upc => base256::unpack_upc(c),
        }
    }
}

/// GLSL `fract` as measured: min(x − floor(x), 1 − 2⁻²⁴), so that it stays below one.
fn fract(x: f32) -> f32 {
    (x - x.floor()).min(1.0 - f32::EPSILON / 2.0)
}
