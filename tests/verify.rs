//! The command `box_report verify` from a user's view.

use std::path::{Path, PathBuf};

use box_physics::integrators::Integrator;

mod program;

use program::{Ran, run};

fn oracle() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/oracle")
}

fn verify(folder: &Path, line: &str) -> Ran {
    run(&format!("verify {{}} {line}"), &[folder])
}

const HEADER: &str = "case,kind,integrator,dt_s,position_error_m,velocity_error_m_s,attitude_error_rad,angular_momentum_error_rel,energy_error_rel,steps,evaluations,fallbacks,ns_per_step,status";

#[test]
fn csv_has_exactly_these_columns_and_all_rows() {
    let text = verify(&oracle(), "--format csv --case pub0*").ok().out;
    assert_eq!(text.lines().next(), Some(HEADER));
    // Nine cases, every integrator, three steps.
    assert_eq!(text.lines().count(), 1 + 9 * Integrator::ALL.len() * 3);
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    for row in rows.records() {
        let row = row.expect("fourteen fields");
        assert!(row[2].parse::<Integrator>().is_ok());
        for k in [3, 4, 5, 6, 7, 12] {
            let x: f64 = row[k].parse().expect("a number");
            assert!(x >= 0.0, "{row:?}");
        }
        assert!(row[9].parse::<u64>().is_ok_and(|n| n > 0));
        assert!(
            row[13].starts_with("lost (") || matches!(&row[13], "ok" | "diverged"),
            "{row:?}"
        );
    }
}

#[test]
fn one_case_one_integrator_one_step_in_every_spelling() {
    for dt in ["60hz", "1/60", "0.016666666666666666"] {
        let line = format!("--integrator split --dt {dt} --case pub01* --format csv");
        let text = verify(&oracle(), &line).ok().out;
        let row: Vec<&str> = text.lines().nth(1).expect("one row").split(',').collect();
        assert_eq!(
            row[..4],
            [
                "pub01_free_asymmetric",
                "free",
                "split",
                "0.016666666666666666"
            ]
        );
        assert_eq!(row[9], "600");
        assert!(row[6].parse::<f64>().is_ok_and(|e| e < 1e-3));
        assert_eq!(text.lines().count(), 2);
    }
}

#[test]
fn the_table_is_aligned() {
    let line = "--integrator split,rk4 --dt 60hz,240hz --case pub01*";
    let text = verify(&oracle(), line).ok().out;
    let lines: Vec<&str> = text.lines().filter(|l| l.starts_with("  ")).collect();
    assert_eq!(lines.len(), 5);
    let column = lines[0].find("status").expect("a heading");
    assert!(
        lines[1..].iter().all(|l| l[column..].starts_with("ok")),
        "{text}"
    );
}

#[test]
fn wrong_usage_exits_with_2_and_lists_what_is_allowed() {
    for (line, words) in [
        (
            "--integrator split,leapfrog",
            &["leapfrog", "split", "explicit-euler"][..],
        ),
        ("--dt fast", &["fast", "60hz", "1/60"]),
        ("--dt 0", &["positive"]),
        ("--case nothing*", &["nothing*", "pub01_free_asymmetric"]),
        ("--format xml", &["xml", "table", "csv"]),
    ] {
        let ran = verify(&oracle(), line);
        assert_eq!(ran.code, Some(2), "{line}");
        for word in words {
            assert!(ran.err.contains(word), "{line}: {}", ran.err);
        }
        assert!(ran.out.is_empty());
    }
    let empty = tempfile::tempdir().expect("a folder");
    assert_eq!(verify(empty.path(), "").code, Some(2));
    assert_eq!(verify(&empty.path().join("none"), "").code, Some(2));
}

#[test]
fn a_bad_file_exits_with_1_and_the_others_still_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = std::fs::read_to_string(oracle().join("pub01_free_asymmetric.json")).expect("there");
    let write =
        |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("good.json", &good);
    write("notes.txt", "not a case");
    write(
        "unknown.json",
        &good.replacen("\"linear_drag_c\"", "\"wind\"", 1),
    );
    write("broken.json", "{");
    write("mass.json", &good.replacen("\"mass\":", "\"mass\":-", 1));
    let Ran { code, out, err } = verify(folder.path(), "--integrator split --dt 60hz --format csv");
    assert_eq!(code, Some(1));
    assert_eq!(out.lines().count(), 2, "{out}");
    for words in [
        ["unknown.json", "forces.wind"],
        ["broken.json", "JSON"],
        ["mass.json", "body.mass"],
    ] {
        let line = err.lines().find(|l| l.contains(words[0]));
        let line = line.expect(words[0]);
        assert!(line.contains(words[1]), "{line}");
    }
    assert!(!err.contains("notes"));
}
