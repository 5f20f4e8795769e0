//! What drawing both faces of all casters would change where culling causes false light.

use serde::Serialize;

/// A case at its own bias with both faces of every caster in the map, at the same receivers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct BothFaces {
    /// Wrong verdicts as a share of the truly lit; `None` where there are none.
    pub false_shadow: Option<f64>,
    /// Wrong verdicts as a share of the truly shadowed; `None` where there are none.
    pub false_light: Option<f64>,
    /// What is seen of all that is wrong.
    pub seen: Option<f64>,
}

impl BothFaces {
    /// What it changes where culling lights `culled` receivers, in one sentence.
    #[must_use]
    pub fn sentence(&self, culled: u64) -> String {
        let percent = |rate: Option<f64>| {
            rate.map_or("not measured".to_string(), |rate| format!("{:.2} %", 100.0 * rate))
        };
        format!(
            "Culling leaves all faces out of the map that shadow {culled} falsely lit receivers, which no \
             bias repairs: with both faces drawn false shadow is {} of the lit and false light {} of the \
             shadowed.",
            percent(self.false_shadow),
            percent(self.false_light)
        )
    }
}
