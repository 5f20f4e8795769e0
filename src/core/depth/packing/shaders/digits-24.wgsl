fn pack(z: f32) -> vec4f {
  if (z >= 1.0) { return vec4f(1.0, 1.0, 1.0, 0.0); }
  let code = round(max(z, 0.0) * 16777215.0);
  let high = floor(code / 65536.0);
  let rest = code - high * 65536.0;
  let middle = floor(rest / 256.0);
  return vec4f(high, middle, rest - middle * 256.0, 0.0) / 255.0;
}
fn unpack(c: vec4f) -> f32 {
  return ((round(c.r * 255.0) * 256.0 + round(c.g * 255.0)) * 256.0 + round(c.b * 255.0)) / 16777215.0;
}
