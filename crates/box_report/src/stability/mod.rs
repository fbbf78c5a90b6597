//! `stability`: the results of all integrators in every hard case, and the largest stable steps compared with theory.

pub(crate) mod limits;

use box_physics::integrators::{Integrator, Limit};
use box_scenarios::contact_cases;
use box_scenarios::hard_cases::{Check, Finding, Verdict, hard_cases};
use serde::Serialize;

use crate::context::{Context, Stop};
use crate::document::{Section, Table};
use crate::{files, text};
use limits::Number;

/// A hard case, of free motion or of contact.
struct Case {
    number: u8,
    id: String,
    title: &'static str,
    examine: Box<dyn Fn(Integrator) -> Vec<Finding>>,
}

/// All measurements of this part.
pub(crate) struct StabilityData {
    cases: Vec<(Case, Vec<(Integrator, Vec<Finding>)>)>,
    limits: Vec<(Integrator, [Limit; 4])>,
}

impl StabilityData {
    /// The largest stable steps of `integrator`, in the order of [`Number::ALL`].
    pub(crate) fn limits(&self, integrator: Integrator) -> Option<&[Limit; 4]> {
        let found = self.limits.iter().find(|(s, _)| *s == integrator);
        found.map(|(_, l)| l)
    }

    /// Number of cases in which the worst verdict on `integrator` is ok, degraded and diverged.
    pub(crate) fn score(&self, integrator: Integrator) -> [usize; 3] {
        let mut score = [0; 3];
        for (_, findings) in &self.cases {
            if let Some((_, f)) = findings.iter().find(|(s, _)| *s == integrator) {
                score[worst(f).0 as usize] += 1;
            }
        }
        score
    }
}

#[derive(Serialize)]
struct CaseRow {
    number: u8,
    case: String,
    integrator: &'static str,
    dt_s: f64,
    quantity: &'static str,
    value: f64,
    ok_up_to: f64,
    verdict: String,
}

#[derive(Serialize)]
struct LimitRow {
    integrator: &'static str,
    number: &'static str,
    measured: String,
    theory: String,
    agrees: bool,
}

/// Progress ticks of [`measure`].
pub(crate) fn ticks(quick: bool) -> u64 {
    cases(quick).len() as u64 + 1
}

/// All cases; if `quick`, without those of a million steps and of thousands of drops.
fn cases(quick: bool) -> Vec<Case> {
    let free = hard_cases()
        .into_iter()
        .filter(|c| !(quick && matches!(c.check, Check::Trend { .. })))
        .map(|c| Case {
            number: c.number,
            id: c.id.to_owned(),
            title: c.title,
            examine: Box::new(move |s| c.examine(s)),
        });
    let contact = contact_cases()
        .into_iter()
        .enumerate()
        .filter(|_| !quick)
        .map(|(k, c)| Case {
            number: c.number,
            id: format!("contact-{}", k + 1),
            title: c.title,
            examine: Box::new(move |s| vec![c.examine(s)]),
        });
    free.chain(contact).collect()
}

/// Runs every case and finds every limit.
pub(crate) fn measure(ctx: &Context) -> Result<StabilityData, Stop> {
    let mut examined = Vec::new();
    for case in cases(ctx.quick) {
        let findings = |&s: &Integrator| (s, (case.examine)(s));
        let findings = ctx.integrators.iter().map(findings).collect();
        ctx.tick(case.title)?;
        examined.push((case, findings));
    }
    let limits = ctx
        .integrators
        .iter()
        .map(|&s| (s, Number::ALL.map(|n| limits::measured(s, n))))
        .collect();
    ctx.tick("largest stable steps")?;
    Ok(StabilityData {
        cases: examined,
        limits,
    })
}

/// The worst verdict over all steps, with its finding.
fn worst(findings: &[Finding]) -> (Verdict, &Finding) {
    findings
        .iter()
        .map(|f| (f.verdict(), f))
        .max_by(|a, b| {
            let excess = |f: &Finding| f.value / f.bound.max(f64::MIN_POSITIVE);
            a.0.cmp(&b.0).then(excess(a.1).total_cmp(&excess(b.1)))
        })
        .expect("every case has at least one step: a test of the list says so")
}

/// Writes the CSV files and creates the tables.
pub(crate) fn section(ctx: &Context, data: &StabilityData) -> Result<Section, Stop> {
    let mut section = Section::new(
        "stability",
        "Stability",
        "Motions that are known to break integrators, under every integrator, at 60, 120 and 240 Hz or at the \
         step sizes that the case tests. The worst step size counts. **ok**: within the bound that a good second-order \
         integrator reaches, or rounding where exactness is possible; **degraded**: wrong but bounded; **diverged**: not finite or \
         outside any plausible range.",
    );
    section.tables.push(limit_table(ctx, data)?);
    section.tables.push(case_table(ctx, data)?);
    let mut clean: Vec<String> = Vec::new();
    let mut scores = Vec::new();
    for &s in &ctx.integrators {
        let [ok, degraded, diverged] = data.score(s);
        if degraded + diverged == 0 {
            clean.push(text::code(s));
        }
        scores.push(format!("`{s}` {ok}/{degraded}/{diverged}"));
    }
    let disagree: Vec<String> = data
        .limits
        .iter()
        .flat_map(|(s, l)| {
            Number::ALL
                .iter()
                .zip(l)
                .filter(|(n, l)| !limits::agree(**n, **l, n.theory(*s)))
                .map(move |(n, l)| {
                    let (found, theory) = (shown(*l), n.theory(*s));
                    format!("`{s}` {} {found} (theory {theory})", n.name())
                })
        })
        .collect();
    section.verdicts = vec![
        format!(
            "Ok in all {} cases: {}.",
            data.cases.len(),
            text::list(&clean)
        ),
        format!("Ok/degraded/diverged: {}.", scores.join(", ")),
        if disagree.is_empty() {
            "Every measured limit agrees with theory to 3 % (spin: at least the guaranteed limit)."
                .to_owned()
        } else {
            format!("Limits that differ from theory: {}.", disagree.join("; "))
        },
    ];
    Ok(section)
}

fn limit_table(ctx: &Context, data: &StabilityData) -> Result<Table, Stop> {
    let mut rows = Vec::new();
    let mut cells = Vec::new();
    for (s, limits) in &data.limits {
        let mut line = vec![text::code(s)];
        for (n, &measured) in Number::ALL.iter().zip(limits) {
            let theory = n.theory(*s);
            let agrees = limits::agree(*n, measured, theory);
            line.push(if agrees {
                shown(measured)
            } else {
                format!("{} (theory: {theory})", shown(measured))
            });
            rows.push(LimitRow {
                integrator: s.id(),
                number: n.name(),
                measured: shown(measured),
                theory: theory.to_string(),
                agrees,
            });
        }
        cells.push(line);
    }
    files::write_csv(&ctx.file("limits.csv"), &rows)?;
    Ok(Table {
        title: "Largest stable steps".to_owned(),
        note: "Tried from 0.1 to 1000. Spin: |L| of a tumbling box, plate and needle, and of a blade spun near its intermediate axis, \
               does not grow in 1000 steps; the worst body counts, and theory guarantees a limit for every body. Drag, damper and undamped \
               spring: no eigenvalue of the step matrix lies outside the unit circle (resolution 0.05 %). If theory differs, its limit is added."
            .to_owned(),
        columns: text::columns(
            "integrator | spin |ω|·dt | drag c·dt/m | damper d·dt/m | spring √(k/m)·dt",
        ),
        rows: cells,
        csv: "limits.csv".to_owned(),
    })
}

/// A measured limit with three digits.
pub(crate) fn shown(limit: Limit) -> String {
    match limit {
        Limit::Below(x) => format!("≤ {}", text::significant(x, 3)),
        other => other.to_string(),
    }
}

fn case_table(ctx: &Context, data: &StabilityData) -> Result<Table, Stop> {
    let mut rows = Vec::new();
    let mut cells = Vec::new();
    for (case, findings) in &data.cases {
        let quantity = findings
            .first()
            .and_then(|(_, f)| f.first())
            .map_or("", |f| f.quantity);
        let mut line = vec![format!("{} {}: {quantity}", case.number, case.title)];
        for (s, findings) in findings {
            let (verdict, f) = worst(findings);
            line.push(match verdict {
                Verdict::Ok => format!("ok {}", text::error(f.value)),
                Verdict::Degraded => format!("**degraded** {}", text::error(f.value)),
                Verdict::Diverged => "**diverged**".to_owned(),
            });
            rows.extend(findings.iter().map(|f| CaseRow {
                number: case.number,
                case: case.id.clone(),
                integrator: s.id(),
                dt_s: f.h,
                quantity: f.quantity,
                value: f.value,
                ok_up_to: f.bound,
                verdict: f.verdict().to_string(),
            }));
        }
        cells.push(line);
    }
    files::write_csv(&ctx.file("stability.csv"), &rows)?;
    let mut columns = vec!["case: measured quantity".to_owned()];
    columns.extend(ctx.integrators.iter().map(text::code));
    Ok(Table {
        title: "Hard cases".to_owned(),
        note: "The worst step size; the file lists all of them with their bounds.".to_owned(),
        columns,
        rows: cells,
        csv: "stability.csv".to_owned(),
    })
}
