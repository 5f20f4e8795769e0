fn pack(z: f32) -> vec4f {
  let c = fract(vec4f(1.0, 256.0, 65536.0, 16777216.0) * z);
  return c - c.gbaa * vec4f(1.0 / 256.0, 1.0 / 256.0, 1.0 / 256.0, 0.0);
}
fn unpack(c: vec4f) -> f32 { return dot(c, vec4f(1.0, 1.0 / 256.0, 1.0 / 65536.0, 1.0 / 16777216.0)); }
