fn pack(z: f32) -> vec4f {
  let c = fract(vec4f(1.0, 255.0, 65025.0, 16581375.0) * z);
  return c - c.gbaa * vec4f(1.0 / 255.0, 1.0 / 255.0, 1.0 / 255.0, 0.0);
}
fn unpack(c: vec4f) -> f32 { return dot(c, vec4f(1.0, 1.0 / 255.0, 1.0 / 65025.0, 1.0 / 16581375.0)); }
