//! A box among planes: the properties of one floor also hold for several planes.

mod moving;
mod ramp;
mod rest;

use glam::DQuat;

use super::*;
use crate::floor::tests::{G, Random, SIXTIETH, Scene, Solver, Worst, about};
use crate::force::Gravity;
use crate::integrators::{Exact, Rk4, SemiImplicitEuler, Split};

impl Scene {
    fn turned(&self, turn: DQuat) -> Self {
        let mut new = self.clone();
        new.gravity.0 = turn * self.gravity.0;
        new.state.position = turn * self.state.position;
        new.state.rotation = turn * self.state.rotation;
        new.state.velocity = turn * self.state.velocity;
        new.planes = self.planes.iter().map(|p| turned(p, turn)).collect();
        new
    }
}

fn turned(plane: &Plane, turn: DQuat) -> Plane {
    let StaticPlane { point, normal, .. } = plane.shape;
    let surface = plane.surface.with_velocity(turn * plane.surface.velocity);
    wall(turn * point, turn * normal, &surface)
}

fn wall(point: DVec3, normal: DVec3, surface: &Floor) -> Plane {
    let shape = StaticPlane::new(point, normal).expect("valid");
    let shape = shape.with_velocity(surface.velocity);
    Plane::new(shape, surface.restitution, surface.friction).expect("valid")
}

/// A floor and four walls, `half` \[m\] from the middle.
fn tray(half: f64, e: f64, mu: f64) -> Vec<Plane> {
    let floor = Floor::new(0.0, e, mu).expect("valid");
    let walls = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
    let walls = walls.map(|normal| wall(-normal * half, normal, &floor));
    [Plane::from(floor)].into_iter().chain(walls).collect()
}

/// Checks random throws in a tray, an eighth of them of hollow or weighted boxes: energy gain, depth and time to rest.
fn storm<S: Integrate>(seed: u64, n: u32, steps: u32, cubes: bool) {
    let mut random = Random(seed);
    let mut worst = Worst::default();
    for i in 0..n {
        let size = random.magnitude(0.005, 1.0);
        let half = if cubes {
            DVec3::splat(size)
        } else {
            size * random.half_extents(0.25, 1.0)
        };
        let (e, mu) = (random.restitution(i), random.friction(i, 2.0));
        let mut scene = Scene::among(tray(size * random.range(2.0, 4.0), e, mu), half);
        if i % 8 == 0 {
            // Turned on its side, so that only one plane is level.
            scene = scene.turned(random.attitude());
        }
        scene.state.position += 2.0 * size * -scene.gravity.0 / G;
        scene.state.rotation = random.attitude();
        let fast = random.magnitude(0.01, 30.0) * size.sqrt();
        scene.state.velocity = random.vector(fast);
        scene.spin(random.vector(fast / size));
        let h = random.magnitude(1e-4, 0.02).min(0.2 * size / fast);
        let scale = scene.energy().abs() + scene.body.mass() * G * size;
        worst.follow::<S>(i, scene, Some(scale), h, steps);
    }
    worst.check(&format!("{n} throws"));
}

#[test]
fn random_throws_in_a_tray_gain_nothing_and_stay_inside() {
    storm::<Split>(1, 1000, 100, true);
    storm::<Split>(2, 1000, 100, false);
}

/// Manual run: `cargo test --release --lib -- --ignored storm_in_a_tray_by_hand --nocapture`.
#[test]
#[ignore = "many throws; a part of them runs with every test"]
fn storm_in_a_tray_by_hand() {
    for seed in 10..30 {
        storm::<Split>(seed, 2000, 100, true);
        storm::<Split>(seed, 1000, 100, false);
    }
}

/// Dice of 16 mm, thrown into a tray of 30 cm, come to rest, each on a face.
#[test]
fn dice_come_to_rest() {
    let mut random = Random(5);
    for i in 0..200 {
        let mut scene = Scene::among(tray(0.06, 0.3, 0.4), DVec3::splat(0.008));
        scene.state.position = DVec3::new(0.0, 0.1, 0.0);
        scene.throw(&mut random, 1.5, 30.0);
        scene.run::<Split>(SIXTIETH, 300);
        assert!(
            scene.contact.is_resting(&scene.state),
            "{i} {:?} {:?}",
            scene.state,
            scene.total
        );
        let start = scene.state;
        scene.run::<Split>(SIXTIETH, 100);
        assert_eq!(scene.state, start);
    }
}

/// In a closed box without friction and with e = 1, no energy is lost either.
#[test]
fn elastic_impacts_in_a_closed_box_conserve_energy() {
    let mut random = Random(7);
    let surface = Floor::new(0.0, 1.0, 0.0).expect("valid");
    let mut worst = 0.0_f64;
    for _ in 0..20 {
        let sides = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
        let planes = sides.flat_map(|n| [wall(-n, n, &surface), wall(n, -n, &surface)]);
        let mut scene = Scene::among(planes.collect(), DVec3::splat(0.3));
        scene.throw(&mut random, 10.0, 5.0);
        let start = scene.energy();
        for _ in 0..600 {
            scene.step::<Split>(SIXTIETH);
            let change = scene.energy() / start - 1.0;
            worst = worst.max(change.abs());
            assert!(change.abs() < 1e-9 && scene.lowest() > -1e-11, "{change:e}");
        }
        assert!(scene.total.impacts > 50 && scene.total.solves_capped == 0);
    }
    println!("a closed box: energy changes by {worst:.1e} at most");
}

/// Every integrator stays inside and comes to rest.
#[test]
fn any_integrator_stays_inside() {
    fn check<S: Integrate>() {
        let mut random = Random(8);
        for i in 0..40 {
            let mut scene = Scene::among(tray(1.0, 0.3, 0.4), DVec3::new(0.3, 0.2, 0.25));
            scene.state.position.y = 1.0;
            scene.throw(&mut random, 4.0, 4.0);
            for _ in 0..400 {
                scene.step::<S>(SIXTIETH);
                assert!(scene.lowest() >= -1e-12, "{} {i}", S::INFO.id);
            }
            assert!(
                scene.contact.is_resting(&scene.state),
                "{} {i} {:?}",
                S::INFO.id,
                scene.state
            );
        }
    }
    check::<Split>();
    check::<Exact>();
    check::<Rk4>();
    check::<SemiImplicitEuler>();
}

/// Cost of a step; manual run: `cargo test --release -- --ignored cost_among_planes_by_hand --nocapture`.
#[test]
#[ignore = "prints times and asserts none, as tests never assert times"]
fn cost_among_planes_by_hand() {
    let mut scene = Scene::among(tray(4.0, 0.3, 0.4), DVec3::new(0.5, 0.25, 0.4));
    scene.state.position = DVec3::new(0.0, 0.25, 0.0);
    scene.state.velocity = DVec3::X;
    scene.step::<Split>(SIXTIETH);
    scene.time("sliding on the floor, walls far", true);
    scene.state.position.x = 3.45;
    scene.state.velocity = DVec3::Z;
    scene.time("sliding on the floor, a wall within reach", true);
    scene.state.position.x = 3.5;
    scene.gravity.0.x = 3.0;
    scene.time("sliding along floor and wall", true);
    scene.state.velocity = DVec3::ZERO;
    scene.gravity.0.z = 0.1;
    scene.run::<Split>(SIXTIETH, 60);
    scene.time("at rest in the edge", true);
}

/// Coulomb's law at random contacts with up to three planes.
#[test]
fn coulombs_law_holds_with_several_normals() {
    use super::among::Among;
    use crate::floor::frame::Frame;
    use crate::floor::ground::Ground;
    use crate::floor::law::Law;
    use crate::floor::operator::DelassusOperator;
    let mut random = Random(9);
    let settings = ContactSettings::default();
    for mu in [0.0, 0.1, 0.4, 0.8, 2.0] {
        let mut solver = Solver::default();
        for i in 0..2000 {
            let body = RigidBox::new(random.half_extents(0.1, 1.0), 3.0).expect("valid");
            let surface = Floor::new(0.0, 0.0, mu).expect("valid");
            let mut state = BodyState::default();
            // Aligned with the planes at one or more corners each.
            if i % 2 == 0 {
                state.rotation = random.attitude();
            }
            let mut planes = Vec::new();
            for axis in 0..1 + i % 3 {
                let mut normal = [DVec3::Y, DVec3::X, DVec3::NEG_Z][axis];
                if i % 4 == 1 {
                    normal = (normal + random.vector(0.3)).normalize();
                }
                let reach = reach(&body, &DMat3::from_quat(state.rotation), normal);
                planes.push(wall(-reach * normal, normal, &surface));
            }
            state.velocity = random.vector(1.0);
            let spin = random.vector(2.0 / body.radius());
            state.set_angular_velocity(&body, spin);
            let gaps = Gaps::over(&planes, &body, &state);
            let attitude = DMat3::from_quat(state.rotation);
            let order = Among::<Gravity>::order(gaps.touching(1e-9));
            let operator = DelassusOperator::at(&body, attitude, order);
            let b = operator.velocities((state.velocity, state.angular_velocity(&body)));
            let context = PlanesContext {
                planes: &planes,
                settings: &settings,
                body: &body,
                force: &Gravity(DVec3::ZERO),
            };
            let floor = Floor::default();
            let world = context.over(&floor);
            let (method, frame) = (Method::of::<Split>(), Frame::new(DVec3::ZERO, None));
            let among = Among {
                world: Level::new(&world, &method, frame),
                planes: &planes,
            };
            let mut law = Law::new(&among, &operator, false);
            let found = law.solve(&b, &[DVec3::ZERO; _]);
            solver.note(&operator, &b, &found, |i| law.surface(i));
        }
        solver.check(mu, 1e-9);
    }
}
