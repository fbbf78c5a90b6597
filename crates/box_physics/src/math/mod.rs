//! Elementary functions that give the same bits everywhere.
//!
//! The standard library's `sin`, `cos` and `exp` call the platform's C library, and so does glam. Two
//! machines may therefore disagree in the last bit, and their simulations soon diverge. A step uses only
//! additions, multiplications, divisions and square roots, which IEEE 754 defines to the last bit. Where
//! speed does not matter it also uses the `libm` crate (pure Rust). It uses no fused multiply-add.

mod exponential;
mod trigonometry;
mod vectors;

pub use exponential::{Exponential, exp};
pub(crate) use trigonometry::SmallArguments;
pub use trigonometry::{AnyArgument, Trigonometry, sin_cos, sinc_cos};
pub(crate) use vectors::{VectorLoop, vectorized};
