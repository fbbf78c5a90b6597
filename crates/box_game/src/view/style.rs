//! Style of each integrator for egui, from the table that the report shares ([`mod@box_scenarios::style`]).

use bevy::color::{Color, Luminance as _, Srgba};
use bevy_egui::egui::{
    self, Color32, Context, FontDefinitions, FontFamily, FontId, Id, RichText, TextStyle, Theme, Ui,
};
use box_physics::prelude::Integrator;
use box_scenarios::style::{Dash, Marker};
use egui_plot::{LineStyle, MarkerShape};

/// Style of one integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorStyle {
    /// sRGB.
    pub rgb: [u8; 3],
    /// Symbol before the name in text.
    pub glyph: char,
    /// The same symbol in a plot.
    pub marker: MarkerShape,
    /// Dash pattern of lines in a plot.
    pub dash: LineStyle,
}

/// The style of an integrator in egui's types, from the table in [`mod@box_scenarios::style`].
pub fn of(integrator: Integrator) -> IntegratorStyle {
    let style = box_scenarios::style(integrator);
    IntegratorStyle {
        rgb: style.color,
        glyph: style.marker.glyph(),
        marker: match style.marker {
            Marker::Circle => MarkerShape::Circle,
            Marker::Diamond => MarkerShape::Diamond,
            Marker::Square => MarkerShape::Square,
            Marker::Cross => MarkerShape::Cross,
            Marker::Plus => MarkerShape::Plus,
            Marker::Up => MarkerShape::Up,
            Marker::Down => MarkerShape::Down,
            Marker::Left => MarkerShape::Left,
            Marker::Right => MarkerShape::Right,
            Marker::Asterisk => MarkerShape::Asterisk,
        },
        dash: match style.dash {
            Dash::Solid => LineStyle::Solid,
            Dash::Dashed => DASHED,
            Dash::Dotted => LineStyle::Dotted { spacing: 6.0 },
            Dash::Long => LineStyle::Dashed { length: 18.0 },
        },
    }
}

/// The symbol and the name: `■ RK4`.
pub fn marked_name(integrator: Integrator) -> String {
    format!("{} {}", of(integrator).glyph, integrator.name())
}

/// Text in the color of an integrator.
pub(crate) fn in_ink(ui: &Ui, integrator: Integrator, text: impl Into<String>) -> RichText {
    RichText::new(text).color(of(integrator).ink(ui.ctx().theme()))
}

/// Text over the picture, on its plate: normal, weak, good and bad.
pub const PICTURE_TEXT: Color32 = Color32::from_rgb(0xF2, 0xF4, 0xF7);
/// See [`PICTURE_TEXT`].
pub const PICTURE_WEAK: Color32 = Color32::from_rgb(0xB4, 0xBC, 0xC8);
/// See [`PICTURE_TEXT`].
pub const PICTURE_GOOD: Color32 = Color32::from_rgb(0x8F, 0xE3, 0xB4);
/// See [`PICTURE_TEXT`].
pub const PICTURE_BAD: Color32 = Color32::from_rgb(0xFF, 0xB4, 0x8F);
/// The plate of a label; nearly opaque, so that its text is readable over a white box.
pub const PICTURE_PLATE: Color32 = Color32::from_rgba_premultiplied(0x0B, 0x0D, 0x11, 0xF5);

/// The process in the plot of CPU usage.
pub const PROCESS: IntegratorStyle = IntegratorStyle {
    rgb: [0xD5, 0x5E, 0x00],
    glyph: '●',
    marker: MarkerShape::Circle,
    dash: LineStyle::Solid,
};
/// The whole computer in the plot of CPU usage.
pub const SYSTEM: IntegratorStyle = IntegratorStyle {
    rgb: [0x56, 0xB4, 0xE9],
    glyph: '○',
    dash: DASHED,
    ..PROCESS
};

const DASHED: LineStyle = LineStyle::Dashed { length: 8.0 };

/// The panel's colors in sRGB, dark and light: ground, fields on it, buttons, check boxes and sliders, text, captions,
/// errors, and the accent.
const PANEL: [u32; 2] = [0x15181D, 0xF4F5F7];
const FIELD: [u32; 2] = [0x0D0F13, 0xFFFFFF];
const BUTTON: [u32; 2] = [0x2A2F38, 0xDFE3E9];
const CONTROL: [u32; 2] = [0x6A7380, 0x838C99];
const TEXT: [u32; 2] = [0xDDE2E9, 0x1A1E25];
const WEAK: [u32; 2] = [0xA4ADBA, 0x525C69];
const ERROR: [u32; 2] = [0xFF8A80, 0xB3261E];
const ACCENT: [u32; 2] = [0x1F62C8; 2];

fn themed([dark, light]: [u32; 2], theme: Theme) -> Color32 {
    let color = if theme == Theme::Dark { dark } else { light };
    let [_, r, g, b] = color.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

/// Font sizes [points]: the headline, text, captions and numbers.
const HEADING: f32 = 19.0;
const BODY: f32 = 13.5;
const SMALL: f32 = 12.0;
const MONOSPACE: f32 = 13.0;

/// Minimum contrast of text with its ground: WCAG 2.1, 1.4.3.
const CONTRAST: f32 = 4.5;

/// Relative luminance, 0 to 1.
fn luminance(c: Color32) -> f32 {
    Srgba::rgb_u8(c.r(), c.g(), c.b()).luminance()
}

/// The contrast of a color with a ground of this luminance, 1 to 21 (WCAG 2.1).
fn contrast(color: Color32, ground: f32) -> f32 {
    let color = luminance(color);
    (color.max(ground) + 0.05) / (color.min(ground) + 0.05)
}

/// The luminance of a label's plate over white.
fn plate() -> f32 {
    luminance(PICTURE_PLATE) + 1.0 - f32::from(PICTURE_PLATE.a()) / 255.0
}

/// The color, mixed with white or black until it is readable on a ground of this luminance.
fn readable(rgb: [u8; 3], ground: f32) -> Color32 {
    let end = if ground < 0.18 { 255.0 } else { 0.0 };
    let mixed = |k: u8| {
        let share = f64::from(k) / 20.0;
        let mix = |c: u8| (f64::from(c) * (1.0 - share) + end * share) as u8;
        let [r, g, b] = rgb.map(mix);
        Color32::from_rgb(r, g, b)
    };
    let mut mixed = (0..20).map(mixed);
    let found = mixed.find(|c| contrast(*c, ground) >= CONTRAST);
    found.unwrap_or_else(|| Color32::from_gray(end as u8))
}

/// A color for text, lines and bars on the panel.
pub fn ink(rgb: [u8; 3], theme: Theme) -> Color32 {
    readable(rgb, luminance(themed(PANEL, theme)))
}

impl IntegratorStyle {
    /// The color for Bevy.
    pub fn srgb(self) -> Color {
        let [r, g, b] = self.rgb;
        Color::srgb_u8(r, g, b)
    }

    /// The color for text and lines on the panel.
    pub fn ink(self, theme: Theme) -> Color32 {
        ink(self.rgb, theme)
    }

    /// The color for marks over the picture, on plates.
    pub fn ink_on_picture(self) -> Color32 {
        readable(self.rgb, plate())
    }
}

/// Installs colors, font sizes and spacing of the panel, once per context. Text falls back to egui's monospaced font,
/// because the proportional one has no ▲ ◆ ● and no arrows.
pub fn install(ctx: &Context, light: bool) {
    ctx.set_theme(if light { Theme::Light } else { Theme::Dark });
    let done = Id::new("box_game style");
    if ctx.data(|data| data.get_temp::<()>(done)).is_some() {
        return;
    }
    ctx.data_mut(|data| data.insert_temp(done, ()));
    for theme in [Theme::Dark, Theme::Light] {
        ctx.style_mut_of(theme, |style| dress(style, theme));
    }
    let mut fonts = FontDefinitions::default();
    let symbols = fonts.families[&FontFamily::Monospace].clone();
    let text = fonts.families.entry(FontFamily::Proportional).or_default();
    for font in symbols {
        if !text.contains(&font) {
            text.push(font);
        }
    }
    ctx.set_fonts(fonts);
}

/// Text of labels in the picture.
pub const PICTURE_FONT: FontId = FontId::proportional(14.0);

fn dress(style: &mut egui::Style, theme: Theme) {
    let color = |color| themed(color, theme);
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
    visuals.panel_fill = color(PANEL);
    visuals.window_fill = color(PANEL);
    visuals.extreme_bg_color = color(FIELD);
    visuals.weak_text_color = Some(color(WEAK));
    visuals.error_fg_color = color(ERROR);
    visuals.selection.bg_fill = color(ACCENT);
    visuals.selection.stroke.color = Color32::WHITE;
    visuals.hyperlink_color = color(ACCENT);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke.color = color(TEXT);
    widgets.inactive.fg_stroke.color = color(TEXT);
    widgets.inactive.weak_bg_fill = color(BUTTON);
    for state in [&mut widgets.inactive, &mut widgets.hovered] {
        state.bg_fill = color(CONTROL);
    }
    for state in [&mut widgets.noninteractive, &mut widgets.inactive] {
        state.corner_radius = egui::CornerRadius::same(4);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Minimum contrast of a control with its ground, and of the mark in it: WCAG 2.1, 1.4.11.
    const OUTLINE: f32 = 3.0;

    /// Text is readable on the panel and its controls, in the picture, and in the integrators' colors, in both themes.
    #[test]
    fn text_can_be_read() {
        let ctx = Context::default();
        let _ = ctx.run_ui(egui::RawInput::default(), |ui| install(ui.ctx(), false));
        for theme in [Theme::Dark, Theme::Light] {
            let style = ctx.style_of(theme);
            // No text is smaller than the captions, which have 12 points.
            assert!(style.text_styles.values().all(|font| font.size >= 12.0));
            let visuals = &style.visuals;
            let (panel, field) = (visuals.panel_fill, visuals.extreme_bg_color);
            let check = |name: &str, text: Color32, ground: Color32| {
                let contrast = contrast(text, luminance(ground));
                assert!(contrast >= CONTRAST, "{theme:?} {name}: {contrast}");
            };
            for ground in [panel, field, visuals.window_fill, visuals.faint_bg_color] {
                // A faint ground is added to that of the panel.
                let ground = if ground.a() == 0 {
                    panel + ground
                } else {
                    ground
                };
                check("text", visuals.text_color(), ground);
                check("caption", visuals.weak_text_color(), ground);
                check("heading", visuals.strong_text_color(), ground);
                check("error", visuals.error_fg_color, ground);
            }
            let selection = &visuals.selection;
            check("selected", selection.stroke.color, selection.bg_fill);
            let widgets = &visuals.widgets;
            let states = [
                &widgets.inactive,
                &widgets.hovered,
                &widgets.active,
                &widgets.open,
            ];
            for (state, k) in states.into_iter().zip(0..) {
                check(
                    &format!("control {k}"),
                    state.text_color(),
                    state.weak_bg_fill,
                );
            }
            for state in [&widgets.inactive, &widgets.hovered] {
                let fill = luminance(state.bg_fill);
                assert!(contrast(panel, fill) >= OUTLINE, "{theme:?}: check box");
                assert!(
                    contrast(state.text_color(), fill) >= OUTLINE,
                    "{theme:?}: tick"
                );
            }
            for &integrator in Integrator::ALL {
                check(integrator.name(), of(integrator).ink(theme), panel);
            }
        }
        let words = [PICTURE_TEXT, PICTURE_WEAK, PICTURE_GOOD, PICTURE_BAD];
        let captions = [TEXT, WEAK, ERROR].map(|color| themed(color, Theme::Dark));
        let marks = Integrator::ALL.iter().map(|&i| of(i).ink_on_picture());
        for text in words.into_iter().chain(captions).chain(marks) {
            assert!(contrast(text, plate()) >= CONTRAST, "{text:?}");
        }
        let black_on_white = contrast(Color32::BLACK, luminance(Color32::WHITE));
        assert!((black_on_white - 21.0).abs() < 21.0 * 4.0 * f32::EPSILON);
    }
}
