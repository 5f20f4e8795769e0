//! Every filter as one row: its name and the points that it compares, from which all else follows.

use super::disk::{DISK, TurnedDisk, poisson16, vogel5, vogel16};
use super::tent::{self, AxisWeights};
use FilterKernel::{Mix, Separable, Square, Turned};

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
    /// (n + 1)² texels around the coordinate, n of them on average, each by the product of two weights.
    Separable {
        /// Width of the kernel in texels, odd.
        n: usize,
        /// The weights along an axis.
        weights: fn(f32) -> AxisWeights,
    },
    /// The four texels around each point of a disk that is turned by a noise of the pixel.
    Turned(TurnedDisk),
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

const fn separable(n: usize, weights: fn(f32) -> AxisWeights) -> FilterKernel {
    Separable { n, weights }
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
        /// Five bilinear comparisons on a Vogel disk of 1 texel, turned by the interleaved gradient noise of
        /// the pixel (three.js r182 on, PCFShadowMap with radius 1; shadowmap_pars_fragment.glsl.js of r187).
        Vogel5Turned = "vogel5-bilinear-ign" => Turned(TurnedDisk::THREE),
        /// Four bilinear comparisons on a Vogel disk of 2 texels, turned against the interleaved gradient
        /// noise of the pixel (Godot 4.5 *Soft Low*, scene_forward_lights_inc.glsl, without TAA).
        Vogel4Turned = "vogel4-bilinear-ign" => Turned(TurnedDisk::GODOT),
        /// 4×4 texels weighted as by a smooth 3×3 (Castaño, The Witness; four hardware comparisons in
        /// PlayCanvas PCF3, Filament PCF_LOW, Babylon's medium quality).
        Castano3 = "castano3x3" => separable(3, tent::castano3),
        /// 6×6 texels weighted as by a smooth 5×5 (Castaño, The Witness; nine hardware comparisons in
        /// PlayCanvas PCF5, Bevy's Gaussian, Babylon's high quality).
        Castano5 = "castano5x5" => separable(5, tent::castano5),
        /// 4×4 texels by the area of a tent 3 texels wide (Unity's ShadowSamplingTent.hlsl, URP and HDRP
        /// *Low*).
        Tent3 = "tent3x3" => separable(3, tent::tent3),
        /// 6×6 texels by the area of a tent 5 texels wide (URP and HDRP *Medium*).
        Tent5 = "tent5x5" => separable(5, tent::tent5),
        /// 8×8 texels by the area of a tent 7 texels wide (URP *High*).
        Tent7 = "tent7x7" => separable(7, tent::tent7),
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
            FilterKernel::Separable { n, .. } => (n + 1) as f64 / 2.0,
            FilterKernel::Turned(disk) => 1.0 + disk.radius as f64,
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
            FilterKernel::Separable { n, .. } => ((n + 1) * (n + 1)) as u32,
            FilterKernel::Turned(disk) => 4 * disk.count,
            FilterKernel::Mix => 4,
        }
    }

    /// Hardware comparisons of 2×2 texels that one look-up makes; 0 where it compares texel by texel.
    #[must_use]
    pub fn hardware_comparisons(self) -> u32 {
        match self.kernel() {
            FilterKernel::Bilinear { points, .. } => points().len() as u32,
            FilterKernel::Separable { n, .. } => ((n + 1) * (n + 1) / 4) as u32,
            FilterKernel::Turned(disk) => disk.count,
            FilterKernel::Points { .. } | FilterKernel::Square(_) | FilterKernel::Mix => 0,
        }
    }
}
