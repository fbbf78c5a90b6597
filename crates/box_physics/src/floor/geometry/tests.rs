use super::*;
use crate::floor::Floor;
use crate::floor::tests::tilted;

#[test]
fn corners_are_where_the_state_says() {
    let (body, state) = tilted();
    let floor = Floor::new(0.5, 0.3, 0.5).expect("valid");
    let c = Corners::at(&floor, &body, &state);
    for (k, r) in crate::aabb::corners(body.half_extents())
        .into_iter()
        .enumerate()
    {
        let point = state.point(r);
        assert!((state.position + c.lever(k) - point).length() < 1e-15);
        assert!((c.height[k] - (point.y - 0.5)).abs() < 1e-15);
    }
}

#[test]
fn faces() {
    assert!(spans_face(0b0000_1111) && spans_face(0b0011_0001) && spans_face(0b1111_1111));
    assert!(!spans_face(0b0000_0011) && !spans_face(0b1000_0001) && !spans_face(0));
}
