//! Contents of the panel: plain data, filled by the game. The panel is a pure function of it, tested without a window.

use box_bench::measure::Cost;
use box_physics::plugin::Stage;
use box_physics::prelude::Integrator;
use box_scenarios::dissertation::Stepper;
use box_scenarios::{Scenario, Status};

use super::format::number;
use crate::action::Plot;
use crate::compare::CompareView;
use crate::parameters::Parameters;
use crate::preferences::Preferences;

/// Names and units of the main box's figures. The potential energy is relative to the floor, or to the origin.
pub(crate) const FIGURES: [(&str, &str); 10] = [
    ("Translational ½mv²", "J"),
    ("Rotational ½L·ω", "J"),
    ("Potential energy", "J"),
    ("Total energy", "J"),
    ("Ang. momentum |L|", "kg m²/s"),
    ("Speed |v|", "m/s"),
    ("Spin |ω|", "rad/s"),
    ("Position x", "m"),
    ("Position y", "m"),
    ("Position z", "m"),
];

/// Everything the panel shows in one frame.
#[derive(Clone, Debug)]
pub struct PanelView {
    /// Every scene, in the order of the menu.
    pub(crate) scenes: Vec<Scenario>,
    /// The current scene, which may no longer be in the list.
    pub(crate) scenario: Scenario,
    pub(crate) integrator: Integrator,
    pub(crate) paused: bool,
    /// Simulated time \[s\].
    pub(crate) time: f64,
    /// Steps taken since the start of the scene.
    pub(crate) steps: u64,
    /// Target speed, 1 = real time.
    pub(crate) speed: f64,
    /// Measured speed over the last second; `None` until there is one.
    pub(crate) actual_speed: Option<f64>,
    /// Simulated time dropped by frame hitches since the start \[s\].
    pub(crate) dropped: f64,
    pub(crate) parameters: Parameters,
    /// Default parameters of the scene, for "reset" and tooltips.
    pub(crate) defaults: Parameters,
    /// The main box in numbers, see [`FIGURES`].
    pub(crate) figures: [f64; FIGURES.len()],
    /// In free flight, at the floor, at rest, or frozen.
    pub(crate) state: Status,
    /// For every integrator, in the order of the menu: recent samples [ns per body-step], if any, and force evaluations
    /// per body-step.
    pub(crate) timings: Vec<(Option<Cost>, f64)>,
    /// Body-steps since the start of the scene in which `split` replaced the integrator.
    pub(crate) fallbacks: u64,
    /// Body-steps since then whose iteration reached its limit.
    pub(crate) unconverged: u64,
    /// Time of each stage of a step in the plugin, all bodies \[µs\]; `None` while it takes no steps.
    pub(crate) stages_us: Option<[f64; Stage::ALL.len()]>,
    /// The same for each of the last steps, oldest first.
    pub(crate) stage_history: Vec<[f64; Stage::ALL.len()]>,
    /// Grain of a coarse clock \[µs\], and the resulting relative standard deviation of a sample.
    pub(crate) grain: Option<(f64, f64)>,
    /// Time of the last frame \[ms\].
    pub(crate) frame_time_ms: f64,
    /// History of every integrator, oldest first: (wall time \[s\], minimum ns per body-step).
    pub(crate) timing_history: Vec<Vec<(f64, f64)>>,
    /// History of the CPU usage, oldest first: (wall time \[s\], process [% of all cores], system CPU \[%\]).
    pub(crate) cpu_history: Vec<(f64, f64, f64)>,
    /// Reason why the CPU usage is unknown, if it is.
    pub(crate) no_cpu: Option<&'static str>,
    pub(crate) compare: CompareView,
    pub(crate) preferences: Preferences,
    pub(crate) show_help: bool,
    pub(crate) hidden: bool,
    pub(crate) plot: Plot,
    /// The CSV log being written, and its rows.
    pub(crate) log: Option<(String, u64)>,
    /// The device renders in software, so frame times are not meaningful.
    pub(crate) software_rendering: bool,
    /// Messages for the user, such as errors or files written, newest last.
    pub(crate) notices: Vec<String>,
    pub(crate) scene_errors: Vec<String>,
    pub(crate) undoes: Option<&'static str>,
    pub(crate) redoes: Option<&'static str>,
    pub(crate) show_picker: bool,
    pub(crate) demo: Option<DemoView>,
}

impl PanelView {
    /// Time of a step in the plugin, as shown: `0.8 µs`.
    pub(super) fn step_time(&self) -> String {
        let Some(stages) = self.stages_us else {
            return "– µs".to_owned();
        };
        let time = stages.iter().sum::<f64>();
        self.measured(time, |us| {
            format!("{} µs", number((us * 10.0).round() / 10.0))
        })
    }

    /// Formats a time \[µs\] with `words`, or as `below …` one grain of a coarse clock.
    pub(super) fn measured(&self, time: f64, words: impl Fn(f64) -> String) -> String {
        match self.grain {
            Some((grain, _)) if time < grain => format!("below {}", words(grain)),
            _ => words(time),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DemoView {
    /// The integrator of 2012 that moves the main box; `None` for the plugin.
    pub stepper: Option<Stepper>,
    /// Description of the latest fault.
    pub fault: &'static str,
    /// Duration of the last integration cycle \[µs\].
    pub cycle_us: f64,
    /// The file of its cycle times and their number.
    pub log: Option<(String, u64)>,
}
