//! The reference solution of a setup: a closed form if there is one, otherwise a fine numerical reference.
//!
//! | motion | reference |
//! |---|---|
//! | gravity, constant force, linear drag | exponentials |
//! | quadratic drag on a straight line | tanh, tan, ln cosh |
//! | springs at the center of mass | the harmonic oscillator |
//! | free rotation, also with damping −γL | Jacobi's elliptic functions and Carlson's R_J |
//! | rotation about one principal axis with angular drag and torque | exponentials |
//! | flat bounces, sliding to rest | the Zeno sequence, the parabola that ends at rest |
//! | anything else without a floor | Dormand and Prince's method of order 8, two step sizes compared |
//!
//! All functions are those of `libm`, not of the platform, so a reference has the same bits on every machine.

mod axis;
mod carlson;
mod contact;
mod free;
pub mod jacobi;
mod numerical;
mod translation;

use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

use self::axis::AxisRotation;
use crate::setup::Setup;
use contact::FlatContact;
pub use free::FreeMotion;
use numerical::Numerical;
use translation::Translation;

/// The rotation by `angle` \[rad\] about a unit vector.
pub(crate) fn turn(axis: DVec3, angle: f64) -> DQuat {
    let (s, c) = libm::sincos(0.5 * angle);
    let v = s * axis;
    DQuat::from_xyzw(v.x, v.y, v.z, c)
}

/// Source of a reference solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceKind {
    /// Closed forms, accurate to rounding.
    ClosedForm,
    /// An integrator of order 8. `agreement` is the largest difference (position \[m\], velocity [m/s], attitude
    /// \[rad\], relative angular momentum) between two step sizes.
    Numerical {
        /// Largest difference between the two runs.
        agreement: f64,
    },
    /// There is no reference.
    None,
}

/// The reference solution of a setup.
#[derive(Clone, Debug)]
pub struct ReferenceSolution {
    segments: Vec<(f64, Segment)>,
    kind: ReferenceKind,
    description: &'static str,
}

/// The solution between two impulses, with time counted from the first.
#[derive(Clone, Debug)]
enum Segment {
    Separate(Translation, Rotation),
    Flat(FlatContact, FreeMotion),
    Numerical(Box<Numerical>),
}

#[derive(Clone, Debug)]
enum Rotation {
    Free(FreeMotion),
    Axis(AxisRotation),
}

impl Rotation {
    fn of(setup: &Setup, start: &BodyState) -> Option<Self> {
        let f = &setup.forces;
        let torque_free = !f.has_wrench() || translation::springs_at_center(f);
        if torque_free && f.angular_drag == 0.0 {
            return Some(Self::Free(FreeMotion::new(
                &setup.body,
                start,
                f.angular_damping,
            )));
        }
        AxisRotation::of(setup, start).map(Self::Axis)
    }

    fn write(&self, t: f64, state: &mut BodyState) {
        match self {
            Self::Free(r) => r.write(t, state),
            Self::Axis(r) => r.write(t, state),
        }
    }
}

impl Setup {
    /// The reference solution; see [`ReferenceSolution`].
    pub fn reference(&self) -> ReferenceSolution {
        ReferenceSolution::of(self)
    }
}

impl ReferenceSolution {
    /// The reference solution of `setup`, through all its impulses.
    pub fn of(setup: &Setup) -> Self {
        Self::through(setup, true)
    }

    /// The closed form of `setup`, if there is one. It needs no numerical integration.
    pub fn closed_form(setup: &Setup) -> Option<Self> {
        let reference = Self::through(setup, false);
        (reference.kind == ReferenceKind::ClosedForm).then_some(reference)
    }

    fn through(setup: &Setup, numerical: bool) -> Self {
        let mut reference = Self {
            segments: Vec::new(),
            kind: ReferenceKind::ClosedForm,
            description: "closed form",
        };
        let (mut start, mut from) = (setup.initial, 0.0);
        let mut impulses = setup.impulses.iter().peekable();
        while from < setup.duration {
            while let Some(i) = impulses.next_if(|i| i.t <= from) {
                start.apply_impulse_at_body_point(&setup.body, i.impulse, i.body_point);
            }
            let until = impulses
                .peek()
                .map_or(setup.duration, |i| i.t.min(setup.duration));
            let Some(segment) = reference.segment(setup, &start, until - from, numerical) else {
                return Self::none();
            };
            let Some(next) = segment.at(until - from) else {
                return Self::none();
            };
            reference.segments.push((from, segment));
            (start, from) = (next, until);
        }
        reference
    }

    /// No reference solution.
    pub fn none() -> Self {
        Self {
            segments: Vec::new(),
            kind: ReferenceKind::None,
            description: "none: tumbling contact is chaotic; compare statistics and conserved quantities",
        }
    }

    fn segment(
        &mut self,
        setup: &Setup,
        start: &BodyState,
        duration: f64,
        numerical: bool,
    ) -> Option<Segment> {
        if let Some(floor) = &setup.floor {
            let (contact, rotation) = FlatContact::of(setup, floor, start)?;
            return Some(Segment::Flat(contact, rotation));
        }
        if let (Some(x), Some(r)) = (Translation::of(setup, start), Rotation::of(setup, start)) {
            return Some(Segment::Separate(x, r));
        }
        if !numerical {
            return None;
        }
        let reference = Numerical::new(setup, start, duration)?;
        let before = match self.kind {
            ReferenceKind::Numerical { agreement } => agreement,
            _ => 0.0,
        };
        self.kind = ReferenceKind::Numerical {
            agreement: before.max(reference.agreement()),
        };
        self.description = "Dormand–Prince order 8, two step sizes compared";
        Some(Segment::Numerical(Box::new(reference)))
    }

    /// The state at time `t` \[s\] ≥ 0; at the time of an impulse, the state just before it. `None` if there is no
    /// reference: before 0, and for a numerical reference after the setup's duration.
    pub fn at(&self, t: f64) -> Option<BodyState> {
        if !(t >= 0.0 && t.is_finite()) {
            return None;
        }
        let k = self.segments.iter().rposition(|(from, _)| *from < t);
        let (from, segment) = self.segments.get(k.unwrap_or(0))?;
        segment.at(t - from)
    }

    /// Source of the reference.
    pub fn kind(&self) -> ReferenceKind {
        self.kind
    }

    /// Source of the reference, in words.
    pub fn description(&self) -> &'static str {
        self.description
    }
}

impl Segment {
    fn at(&self, t: f64) -> Option<BodyState> {
        let mut state = BodyState::at(DVec3::ZERO);
        match self {
            Self::Separate(x, r) => {
                (state.position, state.velocity) = x.at(t);
                r.write(t, &mut state);
            }
            Self::Flat(x, r) => {
                (state.position, state.velocity) = x.at(t);
                r.write(t, &mut state);
            }
            Self::Numerical(n) => return n.at(t),
        }
        Some(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::StateError;
    use crate::scenario::Scenario;
    use box_physics::digest::state_digest;

    fn difference(a: &BodyState, b: &BodyState) -> f64 {
        let e = StateError::between(a, b);
        e.position
            .max(e.velocity)
            .max(e.attitude)
            .max(e.angular_momentum)
    }

    #[test]
    fn every_scene_without_floor_has_a_reference() {
        for s in Scenario::ALL.iter().map(|build| build()) {
            let reference = s.reference();
            match reference.kind() {
                ReferenceKind::Numerical { agreement } => {
                    // This is the error of the coarser run. A stiff nonlinear oscillation over 240 rad amplifies it.
                    let bound = if s.id == "stiff-spring" { 2e-10 } else { 1e-11 };
                    assert!(agreement < bound, "{}: {agreement:e}", s.id);
                }
                ReferenceKind::ClosedForm => {}
                ReferenceKind::None => {
                    assert!(s.setup.floor.is_some(), "{}", s.id);
                    continue;
                }
            }
            let start = reference.at(0.0).expect("at the start");
            assert!(difference(&start, &s.setup.initial) < 1e-14, "{}", s.id);
            assert!(reference.at(s.setup.duration).is_some(), "{}", s.id);
            assert!(reference.at(-1.0).is_none() && reference.at(f64::NAN).is_none());
        }
    }

    /// Closed forms against numerical integration, two independent methods. The bound accounts for the growth of
    /// rounding errors: the separatrix amplifies a difference by e^{λt}, up to its first flip by 1e6.
    #[test]
    fn closed_forms_agree_with_the_numerical_reference() {
        for s in Scenario::ALL.iter().map(|build| build()) {
            let reference = s.reference();
            let stiff = s.setup.forces.linear_drag > 100.0;
            if s.setup.floor.is_some() || reference.kind() != ReferenceKind::ClosedForm || stiff {
                continue;
            }
            let duration = s.setup.duration.min(10.0);
            let numerical = Numerical::new(&s.setup, &s.setup.initial, duration).expect("smooth");
            let bound = match s.id {
                "separatrix" => 1e-5,
                "dzhanibekov" => 1e-8,
                _ => 1e-10,
            };
            for k in 0..=40 {
                let t = duration * f64::from(k) / 40.0;
                let (a, b) = (
                    reference.at(t).expect("closed"),
                    numerical.at(t).expect("inside"),
                );
                let error = difference(&a, &b);
                assert!(error < bound, "{}: {error:e} at {t} s", s.id);
            }
        }
    }

    /// Guards the bits of the references as far as one machine can: all functions are those of `libm`. `.ci/web`
    /// compares them with the results of a browser.
    #[test]
    fn references_have_the_same_bits_on_every_machine() {
        let digest = |closed: bool| {
            let scenes = Scenario::ALL.iter().map(|build| build());
            let states: Vec<_> = scenes
                .map(|s| (s.reference(), s.setup.duration))
                .filter(|(r, _)| (r.kind() == ReferenceKind::ClosedForm) == closed)
                .flat_map(|(reference, duration)| {
                    (0..=400).filter_map(move |k| reference.at(duration * f64::from(k) / 400.0))
                })
                .collect();
            (states.len(), state_digest(&states))
        };
        for (closed, stored) in [
            (true, 0x4bf2_348a_aa5a_fad5),
            (false, 0x13ff_53c3_51ea_c3e1),
        ] {
            let (states, found) = digest(closed);
            assert_eq!(
                found, stored,
                "closed: {closed}, {states} states: {found:x}"
            );
        }
    }

    #[test]
    fn a_closed_form_is_the_reference_or_none() {
        for s in Scenario::ALL.iter().map(|build| build()) {
            let (closed, reference) = (ReferenceSolution::closed_form(&s.setup), s.reference());
            let known = reference.kind() == ReferenceKind::ClosedForm;
            assert_eq!(closed.is_some(), known, "{}", s.id);
            if let Some(closed) = closed {
                assert_eq!(closed.at(1.25), reference.at(1.25), "{}", s.id);
            }
        }
    }

    #[test]
    fn contact_answers() {
        let at = |id: &str, t: f64| {
            let s = Scenario::find(id).expect("known");
            s.reference().at(t).expect("closed")
        };
        // 6 m/s against µg = 4.905 m/s²: stops after 36/9.81 m.
        assert!((at("slide", 3.0).position.x - (-4.0 + 36.0 / 9.81)).abs() < 1e-14);
        assert_eq!(at("slide", 3.0).velocity, DVec3::ZERO);
        // The apex after a hundred bounces equals the first; the period is 2√(2h/g).
        let period = 2.0 * (2.0_f64 / 9.81).sqrt();
        let apex = at("bounce", 100.0 * period);
        assert!((apex.position.y - 1.25).abs() < 1e-12 && apex.velocity.length() < 1e-11);
        // Drop from 3 m, e = ½: at rest after √(2h/g)(1+e)/(1−e); the first apex is at h/4.
        let fall = (6.0_f64 / 9.81).sqrt();
        assert!((at("drop", 1.5 * fall).position.y - (0.25 + 0.75)).abs() < 1e-14);
        assert_eq!(at("drop", 3.0 * fall + 1e-6).position.y, 0.25);
        assert_eq!(
            at("playground", 7.0),
            Scenario::find("playground").expect("known").setup.initial
        );
    }

    #[test]
    fn impulses_are_seen_through() {
        use crate::setup::TimedImpulse;
        let mut s = Scenario::find("throw").expect("known");
        let kick = TimedImpulse {
            t: 1.0,
            impulse: DVec3::new(1.0, -2.0, 0.5),
            body_point: DVec3::new(0.5, 0.0, 0.125),
        };
        s.setup.impulses = vec![kick, TimedImpulse { t: 2.5, ..kick }];
        let reference = s.reference();
        assert_eq!(reference.kind(), ReferenceKind::ClosedForm);
        let mut before = reference.at(1.0).expect("closed");
        let after = reference.at(1.0 + 1e-12).expect("closed");
        before.apply_impulse_at_body_point(&s.setup.body, kick.impulse, kick.body_point);
        assert!(difference(&before, &after) < 1e-10);
    }
}
