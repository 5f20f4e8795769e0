//! Packings: window depth → UNORM8 channels → depth, each in its own exact order of operations.
//!
//! To add one: implement [`Pair`] in its family's file and add its row. Tests, certificates, reports and
//! command-line names follow.

mod base255;
mod base256;
mod bits;
mod digits;
#[macro_use]
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

/// What is known of a packing beside its name and its pair.
struct Row {
    worst_error: f64,
    source: Option<Source>,
}

/// The catalogue, and which code a name means: every row is name, pair, worst error, shader text.
macro_rules! packings {
    ($(#[$meta:meta])* pub enum Packing {
        $($(#[doc = $doc:literal])+ $Item:ident = $name:literal => $pair:expr, $error:expr, $source:expr;)+
    }) => {
        crate::catalogue! {
            $(#[$meta])*
            pub enum Packing: Row {
                $($(#[doc = $doc])+ $Item = $name => Row { worst_error: $error, source: $source }),+
            }
        }

        impl Packing {
            /// Calls `visitor` with the pair itself: the only place that knows which code a name means.
            pub fn with_pair<V: PairVisitor>(self, visitor: V) -> V::Output {
                match self { $(Self::$Item => visitor.visit($pair)),+ }
            }
        }
    };
}

packings! {
    /// A pack/unpack pair over UNORM8 channels in real use.
    pub enum Packing {
        /// The depth in the red channel alone (document 000, Shadow.js).
        R8 = "r8" => bits::R8, 0.0019608139991760254, source!("r8");
        /// Base 256, R most significant (documents 000 and 004).
        Book = "book" => base256::HighFirst, 0.001968562602996826, source!("book");
        /// Base 256, A most significant (document 001, corrected).
        Upc = "upc" => base256::LowFirst, 0.0019685029983520508, source!("upc");
        /// Base 256, lo-first (ozone3d, GLSL folk encoder of 2008).
        Ozone3d = "ozone3d" => base256::LowFirst, 0.0019685029983520508, None;
        /// Base 256, lo-first (Godot 2, GLES2).
        Godot2 = "godot-2" => base256::LowFirst, 0.0019685029983520508, None;
        /// Base 256, lo-first (mapbox-gl until #12005).
        Mapbox256 = "mapbox-256" => base256::LowFirst, 0.0019685029983520508, None;
        /// Base 256, unmasked (Aras Pranckevičius, March 2007).
        Aras200703 = "aras-2007-03" => base256::Unmasked, 0.005867093801498413, None;
        /// Base 255, unmasked, plus 0.5/255 (Aras Pranckevičius, June 2007).
        Aras2007 = "aras-2007" => base255::HalfStep, 0.007858633995056152, None;
        /// Base 255, R most significant (Aras Pranckevičius, July 2009).
        Aras2009 = "aras-2009" => base255::HighFirst::<false>, 1.1920928955078125e-07, source!("aras-2009");
        /// Base 255, unmasked, with the miscopied scale 160581375.
        Aras160581375 = "aras-160581375" => base255::HighFirst::<true>, 1.1920928955078125e-07, None;
        /// Base 255, all four channels masked (Unity EncodeFloatRGBA).
        UnityRgba = "unity-rgba" => base255::UnityRgba, 1.1920928955078125e-07, None;
        /// Base 255 in two channels (Unity EncodeFloatRG).
        UnityRg = "unity-rg" => base255::Rg::<false>, 7.748603820800781e-06, None;
        /// Base 255, R most significant (Cesium czm_packDepth since #4615).
        Cesium = "cesium" => base255::HighFirst::<false>, 1.1920928955078125e-07, None;
        /// Base 255, lo-first (Babylon packingFunctions).
        Babylon = "babylon" => base255::LowFirst, 1.1920928955078125e-07, None;
        /// Base 255, lo-first (Godot 3, USE_RGBA_SHADOWS).
        Godot3 = "godot-3" => base255::LowFirst, 1.1920928955078125e-07, None;
        /// Base 255, lo-first (mapbox-gl since #12005).
        Mapbox255 = "mapbox-255" => base255::LowFirst, 1.1920928955078125e-07, None;
        /// Packed in base 255 hi-first, unpacked in base 256 lo-first (ForgE).
        Forge = "forge" => base255::Mismatched, 1.003875494003296, None;
        /// mod 256 of 255-fold digits (three.js r68…r85, PlayCanvas WebGL1).
        ThreeR68 = "three-r68" => three::R68, 5.960464477539063e-08, None;
        /// 256/255 upscale, lo-first (three.js r86…r166, luma.gl).
        ThreeR86 = "three-r86" => three::R86, 2.3282709094019083e-10, None;
        /// Floor digits with end cases, RGBA (three.js r167 and later).
        ThreeRgba = "three-rgba" => three::R167::<4>, 2.3283064365386963e-10, source!("three-rgba");
        /// Floor digits with end cases, RGB (three.js r167 and later).
        ThreeRgb = "three-rgb" => three::R167::<3>, 5.960464477539063e-08, None;
        /// Floor digits with end cases, RG (three.js r167 and later).
        ThreeRg = "three-rg" => three::R167::<2>, 7.68899917602539e-06, None;
        /// Two channels of pack2HalfToRGBA (three.js VSM).
        ThreeHalf = "three-half" => three::Half, 7.748603820800781e-06, None;
        /// The float's bit pattern (PlayCanvas float-as-uint).
        PlaycanvasBits = "playcanvas-bits" => bits::FloatBits, 0.0, None;
        /// Base 255 with floor(256·digit) bytes (PlayCanvas packFloat32ToRGBA8).
        PlaycanvasCpu = "playcanvas-cpu" => base255::PlayCanvasCpu, 1.1920928955078125e-07, None;
        /// Base 255 in two channels, both masked (PlayCanvas VSM8).
        PlaycanvasVsm8 = "playcanvas-vsm8" => base255::Rg::<true>, 2.3037195205688477e-05, None;
        /// Integer digits, 16 bits in RG.
        Digits16 = "digits-16" => digits::Digits::<2>, 7.68899917602539e-06, None;
        /// Integer digits, 24 bits in RGB (the safe reference for f32 shaders).
        Digits24 = "digits-24" => digits::Digits::<3>, 5.960464477539063e-08, source!("digits-24");
        /// Integer digits, 32 bits in RGBA.
        Digits32 = "digits-32" => digits::Digits::<4>, 1.1641532182693481e-10, None;
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
    /// The largest |decoded − z| over all floats z ∈ [0, 1), window depth: f32 arithmetic without FMA,
    /// bytes stored to nearest even and sampled as k/255. Certified exhaustively; a test holds each to
    /// the committed certificate.
    #[must_use]
    pub const fn worst_error(self) -> f64 {
        self.row().worst_error
    }

    /// The packings that have a [`Source`], in catalogue order.
    pub fn with_source() -> impl Iterator<Item = (Self, Source)> {
        Self::ALL.iter().filter_map(|&packing| Some((packing, packing.row().source?)))
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
