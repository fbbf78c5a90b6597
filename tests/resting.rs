//! A resting box is skipped until something changes. It then behaves exactly like a box that was just placed.

use bevy::prelude::*;
use box_physics::floor::ContactState;
use box_physics::prelude::*;

fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

/// Boxes on the floor at x = 0, 3, 6 m; the tests observe the middle one.
struct Scene {
    app: App,
    bodies: [Entity; 3],
}

impl Scene {
    fn new(states: [(BodyState, ContactState); 3]) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
            .insert_resource(Floor::default());
        let bodies = states.map(|(state, contact)| {
            let parts = (brick(), state, contact);
            app.world_mut().spawn(parts).id()
        });
        Self { app, bodies }
    }

    /// Boxes that were dropped and have been at rest long enough to sleep.
    fn at_rest() -> Self {
        let start = [0.0, 3.0, 6.0].map(|x| {
            let state =
                BodyState::at(DVec3::new(x, 0.3, 0.0)).with_velocity(DVec3::new(0.1, 0.0, 0.0));
            (state, ContactState::default())
        });
        let mut scene = Self::new(start);
        scene.step(120);
        for body in scene.bodies {
            let state = scene.get::<BodyState>(body);
            assert!(scene.get::<ContactState>(body).is_resting(&state));
        }
        scene
    }

    /// The same boxes, just placed.
    fn put_there(&self) -> Self {
        let parts = self
            .bodies
            .map(|body| (self.get(body), self.get::<ContactState>(body)));
        let mut scene = Self::new(parts);
        // This step detects that they rest.
        scene.step(1);
        scene
    }

    fn step(&mut self, steps: u32) {
        self.app.world_mut().commands().queue(StepPhysics(steps));
        self.app.world_mut().flush();
    }

    fn get<C: Component + Clone>(&self, body: Entity) -> C {
        self.app.world().get::<C>(body).expect("a body's").clone()
    }

    fn edit<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        edit: impl FnOnce(&mut C),
    ) {
        let body = self.bodies[1];
        edit(&mut self.app.world_mut().get_mut::<C>(body).expect("a body's"));
    }

    fn insert(&mut self, parts: impl Bundle) {
        let body = self.bodies[1];
        self.app.world_mut().entity_mut(body).insert(parts);
    }

    /// The visible state of the three boxes.
    fn seen(&self) -> [(BodyState, Transform, WorldAabb, ContactState); 3] {
        self.bodies
            .map(|b| (self.get(b), self.get(b), self.get(b), self.get(b)))
    }
}

/// Disturbs sleeping boxes and just placed boxes in the same way, and asserts that they behave alike. Returns
/// whether the middle one moved, and whether the others moved.
fn compare(what: &str, disturb: impl Fn(&mut Scene)) -> (bool, bool) {
    let mut moved = (false, false);
    let mut known = Scene::at_rest();
    let mut new = known.put_there();
    assert!(known.seen() == new.seen(), "{what}: at the start");
    let before = known.seen();
    for scene in [&mut known, &mut new] {
        disturb(scene);
    }
    for step in 0..90 {
        known.step(1);
        new.step(1);
        let same = known.seen() == new.seen();
        assert!(same, "{what}, step {step}");
        let now = known.seen();
        moved.0 |= now[1].0 != before[1].0;
        moved.1 |= now[0].0 != before[0].0 || now[2].0 != before[2].0;
    }
    moved
}

const STILL: (bool, bool) = (false, false);
const ONE: (bool, bool) = (true, false);
const ALL: (bool, bool) = (true, true);

#[test]
fn nothing_moves_what_nothing_touches() {
    assert_eq!(compare("nothing", |_| ()), STILL);
}

#[test]
fn a_box_is_moved_by_what_is_done_to_it() {
    let push = |scene: &mut Scene| {
        let body = scene.bodies[1];
        let impulse = ApplyImpulse::center(body, DVec3::new(2.0, 4.0, 0.0));
        scene.app.world_mut().write_message(impulse);
    };
    assert_eq!(compare("an impulse", push), ONE);
    let lift = |scene: &mut Scene| scene.edit::<Transform>(|t| t.translation.y += 1.0);
    assert_eq!(compare("a teleport by its Transform", lift), ONE);
    let kick = |scene: &mut Scene| scene.edit::<BodyState>(|state| state.velocity.x = 1.0);
    assert_eq!(compare("a velocity", kick), ONE);
    let grow =
        |scene: &mut Scene| scene.insert(RigidBox::new(DVec3::splat(0.4), 3.0).expect("valid"));
    assert_eq!(compare("another size", grow), ONE);
    let heavier = |scene: &mut Scene| {
        scene.insert(RigidBox::new(brick().half_extents(), 5.0).expect("valid"));
    };
    compare("another mass", heavier);
    let pull = |scene: &mut Scene| {
        scene.insert(ExternalForce {
            force: DVec3::new(60.0, 0.0, 0.0),
            torque: DVec3::ZERO,
        });
    };
    assert_eq!(compare("a force", pull), ONE);
    let float = |scene: &mut Scene| scene.insert(GravityScale(-0.5));
    assert_eq!(compare("gravity of its own", float), ONE);
    let forget = |scene: &mut Scene| scene.insert(ContactState::default());
    compare("a contact that is forgotten", forget);
}

#[test]
fn boxes_are_moved_by_a_change_of_the_world() {
    let lean = |scene: &mut Scene| {
        scene
            .app
            .insert_resource(WorldGravity(DVec3::new(8.0, -6.0, 0.0)));
    };
    assert_eq!(compare("gravity aslant", lean), ALL);
    let floor = |height: f64, friction: f64| {
        move |scene: &mut Scene| {
            scene.app.insert_resource(Floor {
                height,
                friction,
                ..default()
            });
        }
    };
    assert_eq!(compare("a higher floor", floor(0.1, 0.5)), ALL);
    assert_eq!(compare("a lower floor", floor(-0.1, 0.5)), ALL);
    assert_eq!(compare("a smoother floor", floor(0.0, 0.1)), STILL);
    let remove = |scene: &mut Scene| {
        scene.app.world_mut().remove_resource::<Floor>();
    };
    assert_eq!(compare("no floor", remove), ALL);
    let no_settings = |scene: &mut Scene| {
        scene.app.world_mut().remove_resource::<ContactSettings>();
    };
    assert_eq!(compare("no settings of the contact", no_settings), STILL);
}

/// Changes to a box that is skipped take effect when it is processed again.
#[test]
fn a_box_that_was_left_out_is_looked_at_again() {
    let meanwhile = |scene: &mut Scene, done: &dyn Fn(&mut Scene)| {
        scene.insert(Quarantined { time: 0.0 });
        scene.step(2);
        done(scene);
        scene.step(2);
        let body = scene.bodies[1];
        let mut body = scene.app.world_mut().entity_mut(body);
        body.remove::<Quarantined>();
    };
    let higher = |scene: &mut Scene| {
        scene.app.insert_resource(Floor {
            height: 0.1,
            ..default()
        });
    };
    let rose = |scene: &mut Scene| meanwhile(scene, &higher);
    assert_eq!(compare("the floor rose under it", rose), ALL);
    let kick = |scene: &mut Scene| scene.edit::<BodyState>(|state| state.velocity.y = 1.0);
    let kicked = |scene: &mut Scene| meanwhile(scene, &kick);
    assert_eq!(compare("it was given a velocity", kicked), ONE);
    let no_contact_meanwhile = |scene: &mut Scene| {
        scene.app.world_mut().remove_resource::<Floor>();
        scene.step(10);
        scene.app.insert_resource(Floor::default());
    };
    assert_eq!(compare("there was no contact", no_contact_meanwhile), ALL);
}

/// A force that held the box is removed.
#[test]
fn a_box_that_was_held_is_let_go() {
    let mut scene = Scene::at_rest();
    let up = ExternalForce {
        force: DVec3::new(-8.0 * brick().mass(), 0.0, 0.0),
        torque: DVec3::ZERO,
    };
    scene.insert(up);
    scene
        .app
        .insert_resource(WorldGravity(DVec3::new(8.0, -9.81, 0.0)));
    scene.step(60);
    let body = scene.bodies[1];
    let before = scene.seen();
    let rests = |k: usize| before[k].3.is_resting(&before[k].0);
    assert!(rests(1) && !rests(0));
    scene
        .app
        .world_mut()
        .entity_mut(body)
        .remove::<ExternalForce>();
    scene.step(10);
    assert!(scene.seen()[1].0.position.x > before[1].0.position.x + 0.01);
}

/// A pose that is overwritten after teleports were read is written again in the same step. A pose that is not
/// a teleport but differs from the written one is corrected in the next step.
#[test]
fn a_pose_overwritten_is_shown_again() {
    let mut scene = Scene::at_rest();
    let shown = scene.seen();
    let smear = |mut transforms: Query<&mut Transform>| {
        for mut transform in &mut transforms {
            transform.translation.y = 7.0;
        }
    };
    scene
        .app
        .add_systems(PhysicsSchedule, smear.in_set(PhysicsSystems::Forces));
    for _ in 0..3 {
        scene.step(1);
        assert!(scene.seen() == shown);
    }
}

/// Changes between *Integrate* and *Contact* take effect in this step.
#[test]
fn between_the_sets_a_box_can_still_be_moved() {
    let mut scene = Scene::at_rest();
    let before = scene.seen();
    let raise = |mut states: Query<&mut BodyState>| {
        for mut state in &mut states {
            state.velocity.y = 1.0;
        }
    };
    scene.app.add_systems(
        PhysicsSchedule,
        raise
            .after(PhysicsSystems::Integrate)
            .before(PhysicsSystems::Contact),
    );
    scene.step(1);
    for (now, before) in scene.seen().into_iter().zip(before) {
        assert!(now.0.position.y > before.0.position.y);
        assert!(now.1.translation.y > before.1.translation.y);
    }
}

/// An elevator goes down with boxes on it: they ride, their contacts go on, and when it stops they rest and sleep.
#[test]
fn boxes_ride_an_elevator_and_a_conveyor() {
    let mut scene = Scene::at_rest();
    scene.insert(ReportContacts);
    scene.step(2);
    let velocity = DVec3::new(0.4, -0.5, 0.0);
    let drive = |scene: &mut Scene, velocity: DVec3| {
        let mut floor = scene.app.world_mut().resource_mut::<Floor>();
        floor.velocity = velocity;
    };
    let began = |scene: &mut Scene| {
        let mut messages = scene
            .app
            .world_mut()
            .resource_mut::<Messages<FloorContact>>();
        let began = messages.drain().filter(|m| m.phase == ContactPhase::Began);
        began.count()
    };
    began(&mut scene);
    drive(&mut scene, velocity);
    scene.step(60);
    let start = scene.seen();
    assert!(began(&mut scene) <= 16, "a hop that ends");
    for _ in 0..120 {
        scene.step(1);
        let height = scene.app.world().resource::<Floor>().height;
        for body in scene.bodies {
            let state = scene.get::<BodyState>(body);
            assert!(scene.get::<ContactState>(body).is_resting(&state));
            assert!(state.velocity == velocity && state.position.y == height + 0.25);
            let shown = scene.get::<Transform>(body).translation.y;
            assert_eq!(shown, state.position.y as f32);
        }
    }
    assert_eq!(began(&mut scene), 0);
    let height = scene.app.world().resource::<Floor>().height;
    assert!((height + 0.5 * 180.0 / 64.0).abs() < 1e-12, "{height}");
    for (start, now) in start.iter().zip(scene.seen()) {
        let way = now.0.position - start.0.position;
        assert!((way - velocity * (120.0 / 64.0)).length() < 1e-9, "{way}");
    }
    drive(&mut scene, DVec3::ZERO);
    scene.step(60);
    let still = scene.seen();
    scene.step(60);
    assert!(
        scene.seen() == still && scene.get::<BodyState>(scene.bodies[0]).velocity == DVec3::ZERO
    );
}
