type Vec3 = [Real; 3];
type Quat = [Real; 4];

fn dot(a: Vec3, b: Vec3) -> Real {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn product([x, y, z, w]: Quat, p: Quat) -> Quat {
    let i = w * p[0] + x * p[3] + y * p[2] - z * p[1];
    let j = w * p[1] + y * p[3] + z * p[0] - x * p[2];
    let k = w * p[2] + z * p[3] + x * p[1] - y * p[0];
    [i, j, k, w * p[3] - x * p[0] - y * p[1] - z * p[2]]
}

/// Attitude `q` (x, y, z, w; body to world) and momentum `l` (body axes) after the time `h`.
/// `inverse` holds 1/I of the three principal axes. All numbers are finite.
pub fn free_rotation(inverse: Vec3, q: Quat, l: Vec3, h: Real) -> (Quat, Vec3) {
    let [a, b, c] = inverse;
    let middle = a.min(b).max(a.max(b).min(c));
    let z = 0.5 * h;
    let j = inverse.map(|j| z * (j - middle));
    let g = [j[2] - j[1], j[0] - j[2], j[1] - j[0]];
    let w = [j[0] * l[0], j[1] * l[1], j[2] * l[2]];
    let (ll, e) = (dot(l, l), dot(w, l));
    let p1 = j[0] + j[1] + j[2];
    let p2 = 2.0 * (j[0] * j[1] + (j[0] + j[1]) * j[2]);
    if dot(w, w) - 0.5 * p2 * ll > 0.0225 {
        let (q, l) = free_rotation(inverse, q, l, z); // too long: two halves
        return free_rotation(inverse, q, l, z);
    }
    let d = [0, 1, 2].map(|i| g[i] * (j[i] * ll - e) / 3.0);
    let y = [d[2] - d[1], d[0] - d[2], d[1] - d[0]];
    let (c2, c3) = (dot(y, y) / 10.0, y[0] * y[1] * y[2] / 7.0);
    let (c4, c6) = (c2 * c2 / 3.0, c2 * c2 * c2 * 2.0 / 39.0 + c3 * c3 / 13.0);
    let (c5, c7) = (c2 * c3 * 3.0 / 11.0, c2 * c2 * c3 * 2.0 / 33.0);
    let p = y.map(|y| 1.0 + (c2 + c3 + c4 + c5 + c6 + c7) - y);
    let pp = [p[1] * p[2], p[2] * p[0], p[0] * p[1]];
    let root = (p[0] * pp[0]).sqrt();
    let b = [p[0] * g[0], p[1] * g[1], p[2] * g[2]];
    let m = [0, 1, 2].map(|i| root * l[i] + b[i] * l[(i + 1) % 3] * l[(i + 2) % 3]);
    let k = p[0] - g[1] * g[2] * l[0] * l[0];
    let r = root * ((p[0] * k) * (p[0] * k) - g[1] * g[2] * m[0] * m[0]);
    let d = [0, 1, 2].map(|i| b[i] * m[(i + 1) % 3] * m[(i + 2) % 3]);
    let small = ll / 16384.0 + Real::MIN_POSITIVE;
    let f = 2.0 * (p[0] * small - r * dot(l, d)) / (r * (small + dot(d, d)));
    let (a, b, u) = (p1 * e, p2 * ll, p2 * e * e);
    let s0 = b * (-2.0 / 45.0 + b * (1.0 / 378.0 + b * (-1.0 / 9450.0 + b / 534600.0)));
    let u0 = -19.0 / 1260.0 + b * (59.0 / 14175.0 - b * (1019.0 / 1871100.0));
    let s1 = b * (-4.0 / 189.0 + b * (1.0 / 315.0 - b * (131.0 / 467775.0)));
    let u1 = -19.0 / 2100.0 + b * (1676.0 / 467775.0);
    let s2 = 31.0 / 945.0 + b * (-4.0 / 315.0 + b * (379.0 / 155925.0)) - u * (1063.0 / 207900.0);
    let s3 = 127.0 / 9450.0 - b * (3032.0 / 467775.0) + a * (73.0 / 13365.0);
    let s1 = 7.0 / 90.0 + s1 + u * u1 + a * (s2 + a * s3);
    let delta = p2 * e * (1.0 / 6.0 + s0 + u * (u0 + u * (151.0 / 207900.0)) + a * s1);
    let t = [0, 1, 2].map(|i| (j[i] + delta) * pp[i] * m[i]);
    let angle = z * middle * ll.sqrt();
    let s = angle.sin() / ll.sqrt().max(Real::MIN_POSITIVE);
    let q = product(q, [s * l[0], s * l[1], s * l[2], angle.cos()]);
    let q = product(q, [t[0], t[1], t[2], p[0] * pp[0] * k]);
    let norm = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    (q.map(|q| q / norm), [0, 1, 2].map(|i| l[i] + f * d[i]))
}
