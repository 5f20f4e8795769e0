// 24-bit depth in RGB. GLSL ES 3.00 (WebGL 2).
// Write the result to an RGB(A)8 target, blending and dithering off, read it with NEAREST.
vec3 packDepth24(highp float z) {
    highp float code = round(clamp(z, 0.0, 1.0) * 16777215.0);
    highp float high = floor(code / 65536.0);
    code -= high * 65536.0;
    highp float middle = floor(code / 256.0);
    return vec3(high, middle, code - middle * 256.0) / 255.0;
}

highp float unpackDepth24(highp vec3 c) {
    highp vec3 digits = round(c * 255.0);
    return ((digits.x * 256.0 + digits.y) * 256.0 + digits.z) / 16777215.0;
}
