//! One box at the floor in each situation with a different cost, stepped by the core alone.

use box_physics::floor::{ContactState, FloorContext, step_on_floor};
use box_physics::force::Gravity;
use box_physics::integrators::Split;
use box_physics::prelude::*;

/// The motion of the box in every measured step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactScene {
    /// At rest on a face.
    Resting,
    /// In flight so close to the floor that only the trial step shows that it does not touch.
    FlyingLow,
    /// Slides on a face.
    Sliding,
    /// Slides on a face and spins about the vertical.
    SlidingAndSpinning,
    /// Hits the floor with an edge.
    EdgeImpact,
    /// Hits the floor with a corner.
    CornerImpact,
    /// Starts to fall about an edge on the floor.
    Pivoting,
}

impl ContactScene {
    /// All scenes.
    pub const ALL: [Self; 7] = [
        Self::Resting,
        Self::FlyingLow,
        Self::Sliding,
        Self::SlidingAndSpinning,
        Self::EdgeImpact,
        Self::CornerImpact,
        Self::Pivoting,
    ];

    /// Display name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Resting => "resting",
            Self::FlyingLow => "flying low",
            Self::Sliding => "sliding",
            Self::SlidingAndSpinning => "sliding and spinning",
            Self::EdgeImpact => "edge impact",
            Self::CornerImpact => "corner impact",
            Self::Pivoting => "pivoting",
        }
    }

    fn start(self, body: &RigidBox) -> BodyState {
        let flat = BodyState::at(DVec3::Y * body.half_extents().y);
        let on_edge = lowered(body, BodyState::at_pose(DVec3::ZERO, turned(0.0, 0.4)));
        let on_corner = lowered(body, BodyState::at_pose(DVec3::ZERO, turned(0.3, 0.4)));
        match self {
            Self::Resting => flat,
            Self::FlyingLow => BodyState::at(DVec3::Y * (body.radius() + 0.01))
                .with_velocity(DVec3::new(1.0, -0.6, 0.0))
                .with_angular_velocity(body, DVec3::new(0.3, 0.2, 0.1)),
            Self::Sliding => flat.with_velocity(DVec3::X * 4.0),
            Self::SlidingAndSpinning => flat
                .with_velocity(DVec3::X * 4.0)
                .with_angular_velocity(body, DVec3::Y * 3.0),
            Self::EdgeImpact => on_edge.with_velocity(DVec3::NEG_Y),
            Self::CornerImpact => on_corner.with_velocity(DVec3::NEG_Y),
            Self::Pivoting => on_edge,
        }
    }
}

/// A rotation about x, then z \[rad\].
fn turned(x: f64, z: f64) -> DQuat {
    let (s, c) = box_physics::math::sin_cos(0.5 * x);
    let (t, d) = box_physics::math::sin_cos(0.5 * z);
    DQuat::from_xyzw(0.0, 0.0, t, d) * DQuat::from_xyzw(s, 0.0, 0.0, c)
}

/// `state` at the height at which its lowest corner touches the floor.
fn lowered(body: &RigidBox, mut state: BodyState) -> BodyState {
    state.position.y = box_physics::aabb::world_half_extents(state.rotation, body.half_extents()).y;
    state
}

/// A box that is stepped repeatedly from the same start.
pub struct ContactBench {
    body: RigidBox,
    start: BodyState,
    memory: IntegratorMemory,
    contact: ContactState,
}

impl ContactBench {
    /// Creates the benchmark of `scene`. A resting box has already come to rest.
    pub fn new(scene: ContactScene) -> Self {
        let body = RigidBox::new(DVec3::new(0.5, 0.25, 0.375), 3.0).unwrap_or_default();
        let mut this = Self {
            body,
            start: scene.start(&body),
            memory: IntegratorMemory::default(),
            contact: ContactState::default(),
        };
        if scene == ContactScene::Resting {
            for _ in 0..3 {
                this.step();
            }
        }
        this
    }

    /// Takes one step of 1/60 s from the start.
    pub fn step(&mut self) -> BodyState {
        let mut state = self.start;
        step_on_floor::<Split, _>(
            &FloorContext {
                floor: &Floor::default(),
                settings: &ContactSettings::default(),
                body: &self.body,
                force: &Gravity(DVec3::NEG_Y * 9.81),
            },
            &mut state,
            1.0 / 60.0,
            &mut self.memory,
            &mut self.contact,
            None,
        );
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Holds under every integrator, with or without a memory that every trial segment must copy.
    #[test]
    fn a_warm_body_that_bounces_allocates_nothing() {
        let (body, force) = (RigidBox::default(), Gravity(DVec3::NEG_Y * 9.81));
        let floor = Floor {
            restitution: 0.8,
            ..Floor::default()
        };
        let settings = ContactSettings::default();
        let context = FloorContext {
            floor: &floor,
            settings: &settings,
            body: &body,
            force: &force,
        };
        for &integrator in Integrator::ALL {
            let spin = DVec3::new(2.0, 1.0, 3.0);
            let mut state = BodyState::at(DVec3::Y * 2.0).with_angular_velocity(&body, spin);
            let (mut memory, mut contact) = Default::default();
            let mut impacts = |steps: u32| -> u32 {
                let step = |_| {
                    integrator
                        .step_on_floor(
                            &context,
                            &mut state,
                            1.0 / 60.0,
                            &mut memory,
                            &mut contact,
                            None,
                        )
                        .impacts
                };
                (0..steps).map(step).sum()
            };
            assert!(impacts(100) > 2, "{integrator}");
            let mut hit = 0;
            let spent = allocation_counter::measure(|| hit = impacts(100));
            assert!(hit > 2, "{integrator}: {hit}");
            assert_eq!(spent.count_total, 0, "{integrator}");
        }
    }

    #[test]
    fn scenes_do_what_they_say() {
        for scene in ContactScene::ALL {
            let mut bench = ContactBench::new(scene);
            let start = bench.start;
            let end = bench.step();
            assert!(end.is_valid());
            let touching = bench.contact.touching().count_ones();
            match scene {
                ContactScene::Resting => assert_eq!(end, start),
                ContactScene::FlyingLow => assert_eq!(touching, 0),
                ContactScene::Sliding | ContactScene::SlidingAndSpinning => {
                    assert!(touching == 4 && end.velocity.x < 4.0);
                }
                ContactScene::EdgeImpact | ContactScene::CornerImpact => {
                    assert!(end.velocity.y > -1.0, "{scene:?}: {end:?}");
                }
                ContactScene::Pivoting => assert!(touching == 2, "{touching}"),
            }
        }
    }
}
