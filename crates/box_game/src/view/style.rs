//! Style of each integrator for egui, from the table that the report shares ([`mod@box_scenarios::style`]).

use box_physics::prelude::Integrator;
use box_scenarios::style::{Dash, Marker, Style};
use egui_plot::{LineStyle, MarkerShape};

use bevy_egui::egui::{
    self, Color32, Context, FontDefinitions, FontFamily, FontId, Id, TextStyle, Theme,
};

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

/// The panel in each theme: ground, fields on it, text, captions, the one accent and text on it.
struct Palette {
    panel: Color32,
    field: Color32,
    button: Color32,
    text: Color32,
    weak: Color32,
    accent: Color32,
}

const fn palette(theme: Theme) -> Palette {
    match theme {
        Theme::Dark => Palette {
            panel: Color32::from_rgb(0x15, 0x18, 0x1D),
            field: Color32::from_rgb(0x0D, 0x0F, 0x13),
            button: Color32::from_rgb(0x2A, 0x2F, 0x38),
            text: Color32::from_rgb(0xDD, 0xE2, 0xE9),
            weak: Color32::from_rgb(0xA4, 0xAD, 0xBA),
            accent: Color32::from_rgb(0x1F, 0x62, 0xC8),
        },
        Theme::Light => Palette {
            panel: Color32::from_rgb(0xF4, 0xF5, 0xF7),
            field: Color32::from_rgb(0xFF, 0xFF, 0xFF),
            button: Color32::from_rgb(0xDF, 0xE3, 0xE9),
            text: Color32::from_rgb(0x1A, 0x1E, 0x25),
            weak: Color32::from_rgb(0x52, 0x5C, 0x69),
            accent: Color32::from_rgb(0x1F, 0x62, 0xC8),
        },
    }
}

/// The type scale [points]: the headline, text, captions and numbers.
const HEADING: f32 = 19.0;
const BODY: f32 = 13.5;
const SMALL: f32 = 12.0;
const MONOSPACE: f32 = 13.0;

/// Contrast of text with its ground: WCAG 2.1, 1.4.3.
const CONTRAST: f64 = 4.5;

/// The relative luminance of a color, 0 to 1 (WCAG 2.1).
fn luminance(color: Color32) -> f64 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
}

/// The contrast of two colors, 1 to 21 (WCAG 2.1).
fn contrast(a: Color32, b: Color32) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

impl IntegratorStyle {
    /// The color for text and lines on the panel: the integrator's own, mixed with white or black until it can be read.
    pub fn ink(self, theme: Theme) -> Color32 {
        let ground = palette(theme).panel;
        let end = if theme == Theme::Dark { 255.0 } else { 0.0 };
        let mixed = |k: u8| {
            let share = f64::from(k) / 20.0;
            let [r, g, b] = self
                .rgb
                .map(|c| (f64::from(c) * (1.0 - share) + end * share) as u8);
            Color32::from_rgb(r, g, b)
        };
        let readable = (0..20)
            .map(mixed)
            .find(|c| contrast(*c, ground) >= CONTRAST);
        readable.unwrap_or(palette(theme).text)
    }
}

/// Colors, type scale and spacing of the panel, once per context. Text falls back on egui's own monospaced font: the
/// proportional one has no ▲ ◆ ● and no arrows.
pub fn install(ctx: &Context, light: bool) {
    ctx.set_theme(if light { Theme::Light } else { Theme::Dark });
    let done = Id::new("box_game style");
    if ctx.data(|data| data.get_temp::<()>(done)).is_some() {
        return;
    }
    ctx.data_mut(|data| data.insert_temp(done, ()));
    for theme in [Theme::Dark, Theme::Light] {
        ctx.style_mut_of(theme, |style| dress(style, &palette(theme)));
    }
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

/// Text of labels in the picture.
pub const PICTURE_FONT: FontId = FontId::proportional(14.0);

fn dress(style: &mut egui::Style, palette: &Palette) {
    for (text, size, family) in [
        (TextStyle::Heading, HEADING, FontFamily::Proportional),
        (TextStyle::Body, BODY, FontFamily::Proportional),
        (TextStyle::Button, BODY, FontFamily::Proportional),
        (TextStyle::Small, SMALL, FontFamily::Proportional),
        (TextStyle::Monospace, MONOSPACE, FontFamily::Monospace),
    ] {
        style.text_styles.insert(text, FontId::new(size, family));
    }
    style.spacing.item_spacing = egui::vec2(8.0, 4.0);
    style.spacing.button_padding = egui::vec2(6.0, 2.0);
    let visuals = &mut style.visuals;
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.extreme_bg_color = palette.field;
    visuals.weak_text_color = Some(palette.weak);
    visuals.selection.bg_fill = palette.accent;
    visuals.selection.stroke.color = Color32::WHITE;
    visuals.hyperlink_color = palette.accent;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke.color = palette.text;
    widgets.inactive.fg_stroke.color = palette.text;
    widgets.inactive.weak_bg_fill = palette.button;
    widgets.inactive.bg_fill = palette.button;
    for state in [&mut widgets.noninteractive, &mut widgets.inactive] {
        state.corner_radius = egui::CornerRadius::same(4);
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

    /// Text on the panel, in the picture and in the integrators' colors, in both themes.
    #[test]
    fn text_can_be_read() {
        for theme in [Theme::Dark, Theme::Light] {
            let p = palette(theme);
            for (name, text, ground) in [
                ("text", p.text, p.panel),
                ("text in a field", p.text, p.field),
                ("text on a button", p.text, p.button),
                ("caption", p.weak, p.panel),
                ("caption in a field", p.weak, p.field),
                ("selected", Color32::WHITE, p.accent),
            ] {
                assert!(
                    contrast(text, ground) >= CONTRAST,
                    "{theme:?} {name}: {}",
                    contrast(text, ground)
                );
            }
            for &integrator in Integrator::ALL {
                let ink = of(integrator).ink(theme);
                assert!(contrast(ink, p.panel) >= CONTRAST, "{theme:?} {integrator}");
            }
        }
        let plate = Color32::from_rgb(0x1C, 0x20, 0x27);
        for text in [PICTURE_TEXT, PICTURE_WEAK, PICTURE_GOOD, PICTURE_BAD] {
            assert!(contrast(text, plate) >= CONTRAST, "{text:?}");
        }
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
    }

    /// No text is set smaller than the captions, and captions have 12 points.
    #[test]
    fn the_type_scale_ends_at_twelve_points() {
        let ctx = Context::default();
        let _ = ctx.run_ui(egui::RawInput::default(), |ui| install(ui.ctx(), false));
        for theme in [Theme::Dark, Theme::Light] {
            let style = ctx.style_of(theme);
            assert!(style.text_styles.values().all(|font| font.size >= 12.0));
        }
    }
}
