//! A box among planes: what holds over one floor holds among several.

mod ramp;
mod rest;

use glam::DQuat;

use super::contacts::Gaps;
use super::*;
use crate::floor::tests::{G, Random, SIXTIETH, about};
use crate::force::Gravity;
use crate::integrators::{Exact, Rk4, SemiImplicitEuler, Split};

/// One box among planes, and what it needs between steps.
#[derive(Clone)]
struct Scene {
    planes: Vec<Plane>,
    settings: ContactSettings,
    body: RigidBox,
    state: BodyState,
    gravity: Gravity,
    memory: IntegratorMemory,
    contact: ContactState,
    total: FloorOutcome,
}

impl Scene {
    fn new(planes: Vec<Plane>, half: DVec3) -> Self {
        Self {
            planes,
            settings: ContactSettings::default(),
            body: RigidBox::new(half, 3.0).expect("valid"),
            state: BodyState::default(),
            gravity: Gravity(DVec3::NEG_Y * G),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
            total: FloorOutcome::default(),
        }
    }

    fn step<S: Integrate>(&mut self, h: f64) -> FloorOutcome {
        let context = PlanesContext {
            planes: &self.planes,
            settings: &self.settings,
            body: &self.body,
            force: &self.gravity,
        };
        let (state, memory, contact) = (&mut self.state, &mut self.memory, &mut self.contact);
        let outcome = step_on_planes::<S, _>(&context, state, h, memory, contact, None);
        self.total += outcome;
        outcome
    }

    fn run<S: Integrate>(&mut self, h: f64, steps: u32) {
        for _ in 0..steps {
            self.step::<S>(h);
        }
    }

    /// Height of the lowest corner over any plane \[m\].
    fn lowest(&self) -> f64 {
        Gaps::at(&self.planes, &self.body, &self.state, 0.0)
            .lowest()
            .1
    }

    fn energy(&self) -> f64 {
        let x = self.state.position;
        self.state.kinetic_energy(&self.body) - self.body.mass() * self.gravity.0.dot(x)
    }

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
    let StaticPlane { point, normal } = plane.shape;
    wall(turn * point, turn * normal, &plane.surface)
}

fn wall(point: DVec3, normal: DVec3, surface: &Floor) -> Plane {
    let shape = StaticPlane::new(point, normal).expect("valid");
    Plane::new(shape, surface.restitution, surface.friction).expect("valid")
}

/// A floor and four walls, `half` \[m\] from the middle.
fn tray(half: f64, e: f64, mu: f64) -> Vec<Plane> {
    let floor = Floor::new(0.0, e, mu).expect("valid");
    let walls = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
    let walls = walls.map(|normal| wall(-normal * half, normal, &floor));
    [Plane::from(floor)].into_iter().chain(walls).collect()
}

/// Gains of energy, depths and times to rest of random throws in a tray, an eighth of them of hollow or weighted boxes.
fn storm<S: Integrate>(seed: u64, n: u32, steps: u32, cubes: bool) {
    let mut random = Random(seed);
    let (mut gain, mut depth, mut rested, mut total) =
        (0.0_f64, 0.0_f64, 0, FloorOutcome::default());
    for i in 0..n {
        let size = random.magnitude(0.005, 1.0);
        let mut side = || size * random.magnitude(0.25, 1.0);
        let half = if cubes {
            DVec3::splat(size)
        } else {
            DVec3::new(side(), side(), side())
        };
        let e = if i % 5 == 0 {
            1.0
        } else {
            random.range(0.0, 1.0)
        };
        let mu = if i % 7 == 0 {
            0.0
        } else {
            random.magnitude(0.01, 2.0)
        };
        let mut scene = Scene::new(tray(size * random.range(2.0, 4.0), e, mu), half);
        if i % 8 == 0 {
            // On its side, so that no plane is level but for the one that was.
            scene = scene.turned(random.attitude());
        }
        scene.state.position += 2.0 * size * -scene.gravity.0 / G;
        scene.state.rotation = random.attitude();
        let fast = random.magnitude(0.01, 30.0) * size.sqrt();
        scene.state.velocity = random.vector(fast);
        let spin = random.vector(fast / size);
        scene.state.set_angular_velocity(&scene.body, spin);
        let h = random.magnitude(1e-4, 0.02).min(0.2 * size / fast);
        let mut before = scene.energy();
        let scale = before.abs() + scene.body.mass() * G * size;
        for _ in 0..steps {
            scene.step::<S>(h);
            let after = scene.energy();
            if (after - before) / scale > gain.max(1e-11) {
                println!(
                    "{i}: gain {:.2e} {half} h {h:.2e} e {e:.2} mu {mu:.2}",
                    (after - before) / scale
                );
            }
            gain = gain.max((after - before) / scale);
            depth = depth.max(-scene.lowest() / scene.body.radius());
            assert!(scene.state.is_finite(), "{i}");
            before = after;
        }
        rested += u32::from(scene.contact.is_resting(&scene.state));
        total += scene.total;
    }
    println!("{n} throws: gain {gain:.1e}, depth {depth:.1e}, {rested} rest, {total:?}");
    assert!(gain <= 1e-11 && depth <= 1e-9);
}

#[test]
fn random_throws_in_a_tray_gain_nothing_and_stay_inside() {
    storm::<Split>(1, 1000, 100, true);
    storm::<Split>(2, 1000, 100, false);
}

/// By hand: `cargo test --release --lib -- --ignored storm_in_a_tray_by_hand --nocapture`.
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
        let mut scene = Scene::new(tray(0.06, 0.3, 0.4), DVec3::splat(0.008));
        scene.state.position = DVec3::new(0.0, 0.1, 0.0);
        scene.state.rotation = random.attitude();
        scene.state.velocity = random.vector(1.5);
        let spin = random.vector(30.0);
        scene.state.set_angular_velocity(&scene.body, spin);
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

/// A closed box without friction, e = 1: no energy is lost either.
#[test]
fn elastic_impacts_in_a_closed_box_conserve_energy() {
    let mut random = Random(7);
    let surface = Floor::new(0.0, 1.0, 0.0).expect("valid");
    let mut worst = 0.0_f64;
    for _ in 0..20 {
        let sides = [DVec3::X, DVec3::Y, DVec3::Z].into_iter();
        let planes = sides.flat_map(|n| [wall(-n, n, &surface), wall(n, -n, &surface)]);
        let mut scene = Scene::new(planes.collect(), DVec3::splat(0.3));
        scene.state.rotation = random.attitude();
        scene.state.velocity = random.vector(10.0);
        let spin = random.vector(5.0);
        scene.state.set_angular_velocity(&scene.body, spin);
        let start = scene.energy();
        for _ in 0..600 {
            scene.step::<Split>(SIXTIETH);
            let change = scene.energy() / start - 1.0;
            worst = worst.max(change.abs());
            assert!(change.abs() < 1e-9 && scene.lowest() > -1e-11, "{change:e}");
        }
        assert!(scene.total.impacts > 50 && scene.total.solves_capped == 0);
    }
    println!("energy changes by {worst:.1e} at most");
}

/// Every integrator stays inside and comes to rest.
#[test]
fn any_integrator_stays_inside() {
    fn check<S: Integrate>() {
        let mut random = Random(8);
        for i in 0..40 {
            let mut scene = Scene::new(tray(1.0, 0.3, 0.4), DVec3::new(0.3, 0.2, 0.25));
            scene.state.position.y = 1.0;
            scene.state.rotation = random.attitude();
            scene.state.velocity = random.vector(4.0);
            let spin = random.vector(4.0);
            scene.state.set_angular_velocity(&scene.body, spin);
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

/// By hand: what a step costs, `cargo test --release -- --ignored cost_among_planes_by_hand --nocapture`.
#[test]
#[ignore = "prints times and asserts none, as tests never assert times"]
fn cost_among_planes_by_hand() {
    let time = |name: &str, mut scene: Scene| {
        let start = scene.clone();
        let mut best = f64::INFINITY;
        for _ in 0..20 {
            let clock = std::time::Instant::now();
            for _ in 0..500 {
                scene.state = start.state;
                scene.step::<Split>(SIXTIETH);
            }
            best = best.min(clock.elapsed().as_secs_f64() / 500.0);
        }
        let rests = scene.contact.is_resting(&scene.state);
        println!("{name}: {:.0} ns, at rest: {rests}", best * 1e9);
    };
    let mut scene = Scene::new(tray(4.0, 0.3, 0.4), DVec3::new(0.5, 0.25, 0.4));
    scene.state.position = DVec3::new(0.0, 0.25, 0.0);
    scene.state.velocity = DVec3::X;
    scene.step::<Split>(SIXTIETH);
    time("sliding on the floor, walls far", scene.clone());
    scene.state.position.x = 3.45;
    scene.state.velocity = DVec3::Z;
    time("sliding on the floor, a wall within reach", scene.clone());
    scene.state.position.x = 3.5;
    scene.gravity.0.x = 3.0;
    time("sliding along floor and wall", scene.clone());
    scene.state.velocity = DVec3::ZERO;
    scene.gravity.0.z = 0.1;
    scene.run::<Split>(SIXTIETH, 60);
    time("at rest in the edge", scene);
}

/// Coulomb's law at random contacts with up to three planes.
#[test]
fn coulombs_law_holds_with_several_normals() {
    use super::contacts::{Contacts, PAIRS};
    use super::law::Law;
    let mut random = Random(9);
    let settings = ContactSettings::default();
    for mu in [0.0, 0.1, 0.4, 0.8, 2.0] {
        let (mut failed, mut worst, mut counts) = (0, 0.0_f64, Vec::new());
        let n = 2000;
        for i in 0..n {
            let mut side = || random.magnitude(0.1, 1.0);
            let body = RigidBox::new(DVec3::new(side(), side(), side()), 3.0).expect("valid");
            let surface = Floor::new(0.0, 0.0, mu).expect("valid");
            let mut state = BodyState::default();
            // Fitted to the planes at one or more corners each.
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
            let gaps = Gaps::at(&planes, &body, &state, 0.0);
            let attitude = DMat3::from_quat(state.rotation);
            let touching = gaps.touching(1e-9);
            let contacts = Contacts::new(&planes, &body, attitude, &gaps.lever, touching);
            let b = contacts.slips((state.velocity, state.angular_velocity(&body)));
            let law = Law::new(&contacts, 1.0, [mu; PAIRS], &settings);
            let found = law.solve(&b);
            counts.push(found.iterations);
            if !found.converged {
                failed += 1;
                continue;
            }
            let (w, scale) = (law.velocities(&b, &found.p), contacts.largest(&b));
            let momentum = body.mass() * scale;
            for k in 0..contacts.count {
                let normal = contacts.normal[k];
                let (p, u) = (normal.dot(found.p[k]), normal.dot(w[k]));
                let (t, slip) = (contacts.along(k, found.p[k]), contacts.along(k, w[k]));
                let against = (t.dot(slip) + mu * p * slip.length()).abs();
                worst = worst
                    .max(-u / scale)
                    .max(p * u / (momentum * scale))
                    .max((t.length() - mu * p) / momentum)
                    .max(against / (momentum * scale));
            }
        }
        counts.sort_unstable();
        println!(
            "mu {mu}: failed {failed} of {n}, iterations median {} 99 % {} worst {}, law {worst:.1e}",
            counts[n / 2],
            counts[n * 99 / 100],
            counts[n - 1]
        );
        assert!(failed == 0 && worst < 1e-9);
    }
}
