//! What is being done, how many steps are done, how long it will take: on a terminal only.

use indicatif::{ProgressBar, ProgressStyle};

/// A line at the bottom of the terminal; nothing where standard error is not one.
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// For `steps` steps of work.
    pub(crate) fn new(steps: u64) -> Self {
        let bar = ProgressBar::new(steps);
        let style = ProgressStyle::with_template(
            "{bar:28} {pos}/{len} steps, {elapsed} gone, about {eta} left  {msg}",
        );
        if let Ok(style) = style {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// A step is done; `what` comes next or was it.
    pub(crate) fn tick(&self, what: &str) {
        self.bar.set_message(what.to_owned());
        self.bar.inc(1);
    }

    /// A line above the bar, or on standard error where there is no bar.
    pub(crate) fn say(&self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }

    /// Removes the line.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
