//! The Bevy side: the main box is watched before and after each step, and the comparisons follow it.

use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use box_physics::floor::ContactState;
use box_physics::prelude::{
    ApplyImpulse, BodyIntegrator, BodyState, ContactPhase, DVec3, FloorContact, GlobalIntegrator,
    ImpulsePoint, Integrator, IntegratorMemory, PhysicsSchedule, PhysicsSystems, RigidBox,
};
use box_scenarios::Change;

use super::scene::Scene;
use super::sweep::SweepTask;
use super::{Comparison, RuleKind, copy};
use crate::action::Action;
use crate::action::compare::{CompareAction, Layout};
use crate::compare::sampling::IntegratorSamples;
use crate::scene::session::{MainBox, Session};

/// Compares the main box, a body marked [`MainBox`], with other integrators. Needs `PhysicsPlugins`.
pub struct ComparePlugin;

impl Plugin for ComparePlugin {
    fn build(&self, app: &mut App) {
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
}

/// Observes the actions of the comparison.
fn on_action(action: On<Action>, mut commands: Commands) {
    match action.event().clone() {
        Action::SetIntegrator(integrator) => commands.queue(move |world: &mut World| {
            make_main_box(world, integrator);
            if let Some(mut session) = world.get_resource_mut::<Session>() {
                session.events.push(format!("integrator {integrator}"));
            }
        }),
        Action::Compare(CompareAction::Copy) => commands.queue(copy::copy_plot),
        Action::Compare(action) => commands.queue(move |world: &mut World| apply(world, action)),
        _ => {}
    }
}

/// Takes the pushes out of the message buffer, as the plugin does: those asked for while paused wait.
fn collect_pushes(messages: Res<Messages<ApplyImpulse>>, mut comparison: ResMut<Comparison>) {
    let Comparison {
        cursor, pending, ..
    } = &mut *comparison;
    pending.extend(cursor.read(&messages));
}

/// Looks at the main box when everything that is done to it has been done.
fn before_step(scene: Scene, mut comparison: ResMut<Comparison>) {
    let comparison = &mut *comparison;
    let pending = core::mem::take(&mut comparison.pending);
    let Some((entity, state, law, integrator)) = scene.main_box() else {
        return;
    };
    scene.begin(comparison, (entity, state, &law, integrator));
    let h = scene.clock.step();
    let t = scene.clock.time() - h;
    let Some(run) = &mut comparison.run else {
        return;
    };
    if t < run.clock - 0.5 * h {
        run.rewind(t, &state);
    }
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

/// Looks at the main box after its step, and lets the comparisons follow.
pub(crate) fn after_step(
    scene: Scene,
    mut comparison: ResMut<Comparison>,
    mut contacts: MessageReader<FloorContact>,
) {
    let Some((entity, state, _, integrator)) = scene.main_box() else {
        return;
    };
    let (t, h) = (scene.clock.time(), scene.clock.step());
    let met = contacts
        .read()
        .filter(|c| c.entity == entity && c.phase == ContactPhase::Began)
        .count();
    let start = Instant::now();
    let Some(run) = &mut comparison.run else {
        return;
    };
    if met > 0 {
        run.rule(t, RuleKind::Contact);
    }
    run.after_step(t, h, (&state, scene.contacts()), integrator);
    comparison.spent += start.elapsed();
    comparison.settle();
    comparison.advance();
}

/// Between the steps: a new scene, other comparisons, other steps, and what is left to catch up with.
fn follow(
    scene: Scene,
    samples: Option<Res<IntegratorSamples>>,
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
    let Some((entity, state, law, integrator)) = scene.main_box() else {
        return;
    };
    scene.begin(comparison, (entity, state, &law, integrator));
    if let Some(run) = &mut comparison.run {
        let t = scene.clock.time();
        if t < run.clock - 0.5 * run.step {
            // Stepped back while paused.
            run.rewind(t, &state);
        }
        run.set_step(scene.step());
    }
    comparison.settle();
    if let Some(samples) = samples {
        comparison.make_fair(|i| {
            let min = samples.cost(i)?.min;
            Some((samples.evaluations(i), min))
        });
    }
    comparison.advance();
}

/// Carries out a request.
pub fn apply(world: &mut World, action: CompareAction) {
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
        CompareAction::NextLayout => settings.layout = settings.layout.next(),
        CompareAction::ToggleComparisons => {
            settings.layout = match settings.layout {
                Layout::Solo => Layout::Overlaid,
                Layout::Overlaid | Layout::SideBySide | Layout::Views => Layout::Solo,
            };
        }
        CompareAction::SetFairness(fairness) => settings.fairness = fairness,
        CompareAction::SetWindow(window) => settings.window = window,
        CompareAction::ToggleLogarithmic => settings.logarithmic ^= true,
        CompareAction::ToggleLogarithmicEnergy => settings.logarithmic_energy ^= true,
        CompareAction::ToggleLocal => settings.local ^= true,
        CompareAction::StartSweep => comparison.request_sweep(),
        CompareAction::CancelSweep => comparison.sweep.cancel(),
        CompareAction::Resync | CompareAction::Copy => {}
    }
}

/// Starts the sweep that was asked for, with the main box's integrator and the comparisons.
fn start_sweep(world: &mut World) {
    let session = world.get_resource::<Session>();
    let setup = session.map(|s| (s.setup(), s.truth.clone()));
    let samples = world.get_resource::<IntegratorSamples>();
    let grain = samples.map(IntegratorSamples::grain).unwrap_or_default();
    let boxes = world.query::<&RigidBox>().iter(world).count();
    let mut comparison = world.resource_mut::<Comparison>();
    let Some(run) = &comparison.run else {
        return;
    };
    let (setup, truth) = setup.unwrap_or_else(|| (run.law.setup(*run.start(), 10.0), None));
    let main_box = run.main_box.integrator;
    let others = comparison.chosen.iter().copied().filter(|&i| i != main_box);
    let integrators = [main_box].into_iter().chain(others).collect();
    let task = SweepTask {
        truth,
        grain,
        ..SweepTask::new(setup, boxes, integrators)
    };
    if let Err(error) = comparison.sweep.start(task)
        && let Some(mut session) = world.get_resource_mut::<Session>()
    {
        session.notice(format!("sweep: {error}"));
    }
}

/// Every comparison, and the main box, into the reference's state.
fn resync(world: &mut World) {
    let Some(state) = world
        .resource_mut::<Comparison>()
        .run
        .as_mut()
        .and_then(super::Run::resync)
    else {
        return;
    };
    let mut main_box =
        world.query_filtered::<(&mut BodyState, Option<&mut Transform>), With<MainBox>>();
    if let Some((mut now, pose)) = main_box.iter_mut(world).next() {
        *now = state;
        show(&state, pose);
    }
}

/// The pose as the plugin will write it, at once: the clock may stand.
fn show(state: &BodyState, pose: Option<Mut<Transform>>) {
    if let Some(mut pose) = pose {
        pose.translation = state.position.as_vec3();
        pose.rotation = state.rotation.as_quat();
    }
}

/// The integrator moves the main box from now on. Where a comparison runs under it, main box and comparison change places, so
/// that each trajectory stays one integrator's alone; else the main box carries its state over.
pub fn make_main_box(world: &mut World, integrator: Integrator) {
    let swapped = world.resource_scope(|world, mut comparison: Mut<Comparison>| {
        let Some(run) = &mut comparison.run else {
            return false;
        };
        let old = run.main_box.integrator;
        let mut main_box = world.query_filtered::<(
            &mut BodyState,
            &mut IntegratorMemory,
            &mut ContactState,
            Option<&mut Transform>,
        ), With<MainBox>>();
        let Some((mut state, mut memory, mut contact, pose)) = main_box.iter_mut(world).next()
        else {
            return false;
        };
        let swapped = run.swap(integrator, (&mut state, &mut memory, &mut contact));
        if swapped {
            show(&state, pose);
            let others = comparison.chosen.clone().into_iter();
            let others: Vec<_> = others.filter(|&i| i != integrator).chain([old]).collect();
            comparison.choose(others);
            // In the order of the menu again.
            comparison.settle();
        }
        swapped
    });
    let own = world
        .query_filtered::<&mut BodyIntegrator, With<MainBox>>()
        .iter_mut(world)
        .next()
        .map(|mut own| own.0 = integrator);
    if own.is_none() {
        world.insert_resource(GlobalIntegrator(integrator));
    }
    debug!("main_box under {integrator}, swapped: {swapped}");
}
