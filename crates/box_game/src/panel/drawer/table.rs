//! The figures of every scheme, and what they come to in a sentence.

use bevy_egui::egui::{Grid, Label, RichText, ScrollArea, Ui, vec2};
use box_physics::prelude::Integrator;

use super::super::format::{number, quantity};
use super::super::view::{PanelView, SchemeTiming};
use crate::style;

const HEADINGS: [(&str, &str); 7] = [
    ("scheme", "Mark and name."),
    (
        "min [ns]",
        "Shortest recent sample, ns per body-step: the scheme's own cost.",
    ),
    (
        "median [ns]",
        "Half of the recent samples are shorter, ns per body-step: what a frame feels.",
    ),
    (
        "p95 [ns]",
        "95 % of the recent samples are shorter, ns per body-step.",
    ),
    (
        "evaluations",
        "Force evaluations per body-step, as counted.",
    ),
    (
        "order (rotation)",
        "The error of a free rotation falls with this power of dt.",
    ),
    ("energy", "What becomes of the energy of a free spin."),
];

pub(super) fn show(ui: &mut Ui, view: &PanelView) {
    ui.add(Label::new(RichText::new(verdict(view)).strong()).wrap());
    ScrollArea::both()
        .auto_shrink([false, false])
        .show(ui, |ui| {
            Grid::new("schemes")
                .striped(true)
                .spacing([18.0, 3.0])
                .show(ui, |ui| {
                    for (heading, hint) in HEADINGS {
                        ui.add(Label::new(RichText::new(heading).strong()).extend())
                            .on_hover_text(hint);
                    }
                    ui.end_row();
                    for timing in &view.timings {
                        row(ui, timing, timing.integrator == view.integrator);
                        ui.end_row();
                    }
                });
        });
}

fn row(ui: &mut Ui, timing: &SchemeTiming, active: bool) {
    let info = timing.integrator.info();
    let looks = style::of(timing.integrator);
    ui.horizontal(|ui| {
        // Marks differ in width; the names line up.
        let mark = Label::new(RichText::new(looks.glyph).color(looks.color()));
        ui.add_sized(vec2(16.0, ui.spacing().interact_size.y), mark);
        let name = if active {
            format!("{} · active", info.name)
        } else {
            info.name.to_owned()
        };
        ui.add(Label::new(name).extend());
    });
    let figures = match timing.nanoseconds {
        Some((min, median, p95)) => [min, median, p95].map(quantity),
        None => ["…", "…", "…"].map(str::to_owned),
    };
    for figure in figures {
        ui.label(RichText::new(figure).monospace());
    }
    ui.label(RichText::new(number(timing.evaluations)).monospace());
    ui.label(info.orders.rotation.to_string());
    ui.label(info.keeps.energy.to_string());
}

/// The active scheme against the cheapest, in words.
fn verdict(view: &PanelView) -> String {
    let median = |timing: &&SchemeTiming| {
        timing
            .nanoseconds
            .map(|(_, median, _)| median)
            .filter(|ns| ns.is_finite() && *ns > 0.0)
    };
    let mut ranked: Vec<(Integrator, f64)> = view
        .timings
        .iter()
        .filter_map(|t| Some((t.integrator, median(&t)?)))
        .collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let active = view.integrator;
    let Some(&(_, cost)) = ranked.iter().find(|(integrator, _)| *integrator == active) else {
        return format!("{} has not been timed yet.", active.name());
    };
    let (cheapest, least) = ranked[0];
    if active != cheapest {
        return format!(
            "{} costs {} ns per body-step, {:.1}× the cheapest, {}: order {} against {}, energy {} against {}.",
            active.name(),
            number(cost),
            cost / least,
            cheapest.name(),
            active.info().orders.rotation,
            cheapest.info().orders.rotation,
            active.info().keeps.energy,
            cheapest.info().keeps.energy,
        );
    }
    match ranked.get(1) {
        Some((next, more)) => format!(
            "{} is the cheapest at {} ns per body-step; the next, {}, costs {:.1}×.",
            active.name(),
            number(cost),
            next.name(),
            more / cost
        ),
        None => format!(
            "{} costs {} ns per body-step; nothing else is timed yet.",
            active.name(),
            number(cost)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panel::sample_view;

    fn timed(active: Integrator, medians: &[(Integrator, f64)]) -> PanelView {
        let mut view = sample_view();
        view.integrator = active;
        for timing in &mut view.timings {
            timing.nanoseconds = medians
                .iter()
                .find(|(integrator, _)| *integrator == timing.integrator)
                .map(|&(_, ns)| (ns * 0.9, ns, ns * 1.2));
        }
        view
    }

    #[test]
    fn verdicts() {
        use Integrator::{ExplicitEuler, Rk4};
        let both = [(Rk4, 300.0), (ExplicitEuler, 60.0)];
        assert_eq!(
            verdict(&timed(Rk4, &both)),
            "RK4 costs 300 ns per body-step, 5.0× the cheapest, Explicit Euler: order 4 against 1, energy dissipates against gains."
        );
        assert_eq!(
            verdict(&timed(ExplicitEuler, &both)),
            "Explicit Euler is the cheapest at 60 ns per body-step; the next, RK4, costs 5.0×."
        );
        assert!(verdict(&timed(Rk4, &[(Rk4, 300.0)])).ends_with("nothing else is timed yet."));
        assert_eq!(verdict(&timed(Rk4, &[])), "RK4 has not been timed yet.");
        assert_eq!(
            verdict(&timed(Rk4, &[(Rk4, f64::NAN)])),
            "RK4 has not been timed yet."
        );
        assert_eq!(
            verdict(&timed(Rk4, &[(Rk4, 0.0), (ExplicitEuler, 1.0)])),
            "RK4 has not been timed yet."
        );
    }
}
