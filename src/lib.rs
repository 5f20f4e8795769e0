//! # gnomon
//!
//! The part of a sundial that casts the shadow: a precision and artifact analysis toolkit for shadow
//! maps. It says which depth encodings lose bits, which bias a scene needs, how much acne and
//! peter-panning remain, and **why**, against a ray-traced truth.
//!
//! ## Pipeline
//! A [`scene::Case`] names objects, light, camera, map, look-up and bias.
//! [`raster::passes::Subject`] draws it in the subject's own f32 arithmetic on a [`device::Device`]
//! (map pass, camera pass, [`shadow::ShadowMap`]). [`truth::Tracer`] answers in f64 what each receiver
//! really sees. [`analysis::observe::Observer`] judges every receiver on a ladder of rungs and names
//! artifact and cause; [`analysis::curve::Curve`] gives the errors at *every* constant bias from one
//! pass. A [`report::Report`] is plain data; files are written from it.
//!
//! ## Layers
//! A lower layer never imports a higher one, and siblings of L4 never import each other; a test holds
//! this. The packages below this one can be depended on alone: `gnomon-core` measures, `gnomon-load` reads
//! bytes, `gnomon-page` writes reports.
//!
//! | layer | package | modules |
//! |---|---|---|
//! | L0 | core | [`error`], [`catalogue`](mod@catalogue), [`num`], [`size`] (amounts of memory), [`simd`] (the only `unsafe`) |
//! | L1 | core | [`depth`] (mappings, formats, packings, stores), [`view`] (matrices) |
//! | L2 | core | [`device`], [`light`], [`camera`] |
//! | L3 | core | [`scene`] (meshes, cases, the words of a pipeline) |
//! | L4 | core | [`shadow`] (the subject's map, look-ups, biases), [`truth`] (f64, exact signs): they share inputs, never code |
//! | L5 | core | [`raster`] (coverage, planes, passes), [`engines`] (a bias in an engine's own unit, and back) |
//! | L6 | load | [`load`] (glTF, OBJ, PLY, TOML: bytes to a scene) |
//! | L0 | page | [`input`] (bounded files), [`memory`] (the budget) |
//! | L6 | page | [`report`], [`output`]: data and writers, they know nothing of shadows |
//! | L7 | gnomon | [`analysis`] (verdicts, sweeps, certificates, studies), [`conformance`] (against measured WebGL), [`stress`] (where it breaks), [`scene_file`] (a scene from a command line) |
//! | L8 | gnomon | [`harness`] (what the binaries share) |
//!
//! ## Answers
//! Each question has a function that gives values: [`analysis::measure::measure`] (what is wrong with a
//! case, and why), [`analysis::tune::tune`] (which bias for an engine), [`analysis::formats::measure`]
//! (which format), [`analysis::sweep::run`] and [`analysis::pareto::entries`] (which strategy, at which
//! cost), [`analysis::roundtrip::Certifier`] (what a packing loses), [`stress::run`] (where it breaks).
//! Reports are made from those values.
//!
//! ## Conventions
//! - Right-handed, y up, views look down −z. Matrices are `a_from_b` and names cancel.
//! - Clip space is OpenGL's; window depth is always in [0, 1]. Texel (0,0) is the lowest u, v; PNG and
//!   EXR are written top row first.
//! - The subject is f32 with its order of operations spelled out, the truth is f64. Inputs are
//!   f32-exact, so that a difference is always error.
//! - A bias is positive where it repairs acne, whatever sign a document writes.
//! - Depth differences are window depth unless a name says world, texels or codes.
//! - The same seed gives the same bytes with any number of threads and any SIMD level: only
//!   + − × ÷ √ and integers, other functions through `libm`.
//!
//! ## Why it is so
//! *Why no generic number type?* Subject and truth must not share code, or they would share errors.
//! *Why encode after the depth test?* A sound encode is monotone, so one raster serves every format;
//! what is not monotone (a packing under a 16-bit attachment) is modelled as it is.
//! *Why is ambiguous a value?* A ray through a silhouette has no answer in f64; a guess would be
//! counted as somebody's error.

pub mod analysis;
pub mod conformance;
pub mod harness;
pub mod scene_file;
pub mod stress;

pub use gnomon_core::{
    camera, catalogue, depth, device, engines, error, light, num, raster, scene, shadow, simd,
    size, truth, view,
};
pub use gnomon_load as load;
pub use gnomon_page::{input, memory, output, report};

pub use error::{Error, Result};

/// The README's examples are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
