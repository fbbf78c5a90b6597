use super::*;
use crate::body::RigidBox;
use crate::force::Gravity;
use crate::integrators::{Integrator, IntegratorMemory};
use crate::rotation::compose;
use crate::state::BodyState;
use proptest::prelude::*;

pub(super) fn angle(a: DQuat, b: DQuat) -> f64 {
    let d = a.conjugate() * b;
    2.0 * libm::atan2(d.xyz().length(), d.w.abs())
}

fn energy(inertia: DVec3, l: DVec3) -> f64 {
    0.5 * l.dot(l / inertia)
}

/// Evaluates one motion at times up to `t` and checks the general properties: finite numbers, unit
/// quaternion, constant energy and world momentum, and the start at time 0.
fn check(inertia: DVec3, l: DVec3, t: f64) {
    let start = DQuat::from_xyzw(0.1, -0.7, 0.1, 0.7);
    let motion = FreeRotation::new(inertia, start, l);
    for t in [0.0, 1e-9 * t, 0.3 * t, t, -0.7 * t] {
        let (q, m) = motion.at(t);
        let label = || format!("{inertia} {:?} at {t}: {q} {m}", l.to_array());
        assert!(q.is_finite() && m.is_finite(), "{}", label());
        assert!((q.length() - 1.0).abs() < 1e-15, "{}", label());
        // Sums of squares would underflow for the smallest.
        let scale = l.abs().max_element();
        let change = (q * (m / scale) - start * (l / scale)).length();
        assert!(change < 3e-15, "{change:e} {}", label());
        let (e, e0) = (energy(inertia, m / scale), energy(inertia, l / scale));
        assert!((e / e0 - 1.0).abs() < 1e-14, "{}", label());
        if t == 0.0 {
            assert!(angle(q, start) < 1e-15 && (m - l).length() <= 1e-15 * scale);
        }
    }
}

/// Euler's equations by a Taylor series of order 26 in 40 digits (mpmath), from q = 1: inertia,
/// body momentum, time, attitude. Phases up to 450 rad.
#[test]
fn hard_cases_to_rounding() {
    #[rustfmt::skip]
    let cases = [
        // tiny deviation about the middle axis: flips only after 40 s
        ([0.078125, 0.265625, 0.3125], [0.0, 2.0, 1e-100], 48.0, [3.468051883279515e-08, -0.997933160542902, -1.8985773425578433e-07, 0.06426046287428386]),
        ([0.078125, 0.265625, 0.3125], [1e-120, -2.0, 0.0], 60.0, [0.0022920930472019366, 0.3072643151316628, -0.0014284097748882279, 0.9516203794589774]),
        // next to the separatrix, on both sides
        ([0.078125, 0.265625, 0.3125], [0.3, 0.2, -1.1999999999988], 3.0, [0.6500378281974282, -0.46150164858054366, -0.39656388046322133, 0.4551968134573913]),
        ([0.078125, 0.265625, 0.3125], [0.3, 0.2, -1.2000000000000013], 3.0, [0.650037827915259, -0.4615016484682874, -0.3965638806374669, 0.4551968138223491]),
        // gaps from 1e-2 to one rounding unit
        ([1.0, 1.01, 0.5], [0.3, 0.7, 0.0001], 30.0, [-0.07490926684505972, -0.945521941244135, -0.08565700743388499, 0.305024158787676]),
        ([1.0, 1.01, 1.5], [0.3, 0.7, 0.01], 30.0, [-0.4499200687909744, -0.8286763889136689, 0.06517966681350564, 0.32652562715690026]),
        ([1.0, 1.00001, 0.5], [0.3, 0.7, 0.0001], 30.0, [-0.35923126710384856, -0.8358785551395947, 0.00034439933670986063, 0.4150419487013376]),
        ([1.0, 1.000000001, 1.5], [0.3, 0.7, 0.01], 30.0, [-0.3159628443595382, -0.8526123428480575, -0.032717033416554686, 0.4149087484396981]),
        ([1.0, 1.0000000000000002, 0.5], [0.3, 0.7, 1e-09], 200.0, [0.27123882439508956, 0.6328904154577, 7.342131728660301e-08, 0.7251753044351029]),
        // near a sphere
        ([1.0, 1.0000000000000002, 1.0000000000000004], [0.3, 0.7, 1.1], 30.0, [0.2105034794765455, 0.49117478544527776, 0.7718460914140038, 0.3445130279684328]),
        ([1.0, 1.000000001, 1.000000003], [0.3, 0.7, 1.1], 30.0, [0.21050346326777988, 0.49117479224781146, 0.7718460721503242, 0.344513071332143]),
        // tiny deviation about an extreme axis
        ([0.078125, 0.265625, 0.3125], [2.0, 1e-100, 1e-101], 10.0, [0.7210377105017316, -4.971800016523611e-102, -1.4776813284466823e-101, -0.6928958219201651]),
        ([0.078125, 0.265625, 0.3125], [1e-60, 1e-70, -2.0], 10.0, [4.754558314574191e-61, -6.86084804255687e-61, -0.5514266812416906, 0.8342233605065102]),
        // any scale
        ([7e-26, 2.6e-25, 3.1e-25], [1e-25, 6e-25, 3e-25], 5.0, [0.07599389762310572, 0.14567100668373678, 0.0731751267977864, -0.9836921704242255]),
    ];
    for (inertia, l, t, q) in cases {
        let l = DVec3::from_array(l);
        let motion = FreeRotation::new(DVec3::from_array(inertia), DQuat::IDENTITY, l);
        let (rotation, momentum) = motion.at(t);
        let error = angle(rotation, DQuat::from_array(q));
        assert!(error < 3e-13, "{inertia:?} {l:?}: {error:e}");
        assert!((rotation * momentum - l).length() < 1e-15 * l.length());
    }
}

/// On the separatrix exactly: `I = (3, 4, 6)` and `L_x² = L_z²`, with every choice of signs (the same Taylor
/// series, at 9 s).
#[test]
fn on_the_separatrix() {
    #[rustfmt::skip]
    let cases = [
        ([1.0, 0.5, 1.0], [0.4922023471184428, 0.6620835921813287, 0.5547812152682751, -0.10770315520364185]),
        ([1.0, 0.5, -1.0], [0.6490452586091989, -0.18275483310964, -0.7315652179299231, -0.10076336222620713]),
        ([-1.0, 0.5, 1.0], [-0.6490452586091989, -0.18275483310964, 0.7315652179299231, -0.10076336222620713]),
        ([-1.0, 0.5, -1.0], [-0.4922023471184428, 0.6620835921813287, -0.5547812152682751, -0.10770315520364185]),
        ([1.0, -0.5, 1.0], [0.6490452586091989, 0.18275483310964, 0.7315652179299231, -0.10076336222620713]),
        ([1.0, -0.5, -1.0], [0.4922023471184428, -0.6620835921813287, -0.5547812152682751, -0.10770315520364185]),
        ([-1.0, -0.5, 1.0], [-0.4922023471184428, -0.6620835921813287, 0.5547812152682751, -0.10770315520364185]),
        ([-1.0, -0.5, -1.0], [-0.6490452586091989, 0.18275483310964, -0.7315652179299231, -0.10076336222620713]),
    ];
    for (l, q) in cases {
        let l = DVec3::from_array(l);
        let motion = FreeRotation::new(DVec3::new(3.0, 4.0, 6.0), DQuat::IDENTITY, l);
        assert!(angle(motion.at(9.0).0, DQuat::from_array(q)) < 2e-15);
        // The motion tends to a spin about the middle axis and does not return.
        assert!(motion.at(1e3).1.abs().y / l.length() > 1.0 - 1e-15);
    }
}

/// The symmetric formula, `q₀∘exp(t L/I₁)∘exp(t (1/I₃ − 1/I₁) L₃ e₃)`, has an error of at most gap × phase if
/// the moments are not quite equal.
#[test]
fn nearly_symmetric_bodies_move_like_symmetric_ones() {
    let l = DVec3::new(0.3, 0.7, 0.9);
    for third in [0.5, 1.7, 1.0] {
        let symmetric = FreeRotation::new(DVec3::new(1.0, 1.0, third), DQuat::IDENTITY, l);
        for exponent in 6..53 {
            let gap = libm::exp2(-f64::from(exponent));
            for inertia in [
                DVec3::new(1.0 + gap, 1.0, third),
                DVec3::new(1.0, 1.0 + gap, third),
                DVec3::new(1.0, 1.0 + gap, third + 3.0 * gap),
            ] {
                check(inertia, l, 100.0);
                let (q, _) = FreeRotation::new(inertia, DQuat::IDENTITY, l).at(10.0);
                let error = angle(q, symmetric.at(10.0).0);
                assert!(error < 150.0 * gap + 1e-14, "{inertia} {error:e}");
            }
        }
    }
}

#[test]
fn vanishing_components() {
    let inertia = [0.078125, 0.265625, 0.3125];
    let sizes = [
        0.0, 1e-320, 1e-200, 1e-160, 1e-140, 1e-139, 1e-100, 1e-30, 1e-16, 1e-8,
    ];
    for axis in 0..3 {
        for (i, small) in sizes.iter().enumerate() {
            for (j, tiny) in sizes.iter().enumerate() {
                for sign in 0..8 {
                    let signed = |bit: i32, x: f64| if sign & bit == 0 { x } else { -x };
                    let mut l = [0.0; 3];
                    l[axis] = signed(1, 1.0);
                    l[(axis + 1) % 3] = signed(2, *small);
                    l[(axis + 2) % 3] = signed(4, *tiny);
                    let t = if (i + j) % 2 == 0 { 10.0 } else { 1e4 };
                    check(DVec3::from_array(inertia), DVec3::from_array(l), t);
                    check(DVec3::new(1.0, 1.0, 0.3), DVec3::from_array(l), t);
                    check(DVec3::ONE, DVec3::from_array(l), t);
                }
            }
        }
    }
}

/// D from 1e-2 to 0 from both sides: the motion tends to the separatrix within eps e^{λt}.
#[test]
fn toward_the_separatrix() {
    let inertia = DVec3::new(3.0, 4.0, 6.0);
    let (l, t) = (DVec3::new(1.0, 0.5, 1.0), 3.0);
    let limit = FreeRotation::new(inertia, DQuat::IDENTITY, l).at(t).0;
    for exponent in 3..54 {
        let gap = libm::exp2(-f64::from(exponent));
        for z in [1.0 + gap, 1.0 - 0.5 * gap] {
            for sign in [
                DVec3::ONE,
                -DVec3::ONE,
                DVec3::new(1.0, -1.0, 1.0),
                DVec3::new(-1.0, 1.0, 1.0),
            ] {
                check(inertia, sign * DVec3::new(1.0, 0.5, z), 200.0);
            }
            let near = DVec3::new(1.0, 0.5, z);
            let q = FreeRotation::new(inertia, DQuat::IDENTITY, near).at(t).0;
            assert!(
                angle(q, limit) < 3.0 * gap + 2e-15,
                "{gap:e} {:e}",
                angle(q, limit)
            );
        }
    }
}

/// If one turn is below the rounding of the phase, the attitude is arbitrary. It must still be a rotation with the
/// correct energy and momentum. (Fuzzing reached this by multiplying a momentum by 1e15.)
#[test]
fn phases_without_digits() {
    let inertia = DVec3::new(0.012087243, 0.004346205, 0.007978717);
    for l in [
        DVec3::new(-0.237301862, 0.092968379, -0.225268696),
        DVec3::new(0.3, 0.01, 0.02),
        DVec3::new(0.01, 0.3, 0.02),
        DVec3::new(0.01, 0.02, 0.3),
    ] {
        for power in 10..40 {
            check(inertia, l, 10.0_f64.powi(power));
        }
    }
}

#[test]
fn rest_and_invalid_input_are_harmless() {
    let inertia = DVec3::new(1.0, 2.0, 2.5);
    let rest = FreeRotation::new(inertia, DQuat::IDENTITY, DVec3::ZERO);
    assert_eq!(rest.at(1e9), (DQuat::IDENTITY, DVec3::ZERO));
    // A non-finite input gives a non-finite output, and the evaluation terminates.
    let (_, l) =
        FreeRotation::new(inertia, DQuat::IDENTITY, DVec3::new(1.0, f64::NAN, 0.0)).at(1.0);
    assert!(l.is_nan());
    // Phases of 1e12 rad: the angle has no digits left, but the other properties hold.
    check(inertia, DVec3::new(1.0, 2.0, 3.0), 1e12);
    check(inertia * 1e-24, DVec3::new(1.0, 2.0, 3.0) * 1e-22, 1e6);
    check(inertia * 1e24, DVec3::new(1.0, 2.0, 3.0) * 1e-300, 1e6);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Evaluating from a to b and then on equals evaluating from a. RK4 with small steps agrees.
    #[test]
    fn random_boxes(
        half in prop::array::uniform3(0.05_f64..2.0),
        spin in prop::array::uniform3(-1.0_f64..1.0),
        t1 in -10.0_f64..10.0,
        t2 in 0.5_f64..5.0,
    ) {
        let body = RigidBox::new(DVec3::from_array(half), 2.0).expect("valid");
        let start = BodyState::at_pose(DVec3::ZERO, compose(DQuat::from_xyzw(0.6, 0.0, 0.0, 0.8), DQuat::from_xyzw(0.0, 0.8, 0.0, 0.6)))
            .with_body_angular_velocity(&body, DVec3::from_array(spin));
        let inertia = body.inertia();
        check(inertia, start.angular_momentum, 50.0);
        let motion = FreeRotation::new(inertia, start.rotation, start.angular_momentum);
        let (q, l) = motion.at(t1);
        let (there, m) = FreeRotation::new(inertia, q, l).at(t2);
        let (direct, n) = motion.at(t1 + t2);
        // Rounding errors in L grow as e^{λt} near the separatrix.
        prop_assert!(angle(there, direct) < 1e-11);
        prop_assert!((m - n).length() < 1e-11 * n.length());

        let (mut state, mut memory) = (start, IntegratorMemory::default());
        for _ in 0..1000 {
            Integrator::Rk4.step(&body, &mut state, &Gravity(DVec3::ZERO), t2 / 1000.0, &mut memory);
        }
        prop_assert!(angle(state.rotation, motion.at(t2).0) < 1e-8);
    }
}
