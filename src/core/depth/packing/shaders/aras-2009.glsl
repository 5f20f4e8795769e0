vec4 pack(float z) {
  vec4 c = fract(vec4(1.0, 255.0, 65025.0, 16581375.0) * z);
  return c - c.gbaa * vec4(1.0 / 255.0, 1.0 / 255.0, 1.0 / 255.0, 0.0);
}
float unpack(vec4 c) { return dot(c, vec4(1.0, 1.0 / 255.0, 1.0 / 65025.0, 1.0 / 16581375.0)); }
