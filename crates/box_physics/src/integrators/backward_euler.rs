//! `backward-euler`: the implicit Euler method, solved to convergence; it damps every motion.

use super::implicit_stage::{Attempt, shortened, solve};
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// Backward Euler: all terms are evaluated at the end of the step, and the equations are solved to convergence
/// (`implicit_stage`):
///
/// ```text
/// v₁ = v₀ + h (a − (c₁ + k₂|v₁|) v₁/m + F₁/m),              x₁ = x₀ + h v₁
/// L₁ = L₀ + h (L₁×ω₁ − γL₁ − c_ω ω₁ + T₁),  ω₁ = L₁/I,       q₁ = q₀∘exp(hω₁)
/// ```
///
/// R(z) = 1/(1 − z): A- and L-stable. In free rotation ω₁·(L₁ − L₀) = 0 gives 2E₁ = ω₁·L₀ ≤ 2√(E₀E₁), so the energy
/// never increases. By the same argument |L| never increases. Both decrease until the box spins about one axis (a brick
/// at 60 Hz loses 23 % of its energy in 10 s).
pub struct BackwardEuler;

impl Integrate for BackwardEuler {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "backward-euler",
        name: "Backward Euler",
        group: MenuGroup::Textbook,
        summary: "The true implicit Euler method: stable at any step because it damps all motion, spin and springs alike.",
        source: "Hairer, Wanner, Solving ODEs II, IV.3",
        orders: Orders::all(1),
        evaluations: Evaluations::per_iteration(1, 1),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::None,
            oscillator: Limit::None,
        },
        conserved: Conserved::nothing_else(EnergyBehavior::Dissipates),
    };

    const BRANCHES: bool = true;
    type Memory = ();

    #[inline(always)]
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        _memory: &mut MemorySlot<'_, Self>,
        _trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        shortened(body, state, force, h, Self::one)
    }
}

impl BackwardEuler {
    #[inline(always)]
    fn one<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, h: f64) -> Attempt {
        let start = *state;
        let stage = solve(body, &start, force, h, 1, |velocity, omega| {
            let end = BodyState {
                position: start.position + h * velocity,
                rotation: compose(start.rotation, exponential_map(h * omega)),
                velocity,
                angular_momentum: body.inertia() * omega,
            };
            force.wrench(body, &end)
        });
        if let Attempt::Solved(s) = stage {
            state.velocity = s.velocity;
            state.position += h * s.velocity;
            state.angular_momentum = body.inertia() * s.omega;
            state.turn_by(exponential_map(h * s.omega));
        }
        stage
    }
}

#[cfg(test)]
mod tests {
    use super::super::IntegratorMemory;
    use super::super::testing::{
        Case, expect_damping, expect_new_velocities, on, run, run_counted, spring,
    };
    use super::*;
    use crate::energy::total_energy;
    use crate::force::Gravity;
    use glam::DVec3;

    /// v/(1 − z), z = −ch/m, and L likewise; x by the new velocity, at any z.
    #[test]
    fn amplification_factor() {
        for h in [0.1, 10.0, 1000.0 / 0.7] {
            expect_damping::<BackwardEuler>(h, DVec3::NEG_Y * 9.81, |v, g| {
                let v = (v + h * g) / (1.0 + 0.7 * h);
                (v, h * v)
            });
        }
        expect_new_velocities::<BackwardEuler>();
    }

    /// Neither the energy nor |L| of a free box ever rises, at any step size.
    #[test]
    fn free_rotation_never_gains() {
        let Case { body, start, .. } = Case::free();
        for h in [1.0 / 60.0, 0.3, 3.0, 30.0, 350.0] {
            let mut s = start;
            for _ in 0..200 {
                let before = s;
                let outcome = BackwardEuler::step(
                    &body,
                    &mut s,
                    &Gravity(DVec3::ZERO),
                    h,
                    &mut IntegratorMemory::default(),
                );
                assert_eq!((outcome.fallbacks, outcome.unconverged), (0, 0));
                let (e, l) = (s.rotational_energy(&body), s.angular_momentum.length());
                assert!(e <= before.rotational_energy(&body) * (1.0 + 1e-14));
                assert!(l <= before.angular_momentum.length() * (1.0 + 1e-14));
            }
            assert!(s.is_finite());
        }
        let s = run::<BackwardEuler>(&body, start, &Gravity(DVec3::ZERO), 10.0, 600);
        let lost = 1.0 - s.rotational_energy(&body) / start.rotational_energy(&body);
        assert!((lost - 0.23).abs() < 0.01, "{lost}");
    }

    /// A central spring loses energy by the factor 1/(1 + (ωh)²) each step; a spring at a corner also loses
    /// energy.
    #[test]
    fn springs_lose_energy_at_any_stiffness() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        for wh in [0.1, 1.0, 1000.0] {
            let springs = spring(DVec3::ZERO, 2.0 * wh * wh);
            let law = on(&springs);
            let mut s = BodyState::at(DVec3::X);
            for n in 1..=6 {
                let e = total_energy(&body, &s, &law);
                BackwardEuler::step(&body, &mut s, &law, 1.0, &mut IntegratorMemory::default());
                let expected = e / (1.0 + wh * wh);
                assert!(
                    (total_energy(&body, &s, &law) - expected).abs() < 1e-10 * e,
                    "{wh}, {n}"
                );
            }
        }
        for stiffness in [1e2, 1e4, 1e6] {
            let springs = spring(body.half_extents(), stiffness);
            let (law, start) = (on(&springs), BodyState::at(DVec3::ONE));
            let (s, outcome) = run_counted::<BackwardEuler>(&body, start, &law, 5.0, 300);
            assert_eq!(outcome.fallbacks, 0);
            let left = total_energy(&body, &s, &law) / total_energy(&body, &start, &law);
            assert!(left < 0.1, "{left} of the energy");
        }
    }
}
