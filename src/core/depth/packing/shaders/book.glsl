vec4 pack(float z) {
  vec4 c = fract(vec4(1.0, 256.0, 65536.0, 16777216.0) * z);
  return c - c.gbaa * vec4(1.0 / 256.0, 1.0 / 256.0, 1.0 / 256.0, 0.0);
}
float unpack(vec4 c) { return dot(c, vec4(1.0, 1.0 / 256.0, 1.0 / 65536.0, 1.0 / 16777216.0)); }
