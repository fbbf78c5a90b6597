//! Cost of a step along the plugin's path: many bodies as the plugin steps a table of them, or one body by its
//! plain step.

use box_bench::measure::Contender;
use box_physics::body::RigidBox;
use box_physics::force::{ForceModel, Gravity};
use box_physics::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor};
use box_physics::state::BodyState;
use box_scenarios::{Driver, Model, Plan, Setup, run_plan};

/// Body-steps in a call that is timed: some 100 µs.
const BODY_STEPS: u64 = 4096;
/// Bodies that are stepped together: enough for SIMD lanes and for a processor to overlap steps.
const BODIES: usize = 16;

/// A contender that steps many bodies of `setup` by `integrator` in steps of `h` \[s\], as the plugin does: in
/// SIMD lanes under gravity alone, where the integrator has them, else one by one. Its units are body-steps.
/// Without a floor, the bodies start at `starts` (all at the setup's start, if there are none), at most `run`
/// steps each; with a floor, one body does the whole run of `run` steps, impacts included.
pub(crate) fn many<'a>(
    setup: &'a Setup,
    starts: &'a [BodyState],
    integrator: Integrator,
    h: f64,
    run: u64,
) -> Contender<'a> {
    if setup.floor.is_some() {
        let plan = Plan::clock(h, run, 1);
        return Contender::new(run as f64, move || {
            run_plan(setup, integrator, &plan, |_, state| {
                std::hint::black_box(state.position);
                true
            });
        });
    }
    let starts: Vec<BodyState> = (0..BODIES)
        .map(|k| {
            let start = starts.get(k % starts.len().max(1));
            *start.unwrap_or(&setup.initial)
        })
        .collect();
    let steps = (BODY_STEPS / BODIES as u64).min(run).max(1);
    let model = Model::of(setup);
    let bodies = vec![setup.body; BODIES];
    let mut states = starts.clone();
    Contender::new((steps * BODIES as u64) as f64, move || {
        states.copy_from_slice(&starts);
        let mut memories = vec![IntegratorMemory::default(); BODIES];
        let forces = model.forces.forces(&model.body);
        if model.only_gravity() {
            let gravity = Gravity(forces.acceleration);
            for _ in 0..steps {
                integrator.step_all(&bodies, &mut states, &mut memories, &gravity, h);
            }
        } else {
            integrator.dispatch(OneByOne {
                body: &model.body,
                force: &forces,
                h,
                steps,
                states: &mut states,
                memories: &mut memories,
            });
        }
        std::hint::black_box(&states);
    })
}

/// A contender that steps one body of `setup` from its start: what a game pays that has no others. Its units
/// are steps.
pub(crate) fn one(setup: &Setup, integrator: Integrator, h: f64, run: u64) -> Contender<'_> {
    let model = Model::of(setup);
    let steps = BODY_STEPS.min(run).max(1);
    Contender::new(steps as f64, move || {
        let mut driver = Driver::new(setup.initial, integrator);
        driver.run(&model, h, steps, u64::MAX);
        std::hint::black_box(driver.state);
    })
}

/// Bodies under forces that differ, as the plugin's loop without SIMD lanes.
struct OneByOne<'a, F> {
    body: &'a RigidBox,
    force: &'a F,
    h: f64,
    steps: u64,
    states: &'a mut [BodyState],
    memories: &'a mut [IntegratorMemory],
}

impl<F: ForceModel> IntegratorVisitor for OneByOne<'_, F> {
    type Output = ();

    fn visit<S: Integrate>(self) {
        for _ in 0..self.steps {
            for (state, memory) in self.states.iter_mut().zip(&mut *self.memories) {
                let before = *state;
                S::step(self.body, state, self.force, self.h, memory);
                if !state.is_valid() {
                    *state = before;
                }
            }
        }
    }
}
