//! What the contacts of one segment add up to: which of them block every neighbouring segment.

use glam::DVec3;

use super::intersect::{Contact, Segment};
use super::orient::orient3d;
use super::{Answer, FirstHit, Occlusion, Truth};

/// All that is known about one segment. Contacts may arrive in any order.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    /// The contact inside a triangle that is nearest to the start.
    nearest: Option<Contact>,
    /// The contact inside a triangle that is nearest to the end.
    farthest: Option<Contact>,
    /// Contacts with an edge, a vertex or in a plane: rare.
    marginal: Vec<Contact>,
    touching: u32,
}

impl Contacts {
    /// Counts a triangle that the receiver touches.
    pub(super) fn touch(&mut self) {
        self.touching += 1;
    }

    /// Adds a contact. Ties go to the lowest triangle id.
    pub(super) fn add(&mut self, contact: Contact) {
        if !contact.is_inside() {
            self.marginal.push(contact);
            return;
        }
        if self.nearest.is_none_or(|old| before(&contact, &old)) {
            self.nearest = Some(contact);
        }
        if self.farthest.is_none_or(|old| before(&mirrored(contact), &mirrored(old))) {
            self.farthest = Some(contact);
        }
    }

    /// The verdict. `corners` gives a triangle's corners.
    pub(super) fn answer(
        mut self,
        segment: &Segment,
        corners: impl Fn(u32) -> [DVec3; 3],
    ) -> Answer {
        let (occluder, first) = self.ends(segment, corners);
        let truth = match (occluder, first) {
            (Some(occluder), Some(first)) => Truth::Shadowed(occlusion(segment, occluder, first)),
            _ if self.marginal.is_empty() => Truth::Lit,
            _ => Truth::Ambiguous,
        };
        Answer { truth, touching: self.touching }
    }

    /// The certain occluders nearest to both ends.
    fn ends(
        &mut self,
        segment: &Segment,
        corners: impl Fn(u32) -> [DVec3; 3],
    ) -> (Option<Contact>, Option<Contact>) {
        if self.marginal.is_empty() {
            return (self.nearest, self.farthest);
        }
        let from_receiver = self.marginal.iter().copied().chain(self.nearest);
        let from_light = self.marginal.iter().copied().chain(self.farthest).map(mirrored);
        let occluder = blocking(segment, from_receiver.collect(), &corners);
        let first = blocking(segment, from_light.collect(), &corners);
        (occluder, first.map(mirrored))
    }

    /// The first contact, if it is certain to block; ambiguous if it only grazes.
    pub(super) fn first_hit(
        self,
        segment: &Segment,
        corners: impl Fn(u32) -> [DVec3; 3],
    ) -> FirstHit {
        let mut all: Vec<Contact> = self.marginal.into_iter().chain(self.nearest).collect();
        all.sort_unstable_by(order);
        let Some(first) = all.first().copied() else {
            return FirstHit::None;
        };
        all.retain(|contact| contact.overlaps(&first));
        match blocking(segment, all, &corners) {
            Some(hit) => FirstHit::Hit { triangle: hit.triangle, t: hit.t, t_error: hit.error },
            None => FirstHit::Ambiguous,
        }
    }
}

fn occlusion(segment: &Segment, occluder: Contact, first: Contact) -> Occlusion {
    let length = segment.length();
    Occlusion {
        occluder: occluder.triangle,
        gap: occluder.t * length,
        first: first.triangle,
        first_gap: first.t * length,
    }
}

/// Order along the segment; ties by triangle id.
fn order(a: &Contact, b: &Contact) -> std::cmp::Ordering {
    a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle))
}

fn before(a: &Contact, b: &Contact) -> bool {
    order(a, b).is_lt()
}

/// The contact as seen from the other end, for ordering only.
fn mirrored(contact: Contact) -> Contact {
    Contact { t: -contact.t, ..contact }
}

/// Walks from the start until the contacts passed close the full turn around the segment: that
/// contact, or the one with the lowest id among the marginal ones at the same position.
fn blocking(
    segment: &Segment,
    mut contacts: Vec<Contact>,
    corners: &impl Fn(u32) -> [DVec3; 3],
) -> Option<Contact> {
    contacts.sort_unstable_by(order);
    let mut sectors = Vec::new();
    for (k, contact) in contacts.iter().enumerate() {
        if contact.is_inside() {
            return Some(*contact);
        }
        sectors.extend(sectors_of(contact, &corners(contact.triangle)));
        if full_turn(segment, &sectors) {
            let together = contacts[..=k].iter().filter(|other| other.overlaps(contact));
            return together.min_by_key(|other| other.triangle).copied();
        }
    }
    None
}

/// Directions around the segment, from the first point counter-clockwise to the second, by less
/// than half a turn. The segment does not pass through either point.
type Sector = [DVec3; 2];

/// The part of the turn that a triangle covers: what its edges that miss the segment span. An edge
/// met by the segment adds nothing; one vertex met leaves one sector.
fn sectors_of(contact: &Contact, corners: &[DVec3; 3]) -> impl Iterator<Item = Sector> {
    let (signs, corners) = (contact.signs, *corners);
    (0..3).filter(move |&k| signs[k] != 0).map(move |k| {
        let (start, end) = (corners[k], corners[(k + 1) % 3]);
        if signs[k] > 0 { [start, end] } else { [end, start] }
    })
}

/// Whether the closed sectors cover the full turn. A union of closed sectors that does not has a
/// counter-clockwise end, which is the end of some sector and which no sector reaches beyond.
fn full_turn(segment: &Segment, sectors: &[Sector]) -> bool {
    let turn = |a: DVec3, b: DVec3| orient3d(segment.to, a, b, segment.from);
    let reached = |end: DVec3, [from, to]: Sector| {
        matches!(turn(from, end), Some(0 | 1)) && turn(end, to) == Some(1)
    };
    !sectors.is_empty()
        && sectors.iter().all(|&[_, end]| sectors.iter().any(|&sector| reached(end, sector)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: Segment = Segment::vertical();

    fn at(x: f64, y: f64) -> DVec3 {
        DVec3::new(x, y, 3.0)
    }

    #[test]
    fn a_fan_closes_the_turn_and_a_fan_with_a_gap_does_not() {
        let ring = [at(1.0, 0.0), at(0.0, 1.0), at(-1.0, -1.0)];
        let fan: Vec<Sector> = (0..3).map(|k| [ring[k], ring[(k + 1) % 3]]).collect();
        assert!(full_turn(&UP, &fan));
        for missing in 0..3 {
            let mut open = fan.clone();
            open.remove(missing);
            assert!(!full_turn(&UP, &open), "sector {missing} is missing");
        }
    }

    #[test]
    fn overlapping_sectors_and_both_sides_of_an_edge_close_the_turn() {
        let (east, west, north, south) = (at(2.0, 0.0), at(-3.0, 0.0), at(0.5, 1.0), at(0.0, -1.0));
        let above = [[east, north], [north, west]];
        let below = [[west, south], [south, east]];
        assert!(full_turn(&UP, &[above, below].concat()));
        assert!(!full_turn(&UP, &above));
        assert!(!full_turn(&UP, &[above, above].concat()), "a fold covers one side only");
        assert!(!full_turn(&UP, &[]));
    }
}
