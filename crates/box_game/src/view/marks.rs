//! Marks on the faces of a box: the letter of the axis through the face, underlined, with a minus sign on the opposite
//! face. Every attitude therefore looks different. Strokes are in body axes, for meshes and for lines.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use bevy::prelude::*;

/// A stroke in the letter's square, −1 to 1.
type Stroke = [[f32; 2]; 2];

const UNDERLINE: Stroke = [[-0.8, -1.35], [0.8, -1.35]];
const MINUS: Stroke = [[-1.7, 0.0], [-1.0, 0.0]];
const LETTERS: [&[Stroke]; 3] = [
    &[[[-0.7, 1.0], [0.7, -1.0]], [[-0.7, -1.0], [0.7, 1.0]]],
    &[
        [[-0.7, 1.0], [0.0, 0.1]],
        [[0.7, 1.0], [0.0, 0.1]],
        [[0.0, 0.1], [0.0, -1.0]],
    ],
    &[
        [[-0.7, 1.0], [0.7, 1.0]],
        [[0.7, 1.0], [-0.7, -1.0]],
        [[-0.7, -1.0], [0.7, -1.0]],
    ],
];
/// Half the letter's size, relative to the shorter half-edge of its face.
const SIZE: f32 = 0.5;
/// Half the width of a stroke, relative to half the letter's size.
const WIDTH: f32 = 0.15;
/// Height of the marks above the face, relative to the box's shortest half-edge.
const LIFT: f32 = 0.004;

/// A face: axis and sign, center \[m\], and the half-edges along its right and up \[m\].
struct Face {
    axis: usize,
    sign: f32,
    normal: Vec3,
    middle: Vec3,
    right: Vec3,
    up: Vec3,
}

fn faces(half: Vec3) -> impl Iterator<Item = Face> {
    [0, 1, 2].into_iter().flat_map(move |axis| {
        [1.0, -1.0].map(|sign| {
            let normal = sign * Vec3::AXES[axis];
            let up = if axis == 1 { Vec3::Z } else { Vec3::Y };
            let right = up.cross(normal);
            Face {
                axis,
                sign,
                normal,
                middle: normal * half[axis],
                right: right * right.abs().dot(half),
                up: up * up.dot(half),
            }
        })
    })
}

impl Face {
    /// Half the size of the letter \[m\].
    fn size(&self) -> f32 {
        SIZE * self.right.length().min(self.up.length())
    }

    /// The strokes of its mark in the letter's square.
    fn letter(&self) -> impl Iterator<Item = Stroke> {
        let minus = (self.sign < 0.0).then_some(MINUS);
        let letter = LETTERS[self.axis].iter().copied();
        letter.chain([UNDERLINE]).chain(minus)
    }

    /// The strokes of its mark, body axes \[m\].
    fn strokes(&self, lift: f32) -> impl Iterator<Item = [Vec3; 2]> {
        let (right, up) = (self.right.normalize_or_zero(), self.up.normalize_or_zero());
        let (size, middle) = (self.size(), self.middle + self.normal * lift);
        let place = move |[x, y]: [f32; 2]| middle + size * (x * right + y * up);
        self.letter().map(move |stroke| stroke.map(place))
    }

    /// Lightness of the face; opposite faces differ strongly.
    fn shade(&self) -> f32 {
        let (front, back) = [(0.62, 0.16), (1.0, 0.10), (0.40, 0.24)][self.axis];
        if self.sign > 0.0 { front } else { back }
    }
}

/// The marks of the faces toward +x, +y and +z, as lines in body axes \[m\].
pub(super) fn lines(half: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
    faces(half)
        .filter(|face| face.sign > 0.0)
        .flat_map(|face| face.strokes(0.0).collect::<Vec<_>>())
}

/// A cuboid with six faces of different lightness; the material's color identifies the box. Boxes of the load have no
/// marks.
pub(super) fn cuboid(half: Vec3, marked: bool) -> Mesh {
    let (mut places, mut normals, mut colors, mut indices) = (vec![], vec![], vec![], vec![]);
    let mut quad = |normal: Vec3, corners: [Vec3; 4], color: f32| {
        let first = places.len() as u32;
        places.extend(corners.map(|c| c.to_array()));
        normals.extend([normal.to_array(); 4]);
        colors.extend([[color, color, color, 1.0]; 4]);
        indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    };
    for face in faces(half) {
        let (m, r, u) = (face.middle, face.right, face.up);
        let shade = face.shade();
        let corners = [m - r - u, m + r - u, m + r + u, m - r + u];
        quad(face.normal, corners, shade);
        if !marked {
            continue;
        }
        let ink = if shade > 0.3 { 0.02 } else { 1.0 };
        let width = WIDTH * face.size();
        for [a, b] in face.strokes(LIFT * half.min_element()) {
            let along = (b - a).normalize_or_zero() * width;
            let aside = face.normal.cross(along);
            let (a, b) = (a - along, b + along);
            let corners = [a - aside, b - aside, b + aside, a + aside];
            quad(face.normal, corners, ink);
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
    .with_inserted_indices(Indices::U32(indices))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every mark is inside its face, and no two faces look equal in any of their four rotations.
    #[test]
    fn marks_lie_on_their_faces_and_tell_them_apart() {
        let half = Vec3::new(0.2, 0.5, 1.0);
        let mut seen: Vec<Vec<[[i32; 2]; 2]>> = Vec::new();
        for face in faces(half) {
            for p in face.strokes(0.0).flatten() {
                assert!((p.abs().cmple(half + 1e-6)).all(), "{p}");
                assert!((p.dot(face.normal) - face.normal.abs().dot(half)).abs() < 1e-6);
            }
            let outward = face.right.cross(face.up).dot(face.normal);
            assert!(outward > 0.0, "seen from outside");
            for turn in [Vec2::X, Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y] {
                let end = |p: [f32; 2]| {
                    (turn.rotate(p.into()) * 100.0)
                        .round()
                        .as_ivec2()
                        .to_array()
                };
                let turned = face.letter().map(|stroke| {
                    let mut ends = stroke.map(end);
                    ends.sort_unstable();
                    ends
                });
                let mut look: Vec<_> = turned.collect();
                look.sort_unstable();
                assert!(!seen.contains(&look), "{} {}", face.axis, face.sign);
                seen.push(look);
            }
        }
    }
}
