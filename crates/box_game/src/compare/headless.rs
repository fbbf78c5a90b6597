//! The comparison without window and GPU: the same scene under every integrator, a table of error and cost, and the
//! time series as CSV.

use std::io;
use std::path::PathBuf;

use box_bench::measure::{Cost, Settings};
use box_bench::snapshot::Snapshot;
use box_physics::prelude::Integrator;
use box_scenarios::{ComparisonResult, Scenario};

use super::sampling::{measure_grain, shortest_sample};
use super::verdict::short;
use crate::record::csv_log::{CsvLog, Row};

/// Maximum number of CSV rows per integrator; a longer run is thinned to every `every`-th step.
const MAX_ROWS: u64 = 100_000;

/// Options of a comparison without a window.
#[derive(Clone, Debug)]
pub struct Headless {
    /// The scene; the run has the duration of its setup.
    pub scenario: Scenario,
    /// The integrators, in this order.
    pub integrators: Vec<Integrator>,
    /// Step \[s\].
    pub dt: f64,
    /// Substeps per step.
    pub substeps: u32,
    /// Path of the CSV file.
    pub log: PathBuf,
    /// Seed, for the header of the CSV file.
    pub seed: u64,
}

/// Result of a comparison without a window.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Errors and states.
    pub result: ComparisonResult,
    /// Cost [ns per body-step] in the order of the integrators.
    pub costs: Vec<Cost>,
    /// Steps between two rows of the CSV.
    pub every: u64,
}

impl Headless {
    /// Runs the comparison and writes the CSV. The required memory does not depend on the duration.
    ///
    /// # Errors
    /// An I/O error of the CSV file, with its path.
    pub fn run(&self) -> io::Result<Table> {
        let comparison = box_scenarios::IntegratorComparison {
            setup: self.scenario.setup.clone(),
            integrators: self.integrators.clone(),
            dt: self.dt,
            substeps: self.substeps,
        };
        let mut log = CsvLog::create(&self.log, self.scenario.id, self.seed)?;
        let costs = self.costs();
        let run_id = format!("{}-{}", self.scenario.id, self.seed);
        let last = comparison.steps();
        let every = last.div_ceil(MAX_ROWS).max(1);
        let result = comparison.run(|now| {
            let due = now.step.is_multiple_of(every) || now.step == last;
            if !due && !now.status.is_diverged() {
                return Ok(());
            }
            log.write(&Row {
                run_id: run_id.clone(),
                frame: now.step,
                sim_t_s: now.t,
                trajectory: now.number as u32,
                integrator: now.integrator.id().to_owned(),
                dt_s: self.dt,
                substeps: self.substeps,
                rhs_evals: now.evaluations,
                step_ns_min: Some(costs[now.number].min),
                step_ns_med: Some(costs[now.number].median),
                pos_err_m: now.error.map(|e| e.position),
                rot_err_deg: now.error.map(|e| e.attitude.to_degrees()),
                local_pos_err_m: now.local.map(|e| e.position),
                energy_j: now.energy,
                energy_rel: Some(now.residual.energy),
                angmom_rel: Some(now.residual.vector),
                contacts: now.contacts,
                state: now.status,
                ..Row::default()
            })
        })?;
        log.sync()?;
        Ok(Table {
            result,
            costs,
            every,
        })
    }

    /// Measures the cost of a step of the scene's boxes over its duration; see [`Snapshot`].
    pub fn costs(&self) -> Vec<Cost> {
        let boxes = self.scenario.boxes as usize;
        let h = self.dt / f64::from(self.substeps.max(1));
        let settings = Settings {
            shortest_sample: shortest_sample(measure_grain()),
            ..Settings::default()
        };
        Snapshot::of_scene(&self.scenario.setup, boxes, h)
            .map(|snapshot| snapshot.costs(&self.integrators, &settings))
            .unwrap_or_default()
    }

    /// Formats the table, with a summary in words.
    pub fn report(&self, table: &Table) -> String {
        let result = &table.result;
        let u = result.uncertainty;
        let substeps = match self.substeps {
            0 | 1 => String::new(),
            n => format!(" ({n} substeps)"),
        };
        let mut text = format!(
            "{}: {} s in steps of {:.5} s{substeps}; largest errors; reference: {}\n",
            self.scenario.title, self.scenario.setup.duration, self.dt, result.reference,
        );
        if u.position > 0.0 || u.attitude > 0.0 {
            let (position, attitude) = (u.position, u.attitude.to_degrees());
            text += &format!("reference accurate to {position:.1e} m and {attitude:.1e}°\n");
        }
        if let Some(end) = result.horizon {
            text += &format!(
                "errors up to {end:.2} s; after that, the motion is chaotic and the reference changes when its step is halved\n"
            );
        }
        text += &format!(
            "\n{:<21}{:>14}{:>14}{:>13}{:>13}{:>12}{:>14}  state\n",
            "integrator",
            "position [m]",
            "attitude [°]",
            "energy [1]",
            "ang.mom. [1]",
            "evals/step",
            "min ns/step",
        );
        let figure = |x: Option<f64>, least: f64| match x {
            None => "-".to_owned(),
            Some(x) if x < least => format!("<{least:.1e}"),
            Some(x) => format!("{x:.1e}"),
        };
        for (r, cost) in result.integrators.iter().zip(&table.costs) {
            let mut state = r.status.to_string();
            let counts = [r.totals.fallbacks, r.totals.unconverged];
            for (count, what) in counts.into_iter().zip(["fallbacks", "not converged"]) {
                if count > 0 {
                    state += &format!(", {count} {what}");
                }
            }
            text += &format!(
                "{:<21}{:>14}{:>14}{:>13}{:>13}{:>12.1}{:>14.1}  {state}\n",
                r.integrator.id(),
                figure(r.position, u.position),
                figure(r.attitude.map(f64::to_degrees), u.attitude.to_degrees()),
                figure(r.energy, 0.0),
                figure(r.momentum, 0.0),
                r.totals.evaluations as f64 / r.totals.steps.max(1) as f64,
                cost.min,
            );
        }
        text + &verdict(table)
    }
}

/// Compares the default integrator with that of most engines, in words.
fn verdict(table: &Table) -> String {
    let find = |i| {
        let results = table.result.integrators.iter();
        results.zip(&table.costs).find(|(r, _)| r.integrator == i)
    };
    let (Some((ours, cost)), Some((usual, usual_cost))) =
        (find(Integrator::Split), find(Integrator::SemiImplicitEuler))
    else {
        return String::new();
    };
    let least = table.result.uncertainty.attitude;
    match (ours.attitude, usual.attitude) {
        (Some(a), Some(b)) if a > least && b > least => format!(
            "\nsplit: {}× smaller attitude error than semi-implicit-euler at {}× its cost.\n",
            short(b / a),
            short(cost.min / usual_cost.min)
        ),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the integrators in a scene, with options modified by `change`. Returns the table, its text and the CSV.
    fn table(scene: &str, change: impl FnOnce(&mut Headless)) -> (Table, String, String) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut headless = Headless {
            scenario: Scenario::find(scene).expect("a scene"),
            integrators: Integrator::ALL.to_vec(),
            dt: 1.0 / 60.0,
            substeps: 1,
            log: folder.path().join("a.csv"),
            seed: 1,
        };
        change(&mut headless);
        let table = headless.run().expect("writable");
        let csv = std::fs::read_to_string(&headless.log).expect("readable");
        let text = headless.report(&table);
        (table, text, csv)
    }

    #[test]
    fn split_is_a_hundred_times_better_than_semi_implicit_euler() {
        let (table, text, _) = table("throw", |_| ());
        let of = |i: Integrator| &table.result.integrators[i.index()];
        let (ours, usual) = (of(Integrator::Split), of(Integrator::SemiImplicitEuler));
        for (a, b) in [
            (ours.position, usual.position),
            (ours.attitude, usual.attitude),
            (ours.energy, usual.energy),
        ] {
            let (a, b) = (a.expect("known"), b.expect("known"));
            assert!(a * 100.0 <= b, "{a:e} against {b:e}");
        }
        for i in Integrator::ALL {
            assert!(text.contains(i.id()));
        }
        assert!(text.contains("× smaller attitude error"));
    }

    #[test]
    fn a_diverging_integrator_is_said_and_the_others_go_on() {
        let (table, text, _) = table("stiff-drag", |c| {
            c.dt = 0.1;
            c.scenario.setup.duration = 60.0;
        });
        let diverged = |i: Integrator| table.result.integrators[i.index()].status.is_diverged();
        assert!(diverged(Integrator::ExplicitEuler) && !diverged(Integrator::Split));
        assert!(text.contains("diverged at t = 0."));
    }

    /// Without a closed form, the table still has every figure, and states the accuracy of the reference.
    #[test]
    fn a_tumbling_contact_has_a_table() {
        let (_, text, _) = table("contact", |_| ());
        assert!(
            text.contains("reference: exact in steps of 1/3840 s"),
            "{text}"
        );
        assert!(text.contains("reference accurate to "), "{text}");
        assert!(!text.contains("diverged"), "{text}");
        let row = text.lines().find(|l| l.starts_with("rk4")).expect("a row");
        assert!(!row.contains(" - ") && row.ends_with("resting"), "{row}");
        assert!(!text.contains("chaotic"), "{text}");
    }

    /// A box that bounces without loss is chaotic. Its errors end with the reference; its energy error does not.
    #[test]
    fn chaos_is_named_and_its_moment() {
        let (table, text, csv) = table("load", |c| {
            let floor = c.scenario.setup.floor.as_mut().expect("a floor");
            (floor.restitution, floor.friction) = (1.0, 0.0);
            c.scenario.setup.duration = 60.0;
            c.integrators = vec![Integrator::Split, Integrator::Exact];
        });
        let end = table.result.horizon.expect("chaos");
        let said = format!("errors up to {end:.2} s; after that, the motion is chaotic");
        assert!(text.contains(&said), "{text}");
        let exact = &table.result.integrators[1];
        assert!(exact.attitude.expect("until then") < 0.1, "{exact:?}");
        assert!(exact.energy.expect("to the end") < 1e-3, "{exact:?}");
        let last = csv.lines().last().expect("rows");
        let cells: Vec<_> = last.split(',').collect();
        assert_eq!((cells[2], cells[11]), ("60.0", ""), "no error at the end");
        assert!(cells[15].parse::<f64>().is_ok());
    }

    /// The file of a long run is thinned, and contains the last step.
    #[test]
    fn a_long_run_has_a_short_file() {
        let (table, _, csv) = table("throw", |c| {
            c.integrators = vec![Integrator::Exact];
            c.scenario.setup.duration = 2.5 * MAX_ROWS as f64 / 60.0;
        });
        assert_eq!(table.every, 3);
        let rows: Vec<_> = csv.lines().filter(|l| l.starts_with("throw-1,")).collect();
        let count = rows.len();
        assert!((80_000..=MAX_ROWS as usize).contains(&count), "{count}");
        assert!(rows[1].starts_with("throw-1,3,"));
        assert!(rows[count - 1].starts_with("throw-1,250000,"));
    }
}
