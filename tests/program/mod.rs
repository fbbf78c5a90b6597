//! The program `box_report`, as the tests start it.

#![allow(dead_code, reason = "each test uses a part")]

use std::path::Path;
use std::process::Command;

/// The result of a run.
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Ran {
    /// Asserts that the run was successful.
    #[track_caller]
    pub(crate) fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self
    }
}

/// `box_report` with the words of `line`; each `{}` is the next of `paths`.
pub(crate) fn command(line: &str, paths: &[&Path]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_box_report"));
    let mut paths = paths.iter();
    for word in line.split_whitespace() {
        match word {
            "{}" => command.arg(paths.next().expect("a path for each {}")),
            _ => command.arg(word),
        };
    }
    command
}

/// Runs [`command`] to its end.
pub(crate) fn run(line: &str, paths: &[&Path]) -> Ran {
    let output = command(line, paths).output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    Ran {
        code: output.status.code(),
        out: text(output.stdout),
        err: text(output.stderr),
    }
}
