//! Faults in a user's game: nothing panics, other bodies are unaffected, and each fault is reported once, not
//! every frame.

#[path = "faults/entities.rs"]
mod entities;
#[path = "faults/nonsense.rs"]
mod nonsense;
#[path = "faults/settings.rs"]
mod settings;
#[path = "faults/time.rs"]
mod time;
mod world;

use std::sync::{Mutex, MutexGuard};

use bevy::prelude::*;
use box_physics::prelude::*;

use world::{Play, app, brick, tumbling};

/// Collects the library's log messages from now on. Tests that use it run one at a time.
struct Log(MutexGuard<'static, ()>);

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Collector;

impl log::Log for Collector {
    fn enabled(&self, _: &log::Metadata) -> bool {
        true
    }
    fn log(&self, record: &log::Record) {
        if record.level() <= log::Level::Warn && record.target().starts_with("box_physics") {
            let line = record.args().to_string();
            LINES
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
                .push(line);
        }
    }
    fn flush(&self) {}
}

impl Log {
    fn start() -> Self {
        let guard = ONE_AT_A_TIME
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        // A second call fails, which is fine.
        let _ = log::set_logger(&Collector);
        log::set_max_level(log::LevelFilter::Warn);
        let log = Self(guard);
        log.take();
        log
    }

    fn take(&self) -> Vec<String> {
        let () = *self.0;
        std::mem::take(
            &mut *LINES
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner),
        )
    }

    /// Asserts that there is one message since the last call, and that it contains `words`.
    #[track_caller]
    fn says_once(&self, words: &str) {
        let lines = self.take();
        assert_eq!(lines.len(), 1, "{lines:#?}");
        assert!(lines[0].contains(words), "{lines:#?} lacks '{words}'");
    }

    #[track_caller]
    fn is_silent(&self) {
        let lines = self.take();
        assert!(lines.is_empty(), "{lines:#?}");
    }
}

#[track_caller]
fn assert_shown_sanely(app: &mut App) {
    let mut all = app.world_mut().query::<(&Transform, &BodyState)>();
    for (transform, state) in all.iter(app.world()) {
        assert!(transform.translation.is_finite() && transform.rotation.is_finite());
        assert!(state.is_valid());
    }
}
