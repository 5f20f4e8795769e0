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

/// A Vogel disk of bilinear comparisons that each pixel turns by its own angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedDisk {
    /// Comparisons.
    pub count: u32,
    /// Its radius in texels; all points lie within.
    pub radius: f32,
    /// Angle from one point to the next.
    pub spacing: f32,
    /// Which way the noise turns it: 1 or −1.
    pub turn: f32,
}

impl TurnedDisk {
    /// vogelDiskSample of three.js r187 under radius 1.
    pub(super) const THREE: Self = Self { count: 5, radius: 1.0, spacing: 2.399_963_3, turn: 1.0 };
    /// get_vogel_disk and sample_directional_pcf_shadow of Godot 4.5 under *Soft Low*.
    pub(super) const GODOT: Self = Self { count: 4, radius: 2.0, spacing: 2.4, turn: -1.0 };

    /// Point `i` at a pixel, in texels, as a shader of highp f32 computes it; sine and cosine are rounded
    /// once, where a GPU's may be off by 2⁻¹¹.
    #[must_use]
    pub fn point(&self, i: u32, pixel: [u32; 2]) -> [f32; 2] {
        let phi = gradient_noise(pixel) * (2.0 * std::f32::consts::PI) * self.turn;
        let r = ((i as f32 + 0.5) / self.count as f32).sqrt();
        let theta = f64::from(i as f32 * self.spacing + phi);
        [libm::cos(theta) as f32 * r * self.radius, libm::sin(theta) as f32 * r * self.radius]
    }
}

/// The interleaved gradient noise of a pixel's centre, in [0, 1): fract(52.9829189·fract(0.06711056·x +
/// 0.00583715·y)), each operation rounded to f32 (Jimenez 2014).
#[must_use]
fn gradient_noise(pixel: [u32; 2]) -> f32 {
    let fract = |x: f32| x - x.floor();
    let [x, y] = pixel.map(|c| c as f32 + 0.5);
    fract(52.982_92 * fract(x * 0.067_110_56 + y * 0.005_837_15))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_disk_is_the_same_disk_at_another_angle() {
        let length = |[x, y]: [f32; 2]| f64::from(x * x + y * y).sqrt();
        for disk in [TurnedDisk::THREE, TurnedDisk::GODOT] {
            for (i, pixel) in (0..disk.count).flat_map(|i| (0..40).map(move |p| (i, [p, 7 * p]))) {
                let r = f64::sqrt((f64::from(i) + 0.5) / f64::from(disk.count));
                let off = length(disk.point(i, pixel)) - r * f64::from(disk.radius);
                assert!(off.abs() < 1e-6, "point {i} is off by {off}");
            }
        }
        let plain = vogel(5, 1.0);
        let [noise, other] = [[3, 4], [4, 4]].map(gradient_noise);
        assert!(noise != other && (0.0..1.0).contains(&noise));
        let angle = f64::from(noise) * 2.0 * std::f64::consts::PI;
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        for (i, [x, y]) in plain.iter().map(|p| p.map(f64::from)).enumerate() {
            let turned = [x * cos - y * sin, x * sin + y * cos];
            let ours = TurnedDisk::THREE.point(i as u32, [3, 4]);
            for axis in 0..2 {
                assert!((turned[axis] - f64::from(ours[axis])).abs() < 1e-5);
            }
        }
    }
}
