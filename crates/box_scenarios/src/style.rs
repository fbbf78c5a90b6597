//! The look of each integrator in every plot and scene: color, dash and marker by its place in
//! [`Integrator::ALL`], in this one table.
//!
//! The colors are Okabe and Ito's (2008), distinguishable with every common color blindness; yellow
//! is left out of the first round because it is faint on white. Dash and marker repeat what the color
//! says, so that nothing depends on color alone.

use box_physics::integrators::Integrator;

/// A line's dash pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dash {
    /// ────
    Solid,
    /// ─ ─ ─
    Dashed,
    /// · · ·
    Dotted,
}

/// A point's shape.
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

/// How one line looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Style {
    /// sRGB, 0 to 255 a channel.
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

/// By place in the menu; every (color, dash) pair occurs once.
const TABLE: [Style; 14] = {
    use Dash::{Dashed, Dotted, Solid};
    [
        look(VERMILLION, Solid, Marker::Circle),
        look(ORANGE, Solid, Marker::Asterisk),
        look(PURPLE, Solid, Marker::Diamond),
        look(SKY, Solid, Marker::Right),
        look(GREEN, Solid, Marker::Square),
        look(BLUE, Dashed, Marker::Cross),
        look(SKY, Dashed, Marker::Plus),
        look(PURPLE, Dotted, Marker::Down),
        look(VERMILLION, Dashed, Marker::Diamond),
        look(BLUE, Solid, Marker::Up),
        look(GREEN, Dashed, Marker::Left),
        look(GREEN, Dotted, Marker::Right),
        look(ORANGE, Dashed, Marker::Square),
        look(ORANGE, Dotted, Marker::Circle),
    ]
};

const fn look(color: [u8; 3], dash: Dash, marker: Marker) -> Style {
    Style {
        color,
        dash,
        marker,
    }
}

/// The look of `integrator`. A fifteenth and later integrator is yellow, then repeats the table.
pub fn style(integrator: Integrator) -> Style {
    by_place(integrator.index())
}

fn by_place(place: usize) -> Style {
    match place.checked_sub(TABLE.len()) {
        None => TABLE[place],
        Some(extra @ 0..3) => Style {
            color: YELLOW,
            ..TABLE[[0, 6, 7][extra]]
        },
        Some(extra) => TABLE[(extra - 3) % TABLE.len()],
    }
}

/// The look of the reference: black on light, white on dark, dashed.
pub const fn reference_style(dark: bool) -> Style {
    let shade = if dark { 0xFF } else { 0x00 };
    look([shade; 3], Dash::Dashed, Marker::Plus)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_integrators_look_alike() {
        let lines: HashSet<_> = (0..17).map(by_place).map(|s| (s.color, s.dash)).collect();
        assert_eq!(lines.len(), 17);
        let points: HashSet<_> = (0..17).map(by_place).map(|s| (s.color, s.marker)).collect();
        assert_eq!(points.len(), 17);
        assert!(Integrator::ALL.len() <= 17, "extend the table");
        assert_eq!(style(Integrator::default()), TABLE[0]);
    }
}
