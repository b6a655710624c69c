//! Which instructions of the processor a batch uses, chosen when it runs.

#[cfg(target_arch = "x86_64")]
use crate::lanes::avx2;
#[cfg(avx512)]
use crate::lanes::avx512;
use crate::lanes::{Four, Two, Wide};

/// Instructions that this processor has. All give the same bits; they differ in speed only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instructions(Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(avx512)]
    Avx512,
}

impl Instructions {
    /// All that this processor has, the fastest first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut kinds = Vec::new();
        #[cfg(avx512)]
        if avx512::available() {
            kinds.push(Kind::Avx512);
        }
        #[cfg(target_arch = "x86_64")]
        if avx2::available() {
            kinds.push(Kind::Avx2);
        }
        kinds.push(Kind::Portable);
        kinds.into_iter().map(Self).collect()
    }

    /// The fastest.
    #[must_use]
    pub fn fastest() -> Self {
        Self::available()[0]
    }

    /// `avx512`, `avx2` or `portable`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            #[cfg(avx512)]
            Kind::Avx512 => "avx512",
        }
    }

    /// How many runs go through the step together where four vectors do.
    #[must_use]
    pub fn lanes(self) -> usize {
        4 * match self.0 {
            Kind::Portable => 1,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => avx2::Four::WIDTH,
            #[cfg(avx512)]
            Kind::Avx512 => avx512::Eight::WIDTH,
        }
    }
}

/// A computation in lanes, compiled for each kind of instructions.
pub(crate) trait Kernel {
    /// What it gives.
    type Output;

    /// Computes with numbers `V` that hold `N` runs side by side. Has to be inlined.
    fn run<V: Wide, const N: usize>(self) -> Self::Output;
}

impl Instructions {
    /// Runs a kernel on four vectors at once, which hide the latency of its chain.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Kind::Portable => kernel.run::<Four<f64>, 4>(),
            // SAFETY: `Instructions` are made only for a processor that has them.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Kind::Avx2 => unsafe { with_avx2::<_, Four<avx2::Four>, 16>(kernel) },
            #[cfg(avx512)]
            #[allow(unsafe_code)]
            Kind::Avx512 => unsafe { with_avx512::<_, Four<avx512::Eight>, 32>(kernel) },
        }
    }

    /// Runs a kernel that handles very many numbers on two vectors at once: with four, they do not
    /// fit the processor's nearest cache, which takes half as long again.
    pub(crate) fn run_large<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Kind::Portable => kernel.run::<Two<f64>, 2>(),
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Kind::Avx2 => unsafe { with_avx2::<_, Two<avx2::Four>, 8>(kernel) },
            #[cfg(avx512)]
            #[allow(unsafe_code)]
            Kind::Avx512 => unsafe { with_avx512::<_, Two<avx512::Eight>, 16>(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[allow(unsafe_code)]
unsafe fn with_avx2<K: Kernel, V: Wide, const N: usize>(kernel: K) -> K::Output {
    kernel.run::<V, N>()
}

#[cfg(avx512)]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
#[allow(unsafe_code)]
unsafe fn with_avx512<K: Kernel, V: Wide, const N: usize>(kernel: K) -> K::Output {
    kernel.run::<V, N>()
}
