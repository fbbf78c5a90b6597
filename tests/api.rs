//! The library from a user's view: scenes in `bsn!`, reflection, schedules, optional parts.

use std::any::TypeId;

use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy::reflect::ReflectFromReflect;
use bevy::scene::ScenePlugin;
use bevy::time::TimeUpdateStrategy;
use box_physics::error::InvalidValue;
use box_physics::floor::{ContactReport, ContactState, FloorOutcome};
use box_physics::plugin::Stage;
use box_physics::prelude::*;

mod world;

use world::{Play, app_with, brick};

/// A scene function: a brick that users patch further.
fn thrown_brick(height: f64) -> impl Scene {
    bsn! {
        template_value(brick())
        BodyState { position: {DVec3::Y * height}, velocity: {DVec3::X * 2.0} }
        LinearDrag(0.1)
        BodyIntegrator(Integrator::Exact)
        ReportContacts
    }
}

#[test]
fn bodies_in_scenes() {
    let mut app = app_with((
        AssetPlugin::default(),
        ScenePlugin,
        PhysicsPlugins::default(),
    ));
    let world = app.world_mut();
    let plain = world
        .spawn_scene(bsn! {
            #Plain
            RigidBox
            Transform { translation: Vec3 { y: 3.0 } }
            GravityScale(0.5)
        })
        .expect("no assets to wait for")
        .id();
    let patched = world
        .spawn_scene(bsn! {
            thrown_brick(7.0)
            BodyState { velocity: DVec3 { z: 1.0 } }
            ExternalForce { force: {DVec3::Y * 3.0} }
            BodyTorque({DVec3::X})
            QuadraticDrag(0.25)
            AngularDamping(0.5)
            AngularDrag(0.125)
            PointForces({vec![PointForce { force: DVec3::Y, frame: Frame::Body, ..default() }]})
            Springs({vec![Spring { stiffness: 20.0, ..default() }]})
        })
        .expect("no assets to wait for")
        .id();
    let entity = app.world().entity(patched);
    let state = *entity.get::<BodyState>().expect("in the scene");
    assert_eq!(state.position, DVec3::Y * 7.0, "from the function");
    assert_eq!(state.velocity, DVec3::new(2.0, 0.0, 1.0), "patched");
    assert_eq!(entity.get::<RigidBox>(), Some(&brick()));
    assert_eq!(
        entity.get::<BodyIntegrator>(),
        Some(&BodyIntegrator(Integrator::Exact))
    );
    assert_eq!(entity.get::<LinearDrag>(), Some(&LinearDrag(0.1)));
    assert_eq!(entity.get::<QuadraticDrag>(), Some(&QuadraticDrag(0.25)));
    assert_eq!(entity.get::<AngularDamping>(), Some(&AngularDamping(0.5)));
    assert_eq!(entity.get::<AngularDrag>(), Some(&AngularDrag(0.125)));
    assert_eq!(entity.get::<BodyTorque>(), Some(&BodyTorque(DVec3::X)));
    let external = entity.get::<ExternalForce>().expect("in the scene");
    assert_eq!((external.force.y, external.torque), (3.0, DVec3::ZERO));
    let thrusters = &entity.get::<PointForces>().expect("in the scene").0;
    assert_eq!(thrusters[0].frame, Frame::Body);
    let springs = &entity.get::<Springs>().expect("in the scene").0;
    assert_eq!((springs.len(), springs[0].stiffness), (1, 20.0));
    assert!(entity.contains::<ReportContacts>() && entity.contains::<IntegratorMemory>());
    assert_eq!(
        app.world().get::<GravityScale>(plain),
        Some(&GravityScale(0.5))
    );
    app.update();
    let fell = app.get::<BodyState>(plain);
    assert!(fell.position.y < 3.0 && fell.position.y > 2.9);
}

#[test]
fn everything_that_can_be_named_is_registered() {
    macro_rules! list {
        [type $($Type:ty),+ $(,)?] => { [$((stringify!($Type), TypeId::of::<$Type>())),+] };
    }
    let components = list![
        type RigidBox, BodyState, IntegratorMemory, ContactState, BodyIntegrator, GravityScale, LinearDrag,
        QuadraticDrag, AngularDamping, AngularDrag, ExternalForce, OneShotForce, BodyTorque, PointForces,
        Springs, WorldAabb, ReportContacts, ReportPersisting, RestingSince, Quarantined,
    ];
    let resources = list![
        type WorldGravity, GlobalIntegrator, PhysicsClock, PhysicsTimings, Floor, ContactSettings,
        PhysicsThreads,
    ];
    let others = list![
        type ApplyImpulse, FloorContact, BodyQuarantined, QuarantineCause, ImpulsePoint, ContactPhase,
        PointForce, Spring, Frame, Integrator, FloorOutcome, Stage, Dissipation, Wrench,
        box_physics::force::Gravity, Explosion, ContactReport, Landed, Settled, Woken,
    ];
    let app = app_with(PhysicsPlugins::default());
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let entry = |(name, id): &(&str, TypeId)| {
        let entry = registry.get(*id);
        entry.unwrap_or_else(|| panic!("{name} is not registered"))
    };
    for named in &components {
        let (entry, name) = (entry(named), named.0);
        assert!(entry.data::<ReflectComponent>().is_some(), "{name}");
        assert!(entry.data::<ReflectDefault>().is_some(), "{name}");
        assert!(entry.data::<ReflectFromReflect>().is_some(), "{name}");
    }
    for named in &resources {
        let (entry, name) = (entry(named), named.0);
        assert!(entry.data::<ReflectResource>().is_some(), "{name}");
        assert!(entry.data::<ReflectDefault>().is_some(), "{name}");
    }
    for named in &others {
        let entry = entry(named);
        assert!(entry.data::<ReflectComponent>().is_none(), "{}", named.0);
    }
}

/// An inspector writes through reflection. The box itself is opaque, so that mass and inertia agree.
#[test]
fn reflection_reads_and_writes() {
    let mut state = BodyState::default();
    *state
        .path_mut::<f64>(".velocity.y")
        .expect("a field of a field") = 4.0;
    assert_eq!(state.velocity.y, 4.0);
    let mut floor = Floor::default();
    *floor.path_mut::<f64>(".friction").expect("a field") = 0.9;
    assert_eq!(floor.friction, 0.9);
    assert!(brick().reflect_path(".mass").is_err());
}

#[test]
fn the_floor_can_be_left_out() {
    let mut app = app_with(PhysicsPlugins::default().build().disable::<FloorPlugin>());
    // A Floor inserted by other code must have no effect either.
    app.insert_resource(Floor::default())
        .insert_resource(Time::<Fixed>::from_hz(64.0));
    let lying = BodyState::at(DVec3::Y * 0.25);
    let entity = app.spawn((brick(), lying, ReportContacts));
    app.play(64);
    assert!(app.world().get::<ContactState>(entity).is_none());
    let state = app.get::<BodyState>(entity);
    assert!(
        (state.position.y - (0.25 - 0.5 * 9.81)).abs() < 1e-9,
        "free fall"
    );
}

#[test]
fn plugins_in_any_order_and_in_any_schedule() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        PhysicsDiagnosticsPlugin,
        AabbPlugin,
        FloorPlugin,
        PhysicsPlugin::in_schedule(FixedUpdate),
    ))
    .insert_resource(Floor::default())
    .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.update();
    let start = BodyState::at(DVec3::Y * 1.25);
    let entity = app.spawn((brick(), start));
    app.play(200);
    let world = app.world();
    let state = world.get::<BodyState>(entity).expect("a body");
    assert!((state.position.y - 0.25).abs() < 1e-9, "on the floor");
    let aabb = world.get::<WorldAabb>(entity).expect("comes along").0;
    assert!((aabb.min.y).abs() < 1e-6 && (aabb.max.y - 0.5).abs() < 1e-6);
    assert!(world.resource::<PhysicsTimings>().total() > 0);
}

#[test]
fn errors_are_bevy_errors() {
    fn setup() -> Result<RigidBox, BevyError> {
        Ok(RigidBox::new(Vec3::ONE, -1.0)?)
    }
    assert!(setup().unwrap_err().to_string().contains("mass must be"));
    let error: InvalidValue = LinearDrag::new(-1.0).unwrap_err();
    assert_eq!(error.field, "linear drag");
}

/// Every integrator continues bit for bit from a state saved in flight, during a bounce and at rest.
#[cfg(feature = "serde")]
#[test]
fn saved_bodies_continue_bit_for_bit_under_every_integrator() {
    type Saved = (RigidBox, BodyState, IntegratorMemory, ContactState);
    fn new_app(integrator: Integrator) -> App {
        let mut app = app_with(PhysicsPlugins::default());
        app.insert_resource(Floor::default())
            .insert_resource(GlobalIntegrator(integrator));
        app
    }
    fn states(app: &mut App) -> Vec<BodyState> {
        let mut all = app.world_mut().query::<&BodyState>();
        all.iter(app.world()).copied().collect()
    }
    for &integrator in Integrator::ALL {
        let mut first = new_app(integrator);
        for k in 0_u8..6 {
            let state = BodyState::at(DVec3::new(0.0, 0.25 + 0.4 * f64::from(k), 0.0))
                .with_angular_velocity(&brick(), DVec3::new(1.0, 2.0, 0.5) * f64::from(k));
            first.spawn((brick(), state));
        }
        first.play(40);
        let mut all = first
            .world_mut()
            .query::<(&RigidBox, &BodyState, &IntegratorMemory, &ContactState)>();
        let saved: Vec<Saved> = all
            .iter(first.world())
            .map(|(b, s, m, c)| (*b, *s, m.clone(), c.clone()))
            .collect();
        let text = ron::to_string(&saved).expect("RON takes all of it");
        let loaded: Vec<Saved> = ron::from_str(&text).expect("what was written");
        assert_eq!(loaded, saved, "{integrator}");
        let mut second = new_app(integrator);
        second.world_mut().spawn_batch(loaded);
        for step in 0..80 {
            first.update();
            second.update();
            assert_eq!(
                states(&mut first),
                states(&mut second),
                "{integrator}, step {step}"
            );
        }
    }
    let id = ron::to_string(&Integrator::Heun2012).expect("a text");
    assert_eq!(id, "\"heun-2012\"");
    assert!(ron::from_str::<Integrator>("\"leapfrog\"").is_err());
}
