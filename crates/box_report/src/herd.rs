//! What a step costs: several bodies of one scene stepped together by one integrator, as the plugin does.

use box_bench::measure::Contender;
use box_physics::body::RigidBox;
use box_physics::force::{Dissipation, ForceModel, Gravity};
use box_physics::integrators::{Integrate, Integrator, IntegratorMemory, IntegratorVisitor};
use box_physics::state::BodyState;
use box_scenarios::{Plan, Setup, run_plan};

/// Body-steps in a call that is timed: some 100 µs.
const BODY_STEPS: u64 = 2048;
/// Bodies that are stepped together: enough for the processor to work on several at once.
const BODIES: usize = 8;

/// A contender that steps bodies of `setup` by `integrator` in steps of `h` \[s\]; its units are
/// body-steps. Without a floor, eight bodies start at `starts` (all at the setup's start, if there are
/// none), at most `run` steps each; with a floor, one body does the whole run of `run` steps, impacts
/// included.
pub(crate) fn contender<'a>(
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
            *starts
                .get(k % starts.len().max(1))
                .unwrap_or(&setup.initial)
        })
        .collect();
    let steps = (BODY_STEPS / BODIES as u64).min(run).max(1);
    let forces = setup.forces.forces(&setup.body);
    let only_gravity = !forces.has_wrench() && forces.dissipation == Dissipation::NONE;
    let mut herd = Vec::with_capacity(BODIES);
    Contender::new((steps * BODIES as u64) as f64, move || {
        herd.clear();
        herd.extend(starts.iter().map(|&s| (s, IntegratorMemory::default())));
        if only_gravity {
            let force = &Gravity(forces.acceleration);
            integrator.dispatch(Herd::new(&setup.body, force, h, steps, &mut herd));
        } else {
            integrator.dispatch(Herd::new(&setup.body, &forces, h, steps, &mut herd));
        }
        std::hint::black_box(&herd);
    })
}

struct Herd<'a, F> {
    body: &'a RigidBox,
    force: &'a F,
    h: f64,
    steps: u64,
    members: &'a mut [(BodyState, IntegratorMemory)],
}

impl<'a, F> Herd<'a, F> {
    fn new(
        body: &'a RigidBox,
        force: &'a F,
        h: f64,
        steps: u64,
        members: &'a mut [(BodyState, IntegratorMemory)],
    ) -> Self {
        Self {
            body,
            force,
            h,
            steps,
            members,
        }
    }
}

impl<F: ForceModel> IntegratorVisitor for Herd<'_, F> {
    type Output = ();

    fn visit<S: Integrate>(self) {
        for _ in 0..self.steps {
            for (state, memory) in &mut *self.members {
                S::step(self.body, state, self.force, self.h, memory);
            }
        }
    }
}
