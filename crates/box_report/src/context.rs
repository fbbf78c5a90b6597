//! Shared context of the report's parts: options, output folder, progress and interruption.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use box_bench::measure::{Contender, Cost, Settings, interleaved};
use box_physics::integrators::Integrator;
use indicatif::ProgressBar;

/// Reasons why a part ends without a result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Stop {
    /// Ctrl-C.
    #[error("interrupted; the finished parts are in the output folder")]
    Interrupted,
    /// A file or folder cannot be written or read.
    #[error("{path}: {source}")]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// Invalid use of the command line; the message lists what is allowed.
    #[error("{0}")]
    Usage(String),
    /// A number differs from the stored one.
    #[error("{0}")]
    Changed(String),
    /// An external program failed.
    #[error("{0}")]
    Failed(String),
    /// An internal error.
    #[error("{0}")]
    Internal(String),
}

/// A flag that Ctrl-C sets; a second Ctrl-C ends the program at once.
#[derive(Clone, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Installs the handler of Ctrl-C and of termination requests.
    pub(crate) fn listen() -> Result<Self, Stop> {
        let this = Self::default();
        // Compiled for browsers, which have no signals, only with the rest of the workspace.
        #[cfg(any(unix, windows))]
        {
            let flag = this.0.clone();
            ctrlc::set_handler(move || {
                if flag.swap(true, Ordering::Relaxed) {
                    std::process::exit(i32::from(crate::INTERRUPTED));
                }
            })
            .map_err(|e| Stop::Internal(format!("cannot listen for Ctrl-C: {e}")))?;
        }
        Ok(this)
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Shared context of all parts of the report.
pub(crate) struct Context {
    /// Output folder.
    pub(crate) folder: PathBuf,
    /// The integrators to compare.
    pub(crate) integrators: Vec<Integrator>,
    /// Fewer steps and samples: it takes seconds instead of minutes, and the times are noisier.
    pub(crate) quick: bool,
    /// Progress bar, shown only on a terminal.
    pub(crate) progress: ProgressBar,
    pub(crate) interrupt: Interrupt,
}

/// Minimum and maximum number of samples per contender. Within these limits, the time available decides.
const SAMPLES: (usize, usize) = (7, 60);

impl Context {
    /// Path of a file in the output folder.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Counts one unit of work as done, with the message `what`. Returns an error if Ctrl-C was pressed.
    pub(crate) fn tick(&self, what: &str) -> Result<(), Stop> {
        self.progress.set_message(what.to_owned());
        self.progress.inc(1);
        if self.interrupt.is_set() {
            return Err(Stop::Interrupted);
        }
        Ok(())
    }

    /// Times the contenders in turns. They share the time `share`.
    pub(crate) fn measure(&self, contenders: &mut [Contender<'_>], share: Duration) -> Vec<Cost> {
        let settings = if self.quick {
            Settings {
                shortest_sample: Duration::from_micros(20),
                samples: (3, 3),
                ..Settings::default()
            }
        } else {
            Settings {
                samples: SAMPLES,
                budget: share,
                ..Settings::default()
            }
        };
        interleaved(contenders, &settings)
    }
}

/// Description of the time measurement, for the text of the report.
pub(crate) const SAMPLES_IN_WORDS: &str = "minimum of 7 to 60 samples of at least 100 µs, integrators timed in turns on the same bodies in one run";
