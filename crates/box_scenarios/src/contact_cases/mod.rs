//! The hard cases of contact, numbers 25 to 32: bounces, rest, balance, sliding, tipping, corner impacts, spin-down,
//! and impacts within long steps. Like the [`mod@crate::hard_cases`], each has a measured quantity and a bound up to
//! which the result is ok.

mod bounce;
mod drops;
mod rest;
mod slide;
mod trial;

use box_physics::integrators::Integrator;

use crate::hard_cases::Finding;

pub use trial::Trial;

/// Step of all cases, unless stated otherwise \[s\].
pub const STEP: f64 = 1.0 / 60.0;
/// Gravity of all cases [m/s²].
const G: f64 = crate::scenes::GRAVITY;

/// One measurement of a case.
#[derive(Clone, Copy, Debug)]
pub struct ContactCase {
    /// Number of the case, 25 to 32; some cases measure several quantities.
    pub number: u8,
    /// Description of the motion.
    pub title: &'static str,
    /// The measured quantity, with its unit.
    pub quantity: &'static str,
    /// Largest value that is ok.
    pub bound: f64,
    measure: fn(Integrator) -> f64,
}

impl ContactCase {
    /// Measures the quantity; NaN or infinite if the motion diverged.
    pub fn measure(&self, integrator: Integrator) -> f64 {
        (self.measure)(integrator)
    }

    /// Measures the quantity and returns it as a finding; a value that is not finite counts as diverged.
    pub fn examine(&self, integrator: Integrator) -> Finding {
        let value = self.measure(integrator);
        Finding {
            h: STEP,
            quantity: self.quantity,
            value,
            bound: self.bound,
            sane: value.is_finite(),
        }
    }
}

/// All cases, in the order of their numbers.
#[rustfmt::skip]
pub fn contact_cases() -> Vec<ContactCase> {
    let case = |number, title, quantity, bound, measure: fn(Integrator) -> f64| ContactCase {
        number,
        title,
        quantity,
        bound,
        measure,
    };
    vec![
        case(25, "flat bounces, e = 0.5, to rest (pub16)", "position error over the run [m]", 2e-4,
            bounce::position_error),
        case(25, "the same", "position error before the eighth bounce [m]", 1e-6, bounce::position_error_early),
        case(25, "the same", "settling time against √(2h/g)(1+e)/(1−e), relative", 0.01, bounce::settling_time),
        case(25, "ten bounces with e = 0.9, 0.5, 0.1, a hundred with e = 1",
            "height of the apexes against e²ⁿh [m]", 1e-6, bounce::apexes),
        case(26, "at rest on each of the six faces, 1e5 steps", "components of the state that changed", 0.0,
            rest::changed_components),
        case(27, "falling off an edge without slip, from 1e-1 to 1e-8 rad",
            "time against the quadrature of θ̇(θ), relative", 0.01, rest::edge_fall_sticking),
        case(27, "the same without friction", "time against the quadrature of θ̇(θ), relative", 0.01,
            rest::edge_fall_frictionless),
        case(27, "balanced on an edge, on a corner", "time until it falls [s]", 60.0, rest::balance),
        case(27, "the same", "growth of the spin against e^{λt}, λ² = m g d/I, relative", 0.01,
            rest::balance_growth),
        case(28, "sliding to rest, µ = 0.5 (pub17)", "position error over the run [m]", 1e-3,
            slide::position_error),
        case(28, "the same", "stopping time, off by [steps]", 1.0, slide::stopping_time),
        case(28, "twelve directions of sliding", "stopping point against v²/2µg along the line [m]", 1e-3,
            slide::diagonals),
        case(28, "sliding with growing friction until it tips", "threshold against µ = hx/hy, relative", 0.02,
            slide::tipping_by_friction),
        case(29, "pushed above its center until it tips", "threshold against F·H = m g hx, relative", 0.02,
            slide::tipping_by_push),
        case(30, "corner impact without friction (pub18)", "velocity after the impact, relative error", 1e-6,
            bounce::corner_velocity),
        case(30, "the same", "angular velocity after the impact, relative error", 1e-6, bounce::corner_spin),
        case(30, "the same", "position error 0.07 s later [m]", 1e-6, bounce::corner_position),
        case(30, "a thousand random drops of cubes, 30 steps each", "largest gain of energy in a step, relative",
            1e-11, drops::gain),
        case(30, "a thousand random impacts of boxes, e to 1, µ to 5",
            "energy returned beyond e² of what a plastic impact takes, relative", 1e-9, drops::energetic_excess),
        case(30, "the same under Newton's law",
            "energy returned beyond e² of what a plastic impact takes, relative", 1.0, drops::newton_excess),
        case(30, "the drops of cubes, steps without impacts", "gain by errors that was taken back, relative", 0.01,
            drops::repaired_segments),
        case(31, "spinning plate, 3 and 20 rad/s",
            "time to rest against the law of four loaded corners, off by [steps]", 1.0, slide::spin_down),
        case(31, "the same", "walk of the center [m]", 1e-3, slide::walk),
        case(32, "5 mm thick, 300 m/s, up to 1000 rad/s, steps of 1e-5 to 0.5 s",
            "deepest corner over the circumradius", 1e-9, drops::depth),
    ]
}
