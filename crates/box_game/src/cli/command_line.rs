//! The command line that restores the current session.

use bevy::prelude::*;
use box_physics::prelude::GlobalIntegrator;
use clap::ValueEnum as _;

use crate::action::compare::Layout;
use crate::action::{Action, Plot};
use crate::compare::Comparison;
use crate::parameters::{Parameter, Parameters};
use crate::platform;
use crate::scene::library::SceneLibrary;
use crate::scene::session::Session;

/// Observes the copy action.
pub fn on_action(action: On<Action>, mut commands: Commands) {
    if *action == Action::CopyCommandLine {
        commands.queue(copy);
    }
}

/// The command line that restores the session. Default options are omitted.
///
/// # Errors
/// Names a part of the session that it cannot restore.
pub fn of(world: &World) -> Result<String, &'static str> {
    let session = world.resource::<Session>();
    let comparison = world.resource::<Comparison>();
    let integrator = world.resource::<GlobalIntegrator>().0;
    let scene = world
        .resource::<SceneLibrary>()
        .path_of(session.scenario.id);
    let mut ids = vec![integrator.id()];
    let others = comparison.chosen().iter().filter(|i| **i != integrator);
    ids.extend(others.map(|i| i.id()));
    let mut words = vec![scene.unwrap_or_else(|| session.scenario.id.to_owned())];
    let mut option = |name: &str, value: String| words.extend([format!("--{name}"), value]);
    option("integrator", ids.join(","));
    let layout = comparison.settings.layout.to_possible_value();
    if let Some(layout) = layout.filter(|_| comparison.settings.layout != Layout::default()) {
        option("layout", layout.get_name().to_owned());
    }
    let plot = Plot::ALL.iter().find(|(plot, _)| *plot == session.plot);
    if let Some((_, name)) = plot.filter(|(plot, _)| *plot != session.scenario.view.plot) {
        option("plot", (*name).to_owned());
    }
    if session.speed != 1.0 {
        option("speed", session.speed.to_string());
    }
    if session.seed != 1 {
        option("seed", session.seed.to_string());
    }
    for (name, value) in parameters(&session.parameters, &session.defaults) {
        option(&name, value);
    }
    platform::reproduce(&words)
}

/// The options of the parameters that differ from the scene's defaults, and always dt.
fn parameters(now: &Parameters, scene: &Parameters) -> Vec<(String, String)> {
    let changed = |p: &Parameter| now.get(*p) != scene.get(*p);
    let option = |p: Parameter| {
        let (id, value) = (p.info().id, now.get(p)?);
        Some(match p {
            Parameter::Step => ("dt".to_owned(), step(value)),
            Parameter::Substeps | Parameter::Boxes => (id.to_owned(), value.to_string()),
            _ => ("set".to_owned(), format!("{id}={value}")),
        })
    };
    Parameter::ALL
        .into_iter()
        .filter(|p| *p == Parameter::Step || changed(p))
        .filter_map(option)
        .collect()
}

/// Copies it to the clipboard, and shows it.
fn copy(world: &mut World) {
    let notice = match of(world) {
        Ok(line) if platform::copy(world, &line) => format!("copied: {line}"),
        Ok(line) => line,
        Err(reason) => reason.to_owned(),
    };
    world.resource_mut::<Session>().notice(notice);
}

/// The step as a rate if that is a whole number.
fn step(step: f64) -> String {
    let rate = (1.0 / step).round();
    if 1.0 / rate == step {
        format!("{rate}hz")
    } else {
        format!("{step}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    #[test]
    fn only_what_differs_is_said() {
        let scene = Parameters::of(&Scenario::find("bounce").expect("a scene"));
        let said = |now: &Parameters| {
            let options = parameters(now, &scene).into_iter();
            options
                .map(|(name, value)| format!("--{name} {value}"))
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(said(&scene), "--dt 60hz");
        let mut now = scene;
        for (parameter, value) in [
            (Parameter::Step, 0.0123),
            (Parameter::Substeps, 3.0),
            (Parameter::Gravity, 1.62),
            (Parameter::HalfY, 0.2),
            (Parameter::Boxes, 7.0),
        ] {
            now.set(parameter, value).expect("allowed");
        }
        assert_eq!(
            said(&now),
            "--dt 0.0123 --substeps 3 --set gravity=1.62 --set half-y=0.2 --boxes 7"
        );
    }
}
