// Opens written reports in headless Chromium and compares what the page computes with what Rust
// computed. Usage: node run.mjs DIR, where DIR holds sample/, large/ and expected.json.
// GNOMON_CHROMIUM names the browser; GNOMON_SHOTS=DIR keeps screenshots; GNOMON_LEAST_RATE asks for
// that many updates a second (60 holds on a quiet machine; a busy one is given 20).
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const folder = process.argv[2];
const shots = process.env.GNOMON_SHOTS;
const expected = JSON.parse(readFileSync(join(folder, "expected.json")));
const args = ["--no-sandbox", "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--disable-quic", "--disable-background-networking", "--disable-component-update", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const browser = await chromium.launch({ executablePath: process.env.GNOMON_CHROMIUM ?? "/usr/bin/chromium", args });
const url = (name) => pathToFileURL(join(folder, name, "index.html")).href;

// A page that fails the test on any console error, exception or request to a network.
async function open(name, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const page = await context.newPage();
  const faults = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) faults.push(message.text()); });
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("request", (request) => { if (!/^(file|data|blob):/.test(request.url())) faults.push(`request ${request.url()}`); });
  await page.addInitScript(() => {
    window.show = (element) => {
      for (let part = element; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
      element.scrollIntoView();
    };
  });
  const start = Date.now();
  await page.goto(url(name));
  return { page, took: Date.now() - start, close: async () => { assert.deepEqual(faults, [], name); await context.close(); } };
}

const tests = {
  async "slider counts equal the Rust counts"() {
    let last = null;
    for (const { folder: name, id, at, fields } of expected) {
      if (last?.name !== name) {
        await last?.close();
        last = { name, ...await open(name) };
      }
      const different = await last.page.evaluate(async ({ id, at }) => {
        const figure = document.getElementById(id);
        show(figure);
        while (!figure.explorer) await new Promise(requestAnimationFrame);
        const explorer = await figure.explorer.ready, bits = new Uint32Array(1), value = new Float32Array(bits.buffer);
        const sorted = (x) => JSON.stringify(Object.entries(x).sort());
        return at.flatMap((row) => {
          bits[0] = row.bits;
          return row.views.filter((want, view) => sorted(explorer.tally(view, value[0])) !== sorted(want)).map(() => value[0]);
        });
      }, { id, at });
      const apart = await last.page.evaluate(({ id, fields }) => {
        const [view] = document.getElementById(id).explorer.views;
        return fields.flatMap(({ values, within }, field) => values.filter((want, i) => {
          const value = fieldValue(view, view.fields[field], i);
          return want === null ? Number.isFinite(value) : !(Math.abs(value - want) <= within);
        }).map((want) => [view.fields[field].name, want]));
      }, { id, fields });
      assert.deepEqual(apart.slice(0, 5), [], `${id}: values that the inspector shows otherwise`);
      assert.deepEqual(different, [], `${id}: biases at which page and Rust differ`);
      console.log(`  ${name} ${id}: ${at.length} biases, ${at[0].views.length} configurations, 0 differences`);
    }
    await last.close();
  },

  async "pixels equal the Rust picture"() {
    const { page, close } = await open("sample");
    const { id, picture } = expected[0];
    const different = await page.evaluate(async ({ id, picture }) => {
      const figure = document.getElementById(id);
      figure.scrollIntoView();
      while (!figure.dataset.drawn) await new Promise(requestAnimationFrame);
      const canvas = figure.querySelector(".pane canvas");
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return picture.filter((byte, i) => byte !== data[4 * Math.floor(i / 3) + i % 3]).length;
    }, { id, picture });
    assert.equal(different, 0);
    await close();
  },

  async "the slider keeps up at 512 x 512"() {
    const { page, close, took } = await open("large");
    const rates = await page.evaluate(async () => {
      const figure = document.getElementById("large");
      while (!figure.explorer) await new Promise(requestAnimationFrame);
      const explorer = await figure.explorer.ready, rates = [];
      for (const view of [0, 1]) {
        explorer.panes[0].index = view;
        explorer.draw();
        // One second's drag over the whole range, in six parts; the best part, which the machine's other
        // work left alone, and the worst.
        const part = (from) => {
          const start = performance.now();
          for (let i = from; i < from + 10; i++) { explorer.set(explorer.valueAt(i / 59)); explorer.draw(); }
          return 10000 / (performance.now() - start);
        };
        const parts = [0, 10, 20, 30, 40, 50].map(part);
        rates.push({ best: Math.max(...parts), worst: Math.min(...parts) });
      }
      return rates;
    });
    console.log(`  updates a second: ${rates.map(({ best, worst }) => `${best.toFixed(0)} (worst part ${worst.toFixed(0)})`).join(" with 1 tap, ")} with 9; page of 512 x 512 x 10 breakpoints opened in ${took} ms`);
    const least = Number(process.env.GNOMON_LEAST_RATE ?? 20);
    assert.ok(rates[0].best >= least, `1 tap: ${rates[0].best}`);
    assert.ok(rates[1].best >= least, `9 taps: ${rates[1].best}`);
    await close();
  },

  async "slider, exact value, marks, arrow keys and toggles work"() {
    const { page, close } = await open("sample");
    const figure = page.locator("#small");
    await figure.scrollIntoViewIfNeeded();
    const slider = figure.locator(".controls input[type=range]"), exact = figure.locator(".controls input[type=text]");
    const sum = figure.locator(".sum").first();
    await exact.fill("1e-6");
    await exact.press("Enter");
    const before = await sum.textContent();
    await slider.focus();
    for (let i = 0; i < 40; i++) await page.keyboard.press("Shift+ArrowRight");
    await page.waitForFunction(() => Number(document.getElementById("small").dataset.drawn) > 0.09);
    assert.notEqual(await sum.textContent(), before, "the counts follow the slider");
    await figure.getByRole("button", { name: "document's bias" }).click();
    assert.equal(await exact.inputValue(), "0.0015");
    const canvas = figure.locator(".pane canvas").first();
    await canvas.focus();
    const inspected = () => figure.locator(".inspector dd").first().textContent();
    const place = await inspected();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowDown");
    const [x, y] = place.split(", ").map(Number);
    assert.equal(await inspected(), `${x + 1}, ${y + 1}`);
    await figure.locator(".pane input[type=checkbox]").first().uncheck();
    await figure.getByLabel("side by side").check();
    assert.equal(await figure.locator(".pane").count(), 2);
    await figure.getByLabel("show").selectOption("margin");
    await figure.getByLabel("show").selectOption("cause");
    await close();
  },

  async "the GPU panel measures SwiftShader as the emulated device predicts"() {
    for (const name of ["sample", "documents"]) {
      const { page, close } = await open(name);
      await page.evaluate(() => show(document.getElementById("gpu")));
      await page.getByRole("button", { name: "Measure this GPU" }).click();
      await page.waitForFunction(() => document.getElementById("gpu").dataset.done);
      const { said, result, about } = await page.evaluate(() => {
        const { panel } = document.getElementById("gpu");
        return { said: panel.said.textContent, result: panel.result, about: panel.about };
      });
      assert.ok(result, said);
      console.log(`  ${said} ${JSON.stringify(result.device)}`);
      assert.match(result.renderer, /SwiftShader/);
      assert.deepEqual(result.device, { subpixel_bits: 4, store: "half-even", load: "reciprocal", depth24: "f32", nearest: "fixed16", fma: false, flush_denormals: true, clamp_frag_z: false, slope_norm: "max" });
      assert.deepEqual(result.mediump, { fraction_bits: 23, overflows_at_65536: false });
      assert.equal(result.depth.unorm16.kind, "unorm16");
      assert.ok(Math.abs(result.polygon_offset.unorm16.r * 65535 - 1.01) < 0.01, "r of 16 bits is 1.01 quanta");
      for (const measured of result.packings) {
        const { predicted } = about.pairs.find(({ name }) => name === measured.name), { max_error, one } = predicted.find(({ on }) => on === "webgl-swiftshader");
        assert.equal(measured.max_error, max_error, `${measured.name} ${measured.precision}: largest error`);
        assert.equal(measured.one, one, `${measured.name} ${measured.precision}: what 1.0 gives`);
        assert.equal(measured.es100_bytes_differing, 0, `${measured.name}: GLSL ES 1.00 stores other bytes`);
      }
      for (const { name, facts } of about.devices.filter(({ name }) => name === "webgl-swiftshader")) {
        for (const [format, { kind }] of Object.entries(result.depth)) assert.equal(kind, facts[`${format}_keeps`], `${name}: ${format}`);
        for (const [format, { r, one_unit }] of Object.entries(result.polygon_offset)) assert.deepEqual([r, one_unit], [facts[`${format}_r`], facts[`${format}_one_unit`]], `${name}: offset in ${format}`);
      }
      console.log(`  WebGPU: ${JSON.stringify(result.webgpu.absent ?? { depth: result.webgpu.depth, packings: result.webgpu.packings.map(({ name, max_error }) => [name, max_error]) })}`);
      writeFileSync(join(folder, "device.json"), JSON.stringify(result));
      if (shots) await page.locator("#gpu").screenshot({ path: join(shots, `gpu-${name}.png`) });
      await close();
    }
  },

  async "without WebGL the panel says so and the rest works"() {
    const { page, close } = await open("sample");
    await page.evaluate(() => { HTMLCanvasElement.prototype.getContext = ((get) => function (kind, ...rest) { return kind === "webgl2" ? null : get.call(this, kind, ...rest); })(HTMLCanvasElement.prototype.getContext); });
    await page.getByRole("button", { name: "Measure this GPU" }).click();
    await page.waitForFunction(() => document.getElementById("gpu").dataset.done);
    assert.match(await page.locator("#gpu [role=status]").textContent(), /no WebGL2/);
    await page.evaluate(() => show(document.getElementById("small")));
    await page.waitForFunction(() => document.getElementById("small").dataset.drawn);
    await close();
  },

  async "without script the numbers are there"() {
    const { page, close } = await open("sample", { javaScriptEnabled: false });
    assert.ok(await page.getByText("headroom −0.0016").isVisible());
    assert.ok(await page.locator("#small .still img").isVisible());
    assert.ok(await page.locator("#small .still").getByText("peter-panning").isVisible());
    await close();
  },

  async "no page is wider than its window; every image, plot and canvas has a name"() {
    for (const name of ["sample", "documents"]) {
      for (const width of [1280, 400]) {
        for (const colorScheme of ["light", "dark"]) {
          const { page, close } = await open(name, { viewport: { width, height: 900 }, colorScheme });
          const id = await page.evaluate(() => { const first = document.querySelector("figure.explorer"); show(first); return first.id; });
          await page.waitForFunction((id) => document.getElementById(id).dataset.drawn, id);
          assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width, `${name} at ${width}`);
          const nameless = await page.evaluate(() => [...document.querySelectorAll("img, canvas, svg[role=img], input, select")]
            .filter((e) => !(e.alt || e.getAttribute("aria-label") || e.labels?.length)).map((e) => e.outerHTML.slice(0, 80)));
          assert.deepEqual(nameless, []);
          if (shots) await page.screenshot({ path: join(shots, `${name}-${width}-${colorScheme}.png`), fullPage: true });
          await close();
        }
      }
    }
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    await test();
    console.log(`ok ${name}`);
  } catch (error) {
    failed++;
    console.log(`FAILED ${name}\n${error.stack}`);
  }
}
await browser.close();
process.exit(failed ? 1 : 0);
