//! `simulate`: one trajectory as CSV.

use std::io::Write;
use std::path::{Path, PathBuf};

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use box_scenarios::oracle::Case;
use box_scenarios::run::steps_in;
use box_scenarios::{Family, Plan, Scenario, Setup, StateError, parse_step, run_plan, scene_file};
use clap::Args;

use crate::context::Stop;

/// Maximum length of a run \[steps\].
const MAX_STEPS: u64 = 100_000_000;

/// Options of the command simulate.
#[derive(Args)]
pub(crate) struct Options {
    /// Name of a scene, or a file: a scene (RON) or a reference trajectory (JSON)
    #[arg(value_name = "SCENE|FILE")]
    scene: String,
    /// Integrator
    #[arg(long, value_name = "INTEGRATOR", default_value = "split")]
    integrator: Integrator,
    /// Step size: 60hz, 1/60 or 0.0166 (seconds)
    #[arg(long, value_name = "STEP", default_value = "60hz", value_parser = parse_step)]
    dt: f64,
    /// Duration in seconds [default: the scene's]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    duration: Option<f64>,
    /// CSV file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn seconds(text: &str) -> Result<f64, String> {
    let value = text.trim_end_matches('s').parse::<f64>().ok();
    value
        .filter(|s| s.is_finite() && *s > 0.0)
        .ok_or_else(|| format!("allowed: seconds, above 0; given: '{text}'"))
}

/// The columns. The error columns are empty where there is no reference.
#[rustfmt::skip]
const COLUMNS: [&str; 20] = [
    "t_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s",
    "wy_rad_s", "wz_rad_s", "lx_kg_m2_s", "ly_kg_m2_s", "lz_kg_m2_s", "energy_j",
    "position_error_m", "attitude_error_rad",
];

/// Finds the setup called `name`: a scene of the list, a family of the report, or a file. **To support other file
/// formats, extend this function**; it selects the format by the file extension.
fn find(name: &str) -> Result<Setup, Stop> {
    let path = Path::new(name);
    if path.is_file() {
        return match path.extension().and_then(|e| e.to_str()) {
            Some("json") => Case::load(path)
                .map(|c| c.setup)
                .map_err(|e| Stop::Usage(e.to_string())),
            Some("ron") => scene_file::load(path)
                .map(|s| s.setup)
                .map_err(|e| Stop::Usage(e.to_string())),
            _ => Err(Stop::Usage(format!(
                "{name}: allowed: a scene file (.ron) or a reference trajectory (.json)"
            ))),
        };
    }
    if let Some(family) = Family::all().iter().find(|f| f.id == name) {
        return Ok(family.setup.clone());
    }
    Scenario::find(name).map(|s| s.setup).map_err(|_| {
        let mut known = Scenario::ids();
        for f in Family::all() {
            if !known.contains(&f.id) {
                known.push(f.id);
            }
        }
        Stop::Usage(format!(
            "unknown scene '{name}', and no file of that name; allowed: {}",
            known.join(", ")
        ))
    })
}

/// Runs the simulation and writes the CSV.
pub(crate) fn run(options: &Options) -> Result<(), Stop> {
    let mut setup = find(&options.scene)?;
    if let Some(duration) = options.duration {
        setup.duration = duration;
    }
    let steps = steps_in(setup.duration, options.dt);
    if steps > MAX_STEPS {
        return Err(Stop::Usage(format!(
            "{} s in steps of {} s: allowed: at most 1e8 steps",
            setup.duration, options.dt
        )));
    }
    let failed = |source| Stop::File {
        path: options
            .output
            .clone()
            .unwrap_or_else(|| PathBuf::from("standard output")),
        source,
    };
    match &options.output {
        None => write(&setup, options, steps, &mut std::io::stdout().lock()).map_err(failed),
        Some(path) => {
            let file = std::fs::File::create(path).map_err(failed)?;
            let mut out = std::io::BufWriter::new(file);
            write(&setup, options, steps, &mut out).map_err(failed)
        }
    }
}

fn write(
    setup: &Setup,
    options: &Options,
    steps: u64,
    out: &mut impl Write,
) -> Result<(), std::io::Error> {
    let reference = setup.reference();
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(COLUMNS)?;
    let mut line = |t: f64, state: &BodyState| -> Result<(), csv::Error> {
        let (x, q, v) = (state.position, state.rotation, state.velocity);
        let w = state.angular_velocity(&setup.body);
        let l = state.angular_momentum_world();
        let e = setup.energy(state);
        let numbers = [
            t, x.x, x.y, x.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z, l.x, l.y, l.z, e,
        ];
        let error = reference.at(t).map(|r| StateError::between(state, &r));
        let errors = [error.map(|e| e.position), error.map(|e| e.attitude)];
        let text = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        let cells = numbers.into_iter().map(Some).chain(errors);
        csv.write_record(cells.map(text))
    };
    line(0.0, &setup.initial)?;
    let plan = if setup.impulses.is_empty() {
        Plan::clock(options.dt, 1, steps)
    } else {
        let times: Vec<f64> = (1..=steps).map(|k| k as f64 * options.dt).collect();
        Plan::new(&times, &setup.impulses, options.dt)
    };
    let mut result = Ok(());
    run_plan(setup, options.integrator, &plan, |t, state| {
        result = line(t, state);
        // Stop after a state that is not finite; later lines would contain no information.
        result.is_ok() && state.is_finite()
    });
    result?;
    csv.flush()
}
