//! Every bias strategy as three hooks: what casters store, where receivers look, what taps compare.
//!
//! A [`Recipe`] is plain data with all hooks; engines fill several fields at once. A [`Strategy`] is a
//! family of recipes with one parameter, so that it can be swept. Filters are orthogonal to both.

pub mod constant;
pub mod layers;
pub mod normal;
pub mod plane;
pub mod slope;
mod unit;

pub use constant::Weights;
use glam::{DVec2, DVec3};
pub use layers::Layers;
pub use normal::{NormalMove, NormalWeight};
pub use plane::Follow;
pub use slope::PolygonOffset;
pub use unit::Unit;

/// What a bias may know about a place on a surface. World units, f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// World position.
    pub position: DVec3,
    /// Unit normal on the side that is seen.
    pub normal: DVec3,
    /// Unit vector towards the light.
    pub to_light: DVec3,
    /// Edge of a texel there.
    pub texel_world: f64,
    /// Window depth per world unit along the light's axis.
    pub window_per_world: f64,
    /// Window depth of the surface's plane per unit of u and v; infinite where it is seen edge-on.
    pub gradient: DVec2,
    /// Width and height of the map in texels.
    pub map_size: [u32; 2],
}

/// All hooks of a bias. The default changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Caster: raster depth bias.
    pub polygon: PolygonOffset,
    /// Caster: vertices move inwards along their normals by this.
    pub caster_normal: NormalMove,
    /// Caster: vertices move away from the light, world units.
    pub caster_light: f64,
    /// Caster: the same in texel edges.
    pub caster_light_texels: f64,
    /// Caster: both moves grow by this times min(tan θ, 1) of the vertex' normal.
    pub caster_light_slope: f64,
    /// Caster: fragments move away from the light where their face looks at it and towards it where
    /// not, world units (oriented depth bias).
    pub oriented: f32,
    /// Caster: which surface is stored.
    pub layers: Layers,
    /// Caster: offset of [`Layers::Dual`], window depth.
    pub layer_offset: f32,
    /// Receiver: moves outwards along its normal.
    pub normal: NormalMove,
    /// Receiver: moves towards the light, world units.
    pub light: f64,
    /// Tap: constant, window depth.
    pub window: f32,
    /// Tap: constant, world units along the light's axis.
    pub world: f32,
    /// Tap: constant, texel edges along the light's axis.
    pub texels: f32,
    /// Tap: constant, steps of the format.
    pub steps: f32,
    /// Tap: multiples of the receiver's depth slope per texel.
    pub slope: f32,
    /// Tap: bound of the slope term, window depth; 0 for none.
    pub slope_clamp: f32,
    /// Tap: which depth is compared.
    pub follow: Follow,
}

impl Default for Recipe {
    fn default() -> Self {
        Self {
            polygon: PolygonOffset::default(),
            caster_normal: NormalMove::default(),
            caster_light: 0.0,
            caster_light_texels: 0.0,
            caster_light_slope: 0.0,
            oriented: 0.0,
            layers: Layers::Nearest,
            layer_offset: 0.0,
            normal: NormalMove::default(),
            light: 0.0,
            window: 0.0,
            world: 0.0,
            texels: 0.0,
            steps: 0.0,
            slope: 0.0,
            slope_clamp: 0.0,
            follow: Follow::Receiver,
        }
    }
}

impl Recipe {
    /// Whether receivers look elsewhere than at themselves.
    #[must_use]
    pub fn moves_receiver(&self) -> bool {
        self.normal.amount != 0.0 || self.light != 0.0
    }

    /// Whether casters' vertices move, so that they cover other texels.
    #[must_use]
    pub fn moves_vertices(&self) -> bool {
        self.caster_normal.amount != 0.0
            || self.caster_light != 0.0
            || self.caster_light_texels != 0.0
    }

    /// Whether the map stores anything else than without a bias.
    #[must_use]
    pub fn changes_map(&self) -> bool {
        let polygon = self.polygon.factor != 0.0 || self.polygon.units != 0.0;
        let layered = self.layers != Layers::Nearest || self.oriented != 0.0;
        polygon || layered || self.moves_vertices()
    }

    /// Where a receiver looks from, relative to itself. World units, f64.
    #[must_use]
    pub fn receiver_offset(&self, site: &Site) -> DVec3 {
        self.normal.offset(site) + site.to_light * self.light
    }

    /// Where a caster's vertex is drawn, relative to itself. World units, f64.
    #[must_use]
    pub fn vertex_offset(&self, site: &Site) -> DVec3 {
        let cosine = site.normal.dot(site.to_light).abs().clamp(1e-9, 1.0);
        let tangent = f64::sqrt(1.0 - cosine * cosine) / cosine;
        let away = (self.caster_light + self.caster_light_texels * site.texel_world)
            * (1.0 + self.caster_light_slope * tangent.min(1.0));
        -(self.caster_normal.offset(site) + site.to_light * away)
    }
}

/// r.Shadow.CSMSlopeScaleDepthBias 3 times a Shadow Slope Bias of 0.5 (Unreal Engine 5,
/// ShadowRendering.cpp, `UpdateShaderDepthBias`).
pub const UNREAL_SLOPE: f64 = 1.5;

crate::catalogue! {
    /// A family of biases with one parameter a ≥ 0, whose unit is [`Strategy::unit`].
    pub enum Strategy {
        /// No bias; the parameter does nothing. z against D.
        None = "none",
        /// z against D + a, a in window depth (the documents; three.js bias; learnopengl.com).
        Constant = "constant",
        /// z against D + a·dz/dW, a in world units along the light's axis.
        World = "world",
        /// z against D + a·s·dz/dW, a in texel edges s.
        Texels = "texels",
        /// z against D + a·q, a in steps q of the format at the receiver's depth.
        FormatSteps = "format-steps",
        /// Casters drawn at D + a·m + 1·r: slope-scaled polygon offset and one unit (GL, Vulkan, D3D,
        /// WebGPU).
        SlopeRaster = "slope-raster",
        /// Casters drawn at D + a·r: polygon offset in units alone.
        RasterUnits = "raster-units",
        /// Casters drawn at D + 10a·m + 10a·r (PlayCanvas shadowBias: slope and units are 10 times it).
        RasterPlaycanvas = "raster-playcanvas",
        /// z against D + min(a·m, 0.01), m the receiver's own depth slope per texel
        /// (opengl-tutorial.org tutorial 16: 0.005·tan(acos(N·L)) clamped to 0.01). Its reach ends at the
        /// clamp: a plane under a filter of half-width h keeps acne where h·s·|g|₁ > 0.01 window depth.
        ReceiverSlope = "receiver-slope",
        /// Receiver at p + a·N, a in world units (three.js normalBias).
        NormalOffset = "normal-offset",
        /// Receiver at p + a·√2·s·N (Bevy shadow_normal_bias).
        NormalBevy = "normal-bevy",
        /// Receiver at p + (a/2)·s·sin θ·N (Filament normalBias).
        NormalFilament = "normal-filament",
        /// Receiver at p + a·s·(1 − N·L)·N less its component along L (Godot normal_bias).
        NormalGodot = "normal-godot",
        /// Receiver at p + a·s·N (HDRP normalBias).
        NormalHdrp = "normal-hdrp",
        /// Receiver at p + a·√2·s·(sin θ/cos 0.534 + 0.195)·N (Blender EEVEE Next, a = 1).
        NormalBlender = "normal-blender",
        /// Receiver at p + a·(1 − N·L)·N, a in world units (Cesium normalOffsetScale).
        NormalCesium = "normal-cesium",
        /// Receiver at p + a·L, a in world units (Bevy shadow_depth_bias).
        LightOffset = "light-offset",
        /// Casters at p − a·s·sin θ·N (Unity built-in normal bias).
        CasterUnity = "caster-unity",
        /// Casters at p − a·s·(1 − N·L)·N (URP normal bias).
        CasterUrp = "caster-urp",
        /// Casters at p − a·sin θ·N, a in world units (Babylon normalBias).
        CasterBabylon = "caster-babylon",
        /// Casters at p − a·s·L (URP depth bias).
        CasterLight = "caster-light",
        /// Casters at p − (a/4)·s·(1 + 1.5·min(tan θ, 1))·L (Unreal CSM depth bias under a Shadow Bias
        /// and Shadow Slope Bias of 0.5 and a slope scale of 3).
        CasterUnreal = "caster-unreal",
        /// The receiver's plane at each texel's centre against D + a (receiver-plane depth bias,
        /// clamped to 0.01).
        ReceiverPlane = "receiver-plane",
        /// The receiver's plane at each tap against D + a (Isidoro 2006, as in MJP Shadows).
        ReceiverPlaneTap = "receiver-plane-tap",
        /// min(z, the plane at the texel's centre) against D + a·dz/dW (Dou et al. 2014, K = a).
        Adaptive = "adaptive",
        /// Only back faces are drawn; z against D + a.
        FrontCulling = "front-culling",
        /// The second nearest surface is stored; z against D + a (Wang and Molnar 1994).
        SecondDepth = "second-depth",
        /// The middle of the two nearest surfaces is stored; z against D + a (Woo 1992).
        Midpoint = "midpoint",
        /// z₁ + min((z₂ − z₁)/2, a) is stored (Weiskopf and Ertl 2003).
        DualLayer = "dual-layer",
        /// Casters drawn a world units farther where they face the light, nearer where not, and one
        /// slope m farther (oriented depth bias, Square Enix 2023).
        Oriented = "oriented",
    }
}

crate::catalogue! {
    /// How the errors of a strategy follow from its parameter.
    pub enum Family {
        /// Texels and stored depths stay: each tap has one breakpoint.
        Tap = "tap",
        /// Texels stay, stored depths grow with the parameter.
        Map = "map",
        /// Receivers look at other texels.
        Receiver = "receiver",
        /// Casters cover other texels.
        Vertex = "vertex",
    }
}

impl Strategy {
    /// The recipe at parameter `a`.
    #[must_use]
    pub fn with(self, a: f32) -> Recipe {
        use NormalWeight::{Blender, One, OneMinusCos, Sin};
        let none = Recipe::default();
        let a64 = f64::from(a);
        let along = |amount: f64, weight, in_texels| NormalMove {
            amount,
            weight,
            in_texels,
            ..NormalMove::default()
        };
        let receiver = |normal: NormalMove| Recipe { normal, ..none };
        let caster = |caster_normal: NormalMove| Recipe { caster_normal, ..none };
        let stored = |layers: Layers| Recipe { layers, window: a, ..none };
        let polygon = |factor, units| PolygonOffset { factor, units, clamp: 0.0 };
        let root2 = std::f64::consts::SQRT_2;
        match self {
            Self::None => none,
            Self::Constant => Recipe { window: a, ..none },
            Self::World => Recipe { world: a, ..none },
            Self::Texels => Recipe { texels: a, ..none },
            Self::FormatSteps => Recipe { steps: a, ..none },
            Self::SlopeRaster => Recipe { polygon: polygon(a, 1.0), ..none },
            Self::RasterUnits => Recipe { polygon: polygon(0.0, a), ..none },
            Self::RasterPlaycanvas => Recipe { polygon: polygon(10.0 * a, 10.0 * a), ..none },
            Self::ReceiverSlope => Recipe { slope: a, slope_clamp: 0.01, ..none },
            Self::NormalOffset => receiver(along(a64, One, false)),
            Self::NormalBevy => receiver(along(a64 * root2, One, true)),
            Self::NormalFilament => receiver(along(a64 / 2.0, Sin, true)),
            Self::NormalGodot => {
                receiver(NormalMove { sideways: true, ..along(a64, OneMinusCos, true) })
            }
            Self::NormalHdrp => receiver(along(a64, One, true)),
            Self::NormalBlender => receiver(along(a64 * root2, Blender, true)),
            Self::NormalCesium => receiver(along(a64, OneMinusCos, false)),
            Self::LightOffset => Recipe { light: a64, ..none },
            Self::CasterUnity => caster(along(a64, Sin, true)),
            Self::CasterUrp => caster(along(a64, OneMinusCos, true)),
            Self::CasterBabylon => caster(along(a64, Sin, false)),
            Self::CasterLight => Recipe { caster_light_texels: a64, ..none },
            Self::CasterUnreal => {
                Recipe { caster_light_texels: a64 / 4.0, caster_light_slope: UNREAL_SLOPE, ..none }
            }
            Self::ReceiverPlane => Recipe { follow: Follow::TexelCentre, window: a, ..none },
            Self::ReceiverPlaneTap => Recipe { follow: Follow::Sample, window: a, ..none },
            Self::Adaptive => Recipe { follow: Follow::NearerOfCentre, world: a, ..none },
            Self::FrontCulling => stored(Layers::BackFaces),
            Self::SecondDepth => stored(Layers::Second),
            Self::Midpoint => stored(Layers::Midpoint),
            Self::DualLayer => Recipe { layers: Layers::Dual, layer_offset: a, ..none },
            Self::Oriented => Recipe { oriented: a, polygon: polygon(1.0, 0.0), ..none },
        }
    }

    /// The parameter's unit.
    #[must_use]
    pub const fn unit(self) -> Unit {
        match self {
            Self::None => Unit::Nothing,
            Self::Constant
            | Self::ReceiverPlane
            | Self::ReceiverPlaneTap
            | Self::FrontCulling
            | Self::SecondDepth
            | Self::Midpoint
            | Self::DualLayer => Unit::WindowDepth,
            Self::World
            | Self::NormalOffset
            | Self::NormalCesium
            | Self::LightOffset
            | Self::CasterBabylon
            | Self::Adaptive
            | Self::Oriented => Unit::WorldUnits,
            Self::Texels
            | Self::NormalHdrp
            | Self::CasterUnity
            | Self::CasterUrp
            | Self::CasterLight
            | Self::NormalGodot => Unit::Texels,
            Self::FormatSteps => Unit::FormatSteps,
            Self::SlopeRaster | Self::ReceiverSlope => Unit::Slopes,
            Self::RasterPlaycanvas => Unit::TenthsOfASlope,
            Self::RasterUnits => Unit::UnitsR,
            Self::NormalBevy => Unit::TexelDiagonals,
            Self::NormalFilament => Unit::HalfTexels,
            Self::CasterUnreal => Unit::QuarterTexels,
            Self::NormalBlender => Unit::OwnMultiples,
        }
    }

    /// What has to be evaluated anew when the parameter changes.
    #[must_use]
    pub const fn family(self) -> Family {
        match self {
            Self::SlopeRaster
            | Self::RasterUnits
            | Self::RasterPlaycanvas
            | Self::DualLayer
            | Self::Oriented => Family::Map,
            Self::NormalOffset
            | Self::NormalBevy
            | Self::NormalFilament
            | Self::NormalGodot
            | Self::NormalHdrp
            | Self::NormalBlender
            | Self::NormalCesium
            | Self::LightOffset => Family::Receiver,
            Self::CasterUnity
            | Self::CasterUrp
            | Self::CasterBabylon
            | Self::CasterLight
            | Self::CasterUnreal => Family::Vertex,
            _ => Family::Tap,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_family_is_what_its_recipes_change() {
        for &strategy in Strategy::ALL {
            let recipe = strategy.with(0.25);
            match strategy.family() {
                Family::Tap => assert!(!recipe.moves_receiver() && !recipe.moves_vertices()),
                Family::Map => assert!(recipe.changes_map() && !recipe.moves_vertices()),
                Family::Receiver => assert!(recipe.moves_receiver() && !recipe.changes_map()),
                Family::Vertex => assert!(recipe.moves_vertices()),
            }
        }
    }
}
