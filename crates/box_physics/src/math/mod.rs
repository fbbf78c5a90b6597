//! Elementary functions that give the same bits everywhere.
//!
//! The standard library's `sin`, `cos` and `exp` call the platform's C library, and glam's use them
//! too, so two machines may disagree in the last bit and a simulation with them soon altogether.
//! Inside a step only these are used: additions, multiplications, divisions and square roots, which
//! IEEE 754 defines to the last bit, and the `libm` crate (pure Rust) where speed does not matter.
//! There is no fused multiply-add.

mod exponential;
mod trigonometry;
mod vectors;

pub use exponential::{Exponential, exp};
pub(crate) use trigonometry::SmallArguments;
pub use trigonometry::{AnyArgument, Trigonometry, sin_cos, sinc_cos};
pub(crate) use vectors::{VectorLoop, vectorized};
