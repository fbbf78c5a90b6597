//! The slow energy change in a long run, separated from its oscillation.

use box_physics::integrators::Integrator;

use crate::driver::Driver;
use crate::forces::ForceSet;
use crate::model::Model;
use crate::setup::Setup;

/// The relative change of the rotational energy of a freely spinning body over `steps` steps of `h` \[s\].
///
/// It is the difference between the means over the last and the first tenth. The means have a smooth (Hann) weight, so
/// that an oscillation with any phase does not look like a trend. Returns `None` if the motion diverges. Gravity and
/// other forces of `setup` are ignored.
pub fn energy_trend(setup: &Setup, integrator: Integrator, h: f64, steps: u64) -> Option<f64> {
    let body = &setup.body;
    let free = Model::without_floor(*body, ForceSet::none());
    let mut driver = Driver::new(setup.initial, integrator);
    let start = setup.initial.rotational_energy(body);
    let tenth = (steps / 10).max(1);
    let mut mean_over_a_tenth = || {
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in 0..tenth {
            driver.step(&free, h)?;
            let part = (k as f64 + 0.5) / tenth as f64;
            let weight = libm::sin(core::f64::consts::PI * part).powi(2);
            // Subtracts the initial energy before summing, because the sum of a million energies would lose digits.
            sum += weight * (driver.state.rotational_energy(body) - start);
            weights += weight;
        }
        Some(sum / weights)
    };
    let first = mean_over_a_tenth()?;
    for _ in 0..8 {
        mean_over_a_tenth()?;
    }
    let trend = (mean_over_a_tenth()? - first) / start;
    trend.is_finite().then_some(trend)
}
