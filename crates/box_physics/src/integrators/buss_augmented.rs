//! `buss-augmented`: the augmented second-order method of Buss.

use super::buss::{Buss, kick_drift_kick};
use super::{Integrate, IntegratorInfo, MemorySlot, StepOutcome};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::state::BodyState;

/// `buss` with the next commutator of the Magnus expansion: ω̄ = ω + h/2 ω' + h²/12 ω'×ω.
///
/// The other term of the same order, h²/6 ω'', is omitted, so the order remains 2. The error is smaller for a fast,
/// nearly steady spin and larger for slow tumbling.
///
/// `JSBSim`'s "Buss 2" is this rotation with angular velocities from Adams–Bashforth 4; the paper computes them from
/// the angular momentum. For a fast spin that variant is a hundred times more accurate (see the test below), but it
/// does not conserve angular momentum.
pub struct BussAugmented;

impl Integrate for BussAugmented {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "buss-augmented",
        name: "Buss, augmented",
        summary: "Buss's second-order turn with one more term: better for a fast needle, worse for slow tumbling; the energy also drifts.",
        ..Buss::INFO
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
        kick_drift_kick(body, state, force, h, true, trigonometry);
        StepOutcome::plain(2)
    }
}

#[cfg(test)]
mod tests {
    use super::super::buss::mean;
    use super::super::testing::{Case, run};
    use super::*;
    use crate::force::Gravity;
    use crate::rotation::{compose, exponential_map};
    use glam::DVec3;

    /// One step equals the formula.
    #[test]
    fn formula() {
        let Case { body, start, .. } = Case::free();
        let (w, l, h) = (
            start.body_angular_velocity(&body),
            start.angular_momentum,
            0.05,
        );
        let rate = body.inverse_inertia() * l.cross(w);
        let mean = w + 0.5 * h * rate + (h * h / 12.0) * rate.cross(w);
        let turned = compose(start.rotation, exponential_map(h * mean));
        let s = run::<BussAugmented>(&body, start, &Gravity(DVec3::ZERO), h, 1);
        assert!((s.rotation.dot(turned).abs() - 1.0).abs() < 1e-15);
    }

    /// With velocities from Adams–Bashforth 4, started by repeating the first derivative, the turn is as
    /// accurate as in `JSBSim` 1.3.3: 0.012 rad.
    #[test]
    fn as_flight_simulators_use_the_turn() {
        let case = Case::van_zon_schofield();
        let (i, j) = (case.body.inertia(), case.body.inverse_inertia());
        let (mut state, h) = (case.start, 1.0 / 60.0);
        let mut w = state.body_angular_velocity(&case.body);
        let mut past = [j * (i * w).cross(w); 3];
        for _ in 0..240 {
            let rate = j * (i * w).cross(w);
            let turn = exponential_map(h * mean(w, rate, h, true));
            state.rotation = compose(state.rotation, turn).normalize();
            w += (h / 24.0) * (55.0 * rate - 59.0 * past[0] + 37.0 * past[1] - 9.0 * past[2]);
            past = [rate, past[0], past[1]];
        }
        let error = case.attitude_error(&state);
        assert!((error - 0.011).abs() < 1e-3, "{error}");
        assert!(case.error::<BussAugmented>(60) > 1.0);
    }
}
