//! The clock and its copies.

use bevy::prelude::*;
use box_physics::prelude::*;

use super::{Play, app, brick, tick, tumbling};

type Copy = (PhysicsClock, BodyState, IntegratorMemory);

#[derive(Resource, Default)]
struct Copies(Vec<Copy>);

fn copy(
    clock: Res<PhysicsClock>,
    bodies: Query<(&BodyState, &IntegratorMemory)>,
    mut copies: ResMut<Copies>,
) {
    for (state, memory) in &bodies {
        copies.0.push((*clock, *state, memory.clone()));
    }
}

/// Steps one body, and copies every step in `Last`.
fn recorded(substeps: u32, ticks: u32, from: Option<&Copy>) -> Vec<Copy> {
    let mut app = app();
    app.init_resource::<Copies>()
        .insert_resource(GlobalIntegrator(Integrator::Exact))
        .add_systems(PhysicsSchedule, copy.in_set(PhysicsSystems::Last));
    app.world_mut().resource_mut::<PhysicsClock>().substeps = substeps;
    let body = app.spawn((brick(), tumbling()));
    if let Some((clock, state, memory)) = from {
        let mut body = app.world_mut().entity_mut(body);
        body.insert((*state, memory.clone()));
        app.insert_resource(*clock);
    }
    app.play(ticks);
    app.world_mut()
        .remove_resource::<Copies>()
        .expect("there")
        .0
}

/// In a step, the clock has the values of the end of that step. A copy made there continues bit for bit.
#[test]
fn a_copy_made_in_last_continues_bit_for_bit() {
    for substeps in [1, 4] {
        let whole = recorded(substeps, 30, None);
        for (k, (clock, ..)) in whole.iter().enumerate() {
            let (steps, n) = (k as u32 + 1, substeps);
            assert_eq!(clock.steps(), u64::from(steps));
            assert_eq!(clock.elapsed(), tick() * (steps / n));
            let into = f64::from(steps % n) * clock.step();
            assert_eq!(clock.time(), clock.elapsed().as_secs_f64() + into);
        }
        for k in [0, 5, 6, 7, 8, 20] {
            let rest = &whole[k + 1..];
            let again = recorded(substeps, 30, Some(&whole[k]));
            assert!(
                again[..rest.len()] == *rest,
                "{substeps} substeps, from step {k}"
            );
        }
    }
}

/// If the physics runs in `Update`, a single step has the length of its ticks, not that of `Time<Fixed>`.
#[test]
fn a_single_step_is_one_of_the_schedule_of_the_physics() {
    use core::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    let frame = Duration::from_millis(5);
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::in_schedule(Update)))
        .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    app.update();
    app.spawn((brick(), tumbling()));
    let step = |app: &mut App| {
        app.step(2);
        app.clock()
    };
    app.update();
    let before = app.clock();
    assert_eq!((before.steps(), before.elapsed()), (1, frame));
    app.pause();
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    app.update();
    let after = step(&mut app);
    assert_eq!((after.steps(), after.elapsed()), (3, 3 * frame));
    assert_eq!(after.step(), 0.005);
    // In the fixed loop a single step is one of its ticks.
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::in_schedule(FixedUpdate)))
        .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    assert_eq!(step(&mut app).step(), 1.0 / 64.0);
}
