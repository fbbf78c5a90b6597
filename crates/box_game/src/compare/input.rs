//! What is done to every comparison alike: inputs with the simulated time at which they act.

use std::collections::VecDeque;

use box_scenarios::Change;

/// Inputs that are kept, so that a comparison chosen later can be simulated from the start. Ten pushes a
/// second for an hour.
const MAX_INPUTS: usize = 36_000;

/// A change and its time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Input {
    /// When \[s\]; a comparison takes it at its first step boundary at or after that.
    pub t: f64,
    pub change: Change,
}

/// Every input of a run, in order of time. A comparison remembers how many it has taken.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inputs {
    kept: VecDeque<Input>,
    /// Number of the first one kept.
    first: u64,
}

impl Inputs {
    /// Appends; the oldest goes where there are too many.
    pub(crate) fn push(&mut self, input: Input) {
        self.kept.push_back(input);
        if self.kept.len() > MAX_INPUTS {
            self.kept.pop_front();
            self.first += 1;
        }
    }

    /// Number `n`, if it has happened and is still kept.
    pub(crate) fn get(&self, n: u64) -> Option<&Input> {
        self.kept.get(n.checked_sub(self.first)? as usize)
    }

    /// Whether the run can be simulated from its start.
    pub(crate) fn is_whole(&self) -> bool {
        self.first == 0
    }

    /// The number of the next input.
    pub(crate) fn end(&self) -> u64 {
        self.first + self.kept.len() as u64
    }

    /// Those from `t` \[s\] on.
    pub(crate) fn since(&self, t: f64) -> impl Iterator<Item = &Input> {
        self.kept.iter().filter(move |input| input.t >= t)
    }

    /// Forgets what happened after `t` \[s\].
    pub(crate) fn rewind(&mut self, t: f64) {
        self.kept.retain(|input| input.t <= t);
    }

    /// Whether one lies strictly between two times.
    pub(crate) fn any_within(&self, from: f64, to: f64, margin: f64) -> bool {
        let after = |input: &&Input| input.t > from + margin;
        let mut late = self.kept.iter().rev().take_while(after);
        late.any(|input| input.t < to - margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::BodyState;

    fn at(t: f64) -> Input {
        Input {
            t,
            change: Change::Place(BodyState::default()),
        }
    }

    #[test]
    fn memory_is_bounded_and_numbers_stay() {
        let mut inputs = Inputs::default();
        for k in 0..MAX_INPUTS as u64 + 10 {
            inputs.push(at(k as f64));
        }
        assert_eq!(inputs.kept.len(), MAX_INPUTS);
        assert!(!inputs.is_whole());
        assert!(inputs.get(9).is_none());
        assert_eq!(inputs.get(10).map(|i| i.t), Some(10.0));
        assert_eq!(inputs.end(), MAX_INPUTS as u64 + 10);
    }

    #[test]
    fn rewinding_forgets_the_future() {
        let mut inputs = Inputs::default();
        (0..5).for_each(|k| inputs.push(at(f64::from(k))));
        assert!(inputs.any_within(2.5, 3.5, 1e-9) && !inputs.any_within(3.0, 4.0, 1e-9));
        inputs.rewind(2.0);
        assert_eq!(inputs.end(), 3);
        assert!(!inputs.any_within(2.0, 9.0, 1e-9));
    }
}
