//! What the numbers were measured on, and when.

use serde::{Deserialize, Serialize};

/// The class of machine, and the date.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Machine {
    /// The processor, as it names itself.
    pub(crate) processor: String,
    /// How many threads it runs at once.
    pub(crate) threads: usize,
    pub(crate) system: String,
    /// Year-month-day, UTC.
    pub(crate) date: String,
    /// Version of the report.
    pub(crate) version: String,
}

impl Machine {
    pub(crate) fn this() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS.to_owned(),
            date: jiff::Timestamp::now().strftime("%Y-%m-%d").to_string(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}

/// The name in Linux's list of processors, where there is one.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    let (_, name) = line.split_once(':')?;
    Some(name.trim().to_owned())
}
