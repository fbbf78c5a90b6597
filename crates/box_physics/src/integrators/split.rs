//! `split`, the default: exact flows of every part of the force model, composed symmetrically.

use core::ops::Range;

use super::extrapolation::{extrapolate_rotation, extrapolate_translation, halved};
use super::flows::{
    ExactRotation, damped_step, exact_drift, half_dissipation, kick, modified_kick,
};
use super::{
    Conserved, EnergyBehavior, Evaluations, ForcedGroup, Integrate, IntegratorInfo, Limit,
    MemorySlot, MenuGroup, Order, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::free_motion::free_rotation_by;
use crate::math::{AnyArgument, Exponential, Trigonometry, exp};
use crate::state::BodyState;
use crate::translation::{exponential_step, quadratic_drag_flow};
use glam::DVec3;

/// Exact flows, composed symmetrically with positive times.
///
/// ```text
/// drift D   gravity + linear drag (exponential), free rotation + angular damping: exact, any step
/// kick K    the wrench at a fixed pose; K* Chin's modified kick
/// free      D(h)
/// wrench    K(h/6) D(h/2) K*(2h/3, h²/24) D(h/2) K(h/6)                    order 4 (Chin 1997, scheme 4A)
/// drag      S(h) = Q(h/2) · the above over h · Q(h/2),  S(½h)² + (S(½h)² − S(h))/3     order 4
/// dampers   D₀(h/2) · kick with all linear damping · D₀(h/2)               order 2, any damping
/// ```
///
/// Q is the exact flow of quadratic and angular drag. Free rotation is the algebraic map of
/// [`free_rotation`](crate::free_motion::free_rotation). Angular damping −γL only rescales time: the free
/// rotation over s = (1 − e^{−γh})/γ, then L ← e^{−γh} L, is exact. If the linear damping of the body is fast
/// (rate × step above 1), a wrench is one kick between halves of D, order 2.
pub struct Split;

impl Integrate for Split {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "split",
        name: "Split",
        group: MenuGroup::Ours,
        summary: "The default: free flight exact to rounding at the cost of RK4, fourth order under forces, stable drag at any step.",
        source: "Chin, Phys. Lett. A 226 (1997) 344; free rotation: docs/free-rotation.md; McLachlan, Perlmutter 2001 (damping)",
        orders: Orders {
            gravity: Order::Exact,
            linear_drag: Order::Exact,
            rotation: Order::Exact,
            angular_damping: Order::Exact,
            ..Orders::all(4)
        },
        evaluations: Evaluations::fixed(1, 4),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::None,
            oscillator: Limit::Below(3.464),
        },
        conserved: Conserved::all_else(EnergyBehavior::Exact),
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
        StepOutcome::plain(step(body, state, force, h, trigonometry))
    }

    const FORCED_IN_LANES: bool = true;

    fn step_forced<F: ForceModel>(group: &mut ForcedGroup<'_, F>, h: f64) -> StepOutcome {
        group.wrench_in_lanes::<Self>(h, StepOutcome::plain(4), |group, run| {
            chin_in_lanes(group, run, h);
        })
    }
}

/// [`chin`] without dissipation for many bodies, pass by pass.
#[inline(never)]
pub(super) fn chin_in_lanes<F: ForceModel>(
    group: &mut ForcedGroup<'_, F>,
    run: Range<usize>,
    h: f64,
) {
    let end_kick =
        |body: &RigidBox, state: &mut BodyState, force: &F| kick(body, state, force, h / 6.0);
    group.kick(run.clone(), end_kick);
    group.drift::<Split>(run.clone(), 0.5 * h);
    group.kick(run.clone(), |body, state, force| {
        modified_kick(body, state, force, h / 1.5, h * h / 24.0);
    });
    group.drift::<Split>(run.clone(), 0.5 * h);
    group.kick(run, end_kick);
}

/// The step of [`Split`], for integrators that fall back to it. Returns the number of force evaluations.
#[inline(always)]
pub(super) fn step<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) -> u32 {
    if force.has_wrench() {
        return forced(body, state, force, h);
    }
    let a = force.acceleration();
    if force.has_dissipation() {
        let d = force.dissipation();
        translate(body, state, a, &d, h);
        rotate(body, state, &d, h, trigonometry);
    } else {
        exponential_step(state, a, 0.0, h);
        free_rotation_by(body, state, h, trigonometry);
    }
    1
}

/// The step with a wrench, in a separate function so that the loop over free bodies stays small.
#[inline(never)]
fn forced<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, h: f64) -> u32 {
    let d = force.dissipation();
    if d == Dissipation::NONE && !force.has_damping() {
        chin(body, state, force, &Dissipation::NONE, h);
        return 4;
    }
    if damped_step(body, state, force, h, &mut ExactRotation(&mut AnyArgument)) {
        return 1;
    }
    if d.quadratic_drag == 0.0 && d.angular_drag == 0.0 {
        chin(body, state, force, &d, h);
        return 4;
    }
    let (start, one) = halved(state, h, |state, h| {
        half_dissipation(body, state, &d, 0.5 * h);
        chin(body, state, force, &d, h);
        half_dissipation(body, state, &d, 0.5 * h);
    });
    extrapolate_translation(&start, &one, state);
    extrapolate_rotation(&start, &one, state);
    12
}

/// Chin's composition 4A: three kicks, the middle one modified, and two exact drifts.
#[inline(always)]
fn chin<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, d: &Dissipation, h: f64) {
    let a = force.acceleration();
    let rotation = &mut ExactRotation(&mut AnyArgument);
    kick(body, state, force, h / 6.0);
    exact_drift(body, state, a, d, 0.5 * h, rotation);
    modified_kick(body, state, force, h / 1.5, h * h / 24.0);
    exact_drift(body, state, a, d, 0.5 * h, rotation);
    kick(body, state, force, h / 6.0);
}

/// The center of mass without a wrench: exact except for quadratic drag, which is extrapolated.
#[inline(always)]
fn translate(body: &RigidBox, state: &mut BodyState, a: DVec3, d: &Dissipation, h: f64) {
    let linear = d.linear_drag * body.inverse_mass();
    let a = d.blown(a, linear);
    if d.quadratic_drag == 0.0 {
        return exponential_step(state, a, linear, h);
    }
    let quadratic = d.quadratic_drag * body.inverse_mass();
    let (start, one) = halved(state, h, |state, h| {
        let drag = |v| quadratic_drag_flow(v, quadratic, 0.5 * h);
        state.velocity = d.in_air(state.velocity, drag);
        exponential_step(state, a, linear, h);
        state.velocity = d.in_air(state.velocity, drag);
    });
    extrapolate_translation(&start, &one, state);
}

/// The rotation without a wrench: exact except for angular drag, which is extrapolated.
#[inline(always)]
fn rotate(
    body: &RigidBox,
    state: &mut BodyState,
    d: &Dissipation,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let mut damped = |state: &mut BodyState, h: f64| {
        let damping = Exponential::new(d.angular_damping * h);
        free_rotation_by(body, state, h * damping.phi1, trigonometry);
        state.angular_momentum *= damping.decay;
    };
    if d.angular_drag == 0.0 {
        return damped(state, h);
    }
    let (start, one) = halved(state, h, |state, h| {
        let rates = body.inverse_inertia() * (-0.5 * d.angular_drag * h);
        let decay = DVec3::new(exp(rates.x), exp(rates.y), exp(rates.z));
        state.angular_momentum *= decay;
        damped(state, h);
        state.angular_momentum *= decay;
    });
    extrapolate_rotation(&start, &one, state);
}

#[cfg(test)]
mod tests {
    use super::super::Rk4;
    use super::super::testing::{Case, brick, on, run, spring};
    use super::*;
    use crate::force::{Forces, Spring};

    /// The discrete closed form on a central spring: Chin's five shears.
    #[test]
    fn oscillator_closed_form() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        for w in [1.0, 20.0, 3.46 * 60.0_f64] {
            let springs = spring(DVec3::ZERO, 2.0 * w * w);
            let law = on(&springs);
            let h = 1.0 / 60.0;
            let s = run::<Split>(&body, BodyState::at(DVec3::X), &law, 10.0, 600);
            let (mut x, mut v) = (1.0, 0.0);
            for _ in 0..600 {
                v -= h / 6.0 * w * w * x;
                x += 0.5 * h * v;
                v -= h / 1.5 * w * w * (x - h * h / 24.0 * w * w * x);
                x += 0.5 * h * v;
                v -= h / 6.0 * w * w * x;
            }
            let size = x.abs().max(1.0);
            assert!((s.position.x - x).abs() < 1e-9 * size && size < 30.0, "{w}");
        }
    }

    /// Fourth order under springs with every drag; errors at 60 Hz as measured.
    #[test]
    fn fourth_order() {
        let case = Case::dipole();
        assert!(case.error::<Split>(60) < 2e-7);
        let springs = [Spring {
            anchor: DVec3::Y,
            ..spring(case.body.half_extents(), 20.0)[0]
        }];
        let drag = |quadratic_drag, angular_drag| Dissipation {
            linear_drag: 0.6,
            angular_damping: 0.2,
            quadratic_drag,
            angular_drag,
            ..Dissipation::NONE
        };
        for (springs, dissipation) in [
            (&springs[..], drag(0.0, 0.0)),
            (&springs[..], drag(0.1, 0.02)),
            (&[], drag(0.1, 0.0)),
            (&[], drag(0.0, 0.02)),
        ] {
            let law = Forces {
                acceleration: DVec3::NEG_Y * 9.81,
                springs,
                dissipation,
                ..Default::default()
            };
            let start = case.start.with_velocity(DVec3::new(1.0, 2.0, -0.5));
            let reference = run::<Rk4>(&case.body, start, &law, 4.0, 4 * 3840);
            let error = |rate: u32| {
                let s = run::<Split>(&case.body, start, &law, 4.0, 4 * rate);
                let attitude = s.attitude_difference(&reference);
                (s.position - reference.position).length().max(attitude)
            };
            let (coarse, fine) = (error(30), error(60));
            let order = libm::log2(coarse / fine);
            assert!((order - 4.0).abs() < 0.25, "{order} ({coarse:e}, {fine:e})");
            assert!(fine < 1e-5, "{fine:e}");
        }
    }

    /// Drag of any size never reverses a velocity or adds energy, at any step size.
    #[test]
    fn drag_never_reverses() {
        let body = brick();
        for factor in [1e-3, 1.0, 1e3, 1e6] {
            for h in [1e-3, 0.1, 10.0, 1e3] {
                for (linear, quadratic, damping, drag) in [
                    (0.0, 1.0, 0.0, 1.0),
                    (1.0, 1.0, 1.0, 0.0),
                    (1.0, 1.0, 1.0, 1.0),
                ] {
                    let law = Forces {
                        dissipation: Dissipation {
                            linear_drag: factor * linear,
                            quadratic_drag: factor * quadratic,
                            angular_damping: factor * damping,
                            angular_drag: factor * drag,
                            ..Dissipation::NONE
                        },
                        ..Default::default()
                    };
                    let mut s = BodyState::default()
                        .with_velocity(DVec3::X * 30.0)
                        .with_body_angular_velocity(&body, DVec3::new(3.0, 2.0, 1.0));
                    for _ in 0..100 {
                        let before = s;
                        s = run::<Split>(&body, s, &law, h, 1);
                        assert!(s.velocity.x >= 0.0 && s.velocity.x <= before.velocity.x);
                        let (l, l0) = (s.angular_momentum, before.angular_momentum);
                        assert!(l.length() <= l0.length() * (1.0 + 1e-15), "{factor} {h}");
                        assert!(s.is_valid());
                    }
                }
            }
        }
    }
}
