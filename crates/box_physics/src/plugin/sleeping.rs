//! Sleep: a box at rest on the floor is skipped until something could move it.
//!
//! A box falls asleep in the second consecutive step at rest, if only gravity acts on it and it has no `Friction` or
//! `Restitution`. From then on it is not stepped, its bounding box is not refitted and its `Transform` is not written.
//! It wakes when:
//!
//! | event | detected by |
//! |---|---|
//! | its `BodyState` is written: by your systems, an impulse or a teleport | change detection |
//! | its `RigidBox` or `ContactState` is written | change detection |
//! | it gets a force component, `GravityScale`, `Friction`, `Restitution` or `ReportPersisting` | its new table |
//! | `WorldGravity`, the `Floor` or a `StaticPlane` changes, or the floor moves | comparison with the last step |
//! | a step runs without it: `Disabled`, `Quarantined`, no floor | the number of the step |
//!
//! The physics itself moves bodies without marking them as changed. A `Transform` overwritten by other code is written
//! again without waking the box.

use core::ops::Range;

use bevy::ecs::change_detection::Tick;
use bevy::ecs::component::Component;
use bevy::ecs::resource::Resource;
use glam::DVec3;

use super::chunks::runs_of;
use super::forces::Step;
use crate::floor::{Floor, Plane};

/// The last run of *Contact* in which the body slept; 0 if it is awake.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sleep(u32);

/// Number of the current run of *Contact*, and the surroundings in the last run.
#[derive(Resource)]
pub(crate) struct SleepClock {
    run: u32,
    surroundings: Option<(DVec3, Option<Floor>)>,
    planes: Vec<Plane>,
    unchanged: bool,
}

impl Default for SleepClock {
    fn default() -> Self {
        Self {
            run: 1,
            surroundings: None,
            planes: Vec::new(),
            unchanged: false,
        }
    }
}

impl SleepClock {
    /// Begins a run of *Contact*. Runs without a floor count too, because bodies that slept before them may have moved.
    pub(crate) fn begin_run(&mut self, step: &Step) {
        self.run = self.run.checked_add(1).unwrap_or(2);
        let now = step.has_contact().then_some((step.gravity, step.floor));
        let velocity = step.floor.map_or(DVec3::ZERO, |floor| floor.velocity);
        let still = now.is_some() && velocity == DVec3::ZERO;
        self.unchanged = still && self.surroundings == now && self.planes == step.planes;
        self.surroundings = now;
        self.planes.clone_from(&step.planes);
    }

    /// Calls `work` for the rows of a chunk that a pass after *Contact* must process: awake bodies, and sleeping bodies
    /// with a change in one of the columns.
    pub(crate) fn on_awake<const N: usize>(
        &self,
        sleep: &[Sleep],
        changes: &Changes<'_, N>,
        mut work: impl FnMut(Range<usize>),
    ) {
        // Tests the whole chunk first, without a branch per row.
        if !sleep.iter().fold(false, |any, s| any | (s.0 == self.run)) {
            return work(0..sleep.len());
        }
        let any_change = changes.any(0..sleep.len());
        let awake = |i: usize| sleep[i].0 != self.run || (any_change && changes.any(i..i + 1));
        runs_of(sleep.len(), awake).for_each(work);
    }
}

/// Columns of change ticks, and the interval in which a change counts.
#[derive(Clone, Copy)]
pub(crate) struct Changes<'a, const N: usize> {
    pub(crate) columns: [&'a [Tick]; N],
    /// Tick of the system's last run.
    pub(crate) last: Tick,
    pub(crate) now: Tick,
}

impl<const N: usize> Changes<'_, N> {
    /// Returns `true` if anything changed in these rows.
    pub(crate) fn any(&self, rows: Range<usize>) -> bool {
        let mut columns = self.columns.iter();
        columns.any(|ticks| any_newer(&ticks[rows.clone()], self.last, self.now))
    }
}

/// Returns `true` if any of these ticks is newer than `last`, relative to `now`. There is no branch per tick, so the
/// compiler can vectorize the loop.
pub(crate) fn any_newer(ticks: &[Tick], last: Tick, now: Tick) -> bool {
    ticks.chunks(64).any(|some| {
        let newer = |found, tick: &Tick| found | tick.is_newer_than(last, now);
        some.iter().fold(false, newer)
    })
}

/// Sleep data of a table for one run of *Contact*.
pub(crate) struct Sleepers<'a> {
    run: u32,
    /// Only gravity acts on these bodies, they have no surface of their own, and persisting contacts are not reported.
    may_sleep: bool,
    unchanged: bool,
    /// Change ticks of everything that can wake a body.
    changes: Changes<'a, 3>,
}

impl<'a> Sleepers<'a> {
    pub(crate) fn new(clock: &SleepClock, may_sleep: bool, changes: Changes<'a, 3>) -> Self {
        Self {
            run: clock.run,
            may_sleep,
            unchanged: clock.unchanged,
            changes,
        }
    }

    /// Returns `true` if nothing that could wake a body changed in these rows.
    pub(crate) fn untouched(&self, rows: Range<usize>) -> bool {
        self.may_sleep && self.unchanged && !self.changes.any(rows)
    }

    /// Returns `true` if the body slept in the last run.
    pub(crate) fn slept(&self, sleep: &Sleep) -> bool {
        sleep.0 == self.run - 1
    }

    /// Keeps the body of a row asleep if it slept in the last run and nothing woke it. Returns `true` if it sleeps.
    /// `untouched` states that no row of the chunk changed.
    pub(crate) fn sleeps_on(&self, row: usize, sleep: &mut Sleep, untouched: bool) -> bool {
        let sleeps = self.slept(sleep) && (untouched || self.untouched(row..row + 1));
        if sleeps {
            sleep.0 = self.run;
        }
        sleeps
    }

    /// The sleep value after a step. The body falls asleep if it did not move.
    pub(crate) fn after_step(&self, still: bool) -> Sleep {
        Sleep(if still && self.may_sleep { self.run } else { 0 })
    }
}
