//! Every bias strategy as one row: its name, what it does, its unit, and its recipe at an amount.
//!
//! To add one, add its row. Its [`Family`], its cost, its units in engines and its place in sweeps follow
//! from the recipe.

use super::MoveNormal::{Face, Interpolated, Shading, Vertices};
use super::NormalWeight::{Blender, One, OneMinusCos, Sin};
use super::Unit::{
    ClipDepth, FormatSteps, HalfTexels, Nothing, OwnMultiples, QuarterTexels, Slopes,
    TenthsOfASlope, TexelDiagonals, Texels, UnitsR, WindowDepth, WorldUnits,
};
use super::rule::{self, BiasRule, Rule};
use super::{
    Family, Follow, Layers, MoveNormal, NormalMove, NormalWeight, PolygonOffset, Recipe, Unit,
};
use std::f64::consts::SQRT_2;

/// r.Shadow.CSMSlopeScaleDepthBias 3 times a Shadow Slope Bias of 0.5 (Unreal Engine 5,
/// ShadowRendering.cpp, `UpdateShaderDepthBias`).
pub const UNREAL_SLOPE: f64 = 1.5;

/// What is known of a strategy beside its name.
struct Row {
    unit: Unit,
    recipe: fn(f64) -> Recipe,
}

const fn row(unit: Unit, recipe: fn(f64) -> Recipe) -> Row {
    Row { unit, recipe }
}

const NONE: Recipe = Recipe::NONE;

const fn world(amount: f64, weight: NormalWeight, along: MoveNormal) -> NormalMove {
    NormalMove { amount, weight, in_texels: false, sideways: false, along }
}

const fn texels(amount: f64, weight: NormalWeight, along: MoveNormal) -> NormalMove {
    NormalMove { in_texels: true, ..world(amount, weight, along) }
}

const fn receiver(normal: NormalMove) -> Recipe {
    Recipe { normal, ..NONE }
}

const fn caster(caster_normal: NormalMove) -> Recipe {
    Recipe { caster_normal, ..NONE }
}

const fn window(a: f64, layers: Layers) -> Recipe {
    Recipe { window: a as f32, layers, ..NONE }
}

const fn polygon(factor: f64, units: f64) -> Recipe {
    let polygon = PolygonOffset { factor: factor as f32, units: units as f32, clamp: 0.0 };
    Recipe { polygon, ..NONE }
}

fn shader(rule: &'static dyn BiasRule, a: f64) -> Recipe {
    Recipe { rule: Some(Rule { rule, amounts: [a as f32, 0.0] }), ..NONE }
}

crate::catalogue! {
    /// A family of biases with one parameter a ≥ 0, whose unit is [`Strategy::unit`].
    pub enum Strategy: Row {
        /// No bias; the parameter does nothing. z against D.
        None = "none" => row(Nothing, |_| Recipe::NONE),
        /// z against D + a, a in window depth (the documents; three.js bias; learnopengl.com).
        Constant = "constant" => row(WindowDepth, |a| window(a, Layers::Nearest)),
        /// z against D + a·dz/dW, a in world units along the light's axis.
        World = "world" => row(WorldUnits, |a| Recipe { world: a as f32, ..NONE }),
        /// z against D + a·s·dz/dW, a in texel edges s.
        Texels = "texels" => row(Texels, |a| Recipe { texels: a as f32, ..NONE }),
        /// z against D + a·q, a in steps q of the format at the receiver's depth.
        FormatSteps = "format-steps" => row(FormatSteps, |a| Recipe { steps: a as f32, ..NONE }),
        /// Casters drawn at D + a·m + 1·r: slope-scaled polygon offset and one unit (GL, Vulkan, D3D,
        /// WebGPU).
        SlopeRaster = "slope-raster" => row(Slopes, |a| polygon(a, 1.0)),
        /// Casters drawn at D + a·r: polygon offset in units alone.
        RasterUnits = "raster-units" => row(UnitsR, |a| polygon(0.0, a)),
        /// Casters drawn at D + 10a·m + 10a·r (PlayCanvas shadowBias: slope and units are 10 times it).
        RasterPlaycanvas = "raster-playcanvas" =>
            row(TenthsOfASlope, |a| polygon(10.0 * a, 10.0 * a)),
        /// z against D + min(a·m, 0.01), m the receiver's own depth slope per texel: a polygon offset's
        /// a·m (OpenGL 4.6 §14.6.5, Euclidean norm) made in the receiver's shader, clamped as MJP Shadows
        /// clamps its receiver plane. Its reach ends at the clamp: a plane under a filter of half-width h
        /// keeps acne where h·s·|g|₁ > 0.01 window depth.
        ReceiverSlope = "receiver-slope" =>
            row(Slopes, |a| Recipe { slope: a as f32, slope_clamp: 0.01, ..NONE }),
        /// Receiver at p + a·N, a in world units, N the vertices' own, one offset a vertex, interpolated and
        /// never turned to the side seen (three.js normalBias, shadowmap_vertex.glsl; a geometry without
        /// normals has its faces' here, as `flatShading` draws it: three.js itself has none to go by).
        NormalOffset = "normal-offset" => row(WorldUnits, |a| receiver(world(a, One, Vertices))),
        /// Receiver at p + a·√2·s·N (Bevy shadow_normal_bias).
        NormalBevy = "normal-bevy" => row(TexelDiagonals, |a| receiver(texels(a * SQRT_2, One, Shading))),
        /// Receiver at p + (a/2)·s·sin θ·N (Filament normalBias).
        NormalFilament = "normal-filament" => row(HalfTexels, |a| receiver(texels(a / 2.0, Sin, Shading))),
        /// Receiver at p + a·s·(1 − N·L)·N less its component along L (Godot normal_bias).
        NormalGodot = "normal-godot" =>
            row(Texels, |a| receiver(NormalMove {
                sideways: true, ..texels(a, OneMinusCos, Interpolated)
            })),
        /// Receiver at p + a·s·N (HDRP normalBias).
        NormalHdrp = "normal-hdrp" => row(Texels, |a| receiver(texels(a, One, Shading))),
        /// Receiver at p + a·√2·s·(sin θ/cos 0.534 + 0.195)·N (Blender EEVEE Next, a = 1).
        NormalBlender = "normal-blender" =>
            row(OwnMultiples, |a| receiver(texels(a * SQRT_2, Blender, Face))),
        /// Receiver at p + a·(1 − N·L)·N, a in world units (Cesium normalOffsetScale).
        NormalCesium = "normal-cesium" => row(WorldUnits, |a| receiver(world(a, OneMinusCos, Shading))),
        /// Receiver at p + a·L, a in world units (Bevy shadow_depth_bias).
        LightOffset = "light-offset" => row(WorldUnits, |a| Recipe { light: a, ..NONE }),
        /// Casters at p − a·s·sin θ·N (Unity built-in normal bias).
        CasterUnity = "caster-unity" => row(Texels, |a| caster(texels(a, Sin, Vertices))),
        /// Casters at p − a·s·(1 − N·L)·N (URP normal bias).
        CasterUrp = "caster-urp" => row(Texels, |a| caster(texels(a, OneMinusCos, Vertices))),
        /// Casters at p − a·sin θ·N, a in world units (Babylon normalBias).
        CasterBabylon = "caster-babylon" => row(WorldUnits, |a| caster(world(a, Sin, Vertices))),
        /// Casters at p − a·s·L (URP depth bias).
        CasterLight = "caster-light" => row(Texels, |a| Recipe { caster_light_texels: a, ..NONE }),
        /// Casters at p − (a/4)·s·(1 + 1.5·min(tan θ, 1))·L (Unreal CSM depth bias under a Shadow Bias
        /// and Shadow Slope Bias of 0.5 and a slope scale of 3).
        CasterUnreal = "caster-unreal" => row(QuarterTexels, |a| Recipe {
            caster_light_texels: a / 4.0, caster_light_slope: UNREAL_SLOPE, ..NONE
        }),
        /// The receiver's plane at each texel's centre against D + a (receiver-plane depth bias,
        /// clamped to 0.01).
        ReceiverPlane = "receiver-plane" => row(WindowDepth, |a| Recipe {
            follow: Follow::TexelCentre, ..window(a, Layers::Nearest)
        }),
        /// The receiver's plane at each tap against D + a (Isidoro 2006, as in MJP Shadows).
        ReceiverPlaneTap = "receiver-plane-tap" =>
            row(WindowDepth, |a| Recipe { follow: Follow::Sample, ..window(a, Layers::Nearest) }),
        /// min(z, the plane at the texel's centre) against D + a·dz/dW (Dou et al. 2014, K = a).
        Adaptive = "adaptive" =>
            row(WorldUnits, |a| Recipe { follow: Follow::NearerOfCentre, world: a as f32, ..NONE }),
        /// Only back faces are drawn; z against D + a.
        FrontCulling = "front-culling" => row(WindowDepth, |a| window(a, Layers::BackFaces)),
        /// The second nearest surface is stored; z against D + a (Wang and Molnar 1994).
        SecondDepth = "second-depth" => row(WindowDepth, |a| window(a, Layers::Second)),
        /// The middle of the two nearest surfaces is stored; z against D + a (Woo 1992).
        Midpoint = "midpoint" => row(WindowDepth, |a| window(a, Layers::Midpoint)),
        /// z₁ + min((z₂ − z₁)/2, a) is stored (Weiskopf and Ertl 2003).
        DualLayer = "dual-layer" =>
            row(WindowDepth, |a| Recipe { layers: Layers::Dual, layer_offset: a as f32, ..NONE }),
        /// Casters drawn a world units farther where they face the light, nearer where not, and one
        /// slope m farther (oriented depth bias, Square Enix 2023).
        Oriented = "oriented" =>
            row(WorldUnits, |a| Recipe { oriented: a as f32, ..polygon(1.0, 0.0) }),
        /// z against D + max(a·(1 − N·L), 0.005); as written a = 0.05 (learnopengl.com, *Shadow Mapping*).
        TutorialCosine = "tutorial-cosine" => row(WindowDepth, |a| shader(&rule::FlooredCosine, a)),
        /// z against D + clamp(a·tan θ, 0, 0.01), absolute and blind to the texel; as written a = 0.005
        /// (opengl-tutorial.org, tutorial 16: 0.005·tan(acos(N·L))).
        TutorialTangent = "tutorial-tangent" => row(WindowDepth, |a| shader(&rule::ClampedTangent, a)),
        /// (z·w − a)/w against D: a bias before the division by w, which is the distance along a spot's
        /// axis and 1 under a directional light.
        ClipSpace = "clip-space" => row(ClipDepth, |a| shader(&rule::BeforeDivision, a)),
    }
}

impl Strategy {
    /// The recipe at parameter `a`.
    #[must_use]
    pub fn with(self, a: f32) -> Recipe {
        self.at(f64::from(a))
    }

    /// The recipe at a parameter that no f32 need be: engines keep some of theirs in f64.
    #[must_use]
    pub fn at(self, a: f64) -> Recipe {
        (self.row().recipe)(a)
    }

    /// The parameter's unit.
    #[must_use]
    pub const fn unit(self) -> Unit {
        self.row().unit
    }

    /// What has to be evaluated anew when the parameter changes.
    #[must_use]
    pub fn family(self) -> Family {
        Family::between(&self.at(1.0), &self.at(2.0))
    }
}
