//! The order in which the parts of a look-up name its error: at one bias, and along all of them.

/// The parts in the order in which they name an error: the middle one, then the others; none where there
/// are none.
pub fn order(centre: usize, parts: usize) -> impl Iterator<Item = usize> {
    (parts > 0).then_some(centre).into_iter().chain((0..parts).filter(move |&part| part != centre))
}

/// The part that names an error: the first wrong one in [`order`].
#[must_use]
pub fn deciding(centre: usize, parts: usize, is_wrong: impl Fn(usize) -> bool) -> Option<usize> {
    order(centre, parts).find(|&part| is_wrong(part))
}

/// The texel whose surface decides a mix of `texels`: for a truly lit receiver the nearest to the light
/// (of equals the first), else the first, which NEAREST reads.
#[must_use]
#[inline]
pub fn deciding_in_a_mix(truly_lit: bool, texels: usize, depth: impl Fn(usize) -> f32) -> usize {
    if !truly_lit {
        return 0;
    }
    let nearer = |best: usize, i: usize| if depth(i) < depth(best) { i } else { best };
    (1..texels).fold(0, nearer)
}

/// Calls `span(tap, from, until)` with the amounts [from, until) of a bias at which each tap names the
/// error, `lit_from` saying from which amount each is lit: [`deciding`] at every amount. Returns the end
/// of the wrong amounts: the last of a truly lit receiver, the first of a truly shadowed one.
#[inline(always)]
pub fn spans(
    truly_lit: bool,
    centre: usize,
    lit_from: &[f32],
    mut span: impl FnMut(usize, f32, f32),
) -> f32 {
    let mut end = lit_from[centre];
    match truly_lit {
        true => span(centre, f32::NEG_INFINITY, end),
        false => span(centre, end, f32::INFINITY),
    }
    for (tap, &turn) in lit_from.iter().enumerate() {
        if truly_lit && turn > end {
            span(tap, end, turn);
            end = turn;
        } else if !truly_lit && turn < end {
            span(tap, turn, end);
            end = turn;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_part_is_first_and_a_look_up_without_parts_has_none() {
        assert_eq!(order(4, 9).collect::<Vec<_>>(), [4, 0, 1, 2, 3, 5, 6, 7, 8]);
        assert_eq!(order(0, 1).count(), 1);
        assert_eq!(order(0, 0).count(), 0);
        assert_eq!(deciding(0, 0, |_| true), None);
    }
}
