fn pack(z: f32) -> vec4f {
  if (z <= 0.0) { return vec4f(0.0); }
  if (z >= 1.0) { return vec4f(1.0); }
  let scaled = z * 16777216.0;
  let low = floor(scaled);
  let shifted = low * (1.0 / 256.0);
  let middle = floor(shifted);
  let last = middle * (1.0 / 256.0);
  let high = floor(last);
  let stretch = 256.0 / 255.0;
  return vec4f(high * (1.0 / 255.0), (last - high) * stretch, (shifted - middle) * stretch, scaled - low);
}
fn unpack(c: vec4f) -> f32 {
  return dot(c, vec4f(0.99609375, 0.99609375 / 256.0, 0.99609375 / 65536.0, 1.0 / 16777216.0));
}
