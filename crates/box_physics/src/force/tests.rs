use super::*;
use crate::integrators::{Integrator, IntegratorMemory};
use glam::DQuat;

/// A box and a state without any symmetry.
pub(crate) fn setting() -> (RigidBox, BodyState) {
    let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.375), 3.0).expect("valid");
    let state = BodyState::at_pose(
        DVec3::new(0.2, 1.0, -0.4),
        DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
    )
    .with_velocity(DVec3::new(1.0, -2.0, 0.5))
    .with_angular_velocity(&body, DVec3::new(3.0, 1.0, -2.0));
    (body, state)
}

#[test]
fn rates_are_the_law() {
    let (body, state) = setting();
    let d = Dissipation {
        linear_drag: 0.3,
        quadratic_drag: 0.2,
        angular_damping: 0.1,
        angular_drag: 0.05,
        ..Dissipation::NONE
    };
    let law = Forces {
        acceleration: DVec3::NEG_Y,
        dissipation: d,
        body_torque: DVec3::X,
        ..Default::default()
    };
    let (dv, dl) = rates(&body, &state, &law);
    let (v, l, w) = (
        state.velocity,
        state.angular_momentum,
        state.body_angular_velocity(&body),
    );
    let expected = DVec3::NEG_Y - (0.3 * v + 0.2 * v.length() * v) / 3.0;
    assert!((dv - expected).length() < 1e-15);
    let expected = l.cross(w) - 0.1 * l - 0.05 * w + DVec3::X;
    assert!((dl - expected).length() < 1e-15);
}

/// In wind a body moves as in still air seen from a frame that moves with it, under every integrator.
#[test]
fn wind_is_a_moving_frame_under_every_integrator() {
    let (body, start) = setting();
    let (wind, h) = (DVec3::new(4.0, -1.0, 2.5), 1.0 / 60.0);
    for (linear_drag, quadratic_drag) in [(2.0, 0.0), (0.0, 0.7), (1.5, 0.4)] {
        let dissipation = Dissipation {
            linear_drag,
            quadratic_drag,
            angular_damping: 0.2,
            ..Dissipation::NONE
        };
        let still = Forces {
            acceleration: DVec3::new(0.5, -9.81, 0.0),
            dissipation,
            ..Forces::default()
        };
        let blowing = Forces {
            dissipation: Dissipation {
                wind,
                ..dissipation
            },
            ..still
        };
        for &integrator in Integrator::ALL {
            let (mut a, mut b) = (start, start);
            b.velocity -= wind;
            let mut memories = [IntegratorMemory::default(), IntegratorMemory::default()];
            for step in 1..=300 {
                integrator.step(&body, &mut a, &blowing, h, &mut memories[0]);
                integrator.step(&body, &mut b, &still, h, &mut memories[1]);
                let moved = wind * (h * f64::from(step));
                assert!(
                    (a.velocity - b.velocity - wind).length() < 1e-11,
                    "{integrator}"
                );
                assert!(
                    (a.position - b.position - moved).length() < 1e-9,
                    "{integrator}"
                );
            }
            assert!(a.attitude_difference(&b) < 1e-12, "{integrator}");
        }
    }
}

/// A wind stretches a damped spring by F/k at equilibrium, under every integrator.
#[test]
fn a_kite_stands_in_the_wind() {
    let body = RigidBox::cube(0.5, 1.0).expect("valid");
    let springs = [Spring {
        stiffness: 20.0,
        damping: 2.0,
        ..Spring::default()
    }];
    let wind = DVec3::new(3.0, 0.0, 4.0);
    let law = Forces {
        dissipation: Dissipation {
            linear_drag: 0.6,
            quadratic_drag: 0.2,
            wind,
            ..Dissipation::NONE
        },
        springs: &springs,
        ..Forces::default()
    };
    let stretch = wind * ((0.6 + 0.2 * 5.0) / 20.0);
    for &integrator in Integrator::ALL {
        let (mut state, mut memory) = (BodyState::default(), IntegratorMemory::default());
        for _ in 0..3000 {
            integrator.step(&body, &mut state, &law, 1.0 / 240.0, &mut memory);
        }
        let off = (state.position - stretch).length();
        // First-order integrators that damp after the kick miss it by the fraction c h/m.
        let most = stretch.length() * 1.01 * 1.6 / 240.0;
        assert!(
            off < most && state.velocity.length() < 0.02,
            "{integrator}: {off}"
        );
    }
}

/// A resting box stays at rest in a breeze, slides in a gale, and reacts to the change from one to the
/// other.
#[test]
fn wind_moves_a_lying_box_if_it_beats_friction() {
    use crate::floor::{ContactSettings, ContactState, Floor, FloorContext};
    let body = RigidBox::default();
    let law = |speed: f64| Forces {
        acceleration: DVec3::NEG_Y * 9.81,
        dissipation: Dissipation {
            linear_drag: 1.0,
            wind: DVec3::X * speed,
            ..Dissipation::NONE
        },
        ..Forces::default()
    };
    for integrator in [
        Integrator::Split,
        Integrator::Rk4,
        Integrator::BackwardEuler,
    ] {
        let mut state = BodyState::at(DVec3::Y * 0.5);
        let (mut memory, mut contact) = (IntegratorMemory::default(), ContactState::default());
        // µ m g is 4.9 N.
        for (speed, rests) in [(0.0, true), (4.0, true), (10.0, false)] {
            for _ in 0..60 {
                let context = FloorContext {
                    floor: &Floor::default(),
                    settings: &ContactSettings::default(),
                    body: &body,
                    force: &law(speed),
                };
                let (h, memory) = (1.0 / 60.0, &mut memory);
                integrator.step_on_floor(&context, &mut state, h, memory, &mut contact, None);
            }
            assert_eq!(
                contact.is_resting(&state),
                rests,
                "{integrator}, {speed} m/s"
            );
        }
        // v' = c (w − v) − µ g after a second, from rest.
        let speed = (10.0 - 4.905) * (1.0 - libm::exp(-1.0));
        assert!(
            (state.velocity.x - speed).abs() < 0.05,
            "{integrator}: {}",
            state.velocity.x
        );
    }
}
