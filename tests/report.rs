//! The program `box_report` from a user's view: its outputs, its errors, and the files that an interruption
//! leaves.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use box_physics::digest::fingerprint;
use box_physics::integrators::{Integrator, Limit};

mod program;
#[path = "report/stored.rs"]
mod stored;

use program::{command, run};

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
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

/// A quick run of one part under these integrators into a new folder.
fn quick(part: &str, integrators: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let line = format!("{part} --quick --integrators {integrators} --output {{}}");
    run(&line, &[folder.path()]).ok();
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
    run("--quick --output {} --docs {}", &[&report, &docs]).ok();
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
        let rows = rows(&report.join(format!("{table}.csv")));
        assert!(!rows.is_empty(), "{table}");
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
        let code = format!("<code>{integrator}</code>");
        assert!(html.contains(&code), "{integrator}");
        let row = format!("| `{integrator}` | `{:016x}` |", fingerprint(*integrator));
        assert!(page.contains(&row), "{row}");
    }
    // The one-minute page: two tables, two sentences and the source of the numbers; its figures exist and are small.
    let digest = read(&docs.join("results.md"));
    for part in [
        "| `split` (the default) |",
        "| `exact` (closed form) |",
        "| `rk4` (the baseline) |",
        "| `engine-rescaled` / `engine-newton` (",
        "| `heun-2012` (2012 dissertation) |",
        "At 30 · 60 · 120 Hz: scenes out of 13",
        "At 60 Hz, use `",
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
    let integrators = "split,symmetric-top,split4,rk4,explicit-euler,exact";
    let folder = quick("work-precision", integrators);
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
    let folder = quick("work-precision", "semi-implicit-euler,split");
    let rows = rows(&folder.path().join("work-precision.csv"));
    // At 30 and 60 Hz, the explicit gyroscopic term diverges for the needle.
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
    let folder = quick("stability", "split,rk4,backward-euler,heun-2012");
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
    let shown = below_a_file.to_str().expect("text");
    for (line, words) in [
        (
            "timing --integrators split,leapfrog",
            &["leapfrog", "heun-2012"][..],
        ),
        ("simulate moon", &["moon", "dzhanibekov", "corner-drop"]),
        (
            "simulate bounce --integrator leapfrog",
            &["leapfrog", "split"],
        ),
        ("simulate bounce --dt fast", &["fast", "60hz"]),
        ("simulate bounce --duration -1", &["-1"]),
        ("simulate bounce -o {}", &[shown]),
        ("--quick --output {}", &[shown]),
        ("timing --quick --output {}", &[shown]),
        ("check --root {}", &[shown]),
        ("everything", &["everything", "work-precision", "stability"]),
    ] {
        let ran = run(line, &[&below_a_file]);
        assert_eq!(ran.code, Some(2), "{line}: {}", ran.err);
        for word in words {
            assert!(ran.err.contains(word), "{line}: {}", ran.err);
        }
    }
}

#[test]
fn a_trajectory_as_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("orbit.csv");
    let oracle = root().join("tests/oracle/pub01_free_asymmetric.json");
    for scene in [Path::new("dzhanibekov"), &oracle, Path::new("free-tumble")] {
        let line = "simulate {} --integrator exact --dt 60hz --duration 2 -o {}";
        let ran = run(line, &[scene, &file]).ok();
        assert!(ran.out.is_empty());
        let rows = rows(&file);
        assert_eq!(rows.len(), 121, "{scene:?}");
        for (k, row) in rows.iter().enumerate() {
            let t = number(row, "t_s").expect("a time");
            assert!((t - k as f64 / 60.0).abs() < 1e-12);
            let error = number(row, "attitude_error_rad").expect("free motion is known");
            assert!(error < 1e-9, "{scene:?} at {t}: {error:e}");
        }
    }
    let table = run("simulate contact --duration 0.5", &[]).ok().out;
    assert_eq!(table.lines().count(), 32);
    let scene = root().join("assets/scenes/example.ron");
    let own = run("simulate {} --duration 0.5", &[&scene]).ok().out;
    assert_eq!(own.lines().count(), 32);
    // A corner drop with friction has no reference.
    assert!(table.lines().nth(1).is_some_and(|l| l.ends_with(",,")));
}

/// Ctrl-C during the run: the first part is written and shown, the others are listed as not reached.
#[cfg(unix)]
#[test]
fn an_interruption_leaves_finished_parts() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    let mut child = command("--quick --output {}", &[path])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // The efficiency table is written as soon as the first measurement is complete.
    let first = path.join("efficiency.csv");
    let patience = Instant::now();
    while !first.is_file() && patience.elapsed() < Duration::from_secs(240) {
        let running = child.try_wait().expect("a child").is_none();
        assert!(running, "it ended too early");
        std::thread::sleep(Duration::from_millis(2));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill is there").success());
    let o = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&o.stderr);
    assert_eq!(o.status.code(), Some(130), "{said}");
    assert!(said.contains("interrupted"));
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
