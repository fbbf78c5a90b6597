//! Many bodies in a table, each under separate forces: the results have the bits of the core, body by body.

use super::*;

/// A torque, a point force, a spring, a damped spring or no force, in turns; the numbers differ for every `i`.
fn forces(i: usize) -> (ExternalForce, PointForces, Springs) {
    let of = |kind: usize| i % 5 == kind;
    let size = 0.1 * i as f64;
    let torque = ExternalForce {
        torque: DVec3::Z * size,
        ..ExternalForce::default()
    };
    let point = PointForce {
        body_point: DVec3::X * 0.5,
        force: DVec3::Y * size,
        frame: if i.is_multiple_of(2) {
            Frame::World
        } else {
            Frame::Body
        },
    };
    let spring = Spring {
        body_point: DVec3::Y * 0.25,
        anchor: DVec3::Y * 49.0,
        stiffness: 20.0 * size,
        damping: if of(4) { 0.5 } else { 0.0 },
    };
    (
        if of(1) {
            torque
        } else {
            ExternalForce::default()
        },
        PointForces(if of(2) { vec![point] } else { Vec::new() }),
        Springs(if of(3) || of(4) {
            vec![spring]
        } else {
            Vec::new()
        }),
    )
}

/// Fewer and more bodies than the plugin steps together, in free flight and mixed with boxes at the floor.
#[test]
fn a_group_under_forces_has_the_bits_of_single_bodies() {
    for &integrator in Integrator::ALL {
        for (n, at_floor) in [(9, false), (40, false), (100, true)] {
            let mut app = app();
            app.insert_resource(GlobalIntegrator(integrator));
            if at_floor {
                app.insert_resource(Floor::default());
            }
            let flying = |i: usize| !at_floor || i % 30 != 7;
            let bodies: Vec<_> = (0..n)
                .map(|i| {
                    let resting = BodyState::at(DVec3::Y * 0.25);
                    let state = if flying(i) { tumbling() } else { resting };
                    app.spawn((brick(), state, forces(i)))
                })
                .collect();
            app.play(10);
            for i in (0..n).filter(|&i| flying(i)) {
                let (external, points, springs) = forces(i);
                let law = Forces {
                    acceleration: WEIGHT.0,
                    world_torque: external.torque,
                    point_forces: &points.0,
                    springs: &springs.0,
                    ..Forces::default()
                };
                let mut expected = tumbling();
                core(integrator, &mut expected, &law, 10);
                assert_eq!(app.state(bodies[i]), expected, "{integrator}: {i} of {n}");
            }
        }
    }
}
