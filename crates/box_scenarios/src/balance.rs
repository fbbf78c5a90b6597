//! The balance of energy and angular momentum of one comparison: what inputs, forces and floor have rightly
//! changed is booked, so that what is left over is numerical error.
//!
//! ```text
//! E = E₀ + inputs + forces + contact + residual        (the same for L, a vector in world axes)
//! ```
//!
//! What a force or the floor rightly does in one step is the change along the accurate flow of the force model,
//! from the comparison's own state at the beginning of that step: a simulation in finer steps by the integrator of
//! [`best_integrator`]. Under conservative forces away from the floor nothing is booked and nothing computed.

use box_physics::force::rates;
use box_physics::prelude::{BodyState, DVec3};

use crate::driver::Driver;
use crate::live_reference::best_integrator;
use crate::metrics::{energy_scale, momentum_scale};
use crate::model::Model;

/// Parts of a step in which the accurate flow is simulated: with an integrator of fourth order its error is
/// 4096 times smaller than the comparison's would be with the same.
const PARTS: u32 = 8;

/// The books of one comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Energy at the start \[J\].
    pub start: f64,
    /// By pushes, changed parameters and placing by hand \[J\].
    pub inputs: f64,
    /// By drag, damping, torques and damped springs \[J\].
    pub forces: f64,
    /// By the floor \[J\]; in a step that meets it, by everything.
    pub contact: f64,
    /// The most energy that it could have been given so far: at the start, by inputs, and by torques and springs where
    /// those gave any \[J\].
    pub given: f64,
    /// The angular momentum that would be right, world axes [kg m²/s].
    pub momentum: DVec3,
    energy_scale: f64,
    momentum_scale: f64,
    /// The most kinetic energy that it could have had so far \[J\].
    kinetic_scale: f64,
}

/// What is left over.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Energy over its scale.
    pub energy: f64,
    /// |L| less what it should be, over its scale.
    pub momentum: f64,
    /// |L − L_right|, vectors in world axes, over its scale.
    pub vector: f64,
    /// Angle between L and what it should be \[°\].
    pub direction: f64,
}

impl Balance {
    /// Opens the books.
    pub fn new(model: &Model, state: &BodyState) -> Self {
        let start = model.energy(state);
        let momentum = state.angular_momentum_world();
        Self {
            start,
            given: start,
            momentum,
            energy_scale: energy_scale(start, state.kinetic_energy(&model.body)),
            momentum_scale: momentum_scale(momentum.length(), 0.0),
            kinetic_scale: state.kinetic_energy(&model.body).max(reach(model, state)),
            ..Self::default()
        }
    }

    /// What the energy should be \[J\].
    pub fn expected(&self) -> f64 {
        self.start + self.inputs + self.forces + self.contact
    }

    /// Books an input: everything that it changed.
    pub fn input(&mut self, before: (&Model, &BodyState), after: (&Model, &BodyState)) {
        let change = after.0.energy(after.1) - before.0.energy(before.1);
        self.inputs += change;
        self.given += change;
        self.momentum += after.1.angular_momentum_world() - before.1.angular_momentum_world();
        // A box that was at rest has no scale before it is pushed.
        let kinetic = after.1.kinetic_energy(&after.0.body);
        self.energy_scale = self.energy_scale.max(self.expected().abs()).max(kinetic);
        self.kinetic_scale = self.kinetic_scale.max(kinetic).max(reach(after.0, after.1));
        self.momentum_scale = self.momentum_scale.max(self.momentum.length());
    }

    /// Books what forces and floor do in a step of `h` \[s\] from `state`.
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
            // Drag and floor only take.
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

    /// Whether `state` has more energy than it could have been given, whatever the error of the motion: kinetic energy
    /// beyond what is left of the energy given at this place, by more than the most that there ever was.
    pub fn is_exceeded(&mut self, model: &Model, state: &BodyState) -> bool {
        let kinetic = state.kinetic_energy(&model.body);
        let left = self.given - (model.energy(state) - kinetic);
        self.kinetic_scale = self.kinetic_scale.max(left);
        let most = left + self.kinetic_scale;
        kinetic > most || kinetic.is_nan() || most.is_nan()
    }

    /// Opens the books in `state` with `energy` (over its scale) already left over.
    pub fn rebase(&mut self, model: &Model, state: &BodyState, energy: f64) {
        self.inputs += model.energy(state) - self.expected() - energy * self.energy_scale;
        self.given = self.given.max(model.energy(state));
        self.momentum = state.angular_momentum_world();
    }

    /// What is left over in `state`.
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

/// The kinetic energy \[J\] that the forces at `state` give within a radius of the box, or a radian: what a motion that
/// starts from rest is measured by.
fn reach(model: &Model, state: &BodyState) -> f64 {
    // At rest: neither drag nor the gyroscopic term L×ω gives any energy.
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

    /// Runs a scene with its books and returns the largest residual of the energy.
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

    /// Drag, torque and lossy impacts are not drift: an integrator that is right about them has none left.
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

    /// With dissipation or without.
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
