//! A bias in each engine's own parameters: what they mean, their defaults, and the line to paste.
//!
//! An engine is one row. Its defaults, their units elsewhere and its lines follow from its knobs.

pub mod convert;
pub mod withdrawn;

use crate::shadow::bias::Strategy as S;
use crate::shadow::bias::{PolygonOffset, Recipe, Strategy};
pub use convert::Place;
use withdrawn::Withdrawal;
pub use withdrawn::{Setting, When};

/// What is known of an engine beside its name.
struct Row {
    /// Its parameters, the one it is known for first.
    knobs: &'static [Knob],
    /// Factor and units of the polygon offset that it draws casters with beside its parameters.
    polygon: [f32; 2],
    /// Where what its defaults leave is not said.
    default_withdrawn: &'static [Withdrawal],
    /// Version and file, or the specification's section.
    source: &'static str,
    /// What its own terms leave open here.
    remark: &'static str,
}

const UNTOLD: Row =
    Row { knobs: &[], polygon: [0.0; 2], default_withdrawn: &[], source: "", remark: "" };

crate::catalogue! {
    /// Engines and APIs whose bias parameters were read in their source or specification.
    pub enum Engine: Row {
        /// three.js r187: bias in window depth (negative removes acne), normalBias in world units.
        Threejs = "threejs" => Row {
            knobs: &[
                knob("shadow.bias", S::Constant, -1.0, 0.0, "light.shadow.bias = {v};"),
                knob("shadow.normalBias", S::NormalOffset, 1.0, 0.0,
                    "light.shadow.normalBias = {v};"),
            ],
            default_withdrawn: withdrawn::DEFAULT_THREEJS,
            source: "three.js r187, src/lights/LightShadow.js and the shadow chunks",
            remark: "the map is drawn as map.cull says, while three.js draws back faces unless material.shadowSide is set to the side drawn here",
            ..UNTOLD
        },
        /// Babylon.js 8: bias in NDC (window depth is half of it), normalBias · sin θ at casters.
        Babylon = "babylon" => Row {
            knobs: &[
                knob("bias", S::Constant, 2.0, 5e-5, "shadowGenerator.bias = {v};")
                    .without(withdrawn::BABYLON),
                knob("normalBias", S::CasterBabylon, 1.0, 0.0, "shadowGenerator.normalBias = {v};"),
            ],
            default_withdrawn: withdrawn::DEFAULT_BABYLON,
            source: "Babylon.js 8.22, shadowGenerator.ts and shadowMapVertexMetric",
            remark: "the depth-texture path; bias is added to casters' NDC depth",
            ..UNTOLD
        },
        /// Bevy: depth bias in world units towards the light, normal bias in texel diagonals.
        Bevy = "bevy" => Row {
            knobs: &[
                knob("shadow_normal_bias", S::NormalBevy, 1.0, 1.8,
                    "DirectionalLight { shadow_normal_bias: {v}, ..default() }").without(withdrawn::BEVY),
                knob("shadow_depth_bias", S::LightOffset, 1.0, 0.02,
                    "DirectionalLight { shadow_depth_bias: {v}, ..default() }").without(withdrawn::BEVY),
            ],
            source: "Bevy 0.17-dev, bevy_light directional_light.rs and bevy_pbr shadows.wgsl",
            ..UNTOLD
        },
        /// Filament: constantBias in world units, normalBias in half texels · sin θ, polygon offset.
        Filament = "filament" => Row {
            knobs: &[
                knob("normalBias", S::NormalFilament, 1.0, 1.0, "shadowOptions.normalBias = {v}f;")
                    .without(withdrawn::FILAMENT),
                knob("constantBias", S::LightOffset, 1.0, 0.001,
                    "shadowOptions.constantBias = {v}f;").without(withdrawn::FILAMENT),
            ],
            polygon: [2.0, 0.5],
            default_withdrawn: withdrawn::DEFAULT_FILAMENT,
            source: "Filament 2026, LightManager.h, ShadowMap.cpp and surface_shadowing.fs",
            ..UNTOLD
        },
        /// Godot 4: bias in hundredths of a world unit (scales 1), normal_bias in texels · (1 − N·L).
        Godot = "godot" => Row {
            knobs: &[
                knob("shadow_bias", S::LightOffset, 100.0, 0.1, "light.shadow_bias = {v}")
                    .without(withdrawn::GODOT),
                knob("shadow_normal_bias", S::NormalGodot, 1.0, 1.0,
                    "light.shadow_normal_bias = {v}").without(withdrawn::GODOT),
            ],
            default_withdrawn: withdrawn::DEFAULT_GODOT,
            source: "Godot 4, scene/3d/light_3d.cpp and the forward renderer's shadow set-up",
            remark: "bias_scale and soft_scale are taken as 1; at the desktop default of soft_shadow_filter_quality shadow_bias acts twice as strong",
            ..UNTOLD
        },
        /// Unity built-in: normal bias in texels · sin θ at casters.
        Unity = "unity" => Row {
            knobs: &[
                knob("shadowNormalBias", S::CasterUnity, 1.0, 0.4,
                    "light.shadowNormalBias = {v}f;"),
            ],
            default_withdrawn: withdrawn::DEFAULT_UNITY,
            source: "Unity's built-in UnityCG.cginc, UnityClipSpaceShadowCasterPos",
            remark: "how the built-in depth bias scales is not public, so only the normal bias is tuned",
            ..UNTOLD
        },
        /// Unity URP: depth and normal bias in texels at casters.
        Urp = "urp" => Row {
            knobs: &[
                knob("shadowNormalBias", S::CasterUrp, 1.0, 1.0,
                    "urpAsset.shadowNormalBias = {v}f;").within(0.0, 10.0).without(withdrawn::URP),
                knob("shadowDepthBias", S::CasterLight, 1.0, 1.0,
                    "urpAsset.shadowDepthBias = {v}f;").within(0.0, 10.0).without(withdrawn::URP),
            ],
            polygon: [2.5, 1.0],
            default_withdrawn: withdrawn::DEFAULT_URP,
            source: "URP ShadowUtils.cs (GetShadowBias, RenderShadowSlice) and Shadows.hlsl",
            remark: "hard shadows under a directional light; soft shadows multiply both values by 2.5, and a spot takes half a texel at its range everywhere",
        },
        /// Unity HDRP: normal bias in texels, slope bias.
        Hdrp = "hdrp" => Row {
            knobs: &[
                knob("normalBias", S::NormalHdrp, 1.0, 0.75, "light.normalBias = {v}f;")
                    .without(withdrawn::HDRP_NORMAL),
                knob("slopeBias", S::SlopeRaster, 1.0, 0.5, "light.slopeBias = {v}f;")
                    .within(0.0, 1.0).without(withdrawn::HDRP_SLOPE),
            ],
            default_withdrawn: withdrawn::DEFAULT_HDRP,
            source: "HDRP HDShadowAlgorithms.hlsl (EvalShadow_NormalBias) and HDShadowAtlas.cs",
            ..UNTOLD
        },
        /// Unreal 5: CSM depth bias in quarter texels (Shadow Bias 0.5), grown by the slope at casters.
        Unreal = "unreal" => Row {
            knobs: &[
                knob("r.Shadow.CSMDepthBias", S::CasterUnreal, 1.0, 10.0,
                    "r.Shadow.CSMDepthBias {v}").without(withdrawn::UNREAL),
            ],
            default_withdrawn: withdrawn::DEFAULT_UNREAL,
            source: "Unreal Engine 5, ShadowRendering.cpp (UpdateShaderDepthBias) and ShadowDepthVertexShader.usf",
            remark: "directional lights with Shadow Bias and Shadow Slope Bias at 0.5 and Cascade Bias Distribution at 1; the receiver bias and the soft comparison are left out",
            ..UNTOLD
        },
        /// PlayCanvas: shadowBias, a tenth of a polygon offset's slope and units.
        Playcanvas = "playcanvas" => Row {
            knobs: &[
                knob("shadowBias", S::RasterPlaycanvas, 1.0, 0.05, "entity.light.shadowBias = {v};")
                    .within(0.0, 1.0),
            ],
            default_withdrawn: withdrawn::DEFAULT_PLAYCANVAS,
            source: "PlayCanvas engine, src/scene/light.js and framework/components/light",
            ..UNTOLD
        },
        /// Cesium: depthBias in window depth, normalOffsetScale in world units · (1 − N·L).
        Cesium = "cesium" => Row {
            knobs: &[
                knob("depthBias", S::Constant, 1.0, 1e-4, "shadowMap._terrainBias.depthBias = {v};")
                    .without(withdrawn::CESIUM),
                knob("normalOffsetScale", S::NormalCesium, 1.0, 0.5,
                    "shadowMap._terrainBias.normalOffsetScale = {v};").without(withdrawn::CESIUM),
            ],
            polygon: [1.1, 4.0],
            default_withdrawn: withdrawn::DEFAULT_CESIUM,
            source: "CesiumJS, ShadowMap.js (terrain bias) and ShadowMapShader.js",
            remark: "the default is the terrain's, with its polygon offset 1.1, 4 and its normal offset",
        },
        /// OpenGL: glPolygonOffset.
        Gl = "gl" => Row {
            knobs: &[
                knob("factor", S::SlopeRaster, 1.0, 0.0, "glPolygonOffset({v}, 1.0);"),
                knob("units", S::RasterUnits, 1.0, 0.0, "glPolygonOffset(0.0, {v});"),
            ],
            source: "OpenGL 4.6 core, 14.6.5 Depth Offset",
            ..UNTOLD
        },
        /// Vulkan: vkCmdSetDepthBias.
        Vulkan = "vulkan" => Row {
            knobs: &[
                knob("depthBiasSlopeFactor", S::SlopeRaster, 1.0, 0.0,
                    "vkCmdSetDepthBias(cmd, 1.0f, 0.0f, {v}f);"),
                knob("depthBiasConstantFactor", S::RasterUnits, 1.0, 0.0,
                    "vkCmdSetDepthBias(cmd, {v}f, 0.0f, 0.0f);"),
            ],
            source: "Vulkan 1.3, Depth Bias; VK_EXT_depth_bias_control",
            ..UNTOLD
        },
        /// Direct3D 12: rasterizer state.
        D3d12 = "d3d12" => Row {
            knobs: &[
                knob("SlopeScaledDepthBias", S::SlopeRaster, 1.0, 0.0,
                    "rasterizer.DepthBias = 1; rasterizer.SlopeScaledDepthBias = {v}f;"),
                knob("DepthBias", S::RasterUnits, 1.0, 0.0, "rasterizer.DepthBias = {v};").whole(),
            ],
            source: "D3D11.3 functional specification, 15.10 Depth Bias",
            ..UNTOLD
        },
        /// WebGPU: depth-stencil state.
        Webgpu = "webgpu" => Row {
            knobs: &[
                knob("depthBiasSlopeScale", S::SlopeRaster, 1.0, 0.0,
                    "depthStencil: { depthBias: 1, depthBiasSlopeScale: {v} }"),
                knob("depthBias", S::RasterUnits, 1.0, 0.0, "depthStencil: { depthBias: {v} }")
                    .whole(),
            ],
            source: "WebGPU, GPUDepthStencilState depth bias",
            ..UNTOLD
        },
    }
}

/// One parameter of an engine: `scale` times a strategy's amount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// Its name in the engine.
    pub name: &'static str,
    /// The family that it moves along.
    pub strategy: Strategy,
    /// Engine value per unit of the strategy's amount; negative where the engine writes it so.
    pub scale: f64,
    /// The engine's default; 0 does nothing.
    pub default: f64,
    /// Whether only whole numbers are accepted.
    pub integer: bool,
    /// The smallest and the largest value that the engine keeps as it is given.
    pub range: [f64; 2],
    /// The line to paste, `{v}` for the value.
    pub line: &'static str,
    /// Where its line is known to be wrong and is not printed.
    pub withdrawn: &'static [Withdrawal],
}

const fn knob(
    name: &'static str,
    strategy: Strategy,
    scale: f64,
    default: f64,
    line: &'static str,
) -> Knob {
    let range = [f64::NEG_INFINITY, f64::INFINITY];
    Knob { name, strategy, scale, default, integer: false, range, line, withdrawn: &[] }
}

impl Knob {
    const fn within(self, low: f64, high: f64) -> Self {
        Self { range: [low, high], ..self }
    }

    const fn whole(self) -> Self {
        Self { integer: true, ..self }.within(i32::MIN as f64, i32::MAX as f64)
    }

    const fn without(self, withdrawn: &'static [Withdrawal]) -> Self {
        Self { withdrawn, ..self }
    }

    /// Why its line is not printed in a setting; `None` where it is.
    #[must_use]
    pub fn withdrawn(&self, setting: &Setting) -> Option<&'static Withdrawal> {
        withdrawn::withdrawn(self.withdrawn, setting)
    }

    /// Whether the engine keeps a value as it is given.
    #[must_use]
    pub fn accepts(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }

    /// The engine's value for an amount, rounded up to a whole number where it must be; never -0.
    #[must_use]
    pub fn value(&self, amount: f64) -> f64 {
        let value = amount * self.scale + 0.0;
        if self.integer { value.ceil() } else { value }
    }

    /// A value as engines keep it: the f32 next to it away from zero, so that it is worth no less.
    #[must_use]
    pub fn stored(value: f64) -> f32 {
        let nearest = value as f32;
        if f64::from(nearest).abs() >= value.abs() {
            nearest
        } else if value > 0.0 {
            nearest.next_up()
        } else {
            nearest.next_down()
        }
    }

    /// The line to paste for a value, which is written as [`Self::stored`].
    #[must_use]
    pub fn line(&self, value: f64) -> String {
        let stored = Self::stored(value);
        let text = if self.integer { format!("{}", value as i64) } else { format!("{stored:?}") };
        self.line.replace("{v}", &text)
    }

    /// What the engine does where the parameter stands at its default.
    fn at_default(&self) -> Recipe {
        match self.default {
            0.0 => Recipe::NONE,
            value => self.strategy.at(value / self.scale),
        }
    }
}

impl Engine {
    /// Its parameters, the one it is known for first; where they were read: [`Self::source`].
    #[must_use]
    pub fn knobs(self) -> Vec<Knob> {
        self.row().knobs.to_vec()
    }

    /// What the engine does when nothing is set: all of its default biases together.
    #[must_use]
    pub fn defaults(self) -> Recipe {
        let [factor, units] = self.row().polygon;
        let polygon = PolygonOffset { factor, units, clamp: 0.0 };
        let always = Recipe { polygon, ..Recipe::NONE };
        self.row().knobs.iter().map(Knob::at_default).fold(always, Recipe::and)
    }

    /// Why what the defaults leave is not said in a setting; `None` where it is.
    #[must_use]
    pub fn default_withdrawn(self, setting: &Setting) -> Option<&'static Withdrawal> {
        withdrawn::withdrawn(self.row().default_withdrawn, setting)
    }

    /// Where formula and defaults were read: version and file, or the specification's section.
    #[must_use]
    pub const fn source(self) -> &'static str {
        self.row().source
    }

    /// What the engine's own terms leave open here; empty where nothing.
    #[must_use]
    pub const fn remark(self) -> &'static str {
        self.row().remark
    }
}
