//! The force model of the library: uniform terms, forces at body points and springs.

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::DVec3;

use super::{Damping, Dissipation, ForceModel, Wrench, fingerprint};
use crate::body::RigidBox;
use crate::state::{BodyState, Frame};

/// A force at a point of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PointForce {
    /// Point of application, body axes from the center \[m\].
    pub body_point: DVec3,
    /// The force \[N\], constant in the axes given by `frame`.
    pub force: DVec3,
    /// The axes in which the force is constant.
    #[cfg_attr(feature = "serde", serde(default))]
    pub frame: Frame,
}

/// A damped spring of zero natural length from a body point to a world anchor.
///
/// The force at the point is −k (x + R r − anchor) − d u, where u is the point's velocity. A mouse grab is such a
/// spring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Spring {
    /// Attachment point, body axes from the center \[m\].
    pub body_point: DVec3,
    /// Anchor point in the world \[m\].
    pub anchor: DVec3,
    /// Stiffness k [N/m], ≥ 0.
    pub stiffness: f64,
    /// Damping d [N s/m], ≥ 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// The complete force model of the library. Every term may be absent.
///
/// ```
/// use box_physics::force::Forces;
/// use box_physics::prelude::*;
/// // A box hangs on a spring from a meter above: k = 20 N/m stretches by m g / k.
/// let body = RigidBox::default(); // 1 kg
/// let springs = [Spring { anchor: DVec3::Y, stiffness: 20.0, damping: 4.0, ..Spring::default() }];
/// let law = Forces {
///     acceleration: DVec3::new(0.0, -9.81, 0.0),
///     springs: &springs,
///     ..Forces::default()
/// };
/// let (mut state, mut memory) = (BodyState::default(), IntegratorMemory::default());
/// for _ in 0..1200 {
///     Integrator::Split.step(&body, &mut state, &law, 1.0 / 60.0, &mut memory);
/// }
/// assert!((state.position.y - (1.0 - 9.81 / 20.0)).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces<'a> {
    /// Uniform acceleration [m/s²]: gravity times the body's scale, plus constant force divided by mass.
    pub acceleration: DVec3,
    /// Drag and damping.
    pub dissipation: Dissipation,
    /// Constant torque in body axes \[N m\].
    pub body_torque: DVec3,
    /// Constant torque in world axes \[N m\].
    pub world_torque: DVec3,
    /// Forces at body points.
    pub point_forces: &'a [PointForce],
    /// Springs at body points.
    pub springs: &'a [Spring],
}

impl ForceModel for Forces<'_> {
    #[inline(always)]
    fn acceleration(&self) -> DVec3 {
        self.acceleration
    }

    #[inline(always)]
    fn dissipation(&self) -> Dissipation {
        self.dissipation
    }

    #[inline(always)]
    fn has_wrench(&self) -> bool {
        !(self.point_forces.is_empty()
            && self.springs.is_empty()
            && self.body_torque == DVec3::ZERO
            && self.world_torque == DVec3::ZERO)
    }

    #[inline(always)]
    fn wrench(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        if self.springs.is_empty() {
            self.springless(state)
        } else {
            self.with_dampers(body, state)
        }
    }

    #[inline(always)]
    fn elastic_wrench(&self, _body: &RigidBox, state: &BodyState) -> Wrench {
        if self.springs.is_empty() {
            self.springless(state)
        } else {
            self.with_springs(state)
        }
    }

    #[inline(always)]
    fn displaced_wrench(
        &self,
        _body: &RigidBox,
        state: &BodyState,
        shift: DVec3,
        turn: DVec3,
    ) -> Wrench {
        if self.springs.is_empty() {
            self.displaced_springless(state, turn)
        } else {
            self.displaced_with_springs(state, shift, turn)
        }
    }

    fn wrench_fingerprint(&self) -> Option<u64> {
        if !self.has_wrench() {
            return Some(0);
        }
        let vectors = [self.body_torque, self.world_torque];
        let points = self.point_forces.iter().map(|p| {
            let frame = f64::from(u8::from(p.frame == Frame::Body));
            (p.body_point, p.force, [frame, 0.0])
        });
        let springs = self.springs.iter();
        let springs = springs.map(|s| (s.body_point, s.anchor, [s.stiffness, s.damping]));
        let parts = points
            .chain(springs)
            .flat_map(|(a, b, rest)| a.to_array().into_iter().chain(b.to_array()).chain(rest));
        // The number of point forces separates them from the springs.
        Some(fingerprint(
            [self.point_forces.len() as f64]
                .into_iter()
                .chain(vectors.into_iter().flat_map(|v| v.to_array()))
                .chain(parts),
        ))
    }

    fn damping(&self) -> Damping {
        let add = |sum: Damping, s: &Spring| sum.with(s.body_point, s.damping);
        self.springs.iter().fold(Damping::NONE, add)
    }

    #[inline(always)]
    fn has_damping(&self) -> bool {
        self.springs.iter().any(|s| s.damping != 0.0)
    }
}

/// Without springs a wrench is inlined into the step; with them it is a call, because loops inside a step are slower.
impl Forces<'_> {
    #[inline(always)]
    fn springless(&self, state: &BodyState) -> Wrench {
        let inverse = state.rotation.inverse();
        let world_torque = if self.world_torque == DVec3::ZERO {
            DVec3::ZERO
        } else {
            inverse * self.world_torque
        };
        let mut total = Wrench {
            force: DVec3::ZERO,
            torque: self.body_torque + world_torque,
        };
        for p in self.point_forces {
            let (force, local) = match p.frame {
                Frame::World => (p.force, inverse * p.force),
                Frame::Body => (state.rotation * p.force, p.force),
            };
            total += Wrench {
                force,
                torque: p.body_point.cross(local),
            };
        }
        total
    }

    #[inline(never)]
    fn with_springs(&self, state: &BodyState) -> Wrench {
        let mut total = self.springless(state);
        for s in self.springs {
            let force = -s.stiffness * (state.point(s.body_point) - s.anchor);
            total += at_point(state, force, s.body_point);
        }
        total
    }

    #[inline(never)]
    fn with_dampers(&self, body: &RigidBox, state: &BodyState) -> Wrench {
        let mut total = self.with_springs(state);
        for spring in self.springs.iter().filter(|s| s.damping != 0.0) {
            let local = state.body_angular_velocity(body).cross(spring.body_point);
            let force = -spring.damping * (state.velocity + state.rotation * local);
            total += at_point(state, force, spring.body_point);
        }
        total
    }

    #[inline(always)]
    fn displaced_springless(&self, state: &BodyState, turn: DVec3) -> Wrench {
        let inverse = state.rotation.inverse();
        let turned = |v: DVec3| v + v.cross(turn);
        let world_torque = if self.world_torque == DVec3::ZERO {
            DVec3::ZERO
        } else {
            turned(inverse * self.world_torque)
        };
        let mut total = Wrench {
            force: DVec3::ZERO,
            torque: self.body_torque + world_torque,
        };
        for p in self.point_forces {
            let (force, local) = match p.frame {
                Frame::World => (p.force, turned(inverse * p.force)),
                Frame::Body => (state.rotation * (p.force + turn.cross(p.force)), p.force),
            };
            total += Wrench {
                force,
                torque: p.body_point.cross(local),
            };
        }
        total
    }

    #[inline(never)]
    fn displaced_with_springs(&self, state: &BodyState, shift: DVec3, turn: DVec3) -> Wrench {
        let inverse = state.rotation.inverse();
        let turned = |v: DVec3| v + v.cross(turn);
        let mut total = self.displaced_springless(state, turn);
        for s in self.springs {
            let arm = s.body_point + turn.cross(s.body_point);
            let force = -s.stiffness * (state.point(arm) + shift - s.anchor);
            total += Wrench {
                force,
                torque: s.body_point.cross(turned(inverse * force)),
            };
        }
        total
    }
}

/// The wrench of a world force at a body point.
fn at_point(state: &BodyState, force: DVec3, body_point: DVec3) -> Wrench {
    Wrench {
        force,
        torque: body_point.cross(state.rotation.inverse() * force),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::setting;
    use super::*;
    use crate::rotation::{compose, exponential_map};

    #[test]
    fn a_dipole_is_a_pair_of_point_forces() {
        // torque_world = (Rµ)×B
        let (body, state) = setting();
        let (moment, field) = (DVec3::new(0.0, -4.0, 1.0), DVec3::new(0.5, 1.0, 0.0));
        let force = |body_point, force| PointForce {
            body_point,
            force,
            frame: Frame::World,
        };
        let pair = [force(moment, field), force(DVec3::ZERO, -field)];
        let law = Forces {
            point_forces: &pair,
            ..Default::default()
        };
        let w = law.wrench(&body, &state);
        let expected = (state.rotation * moment).cross(field);
        assert!(w.force.length() < 1e-15);
        assert!((state.rotation * w.torque - expected).length() < 1e-14);
    }

    #[test]
    fn a_thruster_turns_with_the_body() {
        let (body, state) = setting();
        let thruster = [PointForce {
            body_point: DVec3::X,
            force: DVec3::Y,
            frame: Frame::Body,
        }];
        let law = Forces {
            point_forces: &thruster,
            ..Default::default()
        };
        let w = law.wrench(&body, &state);
        assert_eq!(w.torque, DVec3::Z);
        assert!((w.force - state.rotation * DVec3::Y).length() < 1e-15);
    }

    /// The displaced wrench of every kind of force agrees with the wrench at the displaced pose to second order.
    #[test]
    fn displaced_wrench_to_first_order() {
        let (body, state) = setting();
        let point = |frame| PointForce {
            body_point: DVec3::new(0.4, -0.2, 0.1),
            force: DVec3::new(1.0, -2.0, 3.0),
            frame,
        };
        let (points, springs) = (
            [point(Frame::World), point(Frame::Body)],
            [Spring {
                body_point: DVec3::new(0.5, 0.25, 0.1),
                anchor: DVec3::Y,
                stiffness: 3.0,
                damping: 0.5,
            }],
        );
        let (none, torque) = (Forces::default(), DVec3::new(0.3, 0.5, -0.2));
        #[rustfmt::skip]
        let laws = [
            Forces { body_torque: torque, ..none },
            Forces { world_torque: torque, ..none },
            Forces { point_forces: &points[..1], ..none },
            Forces { point_forces: &points[1..], ..none },
            Forces { springs: &springs, ..none },
        ];
        for law in laws {
            let error = |size: f64| {
                let (shift, turn) = (DVec3::new(1.0, 0.5, -2.0) * size, DVec3::ONE * size);
                let mut displaced = state;
                displaced.position += shift;
                displaced.rotation = compose(state.rotation, exponential_map(turn));
                let exact = law.elastic_wrench(&body, &displaced);
                let near = law.displaced_wrench(&body, &state, shift, turn);
                (near.force - exact.force).length() + (near.torque - exact.torque).length()
            };
            let errors = [error(1e-4), error(1e-5)];
            assert!(errors[0] < 2e-7 && errors[1] < 2e-9, "{errors:?}");
        }
    }

    /// The elastic wrench leaves out −C (v, ω) in body axes.
    #[test]
    fn damping_is_the_velocity_dependent_part_of_the_wrench() {
        let (body, state) = setting();
        let spring = |x: f64, y: f64, z: f64, damping: f64| Spring {
            body_point: DVec3::new(x, y, z),
            anchor: DVec3::Y,
            stiffness: 3.0,
            damping,
        };
        let springs = [spring(0.5, 0.25, 0.1, 7.0), spring(-0.5, 0.2, 0.3, 2.0)];
        let law = Forces {
            springs: &springs,
            ..Default::default()
        };
        let (whole, elastic) = (law.wrench(&body, &state), law.elastic_wrench(&body, &state));
        let c = law.damping();
        let v = state.rotation.inverse() * state.velocity;
        let omega = state.body_angular_velocity(&body);
        let force = -(c.total * v + omega.cross(c.moment));
        let torque = -(c.moment.cross(v) + c.second * omega);
        let damper = state.rotation.inverse() * (whole.force - elastic.force);
        assert!((damper - force).length() < 1e-14);
        assert!((whole.torque - elastic.torque - torque).length() < 1e-14);
    }
}
