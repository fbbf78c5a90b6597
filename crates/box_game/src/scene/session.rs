//! The current scene, its parameters, and the switches of the view.

use std::collections::VecDeque;

use bevy::prelude::*;
use box_physics::prelude::{DVec3, RestitutionLaw, RigidBox};
use box_scenarios::{ForceSet, ReferenceSolution, Scenario, Setup};

use crate::action::Plot;
use crate::parameters::Parameters;

/// The box that the user pushes; the others are load.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct MainBox;

/// Marks everything that a restart replaces.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct SceneEntity;

/// Number of a box in the scene; 0 is the main box.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct BoxNumber(pub u32);

/// The current scene and settings.
#[derive(Resource)]
pub struct Session {
    /// The scene without changes.
    pub scenario: Scenario,
    /// The scene's default parameters.
    pub defaults: Parameters,
    /// The current parameters.
    pub parameters: Parameters,
    /// Number of starts, part of the log's `run_id`.
    pub run: u32,
    /// Index of the scene's next timed impulse.
    pub next_impulse: usize,
    /// The reference, until the first push or change.
    pub truth: Option<ReferenceSolution>,
    /// Target speed.
    pub speed: f64,
    /// Seed of the load boxes' attitudes.
    pub seed: u64,
    /// Pushes and changes since the last row of the log.
    pub events: Vec<String>,
    /// `true` if the list of keys is open.
    pub show_help: bool,
    /// `true` if the scene menu is open.
    pub show_picker: bool,
    /// `true` if the panel is hidden.
    pub hidden: bool,
    /// Plot in the drawer.
    pub plot: Plot,
    /// The latest messages.
    pub notices: VecDeque<String>,
    /// Body-steps since the start of the scene that the integrator delegated to `split`.
    pub fallbacks: u64,
    /// Body-steps since then whose iteration reached its maximum.
    pub unconverged: u64,
}

impl Session {
    /// Creates a session that opens with `scenario`.
    pub fn new(scenario: Scenario, seed: u64) -> Self {
        let defaults = Parameters::of(&scenario);
        Self {
            scenario,
            defaults,
            parameters: defaults,
            run: 0,
            next_impulse: 0,
            truth: None,
            speed: 1.0,
            seed,
            events: Vec::new(),
            show_help: false,
            show_picker: false,
            hidden: false,
            plot: Plot::Energy,
            notices: VecDeque::new(),
            fallbacks: 0,
            unconverged: 0,
        }
    }

    /// Shows a message in the panel, and writes it to the application log.
    pub fn notice(&mut self, text: impl Into<String>) {
        let text = text.into();
        info!("{text}");
        self.notices.push_back(text);
        if self.notices.len() > 4 {
            self.notices.pop_front();
        }
    }

    /// Id of the current run in the log: scene, seed, number of the start.
    pub fn run_id(&self) -> String {
        format!("{}-{}-{}", self.scenario.id, self.seed, self.run)
    }

    /// Records an event that the scene's reference does not include.
    pub fn perturb(&mut self, event: String) {
        self.truth = None;
        self.events.push(event);
    }

    /// The scene's default parameters, with the current step and substeps.
    pub fn own_parameters(&self) -> Parameters {
        Parameters {
            step: self.parameters.step,
            substeps: self.parameters.substeps,
            ..self.defaults
        }
    }

    /// The scene with the current parameters.
    pub fn setup(&self) -> Setup {
        let mut setup = self.scenario.setup.clone();
        let p = &self.parameters;
        if p.half_extents != self.defaults.half_extents || p.mass != self.defaults.mass {
            // Validated when it was set. The spin is unchanged, the box is new.
            if let Ok(body) = RigidBox::new(p.half_extents, p.mass) {
                let spin = setup.initial.body_angular_velocity(&setup.body);
                setup.initial = setup.initial.with_body_angular_velocity(&body, spin);
                setup.body = body;
            }
        }
        setup.forces = self.forces();
        if let Some(floor) = &mut setup.floor {
            floor.restitution = p.restitution.unwrap_or(floor.restitution);
            floor.restitution_law = match p.restitution_law {
                Some(1.0) => RestitutionLaw::Newton,
                _ => RestitutionLaw::Energetic,
            };
            floor.friction = p.friction.unwrap_or(floor.friction);
        }
        setup
    }

    /// The scene's forces with the current parameters.
    pub fn forces(&self) -> ForceSet {
        let (p, d) = (&self.parameters, &self.defaults);
        let mut forces = self.scenario.setup.forces.clone();
        if p.gravity != d.gravity {
            forces.gravity = DVec3::NEG_Y * p.gravity;
        }
        forces.linear_drag = p.linear_drag;
        forces.angular_damping = p.angular_damping;
        forces
    }
}
