//! Three ways to add your own forces. `cargo run --release --example own_forces`
//!
//! 1. Constant over a step: write [`ExternalForce`] in [`PhysicsSystems::Forces`].
//! 2. State-dependent and built in: [`Springs`], [`PointForces`] and drag, evaluated at every stage.
//! 3. State-dependent and custom: implement [`ForceModel`] and step the core with it. The integrator
//!    evaluates it at every stage, so it keeps its order.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// Applies gusts of wind.
fn wind(clock: Res<PhysicsClock>, mut bodies: Query<&mut ExternalForce>) {
    let gust = if clock.time() % 2.0 < 1.0 { 3.0 } else { 0.0 };
    for mut external in &mut bodies {
        external.force = DVec3::X * gust; // N
    }
}

/// A planet at the origin: a = −µ x/|x|³ on the center of mass.
struct Planet {
    /// µ = G M [m³/s²]
    strength: f64,
}

impl ForceModel for Planet {
    fn acceleration(&self) -> DVec3 {
        DVec3::ZERO
    }

    fn has_wrench(&self) -> bool {
        true
    }

    fn wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        let x = state.position;
        Wrench {
            force: -body.mass() * self.strength * x / x.length().powi(3),
            torque: DVec3::ZERO,
        }
    }
}

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(PhysicsSchedule, wind.in_set(PhysicsSystems::Forces));
    let leaf = (
        RigidBox::default(),
        Transform::from_xyz(0.0, 1e3, 0.0),
        ExternalForce::default(),
        LinearDrag(0.5),
        AngularDamping(0.1),
    );
    let leaf = app.world_mut().spawn(leaf).id();
    for _ in 0..256 {
        app.update();
    }
    let state = app.world().get::<BodyState>(leaf).expect("a body");
    println!("the wind took the leaf {:.2} m", state.position.x);
    assert!(state.position.x > 1.0);

    // A satellite on a circle of radius 10 m: v = √(µ/r), and a period of 2π r/v.
    let (body, law) = (RigidBox::default(), Planet { strength: 40.0 });
    let start = BodyState::at(DVec3::X * 10.0).with_velocity(DVec3::Z * 2.0);
    let (mut state, mut memory) = (start, IntegratorMemory::default());
    let (period, steps) = (core::f64::consts::TAU * 5.0, 2000);
    for _ in 0..steps {
        let h = period / f64::from(steps);
        Integrator::Split4.step(&body, &mut state, &law, h, &mut memory);
    }
    let miss = (state.position - start.position).length();
    println!("after one orbit the satellite is {miss:.1e} m from where it began");
    assert!(miss < 1e-6);
}
