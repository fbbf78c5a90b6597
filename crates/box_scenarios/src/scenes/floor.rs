//! Scenes with contact.

use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use super::bodies::{GRAVITY, brick, solid, spinning};
use crate::forces::ForceSet;
use crate::scenario::Scenario;
use crate::setup::{FloorSpec, Setup};
use crate::view::{Plot, SceneView};

/// A box at rest, to be pushed around.
pub fn playground() -> Scenario {
    let body = solid([0.5; 3], 2.0);
    let start = spinning(&body, [0.0, 0.5, 0.0], [0.0; 3]);
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 60.0);
    Scenario {
        id: "playground",
        title: "Playground",
        lesson: "A box at rest on a floor. Push it with W and S (z axis), A and D (x axis), Q and E (y axis); hold Shift to push off-center.",
        hints: [
            "Click the box to poke it, drag it to grab it, or press [Push +x].",
            "Press [Friction 0] and push again: nothing stops the box.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.4, 0.5)),
        recommended: &["split", "rk4", "semi-implicit-euler"],
        boxes: 1,
        view: SceneView::from(30.0, 24.0),
    }
}

/// A flat drop that loses half its speed at every bounce.
pub fn drop() -> Scenario {
    let body = solid([0.5, 0.25, 0.5], 3.0);
    let start = spinning(&body, [0.0, 3.25, 0.0], [0.0; 3]);
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 4.0);
    Scenario {
        id: "drop",
        title: "Flat drop",
        lesson: "Bounce n reaches e^(2n) of the initial height. There are infinitely many bounces in a finite time, then rest. Locating the impact within the step preserves the order of the integrator.",
        hints: [
            "Press [Restitution 1] or [Restitution 0] and [Restart]: it bounces forever or not at all.",
            "Read [Spin |ω|]: a flat landing must not cause spin.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.5, 0.0)),
        recommended: &["split", "rk4", "semi-implicit-euler", "heun-2012"],
        boxes: 1,
        view: SceneView::from(15.0, 8.0).at([0.0, 1.6, 0.0], 6.5),
    }
}

/// Endless bounces with e = 1.
pub fn bounce() -> Scenario {
    let body = solid([0.5, 0.25, 0.5], 3.0);
    let start = spinning(&body, [0.0, 1.25, 0.0], [0.0; 3]);
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 90.0);
    Scenario {
        id: "bounce",
        title: "Hundred bounces",
        lesson: "With e = 1 the box must return to the same height a hundred times. Energy errors at each contact accumulate until they are visible.",
        hints: [
            "Press [Faster] and read [Total energy] after a minute.",
            "Open the [Energy tab]: integrators that are exact on the parabola keep the energy, the others gain or lose it.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(1.0, 0.0)),
        recommended: &[
            "split",
            "explicit-euler",
            "semi-implicit-euler",
            "heun-2012",
        ],
        boxes: 1,
        view: SceneView::from(15.0, 8.0),
    }
}

/// Sliding to rest.
pub fn slide() -> Scenario {
    let body = solid([0.5, 0.25, 0.5], 3.0);
    let start =
        spinning(&body, [-4.0, 0.25, 0.0], [0.0; 3]).with_velocity(DVec3::new(6.0, 0.0, 0.0));
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 3.0);
    Scenario {
        id: "slide",
        title: "Slide to rest",
        lesson: "Coulomb friction stops the box after a distance v²/(2µg), and the friction force then drops to zero. The box must neither creep nor reverse.",
        hints: [
            "Press [Restart] and [Push +x]: it must not leave its straight line.",
            "Press [Friction 3] and [Restart]: the box tips instead of sliding.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.0, 0.5)),
        recommended: &["split", "rk4", "backward-euler", "explicit-euler"],
        boxes: 1,
        view: SceneView::from(8.0, 14.0)
            .at([-2.0, 0.4, 0.0], 6.5)
            .with_plot(Plot::Error),
    }
}

/// A fast tumbling throw over a bouncy floor: chaotic motion.
pub fn tumble_storm() -> Scenario {
    let body = brick();
    let start = spinning(&body, [-3.0, 4.0, 0.0], [3.0, 9.0, -5.0])
        .with_velocity(DVec3::new(2.0, 3.0, 0.5));
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 12.0);
    Scenario {
        id: "tumble-storm",
        title: "Tumble storm",
        lesson: "Each bounce of a tumbling box amplifies every difference. After a few bounces, no two integrators agree on the path; only the energy can still be compared: it must never grow.",
        hints: [
            "Press [Compare all]: no two come to rest in the same place.",
            "Press [120 Hz]: smaller steps do not help for long.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.8, 0.3)),
        recommended: &["split", "rk4", "semi-implicit-euler", "explicit-euler"],
        boxes: 1,
        view: SceneView::from(25.0, 18.0).at([1.0, 1.6, 0.0], 13.0),
    }
}

/// Many boxes, to show the cost of a step.
pub fn load() -> Scenario {
    let body = brick();
    let start =
        spinning(&body, [0.0, 3.0, 0.0], [1.5, 2.5, 1.0]).with_velocity(DVec3::new(0.5, 4.0, -0.5));
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 20.0);
    Scenario {
        id: "load",
        title: "Load test",
        lesson: "Thousands of boxes thrown over a floor. Compare the cost per box and step of each integrator, in nanoseconds.",
        hints: [
            "Press [Boxes 100] or [Boxes 4000] and read the time per step.",
            "Open the [Timing tab]: four evaluations need not cost four times as much.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.5, 0.5)),
        recommended: &["split", "rk4", "semi-implicit-euler"],
        boxes: 1000,
        view: SceneView::from(30.0, 28.0).with_plot(Plot::Timing),
    }
}

/// A corner drop with friction.
pub fn contact() -> Scenario {
    let body = solid([0.5, 0.25, 0.375], 3.0);
    let tilted = DQuat::from_xyzw(0.25, 0.05, 0.2, 0.95);
    let start = BodyState::at_pose(DVec3::Y * 2.0, tilted).with_velocity(DVec3::new(1.0, 0.0, 0.0));
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 6.0);
    Scenario {
        id: "contact",
        title: "Corner drop",
        lesson: "A tilted box lands on one corner, and its fall becomes spin. The rest of the motion depends on the exact time of impact.",
        hints: [
            "Press [Step] to go through the impact.",
            "Read [Total energy]: it may decrease at an impact but must never increase.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.5, 0.4)),
        recommended: &["split", "rk4", "semi-implicit-euler", "explicit-euler"],
        boxes: 1,
        view: SceneView::from(20.0, 12.0).at([0.6, 0.9, 0.0], 5.0),
    }
}

/// Dice between walls.
pub fn dice_tray() -> Scenario {
    let body = solid([0.25; 3], 1.0);
    let start =
        spinning(&body, [0.0, 2.0, 0.0], [5.0, 3.0, -8.0]).with_velocity(DVec3::new(7.0, 1.0, 4.0));
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 8.0);
    Scenario {
        id: "dice-tray",
        title: "Dice tray",
        lesson: "Dice are thrown against the walls of a tray. In an edge or a corner, all contacts are solved together. Energy never grows there either, and a die at rest does not move at all.",
        hints: [
            "Press [Boxes 25] for more dice.",
            "Press [Restitution 1], [Friction 0] and [Restart]: they never stop.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.4, 0.3).in_tray(3.0)),
        recommended: &["split", "exact", "rk4"],
        boxes: 9,
        view: SceneView::from(25.0, 40.0).at([0.0, 0.3, 0.0], 11.0),
    }
}

/// The demo of 2012: one cube over a ground plane.
pub fn dissertation_2012() -> Scenario {
    let body = solid([0.5; 3], 10.0);
    let start = spinning(&body, [0.0, 4.5, 0.0], [0.0; 3]);
    let setup = Setup::new(body, start, ForceSet::gravity(GRAVITY), 30.0);
    Scenario {
        id: "dissertation-2012",
        title: "The 2012 demo",
        lesson: "One cube over a ground plane, pushed along its axes, as in V. Stojanovic's dissertation of 2012. Its implicit Euler is Heun's explicit method.",
        hints: [
            "Press [box_physics] and [Restart]: the fall becomes a parabola, and it bounces.",
            "Press [Push +x] twice, quickly: in 2012 the second push replaces the first.",
        ],
        setup: setup.with_floor(FloorSpec::at_zero(0.5, 0.0)),
        recommended: &["heun-2012", "rk4", "explicit-euler", "backward-euler"],
        boxes: 1,
        view: SceneView::from(30.0, 16.0)
            .at([0.0, 1.6, 0.0], 9.0)
            .with_plot(Plot::Cpu),
    }
}
