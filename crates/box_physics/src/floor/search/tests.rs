use super::*;

fn search(start: f64, rate: f64, time: f64, curvature: f64) -> Search<8> {
    Search {
        watch: 1,
        start: [start; 8],
        rate: [rate; 8],
        end_rate: [f64::NAN; 8],
        time,
        curvature,
        tolerance: 1e-12,
        dip: 1e-9,
        highest: 2.0,
        budget: 2000,
    }
}

/// The time of the first touch, the number of segments, and `true` if the search was capped.
fn touch(search: &Search<8>, height: impl Fn(f64) -> f64) -> (f64, u32, bool) {
    let (mut whole, mut other) = (search.time, f64::NAN);
    let mut segments = 1;
    let (tau, segment, capped) = search.run(
        &mut whole,
        [height(search.time); 8],
        &mut other,
        |t, segment| {
            segments += 1;
            *segment = t;
            [height(t); 8]
        },
    );
    assert_eq!(*segment, tau, "the segment is the one to that time");
    (tau, segments, capped)
}

#[test]
fn the_first_root_is_found_sharply_and_cheaply() {
    let (tau, segments, _) = touch(&search(1.0, 0.0, 1.0, 0.0), |t| 1.0 - 4.905 * t * t);
    assert!((tau - (1.0_f64 / 4.905).sqrt()).abs() < 1e-12);
    assert!(segments <= 3, "{segments}");
}

/// The height has derivatives of every order, and the corner turns by more than a radian.
#[test]
fn a_turning_corner_is_found_in_a_few_segments() {
    let height = |t: f64| 0.3 - t - 0.5 * libm::sin(2.0 * t);
    let (tau, segments, _) = touch(&search(0.3, -2.0, 0.7, 2.0), height);
    assert!(height(tau).abs() <= 1e-12);
    assert!(segments <= 6, "{segments}");
}

/// Bisection finds a jump, as when friction sticks or slips depending on the length of the segment.
#[test]
fn a_jump_is_found_as_well() {
    let height = |t: f64| if t < 0.3 { 0.5 } else { -0.5 };
    let (tau, segments, _) = touch(&search(0.5, 0.0, 1.0, 0.0), height);
    assert!((tau - 0.3).abs() < 1e-15);
    assert!(segments <= 60 * PATIENCE as u32, "{segments}");
}

/// A height that jumps below the floor at once, or is not a number, ends the search like any other.
#[test]
fn a_jump_at_the_very_start_ends_the_search() {
    for below in [-1.0, f64::NAN] {
        let height = |t: f64| if t == 0.0 { 0.5 } else { below };
        let mut s = search(0.5, 0.0, 1.0, 0.0);
        for time in [1.0, 1e-300, f64::from_bits(1)] {
            s.time = time;
            let (tau, segments, _) = touch(&s, height);
            assert!(tau <= time && segments <= 1 + LONGEST as u32, "{segments}");
        }
    }
}

#[test]
fn a_dip_between_two_good_ends_is_found() {
    // A corner of radius 1 turns at 40 rad/s: it is high at both ends and below in between.
    let height = |t: f64| 0.9 + libm::cos(40.0 * t);
    let time = core::f64::consts::TAU / 40.0;
    let (tau, _, capped) = touch(&search(height(0.0), 0.0, time, 1600.0), height);
    assert!((tau - libm::acos(-0.9) / 40.0).abs() < 1e-12 && !capped);
}

/// The search gives up immediately, not after the whole budget, on a wheel that turns a million times. It can follow a
/// wheel that turns a hundred times.
#[test]
fn what_cannot_be_followed_is_given_up_at_once() {
    let wheel = |omega: f64| {
        let height = move |t: f64| 1.1 + libm::cos(omega * t);
        let mut s = search(height(0.0), 0.0, 1.0, omega * omega);
        s.highest = 2.1;
        touch(&s, height)
    };
    let (tau, segments, capped) = wheel(1e6 * core::f64::consts::TAU);
    assert!(tau == 1.0 && segments == 1 && capped);
    let (tau, segments, capped) = wheel(100.0 * core::f64::consts::TAU);
    assert!(tau == 1.0 && segments > 100 && !capped);
}

#[test]
fn a_start_on_the_floor_is_not_a_touch() {
    let height = |t: f64| t - 4.0 * t * t;
    let (tau, ..) = touch(&search(0.0, 1.0, 1.0, 0.0), height);
    assert!((tau - 0.25).abs() < 1e-12);
    assert_eq!(touch(&search(0.0, 1.0, 0.2, 0.0), height).0, 0.2);
}
