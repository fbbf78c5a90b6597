//! The program `box_report` from a user's view: its outputs, its errors, and the files that an interruption
//! leaves.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use box_physics::digest::fingerprint;
use box_physics::integrators::{Integrator, Limit};

fn box_report(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_box_report"));
    command.args(arguments);
    command
}

fn run(arguments: &[&str]) -> Output {
    box_report(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The rows of a CSV file, each as a map from column names.
fn rows(path: &Path) -> Vec<HashMap<String, String>> {
    let mut reader =
        csv::Reader::from_path(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    reader.deserialize().map(|r| r.expect("a row")).collect()
}

fn number(row: &HashMap<String, String>, column: &str) -> Option<f64> {
    row[column].parse().ok()
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut files: Vec<PathBuf> = entries
        .map(|e| e.expect("an entry").path())
        .filter(|p| p.extension().is_some_and(|e| e == ending))
        .collect();
    files.sort();
    files
}

/// A quick run of one part into a new folder.
fn quick(part: &str, more: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().to_str().expect("text");
    let mut arguments = vec![part, "--quick", "--output", path];
    arguments.extend(more);
    let o = run(&arguments);
    assert_eq!(o.status.code(), Some(0), "{}", text(&o.stderr));
    folder
}

#[test]
fn a_quick_run_writes_every_page_table_and_figure() {
    let folder = tempfile::tempdir().expect("a folder");
    let (report, docs) = (folder.path().join("report"), folder.path().join("docs"));
    std::fs::create_dir(&docs).expect("a folder");
    let readme = folder.path().join("README.md");
    let (integrators, performance) = (docs.join("integrators.md"), docs.join("performance.md"));
    for (file, name) in [
        (&readme, "results"),
        (&integrators, "errors"),
        (&performance, "integrators"),
    ] {
        let text = format!("before\n<!-- {name} -->\nold\n<!-- /{name} -->\nafter\n");
        std::fs::write(file, text).expect("written");
    }
    let o = run(&[
        "--quick",
        "--output",
        report.to_str().expect("text"),
        "--docs",
        docs.to_str().expect("text"),
    ]);
    assert_eq!(o.status.code(), Some(0), "{}", text(&o.stderr));
    for table in [
        "summary",
        "work-precision",
        "efficiency",
        "frontier",
        "stability",
        "limits",
        "timing",
        "visible",
        "dissertation-cycles",
        "dissertation-answer",
        "determinism",
    ] {
        assert!(
            !rows(&report.join(format!("{table}.csv"))).is_empty(),
            "{table}"
        );
    }
    // Every family by time and by evaluations, plus the additional errors.
    let figures = files(&report, "svg");
    assert!(figures.len() >= 2 * 12 + 5, "{figures:?}");
    let page = read(&report.join("report.md"));
    assert!(!page.contains("Not reached"), "{page}");
    let html = read(&report.join("report.html"));
    for figure in &figures {
        let name = figure.file_name().expect("a name").to_str().expect("text");
        assert!(page.contains(&format!("({name})")), "{name}");
        let svg = read(figure);
        assert!(
            svg.contains("</svg>") && html.contains(svg.trim()),
            "{name}"
        );
    }
    for integrator in Integrator::ALL {
        assert!(
            html.contains(&format!("<code>{integrator}</code>")),
            "{integrator}"
        );
    }
    for integrator in Integrator::ALL {
        let row = format!("| `{integrator}` | `{:016x}` |", fingerprint(*integrator));
        assert!(page.contains(&row), "{row}");
    }
    // The page of one minute: five rows, two sentences, where the numbers come from; its figures there and small.
    let digest = read(&docs.join("results.md"));
    for part in [
        "| `split` (the default) |",
        "| `exact` (closed form) |",
        "| `rk4` (the yardstick) |",
        "| `engine-rescaled` / `engine-newton` (",
        "| `heun-2012` (the dissertation's, 2012) |",
        "At 60 Hz take `",
        "Where `rk4` wins",
        "rustc 1.",
    ] {
        assert!(digest.contains(part), "{part}: {digest}");
    }
    assert!(!digest.contains("Hard cases") && digest.lines().count() < 100);
    let shown = files(&docs.join("results"), "svg");
    assert!(shown.len() >= 5);
    for figure in shown {
        let name = figure.file_name().expect("a name").to_str().expect("text");
        assert!(digest.contains(&format!("(results/{name})")), "{name}");
        let size = std::fs::metadata(&figure).expect("there").len();
        assert!(size < 150_000, "{name}: {size} bytes");
    }
    // README and pages show the costs of the report's table.
    let timing = rows(&report.join("timing.csv"));
    let cost = |integrator: &str, situation: &str| {
        let mut rows = timing.iter();
        let row = rows.find(|r| r["integrator"] == integrator && r["situation"] == situation);
        number(row.expect("measured"), "ns_per_step_min").expect("a number")
    };
    let five = ["split", "exact", "rk4", "heun-2012"].as_slice();
    let all: Vec<&str> = Integrator::ALL.iter().map(|i| i.id()).collect();
    for (file, column, digits, shown) in [
        (&readme, 5, 0.06, five),
        (&integrators, 8, 0.01, all.as_slice()),
        (&performance, 1, 0.01, all.as_slice()),
    ] {
        let page = read(file);
        assert!(page.starts_with("before\n") && page.ends_with("after\n"));
        for &integrator in shown {
            let start = format!("| `{integrator}` ");
            let row = page.lines().find(|l| l.starts_with(&start)).expect("a row");
            let shown = row.split('|').nth(column + 1).expect("a cell").trim();
            let (shown, measured): (f64, f64) =
                (shown.parse().expect("ns"), cost(integrator, "free-many"));
            assert!((shown / measured - 1.0).abs() < digits, "{row}: {measured}");
        }
        assert_eq!(page.matches("cargo box-report --docs docs").count(), 1);
    }
}

#[test]
fn orders_in_the_legend_are_those_the_integrators_claim() {
    let folder = quick(
        "work-precision",
        &[
            "--integrators",
            "split,symmetric-top,split4,rk4,explicit-euler,exact",
        ],
    );
    let svg = |id: &str| read(&folder.path().join(format!("work-precision-{id}.svg")));
    let order = |svg: &str, integrator: &str| -> f64 {
        let from = svg
            .find(&format!("{integrator} (dt^p, p = "))
            .expect(integrator);
        let tail = &svg[from..];
        let at = tail.find("p = ").expect("just found") + 4;
        let end = tail[at..].find(')').expect("closed");
        tail[at..at + end].parse().expect("a number")
    };
    let tumble = svg("free-tumble-attitude");
    for (integrator, p, within) in [
        ("symmetric-top", 2.0, 0.2),
        ("split4", 4.0, 0.3),
        ("rk4", 4.0, 0.3),
    ] {
        let fitted = order(&tumble, integrator);
        assert!((fitted - p).abs() < within, "{integrator}: {fitted}");
    }
    assert!(tumble.contains("exact (rounding)") && tumble.contains("split (rounding)"));
    let drag = svg("linear-drag-position");
    assert!((order(&drag, "explicit-euler") - 1.0).abs() < 0.1);
    assert!((order(&drag, "rk4") - 4.0).abs() < 0.3);
}

#[test]
fn a_failed_run_leaves_a_gap_and_no_cost() {
    let folder = quick(
        "work-precision",
        &["--integrators", "semi-implicit-euler,split"],
    );
    let rows = rows(&folder.path().join("work-precision.csv"));
    // At 30 and 60 Hz the explicit gyroscopic term diverges on the needle.
    let needle = |integrator: &str| -> Vec<_> {
        let wanted =
            |r: &&HashMap<String, String>| r["family"] == "needle" && r["integrator"] == integrator;
        rows.iter().filter(wanted).collect()
    };
    let failed: Vec<_> = needle("semi-implicit-euler")
        .into_iter()
        .filter(|r| r["status"] == "failed")
        .collect();
    assert!(!failed.is_empty());
    for row in failed {
        assert_eq!(number(row, "attitude_error_rad"), None, "{row:?}");
        assert_eq!(number(row, "ns_per_step_min"), None, "{row:?}");
    }
    for row in needle("split") {
        let (low, high) = (
            number(row, "ns_per_step_min"),
            number(row, "ns_per_step_p95"),
        );
        assert!(
            row["status"] == "ok" && low > Some(0.0) && low <= high,
            "{row:?}"
        );
    }
    assert!(read(&folder.path().join("report.md")).contains("failed"));
}

#[test]
fn limits_found_are_those_the_integrators_claim() {
    let folder = quick(
        "stability",
        &["--integrators", "split,rk4,backward-euler,heun-2012"],
    );
    for row in rows(&folder.path().join("limits.csv")) {
        assert_eq!(row["agrees"], "true", "{row:?}");
    }
    let rk4 = Integrator::Rk4.info().stability.drag;
    assert_eq!(rk4, Limit::Below(2.785));
    let cases = rows(&folder.path().join("stability.csv"));
    assert!(
        cases
            .iter()
            .any(|r| r["integrator"] == "rk4" && r["verdict"] == "diverged")
    );
    let split = cases.iter().filter(|r| r["integrator"] == "split");
    assert!(split.clone().count() > 50);
    for row in split {
        assert_eq!(row["verdict"], "ok", "{row:?}");
    }
}

#[test]
fn invalid_usage_exits_with_2_and_lists_what_is_allowed() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("written");
    let below_a_file = file.join("report");
    let below_a_file = below_a_file.to_str().expect("text");
    for (arguments, words) in [
        (
            &["timing", "--integrators", "split,leapfrog"][..],
            &["leapfrog", "heun-2012"][..],
        ),
        (
            &["simulate", "moon"],
            &["moon", "dzhanibekov", "corner-drop"],
        ),
        (
            &["simulate", "bounce", "--integrator", "leapfrog"],
            &["leapfrog", "split"],
        ),
        (&["simulate", "bounce", "--dt", "fast"], &["fast", "60hz"]),
        (&["simulate", "bounce", "--duration", "-1"], &["-1"]),
        (&["simulate", "bounce", "-o", below_a_file], &[below_a_file]),
        (&["--quick", "--output", below_a_file], &[below_a_file]),
        (
            &["timing", "--quick", "--output", below_a_file],
            &[below_a_file],
        ),
        (&["check", "--root", below_a_file], &[below_a_file]),
        (
            &["everything"],
            &["everything", "work-precision", "stability"],
        ),
    ] {
        let o = run(arguments);
        assert_eq!(
            o.status.code(),
            Some(2),
            "{arguments:?}: {}",
            text(&o.stderr)
        );
        for word in words {
            assert!(
                text(&o.stderr).contains(word),
                "{arguments:?}: {}",
                text(&o.stderr)
            );
        }
    }
}

#[test]
fn a_trajectory_as_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("orbit.csv");
    let oracle =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/oracle/pub01_free_asymmetric.json");
    for (scene, steps) in [
        ("dzhanibekov", 120),
        (oracle.to_str().expect("text"), 120),
        ("free-tumble", 120),
    ] {
        let o = run(&[
            "simulate",
            scene,
            "--integrator",
            "exact",
            "--dt",
            "60hz",
            "--duration",
            "2",
            "-o",
            file.to_str().expect("text"),
        ]);
        assert_eq!(o.status.code(), Some(0), "{}", text(&o.stderr));
        assert!(o.stdout.is_empty());
        let rows = rows(&file);
        assert_eq!(rows.len(), steps + 1, "{scene}");
        for (k, row) in rows.iter().enumerate() {
            let t = number(row, "t_s").expect("a time");
            assert!((t - k as f64 / 60.0).abs() < 1e-12);
            let error = number(row, "attitude_error_rad").expect("free motion is known");
            assert!(error < 1e-9, "{scene} at {t}: {error:e}");
        }
    }
    let o = run(&["simulate", "contact", "--duration", "0.5"]);
    let table = text(&o.stdout);
    assert_eq!(table.lines().count(), 32);
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes/example.ron");
    let o = run(&[
        "simulate",
        scene.to_str().expect("text"),
        "--duration",
        "0.5",
    ]);
    assert_eq!(text(&o.stdout).lines().count(), 32, "{}", text(&o.stderr));
    // A corner drop with friction has no reference.
    assert!(table.lines().nth(1).is_some_and(|l| l.ends_with(",,")));
}

/// A repository with only the stored files.
fn stored_files() -> tempfile::TempDir {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let copy = tempfile::tempdir().expect("a folder");
    for file in [
        "tests/expected/digests.csv",
        "tests/expected/report.csv",
        "docs/integrators.md",
        "docs/contact.md",
    ] {
        let to = copy.path().join(file);
        std::fs::create_dir_all(to.parent().expect("a folder")).expect("created");
        std::fs::copy(own.join(file), to).expect(file);
    }
    copy
}

#[test]
fn stored_files_match_the_program() {
    let o = run(&["check"]);
    assert_eq!(o.status.code(), Some(0), "{}", text(&o.stderr));
}

#[test]
fn check_names_a_changed_number_and_bless_stores_it() {
    let copy = stored_files();
    let root = copy.path().to_str().expect("text");
    // The values that bless would have stored for an integrator that is a hundred times less accurate and
    // more expensive, with different digests.
    let errors = copy.path().join("tests/expected/report.csv");
    let before = read(&errors);
    let exact = before
        .lines()
        .find(|l| l.starts_with("free-tumble,exact,60,"))
        .expect("a row");
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
    std::fs::write(
        &digests,
        right.replace(line, &format!("{id},0123456789abcdef")),
    )
    .expect("written");
    let o = run(&["check", "--root", root]);
    assert_eq!(o.status.code(), Some(1));
    let message = text(&o.stderr);
    for words in [
        "report.csv: 2 differences",
        "free-tumble exact 60 Hz: attitude_error_rad was",
        "free-tumble exact 60 Hz: evaluations were",
        "digests.csv: 1 differences",
        "was 0123456789abcdef, is",
        "box_report bless",
    ] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let o = run(&["bless", "--without-game", "--root", root]);
    assert_eq!(o.status.code(), Some(0), "{}", text(&o.stderr));
    let printed = text(&o.stdout);
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
    let o = run(&["check", "--root", root]);
    assert_eq!(o.status.code(), Some(0), "{}", text(&o.stderr));
}

/// Ctrl-C during the run: the first part is written and shown, the others are listed as not reached.
#[cfg(unix)]
#[test]
fn an_interruption_leaves_finished_parts() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let mut child = box_report(&["--quick", "--output", path.to_str().expect("text")])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // The efficiency table is written as soon as the first measurement is complete.
    let first = path.join("efficiency.csv");
    let patience = Instant::now();
    while !first.is_file() && patience.elapsed() < Duration::from_secs(240) {
        assert!(
            child.try_wait().expect("a child").is_none(),
            "it ended too early"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill is there").success());
    let o = child.wait_with_output().expect("it ends");
    assert_eq!(o.status.code(), Some(130), "{}", text(&o.stderr));
    assert!(text(&o.stderr).contains("interrupted"));
    let page = read(&path.join("report.md"));
    assert!(
        page.contains("**Not reached**: ") && page.contains("dissertation"),
        "{page}"
    );
    assert!(page.contains("## Work–precision diagrams"));
    assert!(read(&path.join("report.html")).contains("<strong>Not reached</strong>"));
    assert!(!rows(&path.join("work-precision.csv")).is_empty());
    assert!(!path.join("dissertation-cycles.csv").exists());
}
