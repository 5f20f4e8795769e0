//! What a material and an object say of a surface beside its shape: its sides, its holes, whether it
//! casts and receives shadows.

use super::alpha::Mask;
use std::sync::Arc;

crate::catalogue! {
    /// The sides of a surface that its material draws.
    pub enum Sides {
        /// The front alone, counter-clockwise (glTF without `doubleSided`; three.js FrontSide).
        Front = "front",
        /// The back alone (three.js BackSide).
        Back = "back",
        /// Both (glTF `doubleSided`; three.js DoubleSide).
        Both = "both",
    }
}

/// How a surface is drawn, into the picture and into maps.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// The sides that its material draws.
    pub sides: Sides,
    /// Where it has holes; `None` where it has none.
    pub mask: Option<Arc<Mask>>,
    /// Whether it throws shadows: is drawn into maps, and occludes in truth.
    pub casts: bool,
    /// Whether shadows fall on it; a surface that receives none counts in no rate.
    pub receives: bool,
}

/// Both sides, no holes, casting and receiving.
impl Default for Surface {
    fn default() -> Self {
        Self { sides: Sides::Both, mask: None, casts: true, receives: true }
    }
}
