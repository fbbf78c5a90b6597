//! Sliding on a face without tipping, the most frequent sustained motion, as a problem in the plane.
//!
//! The corners k carry N_k ≥ 0 and slip with w_k, so the forces on them are N_k (n − µŵ_k), ŵ_k = w_k/|w_k|. There is
//! no torque about the horizontal axes while the box does not tip. With the arms ρ_k in the plane, the height of the
//! center h, and Σ N_k = N,
//!
//! ```text
//! Σ N_k ρ_k = µh Σ N_k ŵ_k,     N_k = ¼N (1 + σ_k1 p_1/h_1 + σ_k2 p_2/h_2)
//! ```
//!
//! The second equation is the smallest load distribution with the center of pressure p (h_1, h_2 the half-extents of
//! the face, σ_k = ±1 the signs of the corner). Two linear equations for p remain. Without spin all ŵ_k are equal, and
//! the deceleration is constant. Otherwise velocity and spin, in the axes of the box, obey an ordinary differential
//! equation, since a face's normal is a principal axis. It is solved in parts, which become shorter toward a stop.

use glam::{DVec2, DVec3};

use super::frame::Level;
use super::geometry::{has, mask};
use super::ground::Ground;
use super::slips::NEGLIGIBLE;
use crate::force::ForceModel;
use crate::math::sin_cos;
use crate::rotation::{compose, exponential_map};
use crate::state::BodyState;

/// Result of a step of sliding.
pub(super) struct Slide {
    /// Duration \[s\]: shorter than requested if the box stopped, or if events must solve the remaining time.
    pub(super) time: f64,
    /// Mean normal force at each corner \[N\].
    pub(super) load: [f64; 8],
    /// Evaluations of the friction.
    pub(super) evaluations: u32,
}

/// Largest turn \[rad\], and largest relative change of a corner's slip, in one part of a step.
const LARGEST_TURN: f64 = 0.25;
const LARGEST_CHANGE: f64 = 0.25;
/// Maximum number of parts. The remaining time, in which the slip of a corner vanishes, is solved by events.
const PARTS: u32 = 16;
/// A corner does not stop together with the others if its slip is below this fraction of the fastest one.
const ALONE: f64 = 0.25;
/// Smallest remaining fraction of a slip after one part of a step, and the smallest cosine of its turn.
const SMALLEST_LEFT: f64 = 0.25;
const SMALLEST_COSINE: f64 = 0.8;
/// Maximum number of trials for the length of a part.
const HALVINGS: u32 = 3;

/// Slides a box that touches the floor with the four corners `touching` for `h` \[s\]. Requires a uniform force, a
/// level face, no tipping and, for a spinning box, no force along the floor; otherwise returns `None` and leaves
/// `state` unchanged. Also `None` for an integrator of order 1 in uniform gravity, whose error would be hidden.
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
    // The axis normal to the face, and the two axes in it.
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
    if pull.y >= 0.0 || v[c].abs() + tilting > 1e-12 * speed || speed == 0.0 {
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
        let turning = face.turning(start, h, NEGLIGIBLE * body.radius())?;
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
        end.rotation = compose(state.rotation, exponential_map(axis(turning.turn)));
        end.renormalize();
        end.position += (state.rotation * plane(turning.way)).with_y(0.0);
        end.velocity = (end.rotation * plane(turning.end.truncate())).with_y(0.0);
        end.angular_momentum = axis(turning.end.z) * body.inertia();
        let mut corners = level.places(&end, turning.time);
        level.recover(&mut end, &mut corners, turning.time);
        let time = turning.time.max(f64::MIN_POSITIVE); // 0 for an immediate stop
        let share = turning.load.map(|load| load / time);
        (end, turning.time, share, turning.evaluations)
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
    /// The corners' fractions of the load.
    share: [f64; 4],
    slip: [Slip; 4],
}

/// Slip of a corner.
#[derive(Clone, Copy, Default)]
struct Slip {
    /// [m/s]
    speed: f64,
    direction: DVec2,
}

/// Signs of the corners of a face along its axes; opposite ones are neighbors in `PAIRS`.
const SIGNS: [DVec2; 4] = [
    DVec2::new(-1.0, -1.0),
    DVec2::new(1.0, -1.0),
    DVec2::new(-1.0, 1.0),
    DVec2::new(1.0, 1.0),
];
const PAIRS: [usize; 4] = [0, 3, 1, 2];

/// A slide with rotation.
struct Turning {
    /// Velocity [m/s] and spin [rad/s] at the end, in the axes of the box there.
    end: DVec3,
    /// \[rad\]
    turn: f64,
    /// \[m\], in the axes of the box at the start.
    way: DVec2,
    /// \[s\]
    time: f64,
    /// Integrals of the corners' fractions of the load \[s\].
    load: [f64; 4],
    evaluations: u32,
}

impl Turning {
    /// Adds a part of `h` \[s\] with the friction at both ends. `end` is the velocity and spin at its end.
    fn add(&mut self, h: f64, [first, last]: [&Friction; 2], end: DVec3) {
        let way = |turn: f64, v: DVec3, f: DVec2, sign: f64| {
            let (s, c) = sin_cos(turn);
            DVec2::new(c, s).rotate(0.5 * h * v.truncate() + (sign * h * h / 12.0) * f)
        };
        self.way += way(self.turn, self.end, first.force, 1.0);
        self.turn += 0.5 * h * (self.end.z + end.z) + (h * h / 12.0) * (first.torque - last.torque);
        self.way += way(self.turn, end, last.force, -1.0);
        self.end = end;
        for k in 0..4 {
            self.load[k] += 0.5 * h * (first.share[k] + last.share[k]);
        }
    }
}

impl Face {
    /// The corners' fractions of a load with its center at p₁/h₁ and p₂/h₂; `None` if one would have to pull.
    fn shares(p: DVec2) -> Option<[f64; 4]> {
        let inside = p.x.abs() + p.y.abs() <= 1.0;
        inside.then(|| SIGNS.map(|s| 0.25 * (1.0 + s.dot(p))))
    }

    /// The friction at velocity and spin `x`; `None` if a corner would have to pull.
    fn friction(&self, x: DVec3) -> Option<Friction> {
        let (v, omega) = (x.truncate(), x.z);
        let arm = SIGNS.map(|s| s * self.half);
        let mut slip = [Slip::default(); 4];
        // Σ ŵ/4, and the same with the signs of the corners
        let mut sum = [DVec2::ZERO; 3];
        for k in PAIRS {
            let w = v + omega * arm[k].perp();
            let speed = w.length();
            let direction = w / speed;
            slip[k] = Slip { speed, direction };
            let quarter = 0.25 * direction;
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
            let f = (scale * share[k]) * slip[k].direction;
            force += f;
            torque += arm[k].perp_dot(f);
        }
        let torque = torque * self.mass_over_inertia;
        Some(Friction {
            force,
            torque,
            share,
            slip,
        })
    }

    /// dx/dt in the turning axes.
    fn rate(&self, x: DVec3, friction: &Friction) -> DVec3 {
        let turn = -x.z * x.truncate().perp();
        (friction.force + turn).extend(friction.torque)
    }

    /// Slides and turns from `start` for at most `h` \[s\], part by part. Displacements use the velocities and
    /// accelerations at both ends (order 4). Ends early at a stop, once its position is known to `negligible` \[m\], or
    /// where a single slip vanishes. `None` if that occurs at the start, or if the box may tip there.
    fn turning(&self, start: DVec3, h: f64, negligible: f64) -> Option<Turning> {
        let mut done = Turning {
            end: start,
            turn: 0.0,
            way: DVec2::ZERO,
            time: 0.0,
            load: [0.0; 4],
            evaluations: 1,
        };
        let mut here = self.friction(start)?;
        for _ in 0..PARTS {
            let rate = self.rate(done.end, &here);
            let (mut fastest, mut slowest, mut change) = (0.0_f64, f64::INFINITY, 0.0_f64);
            for (slip, sign) in here.slip.iter().zip(SIGNS) {
                let bend = rate.truncate() + rate.z * (sign * self.half).perp();
                (fastest, slowest) = (fastest.max(slip.speed), slowest.min(slip.speed));
                change = change.max(bend.length() / slip.speed);
            }
            let left = h - done.time;
            if fastest <= 2.0 * negligible * change && 1.0 <= change * left {
                done.end = DVec3::ZERO;
                return Some(done);
            }
            let largest = (LARGEST_CHANGE / change).min(LARGEST_TURN / done.end.z.abs());
            if slowest < ALONE * fastest && largest < 0.25 * left {
                break;
            }
            let mut part = largest.min(left);
            let mut next = None;
            for _ in 0..HALVINGS {
                next = self.part(done.end, &here, rate, part);
                done.evaluations += 4;
                if next.is_some() {
                    break;
                }
                part *= 0.5;
            }
            let Some((end, there)) = next else {
                break;
            };
            done.add(part, [&here, &there], end);
            here = there;
            if part == left {
                done.time = h;
                break;
            }
            done.time += part;
        }
        (done.time > 0.0).then_some(done)
    }

    /// A step of `h` \[s\] from `x`, where the friction is `first` and dx/dt is `a`, by the classical Runge–Kutta method.
    /// `None` if the box may tip, if a slip changes too much, or if the energy would grow.
    fn part(&self, x: DVec3, first: &Friction, a: DVec3, h: f64) -> Option<(DVec3, Friction)> {
        let at = |x: DVec3| Some(self.rate(x, &self.friction(x)?));
        let b = at(x + 0.5 * h * a)?;
        let c = at(x + 0.5 * h * b)?;
        let d = at(x + h * c)?;
        let end = x + (h / 6.0) * ((a + d) + 2.0 * (b + c));
        let last = self.friction(end)?;
        let mut slips = first.slip.iter().zip(&last.slip);
        let steady = slips.all(|(old, new)| {
            let turn = old.direction.dot(new.direction);
            new.speed >= SMALLEST_LEFT * old.speed && turn >= SMALLEST_COSINE
        });
        let energy = |x: DVec3| x.truncate().length_squared() + x.z * x.z / self.mass_over_inertia;
        (steady && energy(end) <= energy(x)).then_some((end, last))
    }

    /// Slides without turning until the stop, or for `h` \[s\]; `pull` is the acceleration along the floor. Also
    /// returns the time. `None` if the pull bends the path or moves the box again after the stop.
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
