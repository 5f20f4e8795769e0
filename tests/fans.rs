//! Closed fans of triangles cover every pixel of their square exactly once (R8), on every device.

use glam::Vec4;
use gnomon::device::DeviceProfile;
use gnomon::raster::Setup;
use gnomon::scene::Cull;
use rayon::prelude::*;

/// Side of the square in pixels.
const SIDE: u32 = 16;

/// Seeded random numbers.
struct Random(fastrand::Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    fn below(&mut self, limit: u64) -> u64 {
        self.0.u64(..limit)
    }

    /// In [−1, 1]: on a pixel's centre or corner, on a sub-pixel, beside a centre, or anywhere.
    fn coordinate(&mut self) -> f32 {
        let side = f64::from(SIDE);
        let pixel = self.below(u64::from(SIDE)) as f64;
        let inside = match self.below(5) {
            0 => 0.5,
            1 => 0.0,
            2 => self.below(256) as f64 / 256.0,
            3 => 0.5 + (self.below(9) as f64 - 4.0) / 65_536.0,
            _ => self.below(1 << 24) as f64 / f64::from(1 << 24),
        };
        ((pixel + inside) / side * 2.0 - 1.0).clamp(-1.0, 1.0) as f32
    }
}

/// A point of the rim and its place on the way round.
fn rim(random: &mut Random) -> (u64, f32) {
    (random.below(4), random.coordinate())
}

fn point((edge, t): (u64, f32)) -> Vec4 {
    let [x, y] = match edge {
        0 => [t, -1.0],
        1 => [1.0, t],
        2 => [-t, 1.0],
        _ => [-1.0, -t],
    };
    Vec4::new(x, y, 0.0, 1.0)
}

/// Pixels that a random fan misses or doubles.
fn faults(seed: u64) -> u32 {
    let mut random = Random::new(seed);
    let device = DeviceProfile::ALL[seed as usize % DeviceProfile::ALL.len()].device();
    let centre = Vec4::new(random.coordinate(), random.coordinate(), 0.0, 1.0);
    let spokes = 3 + random.below(8);
    let corners = (0..4).map(|edge| (edge, -1.0));
    let mut stops: Vec<_> = (0..spokes).map(|_| rim(&mut random)).chain(corners).collect();
    stops.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut hits = [0u8; (SIDE * SIDE) as usize];
    let first = random.below(stops.len() as u64) as usize;
    for i in (0..stops.len()).map(|i| (i + first) % stops.len()) {
        let mut corners = [centre, point(stops[i]), point(stops[(i + 1) % stops.len()])];
        corners.rotate_left(random.below(3) as usize);
        if random.below(2) == 0 {
            corners.swap(0, 1);
        }
        let setup = Setup::new(&device, [SIDE; 2], corners);
        setup.cover(&device, [SIDE; 2], Cull::None, |y, first, end| {
            (first..end).for_each(|x| hits[(y * SIDE + x) as usize] += 1);
        });
    }
    hits.iter().filter(|&&h| h != 1).count() as u32
}

fn check(fans: u64) {
    let bad = (0..fans).into_par_iter().find_first(|&seed| faults(seed) > 0);
    assert_eq!(bad, None, "a fan of this seed misses or doubles a pixel");
}

#[test]
fn ten_thousand_fans_neither_double_nor_miss_a_pixel() {
    check(10_000);
}

#[test]
#[ignore = "soak: 10^6 fans, about a minute"]
fn a_million_fans_neither_double_nor_miss_a_pixel() {
    check(1_000_000);
}
