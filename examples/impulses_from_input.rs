//! Pushes from the keyboard. The example presses the keys itself, so it runs without a window; with `DefaultPlugins`
//! the same system receives real keys. `cargo run --release --example impulses_from_input`

use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::{ButtonState, InputPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

/// Space jumps; W pushes forward while held.
fn push(
    keys: Res<ButtonInput<KeyCode>>,
    time: Res<Time>,
    boxes: Query<Entity, With<RigidBox>>,
    mut impulses: MessageWriter<ApplyImpulse>,
) {
    for entity in &boxes {
        if keys.just_pressed(KeyCode::Space) {
            impulses.write(ApplyImpulse::center(entity, Vec3::Y * 5.0)); // N s
        }
        if keys.pressed(KeyCode::KeyW) {
            // 20 N during this frame, at the top face, which also tips the box.
            let push = Vec3::NEG_Z * (20.0 * time.delta_secs());
            impulses.write(ApplyImpulse::at_body_point(entity, push, Vec3::Y * 0.5));
        }
    }
}

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, InputPlugin, PhysicsPlugins::default()))
        .insert_resource(Floor::default())
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(Update, push);
    let entity = app
        .world_mut()
        .spawn((RigidBox::default(), Transform::from_xyz(0.0, 0.5, 0.0)))
        .id();
    let window = app.world_mut().spawn_empty().id();
    let key = |app: &mut App, key_code, state| {
        app.world_mut().write_message(KeyboardInput {
            key_code,
            logical_key: Key::Dead(None),
            state,
            text: None,
            repeat: false,
            window,
        });
    };

    let mut highest: f64 = 0.0;
    for frame in 0..120 {
        match frame {
            10 => key(&mut app, KeyCode::Space, ButtonState::Pressed),
            12 => key(&mut app, KeyCode::Space, ButtonState::Released),
            15 => key(&mut app, KeyCode::KeyW, ButtonState::Pressed),
            30 => key(&mut app, KeyCode::KeyW, ButtonState::Released),
            _ => {}
        }
        app.update();
        let state = app.world().get::<BodyState>(entity).expect("a body");
        highest = highest.max(state.position.y);
    }
    let state = app.world().get::<BodyState>(entity).expect("a body");
    println!(
        "it jumped to {highest:.2} m and is {:.2} m further on",
        -state.position.z
    );
    assert!(highest > 1.5 && state.position.z < -0.5);
}
