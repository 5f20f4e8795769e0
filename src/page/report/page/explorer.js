"use strict";
// Draws explorers: slider, masks, counts, curve and inspector follow one f32 value.
const css = ([r, g, b]) => `rgb(${r},${g},${b})`;
const pixel = ([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;
const faded = (rgb) => rgb.map((c) => Math.round(235 + (c - 235) * 0.08));
const blend = (from, to, part, whole) => from.map((c, i) => Math.floor((c * (whole - part) + to[i] * part + (whole >> 1)) / whole));

// Colours of partly wrong samples, each blended once.
function mixer(colours, taps) {
  const known = new Map();
  return (right, wrong, count) => {
    const key = (right * 256 + wrong) * 256 + count;
    if (!known.has(key)) known.set(key, pixel(blend(colours[right], colours[wrong], count, taps)));
    return known.get(key);
  };
}

const short = (value) => Number.isFinite(value) ? String(Number(value.toPrecision(6))) : value > 0 ? "never" : "always";

// The shortest decimal that rounds to this f32.
function shortest(value) {
  for (let digits = 1; digits < 9; digits++) {
    const text = String(Number(value.toPrecision(digits)));
    if (Math.fround(Number(text)) === value) return text;
  }
  return String(value);
}

class Explorer {
  constructor(figure) {
    this.figure = figure;
    this.about = JSON.parse(figure.querySelector("script.about").textContent);
    this.hidden = new Set();
    this.mode = "class";
    this.at = { x: this.about.width >> 1, y: this.about.height >> 1 };
    figure.explorer = this;
    this.ready = this.load();
  }

  async load() {
    const bytes = await inflate(this.figure.querySelector("script.blob").textContent);
    this.views = this.about.views.map((view) => decodeView(view, bytes));
    this.surveys = this.views.map((view) => new Survey(view, this.about.classes.length));
    this.value = Math.fround(this.about.slider.value);
    this.build();
    this.set(this.value);
    return this;
  }

  // Position 0 is zero, the rest is logarithmic.
  place(value) {
    const { low, high } = this.about.slider;
    if (value < low) return 0;
    return Math.min(1, 0.05 + 0.95 * Math.log(value / low) / Math.log(high / low));
  }

  valueAt(place) {
    const { low, high } = this.about.slider;
    return Math.fround(place < 0.05 ? 0 : low * Math.pow(high / low, (place - 0.05) / 0.95));
  }

  tally(view, value) {
    const rounded = Math.fround(value), { width, height } = this.about;
    const tally = this.surveys[view].follow(rounded);
    return { ...tally, causes: surveyCauses(this.surveys[view], width, height, rounded) };
  }

  set(value) {
    this.value = Math.fround(value);
    this.slider.value = this.place(this.value);
    this.slider.setAttribute("aria-valuetext", `${short(this.value)}`);
    if (document.activeElement !== this.exact) this.exact.value = shortest(this.value);
    this.schedule();
  }

  // At most one drawing per frame, however fast the slider moves.
  schedule() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.draw(); });
  }

  draw() {
    for (const pane of this.panes) pane.draw();
    this.curve.draw();
    this.inspector.draw();
    this.figure.dataset.drawn = String(this.value);
  }

  build() {
    const { about, figure } = this;
    figure.querySelector(".still").hidden = true;
    this.slider = make("input", { type: "range", min: 0, max: 1, step: "any" });
    this.slider.setAttribute("aria-label", about.slider.label);
    this.slider.addEventListener("input", () => this.set(this.valueAt(Number(this.slider.value))));
    this.slider.addEventListener("keydown", (event) => this.stepKey(event));
    this.exact = make("input", { type: "text", inputMode: "decimal", size: 14 });
    this.exact.setAttribute("aria-label", `${about.slider.label}, exact`);
    this.exact.addEventListener("change", () => { const v = Number(this.exact.value); if (v >= 0) this.set(v); });
    const marks = about.slider.marks.map(([value, name]) => make("button", { type: "button", onclick: () => this.set(value) }, name));
    const bar = make("div", { className: "controls" }, make("label", {}, about.slider.label, " ", this.exact), this.slider, make("div", { className: "marks" }, ...marks));
    this.panes = [new Pane(this, 0)];
    this.paneRow = make("div", { className: "panes" }, this.panes[0].element);
    this.curve = new Curve(this);
    this.inspector = new Inspector(this);
    const lower = make("div", { className: "lower" }, this.curve.element, this.inspector.element);
    figure.querySelector(".stage").append(bar, this.modes(), make("div", { className: "body" }, this.paneRow, lower));
  }

  // Arrow keys move by a thousandth of the range or so, with Shift by a twentieth.
  stepKey(event) {
    const direction = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!direction) return;
    event.preventDefault();
    const step = event.shiftKey ? 0.05 : 0.002;
    this.set(this.valueAt(Math.min(1, Math.max(0, this.place(this.value) + direction * step))));
  }

  modes() {
    const causes = this.views.some((view) => view.rungs.length > 0);
    const options = [["class", "artifacts"], ...(causes ? [["cause", "causes"]] : []), ["margin", "distance to breakpoint"]];
    const choice = make("select", { onchange: () => { this.mode = choice.value; range.hidden = choice.value !== "margin"; this.schedule(); } },
      ...options.map(([value, name]) => make("option", { value }, name)));
    const reach = make("input", { type: "range", min: 0.05, max: 1, step: "any", value: this.place(this.value) || 0.5 });
    const shown = make("output");
    this.reach = () => { const v = this.valueAt(Number(reach.value)); shown.textContent = ` ±${short(v)}`; return v; };
    reach.addEventListener("input", () => this.schedule());
    const range = make("label", { hidden: true }, "colour range ", reach, shown);
    const parts = [make("label", {}, "show ", choice), range];
    if (this.views.length > 1) parts.push(make("label", {}, this.comparing(), " side by side"));
    return make("div", { className: "modes" }, ...parts);
  }

  comparing() {
    const box = make("input", { type: "checkbox" });
    box.addEventListener("change", () => {
      this.panes.length = 1;
      if (box.checked) this.panes.push(new Pane(this, 1));
      this.paneRow.replaceChildren(...this.panes.map((pane) => pane.element));
      this.schedule();
    });
    return box;
  }
}

// One configuration: its picture and its counts.
class Pane {
  constructor(owner, index) {
    this.owner = owner;
    this.index = index;
    const { width, height, views } = owner.about;
    this.canvas = make("canvas", { width, height, tabIndex: 0 });
    this.canvas.setAttribute("role", "img");
    this.context = this.canvas.getContext("2d", { alpha: false, willReadFrequently: true });
    this.image = this.context.createImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.counts = make("div", { className: "counts" });
    const names = views.map((view, i) => make("option", { value: i, selected: i === index }, view.name));
    const choice = make("select", { onchange: () => { this.index = Number(choice.value); owner.schedule(); } }, ...names);
    choice.setAttribute("aria-label", "configuration");
    const heading = views.length > 1 ? choice : make("strong", {}, views[0].name);
    this.element = make("div", { className: "pane" }, heading, this.canvas, this.counts);
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerdown", (event) => this.point(event));
    this.canvas.addEventListener("keydown", (event) => this.move(event));
  }

  get view() { return this.owner.views[this.index]; }

  point(event) {
    const box = this.canvas.getBoundingClientRect(), { width, height } = this.owner.about;
    const x = Math.floor((event.clientX - box.left) * width / box.width), y = Math.floor((event.clientY - box.top) * height / box.height);
    this.go(x, y);
  }

  move(event) {
    const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    if (!dx && !dy) return;
    event.preventDefault();
    const far = event.shiftKey ? 10 : 1, { x, y } = this.owner.at;
    this.go(x + far * dx, y + far * dy);
  }

  go(x, y) {
    const { width, height } = this.owner.about;
    this.owner.at = { x: Math.min(width - 1, Math.max(0, x)), y: Math.min(height - 1, Math.max(0, y)) };
    this.owner.inspector.pane = this;
    this.owner.inspector.draw();
  }

  draw() {
    const { owner } = this, { width, height } = owner.about;
    const tally = this.survey().follow(owner.value, owner.mode === "class" ? this.classPainter() : null);
    if (owner.mode === "margin") this.drawMargins();
    const causes = surveyCauses(this.survey(), width, height, owner.value, owner.mode === "cause" ? this.causePainter() : null);
    this.context.putImageData(this.image, 0, 0);
    this.report(tally, causes);
  }

  // This pane's own: two panes may show one configuration.
  survey() {
    if (this.surveyed?.view !== this.view) this.surveyed = new Survey(this.view, this.owner.about.classes.length);
    return this.surveyed;
  }

  // Colours of the classes; everything is painted anew where they, the mode or the configuration changed.
  classPainter() {
    const { owner, view, pixels } = this, key = [this.index, ...owner.hidden].join();
    if (this.painted !== key) {
      const colours = owner.about.classes.map(([, rgb], i) => owner.hidden.has(i) ? faded(rgb) : rgb);
      this.colours = { pixels, colours: colours.map(pixel), mixed: mixer(colours, view.taps) };
    }
    const fresh = this.painted !== key;
    this.painted = key;
    return { ...this.colours, fresh };
  }

  causePainter() {
    this.painted = null;
    const { view, pixels } = this, { width, height } = this.owner.about;
    const colours = view.causes.map(([, rgb]) => pixel(rgb)), right = pixel([235, 235, 238]);
    return (x, y, cause) => {
      const colour = cause < 0 ? right : colours[cause], n = view.every;
      for (let j = y * n; j < Math.min(height, (y + 1) * n); j++) pixels.fill(colour, j * width + x * n, j * width + Math.min(width, (x + 1) * n));
    };
  }

  drawMargins() {
    this.painted = null;
    const { view, pixels, owner } = this, reach = owner.reach();
    const ramp = Array.from({ length: 511 }, (_, i) => pixel(blend([255, 255, 255], i < 255 ? [0, 114, 178] : [230, 159, 0], Math.abs(i - 255), 255)));
    const apart = pixel([222, 222, 226]);
    for (let s = 0; s < pixels.length; s++) {
      const t = Math.max(-1, Math.min(1, (view.decisive[s] - owner.value) / reach));
      pixels[s] = view.truth[s] === APART ? apart : ramp[255 + Math.round(255 * t)];
    }
  }

  report(tally, causes) {
    const { owner, view } = this, { lit, shadowed } = owner.curve.sorted(view);
    const share = (n, all) => `${(100 * n / Math.max(1, all)).toPrecision(3)} %`;
    if (!this.rows) this.rows = this.buildCounts();
    owner.about.classes.forEach((_, i) => { this.rows[i].textContent = tally.classes[i].toLocaleString("en"); });
    const taps = view.taps > 1 ? `; wrong taps ${tally.false_shadow[1]} and ${tally.false_light[1]}, ${view.taps} a sample` : "";
    this.sum.textContent = `false shadow ${tally.false_shadow[0]} (${share(tally.false_shadow[0], lit.length)} of the lit), false light ${tally.false_light[0]} (${share(tally.false_light[0], shadowed.length)} of the shadowed)${taps}`;
    const every = view.every > 1 ? ` (of one sample in ${view.every} across and down)` : "";
    this.causes.replaceChildren(...(causes.length ? ["by cause", every, ": "] : []), ...causes.flatMap((n, i) => [this.swatch(view.causes[i][1]), `${view.causes[i][0]} ${n} `]));
    this.canvas.setAttribute("aria-label", `${view.name} at ${short(owner.value)}: ${this.sum.textContent}`);
  }

  swatch(rgb) {
    const mark = make("span", { className: "swatch" });
    mark.style.background = css(rgb);
    return mark;
  }

  buildCounts() {
    const { owner } = this, list = make("ul", { className: "legend" }), rows = [];
    owner.about.classes.forEach(([name, rgb], i) => {
      const box = make("input", { type: "checkbox", checked: !owner.hidden.has(i) });
      box.addEventListener("change", () => { owner.hidden[box.checked ? "delete" : "add"](i); owner.schedule(); });
      rows.push(make("b"));
      list.append(make("li", {}, make("label", {}, box, this.swatch(rgb), name, " ", rows[i])));
    });
    this.sum = make("p", { className: "sum" });
    this.causes = make("p", { className: "causes" });
    this.counts.append(this.sum, list, this.causes);
    return rows;
  }
}
