//! `avian-993`: the gyroscopic step proposed for Avian in pull request 993.

use glam::DVec3;

use super::engine_newton::velocities_first;
use super::slope::{turn, turned_back};
use super::{EngineRescaled, Integrate, IntegratorInfo, MemorySlot, StepOutcome};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::rotation::exponential_map_by;
use crate::state::BodyState;

/// Turns L about an axis that is chosen for the energy, then turns the box by the new angular velocity
/// (Spiers's "modified Jolt method", with the exponential map in both turns):
///
/// ```text
/// k = ω×L,  J' = k·I⁻¹k/|k|²,  Ω = ω − J'L          L ← exp(−hΩ) L,  q ← q∘exp(hω_new)
/// ```
///
/// Ω×L = ω×L for any J'. This J' makes the second derivative of the energy vanish, so a step changes the
/// energy by O(h³) instead of the O(h²) of `engine-rescaled`. If two moments are equal, J' is their inverse
/// and L turns about the axis of symmetry: its motion in the body and the energy are then exact. The attitude
/// has order 1, because it turns by the velocity at the end of the step.
///
/// Everything else is as in `engine-newton`: velocities first, damping by implicit factors, and drag with its
/// coefficient at the start of the step. A torque acts first, and k and Ω use the velocity after it, in the order of
/// Avian's systems. Spiers's text uses the velocity before it in k and Ω.
pub struct Avian993;

impl Integrate for Avian993 {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "avian-993",
        name: "Engine: Avian 993",
        summary: "The step proposed for Avian: exact energy for bodies with two or three equal moments, first-order attitude.",
        source: "B. Spiers, A better way to spin (2026), \"Modified Jolt Method\"; avian PR #993",
        ..EngineRescaled::INFO
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
        velocities_first(body, state, force, h);
        turn_momentum(body, state, h, trigonometry);
        turn(body, state, h, trigonometry);
        StepOutcome::plain(1)
    }
}

/// L ← exp(−hΩ) L.
#[inline(always)]
fn turn_momentum(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let (l, j) = (state.angular_momentum, body.inverse_inertia());
    let w = j * l;
    let k = w.cross(l);
    let (square, weighted) = (k.length_squared(), k.dot(j * k));
    // If k is 0, L does not turn.
    let rate = if square > 0.0 { weighted / square } else { 0.0 };
    let axis = if square > 0.0 {
        w - rate * l
    } else {
        DVec3::ZERO
    };
    state.angular_momentum = turned_back(l, exponential_map_by(h * axis, trigonometry));
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Case, expect_new_velocities, run};
    use super::*;
    use crate::force::Gravity;
    use crate::rotation::exponential_map;

    #[test]
    fn closed_forms() {
        expect_new_velocities::<Avian993>();
    }

    /// If two moments are equal, L moves exactly in the body at any step: by (J₃ − J₁)L₃h about the axis.
    #[test]
    fn symmetric_bodies_turn_their_momentum_exactly() {
        let body = RigidBox::new(DVec3::new(0.25, 0.5, 0.25), 6.0).expect("valid");
        let start =
            BodyState::default().with_body_angular_velocity(&body, DVec3::new(0.7, 12.0, -0.4));
        let (l, j) = (start.angular_momentum, body.inverse_inertia());
        for h in [0.01, 0.1, 3.0] {
            let s = run::<Avian993>(&body, start, &Gravity(DVec3::ZERO), 100.0 * h, 100);
            let back = exponential_map(DVec3::Y * (-100.0 * h * (j.y - j.x) * l.y));
            assert!(
                (s.angular_momentum - back * l).length() < 1e-11 * l.length(),
                "{h}"
            );
            let energy = s.rotational_energy(&body) / start.rotational_energy(&body);
            assert!((energy - 1.0).abs() < 1e-13, "{h}");
        }
    }

    /// The energy of a brick changes by O(h³) per step, O(h²) in a given time.
    #[test]
    fn energy_of_second_order() {
        let Case { body, start, .. } = Case::free();
        let change = |rate: u32| {
            let s = run::<Avian993>(&body, start, &Gravity(DVec3::ZERO), 2.0, 2 * rate);
            s.rotational_energy(&body) / start.rotational_energy(&body) - 1.0
        };
        let slope = libm::log2((change(240) / change(480)).abs());
        assert!((slope - 2.0).abs() < 0.1, "{slope}");
    }
}
