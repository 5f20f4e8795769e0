float nearest(float x) {
  float below = floor(x), rest = x - below;
  return rest > 0.5 || (rest == 0.5 && mod(below, 2.0) == 1.0) ? below + 1.0 : below;
}
vec4 pack(float z) {
  if (z >= 1.0) return vec4(1.0, 1.0, 1.0, 0.0);
  float code = nearest(max(z, 0.0) * 16777215.0);
  float high = floor(code / 65536.0), rest = code - high * 65536.0, middle = floor(rest / 256.0);
  return vec4(high, middle, rest - middle * 256.0, 0.0) / 255.0;
}
float unpack(vec4 c) {
  return ((nearest(c.r * 255.0) * 256.0 + nearest(c.g * 255.0)) * 256.0 + nearest(c.b * 255.0)) / 16777215.0;
}
