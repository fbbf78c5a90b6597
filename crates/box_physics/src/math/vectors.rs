//! Loops that the compiler turns into vector instructions, compiled for more than one instruction set.

/// A loop over plain slices, without a branch.
///
/// Vector and scalar additions, multiplications, divisions, square roots and conversions round alike, and
/// nothing is contracted or reordered: the result has the same bits whatever it was compiled for.
pub(crate) trait VectorLoop {
    /// Runs it. Must be `#[inline(always)]`, and all that it calls: only what is inlined is compiled for
    /// the instruction set of the caller. Best hand the slices on as the arguments of a function of their
    /// own, so that the compiler knows that they do not overlap.
    fn run(self);
}

/// Runs the loop: compiled for AVX2 (four f64 at a time) where the processor has it, which is asked at run
/// time; elsewhere for what every x86-64 has (two at a time), or what the target has.
#[inline]
pub(crate) fn vectorized<L: VectorLoop>(work: L) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the same code, compiled for AVX2")]
        // SAFETY: the processor has AVX2, as was asked in the line above.
        return unsafe { with_avx2(work) };
    }
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<L: VectorLoop>(work: L) {
    work.run();
}
