//! Scenes with springs and torques.

use box_physics::state::BodyState;
use glam::DVec3;

use super::bodies::{brick, solid, spinning};
use crate::forces::ForceSet;
use crate::reference::turn;
use crate::scenario::Scenario;
use crate::setup::Setup;
use crate::view::SceneView;

/// A box in orbit on a spring: a closed ellipse.
pub fn spring_orbit() -> Scenario {
    let body = brick();
    let start =
        spinning(&body, [2.0, 2.0, 0.0], [0.5, 4.0, 1.0]).with_velocity(DVec3::new(0.0, 0.0, 3.0));
    // Ω = 2 rad/s: one orbit in π seconds.
    let forces = ForceSet::none().with_spring(DVec3::ZERO, DVec3::new(0.0, 2.0, 0.0), 12.0, 0.0);
    Scenario {
        id: "spring-orbit",
        title: "Spring orbit",
        lesson: "A spring to a fixed point moves the box along an ellipse that closes every π seconds. Symplectic integrators preserve its size, RK4 shrinks it slowly, Euler spirals out or in.",
        hints: [
            "Press [30 Hz]: Explicit Euler leaves the ellipse sooner.",
            "Open the [Energy tab]: the energy of Split oscillates but never drifts.",
        ],
        setup: Setup::new(body, start, forces, 30.0),
        recommended: &["split", "semi-implicit-euler", "explicit-euler", "rk4"],
        boxes: 1,
        view: SceneView::from(10.0, 50.0).at([0.0, 2.0, 0.0], 7.0),
    }
}

/// A stiff spring at a corner, near the stability limit of every explicit integrator at 60 Hz.
pub fn stiff_spring() -> Scenario {
    let body = solid([0.25; 3], 2.0);
    let start =
        spinning(&body, [0.0, 2.2, 0.0], [0.0, 0.5, 0.0]).with_velocity(DVec3::new(0.5, 0.0, 0.0));
    // At the corner the largest ω² is k (1/m + |r|²/I) = 5.5 k/m for a cube (|r|² = ¾ a², I = m a²/6
    // with edge a): ω·dt = 1.0 at 60 Hz, where ω = 60 rad/s.
    let k = 2.0 * 60.0 * 60.0 / 5.5;
    let forces =
        ForceSet::none().with_spring(DVec3::splat(0.25), DVec3::new(0.25, 2.4, 0.25), k, 0.0);
    Scenario {
        id: "stiff-spring",
        title: "Stiff spring",
        lesson: "A spring at a corner, stiff enough that ω·dt is 1 at 60 Hz. Velocity Verlet is stable up to 2, RK4 up to 2.83, Split up to 3.46; implicit integrators always, some by damping the motion.",
        hints: [
            "Compare with [Velocity Verlet] and press [30 Hz]: ω·dt is 2, its limit.",
            "Open the [Energy tab]: Backward Euler is stable but damps the oscillation within a second.",
        ],
        setup: Setup::new(body, start, forces, 4.0),
        recommended: &["split", "rk4", "backward-euler", "implicit-midpoint"],
        boxes: 1,
        view: SceneView::from(30.0, 20.0),
    }
}

/// A heavy top, modeled as a dipole in a field: precession and nutation.
pub fn heavy_top() -> Scenario {
    let body = solid([0.25, 0.5, 0.25], 6.0);
    let leaning = turn(DVec3::X, 40.0_f64.to_radians());
    let start = BodyState::at_pose(DVec3::Y * 2.0, leaning)
        .with_body_angular_velocity(&body, DVec3::Y * 12.0);
    // The torque of gravity on an upright top with m g l = 4 N m, without a pivot.
    let forces = ForceSet::none().with_dipole(DVec3::NEG_Y * 4.0, DVec3::Y);
    Scenario {
        id: "heavy-top",
        title: "Heavy top",
        lesson: "A leaning, spinning bar does not fall: it precesses and nutates. Energy, the spin about its axis and the vertical angular momentum are constant.",
        hints: [
            "Raise [dt] until the nutation is wrong, then compare with [Split, order 4].",
            "Compare with [Implicit midpoint]: it conserves the energy but lags in phase.",
        ],
        setup: Setup::new(body, start, forces, 5.0),
        recommended: &["split", "explicit-euler", "rk4", "split4"],
        boxes: 1,
        view: SceneView::from(25.0, 12.0),
    }
}
