//! Origin of measured numbers: processor, compiler, commit and date.

use std::fmt;
use std::path::Path;
use std::process::Command;

use serde::{Deserialize, Serialize};

/// The provenance of a measurement.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor.
    pub processor: String,
    /// Vector instruction set used by the integrators' SIMD lanes.
    #[serde(default)]
    pub features: String,
    /// Number of hardware threads.
    pub threads: usize,
    /// The operating system.
    pub system: String,
    /// Date of the measurement, year-month-day, UTC.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// Version of the compiler.
    #[serde(default)]
    pub compiler: String,
    /// Commit, with `-dirty` for a modified working tree; empty outside of a repository.
    #[serde(default)]
    pub commit: String,
}

impl Machine {
    /// Describes this machine at the current time.
    pub fn this() -> Self {
        Self {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            features: features().to_owned(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS.to_owned(),
            date: jiff::Timestamp::now().strftime("%Y-%m-%d").to_string(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            compiler: env!("COMPILER").to_owned(),
            commit: commit().unwrap_or_default(),
        }
    }
}

impl fmt::Display for Machine {
    /// One line; unknown values are omitted.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let threads = format!("{} threads", self.threads);
        let commit = match self.commit.as_str() {
            "" => String::new(),
            commit => format!("commit {commit}"),
        };
        let parts = [
            &self.processor,
            &threads,
            &self.features,
            &self.system,
            &self.compiler,
            &commit,
            &self.date,
        ];
        let parts: Vec<&str> = parts.iter().map(|p| p.as_str()).collect();
        let known: Vec<&str> = parts.into_iter().filter(|p| !p.is_empty()).collect();
        f.write_str(&known.join(", "))
    }
}

/// The processor's name in `/proc/cpuinfo`, if available.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    let (_, name) = line.split_once(':')?;
    Some(name.trim().to_owned())
}

#[cfg(target_arch = "x86_64")]
fn features() -> &'static str {
    if std::is_x86_feature_detected!("avx2") {
        "AVX2"
    } else {
        "SSE2"
    }
}

#[cfg(not(target_arch = "x86_64"))]
const fn features() -> &'static str {
    ""
}

fn commit() -> Option<String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let describe = [
        "describe",
        "--always",
        "--dirty",
        "--abbrev=10",
        "--exclude=*",
    ];
    let mut git = Command::new("git");
    let output = git.current_dir(here).args(describe).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_names_what_is_known_and_reads_older_results() {
        let line = Machine::this().to_string();
        assert!(
            line.contains("rustc 1.") && line.contains("threads"),
            "{line}"
        );
        let old =
            r#"{"processor":"A","threads":2,"system":"linux","date":"2026-01-02","version":"0"}"#;
        let old: Machine = serde_json::from_str(old).expect("readable");
        assert_eq!(old.to_string(), "A, 2 threads, linux, 2026-01-02");
    }
}
