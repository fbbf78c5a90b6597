//! Several planes as a [`Ground`]: a place for each corner over each plane, in world axes.

use glam::{DMat3, DVec3};

use super::Plane;
use super::contacts::{Each, Gaps, NONE, PAIRS};
use super::law::Law;
use crate::floor::Floor;
use crate::floor::bounds::curvature_bound;
use crate::floor::geometry::{each, has, set};
use crate::floor::ground::{Ground, Level, Segment, Touching, Way};
use crate::floor::newton::CoulombLaw;
use crate::floor::operator::DelassusOperator;
use crate::floor::projection::cancel_iteratively;
use crate::force::ForceModel;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// The body among the planes.
pub(super) struct Among<'a, F> {
    pub(super) world: Level<'a, F>,
    pub(super) planes: &'a [Plane],
}

impl<F: ForceModel> Among<'_, F> {
    fn over_all(&self, f: impl Fn(&Plane) -> f64) -> f64 {
        self.planes.iter().map(f).fold(0.0, f64::max)
    }

    /// Impulses p with u + Wp = 0 along the normals, and altogether at the places in `whole`.
    fn cancel(&self, operator: &DelassusOperator<PAIRS>, u: &Each, whole: u64) -> Each {
        cancel_iteratively(operator, operator.bound(), u, |i, v| {
            let place = usize::from(operator.place[i]);
            if has(whole, place) {
                v
            } else {
                let normal = self.normal(place);
                normal * normal.dot(v)
            }
        })
    }
}

impl<F: ForceModel> Ground<PAIRS> for Among<'_, F> {
    type Force = F;
    type Held = ();
    const MAX_EVALUATIONS: u64 = 4_000;

    fn level(&self) -> &Level<'_, F> {
        &self.world
    }

    fn order(places: u64) -> (usize, [u8; PAIRS]) {
        let (mut count, mut order) = (0, [0; PAIRS]);
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

    fn places(&self, state: &BodyState, elapsed: f64) -> Gaps {
        Gaps::over(self.planes, self.world.context.body, state, elapsed)
    }

    fn recover(&self, state: &mut BodyState, gaps: &mut Gaps, elapsed: f64) {
        gaps.leave(self.planes, state, elapsed);
    }

    fn normal_velocities(&self, state: &BodyState, gaps: &Gaps) -> [f64; PAIRS] {
        let omega = state.angular_velocity(self.world.context.body);
        let twist = (state.velocity, omega);
        let mut speed = [0.0; PAIRS];
        for i in 0..8 * self.planes.len() {
            speed[i] = self.normal(i).dot(self.relative(i, gaps, twist));
        }
        speed
    }

    fn curvature(&self, state: &BodyState, acceleration: f64) -> f64 {
        let (body, force) = (self.world.context.body, self.world.context.force);
        self.over_all(|plane| curvature_bound(body, state, acceleration, force, plane.shape.normal))
    }

    fn height(&self, center: DVec3) -> f64 {
        self.over_all(|plane| plane.height(center))
    }

    fn law<'a>(
        &'a self,
        operator: &'a DelassusOperator<PAIRS>,
        grips: bool,
    ) -> impl CoulombLaw<PAIRS> + 'a {
        let friction = |floor: &Floor| if grips { floor.grip() } else { floor.friction };
        Law::new(operator, self.planes, friction, self.world.context.settings)
    }

    fn way(&self, at: &Touching<PAIRS>, [first, last]: [&Each; 2]) -> Way {
        let (operator, before) = (at.operator, &at.before);
        let mut d = *last;
        for i in 0..operator.count {
            d[i] -= first[i];
        }
        let dot = |p: &Each, q: &Each| operator.dot(p, q);
        let gain = |p: &Each| dot(p, before) + 0.5 * dot(p, &operator.response(p));
        Way {
            a: 0.5 * dot(&d, &operator.response(&d)),
            b: dot(&d, before) + dot(&d, &operator.response(first)),
            lost: gain(first),
            gained: gain(last),
        }
    }

    /// Three corners at one plane.
    fn on_faces(&self, touching: u64) -> u64 {
        let face = |i: usize| (touching >> (8 * (i / 8)) & 0xff).count_ones() >= 3;
        touching & set::<PAIRS>(face)
    }

    fn strike(&self, state: &mut BodyState, at: &Touching<PAIRS>, p: &Each, stopped: u64) -> Each {
        at.operator.apply(state, p);
        let mut impulse = at.operator.by_place(p);
        if stopped != 0 {
            let operator = self.operator(DMat3::from_quat(state.rotation), stopped);
            let twist = (
                state.velocity,
                state.angular_velocity(self.world.context.body),
            );
            let held = self.cancel(&operator, &self.velocities(&operator, twist), 0);
            operator.apply(state, &held);
            operator.add_to(&mut impulse, &held);
        }
        impulse
    }

    fn slips(&self, k: usize, u: DVec3, still: f64) -> bool {
        self.along(k, u).length() > still
    }

    fn holds_still(
        &self,
        operator: &DelassusOperator<PAIRS>,
        _: &Each,
        (v, omega): (DVec3, DVec3),
        still: f64,
    ) -> bool {
        let speed = v.length() + omega.length() * self.world.context.body.radius();
        self.is_fixed() && operator.support() && speed <= still
    }

    /// By Newton's method on their heights.
    fn project(&self, state: &mut BodyState, held: u64, elapsed: f64) -> (Gaps, ()) {
        let mut gaps = self.places(state, elapsed);
        let scale = self.world.context.body.radius() + state.position.abs().max_element();
        for _ in 0..3 {
            let worst = each(held).fold(0.0, |a: f64, i| a.max(gaps.height[i].abs()));
            if worst <= 4.0 * f64::EPSILON * scale {
                break;
            }
            let attitude = DMat3::from_quat(state.rotation);
            let operator = self.operator(attitude, held);
            let mut gap = NONE;
            for i in 0..operator.count {
                let place = usize::from(operator.place[i]);
                gap[i] = self.normal(place) * gaps.height[place];
            }
            let (shift, turn) = operator.twist(&self.cancel(&operator, &gap, 0));
            state.position += shift;
            if turn != DVec3::ZERO {
                // World turn: q ← exp(turn)∘q. The angular momentum keeps its body components.
                state.rotation = compose(exponential_map(turn), state.rotation);
                state.renormalize();
            }
            gaps = self.places(state, elapsed);
        }
        (gaps, ())
    }

    fn stop(
        &self,
        segment: &mut Segment<PAIRS>,
        (): &(),
        held: u64,
        whole: u64,
        after: &Each,
    ) -> bool {
        let attitude = DMat3::from_quat(segment.state.rotation);
        let operator = self.operator(attitude, held);
        let u = operator.place.map(|place| after[usize::from(place)]);
        let correction = self.cancel(&operator, &u, whole);
        operator.apply(&mut segment.state, &correction);
        operator.add_to(&mut segment.impulse, &correction);
        self.is_fixed() && operator.support()
    }

    /// Two planes after one another may bring the first one back: each twice.
    fn separate(&self, state: &mut BodyState) {
        for plane in self.planes.iter().chain(self.planes) {
            let normal = plane.shape.normal;
            let approach = (state.velocity - plane.surface.velocity).dot(normal);
            state.velocity -= normal * approach.min(0.0);
        }
    }
}
