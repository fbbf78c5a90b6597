//! The cost of a step under a torque, a force at a point and a spring, for one to 64 bodies, by the path that the plugin
//! takes. `cargo run --release --example cost_under_forces`

use std::time::Instant;

use box_physics::force::Forces;
use box_physics::integrators::{Exact, ForcedGroup, Integrate, Rk4, Split, Split4};
use box_physics::prelude::*;

/// Number of steps per sample.
const STEPS: u32 = 32;

/// Nanoseconds per body-step of `count` bricks that tumble under `forces`.
fn cost<S: Integrate>(forces: &Forces<'_>, count: usize) -> Result<f64, InvalidValue> {
    let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
    let bodies = vec![body; count];
    let spins = (0..count).map(|k| DVec3::new(1.5, 2.5, 1.0) * (1.0 + 0.01 * k as f64));
    let mut states: Vec<_> = spins
        .map(|omega| BodyState::at(DVec3::Y).with_body_angular_velocity(&body, omega))
        .collect();
    let mut memories: Vec<_> = bodies.iter().map(|_| IntegratorMemory::default()).collect();
    let mut faults = Vec::new();
    let repeats = 64_u32.div_ceil(count as u32);
    let before = Instant::now();
    for _ in 0..STEPS * repeats {
        let columns = (&*bodies, &mut *states, &mut *memories);
        ForcedGroup::step_each::<S>(columns, |_| *forces, 1.0 / 60.0, &mut faults);
    }
    let steps = f64::from(STEPS * repeats) * count as f64;
    Ok(before.elapsed().as_nanos() as f64 / steps)
}

fn main() -> Result<(), InvalidValue> {
    let points = [PointForce {
        body_point: DVec3::new(0.4, 0.2, 0.1),
        force: DVec3::new(0.3, -0.2, 0.5),
        frame: Frame::World,
    }];
    let springs = [Spring {
        body_point: DVec3::new(0.5, 0.25, 0.125),
        stiffness: 12.0,
        ..Spring::default()
    }];
    let torque = Forces {
        body_torque: DVec3::new(0.002, 0.001, -0.0005),
        ..Forces::default()
    };
    let point = Forces {
        point_forces: &points,
        ..Forces::default()
    };
    let spring = Forces {
        springs: &springs,
        ..Forces::default()
    };
    println!("ns a body-step; in brackets: over rk4");
    println!("bodies  split          exact          split4          rk4");
    for (name, forces) in [
        ("torque", torque),
        ("point force", point),
        ("spring", spring),
    ] {
        println!("{name}");
        for count in [1, 2, 3, 4, 6, 8, 15, 64] {
            // In turns, with the minimum of many samples: disturbances only lengthen a sample.
            let mut least = [f64::INFINITY; 4];
            for _ in 0..60 {
                let samples = [
                    cost::<Split>(&forces, count)?,
                    cost::<Exact>(&forces, count)?,
                    cost::<Split4>(&forces, count)?,
                    cost::<Rk4>(&forces, count)?,
                ];
                for (least, sample) in least.iter_mut().zip(samples) {
                    *least = least.min(sample);
                }
            }
            let rk4 = least[3];
            let cells = least.map(|ns| format!("{ns:.0} ({:.2})", ns / rk4));
            let [split, exact, split4, _] = &cells;
            println!("{count:<6}  {split:<13}  {exact:<13}  {split4:<14}  {rk4:.0}");
        }
    }
    Ok(())
}
