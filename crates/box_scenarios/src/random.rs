//! A small random generator, so that every run on every machine uses the same boxes.

use box_physics::math::exp;
use glam::DVec3;

/// Marsaglia's xorshift64* (*Xorshift RNGs*, J. Stat. Software 8, 2003).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Creates a generator from a seed; 0 is replaced by 1.
    pub fn new(seed: u64) -> Self {
        Self(seed.max(1))
    }

    /// A number uniformly distributed in [`low`, `high`).
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        low + (high - low) * (bits as f64 / (1_u64 << 53) as f64)
    }

    /// A number between `low` and `high` whose logarithm is uniformly distributed.
    pub fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        exp(self.range(libm::log(low), libm::log(high)))
    }

    /// A vector with each component uniformly distributed in [−`size`, `size`).
    pub fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::from_array(core::array::from_fn(|_| self.range(-size, size)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_uniform_and_repeat() {
        let sample = |seed| {
            let mut random = Random::new(seed);
            (0..10_000)
                .map(|_| random.range(-1.0, 3.0))
                .collect::<Vec<_>>()
        };
        let a = sample(7);
        assert_eq!(a, sample(7));
        assert_ne!(a, sample(8));
        assert!(a.iter().all(|x| (-1.0..3.0).contains(x)));
        // The mean of n uniform numbers has the standard deviation 4/√(12 n) = 0.012.
        let mean = a.iter().sum::<f64>() / a.len() as f64;
        assert!((mean - 1.0).abs() < 0.05, "{mean}");
        let lower = a.iter().filter(|x| **x < 0.0).count();
        assert!((2300..2700).contains(&lower), "{lower}");
    }
}
