//! The list of families. To add one, add a row.

use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use super::{Family, Metric};
use crate::forces::ForceSet;
use crate::scenario::Scenario;
use crate::setup::{FloorSpec, Setup};

/// The families, in the order of the report.
#[rustfmt::skip]
pub(super) fn families() -> Vec<Family> {
    use Metric::{Attitude, Energy, Position};
    let solid = |half: [f64; 3], mass: f64| {
        RigidBox::new(DVec3::from_array(half), mass)
            .expect("the numbers of a built-in family are valid: a test builds every one")
    };
    let scene = |build: fn() -> Scenario, duration: f64| Setup {
        duration,
        ..build().setup
    };
    let brick = solid([0.5, 0.25, 0.125], 3.0);
    let cube = solid([0.5; 3], 2.0);
    let tumble =
        BodyState::at(DVec3::Y * 2.0).with_body_angular_velocity(&brick, DVec3::new(1.5, 2.5, 1.0));
    let top = solid([3.0, 2.0, 1.0], 6.0);
    let top_start =
        BodyState::default().with_body_angular_velocity(&top, DVec3::new(1.0, 15.0, 1.0));
    let thrown = BodyState::at(DVec3::Y).with_velocity(DVec3::new(10.0, 12.0, 3.0));
    let drag = ForceSet {
        linear_drag: 1.0,
        ..ForceSet::gravity(9.81)
    };
    let corner = solid([0.5, 0.25, 0.375], 3.0);
    let tilted = BodyState::at_pose(DVec3::Y * 1.5, DQuat::from_xyzw(0.25, 0.075, 0.2, 1.063))
        .with_velocity(DVec3::X)
        .with_body_angular_velocity(&corner, DVec3::new(0.5, 1.5, -0.25));
    let family = |id, title, what, setup: Setup, metrics, watch| Family {
        id,
        title,
        what,
        setup,
        metrics,
        watch,
    };
    vec![
        family("free-tumble", "Free tumble", "An ordinary box, 4:2:1, tumbles for 10 s without any force.",
            Setup::new(brick, tumble, ForceSet::none(), 10.0), &[Attitude, Energy], 60.0),
        family("flip", "Near-separatrix flip",
            "The same box, spun at 8 rad/s about its intermediate axis, flips every few seconds.",
            scene(crate::scenes::free::dzhanibekov, 10.0), &[Attitude, Energy], 60.0),
        family("thin-plate", "Thin plate", "A 64:1 plate tumbles; its largest moment is the sum of the other two.",
            scene(crate::scenes::free::thin_plate, 10.0), &[Attitude, Energy], 60.0),
        family("needle", "Needle", "A rod with moments 800:1 spins at 20 rad/s, slightly off its long axis.",
            scene(crate::scenes::free::needle, 5.0), &[Attitude, Energy], 60.0),
        family("symmetric-top", "Symmetric top", "A square bar precesses steadily.",
            scene(crate::scenes::free::symmetric_top, 10.0), &[Attitude, Energy], 60.0),
        family("free-top", "Free top of van Zon and Schofield",
            "Moments 10, 20, 26 kg m² at 15 rad/s near the intermediate axis, as in J. Comput. Phys. 225 (2007).",
            Setup::new(top, top_start, ForceSet::none(), 4.0), &[Attitude, Energy], 60.0),
        family("linear-drag", "Projectile, linear drag",
            "A throw with drag proportional to the speed, c/m = 0.5 1/s.", Setup::new(cube, thrown, drag, 10.0),
            &[Position], 60.0),
        family("quadratic-drag", "Projectile, quadratic drag",
            "A throw straight up at 45 m/s through air, and down again.",
            scene(crate::scenes::flight::quadratic_drag, 8.0), &[Position], 60.0),
        family("heavy-top", "Heavy top", "A leaning, spinning bar precesses and nutates under a torque.",
            scene(crate::scenes::forced::heavy_top, 5.0), &[Attitude, Energy], 60.0),
        family("spring", "Spring orbit", "A tumbling box on a spring: an ellipse that closes every π seconds.",
            scene(crate::scenes::forced::spring_orbit, 10.0), &[Position, Attitude, Energy], 60.0),
        family("damped-spin", "Damped spin", "Tumbling under a torque −γL, γ = 0.25 1/s.",
            scene(crate::scenes::free::damped_spin, 10.0), &[Attitude], 60.0),
        family("bounce", "Bounce",
            "A flat drop from a meter with e = 1: ten seconds of bounces to the same height.",
            scene(crate::scenes::floor::bounce, 10.0), &[Position, Energy], 60.0),
        family("corner-drop", "Corner drop",
            "A tilted, slowly turning box falls on a frictionless floor with e = 0.5, corner after corner.",
            Setup::new(corner, tilted, ForceSet::gravity(9.81), 16.0 / 15.0).with_floor(FloorSpec::at_zero(0.5, 0.0)),
            &[Attitude, Position], 16.0 / 15.0),
    ]
}
