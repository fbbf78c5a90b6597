//! Finds the boxes in a region, and the box that a ray hits. `WorldAabb` wraps Bevy's `Aabb3d`, so everything in
//! `bevy::math::bounding` applies to it. `cargo run --release --example aabb_queries`

use bevy::math::bounding::{Aabb3d, BoundingVolume, IntersectsVolume, RayCast3d};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(WorldGravity(DVec3::ZERO))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1)) // not for a game: one tick per update
        .add_systems(Startup, |mut commands: Commands| {
            for k in 0_u8..10 {
                let turned = Transform::from_xyz(3.0 * f32::from(k), 0.0, 0.0)
                    .with_rotation(Quat::from_rotation_y(0.1 * f32::from(k)));
                commands.spawn((RigidBox::default(), turned));
            }
        });
    app.update();
    app.update();

    let mut boxes = app
        .world_mut()
        .query::<(&WorldAabb, &RigidBox, &BodyState, &Transform)>();
    let region = Aabb3d::new(Vec3::new(9.0, 0.0, 0.0), Vec3::splat(4.0));
    let inside = boxes
        .iter(app.world())
        .filter(|(aabb, ..)| aabb.0.intersects(&region))
        .count();
    println!("{inside} boxes in the region");
    assert_eq!(inside, 3); // at x = 6, 9 and 12

    // A ray along x, slightly above the center. The bounding boxes give the candidates …
    let ray = Ray3d::new(Vec3::new(-5.0, 0.2, 0.0), Dir3::X);
    let cast = RayCast3d::from_ray(ray, 100.0);
    let nearest = boxes
        .iter(app.world())
        .filter(|(aabb, ..)| cast.aabb_intersection_at(&aabb.0).is_some())
        // … and the box itself, in its own axes, gives the hit point.
        .filter_map(|(_, body, state, _)| {
            let inverse = state.rotation.inverse();
            let local = Ray3d {
                origin: (inverse * (ray.origin.as_dvec3() - state.position)).as_vec3(),
                direction: Dir3::new((inverse * ray.direction.as_dvec3()).as_vec3()).ok()?,
            };
            let half = body.half_extents().as_vec3();
            RayCast3d::from_ray(local, 100.0).aabb_intersection_at(&Aabb3d::new(Vec3::ZERO, half))
        })
        .min_by(f32::total_cmp);
    println!("the ray hits after {nearest:?} m");
    assert!(nearest.is_some_and(|d| (d - 4.5).abs() < 1e-6));

    // The bounding box of all bodies, for example to frame them with a camera.
    let all = boxes
        .iter(app.world())
        .map(|(aabb, ..)| aabb.0)
        .reduce(|a, b| a.merge(&b))
        .expect("there are boxes");
    println!("bounding box of all: {} to {}", all.min, all.max);
    assert!(all.max.x > 27.5);
}
