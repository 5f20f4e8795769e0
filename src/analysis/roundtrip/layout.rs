//! How each packing lays its digits out: what a bound needs to know of it.

use super::conditions::Texels;
use crate::depth::Packing;
use crate::num::exp2;
use std::ops::RangeInclusive;

/// Masked digits, the channel after them, and what f32 rounds on the way.
pub(super) struct Layout {
    /// Ratio of neighbouring weights.
    pub(super) base: f64,
    /// Window depth per leading digit is 1/leading.
    pub(super) leading: f64,
    /// Masked channels before the last.
    pub(super) masked: u32,
    /// How many digits a masked channel can hold.
    pub(super) digits: u32,
    /// How a digit is written.
    pub(super) digit: Digit,
    /// Weight of the last channel.
    pub(super) last_weight: f64,
    /// Greatest error of the last channel, from that of storing any value.
    pub(super) last: fn(f64) -> f64,
    /// What f32 rounds in the pack, weighed.
    pub(super) pack: f64,
    /// What f32 rounds in the unpack.
    pub(super) sums: Sums,
}

/// How the unpack sums.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Sums {
    /// Errs by so much.
    Rounded(f64),
    /// Multiples of 1/256ⁱ below 1 and one last term: exact but for the last rounding, and `partial`
    /// where the sum starts with the last term.
    Exact {
        /// Roundings before the last one.
        partial: f64,
    },
}

/// How digit k of a masked channel is written and what it stands for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Digit {
    /// k/256 as it is.
    Of256,
    /// k/256 stretched by 256/255, and shrunk again by the weights.
    Stretched,
    /// Digits whose leading one enters as k·(1/255).
    StretchedFromLead,
    /// k/255, a few ulps off.
    NearOf255,
    /// A byte k as k/255.
    Byte,
}

impl Digit {
    /// The greatest of decoded − digit and of digit − decoded (at least 0), weight 1.
    pub(super) fn extremes(
        self,
        texels: &Texels,
        leads: bool,
        digits: RangeInclusive<u32>,
    ) -> (f64, f64) {
        if self == Self::NearOf255 && texels.truncates() {
            let sampler = texels.sampler_error();
            return (sampler, 1.0 / 255.0 + sampler);
        }
        let error = |k: u32| self.error(texels, leads, f64::from(k));
        digits.map(error).fold((0.0, 0.0), |(up, down), e| (up.max(e), down.max(-e)))
    }

    fn error(self, texels: &Texels, leads: bool, k: f64) -> f64 {
        let of_255 = texels.rounded(k / 255.0);
        let stretched = |channel: f64| {
            let sampled = texels.sampled(texels.rounded(channel));
            texels.rounded(sampled * (255.0 / 256.0)) - k / 256.0
        };
        match self {
            Self::Of256 => texels.sampled(k / 256.0) - k / 256.0,
            Self::NearOf255 | Self::Byte => texels.sampled(of_255) - k / 255.0,
            Self::StretchedFromLead if leads => stretched(k * texels.rounded(1.0 / 255.0)),
            Self::Stretched | Self::StretchedFromLead => {
                stretched(k / 256.0 * texels.rounded(256.0 / 255.0))
            }
        }
    }
}

fn power(base: f64, n: u32) -> f64 {
    (0..n).fold(1.0, |product, _| product * base)
}

const STEP: f64 = 1.0 / 255.0;
/// Roundings of a sum that starts with the greatest term, of one that ends with it, and of one sum.
const HIGH_FIRST: f64 = exp2(-23);
const LOW_FIRST: f64 = exp2(-24) + exp2(-31);
const ONE_SUM: f64 = exp2(-24);
/// fl(255ⁱz), and the products with rounded 1/255ⁱ.
const PACK_255: f64 = exp2(-25) * (1.0 + 1.0 / 32.0);

fn of_256(masked: u32, digit: Digit) -> Layout {
    Layout {
        base: 256.0,
        leading: 256.0,
        masked,
        digits: 256,
        digit,
        last_weight: 1.0 / power(256.0, masked),
        last: |error| error,
        pack: 0.0,
        sums: Sums::Exact { partial: 0.0 },
    }
}

fn of_255(masked: u32, sum: f64, last: fn(f64) -> f64) -> Layout {
    Layout {
        base: 255.0,
        leading: 255.0,
        masked,
        digits: 255,
        digit: Digit::NearOf255,
        last_weight: 1.0 / power(255.0, masked),
        last,
        pack: PACK_255,
        sums: Sums::Rounded(sum),
    }
}

/// The layout of a packing whose channels telescope.
pub(super) fn layout(packing: Packing) -> Option<Layout> {
    let loses_a_step = |error: f64| error + STEP;
    Some(match packing {
        Packing::R8 => Layout { sums: Sums::Rounded(0.0), ..of_256(0, Digit::Of256) },
        Packing::Book => Layout { sums: Sums::Rounded(HIGH_FIRST), ..of_256(3, Digit::Of256) },
        Packing::Upc | Packing::Ozone3d | Packing::Godot2 | Packing::Mapbox256 => {
            Layout { sums: Sums::Rounded(LOW_FIRST), ..of_256(3, Digit::Of256) }
        }
        Packing::Aras2009 | Packing::Cesium => of_255(3, HIGH_FIRST, |error| error),
        Packing::Babylon | Packing::Godot3 | Packing::Mapbox255 => {
            of_255(3, LOW_FIRST, |error| error)
        }
        // The last channel is masked with itself.
        Packing::UnityRgba => of_255(3, HIGH_FIRST, loses_a_step),
        Packing::PlaycanvasVsm8 => of_255(1, ONE_SUM, loses_a_step),
        Packing::UnityRg | Packing::ThreeHalf => of_255(1, ONE_SUM, |error| error),
        // The third channel loses a 255th of a fourth that is no digit of it, and which returns with
        // 65025/160581375 of the third's weight.
        Packing::Aras160581375 => {
            of_255(2, HIGH_FIRST, |error| error + STEP - 65_025.0 / 160_581_375.0 * (1.0 - error))
        }
        // Bytes floor(256·digit): any value of the last digit is off by a step at most.
        Packing::PlaycanvasCpu => {
            Layout { digit: Digit::Byte, ..of_255(3, HIGH_FIRST, |_| 1.0 / 255.0) }
        }
        // All four digits are cut from fl(255z).
        Packing::ThreeR68 => Layout {
            leading: 255.0,
            digit: Digit::NearOf255,
            // mod 256 of 255 digits: up to 256/255, clamped to 1.
            last: |error| error.max(STEP),
            pack: PACK_255,
            sums: Sums::Rounded(LOW_FIRST),
            ..of_256(3, Digit::Of256)
        },
        // The last remainder is stretched too, to 256/255 at most, and clamped to 1.
        Packing::ThreeR86 => Layout {
            last_weight: 255.0 / 256.0 / power(256.0, 3),
            last: |error| error.max(STEP),
            sums: Sums::Exact { partial: exp2(-33) + exp2(-41) },
            ..of_256(3, Digit::Stretched)
        },
        Packing::ThreeRgba => of_256(3, Digit::StretchedFromLead),
        Packing::ThreeRgb => of_256(2, Digit::StretchedFromLead),
        Packing::ThreeRg => of_256(1, Digit::StretchedFromLead),
        // Channels that do not telescope: digits by themselves, whole bit patterns, pairs that do not match.
        Packing::Aras200703
        | Packing::Aras2007
        | Packing::Forge
        | Packing::PlaycanvasBits
        | Packing::Digits16
        | Packing::Digits24
        | Packing::Digits32 => return None,
    })
}
