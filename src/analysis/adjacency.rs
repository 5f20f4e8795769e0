//! Which stored surfaces count as the receiver's own: triangles reached across shared edges near a
//! texel.

use crate::scene::Geometry;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Triangles across each triangle's edges, vertices welded by position: one list after the other.
#[derive(Clone, Debug)]
pub struct Adjacency {
    /// Where each triangle's list begins; one more at the end.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

/// Triangles passed on one search without the heap.
const FEW: usize = 32;

impl Adjacency {
    /// Welds vertices of equal position (−0 equals +0) and pairs triangles over shared edges.
    #[must_use]
    pub fn new(geometry: &Geometry) -> Self {
        let welded = welded(&geometry.positions);
        let edges = |(id, t): (usize, &[u32; 3])| {
            let v = t.map(|v| welded[v as usize]);
            let edge = move |i: usize| {
                let (a, b) = (v[i], v[(i + 1) % 3]);
                (a != b).then(|| ((u64::from(a.min(b)) << 32) | u64::from(a.max(b)), id as u32))
            };
            (0..3).filter_map(edge)
        };
        let triangles = geometry.triangles.par_iter().with_min_len(1024).enumerate();
        let mut edges: Vec<(u64, u32)> = triangles.flat_map_iter(edges).collect();
        edges.par_sort_unstable();
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(edges.len());
        for sharing in edges.chunk_by(|a, b| a.0 == b.0) {
            for &(_, a) in sharing {
                let others = sharing.iter().map(|&(_, b)| b).filter(|&b| b != a);
                pairs.extend(others.map(|b| (a, b)));
            }
        }
        pairs.par_sort_unstable();
        pairs.dedup();
        let mut starts = vec![0u32; geometry.triangles.len() + 1];
        pairs.iter().for_each(|&(a, _)| starts[a as usize + 1] += 1);
        for i in 0..geometry.triangles.len() {
            starts[i + 1] += starts[i];
        }
        Self { starts, neighbours: pairs.into_iter().map(|(_, b)| b).collect() }
    }

    fn of(&self, id: u32) -> &[u32] {
        let first = self.starts[id as usize] as usize;
        &self.neighbours[first..self.starts[id as usize + 1] as usize]
    }

    /// Whether `caster` is `own` or reached from it through triangles that overlap the square of
    /// 3×3 texels around the one at `centre` (map coordinates in texels; `project` gives a
    /// triangle's corners there, `None` behind the eye).
    #[must_use]
    pub fn is_own(
        &self,
        own: u32,
        caster: u32,
        centre: DVec2,
        project: impl Fn(u32) -> Option<[DVec2; 3]>,
    ) -> bool {
        if caster == own {
            return true;
        }
        let overlaps = |t: u32| project(t).is_some_and(|corners| overlap(&corners, centre, 1.5));
        let mut seen = Passed { few: [own; FEW], many: Vec::new(), len: 1 };
        let mut next = 0;
        while next < seen.len {
            for &t in self.of(seen.get(next)) {
                if !seen.contains(t) && overlaps(t) {
                    if t == caster {
                        return true;
                    }
                    seen.push(t);
                }
            }
            next += 1;
        }
        false
    }
}

/// The triangles that a search has passed; the first few lie in place.
struct Passed {
    few: [u32; FEW],
    many: Vec<u32>,
    len: usize,
}

impl Passed {
    fn get(&self, k: usize) -> u32 {
        if k < FEW { self.few[k] } else { self.many[k - FEW] }
    }

    fn contains(&self, t: u32) -> bool {
        self.few[..self.len.min(FEW)].contains(&t) || self.many.contains(&t)
    }

    fn push(&mut self, t: u32) {
        match self.few.get_mut(self.len) {
            Some(place) => *place = t,
            None => self.many.push(t),
        }
        self.len += 1;
    }
}

/// The least vertex at each vertex' position.
fn welded(positions: &[DVec3]) -> Vec<u32> {
    let key = |(k, p): (usize, &DVec3)| ((*p + 0.0).to_array().map(f64::to_bits), k as u32);
    let mut sorted: Vec<_> = positions.par_iter().enumerate().map(key).collect();
    sorted.par_sort_unstable();
    let mut welded = vec![0; positions.len()];
    for same in sorted.chunk_by(|a, b| a.0 == b.0) {
        same.iter().for_each(|&(_, k)| welded[k as usize] = same[0].1);
    }
    welded
}

/// Whether a triangle and a square of half-width `half` meet (separating axes; touching counts).
fn overlap(corners: &[DVec2; 3], centre: DVec2, half: f64) -> bool {
    let p = corners.map(|c| c - centre);
    let box_axes = |k: usize| {
        let low = p[0][k].min(p[1][k]).min(p[2][k]);
        let high = p[0][k].max(p[1][k]).max(p[2][k]);
        low <= half && high >= -half
    };
    let edge_axis = |i: usize| {
        let edge = p[(i + 1) % 3] - p[i];
        let normal = DVec2::new(-edge.y, edge.x);
        let (on, off) = (normal.dot(p[i]), normal.dot(p[(i + 2) % 3]));
        let reach = half * (normal.x.abs() + normal.y.abs());
        on.min(off) <= reach && on.max(off) >= -reach
    };
    box_axes(0) && box_axes(1) && (0..3).all(edge_axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_is_one_surface_near_its_diagonal_only() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let geometry = Geometry {
            positions: vec![p(0., 0.), p(100., 0.), p(100., 100.), p(0., 100.)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            object: vec![0, 0],
            ..Geometry::default()
        };
        let adjacency = Adjacency::new(&geometry);
        let project = |t: u32| Some(geometry.corners(t).map(|c| c.truncate()));
        assert!(adjacency.is_own(0, 1, DVec2::splat(50.5), project), "on the diagonal");
        assert!(!adjacency.is_own(0, 1, DVec2::new(90.5, 10.5), project), "far from it");
        assert!(adjacency.is_own(1, 1, DVec2::new(90.5, 10.5), project), "itself");
    }

    #[test]
    fn overlap_is_not_a_bounding_box_test() {
        let corners = [DVec2::new(0., 0.), DVec2::new(10., 0.), DVec2::new(0., 10.)];
        assert!(!overlap(&corners, DVec2::new(9.0, 9.0), 1.5), "beyond the hypotenuse");
        assert!(overlap(&corners, DVec2::new(5.0, 6.0), 1.5), "across it");
    }
}
