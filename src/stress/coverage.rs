//! Coverage under stress: slivers, T-junctions, vertices on pixel centres, holes, coplanar casters (T15).

use super::grid::{FINE, Grid, IDEAL, Point, SIZE};
use super::search::{Random, ladder, onset};
use super::{Fate, Forecast, Row, Sampling, Stress, winding};
use crate::depth::DepthFormat;
use crate::num::exp2;
use crate::raster::{Pass, PolygonOffset, Setup, draw};
use crate::report::Scale;
use crate::scene::Cull;
use glam::Vec4;

/// Narrower and narrower: the width that snapping leaves of a sliver 40 pixels long.
fn snapped_width(width: f64) -> f64 {
    let a = [10.0, 10.0].map(|c| c * FINE as f64);
    let b = [10.0 * FINE as f64, 50.0 * FINE as f64];
    let c = [a[0] + width * FINE as f64, a[1]];
    let setup = Setup::new(&IDEAL.device(), [SIZE; 2], [a, c, b].map(|p| IDEAL.clip_at(p, 0.5)));
    if !setup.is_front() {
        return 0.0;
    }
    // A quantity that is 0 on the long edge and 1 at the far corner grows by 1/width per pixel.
    1.0 / f64::from(setup.exact_plane([0.0, 1.0, 0.0]).gradient()[0])
}

/// A sliver's width down to nothing.
pub(super) fn slivers(effort: &Sampling) -> Stress {
    let widths = ladder(1e-4, 1.0, 17);
    let error = |w: f64| (snapped_width(w) / w - 1.0).abs();
    let event = "a sliver keeps an area";
    let formula = "half a sub-pixel, 2⁻⁹ pixel, rounds to none (ties to even)";
    let predicted = exp2(-9);
    let forecast = Forecast::at(Fate::Breaks, predicted, "sliver", event, formula)
        .curve(&widths, |w| if w < predicted { 1.0 } else { exp2(-9) / w });
    let measured = onset(1e-4, 1.0, 400, |w| snapped_width(w) > 0.0);
    let row = forecast
        .met(measured, widths.iter().map(|&w| (w, error(w))).collect())
        .noting("Narrower slivers are counted as empty and leave no NaN and no depth.");
    Stress {
        id: "sliver",
        title: "Slivers, and windings that flip",
        lead: "A triangle 40 pixels long whose width shrinks: the relative error of its width after \
               snapping to 2⁻⁸ pixel, the theory the bound 2⁻⁹/width. Front faces with two vertices on \
               the grid and the third anywhere beside their edge: the share that shows its back once it \
               is snapped."
            .to_string(),
        parameter: "width [pixels]",
        error: "error of the width; share of flipped faces",
        scale: Scale::Log,
        rows: vec![row, winding::along_the_grid(effort), winding::across_the_grid(effort)],
    }
}

/// A device with 4 sub-pixel bits, Vulkan's minimum: its cracks are sixteen times those of 8 bits.
const COARSE: Grid = Grid { fine: 16 };

/// One edge of `length` pixels in a random place and direction: the pattern with the T-junction on it,
/// and the one without.
fn junction(length: f64, random: &mut Random) -> ([[Point; 3]; 3], [[Point; 3]; 2]) {
    let fine = COARSE.fine as f64;
    let angle = 2.0 * std::f64::consts::PI * random.unit();
    let half = [libm::cos(angle), libm::sin(angle)].map(|c| c * length * fine / 2.0);
    let centre = [0; 2].map(|_| (random.unit() * 8.0 + 28.0) * fine);
    let rounded = |p: [f64; 2]| p.map(|c| c.round_ties_even() as i64);
    let end = |sign: f64| rounded([0, 1].map(|k| centre[k] + sign * half[k]));
    let (a, b) = (end(-1.0), end(1.0));
    let share = random.unit();
    let joint = rounded([0, 1].map(|k| a[k] as f64 + share * (b[k] - a[k]) as f64));
    let apex = |sign: f64| rounded([centre[0] - sign * half[1], centre[1] + sign * half[0]]);
    let (left, right) = (apex(1.0), apex(-1.0));
    ([[a, b, right], [a, left, joint], [joint, left, b]], [[a, b, right], [a, left, b]])
}

/// Pixels that one T-junction on an edge of `length` pixels misses or doubles, on average, and how many
/// pixels of every 64th pattern differ from the oracle.
fn junctions_of(length: f64, count: u32, seed: u64) -> (f64, usize) {
    let mut random = Random(seed);
    let (mut wrong, mut against_oracle) = (0usize, 0usize);
    for i in 0..count {
        let (parted, whole) = junction(length, &mut random);
        let (with, without) = (COARSE.covered(&parted), COARSE.covered(&whole));
        wrong += with.iter().zip(&without).filter(|(x, y)| x != y).count();
        if i % 64 == 0 {
            against_oracle += COARSE.differing(&parted);
        }
    }
    (wrong as f64 / f64::from(count), against_oracle)
}

/// T-junctions whose joint is not on the sub-pixel grid.
pub(super) fn junctions(effort: &Sampling) -> Stress {
    // A point rounded to a grid lies 0.24357 of its step off a line, on average over all directions
    // (∫ a/2 + c²/(6a) over the azimuth); the crack is a triangle of that height on the edge.
    let rate = |length: f64| 0.243_57 / COARSE.fine as f64 * length / 2.0;
    let lengths = ladder(4.0, 32.0, 7);
    let event = "one T-junction in ten costs a pixel";
    let formula = "½·L·0.24357·2⁻⁴ pixels of crack on an edge of L pixels";
    let predicted = 0.1 / rate(1.0);
    let forecast =
        Forecast::at(Fate::Degrades, predicted, "t-junction", event, formula).curve(&lengths, rate);
    let seed = |l: f64| effort.seed.wrapping_add(l.to_bits());
    let run = |&l: &f64| (l, junctions_of(l, 16 * effort.samples, seed(l)));
    let runs: Vec<_> = lengths.iter().map(run).collect();
    let slope = runs.iter().map(|r| r.1.0).sum::<f64>() / lengths.iter().sum::<f64>();
    let differing: usize = runs.iter().map(|r| r.1.1).sum();
    let note = format!(
        "{differing} pixels differ from the exact integer oracle: the cracks are the geometry's, not \
         the rasteriser's."
    );
    let curve = runs.iter().map(|&(l, (mean, _))| (l, mean)).collect();
    Stress {
        id: "t-junction",
        title: "T-junctions",
        lead: "One triangle has an edge, its two neighbours meet on that edge at a point which the grid \
               of 4 sub-pixel bits cannot keep. The curve is the mean number of pixels missed or doubled."
            .to_string(),
        parameter: "length of the edge [pixels]",
        error: "wrong pixels per T-junction",
        scale: Scale::Log,
        rows: vec![forecast.met(Some(0.1 / slope), curve).noting(note)],
    }
}

/// `spokes` triangles from `centre` to points on the border of the picture, in turn.
fn fan(centre: Point, spokes: u32, random: &mut Random) -> Vec<[Point; 3]> {
    let side = i64::from(SIZE) * FINE;
    let low = -FINE / 2;
    let rim = |s: i64| match s / side {
        0 => [low + s % side, low],
        1 => [low + side, low + s % side],
        2 => [low + side - s % side, low + side],
        _ => [low, low + side - s % side],
    };
    let mut stops: Vec<i64> = (0..spokes).map(|_| random.integer(0, 4 * side)).collect();
    stops.extend([0, side, 2 * side, 3 * side]);
    stops.sort_unstable();
    stops.dedup();
    let next = |i: usize| rim(stops[(i + 1) % stops.len()]);
    (0..stops.len()).map(|i| [centre, rim(stops[i]), next(i)]).collect()
}

/// A plane cut along every second cell of a grid with cells of `cell` sub-pixels: two triangles for each
/// cell kept.
fn cheese(cell: i64) -> Vec<[Point; 3]> {
    let cells = (i64::from(SIZE) * FINE / cell).min(48);
    let kept = (0..cells * cells).map(|i| (i % cells, i / cells)).filter(|(x, y)| (x + y) % 2 == 0);
    kept.flat_map(|(x, y)| {
        let at = |i: i64, j: i64| [(x + i) * cell - FINE / 2, (y + j) * cell - FINE / 2];
        [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]]
    })
    .collect()
}

/// A random triangle with its vertices on pixel centres.
fn on_centres(random: &mut Random) -> [Point; 3] {
    [[0; 2]; 3].map(|p: Point| p.map(|_: i64| random.integer(0, i64::from(SIZE)) * FINE))
}

/// Texels of two coplanar casters whose depth depends on the order in which they are drawn.
fn coplanar(random: &mut Random) -> usize {
    let plane = |[x, y]: [f64; 2]| 0.5 + (x / 3.0 + y / 7.0) * 1e-5;
    let corners: Vec<Vec4> = (0..6)
        .map(|_| {
            let place = [0; 2].map(|_| random.unit() * f64::from(SIZE) * FINE as f64);
            IDEAL.clip_at(place, plane(place))
        })
        .collect();
    let pass = Pass {
        size: [SIZE; 2],
        cull: Cull::None,
        depth_buffer: DepthFormat::F32,
        offset: PolygonOffset::default(),
        clip: Default::default(),
    };
    let depths = |order: [[u32; 3]; 2]| draw(&IDEAL.device(), &pass, &corners, &order).depth;
    let (one, other) = (depths([[0, 1, 2], [3, 4, 5]]), depths([[3, 4, 5], [0, 1, 2]]));
    one.iter().zip(&other).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
}

fn zero_row(name: &str, event: &str, formula: &str, counts: Vec<(f64, usize)>, of: &str) -> Row {
    let total: usize = counts.iter().map(|c| c.1).sum();
    let parameters: Vec<f64> = counts.iter().map(|c| c.0).collect();
    let first = counts.iter().find(|c| c.1 > 0).map(|c| c.0);
    let curve = counts.into_iter().map(|(p, n)| (p, n as f64)).collect();
    let note = format!("{total} {of}.");
    Forecast::never(name, event, formula).curve(&parameters, |_| 0.0).met(first, curve).noting(note)
}

/// Counts that have to be 0 however far the parameter goes.
pub(super) fn counts(effort: &Sampling) -> Stress {
    let mut random = Random(effort.seed);
    let sizes = [4u32, 16, 64, 256, 1024, 4096];
    let exact = "integer edge functions, one owner for every centre on a shared edge";
    let not_once = |t: &[[Point; 3]]| IDEAL.covered(t).iter().filter(|&&n| n != 1).count();
    let fans =
        sizes.map(|n| (f64::from(n), not_once(&fan([20 * FINE, 33 * FINE], n, &mut random))));
    let fans_oracle = sizes
        .map(|n| (f64::from(n), IDEAL.differing(&fan([20 * FINE + 7, 33 * FINE], n, &mut random))));
    let cells = [1i64, 3, 17, 128, 255, 256, 1000]
        .map(|c| (c as f64 / FINE as f64, IDEAL.differing(&cheese(c))));
    let centres = sizes.map(|n| {
        let wrong = (0..n).map(|_| IDEAL.differing(&[on_centres(&mut random)])).sum();
        (f64::from(n), wrong)
    });
    let shuffled = sizes.map(|n| (f64::from(n), (0..n).map(|_| coplanar(&mut random)).sum()));
    let differ = "pixels differ from the oracle";
    Stress {
        id: "coverage-counts",
        title: "Fans, holes, vertices on centres, coplanar casters (T15)",
        lead: "Patterns that must come out without one wrong pixel, against an exact integer oracle that \
               looks at one pixel centre at a time."
            .to_string(),
        parameter: "slivers, triangles, pairs; cell size [pixels]",
        error: "wrong pixels",
        scale: Scale::Log,
        rows: vec![
            zero_row("sliver-fan", "a fan misses or doubles a pixel", exact, fans.into(), "pixels missed or doubled by fans around a pixel centre"),
            zero_row("sliver-fan-oracle", "a fan differs from the oracle", exact, fans_oracle.into(), differ),
            zero_row("swiss-cheese", "a plane with holes differs from the oracle", exact, cells.into(), differ),
            zero_row("vertices-on-centres", "a triangle with vertices on pixel centres differs from the oracle", exact, centres.into(), differ),
            zero_row("coplanar-casters", "the map of two coplanar casters depends on their order", "the minimum of two depths has no order", shuffled.into(), "texels changed with the order"),
        ],
    }
}
