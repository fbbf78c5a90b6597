//! Many bodies at once: free flight under gravity alone, which is what most bodies do most of the time.
//!
//! The numbers of up to [`LANES`] bodies are laid out one array a quantity, the scheme's rotation runs
//! over these arrays in one loop without a branch, and the compiler makes vector instructions of it: two
//! bodies at a time on any x86-64, four where the processor has AVX2, which is asked at run time. Vector
//! and scalar additions, multiplications, divisions and square roots round alike, nothing is contracted
//! or reordered, so the bits are the same whatever the instruction set and whichever lane a body is in.
//!
//! A body for which the loop does not apply (its turn is beyond the polynomials' range, a number is not
//! finite) takes the scheme's plain step, which gives the same bits wherever both apply.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is one index into several arrays, of which only the first `count` entries are in use"
)]

use glam::DVec3;

use super::{Integrator, Scheme, SchemeMemory, SchemeVisitor, StepOutcome};
use crate::body::RigidBox;
use crate::force::Gravity;
use crate::state::BodyState;

/// Bodies in one group: enough to hide what the change of layout costs, few enough for the L1 cache.
pub const LANES: usize = 64;

/// Gravity, the same for all bodies but for a factor.
#[derive(Clone, Copy)]
pub struct GravityField<'a> {
    /// Of the world [m/s²].
    pub world: DVec3,
    /// Factor on it of body `i`; 1 for all if there is none.
    pub scale: Option<&'a (dyn Fn(usize) -> f64 + Sync)>,
}

impl GravityField<'_> {
    /// Of body `i` [m/s²].
    #[inline(always)]
    fn at(&self, i: usize) -> DVec3 {
        match self.scale {
            Some(scale) => self.world * scale(i),
            None => self.world,
        }
    }
}

/// Bodies of a table, of which those `chosen` are to be stepped in free flight.
pub struct Group<'a> {
    /// The bodies.
    pub bodies: &'a [RigidBox],
    /// Their states. One that does not stay sound in the step is left as it was.
    pub states: &'a mut [BodyState],
    /// Their schemes' memories.
    pub memories: &'a mut [SchemeMemory],
    /// Gravity, the only force.
    pub gravity: GravityField<'a>,
    /// Indices of the bodies to step: at most [`LANES`], each at most once.
    pub chosen: &'a [usize],
    /// Where the indices of bodies go that did not stay sound.
    pub faults: &'a mut Vec<usize>,
    /// Room to work in.
    pub scratch: &'a mut Scratch,
}

impl Group<'_> {
    /// The scheme's plain step, body by body.
    pub fn one_by_one<S: Scheme>(&mut self, h: f64) -> StepOutcome {
        let mut total = StepOutcome::default();
        for &i in self.chosen {
            total += self.step_one::<S>(i, h);
        }
        total
    }

    /// Out of line: the loop over the lanes, in which it is the exception, stays small.
    #[inline(never)]
    fn step_one<S: Scheme>(&mut self, i: usize, h: f64) -> StepOutcome {
        let state = &mut self.states[i];
        let before = *state;
        let law = Gravity(self.gravity.at(i));
        let outcome = S::step(&self.bodies[i], state, &law, h, &mut self.memories[i]);
        if !state.is_sound() {
            *state = before;
            self.faults.push(i);
        }
        outcome
    }

    /// All lanes at once by the kernel of `S`.
    pub(super) fn in_lanes<S: Lanes<IN>, const IN: usize>(&mut self, h: f64) -> StepOutcome {
        if h == 0.0 {
            return self.one_by_one::<S>(h);
        }
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            #[expect(unsafe_code, reason = "the same code, compiled for AVX2")]
            // SAFETY: the processor has AVX2, as was asked in the line above.
            return unsafe { self.run_with_avx2::<S, IN>(h) };
        }
        self.run::<S, IN>(h)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn run_with_avx2<S: Lanes<IN>, const IN: usize>(&mut self, h: f64) -> StepOutcome {
        self.run::<S, IN>(h)
    }

    #[inline(always)]
    fn run<S: Lanes<IN>, const IN: usize>(&mut self, h: f64) -> StepOutcome {
        let Scratch {
            input,
            momentum,
            attitude,
            applies,
        } = &mut *self.scratch;
        let count = self.chosen.len().min(LANES);
        for (lane, &i) in self.chosen[..count].iter().enumerate() {
            let values = S::gather(&self.bodies[i], &self.states[i]);
            for k in 0..IN {
                input[k][lane] = values[k];
            }
        }
        for lane in 0..count {
            let (l, q, ok) = S::rotate(core::array::from_fn(|k| input[k][lane]), h);
            let square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
            // Whether the state stays sound; 0·x is 0 or, of what is not finite, NaN.
            let sound = (square - 1.0).abs() < 0.5e-3;
            let finite = 0.0 * l[0] + 0.0 * l[1] + 0.0 * l[2] == 0.0;
            for k in 0..3 {
                momentum[k][lane] = l[k];
            }
            for k in 0..4 {
                attitude[k][lane] = q[k];
            }
            applies[lane] = if ok & sound & finite { 1.0 } else { 0.0 };
        }
        let mut total = StepOutcome::default();
        for (lane, &i) in self.chosen[..count].iter().enumerate() {
            let scratch = &*self.scratch;
            let state = &mut self.states[i];
            let (x, v) = (state.position, state.velocity);
            S::translate(state, self.gravity.at(i), h);
            let finite = state.position.is_finite() && state.velocity.is_finite();
            if scratch.applies[lane] == 1.0 && finite {
                let l = core::array::from_fn(|k| scratch.momentum[k][lane]);
                let q = core::array::from_fn(|k| scratch.attitude[k][lane]);
                S::scatter(&self.bodies[i], state, l, q);
                total += S::OUTCOME;
            } else {
                (state.position, state.velocity) = (x, v);
                total += self.step_one::<S>(i, h);
            }
        }
        total
    }
}

/// The numbers of the bodies of a group, one array a quantity. What is in it between steps means
/// nothing; it is kept so that it need not be cleared each time.
pub struct Scratch {
    input: [[f64; LANES]; MOST_INPUTS],
    momentum: [[f64; LANES]; 3],
    attitude: [[f64; LANES]; 4],
    /// 1 where the kernel applied, 0 where it did not: as wide as the other numbers, so that the loop is
    /// vectorised at one width.
    applies: [f64; LANES],
}

/// Numbers of a body that a kernel may ask for.
const MOST_INPUTS: usize = 16;

impl Default for Scratch {
    fn default() -> Self {
        Self {
            input: [[0.0; LANES]; MOST_INPUTS],
            momentum: [[0.0; LANES]; 3],
            attitude: [[0.0; LANES]; 4],
            applies: [0.0; LANES],
        }
    }
}

/// A scheme whose step in free flight has no branch, so that many bodies can be stepped at once.
///
/// What it does must be, bit for bit, what its [`Scheme::step`] does under
/// [`Gravity`] alone wherever [`Lanes::rotate`] says that it applies (the test in this file compares
/// them). Best write the rotation once and use it in both, as `split` does.
pub(super) trait Lanes<const IN: usize>: Scheme {
    /// What a step that applied reports.
    const OUTCOME: StepOutcome;

    /// The numbers of one body that the rotation needs.
    fn gather(body: &RigidBox, state: &BodyState) -> [f64; IN];

    /// Angular momentum and attitude after `h` \[s\], and whether that applies. No branch, no call that
    /// is not inlined: else the loop over the lanes is not vectorised.
    fn rotate(input: [f64; IN], h: f64) -> ([f64; 3], [f64; 4], bool);

    /// Puts them into the state.
    fn scatter(body: &RigidBox, state: &mut BodyState, l: [f64; 3], q: [f64; 4]);

    /// Position and velocity after `h` \[s\] in the uniform acceleration `a` [m/s²].
    fn translate(state: &mut BodyState, a: DVec3, h: f64);
}

impl Integrator {
    /// One step of `h` \[s\] of many bodies in free flight, each as [`Integrator::step`] under `gravity`
    /// does, to the last bit, but several at a time where the scheme can. A body whose new state would
    /// not be sound stays as it was. The three slices are of equal length (what is beyond the shortest
    /// is left alone).
    pub fn step_all(
        self,
        bodies: &[RigidBox],
        states: &mut [BodyState],
        memories: &mut [SchemeMemory],
        gravity: &Gravity,
        h: f64,
    ) -> StepOutcome {
        self.dispatch(All {
            bodies,
            states,
            memories,
            gravity: gravity.0,
            h,
        })
    }
}

struct All<'a> {
    bodies: &'a [RigidBox],
    states: &'a mut [BodyState],
    memories: &'a mut [SchemeMemory],
    gravity: DVec3,
    h: f64,
}

impl SchemeVisitor for All<'_> {
    type Output = StepOutcome;

    fn visit<S: Scheme>(self) -> StepOutcome {
        let chosen: [usize; LANES] = core::array::from_fn(|i| i);
        let gravity = GravityField {
            world: self.gravity,
            scale: None,
        };
        let (mut faults, mut scratch) = (Vec::new(), Scratch::default());
        let mut total = StepOutcome::default();
        let chunks = self
            .bodies
            .chunks(LANES)
            .zip(self.states.chunks_mut(LANES))
            .zip(self.memories.chunks_mut(LANES));
        for ((bodies, states), memories) in chunks {
            let count = bodies.len().min(states.len()).min(memories.len());
            total += S::step_group(
                &mut Group {
                    bodies,
                    states,
                    memories,
                    gravity,
                    chosen: &chosen[..count],
                    faults: &mut faults,
                    scratch: &mut scratch,
                },
                self.h,
            );
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::exponential_map;
    use proptest::prelude::*;

    /// Numbers as they come: ordinary, both zeros, tiny, large, not finite.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            8 => -3.0..3.0_f64,
            1 => Just(0.0),
            1 => Just(-0.0),
            1 => Just(1e-300),
            1 => -500.0..500.0_f64,
        ]
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(number()).prop_map(DVec3::from_array)
    }

    fn body() -> impl Strategy<Value = RigidBox> {
        let half = prop_oneof![
            3 => prop::array::uniform3(0.1..1.0_f64),
            1 => (0.1..1.0_f64).prop_map(|a| [a; 3]),
            1 => (0.1..1.0_f64, 0.1..1.0_f64).prop_map(|(a, b)| [a, b, a]),
        ];
        (half, 0.5..5.0_f64)
            .prop_map(|(h, m)| RigidBox::new(DVec3::from_array(h), m).expect("valid"))
    }

    fn moving() -> impl Strategy<Value = (RigidBox, BodyState)> {
        let turned = prop_oneof![1 => Just(DVec3::ZERO), 4 => vector()];
        (body(), vector(), turned, vector(), vector()).prop_map(|(body, x, turn, v, spin)| {
            let state = BodyState::at(x)
                .with_rotation(exponential_map(turn))
                .with_velocity(v)
                .with_body_angular_velocity(&body, spin);
            (body, state)
        })
    }

    fn bits(state: &BodyState) -> [u64; 13] {
        let (x, q) = (state.position, state.rotation);
        let (v, l) = (state.velocity, state.angular_momentum);
        [
            x.x, x.y, x.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, l.x, l.y, l.z,
        ]
        .map(f64::to_bits)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Every scheme, any number of bodies, zeros of both signs, turns beyond the kernels' range,
        /// one state that is not finite: bit for bit what the plain steps give, over several steps.
        #[test]
        fn all_at_once_is_one_by_one(
            set in prop::collection::vec(moving(), 1..150),
            gravity in vector(),
            broken in 0_usize..300,
            h in prop_oneof![Just(1.0 / 60.0), Just(0.0), Just(-0.1), 0.001..0.5_f64],
        ) {
            let bodies: Vec<_> = set.iter().map(|(body, _)| *body).collect();
            let mut start: Vec<_> = set.iter().map(|(_, state)| *state).collect();
            if let Some(state) = start.get_mut(broken) {
                state.angular_momentum.y = f64::INFINITY;
            }
            let law = Gravity(gravity);
            for &integrator in Integrator::ALL {
                let (mut states, mut expected) = (start.clone(), start.clone());
                let mut memories: Vec<_> = bodies.iter().map(|_| SchemeMemory::default()).collect();
                let mut own: Vec<_> = bodies.iter().map(|_| SchemeMemory::default()).collect();
                for _ in 0..3 {
                    let outcome = integrator.step_all(&bodies, &mut states, &mut memories, &law, h);
                    let mut total = StepOutcome::default();
                    for ((body, state), memory) in bodies.iter().zip(&mut expected).zip(&mut own) {
                        let before = *state;
                        total += integrator.step(body, state, &law, h, memory);
                        if !state.is_sound() {
                            *state = before;
                        }
                    }
                    prop_assert_eq!(outcome, total);
                    for (a, b) in states.iter().zip(&expected) {
                        prop_assert_eq!(bits(a), bits(b), "{}", integrator);
                    }
                }
            }
        }
    }
}
