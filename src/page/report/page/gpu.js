"use strict";
// Measures the reader's GPU in WebGL2. Every probe draws one fragment a value into an unsigned
// integer target and reads bit patterns back, so nothing is lost on the way.
const f32 = Math.fround;
const bitsOf = (value) => { const u = new Uint32Array(1); new Float32Array(u.buffer)[0] = value; return u[0]; };
const floatOf = (bits) => { const f = new Float32Array(1); new Uint32Array(f.buffer)[0] = bits; return f[0]; };
const even = (x) => { const r = Math.round(x); return r - x === 0.5 && r % 2 !== 0 ? r - 1 : r; };
const WIDE = 512;

class Gpu {
  constructor() {
    const canvas = document.createElement("canvas");
    this.gl = canvas.getContext("webgl2", { antialias: false, depth: true });
    if (!this.gl) throw new Error("this browser has no WebGL2");
    this.gl.disable(this.gl.DITHER);
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.gl.createBuffer());
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), this.gl.STATIC_DRAW);
    this.gl.enableVertexAttribArray(0);
    this.gl.vertexAttribPointer(0, 2, this.gl.FLOAT, false, 0, 0);
  }

  // A program whose fragment shader has the given default precision of floats and samplers.
  program(precision, body, vertex = "gl_Position = vec4(corner, 0.0, 1.0);") {
    const corners = "highp vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);";
    return this.link(`#version 300 es\nprecision highp float;\nuniform vec4 p;\nvoid main() { ${corners} ${vertex} }`,
      `#version 300 es\nprecision ${precision} float;\nprecision highp int;\nprecision ${precision} sampler2D;\nuniform highp vec4 p;\nuniform highp sampler2D values;\nuniform sampler2D map;\n${body}`);
  }

  link(vertex, fragment) {
    const { gl } = this, program = gl.createProgram(), sources = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]];
    gl.bindAttribLocation(program, 0, "corner");
    for (const [type, source] of sources) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  // The same pair under GLSL ES 1.00, which WebGL2 runs too: without vertex ids, integers and fetches.
  program100(precision, body) {
    const fragment = `precision ${precision} float;\nuniform highp vec4 p;\nuniform highp sampler2D values;\nuniform ${precision} sampler2D map;\n${body}`;
    return this.link(`attribute vec2 corner;\nvoid main() { gl_Position = vec4(corner, 0.0, 1.0); }`, fragment);
  }

  texture(internal, width, height, format, type, data = null) {
    const { gl } = this, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, type, data);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    return { texture, width, height };
  }

  floats(values) {
    const { gl } = this, rows = Math.ceil(values.length / WIDE), data = new Float32Array(WIDE * rows);
    data.set(values);
    return this.texture(gl.R32F, WIDE, rows, gl.RED, gl.FLOAT, data);
  }

  bytes(width, height, data = null) {
    const { gl } = this;
    return this.texture(gl.RGBA8, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
  }

  depth(internal, width, height) {
    const { gl } = this;
    const type = { [gl.DEPTH_COMPONENT16]: gl.UNSIGNED_SHORT, [gl.DEPTH_COMPONENT24]: gl.UNSIGNED_INT, [gl.DEPTH_COMPONENT32F]: gl.FLOAT }[internal];
    return this.texture(internal, width, height, gl.DEPTH_COMPONENT, type);
  }

  draw(program, { colour, depth, values, map, p = [0, 0, 0, 0], offset }) {
    const { gl } = this, { width, height } = colour ?? depth, frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    if (colour) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, colour.texture, 0);
    if (depth) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth.texture, 0);
    gl.drawBuffers([colour ? gl.COLOR_ATTACHMENT0 : gl.NONE]);
    gl.viewport(0, 0, width, height);
    gl.useProgram(program);
    [["values", values], ["map", map]].forEach(([name, source], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, source?.texture ?? null);
      gl.uniform1i(gl.getUniformLocation(program, name), unit);
    });
    gl.uniform4fv(gl.getUniformLocation(program, "p"), p);
    gl[depth ? "enable" : "disable"](gl.DEPTH_TEST);
    gl.depthFunc(gl.ALWAYS);
    gl[offset ? "enable" : "disable"](gl.POLYGON_OFFSET_FILL);
    if (offset) gl.polygonOffset(...offset);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    return frame;
  }

  // Runs a fragment body that assigns the uvec4 `result`; returns it for every pixel.
  read(precision, body, size, options = {}, functions = "") {
    const { gl } = this, colour = this.texture(gl.RGBA32UI, size.width, size.height, gl.RGBA_INTEGER, gl.UNSIGNED_INT);
    const program = this.program(precision, `out highp uvec4 result;\n${functions}\nvoid main() { highp ivec2 at = ivec2(gl_FragCoord.xy);\n${body} }`);
    this.draw(program, { colour, ...options });
    const data = new Uint32Array(4 * size.width * size.height);
    gl.readPixels(0, 0, size.width, size.height, gl.RGBA_INTEGER, gl.UNSIGNED_INT, data);
    return data;
  }

  // Draws values through `pack` into bytes.
  store(precision, glsl, values) {
    const { gl } = this, target = this.bytes(values.width, values.height);
    const body = `out vec4 stored;\n${glsl}\nvoid main() { highp float z = texelFetch(values, ivec2(gl_FragCoord.xy), 0).r; stored = pack(z); }`;
    this.draw(this.program(precision, body), { colour: target, values });
    const bytes = new Uint8Array(4 * values.width * values.height);
    gl.readPixels(0, 0, values.width, values.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return { target, bytes };
  }
}

// Errors over all depths and what 1.0 gives, from what came back for the depths and 1.0 behind them.
function errorsOf(back, depths) {
  let worst = 0, at = 0, squares = 0;
  depths.forEach((depth, i) => {
    const error = Math.abs(back[i] - depth), size = Number.isNaN(error) ? Infinity : error;
    squares += size * size;
    if (size > worst) [worst, at] = [size, depth];
  });
  return { max_error: worst, at, rms: Math.sqrt(squares / depths.length), one: back[depths.length] };
}

// Pack, store, sample, unpack in one precision.
function measurePair(gpu, pair, precision, depths) {
  const values = gpu.floats([...depths, 1]), { target, bytes } = gpu.store(precision, pair.glsl, values);
  const data = gpu.read(precision, "highp float z = unpack(texelFetch(map, at, 0)); result.x = floatBitsToUint(z);", target, { map: target }, pair.glsl);
  const back = Array.from({ length: depths.length + 1 }, (_, i) => floatOf(data[4 * i]));
  return { name: pair.name, api: "WebGL2", precision, ...errorsOf(back, depths), es100_bytes_differing: differing100(gpu, pair, precision, values, bytes) };
}

// Bytes that GLSL ES 1.00 stores otherwise than 3.00.
function differing100(gpu, pair, precision, values, bytes) {
  const size = `vec2(${values.width}.0, ${values.height}.0)`;
  const body = `${pair.glsl}\nvoid main() { highp float z = texture2D(values, gl_FragCoord.xy / ${size}).r; gl_FragColor = pack(z); }`;
  const target = gpu.bytes(values.width, values.height), own = new Uint8Array(bytes.length), { gl } = gpu;
  gpu.draw(gpu.program100(precision, body), { colour: target, values });
  gl.readPixels(0, 0, values.width, values.height, gl.RGBA, gl.UNSIGNED_BYTE, own);
  return own.filter((byte, i) => byte !== bytes[i]).length;
}

// The first rule that explains every stored byte; "unknown" with the mismatches of each otherwise.
function storeRule(gpu) {
  const inputs = [];
  for (let k = 0; k < 255; k++) for (const t of [0.1, 0.25, 0.4, 0.499, 0.501, 0.6, 0.9]) inputs.push(f32((k + t) / 255));
  for (let k = 0; k < 255; k++) {
    const bits = bitsOf(f32((k + 0.5) / 255));
    for (let d = -4; d <= 4; d++) inputs.push(floatOf(bits + d));
  }
  const { bytes } = gpu.store("highp", "highp vec4 pack(highp float z) { return vec4(z); }", gpu.floats(inputs));
  const rules = { "half-even": (x) => even(f32(x * 255)), exact: (x) => even(x * 255), "half-up": (x) => Math.floor(f32(f32(x * 255) + 0.5)), truncate: (x) => Math.floor(f32(x * 255)) };
  return fitting(rules, inputs, (i) => bytes[4 * i]);
}

function loadRule(gpu) {
  const data = Uint8Array.from({ length: 4 * 256 }, (_, i) => i >> 2), map = gpu.bytes(256, 1, data);
  const read = gpu.read("highp", "result.x = floatBitsToUint(texelFetch(map, at, 0).r);", map, { map });
  const rules = { divide: (k) => f32(k / 255), reciprocal: (k) => f32(k * f32(1 / 255)) };
  return fitting(rules, Array.from({ length: 256 }, (_, k) => k), (i) => floatOf(read[4 * i]));
}

// NEAREST look-ups just above the boundaries of 257 texels: a coordinate in 16 bits falls below most.
function nearestRule(gpu) {
  const wide = 257, data = Uint8Array.from({ length: 4 * wide }, (_, i) => [i >> 2 & 255, i >> 10, 0, 0][i & 3]);
  const inputs = Array.from({ length: wide }, (_, k) => f32(k / wide + 2 ** -20)), map = gpu.bytes(wide, 1, data), values = gpu.floats(inputs);
  const read = gpu.read("highp", "highp vec2 c = texture(map, vec2(texelFetch(values, at, 0).r, 0.5)).rg * 255.0; result.x = uint(c.r + 0.5) + 256u * uint(c.g + 0.5);", values, { map, values });
  const texel = (u) => Math.floor(f32(u * wide)), rules = { float: texel, fixed16: (u) => texel(Math.floor(u * 65536) / 65536) };
  return fitting(rules, inputs, (i) => read[4 * i]);
}

function fitting(rules, inputs, measured) {
  const misses = Object.entries(rules).map(([name, rule]) => [name, inputs.filter((x, i) => rule(x) !== measured(i)).length]);
  return { rule: misses.find(([, n]) => n === 0)?.[0] ?? "unknown", samples: inputs.length, misses: Object.fromEntries(misses) };
}

// Fraction bits of mediump: halvings of e until 1 + e is 1. Values come in as uniforms, so that no
// compiler folds them away.
function mediump(gpu) {
  const body = "float one = p.x, e = p.x; uint n = 0u; for (int i = 0; i < 40; i++) { float sum = one + e * 0.5; if (sum == one) break; e = e * 0.5; n++; } float big = p.y * 2.0; result = uvec4(n, floatBitsToUint(highp float(big)), 0, 0);";
  const [bits, big] = gpu.read("mediump", body.replace("highp float(big)", "big"), { width: 1, height: 1 }, { p: [1, 60000, 0, 0] });
  return { fraction_bits: bits, overflows_at_65536: !Number.isFinite(floatOf(big)) };
}

function arithmetic(gpu) {
  const a = f32(1 + 2 ** -12), c = -f32(a * a), tiny = f32(2 ** -126);
  const [fused, halved] = gpu.read("highp", "highp float product = p.x * p.x + p.y; result = uvec4(floatBitsToUint(product), floatBitsToUint(p.z * p.w), 0, 0);", { width: 1, height: 1 }, { p: [a, c, tiny, 0.5] });
  return { fma: floatOf(fused) !== 0, flush_denormals: floatOf(halved) === 0 };
}

// What a depth texture keeps of gl_FragDepth.
function depthFormat(gpu, internal, depths) {
  const values = gpu.floats(depths), depth = gpu.depth(internal, values.width, values.height);
  const write = gpu.program("highp", "void main() { gl_FragDepth = texelFetch(values, ivec2(gl_FragCoord.xy), 0).r; }");
  gpu.draw(write, { depth, values });
  const data = gpu.read("highp", "result.x = floatBitsToUint(texelFetch(map, at, 0).r);", values, { map: depth });
  return keeps(depths, depths.map((_, i) => floatOf(data[4 * i])));
}

// Which format a depth texture has, from its largest error.
function keeps(depths, back) {
  const worst = depths.reduce((most, d, i) => Math.max(most, Math.abs(back[i] - d)), 0);
  // Denormals may be flushed on the way; a fixed-point grid is far coarser.
  const kind = worst < 2 ** -100 ? "f32" : worst < 2 ** -23 ? "unorm24" : worst < 2 ** -15 ? "unorm16" : "unknown";
  return { kind, max_error: worst };
}

// Depth at the middle of a plane z = z0 + g·(x + y) per pixel, with a polygon offset.
function planeDepth(gpu, internal, z0, slopes, offset) {
  const depth = gpu.depth(internal, 8, 8), [gx, gy] = slopes;
  const vertex = "gl_Position = vec4(corner, 2.0 * (p.x + 4.0 * (p.y * corner.x + p.z * corner.y)) - 1.0, 1.0);";
  gpu.draw(gpu.program("highp", "void main() {}", vertex), { depth, p: [z0, gx, gy, 0], offset });
  const data = gpu.read("highp", "result.x = floatBitsToUint(texelFetch(map, at, 0).r);", depth, { map: depth });
  return floatOf(data[4 * (4 * 8 + 4)]);
}

function polygonOffset(gpu, internal) {
  const flat = (units) => planeDepth(gpu, internal, 0.625, [0, 0], [0, units]);
  const slope = 2 ** -7, tilted = (factor) => planeDepth(gpu, internal, 0.625, [slope, slope], [factor, 0]);
  return { r: (flat(1024) - flat(0)) / 1024, one_unit: flat(1) - flat(0), slope_over_gradient: (tilted(1) - tilted(0)) / slope };
}

// Whether the shader's own gl_FragCoord.z leaves [0, 1] under an offset.
function clampsFragZ(gpu) {
  const { gl } = gpu, size = { width: 8, height: 8 }, depth = gpu.depth(gl.DEPTH_COMPONENT32F, 8, 8);
  const colour = gpu.texture(gl.RGBA32UI, 8, 8, gl.RGBA_INTEGER, gl.UNSIGNED_INT);
  const body = "out highp uvec4 result; void main() { result = uvec4(floatBitsToUint(gl_FragCoord.z)); }";
  const vertex = "gl_Position = vec4(corner, 2.0 * (p.x + 4.0 * p.y * corner.x) - 1.0, 1.0);";
  gpu.draw(gpu.program("highp", body, vertex), { colour, depth, p: [0.9, 2 ** -6, 0, 0], offset: [64, 0] });
  const data = new Uint32Array(4 * size.width * size.height);
  gl.readPixels(0, 0, 8, 8, gl.RGBA_INTEGER, gl.UNSIGNED_INT, data);
  return floatOf(data[4 * 36]) <= 1;
}

function environment(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return {
    renderer: gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER),
    version: gl.getParameter(gl.VERSION),
    subpixel_bits: gl.getParameter(gl.SUBPIXEL_BITS),
    default_depth_bits: gl.getParameter(gl.DEPTH_BITS),
  };
}

// Everything, as the JSON that the reader can copy; `device` has the fields of a device profile.
function measureGpu(panel, depths) {
  const gpu = new Gpu(), { gl } = gpu, facts = environment(gl);
  const pairs = panel.pairs.flatMap((pair) => ["highp", "mediump"].map((precision) => measurePair(gpu, pair, precision, depths)));
  const formats = { unorm16: gl.DEPTH_COMPONENT16, unorm24: gl.DEPTH_COMPONENT24, f32: gl.DEPTH_COMPONENT32F };
  const each = (probe) => Object.fromEntries(Object.entries(formats).map(([name, internal]) => [name, probe(internal)]));
  const store = storeRule(gpu), load = loadRule(gpu), nearest = nearestRule(gpu), depth = each((internal) => depthFormat(gpu, internal, depths));
  const offset = each((internal) => polygonOffset(gpu, internal));
  const device = {
    subpixel_bits: facts.subpixel_bits, store: store.rule, load: load.rule, depth24: depth.unorm24.kind, nearest: nearest.rule,
    ...arithmetic(gpu), clamp_frag_z: clampsFragZ(gpu), slope_norm: offset.f32.slope_over_gradient > 1.2 ? "euclid" : "max",
  };
  const error = gl.getError();
  if (error) throw new Error(`WebGL error ${error}`);
  return { schema: "gnomon-device-1", ...facts, device, mediump: mediump(gpu), store, load, nearest, depth, polygon_offset: offset, packings: pairs };
}
