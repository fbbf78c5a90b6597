//! Rest on planes: its report, and one that moves and carries the box.

use glam::DVec3;

use super::{Plane, PlanesContext};
use crate::body::RigidBox;
use crate::floor::geometry::Corners;
use crate::floor::{ContactReport, ContactState, Floor, FloorContext};
use crate::force::{ForceModel, fingerprint};
use crate::state::BodyState;

/// What a plane that moves is as a floor at the origin.
fn floor_of(plane: &Plane) -> Floor {
    Floor::default().with_velocity(plane.shape.velocity)
}

impl<'a, F> PlanesContext<'a, F> {
    fn over(&self, floor: &'a Floor) -> FloorContext<'a, F> {
        FloorContext {
            floor,
            settings: self.settings,
            body: self.body,
            force: self.force,
        }
    }
}

impl ContactState {
    /// Reports a step of `h` \[s\] at rest.
    pub(super) fn report_rest(
        &self,
        body: &RigidBox,
        state: &BodyState,
        h: f64,
        report: Option<&mut ContactReport>,
    ) {
        if let (Some(report), Some(rest)) = (report, &self.rest) {
            let corners = Corners::at(&Floor::default(), body, state);
            report.normal = rest.planes.map_or(DVec3::Y, |(_, normal)| normal);
            report.hold(state.position, &corners, h, &rest.reaction);
            report.end(state.position, &corners, self.touching);
        }
    }

    /// If the box rests on this plane, which moves, carries it along for `h` \[s\] and returns true. Its height over the
    /// plane stays.
    pub(super) fn rides<F: ForceModel>(
        &mut self,
        context: &PlanesContext<'_, F>,
        plane: &Plane,
        state: &mut BodyState,
        h: f64,
    ) -> bool {
        let floor = floor_of(plane);
        let surface = fingerprint(plane.anywhere().numbers());
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
        let floor = floor_of(plane);
        let surface = fingerprint(plane.anywhere().numbers());
        let planes = Some((surface, plane.shape.normal));
        // In the frame of the plane.
        state.velocity = DVec3::ZERO;
        self.establish_rest(&context.over(&floor), planes, state, 0.0, reaction);
        state.velocity = plane.shape.velocity;
        if let Some(rest) = &mut self.rest {
            rest.above = plane.height(state.position) - plane.rise() * h;
        }
    }
}
