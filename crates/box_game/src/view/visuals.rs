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

/// Edge of the drawn floor \[m\].
const FLOOR_SIZE: f32 = 200.0;

/// The drawn floor.
#[derive(Component)]
pub(super) struct FloorSurface;

/// Mesh and materials of the boxes.
#[derive(Resource)]
pub(super) struct BoxLook {
    main_box: Handle<StandardMaterial>,
    load: Handle<StandardMaterial>,
    mesh: Option<(Vec3, Handle<Mesh>)>,
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
            illuminance: 9_000.0,
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
        brightness: 260.0,
        ..default()
    });
    let mut plane = Plane3d::new(Vec3::Y, Vec2::splat(FLOOR_SIZE / 2.0))
        .mesh()
        .build();
    // One tile of the image is 2 m: four squares of 1 m.
    if let Some(bevy::mesh::VertexAttributeValues::Float32x2(uvs)) =
        plane.attribute_mut(Mesh::ATTRIBUTE_UV_0)
    {
        for uv in uvs {
            uv[0] *= FLOOR_SIZE / 2.0;
            uv[1] *= FLOOR_SIZE / 2.0;
        }
    }
    commands.spawn((
        FloorSurface,
        everywhere(),
        Mesh3d(meshes.add(plane)),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color_texture: Some(images.add(checker())),
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
        mesh: None,
    });
}

/// Texels along an edge of the floor's tile, a power of two.
const TILE: u32 = 128;

/// Two by two squares of 1 m, with all smaller versions of it: a distant floor is gray and does not
/// shimmer.
fn checker() -> Image {
    let (light, dark) = ([96, 102, 112, 255], [78, 84, 94, 255]);
    let mean: [u8; 4] = core::array::from_fn(|k| u8::midpoint(light[k], dark[k]));
    let level = |edge: u32| {
        (0..edge * edge).flat_map(move |texel| {
            let square = |at: u32| at * 2 / edge;
            match edge {
                1 => mean,
                _ if (square(texel % edge) + square(texel / edge)).is_multiple_of(2) => light,
                _ => dark,
            }
        })
    };
    let levels = TILE.ilog2() + 1;
    let mut image = Image::new(
        Extent3d {
            width: TILE,
            height: TILE,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        level(TILE).collect(),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = levels;
    image.data = Some((0..levels).flat_map(|k| level(TILE >> k)).collect());
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        anisotropy_clamp: 8,
        ..ImageSamplerDescriptor::linear()
    });
    image
}

/// A cuboid with six faces of different lightness and no color of its own, so that every attitude looks
/// different and the material's color says whose box it is.
pub(crate) fn shaded_cuboid(half: Vec3) -> Mesh {
    let mut mesh = Cuboid::from_size(half * 2.0).mesh().build();
    let colors: Vec<[f32; 4]> = mesh
        .attribute(Mesh::ATTRIBUTE_NORMAL)
        .and_then(|n| n.as_float3())
        .map(|normals| {
            normals
                .iter()
                .map(|n| face_shade(Vec3::from_array(*n)))
                .collect()
        })
        .unwrap_or_default();
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    mesh
}

/// Opposite faces are far apart in lightness: a box that has turned over is told at a glance.
fn face_shade(normal: Vec3) -> [f32; 4] {
    let pair = if normal.x.abs() > 0.5 {
        (0.62, 0.14)
    } else if normal.y.abs() > 0.5 {
        (1.0, 0.07)
    } else {
        (0.36, 0.22)
    };
    let shade = if normal.element_sum() > 0.0 {
        pair.0
    } else {
        pair.1
    };
    [shade, shade, shade, 1.0]
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

/// Gives new boxes a mesh: one mesh and two materials for all, so that they are drawn in few calls.
pub(super) fn dress_boxes(
    new: Query<(Entity, &RigidBox, Has<MainBox>), Added<RigidBox>>,
    mut look: ResMut<BoxLook>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (entity, body, main_box) in &new {
        let half = body.half_extents().as_vec3();
        let mesh = match &look.mesh {
            Some((size, mesh)) if *size == half => mesh.clone(),
            _ => {
                let mesh = meshes.add(shaded_cuboid(half));
                look.mesh = Some((half, mesh.clone()));
                mesh
            }
        };
        let material = if main_box {
            look.main_box.clone()
        } else {
            look.load.clone()
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
