//! The widest vector unit of the machine, for inner loops, and operations that it computes.

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use pulp::Arch;

/// The vector unit that the whole module is compiled for: WebAssembly has no detection, and copies of the
/// loops for other units would double its size.
#[cfg(target_arch = "wasm32")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arch;

#[cfg(target_arch = "wasm32")]
impl Arch {
    pub(crate) const fn new() -> Self {
        Self
    }

    #[inline]
    pub(crate) fn dispatch<Op: pulp::NullaryFnOnce>(self, op: Op) -> Op::Output {
        op.call()
    }
}

/// The greater and the lesser of two numbers. The argument must not be NaN; if the receiver is, the result is
/// the argument.
pub(crate) trait Extremes {
    fn at_least(self, least: Self) -> Self;
    fn at_most(self, most: Self) -> Self;
}

#[cfg(target_arch = "aarch64")]
impl Extremes for f32 {
    #[inline(always)]
    fn at_least(self, least: Self) -> Self {
        self.max(least)
    }

    #[inline(always)]
    fn at_most(self, most: Self) -> Self {
        self.min(most)
    }
}

/// By comparisons, which are single instructions on x86. There `f32::max` takes three, as it has to return
/// the number if either is NaN; in WebAssembly it calls a function, so that no loop with it is vectorised.
#[cfg(not(target_arch = "aarch64"))]
impl Extremes for f32 {
    #[inline(always)]
    fn at_least(self, least: Self) -> Self {
        if self > least { self } else { least }
    }

    #[inline(always)]
    fn at_most(self, most: Self) -> Self {
        if self < most { self } else { most }
    }
}

/// `self` * `factor` + `addend`.
pub(crate) trait Fused {
    fn times_plus(self, factor: Self, addend: Self) -> Self;
}

/// Rounded once, in one instruction of the vector units that [`Arch`] finds.
#[cfg(not(target_arch = "wasm32"))]
impl Fused for f32 {
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
}

/// WebAssembly has no such instruction.
#[cfg(target_arch = "wasm32")]
impl Fused for f32 {
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
}
