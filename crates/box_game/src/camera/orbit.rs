//! An orbit camera: drag on empty space to rotate, right or middle drag to pan, scroll to zoom.
//!
//! A gesture that begins on the panel or the view belongs to it until the button is released, at any position of the
//! pointer.

#[cfg(feature = "gamepad")]
use bevy::input::gamepad::Gamepad;
use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use box_physics::prelude::{BodyState, Floor};
use box_scenarios::SceneView;

use super::TONEMAPPING;
use crate::action::Action;
use crate::input::UiFocus;
use crate::interaction::mouse::Hand;
use crate::interaction::pointer::{NOTCH, Pointer};
use crate::scene::session::{MainBox, Session};
use crate::scene::start::SceneOpened;
use crate::view::renderer::PictureTarget;

/// Radius of the middle of the picture, relative to the distance of the camera.
const MIDDLE: f32 = 0.3;

/// Pose of the camera.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct OrbitCamera {
    /// Point in the middle of the view \[m\].
    pub target: Vec3,
    /// Angle about the vertical \[rad\].
    pub yaw: f32,
    /// Angle above the horizon \[rad\], −1.5 to 1.5.
    pub pitch: f32,
    /// Distance from the target \[m\].
    pub distance: f32,
}

impl OrbitCamera {
    /// The scene's default view: five radii from the main box, farther with many boxes.
    pub fn home(session: &Session) -> Self {
        let setup = &session.scenario.setup;
        let boxes = session.parameters.boxes() as f32;
        let radius = setup.body.radius() as f32;
        let mut target = setup.initial.position.as_vec3();
        let mut distance = (5.0 * radius).max(1.5) * (1.0 + 0.35 * (boxes.sqrt() - 1.0));
        if let Some(floor) = setup.floor {
            // Includes the floor in the view.
            let height = target.y - floor.height as f32;
            target.y -= 0.5 * height;
            distance = distance.max(1.6 * height + 5.0 * radius);
        }
        let home = Self {
            target,
            yaw: 0.0,
            pitch: 0.0,
            distance,
        };
        home.seen_as(&session.scenario.view)
    }

    /// The pose of `view`. A target or distance that it does not set is unchanged.
    #[must_use]
    pub fn seen_as(self, view: &SceneView) -> Self {
        let limit = 85.0_f32.to_radians();
        Self {
            target: view.target.map_or(self.target, |t| t.as_vec3()),
            yaw: (view.yaw as f32).to_radians(),
            pitch: (view.pitch as f32).to_radians().clamp(-limit, limit),
            distance: view
                .distance
                .map_or(self.distance, |d| (d as f32).clamp(0.01, 1e5)),
        }
    }

    /// Scales the distance by this factor without moving `fixed` in the picture. `fixed` is a point of the plane
    /// through the target across the view.
    #[must_use]
    pub fn zoomed(self, factor: f32, fixed: Option<Vec3>) -> Self {
        let distance = (self.distance * factor).clamp(0.01, 1e5);
        let factor = distance / self.distance;
        let target = fixed.map_or(self.target, |fixed| fixed + (self.target - fixed) * factor);
        Self {
            target,
            distance,
            ..self
        }
    }

    /// Follows a box that leaves the middle of the picture, by the smallest shift. A view that was shifted away from
    /// the box stays unchanged.
    fn keep_in_view(&mut self, before: Vec3, now: Vec3) {
        let most = (MIDDLE * self.distance).max(before.distance(self.target));
        let out = now - self.target;
        self.target += out - out.clamp_length_max(most);
    }

    /// The pose as a Bevy transform.
    pub fn transform(&self) -> Transform {
        let rotation = Quat::from_euler(EulerRot::YXZ, self.yaw, -self.pitch, 0.0);
        let position = self.target + rotation * Vec3::Z * self.distance;
        Transform::from_translation(position).with_rotation(rotation)
    }
}

/// Request to move the camera.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub enum CameraRequest {
    /// Centered on the main box.
    Frame,
    /// The scene's own view.
    Home,
    /// A given view.
    Look(SceneView),
}

/// Observes actions that move the camera.
pub fn on_action(action: On<Action>, mut commands: Commands) {
    commands.insert_resource(match *action {
        Action::FrameCamera => CameraRequest::Frame,
        Action::HomeCamera => CameraRequest::Home,
        Action::SetCamera(view) => CameraRequest::Look(view),
        _ => return,
    });
}

/// Resets the camera to the view of a new scene.
pub fn go_home(opened: On<SceneOpened>, mut commands: Commands) {
    if opened.new {
        commands.insert_resource(CameraRequest::Home);
    }
}

/// Owner of the drag in progress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gesture {
    /// No button is down.
    #[default]
    None,
    /// The drag began on the panel, or on the box: poke or grab.
    Elsewhere,
    /// The drag began on the view: rotate.
    Orbit,
    /// The drag began on the view: pan.
    Pan,
}

impl Gesture {
    /// Owner of the drag after this frame of the pointer.
    fn next(self, pointer: &Pointer, over_panel: bool, on_box: bool) -> Self {
        match self {
            _ if !(pointer.left || pointer.other) => Self::None,
            Self::None if pointer.left_pressed || pointer.other_pressed => match pointer.other {
                _ if over_panel || on_box => Self::Elsewhere,
                true => Self::Pan,
                false => Self::Orbit,
            },
            begun => begun,
        }
    }
}

/// Spawns the camera with the scene's default view.
pub fn spawn_camera(
    session: Res<Session>,
    (target, adapter): (Res<PictureTarget>, Option<Res<RenderAdapterInfo>>),
    mut commands: Commands,
) {
    let orbit = OrbitCamera::home(&session);
    commands.spawn((
        Camera3d::default(),
        orbit,
        orbit.transform(),
        target.0.clone(),
        target.antialiasing(adapter.as_deref()),
        TONEMAPPING,
    ));
}

/// Moves the camera by the mouse.
pub(crate) fn move_camera(
    mut camera: Single<(&mut OrbitCamera, &mut Transform, &Camera)>,
    (pointer, focus, hand): (Res<Pointer>, Res<UiFocus>, Res<Hand>),
    (session, floor): (Res<Session>, Option<Res<Floor>>),
    request: Option<Res<CameraRequest>>,
    main_box: Query<&BodyState, With<MainBox>>,
    (mut gesture, mut seen): (Local<Gesture>, Local<Option<Vec3>>),
    mut commands: Commands,
) {
    let (orbit, transform, lens) = &mut *camera;
    let on_box = *hand != Hand::Idle;
    *gesture = gesture.next(&pointer, focus.pointer, on_box);
    match *gesture {
        Gesture::Orbit => {
            orbit.yaw -= pointer.moved.x * 0.006;
            orbit.pitch = (orbit.pitch + pointer.moved.y * 0.006).clamp(-1.5, 1.5);
        }
        Gesture::Pan => {
            let scale = orbit.distance * 0.0015;
            let shift = transform.rotation * Vec3::new(-pointer.moved.x, pointer.moved.y, 0.0);
            orbit.target += shift * scale;
        }
        Gesture::None | Gesture::Elsewhere => {}
    }
    if !focus.pointer && !on_box && pointer.notches != 0.0 {
        let fixed = under_cursor(orbit, lens, pointer.at);
        **orbit = orbit.zoomed(NOTCH.powf(pointer.notches), fixed);
    }
    // Without a floor and without a target set by the scene, the camera follows the main box.
    let stays = floor.is_some() || session.scenario.view.target.is_some();
    let at = main_box.iter().next().map(|state| state.position.as_vec3());
    match (at, *seen) {
        (Some(now), Some(before)) if !stays => orbit.target += now - before,
        (Some(now), Some(before)) if floor.is_some() => orbit.keep_in_view(before, now),
        _ => {}
    }
    *seen = at;
    if let Some(request) = request {
        match *request {
            CameraRequest::Home => {
                **orbit = OrbitCamera::home(&session);
                // The main box may have moved since the start.
                if let (false, Some(now)) = (stays, at) {
                    let start = session.setup().initial.position.as_vec3();
                    orbit.target += now - start;
                }
            }
            CameraRequest::Look(view) => **orbit = orbit.seen_as(&view),
            CameraRequest::Frame => orbit.target = at.unwrap_or(orbit.target),
        }
        commands.remove_resource::<CameraRequest>();
    }
    **transform = orbit.transform();
}

/// Rotates the camera by the right stick of a gamepad, at full deflection by 2.5 rad/s.
#[cfg(feature = "gamepad")]
pub fn turn_camera(
    pads: Query<&Gamepad>,
    time: Res<Time<Real>>,
    mut camera: Single<&mut OrbitCamera>,
) {
    for pad in &pads {
        let stick = pad.right_stick();
        if stick.length() > 0.1 {
            let turn = stick * 2.5 * time.delta_secs();
            camera.yaw -= turn.x;
            camera.pitch = (camera.pitch - turn.y).clamp(-1.5, 1.5);
        }
    }
}

/// The point under the mouse in the plane through the target across the view.
fn under_cursor(orbit: &OrbitCamera, camera: &Camera, cursor: Option<Vec2>) -> Option<Vec3> {
    let eye = orbit.transform();
    let cursor = cursor?;
    let rect = camera.logical_viewport_rect()?;
    if !rect.contains(cursor) {
        // The mouse is in another view.
        return None;
    }
    let ray = camera.viewport_to_world(&eye.into(), cursor).ok()?;
    let along = ray.direction.dot(*eye.forward());
    (along > 0.1).then(|| ray.get_point(orbit.distance / along))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gesture_belongs_to_whoever_it_began_on() {
        use Gesture::{Elsewhere, None, Orbit, Pan};
        let (left, other, pressed) = (1, 2, 4);
        let (begin, more) = (left + pressed, left + other + pressed);
        for (before, buttons, over_panel, on_box, after) in [
            // Begins on the panel and moves over the view: belongs to the panel.
            (None, begin, true, false, Elsewhere),
            (Elsewhere, left, false, false, Elsewhere),
            (Elsewhere, 0, false, false, None),
            // Begins on the view and moves over the panel: belongs to the view.
            (None, begin, false, false, Orbit),
            (Orbit, left, true, false, Orbit),
            (None, other + pressed, false, false, Pan),
            // Begins on the box: a poke or grab, until released.
            (None, begin, false, true, Elsewhere),
            (Elsewhere, left, true, true, Elsewhere),
            // A second button does not change the gesture.
            (Orbit, more, false, false, Orbit),
        ] {
            let [left, other, pressed] = [left, other, pressed].map(|button| buttons & button > 0);
            let pointer = Pointer {
                left,
                other,
                left_pressed: pressed,
                ..default()
            };
            assert_eq!(before.next(&pointer, over_panel, on_box), after);
        }
    }

    const CAMERA: OrbitCamera = OrbitCamera {
        target: Vec3::new(1.0, 2.0, 3.0),
        yaw: 0.4,
        pitch: 0.3,
        distance: 5.0,
    };

    /// The point under the mouse keeps its direction from the camera.
    #[test]
    fn zooming_keeps_the_point_under_the_mouse() {
        let before = CAMERA;
        let eye = before.transform();
        let fixed = before.target + eye.right() * 1.5 + eye.up() * 0.5;
        let after = before.zoomed(0.5, Some(fixed));
        assert_eq!(after.distance, 2.5);
        let seen = |camera: &OrbitCamera| {
            let eye = camera.transform();
            (eye.rotation.inverse() * (fixed - eye.translation)).normalize()
        };
        assert!((seen(&before) - seen(&after)).length() < 1e-5);
        // Without a mouse the target stays in the middle.
        assert_eq!(before.zoomed(0.5, None).target, before.target);
        // At the limit nothing moves.
        let near = OrbitCamera {
            distance: 0.01,
            ..before
        };
        assert_eq!(near.zoomed(0.5, Some(fixed)), near);
    }

    #[test]
    fn a_box_that_is_pushed_away_stays_in_the_picture() {
        let mut camera = CAMERA;
        let step = Vec3::new(0.1, 0.0, 0.02);
        let mut at = CAMERA.target;
        for k in 0..100 {
            camera.keep_in_view(at, at + step);
            at += step;
            assert!(at.distance(camera.target) <= MIDDLE * camera.distance + 1e-5);
            assert!(k > 10 || camera == CAMERA, "it moved too early");
        }
        // Shifted away by the user.
        camera.target.y += 9.0;
        let shifted = camera;
        camera.keep_in_view(at, at);
        assert!(camera.target.distance(shifted.target) < 1e-5);
    }
}
