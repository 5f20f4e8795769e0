//! Which stored surfaces count as the receiver's own: triangles reached across shared edges near a
//! texel.

use crate::scene::Geometry;
use glam::DVec2;
use std::collections::HashMap;

/// Triangles across each triangle's edges, vertices welded by position.
#[derive(Clone, Debug)]
pub struct Adjacency {
    neighbours: Vec<Vec<u32>>,
}

impl Adjacency {
    /// Welds vertices of equal position (−0 equals +0) and pairs triangles over shared edges.
    #[must_use]
    pub fn new(geometry: &Geometry) -> Self {
        let mut welded: HashMap<[u64; 3], u32> = HashMap::new();
        let weld: Vec<u32> = geometry
            .positions
            .iter()
            .map(|p| {
                let key = (*p + 0.0).to_array().map(f64::to_bits);
                let next = welded.len() as u32;
                *welded.entry(key).or_insert(next)
            })
            .collect();
        let mut edges: HashMap<(u32, u32), Vec<u32>> = HashMap::new();
        for (id, t) in geometry.triangles.iter().enumerate() {
            let v = t.map(|v| weld[v as usize]);
            for i in 0..3 {
                let (a, b) = (v[i].min(v[(i + 1) % 3]), v[i].max(v[(i + 1) % 3]));
                if a != b {
                    edges.entry((a, b)).or_default().push(id as u32);
                }
            }
        }
        let mut neighbours = vec![Vec::new(); geometry.triangles.len()];
        for sharing in edges.values() {
            for &a in sharing {
                neighbours[a as usize].extend(sharing.iter().copied().filter(|&b| b != a));
            }
        }
        neighbours.iter_mut().for_each(|list: &mut Vec<u32>| {
            list.sort_unstable();
            list.dedup();
        });
        Self { neighbours }
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
        let mut seen = vec![own];
        let mut next = 0;
        while next < seen.len() {
            for &t in &self.neighbours[seen[next] as usize] {
                if !seen.contains(&t) && overlaps(t) {
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
    use glam::DVec3;

    #[test]
    fn a_quad_is_one_surface_near_its_diagonal_only() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let geometry = Geometry {
            positions: vec![p(0., 0.), p(100., 0.), p(100., 100.), p(0., 100.)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            object: vec![0, 0],
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
