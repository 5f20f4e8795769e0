//! All receivers of a canvas at once: their truth in one call, the depths at texel centres once a
//! texel.

use super::effort::{Count, TruthBy};
use super::foremost::{self, Foremost};
use super::observation::{Observation, Standing};
use super::observe::{Observer, Seen, Spot};
use crate::truth::{Answer, LightEnd, Receiver, izb};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// What is known of a receiver before it is judged.
struct Witness {
    exact: DVec3,
    standing: Standing,
}

impl Observer<'_> {
    /// Judges every `step`-th covered pixel in x and y, row by row from the bottom, and counts the work.
    #[must_use]
    pub fn observe_all(&self, step: u32) -> (Vec<Observation>, Vec<Count>) {
        let seen = self.seen(step);
        let receivers: Vec<Receiver> = seen.iter().map(|s| s.receiver).collect();
        let (answers, mut work) = self.answers(&receivers);
        let witness = |(receiver, answer): (&Receiver, &Answer)| self.witnessed(receiver, answer);
        let witnesses: Vec<Witness> = receivers.par_iter().zip(&answers).map(witness).collect();
        let (depths, count) = self.centre_depths(&witnesses);
        work.push(count);
        work.push(Count {
            what: "receivers on the ladder",
            answered: seen.len() as u64,
            evaluated: witnesses.iter().filter(|w| w.standing == Standing::Counted).count() as u64,
            because: "they face away, lie outside cone or map, or have no certain truth",
        });
        let inputs = (seen, witnesses, answers, depths);
        let judged = inputs.into_par_iter().map(|(seen, w, answer, depth)| {
            self.judge(seen, w.exact, answer, w.standing, || depth)
        });
        (judged.collect(), work)
    }

    /// The receivers under every `step`-th pixel.
    fn seen(&self, step: u32) -> Vec<Seen> {
        let [width, height] = self.subject.canvas.size;
        let row = |y: u32| {
            let mut spot: Option<Spot> = None;
            let pixel = move |x: u32| {
                let triangle = self.triangle_under(x, y)?;
                if spot.as_ref().is_none_or(|s| s.triangle != triangle) {
                    spot = Some(Spot::new(self, triangle));
                }
                let (receiver, coord) = spot.as_ref()?.receiver(self, x, y);
                Some(Seen { pixel: [x, y], receiver, coord })
            };
            (0..width).step_by(step as usize).filter_map(pixel).collect::<Vec<_>>()
        };
        let rows: Vec<u32> = (0..height).step_by(step as usize).collect();
        rows.into_par_iter().map(row).collect::<Vec<_>>().concat()
    }

    /// Where the shadow rays of all receivers end.
    #[must_use]
    pub fn light(&self) -> LightEnd {
        let light = &self.case().light;
        match light.is_directional() {
            true => LightEnd::Along(light.view.backward() * self.tracer.reach()),
            false => LightEnd::Point(light.view.position),
        }
    }

    /// What all receivers see.
    fn answers(&self, receivers: &[Receiver]) -> (Vec<Answer>, Vec<Count>) {
        let light = self.light();
        if self.effort.truth == TruthBy::Rays {
            return (self.tracer.truths(receivers, light), Vec::new());
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
    fn centre_depths(&self, witnesses: &[Witness]) -> (Vec<f64>, Count) {
        let mut depths = vec![f64::INFINITY; witnesses.len()];
        let mut places: Vec<(u64, u32)> = witnesses
            .par_iter()
            .enumerate()
            .filter(|(_, w)| w.standing == Standing::Counted)
            .map(|(i, w)| (self.texel_key(w.exact), i as u32))
            .collect();
        let answered = places.len() as u64;
        places.par_sort_unstable();
        let groups: Vec<&[(u64, u32)]> = if self.effort.skip {
            places.chunk_by(|a, b| a.0 == b.0).collect()
        } else {
            places.chunks(1).collect()
        };
        let centre =
            |group: &&[(u64, u32)]| self.texel_centre(witnesses[group[0].1 as usize].exact);
        let centres: Vec<DVec2> = groups.iter().map(centre).collect();
        let (found, evaluated) = self.depths_at(&centres);
        for (group, depth) in groups.iter().zip(found) {
            group.iter().for_each(|&(_, i)| depths[i as usize] = depth);
        }
        let because = "receivers share texels, and f64 planes say with certainty what is first";
        (depths, Count { what: "exact depths at texel centres", answered, evaluated, because })
    }

    /// The texel under exact map coordinates in [0,1], as one number.
    fn texel_key(&self, exact: DVec3) -> u64 {
        let at = (exact.truncate() * f64::from(self.case().map.size)).floor();
        (at.y as u64) << 32 | at.x as u64
    }

    /// Exact depths of the first drawn casters at map points, and the rays traced for them.
    fn depths_at(&self, points: &[DVec2]) -> (Vec<f64>, u64) {
        if !self.effort.skip {
            let depths = points.par_iter().map(|&uv| self.depth_at(uv)).collect();
            return (depths, points.len() as u64);
        }
        let foremost = Foremost::new(self, self.drawn_faces);
        let chunk = |points: &[DVec2]| {
            let seen = foremost.at(points);
            let rays = seen.iter().filter(|s| **s == foremost::Seen::Open).count() as u64;
            let depth = |(seen, &uv): (foremost::Seen, &DVec2)| match seen {
                foremost::Seen::Nothing => f64::INFINITY,
                foremost::Seen::First(triangle) => self.depth_of(triangle, uv),
                foremost::Seen::Open => self.depth_at(uv),
            };
            (seen.into_iter().zip(points).map(depth).collect::<Vec<_>>(), rays)
        };
        let found: Vec<_> = points.par_chunks(foremost.chunk()).map(chunk).collect();
        let rays = found.iter().map(|(_, rays)| rays).sum();
        (found.into_iter().flat_map(|(depths, _)| depths).collect(), rays)
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
