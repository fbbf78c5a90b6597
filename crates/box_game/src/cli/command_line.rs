//! The command line that brings the present set-up back.

use bevy::clipboard::Clipboard;
use bevy::prelude::*;
use box_physics::prelude::GlobalIntegrator;

use crate::action::Action;
use crate::action::compare::Layout;
use crate::compare::Comparison;
use crate::parameters::{Parameter, Parameters};
use crate::scene::library::SceneLibrary;
use crate::scene::session::Session;

/// Observes the request.
pub fn on_action(action: On<Action>, mut commands: Commands) {
    if *action == Action::CopyCommandLine {
        commands.queue(copy);
    }
}

/// The command line that restores the session. Options at their default are left out.
pub fn of(world: &World) -> String {
    let session = world.resource::<Session>();
    let comparison = world.resource::<Comparison>();
    let integrator = world.resource::<GlobalIntegrator>().0;
    let scene = world
        .resource::<SceneLibrary>()
        .path_of(session.scenario.id);
    let others = comparison.chosen().iter().filter(|&&i| i != integrator);
    let ids: Vec<_> = [&integrator]
        .into_iter()
        .chain(others)
        .map(|i| i.id())
        .collect();
    let mut words = vec![
        "box_game".to_owned(),
        quoted(scene.as_deref().unwrap_or(session.scenario.id)),
        format!("--integrator {}", ids.join(",")),
    ];
    let layout = comparison.settings.layout;
    if layout != Layout::default() {
        words.push(format!("--layout {}", layout.name().to_ascii_lowercase()));
    }
    if session.speed != 1.0 {
        words.push(format!("--speed {}", session.speed));
    }
    if session.seed != 1 {
        words.push(format!("--seed {}", session.seed));
    }
    words.extend(parameters(&session.parameters, &session.defaults));
    words.join(" ")
}

/// The options of the parameters that differ from the scene's own; dt always.
fn parameters(now: &Parameters, scene: &Parameters) -> Vec<String> {
    let changed = |p: &Parameter| now.get(*p) != scene.get(*p);
    let option = |p: Parameter| {
        let (id, value) = (p.info().id, now.get(p)?);
        Some(match p {
            Parameter::Step => format!("--dt {}", step(value)),
            Parameter::Substeps | Parameter::Boxes => format!("--{id} {value}"),
            _ => format!("--set {id}={value}"),
        })
    };
    Parameter::ALL
        .into_iter()
        .filter(|p| *p == Parameter::Step || changed(p))
        .filter_map(option)
        .collect()
}

/// Puts it on the clipboard, and shows it.
fn copy(world: &mut World) {
    let line = of(world);
    let copied = world
        .get_resource_mut::<Clipboard>()
        .is_some_and(|mut clipboard| clipboard.set_text(line.as_str()).is_ok());
    let text = if copied {
        format!("copied: {line}")
    } else {
        line
    };
    world.resource_mut::<Session>().notice(text);
}

/// A rate where it is a whole number.
fn step(step: f64) -> String {
    let rate = (1.0 / step).round();
    if 1.0 / rate == step {
        format!("{rate}hz")
    } else {
        format!("{step}")
    }
}

/// For a shell: plain where it can be.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./".contains(c);
    if word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    #[test]
    fn only_what_differs_is_said() {
        let scene = Parameters::of(&Scenario::find("bounce").expect("a scene"));
        assert_eq!(parameters(&scene, &scene), ["--dt 60hz"]);
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
            parameters(&now, &scene).join(" "),
            "--dt 0.0123 --substeps 3 --set gravity=1.62 --set half-y=0.2 --boxes 7"
        );
        assert_eq!(quoted("my scenes/a.ron"), "'my scenes/a.ron'");
    }
}
