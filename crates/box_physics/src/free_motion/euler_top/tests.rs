use super::super::tests::angle;
use super::*;
use proptest::prelude::*;

const CUBE: DVec3 = DVec3::ONE;

fn body(inertia: DVec3) -> RigidBox {
    let cube = RigidBox::new(CUBE, 1.0).expect("valid");
    cube.with_inertia(inertia).expect("valid")
}

/// Errors of attitude \[rad\] and momentum (relative) with respect to `reference`.
fn difference(state: &BodyState, reference: (DQuat, DVec3)) -> (f64, f64) {
    let l = reference.1;
    (
        angle(state.rotation, reference.0),
        (state.angular_momentum - l).length() / l.length().max(1e-300),
    )
}

/// Euler's equations by a Taylor series of order 50 in 40 digits (mpmath), from q = 1: inertia, body momentum,
/// time, attitude, momentum. One step each.
#[test]
fn hard_cases_to_rounding() {
    #[rustfmt::skip]
    let cases = [
        // ordinary
        ([0.078125, 0.265625, 0.3125], [0.1171875, 0.6640625, 0.3125], 0.015625, [0.011625805922158042, 0.019609084132354404, 0.007675665566669531, 0.9997106624490204], [0.1153812797161453, 0.6694178078827892, 0.30155451056644106]),
        // fast, in one map
        ([0.078125, 0.265625, 0.3125], [0.703125, 3.984375, 1.875], 0.015625, [0.06674177495828164, 0.11946926736249903, 0.04203828909401758, 0.9896996574119512], [0.6427765205778536, 4.154038639004828, 1.4886420780358016]),
        // needle, about its axis
        ([0.001220703125, 1.000244140625, 1.0009765625], [0.0244140625, 1.000244140625, 0.50048828125], 0.015625, [0.15559432027661366, 0.00832494371707615, 0.0026455031034273006, 0.9877824173992448], [0.024409999718179597, 1.105600254875595, 0.16918964301562772]),
        // needle, across its axis, in parts
        ([0.001220703125, 1.000244140625, 1.0009765625], [0.3662109375, 40.009765625, -20.01953125], 0.015625, [0.6686136704981603, -0.32366908666001654, -0.11116820912947654, -0.6601785449729438], [0.3677087099158373, 19.26907216703895, 40.376536941818074]),
        // plate
        ([0.14068603515625, 0.390625, 0.25006103515625], [0.42205810546875, 0.1953125, 1.000244140625], 0.03125, [0.04732783212360985, 0.008644011428309563, 0.062052881470793526, 0.9969126327186743], [0.4317053249264352, 0.2365201062324158, 0.9871459414294996]),
        // disc: two equal moments
        ([2.0, 1.0, 1.0], [6.0, 4.0, -5.0], 0.03125, [0.04693579956101061, 0.06588523526803357, -0.07487545960774065, 0.9939063497341055], [6.0, 4.450498402009571, -4.603592507347957]),
        // nearly symmetric
        ([2.0, 1.0, 1.0000000009313226], [6.0, 4.0, -5.000000004656613], 0.03125, [0.04693579956316566, 0.06588523526490206, -0.07487545961065854, 0.9939063497339915], [6.000000000590914, 4.450498401628792, -4.603592512003503]),
        // nearly a cube
        ([1.0, 1.0000000000009095, 0.9999999999995453], [3.0, 4.000000000003638, -4.999999999997726], 0.25, [0.3280441269279835, 0.4373921692380112, -0.5467402115473415, 0.6341532008548819], [2.999999999993179, 4.000000000005343, -5.000000000000455]),
        // edge of the triangle inequality
        ([1.25, 0.25, 1.0], [6.25, -1.5, 7.0], 0.03125, [0.08451454448319376, -0.10137225989979623, 0.10068501666747547, 0.9861254910569327], [7.241317161369008, -1.7724591999354515, 5.89357397111692]),
        // middle axis, next to the separatrix
        ([0.078125, 0.265625, 0.3125], [7.8125e-11, 5.3125, -3.125e-11], 0.03125, [1.5710800099924836e-11, 0.30743851458038085, -4.57735898666893e-12, 0.9515679480481722], [8.668167605437096e-11, 5.3125, -1.534265945575229e-10]),
        // on the separatrix
        ([3.0, 4.0, 6.0], [12.0, 0.0, 12.0], 0.0625, [0.12430999670629311, 0.005832737528465797, 0.06245910375041816, 0.9902584835539153], [11.953277104636907, 1.4961059185519663, 11.953277104636907]),
        // backward
        ([0.078125, 0.265625, 0.3125], [0.703125, -3.984375, 1.875], -0.015625, [-0.06674177495828164, 0.11946926736249903, -0.04203828909401758, 0.9896996574119512], [0.6427765205778536, -4.154038639004828, 1.4886420780358016]),
        // 14 turns, by the closed form
        ([0.078125, 0.265625, 0.3125], [0.1171875, 0.6640625, 0.3125], 8.0, [0.3547008882865882, 0.1393058856522928, -0.8946288652629225, -0.23328168275651465], [0.08984263137224714, -0.7329526612001479, 0.08412408745556628]),
        // 28 turns
        ([0.078125, 0.265625, 0.3125], [0.1171875, 0.6640625, 0.3125], 16.0, [0.2685746090192629, -0.7256509752583834, 0.15041492108267177, 0.6153646829420752], [0.15689727997943223, 0.5059185869865289, -0.5213422972856793]),
    ];
    for (inertia, l, h, q, momentum) in cases {
        let b = body(DVec3::from_array(inertia));
        let mut state = BodyState {
            angular_momentum: DVec3::from_array(l),
            ..BodyState::default()
        };
        let turn = state.body_angular_velocity(&b).length() * f64::abs(h);
        free_rotation(&b, &mut state, h);
        let reference = (DQuat::from_array(q), DVec3::from_array(momentum));
        let (attitude, momentum) = difference(&state, reference);
        // The reciprocal of a moment is rounded, so the angle has that relative error.
        let bound = 1e-15 * (1.0 + turn);
        assert!(attitude < bound, "{inertia:?}, {h}: {attitude:e} rad");
        assert!(momentum < bound, "{inertia:?}, {h}: {momentum:e}");
    }
}

/// Truncation error of order 13 in one step, beyond the range of the map: order 12.
#[test]
fn the_order_shows_beyond_the_range() {
    let b = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
    let l = b.inertia() * DVec3::new(1.2, 0.9, 4.0);
    let j = b.inverse_inertia() - DVec3::splat(b.splitting().reference);
    let error = |h: f64| {
        let spin = exponential_map_by((h * b.splitting().reference) * l, &mut AnyArgument);
        let (q, m) = Map::new(j, l, h).apply(spin, l);
        let exact = FreeRotation::new(b.inertia(), DQuat::IDENTITY, l).at(h);
        // Exact for any truncation.
        assert!((q * m - l).length() < 2e-15 * l.length());
        let energy = |l: DVec3| l.dot(b.inverse_inertia() * l);
        assert!((energy(m) / energy(l) - 1.0).abs() < 3e-15);
        angle(q, exact.0)
    };
    let (coarse, fine) = (error(0.2), error(0.15));
    let slope = libm::log(coarse / fine) / libm::log(0.2 / 0.15);
    assert!((slope - 13.0).abs() < 0.5, "{slope} ({coarse:e}, {fine:e})");
}

/// The error has no jump where one method of stepping replaces another.
#[test]
fn no_jump_between_methods() {
    let b = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid");
    let l = b.inertia() * DVec3::new(1.5, 2.5, 1.0);
    let j = b.inverse_inertia() - DVec3::splat(b.splitting().reference);
    let limit = (LARGEST / Map::new(j, l, 1.0).size).sqrt();
    // At its limit the map has an error of a few 1e-15 for this body.
    for parts in [1.0, 2.0, 3.0, 5.0, 8.0] {
        for h in [limit * parts * 0.999_999, limit * parts * 1.000_001] {
            let mut state = BodyState {
                angular_momentum: l,
                ..BodyState::default()
            };
            free_rotation(&b, &mut state, h);
            let exact = FreeRotation::new(b.inertia(), DQuat::IDENTITY, l).at(h);
            let (attitude, momentum) = difference(&state, exact);
            let bound = 2e-15 * (1.0 + parts);
            assert!(
                attitude < bound && momentum < bound,
                "{h}: {attitude:e} {momentum:e}"
            );
        }
    }
}

/// Over a million steps, energy, |L| and world momentum change by rounding alone, without a trend: slow, fast,
/// about the long axis of a needle, in parts and by the closed form.
#[test]
fn a_million_steps() {
    let needle = [1.0, 1.0 / 32.0, 1.0 / 64.0];
    for (half, omega, h) in [
        ([0.5, 0.25, 0.125], [1.5, 2.5, 1.0], 1.0 / 60.0),
        ([0.5, 1.0 / 128.0, 0.375], [3.0, 0.5, 4.0], 1.0 / 60.0),
        (
            [0.5, 0.25, 0.125],
            [0.0078125, 8.0, -0.00390625],
            1.0 / 60.0,
        ),
        (needle, [20.0, 1.0, 0.5], 1.0 / 60.0),
        ([1.0, 0.05, 0.04], [18.0, 2.0, 1.0], 1.0 / 60.0),
        ([0.03, 1.0, 0.02], [0.7, 17.0, 0.3], 1.0 / 60.0),
        ([0.03, 0.02, 1.0], [0.7, 0.9, 19.0], 1.0 / 60.0),
        ([0.3, 0.1, 0.11], [15.0, 3.0, 2.0], 1.0 / 60.0),
        ([0.5, 0.25, 0.125], [0.015, 0.025, 0.01], 1.0 / 60.0),
        (needle, [20.0, 1.0, 0.5], 0.05),
        (needle, [20.0, 1.0, 0.5], 0.25),
    ] {
        let b = RigidBox::new(DVec3::from_array(half), 3.0).expect("valid");
        let start = BodyState::default().with_body_angular_velocity(&b, DVec3::from_array(omega));
        let mut state = start;
        for _ in 0..1_000_000 {
            free_rotation(&b, &mut state, h);
        }
        let energy = state.rotational_energy(&b) / start.rotational_energy(&b) - 1.0;
        let l = start.angular_momentum_world();
        let drift = (state.angular_momentum_world() - l).length() / l.length();
        assert!(
            energy.abs() < 1e-12 && drift < 1e-12,
            "{half:?} {h}: {energy:e} {drift:e}"
        );
        assert!((state.rotation.length() - 1.0).abs() < 4e-16);
    }
}

/// The smallest and the largest boxes and momenta that a body may have.
#[test]
fn extreme_scales() {
    for (size, mass) in [(1e-6, 1e-12), (1e-6, 1e12), (1e6, 1e-12), (1e6, 1e12)] {
        let b = RigidBox::new(DVec3::new(1.0, 0.4, 0.2) * size, mass)
            .or_else(|_| RigidBox::new(DVec3::new(1.0, 2.5, 5.0) * size, mass));
        let b = b.expect("valid");
        let unit = b.inertia() * DVec3::new(1.5, 2.5, 1.0);
        for factor in [1e-30, 1e-10, 1.0, 1e10, 1e38 / unit.max_element().max(1.0)] {
            // The turns are the same at any scale.
            let l = unit * factor;
            for h in [0.01 / factor, -0.3 / factor, 5.0 / factor] {
                let mut state = BodyState {
                    angular_momentum: l,
                    ..BodyState::default()
                };
                free_rotation(&b, &mut state, h);
                let exact = FreeRotation::new(b.inertia(), DQuat::IDENTITY, l).at(h);
                let (attitude, momentum) = difference(&state, exact);
                assert!(
                    attitude < 3e-14 && momentum < 3e-14,
                    "{size} {mass} {factor:e} {h:e}: {attitude:e} {momentum:e}"
                );
            }
        }
        let mut rest = BodyState::default();
        free_rotation(&b, &mut rest, 1.0);
        assert_eq!(rest, BodyState::default());
    }
}

#[test]
fn non_finite_input_stays_invalid_and_terminates() {
    let b = RigidBox::default();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut state = BodyState {
            angular_momentum: DVec3::new(1.0, bad, 0.0),
            ..BodyState::default()
        };
        free_rotation(&b, &mut state, 1.0);
        assert!(!state.is_valid());
    }
}

fn inertia() -> impl Strategy<Value = DVec3> {
    // Moments a = y + z, …, where x, y, z ≥ 0 are the sums of squares along the axes. One may be 0 (a
    // disc or rod at the edge of the triangle inequality); two may be equal or nearly so.
    let squares = prop::array::uniform3(prop_oneof![
        4 => 0.001..1.0_f64,
        1 => Just(0.25),
        1 => (-50..-20_i32).prop_map(|k| 0.25 + libm::exp2(f64::from(k))),
        1 => Just(1e-6),
    ]);
    let edge = (0.01..1.0_f64, 0.01..1.0_f64, 0..3_usize).prop_map(|(a, b, k)| {
        let mut i = [a, b, a + b];
        i.rotate_left(k);
        i
    });
    prop_oneof![
        4 => squares.prop_map(|[x, y, z]| DVec3::new(y + z, z + x, x + y)),
        1 => edge.prop_map(DVec3::from_array),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Any body, spin and step agrees with the closed form (an independent derivation by theta
    /// functions), and a step back returns to the start.
    #[test]
    fn agrees_with_the_closed_form(
        inertia in inertia(),
        direction in prop::array::uniform3(-1.0..1.0_f64),
        turn in prop_oneof![0.001..0.5_f64, 0.5..40.0_f64, Just(1e-9)],
        back in any::<bool>(),
    ) {
        let b = body(inertia);
        let omega = DVec3::from_array(direction);
        prop_assume!(omega.length() > 1e-3);
        let l = inertia * omega;
        let h = if back { -turn } else { turn } / omega.length();
        let start = BodyState {
            rotation: exponential_map_by(DVec3::new(0.3, -1.0, 0.5), &mut AnyArgument),
            angular_momentum: l,
            ..BodyState::default()
        };
        let mut state = start;
        free_rotation(&b, &mut state, h);
        let exact = FreeRotation::new(inertia, start.rotation, l).at(h);
        let (attitude, momentum) = difference(&state, exact);
        // The momentum may be large compared with I_min ω. Its rounding is then a turn of the thin axis.
        // Over a long step near the separatrix, rounding grows by e^(λh).
        let ratio = inertia.max_element() / inertia.min_element();
        let growth = (b.splitting().alpha * b.splitting().beta).abs().sqrt() * l.length() * turn / omega.length();
        let bound = 2e-14 * (1.0 + turn) * ratio.min(1e3) * crate::math::exp(growth.min(25.0));
        prop_assert!(attitude < bound && momentum < bound, "{attitude:e} {momentum:e} {bound:e}");
        let world = (state.angular_momentum_world() - start.angular_momentum_world()).length();
        prop_assert!(world < 1e-14 * l.length());
        let energy = state.rotational_energy(&b) / start.rotational_energy(&b) - 1.0;
        prop_assert!(energy.abs() < 1e-14 * ratio.max(1.0), "{energy:e}");
        free_rotation(&b, &mut state, -h);
        let (attitude, momentum) = difference(&state, (start.rotation, l));
        prop_assert!(attitude < bound && momentum < bound, "back: {attitude:e} {momentum:e} {bound:e}");
    }
}
