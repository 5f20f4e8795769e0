vec4 pack(float z) { return vec4(z, 0.0, 0.0, 0.0); }
float unpack(vec4 c) { return c.r; }
