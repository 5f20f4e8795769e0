//! The ladder of causes: verdicts from the drawn faces to the final filter, from *bias* on each with the
//! case's bias.

crate::catalogue! {
    /// The rungs, from ideal to real. Each adds one source of error to the one before.
    pub enum Rung {
        /// Whether any drawn face occludes the receiver at all: wrong where culling leaves out all that do.
        Culling = "culling",
        /// Exact depth of the nearest occluder at the receiver itself.
        Bias = "bias",
        /// Exact depth, but at the texel's centre.
        Sampling = "sampling",
        /// f32 transform and raster.
        Arithmetic = "arithmetic",
        /// Store, packing, sampler and the map pass' depth attachment.
        Quantization = "quantization",
        /// The case's own filter.
        Filter = "filter",
    }
}

/// Whether each rung's verdict differs from the truth; the last one is the subject itself.
pub type WrongRungs = [bool; Rung::ALL.len()];

/// The first rung from which the verdict stays wrong to the end; `None` if the end is right.
#[must_use]
pub fn cause(wrong: &WrongRungs) -> Option<Rung> {
    let right_until = wrong.iter().rposition(|&w| !w).map_or(0, |last_right| last_right + 1);
    Rung::ALL.get(right_until).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_is_the_start_of_the_last_wrong_run() {
        assert_eq!(cause(&[false; 6]), None);
        assert_eq!(cause(&[true; 6]), Some(Rung::Culling));
        assert_eq!(cause(&[false, true, true, true, true, true]), Some(Rung::Bias));
        assert_eq!(cause(&[true, true, false, true, true, true]), Some(Rung::Arithmetic));
        assert_eq!(cause(&[true, true, true, true, true, false]), None);
        assert_eq!(cause(&[false, false, false, false, false, true]), Some(Rung::Filter));
    }

    #[test]
    fn repairing_the_blamed_rung_repairs_the_sample() {
        for bits in 0..64u8 {
            let wrong: WrongRungs = std::array::from_fn(|i| bits & (1 << i) != 0);
            let Some(blamed) = cause(&wrong) else { continue };
            let index = Rung::ALL.iter().position(|&r| r == blamed).unwrap();
            assert!(wrong[index..].iter().all(|&w| w), "{wrong:?}: wrong from there to the end");
            assert!(index == 0 || !wrong[index - 1], "{wrong:?}: its ideal is right");
        }
    }
}
