//! Grab of the box at a point by a damped spring.
//!
//! The spring is a soft constraint on the velocity of the held point (E. Catto, *Soft Constraints*, GDC 2011). With
//! stiffness k and damping d, an implicit step h of spring and damper applies the impulse λ:
//!
//! ```text
//! (K + γ 1) λ = −(u + β C),    γ = 1/(h (d + h k)),    β = h k γ
//! ```
//!
//! with C the distance of the point from the target, u its velocity and K its inverse-mass matrix. The implicit form is
//! stable at every step size and for every integrator. As an impulse at the start of the step, it affects all compared
//! integrators equally.

use bevy::prelude::*;
use box_physics::prelude::{ApplyImpulse, BodyState, DVec3, PhysicsClock, RigidBox};
use glam::DMat3;

use crate::action::{Action, Hold};
use crate::scene::session::{MainBox, Session};
use crate::scene::start::SceneStarted;

/// Undamped frequency of a box held at its center \[Hz\]: follows fast without jerking.
const FREQUENCY: f64 = 7.5;
/// Fraction of critical damping.
const DAMPING: f64 = 1.0;
/// Maximum force, in weights of the box at 9.81 m/s²: enough to whirl it, too little to hurl it away.
const FORCE_CAP: f64 = 100.0;

/// The grab in progress.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip(pub Option<Hold>);

/// Observes grabs.
pub fn on_action(action: On<Action>, mut grip: ResMut<Grip>, mut session: ResMut<Session>) {
    if let Action::Grab(hold) = *action {
        let hold = hold.filter(|h| h.body_point.is_finite() && h.anchor.is_finite());
        if grip.0.is_none() && hold.is_some() {
            session.perturb("grab".to_owned());
        }
        grip.0 = hold;
    }
}

/// Releases the box when a scene starts.
pub fn release(_: On<SceneStarted>, mut grip: ResMut<Grip>) {
    grip.0 = None;
}

/// The impulse \[N s\] (world axes, at the held point) over a step of `h` \[s\].
fn impulse(hold: &Hold, body: &RigidBox, state: &BodyState, h: f64) -> DVec3 {
    let mass = body.mass();
    let rate = core::f64::consts::TAU * FREQUENCY;
    let (stiffness, damping) = (mass * rate * rate, 2.0 * DAMPING * mass * rate);
    let softness = 1.0 / (h * (damping + h * stiffness));
    let bias = h * stiffness * softness;
    let r = state.rotation * hold.body_point;
    let distance = state.position + r - hold.anchor;
    let velocity = state.point_velocity(body, hold.body_point);
    // K = 1/m − [r]× I⁻¹ [r]×, world axes.
    let to_world = DMat3::from_quat(state.rotation);
    let inverse = to_world * DMat3::from_diagonal(body.inverse_inertia()) * to_world.transpose();
    let cross = DMat3::from_cols(
        DVec3::new(0.0, r.z, -r.y),
        DVec3::new(-r.z, 0.0, r.x),
        DVec3::new(r.y, -r.x, 0.0),
    );
    let k = DMat3::from_diagonal(DVec3::splat(1.0 / mass + softness)) - cross * inverse * cross;
    let wanted = k.inverse() * -(velocity + bias * distance);
    wanted.clamp_length_max(h * FORCE_CAP * mass * 9.81)
}

/// Pulls the main box while it is held, once per tick of the clock.
pub fn pull(
    grip: Res<Grip>,
    clock: Res<PhysicsClock>,
    time: Res<Time>,
    main_box: Query<(Entity, &RigidBox, &BodyState), With<MainBox>>,
    mut session: ResMut<Session>,
    mut impulses: MessageWriter<ApplyImpulse>,
) {
    let (Some(hold), Ok((entity, body, state))) = (&grip.0, main_box.single()) else {
        return;
    };
    let h = time.delta_secs_f64();
    if clock.paused || h == 0.0 {
        return;
    }
    let pull = impulse(hold, body, state, h);
    impulses.write(ApplyImpulse::at_body_point(entity, pull, hold.body_point));
    session.truth = None;
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::force::Gravity;
    use box_physics::prelude::{Integrator, IntegratorMemory};

    fn held(hold: &Hold, start: BodyState, h: f64, seconds: f64) -> Vec<BodyState> {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let (mut state, mut memory) = (start, IntegratorMemory::default());
        (0..(seconds / h) as usize)
            .map(|_| {
                let pull = impulse(hold, &body, &state, h);
                state.apply_impulse_at_body_point(&body, pull, hold.body_point);
                let law = Gravity(DVec3::NEG_Y * 9.81);
                Integrator::Split.step(&body, &mut state, &law, h, &mut memory);
                state
            })
            .collect()
    }

    /// Held at the center, the box arrives within half a second without overshoot. It sags by the discrete balance of
    /// weight and spring, g/Ω² + g h/Ω + g h²/2. At rest the impulse of every step is m g h, and the speed before it is
    /// −g h/2.
    #[test]
    fn it_comes_to_the_hand_without_overshoot() {
        let hold = Hold {
            body_point: DVec3::ZERO,
            anchor: DVec3::new(1.0, 2.0, 0.0),
        };
        for h in [1.0 / 240.0, 1.0 / 60.0, 1.0 / 15.0] {
            let way = held(&hold, BodyState::default(), h, 2.0);
            assert!(way.iter().all(|s| s.position.x < 1.0 + 1e-6), "{h}");
            let end = way.last().expect("steps");
            let rate = core::f64::consts::TAU * FREQUENCY;
            let sag = 9.81 * (1.0 / (rate * rate) + h / rate + 0.5 * h * h);
            let from_hand = end.position - hold.anchor;
            assert!(from_hand.x.abs() < 1e-4, "{h}");
            assert!((from_hand.y + sag).abs() < 1e-6, "{h}: {from_hand} {sag}");
            assert!((end.velocity.y + 0.5 * 9.81 * h).abs() < 1e-5, "{h}");
            if h <= 1.0 / 60.0 {
                let half = way[(0.5 / h) as usize];
                assert!((half.position.x - 1.0).abs() < 1e-2, "{h}");
            }
        }
    }

    /// A box held at a corner hangs there at any step; the cap limits the speed of a wild drag.
    #[test]
    fn it_is_stable_at_a_corner_and_capped() {
        let hold = Hold {
            body_point: DVec3::new(0.5, 0.25, 0.125),
            anchor: DVec3::Y * 3.0,
        };
        for h in [1.0 / 120.0, 1.0 / 60.0, 1.0 / 20.0] {
            let way = held(&hold, BodyState::at(DVec3::Y * 2.5), h, 8.0);
            for state in &way[way.len() / 2..] {
                let corner = state.point(hold.body_point);
                assert!((corner - hold.anchor).length() < 0.1, "{h}: {corner}");
            }
        }
        let body = RigidBox::new(DVec3::splat(0.5), 3.0).expect("valid");
        let far = Hold {
            anchor: DVec3::X * 1e6,
            ..hold
        };
        let pull = impulse(&far, &body, &BodyState::default(), 1.0 / 60.0);
        assert!((pull.length() * 60.0 / (3.0 * 9.81) - FORCE_CAP).abs() < 1e-9);
    }
}
