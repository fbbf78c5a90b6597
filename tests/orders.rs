//! The order of every integrator in every channel of the force model: the measured order equals the claim of
//! its metadata.

use box_physics::integrators::{Channel, Order, Orders};
use box_physics::prelude::*;
use box_scenarios::{ForceSet, Plan, Setup, StateError, run_plan};

/// Number of comparisons with the reference along the way; every number of steps is a multiple of it.
const SAMPLES: u32 = 8;
/// Number of steps of the coarsest run; each next level has twice as many.
const COARSEST: u32 = 8;
/// Number of levels.
const LEVELS: u32 = 9;

/// A smooth motion of 2 s that exercises one channel.
fn setup(channel: Channel) -> Setup {
    setup_of(channel, DVec3::new(0.5, 0.25, 0.125), 9.81)
}

/// The same without the terms that could hide the error of the channel: the gyroscopic term, which a cube
/// does not have, and gravity.
fn bare_setup(channel: Channel) -> Setup {
    setup_of(channel, DVec3::splat(0.375), 0.0)
}

fn setup_of(channel: Channel, half_extents: DVec3, gravity: f64) -> Setup {
    let body = RigidBox::new(half_extents, 3.0).expect("valid");
    let still = BodyState::at(DVec3::new(0.1, 0.5, -0.2)).with_velocity(DVec3::new(3.0, 4.0, -1.0));
    let spin = DVec3::new(1.5, 2.5, 1.0);
    let tumbling = BodyState::at_pose(
        DVec3::new(0.1, 0.5, -0.2),
        DQuat::from_xyzw(0.2, -0.1, 0.3, 0.9),
    )
    .with_body_angular_velocity(&body, spin);
    let none = ForceSet::none();
    let g = ForceSet::gravity(gravity);
    let with = |mut forces: ForceSet, set: fn(&mut ForceSet)| {
        set(&mut forces);
        forces
    };
    let (start, forces) = match channel {
        Channel::Gravity => (still, g),
        Channel::LinearDrag => (still, with(g, |f| f.linear_drag = 3.0)),
        Channel::QuadraticDrag => (still, with(g, |f| f.quadratic_drag = 0.5)),
        Channel::Rotation => (tumbling, none),
        Channel::Torque => (
            tumbling,
            none.with_dipole(DVec3::new(0.0, 1.5, 0.5), DVec3::new(0.0, 1.0, 0.5)),
        ),
        Channel::Spring => (
            tumbling,
            none.with_spring(DVec3::new(0.5, 0.2, 0.1), DVec3::ZERO, 6.0, 0.0),
        ),
        Channel::AngularDamping => (tumbling, with(none, |f| f.angular_damping = 0.5)),
        Channel::AngularDrag => (tumbling, with(none, |f| f.angular_drag = 0.1)),
    };
    Setup::new(body, start, forces, 2.0)
}

/// The error that a channel is measured by: [m] or [rad], largest over the samples.
fn error(channel: Channel, e: &StateError) -> f64 {
    match channel {
        Channel::Gravity | Channel::LinearDrag | Channel::QuadraticDrag => e.position,
        Channel::Spring => e.position.max(e.attitude),
        _ => e.attitude,
    }
}

/// The largest error for each number of steps.
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

/// The order that can show in `channel`, and `true` if it is lower than the channel's claim. In a tumbling motion it is
/// at most that of the rotation, under gravity at most that of gravity.
fn expected(orders: &Orders, channel: Channel) -> (Order, bool) {
    let own = orders.of(channel);
    let other = match channel {
        Channel::Gravity | Channel::Rotation => own,
        Channel::LinearDrag | Channel::QuadraticDrag => orders.gravity,
        _ => orders.rotation,
    };
    match (own, other) {
        (Order::Of(p), Order::Of(q)) => (Order::Of(p.min(q)), p > q),
        (Order::Of(p), Order::Exact) => (Order::Of(p), false),
        // Exact in the channel: it adds no error (a test below checks the damping).
        (Order::Exact, shown) => (shown, false),
    }
}

/// Error below which rounding is more than a tenth of it: 2000 steps with a few roundings each.
const FLOOR: f64 = 3e-12;

/// The slope over the finest three halvings whose errors are above rounding. The tolerance of ±0.25 follows
/// from an error C hᵖ(1 + κh + …): κh ≤ 0.1 at the coarse end gives at most log₂(1.1)/3 ≈ 0.05. Where the
/// leading terms nearly cancel, κ is larger. A missing order is 1.
fn slope(errors: &[f64]) -> Option<f64> {
    let usable: Vec<f64> = errors.iter().copied().take_while(|&e| e > FLOOR).collect();
    let last = usable.len().checked_sub(1)?;
    let first = last.checked_sub(3)?;
    Some(libm::log2(usable[first] / usable[last]) / 3.0)
}

fn list(errors: &[f64]) -> String {
    let all: Vec<String> = errors.iter().map(|e| format!("{e:.1e}")).collect();
    all.join(", ")
}

/// The errors of one integrator in one channel, with and without the terms that hide its own error.
struct Measured {
    channel: Channel,
    errors: Vec<f64>,
    bare: Vec<f64>,
}

fn measure(i: Integrator) -> Vec<Measured> {
    let all = Channel::ALL.into_iter();
    all.map(|channel| Measured {
        channel,
        errors: errors(&setup(channel), channel, i),
        bare: errors(&bare_setup(channel), channel, i),
    })
    .collect()
}

/// Differences between `claims` and the measurement.
fn contradictions(i: Integrator, claims: &Orders, measured: &[Measured]) -> Vec<String> {
    let mut wrong = Vec::new();
    for Measured {
        channel,
        errors,
        bare,
    } in measured
    {
        let mut check = |claim: Order, errors: &[f64]| {
            match claim {
            Order::Exact => {
                let worst = errors.iter().copied().fold(0.0, f64::max);
                // 2048 steps with a few roundings each of numbers up to 10.
                if worst > 1e-11 {
                    wrong.push(format!(
                        "{i} claims to be exact in {}; measured: off by {worst:.1e}. Claim `Order::Of(p)` in its INFO, or mend its step",
                        channel.name()
                    ));
                }
            }
            Order::Of(p) => match slope(errors) {
                Some(s) if (s - f64::from(p)).abs() <= 0.25 => {}
                s => wrong.push(format!(
                    "{i} claims order {p} in {}; measured: {s:.2?}, errors {}. Claim what is measured in its INFO, or mend its step",
                    channel.name(),
                    list(errors)
                )),
            },
        }
        };
        let (shown, hidden) = expected(claims, *channel);
        check(shown, errors);
        if hidden {
            check(claims.of(*channel), bare);
        }
    }
    wrong
}

#[test]
fn every_integrator_has_the_order_it_claims_in_every_channel_and_no_higher() {
    let mut wrong = Vec::new();
    for &i in Integrator::ALL {
        let (claims, measured) = (i.info().orders, measure(i));
        wrong.extend(contradictions(i, &claims, &measured));
        // A claim that is one order higher is rejected in every channel.
        for channel in Channel::ALL {
            let Order::Of(p) = claims.of(channel) else {
                continue;
            };
            let more = with(claims, channel, Order::Of(p + 1));
            if contradictions(i, &more, &measured).is_empty() {
                let (p, q) = (p, p + 1);
                wrong.push(format!(
                    "{i}: this test would not notice order {q} claimed in {} instead of {p}",
                    channel.name()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// `orders` with a different claim in one channel.
fn with(mut orders: Orders, channel: Channel, order: Order) -> Orders {
    *match channel {
        Channel::Gravity => &mut orders.gravity,
        Channel::LinearDrag => &mut orders.linear_drag,
        Channel::QuadraticDrag => &mut orders.quadratic_drag,
        Channel::Rotation => &mut orders.rotation,
        Channel::Torque => &mut orders.torque,
        Channel::Spring => &mut orders.spring,
        Channel::AngularDamping => &mut orders.angular_damping,
        Channel::AngularDrag => &mut orders.angular_drag,
    } = order;
    orders
}

/// "Exact" angular damping adds nothing to the error of the rotation itself. Damping only shortens the steps
/// of the rescaled time, so the damped error must not exceed the free one.
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

/// Dampers at springs also preserve the order of the spring, up to 2, because they are applied symmetrically.
#[test]
fn dampers_converge() {
    let mut setup = setup(Channel::Spring);
    setup.forces.springs[0].damping = 0.8;
    for &i in Integrator::ALL {
        let errors = errors(&setup, Channel::Spring, i);
        let s = slope(&errors).expect("above rounding");
        // A damper is drag at a point. An integrator that lags in drag (order 1) also lags in damping.
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
