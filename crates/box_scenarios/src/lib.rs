//! Named rigid-body scenes with reference solutions, shared by the tests, the report and the game. Without rendering
//! and without a wall clock.
//!
//! - [`scenario`]: a scene; [`scenes`]: the registry with one function per scene, **where a new scene is added**.
//! - [`scene_file`]: reads and writes scene files; [`view`]: camera and plot of a scene.
//! - [`setup`] and [`forces`]: body, start, forces, floor and impulses of a scene.
//! - [`mod@reference`]: the reference solution: a closed form if there is one, otherwise a fine numerical reference.
//! - [`model`]: a box and everything that acts on it; [`driver`]: steps it bit for bit like the plugin; [`run`]: runs a
//!   whole setup from sample to sample; [`mod@simulate`]: compares it with its reference; [`metrics`]: the errors.
//! - [`live_reference`]: the reference while inputs arrive; [`balance`]: expected energy and angular momentum;
//!   [`runner`]: one integrator with its balance; [`comparison`]: all integrators against one reference.
//! - [`families`]: the motions for which the report compares integrators.
//! - [`mod@hard_cases`]: motions on which integrators fail; [`trend`]: energy over a million steps.
//! - [`mod@contact_cases`]: motions on which contact solvers fail.
//! - [`dissertation`]: the demo of 2012 with its errors.
//! - [`oracle`]: reference trajectories from files.
//! - [`statistics`]: quantiles and orders; [`random`]: a reproducible random generator.
//! - [`mod@style`]: color, dash and marker of each integrator.
//!
//! ```
//! use box_physics::prelude::Integrator;
//! use box_scenarios::Scenario;
//! let scene = Scenario::find("ballistic")?;
//! let reference = scene.reference();
//! let run = box_scenarios::simulate(&scene.setup, &reference, Integrator::Split, 1.0 / 60.0);
//! assert!(run.errors.position < 1e-9);
//! # Ok::<(), box_scenarios::UnknownScenario>(())
//! ```

#![expect(clippy::doc_markdown, reason = "the formulas' subscripts are not code")]

pub mod balance;
pub mod comparison;
pub mod contact_cases;
pub mod dissertation;
pub mod driver;
pub mod families;
pub mod forces;
pub mod hard_cases;
mod limits;
pub mod live_reference;
pub mod metrics;
pub mod model;
pub mod oracle;
pub mod random;
pub mod reference;
pub mod run;
pub mod runner;
pub mod scenario;
pub mod scene_file;
pub mod scenes;
pub mod setup;
pub mod simulate;
pub mod statistics;
pub mod status;
pub mod step_size;
pub mod style;
pub mod trend;
pub mod view;

pub use balance::{Balance, Residual};
pub use comparison::{ComparisonResult, IntegratorComparison, IntegratorResult, Moment};
pub use contact_cases::{ContactCase, contact_cases};
pub use driver::{Driver, Totals};
pub use families::{Family, FamilyRun, Metric, ReferenceTable};
pub use forces::ForceSet;
pub use hard_cases::{HardCase, hard_cases};
pub use live_reference::{Change, LiveReference, Uncertainty};
pub use metrics::{Errors, StateError};
pub use model::Model;
pub use reference::{ReferenceKind, ReferenceSolution};
pub use run::{End, Plan, run_plan};
pub use runner::{Runner, local_error};
pub use scenario::Scenario;
pub use scenes::UnknownScenario;
pub use setup::{FloorSpec, Setup, TimedImpulse};
pub use simulate::{Compared, Comparison, Expected, compare, simulate};
pub use status::{Divergence, Reason, Status};
pub use step_size::parse_step;
pub use style::{Style, style};
pub use view::{Plot, SceneView};
