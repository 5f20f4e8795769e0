// 24-bit depth in RGB. HLSL; float (not min16float).
// Write the result to an R8G8B8A8_UNORM target without blending, read it with Load or point sampling.
float3 PackDepth24(float z)
{
    float code = round(saturate(z) * 16777215.0);
    float high = floor(code / 65536.0);
    code -= high * 65536.0;
    float middle = floor(code / 256.0);
    return float3(high, middle, code - middle * 256.0) / 255.0;
}

float UnpackDepth24(float3 c)
{
    float3 digits = round(c * 255.0);
    return ((digits.x * 256.0 + digits.y) * 256.0 + digits.z) / 16777215.0;
}
