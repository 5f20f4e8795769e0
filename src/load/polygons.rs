//! Faces of any number of corners as triangles: convex ones as a fan, others cut ear by ear.

use super::strips;
use earcut::Earcut;
use glam::{DVec2, DVec3};
use gnomon_core::{Error, Result};

/// Corners of the largest face that is cut ear by ear, which takes the square of their number at worst.
const LARGEST_CONCAVE: usize = 1 << 14;
/// Corners² of all such faces together.
const LARGEST_WORK: u64 = 1 << 32;
/// A face is bent where a corner lies off its plane by more than this share of its size.
const BENT: f64 = 1e-4;
/// A face that is cut into another area than its outline encloses, by this share, is not simple.
const OFF: f64 = 1e-6;

/// Cuts faces, one after the other; keeps what it needs from face to face.
pub(super) struct Cutter {
    ears: Earcut<f64>,
    outline: Vec<[f64; 2]>,
    cut: Vec<u32>,
    work: u64,
    /// Whether the face at hand is bent.
    bent: bool,
    /// Faces whose outline crosses itself or has no area, and which are as the library cuts them.
    odd: usize,
}

impl Cutter {
    pub(super) fn new() -> Self {
        Self {
            ears: Earcut::new(),
            outline: Vec::new(),
            cut: Vec::new(),
            work: 0,
            bent: false,
            odd: 0,
        }
    }

    /// Adds the triangles of a face of three corners or more, which stand `at` places, to `triangles`.
    /// Faces that are convex as seen along their normal are fans around their first corner, as other
    /// readers draw them. A corner that is not there is left to the check of indices.
    pub(super) fn face(
        &mut self,
        place: impl Fn() -> String,
        face: &[u32],
        at: impl Fn(u32) -> Option<DVec3>,
        triangles: &mut Vec<u32>,
    ) -> Result<()> {
        if let &[a, b, c] = face {
            triangles.extend([a, b, c]);
            return Ok(());
        }
        if self.flatten(face, at).is_none() || is_convex(&self.outline) {
            triangles.extend(strips::fan(face));
            return Ok(());
        }
        self.work = self.work.saturating_add((face.len() as u64).pow(2));
        if face.len() > LARGEST_CONCAVE || self.work > LARGEST_WORK {
            let reason = format!("is a concave face of {} corners, too many to cut", face.len());
            return Err(Error::bad_input(place(), reason, "triangulate the mesh before"));
        }
        self.ears.earcut_slice(&self.outline, &[], &mut self.cut);
        let off = earcut::deviation(self.outline.iter().copied(), &[], &self.cut);
        // Corners on a line as seen along the normal are left out, but those of a bent face are not on one.
        let torn = self.bent && self.cut.len() < 3 * (face.len() - 2);
        self.odd += usize::from(torn || !(off <= OFF));
        if torn {
            triangles.extend(strips::fan(face));
            return Ok(());
        }
        triangles.extend(self.cut.iter().filter_map(|&i| face.get(i as usize)));
        Ok(())
    }

    /// The face as seen along its normal (Newell's, from all edges); `None` without area.
    fn flatten(&mut self, face: &[u32], at: impl Fn(u32) -> Option<DVec3>) -> Option<()> {
        self.outline.clear();
        let first = at(*face.first()?)?;
        let (mut normal, mut before) = (DVec3::ZERO, at(*face.last()?)? - first);
        for &corner in face {
            let corner = at(corner)? - first;
            normal += before.cross(corner);
            before = corner;
        }
        let along = normal.abs();
        let (u, v, sign) = match along.max_element() {
            largest if !(largest > 0.0 && largest.is_finite()) => return None,
            largest if largest == along.x => (DVec3::Y, DVec3::Z, normal.x),
            largest if largest == along.y => (DVec3::Z, DVec3::X, normal.y),
            _ => (DVec3::X, DVec3::Y, normal.z),
        };
        let away = |p: DVec3| (p.dot(normal) / normal.length(), p.abs().max_element());
        let corners = face.iter().filter_map(|&i| Some(away(at(i)? - first)));
        let (off, size) =
            corners.fold((0.0f64, 0.0f64), |(off, size), (d, s)| (off.max(d.abs()), size.max(s)));
        self.bent = off > BENT * size;
        let flat = |p: DVec3| [p.dot(u) * sign.signum(), p.dot(v)];
        self.outline.extend(face.iter().filter_map(|&i| Some(flat(at(i)? - first))));
        Some(())
    }

    /// What a user should know of the faces that were cut.
    pub(super) fn note(&self, place: &str, notes: &mut Vec<String>) {
        if self.odd > 0 {
            let odd = self.odd;
            notes.push(format!(
                "{place}: {odd} faces cross themselves; their triangles are a guess"
            ));
        }
    }
}

/// Whether a counter-clockwise outline never turns right and goes round once.
fn is_convex(outline: &[[f64; 2]]) -> bool {
    let next = outline.iter().cycle().skip(1);
    let edges =
        outline.iter().zip(next).map(|(a, b)| DVec2::from_array(*b) - DVec2::from_array(*a));
    let edges: Vec<DVec2> = edges.filter(|&edge| edge != DVec2::ZERO).collect();
    let turns = edges.iter().zip(edges.iter().cycle().skip(1));
    let mut reversals = 0;
    for (a, b) in turns {
        if a.perp_dot(*b) < 0.0 || (a.perp_dot(*b) == 0.0 && a.dot(*b) < 0.0) {
            return false;
        }
        // Once round, the direction along x turns twice.
        reversals += usize::from(is_right(*a) != is_right(*b));
    }
    reversals <= 2
}

/// The half-open half plane of directions to the right.
fn is_right(edge: DVec2) -> bool {
    edge.x > 0.0 || (edge.x == 0.0 && edge.y > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(corners: &[[f32; 2]]) -> (Vec<u32>, f64, usize) {
        let positions: Vec<DVec3> = corners
            .iter()
            .map(|&[x, y]| DVec3::new(x.into(), y.into(), (0.5 * x).into()))
            .collect();
        let face: Vec<u32> = (0..positions.len() as u32).collect();
        let (mut cutter, mut triangles) = (Cutter::new(), Vec::new());
        cutter
            .face(|| "here".into(), &face, |i| positions.get(i as usize).copied(), &mut triangles)
            .expect("a cut");
        let corner = |i: u32| positions[i as usize].truncate();
        let area = |t: &[u32]| {
            let [a, b, c] = [t[0], t[1], t[2]].map(corner);
            (b - a).perp_dot(c - a) / 2.0
        };
        let total = triangles.chunks(3).map(area).sum();
        (triangles, total, cutter.odd)
    }

    #[test]
    fn convex_faces_are_fans_and_concave_ones_keep_their_area() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(cut(&square).0, [0, 1, 2, 0, 2, 3]);
        let mut clockwise = square;
        clockwise.reverse();
        assert_eq!(cut(&clockwise).0, [0, 1, 2, 0, 2, 3], "either side is seen along its normal");
        let arrow = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.5, 0.5]];
        let (triangles, area, odd) = cut(&arrow);
        assert_eq!((triangles.len(), odd), (6, 0));
        assert_eq!(area, 1.0);
        let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];
        assert_eq!((cut(&l).1, cut(&l).2), (7.0, 0));
        let on_the_edge = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(cut(&on_the_edge).0.len(), 9, "a corner on an edge is no concave one");
    }

    #[test]
    fn a_bent_face_loses_no_corner() {
        // Seen from above, the last corner lies on the edge before it.
        let corners = [
            [-5.0, 0.0, 5.0],
            [5.0, 0.0, 5.0],
            [5.0, 0.0, -5.0],
            [-5.0, 0.0, -5.0],
            [0.0, 5.0, -5.0],
        ];
        let corners = corners.map(DVec3::from_array);
        let (mut cutter, mut triangles) = (Cutter::new(), Vec::new());
        let at = |i: u32| corners.get(i as usize).copied();
        cutter.face(|| "here".into(), &[0, 1, 2, 3, 4], at, &mut triangles).expect("a cut");
        assert_eq!((triangles.len(), cutter.odd), (9, 1));
    }

    #[test]
    fn stars_and_bow_ties_are_told() {
        let star: Vec<[f32; 2]> = (0..5)
            .map(|i| f64::from(i) * 4.0 * std::f64::consts::PI / 5.0)
            .map(|a| [libm::cos(a) as f32, libm::sin(a) as f32])
            .collect();
        assert_eq!(cut(&star).2, 1, "goes round twice");
        assert_eq!(cut(&[[0.0, 0.0], [3.0, 2.0], [3.0, 0.0], [0.0, 1.0]]).2, 1, "crosses itself");
    }
}
