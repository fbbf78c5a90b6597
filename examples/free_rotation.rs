//! The torque-free rotation of a rigid body in code to copy, in f64 and f32, with its measured error: `step.rs` beside
//! this file. `docs/free-rotation.md` shows and explains it. `cargo run --release --example free_rotation`

#![expect(
    clippy::disallowed_methods,
    unreachable_pub,
    reason = "code to take home uses the standard library alone and is public"
)]

use box_physics::free_motion::FreeRotation;
use box_physics::prelude::*;

mod in_f64 {
    type Real = f64;
    include!("free_rotation/step.rs");
}

mod in_f32 {
    type Real = f32;
    include!("free_rotation/step.rs");
}

/// Largest attitude error \[rad\] over ten seconds in f64 and f32, against the closed form.
fn errors(half: DVec3, omega: DVec3, rate: u32) -> Result<(f64, f64), InvalidValue> {
    let body = RigidBox::new(half, 3.0)?;
    let j = body.inverse_inertia().to_array();
    let l = (body.inertia() * omega).to_array();
    let exact = FreeRotation::new(body.inertia(), DQuat::IDENTITY, DVec3::from_array(l));
    let h = 1.0 / f64::from(rate);
    // The f32 body has the f32 numbers as its moments; it is compared with its own exact motion.
    let (j32, l32) = (j.map(|x| x as f32), l.map(|x| x as f32));
    let near = DVec3::from_array(j32.map(f64::from)).recip();
    let exact32 = FreeRotation::new(near, DQuat::IDENTITY, DVec3::from_array(l32.map(f64::from)));
    let (mut q, mut m, mut q32, mut m32) = ([0.0, 0.0, 0.0, 1.0], l, [0.0, 0.0, 0.0, 1.0], l32);
    let mut worst = (0.0_f64, 0.0_f64);
    for n in 1..=10 * rate {
        (q, m) = in_f64::free_rotation(j, q, m, h);
        (q32, m32) = in_f32::free_rotation(j32, q32, m32, h as f32);
        // The f32 step is a little longer or shorter than h.
        let t32 = f64::from(n) * f64::from(h as f32);
        let wide = DQuat::from_array(q32.map(f64::from));
        worst.0 = worst
            .0
            .max(angle(exact.at(f64::from(n) * h).0, DQuat::from_array(q)));
        worst.1 = worst.1.max(angle(exact32.at(t32).0, wide));
    }
    Ok(worst)
}

fn angle(a: DQuat, b: DQuat) -> f64 {
    let d = a.conjugate() * b;
    2.0 * d.xyz().length().atan2(d.w.abs())
}

fn main() -> Result<(), InvalidValue> {
    let page = include_str!("../docs/free-rotation.md");
    assert!(
        page.contains(include_str!("free_rotation/step.rs").trim()),
        "docs/free-rotation.md shows other code"
    );
    println!("largest attitude error in 10 s [rad]");
    println!("motion      |ω|h     f64      f32");
    let brick = DVec3::new(0.5, 0.25, 0.125);
    let plate = DVec3::new(0.5, 1.0 / 128.0, 0.375);
    let needle = DVec3::new(1.0, 1.0 / 32.0, 1.0 / 64.0);
    for (name, half, omega, limits) in [
        ("box", brick, DVec3::new(1.5, 2.5, 1.0), (1e-12, 1.0)),
        ("plate", plate, DVec3::new(3.0, 0.5, 4.0), (1e-12, 1.0)),
        ("needle", needle, DVec3::new(20.0, 1.0, 0.5), (1e-9, 2.0)),
        (
            "flip",
            brick,
            DVec3::new(0.0078125, 8.0, -0.00390625),
            (1e-8, f64::INFINITY),
        ),
    ] {
        for rate in [30, 60, 120] {
            let (f64s, f32s) = errors(half, omega, rate)?;
            let turn = omega.length() / f64::from(rate);
            println!("{name:8} {turn:7.3}  {f64s:7.1e}  {f32s:7.1e}");
            // In f32 each step contributes one rounding unit. The needle turns by 200 rad. The flip amplifies every
            // rounding error until f32 cannot predict its time, so that column is printed without a bound.
            let rounding = f64::from(10 * rate) * f64::from(f32::EPSILON);
            assert!(
                f64s < limits.0 && f32s < limits.1 * rounding,
                "{name} at {rate} Hz"
            );
        }
    }
    Ok(())
}
