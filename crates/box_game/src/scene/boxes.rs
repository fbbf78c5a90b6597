//! Initial states of the boxes: the main box as defined by the scene, the load on a grid around it.

use box_physics::prelude::{BodyState, DQuat, DVec3};
use box_scenarios::Setup;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt as _, SeedableRng as _};

/// Initial state of box `k`: that of the scene for `k` = 0. The others are on a grid around it, each with a random
/// attitude and the same motion.
pub(super) fn place(setup: &Setup, k: u32, seed: u64) -> BodyState {
    let mut state = setup.initial;
    if k == 0 {
        return state;
    }
    let pitch = 2.5 * setup.body.radius();
    let (i, j) = spiral(k);
    state.position += DVec3::new(f64::from(i) * pitch, 0.0, f64::from(j) * pitch);
    // Uniform on the unit 3-sphere, by rejection from the cube.
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(32) ^ u64::from(k));
    state.rotation = loop {
        let [x, y, z, w] = core::array::from_fn(|_| random.random_range(-1.0..=1.0));
        let q = DQuat::from_xyzw(x, y, z, w);
        let norm = q.length();
        if norm > 0.1 && norm <= 1.0 {
            break q / norm;
        }
    };
    state
}

/// The `k`-th cell of a square spiral around the origin.
fn spiral(k: u32) -> (i32, i32) {
    // Ring r holds the cells with max(|i|, |j|) = r: 8r of them.
    let mut r = 0_u32;
    while (2 * r + 1) * (2 * r + 1) <= k {
        r += 1;
    }
    let along = (k - (2 * r - 1) * (2 * r - 1)) as i32;
    let (r, side) = (r as i32, 2 * r as i32);
    match along / side {
        0 => (-r + along % side, -r),
        1 => (r, -r + along % side),
        2 => (r - along % side, r),
        _ => (-r, r - along % side),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;
    use std::collections::HashSet;

    #[test]
    fn the_spiral_visits_every_cell_once() {
        let cells: HashSet<_> = (1..2601).map(spiral).collect();
        assert_eq!(cells.len(), 2600);
        assert!(!cells.contains(&(0, 0)));
        assert!(cells.iter().all(|&(i, j)| i.abs() <= 25 && j.abs() <= 25));
    }

    #[test]
    fn attitudes_follow_the_seed() {
        let setup = Scenario::find("load").expect("a scene").setup;
        assert_eq!(place(&setup, 5, 1), place(&setup, 5, 1));
        assert_ne!(place(&setup, 5, 1), place(&setup, 5, 2));
        assert_eq!(place(&setup, 0, 1), setup.initial);
        assert!((place(&setup, 7, 3).rotation.length() - 1.0).abs() < 1e-15);
    }
}
