//! The one system that carries out what was asked for.

use bevy::ecs::system::Command;
use bevy::prelude::*;
use bevy::time::Virtual;
use box_physics::prelude::{ApplyImpulse, BodyState, DVec3, PhysicsClock, RigidBox, StepPhysics};

use crate::action::{Action, Push};
use crate::camera::CameraRequest;
use crate::cli::command_line;
use crate::compare::{self, CompareAction, copy};
use crate::demo_2012;
use crate::interaction;
use crate::interaction::grab::{Grip, Hold};
use crate::interaction::{rewind, undo};
use crate::record::csv_log::CsvLog;
use crate::record::film::Recording;
use crate::record::screenshot::{Part, ScreenshotRequest};
use crate::scene::library::SceneLibrary;
use crate::scene::opening::{open_scene, reset_everything};
use crate::scene::session::{
    Hero, LONGEST_FRAME, SPEEDS, SceneEntity, Session, apply_world, insert_forces, start_scene,
};
use crate::ui::panel::Parameters;
use crate::ui::preferences::{Preferences, UI_SCALES};

/// How long the frame of [`Action::Hitch`] takes: longer than [`LONGEST_FRAME`].
pub const HITCH: core::time::Duration = core::time::Duration::from_millis(750);

/// The most steps that one request takes: a script can ask for anything.
const MOST_STEPS: u32 = 10_000;

/// The actions asked for since the last frame, in order.
#[derive(Resource, Clone, Debug, Default)]
pub struct Asked(pub Vec<Action>);

/// Carries them out.
pub fn apply_actions(world: &mut World) {
    let actions = core::mem::take(&mut world.resource_mut::<Asked>().0);
    for action in actions {
        undo::around(world, action, apply);
    }
}

fn apply(world: &mut World, action: Action) {
    match action {
        Action::SetIntegrator(i) => {
            compare::make_hero(world, i);
            event(world, format!("integrator {i}"));
        }
        Action::TogglePause => {
            let mut clock = world.resource_mut::<PhysicsClock>();
            clock.paused = !clock.paused;
        }
        Action::Step(n) => {
            world.resource_mut::<PhysicsClock>().paused = true;
            for _ in 0..n.min(MOST_STEPS) {
                rewind::keep(world);
                StepPhysics(1).apply(world);
            }
        }
        Action::StepBack(n) => rewind::step_back(world, n),
        Action::Restart => start_scene(world),
        Action::SetSpeed(speed) => set_speed(world, speed),
        Action::Slower => ladder(world, |now| {
            SPEEDS.iter().copied().rfind(|&s| s < now * 0.999)
        }),
        Action::Faster => ladder(world, |now| {
            SPEEDS.iter().copied().find(|&s| s > now * 1.001)
        }),
        Action::SetStep(step) => set_step(world, step),
        Action::SetSubsteps(n) => {
            world.resource_mut::<PhysicsClock>().substeps = n.clamp(1, 64);
            event(world, format!("substeps {n}"));
        }
        Action::SetGravity(_)
        | Action::SetRestitution(_)
        | Action::SetFriction(_)
        | Action::SetLinearDrag(_)
        | Action::SetAngularDamping(_)
        | Action::SetHalfExtents(_)
        | Action::SetMass(_)
        | Action::SetImpulse(_)
        | Action::SetBoxes(_) => set_parameter(world, &action),
        Action::ResetParameters => {
            let mut session = world.resource_mut::<Session>();
            session.parameters = session.defaults;
            start_scene(world);
        }
        Action::ResetEverything => reset_everything(world),
        Action::Undo => undo::undo(world),
        Action::Redo => undo::redo(world),
        Action::SelectScene(id) => select_scene(world, &id),
        Action::NextScene => neighbor(world, 1),
        Action::PreviousScene => neighbor(world, -1),
        Action::Push(push) => self::push(world, push),
        Action::Poke(poke) => interaction::poke(world, poke),
        Action::Grab(hold) => {
            let finite = |h: &Hold| h.body_point.is_finite() && h.anchor.is_finite();
            let hold = hold.filter(finite);
            let began = world.resource::<Grip>().0.is_none() && hold.is_some();
            if began {
                world.resource_mut::<Session>().perturb("grab".to_owned());
            }
            world.insert_resource(Grip(hold));
        }
        Action::Hitch => std::thread::sleep(HITCH),
        Action::SetDemo(stepper) => demo_2012::choose(world, stepper),
        Action::ToggleDemoLog => demo_2012::toggle_log(world),
        Action::ToggleLog => toggle_log(world),
        Action::Screenshot => {
            world.init_resource::<ScreenshotRequest>();
        }
        Action::ScreenshotTo(path) => world.insert_resource(ScreenshotRequest::of(Some(path))),
        Action::SavePlot(path) => world.insert_resource(ScreenshotRequest {
            path,
            part: Part::Plot,
        }),
        Action::Record(film) => world.insert_resource(Recording::new(film)),
        Action::CopyCommandLine => command_line::copy(world),
        Action::SetCamera(view) => world.insert_resource(CameraRequest::Look(view)),
        Action::SetUiScale(scale) => {
            let (low, high) = UI_SCALES;
            if scale.is_finite() {
                world.resource_mut::<Preferences>().ui_scale = (scale as f32).clamp(low, high);
            }
        }
        Action::TogglePicker => flip(world, |s| &mut s.show_picker),
        Action::FrameCamera => world.insert_resource(CameraRequest::Frame),
        Action::HomeCamera => world.insert_resource(CameraRequest::Home),
        Action::ToggleAabb => flip(world, |s| &mut s.show_aabb),
        Action::ToggleContacts => flip(world, |s| &mut s.show_contacts),
        Action::ToggleAxes => flip(world, |s| &mut s.show_axes),
        Action::ToggleHelp => flip(world, |s| &mut s.show_help),
        Action::TogglePanel => flip(world, |s| &mut s.hidden),
        Action::TogglePlots => flip(world, |s| &mut s.show_plots),
        Action::SelectPlot(plot) => {
            let mut session = world.resource_mut::<Session>();
            session.plot = plot;
            session.show_plots = true;
        }
        Action::Compare(CompareAction::Copy) => copy::copy_plot(world),
        Action::Compare(action) => compare::apply(world, action),
        Action::Quit => {
            world.write_message(AppExit::Success);
        }
    }
}

fn flip(world: &mut World, field: impl FnOnce(&mut Session) -> &mut bool) {
    let mut session = world.resource_mut::<Session>();
    let field = field(&mut session);
    *field = !*field;
}

fn event(world: &mut World, text: String) {
    world.resource_mut::<Session>().events.push(text);
}

/// Sets the target speed, within its ladder.
pub fn set_speed(world: &mut World, speed: f64) {
    if !speed.is_finite() {
        return;
    }
    let speed = speed.clamp(SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
    world.resource_mut::<Session>().speed = speed;
    let mut time = world.resource_mut::<Time<Virtual>>();
    time.set_relative_speed_f64(speed);
    time.set_max_delta(core::time::Duration::from_secs_f64(LONGEST_FRAME));
}

fn ladder(world: &mut World, next: impl FnOnce(f64) -> Option<f64>) {
    if let Some(speed) = next(world.resource::<Session>().speed) {
        set_speed(world, speed);
    }
}

/// Sets dt \[s\], within the limits of the command line.
pub fn set_step(world: &mut World, step: f64) {
    let (low, high) = crate::cli::STEP_LIMITS;
    if !step.is_finite() {
        return;
    }
    let step = step.clamp(low, high);
    world
        .resource_mut::<Time<Fixed>>()
        .set_timestep(core::time::Duration::from_secs_f64(step));
    event(world, format!("dt {step} s"));
}

/// Takes over one parameter, if it is within its physical range; what can change live does.
fn set_parameter(world: &mut World, action: &Action) {
    let mut session = world.resource_mut::<Session>();
    match accept(&mut session.parameters, action) {
        Accepted::No => session.notice(format!("not possible: {action:?}")),
        Accepted::Restart => start_scene(world),
        Accepted::Live => live_parameters(world, format!("{action:?}")),
        Accepted::Silent => {}
    }
}

/// What becomes of a new value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepted {
    /// It is out of range, or nothing that can be set so.
    No,
    /// It acts from the next step on.
    Live,
    /// It acts from the next start on.
    Restart,
    /// It changes no motion.
    Silent,
}

/// Takes over one parameter into `p`, if it is within its physical range.
pub fn accept(p: &mut Parameters, action: &Action) -> Accepted {
    let valid = |x: f64| x.is_finite() && x >= 0.0;
    match *action {
        Action::SetGravity(g) if g.is_finite() => p.gravity = g,
        Action::SetRestitution(e) if (0.0..=1.0).contains(&e) && p.restitution.is_some() => {
            p.restitution = Some(e);
        }
        Action::SetFriction(mu) if valid(mu) && p.friction.is_some() => p.friction = Some(mu),
        Action::SetLinearDrag(c) if valid(c) => p.linear_drag = c,
        Action::SetAngularDamping(c) if valid(c) => p.angular_damping = c,
        Action::SetImpulse(j) if valid(j) => {
            p.impulse = j;
            return Accepted::Silent;
        }
        Action::SetHalfExtents(h) if RigidBox::new(h, p.mass).is_ok() => {
            p.half_extents = h;
            return Accepted::Restart;
        }
        Action::SetMass(m) if RigidBox::new(p.half_extents, m).is_ok() => {
            p.mass = m;
            return Accepted::Restart;
        }
        Action::SetBoxes(n) => {
            p.boxes = n.clamp(1, 100_000);
            return Accepted::Restart;
        }
        _ => return Accepted::No,
    }
    Accepted::Live
}

/// Gives world and boxes the session's parameters, in flight.
pub fn live_parameters(world: &mut World, event: String) {
    let mut session = world.resource_mut::<Session>();
    session.perturb(event);
    let setup = session.setup();
    apply_world(world, &setup);
    let boxes: Vec<Entity> = world
        .query_filtered::<Entity, With<SceneEntity>>()
        .iter(world)
        .collect();
    for entity in boxes {
        insert_forces(&mut world.entity_mut(entity), &setup.forces);
    }
}

fn select_scene(world: &mut World, id: &str) {
    match world.resource::<SceneLibrary>().find(id) {
        Ok(scenario) => open_scene(world, scenario, true),
        Err(error) => world.resource_mut::<Session>().notice(error),
    }
}

fn neighbor(world: &mut World, by: isize) {
    let ids = world.resource::<SceneLibrary>().scenes().to_vec();
    let now = world.resource::<Session>().scenario.id;
    let at = ids.iter().position(|(id, _)| id == now).unwrap_or(0);
    let next = (at as isize + by).rem_euclid(ids.len() as isize) as usize;
    select_scene(world, &ids[next].0);
}

/// The impulse of a push on the hero: world axes, at the middle of the face it comes from, or at that
/// face's edge.
pub fn impulse_of(push: Push, body: &RigidBox, state: &BodyState, strength: f64) -> (DVec3, DVec3) {
    let local = if push.world {
        state.rotation.inverse() * push.direction
    } else {
        push.direction
    };
    // The face whose outward normal is most against the push, in body axes.
    let a = local.abs();
    let axis = if a.x >= a.y && a.x >= a.z {
        DVec3::X
    } else if a.y >= a.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let h = body.half_extents();
    let face = axis * (h * axis) * -local.dot(axis).signum();
    // The edge: off to the side along the next axis.
    let side = DVec3::new(axis.z, axis.x, axis.y);
    let point = if push.off_center {
        face + side * h
    } else {
        face
    };
    (state.rotation * local * strength, point)
}

fn push(world: &mut World, push: Push) {
    let strength = world.resource::<Session>().parameters.impulse;
    let hero = world
        .query_filtered::<(Entity, &RigidBox, &BodyState), With<Hero>>()
        .iter(world)
        .next()
        .map(|(e, b, s)| (e, *b, *s));
    let Some((entity, body, state)) = hero else {
        return;
    };
    let (impulse, point) = impulse_of(push, &body, &state, strength);
    let message = if push.off_center {
        ApplyImpulse::at_body_point(entity, impulse, point)
    } else {
        ApplyImpulse::center(entity, impulse)
    };
    world.write_message(message);
    let at = if push.off_center { point } else { DVec3::ZERO };
    demo_2012::push(world, impulse, at);
    world.resource_mut::<Session>().perturb(format!(
        "push {:.3} {:.3} {:.3} N s",
        impulse.x, impulse.y, impulse.z
    ));
}

fn toggle_log(world: &mut World) {
    if let Some(log) = world.remove_resource::<CsvLog>() {
        let text = format!("log closed: {} ({} rows)", log.path().display(), log.rows());
        world.resource_mut::<Session>().notice(text);
        return;
    }
    let opened = CsvLog::open_next(world.resource::<Session>());
    match opened {
        Ok(log) => {
            let text = format!("logging to {}", log.path().display());
            world.resource_mut::<Session>().notice(text);
            world.insert_resource(log);
        }
        Err(error) => world
            .resource_mut::<Session>()
            .notice(format!("log: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::DQuat;

    #[test]
    fn a_push_acts_along_the_box_s_own_axes_or_the_world_s() {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
        let quarter = DQuat::from_xyzw(0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt());
        let state = BodyState::default().with_rotation(quarter);
        let own = Push {
            direction: DVec3::X,
            world: false,
            off_center: false,
        };
        let (j, point) = impulse_of(own, &body, &state, 2.0);
        assert!((j - DVec3::Y * 2.0).length() < 1e-15);
        assert_eq!(point, DVec3::NEG_X * 0.5);
        let (j, _) = impulse_of(Push { world: true, ..own }, &body, &state, 2.0);
        assert!((j - DVec3::X * 2.0).length() < 1e-15);
        // Off-center: at the edge of the face, so there is a moment about it.
        let (_, point) = impulse_of(
            Push {
                off_center: true,
                ..own
            },
            &body,
            &state,
            2.0,
        );
        assert_eq!(point, DVec3::new(-0.5, 0.25, 0.0));
    }
}
