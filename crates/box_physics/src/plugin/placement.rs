//! Displays new bodies, and bodies whose [`BodyState`] was written by other code. `Transform` and [`WorldAabb`] follow
//! in the same frame, even without a step.

use bevy::app::{App, MainScheduleOrder, PostUpdate, RunFixedMainLoop, RunFixedMainLoopSystems};
use bevy::ecs::change_detection::{DetectChanges, DetectChangesMut, Mut, Ref, Tick};
use bevy::ecs::entity::{Entity, EntityHashMap};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::lifecycle::{Add, Remove};
use bevy::ecs::observer::On;
use bevy::ecs::query::{Changed, Has, Or, QueryData};
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::{IntoScheduleConfigs, ScheduleLabel, SingleThreadedExecutor};
use bevy::ecs::system::{ParamSet, Query, ResMut, SystemChangeTick};
use bevy::ecs::world::{DeferredWorld, World};
use bevy::transform::TransformSystems;
use bevy::transform::components::{GlobalTransform, Transform};

use super::components::{NearFloor, Quarantined, WorldAabb};
use super::impulses::collect_impulses;
use super::sleeping::any_newer;
use super::transforms::PublishedPose;
use crate::body::RigidBox;
use crate::floor::ContactState;
use crate::state::BodyState;

/// A body with everything that displays its pose.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct ShownBody {
    pub(crate) body: &'static RigidBox,
    pub(crate) state: &'static mut BodyState,
    published: &'static mut PublishedPose,
    transform: &'static mut Transform,
    global: Option<&'static mut GlobalTransform>,
    is_child: Has<ChildOf>,
    aabb: Option<&'static mut WorldAabb>,
    near: &'static mut NearFloor,
    contact: Option<&'static ContactState>,
    quarantined: Has<Quarantined>,
}

impl ShownBodyItem<'_, '_> {
    /// Writes the state to the display components. Returns the previously displayed pose.
    pub(crate) fn show(&mut self) -> PublishedPose {
        let before = *self.published;
        *self.published = PublishedPose::of(&self.state);
        self.published.show(&mut self.transform);
        if let Some(global) = &mut self.global
            && !self.is_child
        {
            **global = GlobalTransform::from(*self.transform);
        }
        self.fit();
        before
    }

    fn fit(&mut self) {
        if let Some(aabb) = &mut self.aabb {
            **aabb = WorldAabb::of(self.body, &self.state);
        }
    }

    /// Starts the body at its `Transform` if that was set, otherwise at its state.
    fn place(&mut self) {
        // A loaded body may already have contacts.
        self.near.touched = self.contact.is_some_and(|c| c.touching() != 0);
        if !self.state.is_valid() {
            // The first step quarantines the body and keeps the pose of its `Transform`.
            *self.published = PublishedPose::shown_by(&self.transform).unwrap_or_default();
        } else if self
            .published
            .take_teleport(self.body, &self.transform, &mut self.state)
            .is_ok()
        {
            self.show();
        }
    }

    /// Displays a state that other code wrote. Returns the previous pose if it differs. A `Transform` that was changed
    /// later than the state is kept: it is a teleport for the next step.
    fn show_written(&mut self, now: Tick) -> Option<PublishedPose> {
        if self.quarantined || !self.state.is_valid() {
            return None;
        }
        let written_last = |state: Tick, transform: Tick| state.is_newer_than(transform, now);
        let moved = PublishedPose::of(&self.state) != *self.published
            && (self.published.is_shown_by(&self.transform)
                || written_last(self.state.last_changed(), self.transform.last_changed()));
        if moved {
            return Some(self.show());
        }
        self.fit();
        None
    }
}

/// Displays a new body immediately, since no other system of the plugin may run in this frame. The body is not marked
/// as placed, so components inserted or changed later in the frame still count.
pub(crate) fn place_new_body(new: On<Add, RigidBox>, mut world: DeferredWorld) {
    if let Ok(mut entity) = world.get_entity_mut(new.entity)
        && let Ok(mut body) = entity.get_components_mut::<ShownBody>()
    {
        body.place();
        body.published.placed = false;
    }
}

/// Places new bodies and displays written states. Outside of a tick, such a body has jumped, and smoothing between
/// steps must not draw it in between.
pub(crate) fn show_changes<const IN_TICK: bool>(
    mut bodies: ParamSet<(
        Query<(Ref<RigidBox>, Ref<BodyState>)>,
        Query<(Entity, ShownBody), Or<(Changed<RigidBox>, Changed<BodyState>)>>,
    )>,
    mut unsmoothed: ResMut<Unsmoothed>,
    ticks: SystemChangeTick,
) {
    let (last, now) = (ticks.last_run(), ticks.this_run());
    // Scans whole columns first, because usually nothing has changed.
    let any = bodies.p0().contiguous_iter().is_ok_and(|mut tables| {
        tables.any(|(boxes, states)| {
            any_newer(boxes.changed_ticks_slice(), last, now)
                || any_newer(states.changed_ticks_slice(), last, now)
        })
    });
    if !any {
        return;
    }
    for (entity, mut body) in &mut bodies.p1() {
        if !body.published.placed {
            body.place();
        } else if let Some(before) = body.show_written(now)
            && !IN_TICK
        {
            unsmoothed.add(entity, before);
        }
    }
}

/// Bodies that jumped outside of a tick. They are displayed unsmoothed until smoothing uses poses from after the jump.
///
/// Smoothing draws a pose between those before and after the last tick, and writes it to `Transform` once per frame
/// after the ticks. Before each tick it restores the pose after the last one. Both are wrong until a second tick
/// begins.
#[derive(Resource, Default)]
pub(crate) struct Unsmoothed {
    bodies: EntityHashMap<Jump>,
    window: SmoothingWindow,
}

struct Jump {
    /// Number of ticks that must begin before smoothing is correct again.
    ticks: u8,
    /// The displayed pose after the last tick.
    before: PublishedPose,
}

impl Unsmoothed {
    pub(crate) fn add(&mut self, entity: Entity, before: PublishedPose) {
        let jump = self
            .bodies
            .entry(entity)
            .or_insert(Jump { ticks: 0, before });
        if jump.ticks < 2 {
            *jump = Jump { ticks: 2, before };
        }
    }

    /// Undoes the restoration by smoothing before a tick.
    pub(crate) fn begin_tick(world: &mut World) {
        if world.resource::<Self>().bodies.is_empty() {
            return;
        }
        world.resource_scope(|world, mut unsmoothed: Mut<Self>| {
            unsmoothed.bodies.retain(|&entity, jump| {
                if jump.ticks == 2
                    && let Ok(mut body) = world.get_entity_mut(entity)
                    && let Ok((published, mut transform)) =
                        body.get_components_mut::<(&PublishedPose, &mut Transform)>()
                {
                    if transform.translation == jump.before.translation {
                        transform.translation = published.translation;
                    }
                    if transform.rotation == jump.before.rotation {
                        transform.rotation = published.rotation;
                    }
                }
                jump.ticks -= 1;
                jump.ticks > 0
            });
        });
    }
}

/// Change ticks before and after the ticks of this frame and the smoothing between them.
#[derive(Clone, Copy, Default)]
struct SmoothingWindow(Option<(Tick, Tick)>);

impl SmoothingWindow {
    /// Returns `true` if a `Transform` that differs from the published pose was written by smoothing, not by a user.
    fn contains(self, changed: Tick, now: Tick) -> bool {
        self.0.is_some_and(|(before, after)| {
            changed.is_newer_than(before, now) && !changed.is_newer_than(after, now)
        })
    }
}

fn open_window(mut unsmoothed: ResMut<Unsmoothed>, ticks: SystemChangeTick) {
    unsmoothed.window = SmoothingWindow(Some((ticks.this_run(), ticks.this_run())));
}

fn show_unsmoothed(
    mut unsmoothed: ResMut<Unsmoothed>,
    mut bodies: Query<(&PublishedPose, &mut Transform)>,
    ticks: SystemChangeTick,
) {
    let now = ticks.this_run();
    if let Some((_, after)) = &mut unsmoothed.window.0 {
        *after = now;
    }
    for &entity in unsmoothed.bodies.keys() {
        if let Ok((published, mut transform)) = bodies.get_mut(entity)
            && !published.is_shown_by(&transform)
            && unsmoothed.window.contains(transform.last_changed(), now)
        {
            published.show(&mut transform);
        }
    }
}

/// Restores the pose of the last step when a body is disabled, instead of the interpolated pose.
pub(crate) fn disable_body(disabled: On<Add, Disabled>, mut world: DeferredWorld) {
    let now = world.read_change_tick();
    let Some(window) = world.get_resource::<Unsmoothed>().map(|u| u.window) else {
        return;
    };
    if let Ok(mut entity) = world.get_entity_mut(disabled.entity)
        && let Ok(mut body) = entity.get_components_mut::<ShownBody>()
        && window.contains(body.transform.last_changed(), now)
        && !body.published.is_shown_by(&body.transform)
    {
        body.published.show(&mut body.transform);
    }
}

/// Marks an enabled body to be placed like a new one, because changes to it went unseen while it was disabled.
pub(crate) fn enable_body(enabled: On<Remove, Disabled>, mut world: DeferredWorld) {
    if let Ok(mut entity) = world.get_entity_mut(enabled.entity)
        && let Ok(mut body) = entity.get_components_mut::<ShownBody>()
    {
        body.published.placed = false;
        body.state.set_changed();
    }
}

/// Runs once per frame, after the ticks of the fixed clock and the smoothing between them.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct AfterTicks;

/// Adds the systems and observers of this module.
pub(crate) fn build(app: &mut App) {
    let world = app.world_mut();
    // Queries for a single entity require registered components, even if no body has them.
    world.register_component::<GlobalTransform>();
    world.register_component::<ChildOf>();
    world.register_component::<WorldAabb>();
    world.register_component::<ContactState>();
    world.register_component::<Quarantined>();
    let order = &mut world.get_resource_or_init::<MainScheduleOrder>().labels;
    if let Some(ticks) = order.iter().position(|l| *l == RunFixedMainLoop.intern()) {
        order.insert(ticks + 1, AfterTicks.intern());
    }
    app.init_resource::<Unsmoothed>()
        .add_observer(place_new_body)
        .add_observer(disable_body)
        .add_observer(enable_body)
        .init_schedule(AfterTicks)
        .edit_schedule(AfterTicks, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        })
        .add_systems(AfterTicks, show_unsmoothed)
        .add_systems(
            RunFixedMainLoop,
            (show_changes::<false>, open_window)
                .chain()
                .in_set(RunFixedMainLoopSystems::BeforeFixedMainLoop),
        )
        .add_systems(
            PostUpdate,
            (show_changes::<false>, collect_impulses)
                .chain()
                .before(TransformSystems::Propagate),
        );
}
