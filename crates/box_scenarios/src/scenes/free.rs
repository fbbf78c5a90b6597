//! Scenes with free rotation only.

use super::bodies::{brick, solid, spinning};
use crate::forces::ForceSet;
use crate::scenario::Scenario;
use crate::setup::Setup;
use crate::view::{Plot, SceneView};

/// Position of freely spinning boxes: 2 m above the ground.
const AT: [f64; 3] = [0.0, 2.0, 0.0];

/// Spin about the middle axis, which flips repeatedly.
pub fn dzhanibekov() -> Scenario {
    let body = brick();
    let start = spinning(&body, AT, [0.01, 8.0, -0.005]);
    Scenario {
        id: "dzhanibekov",
        title: "Dzhanibekov flip",
        lesson: "A box that spins about its intermediate axis flips every few seconds. If its energy drifts, it flips too early, too late, or the wrong way.",
        hints: [
            "Compare with [Explicit Euler]: it gains energy and stops flipping.",
            "Press [120 Hz]: the flips of accurate integrators do not move.",
        ],
        setup: Setup::new(body, start, ForceSet::none(), 12.0),
        recommended: &["split", "semi-implicit-euler", "engine-rescaled", "rk4"],
        boxes: 1,
        view: SceneView::from(30.0, 22.0),
    }
}

/// Spin slightly off the shortest axis, which must remain stable.
pub fn stable_axis() -> Scenario {
    let body = brick();
    let start = spinning(&body, AT, [0.4, 0.3, 6.0]);
    Scenario {
        id: "stable-axis",
        title: "Stable axis",
        lesson: "Spin about the axis of the largest moment wobbles but never flips. Energy and angular momentum are constant, so any drift is an integrator error.",
        hints: [
            "Press [Faster] and open the [Energy tab] after a minute.",
            "Press [Side by side]. Engine: rescaled conserves |L| but not the energy, so it drifts and flips.",
        ],
        setup: Setup::new(body, start, ForceSet::none(), 60.0),
        recommended: &[
            "split",
            "engine-rescaled",
            "explicit-euler",
            "backward-euler",
        ],
        boxes: 1,
        view: SceneView::from(30.0, 22.0),
    }
}

/// A tumbling plate, 64:1.
pub fn thin_plate() -> Scenario {
    let body = solid([0.5, 1.0 / 128.0, 0.375], 3.0);
    let start = spinning(&body, AT, [3.0, 0.5, 4.0]);
    Scenario {
        id: "thin-plate",
        title: "Thin plate",
        lesson: "The largest moment of a thin plate is the sum of the other two, the extreme case for a rigid body. Second-order integrators gain energy here first.",
        hints: [
            "Compare with [Midpoint (RK2)]: Implicit midpoint has the same order but conserves the energy.",
            "Press [30 Hz] and see which integrators still match the reference.",
        ],
        setup: Setup::new(body, start, ForceSet::none(), 10.0),
        recommended: &["split", "semi-implicit-euler", "implicit-midpoint", "rk4"],
        boxes: 1,
        view: SceneView::from(30.0, 25.0),
    }
}

/// A needle with moments 800:1, spinning about its length.
pub fn needle() -> Scenario {
    let body = solid([1.0, 1.0 / 64.0, 1.0 / 32.0], 3.0);
    let start = spinning(&body, AT, [20.0, 1.0, 0.5]);
    Scenario {
        id: "needle",
        title: "Needle",
        lesson: "A thin rod spins fast about its long axis, with moments 800 to 1. At 60 Hz, explicit gyroscopic terms diverge, and implicit ones lose a quarter of the energy.",
        hints: [
            "Press [Restart] and watch Semi-implicit Euler: it diverges within a second.",
            "Open the [Error tab]: Split is accurate to rounding.",
        ],
        setup: Setup::new(body, start, ForceSet::none(), 5.0),
        recommended: &["split", "engine-newton", "semi-implicit-euler", "rk4"],
        boxes: 1,
        view: SceneView::from(30.0, 25.0),
    }
}

/// A square bar in steady precession.
pub fn symmetric_top() -> Scenario {
    let body = solid([0.25, 0.5, 0.25], 6.0);
    let start = spinning(&body, AT, [2.0, 6.0, 0.0]);
    Scenario {
        id: "symmetric-top",
        title: "Symmetric top",
        lesson: "A square bar precesses steadily: its axis traces a cone at the rate L/I. Split is exact at any step size; most integrators are not.",
        hints: [
            "Press [dt 1/10 s]: Split is still exact.",
            "Press [Views] and compare the cones' angles.",
        ],
        setup: Setup::new(body, start, ForceSet::none(), 10.0),
        recommended: &["split", "backward-euler", "semi-implicit-euler", "rk4"],
        boxes: 1,
        view: SceneView::from(30.0, 25.0).with_plot(Plot::Error),
    }
}

/// Tumbling with damping: the free motion in slowing time.
pub fn damped_spin() -> Scenario {
    let body = brick();
    let start = spinning(&body, AT, [1.0, 8.0, 2.0]);
    let forces = ForceSet {
        angular_damping: 0.25,
        ..ForceSet::none()
    };
    Scenario {
        id: "damped-spin",
        title: "Damped spin",
        lesson: "Damping proportional to the angular momentum only slows time down: the box tumbles freely in the time (1 − e^(−γt))/γ, so its final attitude is known in advance.",
        hints: [
            "Press [Ang. damping 180] and [Restart]: γ·dt is 3. Explicit integrators diverge, Split remains exact.",
            "Open the [Energy tab]: the direction of L never changes.",
        ],
        setup: Setup::new(body, start, forces, 10.0),
        recommended: &["split", "semi-implicit-euler", "rk4", "exact"],
        boxes: 1,
        view: SceneView::from(30.0, 22.0),
    }
}

/// Spin close to the separatrix between the two kinds of tumbling.
pub fn separatrix() -> Scenario {
    let body = brick();
    let start = spinning(&body, AT, [1e-6, 6.0, 1e-6]);
    Scenario {
        id: "separatrix",
        title: "Separatrix",
        lesson: "A spin within a millionth of the intermediate axis flips only after a long time. A relative energy error of 1e-12 already shifts the flip.",
        hints: [
            "Open the [Energy tab]: Velocity Verlet is off by 1e-4, RK4 is accurate to rounding.",
            "Compare with [Engine: Avian 993]: if it does not flip, the gyroscopic term is missing.",
        ],
        setup: Setup::new(body, start, ForceSet::none(), 12.0),
        recommended: &["split", "velocity-verlet", "rk4", "implicit-midpoint"],
        boxes: 1,
        view: SceneView::from(30.0, 22.0).with_plot(Plot::Error),
    }
}
