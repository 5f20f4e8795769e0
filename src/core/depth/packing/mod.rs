//! Packings: window depth → UNORM8 channels → depth, each in its own exact order of operations.
//!
//! To add one: implement [`Pair`] in its family's file, add one line to the catalogue, one to
//! [`Packing::with_pair`] and one to [`Packing::worst_error`]. Tests, certificates, reports and command-line names follow.

mod base255;
mod base256;
mod bits;
mod digits;
mod error;
mod source;
#[cfg(feature = "toml")]
mod text;
mod three;

use super::arith::Number;
pub use source::Source;
#[cfg(feature = "toml")]
pub use text::TextPair;

/// A pack and its unpack, written once over [`Number`].
pub trait Pair: Copy + Send + Sync {
    /// How many of the four channels carry the depth.
    const CHANNELS: usize = 4;
    /// Whether depths of [2⁻⁶⁴, 1] keep to what [`Lean`](super::arith::Lean) asks; its constants are
    /// then known when it is compiled.
    const LEAN: bool = true;
    /// The channel values before the store; unused channels are 0.
    fn pack<A: Number>(&self, z: A) -> [A; 4];
    /// The depth of four sampled channels.
    fn unpack<A: Number>(&self, c: [A; 4]) -> A;
}

crate::catalogue! {
    /// A pack/unpack pair over UNORM8 channels in real use.
    pub enum Packing {
        /// The depth in the red channel alone (document 000, Shadow.js).
        R8 = "r8",
        /// Base 256, R most significant (documents 000 and 004).
        Book = "book",
        /// Base 256, A most significant (document 001, corrected).
        Upc = "upc",
        /// Base 256, lo-first (ozone3d, GLSL folk encoder of 2008).
        Ozone3d = "ozone3d",
        /// Base 256, lo-first (Godot 2, GLES2).
        Godot2 = "godot-2",
        /// Base 256, lo-first (mapbox-gl until #12005).
        Mapbox256 = "mapbox-256",
        /// Base 256, unmasked (Aras Pranckevičius, March 2007).
        Aras200703 = "aras-2007-03",
        /// Base 255, unmasked, plus 0.5/255 (Aras Pranckevičius, June 2007).
        Aras2007 = "aras-2007",
        /// Base 255, R most significant (Aras Pranckevičius, July 2009).
        Aras2009 = "aras-2009",
        /// Base 255, unmasked, with the miscopied scale 160581375.
        Aras160581375 = "aras-160581375",
        /// Base 255, all four channels masked (Unity EncodeFloatRGBA).
        UnityRgba = "unity-rgba",
        /// Base 255 in two channels (Unity EncodeFloatRG).
        UnityRg = "unity-rg",
        /// Base 255, R most significant (Cesium czm_packDepth since #4615).
        Cesium = "cesium",
        /// Base 255, lo-first (Babylon packingFunctions).
        Babylon = "babylon",
        /// Base 255, lo-first (Godot 3, USE_RGBA_SHADOWS).
        Godot3 = "godot-3",
        /// Base 255, lo-first (mapbox-gl since #12005).
        Mapbox255 = "mapbox-255",
        /// Packed in base 255 hi-first, unpacked in base 256 lo-first (ForgE).
        Forge = "forge",
        /// mod 256 of 255-fold digits (three.js r68…r85, PlayCanvas WebGL1).
        ThreeR68 = "three-r68",
        /// 256/255 upscale, lo-first (three.js r86…r166, luma.gl).
        ThreeR86 = "three-r86",
        /// Floor digits with end cases, RGBA (three.js r167 and later).
        ThreeRgba = "three-rgba",
        /// Floor digits with end cases, RGB (three.js r167 and later).
        ThreeRgb = "three-rgb",
        /// Floor digits with end cases, RG (three.js r167 and later).
        ThreeRg = "three-rg",
        /// Two channels of pack2HalfToRGBA (three.js VSM).
        ThreeHalf = "three-half",
        /// The float's bit pattern (PlayCanvas float-as-uint).
        PlaycanvasBits = "playcanvas-bits",
        /// Base 255 with floor(256·digit) bytes (PlayCanvas packFloat32ToRGBA8).
        PlaycanvasCpu = "playcanvas-cpu",
        /// Base 255 in two channels, both masked (PlayCanvas VSM8).
        PlaycanvasVsm8 = "playcanvas-vsm8",
        /// Integer digits, 16 bits in RG.
        Digits16 = "digits-16",
        /// Integer digits, 24 bits in RGB (the safe reference for f32 shaders).
        Digits24 = "digits-24",
        /// Integer digits, 32 bits in RGBA.
        Digits32 = "digits-32",
    }
}

/// Something to do with a pair whose type is known when it is compiled.
pub trait PairVisitor {
    /// What it returns.
    type Output;
    /// Does it.
    fn visit<P: Pair + 'static>(self, pair: P) -> Self::Output;
}

impl Packing {
    /// Calls `visitor` with the pair itself: the only place that knows which code a name means.
    pub fn with_pair<V: PairVisitor>(self, visitor: V) -> V::Output {
        match self {
            Self::R8 => visitor.visit(bits::R8),
            Self::Book => visitor.visit(base256::HighFirst),
            Self::Upc | Self::Ozone3d | Self::Godot2 | Self::Mapbox256 => {
                visitor.visit(base256::LowFirst)
            }
            Self::Aras200703 => visitor.visit(base256::Unmasked),
            Self::Aras2007 => visitor.visit(base255::HalfStep),
            Self::Aras2009 | Self::Cesium => visitor.visit(base255::HighFirst::<false>),
            Self::Aras160581375 => visitor.visit(base255::HighFirst::<true>),
            Self::UnityRgba => visitor.visit(base255::UnityRgba),
            Self::UnityRg => visitor.visit(base255::Rg::<false>),
            Self::Babylon | Self::Godot3 | Self::Mapbox255 => visitor.visit(base255::LowFirst),
            Self::Forge => visitor.visit(base255::Mismatched),
            Self::ThreeR68 => visitor.visit(three::R68),
            Self::ThreeR86 => visitor.visit(three::R86),
            Self::ThreeRgba => visitor.visit(three::R167::<4>),
            Self::ThreeRgb => visitor.visit(three::R167::<3>),
            Self::ThreeRg => visitor.visit(three::R167::<2>),
            Self::ThreeHalf => visitor.visit(three::Half),
            Self::PlaycanvasBits => visitor.visit(bits::FloatBits),
            Self::PlaycanvasCpu => visitor.visit(base255::PlayCanvasCpu),
            Self::PlaycanvasVsm8 => visitor.visit(base255::Rg::<true>),
            Self::Digits16 => visitor.visit(digits::Digits::<2>),
            Self::Digits24 => visitor.visit(digits::Digits::<3>),
            Self::Digits32 => visitor.visit(digits::Digits::<4>),
        }
    }

    /// The shader's channel values before the RGBA8 store, every operation rounded to f32, no FMA.
    #[must_use]
    pub fn pack(self, z: f32) -> [f32; 4] {
        self.pack_in(z)
    }

    /// The depth of four sampled channels, every operation rounded to f32, no FMA.
    #[must_use]
    pub fn unpack(self, c: [f32; 4]) -> f32 {
        self.unpack_in(c)
    }

    /// [`Self::pack`] in any arithmetic.
    #[must_use]
    pub fn pack_in<A: Number>(self, z: A) -> [A; 4] {
        struct Pack<A>(A);
        impl<A: Number> PairVisitor for Pack<A> {
            type Output = [A; 4];
            fn visit<P: Pair + 'static>(self, pair: P) -> [A; 4] {
                pair.pack(self.0)
            }
        }
        self.with_pair(Pack(z))
    }

    /// [`Self::unpack`] in any arithmetic.
    #[must_use]
    pub fn unpack_in<A: Number>(self, c: [A; 4]) -> A {
        struct Unpack<A>([A; 4]);
        impl<A: Number> PairVisitor for Unpack<A> {
            type Output = A;
            fn visit<P: Pair + 'static>(self, pair: P) -> A {
                pair.unpack(self.0)
            }
        }
        self.with_pair(Unpack(c))
    }

    /// The first packing of the catalogue with the very same operations (engines copy each other).
    #[must_use]
    pub fn original(self) -> Self {
        struct Code;
        impl PairVisitor for Code {
            type Output = std::any::TypeId;
            fn visit<P: Pair + 'static>(self, _: P) -> Self::Output {
                std::any::TypeId::of::<P>()
            }
        }
        let same = |other: &&Self| other.with_pair(Code) == self.with_pair(Code);
        *Self::ALL.iter().find(same).expect("it is in the catalogue itself")
    }

    /// How many UNORM8 channels carry the depth.
    #[must_use]
    pub fn channels(self) -> usize {
        struct Channels;
        impl PairVisitor for Channels {
            type Output = usize;
            fn visit<P: Pair + 'static>(self, _: P) -> usize {
                P::CHANNELS
            }
        }
        self.with_pair(Channels)
    }
}
