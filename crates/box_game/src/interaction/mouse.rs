//! The mouse on the box: a click pokes, a drag grabs. A gesture that begins on the box applies to it until the button
//! is released; all others move the camera.

use bevy::prelude::*;
use box_physics::prelude::{BodyState, DVec3, RigidBox};

use super::grab::Grip;
use super::pick::{Hit, hit};
use super::pointer::Pointer;
use crate::action::{Action, Actions, Hold, Poke};
use crate::input::UiFocus;
use crate::scene::session::{MainBox, Session};

/// Distance beyond which a press is a drag [logical pixels].
const CLICK: f32 = 5.0;
/// Factor of the strength per notch of the wheel.
const NOTCH: f64 = 1.15;
/// Minimum and maximum strength of a poke, in units of the panel's strength.
const STRENGTH: (f64, f64) = (0.05, 50.0);

/// State of the mouse on the box.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Hand {
    /// The mouse moves the camera.
    #[default]
    Idle,
    /// The button went down on the box.
    Pressed {
        hit: Hit,
        /// Position on the screen [logical pixels].
        at: Vec2,
        /// Strength of the poke, in units of the panel's strength.
        strength: f64,
    },
    /// The box is held.
    Dragging {
        /// The held point, body axes \[m\].
        body_point: DVec3,
        /// Distance of the plane in which the point is moved, along the view \[m\].
        depth: f64,
    },
    /// Escape released the box; the button is still down.
    Canceled,
}

impl Hand {
    /// The state after this frame of the pointer, which may be over the panel. `aim` is the point of the box under the
    /// cursor; `anchor` returns the world point under the cursor at a given depth.
    pub(crate) fn next(
        self,
        pointer: &Pointer,
        over_panel: bool,
        aim: Option<Hit>,
        anchor: impl FnOnce(f64) -> Option<DVec3>,
        depth: impl FnOnce(DVec3) -> f64,
        out: &mut Vec<Action>,
    ) -> Self {
        match self {
            Self::Pressed { .. } | Self::Dragging { .. } if pointer.canceled => Self::Canceled,
            Self::Canceled if !pointer.left => Self::Idle,
            Self::Canceled => Self::Canceled,
            Self::Idle if over_panel || !pointer.left_pressed => Self::Idle,
            Self::Idle => match (aim, pointer.at) {
                (Some(hit), Some(at)) => Self::Pressed {
                    hit,
                    at,
                    strength: 1.0,
                },
                _ => Self::Idle,
            },
            Self::Pressed { hit, at, strength } => {
                let factor = NOTCH.powf(f64::from(pointer.notches));
                let strength = (strength * factor).clamp(STRENGTH.0, STRENGTH.1);
                if !pointer.left {
                    out.push(Action::Poke(Poke {
                        body_point: hit.point,
                        normal: hit.normal,
                        strength,
                    }));
                    return Self::Idle;
                }
                if pointer.at.is_some_and(|now| now.distance(at) > CLICK) {
                    return Self::Dragging {
                        body_point: hit.point,
                        depth: depth(hit.point),
                    };
                }
                Self::Pressed { hit, at, strength }
            }
            Self::Dragging { body_point, depth } => {
                if !pointer.left {
                    out.push(Action::Grab(None));
                    return Self::Idle;
                }
                // Outside the window, the target keeps its last position.
                if let Some(anchor) = anchor(depth) {
                    out.push(Action::Grab(Some(Hold { body_point, anchor })));
                }
                self
            }
        }
    }
}

/// Reads the mouse and requests pokes and grabs.
pub(crate) fn use_mouse(
    mut hand: ResMut<Hand>,
    keys: Res<ButtonInput<KeyCode>>,
    pointer: Res<Pointer>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
    main_box: Query<(&RigidBox, &BodyState), With<MainBox>>,
    focus: Res<UiFocus>,
    mut actions: ResMut<Actions>,
) {
    // The first camera shows the main box; those of the other views have a higher order.
    let Some((camera, view)) = cameras.iter().min_by_key(|(camera, _)| camera.order) else {
        return;
    };
    let ray = pointer
        .at
        .and_then(|at| camera.viewport_to_world(view, at).ok());
    let box_now = main_box.iter().next();
    let pointer = Pointer {
        canceled: pointer.canceled || keys.just_pressed(KeyCode::Escape),
        ..*pointer
    };
    let (from, along) = ray.map_or((DVec3::ZERO, DVec3::ZERO), |r| {
        (r.origin.as_dvec3(), r.direction.as_dvec3())
    });
    let forward = view.forward().as_dvec3();
    let eye = view.translation().as_dvec3();
    let next = hand.next(
        &pointer,
        focus.pointer,
        box_now.and_then(|(body, state)| hit(body, state, from, along)),
        |depth| {
            let slope = along.dot(forward);
            (slope > 1e-6).then(|| from + along * ((depth - (from - eye).dot(forward)) / slope))
        },
        |point| box_now.map_or(0.0, |(_, state)| (state.point(point) - eye).dot(forward)),
        &mut actions.0,
    );
    hand.set_if_neq(next);
}

/// Draws the arrow of a poke, and the line from the held point to its target.
pub(crate) fn draw_hand(
    hand: Res<Hand>,
    grip: Res<Grip>,
    session: Res<Session>,
    main_box: Single<(&RigidBox, &BodyState), With<MainBox>>,
    mut gizmos: Gizmos,
) {
    let (body, state) = *main_box;
    let color = Color::srgb_u8(240, 228, 66);
    if let Hand::Pressed { hit, strength, .. } = *hand {
        let tip = state.point(hit.point);
        // One body radius for a push of the panel's strength, growing with its square root.
        let length = body.radius() * strength.sqrt();
        let tail = tip + state.rotation * hit.normal * length;
        gizmos
            .arrow(tail.as_vec3(), tip.as_vec3(), color)
            .with_tip_length(0.25 * body.radius() as f32);
    }
    if let Some(hold) = grip.0 {
        let at = state.point(hold.body_point).as_vec3();
        let size = 0.06 * session.scenario.setup.body.radius() as f32;
        gizmos.line(at, hold.anchor.as_vec3(), color);
        gizmos.sphere(Isometry3d::from_translation(at), size, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON_BOX: Hit = Hit {
        point: DVec3::new(0.1, 0.2, 0.5),
        normal: DVec3::Z,
    };

    const HOLD: Hand = Hand::Dragging {
        body_point: ON_BOX.point,
        depth: 7.0,
    };

    /// The pointer at `x` with the left button down.
    fn held(x: f32) -> Pointer {
        Pointer {
            at: Some(Vec2::new(x, 0.0)),
            left: true,
            ..default()
        }
    }

    /// The button went down on the box.
    fn pressed() -> Hand {
        Hand::Pressed {
            hit: ON_BOX,
            at: Vec2::ZERO,
            strength: 1.0,
        }
    }

    /// The next state after `pointer`, over the panel or not, with this box point under it; and the actions.
    fn next(
        hand: Hand,
        pointer: Pointer,
        over_panel: bool,
        aim: Option<Hit>,
    ) -> (Hand, Vec<Action>) {
        let mut out = Vec::new();
        let anchor = |depth| Some(DVec3::Z * depth);
        let next = hand.next(&pointer, over_panel, aim, anchor, |_| 7.0, &mut out);
        (next, out)
    }

    #[test]
    fn a_click_pokes_with_the_strength_scrolled() {
        let wheel = Pointer {
            notches: 2.0,
            ..held(2.0)
        };
        let (scrolled, _) = next(pressed(), wheel, false, None);
        let (hand, out) = next(scrolled, Pointer::default(), false, None);
        let [Action::Poke(poke)] = out[..] else {
            panic!("{out:?}");
        };
        assert_eq!((hand, poke.body_point), (Hand::Idle, ON_BOX.point));
        assert_eq!(poke.normal, DVec3::Z);
        assert!((poke.strength - NOTCH * NOTCH).abs() < 1e-12);
    }

    /// A gesture belongs to the object on which it began. Escape ends a drag until the button is pressed again.
    #[test]
    fn a_drag_grabs_until_released_wherever_that_is() {
        let (idle, up, on_box) = (Hand::Idle, Pointer::default(), Some(ON_BOX));
        let press = Pointer {
            left_pressed: true,
            ..held(0.0)
        };
        let escape = Pointer {
            canceled: true,
            ..held(20.0)
        };
        let grab = Action::Grab(Some(Hold {
            body_point: ON_BOX.point,
            anchor: DVec3::Z * 7.0,
        }));
        let release = vec![Action::Grab(None)];
        for (hand, pointer, over_panel, aim, expected, asked) in [
            (idle, press, false, on_box, pressed(), vec![]),
            (pressed(), held(20.0), false, None, HOLD, vec![]),
            (HOLD, held(400.0), true, None, HOLD, vec![grab]),
            (HOLD, up, false, None, idle, release),
            (HOLD, escape, false, on_box, Hand::Canceled, vec![]),
            (
                Hand::Canceled,
                held(30.0),
                false,
                on_box,
                Hand::Canceled,
                vec![],
            ),
            (Hand::Canceled, up, false, on_box, idle, vec![]),
            // Begun next to the box, on the panel, or on empty space and then moved over the box.
            (idle, press, false, None, idle, vec![]),
            (idle, press, true, on_box, idle, vec![]),
            (idle, held(5.0), false, on_box, idle, vec![]),
        ] {
            assert_eq!(next(hand, pointer, over_panel, aim), (expected, asked));
        }
    }
}
