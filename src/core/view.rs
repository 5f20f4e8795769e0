//! Where a camera or a light stands and how it projects: the matrices, in f64.
//!
//! Right-handed, y up, the view looks down −z; clip space is OpenGL's (−w ≤ z ≤ w) unless a
//! [`ClipSpace`] says otherwise.

mod clip_space;

use crate::{Error, Result};
pub use clip_space::{ClipRange, ClipSpace};
use glam::{DMat4, DVec3, DVec4, Mat4};

/// An eye: position, the point it looks at, and which way is up. World units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the eye is.
    pub position: DVec3,
    /// The point in the middle of its picture.
    pub target: DVec3,
    /// Up; must not be parallel to the line of sight.
    pub up: DVec3,
}

/// How an eye projects. Lengths are world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Perspective with a vertical field of view.
    Perspective {
        /// Vertical field of view in degrees, in (0, 180).
        fovy_degrees: f64,
        /// Width over height.
        aspect: f64,
        /// Distance of the near plane, > 0.
        near: f64,
        /// Distance of the far plane, > near; infinite where there is none.
        far: f64,
    },
    /// Orthographic, centred on the line of sight.
    Orthographic {
        /// Width of the box.
        width: f64,
        /// Height of the box.
        height: f64,
        /// Distance of the near plane.
        near: f64,
        /// Distance of the far plane, > near.
        far: f64,
    },
}

/// Length of a vector as √(Σ(v/m)²)·m with m the largest |component| and a Kahan-compensated sum:
/// within 1 ulp, no overflow, and the same bits on every machine.
#[must_use]
pub fn length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if largest == 0.0 {
        return 0.0;
    }
    let (mut sum, mut compensation) = (0.0, 0.0);
    for component in v.to_array() {
        let n = component.abs() / largest;
        let summand = n * n - compensation;
        let preliminary = sum + summand;
        compensation = (preliminary - sum) - summand;
        sum = preliminary;
    }
    f64::sqrt(sum) * largest
}

impl View {
    /// Checks that the view has a direction and that `up` is usable.
    ///
    /// # Errors
    /// [`Error::BadInput`] naming `place` if a number is not finite, the target is the position,
    /// or `up` is parallel to the line of sight.
    pub fn checked(self, place: &str) -> Result<Self> {
        let finite = self.position.is_finite() && self.target.is_finite() && self.up.is_finite();
        if !finite {
            return Err(Error::bad_input(place, "a coordinate is not finite", "give numbers"));
        }
        let back = self.position - self.target;
        if length(back) == 0.0 {
            return Err(Error::bad_input(
                format!("{place}.target"),
                "equals the position",
                "look at another point",
            ));
        }
        if length(self.up.cross(back)) <= 1e-12 * length(self.up) * length(back) {
            return Err(Error::bad_input(
                format!("{place}.up"),
                "is zero or parallel to the line of sight",
                "give another up vector",
            ));
        }
        Ok(self)
    }

    /// Rotation and translation into view space; f64, each entry within a few ulp.
    #[must_use]
    pub fn view_from_world(&self) -> DMat4 {
        let back = self.position - self.target;
        let z = back / length(back);
        let right = self.up.cross(z);
        let x = right / length(right);
        let y = z.cross(x);
        let origin =
            DVec3::new(dot(x, self.position), dot(y, self.position), dot(z, self.position));
        DMat4::from_cols(
            DVec4::new(x.x, y.x, z.x, 0.0),
            DVec4::new(x.y, y.y, z.y, 0.0),
            DVec4::new(x.z, y.z, z.z, 0.0),
            (-origin).extend(1.0),
        )
    }

    /// Unit vector from the target towards the eye.
    #[must_use]
    pub fn backward(&self) -> DVec3 {
        let back = self.position - self.target;
        back / length(back)
    }
}

impl Projection {
    /// Checks the ranges given at the fields.
    ///
    /// # Errors
    /// [`Error::BadInput`] naming `place` and the field.
    pub fn checked(self, place: &str) -> Result<Self> {
        let bad = |field: &str, reason: String, fix: &str| {
            Err(Error::bad_input(format!("{place}.{field}"), reason, fix))
        };
        let (near, far) = self.near_far();
        let endless = far == f64::INFINITY && matches!(self, Self::Perspective { .. });
        if !near.is_finite() || !(far.is_finite() || endless) {
            return bad("near/far", format!("{near}, {far} are not both finite"), "give numbers");
        }
        if near >= far {
            return bad("near", format!("{near} is not below far {far}"), "give near < far");
        }
        match self {
            Self::Perspective { near, .. } if near <= 0.0 => {
                bad("near", format!("{near} is not positive"), "give near > 0 for a perspective")
            }
            Self::Perspective { fovy_degrees, .. }
                if !(fovy_degrees > 0.0 && fovy_degrees < 180.0) =>
            {
                bad("fovy", format!("{fovy_degrees} is not in (0, 180)"), "give degrees")
            }
            Self::Perspective { aspect, .. } if !(aspect > 0.0 && aspect.is_finite()) => {
                bad("aspect", format!("{aspect} is not positive"), "give width over height")
            }
            Self::Orthographic { width, height, .. }
                if !(width > 0.0 && height > 0.0 && (width + height).is_finite()) =>
            {
                bad("ortho", format!("{width} x {height} is empty"), "give a positive size")
            }
            Self::Perspective { .. } | Self::Orthographic { .. } => Ok(self),
        }
    }

    /// Distances of the near and far planes.
    #[must_use]
    pub const fn near_far(&self) -> (f64, f64) {
        match *self {
            Self::Perspective { near, far, .. } | Self::Orthographic { near, far, .. } => {
                (near, far)
            }
        }
    }

    /// OpenGL's projection matrix in f64; the tangent comes from `libm`, so that every machine
    /// has the same bits.
    #[must_use]
    pub fn clip_from_view(&self) -> DMat4 {
        self.clip_from_view_in(ClipSpace::OPENGL)
    }

    /// The projection matrix into a clip space, f64. A y axis that looks down turns the second row.
    #[must_use]
    pub fn clip_from_view_in(&self, clip: ClipSpace) -> DMat4 {
        let [slope, constant] = clip.depth_row(self);
        let up = if clip.y_down { -1.0 } else { 1.0 };
        match *self {
            Self::Perspective { fovy_degrees, aspect, .. } => {
                let cot = 1.0 / libm::tan(fovy_degrees * std::f64::consts::PI / 180.0 / 2.0);
                DMat4::from_cols(
                    DVec4::new(cot / aspect, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, up * cot, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, slope, -1.0),
                    DVec4::new(0.0, 0.0, constant, 0.0),
                )
            }
            Self::Orthographic { width, height, .. } => DMat4::from_cols(
                DVec4::new(2.0 / width, 0.0, 0.0, 0.0),
                DVec4::new(0.0, up * (2.0 / height), 0.0, 0.0),
                DVec4::new(0.0, 0.0, slope, 0.0),
                DVec4::new(0.0, 0.0, constant, 1.0),
            ),
        }
    }

    /// Half the width of the picture at distance 1 (perspective) or at any distance.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        match *self {
            Self::Perspective { fovy_degrees, aspect, .. } => {
                libm::tan(fovy_degrees * std::f64::consts::PI / 180.0 / 2.0) * aspect
            }
            Self::Orthographic { width, .. } => width / 2.0,
        }
    }
}

/// Product of two matrices in f64, each entry summed left to right.
#[must_use]
pub fn product(a: &DMat4, b: &DMat4) -> DMat4 {
    let column = |j: usize| {
        let c = b.col(j);
        ((a.x_axis * c.x + a.y_axis * c.y) + a.z_axis * c.z) + a.w_axis * c.w
    };
    DMat4::from_cols(column(0), column(1), column(2), column(3))
}

/// A matrix rounded to f32 and promoted again: what a program that uploads f32 matrices keeps.
#[must_use]
pub fn rounded(m: &DMat4) -> DMat4 {
    m.as_mat4().as_dmat4()
}

/// The f32 matrices that the documents' programs upload: projection, view and their product, where
/// every stored matrix is f32 and every product is formed in f64 and rounded once.
#[must_use]
pub fn uploaded_product(a: &Mat4, b: &Mat4) -> Mat4 {
    product(&a.as_dmat4(), &b.as_dmat4()).as_mat4()
}

fn dot(a: DVec3, b: DVec3) -> f64 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn view_directions_are_right_handed() {
        let view = View { position: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };
        let m = view.view_from_world();
        assert_eq!(m.transform_point3(DVec3::X), DVec3::X, "right is +x");
        assert_eq!(m.transform_point3(DVec3::NEG_Z), DVec3::NEG_Z, "ahead is -z");
    }

    #[test]
    fn near_and_far_land_on_the_clip_planes() {
        let p = Projection::Perspective { fovy_degrees: 90.0, aspect: 1.0, near: 1.0, far: 9.0 };
        for (distance, ndc) in [(1.0, -1.0), (9.0, 1.0)] {
            let clip = p.clip_from_view() * DVec4::new(0.0, 0.0, -distance, 1.0);
            assert!((clip.z / clip.w - ndc).abs() < 1e-14, "distance {distance}");
        }
    }

    #[test]
    fn bad_ranges_are_named() {
        let p = Projection::Perspective { fovy_degrees: 90.0, aspect: 1.0, near: 5.0, far: 1.0 };
        let message = p.checked("light").unwrap_err().to_string();
        assert!(message.contains("light.near") && message.contains("far"), "{message}");
        let nan = Projection::Orthographic { width: 1.0, height: 1.0, near: f64::NAN, far: 1.0 };
        assert!(nan.checked("light").is_err(), "NaN is refused");
    }
}
