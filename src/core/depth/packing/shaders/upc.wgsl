fn pack(z: f32) -> vec4f {
  let c = fract(vec4f(16777216.0, 65536.0, 256.0, 1.0) * z);
  return c - c.rrgb * vec4f(0.0, 1.0 / 256.0, 1.0 / 256.0, 1.0 / 256.0);
}
fn unpack(c: vec4f) -> f32 { return dot(c, vec4f(1.0 / 16777216.0, 1.0 / 65536.0, 1.0 / 256.0, 1.0)); }
