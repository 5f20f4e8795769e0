//! Matrix chains: which f32 matrices a program uploads and in which order its shaders multiply.

use crate::camera::Camera;
use crate::device::Device;
use crate::light::Light;
use crate::view::uploaded_product;
use glam::{Mat4, Vec4};
use std::collections::BTreeMap;

crate::catalogue! {
    /// The documents' orders of multiplication.
    pub enum MatrixChain {
        /// One uploaded matrix for each pass (documents 000, 004).
        Combined = "combined",
        /// Projection and model-view, multiplied in the shader (document 001).
        ModelView = "model-view",
        /// World position first, then projection·view and a texture matrix (document 002).
        World = "world",
        /// Projection·(view·world), and a bias matrix in front for the light (document 003).
        BiasMatrix = "bias-matrix",
        /// The same with document 003's bias matrix as printed: its third column repeats the second.
        BiasMatrixAsPrinted = "bias-matrix-as-printed",
    }
}

/// The uploaded f32 matrices by the names that `scene.json` gives them.
pub type Matrices = BTreeMap<String, Mat4>;

/// The matrices that a vertex meets one after the other, in each of its three uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Stages {
    /// Model → the camera's clip space.
    pub camera_clip: Vec<Mat4>,
    /// Model → the map's clip space.
    pub light_clip: Vec<Mat4>,
    /// Model → the varying from which the look-up starts.
    pub light_coord: Vec<Mat4>,
}

impl Stages {
    /// Sends a model-space point through `stages` in the device's f32 arithmetic.
    #[must_use]
    pub fn apply(device: &Device, stages: &[Mat4], p_model: Vec4) -> Vec4 {
        stages.iter().fold(p_model, |p, m| device.mat_vec(m, p))
    }
}

/// ½ scale and ½ offset: NDC → [0,1]. `z_column` is the third column.
fn bias_matrix(z_column: Vec4) -> Mat4 {
    let x = Vec4::new(0.5, 0.0, 0.0, 0.0);
    let y = Vec4::new(0.0, 0.5, 0.0, 0.0);
    Mat4::from_cols(x, y, z_column, Vec4::new(0.5, 0.5, 0.5, 1.0))
}

fn sound_bias_matrix() -> Mat4 {
    bias_matrix(Vec4::new(0.0, 0.0, 0.5, 0.0))
}

impl MatrixChain {
    /// The chain in the fixed words of `scene.json`.
    #[must_use]
    pub const fn statement(self) -> &'static str {
        match self {
            Self::Combined => {
                "gl_Position = camMVP * p; light position = lightMVP * p (per object)"
            }
            Self::ModelView => {
                "gl_Position = (camP * camMV) * p; light position = (lightP * lightMV) * p (per object)"
            }
            Self::World => {
                "world = W * p; gl_Position = (camP * camV) * world; light position = textureMatrix * world"
            }
            Self::BiasMatrix => {
                "gl_Position = (camP * (camV * W)) * p; light position = ((B * lightP) * (lightV * W)) * p, B = columns (.5,0,0,0) (0,.5,0,0) (0,0,.5,0) (.5,.5,.5,1)"
            }
            Self::BiasMatrixAsPrinted => {
                "gl_Position = (camP * (camV * W)) * p; light position = ((B * lightP) * (lightV * W)) * p, B = columns (.5,0,0,0) (0,.5,0,0) (0,.5,0,0) (.5,.5,.5,1)"
            }
        }
    }

    /// Names of the matrices that the chain needs.
    #[must_use]
    pub const fn names(self) -> &'static [&'static str] {
        match self {
            Self::Combined => &["lightMVP", "camMVP"],
            Self::ModelView => &["lightP", "lightMV", "camP", "camMV"],
            Self::World => &["lightP", "lightV", "camP", "camV", "textureMatrix"],
            Self::BiasMatrix | Self::BiasMatrixAsPrinted => &["lightP", "lightV", "camP", "camV"],
        }
    }

    /// The uploaded matrices of one object: every stored matrix is f32, every product on the CPU is
    /// formed in f64 from f32 factors and rounded once.
    #[must_use]
    pub fn matrices(self, light: &Light, camera: &Camera, model: &Mat4) -> Matrices {
        let light_p = light.projection.clip_from_view().as_mat4();
        let light_v = light.view.view_from_world().as_mat4();
        let cam_p = camera.projection.clip_from_view().as_mat4();
        let cam_v = camera.view.view_from_world().as_mat4();
        let through = |p: &Mat4, v: &Mat4| uploaded_product(&uploaded_product(p, v), model);
        let named: Vec<(&str, Mat4)> = match self {
            Self::Combined => {
                vec![("lightMVP", through(&light_p, &light_v)), ("camMVP", through(&cam_p, &cam_v))]
            }
            Self::ModelView => vec![
                ("lightP", light_p),
                ("lightMV", uploaded_product(&light_v, model)),
                ("camP", cam_p),
                ("camMV", uploaded_product(&cam_v, model)),
            ],
            Self::World => {
                let texture =
                    uploaded_product(&uploaded_product(&sound_bias_matrix(), &light_p), &light_v);
                vec![
                    ("lightP", light_p),
                    ("lightV", light_v),
                    ("camP", cam_p),
                    ("camV", cam_v),
                    ("textureMatrix", texture),
                ]
            }
            Self::BiasMatrix | Self::BiasMatrixAsPrinted => {
                vec![("lightP", light_p), ("lightV", light_v), ("camP", cam_p), ("camV", cam_v)]
            }
        };
        named.into_iter().map(|(name, m)| (name.to_string(), m)).collect()
    }

    /// Puts a light's clip-from-world matrix, as an engine uploads it, into the matrices of an object.
    pub fn set_light(self, matrices: &mut Matrices, clip_from_world: &Mat4, model: &Mat4) {
        let mut set = |name: &str, m: Mat4| matrices.insert(name.to_string(), m);
        match self {
            Self::Combined => {
                set("lightMVP", uploaded_product(clip_from_world, model));
            }
            Self::ModelView => {
                set("lightP", *clip_from_world);
                set("lightMV", *model);
            }
            Self::World => {
                set("lightP", *clip_from_world);
                set("lightV", Mat4::IDENTITY);
                set("textureMatrix", uploaded_product(&sound_bias_matrix(), clip_from_world));
            }
            Self::BiasMatrix | Self::BiasMatrixAsPrinted => {
                set("lightP", *clip_from_world);
                set("lightV", Mat4::IDENTITY);
            }
        }
    }

    /// The shader's products, in the device's arithmetic.
    ///
    /// # Panics
    /// If `matrices` lacks one of [`Self::names`]; constructors check that.
    #[must_use]
    pub fn stages(self, device: &Device, matrices: &Matrices, model: &Mat4) -> Stages {
        let m = |name: &str| matrices.get(name).expect("constructors check the chain's matrices");
        let times = |a: &Mat4, b: &Mat4| device.mat_mat(a, b);
        match self {
            Self::Combined => Stages {
                camera_clip: vec![*m("camMVP")],
                light_clip: vec![*m("lightMVP")],
                light_coord: vec![*m("lightMVP")],
            },
            Self::ModelView => {
                let light = times(m("lightP"), m("lightMV"));
                Stages {
                    camera_clip: vec![times(m("camP"), m("camMV"))],
                    light_clip: vec![light],
                    light_coord: vec![light],
                }
            }
            Self::World => Stages {
                camera_clip: vec![*model, times(m("camP"), m("camV"))],
                light_clip: vec![*model, times(m("lightP"), m("lightV"))],
                light_coord: vec![*model, *m("textureMatrix")],
            },
            Self::BiasMatrix | Self::BiasMatrixAsPrinted => {
                let bias = match self == Self::BiasMatrix {
                    true => sound_bias_matrix(),
                    false => bias_matrix(Vec4::new(0.0, 0.5, 0.0, 0.0)),
                };
                let light_mv = times(m("lightV"), model);
                Stages {
                    camera_clip: vec![times(m("camP"), &times(m("camV"), model))],
                    light_clip: vec![times(m("lightP"), &light_mv)],
                    light_coord: vec![times(&times(&bias, m("lightP")), &light_mv)],
                }
            }
        }
    }
}
