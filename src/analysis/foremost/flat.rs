//! One triangle as a map sees it: outline, depth plane, and how well they are known.

use super::{CORNER, FAR_AWAY, IN_DEPTH, SIDEWAYS};
use crate::truth::Faces;
use glam::{DVec2, DVec3, DVec4};

/// A triangle as the map sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    pub(super) id: u32,
    pub(super) low: DVec2,
    pub(super) high: DVec2,
    /// Inward unit normals of the edges and their offsets: distance = n·p − d.
    pub(super) edges: [[f64; 3]; 3],
    /// Window depth = x·p.x + y·p.y + z.
    pub(super) plane: DVec3,
    /// What the plane may be off within [`SIDEWAYS`] of an edge.
    pub(super) slack: f64,
    /// The nearest corner.
    pub(super) nearest: f64,
    /// Whether the plane is not known well enough.
    pub(super) vague: bool,
}

impl Flat {
    pub(super) fn new(id: u32, clip: [DVec4; 3], size: DVec2, faces: Faces) -> Option<Self> {
        let window = clip.map(|v| v.truncate() / v.w * 0.5 + 0.5);
        let [a, b, c] = window.map(|w| w.truncate() * size);
        let depths = window.map(|w| w.z);
        let twice_area = (b - a).perp_dot(c - a);
        let longest = [b - a, c - b, a - c].map(|e| e.length()).into_iter().fold(0.0, f64::max);
        let reach = longest.max(1.0) * 4.0 * CORNER;
        let facing_known = twice_area.abs() > reach * 1e3;
        let hidden = match faces {
            Faces::Both => false,
            Faces::Front => twice_area < 0.0,
            Faces::Back => twice_area > 0.0,
        };
        if hidden && facing_known {
            return None;
        }
        let turn = if twice_area < 0.0 { -1.0 } else { 1.0 };
        let edge = |p: DVec2, q: DVec2| {
            let along = (q - p) * turn;
            let n = DVec2::new(-along.y, along.x) / along.length();
            [n.x, n.y, n.dot(p)]
        };
        let (p, q) = (b - a, c - a);
        let (dp, dq) = (depths[1] - depths[0], depths[2] - depths[0]);
        let gradient = DVec2::new(dp * q.y - dq * p.y, dq * p.x - dp * q.x) / twice_area;
        let range = dp.abs().max(dq.abs()).max((dp - dq).abs());
        let slack = 2.0 * SIDEWAYS * gradient.abs().element_sum();
        let depth_error = 1e-10 + 3.0 * range * reach / twice_area.abs() + slack / 200.0;
        let far_away = [a, b, c].iter().any(|p| !(p.abs().max_element() < FAR_AWAY));
        let flat = Self {
            id,
            low: a.min(b).min(c) - SIDEWAYS,
            high: a.max(b).max(c) + SIDEWAYS,
            edges: [edge(a, b), edge(b, c), edge(c, a)],
            plane: gradient.extend(depths[0] - gradient.dot(a)),
            slack: slack + IN_DEPTH,
            nearest: depths[0].min(depths[1]).min(depths[2]) - IN_DEPTH,
            vague: far_away || !facing_known || !(depth_error < IN_DEPTH / 10.0),
        };
        let beyond = flat.nearest > 1.0 + IN_DEPTH;
        (!beyond).then_some(flat)
    }
}
