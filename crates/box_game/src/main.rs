//! The game's entry point: chooses between window, pictures without a window, and the comparison
//! without either.

use std::process::ExitCode;

use bevy::app::AppExit;
use box_game::app;
use box_game::cli::{self, Cli};
use box_game::compare::headless::{self, Headless};
use box_game::platform::{self, Need};
use box_game::scene::library;
use box_game::scene::session::Session;
use box_physics::prelude::Integrator;
use box_scenarios::Scenario;
use clap::Parser;

fn main() -> ExitCode {
    let cli = match Cli::try_parse_from(platform::arguments()) {
        Ok(cli) => cli,
        Err(error) => return platform::refuse(&error),
    };
    if let Some(need) = cli.probe {
        return match platform::probe(need) {
            Ok(()) => ExitCode::SUCCESS,
            Err(reason) => fail(&reason, 1),
        };
    }
    if cli.list_scenes {
        return platform::say(&cli::scene_list());
    }
    if cli.list_integrators {
        return platform::say(&cli::integrator_list());
    }
    if cli.headless {
        return compare(&cli);
    }
    let need = if cli.offscreen {
        Need::Gpu
    } else {
        Need::Window
    };
    if let Err(missing) = platform::check(need) {
        platform::complain(&missing.to_string());
        if cli.offscreen || cli.screenshot.is_some() || cli.script.is_some() {
            return cli::no_display();
        }
        platform::complain(
            "\nRunning the comparison without a window instead (as with --headless):\n",
        );
        return compare(&cli);
    }
    match app::build(&cli) {
        Ok(mut app) => match app.run() {
            AppExit::Success => ExitCode::SUCCESS,
            AppExit::Error(code) => ExitCode::from(code.get()),
        },
        Err(error) => fail(&error.to_string(), 1),
    }
}

/// Says why the program ends with this exit code.
fn fail(reason: &str, code: u8) -> ExitCode {
    platform::complain(reason);
    ExitCode::from(code)
}

/// The comparison without a window.
fn compare(cli: &Cli) -> ExitCode {
    let id = cli.scene.as_deref().unwrap_or("throw");
    let scenario = match library::open(id) {
        Ok(scenario) => scenario,
        Err(error) => return fail(&error, 2),
    };
    let mut scenario = match wished(scenario, cli) {
        Ok(scenario) => scenario,
        Err(error) => return fail(&error, 2),
    };
    if let Some(duration) = cli.duration {
        scenario.setup.duration = duration;
    }
    let headless = Headless {
        scenario,
        integrators: if cli.integrator.is_empty() {
            Integrator::ALL.to_vec()
        } else {
            cli.integrator.clone()
        },
        dt: cli.dt,
        substeps: cli.substeps,
        log: cli
            .log
            .clone()
            .unwrap_or_else(|| headless::default_log().to_owned()),
        seed: cli.seed,
    };
    let table = match headless.run() {
        Ok(table) => table,
        Err(error) => return fail(&error.to_string(), 1),
    };
    let every = match table.every {
        1 => String::new(),
        n => format!(" (every {n} steps)"),
    };
    let said = platform::say(&format!(
        "{}\nFull time series: {}{every}\n",
        headless.report(&table),
        headless.log.display()
    ));
    let mut results = table.result.integrators.iter();
    if cli.fail_on_divergence && results.any(|r| r.status.is_diverged()) {
        return cli::diverged();
    }
    said
}

/// The scene with the parameters of `--set`.
fn wished(mut scenario: Scenario, cli: &Cli) -> Result<Scenario, String> {
    let mut session = Session::new(scenario.clone(), cli.seed);
    for (parameter, value) in cli.parameters() {
        session.parameters.set(parameter, value)?;
    }
    scenario.setup = session.setup();
    Ok(scenario)
}
