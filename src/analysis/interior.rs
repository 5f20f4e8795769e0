//! Interior receivers: those whose neighbourhood in the map sees one object first, so that edges play
//! no part.

use super::effort::Count;
use super::foremost::{Foremost, Points, Seen, States};
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

/// Asks point after point for the receivers of a chunk whose points agree so far.
fn asked(
    observer: &Observer<'_>,
    foremost: Option<&Foremost>,
    list: &[Observation],
) -> (Vec<bool>, [u64; 2]) {
    let texel = 1.0 / f64::from(observer.case().map.size);
    let eligible = |o: &&Observation| {
        matches!(o.standing, Standing::Counted | Standing::FacingAway) && in_map(o)
    };
    let points: Vec<DVec2> = list.iter().filter(eligible).map(|o| o.exact.truncate()).collect();
    let mut around = Around::new(foremost, &points);
    for (k, [dx, dy]) in POINTS.into_iter().enumerate() {
        around.ask(observer, k == 0, DVec2::new(dx, dy) * REACH * texel);
    }
    let mut objects = around.objects.iter();
    let is_interior = |o: &Observation| eligible(&o) && objects.next().is_some_and(Option::is_some);
    (list.iter().map(is_interior).collect(), [around.answered, around.traced])
}

/// Points, and the one object that was seen first from all around each of them so far.
struct Around<'a> {
    points: &'a [DVec2],
    foremost: Option<(&'a Foremost, Points)>,
    states: States,
    objects: Vec<Option<u16>>,
    answered: u64,
    traced: u64,
}

impl<'a> Around<'a> {
    fn new(foremost: Option<&'a Foremost>, points: &'a [DVec2]) -> Self {
        Self {
            points,
            foremost: foremost.map(|f| (f, f.sorted(points, 1.01 * REACH))),
            states: States::default(),
            objects: vec![None; points.len()],
            answered: 0,
            traced: 0,
        }
    }

    /// Looks from every point moved by `offset`; only the first look gives objects to those that
    /// have none.
    fn ask(&mut self, observer: &Observer<'_>, is_first: bool, offset: DVec2) {
        if let Some((foremost, points)) = &self.foremost {
            foremost.look(points, offset, &mut self.states);
        }
        for place in 0..self.points.len() {
            let (index, seen) = match &self.foremost {
                Some((foremost, points)) => {
                    (points.index()[place] as usize, foremost.seen(&self.states, place))
                }
                None => (place, Seen::Open),
            };
            let object = &mut self.objects[index];
            if !is_first && object.is_none() {
                continue;
            }
            self.answered += 1;
            self.traced += u64::from(seen == Seen::Open);
            let here = object_of(observer, seen, self.points[index] + offset);
            *object = if is_first || here == *object { here } else { None };
        }
    }
}

/// The object that the light sees first at a map point, by a ray where that is open.
fn object_of(observer: &Observer<'_>, seen: Seen, uv: DVec2) -> Option<u16> {
    let triangle = match seen {
        Seen::Nothing => None,
        Seen::First(triangle) => Some(triangle),
        Seen::Open => match observer.first_along(uv, Faces::Both) {
            FirstHit::Hit { triangle, .. } => Some(triangle),
            FirstHit::None | FirstHit::Ambiguous => None,
        },
    };
    triangle.map(|t| observer.geometry.object[t as usize])
}

fn in_map(o: &Observation) -> bool {
    o.exact.min_element() >= 0.0 && o.exact.max_element() <= 1.0
}
