//! Disks of points around a look-up, in texels.

use std::sync::OnceLock;

/// Radius of the disks of sixteen, in texels.
pub(super) const DISK: f64 = 2.0;

/// Vogel's disk: point i of n at radius √((i + ½)/n) and i golden angles.
fn vogel(n: u32, radius: f64) -> Vec<[f32; 2]> {
    let golden = std::f64::consts::PI * (3.0 - f64::sqrt(5.0));
    let point = |i: u32| {
        let r = f64::sqrt((f64::from(i) + 0.5) / f64::from(n)) * radius;
        let angle = f64::from(i) * golden;
        [(r * libm::cos(angle)) as f32, (r * libm::sin(angle)) as f32]
    };
    (0..n).map(point).collect()
}

/// Five points within a texel.
pub(super) fn vogel5() -> &'static [[f32; 2]] {
    static POINTS: OnceLock<Vec<[f32; 2]>> = OnceLock::new();
    POINTS.get_or_init(|| vogel(5, 1.0))
}

/// Sixteen points.
pub(super) fn vogel16() -> &'static [[f32; 2]] {
    static POINTS: OnceLock<Vec<[f32; 2]>> = OnceLock::new();
    POINTS.get_or_init(|| vogel(16, DISK))
}

/// Sixteen points no closer than 0.38 radii, thrown with a fixed seed.
pub(super) fn poisson16() -> &'static [[f32; 2]] {
    static POINTS: OnceLock<Vec<[f32; 2]>> = OnceLock::new();
    POINTS.get_or_init(|| {
        let mut seed: u64 = 1;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1u32 << 23) - 1.0
        };
        let mut points: Vec<[f64; 2]> = Vec::new();
        let mut distance = 0.38;
        while points.len() < 16 {
            for _ in 0..10_000 {
                let p = [random(), random()];
                let apart = |q: &[f64; 2]| {
                    let d = [p[0] - q[0], p[1] - q[1]];
                    d[0] * d[0] + d[1] * d[1] >= distance * distance
                };
                let inside = p[0] * p[0] + p[1] * p[1] <= 1.0;
                if inside && points.len() < 16 && points.iter().all(apart) {
                    points.push(p);
                }
            }
            distance *= 0.9;
        }
        points.iter().map(|p| p.map(|c| (c * DISK) as f32)).collect()
    })
}
