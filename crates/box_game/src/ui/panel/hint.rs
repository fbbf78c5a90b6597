//! Hints: sentences in which the name of a control, in brackets, becomes a button with the same effect. An unknown name
//! stays bold text.

use bevy_egui::egui::text::{CCursor, LayoutJob};
use bevy_egui::egui::{
    Label, Sense, StrokeKind, TextFormat, TextStyle, Ui, WidgetInfo, WidgetType, vec2,
};
use box_physics::prelude::{DVec3, Integrator};

use super::drawer::TABS;
use super::format::parse;
use super::view::{FIGURES, PanelView};
use super::widgets::{Panel, identify};
use crate::action::compare::{CompareAction, Fairness, Layout};
use crate::action::{Action, Plot, Push};
use crate::parameters::Parameter;

/// Time for which a hint highlights a control \[s\].
const MARK_TIME: f64 = 2.0;

/// Effect of a button in a hint.
enum HintTarget {
    /// Requests these actions.
    Ask(Vec<Action>),
    /// Highlights the parameter or figure with this name in the side panel.
    Show(&'static str),
}

/// Draws a text with its buttons. Without a `side` panel, a button that highlights a control closes the drawer first.
pub(super) fn show(ui: &mut Ui, hints: &str, side: bool, panel: &mut Panel<'_>) {
    let view = panel.view;
    let font = TextStyle::Body.resolve(ui.style());
    let colors = [
        ui.visuals().weak_text_color(),
        ui.visuals().strong_text_color(),
    ];
    let (mut job, mut buttons, mut end) = (LayoutJob::default(), Vec::new(), 0);
    for (k, part) in hints.split(['[', ']']).enumerate() {
        let named = k % 2;
        // A name does not wrap.
        let text = part.replace(' ', [" ", "\u{a0}"][named]);
        let format = TextFormat::simple(font.clone(), colors[named]);
        // Room for the edge of the plate.
        job.append(&text, if k > 0 { 5.0 } else { 0.0 }, format);
        let start = end;
        end += text.chars().count();
        if named == 1
            && let Some(target) = target(part, view)
        {
            buttons.push((part, target, [start, end]));
        }
    }
    let label = Label::new(job).wrap().selectable(false);
    let (corner, galley, response) = label.layout_in_ui(ui);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, galley.text()));
    for (k, (name, target, [start, end])) in buttons.into_iter().enumerate() {
        // At the start of a row, not at the end of the one above.
        let start = CCursor {
            prefer_next_row: true,
            ..CCursor::new(start)
        };
        let at = galley.layout_from_cursor(start);
        let row = &galley.rows[at.row];
        // A name is on one row. The cursor after it is beyond the room for the edge of the plate.
        let last = at.column.0 + (end - start.index.0) - 1;
        let place = galley.pos_from_cursor(start);
        let right = row.glyphs.get(last).map(|last| row.pos.x + last.max_x());
        let place = place.with_max_x(right.unwrap_or(place.max.x));
        let place = place.translate(corner.to_vec2()).expand2(vec2(3.0, 1.0));
        let on =
            matches!(&target, HintTarget::Ask(actions) if actions.iter().all(|a| is_done(a, view)));
        let button = ui.interact(place, response.id.with(k), Sense::click());
        button.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, on, name));
        identify(&button, format!("hint {name}"));
        let looks = ui.style().interact_selectable(&button, on);
        let (fill, stroke) = (looks.weak_bg_fill, looks.bg_stroke);
        ui.painter()
            .rect(place, looks.corner_radius, fill, stroke, StrokeKind::Inside);
        if !button.clicked() {
            continue;
        }
        match target {
            HintTarget::Ask(mut actions) => {
                actions.retain(|action| !is_done(action, view));
                panel.out.extend(actions);
            }
            HintTarget::Show(name) => {
                panel.memory.marked = Some((name, ui.input(|i| i.time) + MARK_TIME));
                if !side {
                    panel.ask(Action::TogglePlots);
                }
            }
        }
    }
    ui.painter().galley(corner, galley, colors[0]);
}

/// Returns `true` if the action would change nothing; a second toggle would undo it.
fn is_done(action: &Action, view: &PanelView) -> bool {
    let (settings, trajectories) = (&view.compare.settings, &view.compare.trajectories);
    match action {
        Action::Set(parameter, value) => view.parameters.get(*parameter) == Some(*value),
        Action::SelectPlot(plot) => view.plot == *plot && view.preferences.show_plots,
        Action::SetDemo(wanted) => view.demo.as_ref().is_some_and(|d| d.stepper == *wanted),
        Action::Compare(CompareAction::SetLayout(layout)) => settings.layout == *layout,
        Action::Compare(CompareAction::SetFairness(fairness)) => settings.fairness == *fairness,
        Action::Compare(CompareAction::ToggleComparison(integrator)) => {
            trajectories.iter().any(|t| t.integrator == *integrator)
        }
        _ => false,
    }
}

/// Returns the effect of the button with this name, if known.
fn target(name: &str, view: &PanelView) -> Option<HintTarget> {
    let mut figures = FIGURES.iter().map(|figure| figure.0);
    let figure = figures.find(|figure| *figure == name).map(HintTarget::Show);
    let actions = || button(name).or_else(|| listed(name, view).map(|action| vec![action]));
    figure
        .or_else(|| parameter(name, view))
        .or_else(|| actions().map(HintTarget::Ask))
}

/// A parameter, if the scene has it: highlighted, or set to the value after its name, `Restitution 1`, `dt 1/10 s`.
fn parameter(name: &str, view: &PanelView) -> Option<HintTarget> {
    let present = |p: &Parameter| view.parameters.get(*p).is_some();
    Parameter::ALL.into_iter().filter(present).find_map(|p| {
        let label = p.info().label;
        let value = name.strip_prefix(label)?;
        if value.is_empty() {
            return Some(HintTarget::Show(label));
        }
        let value = value.strip_prefix(' ')?;
        let value = p.parse(value).or_else(|| parse(value))?;
        Some(HintTarget::Ask(vec![Action::Set(p, p.nearest(value)?)]))
    })
}

/// The actions of a button of the panel.
fn button(name: &str) -> Option<Vec<Action>> {
    let push = |direction| {
        Action::Push(Push {
            direction,
            world: false,
            off_center: false,
        })
    };
    Some(vec![match name {
        "Restart" => Action::Restart,
        "Step" => Action::Step(1),
        "Back" => Action::StepBack(1),
        "Slower" => Action::Slower,
        "Faster" => Action::Faster,
        "Compare all" => CompareAction::CompareAll.into(),
        "Re-sync" => CompareAction::Resync.into(),
        "box_physics" => Action::SetDemo(None),
        "Push +x" => push(DVec3::X),
        "Push −x" => push(DVec3::NEG_X),
        "Push +y" => push(DVec3::Y),
        "Push −y" => push(DVec3::NEG_Y),
        "Push +z" => push(DVec3::Z),
        "Push −z" => push(DVec3::NEG_Z),
        "Sweep" => {
            let tab = Action::SelectPlot(Plot::WorkPrecision);
            return Some(vec![tab, CompareAction::StartSweep.into()]);
        }
        _ => return None,
    }])
}

/// The action of an entry of a list: layout, fairness, tab, rate, integrator to compare, title of a scene.
fn listed(name: &str, view: &PanelView) -> Option<Action> {
    let layout = Layout::ALL.iter().find(|l| l.1 == name);
    let layout = layout.map(|l| Action::Compare(CompareAction::SetLayout(l.0)));
    let fairness = Fairness::ALL.iter().find(|f| f.1 == name);
    let fairness = fairness.map(|f| Action::Compare(CompareAction::SetFairness(f.0)));
    let tab = name.strip_suffix(" tab");
    let tab = tab.and_then(|tab| TABS.iter().find(|t| t.1 == tab));
    let tab = tab.map(|t| Action::SelectPlot(t.0));
    let rate = parse(name).filter(|_| name.ends_with(" Hz"));
    let rate = rate.and_then(|dt| Parameter::Step.nearest(dt));
    let rate = rate.map(|dt| Action::Set(Parameter::Step, dt));
    let integrator = Integrator::ALL.iter().find(|i| i.name() == name);
    let integrator = integrator.map(|&i| Action::Compare(CompareAction::ToggleComparison(i)));
    let scene = view.scenes.iter().find(|s| s.title == name);
    let scene = scene.map(|s| Action::SelectScene(s.id.to_owned()));
    layout
        .or(fairness)
        .or(tab)
        .or(rate)
        .or(integrator)
        .or(scene)
}
