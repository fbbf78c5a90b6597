//! The order of every integrator in every channel of the force model: what its metadata claims is what is
//! measured, no less and no more.

use box_physics::integrators::{Channel, Order};
use box_physics::prelude::*;
use box_scenarios::{ForceSet, Plan, Setup, StateError, run_plan};

/// Comparisons with the reference along the way; every number of steps is a multiple of it.
const SAMPLES: u32 = 8;
/// The coarsest run has this many steps, then twice as many, and so on.
const COARSEST: u32 = 8;
/// Numbers of steps tried.
const LEVELS: u32 = 9;

/// A smooth motion of 2 s that exercises one channel.
fn setup(channel: Channel) -> Setup {
    let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
    let still = BodyState::at(DVec3::new(0.1, 0.5, -0.2)).with_velocity(DVec3::new(3.0, 4.0, -1.0));
    let spin = DVec3::new(1.5, 2.5, 1.0);
    let tumbling = BodyState::at(DVec3::new(0.1, 0.5, -0.2))
        .with_rotation(DQuat::from_xyzw(0.2, -0.1, 0.3, 0.9))
        .with_body_angular_velocity(&body, spin);
    let none = ForceSet::none();
    let g = ForceSet::gravity(9.81);
    let (start, forces) = match channel {
        Channel::Gravity => (still, g),
        Channel::LinearDrag => (
            still,
            ForceSet {
                linear_drag: 3.0,
                ..g
            },
        ),
        Channel::QuadraticDrag => (
            still,
            ForceSet {
                quadratic_drag: 0.5,
                ..g
            },
        ),
        Channel::Rotation => (tumbling, none),
        Channel::Torque => (
            tumbling,
            none.with_dipole(DVec3::new(0.0, 1.5, 0.5), DVec3::new(0.0, 1.0, 0.5)),
        ),
        Channel::Spring => (
            tumbling,
            none.with_spring(DVec3::new(0.5, 0.2, 0.1), DVec3::ZERO, 6.0, 0.0),
        ),
        Channel::AngularDamping => (
            tumbling,
            ForceSet {
                angular_damping: 0.5,
                ..none
            },
        ),
        Channel::AngularDrag => (
            tumbling,
            ForceSet {
                angular_drag: 0.1,
                ..none
            },
        ),
    };
    Setup::new(body, start, forces, 2.0)
}

/// What a channel is measured in: [m] or [rad], largest over the samples.
fn error(channel: Channel, e: &StateError) -> f64 {
    match channel {
        Channel::Gravity | Channel::LinearDrag | Channel::QuadraticDrag => e.position,
        Channel::Spring => e.position.max(e.attitude),
        _ => e.attitude,
    }
}

/// The largest error with each number of steps.
fn errors(setup: &Setup, channel: Channel, i: Integrator) -> Vec<f64> {
    let times: Vec<f64> = (0..=SAMPLES)
        .map(|k| setup.duration * f64::from(k) / f64::from(SAMPLES))
        .collect();
    let reference = setup.reference();
    let references: Vec<_> = times
        .iter()
        .map(|&t| reference.at(t).expect("known"))
        .collect();
    let run = |level| {
        let plan = Plan::new(&times, &[], setup.duration / f64::from(COARSEST << level));
        assert_eq!(plan.steps(), u64::from(COARSEST << level));
        let (mut worst, mut sample) = (0.0_f64, references.iter());
        run_plan(setup, i, &plan, |_, state| {
            let reference = sample.next().expect("one each");
            worst = worst.max(error(channel, &StateError::between(state, reference)));
            true
        });
        worst
    };
    (0..LEVELS).map(run).collect()
}

/// The order that can show in `channel`: where the motion is a tumbling, no better than the rotation's;
/// under gravity, no better than gravity's.
fn expected(i: Integrator, channel: Channel) -> Order {
    let orders = &i.info().orders;
    let with = |own, other| match (own, other) {
        (Order::Of(p), Order::Of(q)) => Order::Of(p.min(q)),
        (Order::Of(p), Order::Exact) | (Order::Exact, Order::Of(p)) => Order::Of(p),
        (Order::Exact, Order::Exact) => Order::Exact,
    };
    match channel {
        Channel::Gravity | Channel::Rotation => orders.of(channel),
        Channel::LinearDrag | Channel::QuadraticDrag => with(orders.of(channel), orders.gravity),
        _ => with(orders.of(channel), orders.rotation),
    }
}

/// Below this, rounding is more than a tenth of the error: 2000 steps of a few roundings each.
const FLOOR: f64 = 3e-12;

/// The slope over the finest three halvings whose errors are above rounding. The band of ±0.25 around
/// the claim: with an error C hᵖ(1 + κh + …), κh ≤ 0.1 at the coarse end makes at most log₂(1.1)/3 ≈
/// 0.05; where the leading terms nearly cancel, κ is larger. A missing order is 1.
fn slope(errors: &[f64]) -> Option<f64> {
    let usable: Vec<f64> = errors.iter().copied().take_while(|&e| e > FLOOR).collect();
    let last = usable.len().checked_sub(1)?;
    let first = last.checked_sub(3)?;
    Some((usable[first] / usable[last]).log2() / 3.0)
}

fn list(errors: &[f64]) -> String {
    let all: Vec<String> = errors.iter().map(|e| format!("{e:.1e}")).collect();
    all.join(", ")
}

#[test]
fn every_integrator_has_the_order_it_claims_in_every_channel() {
    let mut wrong = Vec::new();
    for channel in Channel::ALL {
        let setup = setup(channel);
        for &i in Integrator::ALL {
            let errors = errors(&setup, channel, i);
            match expected(i, channel) {
                Order::Exact => {
                    let worst = errors.iter().copied().fold(0.0, f64::max);
                    // 2048 steps of a few roundings of numbers up to 10.
                    if worst > 1e-11 {
                        wrong.push(format!(
                            "{i}, {}: claims to be exact, is off by {worst:.1e}",
                            channel.name()
                        ));
                    }
                }
                Order::Of(p) => match slope(&errors) {
                    Some(s) if (s - f64::from(p)).abs() <= 0.25 => {}
                    s => wrong.push(format!(
                        "{i}, {}: claims order {p}, has {s:.2?}: {}",
                        channel.name(),
                        list(&errors)
                    )),
                },
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// "Exact" in the angular damping means: it adds nothing to the error of the rotation itself. Damping
/// only shortens the steps of the rescaled time, so the damped error must not exceed the free one.
#[test]
fn exact_damping_adds_no_error() {
    let (damped, free) = (setup(Channel::AngularDamping), setup(Channel::Rotation));
    for &i in Integrator::ALL {
        if i.info().orders.angular_damping == Order::Exact {
            let with = errors(&damped, Channel::AngularDamping, i);
            let without = errors(&free, Channel::Rotation, i);
            for (with, without) in with.iter().zip(&without) {
                assert!(
                    *with <= 1.5 * without + 1e-12,
                    "{i}: {with:e} damped, {without:e} free"
                );
            }
        }
    }
}

/// Dampers at springs, too, keep the order of the spring (2 at most: they are taken symmetrically).
#[test]
fn dampers_converge() {
    let mut setup = setup(Channel::Spring);
    setup.forces.springs[0].damping = 0.8;
    for &i in Integrator::ALL {
        let errors = errors(&setup, Channel::Spring, i);
        let s = slope(&errors).expect("above rounding");
        // A damper is drag at a point: an integrator that lags drag (order 1) lags it as well.
        let of = |order| match order {
            Order::Exact => 2.0,
            Order::Of(p) => f64::from(p.min(2)),
        };
        let orders = i.info().orders;
        let claimed = f64::min(of(orders.spring), of(orders.linear_drag));
        assert!(s > claimed - 0.25, "{i}: order {s:.2} of {claimed}");
        assert!(errors[LEVELS as usize - 1] < 5e-3, "{i}: {errors:?}");
    }
}
