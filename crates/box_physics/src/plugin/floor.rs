//! The plugin for contact with floor and planes.

use bevy::app::{App, Plugin};
use bevy::ecs::schedule::{IntoScheduleConfigs, SystemCondition, common_conditions};

use super::components::{ReportContacts, ReportPersisting, RestingSince};
use super::messages::{ContactPhase, FloorContact, Landed, Settled, Woken};
use super::sets::{BeforeSteps, PhysicsSchedule, PhysicsSystems};
use super::{contact, contacts, faults};
use crate::floor::{
    ContactReport, ContactSettings, ContactState, Floor, Friction, Restitution, StaticPlane,
};

/// Adds contact with a [`Floor`] and with [`StaticPlane`]s. Without this plugin they have no effect, and bodies carry
/// no contact memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct FloorPlugin;

impl Plugin for FloorPlugin {
    fn is_unique(&self) -> bool {
        false
    }

    fn build(&self, app: &mut App) {
        if app.is_plugin_added::<Self>() {
            return;
        }
        app.init_resource::<ContactSettings>()
            .add_message::<FloorContact>()
            .add_message::<Landed>();
        register![app: Floor, StaticPlane, ContactSettings, Friction, Restitution, ContactState, ReportContacts,
            ReportPersisting, RestingSince, FloorContact, ContactPhase, ContactReport, Landed, Settled, Woken];
        faults::require::<RestingSince, RestingSince>(app);
        faults::require::<ContactState, ContactState>(app);
        app.add_systems(
            PhysicsSchedule,
            (
                contact::contact,
                contact::move_surfaces,
                contacts::report_contacts,
            )
                .chain()
                .in_set(PhysicsSystems::Contact),
        )
        .add_systems(
            BeforeSteps,
            (
                contacts::end_all_contacts.run_if(
                    common_conditions::resource_removed::<Floor>
                        .or_else(contacts::last_plane_removed),
                ),
                faults::report_invalid_planes,
            ),
        );
        contacts::build(app);
    }
}
