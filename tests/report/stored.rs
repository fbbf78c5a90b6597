//! Stored digests, errors and tables: `check` and `bless`.

use super::program::run;
use super::{read, root};

/// A repository with only the stored files.
fn stored_files() -> tempfile::TempDir {
    let copy = tempfile::tempdir().expect("a folder");
    for file in [
        "tests/expected/digests.csv",
        "tests/expected/report.csv",
        "docs/integrators.md",
        "docs/contact.md",
    ] {
        let to = copy.path().join(file);
        std::fs::create_dir_all(to.parent().expect("a folder")).expect("created");
        std::fs::copy(root().join(file), to).expect(file);
    }
    copy
}

#[test]
fn stored_files_match_the_program() {
    run("check", &[]).ok();
}

#[test]
fn check_names_a_changed_number_and_bless_stores_it() {
    let copy = stored_files();
    // The values that bless would have stored for an integrator that is a hundred times less accurate and
    // more expensive, with different digests.
    let errors = copy.path().join("tests/expected/report.csv");
    let before = read(&errors);
    let mut lines = before.lines();
    let exact = lines.find(|l| l.starts_with("free-tumble,exact,60,"));
    let exact = exact.expect("a row");
    let mut cells: Vec<String> = exact.split(',').map(str::to_owned).collect();
    let error: f64 = cells[4].parse().expect("an attitude error");
    assert!(error < 1e-12, "exact is exact: {error:e}");
    cells[4] = (100.0 * error).to_string();
    cells[6] += "0";
    std::fs::write(&errors, before.replace(exact, &cells.join(","))).expect("written");
    let digests = copy.path().join("tests/expected/digests.csv");
    let right = read(&digests);
    let line = right.lines().nth(1).expect("a digest");
    let (id, _) = line.split_once(',').expect("two cells");
    let wrong = right.replace(line, &format!("{id},0123456789abcdef"));
    std::fs::write(&digests, wrong).expect("written");
    let ran = run("check --root {}", &[copy.path()]);
    assert_eq!(ran.code, Some(1));
    for words in [
        "report.csv: 2 differences",
        "free-tumble exact 60 Hz: attitude_error_rad was",
        "free-tumble exact 60 Hz: evaluations were",
        "digests.csv: 1 difference",
        "was 0123456789abcdef, is",
        "box_report bless",
    ] {
        assert!(ran.err.contains(words), "{words}: {}", ran.err);
    }
    let printed = run("bless --without-game --root {}", &[copy.path()])
        .ok()
        .out;
    assert!(
        printed.contains("was 0123456789abcdef, is")
            && printed.contains("docs/integrators.md: unchanged"),
        "{printed}"
    );
    let sorted = |text: &str| {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines.sort();
        lines
    };
    assert_eq!(sorted(&read(&digests)), sorted(&right));
    run("check --root {}", &[copy.path()]).ok();
}
