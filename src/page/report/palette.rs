//! The colours of every page, plot and picture, defined once.
//!
//! The categorical set is Okabe and Ito's ("Color Universal Design", 2008), told apart with any
//! common colour blindness; the magnitude ramp is viridis, monotone in lightness.

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

gnomon_core::catalogue! {
    /// A named colour. A class keeps its colour on every page, in plots and in pictures.
    pub enum Colour {
        /// Near black: text, outlines, the document's own line.
        Ink = "ink",
        /// Mid grey: what is counted apart.
        Grey = "grey",
        /// Light grey: background.
        Light = "light",
        /// White.
        White = "white",
        /// Okabe-Ito blue.
        Blue = "blue",
        /// Okabe-Ito sky blue.
        Sky = "sky",
        /// Okabe-Ito bluish green.
        Green = "green",
        /// Okabe-Ito yellow.
        Yellow = "yellow",
        /// Okabe-Ito orange.
        Orange = "orange",
        /// Okabe-Ito vermilion.
        Vermilion = "vermilion",
        /// Okabe-Ito reddish purple.
        Purple = "purple",
    }
}

#[allow(clippy::derivable_impls, reason = "a catalogue's members carry names, not attributes")]
impl Default for Colour {
    fn default() -> Self {
        Self::Ink
    }
}

impl Colour {
    /// Colours for series without a meaning of their own, in order of use.
    pub const SERIES: [Self; 8] = [
        Self::Blue,
        Self::Vermilion,
        Self::Green,
        Self::Purple,
        Self::Orange,
        Self::Sky,
        Self::Ink,
        Self::Yellow,
    ];

    /// The `index`-th series colour, starting again after eight.
    #[must_use]
    pub const fn series(index: usize) -> Self {
        Self::SERIES[index % Self::SERIES.len()]
    }

    /// sRGB bytes.
    #[must_use]
    pub const fn rgb(self) -> [u8; 3] {
        match self {
            Self::Ink => [28, 28, 32],
            Self::Grey => [138, 138, 142],
            Self::Light => [222, 222, 226],
            Self::White => [255, 255, 255],
            Self::Blue => [0, 114, 178],
            Self::Sky => [86, 180, 233],
            Self::Green => [0, 158, 115],
            Self::Yellow => [240, 228, 66],
            Self::Orange => [230, 159, 0],
            Self::Vermilion => [213, 94, 0],
            Self::Purple => [204, 121, 167],
        }
    }

    /// `#rrggbb`.
    #[must_use]
    pub fn css(self) -> String {
        css(self.rgb())
    }
}

/// `#rrggbb` of sRGB bytes.
#[must_use]
pub fn css([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Viridis at `t` in [0, 1] (clamped; NaN gives the loud colour).
#[must_use]
pub fn magnitude(t: f64) -> [u8; 3] {
    if t.is_nan() {
        return Colour::Vermilion.rgb();
    }
    let RGBColor(r, g, b) = ViridisRGB.get_color(t.clamp(0.0, 1.0));
    [r, g, b]
}

/// Blue below zero, white at zero, orange above, at `t` in [-1, 1] (clamped; NaN gives the loud
/// colour).
#[must_use]
pub fn signed(t: f64) -> [u8; 3] {
    if t.is_nan() {
        return Colour::Vermilion.rgb();
    }
    let end = if t < 0.0 { Colour::Blue } else { Colour::Orange }.rgb();
    let weight = t.abs().min(1.0);
    end.map(|channel| (255.0 + (f64::from(channel) - 255.0) * weight).round() as u8)
}

/// Ink or white, whichever reads better on `background` (WCAG relative luminance).
#[must_use]
pub fn text_on(background: [u8; 3]) -> Colour {
    let linear = |byte: u8| {
        let c = f64::from(byte) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    };
    let [r, g, b] = background.map(linear);
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    if luminance > 0.22 { Colour::Ink } else { Colour::White }
}
