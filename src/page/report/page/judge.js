"use strict";
// An explorer's arrays and verdicts: the twin of src/report/explorer.rs. A tap is lit from its
// breakpoint on; slider values are rounded to f32 first, so both agree at every value.
const LIT = 0, SHADOWED = 1, APART = 2;

function decodeView(view, bytes) {
  const array = (slice) => unplane(bytes, slice);
  const decoded = { ...view };
  for (const name of ["breakpoints", "truth", "shadowed", "lit", "lit_late", "late"]) decoded[name] = array(view[name]);
  decoded.rungs = view.rungs.map(({ sorted, ranks }) => ({ sorted: array(sorted), ranks: array(ranks) }));
  decoded.fields = view.fields.map((field) => ({ ...field, values: field.values && array(field.values) }));
  return decide(decoded);
}

// The value of a field at a grid sample: stored, rounded to steps of its range, or a difference of two.
function fieldValue(view, { values, steps, difference }, grid) {
  if (difference) return fieldValue(view, view.fields[difference[0]], grid) - fieldValue(view, view.fields[difference[1]], grid);
  if (!steps) return values[grid];
  return values[grid] === 65535 ? NaN : steps[0] + steps[1] * values[grid];
}

// Each sample's breakpoints ascending, and for each number of lit taps the first wrong one: of a truly lit
// sample the first of those above, of a shadowed one the first of those below. A lit sample is wrong below
// its largest breakpoint, a shadowed one from its smallest on.
function decide(view) {
  const { taps, truth, breakpoints } = view, samples = truth.length;
  view.perTap = view.shadowed.length > samples;
  view.ascending = taps === 1 ? breakpoints : new Float32Array(samples * taps);
  view.firsts = new Uint8Array(samples * taps);
  view.decisive = new Float32Array(samples).fill(Infinity);
  const order = new Uint8Array(taps);
  for (let s = 0; s < samples; s++) {
    const base = s * taps, lit = truth[s] === LIT;
    if (taps > 1) sortTaps(view, base, order);
    for (let k = 0, first = taps; k < taps; k++) {
      const at = lit ? taps - 1 - k : k;
      view.firsts[base + at] = first = Math.min(first, order[at]);
    }
    if (truth[s] !== APART) view.decisive[s] = view.ascending[base + (lit ? taps - 1 : 0)];
  }
  return view;
}

function sortTaps({ taps, breakpoints, ascending }, base, order) {
  for (let k = 0; k < taps; k++) {
    const breakpoint = breakpoints[base + k];
    let at = k;
    for (; at > 0 && ascending[base + at - 1] > breakpoint; at--) {
      ascending[base + at] = ascending[base + at - 1];
      order[at] = order[at - 1];
    }
    ascending[base + at] = breakpoint;
    order[at] = k;
  }
}

// The verdict on a sample: its class, how many taps are wrong, and from which value up to which (the
// latter left out) both stay so. Of a wrong sample the codes of its first wrong tap decide. `lit` is a
// guess of how many taps are lit.
const verdict = { code: 0, wrong: 0, low: 0, high: 0 };
function judge(view, s, value, lit = 0) {
  const { taps, ascending, late } = view, truth = view.truth[s], base = s * taps;
  let at = view.perTap ? base : s;
  verdict.wrong = 0;
  verdict.low = -Infinity;
  verdict.high = Infinity;
  if (truth === APART) {
    verdict.code = view.shadowed[at];
    return verdict;
  }
  while (lit < taps && value >= ascending[base + lit]) lit++;
  while (lit > 0 && value < ascending[base + lit - 1]) lit--;
  if (lit > 0) verdict.low = ascending[base + lit - 1];
  if (lit < taps) verdict.high = ascending[base + lit];
  const says = truth === LIT ? lit === taps : lit > 0;
  if (says !== (truth === LIT)) {
    verdict.wrong = says ? lit : taps - lit;
    if (view.perTap) at += view.firsts[base + (says ? lit - 1 : lit)];
  }
  const isLate = says && value >= late[at];
  if (isLate) verdict.low = Math.max(verdict.low, late[at]); else if (says) verdict.high = Math.min(verdict.high, late[at]);
  verdict.code = says ? (isLate ? view.lit_late[at] : view.lit[at]) : view.shadowed[at];
  return verdict;
}

const wrongTaps = (view, s, value) => judge(view, s, value).wrong;
const classOf = (view, s, value) => judge(view, s, value).code;

// The class that a sample with `wrong` wrong taps would have were it right; it is mixed with its own.
function rightClass(view, s, wrong) {
  const { taps, firsts, perTap } = view, lit = view.truth[s] === LIT;
  const at = perTap ? s * taps + firsts[s * taps + (lit ? taps - wrong : wrong - 1)] : s;
  return lit ? view.lit[at] : view.shadowed[at];
}

// How many of each rung's sorted breakpoints `value` reaches: ranks below that are lit.
const reached = (view, value) => view.rungs.map(({ sorted }) => atMost(sorted, value));

// The index of the first rung from which a wrong sample stays wrong to the end.
function causeOf(view, grid, s, levels) {
  const lit = view.truth[s] === LIT;
  let cause = view.rungs.length;
  while (cause > 0 && (view.rungs[cause - 1].ranks[grid] < levels[cause - 1]) !== lit) cause--;
  return cause;
}

// Follows one view from value to value: samples whose verdict stays are left alone.
class Survey {
  constructor(view, classes) {
    const samples = view.truth.length;
    this.view = view;
    this.code = new Uint8Array(samples);
    this.wrong = new Uint8Array(samples);
    this.low = new Float32Array(samples).fill(Infinity); // nothing is judged yet
    this.high = new Float32Array(samples).fill(Infinity);
    this.counts = new Int32Array(classes);
    this.sides = [[0, 0], [0, 0], [0, 0]];
  }

  // Counts every sample at `value`, and paints the changed ones where `paint` gives pixels, a colour per
  // class and `mixed` colours for samples of which only some taps are wrong; all where `paint.fresh`.
  follow(value, paint) {
    const { view, code, wrong, low, high, counts } = this, fresh = paint?.fresh;
    for (let s = 0; s < code.length; s++) {
      const stays = value >= low[s] && value < high[s];
      if (!stays) this.change(s, judge(view, s, value, view.truth[s] === LIT ? view.taps - wrong[s] : wrong[s]));
      if (paint && (fresh || !stays)) {
        const partly = wrong[s] > 0 && wrong[s] < view.taps;
        paint.pixels[s] = partly ? paint.mixed(rightClass(view, s, wrong[s]), code[s], wrong[s]) : paint.colours[code[s]];
      }
    }
    return { classes: [...counts], false_shadow: this.sides[LIT], false_light: this.sides[SHADOWED] };
  }

  change(s, verdict) {
    const side = this.sides[this.view.truth[s]];
    if (this.low[s] < Infinity) this.counts[this.code[s]]--;
    this.counts[verdict.code]++;
    side[0] += (verdict.wrong > 0) - (this.wrong[s] > 0);
    side[1] += verdict.wrong - this.wrong[s];
    this.code[s] = verdict.code;
    this.wrong[s] = verdict.wrong;
    this.low[s] = verdict.low;
    this.high[s] = verdict.high;
  }
}

function gridOf(view, width, height) {
  const across = Math.ceil(width / view.every), down = Math.ceil(height / view.every);
  return { across, down, sample: (x, y) => y * view.every * width + x * view.every };
}

function surveyCauses({ view, wrong }, width, height, value, visit) {
  if (view.rungs.length === 0) return [];
  const counts = new Array(view.rungs.length + 1).fill(0), grid = gridOf(view, width, height), levels = reached(view, value);
  for (let y = 0; y < grid.down; y++) {
    for (let x = 0; x < grid.across; x++) {
      const s = grid.sample(x, y), cause = wrong[s] > 0 ? causeOf(view, y * grid.across + x, s, levels) : -1;
      if (cause >= 0) counts[cause]++;
      if (visit) visit(x, y, cause);
    }
  }
  return counts;
}

// How many of an ascending array are at most `value`.
function atMost(sorted, value) {
  let low = 0, high = sorted.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= value) low = middle + 1; else high = middle;
  }
  return low;
}
