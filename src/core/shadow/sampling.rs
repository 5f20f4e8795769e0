//! How look-ups of maps find their texels, and where a tap lies from its look-up.

use crate::scene::{Filter, Wrap};

/// How look-ups of maps find their texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Texels read.
    pub filter: Filter,
    /// What lies beyond the edges.
    pub wrap: Wrap,
    /// Whether NEAREST coordinates are fixed point ([`super::sampler::nearest_texel`]).
    pub fixed: bool,
}

/// From the coordinate of a look-up to what one of its taps stands for, in units of u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    /// To the point that the filter samples.
    pub sample: [f32; 2],
    /// To the centre of the texel.
    pub centre: [f32; 2],
}
