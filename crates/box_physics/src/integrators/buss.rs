//! `buss`: the second-order method of Buss, which rotates by the mean angular velocity at constant world momentum.

use glam::DVec3;

use super::slope::turned_back;
use super::velocity_verlet::{VelocityVerlet, half_kick};
use super::{
    Conserved, EnergyBehavior, Integrate, IntegratorInfo, MemorySlot, MenuGroup, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::rotation::exponential_map_by;
use crate::state::BodyState;

/// Free rotation by the mean angular velocity of the step:
///
/// ```text
/// ω̄ = ω + h/2 ω'            ω' = I⁻¹(L×ω)
/// q ← q∘exp(hω̄),  L in the world unchanged
/// ```
///
/// The rotation is enclosed by two half kicks of the forces, as in `velocity-verlet` (the paper treats free bodies).
/// The method truncates the Magnus expansion: L in the world is conserved to rounding, the energy is not.
pub struct Buss;

impl Integrate for Buss {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "buss",
        name: "Buss, order 2",
        group: MenuGroup::Engines,
        summary: "A turn by the mean angular velocity: conserves angular momentum, but the energy drifts and flips happen at the wrong time.",
        source: "S. Buss, Accurate and efficient simulation of rigid-body rotations, J. Comput. Phys. 164 (2000) 377",
        conserved: Conserved {
            energy: EnergyBehavior::Drifts,
            momentum_magnitude: true,
            momentum: true,
            reversible: false,
        },
        ..VelocityVerlet::INFO
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
        kick_drift_kick(body, state, force, h, false, trigonometry);
        StepOutcome::plain(2)
    }
}

/// A step of kick, drift, kick. With `augmented`, the rotation has the additional term of the augmented method.
#[inline(always)]
pub(super) fn kick_drift_kick<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    augmented: bool,
    trigonometry: &mut impl Trigonometry,
) {
    half_kick(body, state, force, 0.5 * h);
    state.position += h * state.velocity;
    let (l, w) = (state.angular_momentum, state.body_angular_velocity(body));
    let rate = body.inverse_inertia() * l.cross(w);
    let turn = exponential_map_by(h * mean(w, rate, h, augmented), trigonometry);
    state.turn_by(turn);
    state.angular_momentum = turned_back(l, turn);
    half_kick(body, state, force, 0.5 * h);
}

/// The mean angular velocity ω̄ of a step from ω and ω'. With `augmented`, it has the additional term of the augmented
/// method.
#[inline(always)]
pub(super) fn mean(w: DVec3, rate: DVec3, h: f64, augmented: bool) -> DVec3 {
    let mean = w + (0.5 * h) * rate;
    if augmented {
        mean + (h * h / 12.0) * rate.cross(w)
    } else {
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Case, run};
    use super::*;
    use crate::force::Gravity;
    use crate::rotation::{compose, exponential_map};

    /// One step equals the formula; a principal spin is exact.
    #[test]
    fn formula() {
        let Case { body, start, .. } = Case::free();
        let free = Gravity(DVec3::ZERO);
        let (w, l, h) = (
            start.body_angular_velocity(&body),
            start.angular_momentum,
            0.05,
        );
        let rate = body.inverse_inertia() * l.cross(w);
        let turned = compose(start.rotation, exponential_map(h * w + 0.5 * h * h * rate));
        let s = run::<Buss>(&body, start, &free, h, 1);
        assert!((s.rotation.dot(turned).abs() - 1.0).abs() < 1e-15);
        let axis = BodyState::default().with_body_angular_velocity(&body, DVec3::Z * 5.0);
        let s = run::<Buss>(&body, axis, &free, 10.0, 600);
        assert!((s.rotation.dot(exponential_map(DVec3::Z * 50.0)).abs() - 1.0).abs() < 1e-12);
    }
}
