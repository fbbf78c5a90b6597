//! Steps back.

use bevy::prelude::*;
use box_game::action::Action;
use box_game::compare::{Quantity, Run};
use box_physics::prelude::*;
use box_scenarios::{Driver, Model, Scenario};

use super::playing::{ask, game, main_box, push};
use super::run;

/// The states of the comparisons.
fn states(run: &Run) -> Vec<BodyState> {
    let comparisons = run.comparisons.iter();
    comparisons.map(|r| r.simulation.driver.state).collect()
}

/// After a step back, the comparisons have the states of the earlier time.
#[test]
fn comparisons_follow_the_clock_back() {
    let setup = Scenario::find("throw").expect("a scene").setup;
    let h = 1.0 / 60.0;
    let mut run = Run::new(&setup, Some(setup.reference()), Integrator::Split, h);
    run.choose([Integrator::Rk4, Integrator::ExplicitEuler]);
    let law = Model::of(&setup);
    let mut body = Driver::new(setup.initial, Integrator::Split);
    let mut past = Vec::new();
    for n in 0..300 {
        let t = f64::from(n) * h;
        run.before_step(t, law.clone(), &body.state, |_| Vec::new());
        body.step(&law, h);
        run.after_step(t + h, h, (&body.state, &body.contact), Integrator::Split);
        assert!(run.advance(None));
        let sample = run.main_box.track.now.sample;
        past.push((t + h, body.state, states(&run), sample));
    }
    for n in [250, 249, 100, 3] {
        let (t, state, comparisons, sample) = &past[n];
        run.rewind(*t, state);
        assert!(run.advance(None));
        for (r, state) in run.comparisons.iter().zip(comparisons) {
            let apart = (r.simulation.driver.state.position - state.position).length();
            assert!(apart < 1e-9, "{} at step {n}: {apart:e}", r.integrator());
        }
        let balance = &run.main_box.simulation.balance;
        let energy = balance.residual(&law, state).energy;
        assert!((energy - sample.get(Quantity::Energy)).abs() < 1e-9);
    }
}

/// The same with the keys of the game. Back and forward again, with a push in between, main box and
/// comparisons have their earlier state at every step.
#[test]
fn stepping_back_takes_the_comparisons_along() {
    let mut app = game("contact --integrator split,rk4,semi-implicit-euler");
    let mut past = Vec::new();
    let note = |app: &mut App| {
        let (clock, states) = (run(app).clock, states(run(app)));
        (clock, main_box(app), states)
    };
    for k in 0..150 {
        if k == 100 {
            ask(&mut app, push(DVec3::new(0.0, 0.0, 1.0), true));
        } else {
            app.update();
        }
        past.push(note(&mut app));
    }
    // The step that ended at `t` [s].
    let at = |t: f64| {
        let found = past.iter().position(|p| (p.0 - t).abs() < 1e-9);
        found.expect("a step that was taken")
    };
    ask(&mut app, Action::TogglePause);
    for back in [1, 30, 60] {
        ask(&mut app, Action::StepBack(back));
        app.update();
        let now = note(&mut app);
        let then = &past[at(now.0)];
        assert_eq!(now.1, then.1, "the main box, {back} back");
        assert_eq!(now.2, then.2, "the comparisons, {back} back");
    }
    // After the push: going back does not repeat it, because the future is new.
    let again = at(run(&app).clock);
    assert!(again < 100);
    for expected in &past[again + 1..100] {
        ask(&mut app, Action::Step(1));
        assert_eq!(&note(&mut app), expected);
    }
}
