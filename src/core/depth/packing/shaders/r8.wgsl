fn pack(z: f32) -> vec4f { return vec4f(z, 0.0, 0.0, 0.0); }
fn unpack(c: vec4f) -> f32 { return c.r; }
