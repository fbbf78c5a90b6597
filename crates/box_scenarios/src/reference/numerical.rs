//! The numerical reference: Dormand and Prince's Runge–Kutta method of order 8(5,3) (Hairer, Nørsett, Wanner, *Solving
//! ODEs I*, II.10) on (x, q, v, L), at two step sizes whose difference is reported.
//!
//! The steps are equal parts of an interval. The usual step size control uses a power function, which the platform's
//! library computes with different bits on different machines.

use box_physics::body::RigidBox;
use box_physics::force::{Forces, rates};
use box_physics::rotation::quaternion_rate;
use box_physics::state::BodyState;
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use glam::{DQuat, DVec3};

use crate::metrics::StateError;
use crate::setup::Setup;

/// Relative and absolute tolerance of each step of the coarser run. The finer run takes two steps for each.
const TOLERANCE: f64 = 1e-13;
/// A tolerance that every step satisfies.
const ANY: f64 = 1.0;
/// Interval between stored states \[s\]. A time between two of them is reached by integrating from the earlier one.
const SPACING: f64 = 1.0 / 32.0;
/// Maximum number of steps of the coarser run between two stored states.
const MAX_STEPS: usize = 1 << 20;

/// Stored states, and the data needed to continue from them.
#[derive(Clone, Debug)]
pub(crate) struct Numerical {
    setup: Setup,
    /// States, each with the number of steps to the next.
    nodes: Vec<(BodyState, usize)>,
    duration: f64,
    agreement: f64,
}

impl Numerical {
    /// Integrates from `start` for `duration` \[s\]; `None` if no step size satisfies the tolerance.
    pub(crate) fn new(setup: &Setup, start: &BodyState, duration: f64) -> Option<Self> {
        let count = (duration / SPACING).ceil() as usize;
        let mut nodes = Vec::with_capacity(count + 1);
        let (mut fine, mut coarse) = (*start, *start);
        let scale = start.angular_momentum.length().max(f64::MIN_POSITIVE);
        let (mut steps, mut agreement) = (1, 0.0_f64);
        for _ in 0..count {
            coarse = loop {
                match integrate(setup, &coarse, SPACING, steps, TOLERANCE) {
                    Some(next) => break next,
                    None if steps < MAX_STEPS => steps *= 2,
                    None => return None,
                }
            };
            nodes.push((fine, 2 * steps));
            fine = integrate(setup, &fine, SPACING, 2 * steps, ANY)?;
            let e = StateError::between(&fine, &coarse);
            let momentum = e.angular_momentum / scale.max(fine.angular_momentum.length());
            agreement = agreement
                .max(e.position)
                .max(e.velocity)
                .max(e.attitude)
                .max(momentum);
        }
        nodes.push((fine, 2 * steps));
        Some(Self {
            setup: setup.clone(),
            nodes,
            duration,
            agreement,
        })
    }

    /// The largest difference between the two runs.
    pub(crate) fn agreement(&self) -> f64 {
        self.agreement
    }

    /// The state after `t` \[s\], up to the duration.
    pub(crate) fn at(&self, t: f64) -> Option<BodyState> {
        if t > self.duration * (1.0 + 1e-12) {
            return None;
        }
        let k = (t / SPACING).floor();
        let (node, steps) = self.nodes.get(k as usize)?;
        integrate(&self.setup, node, t - k * SPACING, *steps, ANY)
    }
}

struct Motion<'a> {
    body: &'a RigidBox,
    forces: Forces<'a>,
}

impl ODE<f64, [f64; 13]> for Motion<'_> {
    fn diff(&self, _t: f64, y: &[f64; 13], dydt: &mut [f64; 13]) {
        let state = unpack(y);
        let (dv, dl) = rates(self.body, &state, &self.forces);
        let dq = quaternion_rate(state.rotation, state.body_angular_velocity(self.body));
        let slope = BodyState {
            position: state.velocity,
            rotation: dq,
            velocity: dv,
            angular_momentum: dl,
        };
        *dydt = slope.to_array();
    }
}

/// Integrates for `t` \[s\] in equal steps. Returns `None` if the estimated error of a step exceeds the tolerance.
fn integrate(
    setup: &Setup,
    from: &BodyState,
    t: f64,
    steps: usize,
    tolerance: f64,
) -> Option<BodyState> {
    if t <= 0.0 {
        return Some(*from);
    }
    let motion = Motion {
        body: &setup.body,
        forces: setup.forces.forces(&setup.body),
    };
    let method = ExplicitRungeKutta::dop853()
        .rtol(tolerance)
        .atol(tolerance)
        .h0(t / steps as f64)
        .min_scale(1.0)
        .max_scale(1.0)
        // A rejected step would be repeated forever. Rounding may leave an additional, tiny last step.
        .max_steps(steps + 1);
    let solution = IVP::ode(&motion, 0.0, t, from.to_array())
        .method(method)
        .solve()
        .ok()?;
    let mut end = unpack(solution.y.last()?);
    end.rotation = end.rotation.normalize();
    end.is_finite().then_some(end)
}

fn unpack(y: &[f64; 13]) -> BodyState {
    BodyState {
        position: DVec3::new(y[0], y[1], y[2]),
        rotation: DQuat::from_xyzw(y[3], y[4], y[5], y[6]),
        velocity: DVec3::new(y[7], y[8], y[9]),
        angular_momentum: DVec3::new(y[10], y[11], y[12]),
    }
}
