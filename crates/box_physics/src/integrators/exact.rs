//! `exact`: the closed-form motion since the last event, without accumulated errors.

use super::split::{self, Split};
use super::trajectory::{FlightForces, Trajectory};
use super::{ForcedGroup, Integrate, IntegratorInfo, MemorySlot, StepOutcome};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::state::BodyState;

/// The exact solution under gravity, linear drag −c₁v and angular damping −γL.
///
/// An *event* is any change that the integrator detects: an impulse, a teleport, another force, its first
/// step. At time t after the event,
///
/// ```text
/// x = x₀ + t (φ₁ v₀ + t φ₂ a),  v = e^{−ζ} v₀ + t φ₁ a          ζ = (c₁/m) t
/// q = free rotation over s,     L = e^{−γt} L_free(s)           s = (1 − e^{−γt})/γ
/// ```
///
/// The second line follows because Euler's equations are quadratic in L: with L = e^{−γt} M, dM/ds = M×M/I,
/// the free motion in rescaled time. The free rotation is [`FreeRotation`](crate::free_motion::FreeRotation).
///
/// Each step evaluates these formulas at its own t and never restarts from its last result. The error
/// therefore does not depend on the step size and hardly on the number of steps. With any other force, or
/// with quadratic or angular drag, the integrator takes a step of `split` and counts it.
pub struct Exact;

impl Integrate for Exact {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "exact",
        name: "Exact",
        summary: "Free flight in closed form since the last event: the same at any step and frame rate; no gain over Split while |ω|·dt stays below about 0.3, or under forces.",
        source: "Jacobi 1849; van Zon, Schofield, J. Comput. Phys. 225 (2007) 145; Celledoni et al., SIAM J. Sci. Comput. 30 (2008) 2084; McLachlan, Perlmutter 2001 (damping)",
        ..Split::INFO
    };

    const BRANCHES: bool = true;
    type Memory = Trajectory;

    #[inline]
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        memory: &mut MemorySlot<'_, Self>,
        trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        if !Self::remembers(force) {
            let evaluations = split::step(body, state, force, h, trigonometry);
            return StepOutcome {
                fallbacks: 1,
                ..StepOutcome::plain(evaluations)
            };
        }
        let flight = FlightForces::new(body, force);
        match memory.recall() {
            Some(trajectory) => trajectory.advance(&flight, state, h),
            None => {
                let mut trajectory = Trajectory::new(body, state);
                trajectory.advance(&flight, state, h);
                memory.store(trajectory);
            }
        }
        StepOutcome::plain(1)
    }

    #[inline(always)]
    fn remembers<F: ForceModel>(force: &F) -> bool {
        let d = force.dissipation();
        !force.has_wrench() && d.quadratic_drag == 0.0 && d.angular_drag == 0.0
    }

    const FORCED_IN_LANES: bool = true;

    /// Under a wrench a group steps like one of `split`.
    fn step_forced<F: ForceModel>(group: &mut ForcedGroup<'_, F>, h: f64) -> StepOutcome {
        let fallback = StepOutcome {
            fallbacks: 1,
            ..StepOutcome::plain(4)
        };
        group.wrench_in_lanes::<Self>(h, fallback, |group, run| {
            split::chin_in_lanes(group, run, h);
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::IntegratorMemory;
    use super::*;
    use crate::force::{Dissipation, Forces};
    use crate::integrators::SymmetricTop;
    use crate::math::AnyArgument;
    use glam::{DQuat, DVec3};

    fn tumbling() -> (RigidBox, BodyState) {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let state = BodyState::at_pose(
            DVec3::new(1.0, 2.0, 3.0),
            DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
        )
        .with_velocity(DVec3::new(3.0, 9.0, -1.0))
        .with_body_angular_velocity(&body, DVec3::new(1.5, 2.5, 1.0));
        (body, state)
    }

    fn damped() -> Forces<'static> {
        Forces {
            acceleration: DVec3::new(0.0, -9.81, 0.0),
            dissipation: Dissipation {
                linear_drag: 2.0,
                angular_damping: 0.25,
                ..Dissipation::NONE
            },
            ..Default::default()
        }
    }

    fn distance(a: &BodyState, b: &BodyState) -> f64 {
        (a.position - b.position)
            .length()
            .max((a.velocity - b.velocity).length())
            .max((a.angular_momentum - b.angular_momentum).length())
            .max(a.attitude_difference(b))
    }

    fn run(body: &RigidBox, state: &mut BodyState, law: &impl ForceModel, h: f64, n: usize) {
        let mut memory = IntegratorMemory::default();
        for _ in 0..n {
            let outcome = Exact::step(body, state, law, h, &mut memory);
            assert_eq!(outcome, StepOutcome::plain(1));
        }
    }

    #[test]
    fn the_step_does_not_matter() {
        let (body, start) = tumbling();
        for law in [damped(), Forces::default()] {
            let mut one = start;
            run(&body, &mut one, &law, 2.0, 1);
            for n in [2, 7, 1024] {
                let mut many = start;
                run(&body, &mut many, &law, 2.0 / n as f64, n);
                assert!(distance(&one, &many) < 2e-14, "{n}");
            }
        }
    }

    /// `symmetric-top` at a step so small that only its error ∝ h² remains.
    #[test]
    fn agrees_with_a_splitting() {
        let (body, start) = tumbling();
        let law = damped();
        let mut exact = start;
        run(&body, &mut exact, &law, 1.0, 1);
        let error = |n: usize| {
            let (mut state, mut memory) = (start, IntegratorMemory::default());
            for _ in 0..n {
                SymmetricTop::step(&body, &mut state, &law, 1.0 / n as f64, &mut memory);
            }
            distance(&exact, &state)
        };
        let (coarse, fine) = (error(1000), error(10_000));
        assert!(
            coarse < 1e-6 && fine < 1.2e-2 * coarse,
            "{coarse:e} {fine:e}"
        );
    }

    /// A change of step size keeps the event; any other change does not.
    #[test]
    fn an_event_is_a_change() {
        let (body, start) = tumbling();
        let law = damped();
        let (mut state, mut memory) = (start, IntegratorMemory::default());
        let event = |memory: &IntegratorMemory| memory.peek::<Exact>().map(|t| t.event);
        Exact::step(&body, &mut state, &law, 0.01, &mut memory);
        Exact::step(&body, &mut state, &law, 0.003, &mut memory);
        assert_eq!(event(&memory), Some(start));
        let here = state;
        Exact::step(&body, &mut state, &Forces::default(), 0.003, &mut memory);
        assert_eq!(event(&memory), Some(here));
        state.velocity.x += 1e-12;
        let here = state;
        Exact::step(&body, &mut state, &Forces::default(), 0.003, &mut memory);
        assert_eq!(event(&memory), Some(here));
        let heavier = body.with_inertia(body.inertia() * 2.0).expect("valid");
        let here = state;
        Exact::step(&heavier, &mut state, &Forces::default(), 0.003, &mut memory);
        assert_eq!(event(&memory), Some(here));
    }

    #[test]
    fn falls_back_to_split_under_torque() {
        let (body, start) = tumbling();
        let terms: [fn(&mut Forces<'_>); 3] = [
            |law| law.body_torque = DVec3::X,
            |law| law.dissipation.angular_drag = 0.1,
            |law| law.dissipation.quadratic_drag = 0.1,
        ];
        for add in terms {
            let mut law = damped();
            add(&mut law);
            let (mut a, mut b) = (start, start);
            let outcome = Exact::step(&body, &mut a, &law, 0.01, &mut IntegratorMemory::default());
            split::step(&body, &mut b, &law, 0.01, &mut AnyArgument);
            assert_eq!((a, outcome.fallbacks), (b, 1));
        }
    }
}
