//! `avian-993`: the gyroscopic step proposed for Avian in pull request 993.

use glam::DVec3;

use super::{
    EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Keeps, Limit, MemorySlot, MenuGroup,
    Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel, Wrench};
use crate::math::Trigonometry;
use crate::rotation::{compose, exponential_map_by};
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
/// The rest is as in `engine-newton`: velocities first, damping by implicit factors, drag with its
/// coefficient at the start of the step. A torque acts first, and k and Ω use the velocity after it, as Avian
/// orders its systems. The text keeps the velocity before it in k and Ω.
pub struct Avian993;

impl Integrate for Avian993 {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "avian-993",
        name: "Engine: Avian 993",
        group: MenuGroup::Engines,
        summary: "The step proposed for Avian: exact energy for bodies with two or three equal moments, first-order attitude.",
        source: "B. Spiers, A better way to spin (2026), \"Modified Jolt Method\"; avian PR #993",
        orders: Orders::all(1),
        evaluations: Evaluations::fixed(1, 1),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::Below(2.0),
            oscillator: Limit::Below(2.0),
        },
        keeps: Keeps {
            energy: EnergyBehavior::Drifts,
            momentum_magnitude: true,
            momentum: false,
            reversible: false,
        },
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
        let d = force.dissipation();
        let speed = (state.velocity - d.wind).length();
        let w = if force.has_wrench() {
            force.wrench(body, state)
        } else {
            Wrench::ZERO
        };
        if d != Dissipation::NONE {
            let c = (d.linear_drag + d.quadratic_drag * speed) * body.inverse_mass();
            let gamma = d.angular_damping + d.angular_drag * body.inverse_inertia();
            state.velocity = d.in_air(state.velocity, |v| v / (1.0 + h * c));
            state.angular_momentum /= 1.0 + h * gamma;
        }
        state.velocity += h * (force.acceleration() + w.force * body.inverse_mass());
        state.position += h * state.velocity;
        state.angular_momentum += h * w.torque;
        turn_momentum(body, state, h, trigonometry);
        let turn = exponential_map_by(h * state.body_angular_velocity(body), trigonometry);
        state.rotation = compose(state.rotation, turn);
        state.renormalize();
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
    // If k is 0, nothing turns.
    let rate = if square > 0.0 { weighted / square } else { 0.0 };
    let axis = if square > 0.0 {
        w - rate * l
    } else {
        DVec3::ZERO
    };
    let turn = exponential_map_by(h * axis, trigonometry);
    let across = turn.xyz().cross(l);
    state.angular_momentum = l + 2.0 * (turn.xyz().cross(across) - turn.w * across);
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Case, drag, run};
    use super::*;
    use crate::force::{Forces, Gravity};
    use crate::rotation::exponential_map;

    /// As `engine-newton`: v ← v/(1 + ch/m) + hg, x by the new velocity, L likewise, at any step.
    #[test]
    fn implicit_damping() {
        let body = RigidBox::cube(1.0, 2.0).expect("valid");
        let g = DVec3::NEG_Y * 9.81;
        for h in [0.1, 10.0, 1000.0 / 0.7] {
            let law = Forces {
                acceleration: g,
                ..drag(1.4, 0.7)
            };
            let start = BodyState::default()
                .with_velocity(DVec3::X)
                .with_body_angular_velocity(&body, DVec3::Y);
            let s = run::<Avian993>(&body, start, &law, h, 1);
            let v = DVec3::X / (1.0 + 0.7 * h) + h * g;
            assert!((s.velocity - v).length() < 1e-12 * (1.0 + v.length()));
            assert!((s.position - h * v).length() < 1e-12 * (1.0 + h * v.length()));
            assert!((s.body_angular_velocity(&body).y - 1.0 / (1.0 + 0.7 * h)).abs() < 1e-12);
        }
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
