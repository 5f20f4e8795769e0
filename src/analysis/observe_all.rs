//! All receivers of a canvas at once: their truth in one call, the depths at texel centres once a
//! texel.

use super::effort::{Count, TruthBy};
use super::foremost::{Foremost, Seen};
use super::observation::{Observation, Standing};
use super::observe::{Looking, Observer, Spot};
use super::outside::OutsideCounts;
use crate::light::Lens;
use crate::raster::TexelSet;
use crate::truth::{Answer, Answers, Receiver, izb};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// What is known of a receiver before it is judged.
struct Witness {
    exact: DVec3,
    standing: Standing,
}

impl Observer<'_> {
    /// Judges every `step`-th covered pixel in x and y, row by row from the bottom, and counts the work.
    #[must_use]
    pub fn observe_all(&self, step: u32) -> (Vec<Observation>, Vec<Count>) {
        let (receivers, seen) = self.seen(step);
        let (answers, mut work) = self.answers(&receivers);
        let witness = |(k, looking)| self.witnessed(looking, &answers.get(k));
        let witnesses: Vec<Witness> = seen.par_iter().enumerate().map(witness).collect();
        let (centres, count) = self.centre_depths(&seen, &witnesses);
        work.push(count);
        work.push(Count {
            what: "receivers on the ladder",
            answered: receivers.len() as u64,
            evaluated: witnesses.iter().filter(|w| w.standing == Standing::Counted).count() as u64,
            because: "they face away, lie outside cone or map, or have no certain truth",
        });
        let all = (seen, witnesses).into_par_iter().enumerate();
        let judged = all.map(|(k, (looking, w))| {
            let map = looking.main().map;
            self.judge(looking, w.exact, answers.get(k), w.standing, || {
                centres.depth(self, map, w.exact)
            })
        });
        (judged.collect(), work)
    }

    /// Every receiver that counts under every `step`-th pixel, with its exact coordinates in its main map
    /// and its truth; beside them what lies outside.
    pub(super) fn counted(&self, step: u32) -> (Vec<(Looking, DVec3, Answer)>, OutsideCounts) {
        let (receivers, seen) = self.seen(step);
        let (answers, _) = self.answers(&receivers);
        let witness = |(k, looking)| self.witnessed(looking, &answers.get(k));
        let witnesses: Vec<Witness> = seen.par_iter().enumerate().map(witness).collect();
        let add = |mut outside: OutsideCounts, k: usize| {
            let (looking, w) = (&seen[k], &witnesses[k]);
            let exact = (!w.exact.x.is_nan()).then_some(w.exact);
            let judged = (&answers.get(k), w.standing);
            outside.add(self, &looking.receiver, looking.main().map, exact, judged);
            outside
        };
        let all = (0..seen.len()).into_par_iter().with_min_len(1 << 14);
        let outside = all.fold(OutsideCounts::default, add);
        let outside = outside.reduce(OutsideCounts::default, OutsideCounts::joined);
        let all = (seen, witnesses).into_par_iter().enumerate();
        let counted = all.filter_map(|(k, (looking, w))| {
            (w.standing == Standing::Counted).then(|| (looking, w.exact, answers.get(k)))
        });
        (counted.collect(), outside)
    }

    /// The receivers under every `step`-th pixel, and where they look.
    fn seen(&self, step: u32) -> (Vec<Receiver>, Vec<Looking>) {
        let [width, height] = self.subject.canvas.size;
        let row = |y: u32| {
            let mut spot: Option<Spot> = None;
            let pixel = |x: u32| {
                let triangle = self.triangle_under(x, y)?;
                if spot.as_ref().is_none_or(|s| s.triangle != triangle) {
                    spot = Some(Spot::new(self, triangle));
                }
                Some(spot.as_ref()?.looking(self, x, y))
            };
            (0..width).step_by(step as usize).filter_map(pixel).collect()
        };
        let rows: Vec<u32> = (0..height).step_by(step as usize).collect();
        let rows: Vec<Vec<Looking>> = rows.into_par_iter().map(row).collect();
        let seen: Vec<Looking> = rows.into_iter().flatten().collect();
        (seen.par_iter().map(|looking| looking.receiver).collect(), seen)
    }

    /// What all receivers see.
    fn answers(&self, receivers: &[Receiver]) -> (Answers, Vec<Count>) {
        let light = self.light();
        if self.effort.truth == TruthBy::Rays {
            let answers = self.tracer.truths(receivers, light);
            return (answers.into_iter().collect(), Vec::new());
        }
        let skips = if self.effort.skip { izb::Skips::ALL } else { izb::Skips::NONE };
        let options = izb::Options { skips, ..izb::Options::default() };
        let (answers, work) = izb::truths_with(&self.geometry, receivers, light, options);
        (answers, truth_counts(&work))
    }

    fn witnessed(&self, looking: &Looking, answer: &Answer) -> Witness {
        let lens = &self.lenses[looking.main().map];
        let exact = lens.look(looking.receiver.position);
        let inside = exact.filter(|&e| lens.holds(e));
        let standing = self.standing(&looking.receiver, inside, answer);
        Witness { exact: exact.unwrap_or(DVec3::splat(f64::NAN)), standing }
    }

    /// Exact depths at the centres of the texels under all counted receivers; one look for a texel
    /// however many receivers lie in it.
    fn centre_depths(&self, seen: &[Looking], witnesses: &[Witness]) -> (Centres, Count) {
        let all = seen.par_iter().zip(witnesses);
        let counted = all.filter(|(_, w)| w.standing == Standing::Counted);
        let because = "receivers share texels, and f64 planes say with certainty what is first";
        let what = "exact depths at texel centres";
        if !self.effort.skip {
            let answered = counted.count() as u64;
            return (Centres::Asked, Count { what, answered, evaluated: answered, because });
        }
        let grid = Grid::new(&self.lenses);
        let mut texels = TexelSet::new(grid.len);
        let insert = |(l, w): (&Looking, &Witness)| {
            texels.insert(grid.number(&self.lenses, l.main().map, w.exact));
        };
        let asked = counted.map(insert).count();
        texels.count();
        let (depths, evaluated) = self.depths_at(&grid, &texels.list());
        let count = Count { what, answered: asked as u64, evaluated, because };
        (Centres::Known { grid, texels, depths }, count)
    }

    /// Exact depths of the first drawn casters at the centres of texels, and the rays traced for them.
    fn depths_at(&self, grid: &Grid, texels: &[u32]) -> (Vec<f64>, u64) {
        let (mut depths, mut rays) = (Vec::with_capacity(texels.len()), 0);
        for (map, lens) in self.lenses.iter().enumerate() {
            let numbers = grid.range(map);
            let [from, to] =
                [numbers.start, numbers.end].map(|n| texels.partition_point(|&t| t < n));
            let centres = texels[from..to].par_iter().map(|&t| grid.centre(lens, map, t));
            let (found, traced) = self.depths_at_centres(lens, &centres.collect::<Vec<DVec2>>());
            depths.extend(found);
            rays += traced;
        }
        (depths, rays)
    }

    fn depths_at_centres(&self, lens: &Lens, centres: &[DVec2]) -> (Vec<f64>, u64) {
        if centres.is_empty() {
            return (Vec::new(), 0);
        }
        let foremost = Foremost::new(self, lens, &self.drawn);
        let depth = |seen: Seen, uv: DVec2| match seen {
            Seen::Nothing => f64::INFINITY,
            Seen::First(triangle) => self.depth_of(lens, triangle, uv),
            Seen::Open => self.depth_at(lens, uv),
        };
        let found = foremost.by_block(centres, 0.0, |block, states| {
            foremost.look(block, DVec2::ZERO, states);
            let seen = (0..block.index().len()).map(|place| foremost.seen(states, place));
            let one = |(seen, &index): (Seen, &u32)| {
                (index, depth(seen, centres[index as usize]), u64::from(seen == Seen::Open))
            };
            seen.zip(block.index()).map(one).collect::<Vec<_>>()
        });
        let (mut depths, mut rays) = (vec![0.0; centres.len()], 0);
        for (index, depth, traced) in found.into_iter().flatten() {
            depths[index as usize] = depth;
            rays += traced;
        }
        (depths, rays)
    }
}

/// The texels of all maps in one row, each map's rows and columns one longer than it for what lies on its
/// border.
struct Grid {
    /// First number and columns of each map.
    maps: Vec<[u32; 2]>,
    len: usize,
}

impl Grid {
    fn new(lenses: &[Lens]) -> Self {
        let mut first = 0;
        let of = |lens: &Lens| {
            let [width, height] = lens.size;
            let map = [first, width + 1];
            first += (width + 1) * (height + 1);
            map
        };
        let maps = lenses.iter().map(of).collect();
        Self { maps, len: first as usize }
    }

    /// The number of the texel under exact coordinates within a map.
    fn number(&self, lenses: &[Lens], map: usize, exact: DVec3) -> u32 {
        let at = lenses[map].texels(exact.truncate()).floor();
        let [first, columns] = self.maps[map];
        first + at.y as u32 * columns + at.x as u32
    }

    /// The numbers of a map.
    fn range(&self, map: usize) -> Range<u32> {
        let end = self.maps.get(map + 1).map_or(self.len as u32, |next| next[0]);
        self.maps[map][0]..end
    }

    /// Coordinates of a texel's centre in its map.
    fn centre(&self, lens: &Lens, map: usize, number: u32) -> DVec2 {
        let [first, columns] = self.maps[map];
        let at = number - first;
        let corner = DVec2::new(f64::from(at % columns), f64::from(at / columns));
        (corner + 0.5) / lens.texels(DVec2::ONE)
    }
}

/// Exact depths at the centres of texels.
enum Centres {
    /// Looked up for each receiver.
    Asked,
    /// Known for each texel of a set, in its order.
    Known { grid: Grid, texels: TexelSet, depths: Vec<f64> },
}

impl Centres {
    /// The depth at the centre of the texel under exact coordinates in a map.
    fn depth(&self, observer: &Observer<'_>, map: usize, exact: DVec3) -> f64 {
        match self {
            Self::Asked => observer.centre_depth(map, exact),
            Self::Known { grid, texels, depths } => {
                let rank = texels.rank(grid.number(&observer.lenses, map, exact));
                depths[rank.expect("the texels of all counted receivers are members")]
            }
        }
    }
}

/// What the irregular z-buffer left out.
fn truth_counts(work: &izb::Work) -> Vec<Count> {
    vec![
        Count {
            what: "casters in the truth",
            answered: work.triangles,
            evaluated: work.swept,
            because: "they lie beside the receivers, or farther from the light than all of theirs",
        },
        Count {
            what: "pairs of caster and receiver",
            answered: work.answered,
            evaluated: work.evaluated,
            because: "they share no cell of the light's grid",
        },
        Count {
            what: "pairs by exact signs",
            answered: work.evaluated,
            evaluated: work.escalated,
            because: "the error bound of f32 decides, or the hit lies between known occluders",
        },
    ]
}
