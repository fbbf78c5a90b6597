use super::*;
use std::time::Duration;

use bevy::prelude::{Entity, With};
use box_physics::plugin::{BodyTorque, ExternalForce, PointForces, Springs};

use crate::bodies::Situation;
use crate::plugin_world::PluginWorld;

fn snapshot(situation: Situation, n: usize) -> Snapshot {
    let bodies = situation.bodies(n);
    let forces = ForceSet {
        gravity: situation.gravity(),
        ..ForceSet::none()
    };
    let floor = situation.floor().map(|f| (f, ContactSettings::default()));
    let bodies = bodies.iter().map(|(b, s)| (b, s, ContactState::default()));
    Snapshot::new(bodies, &forces, floor, 1.0 / 60.0).expect("bodies")
}

/// A call has the same bits as the steps of the plugin, for one, few and many bodies, in flight, near the floor and on
/// it, under gravity alone and with torques, point forces and springs.
#[test]
fn it_steps_as_the_plugin_does() {
    for situation in [
        Situation::Flight,
        Situation::Near,
        Situation::Settling,
        Situation::Rest,
    ] {
        let forces = ForceSet {
            body_torque: DVec3::X * 0.2,
            world_torque: DVec3::Z * 0.1,
            ..ForceSet::none()
        }
        .with_dipole(DVec3::Y, DVec3::X * 0.3)
        .with_spring(DVec3::splat(0.1), DVec3::Y, 0.1, 0.0);
        // Below and above the number of bodies that are stepped together under forces.
        for n in [1, 9, 40] {
            same_as_the_plugin(situation, n, ForceSet::none());
            same_as_the_plugin(situation, n, forces.clone());
        }
    }
}

fn same_as_the_plugin(situation: Situation, n: usize, forces: ForceSet) {
    let mut snapshot = snapshot(situation, n);
    // The clock's step, which is a whole number of nanoseconds.
    snapshot.h = Duration::from_nanos(16_666_667).as_secs_f64();
    let mut plugin = PluginWorld::new(situation, Integrator::Split, n);
    plugin.restart();
    let world = plugin.app().world_mut();
    if forces.has_wrench() {
        let mut bodies = world.query_filtered::<Entity, With<RigidBox>>();
        for entity in bodies.iter(world).collect::<Vec<_>>() {
            world.entity_mut(entity).insert((
                ExternalForce {
                    torque: forces.world_torque,
                    ..ExternalForce::default()
                },
                BodyTorque(forces.body_torque),
                PointForces(forces.point_forces.clone()),
                Springs(forces.springs.clone()),
            ));
        }
        let gravity = situation.gravity();
        snapshot.forces = ForceSet { gravity, ..forces };
    }
    snapshot.call(Integrator::Split);
    for _ in 0..snapshot.steps {
        plugin.step();
    }
    let world = plugin.app().world_mut();
    let mut states: Vec<_> = world.query::<&BodyState>().iter(world).copied().collect();
    let by_place = |a: &BodyState, b: &BodyState| {
        let key = |s: &BodyState| ((s.position.z / 4.0).round(), (s.position.x / 4.0).round());
        key(a).partial_cmp(&key(b)).expect("finite")
    };
    states.sort_by(by_place);
    let mut ours = snapshot.states.clone();
    ours.sort_by(by_place);
    assert_eq!(states, ours, "{n} bodies: {}", situation.name());
}

#[test]
fn every_integrator_can_be_timed_anywhere() {
    for situation in Situation::ALL {
        let mut snapshot = snapshot(situation, 3);
        for &i in Integrator::ALL {
            let shortest = Settings {
                shortest_sample: Duration::from_nanos(1),
                ..Settings::default()
            };
            let s = snapshot.sample(i, &shortest);
            assert!(s.nanoseconds > 0.0 && s.nanoseconds.is_finite(), "{i}");
            // A box at rest needs no evaluations.
            let moves = situation != Situation::Rest;
            assert!(s.evaluations >= 1.0 || !moves, "{i}: {}", situation.name());
        }
    }
    let none = std::iter::empty::<(&RigidBox, &BodyState, ContactState)>();
    assert!(Snapshot::new(none, &ForceSet::none(), None, 0.1).is_none());
}
