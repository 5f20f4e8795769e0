vec4 pack(float z) {
  if (z <= 0.0) return vec4(0.0);
  if (z >= 1.0) return vec4(1.0);
  float scaled = z * 16777216.0;
  float low = floor(scaled);
  float shifted = low * (1.0 / 256.0), middle = floor(shifted);
  float last = middle * (1.0 / 256.0), high = floor(last);
  float stretch = 256.0 / 255.0;
  return vec4(high * (1.0 / 255.0), (last - high) * stretch, (shifted - middle) * stretch, scaled - low);
}
float unpack(vec4 c) {
  return dot(c, vec4(0.99609375, 0.99609375 / 256.0, 0.99609375 / 65536.0, 1.0 / 16777216.0));
}
