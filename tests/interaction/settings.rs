//! Settings that persist between two starts.

use super::*;
use bevy::input::InputPlugin;
use box_game::app::GamePlugin;

/// Runs in a separate process with the settings folder of the test.
#[test]
#[ignore = "run by the test below, in a separate process"]
fn settings_child() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, preferences::plugin));
    app.add_plugins(GamePlugin { cli: cli("throw") });
    app.update();
    let kept = *app.world().resource::<Preferences>();
    let (scale, plots, aabb) = (kept.ui_scale, kept.show_plots, kept.show_aabb);
    println!("found {scale} {plots} {aabb}");
    for action in [
        Action::SetUiScale(1.25),
        Action::TogglePlots,
        Action::ToggleAabb,
        Action::Quit,
    ] {
        ask(&mut app, action);
    }
    app.update();
}

#[test]
fn settings_persist() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = || {
        let output = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", "settings::settings_child"])
            .args(["--ignored", "--nocapture"])
            .env("XDG_CONFIG_HOME", folder.path())
            .env("HOME", folder.path())
            .stdin(Stdio::null())
            .output()
            .expect("started");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    // Each start toggles both switches.
    for found in ["1 true false", "1.25 false true", "1.25 true false"] {
        let said = start();
        assert!(said.contains(&format!("found {found}")), "{said}");
    }
    // An invalid file does not prevent the start.
    let file = walk(folder.path()).expect("a settings file");
    for (text, found) in [
        ("[box_game]\nui_scale = 1e30\nshow_plots = true\n", "2 true"),
        ("}{ nonsense", "1 true false"),
    ] {
        std::fs::write(&file, text).expect("writable");
        let said = start();
        assert!(said.contains(&format!("found {found}")), "{said}");
    }
}

/// The settings file in `folder` or below.
fn walk(folder: &Path) -> Option<std::path::PathBuf> {
    std::fs::read_dir(folder).ok()?.flatten().find_map(|entry| {
        let path = entry.path();
        let settings = path.extension().is_some_and(|e| e == "toml");
        walk(&path).or(settings.then_some(path))
    })
}
