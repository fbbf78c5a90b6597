//! A stretch of a table: the columns that a step works on, cut alike.

use core::ops::Range;

use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::Entity;
use bevy::transform::components::Transform;

use super::components::{NearFloor, PublishedPose, WorldAabb};
use super::intake::any_newer;
use super::publish::write_transforms;
use super::step::{Tally, runs_of};
use super::timing::Stopwatch;
use crate::body::RigidBox;
use crate::floor::ContactState;
use crate::integrators::IntegratorMemory;
use crate::state::BodyState;

/// Neighbors in a table. A column that the table lacks, or that is not wanted, is empty.
pub(crate) struct Chunk<'a> {
    /// Index in the table of the first body.
    pub(crate) first: usize,
    pub(crate) entities: &'a [Entity],
    pub(crate) bodies: &'a [RigidBox],
    pub(crate) states: &'a mut [BodyState],
    pub(crate) memories: &'a mut [IntegratorMemory],
    pub(crate) contacts: &'a mut [ContactState],
    pub(crate) near: &'a mut [NearFloor],
    pub(crate) shown: Shown<'a>,
}

/// What is shown of them.
pub(crate) struct Shown<'a> {
    pub(crate) fitted: &'a mut [WorldAabb],
    pub(crate) published: &'a mut [PublishedPose],
    pub(crate) transforms: &'a mut [Transform],
    /// When each `Transform` last changed.
    pub(crate) changed: &'a mut [Tick],
    /// Of the system's last run, and of this one.
    pub(crate) last: Tick,
    pub(crate) now: Tick,
}

impl<'a> Chunk<'a> {
    pub(crate) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Those of a range.
    pub(crate) fn part(&mut self, range: Range<usize>) -> Chunk<'_> {
        let whole = Chunk {
            first: self.first,
            entities: self.entities,
            bodies: self.bodies,
            states: self.states,
            memories: self.memories,
            contacts: self.contacts,
            near: self.near,
            shown: Shown {
                fitted: self.shown.fitted,
                published: self.shown.published,
                transforms: self.shown.transforms,
                changed: self.shown.changed,
                last: self.shown.last,
                now: self.shown.now,
            },
        };
        whole.split_at(range.end).0.split_at(range.start).1
    }

    fn split_at(self, count: usize) -> (Self, Self) {
        let (entities, bodies) = (self.entities.split_at(count), self.bodies.split_at(count));
        let states = split(self.states, count);
        let memories = split(self.memories, count);
        let contacts = split(self.contacts, count);
        let near = split(self.near, count);
        let fitted = split(self.shown.fitted, count);
        let published = split(self.shown.published, count);
        let transforms = split(self.shown.transforms, count);
        let changed = split(self.shown.changed, count);
        let (last, now) = (self.shown.last, self.shown.now);
        (
            Chunk {
                first: self.first,
                entities: entities.0,
                bodies: bodies.0,
                states: states.0,
                memories: memories.0,
                contacts: contacts.0,
                near: near.0,
                shown: Shown {
                    fitted: fitted.0,
                    published: published.0,
                    transforms: transforms.0,
                    changed: changed.0,
                    last,
                    now,
                },
            },
            Chunk {
                first: self.first + count,
                entities: entities.1,
                bodies: bodies.1,
                states: states.1,
                memories: memories.1,
                contacts: contacts.1,
                near: near.1,
                shown: Shown {
                    fitted: fitted.1,
                    published: published.1,
                    transforms: transforms.1,
                    changed: changed.1,
                    last,
                    now,
                },
            },
        )
    }

    /// Cut into pieces of `size` bodies, the last one shorter.
    pub(crate) fn chunks(self, size: usize) -> Chunks<'a> {
        Chunks {
            rest: (self.len() > 0).then_some(self),
            size: size.max(1),
        }
    }

    /// Shows the bodies that were `stepped`, but for the faults, whose state is yet to be put right; and of
    /// those that lay still, whose bounding box and pose are shown already, only the poses that somebody
    /// has overwritten.
    pub(crate) fn show(&mut self, stepped: Stepped, tally: &mut Tally, watch: &mut Stopwatch) {
        if tally.bodies == 0 {
            return;
        }
        let count = self.len();
        let (first, near, faults) = (self.first, &*self.near, &tally.faults);
        let (bodies, states, shown) = (self.bodies, &*self.states, &mut self.shown);
        // Nobody to be left out: the columns are gone over as they are.
        if stepped != Stepped::AtFloor && tally.bodies == count as u64 && faults.is_empty() {
            WorldAabb::fit_all(bodies, states, shown.fitted);
            tally.spent.refit += watch.lap();
            shown.write(states, 0..count);
            tally.spent.writeback += watch.lap();
            return;
        }
        let wanted = |i: usize| {
            let taken = match stepped {
                Stepped::All => true,
                Stepped::Clear => !near[i].pending,
                Stepped::AtFloor => near[i].pending,
            };
            taken && (faults.is_empty() || !faults.contains(&(first + i)))
        };
        let moved = |i: usize| wanted(i) && !near[i].still;
        if !shown.fitted.is_empty() {
            for range in runs_of(count, moved) {
                let fitted = &mut shown.fitted[range.clone()];
                WorldAabb::fit_all(&bodies[range.clone()], &states[range], fitted);
            }
        }
        tally.spent.refit += watch.lap();
        if stepped == Stepped::AtFloor && any_newer(shown.changed, shown.last, shown.now) {
            for i in (0..count).filter(|&i| wanted(i) && near[i].still) {
                if shown.changed[i].is_newer_than(shown.last, shown.now) {
                    shown.write(states, i..i + 1);
                }
            }
        }
        for range in runs_of(count, moved) {
            shown.write(states, range);
        }
        tally.spent.writeback += watch.lap();
    }
}

impl Shown<'_> {
    fn write(&mut self, states: &[BodyState], range: Range<usize>) {
        write_transforms(
            &states[range.clone()],
            &mut self.published[range.clone()],
            &mut self.transforms[range.clone()],
            &mut self.changed[range],
            self.now,
        );
    }
}

/// Which bodies of a chunk a pass stepped.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stepped {
    /// Every one.
    All,
    /// Those that are not left to *Contact*.
    Clear,
    /// Those that were.
    AtFloor,
}

fn split<T>(column: &mut [T], count: usize) -> (&mut [T], &mut [T]) {
    column.split_at_mut(count.min(column.len()))
}

/// The pieces of a [`Chunk`], from both ends.
pub(crate) struct Chunks<'a> {
    rest: Option<Chunk<'a>>,
    size: usize,
}

impl<'a> Iterator for Chunks<'a> {
    type Item = Chunk<'a>;

    fn next(&mut self) -> Option<Chunk<'a>> {
        let rest = self.rest.take()?;
        if rest.len() <= self.size {
            return Some(rest);
        }
        let (next, rest) = rest.split_at(self.size);
        self.rest = Some(rest);
        Some(next)
    }
}

impl DoubleEndedIterator for Chunks<'_> {
    fn next_back(&mut self) -> Option<Self::Item> {
        let rest = self.rest.take()?;
        if rest.len() <= self.size {
            return Some(rest);
        }
        let whole = (rest.len() - 1) / self.size * self.size;
        let (rest, last) = rest.split_at(whole);
        self.rest = Some(rest);
        Some(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// From either end: every body once, in pieces of the size but for the last, and each column alike.
    #[test]
    fn chunks_cover_the_range_once_from_both_ends() {
        let bodies = vec![RigidBox::default(); 20];
        let mut states: Vec<_> = (0..20)
            .map(|i| BodyState::at(DVec3::X * f64::from(i)))
            .collect();
        let mut near = vec![NearFloor::default(); 20];
        let mut table = Chunk {
            first: 0,
            entities: &[Entity::PLACEHOLDER; 20],
            bodies: &bodies,
            states: &mut states,
            memories: &mut [],
            contacts: &mut [],
            near: &mut near,
            shown: Shown {
                fitted: &mut [],
                published: &mut [],
                transforms: &mut [],
                changed: &mut [],
                last: Tick::new(0),
                now: Tick::new(0),
            },
        };
        for from_the_end in [false, true] {
            let mut chunks = table.part(3..19).chunks(5);
            let mut found = Vec::new();
            while let Some(chunk) = if from_the_end {
                chunks.next_back()
            } else {
                chunks.next()
            } {
                assert_eq!(chunk.states[0].position.x, chunk.first as f64);
                assert_eq!((chunk.near.len(), chunk.memories.len()), (chunk.len(), 0));
                found.push((chunk.first, chunk.len()));
            }
            found.sort_unstable();
            assert_eq!(found, [(3, 5), (8, 5), (13, 5), (18, 1)]);
        }
        assert_eq!(table.part(4..4).chunks(5).count(), 0);
    }
}
