//! Content of the panel: plain data, filled by the game. The panel is a pure function of it and is tested
//! without a window.

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
use crate::scene::library::SceneCard;

/// Names and units of the main box's figures; the potential energy is that over the floor, or the origin.
pub const FIGURES: [(&str, &str); 10] = [
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
    pub scenes: Vec<SceneCard>,
    /// The scene being played, which may be in the list no longer.
    pub scenario: Scenario,
    /// The integrator in use.
    pub integrator: Integrator,
    /// The clock is paused.
    pub paused: bool,
    /// Simulated time \[s\].
    pub time: f64,
    /// Steps taken since the start of the scene.
    pub steps: u64,
    /// Target speed, 1 = real time.
    pub speed: f64,
    /// Measured speed over the last second; `None` until there is one.
    pub actual_speed: Option<f64>,
    /// Simulated time dropped by frame hitches since the start \[s\].
    pub dropped: f64,
    /// The parameters as they are.
    pub parameters: Parameters,
    /// The scene's own, for "reset" and tooltips.
    pub defaults: Parameters,
    /// The main box in numbers, see [`FIGURES`].
    pub figures: [f64; FIGURES.len()],
    /// In free flight, at the floor, at rest, or frozen.
    pub state: Status,
    /// Of every integrator in the order of the menu: recent samples [ns per body-step], if any, and force evaluations
    /// per body-step.
    pub timings: Vec<(Option<Cost>, f64)>,
    /// Body-steps since the start of the scene in which the integrator gave way to `split`.
    pub fallbacks: u64,
    /// Body-steps since then whose iteration ended at its cap.
    pub unconverged: u64,
    /// Time of each stage of a step in the plugin, all bodies \[µs\]; `None` while it takes no steps.
    pub stages_us: Option<[f64; Stage::ALL.len()]>,
    /// The same for each of the last steps, oldest first.
    pub stage_history: Vec<[f64; Stage::ALL.len()]>,
    /// Grain of a coarse clock \[µs\], and the standard deviation that it leaves in a sample, relative.
    pub grain: Option<(f64, f64)>,
    /// Time of the last frame \[ms\].
    pub frame_time_ms: f64,
    /// Histories for the plots.
    pub history: HistoryView,
    /// The comparison of integrators.
    pub compare: CompareView,
    /// Scale and switches.
    pub preferences: Preferences,
    /// The list of keys is open.
    pub show_help: bool,
    /// The panel is hidden.
    pub hidden: bool,
    /// Plot in the drawer.
    pub plot: Plot,
    /// The log being written: path, rows, bytes.
    pub log: Option<LogView>,
    /// The device renders in software, so frame times say nothing.
    pub software_rendering: bool,
    /// Messages for the person: the last error or file written, newest last.
    pub notices: Vec<String>,
    /// Errors of scene files, a line each.
    pub scene_errors: Vec<String>,
    /// Name of the next change to undo.
    pub undoes: Option<&'static str>,
    /// Name of the next change to redo.
    pub redoes: Option<&'static str>,
    /// The list of scenes is open.
    pub show_picker: bool,
    /// The demo of 2012, in its scene.
    pub demo: Option<DemoView>,
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

    /// A time \[µs\] in words. A browser's clock shows 0 or one of its grains.
    pub(super) fn measured(&self, time: f64, words: impl Fn(f64) -> String) -> String {
        match self.grain {
            Some((grain, _)) if time < grain => format!("below {}", words(grain)),
            _ => words(time),
        }
    }
}

/// The demo of 2012.
#[derive(Clone, Debug, PartialEq)]
pub struct DemoView {
    /// The stepper that moves the main box; `None` for the plugin.
    pub stepper: Option<Stepper>,
    /// The last integration cycle \[µs\].
    pub cycle_us: f64,
    /// The file of its cycle times and their number.
    pub log: Option<(String, u64)>,
}

/// Histories, oldest first; times are seconds since the start of the program or the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HistoryView {
    /// Per integrator in the order of the menu: (wall time \[s\], minimum ns per body-step).
    pub timing: Vec<Vec<(f64, f64)>>,
    /// (wall time \[s\], process CPU [% of all cores], system CPU \[%\]).
    pub cpu: Vec<(f64, f64, f64)>,
    /// Reason why the CPU usage is unknown, if it is.
    pub no_cpu: Option<&'static str>,
}

/// The CSV log being written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogView {
    /// Full path.
    pub path: String,
    /// Rows written.
    pub rows: u64,
    /// Bytes written.
    pub bytes: u64,
}
