//! Live timing of **every** integrator, not only of the one in use: each frame one integrator's turn comes, and
//! it steps a copy of the scene's boxes under the scene's forces, a batch large enough for the clock.

use std::collections::VecDeque;
use std::time::Instant;

use bevy::prelude::*;
use box_physics::floor::{
    ContactSettings, ContactState, Floor, FloorContext, may_touch, step_on_floor,
};
use box_physics::integrators::{Integrate, IntegratorVisitor};
use box_physics::prelude::{
    BodyState, ForceModel, Forces, Gravity, Integrator, IntegratorMemory, PhysicsClock, RigidBox,
    StepOutcome,
};

use crate::compare::Comparison;

/// Samples per integrator from which minimum, median and 95th percentile are taken.
const WINDOW: usize = 60;
/// Bodies in a batch at most: they fit the first-level cache, and a batch at the floor stays within a
/// millisecond.
const BATCH: usize = 128;
/// A sample lasts at least this long \[ns\].
const SHORTEST: f64 = 100_000.0;

/// Times every integrator live.
pub struct SamplingPlugin;

impl Plugin for SamplingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<IntegratorSamples>()
            .add_systems(Update, sample_integrators);
    }
}

/// The samples of every integrator.
#[derive(Resource)]
pub struct IntegratorSamples {
    recent: Vec<VecDeque<f64>>,
    evaluations: Vec<f64>,
    /// Medians over time: (time since start \[s\], ns), per integrator.
    history: Vec<VecDeque<(f64, f64)>>,
    next: usize,
    batch: Batch,
}

impl Default for IntegratorSamples {
    fn default() -> Self {
        let n = Integrator::ALL.len();
        Self {
            recent: vec![VecDeque::new(); n],
            evaluations: vec![0.0; n],
            history: vec![VecDeque::new(); n],
            next: 0,
            batch: Batch::default(),
        }
    }
}

impl IntegratorSamples {
    /// Minimum, median and 95th percentile [ns per body-step].
    pub fn statistics(&self, integrator: Integrator) -> Option<(f64, f64, f64)> {
        let recent = &self.recent[integrator.index()];
        if recent.is_empty() {
            return None;
        }
        let mut sorted: Vec<f64> = recent.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let at = |q: f64| sorted[((sorted.len() - 1) as f64 * q).round() as usize];
        Some((sorted[0], at(0.5), at(0.95)))
    }

    /// Force evaluations per body-step, measured.
    pub fn evaluations(&self, integrator: Integrator) -> f64 {
        self.evaluations[integrator.index()]
    }

    /// (time \[s\], median ns per body-step), oldest first.
    pub fn history(&self, integrator: Integrator) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.history[integrator.index()].iter().copied()
    }

    fn record(&mut self, integrator: Integrator, time: f64, sample: Sample) {
        let k = integrator.index();
        let recent = &mut self.recent[k];
        recent.push_back(sample.nanoseconds);
        if recent.len() > WINDOW {
            recent.pop_front();
        }
        self.evaluations[k] = sample.evaluations;
        if let Some((_, median, _)) = self.statistics(integrator) {
            let history = &mut self.history[k];
            history.push_back((time, median));
            // At 60 frames a second and five integrators or more: at least five minutes.
            if history.len() > 3600 {
                history.pop_front();
            }
        }
    }
}

/// A copy of the scene's boxes, cycled up to a useful number.
#[derive(Default)]
struct Batch {
    bodies: Vec<RigidBox>,
    start: Vec<BodyState>,
    states: Vec<BodyState>,
    memories: Vec<IntegratorMemory>,
    contacts: Vec<ContactState>,
}

impl Batch {
    fn load<'a>(&mut self, boxes: impl Iterator<Item = (&'a RigidBox, &'a BodyState)> + Clone) {
        self.bodies.clear();
        self.start.clear();
        let present = boxes.clone().count().min(BATCH);
        if present == 0 {
            return;
        }
        // Whole cycles, at least 64 bodies.
        let cycles = 64_usize.div_ceil(present);
        for (body, state) in boxes.take(BATCH).cycle().take(present * cycles) {
            self.bodies.push(*body);
            self.start.push(*state);
        }
        let n = self.bodies.len();
        self.memories = vec![IntegratorMemory::default(); n];
        self.contacts = vec![ContactState::default(); n];
    }
}

/// One measurement.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// ns per body-step.
    pub nanoseconds: f64,
    /// Force evaluations per body-step.
    pub evaluations: f64,
}

/// Times `passes` steps of the whole batch.
struct Passes<'a, F> {
    batch: &'a mut Batch,
    law: &'a F,
    floor: Option<(&'a Floor, &'a ContactSettings)>,
    h: f64,
    passes: u32,
}

impl<F: ForceModel> IntegratorVisitor for Passes<'_, F> {
    type Output = Sample;

    fn visit<S: Integrate>(self) -> Sample {
        let Batch {
            bodies,
            start,
            states,
            memories,
            contacts,
        } = self.batch;
        states.clone_from(start);
        let mut outcome = StepOutcome::default();
        let clock = Instant::now();
        for _ in 0..self.passes {
            for i in 0..bodies.len() {
                let (body, state, memory) = (&bodies[i], &mut states[i], &mut memories[i]);
                outcome += match self.floor {
                    Some((floor, settings)) if may_touch(floor, body, state, self.law, self.h) => {
                        let contact = &mut contacts[i];
                        step_on_floor::<S, F>(
                            &FloorContext {
                                floor,
                                settings,
                                body,
                                force: self.law,
                            },
                            state,
                            self.h,
                            memory,
                            contact,
                            None,
                        )
                        .step
                    }
                    _ => S::step(body, state, self.law, self.h, memory),
                };
            }
        }
        let elapsed = clock.elapsed().as_nanos() as f64;
        std::hint::black_box(&states);
        let count = f64::from(self.passes) * bodies.len() as f64;
        Sample {
            nanoseconds: elapsed / count,
            evaluations: outcome.evaluations as f64 / count,
        }
    }
}

/// A sample of at least 100 µs of one integrator on these boxes.
pub fn measure<'a>(
    integrator: Integrator,
    boxes: impl Iterator<Item = (&'a RigidBox, &'a BodyState)> + Clone,
    law: &Forces,
    floor: Option<(&Floor, &ContactSettings)>,
    h: f64,
) -> Option<Sample> {
    let mut batch = Batch::default();
    batch.load(boxes);
    sample(&mut batch, integrator, law, floor, h)
}

fn sample(
    batch: &mut Batch,
    integrator: Integrator,
    law: &Forces,
    floor: Option<(&Floor, &ContactSettings)>,
    h: f64,
) -> Option<Sample> {
    if batch.bodies.is_empty() || h <= 0.0 {
        return None;
    }
    let free = !law.has_wrench() && law.dissipation() == Default::default();
    let mut passes = 1;
    loop {
        // What the plugin does: gravity alone has a loop of its own.
        let sample = if free {
            let law = &Gravity(law.acceleration);
            integrator.dispatch(Passes {
                batch,
                law,
                floor,
                h,
                passes,
            })
        } else {
            integrator.dispatch(Passes {
                batch,
                law,
                floor,
                h,
                passes,
            })
        };
        let total = sample.nanoseconds * f64::from(passes) * batch.bodies.len() as f64;
        if total >= SHORTEST || passes >= 4096 {
            return Some(sample);
        }
        passes = (f64::from(passes) * (1.2 * SHORTEST / total.max(1.0)))
            .ceil()
            .min(4096.0) as u32;
    }
}

/// One integrator's turn.
pub fn sample_integrators(
    mut samples: ResMut<IntegratorSamples>,
    boxes: Query<(&RigidBox, &BodyState)>,
    comparison: Res<Comparison>,
    clock: Res<PhysicsClock>,
    fixed: Res<Time<Fixed>>,
    floor: Option<Res<Floor>>,
    settings: Res<ContactSettings>,
    time: Res<Time<Real>>,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let samples = &mut *samples;
    let integrator = Integrator::ALL[samples.next % Integrator::ALL.len()];
    samples.next += 1;
    samples.batch.load(boxes.iter());
    let law = run.law.forces.forces(&run.law.body);
    let floor = floor.as_deref().map(|f| (f, &*settings));
    let h = fixed.timestep().as_secs_f64() / f64::from(clock.substeps.max(1));
    if let Some(sample) = sample(&mut samples.batch, integrator, &law, floor, h) {
        samples.record(integrator, time.elapsed_secs_f64(), sample);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::DVec3;

    #[test]
    fn every_integrator_can_be_sampled_on_any_load() {
        let bodies = [RigidBox::default(); 3];
        let states = [BodyState::at(DVec3::Y * 9.0); 3];
        let law = Forces {
            acceleration: DVec3::NEG_Y,
            ..Default::default()
        };
        let mut samples = IntegratorSamples::default();
        for &i in Integrator::ALL {
            let sample = measure(i, bodies.iter().zip(&states), &law, None, 1.0 / 60.0)
                .expect("three boxes");
            assert!(sample.nanoseconds > 0.0 && sample.nanoseconds.is_finite());
            assert!(sample.evaluations >= 1.0, "{i}");
            samples.record(i, 1.0, sample);
            let (low, median, high) = samples.statistics(i).expect("one sample");
            assert!(low <= median && median <= high);
        }
        assert!(measure(Integrator::Split, [].into_iter(), &law, None, 0.1).is_none());
    }

    #[test]
    fn memory_stays_flat() {
        let mut samples = IntegratorSamples::default();
        for n in 0..10_000 {
            samples.record(
                Integrator::Split,
                f64::from(n),
                Sample {
                    nanoseconds: 50.0,
                    evaluations: 1.0,
                },
            );
        }
        assert_eq!(samples.history(Integrator::Split).count(), 3600);
        assert_eq!(samples.recent[0].len(), WINDOW);
    }
}
