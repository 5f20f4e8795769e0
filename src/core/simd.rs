//! Run-time choice of the instruction set; the only file with `unsafe`.
//!
//! A kernel is ordinary Rust over slices, written so that the compiler vectorises it. It is compiled
//! once for each [`Level`]; the widest that the machine has is chosen when the program runs. The
//! arithmetic is the same at every level (IEEE operations, no contraction that the kernel does not
//! ask for), so results are bit-identical and the baseline is the arbiter.
#![allow(unsafe_code, reason = "calling a function compiled for a verified instruction set")]

pub mod lanes;

crate::catalogue! {
    /// An instruction set that kernels are compiled for.
    pub enum Level {
        /// What the target guarantees (SSE2 on x86-64, where `floor` is a call).
        Baseline = "baseline",
        /// AVX2 with FMA: eight f32 at a time.
        Avx2 = "avx2",
        /// AVX-512 (F, BW, DQ, VL): sixteen f32 at a time.
        Avx512 = "avx512",
    }
}

impl Level {
    /// Whether this machine can run it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// The widest level of this machine, asked once.
    #[must_use]
    pub fn best() -> Self {
        static BEST: std::sync::OnceLock<Level> = std::sync::OnceLock::new();
        *BEST.get_or_init(|| {
            let mut levels = Self::ALL.iter().rev().copied();
            levels.find(|level| level.is_available()).unwrap_or(Self::Baseline)
        })
    }

    /// Runs `kernel` compiled for this level if that is wider than the baseline. `None` at the
    /// baseline, where the caller has a scalar path: a kernel that is compiled for many types need
    /// not be compiled once more for it.
    ///
    /// # Panics
    /// When the machine lacks the level.
    #[inline]
    pub fn run_wide<K: Kernel>(self, kernel: K) -> Option<K::Output> {
        assert!(self <= Self::best(), "this machine has no {self}");
        match self {
            Self::Baseline => None,
            // SAFETY: `best` has verified every feature that the function is compiled for.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Some(unsafe { run_avx2(kernel) }),
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Some(unsafe { run_avx512(kernel) }),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => unreachable!("never available here"),
        }
    }

    /// Runs scalar work with the instructions of AVX2 where the machine has them (`floor` is one
    /// instruction there, a call at the baseline).
    #[inline]
    pub fn run_scalar<K: Kernel>(kernel: K) -> K::Output {
        match Self::best() {
            Self::Baseline => kernel.run(false),
            // SAFETY: every level above the baseline includes AVX2 and FMA, verified by `best`.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 | Self::Avx512 => unsafe { run_avx2(kernel) },
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => unreachable!("never available here"),
        }
    }

    /// Runs `kernel` compiled for this level.
    ///
    /// # Panics
    /// When the machine lacks the level.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        assert!(self <= Self::best(), "this machine has no {self}");
        match self {
            Self::Baseline => kernel.run(false),
            // SAFETY: `best` has verified every feature that the function is compiled for.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { run_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { run_avx512(kernel) },
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => unreachable!("never available here"),
        }
    }
}

/// Work that gains from wide vectors. `run` and all it calls must be `#[inline(always)]`, so that it
/// is compiled anew inside each level's function.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// Does the work. `has_fma` is a constant of the level: whether `mul_add` is one instruction.
    fn run(self, has_fma: bool) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(true)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sum<'a>(&'a [f32]);

    impl Kernel for Sum<'_> {
        type Output = f32;
        #[inline(always)]
        fn run(self, _: bool) -> f32 {
            self.0.iter().map(|x| (x * 255.0).floor()).sum()
        }
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        let values: Vec<f32> = (0..1000).map(|i| i as f32 / 999.0).collect();
        for &level in Level::ALL.iter().filter(|level| level.is_available()) {
            let sum = level.run(Sum(&values));
            assert_eq!(sum.to_bits(), Level::Baseline.run(Sum(&values)).to_bits(), "{level}");
        }
    }
}
