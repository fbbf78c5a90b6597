//! Measuring what a step costs: [`measure::interleaved`] times several contenders in one run, so that a
//! noisy machine disturbs all of them alike. Benchmarks, report and game measure with it.

pub mod measure;
