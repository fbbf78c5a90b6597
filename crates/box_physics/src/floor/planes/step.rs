//! One step among several planes: the events of the floor, with the contacts of all planes.

use glam::DVec3;

use super::among::Among;
use super::contacts::{Gaps, PAIRS, PLANES};
use super::{Plane, PlanesContext};
use crate::floor::events::{between_events, give_way};
use crate::floor::frame::Method;
use crate::floor::geometry::corners;
use crate::floor::ground::{BodyStep, Ground, Level};
use crate::floor::{ContactReport, Floor, FloorOutcome};
use crate::force::ForceModel;

/// The step, and the normal forces at the corners \[N\] with the direction of their sum if it ends at rest. It is done in
/// a frame with the velocity `carried` [m/s].
pub(super) fn step<F: ForceModel>(
    context: &PlanesContext<'_, F>,
    planes: &[Plane],
    carried: DVec3,
    method: &Method<F>,
    step: BodyStep<'_>,
) -> (FloorOutcome, Option<([f64; 8], DVec3)>) {
    let BodyStep {
        state,
        h,
        memory,
        contact,
        report,
    } = step;
    let tolerances = planes.iter().map(|plane| context.tolerance(state, plane));
    let tolerance = tolerances.fold(0.0, f64::max);
    let floor = Floor::default().with_velocity(carried);
    let frame = &context.over(&floor);
    let mut seen = [Plane::from(floor); PLANES];
    for (seen, plane) in seen.iter_mut().zip(planes) {
        *seen = plane.seen_from(carried);
    }
    let planes = &seen[..planes.len()];
    frame.to_floor(state, 0.0);
    let among = Among {
        world: Level {
            context: frame,
            method,
            tolerance,
        },
        planes,
    };
    let mut outcome = FloorOutcome::default();
    let mut impulses = ContactReport {
        normal: DVec3::ZERO,
        ..ContactReport::default()
    };
    let mut gaps = Gaps::over(planes, context.body, state, 0.0);
    gaps.leave(planes, state, 0.0);
    let mut step = BodyStep {
        state,
        h,
        memory,
        contact,
        report: Some(&mut impulses),
    };
    let loads = if gaps.lowest() < -tolerance {
        // Planes that leave no room for the box do not hold it.
        gaps = give_way(&among, &mut step, h, &mut outcome);
        None
    } else {
        between_events(&among, &mut step, &mut gaps, h, None, &mut outcome)
    };
    if loads.is_none() {
        gaps.leave(planes, step.state, h);
    }
    let now = corners::<PAIRS>(gaps.touching(2.0 * tolerance));
    step.contact.touching = now;
    frame.to_world(step.state, h);
    let lowest = among.normal(gaps.deepest().0);
    let direction = impulses.normal.try_normalize().unwrap_or(lowest);
    if let Some(report) = report {
        impulses.end(state.position, &gaps, now);
        impulses.normal = direction;
        *report = impulses;
    }
    (outcome, loads.map(|loads| (loads, direction)))
}
