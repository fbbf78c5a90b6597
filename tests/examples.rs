//! Every file in `examples/` is a target and has a header with its purpose and command. Three of them open a
//! window. (`.ci/examples` runs them.)

use std::path::Path;

#[test]
fn every_example_is_a_target_and_says_how_to_run_it() {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = std::fs::read_dir(crate_folder.join("..")).expect("the crates");
    let manifests: String = crates
        .filter_map(|entry| std::fs::read_to_string(entry.ok()?.path().join("Cargo.toml")).ok())
        .collect();
    let folder = crate_folder.join("../../examples");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            continue; // a file included by an example
        }
        let name = path
            .file_stem()
            .expect("a file")
            .to_string_lossy()
            .into_owned();
        let text = std::fs::read_to_string(&path).expect("readable");
        let target = format!("path = \"../../examples/{name}.rs\"");
        assert!(manifests.contains(&target), "{name} has no [[example]]");
        let command = format!("`cargo run --release --example {name}");
        let header: Vec<_> = text.lines().take_while(|l| l.starts_with("//!")).collect();
        assert!(header.concat().contains(&command), "{name}: its command");
        let windowed = ["debris", "dice", "two_clocks"].contains(&name.as_str());
        assert_eq!(
            text.contains("DefaultPlugins,"),
            windowed,
            "{name}: a window"
        );
        assert!(!windowed || text.lines().count() < 150, "{name} is long");
        seen += 1;
    }
    assert!(seen >= 17, "{seen}");
}
