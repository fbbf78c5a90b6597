//! NaN and infinity in every component that users can write.

use bevy::math::bounding::Aabb3d;
use bevy::prelude::*;
use box_physics::prelude::*;

use super::{Log, Play, app, assert_shown_sanely, brick, tumbling};

type Poison = fn(&mut EntityWorldMut);
const NAN: DVec3 = DVec3::NAN;

#[rustfmt::skip]
fn poisons() -> Vec<(&'static str, Poison)> {
    fn poison<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        e: &mut EntityWorldMut,
        f: fn(&mut C),
    ) {
        f(&mut e.get_mut::<C>().expect("there"));
    }
    vec![
        ("position", |e| { poison::<BodyState>(e, |s| s.position.y = f64::NAN); }),
        ("rotation", |e| { poison::<BodyState>(e, |s| s.rotation.w = f64::INFINITY); }),
        ("rotation of length 0", |e| {
            poison::<BodyState>(e, |s| s.rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        }),
        ("velocity", |e| poison::<BodyState>(e, |s| s.velocity = NAN)),
        ("momentum", |e| { poison::<BodyState>(e, |s| s.angular_momentum.x = f64::NEG_INFINITY); }),
        ("everything", |e| {
            poison::<BodyState>(e, |s| {
                *s = BodyState { position: NAN, rotation: DQuat::NAN, velocity: NAN, angular_momentum: NAN };
            });
        }),
        ("velocity beyond 1e38", |e| { poison::<BodyState>(e, |s| s.velocity.z = 1e39); }),
        ("translation", |e| { poison::<Transform>(e, |t| t.translation = Vec3::NAN); }),
        ("quaternion", |e| { poison::<Transform>(e, |t| t.rotation = Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0)); }),
        ("quaternion of length 0", |e| {
            poison::<Transform>(e, |t| t.rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        }),
        ("GravityScale", |e| { e.insert(GravityScale(f64::NAN)); }),
        ("LinearDrag", |e| { e.insert(LinearDrag(f64::NAN)); }),
        ("LinearDrag infinite", |e| { e.insert(LinearDrag(f64::INFINITY)); }),
        ("QuadraticDrag", |e| { e.insert(QuadraticDrag(f64::NAN)); }),
        ("AngularDamping", |e| { e.insert(AngularDamping(f64::NAN)); }),
        ("AngularDrag", |e| { e.insert(AngularDrag(f64::NAN)); }),
        ("force", |e| { e.insert(ExternalForce { force: NAN, torque: DVec3::ZERO }); }),
        ("torque", |e| { e.insert(ExternalForce { force: DVec3::ZERO, torque: NAN }); }),
        ("BodyTorque", |e| { e.insert(BodyTorque(NAN)); }),
        ("PointForces", |e| {
            e.insert(PointForces(vec![PointForce { body_point: NAN, force: DVec3::X, ..default() }]));
        }),
        ("Springs", |e| { e.insert(Springs(vec![Spring { stiffness: f64::NAN, damping: 1.0, ..default() }])); }),
        ("damper", |e| { e.insert(Springs(vec![Spring { stiffness: 1.0, damping: f64::NAN, ..default() }])); }),
        ("WorldAabb", |e| { e.insert(WorldAabb(Aabb3d { min: Vec3::NAN.into(), max: Vec3::NAN.into() })); }),
    ]
}

#[test]
fn nan_in_every_component() {
    let log = Log::start();
    for integrator in [
        Integrator::Split,
        Integrator::Exact,
        Integrator::Rk4,
        Integrator::BackwardEuler,
    ] {
        for with_floor in [false, true] {
            let poisoned = |poison: Option<Poison>| {
                let mut app = app();
                app.insert_resource(GlobalIntegrator(integrator));
                if with_floor {
                    app.insert_resource(Floor::default());
                }
                let ids = [tumbling(), BodyState::at(DVec3::Y * 0.3), tumbling()]
                    .map(|start| app.spawn((brick(), start)));
                app.play(3);
                if let Some(poison) = poison {
                    poison(&mut app.entity(ids[1]));
                }
                app.play(20);
                assert_shown_sanely(&mut app);
                let aabb = app.get::<WorldAabb>(ids[1]).0;
                assert!(aabb.min.is_finite() && aabb.max.is_finite());
                [app.state(ids[0]), app.state(ids[2])]
            };
            let clean = poisoned(None);
            log.is_silent();
            for (name, poison) in poisons() {
                assert_eq!(poisoned(Some(poison)), clean, "{name}: neighbors notice");
                let lines = log.take();
                assert!(lines.len() <= 1, "{name}: {lines:#?}");
                if name != "WorldAabb" {
                    assert_eq!(lines.len(), 1, "{integrator}, {name}: said nothing");
                }
            }
        }
    }
}

#[test]
fn a_body_that_starts_invalid() {
    let log = Log::start();
    for transform in [
        Transform::from_xyz(1.0, 2.0, 3.0),
        Transform::from_xyz(f32::NAN, 2.0, 3.0),
    ] {
        let mut app = app();
        let bad = BodyState {
            position: NAN,
            ..tumbling()
        };
        let entity = app.spawn((brick(), bad, transform));
        app.play(3);
        assert_shown_sanely(&mut app);
        let shown = Some(transform.translation).filter(|place| place.is_finite());
        assert_eq!(
            app.state(entity).position.as_vec3(),
            shown.unwrap_or_default()
        );
        assert!(app.world().get::<Quarantined>(entity).is_some());
        let lines = log.take();
        assert!((1..=2).contains(&lines.len()), "{lines:#?}");
        assert!(
            lines.iter().any(|l| l.contains("is quarantined")),
            "{lines:#?}"
        );
        // Writing a state cannot make a quarantined body display invalid numbers.
        *app.edit(entity) = bad;
        app.play(3);
        assert_shown_sanely(&mut app);
        log.is_silent();
    }
}

#[test]
fn a_thousand_quarantines_are_one_line() {
    let log = Log::start();
    let mut app = app();
    for _ in 0..1000 {
        app.spawn((brick(), tumbling(), GravityScale(f64::NAN)));
    }
    app.update();
    log.says_once("999 more with it");
    let told: Vec<_> = app.drain::<BodyQuarantined>();
    assert_eq!(told.len(), 1000);
    assert!(told.iter().all(|m| m.cause == QuarantineCause::Step));
    app.play(3);
    log.is_silent();
}

/// An invalid coefficient from any source is logged once with entity, field and value, and the body moves as
/// without it. Once it is valid again, it takes effect.
#[test]
fn an_invalid_coefficient_is_logged_and_does_not_act() {
    type Insert = fn(&mut EntityWorldMut, f64);
    #[rustfmt::skip]
    let coefficients: [(&str, Insert); 6] = [
        ("linear drag", |e, c| { e.insert(LinearDrag(c)); }),
        ("quadratic drag", |e, c| { e.insert(QuadraticDrag(c)); }),
        ("angular damping", |e, c| { e.insert(AngularDamping(c)); }),
        ("angular drag", |e, c| { e.insert(AngularDrag(c)); }),
        ("spring stiffness", |e, c| { e.insert(Springs(vec![Spring { stiffness: c, ..default() }])); }),
        ("spring damping", |e, c| { e.insert(Springs(vec![Spring { damping: c, ..default() }])); }),
    ];
    let log = Log::start();
    let mut plain = app();
    let free = plain.spawn((brick(), tumbling()));
    plain.play(10);
    for (field, insert) in coefficients {
        for value in [-0.5, f64::NAN, f64::INFINITY] {
            let mut app = app();
            let body = app.spawn((brick(), tumbling()));
            insert(&mut app.entity(body), value);
            app.play(10);
            let lines = log.take();
            let expected =
                format!("{body}: {field} must be finite and not negative, but is {value}");
            assert!(
                lines.len() == 1 && lines[0].contains(&expected),
                "{lines:?}"
            );
            let (now, without) = (app.state(body), plain.state(free));
            assert!(
                (now.position - without.position).length() < 1e-12,
                "{field}: {value}"
            );
            assert!(
                now.attitude_difference(&without) < 1e-12,
                "{field}: {value}"
            );
            insert(&mut app.entity(body), 2.0);
            app.play(10);
            log.is_silent();
            assert!(app.world().get::<Quarantined>(body).is_none());
        }
    }
}

/// An invalid value that is written repeatedly is logged once; of many entities the first ten are named.
#[test]
fn an_invalid_value_does_not_flood_the_log() {
    let log = Log::start();
    let mut app = app();
    let body = app.spawn((brick(), tumbling(), LinearDrag(-1.0)));
    app.add_systems(FixedUpdate, |mut drags: Query<&mut LinearDrag>| {
        drags.iter_mut().for_each(|mut drag| drag.0 *= 1.5);
    });
    app.play(20);
    log.says_once(&body.to_string());
    for _ in 0..100 {
        app.spawn((brick(), tumbling(), LinearDrag(-1.0)));
    }
    app.play(5);
    let lines = log.take();
    assert!(
        lines.len() == 9 && lines[8].contains("further ones"),
        "{lines:#?}"
    );
}

/// The material of a plane is checked like that of a body.
#[test]
fn an_invalid_material_of_a_plane_is_logged() {
    let log = Log::start();
    let mut app = app();
    let wall = StaticPlane::new(DVec3::ZERO, DVec3::X).expect("valid");
    let restitution = Restitution {
        coefficient: 2.0,
        ..default()
    };
    let wall = app.spawn((wall, restitution));
    app.play(5);
    log.says_once(&format!(
        "{wall}: coefficient must be between 0 and 1, but is 2"
    ));
    app.edit::<StaticPlane>(wall).velocity.x = f64::NAN;
    app.play(5);
    log.says_once(&format!("{wall}: velocity must be finite, but is NaN"));
}

/// An invalid material is logged once with entity, field and value, and counts as absent. A valid one acts.
#[test]
fn an_invalid_material_is_logged_and_does_not_act() {
    type Insert = fn(&mut EntityWorldMut, f64);
    let coefficient = "finite and not negative";
    #[rustfmt::skip]
    let materials: [(&str, &str, Insert); 3] = [
        ("dynamic_coefficient", coefficient, |e, c| {
            e.insert(Friction { dynamic_coefficient: c, ..default() });
        }),
        ("static_coefficient", coefficient, |e, c| {
            e.insert(Friction { static_coefficient: c, dynamic_coefficient: 0.9, ..default() });
        }),
        ("coefficient", "between 0 and 1", |e, c| { e.insert(Restitution { coefficient: c, ..default() }); }),
    ];
    let log = Log::start();
    // Falls 0.75 m and slides on.
    let thrown = |insert: &dyn Fn(&mut EntityWorldMut)| {
        let mut app = app();
        app.insert_resource(Floor::default());
        let start = BodyState::at(DVec3::Y).with_velocity(DVec3::X * 10.0);
        let body = app.spawn((brick(), start));
        insert(&mut app.entity(body));
        app.play(60);
        (body, app.state(body))
    };
    let (_, without) = thrown(&|_| {});
    for (field, allowed, insert) in materials {
        for value in [-0.5, f64::NAN, f64::INFINITY] {
            let (body, after) = thrown(&|e| insert(e, value));
            let lines = log.take();
            let expected = format!("{body}: {field} must be {allowed}, but is {value}");
            assert!(
                lines.len() == 1 && lines[0].contains(&expected),
                "{lines:?}"
            );
            assert_eq!(after, without, "{field}: {value}");
        }
        let (_, with) = thrown(&|e| insert(e, 0.95));
        log.is_silent();
        assert!(
            (with.position - without.position).length() > 1e-3,
            "{field}"
        );
    }
}
