//! What is said of receivers and casters outside a light's volume, in the first lines of an answer.

use super::{Include, LeftOut, LostCaster, Outside, OutsideCounts, Reach};
use crate::analysis::observe::Observer;
use crate::report::number::{percent, significant};
use crate::scene::Case;

/// The first lines of an answer about a case: what was left out of its scene, then what lies outside its
/// light's volume; each a sentence, and nothing where there is nothing to say.
#[must_use]
pub fn first_lines(
    case: &Case,
    left_out: &[LeftOut],
    seen: u64,
    lost: &[LostCaster],
) -> Vec<String> {
    let skipped = skipped(case);
    let outside = (!left_out.is_empty()).then(|| {
        let receivers: u64 = left_out.iter().map(|left| left.receivers).sum();
        let who = match receivers == seen {
            true => format!("All {seen} receivers lie"),
            false => {
                let share = percent(receivers as f64 / seen as f64, 3);
                format!("{receivers} of {seen} receivers ({share}) lie")
            }
        };
        format!("{who} outside the light's volume and count in no rate{}.", reasons(left_out))
    });
    skipped.chain(outside).chain(lost.iter().map(LostCaster::sentence)).collect()
}

/// The first lines about one of some cases: with its name where there are several.
#[must_use]
pub fn named(cases: usize, name: &str, lines: &[String]) -> Vec<String> {
    let line = |line: &String| match cases {
        1 => line.clone(),
        _ => format!("{name}: {line}"),
    };
    lines.iter().map(line).collect()
}

/// What was left out of a case's scene and can change a shadow, each as a sentence.
fn skipped(case: &Case) -> impl Iterator<Item = String> + '_ {
    case.skipped.iter().map(|what| format!("Left out: {}.", what.trim_end_matches('.')))
}

impl OutsideCounts {
    /// These first lines; of a case without a counted receiver what lies outside is said by
    /// [`crate::analysis::measurement::Samples::unmeasured`].
    pub(in crate::analysis) fn first_lines(
        &self,
        observer: &Observer<'_>,
        measured: bool,
    ) -> Vec<String> {
        let left_out = if measured { self.left_out(observer) } else { Vec::new() };
        let mut lines =
            first_lines(observer.case(), &left_out, self.seen, &self.lost_casters(observer));
        lines.extend(self.receive_none());
        lines.extend(self.away());
        lines
    }

    /// Receivers on surfaces that receive no shadow, in one sentence.
    fn receive_none(&self) -> Option<String> {
        let Self { receive_none: none, seen, .. } = self;
        let share = percent(*none as f64 / (*seen).max(1) as f64, 3);
        (*none > 0).then(|| {
            format!(
                "{none} of {seen} receivers ({share}) lie on surfaces that receive no shadow and count in no rate."
            )
        })
    }

    /// Lit receivers whose vertices' normals point away from the light, in one sentence.
    fn away(&self) -> Option<String> {
        let [lit, away] = self.lit;
        let share = percent(away as f64 / lit.max(1) as f64, 3);
        (away > 0).then(|| {
            format!(
                "The vertex normals of {away} of {lit} lit receivers ({share}) point away from the light: a bias along them, such as three.js' normalBias, moves these into their own shadow."
            )
        })
    }
}

/// The reasons with their counts, then the values that include them all, for the end of a sentence:
/// `, beyond its far plane; set far from 500 to 600.6 (the outermost takes 600) to include them`.
pub(in crate::analysis) fn reasons(left_out: &[LeftOut]) -> String {
    let counts = match left_out {
        [only] => format!(", {}", place(only.why)),
        several => {
            let count = |left: &LeftOut| format!("{} {}", left.receivers, place(left.why));
            format!(": {}", several.iter().map(count).collect::<Vec<_>>().join(", "))
        }
    };
    let values: Vec<String> =
        Reach::ALL.iter().filter_map(|&reach| widest(left_out, reach)).map(value).collect();
    let set = match values.as_slice() {
        [] => String::new(),
        values => format!("; set {} to include them", values.join(" and ")),
    };
    let lost: u64 = left_out.iter().filter(|l| l.include.is_empty()).map(|l| l.receivers).sum();
    let move_it = match lost {
        0 => String::new(),
        n => format!("; no value includes {n} of them: move or turn the light"),
    };
    format!("{counts}{set}{move_it}")
}

const fn place(why: Outside) -> &'static str {
    match why {
        Outside::BehindLight => "behind the light",
        Outside::BeforeNear => "before its near plane",
        Outside::BeyondFar => "beyond its far plane",
        Outside::Left => "left of its map",
        Outside::Right => "right of its map",
        Outside::Below => "below its map",
        Outside::Above => "above its map",
        Outside::BeyondCone => "beyond its cone",
    }
}

/// The value of one reach that includes all that need it.
fn widest(left_out: &[LeftOut], reach: Reach) -> Option<Include> {
    let all = left_out.iter().flat_map(|left| &left.include).filter(|i| i.reach == reach);
    let outwards = |include: &Include| match reach {
        Reach::Near => -include.set,
        Reach::Far | Reach::Width | Reach::Height | Reach::Fovy => include.set,
    };
    all.copied().max_by(|a, b| outwards(a).total_cmp(&outwards(b)))
}

/// `far from 500 to 600.6 (the outermost takes 600)`.
fn value(include: Include) -> String {
    let [is, takes, set] = [include.is, include.takes, include.set].map(|x| significant(x, 4));
    format!("{} from {is} to {set} (the outermost takes {takes})", include.reach)
}

impl LostCaster {
    /// One sentence.
    fn sentence(&self) -> String {
        let Self { object, receivers, .. } = self;
        let place = match (self.why == Outside::BeforeNear, self.include.as_ref()) {
            (true, Some(include)) => format!("before near {}", significant(include.is, 4)),
            (false, Some(include)) => format!("beyond far {}", significant(include.is, 4)),
            (true, None) => "before near".to_string(),
            (false, None) => "beyond far".to_string(),
        };
        // What lies beyond far shadows receivers beyond far alone, whose value includes it.
        let include = self.include.filter(|_| self.why == Outside::BeforeNear);
        let remedy = include.map_or_else(String::new, |include| {
            format!("; set near to {}", significant(include.set, 4))
        });
        let lost = match self.whole {
            true => format!("{object} lies {place}, so its whole shadow is lost"),
            false => format!("Part of {object} lies {place}, so that part of its shadow is lost"),
        };
        format!("{lost} ({receivers} receivers{remedy}).")
    }
}
