//! A panel that measures the reader's own GPU, as data: shaders to run and what is predicted.

/// The panel. It runs on a button press in WebGL2; without it the page says so.
#[derive(Clone, Debug, Default)]
pub struct GpuPanel {
    /// Unique in the report.
    pub id: String,
    /// Heading.
    pub title: String,
    /// One sentence: what a reader should try.
    pub caption: String,
    /// Values that every pair is run on, in [0, 1); 1.0 is run beside them.
    pub depths: Vec<f32>,
    /// Pairs to run, each in highp and in mediump.
    pub pairs: Vec<ShaderPair>,
}

/// A pack and an unpack function and what they are predicted to give.
#[derive(Clone, Debug, Default)]
pub struct ShaderPair {
    /// Name in the results.
    pub name: String,
    /// GLSL ES 3.00: `vec4 pack(float z)` and `float unpack(vec4 c)`, without precisions, so that
    /// the default precision of the run holds.
    pub glsl: String,
    /// Predicted for highp on a device that rounds to nearest: largest error over `depths`, and
    /// what 1.0 becomes.
    pub highp: Option<Predicted>,
    /// The same for mediump of 10 fraction bits.
    pub mediump: Option<Predicted>,
}

/// A prediction shown beside the measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Predicted {
    /// Largest |unpacked − packed| over the panel's depths.
    pub max_error: f64,
    /// What 1.0 unpacks to.
    pub one: f64,
}
