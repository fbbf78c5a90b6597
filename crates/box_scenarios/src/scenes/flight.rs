//! Scenes of the center of mass under gravity and drag.

use glam::DVec3;

use super::bodies::{GRAVITY, brick, solid, spinning};
use crate::forces::ForceSet;
use crate::scenario::Scenario;
use crate::setup::Setup;
use crate::view::{Plot, SceneView};

/// A ball's throw: a parabola.
pub fn ballistic() -> Scenario {
    let body = solid([0.25; 3], 2.0);
    let start = spinning(&body, [-8.0, 0.5, 0.0], [0.0, 0.0, -3.0])
        .with_velocity(DVec3::new(4.0, 18.0, 0.0));
    Scenario {
        id: "ballistic",
        title: "Ballistic throw",
        lesson: "The simplest motion: a parabola. Semi-implicit Euler and the 2012 integrator are off by exactly ½·g·dt·t, a third of a meter after 4 s; second-order integrators are exact to rounding.",
        hints: [
            "Press [120 Hz]: the first-order errors halve.",
            "Press [Side by side]: Explicit Euler is too high by as much as Semi-implicit Euler is too low.",
        ],
        setup: Setup::new(body, start, ForceSet::gravity(GRAVITY), 4.0),
        recommended: &[
            "split",
            "explicit-euler",
            "semi-implicit-euler",
            "heun-2012",
        ],
        boxes: 1,
        // Close to the box, because the differences between integrators are smaller than it.
        view: SceneView::from(20.0, 10.0).with_plot(Plot::Error),
    }
}

/// Drag a thousand times faster than the motion.
pub fn stiff_drag() -> Scenario {
    let body = solid([0.5; 3], 2.0);
    let start =
        spinning(&body, [0.0, 4.0, 0.0], [0.0; 3]).with_velocity(DVec3::new(10.0, 20.0, -5.0));
    let forces = ForceSet {
        linear_drag: 500.0,
        ..ForceSet::gravity(GRAVITY)
    };
    Scenario {
        id: "stiff-drag",
        title: "Stiff drag",
        lesson: "Drag of 250 per second stops the throw in milliseconds. Explicit integrators diverge for c·dt/m above 2 (RK4: 2.79); implicit and exponential ones remain stable.",
        hints: [
            "Press [Linear drag 300] and [Restart]: c·dt/m falls to 2.5, below the limit of RK4.",
            "Compare with [Implicit midpoint] and open the [Error tab]: it oscillates, as its amplification factor tends to −1.",
        ],
        setup: Setup::new(body, start, forces, 3.0),
        recommended: &["split", "rk4", "backward-euler", "implicit-midpoint"],
        boxes: 1,
        // Close to the box, which takes 25 s to fall by its own height.
        view: SceneView::from(8.0, 15.0)
            .at([0.0, 3.9, 0.0], 4.5)
            .with_plot(Plot::Error),
    }
}

/// A throw through air.
pub fn quadratic_drag() -> Scenario {
    let body = solid([0.5; 3], 2.0);
    let start =
        spinning(&body, [0.0, 0.5, 0.0], [0.0, 0.0, 5.0]).with_velocity(DVec3::new(0.0, 45.0, 0.0));
    let forces = ForceSet {
        quadratic_drag: 1.0 / 24.0,
        ..ForceSet::gravity(GRAVITY)
    };
    Scenario {
        id: "quadratic-drag",
        title: "Quadratic drag",
        lesson: "A throw straight up at 45 m/s through air. The exact velocity is a tangent on the way up and a hyperbolic tangent on the way down. Drag must never reverse the velocity.",
        hints: [
            "Press [Strength 1e4] and [Push +y]: explicit integrators reverse the velocity.",
            "Press [Sweep] in the [Work–precision tab]: each slope is the order of the integrator.",
        ],
        setup: Setup::new(body, start, forces, 8.0),
        recommended: &["split", "rk4", "velocity-verlet", "explicit-euler"],
        boxes: 1,
        view: SceneView::from(8.0, 10.0).with_plot(Plot::Error),
    }
}

/// A tumbling throw: parabola and free rotation together.
pub fn throw() -> Scenario {
    let body = brick();
    let start = spinning(&body, [-4.0, 1.0, 0.0], [1.5, 7.0, -2.0])
        .with_velocity(DVec3::new(2.0, 20.0, 1.0));
    Scenario {
        id: "throw",
        title: "Tumbling throw",
        lesson: "The center follows a parabola while the box tumbles freely, because gravity exerts no torque. Errors in one do not affect the other.",
        hints: [
            "Press [Sweep] in the [Work–precision tab]: position and attitude can have different orders.",
            "Press [equal cost]: cheaper integrators take smaller steps.",
        ],
        setup: Setup::new(body, start, ForceSet::gravity(GRAVITY), 4.0),
        recommended: &["split", "rk4", "semi-implicit-euler", "explicit-euler"],
        boxes: 1,
        view: SceneView::from(15.0, 8.0).with_plot(Plot::Error),
    }
}
