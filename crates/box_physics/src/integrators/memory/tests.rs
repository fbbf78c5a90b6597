use super::super::{slope::Slope, testing};
use super::*;
use crate::force::{Forces, Frame, Gravity, PointForce, Spring, Wrench};
use crate::integrators::{Integrator, Order};
use glam::DQuat;

#[test]
fn a_scratch_copy_keeps_its_allocation() {
    let (body, mut state) = (RigidBox::default(), BodyState::default());
    let (mut memory, mut scratch) = (IntegratorMemory::default(), IntegratorMemory::default());
    let law = Gravity(DVec3::NEG_Y);
    let address = |m: &IntegratorMemory| m.kept.as_deref().map(core::ptr::from_ref);
    Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
    scratch.clone_from(&memory);
    let (first, own) = (address(&scratch), address(&memory));
    Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
    assert!(scratch != memory);
    scratch.clone_from(&memory);
    assert!(scratch == memory && address(&scratch) == first && first.is_some());
    // An event also overwrites in place.
    state.velocity = DVec3::X;
    Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
    assert_eq!(address(&memory), own);
}

/// Inputs of a step.
#[derive(Clone, PartialEq)]
struct Scene {
    body: RigidBox,
    state: BodyState,
    forces: Forces<'static>,
    points: Vec<PointForce>,
    springs: Vec<Spring>,
    h: f64,
}

impl Scene {
    fn free() -> Self {
        let body = testing::brick();
        Self {
            state: BodyState::at_pose(
                DVec3::new(0.5, 1.0, -0.5),
                DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
            )
            .with_velocity(DVec3::new(1.0, 2.0, -1.0))
            .with_body_angular_velocity(&body, DVec3::new(1.5, 2.5, 1.0)),
            body,
            forces: Forces {
                acceleration: DVec3::NEG_Y * 9.81,
                ..testing::drag(0.5, 0.25)
            },
            points: Vec::new(),
            springs: Vec::new(),
            h: 1.0 / 60.0,
        }
    }

    fn forced() -> Self {
        let mut scene = Self::free();
        scene.forces.body_torque = DVec3::new(0.1, 0.2, 0.3);
        scene.forces.world_torque = DVec3::new(0.3, 0.2, 0.1);
        scene.points = vec![PointForce {
            body_point: DVec3::X,
            force: DVec3::Y,
            frame: Frame::Body,
        }];
        scene.springs = vec![Spring {
            body_point: DVec3::new(0.5, 0.25, 0.125),
            anchor: DVec3::Y,
            stiffness: 20.0,
            damping: 0.5,
        }];
        scene
    }

    fn law(&self) -> Forces<'_> {
        Forces {
            point_forces: &self.points,
            springs: &self.springs,
            ..self.forces
        }
    }

    /// The state after a step of `integrator`.
    fn after(&self, integrator: Integrator, memory: &mut IntegratorMemory) -> BodyState {
        let mut state = self.state;
        integrator.step(&self.body, &mut state, &self.law(), self.h, memory);
        state
    }
}

type Change = (&'static str, fn(&mut Scene));

#[rustfmt::skip]
const CHANGES: &[Change] = &[
    ("state: position", |s| s.state.position.x += 0.125),
    ("state: attitude", |s| s.state.rotation = -s.state.rotation),
    ("state: velocity", |s| s.state.velocity.y += 0.125),
    ("state: momentum", |s| s.state.angular_momentum *= 1.5),
    ("body: size", |s| s.body = RigidBox::new(s.body.half_extents() * 2.0, s.body.mass()).expect("valid")),
    ("body: inertia", |s| s.body = s.body.with_inertia(s.body.inertia() * 2.0).expect("valid")),
    ("force: gravity", |s| s.forces.acceleration.x = 1.0),
    ("force: drag", |s| s.forces.dissipation.linear_drag += 1.0),
    ("force: quadratic drag", |s| s.forces.dissipation.quadratic_drag += 1.0),
    ("force: damping", |s| s.forces.dissipation.angular_damping += 1.0),
    ("force: angular drag", |s| s.forces.dissipation.angular_drag += 1.0),
    ("force: body torque", |s| s.forces.body_torque.x += 1.0),
    ("force: world torque", |s| s.forces.world_torque.x += 1.0),
    ("force: two signs", |s| {
        s.forces.body_torque.x *= -1.0;
        s.forces.body_torque.y *= -1.0;
    }),
    ("force: points", |s| s.points.iter_mut().for_each(|p| p.body_point.y += 0.5)),
    ("force: frame", |s| s.points.iter_mut().for_each(|p| p.frame = Frame::World)),
    ("force: anchor", |s| s.springs.iter_mut().for_each(|p| p.anchor.x += 1.0)),
    ("force: stiffness", |s| s.springs.iter_mut().for_each(|p| p.stiffness *= 2.0)),
    ("force: damper", |s| s.springs.iter_mut().for_each(|p| p.damping *= 2.0)),
    ("force: no springs", |s| s.springs.clear()),
    ("step: shorter", |s| s.h *= 0.5),
    ("step: backwards", |s| s.h = -s.h),
];

fn distance(a: &BodyState, b: &BodyState) -> f64 {
    (a.position - b.position)
        .length()
        .max((a.velocity - b.velocity).length())
        .max((a.angular_momentum - b.angular_momentum).length())
        .max((a.rotation - b.rotation).length())
}

/// Asserts that after a change of state, body, forces or step size, a step with the memory equals the step from an
/// empty memory, up to `slack` after a change of the step size.
fn honest<M: Default>(
    step: impl Fn(&Scene, &mut M) -> BodyState,
    slack: impl Fn(&Scene) -> f64,
) -> Result<(), String> {
    for scene in [Scene::free(), Scene::forced()] {
        for (what, change) in CHANGES {
            let (mut scene, mut memory) = (scene.clone(), M::default());
            for _ in 0..3 {
                scene.state = step(&scene, &mut memory);
            }
            let before = scene.clone();
            change(&mut scene);
            if scene == before {
                continue; // This force does not exist in the scene.
            }
            let with_memory = step(&scene, &mut memory);
            let off = distance(&with_memory, &step(&scene, &mut M::default()));
            let slack = if what.starts_with("step") {
                slack(&scene)
            } else {
                0.0
            };
            if off.is_nan() || off > slack {
                return Err(format!(
                    "after a change of {what} the next step differs by {off:e} from one with an empty memory \
                     (allowed: {slack:e}); compare what the memory depends on, and start again where it changed"
                ));
            }
        }
    }
    Ok(())
}

#[test]
fn memories_change_no_result() {
    for &i in Integrator::ALL {
        let o = i.info().orders;
        let exact = [o.gravity, o.linear_drag, o.rotation, o.angular_damping] == [Order::Exact; 4];
        // Closed forms differ by rounding after a change of the step size.
        let slack = |scene: &Scene| {
            if exact && !scene.law().has_wrench() {
                1e-13
            } else {
                0.0
            }
        };
        honest(|scene, memory| scene.after(i, memory), slack)
            .unwrap_or_else(|error| panic!("{i}: {error}"));
    }
}

/// A model that does not report its changes.
struct Motor(f64);

impl ForceModel for Motor {
    fn acceleration(&self) -> DVec3 {
        DVec3::ZERO
    }

    fn has_wrench(&self) -> bool {
        true
    }

    fn wrench(&self, _: &RigidBox, _: &BodyState) -> Wrench {
        Wrench {
            torque: DVec3::Z * self.0,
            ..Wrench::ZERO
        }
    }
}

#[test]
fn a_model_without_a_fingerprint_always_counts_as_changed() {
    for i in Integrator::ALL {
        let Scene { body, state, .. } = Scene::free();
        let (mut a, mut memory) = (state, IntegratorMemory::default());
        i.step(&body, &mut a, &Motor(1.0), 0.1, &mut memory);
        let (mut b, mut empty) = (a, IntegratorMemory::default());
        i.step(&body, &mut a, &Motor(9.0), 0.1, &mut memory);
        i.step(&body, &mut b, &Motor(9.0), 0.1, &mut empty);
        assert_eq!(a, b, "{i}");
    }
}

/// A step of a two-step method that ignores one of the inputs of its memory.
fn careless(
    ignored: &str,
    scene: &Scene,
    memory: &mut Option<(BodyState, Scene, Slope)>,
) -> BodyState {
    let slope = Slope::at(&scene.body, &scene.state, &scene.law());
    let holds = |end: &BodyState, then: &Scene| {
        (ignored == "state" || *end == scene.state)
            && (ignored == "body" || then.body == scene.body)
            && (ignored == "step" || then.h == scene.h)
            && (ignored == "force"
                || (&then.forces, &then.points, &then.springs)
                    == (&scene.forces, &scene.points, &scene.springs))
    };
    let before = match memory {
        Some((end, then, before)) if holds(end, then) => *before,
        _ => slope,
    };
    let end = before.from(&slope.from(&scene.state, 1.5 * scene.h), -0.5 * scene.h);
    *memory = Some((end, scene.clone(), slope));
    end
}

#[test]
fn a_faulty_memory_is_detected() {
    let honest = |ignored| honest(|scene, memory| careless(ignored, scene, memory), |_| 0.0);
    assert_eq!(honest("nothing"), Ok(()));
    for ignored in ["state", "body", "force", "step"] {
        let error = honest(ignored).expect_err(ignored);
        assert!(error.contains(&format!("a change of {ignored}")), "{error}");
    }
}
