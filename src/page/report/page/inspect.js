"use strict";
// The explorer's curve with its moving marker, and its sample inspector.
function draw_svg(tag, attributes, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.textContent = text;
  return element;
}

// False shadow and false light over the slider, exact at every drawn value.
class Curve {
  constructor(owner) {
    this.owner = owner;
    this.size = { left: 52, right: 578, top: 12, bottom: 168 };
    this.svg = draw_svg("svg", { viewBox: "0 0 600 210", role: "img" });
    this.svg.addEventListener("pointerdown", (event) => this.drag(event));
    this.svg.addEventListener("pointermove", (event) => { if (event.buttons) this.drag(event); });
    this.element = make("div", { className: "curve card" }, this.svg);
  }

  drag(event) {
    const box = this.svg.getBoundingClientRect(), { left, right } = this.size;
    const x = (event.clientX - box.left) * 600 / box.width;
    this.owner.set(this.owner.valueAt(Math.min(1, Math.max(0, (x - left) / (right - left)))));
  }

  x(place) { return this.size.left + place * (this.size.right - this.size.left); }
  y(count) { return this.size.bottom - Math.log(1 + count) / Math.log(1 + this.samples) * (this.size.bottom - this.size.top); }

  sorted(view) {
    if (!view.sorted) {
      const of = (truth) => view.decisive.filter((_, s) => view.truth[s] === truth).sort();
      view.sorted = { lit: of(LIT), shadowed: of(SHADOWED) };
    }
    return view.sorted;
  }

  path(view, count) {
    const points = [];
    for (let i = 0; i <= 300; i++) points.push(`${this.x(i / 300).toFixed(1)},${this.y(count(this.sorted(view), this.owner.valueAt(i / 300))).toFixed(1)}`);
    return `M${points.join("L")}`;
  }

  draw() {
    const shown = this.owner.panes.map((pane) => pane.index).join();
    if (shown !== this.shown) this.rebuild(shown);
    const x = this.x(this.owner.place(this.owner.value));
    this.marker.setAttribute("x1", x);
    this.marker.setAttribute("x2", x);
  }

  rebuild(shown) {
    this.shown = shown;
    const views = this.owner.panes.map((pane) => pane.view), { left, right, top, bottom } = this.size;
    this.samples = views[0].truth.length;
    this.svg.replaceChildren();
    this.svg.setAttribute("aria-label", `False shadow and false light over ${this.owner.about.slider.label}`);
    for (let count = 1; count <= this.samples; count *= 10) this.tick(left - 6, this.y(count) + 4, "end", String(count), [left, this.y(count), right, this.y(count)]);
    this.tick(left - 6, bottom + 4, "end", "0", [left, bottom, right, bottom]);
    this.ticksBelow(top, bottom);
    views.forEach((view, i) => {
      const dash = i === 0 ? "none" : "7 4";
      const line = (colour, count) => this.svg.append(draw_svg("path", { d: this.path(view, count), fill: "none", stroke: colour, "stroke-width": 2.5, "stroke-dasharray": dash }));
      line("#d55e00", (sorted, value) => sorted.lit.length - atMost(sorted.lit, value));
      line("#0072b2", (sorted, value) => atMost(sorted.shadowed, value));
    });
    this.marker = draw_svg("line", { y1: top, y2: bottom, stroke: "#1c1c20", "stroke-width": 2 });
    this.svg.append(this.marker);
    this.text(left, 204, "start", "false shadow", "#b34700");
    this.text(left + 90, 204, "start", "false light", "#00639c");
    this.text(right, 204, "end", `${this.owner.about.slider.label}; samples, upright`);
  }

  ticksBelow(top, bottom) {
    const { low, high } = this.owner.about.slider;
    this.tick(this.x(0), bottom + 18, "middle", "0", [this.x(0), top, this.x(0), bottom]);
    for (let d = Math.ceil(Math.log10(low) - 1e-6); d <= Math.log10(high) + 1e-6; d++) {
      const x = this.x(this.owner.place(Number(`1e${d}`) * (1 + 1e-6)));
      this.tick(x, bottom + 18, "middle", `1e${d}`, [x, top, x, bottom]);
    }
  }

  tick(x, y, anchor, label, [x1, y1, x2, y2]) {
    this.svg.append(draw_svg("line", { x1, y1, x2, y2, stroke: "#d6d6dc" }));
    this.text(x, y, anchor, label);
  }

  text(x, y, anchor, label, fill = "#1c1c20") {
    this.svg.append(draw_svg("text", { x, y, "text-anchor": anchor, "font-size": 12, fill }, label));
  }
}

// One sample: what it is, what was measured, and its neighbourhood.
class Inspector {
  constructor(owner) {
    this.owner = owner;
    this.zoom = make("canvas", { width: 195, height: 195 });
    this.zoom.setAttribute("role", "img");
    this.zoom.setAttribute("aria-label", "Neighbourhood of the inspected sample");
    this.list = make("dl", {});
    this.list.setAttribute("aria-live", "polite");
    this.element = make("div", { className: "inspector" }, this.zoom, this.list);
  }

  draw() {
    const pane = this.pane ??= this.owner.panes[0];
    const { x, y } = this.owner.at;
    this.magnify(pane.canvas, x, y);
    this.list.replaceChildren(...this.lines(pane.view, x, y).flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
  }

  magnify(canvas, x, y) {
    const context = this.zoom.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.fillStyle = "#888";
    context.fillRect(0, 0, 195, 195);
    context.drawImage(canvas, x - 7, y - 7, 15, 15, 0, 0, 195, 195);
    context.strokeStyle = "#000";
    context.strokeRect(90.5, 90.5, 14, 14);
    context.strokeStyle = "#fff";
    context.strokeRect(91.5, 91.5, 12, 12);
  }

  // The canvas pixel of a sample.
  pixel(x, y) {
    const { step, bottom_up, height } = this.owner.about;
    return [x * step, (bottom_up ? height - 1 - y : y) * step];
  }

  lines(view, x, y) {
    const { about, value } = this.owner, s = y * about.width + x, wrong = wrongTaps(view, s, value);
    const truth = ["lit", "shadowed", "counted apart"][view.truth[s]];
    const [px, py] = this.pixel(x, y);
    const lines = [["pixel", `${px}, ${py}`], ["truth", truth], ["class", about.classes[classOf(view, s, value)][0]]];
    if (view.truth[s] !== APART) {
      const taps = Array.from(view.breakpoints.subarray(s * view.taps, (s + 1) * view.taps), short);
      const alike = view.taps > 1 && new Set(taps).size === 1;
      lines.push([view.taps > 1 ? "lit from, each tap" : "lit from", alike ? `${taps[0]}, all ${view.taps}` : taps.join(" ")]);
      if (view.taps > 1) lines.push(["wrong taps", `${wrong} of ${view.taps}`]);
    }
    lines.push(...this.measured(view, x, y));
    if (view.command) lines.push(["explain", make("code", {}, view.command.replace("{x}", px).replace("{y}", py))]);
    return lines;
  }

  shown(view, field, index) {
    const value = fieldValue(view, field, index);
    if (field.names.length) return field.names[value] ?? "–";
    if (Number.isNaN(value)) return "–";
    return field.steps ? value.toFixed(Math.max(0, Math.ceil(-Math.log10(field.steps[1] || 1)))) : short(value);
  }

  // Detail of the nearest grid sample up and left.
  measured(view, x, y) {
    if (!view.fields.length && !view.rungs.length) return [];
    const { about, value } = this.owner, grid = gridOf(view, about.width, about.height);
    const [gx, gy] = [Math.floor(x / view.every), Math.floor(y / view.every)];
    const index = gy * grid.across + gx, lines = [];
    if (view.every > 1) lines.push(["measured at", this.pixel(gx * view.every, gy * view.every).join(", ")]);
    if (view.rungs.length) {
      const sample = grid.sample(gx, gy), cause = wrongTaps(view, sample, value) ? causeOf(view, index, sample, reached(view, value)) : -1;
      lines.push(["cause", cause < 0 ? "none: the verdict is right" : view.causes[cause][0]]);
    }
    for (const field of view.fields) {
      const shown = this.shown(view, field, index);
      lines.push([field.name, field.unit && shown !== "–" ? `${shown} ${field.unit}` : shown]);
    }
    return lines;
  }
}

// Unpacked when first seen: a page with many explorers is ready at once.
function startExplorers() {
  const start = (figure) => { if (!figure.explorer) new Explorer(figure); };
  const seen = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) { seen.unobserve(entry.target); start(entry.target); }
  }, { rootMargin: "400px" });
  for (const figure of document.querySelectorAll("figure.explorer")) seen.observe(figure);
}
if (typeof DecompressionStream === "function") startExplorers();
