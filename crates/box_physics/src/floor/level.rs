//! The floor as a [`Ground`]: eight corners, all with the normal +y, in the frame in which the floor is at rest.

use glam::{DMat3, DVec3};

use super::bounds::curvature_bound;
use super::cone::{Blocks, Cone};
use super::frame::Level;
use super::geometry::{Corner3, Corners, each, has, in_pairs, spans_face};
use super::ground::{BodyStep, Ground, Segment};
use super::law::{Law, answered};
use super::operator::DelassusOperator;
use super::projection::{HeldNormals, cancel};
use super::slide::slide;
use super::{Floor, FloorOutcome};
use crate::force::ForceModel;
use crate::integrators::StepOutcome;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

impl<F: ForceModel> Ground<8> for Level<'_, F> {
    type Force = F;
    type Held = HeldNormals;
    const MAX_EVALUATIONS: u64 = 40_000;

    fn level(&self) -> &Level<'_, F> {
        self
    }

    fn order(places: u64) -> (usize, [u8; 8]) {
        in_pairs(places as u8)
    }

    #[inline(always)]
    fn normal(&self, _: usize) -> DVec3 {
        DVec3::Y
    }

    fn surface(&self, _: usize) -> &Floor {
        self.context.floor
    }

    fn shift(&self, corners: &mut Corners, state: &BodyState, _: f64) {
        let base = state.position.y - self.context.floor.height;
        corners.height = core::array::from_fn(|k| base + corners.lever(k).y);
    }

    fn normal_velocities(&self, (v, omega): (DVec3, DVec3), corners: &Corners) -> [f64; 8] {
        core::array::from_fn(|k| v.y + omega.cross(corners.lever(k)).y)
    }

    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64 {
        curvature_bound(self.context.body, state, acceleration, self.pull, DVec3::Y)
    }

    #[inline]
    fn slide(
        &self,
        step: &mut BodyStep<'_>,
        remaining: f64,
        touching: u64,
        outcome: &mut FloorOutcome,
    ) -> Option<f64> {
        if touching.count_ones() != 4 {
            return None;
        }
        let before = step.state.velocity;
        let slide = slide(self, step.state, remaining, touching as u8)?;
        outcome.step += StepOutcome::plain(slide.evaluations);
        if let Some(report) = &mut step.report {
            let end = step.h - (remaining - slide.time);
            let corners = self.places(step.state, end);
            let point = |k| self.point(step.state, &corners, k, end);
            report.hold(point, slide.time, &slide.load);
            let change = step.state.velocity - before - self.pull * slide.time;
            report.tangential_impulse += self.context.body.mass() * self.along(0, change);
        }
        Some(slide.time)
    }

    fn height(&self, center: DVec3) -> f64 {
        center.y - self.context.floor.height
    }

    fn separate(&self, state: &mut BodyState) {
        state.velocity.y = state.velocity.y.max(0.0);
    }

    fn supports(&self, _: &Corners, held: u64) -> bool {
        spans_face(held as u8)
    }

    fn blocks(&self, operator: &DelassusOperator) -> Blocks {
        Blocks::of(operator)
    }

    fn direct(
        &self,
        law: &Law<'_, Self, 8>,
        (b, near): (&Corner3, &Corner3),
        target: f64,
        p: &mut Corner3,
    ) -> Option<()> {
        let friction = law.surface(0).1;
        if friction == 0.0 {
            answered("frictionless");
            *p = law.smooth(b);
            return Some(());
        }
        let cone = Cone {
            operator: law.operator,
            friction,
            target,
        };
        cone.solve(&law.blocks, b, near, p)
    }

    fn cancel(&self, operator: &DelassusOperator, u: &Corner3, whole: u64) -> Corner3 {
        let whole = operator.place.map(|k| has(whole, usize::from(k)));
        cancel(operator, u, &whole)
    }

    fn project(&self, state: &mut BodyState, held: u64, _: f64) -> (Corners, HeldNormals) {
        let body = self.context.body;
        let mut normals = HeldNormals::new(held as u8);
        let mut round = 0;
        loop {
            let attitude = DMat3::from_quat(state.rotation);
            let mut corners = Corners::turned(body, attitude);
            self.shift(&mut corners, state, 0.0);
            let height = corners.height;
            let worst = each(held).fold(0.0, |a: f64, k| a.max(height[k].abs()));
            let rounding = 4.0 * f64::EPSILON * (self.radius + state.position.y.abs());
            normals.turn(body, &attitude);
            if round == 3 || worst <= rounding {
                return (corners, normals);
            }
            if round > 0 && normals.count == 1 {
                // The remaining height of one corner is of second order and needs no rotation.
                state.position.y -= height[usize::from(normals.corner[0])];
            } else if let Some((_, shift, turn)) = normals.stop(body, |k| height[k]) {
                state.position.y += shift * body.inverse_mass();
                let turn = turn * body.inverse_inertia();
                if turn != DVec3::ZERO {
                    state.rotation = compose(state.rotation, exponential_map(turn));
                    state.renormalize();
                }
            } else {
                self.lower(state, held, &height);
            }
            round += 1;
        }
    }

    fn stop(&self, segment: &mut Segment<8>, normals: &HeldNormals, after: &Corner3) -> bool {
        let body = self.context.body;
        let Some((p, sum, torque)) = normals.stop(body, |k| after[k].y) else {
            return false;
        };
        segment.state.velocity.y += sum * body.inverse_mass();
        segment.state.angular_momentum += torque;
        for i in 0..normals.count {
            segment.impulse[usize::from(normals.corner[i])].y += p[i];
        }
        true
    }
}
