"use strict";
// What explorers and the GPU panel share: elements, and arrays that travel inside the page.
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in element && name !== "list") element[name] = value; else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Bytes of equal weight stand together; put them side by side again.
function unplane(bytes, { kind, offset, length }) {
  if (kind === "u8") return bytes.subarray(offset, offset + length);
  const merged = new Uint8Array(4 * length);
  for (let plane = 0; plane < 4; plane++) {
    const from = offset + plane * length;
    for (let i = 0; i < length; i++) merged[4 * i + plane] = bytes[from + i];
  }
  return kind === "f32" ? new Float32Array(merged.buffer) : new Int32Array(merged.buffer);
}
