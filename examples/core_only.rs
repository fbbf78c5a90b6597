//! The physics without a Bevy `App`: plain values and one function call per step, for servers, tools, tests and papers.
//! `cargo run --release --example core_only`

use box_physics::floor::{ContactState, FloorContext, step_on_floor};
use box_physics::force::Gravity;
use box_physics::integrators::Split;
use box_physics::prelude::*;

fn main() -> Result<(), InvalidValue> {
    let brick = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
    let start = BodyState::at(DVec3::Y * 2.0)
        .with_velocity(DVec3::X * 2.0)
        .with_angular_velocity(&brick, DVec3::new(1.5, 2.5, 1.0));
    let h = 1.0 / 60.0;

    // Free flight with several integrators, and their cost.
    let vacuum = Gravity(DVec3::ZERO);
    for integrator in [
        Integrator::Exact,
        Integrator::Split,
        Integrator::EngineNewton,
    ] {
        let (mut state, mut memory) = (start, IntegratorMemory::default());
        let mut evaluations = 0;
        for _ in 0..600 {
            evaluations += integrator
                .step(&brick, &mut state, &vacuum, h, &mut memory)
                .evaluations;
        }
        let drift = state.kinetic_energy(&brick) / start.kinetic_energy(&brick) - 1.0;
        println!("{integrator:>14}: {evaluations} evaluations, energy {drift:+.1e}");
    }

    // Over a floor: the same integrator, with impacts located in time.
    let floor = Floor::new(0.0, 0.3, 0.5)?;
    let settings = ContactSettings::default();
    let over = FloorContext {
        floor: &floor,
        settings: &settings,
        body: &brick,
        force: &Gravity(DVec3::NEG_Y * 9.81),
    };
    let (mut state, mut memory) = (start, IntegratorMemory::default());
    let mut contact = ContactState::default();
    let mut impacts = 0;
    for _ in 0..600 {
        let state = &mut state;
        let step = step_on_floor::<Split, _>(&over, state, h, &mut memory, &mut contact, None);
        impacts += step.impacts;
    }
    println!(
        "after {impacts} impacts it is at {:.3}, resting: {}",
        state.position,
        contact.is_resting(&state)
    );
    assert!(contact.is_resting(&state) && state.velocity == DVec3::ZERO);
    Ok(())
}
