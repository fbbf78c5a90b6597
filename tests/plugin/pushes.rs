//! Impulses, forces for one tick, queries of whole bodies, and commands that move bodies.

use bevy::prelude::*;
use box_physics::force::Forces;
use box_physics::prelude::*;

use super::{FREE, Play, app, brick, core, tumbling};

fn floating<B: Bundle>(bundle: B) -> (App, Entity) {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let entity = app.spawn((brick(), tumbling(), bundle));
    (app, entity)
}

#[test]
fn a_torque_impulse_changes_the_spin_alone() {
    let (mut app, entity) = floating(());
    let push = DVec3::new(0.5, -1.0, 2.0);
    app.send(ApplyImpulse::angular(entity, push));
    app.update();
    let mut expected = tumbling();
    expected.apply_angular_impulse(push);
    let before = tumbling().angular_momentum_world();
    assert!((expected.angular_momentum_world() - before - push).length() < 1e-12);
    core(Integrator::Split, &mut expected, &FREE, 1);
    assert_eq!(app.state(entity), expected);
}

/// The impulse is J (1 − d/R)^p at the closest point of the box, away from the center.
#[test]
fn an_explosion_pushes_away_and_spins() {
    let mut world = World::new();
    let start = BodyState::at(DVec3::new(3.0, 0.1, 0.0));
    let entity = world.spawn((brick(), start)).id();
    let push = |world: &mut World, explosion: Explosion| {
        let mut bodies = world.query::<BodyRef>();
        ApplyImpulse::radial(&bodies.get(world, entity).expect("a body"), &explosion)
    };
    let bomb = Explosion {
        center: DVec3::ZERO,
        radius: 5.0,
        impulse: 12.0,
        falloff: 2.0,
    };
    // The face at x = 2.5 is closest, at the height of the bomb: 0.1 below the center.
    let hit = push(&mut world, bomb).expect("within reach");
    let strength = 12.0 * (1.0 - 2.5 / 5.0_f64).powi(2);
    assert!((hit.impulse - DVec3::X * strength).length() < 1e-12);
    let mut after = start;
    hit.apply(&brick(), &mut after);
    assert!((after.velocity - DVec3::X * strength / 3.0).length() < 1e-12);
    assert!((after.angular_momentum - DVec3::Z * 0.1 * strength).length() < 1e-12);
    assert_eq!(
        push(
            &mut world,
            Explosion {
                radius: 2.5,
                ..bomb
            }
        ),
        None
    );
    let constant = push(
        &mut world,
        Explosion {
            falloff: 0.0,
            ..bomb
        },
    )
    .expect("within reach");
    assert!((constant.impulse.length() - 12.0).abs() < 1e-12);
    // Inside the box, the impulse acts through its center, even without a direction.
    let within = push(
        &mut world,
        Explosion {
            center: DVec3::X * 2.9,
            ..bomb
        },
    )
    .expect("within");
    assert!(within.impulse.x > 0.0 && within.at == ImpulsePoint::Body(DVec3::ZERO));
    let center = Explosion {
        center: start.position,
        ..bomb
    };
    assert_eq!(
        push(&mut world, center).expect("within").impulse,
        DVec3::Y * 12.0
    );
}

/// The force acts in all substeps of one tick, at the order of a constant force, and then ends.
#[test]
fn a_one_shot_force_lasts_for_one_tick() {
    let (mut app, entity) = floating(OneShotForce::default());
    app.world_mut().resource_mut::<PhysicsClock>().substeps = 3;
    let (force, torque) = (DVec3::new(3.0, -6.0, 0.0), DVec3::new(0.1, 0.2, -0.3));
    for _ in 0..2 {
        // Forces of two systems are added.
        let mut one_shot = app.edit::<OneShotForce>(entity);
        one_shot.force += 0.5 * force;
        one_shot.torque += 0.5 * torque;
    }
    app.update();
    let shot = Forces {
        acceleration: force * brick().inverse_mass(),
        world_torque: torque,
        ..default()
    };
    let mut expected = tumbling();
    let mut memory = IntegratorMemory::default();
    let h = super::tick().as_secs_f64() / 3.0;
    for _ in 0..3 {
        Integrator::Split.step(&brick(), &mut expected, &shot, h, &mut memory);
    }
    assert_eq!(app.state(entity), expected);
    assert_eq!(
        app.world().get::<OneShotForce>(entity),
        Some(&OneShotForce::default())
    );
    let velocity = expected.velocity;
    app.update();
    assert_eq!(app.state(entity).velocity, velocity);
}

/// All values are in world axes, and writing wakes a sleeping body.
#[test]
fn a_body_is_read_and_pushed_by_one_query() {
    let mut app = app();
    app.insert_resource(Floor::default());
    let entity = app.spawn((brick(), BodyState::at(DVec3::Y * 0.25)));
    app.play(20);
    let mut bodies = app.world_mut().query::<BodyMut>();
    let mut body = bodies.get_mut(app.world_mut(), entity).expect("a body");
    let spin = DVec3::new(0.5, -1.0, 2.0);
    body.rotation = tumbling().rotation;
    body.set_angular_velocity(spin);
    assert!((body.angular_velocity() - spin).length() < 1e-12);
    let point = body.position + DVec3::new(0.1, 0.4, -0.2);
    let before = body.velocity_at(point);
    let (mut expected, impulse) = (*body.state, DVec3::new(1.0, 9.0, -2.0));
    expected.apply_impulse(&brick(), impulse, point);
    expected.apply_angular_impulse(DVec3::X);
    expected.velocity += DVec3::Y;
    body.apply_impulse_at(impulse, point);
    body.apply_angular_impulse(DVec3::X);
    body.apply_impulse(DVec3::Y * 3.0);
    assert!((body.velocity - expected.velocity).length() < 1e-12);
    assert!((body.angular_momentum - expected.angular_momentum).length() < 1e-12);
    assert!((body.velocity_at(point) - before).length() > 1.0);
    app.update();
    assert!(app.state(entity).velocity.y > 3.0, "it woke");
    let mut bodies = app.world_mut().query::<BodyRef>();
    let body = bodies.get(app.world(), entity).expect("a body");
    assert_eq!(body.kinetic_energy(), body.state.kinetic_energy(&brick()));
}

/// By `Transform` or by command, velocity and spin keep their world axes unless requested otherwise.
#[test]
fn turning_a_body_keeps_velocity_and_spin_in_the_chosen_axes() {
    let turned = Quat::from_rotation_x(1.0) * Quat::from_rotation_y(0.5);
    let ways = [
        (false, Frame::World),
        (true, Frame::World),
        (true, Frame::Body),
    ];
    for (by_command, spin) in ways {
        let (mut app, entity) = floating(());
        app.update();
        let mut expected = app.state(entity);
        if by_command {
            expected.position = DVec3::ONE;
        }
        let there = Teleport::to(entity, expected.position).turned(turned.as_dquat());
        expected.turn_to(&brick(), turned.as_dquat(), spin);
        match (by_command, spin) {
            (false, _) => app.edit::<Transform>(entity).rotation = turned,
            (true, Frame::World) => app.queue(there),
            (true, Frame::Body) => app.queue(there.with_body_spin()),
        }
        if by_command {
            // It is shown at once.
            assert_eq!(app.state(entity), expected);
            let shown = Transform::from_translation(Vec3::ONE);
            let shown = shown.with_rotation(expected.rotation.as_quat());
            assert_eq!(*app.get::<Transform>(entity), shown);
        }
        // An invalid pose or an entity that is not a body changes nothing.
        app.queue(Teleport::to(entity, DVec3::NAN));
        app.queue(Teleport::to(Entity::PLACEHOLDER, DVec3::ONE));
        app.update();
        core(Integrator::Split, &mut expected, &FREE, 1);
        assert_eq!(app.state(entity), expected, "{by_command} {spin:?}");
    }
}

/// Passing forward and back returns to the start. As seen from the portal, the motion does not change.
#[test]
fn a_portal_turns_position_velocity_and_spin_together() {
    let (mut app, entity) = floating(());
    let entrance = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_y(0.7));
    let exit = Transform::from_xyz(-5.0, 1.0, 40.0).with_rotation(Quat::from_rotation_z(2.0));
    let before = app.state(entity);
    let pass = |app: &mut App, entrance, exit| {
        let portal = PassPortal {
            entity,
            entrance,
            exit,
        };
        app.queue(portal);
        app.state(entity)
    };
    let after = pass(&mut app, entrance, exit);
    let seen = |state: &BodyState, from: &Transform| {
        let back = from.rotation.as_dquat().normalize().inverse();
        [
            back * (state.position - from.translation.as_dvec3()),
            back * state.velocity,
            back * state.angular_velocity(&brick()),
            back * (state.rotation * DVec3::X),
        ]
    };
    for (was, is) in seen(&before, &entrance)
        .into_iter()
        .zip(seen(&after, &exit))
    {
        assert!(
            (was - is).length() < 1e-5 * (1.0 + was.length()),
            "{was} {is}"
        );
    }
    let shown = app.get::<Transform>(entity).translation;
    assert_eq!(shown, after.position.as_vec3());
    let back = pass(&mut app, exit, entrance);
    assert!((back.position - before.position).length() < 1e-9);
    assert!((back.velocity - before.velocity).length() < 1e-12);
    assert!(back.attitude_difference(&before) < 1e-12);
}
