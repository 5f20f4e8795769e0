//! Checks of the truth that tests and soak runs share: leaks, integers, the shadow of a sphere.
#![allow(dead_code, unreachable_pub, reason = "every test binary uses a part of it")]

use glam::DVec3;
use gnomon::scene::Geometry;
use gnomon::truth::{Answer, Occlusion, Receiver, Tracer, Truth};

use crate::exact::{self, Meeting, Point, Ratio, neighbours_blocked, point};
use crate::meshes::{self, Random, icosphere, scene};

/// A triangle id that no scene has.
pub const NOWHERE: u32 = u32::MAX;

pub fn look(tracer: &Tracer, from: DVec3, to: DVec3) -> Answer {
    tracer.truth(&Receiver { position: from, triangle: NOWHERE }, to)
}

/// Far from the origin, where f32 would collapse.
pub const FAR: DVec3 = DVec3::new(148_376.0, 1_234.0, -223_423.0);

/// Rays from inside a closed mesh to `beyond` its corners, edges and faces by a factor of two;
/// every one must be shadowed. Returns how many were not.
pub fn leaks(mesh: &Geometry, centre: DVec3, rays: u32, random: &mut Random) -> u32 {
    let tracer = Tracer::new(mesh);
    let mut ends: Vec<(DVec3, DVec3)> = Vec::with_capacity(rays as usize);
    for k in 0..rays {
        let from = meshes::dyadic(centre + random.cube() * 0.25);
        let [a, b, c] = mesh.corners(random.index(mesh.triangles.len()) as u32);
        let aim = match k % 4 {
            0 => a,
            1 => (b + c) / 2.0,
            2 => b + (c - b) * 0.25,
            _ => a + (b - a) * random.unit() * 0.5 + (c - a) * random.unit() * 0.5,
        };
        ends.push((from, from + (aim - from) * 2.0));
    }
    let leaked = |(from, to): &(DVec3, DVec3)| {
        !matches!(look(&tracer, *from, *to).truth, Truth::Shadowed(_))
    };
    ends.iter().filter(|e| leaked(e)).count() as u32
}

/// What integers say about one segment.
enum Oracle {
    Lit,
    Shadowed { near: Vec<u32>, far: Vec<u32> },
    Marginal { blocked: bool },
}

fn oracle(scene: &Geometry, from: Point, to: Point) -> Oracle {
    let ids = 0..scene.triangles.len() as u32;
    let meetings: Vec<(u32, Meeting)> =
        ids.map(|id| (id, exact::meet(from, to, exact::triangle(scene, id)))).collect();
    let mut inside: Vec<(u32, Ratio)> = Vec::new();
    let mut marginal = false;
    let mut at_ends = Vec::new();
    for &(id, meeting) in &meetings {
        match meeting {
            Meeting::Inside(t) | Meeting::Boundary(t) if t.0 == 0 => at_ends.push(id),
            Meeting::Inside(t) | Meeting::Boundary(t) if t.0 == t.1 => {
                at_ends.push(id);
                marginal = true;
            }
            Meeting::Inside(t) => inside.push((id, t)),
            Meeting::Boundary(_) | Meeting::InPlane => marginal = true,
            Meeting::Miss => {}
        }
    }
    inside.sort_by(|a, b| a.1.cmp(b.1));
    match (marginal, inside.first(), inside.last()) {
        (true, ..) => Oracle::Marginal {
            blocked: neighbours_blocked(scene, from, to, |id| at_ends.contains(&id)),
        },
        (false, Some(first), Some(last)) => {
            let same =
                |t: Ratio| inside.iter().filter(move |x| x.1.cmp(t).is_eq()).map(|x| x.0).collect();
            Oracle::Shadowed { near: same(first.1), far: same(last.1) }
        }
        _ => Oracle::Lit,
    }
}

/// Compares one segment with the oracle; returns whether it was marginal.
pub fn check(scene: &Geometry, tracer: &Tracer, from: DVec3, to: DVec3) -> Result<bool, String> {
    let truth = look(tracer, from, to).truth;
    let wrong = |expected: &str| Err(format!("{from} -> {to}: {truth:?}, integers say {expected}"));
    match (oracle(scene, point(from), point(to)), truth) {
        (Oracle::Lit, Truth::Lit) => Ok(false),
        (Oracle::Shadowed { near, far }, Truth::Shadowed(Occlusion { occluder, first, .. })) => {
            if near.contains(&occluder) && far.contains(&first) {
                Ok(false)
            } else {
                wrong(&format!("occluder of {near:?}, first of {far:?}"))
            }
        }
        (Oracle::Marginal { blocked: true }, Truth::Shadowed(_))
        | (Oracle::Marginal { blocked: false }, Truth::Ambiguous | Truth::Lit) => Ok(true),
        (Oracle::Lit, _) => wrong("lit"),
        (Oracle::Shadowed { .. }, _) => wrong("shadowed"),
        (Oracle::Marginal { blocked }, _) => wrong(&format!("marginal, blocked: {blocked}")),
    }
}

/// Integer triangles: soups, and grids whose corners and edges lie on lattice lines.
pub fn lattice_scene(random: &mut Random, half: i64) -> Geometry {
    let mut lattice = || DVec3::from_array([0; 3].map(|_| random.integer(-half, half) as f64));
    let mut points: Vec<DVec3> = (0..12).map(|_| lattice()).collect();
    let height = lattice().x;
    points.extend(
        (0..16).map(|k| DVec3::new(f64::from(k % 4) * 2.0, height, f64::from(k / 4) * 2.0)),
    );
    let mut triangles: Vec<[u32; 3]> = (0..8)
        .map(|_| [0; 3].map(|_| random.index(12) as u32))
        .filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
        .collect();
    for k in (12..24).filter(|k| k % 4 != 3) {
        triangles.extend([[k, k + 1, k + 5], [k, k + 5, k + 4]]);
    }
    scene(&points, &triangles)
}

/// R19: shadows of a sphere. The mesh lies between the ball that its planes touch and the ball of
/// its vertices: shadowed by the inner one means shadowed, not shadowed by the outer one means lit.
/// Returns how many of the points were shadowed, and how many lay between both balls.
pub fn sphere_shadows(points: usize) -> (u32, u32) {
    let (centre, radius) = (DVec3::new(0.5, 2.0, -0.25), 1.0);
    let mesh = icosphere(5, centre, radius);
    let inner = (0..mesh.triangles.len() as u32).map(|id| plane_distance(&mesh, id, centre));
    let inner = inner.fold(f64::INFINITY, f64::min);
    let outer = mesh.positions.iter().map(|p| (*p - centre).length()).fold(0.0, f64::max);
    assert!(outer - inner < 2e-3 && outer - radius < 1e-6);
    let tracer = Tracer::new(&mesh);
    // Point lights above the sphere's top, at it and below it: ellipse, parabola, hyperbola.
    let lights = [DVec3::new(2.0, 7.0, 1.0), DVec3::new(2.5, 3.0, 1.0), DVec3::new(3.0, 2.5, 0.0)];
    let sun = DVec3::new(0.5, 0.75, 0.25);
    let mut random = Random::new(19);
    let (mut shadowed, mut band) = (0, 0);
    for k in 0..points {
        let from = DVec3::new(random.unit() * 12.0 - 9.0, 0.0, random.unit() * 8.0 - 4.0);
        let to = if k % 4 == 3 { from + sun * tracer.reach() } else { lights[k % 4] };
        let truth = look(&tracer, from, to).truth;
        if ball_shadows(centre, inner, from, to) {
            assert!(matches!(truth, Truth::Shadowed(_)), "{from} -> {to}: {truth:?}");
            shadowed += 1;
        } else if ball_shadows(centre, outer, from, to) {
            band += 1;
        } else {
            assert_eq!(truth, Truth::Lit, "{from} -> {to}");
        }
    }
    (shadowed, band)
}

fn plane_distance(mesh: &Geometry, id: u32, p: DVec3) -> f64 {
    let [a, b, c] = mesh.corners(id);
    (b - a).cross(c - a).normalize().dot(a - p)
}

/// `(y a)^2 > |y|^2 (|a|^2 - r^2)` and `y a > |a|^2 - r^2`, a = centre - light, y = point - light.
fn ball_shadows(centre: DVec3, radius: f64, point: DVec3, light: DVec3) -> bool {
    let (a, y) = (centre - light, point - light);
    let power = a.length_squared() - radius * radius;
    y.dot(a).powi(2) > y.length_squared() * power && y.dot(a) > power
}
