//! The recommended pair, `digits-24`, as text to copy into a shader.
//!
//! f32 has 24 significant bits: in [½, 1) three bytes hold all that a f32 depth holds, and no store,
//! sampler or contraction changes a byte. 32 bits gain only below ½; see `digits-32`.

/// One language's text.
#[derive(Clone, Copy, Debug)]
pub struct ShaderText {
    /// The language and its version.
    pub language: &'static str,
    /// Pack and unpack.
    pub text: &'static str,
}

/// The recommended pair in four languages.
pub const RECOMMENDED: [ShaderText; 4] = [
    ShaderText { language: "GLSL ES 1.00", text: include_str!("shaders/digits24.es1.glsl") },
    ShaderText { language: "GLSL ES 3.00", text: include_str!("shaders/digits24.es3.glsl") },
    ShaderText { language: "WGSL", text: include_str!("shaders/digits24.wgsl") },
    ShaderText { language: "HLSL", text: include_str!("shaders/digits24.hlsl") },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::Packing;

    /// The GLSL ES 1 text has no `round`: its floor and step must give the catalogue's code.
    #[test]
    fn floor_and_step_round_like_the_catalogue() {
        let by_step = |z: f32| {
            let scaled = z * 16_777_215.0;
            let code = scaled.floor();
            code + if scaled - code >= 0.5 { 1.0 } else { 0.0 }
        };
        for bits in (0..=0x3f80_0000u32).step_by(4099).chain(0x3f7f_f000..=0x3f80_0000) {
            let z = f32::from_bits(bits);
            let [r, g, b, _] = Packing::Digits24.pack(z).map(|c| (c * 255.0).round());
            let (code, ours) = ((r * 256.0 + g) * 256.0 + b, by_step(z));
            let tie = z * 16_777_215.0 - (z * 16_777_215.0).floor() == 0.5;
            assert!(code == ours || tie, "{z:e}: {code} {ours}");
        }
    }

    #[test]
    fn every_text_has_both_halves_and_the_scale() {
        for shader in RECOMMENDED {
            assert_eq!(shader.text.matches("16777215.0").count(), 2, "{}", shader.language);
            assert!(shader.text.to_lowercase().contains("unpack"), "{}", shader.language);
        }
    }
}
