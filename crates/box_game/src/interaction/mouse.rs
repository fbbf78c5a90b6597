//! The mouse on the box: a click pokes, a drag grabs. A gesture that begins on the box belongs to it until the
//! button is released; all others move the camera.

use bevy::prelude::*;
use box_physics::prelude::{BodyState, DVec3, RigidBox};

use super::grab::Grip;
use super::pick::{Hit, hit};
use super::pointer::Pointer;
use crate::action::{Action, Actions, Hold, Poke};
use crate::input::focus::UiFocus;
use crate::scene::session::{MainBox, Session};

/// A press that moves farther than this is a drag [logical pixels].
const CLICK: f32 = 5.0;
/// Factor of the strength per notch of the wheel.
const NOTCH: f64 = 1.15;
/// The weakest and the strongest poke, in the panel's strength.
const STRENGTH: (f64, f64) = (0.05, 50.0);

/// State of the mouse on the box.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub enum Hand {
    /// The mouse moves the camera.
    #[default]
    Idle,
    /// The button went down on the box.
    Pressed {
        /// The point of the surface.
        hit: Hit,
        /// Place on the screen [logical pixels].
        at: Vec2,
        /// Strength of the poke, in units of the panel's.
        strength: f64,
    },
    /// The box is held.
    Dragging {
        /// The held point, body axes \[m\].
        body_point: DVec3,
        /// Distance of the plane in which it is moved, along the view \[m\].
        depth: f64,
    },
    /// Escape released the box; the button is still down.
    Canceled,
}

/// The mouse in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Mouse {
    /// The cursor [logical pixels], if it is over the window.
    pub at: Option<Vec2>,
    /// The left button went down.
    pub pressed: bool,
    /// The left button went up, or is up.
    pub released: bool,
    /// Notches of the wheel.
    pub scroll: f64,
    /// The cursor is over the panel.
    pub over_panel: bool,
    /// Escape was pressed.
    pub escape: bool,
}

impl Hand {
    /// After this frame. `aim` gives the point of the box under the cursor, `anchor` the point of the
    /// world under it at a depth.
    pub fn next(
        self,
        mouse: Mouse,
        aim: impl FnOnce() -> Option<Hit>,
        anchor: impl FnOnce(f64) -> Option<DVec3>,
        depth: impl FnOnce(DVec3) -> f64,
        out: &mut Vec<Action>,
    ) -> Self {
        match self {
            Self::Pressed { .. } | Self::Dragging { .. } if mouse.escape => Self::Canceled,
            Self::Canceled if mouse.released => Self::Idle,
            Self::Canceled => Self::Canceled,
            Self::Idle => {
                if !mouse.pressed || mouse.over_panel {
                    return Self::Idle;
                }
                match (aim(), mouse.at) {
                    (Some(hit), Some(at)) => Self::Pressed {
                        hit,
                        at,
                        strength: 1.0,
                    },
                    _ => Self::Idle,
                }
            }
            Self::Pressed { hit, at, strength } => {
                let factor = NOTCH.powf(mouse.scroll);
                let strength = (strength * factor).clamp(STRENGTH.0, STRENGTH.1);
                if mouse.released {
                    out.push(Action::Poke(Poke {
                        body_point: hit.point,
                        normal: hit.normal,
                        strength,
                    }));
                    return Self::Idle;
                }
                if mouse.at.is_some_and(|now| now.distance(at) > CLICK) {
                    return Self::Dragging {
                        body_point: hit.point,
                        depth: depth(hit.point),
                    };
                }
                Self::Pressed { hit, at, strength }
            }
            Self::Dragging { body_point, depth } => {
                if mouse.released {
                    out.push(Action::Grab(None));
                    return Self::Idle;
                }
                // Outside the window the target stays at its last place.
                if let Some(anchor) = anchor(depth) {
                    out.push(Action::Grab(Some(Hold { body_point, anchor })));
                }
                self
            }
        }
    }
}

/// Reads the mouse and asks for pokes and grabs.
pub fn use_mouse(
    mut hand: ResMut<Hand>,
    keys: Res<ButtonInput<KeyCode>>,
    pointer: Res<Pointer>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
    main_box: Query<(&RigidBox, &BodyState), With<MainBox>>,
    focus: Res<UiFocus>,
    mut actions: ResMut<Actions>,
) {
    // The first camera shows the main box; those of the other views come after it.
    let Some((camera, view)) = cameras.iter().min_by_key(|(camera, _)| camera.order) else {
        return;
    };
    let ray = pointer
        .at
        .and_then(|at| camera.viewport_to_world(view, at).ok());
    let box_now = main_box.iter().next();
    let mouse = Mouse {
        at: pointer.at,
        pressed: pointer.left_pressed,
        released: !pointer.left,
        scroll: f64::from(pointer.notches),
        over_panel: focus.pointer,
        escape: pointer.canceled || keys.just_pressed(KeyCode::Escape),
    };
    let (from, along) = ray.map_or((DVec3::ZERO, DVec3::ZERO), |r| {
        (r.origin.as_dvec3(), r.direction.as_dvec3())
    });
    let forward = view.forward().as_dvec3();
    let eye = view.translation().as_dvec3();
    let next = hand.next(
        mouse,
        || box_now.and_then(|(body, state)| hit(body, state, from, along)),
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
pub fn draw_hand(
    hand: Res<Hand>,
    grip: Res<Grip>,
    session: Res<Session>,
    main_box: Query<(&RigidBox, &BodyState), With<MainBox>>,
    mut gizmos: Gizmos,
) {
    let Some((body, state)) = main_box.iter().next() else {
        return;
    };
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
        distance: 3.0,
        point: DVec3::new(0.1, 0.2, 0.5),
        normal: DVec3::Z,
    };

    fn mouse(x: f32) -> Mouse {
        Mouse {
            at: Some(Vec2::new(x, 0.0)),
            pressed: false,
            released: false,
            scroll: 0.0,
            over_panel: false,
            escape: false,
        }
    }

    fn step(hand: Hand, mouse: Mouse, aim: Option<Hit>) -> (Hand, Vec<Action>) {
        let mut out = Vec::new();
        let next = hand.next(
            mouse,
            || aim,
            |depth| Some(DVec3::Z * depth),
            |_| 7.0,
            &mut out,
        );
        (next, out)
    }

    #[test]
    fn a_click_pokes_with_the_strength_scrolled() {
        let down = Mouse {
            pressed: true,
            ..mouse(0.0)
        };
        let (hand, out) = step(Hand::Idle, down, Some(ON_BOX));
        assert!(matches!(hand, Hand::Pressed { .. }) && out.is_empty());
        let wheel = Mouse {
            scroll: 2.0,
            ..mouse(2.0)
        };
        let (hand, _) = step(hand, wheel, None);
        let up = Mouse {
            released: true,
            ..mouse(2.0)
        };
        let (hand, out) = step(hand, up, None);
        assert_eq!(hand, Hand::Idle);
        let [Action::Poke(poke)] = out[..] else {
            panic!("{out:?}");
        };
        assert_eq!((poke.body_point, poke.normal), (ON_BOX.point, DVec3::Z));
        assert!((poke.strength - NOTCH * NOTCH).abs() < 1e-12);
    }

    #[test]
    fn a_drag_grabs_until_released_wherever_that_is() {
        let down = Mouse {
            pressed: true,
            ..mouse(0.0)
        };
        let (hand, _) = step(Hand::Idle, down, Some(ON_BOX));
        let (hand, out) = step(hand, mouse(20.0), None);
        assert!(matches!(hand, Hand::Dragging { depth: 7.0, .. }) && out.is_empty());
        // Over the panel it is still the hand's.
        let over_panel = Mouse {
            over_panel: true,
            ..mouse(400.0)
        };
        let (hand, out) = step(hand, over_panel, None);
        assert_eq!(
            out,
            [Action::Grab(Some(Hold {
                body_point: ON_BOX.point,
                anchor: DVec3::Z * 7.0
            }))]
        );
        let outside = Mouse {
            at: None,
            released: true,
            ..mouse(0.0)
        };
        assert_eq!(
            step(hand, outside, None),
            (Hand::Idle, vec![Action::Grab(None)])
        );
    }

    #[test]
    fn escape_ends_a_drag_until_the_button_is_pressed_again() {
        let hold = Hand::Dragging {
            body_point: ON_BOX.point,
            depth: 7.0,
        };
        let escape = Mouse {
            escape: true,
            ..mouse(20.0)
        };
        let (hand, out) = step(hold, escape, None);
        assert_eq!((hand, &out[..]), (Hand::Canceled, &[][..]));
        let (hand, out) = step(hand, mouse(30.0), Some(ON_BOX));
        assert_eq!((hand, &out[..]), (Hand::Canceled, &[][..]));
        let up = Mouse {
            released: true,
            ..mouse(30.0)
        };
        assert_eq!(step(hand, up, None), (Hand::Idle, vec![]));
    }

    #[test]
    fn what_begins_elsewhere_is_not_the_hand_s() {
        let down = Mouse {
            pressed: true,
            ..mouse(0.0)
        };
        assert_eq!(step(Hand::Idle, down, None).0, Hand::Idle);
        let panel = Mouse {
            over_panel: true,
            ..down
        };
        assert_eq!(step(Hand::Idle, panel, Some(ON_BOX)).0, Hand::Idle);
        // A drag that began on empty space and comes over the box.
        assert_eq!(step(Hand::Idle, mouse(5.0), Some(ON_BOX)).0, Hand::Idle);
    }
}
