//! A scene: setup, lesson, hints and view.

use box_physics::integrators::Integrator;

use crate::reference::ReferenceSolution;
use crate::setup::Setup;
use crate::view::SceneView;

/// A named scene with its lesson and hints.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// As typed: lower case, hyphens.
    pub id: &'static str,
    /// As shown in a menu.
    pub title: &'static str,
    /// What there is to see, in one or two sentences.
    pub lesson: &'static str,
    /// What to try.
    pub hints: [&'static str; 2],
    /// Body, start, forces, floor, impulses, duration.
    pub setup: Setup,
    /// Ids of the integrators worth comparing here, the interesting one first.
    pub recommended: &'static [&'static str],
    /// How many boxes the game shows: 1, except in scenes about load.
    pub boxes: u32,
    /// Camera and plot.
    pub view: SceneView,
}

impl Scenario {
    /// The reference solution. Computing it may take some milliseconds; looking it up afterwards,
    /// microseconds.
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
