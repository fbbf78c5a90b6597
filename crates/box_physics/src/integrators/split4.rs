//! `split4`: a composition of kicks and exact drifts with fourth order under torque.

use super::flows::{FreeRotationFlow, damped_step, drift, exact_drift, half_dissipation, kick};
use super::split;
use super::{
    Conserved, EnergyBehavior, Evaluations, ForcedGroup, Integrate, IntegratorInfo, Limit,
    MemorySlot, MenuGroup, Order, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::math::Trigonometry;
use crate::rotation::free_rotation_order4;
use crate::state::BodyState;

/// K₁ D₁ K₂ D₂ K₃ D₃ K₄ D₃ K₃ D₂ K₂ D₁ K₁: Blanes and Moan's `SRKN6b`. The kick is K = wrench. The drift is
/// D = gravity + linear drag (exponential), free rotation + angular damping (order 4, rescaled time).
///
/// A kick depends on the pose alone and the drift is at most quadratic in (v, L), so the brackets
/// `[K,[K,[K,D]]]` vanish. A Runge–Kutta–Nyström composition therefore has order 4 here too. It is the better
/// of the two tried (asymmetric dipole, 1/60 s: 7e-10 rad; the partitioned S6 2.9e-8).
///
/// Without a wrench the whole step is one drift. Quadratic and angular drag are applied half before and half
/// after (Strang), with order 2. With dampers the step is `damped_step`. The negative drift D₃ undoes
/// damping, e^{0.35 ζ} times rounding with ζ = rate × h; above ζ = 20 the integrator takes a step of `split`.
pub struct Split4;

/// Fractions of the kicks K₁ K₂ K₃; K₄ = 1 − 2(K₁+K₂+K₃).
const KICKS: [f64; 3] = [0.0829844064174052, 0.396309801498368, -0.0390563049223486];
/// Fractions of the drifts D₁ D₂; D₃ = ½ − D₁ − D₂ = −0.35.
const DRIFTS: [f64; 2] = [0.245298957184271, 0.604872665711080];
/// Fractions of the six kicks before the last, and of the drift that follows each.
const STAGES: [(f64, f64); 6] = {
    let ([k1, k2, k3], [d1, d2]) = (KICKS, DRIFTS);
    let (k4, d3) = (1.0 - 2.0 * (k1 + k2 + k3), 0.5 - (d1 + d2));
    [(k1, d1), (k2, d2), (k3, d3), (k4, d3), (k3, d2), (k2, d1)]
};
/// Largest damping × step of the composition: e^{0.35·20} ε = 2e-13 is still rounding.
const STIFFEST: f64 = 20.0;

impl Integrate for Split4 {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "split4",
        name: "Split, order 4",
        group: MenuGroup::Ours,
        summary: "The flows of Split in a fourth-order composition: errors near 1e-9 rad at 60 Hz, including torque; order 2 for quadratic, angular and spring drag.",
        source: "Blanes, Moan, J. Comput. Appl. Math. 142 (2002) 313, SRKN6b and S6; Fassò 2003",
        orders: Orders {
            gravity: Order::Exact,
            linear_drag: Order::Exact,
            quadratic_drag: Order::Of(2),
            angular_damping: Order::Exact,
            angular_drag: Order::Of(2),
            ..Orders::all(4)
        },
        evaluations: Evaluations::fixed(1, 7),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::None,
            oscillator: Limit::Below(3.16),
        },
        conserved: Conserved::all_else(EnergyBehavior::Bounded),
    };

    type Memory = ();

    #[inline(always)]
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        _memory: &mut MemorySlot<'_, Self>,
        trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        if !force.has_wrench() {
            drift(body, state, force, h, &mut Order4(trigonometry));
            return StepOutcome::plain(1);
        }
        let d = force.dissipation();
        if stiffness(body, &d) * h.abs() > STIFFEST {
            let evaluations = split::step(body, state, force, h, trigonometry);
            return StepOutcome {
                fallbacks: 1,
                ..StepOutcome::plain(evaluations)
            };
        }
        let mut order4 = Order4(trigonometry);
        if force.has_damping() {
            damped_step(body, state, force, h, &mut order4);
            return StepOutcome::plain(1);
        }
        half_dissipation(body, state, &d, 0.5 * h);
        let a = force.acceleration();
        for (k, s) in STAGES {
            kick(body, state, force, k * h);
            exact_drift(body, state, a, &d, s * h, &mut order4);
        }
        kick(body, state, force, KICKS[0] * h);
        half_dissipation(body, state, &d, 0.5 * h);
        StepOutcome::plain(7)
    }

    const FORCED_IN_LANES: bool = true;

    /// Each of the six drifts is thirteen sequential planar turns, so a single body would wait for each of them.
    fn step_forced<F: ForceModel>(group: &mut ForcedGroup<'_, F>, h: f64) -> StepOutcome {
        group.wrench_in_lanes::<Self>(h, StepOutcome::plain(7), |group, run| {
            for (k, s) in STAGES {
                group.kick(run.clone(), |body, state, force| {
                    kick(body, state, force, k * h);
                });
                group.drift::<Self>(run.clone(), s * h);
            }
            group.kick(run, |body, state, force| {
                kick(body, state, force, KICKS[0] * h);
            });
        })
    }
}

/// The composition of order 4 with a given sine and cosine.
struct Order4<'a, T>(&'a mut T);

impl<T: Trigonometry> FreeRotationFlow for Order4<'_, T> {
    #[inline(always)]
    fn flow(&mut self, body: &RigidBox, state: &mut BodyState, h: f64) {
        free_rotation_order4(body, state, h, self.0);
    }
}

/// The fastest decay [1/s]: `max(c₁/m, γ, c_ω/I_min)`.
#[inline(always)]
fn stiffness(body: &RigidBox, d: &Dissipation) -> f64 {
    let linear = d.linear_drag * body.inverse_mass();
    let angular = d.angular_drag * body.inverse_inertia().max_element();
    linear.max(d.angular_damping).max(angular)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{drag, on, run, run_counted, spring};
    use super::*;
    use crate::force::Forces;
    use glam::DVec3;

    /// On a central spring: the product of its thirteen shears, to rounding; bounded up to ωh = 3.16.
    #[test]
    fn oscillator_closed_form() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        for w in [1.0, 20.0, 3.15 * 60.0_f64] {
            let springs = spring(DVec3::ZERO, 2.0 * w * w);
            let h = 1.0 / 60.0;
            let s = run::<Split4>(&body, BodyState::at(DVec3::X), &on(&springs), 10.0, 600);
            let ([k1, k2, k3], [d1, d2]) = (KICKS, DRIFTS);
            let (k4, d3) = (1.0 - 2.0 * (k1 + k2 + k3), 0.5 - d1 - d2);
            let (mut x, mut v) = (1.0, 0.0);
            for _ in 0..600 {
                for (k, d) in [
                    (k1, d1),
                    (k2, d2),
                    (k3, d3),
                    (k4, d3),
                    (k3, d2),
                    (k2, d1),
                    (k1, 0.0),
                ] {
                    v -= k * h * w * w * x;
                    x += d * h * v;
                }
            }
            assert!(
                (s.position.x - x).abs() < 1e-10 && s.position.x.abs() < 30.0,
                "{w}"
            );
        }
    }

    /// Too stiff for negative substeps: a reported step of `split`, with exact drag.
    #[test]
    fn stiff_damping_falls_back() {
        let cube = RigidBox::cube(1.0, 2.0).expect("valid");
        let start = BodyState::at(DVec3::Y).with_velocity(DVec3::new(10.0, 20.0, -5.0));
        for (z, fallbacks) in [(1.0, 0), (19.9, 0), (20.1, 10), (1000.0, 10)] {
            let torque = Forces {
                body_torque: DVec3::X,
                ..drag(120.0 * z, 0.0)
            };
            let (s, outcome) = run_counted::<Split4>(&cube, start, &torque, 10.0 / 60.0, 10);
            assert_eq!(outcome.fallbacks, fallbacks, "{z}");
            let e = crate::math::Exponential::new(10.0 * z);
            let exact = start.position + start.velocity * (e.phi1 / 6.0);
            assert!((s.position - exact).length() < 1e-12, "{z}");
        }
    }
}
