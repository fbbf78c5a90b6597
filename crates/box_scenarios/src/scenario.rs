//! A scene: setup, lesson, hints and view.

use box_physics::integrators::Integrator;

use crate::reference::ReferenceSolution;
use crate::setup::Setup;
use crate::view::SceneView;

/// A named scene with its lesson and hints.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Identifier: lower case with hyphens.
    pub id: &'static str,
    /// Title in the menu.
    pub title: &'static str,
    /// Description of what the scene shows, in one or two sentences.
    pub lesson: &'static str,
    /// Suggestions for the user. The game turns the name of a control in brackets into a button: `[Restart]`,
    /// `[Gravity 1.62]`.
    pub hints: [&'static str; 2],
    /// Body, start, forces, floor, impulses, duration.
    pub setup: Setup,
    /// Ids of the integrators worth comparing here, the most interesting one first.
    pub recommended: &'static [&'static str],
    /// Number of boxes in the game; 1, except in load tests.
    pub boxes: u32,
    /// Camera and plot.
    pub view: SceneView,
}

impl Scenario {
    /// The reference solution. Computing it may take some milliseconds; evaluating it takes microseconds.
    pub fn reference(&self) -> ReferenceSolution {
        self.setup.reference()
    }

    /// The integrators worth comparing here.
    pub fn recommended(&self) -> Vec<Integrator> {
        self.recommended
            .iter()
            .filter_map(|id| id.parse().ok())
            .collect()
    }
}
