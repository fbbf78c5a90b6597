//! Boxes, floor and light.

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor};
use bevy::light::CascadeShadowConfigBuilder;
use bevy::math::Affine2;
use bevy::mesh::Mesh;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use box_physics::prelude::{BodyIntegrator, Floor, GlobalIntegrator, RigidBox};

use crate::camera::views::{MAX_VIEWS, everywhere, only};
use crate::demo_2012::Demo2012;
use crate::scene::session::{MainBox, Session};
use crate::view::marks::cuboid;
use crate::view::style;

/// Edge of the drawn floor \[m\].
const FLOOR_SIZE: f32 = 400.0;

#[derive(Component)]
pub(super) struct FloorSurface;

/// Mesh and materials of the boxes.
#[derive(Resource)]
pub(super) struct BoxLook {
    main_box: Handle<StandardMaterial>,
    load: Handle<StandardMaterial>,
    meshes: Option<(Vec3, [Handle<Mesh>; 2])>,
}

pub(super) fn set_up(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    // One light per view, because a light casts the shadows of everything on its layers, including the main box.
    for view in 0..MAX_VIEWS {
        commands.spawn((
            only(view),
            DirectionalLight {
                illuminance: 8_000.0,
                shadow_maps_enabled: true,
                ..default()
            },
            // From the left of the home view, so that shadows fall beside the boxes and not behind them.
            Transform::from_xyz(-6.0, 9.0, 3.5).looking_at(Vec3::ZERO, Vec3::Y),
            CascadeShadowConfigBuilder {
                first_cascade_far_bound: 8.0,
                maximum_distance: 120.0,
                ..default()
            }
            .build(),
        ));
    }
    commands.insert_resource(GlobalAmbientLight {
        brightness: 330.0,
        ..default()
    });
    let tiles = FLOOR_SIZE / SQUARES as f32;
    commands.spawn((
        FloorSurface,
        everywhere(),
        Mesh3d(meshes.add(Plane3d::new(Vec3::Y, Vec2::splat(FLOOR_SIZE / 2.0)))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color_texture: Some(images.add(grid())),
            uv_transform: Affine2::from_scale(Vec2::splat(tiles)),
            perceptual_roughness: 0.95,
            ..default()
        })),
        Visibility::Hidden,
    ));
    let painted = |base_color| StandardMaterial {
        base_color,
        perceptual_roughness: 0.6,
        ..default()
    };
    commands.insert_resource(BoxLook {
        main_box: materials.add(painted(Color::WHITE)),
        load: materials.add(painted(Color::srgb(0.62, 0.66, 0.72))),
        meshes: None,
    });
}

/// Texels along an edge of the floor's tile, a power of two, and the number of 1 m grid squares along it.
const TILE: u32 = 512;
const SQUARES: u32 = 4;

/// Four by four squares of 1 m, with a stronger border of the tile, and all mipmaps: a distant floor is plain and does
/// not shimmer.
fn grid() -> Image {
    let (ground, fine, strong) = (76.0, 98.0, 116.0);
    let square = TILE / SQUARES;
    let line = |at: u32| match (at.min(TILE - at) < 3, at % square < 2) {
        (true, _) => strong,
        (_, true) => fine,
        _ => ground,
    };
    let texels = 0..TILE * TILE;
    let texels = texels.map(|texel| f32::max(line(texel % TILE), line(texel / TILE)));
    let mut level: Vec<f32> = texels.collect();
    let mut data: Vec<u8> = Vec::new();
    for halvings in 0..=TILE.ilog2() {
        let edge = (TILE >> halvings) as usize;
        // Slightly blue.
        let paint = |&v: &f32| [v as u8, (1.05 * v) as u8, (1.17 * v) as u8, 255];
        data.extend(level.iter().flat_map(paint));
        // The mean of two by two texels.
        let mean = |k: usize| {
            let corner = 2 * (k / (edge / 2)) * edge + 2 * (k % (edge / 2));
            let corners = [corner, corner + 1, corner + edge, corner + edge + 1];
            corners.map(|at| level[at]).iter().sum::<f32>() / 4.0
        };
        level = (0..level.len() / 4).map(mean).collect();
    }
    let size = Extent3d {
        width: TILE,
        height: TILE,
        depth_or_array_layers: 1,
    };
    let mut image = Image::new(
        size,
        TextureDimension::D2,
        data[..(4 * TILE * TILE) as usize].to_vec(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = TILE.ilog2() + 1;
    image.data = Some(data);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        anisotropy_clamp: 8,
        ..ImageSamplerDescriptor::linear()
    });
    image
}

/// Paints the main box in the color of its integrator, or white under a 2012 integrator.
pub(super) fn tint_main_box(
    main_box: Query<Option<&BodyIntegrator>, With<MainBox>>,
    global: Res<GlobalIntegrator>,
    demo: Res<Demo2012>,
    session: Res<Session>,
    look: Res<BoxLook>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let own = main_box.iter().next().flatten();
    let integrator = own.map_or(global.0, |own| own.0);
    let wanted = match demo.active(&session) {
        Some(_) => Color::WHITE,
        None => style::of(integrator).srgb(),
    };
    let differs = |m: &StandardMaterial| m.base_color != wanted;
    if materials.get(&look.main_box).is_some_and(differs)
        && let Some(mut material) = materials.get_mut(&look.main_box)
    {
        material.base_color = wanted;
    }
}

/// Gives new boxes a mesh: two meshes and two materials in total, for few draw calls.
pub(super) fn dress_boxes(
    new: Query<(Entity, &RigidBox, Has<MainBox>), Added<RigidBox>>,
    mut look: ResMut<BoxLook>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (entity, body, main_box) in &new {
        let half = body.half_extents().as_vec3();
        let [marked, plain] = match &look.meshes {
            Some((size, meshes)) if *size == half => meshes.clone(),
            _ => {
                let made = [true, false].map(|marked| meshes.add(cuboid(half, marked)));
                look.meshes = Some((half, made.clone()));
                made
            }
        };
        // The other boxes are in every view, because their shadows are.
        let (mesh, material, layers) = match main_box {
            true => (marked, look.main_box.clone(), RenderLayers::default()),
            false => (plain, look.load.clone(), everywhere()),
        };
        let look = (Mesh3d(mesh), MeshMaterial3d(material), layers);
        commands.entity(entity).insert(look);
    }
}

/// Shows the floor if the physics has one.
pub(super) fn place_floor(
    floor: Option<Res<Floor>>,
    mut surface: Single<(&mut Transform, &mut Visibility), With<FloorSurface>>,
) {
    let (transform, visibility) = &mut *surface;
    let wanted = match floor {
        Some(_) => Visibility::Visible,
        None => Visibility::Hidden,
    };
    visibility.set_if_neq(wanted);
    if let Some(floor) = floor {
        transform.translation.y = floor.height as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::Integrator;

    /// A box that a system of `Update` spawns is drawn in the same frame, in its integrator's color.
    #[test]
    fn a_new_box_is_dressed_in_its_first_frame() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Mesh>()
            .init_asset::<StandardMaterial>();
        crate::view::add_dressing(&mut app);
        let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
        let [main_box, load] = [(); 2].map(|()| materials.add(StandardMaterial::default()));
        app.insert_resource(BoxLook {
            main_box: main_box.clone(),
            load,
            meshes: None,
        })
        .insert_resource(GlobalIntegrator(Integrator::Rk4))
        .init_resource::<Demo2012>()
        .insert_resource(Session::new(box_scenarios::Scenario::default(), 0))
        .add_systems(Update, |mut commands: Commands| {
            commands.spawn((RigidBox::default(), MainBox));
        });
        app.update();
        let world = app.world_mut();
        let mut drawn = world.query_filtered::<(), (With<MainBox>, With<Mesh3d>)>();
        assert_eq!(drawn.iter(world).count(), 1);
        let materials = world.resource::<Assets<StandardMaterial>>();
        let color = materials.get(&main_box).map(|m| m.base_color);
        assert_eq!(color, Some(style::of(Integrator::Rk4).srgb()));
    }
}
