//! Settings that persist between two starts.

use super::*;
use bevy::input::InputPlugin;
use box_game::app::GamePlugin;

/// Runs in a separate process with the settings folder of the test.
#[test]
#[ignore = "run by the test below, in a process of its own"]
fn settings_child() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, PreferencesPlugin));
    app.add_plugins(GamePlugin { cli: cli("throw") });
    app.update();
    let kept = *app.world().resource::<Preferences>();
    println!(
        "found {} {} {}",
        kept.ui_scale, kept.show_plots, kept.show_aabb
    );
    ask(&mut app, Action::SetUiScale(1.25));
    ask(&mut app, Action::TogglePlots);
    ask(&mut app, Action::ToggleAabb);
    ask(&mut app, Action::Quit);
    app.update();
}

#[test]
fn settings_persist() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = || {
        let output = Command::new(std::env::current_exe().expect("this program"))
            .args([
                "--exact",
                "settings::settings_child",
                "--ignored",
                "--nocapture",
            ])
            .env("XDG_CONFIG_HOME", folder.path())
            .env("HOME", folder.path())
            .stdin(Stdio::null())
            .output()
            .expect("started");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let first = start();
    assert!(first.contains("found 1 true false"), "{first}");
    let second = start();
    assert!(second.contains("found 1.25 false true"), "{second}");
    let third = start();
    assert!(
        third.contains("found 1.25 true false"),
        "toggled again: {third}"
    );
    // An invalid file does not prevent the start.
    let file = walk(folder.path()).expect("a settings file");
    std::fs::write(&file, "[box_game]\nui_scale = 1e30\nshow_plots = true\n").expect("writable");
    assert!(start().contains("found 2 true"));
    std::fs::write(&file, "}{ nonsense").expect("writable");
    assert!(start().contains("found 1 true false"));
}

/// The settings file in `folder` or below.
fn walk(folder: &Path) -> Option<std::path::PathBuf> {
    std::fs::read_dir(folder).ok()?.flatten().find_map(|entry| {
        let path = entry.path();
        if path.is_dir() {
            walk(&path)
        } else {
            path.extension()
                .is_some_and(|e| e == "toml")
                .then_some(path)
        }
    })
}
