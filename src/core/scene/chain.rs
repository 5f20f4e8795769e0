//! Matrix chains: which f32 matrices a program uploads and in which order its shaders multiply.

use crate::camera::Camera;
use crate::device::Device;
use crate::light::Map;
use crate::view::{ClipRange, uploaded_product};
use glam::{Mat4, Vec4};

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
        /// The chain with document 003's bias matrix as printed: its third column repeats the second.
        BiasMatrixAsPrinted = "bias-matrix-as-printed",
    }
}

/// The f32 matrices that a program uploads for one object and one map, as its chain names them.
#[derive(Clone, Debug, PartialEq)]
pub enum Matrices {
    /// Matrices of [`MatrixChain::Combined`].
    Combined {
        /// Clip of the map from model.
        light_mvp: Mat4,
        /// Clip of the camera from model.
        cam_mvp: Mat4,
    },
    /// Matrices of [`MatrixChain::ModelView`].
    ModelView {
        /// Projection of the map.
        light_p: Mat4,
        /// View of the map from model.
        light_mv: Mat4,
        /// Projection of the camera.
        cam_p: Mat4,
        /// View of the camera from model.
        cam_mv: Mat4,
    },
    /// Matrices of [`MatrixChain::World`].
    World {
        /// Projection of the map.
        light_p: Mat4,
        /// View of the map from world.
        light_v: Mat4,
        /// Projection of the camera.
        cam_p: Mat4,
        /// View of the camera from world.
        cam_v: Mat4,
        /// [0, 1] of the map from world.
        texture: Mat4,
    },
    /// Matrices of [`MatrixChain::BiasMatrix`] and its misprint.
    Bias {
        /// Projection of the map.
        light_p: Mat4,
        /// View of the map from world.
        light_v: Mat4,
        /// Projection of the camera.
        cam_p: Mat4,
        /// View of the camera from world.
        cam_v: Mat4,
        /// Constant in the shader: [0, 1] from normalised device coordinates.
        bias: Mat4,
    },
}

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

/// ½ scale and ½ offset: NDC → [0, 1]. `z` is the third column.
fn bias_matrix(z: Vec4, range: ClipRange) -> Mat4 {
    let x = Vec4::new(0.5, 0.0, 0.0, 0.0);
    let y = Vec4::new(0.0, 0.5, 0.0, 0.0);
    let half = match range {
        ClipRange::MinusOneToOne => 0.5,
        ClipRange::ZeroToOne => 0.0,
    };
    Mat4::from_cols(x, y, z, Vec4::new(0.5, 0.5, half, 1.0))
}

/// A depth that is in [0, 1] already stays.
fn sound_bias_matrix(range: ClipRange) -> Mat4 {
    let scale = match range {
        ClipRange::MinusOneToOne => 0.5,
        ClipRange::ZeroToOne => 1.0,
    };
    bias_matrix(Vec4::new(0.0, 0.0, scale, 0.0), range)
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

    /// The matrix that the shader multiplies in front of the light's.
    fn bias(self, range: ClipRange) -> Mat4 {
        match self {
            Self::BiasMatrixAsPrinted => bias_matrix(Vec4::new(0.0, 0.5, 0.0, 0.0), range),
            Self::Combined | Self::ModelView | Self::World | Self::BiasMatrix => {
                sound_bias_matrix(range)
            }
        }
    }

    /// The uploaded matrices of one object: every stored matrix is f32, every product on the CPU is
    /// formed in f64 from f32 factors and rounded once. A map's matrix from outside stands for its
    /// projection.
    #[must_use]
    pub fn matrices(self, map: &Map, camera: &Camera, model: &Mat4) -> Matrices {
        let [light_p, light_v] = map.matrices();
        let cam_p = camera.projection.clip_from_view().as_mat4();
        let cam_v = camera.view.view_from_world().as_mat4();
        let through = |p: &Mat4, v: &Mat4| uploaded_product(&uploaded_product(p, v), model);
        match self {
            Self::Combined => Matrices::Combined {
                light_mvp: through(&light_p, &light_v),
                cam_mvp: through(&cam_p, &cam_v),
            },
            Self::ModelView => Matrices::ModelView {
                light_p,
                light_mv: uploaded_product(&light_v, model),
                cam_p,
                cam_mv: uploaded_product(&cam_v, model),
            },
            Self::World => {
                let bias = sound_bias_matrix(map.clip.range);
                let texture = uploaded_product(&uploaded_product(&bias, &light_p), &light_v);
                Matrices::World { light_p, light_v, cam_p, cam_v, texture }
            }
            Self::BiasMatrix | Self::BiasMatrixAsPrinted => {
                let bias = self.bias(map.clip.range);
                Matrices::Bias { light_p, light_v, cam_p, cam_v, bias }
            }
        }
    }

    /// The matrices of this chain in OpenGL's clip space, asked for by the names that `scene.json` gives
    /// them.
    ///
    /// # Errors
    /// The first that `get` returns.
    pub fn read<E>(
        self,
        mut get: impl FnMut(&'static str) -> Result<Mat4, E>,
    ) -> Result<Matrices, E> {
        Ok(match self {
            Self::Combined => {
                Matrices::Combined { light_mvp: get("lightMVP")?, cam_mvp: get("camMVP")? }
            }
            Self::ModelView => Matrices::ModelView {
                light_p: get("lightP")?,
                light_mv: get("lightMV")?,
                cam_p: get("camP")?,
                cam_mv: get("camMV")?,
            },
            Self::World => Matrices::World {
                light_p: get("lightP")?,
                light_v: get("lightV")?,
                cam_p: get("camP")?,
                cam_v: get("camV")?,
                texture: get("textureMatrix")?,
            },
            Self::BiasMatrix | Self::BiasMatrixAsPrinted => Matrices::Bias {
                light_p: get("lightP")?,
                light_v: get("lightV")?,
                cam_p: get("camP")?,
                cam_v: get("camV")?,
                bias: self.bias(ClipRange::MinusOneToOne),
            },
        })
    }
}

impl Matrices {
    /// The uploaded matrices by the names that `scene.json` gives them.
    #[must_use]
    pub fn named(&self) -> Vec<(&'static str, Mat4)> {
        match *self {
            Self::Combined { light_mvp, cam_mvp } => {
                vec![("lightMVP", light_mvp), ("camMVP", cam_mvp)]
            }
            Self::ModelView { light_p, light_mv, cam_p, cam_mv } => {
                vec![("lightP", light_p), ("lightMV", light_mv), ("camP", cam_p), ("camMV", cam_mv)]
            }
            Self::World { light_p, light_v, cam_p, cam_v, texture } => vec![
                ("lightP", light_p),
                ("lightV", light_v),
                ("camP", cam_p),
                ("camV", cam_v),
                ("textureMatrix", texture),
            ],
            Self::Bias { light_p, light_v, cam_p, cam_v, .. } => {
                vec![("lightP", light_p), ("lightV", light_v), ("camP", cam_p), ("camV", cam_v)]
            }
        }
    }

    /// The shader's products, in the device's arithmetic.
    #[must_use]
    pub fn stages(&self, device: &Device, model: &Mat4) -> Stages {
        let times = |a: &Mat4, b: &Mat4| device.mat_mat(a, b);
        match self {
            Self::Combined { light_mvp, cam_mvp } => Stages {
                camera_clip: vec![*cam_mvp],
                light_clip: vec![*light_mvp],
                light_coord: vec![*light_mvp],
            },
            Self::ModelView { light_p, light_mv, cam_p, cam_mv } => {
                let light = times(light_p, light_mv);
                Stages {
                    camera_clip: vec![times(cam_p, cam_mv)],
                    light_clip: vec![light],
                    light_coord: vec![light],
                }
            }
            Self::World { light_p, light_v, cam_p, cam_v, texture } => Stages {
                camera_clip: vec![*model, times(cam_p, cam_v)],
                light_clip: vec![*model, times(light_p, light_v)],
                light_coord: vec![*model, *texture],
            },
            Self::Bias { light_p, light_v, cam_p, cam_v, bias } => {
                let light_mv = times(light_v, model);
                Stages {
                    camera_clip: vec![times(cam_p, &times(cam_v, model))],
                    light_clip: vec![times(light_p, &light_mv)],
                    light_coord: vec![times(&times(bias, light_p), &light_mv)],
                }
            }
        }
    }
}
