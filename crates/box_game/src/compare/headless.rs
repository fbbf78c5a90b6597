//! The comparison without window and GPU: the same scene under every integrator, a table of error and
//! cost, and the whole course as CSV.

use std::io;
use std::path::{Path, PathBuf};

use box_physics::prelude::{ContactSettings, Floor, Integrator};
use box_scenarios::simulate::sanity;
use box_scenarios::{ReferenceSolution, Scenario};

use crate::compare::lane::{Lane, Law};
use crate::compare::sampling;
use crate::compare::track::{ReferenceStep, local_error};
use crate::record::csv_log::{CsvLog, Row};

/// What to compare.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The scene.
    pub scenario: Scenario,
    /// The integrators, in this order.
    pub integrators: Vec<Integrator>,
    /// Step \[s\].
    pub dt: f64,
    /// Substeps per step.
    pub substeps: u32,
    /// Simulated time \[s\]; the scene's own by default.
    pub duration: Option<f64>,
    /// Where the CSV goes.
    pub log: PathBuf,
    /// For the CSV's header.
    pub seed: u64,
}

/// One line of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct IntegratorResult {
    /// The integrator.
    pub integrator: Integrator,
    /// Largest distance from the trusted answer \[m\].
    pub position: Option<f64>,
    /// Largest angle to the trusted attitude \[rad\].
    pub attitude: Option<f64>,
    /// Largest |E − E₀|/|E₀|, where the energy should be constant.
    pub energy: Option<f64>,
    /// Force evaluations per step.
    pub evaluations: f64,
    /// Steps handed to `split`.
    pub fallbacks: u64,
    /// Iterations that ended at their cap.
    pub unconverged: u64,
    /// Time of the diverging step \[s\].
    pub diverged_at: Option<f64>,
    /// Shortest time [ns per body-step].
    pub nanoseconds: f64,
}

/// Runs the comparison and writes the CSV.
///
/// # Errors
/// What the file system says of the CSV, with its path.
pub fn compare(comparison: &Comparison) -> io::Result<Vec<IntegratorResult>> {
    let setup = &comparison.scenario.setup;
    let mut log = CsvLog::create(&comparison.log, comparison.scenario.id, comparison.seed)?;
    let truth = ReferenceSolution::of(setup);
    let costs = costs(comparison, Law::of(setup).floor.as_ref());
    let mut results = Vec::new();
    for (k, &integrator) in comparison.integrators.iter().enumerate() {
        let mut result = run(comparison, integrator, k as u32, &truth, costs[k], &mut log)?;
        result.nanoseconds = costs[k].0;
        results.push(result);
    }
    Ok(results)
}

/// (Minimum, median) of 21 interleaved samples per integrator [ns per body-step].
fn costs(comparison: &Comparison, floor: Option<&Floor>) -> Vec<(f64, f64)> {
    let setup = &comparison.scenario.setup;
    let law = setup.forces.forces(&setup.body);
    let settings = ContactSettings::default();
    let h = comparison.dt / f64::from(comparison.substeps);
    let boxes = [setup.body; 64];
    let states = [setup.initial; 64];
    let mut samples = vec![Vec::new(); comparison.integrators.len()];
    for round in 0..22 {
        for (k, &integrator) in comparison.integrators.iter().enumerate() {
            let floor = floor.map(|f| (f, &settings));
            let sample = sampling::measure(integrator, boxes.iter().zip(&states), &law, floor, h);
            // The first round warms up.
            if let (Some(sample), true) = (sample, round > 0) {
                samples[k].push(sample.nanoseconds);
            }
        }
    }
    samples
        .into_iter()
        .map(|mut s| {
            s.sort_by(f64::total_cmp);
            (s[0], s[s.len() / 2])
        })
        .collect()
}

fn run(
    comparison: &Comparison,
    integrator: Integrator,
    number: u32,
    truth: &ReferenceSolution,
    (ns_min, ns_median): (f64, f64),
    log: &mut CsvLog,
) -> io::Result<IntegratorResult> {
    let setup = &comparison.scenario.setup;
    let substeps = comparison.substeps.max(1);
    let duration = comparison.duration.unwrap_or(setup.duration);
    let steps = (duration / comparison.dt).round().max(1.0) as u64;
    let h = comparison.dt / f64::from(substeps);
    let times = (0..=steps).map(|n| n as f64 * comparison.dt);
    let trusted: Vec<_> = times.map(|t| truth.at(t)).collect();
    let limits = sanity(setup, trusted.iter().flatten());
    let conserves = setup.conserves_energy();
    let turns_freely = setup.conserves_angular_momentum();
    let e0 = setup.energy(&setup.initial);
    let scale = if e0 != 0.0 {
        e0.abs()
    } else {
        setup.initial.kinetic_energy(&setup.body)
    };
    let law = Law::of(setup);
    let mut lane = Lane::new(setup.initial, integrator);
    let mut impulses = setup.impulses.iter().peekable();
    let mut diverged_at = None;
    let (mut position, mut attitude, mut energy) = (None, None, None);
    let worst = |now: &mut Option<f64>, x: f64| *now = Some(now.unwrap_or(0.0).max(x));
    for n in 0..=steps {
        let before = lane.outcome.evaluations;
        if n > 0 && diverged_at.is_none() {
            let sound = (0..substeps).all(|part| {
                let t = (n - 1) as f64 * comparison.dt + f64::from(part) * h;
                while let Some(i) = impulses.next_if(|i| i.t <= t + 1e-9 * h) {
                    lane.state
                        .apply_impulse_at_body_point(&law.body, i.impulse, i.body_point);
                }
                lane.step(&law, h).sound
            });
            if !sound || limits.is_diverged(&lane.state) {
                diverged_at = Some(n as f64 * comparison.dt);
            }
        }
        // Time is n·dt, not a sum.
        let t = n as f64 * comparison.dt;
        let reference = trusted[n as usize];
        // Of a step with an impulse inside it the reference's beginning is not known.
        let from = n.checked_sub(1).and_then(|k| trusted[k as usize]);
        let local = match (from, reference) {
            (Some(from), Some(to)) if setup.impulses.is_empty() && substeps == 1 => Some(
                local_error(integrator, &law, &ReferenceStep { from, to }, h),
            ),
            _ => None,
        };
        let e = setup.energy(&lane.state);
        let distance = reference.map(|r| (lane.state.position - r.position).length());
        let angle = reference.map(|r| lane.state.attitude_difference(&r));
        let drift = conserves.then(|| (e - e0) / scale);
        distance.iter().for_each(|&x| worst(&mut position, x));
        angle.iter().for_each(|&x| worst(&mut attitude, x));
        drift.iter().for_each(|&x| worst(&mut energy, x.abs()));
        log.write(&Row {
            run_id: format!("{}-{}", comparison.scenario.id, comparison.seed),
            frame: n,
            sim_t_s: t,
            lane: number,
            integrator: integrator.id().to_owned(),
            dt_s: comparison.dt,
            substeps,
            rhs_evals: lane.outcome.evaluations - before,
            step_ns_min: Some(ns_min),
            step_ns_med: Some(ns_median),
            pos_err_m: distance,
            rot_err_deg: angle.map(f64::to_degrees),
            local_pos_err_m: local.map(|e| e.position),
            energy_j: e,
            energy_rel: drift,
            angmom_rel: turns_freely.then(|| setup.angular_momentum_error(&lane.state)),
            state: if diverged_at.is_some() {
                "diverged"
            } else {
                "ok"
            }
            .to_owned(),
            ..Row::default()
        })?;
        if diverged_at.is_some() {
            break;
        }
    }
    // What a diverged run reached says nothing.
    let known = |x: Option<f64>| x.filter(|_| diverged_at.is_none());
    Ok(IntegratorResult {
        integrator,
        position: known(position),
        attitude: known(attitude),
        energy: known(energy),
        fallbacks: lane.outcome.fallbacks,
        unconverged: lane.outcome.unconverged,
        evaluations: lane.outcome.evaluations as f64 / lane.steps.max(1) as f64,
        diverged_at,
        nanoseconds: ns_min,
    })
}

/// The table, and in words what it says.
pub fn report(comparison: &Comparison, results: &[IntegratorResult]) -> String {
    let setup = &comparison.scenario.setup;
    let duration = comparison.duration.unwrap_or(setup.duration);
    let mut text = format!(
        "{}: {} s in steps of {:.5} s{}; largest errors against {}\n\n{:<21}{:>14}{:>14}{:>13}{:>12}{:>14}  {}\n",
        comparison.scenario.title,
        duration,
        comparison.dt,
        if comparison.substeps > 1 {
            format!(" ({} substeps)", comparison.substeps)
        } else {
            String::new()
        },
        ReferenceSolution::of(setup).description(),
        "integrator",
        "position [m]",
        "attitude [°]",
        "energy [1]",
        "evals/step",
        "ns/body-step",
        "state",
    );
    let figure = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.1e}"));
    for r in results {
        let state = match r.diverged_at {
            Some(t) => format!("DIVERGED @ t = {t:.2} s"),
            None => {
                let mut state = "ok".to_owned();
                for (count, what) in [(r.fallbacks, "fallbacks"), (r.unconverged, "not converged")]
                {
                    if count > 0 {
                        state += &format!(", {count} {what}");
                    }
                }
                state
            }
        };
        text += &format!(
            "{:<21}{:>14}{:>14}{:>13}{:>12.1}{:>14.1}  {}\n",
            r.integrator.id(),
            figure(r.position),
            figure(r.attitude.map(f64::to_degrees)),
            figure(r.energy),
            r.evaluations,
            r.nanoseconds,
            state
        );
    }
    text += &verdict(results);
    text
}

/// The default against what most engines do, in words.
fn verdict(results: &[IntegratorResult]) -> String {
    let find = |i| results.iter().find(|r| r.integrator == i);
    let (Some(ours), Some(usual)) = (find(Integrator::Split), find(Integrator::SemiImplicitEuler))
    else {
        return String::new();
    };
    let ratio = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) if a > 0.0 && b > 0.0 => Some(b / a),
        _ => None,
    };
    let cost = ours.nanoseconds / usual.nanoseconds;
    match ratio(ours.attitude, usual.attitude) {
        Some(better) => format!(
            "\nsplit: {better:.0}× smaller attitude error than semi-implicit-euler at {cost:.1}× its cost.\n"
        ),
        None => String::new(),
    }
}

/// Where the CSV goes if nobody said.
pub fn default_log() -> &'static Path {
    Path::new("comparison.csv")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison(folder: &Path) -> Comparison {
        Comparison {
            scenario: Scenario::find("throw").expect("a scene"),
            integrators: Integrator::ALL.to_vec(),
            dt: 1.0 / 60.0,
            substeps: 1,
            duration: None,
            log: folder.join("a.csv"),
            seed: 1,
        }
    }

    #[test]
    fn split_is_a_hundred_times_better_than_semi_implicit_euler() {
        let folder = tempfile::tempdir().expect("a folder");
        let comparison = comparison(folder.path());
        let results = compare(&comparison).expect("writable");
        let of = |i: Integrator| &results[i.index()];
        let (ours, usual) = (of(Integrator::Split), of(Integrator::SemiImplicitEuler));
        for (a, b) in [
            (ours.position, usual.position),
            (ours.attitude, usual.attitude),
            (ours.energy, usual.energy),
        ] {
            let (a, b) = (a.expect("known"), b.expect("known"));
            assert!(a * 100.0 <= b, "{a:e} against {b:e}");
        }
        let text = report(&comparison, &results);
        for i in Integrator::ALL {
            assert!(text.contains(i.id()));
        }
        assert!(text.contains("× smaller attitude error"));
    }

    #[test]
    fn two_runs_differ_in_timing_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let read = |name: &str| {
            let mut c = comparison(folder.path());
            c.duration = Some(0.5);
            c.log = folder.path().join(name);
            compare(&c).expect("writable");
            let mut reader = csv::ReaderBuilder::new()
                .comment(Some(b'#'))
                .from_path(&c.log)
                .expect("readable");
            reader
                .records()
                .map(|r| {
                    let r = r.expect("a row");
                    // Columns 9 and 10 are times.
                    r.iter()
                        .enumerate()
                        .filter(|(k, _)| ![9, 10].contains(k))
                        .map(|(_, f)| f.to_owned())
                        .collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        };
        let (a, b) = (read("1.csv"), read("2.csv"));
        assert_eq!(a, b);
        assert_eq!(a.len(), 31 * Integrator::ALL.len());
    }

    #[test]
    fn a_diverging_integrator_is_said_and_the_others_go_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut c = comparison(folder.path());
        c.scenario = Scenario::find("stiff-drag").expect("a scene");
        c.dt = 0.1;
        c.duration = Some(60.0);
        let results = compare(&c).expect("writable");
        assert!(
            results[Integrator::ExplicitEuler.index()]
                .diverged_at
                .is_some()
        );
        assert!(results[Integrator::Split.index()].diverged_at.is_none());
        assert!(report(&c, &results).contains("DIVERGED"));
    }
}
