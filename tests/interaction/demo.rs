//! The scene of 2012.

use super::*;

#[test]
fn the_2012_scene_moves_by_its_own_integrators() {
    for stepper in Stepper::ALL {
        let mut app = game("dissertation-2012");
        ask(&mut app, Action::SetDemo(Some(stepper)));
        ask(&mut app, Action::Restart);
        let setup = session(&app).setup();
        assert_eq!(setup.body.mass(), 10.0);
        let demo = Demo::of(&setup.body, Some(0.0));
        let mut expected = State::new(&setup.body, &setup.initial);
        // The frame of the restart took a step.
        let h = clock(&app).step();
        demo.cycle(stepper, &mut expected, h);
        for k in 0..120 {
            if k == 70 {
                request(&mut app, push(DVec3::X, false));
                let force = Demo::force_for(DVec3::X * session(&app).parameters.impulse);
                demo.push(&mut expected, force, DVec3::ZERO);
            }
            app.update();
            demo.cycle(stepper, &mut expected, h);
            let expected = expected.body_state(&setup.body);
            assert_eq!(main_box(&mut app), expected, "{stepper:?} {k}");
        }
    }
}

#[test]
fn a_button_switches_to_ours_and_back_in_flight() {
    let mut app = game("dissertation-2012");
    play(&mut app, 10);
    let fall = main_box(&mut app);
    assert_eq!(fall.velocity.y, 0.0, "it falls without a speed");
    assert!((fall.position.y - (4.5 - 9.81 * clock(&app).time())).abs() < 1e-6);
    ask(&mut app, Action::SetDemo(None));
    let speed = main_box(&mut app).velocity.y;
    assert!((speed + 9.81 / 60.0).abs() < 1e-3, "now it has one");
    play(&mut app, 5);
    let before = main_box(&mut app);
    ask(&mut app, Action::SetDemo(Some(Stepper::Rk4)));
    let gone = main_box(&mut app).position.y - before.position.y;
    let expected = (before.velocity.y - 9.81) * clock(&app).step();
    assert!((gone - expected).abs() < 1e-6, "goes on from there");
    // Available only in its own scene.
    ask(&mut app, Action::SelectScene("throw".to_owned()));
    let demo = app.world().resource::<Demo2012>();
    assert_eq!(demo.active(session(&app)), None);
}
