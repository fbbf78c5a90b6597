//! Moving planes that carry a box at rest.

use glam::{DMat3, DVec3};

use super::{Plane, PlanesContext, reach};
use crate::floor::{ContactState, Floor, FloorContext};
use crate::force::{ForceModel, fingerprint};
use crate::state::BodyState;

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

impl<F: ForceModel> PlanesContext<'_, F> {
    /// A fingerprint of planes with a common velocity and of the touched set, `elapsed` \[s\] after the start of the
    /// step, independent of position. Also returns the correction onto the touched planes \[m\].
    pub(super) fn support(
        &self,
        planes: &[Plane],
        state: &BodyState,
        elapsed: f64,
    ) -> (u64, DVec3) {
        let attitude = DMat3::from_quat(state.rotation);
        let mut back = DVec3::ZERO;
        let numbers = planes.iter().flat_map(|plane| {
            let normal = plane.shape.normal;
            let height = plane.height(state.position) - plane.rise() * elapsed;
            let gap = height - reach(self.body, &attitude, normal);
            let touches = gap.abs() <= 2.0 * self.tolerance(state, plane);
            if touches {
                back -= normal * gap;
            }
            let numbers = plane.anywhere().numbers();
            numbers.chain([f64::from(u8::from(touches))])
        });
        (fingerprint(numbers), back)
    }
}

impl ContactState {
    /// Moves a box at rest on these planes, with this velocity [m/s], for `h` \[s\]; `false` if it is not at rest.
    pub(super) fn rides<F: ForceModel>(
        &mut self,
        context: &PlanesContext<'_, F>,
        planes: &[Plane],
        velocity: DVec3,
        state: &mut BodyState,
        h: f64,
    ) -> bool {
        if !self.is_resting(state) {
            return false;
        }
        let floor = Floor::default().with_velocity(velocity);
        let (on, back) = context.support(planes, state, 0.0);
        if !self.still_rests(&context.over(&floor), Some(on), state) {
            return false;
        }
        if velocity != DVec3::ZERO {
            state.position += velocity * h + back;
        }
        if let Some(rest) = &mut self.rest {
            rest.position = state.position;
        }
        true
    }
}
