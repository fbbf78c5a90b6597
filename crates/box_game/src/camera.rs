//! An orbit camera: drag on empty space to turn, right or middle drag to shift, wheel to come nearer.
//!
//! A gesture belongs to whoever it began on, the panel or the view, until the button is released,
//! wherever that happens.

use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll};
use bevy::prelude::*;
use box_physics::prelude::{BodyState, Floor};

use crate::input::UiFocus;
use crate::session::{Hero, Session};

/// Where the camera looks from.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct OrbitCamera {
    /// What it looks at \[m\].
    pub target: Vec3,
    /// Angle about the vertical \[rad\].
    pub yaw: f32,
    /// Angle above the horizon \[rad\], −1.5 to 1.5.
    pub pitch: f32,
    /// Distance from the target \[m\].
    pub distance: f32,
}

impl OrbitCamera {
    /// The scene's own view: the hero in the middle, five radii away, farther with many boxes.
    pub fn home(session: &Session) -> Self {
        let setup = &session.scenario.setup;
        let boxes = session.parameters.boxes as f32;
        let radius = setup.body.radius() as f32;
        let mut target = setup.initial.position.as_vec3();
        let mut distance = (5.0 * radius).max(1.5) * (1.0 + 0.35 * (boxes.sqrt() - 1.0));
        if let Some(floor) = setup.floor {
            // See the floor, too.
            let height = target.y - floor.height as f32;
            target.y -= 0.5 * height;
            distance = distance.max(1.6 * height + 5.0 * radius);
        }
        Self {
            target,
            yaw: 0.6,
            pitch: 0.35,
            distance,
        }
    }

    /// As Bevy wants it.
    pub fn transform(&self) -> Transform {
        let rotation = Quat::from_euler(EulerRot::YXZ, self.yaw, -self.pitch, 0.0);
        let position = self.target + rotation * Vec3::Z * self.distance;
        Transform::from_translation(position).with_rotation(rotation)
    }
}

/// Asks the camera to go somewhere.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraRequest {
    /// The hero in the middle.
    Frame,
    /// The scene's own view.
    Home,
}

/// Who the drag in progress belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gesture {
    /// No button is down.
    #[default]
    None,
    /// It began on the panel.
    Panel,
    /// It began on the view: turn.
    Orbit,
    /// It began on the view: shift.
    Pan,
}

impl Gesture {
    /// Who the drag belongs to after this frame's button events.
    pub fn next(self, left: bool, other: bool, just_pressed: bool, over_panel: bool) -> Self {
        if !(left || other) {
            return Self::None;
        }
        if self == Self::None && just_pressed {
            return match (over_panel, other) {
                (true, _) => Self::Panel,
                (false, true) => Self::Pan,
                (false, false) => Self::Orbit,
            };
        }
        self
    }
}

/// Moves the camera by the mouse.
pub fn move_camera(
    mut camera: Single<(&mut OrbitCamera, &mut Transform)>,
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
    focus: Res<UiFocus>,
    session: Res<Session>,
    request: Option<Res<CameraRequest>>,
    hero: Query<&BodyState, With<Hero>>,
    floor: Option<Res<Floor>>,
    mut gesture: Local<Gesture>,
    mut seen: Local<Option<Vec3>>,
    mut commands: Commands,
) {
    let (orbit, transform) = &mut *camera;
    let left = buttons.pressed(MouseButton::Left);
    let others = [MouseButton::Right, MouseButton::Middle];
    let other = buttons.any_pressed(others);
    let pressed = buttons.just_pressed(MouseButton::Left) || buttons.any_just_pressed(others);
    *gesture = gesture.next(left, other, pressed, focus.pointer);
    match *gesture {
        Gesture::Orbit => {
            orbit.yaw -= motion.delta.x * 0.006;
            orbit.pitch = (orbit.pitch + motion.delta.y * 0.006).clamp(-1.5, 1.5);
        }
        Gesture::Pan => {
            let scale = orbit.distance * 0.0015;
            let shift = transform.rotation * Vec3::new(-motion.delta.x, motion.delta.y, 0.0);
            orbit.target += shift * scale;
        }
        Gesture::None | Gesture::Panel => {}
    }
    if !focus.pointer && scroll.delta.y != 0.0 {
        let notches = match scroll.unit {
            bevy::input::mouse::MouseScrollUnit::Line => scroll.delta.y,
            bevy::input::mouse::MouseScrollUnit::Pixel => scroll.delta.y / 40.0,
        };
        orbit.distance = (orbit.distance * 0.9_f32.powf(notches)).clamp(0.01, 1e5);
    }
    // Without a floor there is nothing to stay at: the camera goes along with the hero.
    let at = hero.iter().next().map(|state| state.position.as_vec3());
    if let (None, Some(now), Some(before)) = (floor, at, *seen) {
        orbit.target += now - before;
    }
    *seen = at;
    if let Some(request) = request {
        match *request {
            CameraRequest::Home => **orbit = OrbitCamera::home(&session),
            CameraRequest::Frame => {
                if let Some(at) = at {
                    orbit.target = at;
                }
            }
        }
        commands.remove_resource::<CameraRequest>();
    }
    **transform = orbit.transform();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gesture_belongs_to_whoever_it_began_on() {
        // Begins on the panel, moves over the view: still the panel's.
        let g = Gesture::None.next(true, false, true, true);
        assert_eq!(g, Gesture::Panel);
        assert_eq!(g.next(true, false, false, false), Gesture::Panel);
        assert_eq!(g.next(false, false, false, false), Gesture::None);
        // Begins on the view, moves over the panel: still the view's.
        let g = Gesture::None.next(true, false, true, false);
        assert_eq!(g, Gesture::Orbit);
        assert_eq!(g.next(true, false, false, true), Gesture::Orbit);
        assert_eq!(Gesture::None.next(false, true, true, false), Gesture::Pan);
        // A second button does not take it over.
        assert_eq!(g.next(true, true, true, false), Gesture::Orbit);
    }

    #[test]
    fn the_camera_looks_at_its_target() {
        let orbit = OrbitCamera {
            target: Vec3::new(1.0, 2.0, 3.0),
            yaw: 0.4,
            pitch: 0.3,
            distance: 5.0,
        };
        let t = orbit.transform();
        let seen = t.translation + t.forward() * 5.0;
        assert!((seen - orbit.target).length() < 1e-5);
        assert!(t.translation.y > 2.0);
    }
}
