use super::*;
use crate::{Driver, Scenario};
use box_physics::prelude::Integrator;

fn of(id: &str) -> (LiveReference, Arc<Model>) {
    let s = Scenario::find(id).expect("a scene");
    let law = Arc::new(Model::of(&s.setup));
    let known = s.reference();
    (
        LiveReference::new(&law, s.setup.initial, &[], Some(known), 1.0 / 60.0),
        law,
    )
}

/// After pushes in flight the reference is still a closed form. It equals that of a setup that contains the pushes from
/// the start.
#[test]
fn a_push_starts_a_new_closed_form() {
    let s = Scenario::find("throw").expect("a scene");
    let (mut reference, _) = of("throw");
    let kick = |t: f64| TimedImpulse {
        t,
        impulse: DVec3::new(0.5, 1.0, -0.25),
        body_point: DVec3::new(0.1, 0.0, 0.2),
    };
    for t in [0.4, 0.7] {
        let k = kick(t);
        reference.push(
            t,
            &Change::Impulse {
                impulse: k.impulse,
                body_point: k.body_point,
            },
        );
        assert!(reference.is_trusted());
    }
    let known = s.setup.clone().with_impulses(vec![kick(0.4), kick(0.7)]);
    let known = known.reference();
    for t in [0.2, 0.55, 1.3] {
        let (a, b) = (reference.at(t), known.at(t));
        let e = StateError::between(&a.expect("kept"), &b.expect("closed"));
        assert!(e.position < 1e-12 && e.attitude < 1e-9, "{t}: {e:?}");
    }
}

/// Without a closed form, the simulation has the stated step and agrees with a finer one.
#[test]
fn a_fine_simulation_where_there_is_no_formula() {
    let (mut reference, law) = of("heavy-top");
    assert!(reference.is_trusted());
    reference.push(
        0.5,
        &Change::Impulse {
            impulse: DVec3::X,
            body_point: DVec3::Y * 0.3,
        },
    );
    assert!(!reference.is_trusted());
    assert!(reference.description().contains("1/3840 s"));
    let start = reference.at(0.5).expect("here");
    let mut finer = Driver::new(start, Integrator::Split4);
    (0..20_000).for_each(|_| {
        finer.step(&law, 2.0 / 20_000.0);
    });
    let end = reference.at(2.5).expect("ahead");
    let e = StateError::between(&end, &finer.state);
    assert!(e.position < 1e-9 && e.attitude < 1e-8, "{e:?}");
    assert!(reference.at(1.0).is_none(), "its past is gone");
}

#[test]
fn it_outlives_a_numerical_answer() {
    let s = Scenario::find("heavy-top").expect("a scene");
    let (mut reference, _) = of("heavy-top");
    let end = s.setup.duration;
    let before = reference.at(end - 0.01).expect("inside");
    let after = reference.at(end + 0.01).expect("goes on");
    assert!((after.position - before.position).length() < 0.1);
    assert!(!reference.is_trusted());
}
