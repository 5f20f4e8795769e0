//! Every filter as one row: its name and the points that it compares, from which all else follows.

use super::disk::{DISK, poisson16, vogel5, vogel16};
use FilterKernel::{Mix, Square};

/// Points in texels around the coordinate.
pub type Points = &'static [[f32; 2]];

/// What a filter compares.
#[derive(Clone, Copy, Debug)]
pub enum FilterKernel {
    /// The texels under each point.
    Points {
        /// Where.
        points: fn() -> Points,
        /// No coordinate of a point is larger.
        reach: f64,
    },
    /// The texels under n×n points one texel apart.
    Square(usize),
    /// The four texels around each point, by their distance.
    Bilinear {
        /// Where.
        points: fn() -> Points,
        /// No coordinate of a point is larger.
        reach: f64,
    },
    /// One depth made of four texels.
    Mix,
}

/// The widest square.
pub const WIDEST: usize = 9;

const fn points(points: fn() -> Points, reach: f64) -> FilterKernel {
    FilterKernel::Points { points, reach }
}

const fn bilinear(points: fn() -> Points, reach: f64) -> FilterKernel {
    FilterKernel::Bilinear { points, reach }
}

const fn centre() -> Points {
    &[[0.0; 2]]
}

/// 3×3 points one texel apart, row by row.
const fn grid3() -> Points {
    &[
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [-1.0, 0.0],
        [0.0, 0.0],
        [1.0, 0.0],
        [-1.0, 1.0],
        [0.0, 1.0],
        [1.0, 1.0],
    ]
}

crate::catalogue! {
    /// Which texels a look-up reads.
    pub enum Filter: FilterKernel {
        /// The one texel under the coordinate.
        Nearest = "nearest" => points(centre, 0.0),
        /// Four texels, weighted: bytes of a packed texture are mixed before they are decoded.
        Linear = "linear" => Mix,
        /// 3×3 NEAREST comparisons, averaged.
        Pcf3 = "pcf3x3" => Square(3),
        /// Four comparisons, weighted by where the coordinate lies between the texel centres.
        Bilinear = "bilinear" => bilinear(centre, 0.0),
        /// 5×5 NEAREST comparisons, averaged.
        Pcf5 = "pcf5x5" => Square(5),
        /// 7×7 NEAREST comparisons, averaged.
        Pcf7 = "pcf7x7" => Square(7),
        /// 9×9 NEAREST comparisons, averaged.
        Pcf9 = "pcf9x9" => Square(WIDEST),
        /// 3×3 bilinear comparisons, averaged.
        Pcf3Bilinear = "pcf3x3-bilinear" => bilinear(grid3, 1.0),
        /// Sixteen NEAREST comparisons on a Poisson disk of 2 texels, not rotated.
        Poisson16 = "poisson16" => points(poisson16, DISK),
        /// Sixteen NEAREST comparisons on a Vogel disk of 2 texels, not rotated.
        Vogel16 = "vogel16" => points(vogel16, DISK),
        /// Five bilinear comparisons on a Vogel disk of 1 texel, not rotated (three.js since r182
        /// turns it by a noise of the pixel).
        Vogel5Bilinear = "vogel5-bilinear" => bilinear(vogel5, 0.948_683_3),
    }
}

impl Filter {
    /// What it compares.
    #[must_use]
    #[inline]
    pub const fn kernel(self) -> FilterKernel {
        *self.row()
    }

    /// How far from the coordinate, in texels along one axis, the farthest point lies at which a
    /// look-up may compare against the depth of a texel's centre: the half-width h of
    /// b* = h·s·|g|₁. Exact for square kernels, a bound for disks.
    #[must_use]
    pub const fn half_width(self) -> f64 {
        match self.kernel() {
            FilterKernel::Points { reach, .. } => 0.5 + reach,
            FilterKernel::Square(n) => n as f64 / 2.0,
            FilterKernel::Bilinear { reach, .. } => 1.0 + reach,
            FilterKernel::Mix => 1.0,
        }
    }

    /// Texels that one look-up reads.
    #[must_use]
    pub fn fetches(self) -> u32 {
        match self.kernel() {
            FilterKernel::Points { points, .. } => points().len() as u32,
            FilterKernel::Square(n) => (n * n) as u32,
            FilterKernel::Bilinear { points, .. } => 4 * points().len() as u32,
            FilterKernel::Mix => 4,
        }
    }
}
