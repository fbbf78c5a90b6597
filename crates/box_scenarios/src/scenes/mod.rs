//! The registry of scenes, one function each. **To add one**, write a function in the module of similar scenes and name
//! it in [`Scenario::ALL`]:
//!
//! - [`mod@free`]: free rotation only;
//! - [`mod@flight`]: the center of mass under gravity and drag;
//! - [`mod@forced`]: springs and torques;
//! - [`mod@floor`][]: contact.

mod bodies;
pub mod flight;
pub mod floor;
pub mod forced;
pub mod free;

pub use bodies::GRAVITY;

use crate::scenario::Scenario;

impl Scenario {
    /// Functions that build the scenes, in menu order. **A new scene is one function in this module and one line
    /// here.**
    pub const ALL: &[fn() -> Self] = &[
        free::dzhanibekov,
        floor::playground,
        flight::ballistic,
        free::stable_axis,
        forced::spring_orbit,
        flight::stiff_drag,
        forced::stiff_spring,
        floor::drop,
        floor::bounce,
        floor::slide,
        floor::tumble_storm,
        floor::load,
        floor::contact,
        floor::dice_tray,
        floor::dissertation_2012,
        free::thin_plate,
        free::needle,
        free::symmetric_top,
        forced::heavy_top,
        free::damped_spin,
        flight::quadratic_drag,
        free::separatrix,
        flight::throw,
    ];

    /// The ids, in menu order.
    pub fn ids() -> Vec<&'static str> {
        Self::ALL.iter().map(|build| build().id).collect()
    }

    /// The scene with the id `id` (case-insensitive).
    ///
    /// # Errors
    /// [`UnknownScenario`] lists the valid ids.
    pub fn find(id: &str) -> Result<Self, UnknownScenario> {
        Self::ALL
            .iter()
            .map(|build| build())
            .find(|s| s.id.eq_ignore_ascii_case(id.trim()))
            .ok_or_else(|| UnknownScenario {
                given: id.to_owned(),
            })
    }
}

impl Default for Scenario {
    /// The first scene of the menu.
    fn default() -> Self {
        (Self::ALL[0])()
    }
}

/// Error for an unknown scene id; the message lists the valid ids.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown scene '{given}'; allowed: {}", Scenario::ids().join(", "))]
pub struct UnknownScenario {
    /// The given text.
    pub given: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::integrators::Integrator;

    #[test]
    fn every_scene_is_complete() {
        let ids = Scenario::ids();
        for (k, build) in Scenario::ALL.iter().enumerate() {
            let s = build();
            assert!(!ids[..k].contains(&s.id), "{} twice", s.id);
            assert!(s.setup.validate().is_ok(), "{}", s.id);
            assert!(s.lesson.ends_with('.') && s.lesson.len() < 260, "{}", s.id);
            assert!(s.hints.iter().all(|h| h.ends_with('.')), "{}", s.id);
            assert!(!s.recommended().is_empty() && s.boxes >= 1, "{}", s.id);
            for id in s.recommended {
                assert!(
                    id.parse::<Integrator>().is_ok(),
                    "{}: no integrator '{id}'",
                    s.id
                );
            }
            assert_eq!(Scenario::find(&s.id.to_uppercase()), Ok(s));
        }
        let error = Scenario::find("moon")
            .expect_err("no such scene")
            .to_string();
        assert!(error.contains("'moon'") && ids.iter().all(|id| error.contains(id)));
        assert_eq!(Scenario::default().id, "dzhanibekov");
    }
}
