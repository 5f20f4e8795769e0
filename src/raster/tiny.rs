//! Small boxes of pixels, counted row by row, eight at a time.
#![allow(clippy::needless_range_loop, reason = "loops over indices become vectors")]

use crate::simd::lanes::BATCH;

/// Boxes of at most so many pixels, and no wider than [`BATCH`], are drawn this way.
const MOST: usize = 3 * BATCH;

/// First pixel and end along x and along y.
pub(super) type Window = [[i32; 2]; 2];

/// Eight pixels of a box, as steps from its lower left one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixels {
    pub(super) x: [i32; BATCH],
    pub(super) y: [i32; BATCH],
}

/// Column and row of the first pixels of boxes of each width.
static PLACES: [[[i32; MOST]; 2]; BATCH] = places();

const fn places() -> [[[i32; MOST]; 2]; BATCH] {
    let mut places = [[[0; MOST]; 2]; BATCH];
    let mut width = 1;
    while width <= BATCH {
        let mut i = 0;
        while i < MOST {
            places[width - 1][0][i] = (i % width) as i32;
            places[width - 1][1][i] = (i / width) as i32;
            i += 1;
        }
        width += 1;
    }
    places
}

/// How many pixels a box holds.
#[inline(always)]
pub(super) fn count([[left, right], [bottom, top]]: Window) -> usize {
    (right.wrapping_sub(left).max(0) as usize)
        .wrapping_mul(top.wrapping_sub(bottom).max(0) as usize)
}

/// Whether a box is drawn in fewer steps this way than row by row.
#[inline(always)]
pub(super) fn fits(window: Window) -> bool {
    let [[left, right], [bottom, top]] = window;
    let (width, height) = (right.wrapping_sub(left), top.wrapping_sub(bottom));
    let narrow = (width > 0) & (width <= BATCH as i32);
    narrow && count(window) <= MOST && count(window).div_ceil(BATCH) as i32 <= height
}

/// The pixels from `first` on of a box `width` pixels wide.
#[inline(always)]
pub(super) fn pixels(width: usize, first: usize) -> Pixels {
    let [x, y] = &PLACES[width - 1];
    let eight = |of: &[i32; MOST]| *of[first..first + BATCH].first_chunk().expect("eight of them");
    Pixels { x: eight(x), y: eight(y) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_count_a_box_row_by_row() {
        for (width, height) in [(1, 8), (2, 4), (3, 5), (5, 4), (8, 3)] {
            let window = [[7, 7 + width], [-3, -3 + height]];
            assert!(fits(window), "{width} x {height}");
            for i in 0..count(window) {
                let Pixels { x, y } = pixels(width as usize, i / BATCH * BATCH);
                let (x, y) = (x[i % BATCH], y[i % BATCH]);
                assert_eq!(y * width + x, i as i32);
                assert!(x < width && y < height, "{x}, {y} of {width} x {height}");
            }
        }
        assert!(!fits([[0, 9], [0, 2]]) && !fits([[0, 5], [0, 6]]) && !fits([[3, 3], [0, 2]]));
    }
}
