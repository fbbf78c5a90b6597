//! What every part of the report works with: options, folder, progress, the wish to stop.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use box_bench::measure::{Contender, Cost, Settings, interleaved};
use box_physics::integrators::Integrator;
use indicatif::ProgressBar;

/// Why a part ended without a result.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Stop {
    /// Ctrl-C.
    #[error("interrupted; the finished parts are in the output folder")]
    Interrupted,
    /// A file or folder cannot be written or read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The command line makes no sense here; the message lists what is allowed.
    #[error("{0}")]
    Usage(String),
    /// A number differs from the stored one.
    #[error("{0}")]
    Changed(String),
    /// A program that was called did not do its work.
    #[error("{0}")]
    Failed(String),
    /// A mistake of ours.
    #[error("{0}")]
    Internal(String),
}

/// Set by Ctrl-C; a second Ctrl-C ends the program at once.
#[derive(Clone, Default)]
pub(crate) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens for Ctrl-C and for being asked to end.
    pub(crate) fn listen() -> Result<Self, Stop> {
        let this = Self::default();
        let flag = this.0.clone();
        ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(i32::from(crate::INTERRUPTED));
            }
        })
        .map_err(|e| Stop::Internal(format!("cannot listen for Ctrl-C: {e}")))?;
        Ok(this)
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The surroundings of a part.
pub(crate) struct Context {
    /// Where the files go.
    pub(crate) folder: PathBuf,
    /// The integrators to compare.
    pub(crate) integrators: Vec<Integrator>,
    /// Fewer steps and samples: seconds instead of minutes, noisier.
    pub(crate) quick: bool,
    /// On a terminal only.
    pub(crate) progress: ProgressBar,
    pub(crate) interrupt: Interrupt,
}

/// Samples per contender, at least and at most: as many as the share of time allows.
const SAMPLES: (usize, usize) = (7, 60);

impl Context {
    /// A file of the folder.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// One step of work is done; stops if that is wished.
    pub(crate) fn tick(&self, what: &str) -> Result<(), Stop> {
        self.progress.set_message(what.to_owned());
        self.progress.inc(1);
        if self.interrupt.is_set() {
            return Err(Stop::Interrupted);
        }
        Ok(())
    }

    /// Times contenders in turns; `share` is the time for that.
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

/// How times are measured, for the text of the report.
pub(crate) const SAMPLES_IN_WORDS: &str = "minimum of 7 to 60 samples of at least 100 µs, integrators timed in turns on the same bodies in one run";
