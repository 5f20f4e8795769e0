"use strict";
// An explorer's arrays and verdicts: the twin of src/report/explorer.rs. A tap is lit from its
// breakpoint on; slider values are rounded to f32 first, so both agree at every value.
const LIT = 0, SHADOWED = 1, APART = 2;

function decodeView(view, bytes) {
  const array = (slice) => unplane(bytes, slice);
  const decoded = { ...view };
  for (const name of ["breakpoints", "truth", "shadowed", "lit", "lit_late", "late"]) decoded[name] = array(view[name]);
  decoded.rungs = view.rungs.map(array);
  decoded.fields = view.fields.map((field) => ({ ...field, values: array(field.values) }));
  return decide(decoded);
}

// A truly lit sample is wrong below its largest breakpoint, a shadowed one from its smallest on.
function decide(view) {
  const { taps, truth, breakpoints } = view;
  view.perTap = view.shadowed.length > truth.length;
  view.decisive = new Float32Array(truth.length).fill(Infinity);
  for (let s = 0; s < truth.length; s++) {
    const own = breakpoints.subarray(s * taps, (s + 1) * taps);
    if (truth[s] !== APART) view.decisive[s] = own.reduce((a, b) => (truth[s] === LIT) === b > a ? b : a);
  }
  return view;
}

// Where a sample's codes stand: those of its first wrong tap decide.
function codesOf(view, s, value, wrong) {
  if (!view.perTap) return s;
  const { taps, breakpoints } = view, lit = view.truth[s] === LIT;
  let t = s * taps;
  if (wrong) while ((value >= breakpoints[t]) === lit) t++;
  return t;
}

function wrongTaps(view, s, value) {
  const truth = view.truth[s];
  if (truth === APART || (value >= view.decisive[s]) === (truth === LIT)) return 0;
  let lit = 0;
  const { taps, breakpoints } = view;
  for (let t = s * taps; t < (s + 1) * taps; t++) lit += (value >= breakpoints[t]) | 0; // no branch to mispredict
  return truth === LIT ? view.taps - lit : lit;
}

function classOf(view, s, value) {
  const says = value >= view.decisive[s], wrong = view.truth[s] !== APART && says !== (view.truth[s] === LIT);
  const at = codesOf(view, s, value, wrong);
  return says ? (value >= view.late[at] ? view.lit_late[at] : view.lit[at]) : view.shadowed[at];
}

// The class of a right verdict, with which partly wrong samples are mixed.
function rightClass(view, s, value) {
  const at = codesOf(view, s, value, true);
  return view.truth[s] === LIT ? view.lit[at] : view.shadowed[at];
}

// The index of the first rung from which a wrong sample stays wrong to the end; -1 where right.
function causeOf(view, grid, s, value) {
  if (wrongTaps(view, s, value) === 0) return -1;
  const lit = view.truth[s] === LIT;
  let cause = view.rungs.length;
  while (cause > 0 && (value >= view.rungs[cause - 1][grid]) !== lit) cause--;
  return cause;
}

// Counts every sample, and paints it where `paint` gives pixels, a colour per class and `mixed` colours
// for samples of which only some taps are wrong. The one loop that runs on every slider move.
function survey(view, classes, value, paint) {
  const { truth, decisive, late, shadowed, lit, lit_late, taps, perTap } = view;
  const counts = new Uint32Array(classes), sides = [[0, 0], [0, 0]];
  for (let s = 0; s < truth.length; s++) {
    const says = value >= decisive[s], wrong = truth[s] !== APART && says !== (truth[s] === LIT);
    const at = perTap ? codesOf(view, s, value, wrong) : s;
    const code = says ? (value >= late[at] ? lit_late[at] : lit[at]) : shadowed[at];
    counts[code]++;
    if (paint) paint.pixels[s] = paint.colours[code];
    if (!wrong) continue;
    const many = taps === 1 ? 1 : wrongTaps(view, s, value), side = sides[truth[s]];
    side[0]++;
    side[1] += many;
    if (paint && many < taps) paint.pixels[s] = paint.mixed(rightClass(view, s, value), code, many);
  }
  return { classes: [...counts], false_shadow: sides[LIT], false_light: sides[SHADOWED] };
}

function gridOf(view, width, height) {
  const across = Math.ceil(width / view.every), down = Math.ceil(height / view.every);
  return { across, down, sample: (x, y) => y * view.every * width + x * view.every };
}

function surveyCauses(view, width, height, value, visit) {
  if (view.rungs.length === 0) return [];
  const counts = new Array(view.rungs.length + 1).fill(0), grid = gridOf(view, width, height);
  for (let y = 0; y < grid.down; y++) {
    for (let x = 0; x < grid.across; x++) {
      const cause = causeOf(view, y * grid.across + x, grid.sample(x, y), value);
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
