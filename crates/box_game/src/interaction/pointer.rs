//! The pointer: a mouse, or fingers. One finger is the left button; two fingers pan and zoom.

use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll, MouseScrollUnit};
use bevy::input::touch::Touches;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;

/// Touchpad pixels per notch of a wheel.
const PIXELS_PER_NOTCH: f32 = 40.0;
/// Factor of the camera's distance per notch.
pub(crate) const NOTCH: f32 = 0.9;

/// The pointer in one frame.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pointer {
    /// Position [logical pixels], if it is over the window.
    pub at: Option<Vec2>,
    /// The left button, or a finger, is down.
    pub left: bool,
    /// Another button is down, or two fingers are.
    pub other: bool,
    /// The left button went down in this frame.
    pub left_pressed: bool,
    /// Another button went down in this frame, or two fingers are down.
    pub other_pressed: bool,
    /// Movement since the last frame [logical pixels].
    pub moved: Vec2,
    /// Notches of the wheel, or their equivalent for two fingers; > 0 zooms in.
    pub notches: f32,
    /// A second finger touched, which cancels the gesture of the first.
    pub canceled: bool,
}

/// Id and position of a finger [logical pixels].
type Finger = (u64, Vec2);

/// The fingers of the last frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fingers {
    down: Vec<Finger>,
    /// `true` from the touch of a second finger until all fingers are up.
    several: bool,
}

impl Fingers {
    /// Returns the pointer for these fingers, which are in a constant order.
    fn next(&mut self, down: Vec<Finger>) -> Pointer {
        let before = core::mem::replace(&mut self.down, down);
        let down = &self.down;
        let was_several = self.several;
        self.several = (was_several && !down.is_empty()) || down.len() > 1;
        match (down.as_slice(), before.as_slice()) {
            ([], _) => Pointer {
                at: before.first().map(|f| f.1),
                ..Pointer::default()
            },
            ([finger], _) if !self.several => Pointer {
                at: Some(finger.1),
                left: true,
                left_pressed: before.is_empty(),
                moved: before.first().map_or(Vec2::ZERO, |f| finger.1 - f.1),
                ..Pointer::default()
            },
            ([a, b, ..], [c, d, ..]) if (a.0, b.0) == (c.0, d.0) => Pointer {
                at: Some(a.1.midpoint(b.1)),
                other: true,
                // A gesture in progress takes no notice.
                other_pressed: true,
                moved: a.1.midpoint(b.1) - c.1.midpoint(d.1),
                // As the fingers part, what is between them grows alike.
                notches: (c.1.distance(d.1).max(1.0) / a.1.distance(b.1).max(1.0)).ln()
                    / NOTCH.ln(),
                ..Pointer::default()
            },
            // For the frame in which a finger comes or goes nothing is down, so that a gesture ends and another begins.
            _ => Pointer {
                at: Some(down[0].1),
                canceled: !was_several,
                ..Pointer::default()
            },
        }
    }
}

pub(super) fn read(
    buttons: Res<ButtonInput<MouseButton>>,
    (motion, scroll): (Res<AccumulatedMouseMotion>, Res<AccumulatedMouseScroll>),
    touches: Res<Touches>,
    window: Query<&Window, With<PrimaryWindow>>,
    mut fingers: Local<Fingers>,
    mut seen: Local<Vec<Finger>>,
    mut pointer: ResMut<Pointer>,
) {
    let mut now: Vec<Finger> = touches.iter().map(|t| (t.id(), t.position())).collect();
    now.sort_by_key(|finger| finger.0);
    // A frame late: by then the panel knows whether the finger is on it.
    let down = core::mem::replace(&mut *seen, now);
    let touched = !(down.is_empty() && fingers.down.is_empty());
    let touch = fingers.next(down);
    if touched {
        *pointer = touch;
        return;
    }
    let others = [MouseButton::Right, MouseButton::Middle];
    *pointer = Pointer {
        at: window.iter().next().and_then(Window::cursor_position),
        left: buttons.pressed(MouseButton::Left),
        other: buttons.any_pressed(others),
        left_pressed: buttons.just_pressed(MouseButton::Left),
        other_pressed: buttons.any_just_pressed(others),
        moved: motion.delta,
        notches: match scroll.unit {
            MouseScrollUnit::Line => scroll.delta.y,
            MouseScrollUnit::Pixel => scroll.delta.y / PIXELS_PER_NOTCH,
        },
        canceled: false,
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finger(id: u64, x: f32) -> Finger {
        (id, Vec2::new(x, 10.0))
    }

    #[test]
    fn one_finger_is_the_left_button() {
        let mut fingers = Fingers::default();
        let down = fingers.next(vec![finger(1, 5.0)]);
        assert!(down.left && down.left_pressed && down.moved == Vec2::ZERO);
        let moved = fingers.next(vec![finger(1, 8.0)]);
        assert!(moved.left && !moved.left_pressed);
        assert_eq!((moved.at, moved.moved.x), (Some(Vec2::new(8.0, 10.0)), 3.0));
        let up = fingers.next(vec![]);
        assert_eq!((up.left, up.at), (false, moved.at));
    }

    #[test]
    fn two_fingers_shift_and_zoom_and_begin_nothing_else() {
        let mut fingers = Fingers::default();
        fingers.next(vec![finger(1, 100.0)]);
        let second = fingers.next(vec![finger(1, 100.0), finger(2, 200.0)]);
        assert!(second.canceled && !second.left && !second.other);
        let parted = fingers.next(vec![finger(1, 90.0), finger(2, 230.0)]);
        assert!(parted.other && !parted.canceled);
        assert_eq!(parted.moved.x, 10.0);
        // 100 pixels became 140: the camera is at 100/140 of its distance.
        assert!((NOTCH.powf(parted.notches) - 100.0 / 140.0).abs() < 1e-6);
        // The one that stays is no left button.
        for _ in 0..2 {
            let one = fingers.next(vec![finger(2, 230.0)]);
            assert!(!one.left && !one.other && !one.canceled);
        }
        let last = Pointer {
            at: Some(Vec2::new(230.0, 10.0)),
            ..default()
        };
        assert_eq!(fingers.next(vec![]), last);
        assert!(fingers.next(vec![finger(3, 1.0)]).left_pressed);
    }
}
