//! The command line that brings the present set-up back.

use bevy::clipboard::Clipboard;
use bevy::prelude::*;
use box_physics::prelude::{GlobalIntegrator, Integrator, PhysicsClock};

use crate::compare::{Comparison, Layout};
use crate::scene::library::SceneLibrary;
use crate::scene::session::Session;
use crate::ui::panel::{Parameters, number};

/// What it is made of.
#[derive(Clone, Debug)]
pub struct SetUp<'a> {
    /// Id of the scene, or path of its file.
    pub scene: &'a str,
    /// The hero's integrator.
    pub integrator: Integrator,
    /// The integrators beside it.
    pub lanes: &'a [Integrator],
    /// How they are shown.
    pub layout: Layout,
    /// dt \[s\].
    pub step: f64,
    /// Substeps per step.
    pub substeps: u32,
    /// Target speed.
    pub speed: f64,
    /// Seed of the load boxes.
    pub seed: u64,
    /// As set, and as the scene has them.
    pub parameters: &'a Parameters,
    /// See `parameters`.
    pub defaults: &'a Parameters,
}

/// The line. What is as it would be anyway is left out.
pub fn line(set_up: &SetUp) -> String {
    let mut words = vec!["box_game".to_owned(), quoted(set_up.scene)];
    let others = set_up.lanes.iter().filter(|&&i| i != set_up.integrator);
    let integrators: Vec<_> = core::iter::once(&set_up.integrator)
        .chain(others)
        .map(|i| i.id())
        .collect();
    words.push(format!("--integrator {}", integrators.join(",")));
    if set_up.layout != Layout::default() {
        words.push(format!(
            "--layout {}",
            set_up.layout.name().to_ascii_lowercase()
        ));
    }
    words.push(format!("--dt {}", step(set_up.step)));
    if set_up.substeps != 1 {
        words.push(format!("--substeps {}", set_up.substeps));
    }
    if set_up.speed != 1.0 {
        words.push(format!("--speed {}", set_up.speed));
    }
    let (p, d) = (set_up.parameters, set_up.defaults);
    if p.boxes != d.boxes {
        words.push(format!("--boxes {}", p.boxes));
    }
    if set_up.seed != 1 {
        words.push(format!("--seed {}", set_up.seed));
    }
    for (name, now, scene) in [
        ("gravity", Some(p.gravity), Some(d.gravity)),
        ("restitution", p.restitution, d.restitution),
        ("friction", p.friction, d.friction),
        ("linear-drag", Some(p.linear_drag), Some(d.linear_drag)),
        (
            "angular-damping",
            Some(p.angular_damping),
            Some(d.angular_damping),
        ),
        ("mass", Some(p.mass), Some(d.mass)),
        ("impulse", Some(p.impulse), Some(d.impulse)),
    ] {
        if let Some(value) = now.filter(|_| now != scene) {
            words.push(format!("--set {name}={value}"));
        }
    }
    if p.half_extents != d.half_extents {
        let h = p.half_extents;
        words.push(format!("--set half-extents={},{},{}", h.x, h.y, h.z));
    }
    words.join(" ")
}

/// The command line that brings the present set-up back.
pub fn of(world: &World) -> String {
    let session = world.resource::<Session>();
    let library = world.resource::<SceneLibrary>();
    let comparison = world.get_resource::<Comparison>();
    let scene = library.path_of(session.scenario.id);
    line(&SetUp {
        scene: scene.as_deref().unwrap_or(session.scenario.id),
        integrator: world.resource::<GlobalIntegrator>().0,
        lanes: comparison.map_or(&[], |c| c.chosen()),
        layout: comparison.map(|c| c.settings.layout).unwrap_or_default(),
        step: world.resource::<Time<Fixed>>().timestep().as_secs_f64(),
        substeps: world.resource::<PhysicsClock>().substeps,
        speed: session.speed,
        seed: session.seed,
        parameters: &session.parameters,
        defaults: &session.defaults,
    })
}

/// Puts it on the clipboard, and shows it.
pub fn copy(world: &mut World) {
    let line = of(world);
    let copied = world
        .get_resource_mut::<Clipboard>()
        .is_some_and(|mut clipboard| clipboard.set_text(line.as_str()).is_ok());
    let text = if copied {
        format!("copied: {line}")
    } else {
        line
    };
    world.resource_mut::<Session>().notice(text);
}

/// A rate where that is shorter and says the same.
fn step(step: f64) -> String {
    let rate = (1.0 / step).round();
    // The clock counts nanoseconds.
    if (1.0 / rate - step).abs() < 1e-9 {
        format!("{}hz", number(rate))
    } else {
        format!("{step}")
    }
}

/// For a shell: plain where it can be.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./".contains(c);
    if word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::DVec3;

    #[test]
    fn only_what_differs_is_said() {
        let defaults = Parameters {
            gravity: 9.81,
            restitution: Some(0.5),
            friction: None,
            linear_drag: 0.0,
            angular_damping: 0.0,
            half_extents: DVec3::splat(0.5),
            mass: 2.0,
            impulse: 2.0,
            boxes: 1,
        };
        let mut set_up = SetUp {
            scene: "bounce",
            integrator: Integrator::Rk4,
            lanes: &[],
            layout: Layout::Ghosts,
            step: 16_666_667e-9,
            substeps: 1,
            speed: 1.0,
            seed: 1,
            parameters: &defaults,
            defaults: &defaults,
        };
        assert_eq!(line(&set_up), "box_game bounce --integrator rk4 --dt 60hz");
        let changed = Parameters {
            gravity: 1.62,
            half_extents: DVec3::new(0.1, 0.2, 0.3),
            boxes: 7,
            ..defaults
        };
        set_up.parameters = &changed;
        set_up.step = 0.0123;
        set_up.substeps = 3;
        set_up.speed = 0.25;
        set_up.scene = "my scenes/a.ron";
        set_up.lanes = &[Integrator::Split, Integrator::Rk4];
        set_up.layout = Layout::Lanes;
        assert_eq!(
            line(&set_up),
            "box_game 'my scenes/a.ron' --integrator rk4,split --layout lanes --dt 0.0123 --substeps 3 \
             --speed 0.25 --boxes 7 --set gravity=1.62 --set half-extents=0.1,0.2,0.3"
        );
    }
}
