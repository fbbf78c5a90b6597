//! What the panel shows: plain data, filled by the game, so that the panel is a pure function of it
//! and is tested without a window.

use box_physics::prelude::{DVec3, Integrator};
use box_scenarios::dissertation::Stepper;

use crate::action::Plot;
use crate::compare::CompareView;

/// Everything the panel shows in one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelView {
    /// (id, title) of every scene, in the order of the list.
    pub scenes: Vec<(String, String)>,
    /// Index into `scenes`.
    pub scene: usize,
    /// One or two sentences about the scene.
    pub lesson: String,
    /// The integrator in use.
    pub integrator: Integrator,
    /// Whether the clock stands.
    pub paused: bool,
    /// Simulated time \[s\].
    pub time: f64,
    /// Steps taken since the start of the scene.
    pub steps: u64,
    /// dt \[s\].
    pub step: f64,
    /// Substeps per step.
    pub substeps: u32,
    /// The scene's own dt \[s\], for "reset" and tooltips.
    pub default_step: f64,
    /// The scene's own substeps, for "reset" and tooltips.
    pub default_substeps: u32,
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
    /// State of the hero box.
    pub hero: HeroView,
    /// Timing of every integrator, in the order of the menu.
    pub timings: Vec<IntegratorTiming>,
    /// Body-steps since the start of the scene in which the integrator gave way to `split`.
    pub fallbacks: u64,
    /// Body-steps since then whose iteration ended at its cap.
    pub unconverged: u64,
    /// Time of the plugin's last step, all bodies \[µs\], and of the frame \[ms\].
    pub step_time_us: f64,
    /// See `step_time_us`.
    pub frame_time_ms: f64,
    /// Histories for the plots.
    pub history: HistoryView,
    /// The comparison of integrators.
    pub compare: CompareView,
    /// What is drawn besides the boxes.
    pub show_aabb: bool,
    /// See `show_aabb`.
    pub show_contacts: bool,
    /// See `show_aabb`.
    pub show_axes: bool,
    /// Whether the key list is open.
    pub show_help: bool,
    /// Whether the panel is hidden.
    pub hidden: bool,
    /// Whether the drawer is open.
    pub show_plots: bool,
    /// Which plot the drawer shows.
    pub plot: Plot,
    /// The log being written: path, rows, bytes.
    pub log: Option<LogView>,
    /// The device renders in software, so frame times say nothing.
    pub software_rendering: bool,
    /// Messages for the person: the last error or file written, newest last.
    pub notices: Vec<String>,
    /// What hands can do and see besides.
    pub interaction: InteractionView,
}

/// Hints, scene files, the past, the 2012 demo.
#[derive(Clone, Debug, PartialEq)]
pub struct InteractionView {
    /// What to try in this scene.
    pub hints: [String; 2],
    /// What is wrong with scene files, a line each.
    pub scene_errors: Vec<String>,
    /// Ticks that one can go back.
    pub past: usize,
    /// What undo would take back.
    pub undoes: Option<String>,
    /// What redo would do again.
    pub redoes: Option<String>,
    /// Whether the list of scenes to search in is open.
    pub show_picker: bool,
    /// Scale of the panel.
    pub ui_scale: f64,
    /// The demo of 2012, in its scene.
    pub demo: Option<DemoView>,
}

impl Default for InteractionView {
    fn default() -> Self {
        Self {
            hints: Default::default(),
            scene_errors: Vec::new(),
            past: 0,
            undoes: None,
            redoes: None,
            show_picker: false,
            ui_scale: 1.0,
            demo: None,
        }
    }
}

/// The demo of 2012.
#[derive(Clone, Debug, PartialEq)]
pub struct DemoView {
    /// Which of its steppers moves the hero; `None` for ours.
    pub stepper: Option<Stepper>,
    /// Its last integration cycle \[µs\].
    pub cycle_us: f64,
    /// The file of its cycle times and their number.
    pub log: Option<(String, u64)>,
}

/// What can be set live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Gravity, downwards [m/s²].
    pub gravity: f64,
    /// Restitution of the floor; `None` without a floor.
    pub restitution: Option<f64>,
    /// Friction of the floor; `None` without a floor.
    pub friction: Option<f64>,
    /// Linear drag c₁ [N s/m].
    pub linear_drag: f64,
    /// Angular damping γ [1/s].
    pub angular_damping: f64,
    /// Half-extents of the box \[m\].
    pub half_extents: DVec3,
    /// Mass \[kg\].
    pub mass: f64,
    /// Strength of a push \[N s\].
    pub impulse: f64,
    /// Number of boxes.
    pub boxes: u32,
}

/// The hero box now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeroView {
    /// ½mv² \[J\].
    pub translational_energy: f64,
    /// ½L·ω \[J\].
    pub rotational_energy: f64,
    /// Potential energy over the floor, or the origin \[J\].
    pub potential_energy: f64,
    /// |L| [kg m²/s].
    pub angular_momentum: f64,
    /// |v| [m/s].
    pub speed: f64,
    /// |ω| [rad/s].
    pub spin: f64,
    /// Center \[m\].
    pub position: DVec3,
    /// "free", "contact", "resting" or "quarantined".
    pub state: &'static str,
}

/// Timing of one integrator on the present load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorTiming {
    /// Which.
    pub integrator: Integrator,
    /// Shortest, median and 95th percentile of the recent samples [ns per body-step]; `None` before
    /// the first.
    pub nanoseconds: Option<(f64, f64, f64)>,
    /// Force evaluations per body-step.
    pub evaluations: f64,
}

/// Histories, oldest first; times are seconds since the start of the program or the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HistoryView {
    /// Per integrator in the order of the menu: (wall time \[s\], median ns per body-step).
    pub timing: Vec<Vec<(f64, f64)>>,
    /// (wall time \[s\], process CPU [% of all cores], system CPU \[%\]).
    pub cpu: Vec<(f64, f64, f64)>,
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
