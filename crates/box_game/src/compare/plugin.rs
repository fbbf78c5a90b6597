//! The Bevy plugin: it observes the main box before and after each step, and advances the comparisons.

use std::time::Duration;

use bevy::ecs::system::SystemParam;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_physics::floor::ContactState;
use box_physics::prelude::{
    ApplyImpulse, BodyState, ContactPhase, DVec3, FloorContact, GlobalIntegrator, ImpulsePoint,
    Integrator, IntegratorMemory, PhysicsClock, PhysicsSchedule, PhysicsSystems, RigidBox,
};
use box_scenarios::{Change, Model};

use super::sweep::SweepTask;
use super::{Comparison, MarkKind, Run, copy};
use crate::action::Action;
use crate::action::compare::{CompareAction, Layout};
use crate::compare::sampling::IntegratorSamples;
use crate::scene::session::{MainBox, Session};

/// Compares the main box, a body marked [`MainBox`], with other integrators. Needs `PhysicsPlugins`.
pub fn plugin(app: &mut App) {
    app.init_resource::<Comparison>()
        .add_observer(on_action)
        .add_systems(FixedPostUpdate, collect_pushes.ambiguous_with_all())
        .add_systems(
            PhysicsSchedule,
            (
                collect_pushes
                    .in_set(PhysicsSystems::First)
                    .ambiguous_with_all(),
                before_step
                    .after(PhysicsSystems::Forces)
                    .before(PhysicsSystems::Integrate)
                    .ambiguous_with_all(),
                after_step.in_set(PhysicsSystems::Last).ambiguous_with_all(),
            ),
        )
        .add_systems(Update, follow);
}

/// Observes the actions of the comparison.
fn on_action(action: On<Action>, mut commands: Commands) {
    match action.event().clone() {
        Action::SetIntegrator(integrator) => commands.queue(move |world: &mut World| {
            make_main_box(world, integrator);
            let mut session = world.resource_mut::<Session>();
            session.events.push(format!("integrator {integrator}"));
        }),
        Action::Compare(CompareAction::Copy) => commands.queue(copy::copy_plot),
        Action::Compare(action) => commands.queue(move |world: &mut World| apply(world, action)),
        _ => {}
    }
}

/// The main box and its surroundings.
#[derive(SystemParam)]
pub(crate) struct Scene<'w, 's> {
    main_box: Query<'w, 's, (Entity, &'static BodyState, &'static ContactState), With<MainBox>>,
    integrator: Res<'w, GlobalIntegrator>,
    clock: Res<'w, PhysicsClock>,
    fixed: Res<'w, Time<Fixed>>,
    session: Res<'w, Session>,
}

impl Scene<'_, '_> {
    /// The main box, its state and its contact. A new main box starts a new run.
    fn main_box(&self, comparison: &mut Comparison) -> Option<(Entity, BodyState, &ContactState)> {
        let (entity, state, contact) = self.main_box.iter().next()?;
        if comparison.main_box != Some(entity) {
            comparison.main_box = Some(entity);
            comparison.begin(&self.session, self.integrator.0, self.step());
        }
        Some((entity, *state, contact))
    }

    /// The clock's (sub)step \[s\].
    fn step(&self) -> f64 {
        self.fixed.timestep().as_secs_f64() / f64::from(self.clock.substeps.max(1))
    }
}

/// Takes the pushes out of the message buffer, as the physics plugin does: those sent while paused wait.
fn collect_pushes(messages: Res<Messages<ApplyImpulse>>, mut comparison: ResMut<Comparison>) {
    let Comparison {
        cursor, pending, ..
    } = &mut *comparison;
    pending.extend(cursor.read(&messages));
}

/// Records the main box after all changes and before its step.
fn before_step(scene: Scene, mut comparison: ResMut<Comparison>) {
    let comparison = &mut *comparison;
    let pending = core::mem::take(&mut comparison.pending);
    let main_box = scene.main_box(comparison);
    let (Some((entity, state, _)), Some(run)) = (main_box, &mut comparison.run) else {
        return;
    };
    let h = scene.clock.step();
    let t = scene.clock.time() - h;
    if t < run.clock - 0.5 * h {
        run.rewind(t, &state);
    }
    let law = Model::of(&scene.session.setup());
    let body = law.body;
    run.before_step(t, law, &state, |expected| {
        let mut changes = Vec::new();
        for push in pending.iter().filter(|p| p.entity == entity) {
            let body_point = match push.at {
                ImpulsePoint::Center => DVec3::ZERO,
                ImpulsePoint::Body(point) => point,
                ImpulsePoint::World(point) => {
                    expected.rotation.inverse() * (point - expected.position)
                }
            };
            let mut pushed = *expected;
            push.apply(&body, &mut pushed);
            if pushed.is_valid() {
                *expected = pushed;
                changes.push(Change::Impulse {
                    impulse: push.impulse,
                    body_point,
                });
            }
        }
        changes
    });
}

/// Records the main box after its step, and advances the comparisons.
pub(crate) fn after_step(
    scene: Scene,
    mut comparison: ResMut<Comparison>,
    mut contacts: MessageReader<FloorContact>,
) {
    let comparison = &mut *comparison;
    let main_box = scene.main_box(comparison);
    let (Some((entity, state, contact)), Some(run)) = (main_box, &mut comparison.run) else {
        return;
    };
    let (t, h) = (scene.clock.time(), scene.clock.step());
    let began = |c: &FloorContact| c.entity == entity && c.phase == ContactPhase::Began;
    let start = Instant::now();
    if contacts.read().filter(|c| began(c)).count() > 0 {
        run.mark(t, MarkKind::Contact);
    }
    run.after_step(t, h, (&state, contact), scene.integrator.0);
    comparison.spent += start.elapsed();
    comparison.settle();
    comparison.advance();
}

/// Applies changes of scene, comparisons and step, and advances comparisons that are behind.
fn follow(
    scene: Scene,
    samples: Res<IntegratorSamples>,
    mut comparison: ResMut<Comparison>,
    mut commands: Commands,
) {
    let comparison = &mut *comparison;
    comparison.sweep.tick();
    if core::mem::take(&mut comparison.sweep_requested) {
        commands.queue(start_sweep);
    }
    comparison.comparisons_ms = comparison.spent.as_secs_f64() * 1e3;
    comparison.spent = Duration::ZERO;
    let main_box = scene.main_box(comparison);
    let (Some((_, state, _)), Some(run)) = (main_box, &mut comparison.run) else {
        return;
    };
    let t = scene.clock.time();
    if t < run.clock - 0.5 * run.step {
        // The user has stepped back while paused.
        run.rewind(t, &state);
    }
    run.set_step(scene.step());
    comparison.settle();
    comparison.make_fair(|i| Some((samples.evaluations(i), samples.cost(i)?.min)));
    comparison.advance();
}

fn apply(world: &mut World, action: CompareAction) {
    if action == CompareAction::Resync {
        return resync(world);
    }
    let mut comparison = world.resource_mut::<Comparison>();
    let settings = &mut comparison.settings;
    match action {
        CompareAction::ToggleComparison(integrator) => comparison.toggle(integrator),
        CompareAction::CompareAll => comparison.choose(Integrator::ALL.iter().copied()),
        CompareAction::CompareNone => comparison.choose([]),
        CompareAction::SetLayout(layout) => settings.layout = layout,
        CompareAction::NextLayout => {
            let next = (settings.layout as usize + 1) % Layout::ALL.len();
            settings.layout = Layout::ALL[next].0;
        }
        CompareAction::ToggleComparisons => {
            settings.layout = match settings.layout {
                Layout::Solo => Layout::Overlaid,
                _ => Layout::Solo,
            };
        }
        CompareAction::SetFairness(fairness) => settings.fairness = fairness,
        CompareAction::SetWindow(window) => settings.window = window,
        CompareAction::ToggleLogarithmic => settings.logarithmic ^= true,
        CompareAction::ToggleLogarithmicEnergy => settings.logarithmic_energy ^= true,
        CompareAction::ToggleLocal => settings.local ^= true,
        CompareAction::StartSweep => comparison.sweep_requested = true,
        CompareAction::CancelSweep => comparison.sweep.cancel(),
        CompareAction::Resync | CompareAction::Copy => {}
    }
}

/// Starts a requested sweep, with the main box's integrator and the comparisons.
fn start_sweep(world: &mut World) {
    let session = world.resource::<Session>();
    let (setup, truth) = (session.setup(), session.truth.clone());
    let grain = world.resource::<IntegratorSamples>().grain;
    let boxes = world.query::<&RigidBox>().iter(world).count();
    let mut comparison = world.resource_mut::<Comparison>();
    let Some(run) = &comparison.run else {
        return;
    };
    let main_box = run.main_box.integrator();
    let others = comparison.chosen.iter().copied().filter(|&i| i != main_box);
    let integrators = [main_box].into_iter().chain(others).collect();
    let task = SweepTask {
        truth,
        grain,
        ..SweepTask::new(setup, boxes, integrators)
    };
    if let Err(error) = comparison.sweep.start(task) {
        let mut session = world.resource_mut::<Session>();
        session.notice(format!("sweep: {error}"));
    }
}

/// Sets the main box and every comparison to the state of the reference.
fn resync(world: &mut World) {
    let mut comparison = world.resource_mut::<Comparison>();
    let Some(state) = comparison.run.as_mut().and_then(Run::resync) else {
        return;
    };
    let mut main_box = world.query_filtered::<&mut BodyState, With<MainBox>>();
    if let Some(mut now) = main_box.iter_mut(world).next() {
        *now = state;
    }
}

/// Changes the integrator of the main box. If a comparison uses it, main box and comparison are swapped, so each
/// trajectory keeps one integrator. Otherwise the main box keeps its state.
fn make_main_box(world: &mut World, integrator: Integrator) {
    world.resource_scope(|world, mut comparison: Mut<Comparison>| {
        let Some(run) = &mut comparison.run else {
            return;
        };
        let old = run.main_box.integrator();
        let mut main_box = world.query_filtered::<(
            &mut BodyState,
            &mut IntegratorMemory,
            &mut ContactState,
        ), With<MainBox>>();
        let Some((mut state, mut memory, mut contact)) = main_box.iter_mut(world).next() else {
            return;
        };
        if run.swap(integrator, (&mut state, &mut memory, &mut contact)) {
            let others = comparison.chosen.clone().into_iter();
            let others: Vec<_> = others.filter(|&i| i != integrator).chain([old]).collect();
            comparison.choose(others);
            // Restores the order of the menu.
            comparison.settle();
        }
    });
    world.insert_resource(GlobalIntegrator(integrator));
}
