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

// Bytes of equal weight stand together, as differences between neighbours; add them up again.
function unplane(bytes, { kind, offset, length }) {
  if (kind === "u8") return bytes.subarray(offset, offset + length);
  const wide = kind !== "u16", values = wide ? new Int32Array(length) : new Uint16Array(length);
  const [a, b, c, d] = [0, 1, 2, 3].map((plane) => offset + plane * length);
  for (let i = 0, sum = 0; i < length; i++) {
    sum = sum + (bytes[a + i] | bytes[b + i] << 8 | (wide ? bytes[c + i] << 16 | bytes[d + i] << 24 : 0)) | 0;
    values[i] = sum;
  }
  return kind === "f32" ? new Float32Array(values.buffer) : values;
}
