//! The words in which a case fixes its pipeline: how it transforms, draws, stores and compares.

use super::filter::Filter;
use super::texel::{DepthBuffer, TexelFormat};
use crate::depth::DepthFormat;
use crate::view::{ClipRange, ClipSpace};

crate::catalogue! {
    /// The f32 form in which a shader turns the interpolated light position into map coordinates
    /// and depth. All mean the same; they round differently.
    pub enum CoordForm {
        /// (xyz / w) / 2 + 0.5 (documents 000, 004).
        DivideHalveAdd = "(xyz / w) / 2 + 0.5",
        /// (0.5 · xyz) / w + 0.5 (document 001).
        HalveDivideAdd = "(0.5 * xyz) / w + 0.5",
        /// xyz / w, the halving and adding being in the matrix (documents 002, 003).
        Divide = "xyz / w",
    }
}

impl CoordForm {
    /// Map coordinates u, v and compared depth z ([`ClipSpace::compared`]), each operation rounded to f32.
    /// Where z/w is a window depth already, it is neither halved nor moved.
    #[must_use]
    pub fn apply(self, p: glam::Vec4, clip: ClipSpace) -> [f32; 3] {
        let halved = |x: f32| match self {
            Self::DivideHalveAdd => (x / p.w) / 2.0 + 0.5,
            Self::HalveDivideAdd => (0.5 * x) / p.w + 0.5,
            Self::Divide => x / p.w,
        };
        let depth = match clip.range {
            ClipRange::MinusOneToOne => halved(p.z),
            ClipRange::ZeroToOne => p.z / p.w,
        };
        [halved(p.x), halved(p.y), clip.compared(depth)]
    }
}

crate::catalogue! {
    /// When a tap is in shadow: receiver depth z, stored depth D, bias b. A larger b never darkens.
    pub enum CompareRule {
        /// Shadow if z > D + b (documents 000, 004).
        ReceiverBeyond = "z > D + b",
        /// Lit if D + b > z, so that a tie is shadow (document 001).
        NotStoredBeyond = "!(D + b > z)",
        /// Shadow if D ≤ z + b with the document's negative b (document 002).
        StoredAtMost = "D <= z + b",
        /// Lit if z − b < D (document 003).
        NotReceiverBefore = "!(z - b < D)",
    }
}

impl CompareRule {
    /// The document's literal f32 rule. `bias` ≥ 0 repairs acne whatever sign the document writes.
    #[must_use]
    #[inline(always)]
    pub fn is_lit(self, z: f32, stored: f32, bias: f32) -> bool {
        match self {
            Self::ReceiverBeyond => !(z > stored + bias),
            Self::NotStoredBeyond => stored + bias > z,
            Self::StoredAtMost => !(stored <= z + -bias),
            Self::NotReceiverBefore => z - bias < stored,
        }
    }

    /// About the smallest bias at which the literal rule says lit: where the exact sum or difference
    /// passes the middle between two floats, so that its rounding turns the comparison. Rounded to f32,
    /// hence off by a few of its steps; a starting point, not a promise.
    #[must_use]
    #[inline(always)]
    pub fn turning_point(self, z: f32, stored: f32) -> f32 {
        let middle = |a: f32, b: f32| (f64::from(a) + f64::from(b)) * 0.5;
        let exact = match self {
            Self::ReceiverBeyond => middle(z.next_down(), z) - f64::from(stored),
            Self::NotStoredBeyond => middle(z, z.next_up()) - f64::from(stored),
            Self::StoredAtMost | Self::NotReceiverBefore => {
                f64::from(z) - middle(stored.next_down(), stored)
            }
        };
        exact as f32
    }

    /// This rule on exact values (f64 operands whose sums round far below the depths' ulps).
    #[must_use]
    pub fn is_lit_exact(self, z: f64, stored: f64, bias: f64) -> bool {
        match self {
            Self::ReceiverBeyond => z - stored <= bias,
            Self::NotStoredBeyond | Self::StoredAtMost | Self::NotReceiverBefore => {
                z - stored < bias
            }
        }
    }

    /// Factor between the bias as documents write it and the bias that repairs acne.
    #[must_use]
    pub const fn bias_sign(self) -> f32 {
        match self {
            Self::StoredAtMost => -1.0,
            Self::ReceiverBeyond | Self::NotStoredBeyond | Self::NotReceiverBefore => 1.0,
        }
    }
}

crate::catalogue! {
    /// What happens to coordinates outside [0, 1].
    pub enum Wrap {
        /// The border texel goes on for ever.
        Clamp = "clamp-to-edge",
        /// The map repeats.
        Repeat = "repeat",
    }
}

crate::catalogue! {
    /// Which faces a pass leaves out.
    pub enum Cull {
        /// None.
        None = "none",
        /// Front faces (counter-clockwise on the screen).
        Front = "front",
        /// Back faces.
        Back = "back",
    }
}

impl Cull {
    /// The other face, where front and back change places.
    #[must_use]
    pub const fn turned(self) -> Self {
        match self {
            Self::None => Self::None,
            Self::Front => Self::Back,
            Self::Back => Self::Front,
        }
    }
}

crate::catalogue! {
    /// Which faces a map leaves out: the same of every object, or by each one's material.
    pub enum CullRule {
        /// None.
        None = "none",
        /// Front faces of every object.
        Front = "front",
        /// Back faces of every object.
        Back = "back",
        /// What the material does not draw: back faces where it draws the front alone.
        Material = "material",
        /// The sides opposite to the material's are drawn: back faces where it draws the front alone
        /// (three.js without `shadowSide`).
        MaterialOpposite = "material-opposite",
    }
}

impl From<Cull> for CullRule {
    fn from(cull: Cull) -> Self {
        match cull {
            Cull::None => Self::None,
            Cull::Front => Self::Front,
            Cull::Back => Self::Back,
        }
    }
}

/// How a light's maps are drawn and kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapSpec {
    /// Texels along the longest side of a whole texture, of which each map has its part
    /// ([`Viewport`](crate::light::Viewport)).
    pub size: u32,
    /// What a texel holds.
    pub texel: TexelFormat,
    /// Clear colour of a packed map in [0, 1] (depth textures clear to 1, reversed ones to 0).
    pub clear: [f32; 4],
    /// The pass' depth attachment.
    pub depth_buffer: DepthBuffer,
    /// Faces left out of the map.
    pub cull: CullRule,
}

impl MapSpec {
    /// This map with another size and format. A packing keeps the clear colour of a packing, others
    /// clear to white; a depth texture is its own depth attachment.
    #[must_use]
    pub fn with(&self, size: u32, texel: TexelFormat) -> Self {
        let keeps = self.texel.is_packed() && texel.is_packed();
        Self {
            size,
            texel,
            clear: if keeps { self.clear } else { [1.0; 4] },
            depth_buffer: if texel.is_packed() { self.depth_buffer } else { DepthBuffer::Texture },
            cull: self.cull,
        }
    }

    /// The format of the depth attachment, in whose unit r a polygon offset counts.
    #[must_use]
    pub const fn attachment(&self) -> DepthFormat {
        self.texel.attachment(self.depth_buffer)
    }
}

/// How a receiver looks the map up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookupSpec {
    /// Arithmetic of the coordinate.
    pub coord: CoordForm,
    /// The comparison.
    pub compare: CompareRule,
    /// Whether receivers outside the map's square are lit without a look-up.
    pub range_test: bool,
    /// Texels read.
    pub filter: Filter,
    /// Coordinates outside.
    pub wrap: Wrap,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_are_decided_as_each_document_writes() {
        let lit = |rule: CompareRule| rule.is_lit(0.5, 0.5, 0.0);
        assert!(lit(CompareRule::ReceiverBeyond), "strict >");
        assert!(!lit(CompareRule::NotStoredBeyond), "strict > the other way");
        assert!(!lit(CompareRule::StoredAtMost), "<=");
        assert!(!lit(CompareRule::NotReceiverBefore), "strict <");
    }

    #[test]
    fn bias_lights_every_rule() {
        for &rule in CompareRule::ALL {
            assert!(!rule.is_lit(0.5, 0.49, 0.0), "{rule}: an occluder shadows");
            assert!(rule.is_lit(0.5, 0.49, 0.02), "{rule}: a larger bias hides it");
            assert!(rule.is_lit_exact(0.5, 0.49, 0.02), "{rule}: exactly too");
        }
    }
}
