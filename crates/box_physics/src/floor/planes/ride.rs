//! A plane that moves and carries a box at rest.

use super::{Plane, PlanesContext};
use crate::floor::{ContactState, Floor, FloorContext};
use crate::force::{ForceModel, fingerprint};
use crate::state::BodyState;

/// What a plane that moves is to the memory of a box that rests on it, wherever it is: a floor at the origin.
fn floor_of(plane: &Plane) -> (Floor, u64) {
    let floor = Floor::default().with_velocity(plane.shape.velocity);
    (floor, fingerprint(plane.anywhere().numbers()))
}

impl<'a, F> PlanesContext<'a, F> {
    pub(super) fn over(&self, floor: &'a Floor) -> FloorContext<'a, F> {
        FloorContext {
            floor,
            settings: self.settings,
            body: self.body,
            force: self.force,
        }
    }
}

impl ContactState {
    /// If the box rests on this plane, which moves, carries it along for `h` \[s\] and returns true. Its height over the
    /// plane stays.
    pub(super) fn rides<F: ForceModel>(
        &mut self,
        context: &PlanesContext<'_, F>,
        plane: &Plane,
        state: &mut BodyState,
        h: f64,
    ) -> bool {
        let (floor, surface) = floor_of(plane);
        if !self.still_rests(&context.over(&floor), Some(surface), state) {
            return false;
        }
        let Some(rest) = &mut self.rest else {
            return false;
        };
        let off = plane.height(state.position) - rest.above;
        if off.abs() > context.tolerance(state, plane) {
            return false;
        }
        state.position += plane.shape.velocity * h - plane.shape.normal * off;
        rest.position = state.position;
        true
    }

    /// Remembers that the box is at rest on this plane, which moves, at the end of a step of `h` \[s\].
    pub(super) fn rest_on<F: ForceModel>(
        &mut self,
        context: &PlanesContext<'_, F>,
        plane: &Plane,
        state: &mut BodyState,
        h: f64,
        reaction: [f64; 8],
    ) {
        let (floor, surface) = floor_of(plane);
        let planes = Some((surface, plane.shape.normal));
        state.velocity = plane.shape.velocity;
        self.establish_rest(&context.over(&floor), planes, state, 0.0, reaction);
        if let Some(rest) = &mut self.rest {
            rest.above = plane.height(state.position) - plane.rise() * h;
        }
    }
}
