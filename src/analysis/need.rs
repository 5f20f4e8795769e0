//! What a run on a case needs in memory, estimated before it starts and held against the budget.

use crate::scene::{Case, Filter};
use crate::{Result, memory};

/// Bytes that a program takes, measured as the largest resident sets of runs that grow one axis at a
/// time; rounded up.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// Whatever the case is.
    fixed: u64,
    /// For each texel of the largest map.
    texel: u64,
    /// For each receiver.
    receiver: u64,
    /// For each receiver and each texel that its look-up reads.
    tap: u64,
}

impl Need {
    /// The report of one case: 35 bytes a texel, 210 a receiver, 30 a tap were seen.
    pub const REPORT: Self = Self { fixed: 64 << 20, texel: 40, receiver: 256, tap: 32 };
    /// Tuning one case: 38 bytes a texel, 230 a receiver, 12 a tap were seen.
    pub const TUNE: Self = Self { fixed: 64 << 20, texel: 40, receiver: 256, tap: 16 };
    /// Sweeping one case: 39 bytes a texel, 410 a receiver beside 200 MB were seen.
    pub const SWEEP: Self = Self { fixed: 192 << 20, texel: 40, receiver: 480, tap: 16 };

    /// Refuses a case that needs more than the budget; every `step`-th pixel of the canvas in x and y
    /// is a receiver.
    ///
    /// # Errors
    /// [`crate::Error::BadInput`] with the need, the budget, and what takes the most of it.
    pub fn check(self, case: &Case, step: u32) -> Result<()> {
        self.check_with(case, case.map.size, case.lookup.filter, step)
    }

    /// This check with another map size and filter than the case's.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn check_with(self, case: &Case, size: u32, filter: Filter, step: u32) -> Result<()> {
        let [width, height] = case.canvas.map(u64::from);
        let step = u64::from(step.max(1));
        let receivers = width.div_ceil(step) * height.div_ceil(step);
        let triangles: usize = case.objects.iter().map(|o| o.mesh.triangles.len()).sum();
        let fetches = u64::from(filter.fetches());
        let shares = [
            (u64::from(size) * u64::from(size) * self.texel, "lower --map"),
            (
                width * height * PIXEL + receivers * (self.receiver + self.tap * fetches),
                "lower the canvas or take --quick",
            ),
            (triangles as u64 * TRIANGLE, "simplify the scene"),
        ];
        let need = self.fixed + shares.iter().map(|share| share.0).sum::<u64>();
        let largest = shares.into_iter().max_by_key(|share| share.0);
        let knob = largest.map_or("", |share| share.1);
        let place = format!(
            "{}: a map of {size} x {size}, a canvas of {width} x {height}, {filter}",
            case.name
        );
        memory::check(&place, need, knob)
    }
}

/// Bytes of a pixel of the canvas, whether or not it is a receiver.
const PIXEL: u64 = 12;
/// Bytes of a triangle in the mesh, the raster and the truth.
const TRIANGLE: u64 = 640;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::cases;

    fn complaint(edit: impl FnOnce(&mut Case)) -> Option<String> {
        let mut case = cases::named("t4-wall").expect("a standard case");
        edit(&mut case);
        Need::REPORT.check(&case, 1).err().map(|e| e.to_string())
    }

    #[test]
    fn the_largest_share_names_the_knob() {
        assert_eq!(complaint(|_| {}), None);
        let text = complaint(|case| case.canvas = [8192, 8192]).expect("beyond 8 GiB");
        assert!(text.starts_with("t4-wall: ") && text.contains("the budget is"), "{text}");
        assert!(text.contains("lower the canvas") && text.contains("--max-memory"), "{text}");
        let text = complaint(|case| {
            (case.canvas, case.lookup.filter) = ([2048, 2048], Filter::Pcf9);
        });
        assert!(text.expect("81 taps a receiver").contains("pcf9x9"));
    }
}
