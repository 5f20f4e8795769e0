// 24-bit depth in RGB. WGSL (WebGPU); f32 only.
// Write the result to an rgba8unorm target without blending, read it with textureLoad.
fn pack_depth_24(z: f32) -> vec3f {
    var code = round(clamp(z, 0.0, 1.0) * 16777215.0);
    let high = floor(code / 65536.0);
    code -= high * 65536.0;
    let middle = floor(code / 256.0);
    return vec3f(high, middle, code - middle * 256.0) / 255.0;
}

fn unpack_depth_24(c: vec3f) -> f32 {
    let digits = round(c * 255.0);
    return ((digits.x * 256.0 + digits.y) * 256.0 + digits.z) / 16777215.0;
}
