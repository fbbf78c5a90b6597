//! Distributes chunks of the columns over threads.

use core::ops::AddAssign;
use std::sync::{Mutex, PoisonError};

use bevy::ecs::reflect::ReflectResource;
use bevy::ecs::resource::Resource;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::tasks::ComputeTaskPool;

/// Number of threads that the physics may use.
///
/// Results do not depend on it, to the last bit, because bodies do not interact.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::plugin::PhysicsThreads;
/// use box_physics::prelude::*;
/// let mut app = App::new();
/// app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
///     .insert_resource(PhysicsThreads { max_threads: 1, ..default() }); // single-threaded
/// app.update();
/// ```
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct PhysicsThreads {
    /// Maximum number of threads, including the caller; 0 counts as 1. Default: all of Bevy's
    /// `ComputeTaskPool`.
    pub max_threads: usize,
    /// Number of bodies in free flight per additional thread. A body moving at the floor counts as 16 of them, a body
    /// under forces as 4. The default of 2048 amounts to about 100 µs, which waking a thread may take.
    pub bodies_per_thread: usize,
}

impl Default for PhysicsThreads {
    fn default() -> Self {
        Self {
            max_threads: usize::MAX,
            bodies_per_thread: 2048,
        }
    }
}

/// Bodies per chunk. The columns of a chunk fit into the L2 cache of a core, and there are enough chunks to balance the
/// uneven cost of bodies at the floor.
pub(crate) const CHUNK: usize = 512;

impl PhysicsThreads {
    /// Number of threads for work equivalent to stepping `bodies` bodies in free flight.
    fn count(&self, bodies: usize) -> usize {
        let Some(pool) = ComputeTaskPool::try_get() else {
            return 1;
        };
        let wanted = bodies / self.bodies_per_thread.max(1);
        // The calling thread also works.
        wanted
            .min(pool.thread_num() + 1)
            .min(self.max_threads)
            .max(1)
    }

    /// Applies `work` to every chunk, in any order and on any thread, and adds up the results. The total work costs as
    /// much as stepping `bodies` bodies in free flight.
    ///
    /// Each thread takes the next chunk when it has finished one, so that none waits for another's slow chunks. Half of
    /// the threads take chunks from the end, so that two threads read memory sequentially.
    pub(crate) fn share_out<C: Send, T: Default + AddAssign + Send + 'static>(
        &self,
        bodies: usize,
        chunks: impl DoubleEndedIterator<Item = C> + Send,
        work: impl Fn(C) -> T + Sync,
    ) -> T {
        let threads = self.count(bodies);
        let mut total = T::default();
        if threads == 1 {
            for chunk in chunks {
                total += work(chunk);
            }
            return total;
        }
        let chunks = Mutex::new(chunks);
        let next = |from_the_end: bool| {
            // A poisoned lock means that another thread panicked. That panic is the one that is reported.
            let mut chunks = chunks.lock().unwrap_or_else(PoisonError::into_inner);
            if from_the_end {
                chunks.next_back()
            } else {
                chunks.next()
            }
        };
        let worker = |from_the_end: bool| {
            let mut own = T::default();
            while let Some(chunk) = next(from_the_end) {
                own += work(chunk);
            }
            own
        };
        let parts = ComputeTaskPool::get().scope(|scope| {
            for k in 1..threads {
                scope.spawn(async move { worker(k % 2 == 1) });
            }
            // The calling thread starts without waiting for the others to wake up.
            total += worker(false);
        });
        for part in parts {
            total += part;
        }
        total
    }
}

/// The result of work that returns nothing.
#[derive(Default)]
pub(crate) struct Done;

impl AddAssign for Done {
    fn add_assign(&mut self, _: Self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::tasks::TaskPool;

    #[test]
    fn every_chunk_is_done_once_by_any_number_of_threads() {
        ComputeTaskPool::get_or_init(TaskPool::default);
        for max_threads in [0, 1, 2, 7] {
            let threads = PhysicsThreads {
                max_threads,
                bodies_per_thread: 10,
            };
            let mut numbers: Vec<u64> = (0..1000).collect();
            let sum: u64 = threads.share_out(1000, numbers.chunks_mut(7), |chunk| {
                chunk.iter_mut().for_each(|x| *x += 1);
                chunk.iter().sum()
            });
            assert_eq!(sum, 500_500);
            assert!(numbers.into_iter().eq(1..1001));
        }
    }
}
