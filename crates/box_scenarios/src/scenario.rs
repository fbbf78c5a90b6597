//! The registry of scenes.

use box_physics::integrators::Integrator;

use crate::reference::ReferenceSolution;
use crate::scenes;
use crate::setup::Setup;
use crate::view::SceneView;

/// A named scene with its lesson and hints.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// As typed: lower case, hyphens.
    pub id: &'static str,
    /// As shown in a menu.
    pub title: &'static str,
    /// What there is to see, in one or two sentences.
    pub lesson: &'static str,
    /// What to try.
    pub hints: [&'static str; 2],
    /// Body, start, forces, floor, impulses, duration.
    pub setup: Setup,
    /// Ids of the integrators worth comparing here, the interesting one first.
    pub recommended: &'static [&'static str],
    /// How many boxes the game shows: 1, except in scenes about load.
    pub boxes: u32,
    /// Camera and plot.
    pub view: SceneView,
}

impl Scenario {
    /// Every scene, in the order of the menu, as the function that builds it. **A new scene is one
    /// function in [`scenes`] and one line here.**
    pub const ALL: &[fn() -> Self] = &[
        scenes::free::dzhanibekov,
        scenes::floor::playground,
        scenes::flight::ballistic,
        scenes::free::stable_axis,
        scenes::forced::spring_orbit,
        scenes::flight::stiff_drag,
        scenes::forced::stiff_spring,
        scenes::floor::drop,
        scenes::floor::bounce,
        scenes::floor::slide,
        scenes::floor::tumble_storm,
        scenes::floor::load,
        scenes::floor::contact,
        scenes::floor::dissertation_2012,
        scenes::free::thin_plate,
        scenes::free::needle,
        scenes::free::symmetric_top,
        scenes::forced::heavy_top,
        scenes::free::damped_spin,
        scenes::flight::quadratic_drag,
        scenes::free::separatrix,
        scenes::flight::throw,
    ];

    /// The ids, in the order of the menu.
    pub fn ids() -> Vec<&'static str> {
        Self::ALL.iter().map(|build| build().id).collect()
    }

    /// The scene called `id` (any case).
    ///
    /// # Errors
    /// [`UnknownScenario`] lists what there is.
    pub fn find(id: &str) -> Result<Self, UnknownScenario> {
        Self::ALL
            .iter()
            .map(|build| build())
            .find(|s| s.id.eq_ignore_ascii_case(id.trim()))
            .ok_or_else(|| UnknownScenario {
                given: id.to_owned(),
            })
    }

    /// The reference solution. Computing it may take some milliseconds; looking it up afterwards,
    /// microseconds.
    pub fn reference(&self) -> ReferenceSolution {
        self.setup.reference()
    }

    /// The integrators worth comparing here.
    pub fn recommended(&self) -> Vec<Integrator> {
        self.recommended
            .iter()
            .filter_map(|id| id.parse().ok())
            .collect()
    }
}

impl Default for Scenario {
    /// The first scene of the menu.
    fn default() -> Self {
        (Self::ALL[0])()
    }
}

/// No scene has this id; the message lists those there are.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown scene '{given}'; allowed: {}", Scenario::ids().join(", "))]
pub struct UnknownScenario {
    /// What was typed.
    pub given: String,
}

#[cfg(test)]
mod tests {
    use super::*;

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
