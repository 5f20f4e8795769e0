//! Every bias strategy as three hooks: what casters store, where receivers look, what taps compare.
//!
//! A [`Recipe`] is plain data with all hooks; engines fill several fields at once. A [`Strategy`] is a
//! family of recipes with one parameter, so that it can be swept. Filters are orthogonal to both.
//! What is in no catalogue is a [`BiasRule`] of the guest.

pub mod constant;
mod family;
pub mod layers;
pub mod normal;
pub mod plane;
mod rule;
pub mod slope;
mod strategy;
mod unit;

pub use constant::Weights;
pub use family::Family;
use glam::{DVec2, DVec3};
pub use layers::Layers;
pub use normal::{MoveNormal, NormalMove, NormalWeight, SurfaceNormals};
pub use plane::Follow;
pub use rule::{BiasRule, Rule};
pub use slope::PolygonOffset;
pub use strategy::{Strategy, UNREAL_SLOPE};
pub use unit::Unit;

/// What a bias may know about a place on a surface. World units, f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// World position.
    pub position: DVec3,
    /// Unit normal of the face on the side that the light reaches.
    pub normal: DVec3,
    /// Normals of the vertices there; `None` where a mesh has none and the face's stands for them.
    pub normals: Option<SurfaceNormals>,
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
    /// The w of its clip position: the distance along a spot's axis, 1 under a directional light.
    pub w: f64,
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
    /// Tap: a rule of its own, window depth.
    pub rule: Option<Rule>,
}

impl Default for Recipe {
    fn default() -> Self {
        Self::NONE
    }
}

impl Recipe {
    /// No bias at all.
    pub const NONE: Self = Self {
        polygon: PolygonOffset::NONE,
        caster_normal: NormalMove::NONE,
        caster_light: 0.0,
        caster_light_texels: 0.0,
        caster_light_slope: 0.0,
        oriented: 0.0,
        layers: Layers::Nearest,
        layer_offset: 0.0,
        normal: NormalMove::NONE,
        light: 0.0,
        window: 0.0,
        world: 0.0,
        texels: 0.0,
        steps: 0.0,
        slope: 0.0,
        slope_clamp: 0.0,
        follow: Follow::Receiver,
        rule: None,
    };

    /// Both biases together: what is an amount adds up, and what is a choice is the other's where this one
    /// has none.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let offset = |a: PolygonOffset, b: PolygonOffset| PolygonOffset {
            factor: a.factor + b.factor,
            units: a.units + b.units,
            clamp: a.clamp + b.clamp,
        };
        fn either<T: PartialEq>(one: T, none: T, other: T) -> T {
            if one == none { other } else { one }
        }
        let none = Self::NONE;
        Self {
            polygon: offset(self.polygon, other.polygon),
            caster_normal: either(self.caster_normal, none.caster_normal, other.caster_normal),
            caster_light: self.caster_light + other.caster_light,
            caster_light_texels: self.caster_light_texels + other.caster_light_texels,
            caster_light_slope: self.caster_light_slope + other.caster_light_slope,
            oriented: self.oriented + other.oriented,
            layers: either(self.layers, none.layers, other.layers),
            layer_offset: self.layer_offset + other.layer_offset,
            normal: either(self.normal, none.normal, other.normal),
            light: self.light + other.light,
            window: self.window + other.window,
            world: self.world + other.world,
            texels: self.texels + other.texels,
            steps: self.steps + other.steps,
            slope: self.slope + other.slope,
            slope_clamp: self.slope_clamp + other.slope_clamp,
            follow: either(self.follow, none.follow, other.follow),
            rule: either(self.rule, none.rule, other.rule),
        }
    }

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
