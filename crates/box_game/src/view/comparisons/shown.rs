//! The trajectories that are drawn, and their places.

use bevy::math::DVec3;
use bevy::prelude::*;
use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::Status;

use crate::action::compare::Layout;
use crate::camera::views;
use crate::compare::track::Track;
use crate::compare::{Comparison, Run};
use crate::view::style;

/// Distance of two comparisons in radii of the box.
const PITCH: f32 = 2.7;

/// A trajectory that is drawn: integrator, state, what is measured of it, by how much its picture is shifted, status.
pub(super) type Shown<'a> = (Integrator, &'a BodyState, &'a Track, Vec3, Status);

/// Every trajectory that is drawn, the main box's first.
pub(super) fn shown(run: &Run, layout: Layout) -> Vec<Shown<'_>> {
    let main_box = (
        run.main_box.integrator,
        &run.main_box.state,
        &run.main_box.track,
        Vec3::ZERO,
        run.main_box.status(),
    );
    let side = sideways(run) * PITCH * run.law.body.radius() as f32;
    let comparisons = run.comparisons.iter().enumerate().map(|(k, r)| {
        let offset = match layout {
            Layout::SideBySide => side * place(k),
            Layout::Solo | Layout::Overlaid | Layout::Views => Vec3::ZERO,
        };
        let driver = &r.simulation.driver;
        let (integrator, state) = (driver.integrator, &driver.state);
        (integrator, state, &r.track, offset, r.simulation.status())
    });
    let beside = match layout {
        Layout::Solo => 0,
        Layout::Overlaid | Layout::SideBySide => run.comparisons.len(),
        Layout::Views => run.comparisons.len().min(views::MOST - 1),
    };
    [main_box]
        .into_iter()
        .chain(comparisons.take(beside))
        .collect()
}

/// Right, left, right, left of the main box.
fn place(k: usize) -> f32 {
    let ring = (k / 2 + 1) as f32;
    if k.is_multiple_of(2) { ring } else { -ring }
}

/// Across the motion over the floor, horizontally.
pub(super) fn sideways(run: &Run) -> Vec3 {
    let v = run.start().velocity.as_vec3();
    let along = Vec3::new(v.x, 0.0, v.z);
    if along.length() > 0.1 && run.law.floor.is_some() {
        along.cross(Vec3::Y).normalize()
    } else {
        Vec3::X
    }
}

pub(super) fn color(integrator: Integrator, alpha: f32) -> Color {
    let [r, g, b] = style::of(integrator).rgb;
    Color::srgb_u8(r, g, b).with_alpha(alpha)
}

/// The layout as it is drawn: views need a room for the picture, and are else drawn in one place.
pub(super) fn drawn(comparison: &Comparison, area: bool) -> Layout {
    match comparison.settings.layout {
        Layout::Views if !area => Layout::Overlaid,
        layout => layout,
    }
}

/// Length of a pin outside the box, over the box's radius.
const PIN: f64 = 0.35;

/// The ends of the pin through the box, body axes \[m\]: along the axis that the box spins about, which a flip
/// turns over. None for a box that travels.
pub(super) fn pin(run: &Run) -> Option<[DVec3; 2]> {
    let start = run.start();
    let travels = start.velocity.length() > 0.1
        || run.law.floor.is_some()
        || run.law.forces.gravity.length() > 0.0;
    let half = run.law.body.half_extents();
    let axis = run.reference_flips.axis().unwrap_or(half.max_position());
    let inner = DVec3::AXES[axis] * half[axis];
    let outer = inner + DVec3::AXES[axis] * PIN * run.law.body.radius();
    (!travels).then_some([inner, outer])
}

/// The point that trails and labels follow, body axes \[m\].
pub(super) fn tip(run: &Run) -> DVec3 {
    pin(run).map_or(DVec3::ZERO, |[_, outer]| outer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    /// Only the picture is shifted: the states drawn are those simulated.
    #[test]
    fn comparisons_stand_side_by_side_in_the_picture_alone() {
        let setup = Scenario::find("slide").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        run.choose([
            Integrator::Rk4,
            Integrator::ExplicitEuler,
            Integrator::Midpoint,
        ]);
        let places: Vec<_> = shown(&run, Layout::SideBySide);
        assert_eq!(places.len(), 4);
        for (k, a) in places.iter().enumerate() {
            assert_eq!(a.1, &setup.initial);
            // Across the slide, and apart.
            assert!(a.3.x.abs() < 1e-6 && a.3.y == 0.0);
            let apart = PITCH * setup.body.radius() as f32 * 0.99;
            assert!(places[..k].iter().all(|b| a.3.distance(b.3) > apart));
        }
        assert!(
            shown(&run, Layout::Overlaid)
                .iter()
                .all(|s| s.3 == Vec3::ZERO)
        );
        assert_eq!(shown(&run, Layout::Solo).len(), 1);
    }
}
