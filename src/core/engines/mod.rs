//! A bias in each engine's own parameters: what they mean, their defaults, and the line to paste.

pub mod convert;
pub mod withdrawn;

use crate::shadow::bias::{NormalMove, NormalWeight, PolygonOffset, Recipe, Strategy};
pub use convert::Place;
use withdrawn::Withdrawal;
pub use withdrawn::{Setting, When};

crate::catalogue! {
    /// Engines and APIs whose bias parameters were read in their source or specification.
    pub enum Engine {
        /// three.js r187: bias in window depth (negative removes acne), normalBias in world units.
        Threejs = "threejs",
        /// Babylon.js 8: bias in NDC (window depth is half of it), normalBias · sin θ at casters.
        Babylon = "babylon",
        /// Bevy: depth bias in world units towards the light, normal bias in texel diagonals.
        Bevy = "bevy",
        /// Filament: constantBias in world units, normalBias in half texels · sin θ, polygon offset.
        Filament = "filament",
        /// Godot 4: bias in hundredths of a world unit (scales 1), normal_bias in texels · (1 − N·L).
        Godot = "godot",
        /// Unity built-in: normal bias in texels · sin θ at casters.
        Unity = "unity",
        /// Unity URP: depth and normal bias in texels at casters.
        Urp = "urp",
        /// Unity HDRP: normal bias in texels, slope bias.
        Hdrp = "hdrp",
        /// Unreal 5: CSM depth bias in quarter texels (Shadow Bias 0.5), grown by the slope at casters.
        Unreal = "unreal",
        /// PlayCanvas: shadowBias, a tenth of a polygon offset's slope and units.
        Playcanvas = "playcanvas",
        /// Cesium: depthBias in window depth, normalOffsetScale in world units · (1 − N·L).
        Cesium = "cesium",
        /// OpenGL: glPolygonOffset.
        Gl = "gl",
        /// Vulkan: vkCmdSetDepthBias.
        Vulkan = "vulkan",
        /// Direct3D 12: rasterizer state.
        D3d12 = "d3d12",
        /// WebGPU: depth-stencil state.
        Webgpu = "webgpu",
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
    /// The engine's default.
    pub default: f64,
    /// Whether only whole numbers are accepted.
    pub integer: bool,
    /// The smallest and the largest value that the engine keeps as it is given.
    pub range: [f64; 2],
    /// Where its line is known to be wrong and is not printed.
    pub withdrawn: &'static [Withdrawal],
}

const fn knob(name: &'static str, strategy: Strategy, scale: f64, default: f64) -> Knob {
    let range = [f64::NEG_INFINITY, f64::INFINITY];
    Knob { name, strategy, scale, default, integer: false, range, withdrawn: &[] }
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
}

impl Engine {
    /// Its parameters, the one it is known for first; where they were read: [`Self::source`].
    #[must_use]
    pub fn knobs(self) -> Vec<Knob> {
        use Strategy as S;
        match self {
            Self::Threejs => vec![
                knob("shadow.bias", S::Constant, -1.0, 0.0),
                knob("shadow.normalBias", S::NormalOffset, 1.0, 0.0),
            ],
            Self::Babylon => vec![
                knob("bias", S::Constant, 2.0, 5e-5).without(withdrawn::BABYLON),
                knob("normalBias", S::CasterBabylon, 1.0, 0.0),
            ],
            Self::Bevy => vec![
                knob("shadow_normal_bias", S::NormalBevy, 1.0, 1.8).without(withdrawn::BEVY),
                knob("shadow_depth_bias", S::LightOffset, 1.0, 0.02).without(withdrawn::BEVY),
            ],
            Self::Filament => vec![
                knob("normalBias", S::NormalFilament, 1.0, 1.0).without(withdrawn::FILAMENT),
                knob("constantBias", S::LightOffset, 1.0, 0.001).without(withdrawn::FILAMENT),
            ],
            Self::Godot => vec![
                knob("shadow_bias", S::LightOffset, 100.0, 0.1).without(withdrawn::GODOT),
                knob("shadow_normal_bias", S::NormalGodot, 1.0, 1.0).without(withdrawn::GODOT),
            ],
            Self::Unity => vec![knob("shadowNormalBias", S::CasterUnity, 1.0, 0.4)],
            Self::Urp => vec![
                knob("shadowNormalBias", S::CasterUrp, 1.0, 1.0)
                    .within(0.0, 10.0)
                    .without(withdrawn::URP),
                knob("shadowDepthBias", S::CasterLight, 1.0, 1.0)
                    .within(0.0, 10.0)
                    .without(withdrawn::URP),
            ],
            Self::Hdrp => vec![
                knob("normalBias", S::NormalHdrp, 1.0, 0.75).without(withdrawn::HDRP_NORMAL),
                knob("slopeBias", S::SlopeRaster, 1.0, 0.5)
                    .within(0.0, 1.0)
                    .without(withdrawn::HDRP_SLOPE),
            ],
            Self::Unreal => {
                vec![
                    knob("r.Shadow.CSMDepthBias", S::CasterUnreal, 1.0, 10.0)
                        .without(withdrawn::UNREAL),
                ]
            }
            Self::Playcanvas => {
                let bias = knob("shadowBias", S::RasterPlaycanvas, 1.0, 0.05);
                vec![bias.within(0.0, 1.0)]
            }
            Self::Cesium => vec![
                knob("depthBias", S::Constant, 1.0, 1e-4).without(withdrawn::CESIUM),
                knob("normalOffsetScale", S::NormalCesium, 1.0, 0.5).without(withdrawn::CESIUM),
            ],
            Self::Gl => {
                vec![
                    knob("factor", S::SlopeRaster, 1.0, 0.0),
                    knob("units", S::RasterUnits, 1.0, 0.0),
                ]
            }
            Self::Vulkan => vec![
                knob("depthBiasSlopeFactor", S::SlopeRaster, 1.0, 0.0),
                knob("depthBiasConstantFactor", S::RasterUnits, 1.0, 0.0),
            ],
            Self::D3d12 => vec![
                knob("SlopeScaledDepthBias", S::SlopeRaster, 1.0, 0.0),
                knob("DepthBias", S::RasterUnits, 1.0, 0.0).whole(),
            ],
            Self::Webgpu => vec![
                knob("depthBiasSlopeScale", S::SlopeRaster, 1.0, 0.0),
                knob("depthBias", S::RasterUnits, 1.0, 0.0).whole(),
            ],
        }
    }

    /// What the engine does when nothing is set: all of its default biases together.
    #[must_use]
    pub fn defaults(self) -> Recipe {
        let none = Recipe::default();
        let normal = |amount: f64, weight: NormalWeight| NormalMove {
            amount,
            weight,
            in_texels: true,
            sideways: false,
        };
        let root2 = std::f64::consts::SQRT_2;
        let polygon = |factor: f32, units: f32| PolygonOffset { factor, units, clamp: 0.0 };
        match self {
            Self::Babylon => Recipe { window: 2.5e-5, ..none },
            Self::Bevy => {
                Recipe { normal: normal(1.8 * root2, NormalWeight::One), light: 0.02, ..none }
            }
            Self::Filament => Recipe {
                normal: normal(0.5, NormalWeight::Sin),
                light: 0.001,
                polygon: polygon(2.0, 0.5),
                ..none
            },
            Self::Godot => Recipe {
                normal: NormalMove { sideways: true, ..normal(1.0, NormalWeight::OneMinusCos) },
                light: 0.001,
                ..none
            },
            Self::Unity => Recipe { caster_normal: normal(0.4, NormalWeight::Sin), ..none },
            Self::Urp => Recipe {
                caster_normal: normal(1.0, NormalWeight::OneMinusCos),
                caster_light_texels: 1.0,
                polygon: polygon(2.5, 1.0),
                ..none
            },
            Self::Hdrp => Recipe {
                normal: normal(0.75, NormalWeight::One),
                polygon: polygon(0.5, 1.0),
                ..none
            },
            Self::Unreal => Strategy::CasterUnreal.with(10.0),
            Self::Playcanvas => Strategy::RasterPlaycanvas.with(0.05),
            Self::Cesium => Recipe {
                window: 1e-4,
                polygon: polygon(1.1, 4.0),
                normal: NormalMove { in_texels: false, ..normal(0.5, NormalWeight::OneMinusCos) },
                ..none
            },
            Self::Threejs | Self::Gl | Self::Vulkan | Self::D3d12 | Self::Webgpu => none,
        }
    }

    /// Why what the defaults leave is not said in a setting; `None` where it is.
    #[must_use]
    pub fn default_withdrawn(self, setting: &Setting) -> Option<&'static Withdrawal> {
        let list: &'static [Withdrawal] = match self {
            Self::Threejs => withdrawn::DEFAULT_THREEJS,
            Self::Babylon => withdrawn::DEFAULT_BABYLON,
            Self::Filament => withdrawn::DEFAULT_FILAMENT,
            Self::Godot => withdrawn::DEFAULT_GODOT,
            Self::Unity => withdrawn::DEFAULT_UNITY,
            Self::Urp => withdrawn::DEFAULT_URP,
            Self::Hdrp => withdrawn::DEFAULT_HDRP,
            Self::Unreal => withdrawn::DEFAULT_UNREAL,
            Self::Playcanvas => withdrawn::DEFAULT_PLAYCANVAS,
            Self::Cesium => withdrawn::DEFAULT_CESIUM,
            Self::Bevy | Self::Gl | Self::Vulkan | Self::D3d12 | Self::Webgpu => &[],
        };
        withdrawn::withdrawn(list, setting)
    }

    /// The line to paste for one parameter, the value as [`Knob::stored`].
    #[must_use]
    pub fn line(self, knob: &Knob, value: f64) -> String {
        let v = format!("{:?}", Knob::stored(value));
        let name = knob.name;
        match (self, knob.strategy) {
            (Self::Threejs, _) => format!("light.{name} = {v};"),
            (Self::Babylon, _) => format!("shadowGenerator.{name} = {v};"),
            (Self::Bevy, _) => format!("DirectionalLight {{ {name}: {v}, ..default() }}"),
            (Self::Filament, _) => format!("shadowOptions.{name} = {v}f;"),
            (Self::Godot, _) => format!("light.{name} = {v}"),
            (Self::Unity | Self::Hdrp, _) => format!("light.{name} = {v}f;"),
            (Self::Urp, _) => format!("urpAsset.{name} = {v}f;"),
            (Self::Unreal, _) => format!("{name} {v}"),
            (Self::Playcanvas, _) => format!("entity.light.{name} = {v};"),
            (Self::Cesium, _) => format!("shadowMap._terrainBias.{name} = {v};"),
            (Self::Gl, Strategy::SlopeRaster) => format!("glPolygonOffset({v}, 1.0);"),
            (Self::Gl, _) => format!("glPolygonOffset(0.0, {v});"),
            (Self::Vulkan, Strategy::SlopeRaster) => {
                format!("vkCmdSetDepthBias(cmd, 1.0f, 0.0f, {v}f);")
            }
            (Self::Vulkan, _) => format!("vkCmdSetDepthBias(cmd, {v}f, 0.0f, 0.0f);"),
            (Self::D3d12, Strategy::SlopeRaster) => {
                format!("rasterizer.DepthBias = 1; rasterizer.SlopeScaledDepthBias = {v}f;")
            }
            (Self::D3d12, _) => format!("rasterizer.DepthBias = {};", value as i64),
            (Self::Webgpu, Strategy::SlopeRaster) => {
                format!("depthStencil: {{ depthBias: 1, depthBiasSlopeScale: {v} }}")
            }
            (Self::Webgpu, _) => format!("depthStencil: {{ depthBias: {} }}", value as i64),
        }
    }

    /// Where formula and defaults were read: version and file, or the specification's section.
    #[must_use]
    pub const fn source(self) -> &'static str {
        match self {
            Self::Threejs => "three.js r187, src/lights/LightShadow.js and the shadow chunks",
            Self::Babylon => "Babylon.js 8.22, shadowGenerator.ts and shadowMapVertexMetric",
            Self::Bevy => {
                "Bevy 0.17-dev, bevy_light directional_light.rs and bevy_pbr shadows.wgsl"
            }
            Self::Filament => {
                "Filament 2026, LightManager.h, ShadowMap.cpp and surface_shadowing.fs"
            }
            Self::Godot => {
                "Godot 4, scene/3d/light_3d.cpp and the forward renderer's shadow set-up"
            }
            Self::Unity => "Unity's built-in UnityCG.cginc, UnityClipSpaceShadowCasterPos",
            Self::Urp => "URP ShadowUtils.cs (GetShadowBias, RenderShadowSlice) and Shadows.hlsl",
            Self::Hdrp => {
                "HDRP HDShadowAlgorithms.hlsl (EvalShadow_NormalBias) and HDShadowAtlas.cs"
            }
            Self::Unreal => {
                "Unreal Engine 5, ShadowRendering.cpp (UpdateShaderDepthBias) and ShadowDepthVertexShader.usf"
            }
            Self::Playcanvas => {
                "PlayCanvas engine, src/scene/light.js and framework/components/light"
            }
            Self::Cesium => "CesiumJS, ShadowMap.js (terrain bias) and ShadowMapShader.js",
            Self::Gl => "OpenGL 4.6 core, 14.6.5 Depth Offset",
            Self::Vulkan => "Vulkan 1.3, Depth Bias; VK_EXT_depth_bias_control",
            Self::D3d12 => "D3D11.3 functional specification, 15.10 Depth Bias",
            Self::Webgpu => "WebGPU, GPUDepthStencilState depth bias",
        }
    }

    /// What the engine's own terms leave open here; empty where nothing.
    #[must_use]
    pub const fn remark(self) -> &'static str {
        match self {
            Self::Threejs => {
                "the map is drawn as map.cull says, while three.js draws back faces unless material.shadowSide is set to the side drawn here"
            }
            Self::Godot => {
                "bias_scale and soft_scale are taken as 1; at the desktop default of soft_shadow_filter_quality shadow_bias acts twice as strong"
            }
            Self::Unity => {
                "how the built-in depth bias scales is not public, so only the normal bias is tuned"
            }
            Self::Unreal => {
                "directional lights with Shadow Bias and Shadow Slope Bias at 0.5 and Cascade Bias Distribution at 1; the receiver bias and the soft comparison are left out"
            }
            Self::Cesium => {
                "the default is the terrain's, with its polygon offset 1.1, 4 and its normal offset"
            }
            Self::Urp => {
                "hard shadows under a directional light; soft shadows multiply both values by 2.5, and a spot takes half a texel at its range everywhere"
            }
            Self::Babylon => "the depth-texture path; bias is added to casters' NDC depth",
            Self::Bevy
            | Self::Filament
            | Self::Hdrp
            | Self::Playcanvas
            | Self::Gl
            | Self::Vulkan
            | Self::D3d12
            | Self::Webgpu => "",
        }
    }
}
