//! Sliding on a face without tipping, the most frequent sustained motion, as a problem in the plane.
//!
//! The corners k bear N_k ≥ 0 and slip with w_k, so that the forces on them are N_k (n − µŵ_k), ŵ_k = w_k/|w_k|.
//! There is no torque about the horizontal axes as long as the box does not tip, so that with the arms ρ_k in the
//! plane, the height of the center h, and Σ N_k = N
//!
//! ```text
//! Σ N_k ρ_k = µh Σ N_k ŵ_k,     N_k = ¼N (1 + σ_k1 p_1/h_1 + σ_k2 p_2/h_2)
//! ```
//!
//! The second equation is the smallest distribution of load whose center of pressure is p (h_1, h_2 the half-extents
//! of the face, σ_k = ±1 the signs of the corner). Two linear equations for p remain. Without spin all ŵ_k are one,
//! and the deceleration is constant. Otherwise velocity and spin, in the axes of the box, obey a plain differential
//! equation, since a face's normal is a principal axis.

use glam::{DVec2, DVec3};

use super::frame::Level;
use super::geometry::{has, mask};
use super::ground::Ground;
use crate::force::ForceModel;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// Result of a step of sliding.
pub(super) struct Slide {
    /// Duration \[s\]: less than the step if the box stopped.
    pub(super) time: f64,
    /// Mean normal force at each corner \[N\].
    pub(super) load: [f64; 8],
    /// Evaluations of the friction.
    pub(super) evaluations: u32,
}

/// Largest turn in one step \[rad\], and largest relative change of a corner's slip. Beyond, the step is solved by events.
const LARGEST_TURN: f64 = 0.25;
const LARGEST_CHANGE: f64 = 0.5;

/// Slides a box that touches the floor with the four corners `touching` for `h` \[s\]. Returns `None` and leaves `state`
/// unchanged unless the force is uniform, the face is level, the box does not tip and, if it spins, nothing pulls it along
/// the floor. Also `None` for an integrator of order 1 in uniform gravity, which has its own error there.
pub(super) fn slide<F: ForceModel>(
    level: &Level<'_, F>,
    state: &mut BodyState,
    h: f64,
    touching: u8,
) -> Option<Slide> {
    let (floor, body, pull) = (level.context.floor, level.context.body, level.pull);
    if !level.is_uniform() || level.method.errs_in_gravity {
        return None;
    }
    let half = body.half_extents();
    let n = state.rotation.inverse() * DVec3::Y;
    let reach = n.abs() * half;
    // The axis across the face, and the two in it.
    let c = (0..3).fold(0, |c, i| if n[i].abs() > n[c].abs() { i } else { c });
    let (i, j) = ((c + 1) % 3, (c + 2) % 3);
    let tolerance = level.tolerance;
    let low = state.position.y - floor.height - reach.element_sum();
    let below = mask(|k| has(k as u8, c) == (n[c] < 0.0));
    if touching != below || reach[i] + reach[j] > tolerance || low.abs() > 2.0 * tolerance {
        return None;
    }
    let v = state.rotation.inverse() * state.velocity;
    let omega = state.body_angular_velocity(body);
    let tilting = (omega[i].abs() + omega[j].abs()) * body.radius();
    let speed = v.length() + omega[c].abs() * body.radius();
    if pull.y >= 0.0 || v[c].abs() + tilting > 1e-14 * speed || speed == 0.0 {
        return None;
    }
    let face = Face {
        half: DVec2::new(half[i], half[j]),
        height: half[c],
        friction: floor.friction,
        pressure: -pull.y,
        // m/I of the spin
        mass_over_inertia: body.mass() * body.inverse_inertia()[c],
    };
    let flat = BodyState {
        velocity: state.velocity.with_y(0.0),
        angular_momentum: DVec3::ZERO,
        ..*state
    };
    let (end, time, share, evaluations) = if omega[c] == 0.0 {
        let t = DVec2::new(v[i], v[j]) / speed;
        let share = Face::shares(face.friction * face.height * t / face.half)?;
        let (end, time) = face.straight(flat, pull.with_y(0.0), h)?;
        (end, time, share, 1)
    } else {
        if pull.x != 0.0 || pull.z != 0.0 {
            return None;
        }
        let start = DVec3::new(v[i], v[j], omega[c]);
        let (next, way, share) = face.turning(start, h)?;
        let mut end = flat;
        let axis = |value: f64| {
            let mut vector = DVec3::ZERO;
            vector[c] = value;
            vector
        };
        let plane = |u: DVec2| {
            let mut vector = DVec3::ZERO;
            (vector[i], vector[j]) = (u.x, u.y);
            vector
        };
        let turned = compose(state.rotation, exponential_map(axis(way.turn)));
        end.rotation = turned;
        end.renormalize();
        // From the velocities at both ends, each in its own axes.
        let way = state.rotation * plane(way.first) + end.rotation * plane(way.second);
        end.position += way.with_y(0.0);
        end.velocity = (end.rotation * plane(next.truncate())).with_y(0.0);
        end.angular_momentum = axis(next.z) * body.inertia();
        let mut corners = level.places(&end, h);
        level.recover(&mut end, &mut corners, h);
        (end, h, share, 5)
    };
    *state = end;
    let weight = body.mass() * face.pressure;
    let side = |k: usize, axis: usize| usize::from(has(k as u8, axis));
    let load = core::array::from_fn(|k| {
        if has(touching, k) {
            weight * share[side(k, i) + 2 * side(k, j)]
        } else {
            0.0
        }
    });
    Some(Slide {
        time,
        load,
        evaluations,
    })
}

/// The face below, per unit of mass.
struct Face {
    /// Half-extents of the face \[m\].
    half: DVec2,
    /// Height of the center \[m\].
    height: f64,
    friction: f64,
    /// Normal force over mass [m/s²].
    pressure: f64,
    /// [1/m²]
    mass_over_inertia: f64,
}

/// Friction at one moment, in the axes of the box.
struct Friction {
    /// Force over mass [m/s²], and torque over inertia [rad/s²].
    force: DVec2,
    torque: f64,
    /// The shares of the corners in the load.
    share: [f64; 4],
    /// The slowest slip [m/s].
    slowest: f64,
}

/// Signs of the corners of a face along its axes; opposite ones are neighbors in `PAIRS`.
const SIGNS: [DVec2; 4] = [
    DVec2::new(-1.0, -1.0),
    DVec2::new(1.0, -1.0),
    DVec2::new(-1.0, 1.0),
    DVec2::new(1.0, 1.0),
];
const PAIRS: [usize; 4] = [0, 3, 1, 2];

/// A displacement: turn \[rad\], and its parts \[m\] in the axes at the start and at the end.
struct Way {
    turn: f64,
    first: DVec2,
    second: DVec2,
}

impl Face {
    /// The shares of the corners in the load with its center at p₁/h₁ and p₂/h₂; `None` if one would have to pull.
    fn shares(p: DVec2) -> Option<[f64; 4]> {
        let inside = p.x.abs() + p.y.abs() <= 1.0;
        inside.then(|| SIGNS.map(|s| 0.25 * (1.0 + s.dot(p))))
    }

    /// The friction at velocity and spin `x`; `None` if a corner would have to pull.
    fn friction(&self, x: DVec3) -> Option<Friction> {
        let (v, omega) = (x.truncate(), x.z);
        let arm = SIGNS.map(|s| s * self.half);
        let mut slowest = f64::INFINITY;
        let mut way = [DVec2::ZERO; 4];
        // Σ ŵ/4, and the same with the signs of the corners
        let mut sum = [DVec2::ZERO; 3];
        for k in PAIRS {
            let w = v + omega * arm[k].perp();
            let speed = w.length();
            slowest = slowest.min(speed);
            way[k] = w / speed;
            let quarter = 0.25 * way[k];
            sum[0] += quarter;
            sum[1] += SIGNS[k].x * quarter;
            sum[2] += SIGNS[k].y * quarter;
        }
        // p = µh (S₀ + S₁ p₁/h₁ + S₂ p₂/h₂), here p₁/h₁ and p₂/h₂
        let lift = self.friction * self.height / self.half;
        let [s0, s1, s2] = sum.map(|s| lift * s);
        let (a, d) = (1.0 - s1.x, 1.0 - s2.y);
        let determinant = a * d - s2.x * s1.y;
        let p = DVec2::new(d * s0.x + s2.x * s0.y, a * s0.y + s1.y * s0.x) / determinant;
        let share = if determinant > 0.0 {
            Self::shares(p)?
        } else {
            return None;
        };
        let scale = -self.friction * self.pressure;
        let (mut force, mut torque) = (DVec2::ZERO, 0.0);
        for k in PAIRS {
            let f = (scale * share[k]) * way[k];
            force += f;
            torque += arm[k].perp_dot(f);
        }
        let torque = torque * self.mass_over_inertia;
        Some(Friction {
            force,
            torque,
            share,
            slowest,
        })
    }

    /// dx/dt in the turning axes.
    fn rate(&self, x: DVec3, friction: &Friction) -> DVec3 {
        let turn = -x.z * x.truncate().perp();
        (friction.force + turn).extend(friction.torque)
    }

    /// Slides and turns from `x` for `h` \[s\] by the classical Runge–Kutta method; the displacement follows from velocities
    /// and accelerations at both ends (order 4). `None` if a slip may end or the box may tip.
    fn turning(&self, x: DVec3, h: f64) -> Option<(DVec3, Way, [f64; 4])> {
        let first = self.friction(x)?;
        let diagonal = self.half.length();
        // Bound of the change of a corner's slip by friction and by the turn of its arm.
        let grip =
            self.friction * self.pressure * (1.0 + diagonal * diagonal * self.mass_over_inertia);
        let change = h * (grip + x.z * x.z * diagonal);
        if change > LARGEST_CHANGE * first.slowest || h * x.z.abs() > LARGEST_TURN {
            return None;
        }
        let a = self.rate(x, &first);
        let at = |x: DVec3| Some(self.rate(x, &self.friction(x)?));
        let b = at(x + 0.5 * h * a)?;
        let c = at(x + 0.5 * h * b)?;
        let d = at(x + h * c)?;
        let end = x + (h / 6.0) * ((a + d) + 2.0 * (b + c));
        let last = self.friction(end)?;
        let way = |v: DVec2, f: DVec2, sign: f64| 0.5 * h * v + (sign * h * h / 12.0) * f;
        let turn = 0.5 * h * (x.z + end.z) + (h * h / 12.0) * (first.torque - last.torque);
        let way = Way {
            turn,
            first: way(x.truncate(), first.force, 1.0),
            second: way(end.truncate(), last.force, -1.0),
        };
        let share = [0, 1, 2, 3].map(|k| 0.5 * (first.share[k] + last.share[k]));
        Some((end, way, share))
    }

    /// Slides without turning until the stop, or for `h` \[s\]; `pull` is the acceleration along the floor. Also returns the
    /// time. `None` if the pull bends the path or moves the box on after the stop.
    fn straight(&self, mut state: BodyState, pull: DVec3, h: f64) -> Option<(BodyState, f64)> {
        let speed = state.velocity.length();
        let t = state.velocity / speed;
        let along = pull.dot(t);
        if (pull - along * t).length() > 1e-14 * self.pressure {
            return None;
        }
        let grip = self.friction * self.pressure;
        let rate = along - grip;
        let end = speed + rate * h;
        if end > 0.0 {
            state.position += t * (h * (speed + 0.5 * h * rate));
            state.velocity = t * end;
            return Some((state, h));
        }
        let time = -speed / rate;
        state.position += t * (0.5 * speed * time);
        state.velocity = DVec3::ZERO;
        (along.abs() <= grip).then_some((state, time.min(h)))
    }
}
