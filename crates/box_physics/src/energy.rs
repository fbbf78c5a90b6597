//! Energies of a body under the force model.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::{ForceModel, Forces, Frame};
use crate::state::BodyState;

/// Potential energy \[J\] of the conservative terms: uniform acceleration (0 at the origin), springs (0 at the anchor)
/// and point forces constant in the world. Body-fixed forces and constant torques have no potential and are not
/// counted.
pub fn potential_energy(body: &RigidBox, state: &BodyState, forces: &Forces) -> f64 {
    let mut energy = -body.mass() * forces.acceleration().dot(state.position);
    for s in forces.springs {
        energy += 0.5 * s.stiffness * (state.point(s.body_point) - s.anchor).length_squared();
    }
    for p in forces.point_forces {
        if p.frame == Frame::World {
            energy -= p.force.dot(state.point(p.body_point));
        }
    }
    energy
}

/// Total energy \[J\]: kinetic plus potential.
///
/// ```
/// use box_physics::energy::total_energy;
/// use box_physics::force::Forces;
/// use box_physics::prelude::*;
/// let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
/// let law = Forces { acceleration: DVec3::new(0.0, -9.81, 0.0), ..Forces::default() };
/// let mut state = BodyState::at(DVec3::Y).with_angular_velocity(&body, DVec3::new(1.5, 2.5, 1.0));
/// let (start, mut memory) = (total_energy(&body, &state, &law), IntegratorMemory::default());
/// for _ in 0..60 {
///     Integrator::Exact.step(&body, &mut state, &law, 1.0 / 60.0, &mut memory);
/// }
/// assert!((total_energy(&body, &state, &law) / start - 1.0).abs() < 1e-12);
/// # Ok::<(), InvalidValue>(())
/// ```
pub fn total_energy(body: &RigidBox, state: &BodyState, forces: &Forces) -> f64 {
    state.kinetic_energy(body) + potential_energy(body, state, forces)
}

/// Returns `true` if the force model conserves [`total_energy`]: no dissipation, no spring damping, no constant torque
/// and no body-fixed force.
pub fn is_conservative(forces: &Forces) -> bool {
    forces.dissipation == crate::force::Dissipation::NONE
        && forces.body_torque == DVec3::ZERO
        && forces.world_torque == DVec3::ZERO
        && forces.point_forces.iter().all(|p| p.frame == Frame::World)
        && forces.springs.iter().all(|s| s.damping == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::{PointForce, Spring, Wrench};
    use glam::DQuat;

    /// The force is minus the gradient of the potential, for translations and rotations.
    #[test]
    fn wrench_is_minus_the_gradient() {
        let body = RigidBox::default();
        let state = BodyState::at_pose(
            DVec3::new(0.2, 1.0, -0.4),
            DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
        );
        let springs = [Spring {
            body_point: DVec3::new(0.5, 0.25, 0.1),
            anchor: DVec3::X,
            stiffness: 3.0,
            damping: 0.0,
        }];
        let points = [PointForce {
            body_point: DVec3::new(0.1, -0.4, 0.2),
            force: DVec3::new(1.0, 2.0, -0.5),
            frame: Frame::World,
        }];
        let law = Forces {
            acceleration: DVec3::NEG_Y * 9.81,
            springs: &springs,
            point_forces: &points,
            ..Default::default()
        };
        assert!(is_conservative(&law));
        let Wrench { force, torque } = law.wrench(&body, &state);
        let force = force + body.mass() * law.acceleration;
        let energy = |s: &BodyState| potential_energy(&body, s, &law);
        let d = 1e-6;
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let (mut a, mut b) = (state, state);
            a.position -= axis * d;
            b.position += axis * d;
            let gradient = (energy(&b) - energy(&a)) / (2.0 * d);
            assert!((gradient + force.dot(axis)).abs() < 1e-8);
            let turned = |angle: f64| {
                let mut s = state;
                s.rotation *= crate::rotation::exponential_map(axis * angle);
                energy(&s)
            };
            let gradient = (turned(d) - turned(-d)) / (2.0 * d);
            assert!((gradient + torque.dot(axis)).abs() < 1e-8);
        }
    }
}
