"use strict";
// The same packings and depth textures in WebGPU, where the browser has it.
const SCREEN = "@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f { return vec4f(select(-1.0, 3.0, i == 1u), select(-1.0, 3.0, i == 2u), 0.0, 1.0); }";

class WebGpu {
  static async open() {
    const adapter = await navigator.gpu?.requestAdapter();
    if (!adapter) return null;
    const own = new WebGpu();
    own.device = await adapter.requestDevice();
    own.name = [adapter.info?.vendor, adapter.info?.architecture, adapter.info?.description].filter(Boolean).join(" ");
    own.faults = [];
    own.device.addEventListener("uncapturederror", ({ error }) => own.faults.push(error.message));
    return own;
  }

  texture(format, width, height) {
    const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC | GPUTextureUsage.COPY_DST;
    return this.device.createTexture({ format, size: [width, height], usage });
  }

  floats(values) {
    const rows = Math.ceil(values.length / WIDE), data = new Float32Array(WIDE * rows), texture = this.texture("r32float", WIDE, rows);
    data.set(values);
    this.device.queue.writeTexture({ texture }, data, { bytesPerRow: 4 * WIDE }, [WIDE, rows]);
    return texture;
  }

  // Draws one triangle over `target` with a fragment shader that reads the texture `from`.
  draw(code, from, target, depth = false) {
    const { device } = this, module = device.createShaderModule({ code: `${SCREEN}\n${code}` });
    const attachment = { view: target.createView() };
    const fragment = { module, entryPoint: "main", targets: depth ? [] : [{ format: target.format }] };
    const state = depth ? { depthStencil: { format: target.format, depthWriteEnabled: true, depthCompare: "always" } } : {};
    const pipeline = device.createRenderPipeline({ layout: "auto", vertex: { module, entryPoint: "corner" }, fragment, ...state });
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginRenderPass(depth
      ? { colorAttachments: [], depthStencilAttachment: { ...attachment, depthClearValue: 1, depthLoadOp: "clear", depthStoreOp: "store" } }
      : { colorAttachments: [{ ...attachment, loadOp: "clear", storeOp: "store" }] });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries: [{ binding: 0, resource: from.createView() }] }));
    pass.draw(3);
    pass.end();
    device.queue.submit([encoder.finish()]);
  }

  // The bit patterns of a u32 texture of WIDE across: rows of 2048 bytes need no padding.
  async read(texture) {
    const { device } = this, { height } = texture, buffer = device.createBuffer({ size: 4 * WIDE * height, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
    const encoder = device.createCommandEncoder();
    encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow: 4 * WIDE }, [WIDE, height]);
    device.queue.submit([encoder.finish()]);
    await buffer.mapAsync(GPUMapMode.READ);
    return new Float32Array(buffer.getMappedRange());
  }

  // What `value`, an f32 of the texel of `map` at `at`, is for every texel.
  values(map, kind, value, functions = "") {
    const result = this.texture("r32uint", map.width, map.height);
    this.draw(`@group(0) @binding(0) var map: ${kind};\n${functions}\n@fragment fn main(@builtin(position) p: vec4f) -> @location(0) u32 { let at = vec2i(p.xy); return bitcast<u32>(${value}); }`, map, result);
    return this.read(result);
  }

  async pair(pair, depths) {
    const values = this.floats([...depths, 1]), bytes = this.texture("rgba8unorm", WIDE, values.height);
    this.draw(`@group(0) @binding(0) var values: texture_2d<f32>;\n${pair.wgsl}\n@fragment fn main(@builtin(position) p: vec4f) -> @location(0) vec4f { return pack(textureLoad(values, vec2i(p.xy), 0).r); }`, values, bytes);
    const back = await this.values(bytes, "texture_2d<f32>", "unpack(textureLoad(map, at, 0))", pair.wgsl);
    return { name: pair.name, api: "WebGPU", precision: "highp", ...errorsOf(back, depths) };
  }

  async depth(format, depths) {
    const values = this.floats(depths), depth = this.texture(format, WIDE, values.height);
    this.draw("@group(0) @binding(0) var values: texture_2d<f32>;\n@fragment fn main(@builtin(position) p: vec4f) -> @builtin(frag_depth) f32 { return textureLoad(values, vec2i(p.xy), 0).r; }", values, depth, true);
    return keeps(depths, await this.values(depth, "texture_depth_2d", "textureLoad(map, at, 0)"));
  }
}

// All packings and depth textures; a sentence where this browser has no WebGPU.
async function measureWebGpu(panel, depths) {
  const gpu = await WebGpu.open().catch(() => null);
  if (!gpu) return { absent: "This browser offers no WebGPU; only WebGL2 was measured." };
  const packings = [], depth = {};
  for (const pair of panel.pairs) packings.push(await gpu.pair(pair, depths));
  for (const [name, format] of [["unorm16", "depth16unorm"], ["unorm24", "depth24plus"], ["f32", "depth32float"]]) depth[name] = await gpu.depth(format, depths);
  if (gpu.faults.length) throw new Error(gpu.faults[0]);
  return { adapter: gpu.name, packings, depth };
}
