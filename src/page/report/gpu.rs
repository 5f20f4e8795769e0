//! A panel that measures the reader's own GPU, as data: shaders to run and what is predicted.

/// The panel. It runs on a button press in WebGL2 and, where there is one, WebGPU; without them the
/// page says so.
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
    /// What known devices do, by the names of the panel's measurements.
    pub devices: Vec<KnownDevice>,
}

/// A pack and an unpack function and what they are predicted to give.
#[derive(Clone, Debug, Default)]
pub struct ShaderPair {
    /// Name in the results.
    pub name: String,
    /// GLSL ES, good for 1.00 and 3.00: `vec4 pack(float z)` and `float unpack(vec4 c)`, without
    /// precisions, so that the default precision of the run holds.
    pub glsl: String,
    /// The pair in WGSL: `fn pack(z: f32) -> vec4f` and `fn unpack(c: vec4f) -> f32`.
    pub wgsl: String,
    /// Predictions, of any number of devices.
    pub predicted: Vec<Predicted>,
}

/// A prediction shown beside the measurement.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Predicted {
    /// The machine whose arithmetic, store and sampler are predicted.
    pub on: String,
    /// `highp` or `mediump`: the run that it stands beside.
    pub precision: &'static str,
    /// Largest |unpacked − packed| over the panel's depths.
    pub max_error: f64,
    /// What 1.0 unpacks to.
    pub one: f64,
    /// Whether an operation on the way leaves the finite numbers.
    pub overflows: bool,
}

/// What a known device does.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct KnownDevice {
    /// Its name.
    pub name: String,
    /// Text or number by the measurement's name.
    pub facts: serde_json::Map<String, serde_json::Value>,
}
