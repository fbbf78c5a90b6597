use super::*;
use crate::visible::RATES;

/// At every rate, the default has the smallest error in the median scene. Therefore nothing beats it, whatever the
/// costs are.
#[test]
fn no_integrator_has_a_smaller_error_than_the_default_in_the_median_scene() {
    let families = Family::all().iter().map(|family| {
        let divisors = RATES.map(|rate| (f64::from(rate) * INTERVAL).round() as u64);
        let (reference, points) = runs(family, Integrator::ALL, &divisors).expect(family.id);
        FamilyPoints {
            family,
            reference: reference.source,
            points,
        }
    });
    let data = WorkPrecision {
        families: families.collect(),
    };
    for rate in RATES {
        for &integrator in Integrator::ALL {
            let ratio = data.median_ratio(integrator, Integrator::Split, rate);
            assert!(ratio >= 1.0, "{integrator} at {rate} Hz: {ratio:e}");
        }
        // The measure distinguishes integrators.
        let yardstick = data.median_ratio(Integrator::Rk4, Integrator::Split, rate);
        assert!(yardstick > 1e4, "{rate} Hz: {yardstick:e}");
    }
}
