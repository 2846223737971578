//! The widest vector unit of the machine, for inner loops, and extremes that it computes.

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

#[cfg(not(target_arch = "wasm32"))]
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

/// By comparisons: `f32::max` calls a function in WebAssembly, so that no loop with it is vectorised.
#[cfg(target_arch = "wasm32")]
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
