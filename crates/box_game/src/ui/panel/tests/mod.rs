//! Tests of the panel without a window, which find controls by their ids.

mod controls;
mod interaction;
mod layout;
mod numbers;
pub(super) mod sample;
mod texts;

use bevy_egui::egui::{Event, Key, Pos2, Rect, Ui, Vec2, accesskit::Role, pos2};
use egui_kittest::{
    Harness, Node,
    kittest::{By, NodeT, Queryable},
};

use super::widgets::id_of;
use super::{DemoView, PanelLayout, PanelMemory, PanelView, sample_view, show};
use crate::action::Action;
use box_scenarios::dissertation::Stepper;

/// State of the harness between frames.
struct Bench {
    view: PanelView,
    memory: PanelMemory,
    asked: Vec<Action>,
    layout: Option<PanelLayout>,
}

/// A simulated user of the panel, with mouse and keyboard.
struct Person {
    harness: Harness<'static, Bench>,
}

/// Tall enough to show every section without scrolling.
const TALL: Vec2 = Vec2::new(1280.0, 2400.0);
const USUAL: Vec2 = Vec2::new(1280.0, 720.0);

/// Creates a user of the sample view, modified by `change`.
fn with(change: impl FnOnce(&mut PanelView)) -> Person {
    let mut view = sample_view();
    change(&mut view);
    Person::before(view, TALL)
}

/// A running demo of 2012.
fn demo() -> DemoView {
    DemoView {
        stepper: Some(Stepper::Heun),
        fault: crate::demo_2012::FAULTS[0],
        cycle_us: 1.25,
        log: None,
    }
}

impl Person {
    /// Creates a user of a panel with every section open.
    fn before(view: PanelView, size: Vec2) -> Self {
        let memory = PanelMemory {
            all_open: true,
            ..PanelMemory::default()
        };
        Self::remembering(memory, view, size)
    }

    fn remembering(memory: PanelMemory, view: PanelView, size: Vec2) -> Self {
        let bench = Bench {
            view,
            memory,
            asked: Vec::new(),
            layout: None,
        };
        let draw = |ui: &mut Ui, bench: &mut Bench| {
            let layout = show(ui, &bench.view, &mut bench.memory, &mut bench.asked);
            bench.layout = Some(layout);
        };
        let harness = Harness::builder().with_size(size);
        let mut person = Self {
            harness: harness.build_ui_state(draw, bench),
        };
        person.look();
        person
    }

    fn view(&mut self) -> &mut PanelView {
        &mut self.harness.state_mut().view
    }

    fn layout(&self) -> PanelLayout {
        self.harness.state().layout.expect("drawn")
    }

    /// Runs enough frames for tooltips to appear.
    fn look(&mut self) {
        self.harness.run_steps(6);
    }

    /// Runs some frames and returns the actions requested since the last call.
    fn asked(&mut self) -> Vec<Action> {
        self.look();
        std::mem::take(&mut self.harness.state_mut().asked)
    }

    /// Returns the control with this id.
    fn find<'a>(&'a self, id: &'a str) -> Node<'a> {
        self.harness.get(by_id(id))
    }

    /// Asserts that each of these actions has a control that requests it.
    fn asks_for<A: Into<Action>>(&mut self, actions: impl IntoIterator<Item = A>) {
        for action in actions.into_iter().map(Into::into) {
            assert_eq!(self.click_on(action.clone()), [action]);
        }
    }

    /// Clicks the control that requests this action.
    fn click_on(&mut self, action: impl Into<Action>) -> Vec<Action> {
        self.click(&id_of(&action.into()))
    }

    fn has(&self, id: &str) -> bool {
        self.harness.query_all(by_id(id)).next().is_some()
    }

    /// The id of the control with this name, outside of hints.
    fn control(&self, name: &str) -> Option<String> {
        let nodes = self.harness.query_all_by_label(name);
        let mut ids = nodes.filter_map(|n| n.accesskit_node().author_id().map(str::to_owned));
        ids.find(|id| !id.starts_with("hint "))
    }

    fn sees(&self, name: &str) -> bool {
        self.harness.query_all_by_label(name).next().is_some()
    }

    fn sees_part(&self, part: &str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(part);
        found.next().is_some()
    }

    fn sees_all(&self, parts: &[&str]) {
        for part in parts {
            assert!(self.sees_part(part), "{part}");
        }
    }

    fn click(&mut self, id: &str) -> Vec<Action> {
        self.find(id).click();
        self.asked()
    }

    /// Presses and drags without releasing.
    fn drag(&mut self, from: Pos2, to: Pos2) -> Vec<Action> {
        self.harness.hover_at(from);
        self.harness.drag_at(from);
        self.harness.hover_at(to);
        self.asked()
    }

    fn release(&mut self, at: Pos2) -> Vec<Action> {
        self.harness.drop_at(at);
        self.asked()
    }

    fn type_into(&mut self, id: &str, text: &str) -> Vec<Action> {
        self.find(id).click();
        self.look();
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.key_press(Key::Enter);
        self.asked()
    }

    /// Every piece of text and every widget: (role, name, place).
    fn nodes(&self) -> Vec<(Role, String, Rect)> {
        let mut found = Vec::new();
        let mut open: Vec<Node<'_>> = vec![self.harness.root()];
        while let Some(node) = open.pop() {
            open.extend(node.children());
            let inner = node.accesskit_node();
            let name = inner.label().or_else(|| inner.value()).unwrap_or_default();
            if inner.bounding_box().is_some() && !name.is_empty() {
                found.push((inner.role(), name, node.rect()));
            }
        }
        found
    }
}

fn by_id(id: &str) -> By<'_> {
    By::new().predicate(move |node| node.author_id() == Some(id))
}

/// A place along a rectangle, from 0 at its left to 1 at its right end.
fn along(rect: Rect, share: f32) -> Pos2 {
    pos2(rect.left() + share * rect.width(), rect.center().y)
}
