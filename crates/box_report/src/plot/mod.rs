//! Figures as SVG: axes with decades and units, lines and markers in the common styles of the integrators, the legend
//! to the right of the chart, and gaps where runs failed.

mod axis;
mod marker;

use box_physics::integrators::Integrator;
use box_scenarios::style::{Dash, Marker, Style, style};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

pub(crate) use axis::Axis;
use axis::Range;

/// Width and height of a figure \[px\].
const SIZE: (u32, u32) = (960, 540);
/// Width of the legend \[px\].
const LEGEND: i32 = 270;
/// Margin around the plotting area \[px\].
const MARGIN: u32 = 14;
const X_LABELS: u32 = 46;
const Y_LABELS: u32 = 66;
const FONT: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

/// A point of a line: x, y, and the lowest and highest y of the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) scatter: Option<(f64, f64)>,
}

impl Point {
    pub(crate) fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            scatter: None,
        }
    }
}

/// A line of a figure.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) label: String,
    pub(crate) style: Style,
    /// The points; `None` is a gap where the run failed.
    pub(crate) points: Vec<Option<Point>>,
    /// `true` if each point has a marker; long lines have none.
    pub(crate) markers: bool,
}

impl Line {
    /// A line in the style of `integrator`, with the label `label`.
    pub(crate) fn of(integrator: Integrator, label: String, points: Vec<Option<Point>>) -> Self {
        Self {
            label,
            style: style(integrator),
            points,
            markers: true,
        }
    }

    /// Returns this line without markers at its points.
    pub(crate) fn unmarked(self) -> Self {
        Self {
            markers: false,
            ..self
        }
    }
}

/// A figure.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) lines: Vec<Line>,
}

/// The drawing area of plotters.
type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type DrawResult = Result<(), Box<dyn core::error::Error>>;

impl Plot {
    /// Draws the figure as SVG. Points that an axis cannot show (not finite, or not positive on a logarithmic axis)
    /// become gaps. A figure without any point has empty axes; that is not an error.
    ///
    /// # Errors
    /// The error message of plotters.
    pub(crate) fn svg(&self) -> Result<String, String> {
        let mut text = String::new();
        self.draw(&mut text)
            .map_err(|e| format!("cannot draw '{}': {e}", self.title))?;
        Ok(text)
    }

    fn draw(&self, text: &mut String) -> DrawResult {
        let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let (left, right) = root.split_horizontally(SIZE.0 as i32 - LEGEND);
        let shown = |select: fn(&Point) -> f64| {
            let points = self.lines.iter().flat_map(|l| l.points.iter().flatten());
            points.map(select).collect::<Vec<_>>()
        };
        let x = self.x.range(&shown(|p| p.x));
        let y = self.y.range(&shown(|p| p.y));
        let mut chart = ChartBuilder::on(&left)
            .margin(MARGIN)
            .caption(&self.title, (FONT, 19))
            .x_label_area_size(X_LABELS)
            .y_label_area_size(Y_LABELS)
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .bold_line_style(RGBColor(200, 200, 200))
            .light_line_style(RGBColor(238, 238, 238))
            .x_labels(64)
            .y_labels(64)
            .max_light_lines(0)
            .x_label_formatter(&|v| x.label(*v))
            .y_label_formatter(&|v| y.label(*v))
            .x_desc(&self.x.title)
            .y_desc(&self.y.title)
            .label_style((FONT, 14))
            .axis_desc_style((FONT, 15))
            .draw()?;
        for line in &self.lines {
            let place = |p: &Point| x.place(p.x).zip(y.place(p.y));
            let places: Vec<_> = line
                .points
                .iter()
                .map(|p| p.as_ref().and_then(place))
                .collect();
            for run in places.split(Option::is_none) {
                let run: Vec<(f64, f64)> = run.iter().copied().flatten().collect();
                if run.len() > 1 {
                    draw_run(&mut chart, run, line.style)?;
                }
            }
            for p in line.points.iter().flatten() {
                if let (Some((low, high)), Some(at)) = (p.scatter, x.place(p.x))
                    && let Some((low, high)) = y.place(low).zip(y.place(high))
                {
                    let bar = color(line.style).mix(0.6).stroke_width(1);
                    let path = PathElement::new(vec![(at, low), (at, high)], bar);
                    chart.draw_series([path])?;
                }
            }
            if line.markers {
                for at in places.into_iter().flatten() {
                    marker::draw(&mut chart, at, line.style)?;
                }
            }
        }
        legend(&right, &self.lines)?;
        root.present()?;
        Ok(())
    }
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Range, Range>>;

fn color(style: Style) -> RGBColor {
    let [r, g, b] = style.color;
    RGBColor(r, g, b)
}

/// Length of a dash and of the gap after it \[px\]; `None` for a solid line.
fn dashes(dash: Dash) -> Option<(i32, i32)> {
    match dash {
        Dash::Solid => None,
        Dash::Dashed => Some((9, 5)),
        Dash::Dotted => Some((2, 4)),
        Dash::Long => Some((20, 6)),
    }
}

fn draw_run(chart: &mut Chart, run: Vec<(f64, f64)>, style: Style) -> DrawResult {
    let stroke = color(style).stroke_width(2);
    match dashes(style.dash) {
        None => chart.draw_series(LineSeries::new(run, stroke))?,
        Some((on, off)) => chart.draw_series(DashedLineSeries::new(run, on, off, stroke))?,
    };
    Ok(())
}

fn legend(area: &Area, lines: &[Line]) -> DrawResult {
    const ROW: i32 = 24;
    const SAMPLE: i32 = 34;
    let top = 52;
    for (k, line) in lines.iter().enumerate() {
        let y = top + ROW * k as i32;
        let stroke = color(line.style).stroke_width(2);
        let ends = vec![(0, y), (SAMPLE, y)];
        match dashes(line.style.dash) {
            None => area.draw(&PathElement::new(ends, stroke))?,
            Some((on, off)) => area.draw(&DashedPathElement::new(ends, on, off, stroke))?,
        }
        if line.markers {
            marker::draw_in(area, (SAMPLE / 2, y), line.style)?;
        }
        let text = TextStyle::from((FONT, 14)).pos(plotters::style::text_anchor::Pos::new(
            plotters::style::text_anchor::HPos::Left,
            plotters::style::text_anchor::VPos::Center,
        ));
        area.draw(&Text::new(line.label.clone(), (SAMPLE + 8, y), text))?;
    }
    Ok(())
}

/// The style of a line that is not an integrator of the list: black.
pub(crate) const fn plain(dash: Dash, marker: Marker) -> Style {
    Style {
        color: [0, 0, 0],
        dash,
        marker,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<Option<Point>>) -> String {
        let split = Integrator::Split;
        let line = Line::of(split, "split (dt^p, p = 2.0)".to_owned(), points);
        let plot = Plot {
            title: "A < B".to_owned(),
            x: Axis::log("error [rad]"),
            y: Axis::log("time [µs/s]"),
            lines: vec![line],
        };
        plot.svg().expect("drawn")
    }

    fn at(x: f64, y: f64) -> Option<Point> {
        Some(Point::new(x, y))
    }

    #[test]
    fn a_failed_run_breaks_the_line() {
        let whole = plot(vec![
            at(1e-2, 1.0),
            at(1e-3, 2.0),
            at(1e-4, 4.0),
            at(1e-5, 8.0),
        ]);
        let broken = plot(vec![
            at(1e-2, 1.0),
            at(1e-3, 2.0),
            None,
            at(1e-4, 4.0),
            at(1e-5, 8.0),
        ]);
        let color = "#D55E00";
        let lines = |svg: &str| {
            svg.lines()
                .filter(|l| l.contains("<polyline") && l.contains(color))
                .count()
        };
        assert_eq!(lines(&broken), lines(&whole) + 1, "{broken}");
        // An infinite value is a gap too.
        let infinite = plot(vec![
            at(1e-2, 1.0),
            at(1e-3, 2.0),
            at(f64::INFINITY, 3.0),
            at(1e-4, 4.0),
            at(1e-5, 8.0),
        ]);
        assert_eq!(lines(&infinite), lines(&broken));
        assert!(whole.contains("p = 2.0") && whole.contains("A &lt; B"));
    }

    #[test]
    fn nothing_to_show_is_still_a_figure() {
        assert!(plot(vec![None, None]).contains("</svg>"));
    }
}
