//! Color, dash and marker of each integrator in all plots and scenes, and its key in the game, listed by id in one
//! table. An integrator without a row gets a spare style, determined by its id, and no key.
//!
//! The colors are those of Okabe and Ito (2008), which are distinguishable with every common form of color blindness.
//! Yellow is only used for spare styles because it is faint on white. Dash and marker repeat the information of the
//! color, so that nothing depends on color alone.

use box_physics::digest::fnv_1a;
use box_physics::integrators::Integrator;

/// Dash pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dash {
    /// ────
    Solid,
    /// ─ ─ ─
    Dashed,
    /// · · ·
    Dotted,
    /// ── ──
    Long,
}

/// Shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are the shapes")]
pub enum Marker {
    Circle,
    Diamond,
    Square,
    Cross,
    Plus,
    Up,
    Down,
    Left,
    Right,
    Asterisk,
}

impl Marker {
    /// The shape as a character, for legends and tables.
    pub const fn glyph(self) -> char {
        match self {
            Self::Circle => '●',
            Self::Diamond => '◆',
            Self::Square => '■',
            Self::Cross => '✖',
            Self::Plus => '✚',
            Self::Up => '▲',
            Self::Down => '▼',
            Self::Left => '◀',
            Self::Right => '▶',
            Self::Asterisk => '✱',
        }
    }
}

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Style {
    /// sRGB color, 0 to 255 per channel.
    pub color: [u8; 3],
    /// Dash pattern.
    pub dash: Dash,
    /// Marker.
    pub marker: Marker,
}

const BLUE: [u8; 3] = [0x00, 0x72, 0xB2];
const VERMILLION: [u8; 3] = [0xD5, 0x5E, 0x00];
const GREEN: [u8; 3] = [0x00, 0x9E, 0x73];
const ORANGE: [u8; 3] = [0xE6, 0x9F, 0x00];
const SKY: [u8; 3] = [0x56, 0xB4, 0xE9];
const PURPLE: [u8; 3] = [0xCC, 0x79, 0xA7];
const YELLOW: [u8; 3] = [0xF0, 0xE4, 0x42];

/// A row: id, key, style.
type Row = (&'static str, Option<u8>, Style);

/// Styles by id. Every (color, dash) pair and every (color, marker) pair occurs once, here and in [`SPARE`].
const TABLE: &[Row] = {
    use Dash::{Dashed, Dotted, Long, Solid};
    &[
        row("split", 1, look(VERMILLION, Solid, Marker::Circle)),
        row("exact", 2, look(ORANGE, Solid, Marker::Asterisk)),
        row("split4", 3, look(PURPLE, Solid, Marker::Diamond)),
        row("dmv6", 4, look(SKY, Solid, Marker::Right)),
        row("symmetric-top", 0, look(VERMILLION, Dotted, Marker::Left)),
        row("rk4", 5, look(GREEN, Solid, Marker::Square)),
        row("implicit-midpoint", 6, look(BLUE, Dashed, Marker::Cross)),
        row("velocity-verlet", 7, look(SKY, Dashed, Marker::Plus)),
        row("midpoint", 8, look(PURPLE, Dotted, Marker::Down)),
        row(
            "backward-euler",
            9,
            look(VERMILLION, Dashed, Marker::Diamond),
        ),
        row("semi-implicit-euler", 0, look(BLUE, Solid, Marker::Up)),
        row("engine-rescaled", 0, look(GREEN, Dashed, Marker::Left)),
        row("engine-newton", 0, look(GREEN, Dotted, Marker::Right)),
        row("avian-993", 0, look(PURPLE, Dashed, Marker::Asterisk)),
        row("adams-bashforth-2", 0, look(BLUE, Dotted, Marker::Down)),
        row("buss", 0, look(BLUE, Long, Marker::Plus)),
        row("buss-augmented", 0, look(PURPLE, Long, Marker::Cross)),
        row("heun-2012", 0, look(ORANGE, Dashed, Marker::Square)),
        row("explicit-euler", 0, look(ORANGE, Dotted, Marker::Circle)),
    ]
};

/// Styles of integrators without a row.
const SPARE: &[Style] = {
    use Dash::{Dashed, Dotted, Long, Solid};
    &[
        look(YELLOW, Solid, Marker::Circle),
        look(YELLOW, Dashed, Marker::Square),
        look(YELLOW, Dotted, Marker::Up),
        look(YELLOW, Long, Marker::Diamond),
        look(VERMILLION, Long, Marker::Cross),
        look(SKY, Long, Marker::Asterisk),
        look(GREEN, Long, Marker::Plus),
    ]
};

/// Creates a row; key 0 means no key.
const fn row(id: &'static str, key: u8, style: Style) -> Row {
    (id, if key == 0 { None } else { Some(key) }, style)
}

const fn look(color: [u8; 3], dash: Dash, marker: Marker) -> Style {
    Style {
        color,
        dash,
        marker,
    }
}

fn listed(id: &str) -> Option<&'static Row> {
    TABLE.iter().find(|row| row.0 == id)
}

/// The style of `integrator`.
pub fn style(integrator: Integrator) -> Style {
    by_id(integrator.id())
}

fn by_id(id: &str) -> Style {
    listed(id).map_or_else(|| spare(id), |row| row.2)
}

/// Selected by a hash of the id, so that it does not depend on the other integrators.
fn spare(id: &str) -> Style {
    SPARE[(fnv_1a(id.bytes()) % SPARE.len() as u64) as usize]
}

/// The digit key that selects `integrator` in the game, 1 to 9.
pub fn key(integrator: Integrator) -> Option<u8> {
    listed(integrator.id())?.1
}

/// The integrator that the digit key `digit` selects in the game.
pub fn integrator_of_key(digit: u8) -> Option<Integrator> {
    let all = Integrator::ALL.iter().copied();
    all.into_iter().find(|&i| key(i) == Some(digit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_look_in_the_tables_occurs_once() {
        let all: Vec<Style> = TABLE
            .iter()
            .map(|row| row.2)
            .chain(SPARE.iter().copied())
            .collect();
        let lines: HashSet<_> = all.iter().map(|s| (s.color, s.dash)).collect();
        let points: HashSet<_> = all.iter().map(|s| (s.color, s.marker)).collect();
        assert_eq!((lines.len(), points.len()), (all.len(), all.len()));
    }

    #[test]
    fn no_two_integrators_look_alike() {
        for (k, &a) in Integrator::ALL.iter().enumerate() {
            for &b in &Integrator::ALL[..k] {
                assert!(
                    style(a) != style(b),
                    "{a} and {b} look alike, {:?}: give one of them a row in TABLE",
                    style(a)
                );
            }
        }
    }

    #[test]
    fn rows_belong_to_integrators_and_keys_to_one() {
        let ids: HashSet<_> = Integrator::ALL.iter().map(|i| i.id()).collect();
        for (id, key, _) in TABLE {
            assert!(ids.contains(id), "'{id}' has a row and is no integrator");
            let same = TABLE.iter().filter(|row| row.0 == *id).count();
            assert_eq!(same, 1, "'{id}' has {same} rows");
            if let Some(key) = key {
                let owner = integrator_of_key(*key).map(Integrator::id);
                assert_eq!(owner, Some(*id), "key {key}");
            }
        }
        assert_eq!(integrator_of_key(1), Some(Integrator::default()));
        assert_eq!(integrator_of_key(0), None);
    }

    /// Inserting an integrator into the menu does not change other colors, because a style depends only on the id.
    #[test]
    fn looks_do_not_depend_on_the_place() {
        assert_eq!(by_id("rk4").color, GREEN);
        assert_eq!(by_id("not-on-the-list"), spare("not-on-the-list"));
        assert!(SPARE.contains(&by_id("not-on-the-list")));
    }
}
