//! Several planes as a [`Ground`]: a place for each corner over each plane, in world axes. Place 8j + k is corner k over
//! plane j.

use glam::DVec3;

use super::{Plane, PlanesContext};
use crate::floor::bounds::curvature_bound;
use crate::floor::events::{between_events, give_way};
use crate::floor::frame::{Frame, Level, Method};
use crate::floor::geometry::{Places, each, has};
use crate::floor::ground::{BodyStep, Ground};
use crate::floor::operator::DelassusOperator;
use crate::floor::projection::cancel_iteratively;
use crate::floor::{ContactReport, Floor, FloorOutcome};
use crate::force::ForceModel;
use crate::state::BodyState;

/// Maximum number of planes within reach: a closed box has six.
pub(super) const PLANES: usize = 6;
const PLACES: usize = 8 * PLANES;

/// One vector per place.
type Each = [DVec3; PLACES];

/// The corners over all planes.
pub(in crate::floor) type Gaps = Places<PLACES>;

/// A body in contact with several planes.
pub(super) struct Among<'a, F> {
    /// A floor at rest without effect.
    pub(super) world: Level<'a, F>,
    pub(super) planes: &'a [Plane],
}

impl<F: ForceModel> Among<'_, F> {
    fn over_all(&self, f: impl Fn(&Plane) -> f64) -> f64 {
        self.planes.iter().map(f).fold(0.0, f64::max)
    }
}

/// Takes one step among planes, like one over the floor but with all contacts, in a frame with the velocity `carried`
/// [m/s]. Returns the normal forces at the corners \[N\] and the direction of their sum if it ends at rest.
pub(super) fn step<F: ForceModel>(
    context: &PlanesContext<'_, F>,
    planes: &[Plane],
    carried: DVec3,
    method: &Method<F>,
    step: BodyStep<'_>,
) -> (FloorOutcome, Option<([f64; 8], DVec3)>) {
    let h = step.h;
    let tolerances = planes.iter().map(|p| context.tolerance(step.state, p));
    let tolerance = tolerances.fold(0.0, f64::max);
    let frame = Frame::new(carried, None);
    frame.to_surface(step.state, 0.0);
    let floor = Floor::default();
    let world = context.over(&floor);
    let mut seen = [Plane::from(floor); PLANES];
    for (seen, plane) in seen.iter_mut().zip(planes) {
        *seen = plane.seen_from(carried);
    }
    let among = Among {
        world: Level {
            tolerance,
            ..Level::new(&world, method, frame)
        },
        planes: &seen[..planes.len()],
    };
    let mut outcome = FloorOutcome::default();
    let mut impulses = ContactReport {
        normal: DVec3::ZERO,
        ..ContactReport::default()
    };
    let mut gaps = among.places(step.state, 0.0);
    among.recover(step.state, &mut gaps, 0.0);
    let report = step.report;
    let mut step = BodyStep {
        report: Some(&mut impulses),
        ..step
    };
    let loads = if gaps.lowest() < -tolerance {
        // If the planes leave no room for the box, they do not hold it.
        gaps = give_way(&among, &mut step, h, &mut outcome);
        None
    } else {
        between_events(&among, &mut step, &mut gaps, h, None, &mut outcome)
    };
    if loads.is_none() {
        among.recover(step.state, &mut gaps, h);
    }
    among.world.frame.to_world(step.state, h);
    let now = gaps.touching(2.0 * tolerance);
    let now = (0..PLANES).fold(0, |set, j| set | (now >> (8 * j)) as u8);
    step.contact.touching = now;
    let center = step.state.position;
    let lowest = among.normal(gaps.deepest().0);
    let direction = impulses.normal.try_normalize().unwrap_or(lowest);
    if let Some(report) = report {
        impulses.end(|k| center + gaps.lever(k), now);
        impulses.normal = direction;
        *report = impulses;
    }
    (outcome, loads.map(|loads| (loads, direction)))
}

impl<F: ForceModel> Ground<PLACES> for Among<'_, F> {
    type Force = F;
    type Held = ();
    const MAX_EVALUATIONS: u64 = 4_000;

    fn level(&self) -> &Level<'_, F> {
        &self.world
    }

    fn order(places: u64) -> (usize, [u8; PLACES]) {
        let (mut count, mut order) = (0, [0; PLACES]);
        for i in each(places) {
            order[count] = i as u8;
            count += 1;
        }
        (count, order)
    }

    fn normal(&self, k: usize) -> DVec3 {
        self.planes[k / 8].shape.normal
    }

    fn surface(&self, k: usize) -> &Floor {
        &self.planes[k / 8].surface
    }

    fn drift(&self, k: usize) -> DVec3 {
        self.surface(k).velocity
    }

    fn is_fixed(&self) -> bool {
        let mut velocities = self.planes.iter().map(|plane| plane.surface.velocity);
        velocities.all(|v| v == DVec3::ZERO)
    }

    fn shift(&self, gaps: &mut Gaps, state: &BodyState, elapsed: f64) {
        for (j, plane) in self.planes.iter().enumerate() {
            let base = plane.height(state.position) - plane.rise() * elapsed;
            for k in 0..8 {
                gaps.height[8 * j + k] = base + plane.shape.normal.dot(gaps.lever(k));
            }
        }
    }

    fn normal_velocities(&self, twist: (DVec3, DVec3), gaps: &Gaps) -> [f64; PLACES] {
        let mut speed = [0.0; PLACES];
        for i in 0..8 * self.planes.len() {
            speed[i] = self.normal(i).dot(self.relative(i, gaps, twist));
        }
        speed
    }

    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64 {
        let (body, pull) = (self.world.context.body, self.world.pull);
        self.over_all(|plane| curvature_bound(body, state, acceleration, pull, plane.shape.normal))
    }

    fn height(&self, center: DVec3) -> f64 {
        self.over_all(|plane| plane.height(center))
    }

    /// Treats each plane twice, because the second may restore an approach to the first.
    fn separate(&self, state: &mut BodyState) {
        for plane in self.planes.iter().chain(self.planes) {
            let normal = plane.shape.normal;
            let approach = (state.velocity - plane.surface.velocity).dot(normal);
            state.velocity -= normal * approach.min(0.0);
        }
    }

    /// Returns `true` if no plane moves and the held corners are not on one line, about which the body could turn.
    fn supports(&self, gaps: &Gaps, held: u64) -> bool {
        let Some(first) = each(held).next() else {
            return false;
        };
        let arm = |i: usize| gaps.lever(i) - gaps.lever(first);
        let longer = |a: DVec3, b: DVec3| {
            if b.length_squared() > a.length_squared() {
                b
            } else {
                a
            }
        };
        let far = each(held).map(arm).fold(DVec3::ZERO, longer);
        let least = 1e-3 * far.length_squared();
        self.is_fixed() && each(held).any(|i| far.cross(arm(i)).length() > least)
    }

    fn cancel(&self, operator: &DelassusOperator<PLACES>, u: &Each, whole: u64) -> Each {
        cancel_iteratively(operator, u, |i, v| {
            let place = usize::from(operator.place[i]);
            let normal = self.normal(place);
            if has(whole, place) {
                v
            } else {
                normal * normal.dot(v)
            }
        })
    }

    /// Newton's method on the heights.
    fn project(&self, state: &mut BodyState, held: u64, elapsed: f64) -> (Gaps, ()) {
        let mut gaps = self.places(state, elapsed);
        let scale = self.world.context.body.radius() + state.position.abs().max_element();
        for _ in 0..3 {
            let worst = each(held).fold(0.0, |a: f64, i| a.max(gaps.height[i].abs()));
            if worst <= 4.0 * f64::EPSILON * scale {
                break;
            }
            self.lower(state, held, &gaps.height);
            gaps = self.places(state, elapsed);
        }
        (gaps, ())
    }
}
