//! Boxes, floor and light.

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor};
use bevy::light::CascadeShadowConfigBuilder;
use bevy::mesh::Mesh;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use box_physics::prelude::{BodyIntegrator, Floor, GlobalIntegrator, Integrator, RigidBox};

use crate::camera::views::everywhere;
use crate::demo_2012::Demo2012;
use crate::scene::session::{MainBox, Session};
use crate::view::marks::{marked_cuboid, shaded_cuboid};

/// Edge of the drawn floor \[m\].
const FLOOR_SIZE: f32 = 400.0;

/// The drawn floor.
#[derive(Component)]
pub(super) struct FloorSurface;

/// Mesh and materials of the boxes.
#[derive(Resource)]
pub(super) struct BoxLook {
    main_box: Handle<StandardMaterial>,
    load: Handle<StandardMaterial>,
    meshes: Option<(Vec3, [Handle<Mesh>; 2])>,
}

/// Light, floor and materials.
pub(super) fn set_up(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    commands.spawn((
        everywhere(),
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
    commands.insert_resource(GlobalAmbientLight {
        brightness: 330.0,
        ..default()
    });
    let mut plane = Plane3d::new(Vec3::Y, Vec2::splat(FLOOR_SIZE / 2.0))
        .mesh()
        .build();
    let tiles = FLOOR_SIZE / SQUARES as f32;
    if let Some(bevy::mesh::VertexAttributeValues::Float32x2(uvs)) =
        plane.attribute_mut(Mesh::ATTRIBUTE_UV_0)
    {
        for uv in uvs {
            uv[0] *= tiles;
            uv[1] *= tiles;
        }
    }
    commands.spawn((
        FloorSurface,
        everywhere(),
        Mesh3d(meshes.add(plane)),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color_texture: Some(images.add(grid())),
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

/// Texels along an edge of the floor's tile, a power of two, and the grid squares of 1 m along it.
const TILE: u32 = 512;
const SQUARES: u32 = 4;

/// Four by four squares of 1 m, the border of the tile drawn stronger, with all smaller versions of it: a distant
/// floor is plain and does not shimmer.
fn grid() -> Image {
    let (ground, fine, strong) = (76.0, 98.0, 116.0);
    let square = TILE / SQUARES;
    let line = |at: u32| match (at.min(TILE - at) < 3, at % square < 2) {
        (true, _) => strong,
        (_, true) => fine,
        _ => ground,
    };
    let mut level: Vec<f32> = (0..TILE * TILE)
        .map(|texel| f32::max(line(texel % TILE), line(texel / TILE)))
        .collect();
    let mut data: Vec<u8> = Vec::new();
    let mut edge = TILE as usize;
    loop {
        // A little blue.
        data.extend(
            level
                .iter()
                .flat_map(|&v| [v as u8, (1.05 * v) as u8, (1.17 * v) as u8, 255]),
        );
        if edge == 1 {
            break;
        }
        edge /= 2;
        level = (0..edge * edge)
            .map(|k| {
                let (x, y) = (2 * (k % edge), 2 * (k / edge));
                let width = 2 * edge;
                let at = |x: usize, y: usize| level[y * width + x];
                (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0
            })
            .collect();
    }
    let mut image = Image::new(
        Extent3d {
            width: TILE,
            height: TILE,
            depth_or_array_layers: 1,
        },
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

/// The color of a box that `integrator` moves: that of the integrator.
pub(crate) fn box_color(integrator: Integrator) -> Color {
    let [r, g, b] = crate::view::style::of(integrator).rgb;
    Color::srgb_u8(r, g, b)
}

/// Paints the main box in the color of the integrator that moves it; white where that is none of ours.
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
        None => box_color(integrator),
    };
    let differs = |m: &StandardMaterial| m.base_color != wanted;
    if materials.get(&look.main_box).is_some_and(differs)
        && let Some(mut material) = materials.get_mut(&look.main_box)
    {
        material.base_color = wanted;
    }
}

/// Gives new boxes a mesh: two meshes and two materials for all, so that they are drawn in few calls.
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
                let made = [marked_cuboid(half), shaded_cuboid(half)].map(|mesh| meshes.add(mesh));
                look.meshes = Some((half, made.clone()));
                made
            }
        };
        let (mesh, material) = if main_box {
            (marked, look.main_box.clone())
        } else {
            (plain, look.load.clone())
        };
        commands
            .entity(entity)
            .insert((Mesh3d(mesh), MeshMaterial3d(material)));
    }
}

/// Shows the floor where the physics has one.
pub(super) fn place_floor(
    floor: Option<Res<Floor>>,
    mut surface: Single<(&mut Transform, &mut Visibility), With<FloorSurface>>,
) {
    let (transform, visibility) = &mut *surface;
    match floor {
        Some(floor) => {
            transform.translation.y = floor.height as f32;
            visibility.set_if_neq(Visibility::Visible);
        }
        None => {
            visibility.set_if_neq(Visibility::Hidden);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        });
        app.insert_resource(GlobalIntegrator(Integrator::Rk4));
        app.init_resource::<Demo2012>();
        app.insert_resource(Session::new(box_scenarios::Scenario::default(), 0));
        app.add_systems(Update, |mut commands: Commands| {
            commands.spawn((RigidBox::default(), MainBox));
        });
        app.update();
        let world = app.world_mut();
        let mut drawn = world.query_filtered::<(), (With<MainBox>, With<Mesh3d>)>();
        assert_eq!(drawn.iter(world).count(), 1);
        let materials = world.resource::<Assets<StandardMaterial>>();
        let color = materials.get(&main_box).map(|m| m.base_color);
        assert_eq!(color, Some(box_color(Integrator::Rk4)));
    }
}
