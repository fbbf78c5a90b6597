//! The floor as a [`Ground`]: eight corners, all with the normal +y, in the frame in which the floor is at rest.

use glam::{DMat3, DVec3};

use super::Floor;
use super::bounds::{curvature_bound, normal_velocities};
use super::cone::Cone;
use super::geometry::{Corner3, Corners, has, in_pairs, spans_face};
use super::ground::{Ground, Level, Segment, Touching, Way};
use super::newton::CoulombLaw;
use super::operator::DelassusOperator;
use super::projection::{HeldNormals, cancel, project_positions, recover_penetration};
use crate::force::ForceModel;
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

    #[inline(always)]
    fn drift(&self, _: usize) -> DVec3 {
        DVec3::ZERO
    }

    fn is_fixed(&self) -> bool {
        true
    }

    fn places(&self, state: &BodyState, _: f64) -> Corners {
        Corners::at(self.context.floor, self.context.body, state)
    }

    fn recover(&self, state: &mut BodyState, corners: &mut Corners, _: f64) {
        recover_penetration(self.context.floor, state, corners);
    }

    fn normal_velocities(&self, state: &BodyState, corners: &Corners) -> [f64; 8] {
        normal_velocities(self.context.body, state, corners)
    }

    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64 {
        let (body, force) = (self.context.body, self.context.force);
        curvature_bound(body, state, acceleration, force, DVec3::Y)
    }

    fn height(&self, center: DVec3) -> f64 {
        center.y - self.context.floor.height
    }

    fn law<'a>(&'a self, operator: &'a DelassusOperator, grips: bool) -> impl CoulombLaw<8> + 'a {
        let floor = self.context.floor;
        let friction = if grips { floor.grip() } else { floor.friction };
        Cone::new(operator, friction, self.context.settings)
    }

    fn way(&self, at: &Touching<8>, solutions: [&Corner3; 2]) -> Way {
        let ((v, omega), operator) = (at.twist, at.operator);
        let [first, last] = solutions.map(|p| operator.resultant(p));
        let way = (last.0 - first.0, last.1 - first.1);
        let (dv, dw) = operator.twist_of(first);
        let (av, aw) = operator.twist_of(way);
        let a = 0.5 * (way.0.dot(av) + way.1.dot(aw));
        let b = way.0.dot(v + dv) + way.1.dot(omega + dw);
        let lost = first.0.dot(v + 0.5 * dv) + first.1.dot(omega + 0.5 * dw);
        let gained = a + b + lost;
        Way { a, b, lost, gained }
    }

    fn on_faces(&self, touching: u64) -> u64 {
        if spans_face(touching as u8) {
            touching
        } else {
            0
        }
    }

    fn strike(
        &self,
        state: &mut BodyState,
        at: &Touching<8>,
        p: &Corner3,
        stopped: u64,
    ) -> Corner3 {
        let operator = at.operator;
        let mut p = *p;
        if stopped != 0 {
            let held = cancel(operator, &operator.after(&at.before, &p), &[DVec3::Y; 8]);
            for i in 0..operator.count {
                p[i] += held[i];
            }
        }
        operator.apply(state, &p);
        operator.by_place(&p)
    }

    fn slips(&self, _: usize, u: DVec3, still: f64) -> bool {
        u.x.abs().max(u.z.abs()) > still
    }

    fn holds_still(
        &self,
        operator: &DelassusOperator,
        mean: &Corner3,
        _: (DVec3, DVec3),
        still: f64,
    ) -> bool {
        operator.spans_face() && operator.largest(mean) <= still
    }

    fn project(&self, state: &mut BodyState, held: u64, _: f64) -> (Corners, HeldNormals) {
        let (floor, body, held) = (self.context.floor, self.context.body, held as u8);
        let mut normals = HeldNormals::new(body, held);
        let corners = project_positions(floor, body, state, held, &mut normals);
        (corners, normals)
    }

    fn stop(
        &self,
        segment: &mut Segment<8>,
        normals: &HeldNormals,
        held: u64,
        whole: u64,
        after: &Corner3,
    ) -> bool {
        let (body, held) = (self.context.body, held as u8);
        let corner = normals.corner.map(usize::from);
        let u = corner.map(|k| after[k]);
        let stopped = (whole == 0).then(|| normals.stop(body, &u.map(|u| u.y)));
        if let Some((p, sum, torque)) = stopped.flatten() {
            segment.state.velocity.y += sum * body.inverse_mass();
            segment.state.angular_momentum += torque;
            for i in 0..held.count_ones() as usize {
                segment.impulse[corner[i]].y += p[i];
            }
        } else {
            let attitude = DMat3::from_quat(segment.state.rotation);
            let operator = DelassusOperator::new(body, attitude, held);
            let components = corner.map(|k| if has(whole, k) { DVec3::ONE } else { DVec3::Y });
            let correction = cancel(&operator, &u, &components);
            operator.apply(&mut segment.state, &correction);
            operator.add_to(&mut segment.impulse, &correction);
        }
        spans_face(held)
    }

    fn separate(&self, state: &mut BodyState) {
        state.velocity.y = state.velocity.y.max(0.0);
    }
}
