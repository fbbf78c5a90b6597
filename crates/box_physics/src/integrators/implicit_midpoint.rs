//! `implicit-midpoint`: the implicit midpoint rule, which is A-stable and conserves energy and angular momentum.

use super::implicit_stage::{Attempt, shortened, solve};
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Order, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{ForceModel, Wrench};
use crate::math::Trigonometry;
use crate::rotation::{cayley_map, compose};
use crate::state::BodyState;

/// The implicit midpoint rule, with the Cayley map for the rotation:
///
/// ```text
/// v_m  = v₀ + h/2 (a − (c₁ + k₂|v_m|) v_m/m + F/m),            v₁ = 2v_m − v₀,    x₁ = x₀ + h v_m
/// Iω_m = L₀ + h/2 (Iω_m×ω_m − γIω_m − c_ω ω_m + T),            L₁ = 2Iω_m − L₀,   q₁ = q₀∘cay(hω_m)
/// ```
///
/// In free motion `L₁ − L₀ = h L_m×ω_m` is orthogonal to `ω_m` and to `L_m = ½(L₀ + L₁)`, so energy and |L| are
/// constant. L in the world is constant too, because `cay(hω_m) L₁ = L₀` (the Cayley map is *defined* by v' − v =
/// hω×½(v' + v)).
///
/// All three hold up to rounding errors, which grow with the rotation per step. For a needle the energy was conserved
/// to 4e-11 at |ω|h = 2e6 and to 5e-9 at 2e8. From 1e14 on, the rotation angle has no significant digits left, energy
/// is not conserved, and the solver occasionally fails. With linear drag R(z) = (1 + z/2)/(1 − z/2), which never
/// exceeds 1 in magnitude but approaches −1 for z → −∞.
///
/// With a wrench the equations are solved together (`implicit_stage`), and the method is A-stable on springs. The
/// wrench is the mean of those at the two attitudes q₀ and q₁ (at `x_m, v_m, ω_m`). The torque is the mean in *world*
/// axes, converted to body axes as `T = t − h/2 ω_m×t`, `t = q₀*T_w`. Then L₁ = cay⁻¹(L₀ + h t), so a world torque adds
/// to the world's angular momentum exactly.
///
/// The displacement of a body point is R₁r − R₀r = hω×½(R₀ + R₁)r. For springs of zero length and constant world forces
/// at body points, the work F·Δx + T·hω is therefore exactly the potential energy that they lose. Energy is conserved
/// with them too, at any step (Simo and Wong's energy–momentum method).
///
/// With a very stiff spring at a corner, the solver may not find the root. If the box turns by more than about a radian
/// per step, steps are divided and reported. Above √(k/m) h ≈ 100, `split` takes some of them (`shortened`). A central
/// spring has no limit.
pub struct ImplicitMidpoint;

impl Integrate for ImplicitMidpoint {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "implicit-midpoint",
        name: "Implicit midpoint",
        group: MenuGroup::Textbook,
        summary: "Stable at any step on springs, drag and spin: conserves E and L, but lags in phase.",
        source: "Austin, Krishnaprasad, Wang, J. Comput. Phys. 107 (1993) 105; Simo, Wong, IJNME 31 (1991) 19",
        orders: Orders {
            gravity: Order::Exact,
            ..Orders::all(2)
        },
        evaluations: Evaluations::per_iteration(1, 2),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::None,
            oscillator: Limit::None,
        },
        conserved: Conserved::all_else(EnergyBehavior::Exact),
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

impl ImplicitMidpoint {
    #[inline(always)]
    fn one<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, h: f64) -> Attempt {
        let start = *state;
        let stage = solve(body, &start, force, 0.5 * h, 2, |velocity, omega| {
            let mut middle = BodyState {
                position: start.position + (0.5 * h) * velocity,
                velocity,
                angular_momentum: body.inertia() * omega,
                ..start
            };
            let before = force.wrench(body, &middle);
            let turn = cayley_map(h * omega);
            middle.rotation = compose(start.rotation, turn);
            let after = force.wrench(body, &middle);
            let torque = 0.5 * (before.torque + turn * after.torque);
            Wrench {
                force: 0.5 * (before.force + after.force),
                torque: torque - (0.5 * h) * omega.cross(torque),
            }
        });
        if let Attempt::Solved(s) = stage {
            state.position += h * s.velocity;
            state.velocity = 2.0 * s.velocity - state.velocity;
            state.angular_momentum = 2.0 * (body.inertia() * s.omega) - state.angular_momentum;
            state.turn_by(cayley_map(h * s.omega));
        }
        stage
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        Case, brick, drag, expect_damping, expect_turn, on, run, run_counted, spring,
    };
    use super::*;
    use crate::energy::total_energy;
    use crate::force::{Forces, Gravity};
    use glam::DVec3;

    /// R = (1 + z/2)/(1 − z/2) on v and L, the position by the mean velocity, at any z; the parabola to rounding.
    #[test]
    fn amplification_factor_and_parabola() {
        for (h, z) in [(0.1, -0.07), (10.0, -7.0), (1000.0 / 0.7, -1000.0)] {
            expect_damping::<ImplicitMidpoint>(h, DVec3::ZERO, |v, _| {
                let middle = v / (1.0 - 0.5 * z);
                ((1.0 + 0.5 * z) * middle, h * middle)
            });
        }
        let body = RigidBox::default();
        let (v, g) = (DVec3::new(3.0, 9.0, 0.0), DVec3::NEG_Y * 9.81);
        let start = BodyState::default().with_velocity(v);
        let s = run::<ImplicitMidpoint>(&body, start, &Gravity(g), 4.0, 240);
        assert!((s.position - (4.0 * v + 8.0 * g)).length() < 1e-12);
    }

    /// A principal spin turns by 2 atan(ωh/2) per step, at any step.
    #[test]
    fn principal_spin_closed_form() {
        for wh in [0.1, 2.0, 1000.0] {
            expect_turn::<ImplicitMidpoint>(wh, 2.0 * libm::atan(0.5 * wh));
        }
    }

    /// On a central spring a step turns the phase by 2 atan(ωh/2), at any stiffness.
    #[test]
    fn oscillator_phase() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        for wh in [0.1, 3.0, 1000.0] {
            let springs = spring(DVec3::ZERO, 2.0 * wh * wh);
            let start = BodyState::at(DVec3::X);
            let s = run::<ImplicitMidpoint>(&body, start, &on(&springs), 100.0, 100);
            let phase = 200.0 * libm::atan(0.5 * wh);
            assert!((s.position.x - libm::cos(phase)).abs() < 1e-11, "{wh}");
            assert!((s.velocity.x / wh + libm::sin(phase)).abs() < 1e-11, "{wh}");
        }
    }

    /// A constant torque about a principal axis: ω exact, the world torque adds to L exactly.
    #[test]
    fn constant_torque() {
        let body = brick();
        let law = Forces {
            world_torque: DVec3::new(0.1, 0.3, -0.2),
            ..Default::default()
        };
        let s = run::<ImplicitMidpoint>(&body, BodyState::default(), &law, 4.0, 240);
        assert!((s.angular_momentum_world() - 4.0 * law.world_torque).length() < 1e-12);
        let law = Forces {
            body_torque: DVec3::Z,
            ..Default::default()
        };
        let s = run::<ImplicitMidpoint>(&body, BodyState::default(), &law, 4.0, 240);
        assert!((s.angular_momentum - DVec3::Z * 4.0).length() < 1e-12);
    }

    /// Energy with a spring at a corner, soft to stiff (√(k/m) h from 0.1 to 10), and with a dipole. The
    /// stiffest spins the box by a radian per step: such steps are divided and reported.
    #[test]
    fn conserves_energy_under_force() {
        let body = brick();
        for (stiffness, parted) in [(100.0, false), (1e4, true), (1e6, true)] {
            let springs = spring(body.half_extents(), stiffness);
            let law = Forces {
                acceleration: DVec3::NEG_Y * 9.81,
                ..on(&springs)
            };
            let start = BodyState::at(DVec3::new(-0.4, -0.3, -0.1))
                .with_body_angular_velocity(&body, DVec3::new(1.0, 2.0, 3.0));
            let (s, outcome) = run_counted::<ImplicitMidpoint>(&body, start, &law, 5.0, 300);
            let e = total_energy(&body, &start, &law);
            assert!(
                (total_energy(&body, &s, &law) / e - 1.0).abs() < 1e-9,
                "{stiffness}"
            );
            assert_eq!(outcome.fallbacks, 0);
            assert!(parted || outcome.unconverged == 0);
        }
        let case = Case::dipole();
        let (s, outcome) =
            run_counted::<ImplicitMidpoint>(&case.body, case.start, &case.law(), 60.0, 3600);
        let energy = |s| total_energy(&case.body, s, &case.law());
        assert!((energy(&s) - energy(&case.start)).abs() < 1e-11);
        assert_eq!((outcome.fallbacks, outcome.unconverged), (0, 0));
    }

    /// A negative step that cancels the damping has no solution: `split` takes the step, which is reported.
    #[test]
    fn an_unsolvable_step_is_reported() {
        let body = brick();
        let start = BodyState::default().with_velocity(DVec3::X);
        let (s, outcome) = run_counted::<ImplicitMidpoint>(&body, start, &drag(3.0, 0.0), -4.0, 1);
        assert_eq!((outcome.fallbacks, outcome.unconverged), (1, 0));
        assert!((s.velocity - libm::exp(4.0) * DVec3::X).length() < 1e-12);
    }
}
