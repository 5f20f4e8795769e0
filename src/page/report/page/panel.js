"use strict";
// The "measure this GPU" panel: a button, two tables beside the predictions, JSON to copy.
const plain = (value) => typeof value === "number" ? (Number.isInteger(value) && Math.abs(value) < 1e6 ? String(value) : value.toPrecision(4)) : String(value);

class Panel {
  constructor(figure) {
    this.figure = figure;
    this.about = JSON.parse(figure.querySelector("script.about").textContent);
    this.stage = figure.querySelector(".stage");
    this.button = make("button", { type: "button", className: "go", onclick: () => this.run() }, "Measure this GPU");
    this.said = make("p", {});
    this.said.setAttribute("role", "status");
    this.stage.append(this.button, this.said);
    figure.querySelector(".unscripted").hidden = true;
    figure.panel = this;
  }

  async run() {
    this.button.disabled = true;
    try {
      const bytes = await inflate(this.figure.querySelector("script.blob").textContent);
      const depths = [...unplane(bytes, this.about.depths)];
      this.result = measureGpu(this.about, depths);
      this.result.webgpu = await measureWebGpu(this.about, depths);
      this.show(this.result);
    } catch (error) {
      this.said.textContent = `Not measured: ${error.message}. The rest of the page does not need it.`;
    }
    this.button.disabled = false;
    this.figure.dataset.done = "true";
  }

  show(result) {
    const { absent, adapter } = result.webgpu;
    this.said.textContent = `Measured on ${result.renderer}. ${absent ?? `WebGPU: ${adapter || "an unnamed adapter"}.`}`;
    const json = JSON.stringify(result, null, 1), copy = make("button", { type: "button", className: "copy" }, "copy JSON");
    copy.addEventListener("click", async () => { await copyText(json); copy.textContent = "copied"; });
    const code = make("pre", { tabIndex: 0 }, make("code", {}, json));
    code.setAttribute("aria-label", "Measurements as JSON");
    const raw = make("details", {}, make("summary", {}, "All measurements as JSON"), code);
    this.stage.replaceChildren(this.button, this.said, this.pairs(result), this.facts(result), copy, raw);
  }

  // A prediction that the measurement meets in every bit is marked.
  predicted(pair, name) {
    const all = this.about.pairs.find((about) => about.name === pair.name).predicted.filter(({ precision }) => precision === pair.precision);
    const shown = all.map((each) => `${pair[name] === each[name] ? "= " : ""}${plain(each[name] ?? Infinity)} ${each.on}${each.overflows ? " (overflows)" : ""}`);
    return make("span", {}, ...shown.map((text) => make("div", {}, text)));
  }

  pairs({ packings, webgpu }) {
    const head = ["packing", "run", "largest error", "predicted", "1.0 gives", "predicted", "rms error"];
    const rows = [...packings, ...webgpu.packings ?? []].map((pair) => [pair.name, `${pair.api} ${pair.precision}`, plain(pair.max_error),
      this.predicted(pair, "max_error"), plain(pair.one), this.predicted(pair, "one"), plain(pair.rms)]);
    return this.table("Packings on this device [window depth]", head, rows);
  }

  // Each fact beside what the known devices do; a fact that none of them has stands alone.
  facts({ device, mediump, depth, polygon_offset, webgpu, packings }) {
    const facts = { ...device };
    for (const [name, { kind }] of Object.entries(depth)) facts[`${name}_keeps`] = kind;
    for (const [name, { r, one_unit }] of Object.entries(polygon_offset)) Object.assign(facts, { [`${name}_r`]: r, [`${name}_one_unit`]: one_unit });
    for (const [name, { kind }] of Object.entries(webgpu.depth ?? {})) facts[`webgpu ${name} keeps`] = kind;
    facts["mediump fraction bits (10 on half floats)"] = mediump.fraction_bits;
    facts["mediump overflows at 65536"] = mediump.overflows_at_65536;
    facts["bytes stored otherwise by GLSL ES 1.00"] = packings.reduce((sum, pair) => sum + pair.es100_bytes_differing, 0);
    const text = (value) => value === undefined ? "–" : plain(value), { devices } = this.about;
    const rows = Object.entries(facts).map(([name, value]) => [name.replaceAll("_", " "), text(value), ...devices.map((known) => {
      const other = text(known.facts[name]);
      return other === text(value) ? `= ${other}` : other;
    })]);
    return this.table("This device", ["fact", "measured", ...devices.map(({ name }) => name)], rows);
  }

  table(caption, head, rows) {
    const line = (cells, tag) => make("tr", {}, ...cells.map((cell) => make(tag, {}, cell)));
    const table = make("table", {}, make("caption", {}, caption), make("thead", {}, line(head, "th")), make("tbody", {}, ...rows.map((row) => line(row, "td"))));
    const scroll = make("div", { className: "scroll", tabIndex: 0 }, table);
    scroll.setAttribute("role", "region");
    scroll.setAttribute("aria-label", caption);
    return scroll;
  }
}
if (typeof DecompressionStream === "function") document.querySelectorAll("figure.gpu").forEach((figure) => new Panel(figure));
