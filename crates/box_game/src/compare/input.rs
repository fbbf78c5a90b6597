//! Inputs that act on all comparisons, with their simulated times.

use std::collections::VecDeque;

use box_scenarios::Change;

/// Maximum number of inputs kept: ten pushes per second for an hour. A comparison added later is simulated through them
/// from the start.
const MAX_INPUTS: usize = 36_000;

/// A change and its time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Input {
    /// Simulated time \[s\]. A comparison applies the change at its first step boundary at or after it.
    pub t: f64,
    pub change: Change,
}

/// All inputs of a run, in order of time. A comparison stores the number of inputs that it has applied.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inputs {
    kept: VecDeque<Input>,
    /// Number of the first input kept.
    first: u64,
}

impl Inputs {
    /// Appends an input. Drops the oldest one if there are too many.
    pub(crate) fn push(&mut self, input: Input) {
        self.kept.push_back(input);
        if self.kept.len() > MAX_INPUTS {
            self.kept.pop_front();
            self.first += 1;
        }
    }

    /// Returns input number `n`, if it exists and is still kept.
    pub(crate) fn get(&self, n: u64) -> Option<&Input> {
        self.kept.get(n.checked_sub(self.first)? as usize)
    }

    /// Returns `true` if every input is kept, so that the run can be simulated from its start.
    pub(crate) fn is_whole(&self) -> bool {
        self.first == 0
    }

    /// The number of the next input.
    pub(crate) fn end(&self) -> u64 {
        self.first + self.kept.len() as u64
    }

    /// The inputs from `t` \[s\] on.
    pub(crate) fn since(&self, t: f64) -> impl Iterator<Item = &Input> {
        self.kept.iter().filter(move |input| input.t >= t)
    }

    /// Removes the inputs after `t` \[s\].
    pub(crate) fn rewind(&mut self, t: f64) {
        self.kept.retain(|input| input.t <= t);
    }

    /// Returns `true` if an input lies between two times, more than `margin` from both \[s\].
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
