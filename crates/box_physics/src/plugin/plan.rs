//! Which of the passes over the bodies can be one.

use std::any::TypeId;

use bevy::ecs::change_detection::ContiguousMut;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::{ApplyDeferred, Schedule, Schedules};
use bevy::ecs::system::{BoxedSystem, IntoSystem};
use bevy::ecs::world::World;

use super::components::WorldAabb;
use super::{PhysicsSchedule, systems};

/// How the next step is made.
///
/// *Integrate*, *Contact*, *Refit* and *Writeback* each go over all bodies. Where no other system stands
/// between them, nobody can tell whether a body's bounding box and `Transform` are written in their turn or
/// right after the body is stepped, by the thread that has its numbers at hand: then that is done, and the
/// last two find nothing left to do but for bodies in quarantine.
#[derive(Resource)]
pub(crate) struct StepPlan {
    /// Show the bodies of a chunk as soon as they are stepped.
    pub(crate) at_once: bool,
    /// There are bounding boxes to be fitted.
    fit: bool,
    integrate: TypeId,
    refit: TypeId,
    last: TypeId,
    /// These and what else may stand between the first and the last.
    ours: [TypeId; 5],
}

impl Default for StepPlan {
    fn default() -> Self {
        let integrate = type_of(systems::integrate);
        let refit = type_of(systems::refit_aabbs);
        let last = type_of(systems::write_transforms);
        Self {
            at_once: false,
            fit: false,
            integrate,
            refit,
            last,
            ours: [
                integrate,
                type_of(systems::contact),
                refit,
                last,
                // Applies the commands of those above.
                TypeId::of::<ApplyDeferred>(),
            ],
        }
    }
}

/// What the schedule knows a system by.
fn type_of<M>(system: impl IntoSystem<(), (), M> + 'static) -> TypeId {
    let system: BoxedSystem = Box::new(IntoSystem::into_system(system));
    system.system_type()
}

impl StepPlan {
    /// Plans for the schedule as it is now.
    pub(crate) fn update(world: &mut World) {
        let schedule = world
            .get_resource::<Schedules>()
            .and_then(|schedules| schedules.get(PhysicsSchedule));
        let plan = world.resource::<Self>();
        let (at_once, fit) = schedule.map_or((false, false), |schedule| plan.read(schedule));
        let mut plan = world.resource_mut::<Self>();
        (plan.at_once, plan.fit) = (at_once, fit);
    }

    /// Whether nothing stands between our systems, and whether there is *Refit*. A schedule that was not yet
    /// run, or not since it was changed, has no order.
    fn read(&self, schedule: &Schedule) -> (bool, bool) {
        let Ok(systems) = schedule.systems() else {
            return (false, false);
        };
        let mut fit = false;
        let from_the_first = systems
            .map(|(_, system)| system.system_type())
            .skip_while(|system| *system != self.integrate);
        for system in from_the_first {
            fit |= system == self.refit;
            if system == self.last {
                return (true, fit);
            }
            if !self.ours.contains(&system) {
                break;
            }
        }
        (false, false)
    }

    /// The bounding boxes that are to be fitted at once: none, or all.
    pub(crate) fn column<'a>(
        &self,
        fitted: &'a mut Option<ContiguousMut<'_, WorldAabb>>,
    ) -> &'a mut [WorldAabb] {
        match fitted {
            Some(fitted) if self.fit => fitted.bypass_change_detection(),
            _ => &mut [],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prelude::*;
    use bevy::MinimalPlugins;
    use bevy::app::App;
    use bevy::ecs::change_detection::DetectChanges;
    use bevy::ecs::entity::Entity;
    use bevy::ecs::query::With;
    use bevy::ecs::schedule::IntoScheduleConfigs;
    use bevy::ecs::system::{Command, Query};
    use bevy::transform::components::Transform;

    /// Boxes in the air, on the floor, spinning, resting, and one that cannot be stepped.
    fn app() -> (App, Vec<Entity>) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
            .insert_resource(Floor::default());
        let bodies = (0..40)
            .map(|i| {
                let body = RigidBox::new(DVec3::new(0.2, 0.3, 0.4), 1.0).expect("valid");
                let x = f64::from(i);
                let mut state = BodyState::at(DVec3::new(x, 0.3 + 0.2 * (x % 9.0), 0.0))
                    .with_angular_velocity(&body, DVec3::new(0.1, 0.2, 0.3) * (x % 4.0));
                if i == 7 {
                    state.velocity.x = f64::INFINITY;
                }
                app.world_mut().spawn((body, state)).id()
            })
            .collect();
        (app, bodies)
    }

    fn shown(app: &App, bodies: &[Entity]) -> Vec<(BodyState, Transform, WorldAabb, bool)> {
        let world = app.world();
        let get = |&e: &Entity| {
            let transform = world.entity(e).get_ref::<Transform>().expect("a body's");
            (
                *world.get(e).expect("a body's"),
                *transform,
                *world.get(e).expect("a body's"),
                transform.last_changed()
                    == world
                        .entity(bodies[0])
                        .get_ref::<Transform>()
                        .expect("a body's")
                        .last_changed(),
            )
        };
        bodies.iter().map(get).collect()
    }

    fn at_once(app: &App) -> bool {
        app.world().resource::<StepPlan>().at_once
    }

    #[test]
    fn bodies_are_shown_at_once_where_nobody_stands_between() {
        let (mut app, _) = app();
        StepPhysics(2).apply(app.world_mut());
        assert!(at_once(&app));
        // A system before and one after change nothing.
        app.add_systems(
            PhysicsSchedule,
            (
                (|| ()).in_set(PhysicsSystems::Forces),
                (|| ()).in_set(PhysicsSystems::Last),
            ),
        );
        StepPhysics(2).apply(app.world_mut());
        assert!(at_once(&app));
        let between = (|| ())
            .after(PhysicsSystems::Contact)
            .before(PhysicsSystems::Refit);
        app.add_systems(PhysicsSchedule, between);
        StepPhysics(2).apply(app.world_mut());
        assert!(!at_once(&app));
    }

    #[test]
    fn either_way_shows_the_same() {
        let ((mut one, bodies), (mut other, others)) = (app(), app());
        let between = (|| ())
            .after(PhysicsSystems::Integrate)
            .before(PhysicsSystems::Contact);
        other.add_systems(PhysicsSchedule, between);
        for _ in 0..60 {
            StepPhysics(1).apply(one.world_mut());
            StepPhysics(1).apply(other.world_mut());
            assert!(shown(&one, &bodies) == shown(&other, &others));
        }
        assert!(at_once(&one) && !at_once(&other));
    }

    #[test]
    fn who_stands_between_is_obeyed() {
        let (mut app, bodies) = app();
        let lift = |mut bodies: Query<&mut BodyState, With<RigidBox>>| {
            for mut state in &mut bodies {
                state.position.y = 5.0;
            }
        };
        let between = lift
            .after(PhysicsSystems::Contact)
            .before(PhysicsSystems::Refit);
        app.add_systems(PhysicsSchedule, between);
        StepPhysics(3).apply(app.world_mut());
        for (_, transform, aabb, _) in shown(&app, &bodies) {
            assert!(transform.translation.y == 5.0);
            assert!(aabb.0.min.y < 5.0 && aabb.0.max.y > 5.0);
        }
    }
}
