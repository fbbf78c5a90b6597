//! Loops that the compiler vectorizes, compiled for more than one instruction set.

/// A loop over plain slices, without a branch.
///
/// Vector and scalar additions, multiplications, divisions, square roots and conversions round identically. Nothing is
/// contracted or reordered, so the result has the same bits on every target.
pub(crate) trait VectorLoop {
    /// Runs the loop. This function and everything it calls must be `#[inline(always)]`: only inlined code is
    /// compiled for the caller's instruction set. Pass the slices as arguments of a separate function, so
    /// that the compiler knows that they do not overlap.
    fn run(self);
}

/// Runs the loop. Uses AVX2 (four f64 at a time) if the processor has it, detected at run time. Otherwise
/// uses the target's baseline, which is two f64 at a time on x86-64.
#[inline]
pub(crate) fn vectorized<L: VectorLoop>(work: L) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        #[expect(unsafe_code, reason = "the same code, compiled for AVX2")]
        // SAFETY: the line above checks that the processor has AVX2.
        return unsafe { with_avx2(work) };
    }
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<L: VectorLoop>(work: L) {
    work.run();
}
