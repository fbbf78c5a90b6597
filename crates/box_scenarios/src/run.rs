//! Advancing a setup by any integrator: from sample to sample, through its impulses, in equal steps.

use box_physics::body::RigidBox;
use box_physics::floor::{ContactSettings, ContactState, Floor, FloorContext, step_on_floor};
use box_physics::force::{Dissipation, ForceModel, Gravity};
use box_physics::integrators::{
    Integrate, Integrator, IntegratorMemory, IntegratorVisitor, StepOutcome,
};
use box_physics::state::BodyState;

use crate::setup::{FloorSpec, Setup, TimedImpulse};

/// What a run cost and how often an integrator gave way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Steps taken.
    pub steps: u64,
    /// Force evaluations.
    pub evaluations: u64,
    /// Steps handed to `split`.
    pub fallbacks: u64,
    /// Iterations that ended at their cap.
    pub unconverged: u64,
}

impl Totals {
    /// Adds one step.
    #[inline(always)]
    pub fn count(&mut self, outcome: StepOutcome) {
        self.steps += 1;
        self.evaluations += u64::from(outcome.evaluations);
        self.fallbacks += u64::from(outcome.fallbacks);
        self.unconverged += u64::from(outcome.unconverged);
    }
}

impl core::ops::AddAssign for Totals {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.evaluations += other.evaluations;
        self.fallbacks += other.fallbacks;
        self.unconverged += other.unconverged;
    }
}

/// `n` steps of `h` \[s\] by `integrator`, compiled for the integrator: one match, then a tight loop.
pub fn advance<F: ForceModel>(
    integrator: Integrator,
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    n: u64,
    memory: &mut IntegratorMemory,
) -> Totals {
    integrator.dispatch(Steps {
        body,
        state,
        force,
        h,
        n,
        memory,
        floor: None,
    })
}

struct Steps<'a, F> {
    body: &'a RigidBox,
    state: &'a mut BodyState,
    force: &'a F,
    h: f64,
    n: u64,
    memory: &'a mut IntegratorMemory,
    floor: Option<&'a mut OnFloor>,
}

impl<F: ForceModel> IntegratorVisitor for Steps<'_, F> {
    type Output = Totals;

    fn visit<S: Integrate>(self) -> Totals {
        let mut totals = Totals::default();
        let (body, force, h) = (self.body, self.force, self.h);
        let (state, memory) = (self.state, self.memory);
        match self.floor {
            None => {
                for _ in 0..self.n {
                    totals.count(S::step(body, state, force, h, memory));
                }
            }
            Some(f) => {
                for _ in 0..self.n {
                    let (floor, settings, contact) = (&f.floor, &f.settings, &mut f.contact);
                    let outcome = step_on_floor::<S, F>(
                        &FloorContext {
                            floor,
                            settings,
                            body,
                            force,
                        },
                        state,
                        h,
                        memory,
                        contact,
                        None,
                    );
                    totals.count(outcome.step);
                }
            }
        }
        totals
    }
}

/// The floor, and what the contact solver remembers of the body on it.
struct OnFloor {
    floor: Floor,
    settings: ContactSettings,
    contact: ContactState,
}

impl OnFloor {
    fn new(spec: &FloorSpec) -> Self {
        Self {
            floor: Floor {
                height: spec.height,
                restitution: spec.restitution,
                friction: spec.friction,
            },
            settings: ContactSettings::default(),
            contact: ContactState::default(),
        }
    }
}

/// How many equal steps of at most `dt` \[s\] fill `interval` \[s\]: the ceiling of their ratio, where a
/// ratio within 1e-9 of a whole number counts as that number (30.000000000000004 steps are 30).
pub fn steps_in(interval: f64, dt: f64) -> u64 {
    let ratio = interval / dt;
    let nearest = ratio.round();
    let n = if (ratio - nearest).abs() <= 1e-9 * ratio.max(1.0) {
        nearest
    } else {
        ratio.ceil()
    };
    n as u64
}

/// A stretch without events: `steps` of `h` \[s\], then perhaps a sample, then perhaps impulses.
#[derive(Clone, Debug, PartialEq)]
struct Leg {
    h: f64,
    steps: u64,
    /// Time at the end \[s\].
    end: f64,
    /// Whether the state at the end is to be looked at (before the impulses).
    sample: bool,
    impulses: Vec<TimedImpulse>,
}

/// Steps between two looks at the budget.
const BLOCK: u64 = 4096;

impl Leg {
    /// Stops after a block of steps in which `budget` evaluations were exceeded.
    fn run<F: ForceModel>(
        &self,
        integrator: Integrator,
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        memory: &mut IntegratorMemory,
        mut floor: Option<&mut OnFloor>,
        budget: u64,
    ) -> Totals {
        let mut totals = Totals::default();
        while totals.steps < self.steps && totals.evaluations <= budget {
            totals += integrator.dispatch(Steps {
                body,
                state,
                force,
                h: self.h,
                n: (self.steps - totals.steps).min(BLOCK),
                memory,
                floor: floor.as_deref_mut(),
            });
        }
        totals
    }
}

/// The steps of a run: each interval between samples and impulses in equal steps of at most dt.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    legs: Vec<Leg>,
}

impl Plan {
    /// For samples at `times` \[s\] (not decreasing, ≥ 0) and `impulses` (in order of time; later than
    /// the last sample, they are ignored), with steps of at most `dt` \[s\]. A sample at an impulse's
    /// time is the state just before it.
    pub fn new(times: &[f64], impulses: &[TimedImpulse], dt: f64) -> Self {
        let mut legs: Vec<Leg> = Vec::with_capacity(times.len() + impulses.len());
        let mut now = 0.0;
        let mut waiting = impulses.iter().copied().peekable();
        let mut leg_to = |t: f64, sample| {
            let steps = if t > now {
                steps_in(t - now, dt).max(1)
            } else {
                0
            };
            let h = if steps > 0 {
                (t - now) / steps as f64
            } else {
                0.0
            };
            now = t;
            Leg {
                h,
                steps,
                end: t,
                sample,
                impulses: Vec::new(),
            }
        };
        for &t in times {
            while let Some(i) = waiting.next_if(|i| i.t < t) {
                let mut leg = leg_to(i.t, false);
                leg.impulses.push(i);
                legs.push(leg);
            }
            legs.push(leg_to(t, true));
        }
        Self { legs }
    }

    /// `samples` samples, one after every `stride` steps of exactly `h` \[s\]: the clock of a game. Every
    /// step is bit for bit as long as the last, so that an integrator's memory stays valid throughout.
    pub fn clock(h: f64, stride: u64, samples: u64) -> Self {
        let leg = |k: u64| Leg {
            h,
            steps: stride,
            end: (k * stride) as f64 * h,
            sample: true,
            impulses: Vec::new(),
        };
        Self {
            legs: (1..=samples).map(leg).collect(),
        }
    }

    /// Steps altogether.
    pub fn steps(&self) -> u64 {
        // A file may ask for more than a number can hold.
        self.legs
            .iter()
            .fold(0, |sum: u64, leg| sum.saturating_add(leg.steps))
    }
}

/// Runs `setup` by `integrator` along `plan`, and shows time \[s\] and state at every sample to `look`,
/// which returns whether to go on.
pub fn run_plan(
    setup: &Setup,
    integrator: Integrator,
    plan: &Plan,
    look: impl FnMut(f64, &BodyState) -> bool,
) -> Totals {
    run_plan_within(setup, integrator, plan, u64::MAX, look)
}

/// [`run_plan`], given up soon after more than `budget` force evaluations: for setups that come from a file, which may
/// ask for anything.
pub fn run_plan_within(
    setup: &Setup,
    integrator: Integrator,
    plan: &Plan,
    budget: u64,
    mut look: impl FnMut(f64, &BodyState) -> bool,
) -> Totals {
    let body = &setup.body;
    let forces = setup.forces.forces(body);
    // Most scenes have no more than gravity: the smaller law compiles to a smaller loop.
    let gravity = Gravity(forces.acceleration);
    let only_gravity = !forces.has_wrench() && forces.dissipation == Dissipation::NONE;
    let mut floor = setup.floor.as_ref().map(OnFloor::new);
    let mut state = setup.initial;
    let mut memory = IntegratorMemory::default();
    let mut totals = Totals::default();
    for leg in &plan.legs {
        let left = budget - totals.evaluations;
        let (state, memory, floor) = (&mut state, &mut memory, floor.as_mut());
        totals += if only_gravity {
            leg.run(integrator, body, state, &gravity, memory, floor, left)
        } else {
            leg.run(integrator, body, state, &forces, memory, floor, left)
        };
        if totals.evaluations > budget {
            break;
        }
        if leg.sample && !look(leg.end, state) {
            break;
        }
        for i in &leg.impulses {
            state.apply_impulse_at_body_point(body, i.impulse, i.body_point);
        }
    }
    totals
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::ForceSet;
    use glam::DVec3;

    #[test]
    fn the_ceiling_knows_rounding() {
        assert_eq!(steps_in(0.5, 1.0 / 60.0), 30);
        assert_eq!(steps_in(30.000000000000004 / 60.0, 1.0 / 60.0), 30);
        assert_eq!(steps_in(0.25, 1.0 / 60.0), 15);
        assert_eq!(steps_in(0.125, 1.0 / 60.0), 8);
        assert_eq!(steps_in(0.5001, 1.0 / 60.0), 31);
        assert_eq!(steps_in(1e-6, 1.0 / 60.0), 1);
    }

    #[test]
    fn samples_come_before_impulses() {
        let kick = |t| TimedImpulse {
            t,
            impulse: DVec3::X,
            body_point: DVec3::ZERO,
        };
        let setup = Setup::new(
            RigidBox::default(),
            BodyState::default(),
            ForceSet::none(),
            2.0,
        )
        .with_impulses(vec![kick(0.0), kick(0.95), kick(1.0), kick(5.0)]);
        let plan = Plan::new(&[0.0, 1.0, 2.0], &setup.impulses, 0.1);
        let mut seen = Vec::new();
        let totals = run_plan(&setup, Integrator::Split, &plan, |t, s| {
            seen.push((t, s.velocity.x));
            true
        });
        assert_eq!(seen, [(0.0, 0.0), (1.0, 2.0), (2.0, 3.0)]);
        // 0.95 in 10 steps, 0.05 in 1, 1 in 10.
        assert_eq!((totals.steps, plan.steps()), (21, 21));
    }
}
