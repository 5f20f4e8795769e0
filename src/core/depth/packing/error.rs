//! The largest round-trip error of each packing, as its certificate says.

use super::Packing;

impl Packing {
    /// The largest |decoded − z| over all floats z ∈ [0, 1), window depth: f32 arithmetic without FMA,
    /// bytes stored to nearest even and sampled as k/255. Certified exhaustively; a test holds each to
    /// the committed certificate.
    #[must_use]
    pub const fn worst_error(self) -> f64 {
        match self {
            Self::R8 => 0.0019608139991760254,
            Self::Book => 0.001968562602996826,
            Self::Upc | Self::Ozone3d | Self::Godot2 | Self::Mapbox256 => 0.0019685029983520508,
            Self::Aras200703 => 0.005867093801498413,
            Self::Aras2007 => 0.007858633995056152,
            Self::Aras2009
            | Self::Aras160581375
            | Self::UnityRgba
            | Self::Cesium
            | Self::Babylon
            | Self::Godot3
            | Self::Mapbox255
            | Self::PlaycanvasCpu => 1.1920928955078125e-07,
            Self::UnityRg | Self::ThreeHalf => 7.748603820800781e-06,
            Self::Forge => 1.003875494003296,
            Self::ThreeR68 | Self::ThreeRgb | Self::Digits24 => 5.960464477539063e-08,
            Self::ThreeR86 => 2.3282709094019083e-10,
            Self::ThreeRgba => 2.3283064365386963e-10,
            Self::ThreeRg | Self::Digits16 => 7.68899917602539e-06,
            Self::PlaycanvasBits => 0.0,
            Self::PlaycanvasVsm8 => 2.3037195205688477e-05,
            Self::Digits32 => 1.1641532182693481e-10,
        }
    }
}
