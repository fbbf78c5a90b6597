//! STUB (replaced by the contact module).
use crate::{body::RigidBox, force::ForceLaw, schemes::*, state::BodyState};
use bevy::ecs::{component::Component, reflect::ReflectResource, resource::Resource};
use bevy::reflect::Reflect;
use glam::DVec3;
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource)]
pub struct Floor {
    pub height: f64,
    pub restitution: f64,
    pub friction: f64,
}
impl Default for Floor {
    fn default() -> Self {
        Self {
            height: 0.0,
            restitution: 0.3,
            friction: 0.5,
        }
    }
}
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Default)]
pub struct ContactSettings {
    pub restitution_threshold: f64,
    pub max_impacts: u32,
    pub max_iterations: u32,
    pub tolerance: f64,
}
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct ContactState {}
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    pub corner: u8,
    pub point: DVec3,
    pub normal_impulse: f64,
    pub phase: ContactPhase,
}
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactPhase {
    Began,
    Persists,
    Ended,
}
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloorOutcome {
    pub step: StepOutcome,
    pub impacts: u32,
    pub impacts_capped: u32,
    pub solves_capped: u32,
    pub energy_repairs: u32,
    pub resting: bool,
}
impl core::ops::AddAssign for FloorOutcome {
    fn add_assign(&mut self, _o: Self) {}
}
pub fn may_touch<F: ForceLaw>(
    _floor: &Floor,
    _body: &RigidBox,
    _state: &BodyState,
    _force: &F,
    _h: f64,
) -> bool {
    false
}
pub fn step_on_floor<S: Scheme, F: ForceLaw>(
    _floor: &Floor,
    _settings: &ContactSettings,
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
    memory: &mut SchemeMemory,
    _contact: &mut ContactState,
    _points: Option<&mut Vec<ContactPoint>>,
) -> FloorOutcome {
    FloorOutcome {
        step: S::step(body, state, force, h, memory),
        ..Default::default()
    }
}
impl Floor { pub fn new(height: f64, restitution: f64, friction: f64) -> Result<Self, crate::error::InvalidValue> { Ok(Self{height,restitution,friction}) } }
