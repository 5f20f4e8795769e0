//! Depth and varying planes through snapped vertices: exact, and in the measured f32 order.

use super::triangle::{self, Projected};
use crate::device::{Device, PlaneSetup};
use crate::shadow::Few;
use glam::{DMat3, DVec3, Vec4};

/// A quantity that is affine on the screen.
#[derive(Clone, Copy, Debug)]
pub enum Plane {
    /// f64, rounded once when evaluated.
    Exact {
        /// Value = gradient · (px, py, 1).
        coefficients: DVec3,
    },
    /// f32(f32((px − x)·a + f32(c + f32((py − y)·b))) + offset), each operation rounded.
    Measured {
        /// Pixel position of the reference vertex.
        origin: [f32; 2],
        /// Gradients along x and y.
        gradient: [f32; 2],
        /// Value at the reference vertex.
        constant: f32,
        /// Added last, with a rounding of its own.
        offset: f32,
    },
}

impl Plane {
    /// The part of the value that a row of pixels shares.
    #[must_use]
    pub fn row(&self, py: f32) -> Row {
        match *self {
            Self::Exact { coefficients: k } => {
                Row::Exact { slope: k.x, base: k.y * f64::from(py) + k.z }
            }
            Self::Measured { origin, gradient, constant, offset } => Row::Measured {
                x: origin[0],
                slope: gradient[0],
                base: constant + (py - origin[1]) * gradient[1],
                offset,
            },
        }
    }

    /// The value at a pixel centre.
    #[must_use]
    pub fn at(&self, px: f32, py: f32) -> f32 {
        self.row(py).at(px)
    }

    /// The gradient (d/dx, d/dy) per pixel.
    #[must_use]
    pub fn gradient(&self) -> [f32; 2] {
        match *self {
            Self::Exact { coefficients: k } => [k.x as f32, k.y as f32],
            Self::Measured { gradient, .. } => gradient,
        }
    }

    /// False for the plane of a triangle without area in space or with a vertex in the eye's plane
    /// (w = 0 without clipping): it has no depth and is not drawn.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        match *self {
            Self::Exact { coefficients } => coefficients.is_finite(),
            Self::Measured { gradient: [a, b], constant, .. } => (a + b + constant).is_finite(),
        }
    }

    /// The plane moved by a constant, as polygon offset does before a fragment's depth is formed.
    #[must_use]
    pub fn moved(self, by: f32) -> Self {
        match self {
            Self::Exact { coefficients } => {
                Self::Exact { coefficients: coefficients + DVec3::new(0.0, 0.0, f64::from(by)) }
            }
            Self::Measured { origin, gradient, constant, offset } => {
                Self::Measured { origin, gradient, constant, offset: offset + by }
            }
        }
    }
}

/// A plane along one row of pixels.
#[derive(Clone, Copy, Debug)]
pub enum Row {
    /// f64 slope and base.
    Exact {
        /// Per pixel.
        slope: f64,
        /// At px = 0.
        base: f64,
    },
    /// f32, in the measured order.
    Measured {
        /// Pixel x of the reference vertex.
        x: f32,
        /// Per pixel.
        slope: f32,
        /// At the reference vertex' x.
        base: f32,
        /// Added last.
        offset: f32,
    },
}

impl Row {
    /// The value at pixel px.
    #[must_use]
    pub fn at(&self, px: f32) -> f32 {
        match *self {
            Self::Exact { slope, base } => (slope * f64::from(px) + base) as f32,
            Self::Measured { x, slope, base, offset } => ((px - x) * slope + base) + offset,
        }
    }
}

/// Window depth over the screen.
pub(super) fn depth_plane(device: &Device, p: &Projected) -> Plane {
    match device.setup {
        PlaneSetup::Exact => {
            let scale = f64::from(p.range.scale());
            let depth = p.clip.map(|v| f64::from(v.z) * scale + f64::from(v.w) * (1.0 - scale));
            Plane::Exact { coefficients: p.homogeneous() * DVec3::from_array(depth) }
        }
        PlaneSetup::Measured => measured_depth(device, p),
    }
}

fn measured_depth(device: &Device, p: &Projected) -> Plane {
    let [o, q, r] = p.reference_order();
    let (origin, step) = measured_steps(device, p);
    let z = p.clip.map(|v| v.z * (1.0 / v.w));
    let ([x1, y1], [x2, y2]) = (step(o, q), step(o, r));
    let (z1, z2) = (z[q] - z[o], z[r] - z[o]);
    let scale = p.range.scale();
    let d = scale / (x1 * y2 - x2 * y1);
    Plane::Measured {
        origin: origin(o),
        gradient: [(y2 * z1 - y1 * z2) * d, (x1 * z2 - x2 * z1) * d],
        constant: z[o] * scale + (1.0 - scale),
        offset: 0.0,
    }
}

/// Position of a vertex in pixels, and the step from one vertex to another, as f32.
fn measured_steps<'a>(
    device: &Device,
    p: &'a Projected,
) -> (impl Fn(usize) -> [f32; 2] + 'a, impl Fn(usize, usize) -> [f32; 2] + 'a) {
    let unit = 1.0 / (1u32 << device.subpixel_bits) as f32;
    let origin = move |i: usize| p.snapped[i].map(|x| x as f32 * unit);
    let step = move |from: usize, to: usize| {
        let (a, b) = (p.snapped[from], p.snapped[to]);
        [(b[0] - a[0]) as f32 * unit, (b[1] - a[1]) as f32 * unit]
    };
    (origin, step)
}

/// The largest among the reference depth and the *differences* of the other two from it: the depth whose
/// exponent the measured implementation takes for r with float depth.
pub(super) fn measured_reference(p: &Projected) -> f32 {
    let [o, q, r] = p.reference_order();
    let z = p.clip.map(|v| v.z * (1.0 / v.w));
    let scale = p.range.scale();
    let terms = [z[o], z[q] - z[o], z[r] - z[o]].map(|z| z * scale + (1.0 - scale));
    terms.into_iter().fold(0.0, |m: f32, t| m.max(t.abs()))
}

/// Perspective-correct interpolation of per-vertex values.
#[derive(Clone, Copy, Debug)]
pub struct Varyings {
    reciprocal_w: Plane,
    basis: Basis,
}

#[derive(Clone, Copy, Debug)]
enum Basis {
    Exact(DMat3),
    Measured { origin: [f32; 2], rows: [[f32; 3]; 3], order: [usize; 3] },
}

impl Varyings {
    pub(super) fn new(device: &Device, p: &Projected) -> Self {
        let basis = match device.setup {
            PlaneSetup::Exact => Basis::Exact(p.homogeneous()),
            PlaneSetup::Measured => measured_basis(device, p),
        };
        Self { reciprocal_w: basis.plane([1.0; 3], true), basis }
    }

    /// 1/w at a pixel centre.
    #[must_use]
    pub fn reciprocal_w(&self, px: f32, py: f32) -> f32 {
        self.reciprocal_w.at(px, py)
    }

    /// The value at a pixel centre of a quantity given at the three vertices.
    #[must_use]
    pub fn scalar(&self, at_vertices: [f32; 3], px: f32, py: f32) -> f32 {
        over_w(&self.basis.plane(at_vertices, false), &self.reciprocal_w, px, py)
    }

    /// [`Self::scalar`] for each component.
    #[must_use]
    pub fn vector(&self, at_vertices: [Vec4; 3], px: f32, py: f32) -> Vec4 {
        let [a, b, c] = at_vertices;
        let component = |i: usize| self.scalar([a[i], b[i], c[i]], px, py);
        Vec4::new(component(0), component(1), component(2), component(3))
    }
}

/// What a pass interpolates over one triangle, set up once for all its pixels: the receiver's own
/// coordinates and varyings of four components. The same bits as [`Varyings::vector`].
#[derive(Clone, Debug)]
pub struct Interpolator {
    homogeneous: DMat3,
    reciprocal_w: Plane,
    components: Few<[Plane; 4]>,
}

impl Interpolator {
    pub(super) fn new(
        device: &Device,
        p: &Projected,
        varyings: impl Iterator<Item = [Vec4; 3]>,
    ) -> Self {
        let homogeneous = p.homogeneous();
        let basis = match device.setup {
            PlaneSetup::Exact => Basis::Exact(homogeneous),
            PlaneSetup::Measured => measured_basis(device, p),
        };
        let components = |[a, b, c]: [Vec4; 3]| {
            let component = |i: usize| basis.plane([a[i], b[i], c[i]], false);
            [component(0), component(1), component(2), component(3)]
        };
        Self {
            homogeneous,
            reciprocal_w: basis.plane([1.0; 3], true),
            components: varyings.map(components).collect(),
        }
    }

    /// Barycentric coordinates of a pixel centre on the triangle in space, f64, in [0, 1].
    #[must_use]
    pub fn barycentrics(&self, px: u32, py: u32) -> DVec3 {
        triangle::barycentrics(&self.homogeneous, f64::from(px), f64::from(py))
    }

    /// The varying of that number at a pixel centre.
    #[must_use]
    pub fn vector(&self, varying: usize, px: f32, py: f32) -> Vec4 {
        let [x, y, z, w] = &self.components[varying];
        let component = |plane: &Plane| over_w(plane, &self.reciprocal_w, px, py);
        Vec4::new(component(x), component(y), component(z), component(w))
    }
}

/// A plane of value/w over that of 1/w at a pixel centre.
fn over_w(plane: &Plane, reciprocal_w: &Plane, px: f32, py: f32) -> f32 {
    match (plane, reciprocal_w) {
        (Plane::Exact { coefficients: a }, Plane::Exact { coefficients: w }) => {
            let pixel = DVec3::new(f64::from(px), f64::from(py), 1.0);
            (a.dot(pixel) / w.dot(pixel)) as f32
        }
        (plane, w) => plane.at(px, py) * (1.0 / w.at(px, py)),
    }
}

impl Basis {
    /// The plane of value/w; `unit` asks for 1/w itself.
    fn plane(&self, value: [f32; 3], unit: bool) -> Plane {
        match *self {
            Self::Exact(homogeneous) => {
                Plane::Exact { coefficients: homogeneous * DVec3::from_array(value.map(f64::from)) }
            }
            Self::Measured { origin, rows, order } => {
                let k = |column: usize| {
                    let term = |i: usize| {
                        let m = rows[i][column];
                        if unit { m } else { value[order[i]] * m }
                    };
                    (term(0) + term(1)) + term(2)
                };
                Plane::Measured { origin, gradient: [k(0), k(1)], constant: k(2), offset: 0.0 }
            }
        }
    }
}

fn measured_basis(device: &Device, p: &Projected) -> Basis {
    let order @ [o, q, r] = p.reference_order();
    let unit = 1.0 / (1u32 << device.subpixel_bits) as f32;
    let (w1, w2) = (p.clip[q].w, p.clip[r].w);
    let weighted = |w: f32, to: usize, axis: usize| {
        (w * unit) * (p.snapped[to][axis] - p.snapped[o][axis]) as f32
    };
    let (x1, y1) = (weighted(w1, q, 0), weighted(w1, q, 1));
    let (x2, y2) = (weighted(w2, r, 0), weighted(w2, r, 1));
    let area = x1 * y2 - x2 * y1;
    let inverse = 1.0 / area;
    let rhw = 1.0 / p.clip[o].w;
    let e = inverse * rhw;
    let rows = [
        [(y1 * w2 - y2 * w1) * e, (x2 * w1 - x1 * w2) * e, rhw],
        [y2 * inverse, -x2 * inverse, 0.0],
        [-y1 * inverse, x1 * inverse, 0.0],
    ];
    let (origin, _) = measured_steps(device, p);
    Basis::Measured { origin: origin(o), rows, order }
}
