//! The command line.

pub mod command_line;
mod parse;
pub mod start;

use std::path::PathBuf;

use bevy::prelude::Resource;
use box_physics::prelude::Integrator;
use box_scenarios::Scenario;
use clap::Parser;

use crate::action::Plot;
use crate::action::compare::Layout;
use crate::parameters::Parameter;
use crate::platform::Need;

/// Push a box around and compare numerical integrators live, by error and cost.
///
/// Exit codes: 0 success, 1 run-time error, 2 usage error, 3 divergence with --fail-on-divergence,
/// 4 no display or GPU although an option requires one.
#[derive(Resource, Parser, Clone, Debug)]
#[command(name = "box_game", version, verbatim_doc_comment)]
pub struct Cli {
    /// Scene to open (see --list-scenes), or a scene file (assets/scenes/example.ron documents the
    /// format) [default with --headless: throw].
    #[arg(value_parser = parse::scene)]
    pub scene: Option<String>,

    /// Integrators, separated by commas: the first moves the main box, the others are comparisons.
    /// --headless compares all of them [default there: every integrator]. See --list-integrators.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub integrator: Vec<Integrator>,

    /// Step size as a rate (60hz), a fraction (1/60) or seconds (0.0166); 0.00052 to 0.5 s.
    #[arg(long, value_name = "STEP", default_value = "60hz", value_parser = parse::step)]
    pub dt: f64,

    /// Substeps per step.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub substeps: u32,

    /// Layout of the comparisons: solo, overlaid (all in one place), side-by-side or views.
    #[arg(
        long,
        value_name = "LAYOUT",
        default_value = "overlaid",
        ignore_case = true,
        hide_possible_values = true
    )]
    pub layout: Layout,

    /// Plot to show: error, energy, timing, cpu, work-precision (also starts its sweep over step
    /// sizes) or table [default: the scene's].
    #[arg(long, value_name = "TAB", value_parser = parse::plot)]
    pub plot: Option<Plot>,

    /// Number of boxes [default: the scene's].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub boxes: Option<u32>,

    /// Random seed (for the attitudes of multiple boxes).
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,

    /// Quit after this simulated time in seconds [default: no limit; headless: the scene's duration].
    #[arg(long, value_name = "S", value_parser = parse::duration)]
    pub duration: Option<f64>,

    /// Write the CSV log to this file from the start.
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,

    /// Run the comparison without a window or GPU: print a table and write the time series as CSV
    /// (to --log, by default comparison.csv in this folder).
    #[arg(long, conflicts_with_all = ["offscreen", "screenshot", "boxes", "frames"])]
    pub headless: bool,

    /// Render without a window, for --screenshot (needs a GPU driver, hardware or software).
    #[arg(long)]
    pub offscreen: bool,

    /// Quit after rendering this number of frames.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: Option<u32>,

    /// Save the last frame to this PNG file and quit (after --frames, by default 60).
    #[arg(long, value_name = "FILE", value_parser = parse::png)]
    pub screenshot: Option<PathBuf>,

    /// Size of the window, or of the image with --offscreen, in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse::size)]
    pub size: (u32, u32),

    /// Target speed: simulated seconds per second, 0.01 to 4.
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = parse::speed)]
    pub speed: f64,

    /// Set a parameter of the scene, for example gravity=1.62; may be repeated. Names: gravity, restitution,
    /// restitution-law (energetic or newton), friction, linear-drag, angular-damping, half-x, half-y, half-z (or half-extents=X,Y,Z), mass, impulse.
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse::setting)]
    pub set: Vec<Setting>,

    /// Run this script of actions (example: assets/scripts/tour.ron).
    #[arg(long, value_name = "FILE")]
    pub script: Option<PathBuf>,

    /// Do not read or write the user's settings file.
    #[arg(long)]
    pub no_settings: bool,

    /// Scale of the panel, 0.75 to 2 [default: last used].
    #[arg(long, value_name = "X", value_parser = parse::scale)]
    pub ui_scale: Option<f32>,

    /// Exit with code 3 if an integrator diverges.
    #[arg(long)]
    pub fail_on_divergence: bool,

    /// List the scenes and quit.
    #[arg(long)]
    pub list_scenes: bool,

    /// List the integrators and quit.
    #[arg(long)]
    pub list_integrators: bool,

    /// Internal: check in a separate process whether a window and a GPU are available.
    #[arg(long, hide = true, value_name = "WHAT")]
    pub probe: Option<Need>,
}

/// Values for parameters, of one `--set`.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting(pub Vec<(Parameter, f64)>);

impl Cli {
    /// Every parameter that the command line sets, in order.
    pub fn parameters(&self) -> Vec<(Parameter, f64)> {
        let own = [
            (Parameter::Step, Some(self.dt)),
            (Parameter::Substeps, Some(f64::from(self.substeps))),
            (Parameter::Boxes, self.boxes.map(f64::from)),
        ];
        let own = own.into_iter().filter_map(|(p, value)| Some((p, value?)));
        let set = self.set.iter().flat_map(|setting| setting.0.clone());
        own.chain(set).collect()
    }
}

/// Exit code: an integrator diverged, and --fail-on-divergence was given.
pub const DIVERGED: u8 = 3;
/// Exit code: no display or GPU although a flag asks for one.
pub const NO_DISPLAY: u8 = 4;

/// The table of `--list-scenes`.
pub fn scene_list() -> String {
    let scenes: Vec<_> = Scenario::ALL.iter().map(|build| build()).collect();
    let width = scenes.iter().map(|s| s.id.len()).max().unwrap_or(0);
    scenes
        .iter()
        .map(|s| format!("{:width$}  {}: {}\n", s.id, s.title, s.lesson))
        .collect()
}

/// The table of `--list-integrators`.
pub fn integrator_list() -> String {
    Integrator::ALL
        .iter()
        .map(|i| {
            let info = i.info();
            format!(
                "{:20}  order {:5}  evaluations {:19}  {}\n",
                info.id,
                info.orders.rotation.to_string(),
                info.evaluations.to_string(),
                info.summary
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    /// Text for people: no escapes and no markup of doc comments in any help page.
    #[test]
    fn help_pages_are_plain_text() {
        let mut command = Cli::command();
        for page in [command.render_help(), command.render_long_help()] {
            let page = page.to_string();
            for markup in ["\\", "`", "[[", "]("] {
                assert!(!page.contains(markup), "{markup} in:\n{page}");
            }
        }
    }

    #[test]
    fn errors_name_option_value_and_what_is_allowed() {
        for (line, words) in [
            (
                "--integrator split,leapfrog",
                &["leapfrog", "--integrator", "heun-2012"][..],
            ),
            ("--dt 0", &["--dt", "'0'", "60hz"]),
            ("--dt 0.7", &["--dt", "0.5 s"]),
            ("nowhere", &["nowhere", "dzhanibekov"]),
            ("--boxes 0", &["--boxes", "1..=100000"]),
            (
                "--layout tiles",
                &["--layout", "solo, overlaid, side-by-side"],
            ),
            ("--plot pie", &["--plot", "work-precision"]),
            ("--screenshot a.jpg", &[".png"]),
            ("--headless --offscreen", &["cannot be used with"]),
        ] {
            let arguments = ["box_game"].into_iter().chain(line.split(' '));
            let said = Cli::try_parse_from(arguments).unwrap_err().to_string();
            assert!(words.iter().all(|word| said.contains(word)), "{said}");
        }
    }
}
