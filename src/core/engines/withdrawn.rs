//! Lines that are known to be wrong and are not printed until they are mended: when, why, what instead.

use crate::scene::{Case, CullRule, Filter};

/// What decides whether a line is known to be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Whether the light is a spot, not directional.
    pub spot: bool,
    /// How the map is read.
    pub filter: Filter,
    /// Which faces are left out of the map.
    pub cull: CullRule,
}

impl Setting {
    /// The setting of a case under another filter.
    #[must_use]
    pub fn of(case: &Case, filter: Filter) -> Self {
        Self { spot: !case.light.is_directional(), filter, cull: case.map.cull }
    }
}

/// When a line is known to be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Whatever is set.
    Always,
    /// Under a directional light.
    Directional,
    /// Under a spot.
    Spot,
    /// Where a look-up reads one texel.
    Unfiltered,
    /// Where front faces are drawn into the map.
    FrontFaces,
}

/// A line that is not printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Withdrawal {
    /// When.
    pub when: When,
    /// Why, for the middle of a sentence.
    pub why: &'static str,
    /// What to do instead, for the middle of a sentence.
    pub instead: &'static str,
}

impl Withdrawal {
    /// Whether it holds in a setting.
    #[must_use]
    pub const fn holds(&self, setting: &Setting) -> bool {
        match self.when {
            When::Always => true,
            When::Directional => !setting.spot,
            When::Spot => setting.spot,
            When::Unfiltered => matches!(setting.filter, Filter::Nearest),
            When::FrontFaces => {
                !matches!(setting.cull, CullRule::Front | CullRule::MaterialOpposite)
            }
        }
    }
}

/// The first of a list that holds in a setting.
#[must_use]
pub fn withdrawn(list: &'static [Withdrawal], setting: &Setting) -> Option<&'static Withdrawal> {
    list.iter().find(|withdrawal| withdrawal.holds(setting))
}

const BY_EYE: &str = "set it by eye";
const PUBLIC_DEFAULT: &str = "draw the engine's own picture";

const fn one(when: When, why: &'static str, instead: &'static str) -> [Withdrawal; 1] {
    [Withdrawal { when, why, instead }]
}

pub(super) const BABYLON: &[Withdrawal] = &one(
    When::Unfiltered,
    "in its default mode, without a filter, Babylon adds the bias to another depth, which is not expressed yet",
    "use shadowGenerator.usePercentageCloserFiltering and tune with a PCF filter, or set it by eye",
);
pub(super) const BEVY: &[Withdrawal] = &one(
    When::Spot,
    "the line was that of a DirectionalLight, and a spot's is not expressed yet",
    "set this field of SpotLight by eye",
);
pub(super) const FILAMENT: &[Withdrawal] = &one(
    When::Spot,
    "Filament scales the biases of spots otherwise than those of the sun, which is not expressed yet",
    BY_EYE,
);
pub(super) const GODOT: &[Withdrawal] = &one(
    When::Spot,
    "Godot divides a spot's bias by its distance and multiplies it by the blur, which is not expressed yet",
    BY_EYE,
);
pub(super) const URP: &[Withdrawal] = &one(
    When::Spot,
    "URP takes half a texel at a spot's range everywhere, which is not expressed yet",
    BY_EYE,
);
pub(super) const HDRP_NORMAL: &[Withdrawal] = &one(
    When::Always,
    "the texel that HDRP multiplies it by is not expressed yet",
    "set normalBias of HDAdditionalLightData by eye",
);
pub(super) const HDRP_SLOPE: &[Withdrawal] = &one(
    When::Always,
    "the factor that HDRP multiplies it by is not expressed yet",
    "set slopeBias of HDAdditionalLightData by eye, from 0 to 1",
);
pub(super) const UNREAL: &[Withdrawal] = &one(
    When::Spot,
    "the cascades' variable does not act on spots, whose own is not expressed yet",
    "set r.Shadow.SpotLightDepthBias or the light's Shadow Bias by eye",
);
pub(super) const CESIUM: &[Withdrawal] = &one(
    When::Always,
    "the line set a private member, which acts on terrain alone",
    "Cesium has no public knob for it: change the light, the map's size or its range",
);

pub(super) const DEFAULT_THREEJS: &[Withdrawal] = &one(
    When::FrontFaces,
    "three.js draws the back faces of single-sided materials by default, and this map has front faces",
    "set map.cull = \"front\" to see the default",
);
pub(super) const DEFAULT_BABYLON: &[Withdrawal] = &one(
    When::Always,
    "Babylon's default mode, without a filter and in half floats, is not expressed yet",
    PUBLIC_DEFAULT,
);
pub(super) const DEFAULT_FILAMENT: &[Withdrawal] =
    &one(When::Spot, "Filament's spots are not expressed yet", PUBLIC_DEFAULT);
pub(super) const DEFAULT_GODOT: &[Withdrawal] = &one(
    When::Always,
    "Godot's default normal bias and soft-shadow quality are not expressed yet",
    PUBLIC_DEFAULT,
);
pub(super) const DEFAULT_UNITY: &[Withdrawal] = &one(
    When::Always,
    "how Unity's built-in depth bias scales is not public, and it is a part of the default",
    PUBLIC_DEFAULT,
);
pub(super) const DEFAULT_URP: &[Withdrawal] =
    &one(When::Spot, "URP's spots are not expressed yet", PUBLIC_DEFAULT);
pub(super) const DEFAULT_HDRP: &[Withdrawal] =
    &one(When::Always, "HDRP's own factors are not expressed yet", PUBLIC_DEFAULT);
pub(super) const DEFAULT_UNREAL: &[Withdrawal] =
    &one(When::Spot, "Unreal's spots are not expressed yet", PUBLIC_DEFAULT);
pub(super) const DEFAULT_PLAYCANVAS: &[Withdrawal] = &one(
    When::Directional,
    "PlayCanvas moves receivers under a directional light too, which is not expressed yet",
    PUBLIC_DEFAULT,
);
pub(super) const DEFAULT_CESIUM: &[Withdrawal] = &one(
    When::Always,
    "models have other defaults than the terrain, which are not expressed yet",
    PUBLIC_DEFAULT,
);
