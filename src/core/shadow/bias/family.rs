//! What has to be evaluated anew where a bias changes, read off its recipes.

use super::Recipe;

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
        /// Texels and stored depths stay; a rule says the bias of each receiver at each amount.
        Rule = "rule",
    }
}

impl Family {
    /// What changes between two recipes; of several the one that most hangs on.
    #[must_use]
    pub fn between(one: &Recipe, other: &Recipe) -> Self {
        let vertex = |r: &Recipe| {
            (r.caster_normal, r.caster_light, r.caster_light_texels, r.caster_light_slope)
        };
        let map = |r: &Recipe| (r.polygon, r.oriented, r.layers, r.layer_offset);
        if vertex(one) != vertex(other) {
            Self::Vertex
        } else if (one.normal, one.light) != (other.normal, other.light) {
            Self::Receiver
        } else if map(one) != map(other) {
            Self::Map
        } else if one.rule != other.rule {
            Self::Rule
        } else {
            Self::Tap
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shadow::bias::Strategy;

    #[test]
    fn a_family_is_what_its_recipes_change() {
        for &strategy in Strategy::ALL {
            let recipe = strategy.with(0.25);
            match strategy.family() {
                Family::Tap | Family::Rule => {
                    assert!(!recipe.moves_receiver() && !recipe.moves_vertices());
                }
                Family::Map => assert!(recipe.changes_map() && !recipe.moves_vertices()),
                Family::Receiver => assert!(recipe.moves_receiver() && !recipe.changes_map()),
                Family::Vertex => assert!(recipe.moves_vertices()),
            }
        }
    }
}
