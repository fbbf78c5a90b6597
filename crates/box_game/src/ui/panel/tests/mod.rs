//! The panel without a window: every control by its id.

mod controls;
mod interaction;
mod layout;
mod numbers;
mod texts;

use bevy_egui::egui::{Event, Key, PointerButton, Pos2, Rect, Vec2, accesskit::Role, pos2};
use egui_kittest::{
    Harness, Node,
    kittest::{By, NodeT, Queryable},
};

use super::widgets::id_of;
use super::{PanelLayout, PanelMemory, PanelView, sample_view, show};
use crate::action::Action;

/// What the harness carries from frame to frame.
struct Bench {
    view: PanelView,
    memory: PanelMemory,
    asked: Vec<Action>,
    layout: Option<PanelLayout>,
}

/// A person with a mouse and a keyboard before a panel.
struct Person {
    harness: Harness<'static, Bench>,
}

/// Tall enough to show every section without scrolling.
const TALL: Vec2 = Vec2::new(1280.0, 2400.0);

impl Person {
    fn before(view: PanelView, size: Vec2) -> Self {
        Self::with(view, PanelMemory::all_open(), size)
    }

    fn with(view: PanelView, memory: PanelMemory, size: Vec2) -> Self {
        let bench = Bench {
            view,
            memory,
            asked: Vec::new(),
            layout: None,
        };
        let harness = Harness::builder().with_size(size).build_ui_state(
            |ui, bench: &mut Bench| {
                let layout = show(ui, &bench.view, &mut bench.memory, &mut bench.asked);
                bench.layout = Some(layout);
            },
            bench,
        );
        let mut person = Self { harness };
        person.look();
        person
    }

    /// Some frames, a second in all: tooltips appear.
    fn look(&mut self) {
        self.harness.run_steps(6);
    }

    /// What was asked for since the last time.
    fn asked(&mut self) -> Vec<Action> {
        self.look();
        std::mem::take(&mut self.harness.state_mut().asked)
    }

    /// The control with this id.
    fn find<'a>(&'a self, id: &'a str) -> Node<'a> {
        let by = By::new().predicate(move |node| node.author_id() == Some(id));
        self.harness.get(by)
    }

    /// The control that asks for this.
    fn click_on(&mut self, action: impl Into<Action>) -> Vec<Action> {
        self.click(&id_of(&action.into()))
    }

    fn has(&self, id: &str) -> bool {
        let by = By::new().predicate(move |node| node.author_id() == Some(id));
        self.harness.query_all(by).next().is_some()
    }

    fn sees(&self, name: &str) -> bool {
        self.harness.query_all_by_label(name).next().is_some()
    }

    fn sees_part(&self, part: &str) -> bool {
        self.harness
            .query_all_by_label_contains(part)
            .next()
            .is_some()
    }

    fn click(&mut self, id: &str) -> Vec<Action> {
        self.find(id).click();
        self.asked()
    }

    /// Presses, moves and holds.
    fn drag(&mut self, from: Pos2, to: Pos2) -> Vec<Action> {
        self.harness.hover_at(from);
        self.button(from, PointerButton::Primary, true);
        self.harness.hover_at(to);
        self.asked()
    }

    fn release(&mut self, at: Pos2) -> Vec<Action> {
        self.button(at, PointerButton::Primary, false);
        self.asked()
    }

    fn button(&self, pos: Pos2, button: PointerButton, pressed: bool) {
        self.harness.event(Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers: Default::default(),
        });
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

/// A place along a rectangle, from 0 at its left to 1 at its right end.
fn along(rect: Rect, share: f32) -> Pos2 {
    pos2(rect.left() + share * rect.width(), rect.center().y)
}
