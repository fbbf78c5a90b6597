//! Scripts: actions at given times, from a RON file. The tests use them, and the pictures of the
//! documentation are made by one.
//!
//! ```ron
//! [
//!     (at: 0.0, actions: [SelectScene("bounce"), SetIntegrator("rk4")]),
//!     (at: 2.5, actions: [Push((direction: (1, 0, 0))), ScreenshotTo("pushed.png")]),
//!     (at: 3.0, actions: [Quit]),
//! ]
//! ```
//!
//! Actions after a picture in a list wait for the next frame. A picture waits until a sweep ends, and so does what
//! follows it. Times are seconds of the program's clock since the
//! script began; they go on while the scene is paused. Offscreen, a frame is one step of the physics.

use std::collections::VecDeque;
use std::path::Path;

use bevy::prelude::*;
use ron::extensions::Extensions;
use serde::{Deserialize, Serialize};

use crate::action::compare::CompareAction;
use crate::action::{Action, Actions};
use crate::compare::Comparison;
use crate::platform;

/// The longest script that is read \[bytes\].
const MAX_BYTES: u64 = 1024 * 1024;

/// Actions of one moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Beat {
    /// Time since the script began \[s\]; not before the beat above.
    pub at: f64,
    /// Actions, in this order.
    pub actions: Vec<Action>,
}

/// Reads the script in `path`.
///
/// # Errors
/// A sentence with file, line and column.
pub fn load(path: &Path) -> Result<Vec<Beat>, String> {
    let file = path.display();
    let read = || {
        let bytes = platform::read(path, MAX_BYTES + 1)?;
        if bytes.len() as u64 > MAX_BYTES {
            let text = format!("longer than {MAX_BYTES} bytes");
            return Err(std::io::Error::other(text));
        }
        String::from_utf8(bytes).map_err(std::io::Error::other)
    };
    let text = read().map_err(|error| format!("{file}: {error}"))?;
    parse(&text).map_err(|error| format!("{file}:{error}"))
}

/// The script in `text`; an error begins with line and column.
fn parse(text: &str) -> Result<Vec<Beat>, String> {
    let beats: Vec<Beat> = ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .from_str(text)
        .map_err(|error| {
            let place = error.span.start;
            format!("{}:{}: {}", place.line, place.col, error.code)
        })?;
    let mut last = 0.0;
    for (beat, k) in beats.iter().zip(1..) {
        let at = beat.at;
        if !(at.is_finite() && at >= last) {
            return Err(format!(
                " beat {k}: at {at}: allowed: finite, not before the previous beat"
            ));
        }
        last = at;
    }
    Ok(beats)
}

/// The script that is being played.
#[derive(Resource, Clone, Debug)]
pub struct Script {
    /// Remaining actions, with their times \[s\].
    rest: VecDeque<(f64, Action)>,
    began: Option<f64>,
}

impl Script {
    /// A script of these beats.
    pub fn new(beats: Vec<Beat>) -> Self {
        let timed = |beat: Beat| {
            beat.actions
                .into_iter()
                .map(move |action| (beat.at, action))
        };
        Self {
            rest: beats.into_iter().flat_map(timed).collect(),
            began: None,
        }
    }
}

/// Requests the actions that are due.
pub fn play(
    mut script: If<ResMut<Script>>,
    time: Res<Time<Real>>,
    comparison: Res<Comparison>,
    mut actions: ResMut<Actions>,
) {
    let now = time.elapsed_secs_f64();
    let began = *script.began.get_or_insert(now);
    while let Some((at, action)) = script.rest.front() {
        // A step of the clock is not always the same in its last digits.
        if now - began < at - 1e-6 {
            return;
        }
        let picture = matches!(
            action,
            Action::Screenshot | Action::ScreenshotTo(_) | Action::SavePlot(_)
        );
        if picture && comparison.is_sweeping() {
            return;
        }
        let sweep = *action == Action::Compare(CompareAction::StartSweep);
        actions.0.extend(script.rest.pop_front().map(|next| next.1));
        // What follows must not be in the picture, or must see that the sweep has begun: it waits for the next frame.
        if picture || sweep {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use box_physics::prelude::Integrator;
    use box_scenarios::Scenario;

    use super::*;
    use crate::compare::Layout;
    use crate::compare::sweep::SweepTask;

    #[test]
    fn what_is_written_reads_back() {
        let text = r#"[
            (at: 0, actions: [SelectScene("bounce"), SetIntegrator("rk4"), Set(Step, 0.01)]),
            (at: 1.5, actions: [
                Push((direction: (0, 1, 0))),
                Poke((body_point: (0.5, 0, 0), normal: (1, 0, 0), strength: 2)),
                SetCamera((yaw: 10, pitch: 20, distance: 6)),
                SelectPlot(timing), SetDemo("2012-rk4"), SetDemo(None), Grab(None), Restart, Quit,
            ]),
            (at: 2, actions: [Compare(ToggleComparison("rk4")), Compare(SetLayout(side_by_side))]),
        ]"#;
        let beats = parse(text).expect("a script");
        assert_eq!(beats.len(), 3);
        let rk4 = CompareAction::ToggleComparison(Integrator::Rk4);
        let layout = CompareAction::SetLayout(Layout::SideBySide);
        assert_eq!(beats[2].actions, [rk4.into(), layout.into()]);
        let written = ron::to_string(&beats).expect("plain data");
        assert!(written.contains(r#"ToggleComparison("rk4")"#), "{written}");
        let again: Vec<Beat> = ron::from_str(&written).expect("own text");
        assert_eq!(again, beats);
    }

    /// Plays these actions at once.
    fn playing(actions: &[Action]) -> App {
        let actions = actions.to_vec();
        let mut app = App::new();
        app.init_resource::<Time<Real>>()
            .init_resource::<Actions>()
            .init_resource::<Comparison>()
            .insert_resource(Script::new(vec![Beat { at: 0.0, actions }]))
            .add_systems(Update, play);
        app
    }

    fn requested(app: &App) -> usize {
        app.world().resource::<Actions>().0.len()
    }

    #[test]
    fn what_follows_a_picture_is_not_in_it() {
        let picture = Action::ScreenshotTo("a.png".into());
        let actions = [Action::TogglePause, picture, Action::Restart, Action::Quit];
        let mut app = playing(&actions);
        for expected in [2, 4] {
            app.update();
            assert_eq!(requested(&app), expected);
        }
        app.update();
        assert!(app.world().resource::<Script>().rest.is_empty());
    }

    #[test]
    fn a_picture_waits_for_the_sweep() {
        let setup = Scenario::find("heavy-top").expect("a scene").setup;
        let task = SweepTask::new(setup, 1, Integrator::ALL.to_vec());
        let mut app = playing(&[Action::ScreenshotTo("a.png".into())]);
        let mut comparison = app.world_mut().resource_mut::<Comparison>();
        comparison.sweep.start(task).expect("a thread");
        app.update();
        assert_eq!(requested(&app), 0);
        app.world_mut().resource_mut::<Comparison>().sweep.cancel();
        app.update();
        assert_eq!(requested(&app), 1);
    }

    #[test]
    fn mistakes_have_a_place() {
        let error = |text: &str| parse(text).expect_err("bad");
        let said = error("[\n (at: 0, actions: [Fly]),\n]");
        assert!(said.starts_with("2:") && said.contains("Fly"), "{said}");
        let said = error("[(at: 0, actions: [SetIntegrator(\"leapfrog\")])]");
        assert!(said.contains("leapfrog") && said.contains("rk4"), "{said}");
        let said = error("[(at: 0, actions: [Compare(ToggleComparison(\"leapfrog\"))])]");
        assert!(said.contains("leapfrog"), "{said}");
        assert!(error("[(at: 2, actions: []), (at: 1, actions: [])]").contains("beat 2: at"));
        assert!(error("[(at: inf, actions: [])]").contains("finite"));
        assert!(load(Path::new("/nowhere.ron")).is_err());
    }
}
