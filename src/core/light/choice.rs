//! Which maps a receiver looks up, and with what weights: from where it looks and the camera's view depth.

use super::map::Map;
use crate::{Error, Result};

/// How a receiver chooses among the maps of its light. It never depends on the bias that is compared.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// There is one map.
    #[default]
    Only,
    /// The first map in the list in whose square the receiver lies at least `border` inside, in shares of
    /// its side, the last where none does. Over the `blend` next to that border it is mixed with the next
    /// that holds it.
    FirstThatHolds {
        /// Share of the side next to the edge that does not count, in [0, ½).
        border: f32,
        /// Share of the side over which two maps are mixed; 0 for a hard seam.
        blend: f32,
    },
    /// By distance along the camera's axis: map k up to `ends[k]`, the last beyond; over the share `blend`
    /// of the way back to the end before, it is mixed with the next (cascades).
    ViewDepth {
        /// Ascending; one for each map but the last.
        ends: Vec<f32>,
        /// Share of a range, in [0, 1].
        blend: f32,
    },
}

/// A map and its share of a receiver's visibility.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// The map's place in the list.
    pub map: usize,
    /// In (0, 1]; those of a receiver add up to 1.
    pub weight: f64,
}

/// What a choice may know of a place that is looked up.
#[derive(Clone, Copy)]
pub struct PlaceInMaps<'p> {
    /// Map coordinates and compared depth in each map, as the subject computes them.
    pub coords: &'p [[f32; 3]],
    /// Distance along the camera's axis, world units.
    pub view_depth: &'p dyn Fn() -> f32,
}

impl std::fmt::Debug for PlaceInMaps<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PlaceInMaps").field("coords", &self.coords).finish_non_exhaustive()
    }
}

/// One look-up of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// The map's place in the light's list.
    pub map: usize,
    /// Map coordinates u, v and compared depth z.
    pub coord: [f32; 3],
    /// Its share of the receiver's visibility.
    pub weight: f64,
}

impl Lookup {
    /// A look-up of a light's only map.
    #[must_use]
    pub const fn only(coord: [f32; 3]) -> Self {
        Self { map: 0, coord, weight: 1.0 }
    }
}

impl Choice {
    /// Checks that it fits a list of so many maps.
    ///
    /// # Errors
    /// [`Error::BadInput`] naming the field.
    pub(super) fn checked(&self, maps: usize) -> Result<()> {
        let bad = |field: &str, reason: String, fix: &str| {
            Err(Error::bad_input(format!("light.choice{field}"), reason, fix))
        };
        match self {
            Self::Only if maps > 1 => {
                bad("", format!("says there is one map of {maps}"), "choose among them")
            }
            Self::FirstThatHolds { border, .. } if !(0.0..0.5).contains(border) => {
                bad(".border", format!("{border} is not in [0, 0.5)"), "give a share of the side")
            }
            Self::FirstThatHolds { blend, .. } | Self::ViewDepth { blend, .. }
                if !(0.0..=1.0).contains(blend) =>
            {
                bad(".blend", format!("{blend} is not in [0, 1]"), "give a share")
            }
            Self::ViewDepth { ends, .. } if ends.len() + 1 != maps => bad(
                ".ends",
                format!("has {} ends for {maps} maps", ends.len()),
                "give one for each map but the last",
            ),
            Self::ViewDepth { ends, .. }
                if !ends.iter().all(|e| e.is_finite()) || !ends.is_sorted_by(|a, b| a < b) =>
            {
                bad(".ends", "does not ascend".to_string(), "give growing distances")
            }
            Self::Only | Self::FirstThatHolds { .. } | Self::ViewDepth { .. } => Ok(()),
        }
    }

    /// The maps of a place, the one with the larger index last: one, or two that are mixed.
    #[must_use]
    pub fn among(&self, maps: &[Map], place: &PlaceInMaps<'_>) -> [Option<Chosen>; 2] {
        match self {
            Self::Only => only(0),
            Self::FirstThatHolds { border, blend } => {
                let insets = maps.iter().zip(place.coords).map(|(map, coord)| inset(map, coord));
                by_square(insets.map(|inset| inset - border), *blend)
            }
            Self::ViewDepth { ends, blend } => by_depth(ends, *blend, (place.view_depth)()),
        }
    }
}

fn only(map: usize) -> [Option<Chosen>; 2] {
    [Some(Chosen { map, weight: 1.0 }), None]
}

/// Two maps mixed; one alone where the other has no share.
fn mixed(first: usize, second: usize, share: f32) -> [Option<Chosen>; 2] {
    if share <= 0.0 {
        return only(first);
    }
    if share >= 1.0 {
        return only(second);
    }
    let share = f64::from(share);
    [Some(Chosen { map: first, weight: 1.0 - share }), Some(Chosen { map: second, weight: share })]
}

/// How far inside a map's square a receiver lies, in shares of its side; −∞ where its depth is none of
/// the map's.
fn inset(map: &Map, &[u, v, z]: &[f32; 3]) -> f32 {
    let [low, high] = map.clip.depths();
    match (low..=high).contains(&f64::from(z)) {
        true => u.min(1.0 - u).min(v.min(1.0 - v)),
        false => f32::NEG_INFINITY,
    }
}

fn by_square(insets: impl ExactSizeIterator<Item = f32>, blend: f32) -> [Option<Chosen>; 2] {
    let last = insets.len().saturating_sub(1);
    let mut holding = insets.enumerate().filter(|&(_, inside)| inside >= 0.0);
    let Some((first, inside)) = holding.next() else { return only(last) };
    match holding.next() {
        Some((second, _)) if inside < blend => mixed(first, second, 1.0 - inside / blend),
        _ => only(first),
    }
}

fn by_depth(ends: &[f32], blend: f32, depth: f32) -> [Option<Chosen>; 2] {
    let map = ends.iter().take_while(|&&end| depth >= end).count();
    let Some(&end) = ends.get(map) else { return only(map) };
    let start = if map == 0 { 0.0 } else { ends[map - 1] };
    let band = blend * (end - start);
    let left = end - depth;
    if left < band { mixed(map, map + 1, 1.0 - left / band) } else { only(map) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{Projection, View};
    use glam::DVec3;

    fn shares(choice: &Choice, place: &PlaceInMaps<'_>) -> Vec<(usize, f64)> {
        let view = View { position: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };
        let square = Projection::Orthographic { width: 2.0, height: 2.0, near: 0.0, far: 1.0 };
        let chosen = choice.among(&[Map::new(view, square); 2], place);
        chosen.into_iter().flatten().map(|c| (c.map, c.weight)).collect()
    }

    #[test]
    fn cascades_blend_over_the_end_of_each_range() {
        let choice = Choice::ViewDepth { ends: vec![10.0, 30.0], blend: 0.25 };
        let at = |view_depth: f32| {
            shares(&choice, &PlaceInMaps { coords: &[], view_depth: &|| view_depth })
        };
        assert_eq!(at(5.0), [(0, 1.0)]);
        assert_eq!(at(8.75), [(0, 0.5), (1, 0.5)], "halfway through the last quarter of 10");
        assert_eq!(at(10.0), [(1, 1.0)], "the end belongs to the next");
        assert_eq!(at(28.75), [(1, 0.25), (2, 0.75)]);
        assert_eq!(at(99.0), [(2, 1.0)]);
    }

    #[test]
    fn the_first_square_that_holds_a_place_is_taken() {
        let choice = Choice::FirstThatHolds { border: 0.125, blend: 0.25 };
        let at = |u: f32, v: f32| {
            let coords = [[u, 0.5, 0.5], [v, 0.5, 0.5]];
            shares(&choice, &PlaceInMaps { coords: &coords, view_depth: &|| 0.0 })
        };
        assert_eq!(at(0.5, 0.5), [(0, 1.0)]);
        assert_eq!(at(0.25, 0.5), [(0, 0.5), (1, 0.5)]);
        assert_eq!(at(0.25, 0.0), [(0, 1.0)], "no other holds it");
        assert_eq!(at(0.0, 0.5), [(1, 1.0)]);
        assert_eq!(at(-1.0, 2.0), [(1, 1.0)], "the last where none does");
    }

    #[test]
    fn a_choice_that_does_not_fit_is_refused() {
        let message = |choice: Choice, maps| choice.checked(maps).unwrap_err().to_string();
        assert!(message(Choice::Only, 2).contains("light.choice"));
        let one = Choice::ViewDepth { ends: vec![1.0], blend: 0.0 };
        assert!(message(one.clone(), 3).contains("1 ends for 3 maps"));
        assert!(one.checked(2).is_ok());
        let nan = Choice::ViewDepth { ends: vec![f32::NAN], blend: 0.0 };
        assert!(message(nan, 2).contains("ascend"));
        let blend = Choice::FirstThatHolds { border: 0.0, blend: f32::NAN };
        assert!(message(blend, 2).contains("blend"));
    }
}
