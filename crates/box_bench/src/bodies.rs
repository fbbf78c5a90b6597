//! Sets of bodies for the benchmarks of plugin, bare loop and contact.

use box_physics::floor::Floor;
use box_physics::prelude::*;
use box_scenarios::random::Random;

/// The motion of the bodies of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Situation {
    /// Tumbling freely, without a floor.
    Flight,
    /// Tumbling and falling from high above a floor.
    Falling,
    /// Falling close above the floor, without touching it.
    Near,
    /// Falling still closer: one body in twenty hits the floor during the step.
    Grazing,
    /// Thrown onto the floor from 0.5 to 2 m, and simulated until most are at rest.
    Settling,
    /// At rest.
    Rest,
    /// Sliding on a face without stopping, because friction cannot hold the box on the inclined floor.
    Sliding,
}

impl Situation {
    /// All situations.
    pub const ALL: [Self; 7] = [
        Self::Flight,
        Self::Falling,
        Self::Near,
        Self::Grazing,
        Self::Settling,
        Self::Rest,
        Self::Sliding,
    ];

    /// Display name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flight => "free flight",
            Self::Falling => "falling",
            Self::Near => "near the floor",
            Self::Grazing => "grazing the floor",
            Self::Settling => "settling, 3 s",
            Self::Rest => "at rest",
            Self::Sliding => "sliding",
        }
    }

    /// The floor, if any.
    pub fn floor(self) -> Option<Floor> {
        let friction = if self == Self::Sliding { 0.2 } else { 0.5 };
        (self != Self::Flight).then(|| Floor {
            friction,
            ..Floor::default()
        })
    }

    /// Gravity [m/s²], tilted by 0.3 rad for sliding boxes.
    pub fn gravity(self) -> DVec3 {
        match self {
            Self::Flight => DVec3::ZERO,
            Self::Sliding => DVec3::new(2.9, -9.37, 0.0),
            _ => DVec3::new(0.0, -9.81, 0.0),
        }
    }

    /// Number of steps of 1/60 s in a measured call that starts from the initial state; 0 if a call continues from the
    /// end of the last one.
    pub const fn episode(self) -> u32 {
        match self {
            Self::Settling => 180,
            Self::Near | Self::Grazing => 1,
            _ => 0,
        }
    }

    /// `n` boxes of many shapes in a grid 4 m apart. The same `n` always gives the same boxes.
    pub fn bodies(self, n: usize) -> Vec<(RigidBox, BodyState)> {
        let mut random = Random::new(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(7));
        let side = (n as f64).sqrt().ceil().max(1.0) as usize;
        (0..n)
            .map(|i| {
                let half = DVec3::from_array(core::array::from_fn(|_| random.range(0.2, 0.5)));
                let body = RigidBox::new(half, random.range(1.0, 3.0)).unwrap_or_default();
                let place = DVec3::new((i % side) as f64, 0.0, (i / side) as f64) * 4.0;
                (body, self.start(&body, place, &mut random))
            })
            .collect()
    }

    fn start(self, body: &RigidBox, place: DVec3, random: &mut Random) -> BodyState {
        let half = body.half_extents();
        let up = |y: f64| BodyState::at(place + DVec3::Y * y);
        let spin = random.vector(3.0);
        let turned = attitude(random);
        let tumbling = |y: f64, v: DVec3| {
            BodyState::at_pose(place + DVec3::Y * y, turned)
                .with_velocity(v)
                .with_angular_velocity(body, spin)
        };
        match self {
            Self::Flight => tumbling(0.0, random.vector(1.0)),
            Self::Falling => tumbling(1e6, random.vector(1.0)),
            // During the step the box falls by 1/60 + 9.81/7200 m = 0.01803 m.
            Self::Near => tumbling(body.radius() + 0.0185, DVec3::NEG_Y),
            Self::Grazing => tumbling(body.radius() + 0.01, DVec3::NEG_Y),
            Self::Settling => tumbling(body.radius() + random.range(0.5, 2.0), random.vector(1.0)),
            Self::Rest => up(half.y),
            Self::Sliding => up(half.y).with_velocity(DVec3::X),
        }
    }
}

/// A random attitude within about 90° of upright.
fn attitude(random: &mut Random) -> DQuat {
    let v = random.vector(1.0);
    let turn = DQuat::from_xyzw(v.x, v.y, v.z, random.range(0.1, 1.0));
    BodyState::at_pose(DVec3::ZERO, turn).rotation
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::floor::FloorContext;
    use box_physics::force::Gravity;

    /// There are two sets of bodies just above the floor. One has no impacts, the other a few.
    #[test]
    fn near_is_not_touching() {
        let (floor, settings) = (Floor::default(), ContactSettings::default());
        let force = Gravity(Situation::Near.gravity());
        let strikes = |situation: Situation| {
            let mut impacts = 0;
            for (body, mut state) in situation.bodies(2000) {
                let context = FloorContext {
                    floor: &floor,
                    settings: &settings,
                    body: &body,
                    force: &force,
                };
                let (mut memory, mut contact) = Default::default();
                let integrator = Integrator::default();
                impacts += integrator
                    .step_on_floor(
                        &context,
                        &mut state,
                        1.0 / 60.0,
                        &mut memory,
                        &mut contact,
                        None,
                    )
                    .impacts;
            }
            impacts
        };
        assert_eq!(strikes(Situation::Near), 0);
        let grazing = strikes(Situation::Grazing);
        assert!((50..200).contains(&grazing), "{grazing} of 2000");
    }

    #[test]
    fn sets_repeat_and_are_valid() {
        for situation in Situation::ALL {
            let bodies = situation.bodies(50);
            assert_eq!(bodies, situation.bodies(50));
            assert!(bodies.iter().all(|(_, state)| state.is_valid()));
            assert!(bodies[0].0 != bodies[1].0, "many shapes");
        }
    }
}
