//! The contact cases 25 to 32 under the integrators that suit a game. `box_report bless` writes their table
//! in `docs/contact.md`.

use box_physics::integrators::Integrator;
use box_scenarios::contact_cases;

#[test]
fn contact_keeps_its_bounds() {
    let chosen = [
        Integrator::Split,
        Integrator::Exact,
        Integrator::Split4,
        Integrator::Rk4,
    ];
    let mut broken = Vec::new();
    for case in contact_cases() {
        for integrator in chosen {
            let value = case.measure(integrator);
            if value.is_nan() || value > case.bound {
                broken.push(format!(
                    "{} {} {integrator}: {value:e}, bound {:e}",
                    case.number, case.quantity, case.bound
                ));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}
