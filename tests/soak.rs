//! Hostile play at full speed. Bodies come and go and are pushed, poisoned, teleported and resized; the floor
//! moves and vanishes; integrators and settings change; the game pauses. No panic, no leak, no energy gain.
//! Every test run plays a minute; `BOX_SOAK_SECONDS=3600` plays an hour, `BOX_SOAK_SEED=…` another one.

use bevy::ecs::message::Messages;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::energy::total_energy;
use box_physics::floor::ContactState;
use box_physics::force::Forces;
use box_physics::prelude::*;

/// Updates per second of play.
const RATE: u32 = 60;
const MAX_BODIES: usize = 150;

/// SplitMix64 (Steele, Lea, Flood 2014): the same sequence in every run.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// [0, 1)
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 * libm::exp2(-53.0)
    }

    /// [−1, 1)³
    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    /// A number between 1/`r` and `r`, uniform in the logarithm.
    fn scale(&mut self, r: f64) -> f64 {
        libm::pow(r, 2.0 * self.unit() - 1.0)
    }

    fn body(&mut self) -> RigidBox {
        let size = self.scale(10.0);
        let half = DVec3::new(self.scale(10.0), self.scale(10.0), self.scale(10.0)) * (0.3 * size);
        RigidBox::new(half, self.scale(1000.0)).expect("in range")
    }

    fn state(&mut self, body: &RigidBox) -> BodyState {
        let q = self.vector();
        let mut state = BodyState::at_pose(
            self.vector() * 20.0 + DVec3::Y * 15.0,
            DQuat::from_xyzw(q.x, q.y, q.z, 0.5),
        )
        .with_velocity(self.vector() * self.scale(30.0));
        if self.chance(0.7) {
            state.set_angular_velocity(body, self.vector() * self.scale(30.0));
        }
        state
    }
}

fn bodies(app: &mut App) -> Vec<Entity> {
    let mut all = app.world_mut().query_filtered::<Entity, With<RigidBox>>();
    all.iter(app.world()).collect()
}

fn spawn(app: &mut App, dice: &mut Dice) {
    let body = dice.body();
    let state = dice.state(&body);
    let mut entity = app.world_mut().spawn((body, state));
    if dice.chance(0.5) {
        entity.insert(ReportContacts);
    }
}

/// Performs one hostile action.
fn act(app: &mut App, dice: &mut Dice, graveyard: &[Entity]) {
    let all = bodies(app);
    if all.is_empty() {
        return spawn(app, dice);
    }
    let one = all[dice.below(all.len())];
    let world = app.world_mut();
    match dice.below(24) {
        0..3 if all.len() < MAX_BODIES => {
            for _ in 0..dice.below(12) {
                spawn(app, dice);
            }
        }
        0..4 => {
            for _ in 0..dice.below(6) {
                if let Ok(entity) = world.get_entity_mut(all[dice.below(all.len())]) {
                    entity.despawn();
                }
            }
        }
        4..9 => {
            let entity = if dice.chance(0.05) && !graveyard.is_empty() {
                graveyard[dice.below(graveyard.len())]
            } else {
                one
            };
            let impulse = dice.vector() * dice.scale(1000.0);
            let impulse = if dice.chance(0.01) {
                DVec3::NAN
            } else {
                impulse
            };
            for _ in 0..dice.below(10) {
                world.write_message(ApplyImpulse::at_body_point(entity, impulse, dice.vector()));
            }
        }
        9 => {
            let any = Integrator::ALL[dice.below(Integrator::ALL.len())];
            world.insert_resource(GlobalIntegrator(any));
        }
        10 => {
            let any = Integrator::ALL[dice.below(Integrator::ALL.len())];
            world.entity_mut(one).insert(BodyIntegrator(any));
        }
        11 => {
            let mut clock = world.resource_mut::<PhysicsClock>();
            clock.paused = !clock.paused;
            world.commands().queue(StepPhysics(dice.below(4) as u32));
        }
        12 => {
            let height = dice.vector().y * 3.0;
            let floor = Floor::new(height, dice.unit(), dice.unit()).expect("in range");
            world.insert_resource(floor);
        }
        13 => {
            world.remove_resource::<Floor>();
        }
        14 => {
            // An earlier action of this frame may have removed it; the plugin restores it at the next tick.
            let Some(mut state) = world.get_mut::<BodyState>(one) else {
                return;
            };
            match dice.below(4) {
                0 => state.position.x = f64::NAN,
                1 => state.rotation = DQuat::from_xyzw(3.0, 0.0, 0.0, 0.0),
                2 => state.velocity.y = f64::INFINITY,
                _ => state.angular_momentum *= 1e300,
            }
        }
        15 => {
            let place = (dice.vector() * 10.0).as_vec3();
            let nowhere = dice.chance(0.1);
            let Some(mut transform) = world.get_mut::<Transform>(one) else {
                return;
            };
            transform.translation = if nowhere { Vec3::NAN } else { place };
        }
        16 => {
            for entity in all {
                world.entity_mut(entity).remove::<Quarantined>();
            }
        }
        17 => {
            let body = dice.body();
            world.entity_mut(one).insert(body);
        }
        18 => world.resource_mut::<PhysicsClock>().substeps = dice.below(4) as u32,
        19 => {
            let force = ExternalForce {
                force: dice.vector() * dice.scale(100.0),
                torque: dice.vector() * dice.scale(100.0),
            };
            world.entity_mut(one).insert(force);
        }
        20 => {
            let drag = [f64::NAN, 0.0, dice.scale(10.0), dice.scale(10.0)][dice.below(4)];
            world
                .entity_mut(one)
                .insert((LinearDrag(drag), QuadraticDrag(dice.scale(10.0))))
                .insert((AngularDamping(dice.unit()), AngularDrag(drag)));
        }
        21 => {
            let spring = Spring {
                body_point: dice.vector(),
                anchor: dice.vector() * 5.0,
                stiffness: dice.scale(1e4),
                damping: dice.scale(10.0),
            };
            world
                .entity_mut(one)
                .insert(Springs(vec![spring; dice.below(3)]));
        }
        22 => {
            let gravity = DVec3::new(0.0, -9.81 * dice.unit(), 0.0) + 0.3 * dice.vector();
            let gravity = if dice.chance(0.05) {
                DVec3::NAN
            } else {
                gravity
            };
            world.insert_resource(WorldGravity(gravity));
        }
        _ => {
            let mut entity = world.entity_mut(one);
            match dice.below(4) {
                0 => entity.remove::<IntegratorMemory>(),
                1 => entity.remove::<BodyState>(),
                2 => entity.remove::<Transform>(),
                _ => entity.remove::<ContactState>(),
            };
        }
    }
}

/// Three seconds without actions: no body may gain energy. Returns the largest gain of a body, and the number
/// of bodies observed.
fn rest(app: &mut App, dice: &mut Dice) -> (f64, usize) {
    // These two integrators conserve the energy of a spin at any step and add none at the floor. The second
    // does so only while the turn of a step has enough digits (see its file); the play makes spins of
    // 1e30 rad/s.
    let chosen = [Integrator::Exact, Integrator::ImplicitMidpoint][dice.below(2)];
    app.insert_resource(GlobalIntegrator(chosen));
    app.insert_resource(WorldGravity::default());
    app.world_mut().resource_mut::<PhysicsClock>().paused = false;
    for entity in bodies(app) {
        app.world_mut()
            .entity_mut(entity)
            .remove::<(BodyIntegrator, ExternalForce, Springs, Quarantined)>()
            .remove::<(LinearDrag, QuadraticDrag, AngularDamping, AngularDrag)>();
    }
    // Requests from before the pause take effect, and bodies in the floor are moved out.
    for _ in 0..2 {
        app.update();
    }
    let law = Forces {
        acceleration: WorldGravity::default().0,
        ..Forces::default()
    };
    let clock = *app.world().resource::<PhysicsClock>();
    let floor = app.world().get_resource::<Floor>().copied();
    let energies = |app: &mut App| -> Vec<(Entity, f64, f64, RigidBox, BodyState)> {
        let mut all = app
            .world_mut()
            .query_filtered::<(Entity, &RigidBox, &BodyState), Without<Quarantined>>();
        all.iter(app.world())
            .map(|(e, b, s)| {
                // The scale of the rounding: kinetic energy, and potential energy in both directions.
                let size =
                    s.kinetic_energy(b) + 9.81 * b.mass() * (s.position.length() + b.radius());
                (e, total_energy(b, s, &law), size, *b, *s)
            })
            .collect()
    };
    let before = energies(app);
    for _ in 0..3 * RATE {
        app.update();
    }
    let (mut worst, mut seen) = (f64::MIN, 0);
    for (entity, after, ..) in energies(app) {
        if let Some((_, energy, size, body, start)) = before.iter().find(|(e, ..)| *e == entity) {
            let turn = start.body_angular_velocity(body).length() / f64::from(RATE);
            if chosen == Integrator::ImplicitMidpoint && turn > 1e6 {
                continue;
            }
            let gain = (after - energy) / size;
            assert!(
                gain.is_finite() && gain < 1e-9,
                "{chosen}: from {energy} to {after} J, {gain:e} of {size}, in substeps of {} s over {floor:?}: \
                 {body:?} from {start:?}",
                clock.step()
            );
            worst = worst.max(gain);
            seen += 1;
        }
    }
    (worst, seen)
}

/// Every body can be stepped and is displayed at a finite position.
fn assert_sound(app: &mut App) {
    let mut all = app
        .world_mut()
        .query::<(Entity, &BodyState, &Transform, Option<&WorldAabb>)>();
    for (entity, state, transform, aabb) in all.iter(app.world()) {
        assert!(state.is_valid(), "{entity}: {state:?}");
        let shown = transform.translation.is_finite() && transform.rotation.is_finite();
        assert!(shown, "{entity}: {transform:?}");
        let fitted = aabb.is_none_or(|b| b.0.min.is_finite() && b.0.max.is_finite());
        assert!(fitted, "{entity}: {aabb:?}");
    }
}

/// Resident memory of this process \[bytes\], if the system reports it.
fn resident() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(text.split(' ').nth(1)?.parse::<u64>().ok()? * 4096)
}

fn messages<M: Message>(app: &App) -> usize {
    app.world().resource::<Messages<M>>().len()
}

#[test]
fn hostile_play() {
    let seconds: u32 = match std::env::var("BOX_SOAK_SECONDS") {
        Ok(text) => text.parse().expect("a number of seconds"),
        Err(_) => 60,
    };
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Time::<Fixed>::from_hz(f64::from(RATE)))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.update();
    let mut dice = Dice(match std::env::var("BOX_SOAK_SEED") {
        Ok(text) => text.parse().expect("a number"),
        Err(_) => 2012,
    });
    let mut graveyard = Vec::new();
    let (mut early_others, mut most_others) = (0, 0);
    let (mut worst_gain, mut quarantined, mut memory) = (f64::MIN, 0, Vec::new());
    let mut watched = 0;
    for second in 0..seconds {
        for _ in 0..RATE {
            for _ in 0..dice.below(4) {
                act(&mut app, &mut dice, &graveyard);
            }
            app.update();
        }
        let mut out = app.world_mut().query::<&Quarantined>();
        quarantined += out.iter(app.world()).count();
        if second % 10 == 9 {
            let (gain, seen) = rest(&mut app, &mut dice);
            assert_sound(&mut app);
            worst_gain = worst_gain.max(gain);
            watched += seen;
            memory.extend(resident());
        }
        if second % 600 == 599 {
            println!("{} minutes", (second + 1) / 60);
        }
        graveyard = bodies(&mut app);
        // Only bodies were spawned (resources are entities as well), and no message remains.
        let others = app.world().entities().count_spawned() as usize - graveyard.len();
        most_others = most_others.max(others);
        if second < 10 {
            early_others = most_others;
        }
        assert!(messages::<ApplyImpulse>(&app) < 1000);
        assert!(messages::<BodyQuarantined>(&app) < 10 * MAX_BODIES);
        assert!(messages::<FloorContact>(&app) < 100 * MAX_BODIES);
    }
    let clock = app.world().resource::<PhysicsClock>();
    println!(
        "{seconds} s of play: {} steps, {quarantined} sightings of quarantined bodies, largest energy \
         gain of {watched} bodies watched {worst_gain:.1e}, memory {:?} bytes",
        clock.steps(),
        memory
            .iter()
            .step_by(memory.len().div_ceil(12).max(1))
            .collect::<Vec<_>>()
    );
    assert!(watched > seconds as usize, "{watched} bodies were watched");
    assert!(
        most_others <= early_others + 4,
        "{early_others} other entities became {most_others}"
    );
    // Once every kind of table exists, the memory does not grow.
    if let (Some(early), Some(last)) = (memory.get(memory.len() / 3), memory.last()) {
        assert!(
            *last < early + (16 << 20),
            "memory grew from {early} to {last} bytes"
        );
    }
}
