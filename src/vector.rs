//! The widest vector unit of the machine, for inner loops.

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use pulp::Arch;

/// The vector unit that the whole module is compiled for: WebAssembly has no detection, and copies of the loops
/// for other units would double its size.
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
