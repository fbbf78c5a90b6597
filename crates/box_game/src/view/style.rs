//! Style of each integrator for egui, from the table that the report shares ([`mod@box_scenarios::style`]).

use box_physics::prelude::Integrator;
use box_scenarios::style::{Dash, Marker, Style};
use egui_plot::{LineStyle, MarkerShape};

use bevy_egui::egui::{Color32, Context, FontDefinitions, FontFamily, FontId, Id, TextStyle};

/// The looks of one integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorStyle {
    /// sRGB.
    pub rgb: [u8; 3],
    /// Stands before the name in text.
    pub glyph: &'static str,
    /// The same mark in a plot.
    pub marker: MarkerShape,
    /// Dash pattern of lines in a plot.
    pub dash: LineStyle,
}

impl IntegratorStyle {
    /// The color for egui.
    pub const fn color(self) -> Color32 {
        Color32::from_rgb(self.rgb[0], self.rgb[1], self.rgb[2])
    }
}

/// The looks of an integrator: those of the one table in [`mod@box_scenarios::style`], in egui's words.
pub fn of(integrator: Integrator) -> IntegratorStyle {
    translate(box_scenarios::style(integrator))
}

fn translate(style: Style) -> IntegratorStyle {
    let (glyph, marker) = match style.marker {
        Marker::Circle => ("●", MarkerShape::Circle),
        Marker::Diamond => ("◆", MarkerShape::Diamond),
        Marker::Square => ("■", MarkerShape::Square),
        Marker::Cross => ("✖", MarkerShape::Cross),
        Marker::Plus => ("✚", MarkerShape::Plus),
        Marker::Up => ("▲", MarkerShape::Up),
        Marker::Down => ("▼", MarkerShape::Down),
        Marker::Left => ("◀", MarkerShape::Left),
        Marker::Right => ("▶", MarkerShape::Right),
        Marker::Asterisk => ("✱", MarkerShape::Asterisk),
    };
    let dash = match style.dash {
        Dash::Solid => LineStyle::Solid,
        Dash::Dashed => DASHED,
        Dash::Dotted => DOTTED,
        Dash::Long => LONG,
    };
    look(style.color, glyph, marker, dash)
}

/// The mark and the name: `■ RK4`.
pub fn marked_name(integrator: Integrator) -> String {
    format!("{} {}", of(integrator).glyph, integrator.name())
}

/// Text over the picture: on its plate, beside it, right and wrong.
pub const PICTURE_TEXT: Color32 = Color32::from_rgb(0xF2, 0xF4, 0xF7);
/// See [`PICTURE_TEXT`].
pub const PICTURE_WEAK: Color32 = Color32::from_rgb(0xB4, 0xBC, 0xC8);
/// See [`PICTURE_TEXT`].
pub const PICTURE_GOOD: Color32 = Color32::from_rgb(0x8F, 0xE3, 0xB4);
/// See [`PICTURE_TEXT`].
pub const PICTURE_BAD: Color32 = Color32::from_rgb(0xFF, 0xB4, 0x8F);
/// The plate of a label.
pub const PICTURE_PLATE: Color32 = Color32::from_rgba_premultiplied(0x0B, 0x0D, 0x11, 0xDC);

/// The process in the plot of CPU use.
pub const PROCESS: IntegratorStyle = look(VERMILION, "●", MarkerShape::Circle, LineStyle::Solid);
/// The whole computer in the plot of CPU use.
pub const SYSTEM: IntegratorStyle = look(SKY, "○", MarkerShape::Circle, DASHED);

const SKY: [u8; 3] = [0x56, 0xB4, 0xE9];
const VERMILION: [u8; 3] = [0xD5, 0x5E, 0x00];

const DASHED: LineStyle = LineStyle::Dashed { length: 8.0 };
const LONG: LineStyle = LineStyle::Dashed { length: 18.0 };
const DOTTED: LineStyle = LineStyle::Dotted { spacing: 6.0 };

const fn look(
    rgb: [u8; 3],
    glyph: &'static str,
    marker: MarkerShape,
    dash: LineStyle,
) -> IntegratorStyle {
    IntegratorStyle {
        rgb,
        glyph,
        marker,
        dash,
    }
}

/// Small print \[points\]: egui's own nine are hard to read over a dark ground.
const SMALL: f32 = 10.5;

/// Lets text fall back on egui's own monospaced font, once per context: the proportional one has no
/// ▲ ◆ ● and no arrows. And makes the small print readable.
pub fn install_symbols(ctx: &Context) {
    let done = Id::new("box_game symbols");
    if ctx.data(|data| data.get_temp::<()>(done)).is_some() {
        return;
    }
    ctx.data_mut(|data| data.insert_temp(done, ()));
    ctx.all_styles_mut(|style| {
        let small = FontId::new(SMALL, FontFamily::Proportional);
        style.text_styles.insert(TextStyle::Small, small);
    });
    let mut fonts = FontDefinitions::default();
    let symbols = fonts.families.get(&FontFamily::Monospace).cloned();
    if let (Some(symbols), Some(text)) =
        (symbols, fonts.families.get_mut(&FontFamily::Proportional))
    {
        for font in symbols {
            if !text.contains(&font) {
                text.push(font);
            }
        }
        ctx.set_fonts(fonts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glyph_and_marker_agree_and_no_two_integrators_share_both_color_and_glyph() {
        for (k, &a) in Integrator::ALL.iter().enumerate() {
            let glyph = box_scenarios::style(a).marker.glyph().to_string();
            assert_eq!(of(a).glyph, glyph);
            for &b in &Integrator::ALL[..k] {
                assert!(of(a).rgb != of(b).rgb || of(a).glyph != of(b).glyph);
                assert!(of(a).rgb != of(b).rgb || of(a).dash != of(b).dash);
            }
        }
    }

    /// WCAG 2.1, 1.4.11: 3 : 1 for graphics, against the panel's gray 27.
    #[test]
    fn colors_stand_out_from_the_panel() {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        let luminance = |rgb: [u8; 3]| {
            0.2126 * linear(rgb[0]) + 0.7152 * linear(rgb[1]) + 0.0722 * linear(rgb[2])
        };
        let panel = luminance([27; 3]);
        for style in Integrator::ALL.iter().map(|&i| of(i)) {
            assert!(
                (luminance(style.rgb) + 0.05) / (panel + 0.05) >= 3.0,
                "{style:?}"
            );
        }
    }
}
