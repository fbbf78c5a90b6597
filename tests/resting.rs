//! A resting box is skipped until something changes. It then behaves exactly like a box that was just placed.

use bevy::prelude::*;
use box_physics::floor::ContactState;
use box_physics::prelude::*;

mod world;

use world::{Play, brick};

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
        let bodies = states.map(|(state, contact)| app.spawn((brick(), state, contact)));
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
        self.app.step(steps);
    }

    fn get<C: Component + Clone>(&self, body: Entity) -> C {
        self.app.get::<C>(body).clone()
    }

    fn edit<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        edit: impl FnOnce(&mut C),
    ) {
        edit(&mut self.app.edit::<C>(self.bodies[1]));
    }

    fn insert(&mut self, parts: impl Bundle) {
        self.app.entity(self.bodies[1]).insert(parts);
    }

    fn set_floor(&mut self, height: f64, friction: f64) {
        self.app.insert_resource(Floor {
            height,
            friction,
            ..default()
        });
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

/// Name of a disturbance, the boxes that move (none, the middle one, all, or any), and the disturbance.
type Row = (&'static str, Option<(bool, bool)>, fn(&mut Scene));
const NONE: Option<(bool, bool)> = Some((false, false));
const ONE: Option<(bool, bool)> = Some((true, false));
const ALL: Option<(bool, bool)> = Some((true, true));
const ANY: Option<(bool, bool)> = None;

fn check(rows: &[Row]) {
    for &(what, expected, disturb) in rows {
        let moved = compare(what, disturb);
        assert_eq!(moved, expected.unwrap_or(moved), "{what}");
    }
}

#[test]
fn a_box_is_moved_by_what_is_done_to_it() {
    #[rustfmt::skip]
    check(&[
        ("nothing", NONE, |_| ()),
        ("an impulse", ONE, |s| s.app.send(ApplyImpulse::center(s.bodies[1], DVec3::new(2.0, 4.0, 0.0)))),
        ("a teleport by its Transform", ONE, |s| s.edit::<Transform>(|t| t.translation.y += 1.0)),
        ("a velocity", ONE, |s| s.edit::<BodyState>(|state| state.velocity.x = 1.0)),
        ("another size", ONE, |s| s.insert(RigidBox::cube(0.8, 3.0).expect("valid"))),
        ("another mass", ANY, |s| s.insert(RigidBox::new(brick().half_extents(), 5.0).expect("valid"))),
        ("a force", ONE, |s| s.insert(ExternalForce { force: DVec3::X * 60.0, torque: DVec3::ZERO })),
        ("gravity scale", ONE, |s| s.insert(GravityScale(-0.5))),
        ("a contact that is forgotten", ANY, |s| s.insert(ContactState::default())),
    ]);
}

#[test]
fn boxes_are_moved_by_a_change_of_the_world() {
    #[rustfmt::skip]
    check(&[
        ("gravity aslant", ALL, |s| { s.app.insert_resource(WorldGravity(DVec3::new(8.0, -6.0, 0.0))); }),
        ("a higher floor", ALL, |s| s.set_floor(0.1, 0.5)),
        ("a lower floor", ALL, |s| s.set_floor(-0.1, 0.5)),
        ("a smoother floor", NONE, |s| s.set_floor(0.0, 0.1)),
        ("no floor", ALL, |s| { s.app.world_mut().remove_resource::<Floor>(); }),
        ("no settings of the contact", NONE, |s| { s.app.world_mut().remove_resource::<ContactSettings>(); }),
    ]);
}

/// Changes to a box that is skipped take effect when it is processed again.
#[test]
fn a_box_that_was_left_out_is_looked_at_again() {
    fn meanwhile(scene: &mut Scene, change: fn(&mut Scene)) {
        scene.insert(Quarantined { time: 0.0 });
        scene.step(2);
        change(scene);
        scene.step(2);
        scene.app.entity(scene.bodies[1]).remove::<Quarantined>();
    }
    #[rustfmt::skip]
    check(&[
        ("the floor rose under it", ALL, |s| meanwhile(s, |s| s.set_floor(0.1, 0.5))),
        ("it was given a velocity", ONE, |s| meanwhile(s, |s| s.edit::<BodyState>(|state| state.velocity.y = 1.0))),
        ("there was no contact", ALL, |s| {
            s.app.world_mut().remove_resource::<Floor>();
            s.step(10);
            s.app.insert_resource(Floor::default());
        }),
    ]);
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
    scene.app.entity(body).remove::<ExternalForce>();
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
        let contacts = scene.app.drain::<FloorContact>().into_iter();
        contacts.filter(|m| m.phase == ContactPhase::Began).count()
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
