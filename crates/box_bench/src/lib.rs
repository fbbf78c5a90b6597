//! Measuring what a step costs: [`measure::interleaved`] times several contenders in one run, so that a
//! noisy machine disturbs all of them alike. Benchmarks, report and game measure with it.
//!
//! The benchmarks (`cargo bench`, or one of them by `--bench NAME`) are [`suites`]: each returns rows,
//! which are printed, and written as JSON with `--json FILE`. What the plugin is compared with is defined
//! here too: the [`bare`] loop over plain arrays, and the [`memory`] bound, a pass over the same bytes.

pub mod bare;
pub mod bodies;
pub mod contact_scenes;
pub mod document;
pub mod measure;
pub mod memory;
pub mod options;
pub mod plugin_world;
pub mod rows;
pub mod snapshot;
pub mod suites;
pub mod targets;
