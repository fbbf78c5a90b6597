//! Shared helpers of the integrators' tests: discrete solutions that several integrators have in common, tumbling
//! cases with known solutions, and the measured order of an integrator.

use glam::{DQuat, DVec3};

use super::{Integrate, IntegratorMemory, Rk4, StepOutcome};
use crate::body::RigidBox;
use crate::force::{Dissipation, Forces, Frame, Gravity, PointForce, Spring};
use crate::free_motion::FreeRotation;
use crate::rotation::exponential_map;
use crate::state::BodyState;

/// Runs `n` steps of `S` over the time `t` \[s\].
pub(crate) fn run<S: Integrate>(
    body: &RigidBox,
    start: BodyState,
    law: &impl crate::force::ForceModel,
    t: f64,
    n: u32,
) -> BodyState {
    run_counted::<S>(body, start, law, t, n).0
}

/// Like [`run`], and returns the sum of the step outcomes.
pub(crate) fn run_counted<S: Integrate>(
    body: &RigidBox,
    start: BodyState,
    law: &impl crate::force::ForceModel,
    t: f64,
    n: u32,
) -> (BodyState, StepOutcome) {
    let (mut state, mut memory) = (start, IntegratorMemory::default());
    let mut outcome = StepOutcome::default();
    for _ in 0..n {
        outcome += S::step(body, &mut state, law, t / f64::from(n), &mut memory);
    }
    (state, outcome)
}

/// Forces with only linear drag c₁ [N s/m] and angular damping γ [1/s].
pub(crate) fn drag(linear_drag: f64, angular_damping: f64) -> Forces<'static> {
    Forces {
        dissipation: Dissipation {
            linear_drag,
            angular_damping,
            ..Dissipation::NONE
        },
        ..Default::default()
    }
}

/// An undamped spring of `stiffness` [N/m] from `body_point` to the origin.
pub(crate) fn spring(body_point: DVec3, stiffness: f64) -> [Spring; 1] {
    [Spring {
        body_point,
        stiffness,
        ..Spring::default()
    }]
}

/// Forces with only `springs`.
pub(crate) fn on(springs: &[Spring]) -> Forces<'_> {
    Forces {
        springs,
        ..Default::default()
    }
}

/// Asserts that steps of `h` under gravity `g`, drag and damping with the rate 0.7 1/s multiply the velocity and
/// the angular velocity as `step` does: (v, g) to (v after the step, displacement).
pub(crate) fn expect_damping<S: Integrate>(
    h: f64,
    g: DVec3,
    step: impl Fn(DVec3, DVec3) -> (DVec3, DVec3),
) {
    let body = RigidBox::cube(1.0, 2.0).expect("valid");
    let law = Forces {
        acceleration: g,
        ..drag(1.4, 0.7)
    };
    let (mut v, mut x, mut w) = (DVec3::X, DVec3::ZERO, DVec3::Y);
    let mut s = BodyState::default()
        .with_velocity(v)
        .with_body_angular_velocity(&body, w);
    for n in 1..=100 {
        S::step(&body, &mut s, &law, h, &mut IntegratorMemory::default());
        let (after, displacement) = step(v, g);
        (v, x, w) = (after, x + displacement, step(w, DVec3::ZERO).0);
        let omega = s.body_angular_velocity(&body);
        for (what, is, must) in [("v", s.velocity, v), ("x", s.position, x), ("ω", omega, w)] {
            let near = (is - must).length() < 1e-12 * (1.0 + must.length());
            assert!(near, "{what} after {n} steps of {h} s: {is}, not {must}");
        }
    }
}

/// Asserts that a spin of `turn` \[rad\] per step about each axis rotates the box by `turned` \[rad\] per step.
pub(crate) fn expect_turn<S: Integrate>(turn: f64, turned: f64) {
    let body = brick();
    for axis in DVec3::AXES {
        let start = BodyState::default().with_body_angular_velocity(&body, axis * turn);
        let s = run::<S>(&body, start, &Gravity(DVec3::ZERO), 600.0, 600);
        let (sin, cos) = libm::sincos(300.0 * turned);
        assert!((s.rotation.xyz() - axis * sin).length() < 1e-12);
        assert!((s.rotation.w - cos).abs() < 1e-12);
    }
}

/// Asserts the discrete solution of first-order integrators that move the pose by the new velocities: ahead of a
/// parabola by ½ght and of a constant torque's rotation by half a step, exact for a principal spin.
pub(crate) fn expect_new_velocities<S: Integrate>() {
    let body = brick();
    let (t, h) = (4.0, 1.0 / 60.0);
    let (v, g) = (DVec3::new(3.0, 9.0, 0.0), DVec3::NEG_Y * 9.81);
    for (alpha, spin) in [
        (DVec3::Z * 3.0, DVec3::Z * 2.0),
        (DVec3::ZERO, DVec3::Y * 7.0),
    ] {
        let law = Forces {
            acceleration: g,
            body_torque: body.inertia() * alpha,
            ..Default::default()
        };
        let start = BodyState::default()
            .with_velocity(v)
            .with_body_angular_velocity(&body, spin);
        let s = run::<S>(&body, start, &law, t, 240);
        assert!((s.position - (v * t + 0.5 * g * t * (t + h))).length() < 1e-12);
        let turned = exponential_map(spin * t + 0.5 * alpha * t * (t + h));
        assert!((s.rotation.dot(turned).abs() - 1.0).abs() < 1e-12);
        assert!((s.body_angular_velocity(&body) - (spin + alpha * t)).length() < 1e-12);
    }
}

/// The box of pub01: 1 × ½ × ¼ m, 3 kg.
pub(crate) fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

/// A tumbling motion with a known attitude at its end.
pub(crate) struct Case {
    pub(crate) body: RigidBox,
    pub(crate) start: BodyState,
    pair: Vec<PointForce>,
    pub(crate) seconds: u32,
    answer: DQuat,
}

impl Case {
    /// pub01: torque-free, 10 s, elliptic functions at 40 digits.
    pub(crate) fn free() -> Self {
        let body = brick();
        Self {
            start: BodyState::default()
                .with_body_angular_velocity(&body, DVec3::new(1.5, 2.5, 1.0)),
            body,
            pair: Vec::new(),
            seconds: 10,
            answer: DQuat::from_xyzw(
                0.15838661864064005,
                0.5357215218783311,
                0.18329396581463148,
                0.8089001496648978,
            ),
        }
    }

    /// The free top of van Zon and Schofield (J. Comput. Phys. 225 (2007) 145): moments of 10, 20 and 26 kg
    /// m², 4 s.
    pub(crate) fn van_zon_schofield() -> Self {
        let body = RigidBox::new(DVec3::new(3.0, 2.0, 1.0), 6.0).expect("valid");
        let start =
            BodyState::default().with_body_angular_velocity(&body, DVec3::new(1.0, 15.0, 1.0));
        let free = FreeRotation::new(body.inertia(), start.rotation, start.angular_momentum);
        Self {
            answer: free.at(4.0).0,
            body,
            start,
            pair: Vec::new(),
            seconds: 4,
        }
    }

    /// The same box in the field (0, 1, ½) with the dipole (0, 1.5, ½), ω = (1, 4, −2), 6 s. The reference is
    /// RK4 with 1/3840 s (error: 4e-13 rad).
    pub(crate) fn dipole() -> Self {
        let mut case = Self::free();
        case.start =
            BodyState::default().with_body_angular_velocity(&case.body, DVec3::new(1.0, 4.0, -2.0));
        case.seconds = 6;
        // The torque (Rµ)×B as a pair of forces.
        let (moment, field) = (DVec3::new(0.0, 1.5, 0.5), DVec3::new(0.0, 1.0, 0.5));
        let force = |body_point, force| PointForce {
            body_point,
            force,
            frame: Frame::World,
        };
        case.pair = vec![force(moment, field), force(DVec3::ZERO, -field)];
        case.answer = run::<Rk4>(&case.body, case.start, &case.law(), 6.0, 6 * 3840).rotation;
        case
    }

    pub(crate) fn law(&self) -> Forces<'_> {
        Forces {
            point_forces: &self.pair,
            ..Default::default()
        }
    }

    /// Attitude error at the end \[rad\] with `rate` steps per second.
    pub(crate) fn error<S: Integrate>(&self, rate: u32) -> f64 {
        let n = self.seconds * rate;
        let end = run::<S>(
            &self.body,
            self.start,
            &self.law(),
            f64::from(self.seconds),
            n,
        );
        assert!(end.is_finite());
        self.attitude_error(&end)
    }

    /// Attitude error of `end` \[rad\].
    pub(crate) fn attitude_error(&self, end: &BodyState) -> f64 {
        end.attitude_difference(&BodyState {
            rotation: self.answer,
            ..*end
        })
    }
}
