//! All receivers of a canvas at once: their truth in one call, the depths at texel centres once a
//! texel.

use super::effort::{Count, TruthBy};
use super::foremost::{Foremost, Seen};
use super::observation::{Observation, Standing};
use super::observe::{Looking, Observer, Spot};
use crate::raster::TexelSet;
use crate::truth::{Answer, Answers, Receiver, izb};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Where a receiver was seen: its pixel, and the map coordinates that the subject computes there.
type Place = ([u32; 2], [f32; 3]);

/// What is known of a receiver before it is judged.
struct Witness {
    exact: DVec3,
    standing: Standing,
}

impl Observer<'_> {
    /// Judges every `step`-th covered pixel in x and y, row by row from the bottom, and counts the work.
    #[must_use]
    pub fn observe_all(&self, step: u32) -> (Vec<Observation>, Vec<Count>) {
        let (receivers, places) = self.seen(step);
        let (answers, mut work) = self.answers(&receivers);
        let witness = |(k, receiver)| self.witnessed(receiver, &answers.get(k));
        let witnesses: Vec<Witness> = receivers.par_iter().enumerate().map(witness).collect();
        let (centres, count) = self.centre_depths(&witnesses);
        work.push(count);
        work.push(Count {
            what: "receivers on the ladder",
            answered: receivers.len() as u64,
            evaluated: witnesses.iter().filter(|w| w.standing == Standing::Counted).count() as u64,
            because: "they face away, lie outside cone or map, or have no certain truth",
        });
        let all = (receivers, places, witnesses).into_par_iter().enumerate();
        let judged = all.map(|(k, (receiver, (pixel, coord), w))| {
            let looking = Looking { pixel, receiver, coord };
            self.judge(looking, w.exact, answers.get(k), w.standing, || {
                centres.depth(self, w.exact)
            })
        });
        (judged.collect(), work)
    }

    /// Every receiver that counts under every `step`-th pixel, with its exact window coordinates and its
    /// truth.
    pub(super) fn counted(&self, step: u32) -> Vec<(Looking, DVec3, Answer)> {
        let (receivers, places) = self.seen(step);
        let (answers, _) = self.answers(&receivers);
        let all = (receivers, places).into_par_iter().enumerate();
        let counted = all.filter_map(|(k, (receiver, (pixel, coord)))| {
            let answer = answers.get(k);
            let witness = self.witnessed(&receiver, &answer);
            let looking = Looking { pixel, receiver, coord };
            (witness.standing == Standing::Counted).then_some((looking, witness.exact, answer))
        });
        counted.collect()
    }

    /// The receivers under every `step`-th pixel.
    fn seen(&self, step: u32) -> (Vec<Receiver>, Vec<Place>) {
        let [width, height] = self.subject.canvas.size;
        let row = |y: u32| {
            let mut spot: Option<Spot> = None;
            let pixel = |x: u32| {
                let triangle = self.triangle_under(x, y)?;
                if spot.as_ref().is_none_or(|s| s.triangle != triangle) {
                    spot = Some(Spot::new(self, triangle));
                }
                let (receiver, coord) = spot.as_ref()?.receiver(self, x, y);
                Some((receiver, ([x, y], coord)))
            };
            (0..width).step_by(step as usize).filter_map(pixel).unzip()
        };
        let rows: Vec<u32> = (0..height).step_by(step as usize).collect();
        let (receivers, places): (Vec<Vec<Receiver>>, Vec<Vec<Place>>) =
            rows.into_par_iter().map(row).unzip();
        rayon::join(|| receivers.concat(), || places.concat())
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

    fn witnessed(&self, receiver: &Receiver, answer: &Answer) -> Witness {
        let window = self.case().light.window_from_world(&self.clip_from_world, receiver.position);
        let standing = self.standing(receiver, window, answer);
        Witness { exact: window.unwrap_or(DVec3::splat(f64::NAN)), standing }
    }

    /// Exact depths at the centres of the texels under all counted receivers; one look for a texel
    /// however many receivers lie in it.
    fn centre_depths(&self, witnesses: &[Witness]) -> (Centres, Count) {
        let counted = witnesses.par_iter().filter(|w| w.standing == Standing::Counted);
        let because = "receivers share texels, and f64 planes say with certainty what is first";
        let what = "exact depths at texel centres";
        if !self.effort.skip {
            let answered = counted.count() as u64;
            return (Centres::Asked, Count { what, answered, evaluated: answered, because });
        }
        let side = self.case().map.size as usize + 1;
        let mut texels = TexelSet::new(side * side);
        let asked = counted.map(|w| texels.insert(self.texel_of(w.exact))).count();
        texels.count();
        let (depths, evaluated) = self.depths_at(&texels.list());
        let count = Count { what, answered: asked as u64, evaluated, because };
        (Centres::Known { texels, depths }, count)
    }

    /// The number of the texel under exact map coordinates in [0, 1], rows being one longer than the map
    /// for what lies on its border.
    fn texel_of(&self, exact: DVec3) -> u32 {
        let size = self.case().map.size;
        let at = (exact.truncate() * f64::from(size)).floor();
        at.y as u32 * (size + 1) + at.x as u32
    }

    /// Exact depths of the first drawn casters at the centres of texels, and the rays traced for them.
    fn depths_at(&self, texels: &[u32]) -> (Vec<f64>, u64) {
        let foremost = Foremost::new(self, self.drawn_faces);
        let side = self.case().map.size + 1;
        let corner = |t: u32| DVec2::new(f64::from(t % side), f64::from(t / side));
        let centre = |&t: &u32| (corner(t) + 0.5) / f64::from(side - 1);
        let centres: Vec<DVec2> = texels.par_iter().map(centre).collect();
        let depth = |seen: Seen, uv: DVec2| match seen {
            Seen::Nothing => f64::INFINITY,
            Seen::First(triangle) => self.depth_of(triangle, uv),
            Seen::Open => self.depth_at(uv),
        };
        let found = foremost.by_block(&centres, 0.0, |block, states| {
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

/// Exact depths at the centres of texels.
enum Centres {
    /// Looked up for each receiver.
    Asked,
    /// Known for each texel of a set, in its order.
    Known { texels: TexelSet, depths: Vec<f64> },
}

impl Centres {
    /// The depth at the centre of the texel under exact map coordinates.
    fn depth(&self, observer: &Observer<'_>, exact: DVec3) -> f64 {
        match self {
            Self::Asked => observer.centre_depth(exact),
            Self::Known { texels, depths } => {
                let rank = texels.rank(observer.texel_of(exact));
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
