//! Interior receivers: those whose neighbourhood in the map sees one object first, so that edges play
//! no part.

use super::effort::Count;
use super::foremost::{Foremost, Seen};
use super::observe::{Observation, Observer, Standing};
use crate::truth::{Faces, FirstHit};
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
    let foremost = observer.effort.skip.then(|| Foremost::new(observer, Faces::Both));
    let chunk = foremost.as_ref().map_or(1 << 12, Foremost::chunk);
    let one = |list: &[Observation]| asked(observer, foremost.as_ref(), list);
    let found: Vec<_> = observations.par_chunks(chunk).map(one).collect();
    let count = found.iter().fold([0; 2], |[a, e], (_, [b, f])| [a + b, e + f]);
    let count = Count {
        what: "map points around receivers",
        answered: count[0],
        evaluated: count[1],
        because: "f64 planes say with certainty what the light sees there first",
    };
    (found.into_iter().flat_map(|(inside, _)| inside).collect(), count)
}

/// Asks point after point for all receivers of a chunk whose points agree so far.
fn asked(
    observer: &Observer<'_>,
    foremost: Option<&Foremost>,
    list: &[Observation],
) -> (Vec<bool>, [u64; 2]) {
    let texel = 1.0 / f64::from(observer.case().map.size);
    let eligible = |o: &Observation| {
        matches!(o.standing, Standing::Counted | Standing::FacingAway) && in_map(o)
    };
    let mut left: Vec<u32> =
        (0..list.len() as u32).filter(|&i| eligible(&list[i as usize])).collect();
    let mut first: Vec<Option<u16>> = vec![None; list.len()];
    let (mut answered, mut traced) = (0, 0);
    for (k, [dx, dy]) in POINTS.into_iter().enumerate() {
        let offset = DVec2::new(dx, dy) * REACH * texel;
        let point = |&i: &u32| list[i as usize].exact.truncate() + offset;
        let points: Vec<DVec2> = left.iter().map(point).collect();
        let (objects, rays) = objects(observer, foremost, &points);
        (answered, traced) = (answered + points.len() as u64, traced + rays);
        let mut objects = objects.into_iter();
        left.retain(|&i| {
            let object = objects.next().flatten();
            let wanted = &mut first[i as usize];
            if k == 0 {
                *wanted = object;
            }
            object.is_some() && object == *wanted
        });
    }
    let mut inside = vec![false; list.len()];
    left.into_iter().for_each(|i| inside[i as usize] = true);
    (inside, [answered, traced])
}

/// The object that the light sees first at each point, and how many rays were traced for it.
fn objects(
    observer: &Observer<'_>,
    foremost: Option<&Foremost>,
    points: &[DVec2],
) -> (Vec<Option<u16>>, u64) {
    let open = || vec![Seen::Open; points.len()];
    let seen = foremost.map_or_else(open, |f| f.at(points));
    let mut rays = 0;
    let object = |triangle: u32| observer.geometry.object[triangle as usize];
    let of = |(seen, &uv): (Seen, &DVec2)| match seen {
        Seen::Nothing => None,
        Seen::First(triangle) => Some(object(triangle)),
        Seen::Open => {
            rays += 1;
            match observer.first_along(uv, Faces::Both) {
                FirstHit::Hit { triangle, .. } => Some(object(triangle)),
                FirstHit::None | FirstHit::Ambiguous => None,
            }
        }
    };
    (seen.into_iter().zip(points).map(of).collect(), rays)
}

fn in_map(o: &Observation) -> bool {
    o.exact.min_element() >= 0.0 && o.exact.max_element() <= 1.0
}
