//! The balance of energy and angular momentum of one comparison. It accounts for the changes due to inputs, forces and
//! the floor, so that the residual is numerical error.
//!
//! ```text
//! E = E₀ + inputs + forces + contact + residual        (the same for L, a vector in world axes)
//! ```
//!
//! The change due to forces and floor in a step is that of the accurate flow of the force model, starting from the
//! comparison's own state at the beginning of the step. The flow is simulated in finer steps by [`best_integrator`].
//! Under conservative forces and away from the floor, nothing is computed or added.

use box_physics::force::rates;
use box_physics::prelude::{BodyState, DVec3};

use crate::driver::Driver;
use crate::live_reference::best_integrator;
use crate::metrics::error_scale;
use crate::model::Model;

/// Number of parts of a step in which the accurate flow is simulated. With an integrator of fourth order, its error is
/// 4096 times smaller than that of a whole step.
const PARTS: u32 = 8;

/// Energy and angular momentum accounts of one comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Energy at the start \[J\].
    pub start: f64,
    /// Change by pushes, changed parameters and repositioning \[J\].
    pub inputs: f64,
    /// Change by drag, damping, torques and damped springs \[J\].
    pub forces: f64,
    /// Change by the floor \[J\]; in a step that touches it, all changes.
    pub contact: f64,
    /// Upper bound on the energy given so far \[J\]: at the start, by inputs, and by torques and springs where they
    /// added energy.
    pub given: f64,
    /// Expected angular momentum, world axes [kg m²/s].
    pub momentum: DVec3,
    energy_scale: f64,
    momentum_scale: f64,
    /// Upper bound on the kinetic energy so far \[J\].
    kinetic_scale: f64,
}

/// Deviation from the balance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Energy residual, divided by its scale.
    pub energy: f64,
    /// |L| minus its expected value, divided by its scale.
    pub momentum: f64,
    /// |L − L_expected|, vectors in world axes, divided by its scale.
    pub vector: f64,
    /// Angle between L and its expected value \[°\].
    pub direction: f64,
}

impl Balance {
    /// Creates the balance of a body that starts in `state`.
    pub fn new(model: &Model, state: &BodyState) -> Self {
        let start = model.energy(state);
        let momentum = state.angular_momentum_world();
        Self {
            start,
            given: start,
            momentum,
            energy_scale: error_scale(start, state.kinetic_energy(&model.body)),
            momentum_scale: error_scale(momentum.length(), 0.0),
            kinetic_scale: state.kinetic_energy(&model.body).max(reach(model, state)),
            ..Self::default()
        }
    }

    /// Expected energy \[J\].
    pub fn expected(&self) -> f64 {
        self.start + self.inputs + self.forces + self.contact
    }

    /// Adds all changes made by an input.
    pub fn input(&mut self, before: (&Model, &BodyState), after: (&Model, &BodyState)) {
        let change = after.0.energy(after.1) - before.0.energy(before.1);
        self.inputs += change;
        self.given += change;
        self.momentum += after.1.angular_momentum_world() - before.1.angular_momentum_world();
        // A box that was at rest has no energy scale before it is pushed.
        let kinetic = after.1.kinetic_energy(&after.0.body);
        self.energy_scale = self.energy_scale.max(self.expected().abs()).max(kinetic);
        self.kinetic_scale = self.kinetic_scale.max(kinetic).max(reach(after.0, after.1));
        self.momentum_scale = self.momentum_scale.max(self.momentum.length());
    }

    /// Adds the changes by forces and floor in a step of `h` \[s\] from `state`.
    pub fn step(&mut self, model: &Model, state: &BodyState, h: f64) {
        let meets = model.may_touch(state, h);
        let d = model.forces.dissipation();
        let turns = model.forces.has_wrench() || d.angular_damping != 0.0 || d.angular_drag != 0.0;
        if !meets && !turns && model.is_conservative() {
            return;
        }
        let mut flow = Driver::new(*state, best_integrator(model));
        for _ in 0..PARTS {
            if flow.step(model, h / f64::from(PARTS)).is_none() {
                return;
            }
        }
        let mut change = model.energy(&flow.state) - model.energy(state);
        if model.forces.has_wrench() {
            self.given += change.max(0.0);
        } else {
            // Drag and floor can only remove energy.
            change = change.min(0.0);
        }
        if meets {
            self.contact += change;
        } else if !model.is_conservative() {
            self.forces += change;
        }
        self.momentum += flow.state.angular_momentum_world() - state.angular_momentum_world();
        self.momentum_scale = self.momentum_scale.max(self.momentum.length());
    }

    /// Returns `true` if `state` has more energy than it can have been given, whatever the error of the motion.
    ///
    /// The available kinetic energy is the energy given minus the potential energy in this state. The limit is exceeded
    /// if the kinetic energy exceeds the available one by more than the largest available one so far.
    pub fn is_exceeded(&mut self, model: &Model, state: &BodyState) -> bool {
        let kinetic = state.kinetic_energy(&model.body);
        let left = self.given - (model.energy(state) - kinetic);
        self.kinetic_scale = self.kinetic_scale.max(left);
        let limit = left + self.kinetic_scale;
        kinetic > limit || kinetic.is_nan() || limit.is_nan()
    }

    /// Restarts the balance in `state` with the energy residual `energy` (divided by its scale).
    pub fn rebase(&mut self, model: &Model, state: &BodyState, energy: f64) {
        self.inputs += model.energy(state) - self.expected() - energy * self.energy_scale;
        self.given = self.given.max(model.energy(state));
        self.momentum = state.angular_momentum_world();
    }

    /// The residual in `state`.
    pub fn residual(&self, model: &Model, state: &BodyState) -> Residual {
        let l = state.angular_momentum_world();
        let right = self.momentum;
        Residual {
            energy: (model.energy(state) - self.expected()) / self.energy_scale,
            momentum: (l.length() - right.length()) / self.momentum_scale,
            vector: (l - right).length() / self.momentum_scale,
            direction: if l.length().min(right.length()) > 1e-9 * self.momentum_scale {
                libm::atan2(l.cross(right).length(), l.dot(right)).to_degrees()
            } else {
                0.0
            },
        }
    }
}

/// The kinetic energy \[J\] that the forces at `state` supply over a radius of the box or a radian. It is the scale of
/// a motion that starts from rest.
fn reach(model: &Model, state: &BodyState) -> f64 {
    // At rest, because neither drag nor the gyroscopic term L×ω supplies energy.
    let rest = BodyState {
        velocity: DVec3::ZERO,
        angular_momentum: DVec3::ZERO,
        ..*state
    };
    let (acceleration, torque) = rates(&model.body, &rest, &model.forces.forces(&model.body));
    model.body.mass() * acceleration.length() * model.body.radius() + torque.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scenario;
    use box_physics::prelude::Integrator;

    const H: f64 = 1.0 / 60.0;

    /// Runs a scene with its balance and returns the largest energy residual.
    fn worst(id: &str, integrator: Integrator, seconds: f64) -> f64 {
        let setup = Scenario::find(id).expect("a scene").setup;
        let model = Model::of(&setup);
        let mut comparison = Driver::new(setup.initial, integrator);
        let mut balance = Balance::new(&model, &comparison.state);
        let mut worst = 0.0_f64;
        for _ in 0..(seconds / H) as u32 {
            balance.step(&model, &comparison.state, H);
            comparison.step(&model, H);
            worst = worst.max(balance.residual(&model, &comparison.state).energy.abs());
        }
        worst
    }

    /// Drag, torque and lossy impacts are not counted as drift: an integrator that treats them correctly has no
    /// residual.
    #[test]
    fn what_forces_and_floor_take_is_not_drift() {
        for (id, integrator, most) in [
            ("quadratic-drag", Integrator::Rk4, 1e-9),
            ("damped-spin", Integrator::Exact, 1e-12),
            ("drop", Integrator::Split, 1e-9),
            ("slide", Integrator::Split, 1e-9),
            ("bounce", Integrator::Split, 1e-9),
        ] {
            let left = worst(id, integrator, 3.0);
            assert!(left < most, "{id}: {left:e}");
        }
    }

    /// Errors appear with and without dissipation.
    #[test]
    fn what_an_integrator_gets_wrong_shows() {
        assert!(worst("dzhanibekov", Integrator::SemiImplicitEuler, 3.0) > 0.1);
        assert!(worst("quadratic-drag", Integrator::ExplicitEuler, 3.0) > 1e-4);
        assert!(worst("bounce", Integrator::ExplicitEuler, 3.0) > 1e-3);
    }

    /// A push on a box at rest is an input, to the last bit.
    #[test]
    fn a_push_is_booked() {
        let setup = Scenario::find("playground").expect("a scene").setup;
        let model = Model::of(&setup);
        let mut balance = Balance::new(&model, &setup.initial);
        let mut pushed = setup.initial;
        pushed.apply_impulse_at_body_point(&model.body, DVec3::X * 3.0, DVec3::Z * 0.5);
        balance.input((&model, &setup.initial), (&model, &pushed));
        assert!(balance.inputs > 2.0);
        let left = balance.residual(&model, &pushed);
        assert!(left.energy.abs() < 1e-15 && left.momentum == 0.0 && left.direction == 0.0);
    }
}
