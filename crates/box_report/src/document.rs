//! The result of a part of the report, and the pages generated from results: `report.md`, `report.html` (one file that
//! contains the figures) and the digest `results.md`.

use std::collections::BTreeMap;
use std::path::Path;

use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, Value, context};
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd, html};
use serde::Serialize;

use crate::context::{SAMPLES_IN_WORDS, Stop};
use crate::files;
use box_bench::machine::Machine;

/// A part of the report.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Section {
    /// The name of the subcommand.
    pub(crate) id: &'static str,
    pub(crate) title: &'static str,
    /// Summary of the measurement and its method, in a few sentences.
    pub(crate) intro: String,
    /// The method in detail, shown at the end of the section; may be empty.
    pub(crate) method: String,
    /// Conclusions: sentences that contain the measured values.
    pub(crate) verdicts: Vec<String>,
    pub(crate) figures: Vec<Figure>,
    pub(crate) tables: Vec<Table>,
    /// Additional files of the part: name and contents.
    pub(crate) files: Vec<(String, String)>,
}

/// A figure as SVG.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Figure {
    /// File name without extension.
    pub(crate) id: String,
    /// Description of what the figure shows.
    pub(crate) caption: String,
    #[serde(skip)]
    pub(crate) svg: String,
    /// `true` if the figure also appears in the digest.
    pub(crate) digest: bool,
}

/// A table of the report; its data are in a CSV file.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Table {
    pub(crate) title: String,
    /// Explanation of the columns whose headings are not enough.
    pub(crate) note: String,
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
    /// Name of the file with the data.
    pub(crate) csv: String,
}

impl Section {
    pub(crate) fn new(id: &'static str, title: &'static str, intro: impl Into<String>) -> Self {
        Self {
            id,
            title,
            intro: intro.into(),
            method: String::new(),
            verdicts: Vec::new(),
            figures: Vec::new(),
            tables: Vec::new(),
            files: Vec::new(),
        }
    }

    /// Writes the figures into `folder`.
    pub(crate) fn write_figures(&self, folder: &Path) -> Result<(), Stop> {
        for f in &self.figures {
            files::write(&folder.join(format!("{}.svg", f.id)), &f.svg)?;
        }
        Ok(())
    }
}

/// The contents of all pages.
pub(crate) struct Document<'a> {
    pub(crate) sections: &'a [Section],
    /// Requested parts that were not finished.
    pub(crate) missing: &'a [String],
    pub(crate) machine: &'a Machine,
    /// Duration of the run \[s\].
    pub(crate) seconds: f64,
    pub(crate) quick: bool,
}

const MARKDOWN: &str = include_str!("../templates/report.md");
const HTML: &str = include_str!("../templates/report.html");
const DIGEST: &str = include_str!("../templates/results.md");

impl Document<'_> {
    /// Writes `report.md` and `report.html` into `folder`.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), Stop> {
        let markdown = self.render("report.md", MARKDOWN)?;
        files::write(&folder.join("report.md"), &markdown)?;
        let figures = self.sections.iter().flat_map(|s| &s.figures);
        let figures = figures.map(|f| (format!("{}.svg", f.id), f.svg.trim()));
        let body = html_body(&markdown, &figures.collect());
        files::write(
            &folder.join("report.html"),
            &HTML.replace("{{ body }}", &body),
        )
    }

    /// Writes the digest into `docs`: `results.md` (the first table of the summary, the figures marked for it, other
    /// engines) and `results/*.svg`.
    pub(crate) fn write_digest(&self, docs: &Path) -> Result<(), Stop> {
        let figures = docs.join("results");
        files::create_folder(&figures)?;
        for f in self.sections.iter().flat_map(|s| &s.figures) {
            if f.digest {
                files::write(&figures.join(format!("{}.svg", f.id)), &f.svg)?;
            }
        }
        files::write(
            &docs.join("results.md"),
            &self.render("results.md", DIGEST)?,
        )
    }

    fn render(&self, name: &str, template: &str) -> Result<String, Stop> {
        let mut environment = Environment::new();
        environment.add_filter("cell", |s: String| s.replace('|', "\\|"));
        let failed = |e: minijinja::Error| Stop::Internal(format!("template {name}: {e:#}"));
        let syntax = SyntaxConfig::builder()
            .trim_blocks(true)
            .lstrip_blocks(true)
            .keep_trailing_newline(true)
            .build()
            .map_err(failed)?;
        environment.set_syntax(syntax);
        environment.add_template(name, template).map_err(failed)?;
        let page = environment.get_template(name).map_err(failed)?;
        page.render(context! {
            sections => plain(&self.sections)?,
            missing => plain(&self.missing)?,
            machine => context! { version => &self.machine.version, line => self.machine.to_string() },
            seconds => self.seconds.round() as u64,
            quick => self.quick,
            samples => SAMPLES_IN_WORDS,
        })
        .map_err(failed)
    }
}

/// Converts `data` for a template.
fn plain(data: &impl Serialize) -> Result<Value, Stop> {
    fn value(json: serde_json::Value) -> Value {
        match json {
            serde_json::Value::Null => Value::from(()),
            serde_json::Value::Bool(b) => Value::from(b),
            serde_json::Value::Number(n) => n
                .as_i64()
                .map_or_else(|| Value::from(n.as_f64().unwrap_or(f64::NAN)), Value::from),
            serde_json::Value::String(s) => Value::from(s),
            serde_json::Value::Array(a) => a.into_iter().map(value).collect(),
            serde_json::Value::Object(o) => {
                let fields = o.into_iter().map(|(k, v)| (k, value(v)));
                Value::from(fields.collect::<BTreeMap<String, Value>>())
            }
        }
    }
    serde_json::to_value(data)
        .map(value)
        .map_err(|e| Stop::Internal(format!("data of the pages: {e}")))
}

/// Renders `markdown` as the body of an HTML page; each image of a figure is replaced by its SVG.
fn html_body(markdown: &str, figures: &BTreeMap<String, &str>) -> String {
    let mut in_figure = false;
    let events =
        Parser::new_ext(markdown, Options::ENABLE_TABLES).filter_map(|event| match event {
            Event::Start(Tag::Image { ref dest_url, .. }) => match figures.get(dest_url.as_ref()) {
                Some(svg) => {
                    in_figure = true;
                    Some(Event::InlineHtml((*svg).to_owned().into()))
                }
                None => Some(event),
            },
            Event::End(TagEnd::Image) if in_figure => {
                in_figure = false;
                None
            }
            // Skip the text of an image because its caption repeats it.
            _ if in_figure => None,
            _ => Some(event),
        });
    let mut body = String::new();
    html::push_html(&mut body, events);
    body
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_tables_escapes_and_its_figures_inside() {
        let markdown =
            "# **a** `b` <c> & 1\n\n| x |\n|---|\n| `y` |\n\n![what it shows](one.svg)\n";
        let figures = BTreeMap::from([("one.svg".to_owned(), "<svg>1</svg>")]);
        let html = html_body(markdown, &figures);
        for part in [
            "<strong>a</strong> <code>b</code>",
            "&amp; 1",
            "<td><code>y</code></td>",
            "<p><svg>1</svg></p>",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        assert!(!html.contains("what it shows"));
    }
}
