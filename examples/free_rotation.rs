//! The torque-free rotation of a rigid body as forty lines to copy, in f32 and f64, with its measured error.
//! `docs/free-rotation.md` explains it. `cargo run --release --example free_rotation`

#![expect(
    clippy::disallowed_methods,
    reason = "code to take home uses the standard library alone"
)]

use box_physics::free_motion::FreeRotation;
use box_physics::prelude::*;

macro_rules! free_rotation {
    ($name:ident, $real:ty) => {
        /// Attitude `q` (x, y, z, w; body to world) and angular momentum `l` (body axes) after `h`; `j` = 1/I.
        fn $name(
            j: [$real; 3],
            l: [$real; 3],
            q: [$real; 4],
            h: $real,
        ) -> ([$real; 4], [$real; 3]) {
            let middle = j[0].min(j[1]).max(j[0].max(j[1]).min(j[2])); // median of the three
            let z = 0.5 * h;
            let j = j.map(|j| z * (j - middle));
            let g = [j[2] - j[1], j[0] - j[2], j[1] - j[0]];
            let w = [j[0] * l[0], j[1] * l[1], j[2] * l[2]];
            let c = l[0] * l[0] + l[1] * l[1] + l[2] * l[2];
            let e = w[0] * l[0] + w[1] * l[1] + w[2] * l[2];
            let (p1, p2) = (
                j[0] + j[1] + j[2],
                2.0 * (j[0] * j[1] + (j[0] + j[1]) * j[2]),
            );
            if w[0] * w[0] + w[1] * w[1] + w[2] * w[2] - 0.5 * p2 * c > 0.0225 {
                let (q, l) = $name(j.map(|j| j / z + middle), l, q, z);
                return $name(j.map(|j| j / z + middle), l, q, z);
            }
            let d = [0, 1, 2].map(|i| g[i] * (j[i] * c - e) / 3.0);
            let y = [d[2] - d[1], d[0] - d[2], d[1] - d[0]];
            let (k2, k3) = (
                (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) / 10.0,
                y[0] * y[1] * y[2] / 7.0,
            );
            let wp = 1.0
                + k2
                + k3
                + k2 * k2 / 3.0
                + k2 * k3 * (3.0 / 11.0)
                + k2 * k2 * k2 * (2.0 / 39.0)
                + k3 * k3 / 13.0
                + k2 * k2 * k3 * (2.0 / 33.0);
            let p = y.map(|y| wp - y);
            let pp = [p[1] * p[2], p[2] * p[0], p[0] * p[1]];
            let root = (p[0] * pp[0]).sqrt();
            let b = [p[0] * g[0], p[1] * g[1], p[2] * g[2]];
            let m = [0, 1, 2].map(|i| root * l[i] + b[i] * l[(i + 1) % 3] * l[(i + 2) % 3]);
            let gg = g[1] * g[2];
            let common = p[0] - gg * l[0] * l[0];
            let pc = p[0] * common;
            let n = root * (pc * pc - gg * m[0] * m[0]);
            let d = [0, 1, 2].map(|i| b[i] * m[(i + 1) % 3] * m[(i + 2) % 3]);
            let dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            let ld = l[0] * d[0] + l[1] * d[1] + l[2] * d[2];
            let small = c / 16384.0 + <$real>::MIN_POSITIVE;
            let s = 2.0 * (p[0] * small - n * ld) / (n * (small + dd));
            let (x, b2, u) = (p1 * e, p2 * c, p2 * e * e);
            let s0 = 1.0 / 6.0
                + b2 * (-2.0 / 45.0 + b2 * (1.0 / 378.0 + b2 * (-1.0 / 9450.0 + b2 / 534600.0)))
                + u * (-19.0 / 1260.0
                    + b2 * (59.0 / 14175.0 - b2 * (1019.0 / 1871100.0))
                    + u * (151.0 / 207900.0));
            let s1 = 7.0 / 90.0
                + b2 * (-4.0 / 189.0 + b2 * (1.0 / 315.0 - b2 * (131.0 / 467775.0)))
                + u * (-19.0 / 2100.0 + b2 * (1676.0 / 467775.0));
            let s2 = 31.0 / 945.0 + b2 * (-4.0 / 315.0 + b2 * (379.0 / 155925.0))
                - u * (1063.0 / 207900.0);
            let s3 = 127.0 / 9450.0 - b2 * (3032.0 / 467775.0);
            let delta = p2 * e * (s0 + x * (s1 + x * (s2 + x * (s3 + x * (73.0 / 13365.0)))));
            let turn = [
                (j[0] + delta) * pp[0] * m[0],
                (j[1] + delta) * pp[1] * m[1],
                (j[2] + delta) * pp[2] * m[2],
                p[0] * pp[0] * common,
            ];
            let (half, angle) = (z * middle, z * middle * c.sqrt());
            let sinc = if angle == 0.0 {
                half
            } else {
                half * angle.sin() / angle
            };
            let spin = [sinc * l[0], sinc * l[1], sinc * l[2], angle.cos()];
            let times = |q: [$real; 4], p: [$real; 4]| {
                [
                    q[3] * p[0] + q[0] * p[3] + q[1] * p[2] - q[2] * p[1],
                    q[3] * p[1] + q[1] * p[3] + q[2] * p[0] - q[0] * p[2],
                    q[3] * p[2] + q[2] * p[3] + q[0] * p[1] - q[1] * p[0],
                    q[3] * p[3] - q[0] * p[0] - q[1] * p[1] - q[2] * p[2],
                ]
            };
            let q = times(times(q, spin), turn);
            let norm = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
            (q.map(|q| q / norm), [0, 1, 2].map(|i| l[i] + s * d[i]))
        }
    };
}

free_rotation!(free_rotation_f64, f64);
free_rotation!(free_rotation_f32, f32);

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
        (q, m) = free_rotation_f64(j, m, q, h);
        (q32, m32) = free_rotation_f32(j32, m32, q32, h as f32);
        // The f32 step is slightly longer or shorter than h.
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
