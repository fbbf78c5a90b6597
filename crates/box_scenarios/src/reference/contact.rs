//! Closed form of a box that stays flat on the floor or bounces flat on it.

use box_physics::aabb::world_half_extents;
use box_physics::state::BodyState;
use glam::DVec3;

use super::free::FreeMotion;
use crate::setup::{FloorSpec, Setup};

/// Vertically, the Zeno sequence of flat bounces, with apex n at e^{2n} times the first. Horizontally, uniform motion
/// without friction, or on the floor the parabola that ends at v²/(2µg).
#[derive(Clone, Debug)]
pub(super) struct FlatContact {
    start: DVec3,
    velocity: DVec3,
    /// Height of the center when the box is at rest on the floor \[m\].
    rest: f64,
    gravity: f64,
    restitution: f64,
    /// µg while sliding [m/s²]
    deceleration: f64,
}

/// Heights that differ by less than this times the box's size are equal, because positions are given in decimals.
const TOUCHING: f64 = 1e-12;

/// Rises shorter than this \[s\] are neglected: in 1e-9 s a box rises by 1e-18 m.
const SHORTEST_RISE: f64 = 1e-9;

impl FlatContact {
    /// Returns `None` unless the motion is one of these: only vertical gravity acts, a face is level, and the box does
    /// not spin, except about the vertical without friction.
    pub(super) fn of(
        setup: &Setup,
        floor: &FloorSpec,
        start: &BodyState,
    ) -> Option<(Self, FreeMotion)> {
        let f = &setup.forces;
        let a = f.acceleration(&setup.body);
        let only_gravity =
            f.dissipation() == box_physics::force::Dissipation::NONE && !f.has_wrench();
        let down = a.x == 0.0 && a.z == 0.0 && a.y < 0.0;
        // Level: the vertical is a body axis.
        let up = (start.rotation.inverse() * DVec3::Y).abs();
        let level = up.to_array().iter().filter(|c| **c == 0.0).count() == 2;
        let w = start.angular_velocity(&setup.body);
        let upright = w.x == 0.0 && w.z == 0.0;
        if !(only_gravity && down && level && upright && floor.tray == 0.0) {
            return None;
        }
        let half = setup.body.half_extents();
        let rest = floor.height + half.dot(up);
        let clearance = start.position.y - rest;
        let lies = clearance.abs() <= TOUCHING * half.max_element() && start.velocity.y == 0.0;
        let level_velocity = DVec3::new(start.velocity.x, 0.0, start.velocity.z);
        let frictionless = floor.friction == 0.0;
        let still = w.y == 0.0 && level_velocity == DVec3::ZERO;
        let possible = if lies {
            // Sliding does not tip the box if µ times the height of the center is below the distance to the edge of the
            // footprint, in any direction.
            let extents = world_half_extents(start.rotation, half);
            let stands = floor.friction * extents.y < extents.x.min(extents.z);
            frictionless || (w.y == 0.0 && stands)
        } else {
            clearance > 0.0 && (frictionless || still)
        };
        possible.then(|| {
            let contact = Self {
                start: start.position,
                velocity: start.velocity,
                rest: if lies { start.position.y } else { rest },
                gravity: -a.y,
                restitution: floor.restitution,
                deceleration: if lies { floor.friction * -a.y } else { 0.0 },
            };
            (contact, FreeMotion::new(&setup.body, start, 0.0))
        })
    }

    /// Position \[m\] and velocity [m/s] after `t` \[s\].
    pub(super) fn at(&self, t: f64) -> (DVec3, DVec3) {
        let (way, velocity) = self.along_the_floor(t);
        let (y, vy) = self.vertical(t);
        (
            DVec3::new(self.start.x + way.x, y, self.start.z + way.z),
            DVec3::new(velocity.x, vy, velocity.z),
        )
    }

    fn along_the_floor(&self, t: f64) -> (DVec3, DVec3) {
        let v = DVec3::new(self.velocity.x, 0.0, self.velocity.z);
        let speed = v.length();
        if self.deceleration == 0.0 || speed == 0.0 {
            return (v * t, v);
        }
        let t = t.min(speed / self.deceleration);
        let left = 1.0 - self.deceleration * t / speed;
        (v * (0.5 * t * (1.0 + left)), v * left)
    }

    /// Skips thousands of bounces at once: the first n rises take 2u/g (1 − eⁿ)/(1 − e). Stops some bounces before
    /// `since`, so that the remaining ones are treated individually.
    fn skip_bounces(&self, since: f64, up: f64) -> (f64, f64) {
        let e = self.restitution;
        let first = 2.0 * up / self.gravity;
        if !(e > 0.0 && e < 1.0) || since <= 1000.0 * first {
            return (since, up);
        }
        let left = 1.0 - since * (1.0 - e) / first;
        // Number of rises before `since`, or before they are too short to count.
        let end = left.max(SHORTEST_RISE / first).max(f64::MIN_POSITIVE);
        let n = (libm::log(end) / libm::log(e)).floor() - 100.0;
        if n < 1000.0 {
            return (since, up);
        }
        let decay = libm::exp(n * libm::log(e));
        (since - first * (1.0 - decay) / (1.0 - e), up * decay)
    }

    fn vertical(&self, t: f64) -> (f64, f64) {
        let (g, v, h) = (self.gravity, self.velocity.y, self.start.y - self.rest);
        if h <= 0.0 && v <= 0.0 {
            return (self.rest, 0.0);
        }
        // First impact: h + v t − ½ g t² = 0.
        let impact_speed = (v * v + 2.0 * g * h).sqrt();
        let first = (v + impact_speed) / g;
        if t <= first {
            return (self.start.y + t * (v - 0.5 * g * t), v - g * t);
        }
        let mut since = t - first;
        let mut up = self.restitution * impact_speed;
        (since, up) = self.skip_bounces(since, up);
        loop {
            let rise = 2.0 * up / g;
            if rise < SHORTEST_RISE {
                return (self.rest, 0.0);
            }
            if since <= rise {
                return (self.rest + since * (up - 0.5 * g * since), up - g * since);
            }
            if self.restitution == 1.0 {
                since %= rise;
            } else {
                since -= rise;
                up *= self.restitution;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Skipping bounces gives the same result as counting them one by one.
    #[test]
    fn thousands_of_bounces_are_passed_over() {
        let contact = FlatContact {
            start: DVec3::Y * 1e-4,
            velocity: DVec3::ZERO,
            rest: 0.0,
            gravity: 9.81,
            restitution: 0.9995,
            deceleration: 0.0,
        };
        let impact = (2.0 * contact.gravity * contact.start.y).sqrt();
        let first = contact.restitution * impact * 2.0 / contact.gravity;
        for since in [1200.0, 1500.3, 1990.0, 1999.5] {
            let (mut up, mut left) = (contact.restitution * impact, since * first);
            while left > 2.0 * up / contact.gravity {
                left -= 2.0 * up / contact.gravity;
                up *= contact.restitution;
            }
            let counted = left * (up - 0.5 * contact.gravity * left);
            let (y, _) = contact.vertical(impact / contact.gravity + since * first);
            assert!(
                (y - counted).abs() < 1e-9 * contact.start.y,
                "{since}: {y} {counted}"
            );
        }
        assert_eq!(contact.vertical(600.0), (0.0, 0.0));
        let hardly = FlatContact {
            restitution: 1.0 - 1e-12,
            start: DVec3::Y * 1e-10,
            ..contact
        };
        let (y, _) = hardly.vertical(600.0);
        assert!((-1e-13..=1.1e-10).contains(&y), "{y}");
    }
}
