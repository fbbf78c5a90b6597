//! Cost measurements of a step. [`measure::interleaved`] times several contenders in one run, so that a noisy machine
//! affects them equally. Benchmarks, report and game use it.
//!
//! The benchmarks (`cargo bench`, or one of them by `--bench NAME`) are [`suites`]. Each returns rows, which
//! are printed, and written as JSON with `--json FILE`. This crate also defines the baselines of the plugin:
//! the [`bare`] loop over plain arrays, and the [`memory`] bound, a pass over the same bytes.

pub mod bare;
pub mod bodies;
pub mod contact_scenes;
pub mod document;
pub mod machine;
pub mod measure;
pub mod memory;
pub mod options;
pub mod plugin_world;
pub mod rows;
pub mod snapshot;
pub mod suites;
pub mod targets;
