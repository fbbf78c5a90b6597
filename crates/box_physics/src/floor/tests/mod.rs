//! Properties of the contact in every scene. (The measured hard cases 25 to 32 are in `box_scenarios::contact_cases`.)

mod bounce;
mod moving;
mod react;
mod rest;
mod robust;
mod slide;

use glam::{DMat3, DQuat, DVec3};

use super::geometry::Corners;
use super::law::Solution;
use super::operator::DelassusOperator;
use super::planes::Gaps;
use super::{
    ContactReport, ContactSettings, ContactState, Floor, FloorContext, FloorOutcome, Plane,
    PlanesContext, step_on_floor, step_on_planes,
};
use crate::aabb;
use crate::body::RigidBox;
use crate::force::{ForceModel, Gravity};
use crate::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor, Split};
use crate::math::sin_cos;
use crate::state::BodyState;

pub(super) const G: f64 = 9.81;
pub(super) const SIXTIETH: f64 = 1.0 / 60.0;

impl Corners {
    /// The corners over a floor.
    pub(in crate::floor) fn at(floor: &Floor, body: &RigidBox, state: &BodyState) -> Self {
        let mut corners = Self::turned(body, DMat3::from_quat(state.rotation));
        let base = state.position.y - floor.height;
        corners.height = core::array::from_fn(|k| base + corners.lever(k).y);
        corners
    }
}

impl Gaps {
    /// The corners over planes.
    pub(in crate::floor) fn over(planes: &[Plane], body: &RigidBox, state: &BodyState) -> Self {
        let mut gaps = Self::turned(body, DMat3::from_quat(state.rotation));
        for (i, height) in gaps.height.iter_mut().enumerate().take(8 * planes.len()) {
            let corner = aabb::corners(body.half_extents())[i % 8];
            *height = planes[i / 8].height(state.point(corner));
        }
        gaps
    }
}

/// One box over the floor, or among planes if there are any, with its memories between steps.
#[derive(Clone)]
pub(super) struct Scene {
    pub(super) floor: Floor,
    pub(super) planes: Vec<Plane>,
    pub(super) settings: ContactSettings,
    pub(super) body: RigidBox,
    pub(super) state: BodyState,
    pub(super) gravity: Gravity,
    pub(super) memory: IntegratorMemory,
    pub(super) contact: ContactState,
    pub(super) total: FloorOutcome,
}

impl Scene {
    pub(super) fn new(half: DVec3, e: f64, mu: f64) -> Self {
        let body = RigidBox::new(half, 3.0).expect("valid");
        Self {
            floor: Floor::new(0.0, e, mu).expect("valid"),
            planes: Vec::new(),
            settings: ContactSettings::default(),
            body,
            state: BodyState::at(DVec3::Y * half.y),
            gravity: Gravity(DVec3::NEG_Y * G),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
            total: FloorOutcome::default(),
        }
    }

    /// A box at the origin among planes.
    pub(super) fn among(planes: Vec<Plane>, half: DVec3) -> Self {
        let new = Self::new(half, 0.0, 0.0).with_state(BodyState::default());
        Self { planes, ..new }
    }

    pub(super) fn with_state(mut self, state: BodyState) -> Self {
        self.state = state;
        self
    }

    /// Gravity tilted by `theta` \[rad\] toward +x: a slope.
    pub(super) fn on_slope(mut self, theta: f64) -> Self {
        let (s, c) = sin_cos(theta);
        self.gravity = Gravity(DVec3::new(G * s, -G * c, 0.0));
        self
    }

    pub(super) fn step<S: Integrate>(&mut self, h: f64) -> FloorOutcome {
        let gravity = self.gravity;
        self.step_under::<S>(&gravity, h, None)
    }

    /// Takes a step of a 60th of a second by the chosen integrator.
    fn step_by(&mut self, integrator: Integrator) -> FloorOutcome {
        struct Step<'a>(&'a mut Scene);
        impl IntegratorVisitor for Step<'_> {
            type Output = FloorOutcome;
            fn visit<S: Integrate>(self) -> FloorOutcome {
                self.0.step::<S>(SIXTIETH)
            }
        }
        integrator.dispatch(Step(self))
    }

    pub(super) fn step_under<S: Integrate>(
        &mut self,
        force: &impl ForceModel,
        h: f64,
        report: Option<&mut ContactReport>,
    ) -> FloorOutcome {
        let (floor, planes) = (&self.floor, &self.planes[..]);
        let (settings, body) = (&self.settings, &self.body);
        let (state, memory, contact) = (&mut self.state, &mut self.memory, &mut self.contact);
        let outcome = if planes.is_empty() {
            let context = FloorContext {
                floor,
                settings,
                body,
                force,
            };
            step_on_floor::<S, _>(&context, state, h, memory, contact, report)
        } else {
            let context = PlanesContext {
                planes,
                settings,
                body,
                force,
            };
            step_on_planes::<S, _>(&context, state, h, memory, contact, report)
        };
        self.floor.advance(h);
        self.planes.iter_mut().for_each(|plane| plane.advance(h));
        self.total += outcome;
        outcome
    }

    pub(super) fn run<S: Integrate>(&mut self, h: f64, steps: u32) {
        for _ in 0..steps {
            self.step::<S>(h);
        }
    }

    /// Prints the minimum cost of a step. If `reset`, every step starts from the same state.
    pub(super) fn time(&self, name: &str, reset: bool) {
        let mut scene = self.clone();
        let mut best = f64::INFINITY;
        for _ in 0..20 {
            let clock = std::time::Instant::now();
            for _ in 0..1000 {
                if reset {
                    scene.state = self.state;
                }
                scene.step::<Split>(SIXTIETH);
            }
            best = best.min(clock.elapsed().as_secs_f64() / 1000.0);
        }
        println!("{name}: {:.0} ns", best * 1e9);
    }

    /// Sets a random attitude, and a velocity and a spin up to `speed` [m/s] and `spin` [rad/s] along each axis.
    pub(super) fn throw(&mut self, random: &mut Random, speed: f64, spin: f64) {
        self.state.rotation = random.attitude();
        self.state.velocity = random.vector(speed);
        self.spin(random.vector(spin));
    }

    /// Sets the angular velocity in the world [rad/s].
    pub(super) fn spin(&mut self, omega: DVec3) {
        self.state.set_angular_velocity(&self.body, omega);
    }

    /// Height of the lowest corner over the floor or any plane \[m\].
    pub(super) fn lowest(&self) -> f64 {
        if self.planes.is_empty() {
            Corners::at(&self.floor, &self.body, &self.state).lowest()
        } else {
            Gaps::over(&self.planes, &self.body, &self.state).lowest()
        }
    }

    /// Kinetic energy plus potential energy over the floor \[J\].
    pub(super) fn energy(&self) -> f64 {
        let x = self.state.position - DVec3::Y * self.floor.height;
        self.state.kinetic_energy(&self.body) - self.body.mass() * self.gravity.0.dot(x)
    }
}

/// A tilted, moving box.
pub(super) fn tilted() -> (RigidBox, BodyState) {
    let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.375), 3.0).expect("valid");
    let state = BodyState::at_pose(
        DVec3::new(1.0, 2.0, 3.0),
        DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
    )
    .with_velocity(DVec3::new(0.1, -0.4, 0.9))
    .with_angular_velocity(&body, DVec3::new(2.0, -1.0, 0.5));
    (body, state)
}

pub(super) fn about(axis: DVec3, angle: f64) -> DQuat {
    crate::rotation::exponential_map(axis * angle)
}

/// A small generator (Marsaglia's xorshift64*, 2003), so that every run tries the same boxes.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// In [low, high).
    pub(super) fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        low + (high - low) * (bits as f64 / (1_u64 << 53) as f64)
    }

    /// Log-uniform.
    pub(super) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        crate::math::exp(self.range(libm::log(low), libm::log(high)))
    }

    /// Half-extents, each log-uniform.
    pub(super) fn half_extents(&mut self, low: f64, high: f64) -> DVec3 {
        let mut side = || self.magnitude(low, high);
        DVec3::new(side(), side(), side())
    }

    /// A coefficient of restitution for the i-th box. Every fifth box is elastic.
    pub(super) fn restitution(&mut self, i: u32) -> f64 {
        if i.is_multiple_of(5) {
            1.0
        } else {
            self.range(0.0, 1.0)
        }
    }

    /// A coefficient of friction; 0 for every seventh box.
    pub(super) fn friction(&mut self, i: u32, high: f64) -> f64 {
        if i.is_multiple_of(7) {
            0.0
        } else {
            self.magnitude(0.01, high)
        }
    }

    pub(super) fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::new(
            self.range(-size, size),
            self.range(-size, size),
            self.range(-size, size),
        )
    }

    pub(super) fn attitude(&mut self) -> DQuat {
        loop {
            let v = self.vector(1.0);
            let q = DQuat::from_xyzw(v.x, v.y, v.z, self.range(-1.0, 1.0));
            if (0.1..1.0).contains(&q.length()) {
                return q / q.length();
            }
        }
    }
}

/// The worst values over many boxes.
#[derive(Debug, Default)]
pub(super) struct Worst {
    /// Gain of energy in one step, relative to the energy.
    pub(super) gain: f64,
    /// Depth below the floor over the circumradius.
    pub(super) depth: f64,
    pub(super) rested: u32,
    pub(super) total: FloorOutcome,
}

impl Worst {
    /// Steps the i-th box and records the worst values. Energy is relative to `scale` \[J\], or its previous value.
    pub(super) fn follow<S: Integrate>(
        &mut self,
        i: u32,
        mut scene: Scene,
        scale: Option<f64>,
        h: f64,
        steps: u32,
    ) {
        let mut before = scene.energy();
        for _ in 0..steps {
            scene.step::<S>(h);
            let after = scene.energy();
            let gain = (after - before) / scale.unwrap_or(before);
            self.gain = self.gain.max(gain);
            self.depth = self.depth.max(-scene.lowest() / scene.body.radius());
            assert!(scene.state.is_finite(), "{i}");
            before = after;
        }
        self.rested += u32::from(scene.contact.is_resting(&scene.state));
        self.total += scene.total;
    }

    pub(super) fn check(&self, what: &str) {
        println!("{what}: {self:?}");
        assert!(self.gain <= 1e-11 && self.depth <= 1e-9, "{what}");
    }
}

/// Statistics of a solver of Coulomb's law over many problems.
#[derive(Default)]
pub(super) struct Solver {
    iterations: Vec<u32>,
    failed: u32,
    /// The largest violation of a condition of the law, in units of speed and momentum.
    worst: f64,
}

impl Solver {
    /// Adds a solution for the velocities `b`; `surface` gives the normal and the friction of a contact.
    pub(super) fn note<const N: usize>(
        &mut self,
        operator: &DelassusOperator<N>,
        b: &[DVec3; N],
        found: &Solution<N>,
        surface: impl Fn(usize) -> (DVec3, f64),
    ) {
        self.iterations.push(found.iterations);
        if !found.converged {
            self.failed += 1;
            return;
        }
        let (w, scale) = (operator.after(b, &found.p), operator.largest(b));
        let momentum = scale / operator.inverse_mass;
        for i in 0..operator.count {
            let (normal, mu) = surface(i);
            let (p, u) = (normal.dot(found.p[i]), normal.dot(w[i]));
            let (t, slip) = (found.p[i] - normal * p, w[i] - normal * u);
            let against = (t.dot(slip) + mu * p * slip.length()).abs();
            let violations = [
                -u / scale,
                p * u / (momentum * scale),
                (t.length() - mu * p) / momentum,
                against / ((1.0 + mu) * momentum * scale),
            ];
            self.worst = violations.into_iter().fold(self.worst, f64::max);
        }
    }

    pub(super) fn check(&mut self, mu: f64, bound: f64) {
        let (failed, worst) = (self.failed, self.worst);
        self.iterations.sort_unstable();
        let n = self.iterations.len();
        println!(
            "mu {mu}: Coulomb's law to {worst:.1e}; failed {failed} of {n}, iterations: median {}, 99 % {}",
            self.iterations[n / 2],
            self.iterations[n * 99 / 100]
        );
        assert!(
            failed == 0 && worst <= bound,
            "mu {mu}: {failed}, {worst:e}"
        );
    }
}
