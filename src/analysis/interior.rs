//! Interior receivers: those whose neighbourhood in the map sees one object first, so that edges play
//! no part.

use super::effort::Count;
use super::foremost::{Foremost, Seen};
use super::observe::{Observation, Observer, Standing};
use crate::light::Lens;
use crate::truth::{Faces, FirstHit, SeenFaces};
use glam::DVec2;
use rayon::prelude::*;

/// Distance of the eight neighbours from the receiver in map texels.
const REACH: f64 = 1.5;

/// The receiver's own map point and those around it, in units of [`REACH`].
const POINTS: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [-1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
    [1.0, -1.0],
    [0.0, -1.0],
    [0.0, 1.0],
    [-1.0, 0.0],
    [1.0, 0.0],
];

/// For each observation: whether nine light rays (its own and eight around it at 1.5 map texels) hit
/// the same object first. Receivers outside the map or of undecided truth are never interior;
/// receivers facing away from the light may be.
#[must_use]
pub fn interior(observer: &Observer<'_>, observations: &[Observation]) -> Vec<bool> {
    counted(observer, observations).0
}

/// As [`interior`], with the number of map points asked for and of rays traced.
#[must_use]
pub fn counted(observer: &Observer<'_>, observations: &[Observation]) -> (Vec<bool>, Count) {
    let eligible = |o: &Observation| {
        matches!(o.standing, Standing::Counted | Standing::FacingAway)
            && observer.lenses[o.map].holds(o.exact)
    };
    let mut interior = vec![false; observations.len()];
    let (mut answered, mut evaluated) = (0, 0);
    for (map, lens) in observer.lenses.iter().enumerate() {
        let which: Vec<u32> = (0..observations.len() as u32)
            .into_par_iter()
            .filter(|&k| observations[k as usize].map == map)
            .filter(|&k| eligible(&observations[k as usize]))
            .collect();
        let point = |&k: &u32| observations[k as usize].exact.truncate();
        let points: Vec<DVec2> = which.par_iter().map(point).collect();
        for Around { one_object, asked, traced } in around(observer, lens, &points) {
            one_object.iter().for_each(|&k| interior[which[k as usize] as usize] = true);
            (answered, evaluated) = (answered + asked, evaluated + traced);
        }
    }
    let because = "f64 planes say with certainty what the light sees there first";
    (interior, Count { what: "map points around receivers", answered, evaluated, because })
}

/// What was found around some points.
#[derive(Default)]
struct Around {
    /// Points all around which one object is seen first.
    one_object: Vec<u32>,
    /// Places asked for.
    asked: u64,
    /// Rays traced for them.
    traced: u64,
}

/// Looks around all points.
fn around(observer: &Observer<'_>, lens: &Lens, points: &[DVec2]) -> Vec<Around> {
    if !observer.effort.skip {
        let all: Vec<u32> = (0..points.len() as u32).collect();
        let open = |_: DVec2, _: usize| Seen::Open;
        return all
            .par_chunks(1 << 12)
            .map(|some| asked(observer, lens, points, some, open))
            .collect();
    }
    let foremost = Foremost::new(observer, lens, &SeenFaces::Alike(Faces::Both));
    foremost.by_block(points, 1.01 * REACH, |block, states| {
        let mut looked = None;
        asked(observer, lens, points, block.index(), |offset, place| {
            if looked != Some(offset) {
                foremost.look(block, offset, states);
                looked = Some(offset);
            }
            foremost.seen(states, place)
        })
    })
}

/// Asks offset after offset what is `seen` beside the points named by `which`, as long as they agree.
fn asked(
    observer: &Observer<'_>,
    lens: &Lens,
    points: &[DVec2],
    which: &[u32],
    mut seen: impl FnMut(DVec2, usize) -> Seen,
) -> Around {
    let texel = 1.0 / lens.texels(DVec2::ONE);
    let mut objects: Vec<Option<u16>> = vec![None; which.len()];
    let mut around = Around::default();
    for (k, [dx, dy]) in POINTS.into_iter().enumerate() {
        let offset = DVec2::new(dx, dy) * REACH * texel;
        for (place, object) in objects.iter_mut().enumerate() {
            if k > 0 && object.is_none() {
                continue;
            }
            let seen = seen(offset, place);
            around.asked += 1;
            around.traced += u64::from(seen == Seen::Open);
            let here = object_of(observer, lens, seen, points[which[place] as usize] + offset);
            *object = if k == 0 || here == *object { here } else { None };
        }
    }
    let agree = which.iter().zip(&objects).filter(|(_, object)| object.is_some());
    around.one_object = agree.map(|(&k, _)| k).collect();
    around
}

/// The object that the light sees first at a map point, by a ray where that is open.
fn object_of(observer: &Observer<'_>, lens: &Lens, seen: Seen, uv: DVec2) -> Option<u16> {
    let triangle = match seen {
        Seen::Nothing => None,
        Seen::First(triangle) => Some(triangle),
        Seen::Open => match observer.first_along(lens, uv, Faces::Both) {
            FirstHit::Hit { triangle, .. } => Some(triangle),
            FirstHit::None | FirstHit::Ambiguous => None,
        },
    };
    triangle.map(|t| observer.geometry.object[t as usize])
}
