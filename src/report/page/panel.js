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
    try {
      const bytes = await inflate(this.figure.querySelector("script.blob").textContent);
      this.result = measureGpu(this.about, [...unplane(bytes, this.about.depths)]);
      this.show(this.result);
    } catch (error) {
      this.said.textContent = `Not measured: ${error.message}. The rest of the page does not need it.`;
    }
    this.figure.dataset.done = "true";
  }

  show(result) {
    this.said.textContent = `Measured on ${result.renderer}.`;
    const json = JSON.stringify(result, null, 1), copy = make("button", { type: "button", className: "copy" }, "copy JSON");
    copy.addEventListener("click", async () => { await copyText(json); copy.textContent = "copied"; });
    const code = make("pre", { tabIndex: 0 }, make("code", {}, json));
    code.setAttribute("aria-label", "Measurements as JSON");
    const raw = make("details", {}, make("summary", {}, "All measurements as JSON"), code);
    this.stage.replaceChildren(this.button, this.said, this.pairs(result), this.facts(result), copy, raw);
  }

  pairs({ packings }) {
    const head = ["packing", "precision", "largest error", "predicted", "1.0 gives", "predicted", "rms error"];
    const rows = packings.map((pair) => {
      const predicted = this.about.pairs.find(({ name }) => name === pair.name)[pair.precision];
      const show = (name) => predicted ? plain(predicted[name]) : "–";
      return [pair.name, pair.precision, plain(pair.max_error), show("max_error"), plain(pair.one), show("one"), plain(pair.rms)];
    });
    return this.table("Packings on this device", head, rows);
  }

  facts({ device, mediump, depth, polygon_offset, store }) {
    const rows = Object.entries(device).map(([name, value]) => [name.replaceAll("_", " "), plain(value)]);
    rows.push(["mediump fraction bits (10 on true half floats)", plain(mediump.fraction_bits)], ["mediump overflows at 65536", String(mediump.overflows_at_65536)]);
    rows.push(["store: samples tried", plain(store.samples)]);
    for (const [name, { kind, max_error }] of Object.entries(depth)) rows.push([`${name} depth texture keeps`, `${kind}, largest error ${plain(max_error)}`]);
    for (const [name, { r, one_unit }] of Object.entries(polygon_offset)) rows.push([`polygon offset r at 0.625, ${name}`, `${plain(r)}; one unit gives ${plain(one_unit)}`]);
    return this.table("This device", ["fact", "measured"], rows);
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
