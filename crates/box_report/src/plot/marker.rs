//! Markers, drawn in pixels around a point.

use box_scenarios::style::{Marker, Style};
use plotters::element::{DynElement, IntoDynElement};
use plotters::prelude::*;

use super::{Area, Chart, DrawResult, color};

/// Half the size of a marker \[px\].
const R: i32 = 5;

type Shape<'a> = DynElement<'static, SVGBackend<'a>, (i32, i32)>;

/// The elements of a marker around (0, 0).
fn shapes<'a>(style: Style) -> Vec<Shape<'a>> {
    let filled = |corners: &[(i32, i32)]| {
        vec![Polygon::new(corners.to_vec(), color(style).filled()).into_dyn()]
    };
    let strokes = |ends: &[[(i32, i32); 2]]| {
        let stroke = color(style).stroke_width(2);
        let path = |e: &[(i32, i32); 2]| PathElement::new(e.to_vec(), stroke).into_dyn();
        ends.iter().map(path).collect::<Vec<_>>()
    };
    let d = R - 1;
    match style.marker {
        Marker::Circle => vec![Circle::new((0, 0), R - 1, color(style).filled()).into_dyn()],
        Marker::Diamond => filled(&[(0, -R), (R, 0), (0, R), (-R, 0)]),
        Marker::Square => filled(&[(-d, -d), (d, -d), (d, d), (-d, d)]),
        Marker::Cross => strokes(&[[(-d, -d), (d, d)], [(-d, d), (d, -d)]]),
        Marker::Plus => strokes(&[[(-R, 0), (R, 0)], [(0, -R), (0, R)]]),
        Marker::Up => filled(&[(0, -R), (R, d), (-R, d)]),
        Marker::Down => filled(&[(0, R), (R, -d), (-R, -d)]),
        Marker::Left => filled(&[(-R, 0), (d, -R), (d, R)]),
        Marker::Right => filled(&[(R, 0), (-d, -R), (-d, R)]),
        Marker::Asterisk => strokes(&[[(-R, 0), (R, 0)], [(-3, -R), (3, R)], [(-3, R), (3, -R)]]),
    }
}

/// Draws a marker at the coordinates `at` of the chart.
pub(super) fn draw(chart: &mut Chart, at: (f64, f64), style: Style) -> DrawResult {
    let area = chart.plotting_area();
    let pixel = area.map_coordinate(&at);
    let area = area.strip_coord_spec();
    let (left, top) = area.get_base_pixel();
    draw_in(&area, (pixel.0 - left, pixel.1 - top), style)
}

/// Draws a marker at the pixel `at` of `area`.
pub(super) fn draw_in(area: &Area, at: (i32, i32), style: Style) -> DrawResult {
    for shape in shapes(style) {
        area.draw(&(EmptyElement::at(at) + shape))?;
    }
    Ok(())
}
