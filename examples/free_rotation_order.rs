//! Order 8, 10 or 12: the free rotation of `split` with its two series cut off earlier. Prints the error of one step
//! against |ω|h, and the cost in SIMD lanes. `cargo run --release --example free_rotation_order`

use std::time::Instant;

use box_physics::force::Gravity;
use box_physics::free_motion::FreeRotation;
use box_physics::integrators::{
    GravityField, Group, Integrate, IntegratorInfo, MemorySlot, Rk4, Split,
};
use box_physics::math::Trigonometry;
use box_physics::prelude::*;
use box_physics::rotation::compose;
use box_physics::translation::exponential_step;

/// `split` in free flight with δ to degree `N`: order 2N + 4, as a single map at any |ω|h.
struct Cut<const N: usize>;

impl<const N: usize> Integrate for Cut<N> {
    const INFO: IntegratorInfo = Split::INFO;
    type Memory = ();

    #[inline(always)]
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        _memory: &mut MemorySlot<'_, Self>,
        trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome {
        exponential_step(state, force.acceleration(), 0.0, h);
        free_rotation::<N>(body, state, h, trigonometry);
        StepOutcome::plain(1)
    }
}

/// The step of `docs/free-rotation.md`, without its limit.
#[inline(always)]
fn free_rotation<const N: usize>(
    body: &RigidBox,
    state: &mut BodyState,
    h: f64,
    trigonometry: &mut impl Trigonometry,
) {
    let (inverse, momentum) = (body.inverse_inertia(), state.angular_momentum);
    let (x, y) = (inverse.x, inverse.y);
    let middle = x.min(y).max(x.max(y).min(inverse.z));
    let (l, z) = (momentum.to_array(), 0.5 * h);
    let j = ((inverse - DVec3::splat(middle)) * z).to_array();
    let g = [j[2] - j[1], j[0] - j[2], j[1] - j[0]];
    let c = momentum.length_squared();
    let e = (j[0] * l[0] * l[0] + j[1] * l[1] * l[1]) + j[2] * l[2] * l[2];
    let d = [0, 1, 2].map(|i| g[i] * (j[i] * c - e) * (1.0 / 3.0));
    let y = [d[2] - d[1], d[0] - d[2], d[1] - d[0]];
    let w = weierstrass::<N>(y);
    let p = y.map(|y| w - y);
    let pp = [p[1] * p[2], p[2] * p[0], p[0] * p[1]];
    let product = p[0] * pp[0];
    let root = product.sqrt();
    let b = [p[0] * g[0], p[1] * g[1], p[2] * g[2]];
    let m = [0, 1, 2].map(|i| root * l[i] + b[i] * l[(i + 1) % 3] * l[(i + 2) % 3]);
    let gg = g[1] * g[2];
    let common = p[0] - gg * (l[0] * l[0]);
    let r = root * ((p[0] * common) * (p[0] * common) - gg * (m[0] * m[0]));
    let d = DVec3::from_array([0, 1, 2].map(|i| b[i] * m[(i + 1) % 3] * m[(i + 2) % 3]));
    let p1 = j[0] + j[1] + j[2];
    let p2 = 2.0 * (j[0] * j[1] + (j[0] + j[1]) * j[2]);
    let delta = p2 * e * precession::<N>(p1 * e, p2 * c, p2 * e * e);
    let turn = [0, 1, 2].map(|i| (j[i] + delta) * pp[i] * m[i]);
    let turn = DQuat::from_xyzw(turn[0], turn[1], turn[2], product * common);
    let half = (z * middle) * momentum;
    let (sinc, cos) = trigonometry.sinc_cos(half.length_squared());
    let spin = DQuat::from_xyzw(sinc * half.x, sinc * half.y, sinc * half.z, cos);
    let q = compose(compose(state.rotation, spin), turn);
    // One division for both results.
    let (norm, small) = (q.length(), c * (1.0 / 16384.0) + f64::MIN_POSITIVE);
    let divisor = r * (d.length_squared() + small);
    let reciprocal = 1.0 / (divisor * norm);
    let f = 2.0 * (p[0] * small - r * momentum.dot(d)) * (reciprocal * norm);
    state.rotation = q * (reciprocal * divisor);
    state.angular_momentum = momentum + d * f;
}

/// `low`, plus `high` if that belongs to the series of degree `N`.
#[inline(always)]
fn add<const N: usize>(degree: usize, low: f64, high: f64) -> f64 {
    if N >= degree { low + high } else { low }
}

#[inline(always)]
fn weierstrass<const N: usize>(y: [f64; 3]) -> f64 {
    let c2 = (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) * 0.1;
    let c3 = (y[0] * y[1]) * (y[2] * (1.0 / 7.0));
    let c22 = c2 * c2;
    let to_c5 = (c2 + c3) + (c22 * (1.0 / 3.0) + (c2 * c3) * (3.0 / 11.0));
    let c6 = (c22 * c2) * (2.0 / 39.0) + (c3 * c3) * (1.0 / 13.0);
    let c7 = (c22 * c3) * (2.0 / 33.0);
    1.0 + add::<N>(4, add::<N>(3, to_c5, c6), c7)
}

#[inline(always)]
fn precession<const N: usize>(a: f64, b: f64, q: f64) -> f64 {
    let b4 = add::<N>(4, -1.0 / 9450.0, b * (1.0 / 534600.0));
    let b3 = add::<N>(3, 1.0 / 378.0, b * b4);
    let b2 = add::<N>(2, -2.0 / 45.0, b * b3);
    let qb = add::<N>(4, 59.0 / 14175.0, b * (-1019.0 / 1871100.0));
    let q1 = add::<N>(3, -19.0 / 1260.0, b * qb);
    let q2 = add::<N>(4, q1, q * (151.0 / 207900.0));
    let s0 = add::<N>(2, add::<N>(1, 1.0 / 6.0, b * b2), q * q2);
    let b3 = add::<N>(4, 1.0 / 315.0, b * (-131.0 / 467775.0));
    let b2 = add::<N>(3, -4.0 / 189.0, b * b3);
    let q1 = add::<N>(4, -19.0 / 2100.0, b * (1676.0 / 467775.0));
    let s1 = add::<N>(3, add::<N>(2, 7.0 / 90.0, b * b2), q * q1);
    let b2 = add::<N>(4, -4.0 / 315.0, b * (379.0 / 155925.0));
    let s2 = add::<N>(3, 31.0 / 945.0, b * b2);
    let s2 = add::<N>(4, s2, q * (-1063.0 / 207900.0));
    let s3 = add::<N>(
        4,
        127.0 / 9450.0,
        b * (-3032.0 / 467775.0) + a * (73.0 / 13365.0),
    );
    let s2 = add::<N>(3, s2, a * s3);
    let s1 = add::<N>(2, s1, a * s2);
    add::<N>(1, s0, a * s1)
}

/// Random numbers, uniform in 0 to 1, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn in_range(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }
}

const BODIES: usize = 1000;

/// Kinds of bodies: moments of inertia, up to a factor.
const KINDS: [(&str, fn(&mut Random) -> DVec3); 4] = [
    ("boxes, sides 0.2 to 0.5", |random| {
        solid([(); 3].map(|()| random.in_range(0.2, 0.5)))
    }),
    ("boxes, sides 0.1 to 10", |random| {
        solid([(); 3].map(|()| 0.1 * libm::pow(100.0, random.next())))
    }),
    ("needles, 1 by 0.05 by 0.02 to 0.05", |random| {
        solid([1.0, 0.05, random.in_range(0.02, 0.05)])
    }),
    ("edge of the triangle inequality", |random| {
        let (a, b) = (random.in_range(0.1, 1.0), random.in_range(0.1, 1.0));
        DVec3::new(a, b, a + b)
    }),
];

fn solid([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(y * y + z * z, z * z + x * x, x * x + y * y)
}

/// Bodies, each with a spin of 1 rad/s in a random direction.
fn bodies(
    inertia: fn(&mut Random) -> DVec3,
) -> Result<(Vec<RigidBox>, Vec<BodyState>), InvalidValue> {
    let mut random = Random(17);
    let mut all = (Vec::new(), Vec::new());
    for _ in 0..BODIES {
        let body = RigidBox::default().with_inertia(inertia(&mut random))?;
        let direction = [(); 3].map(|()| random.in_range(-1.0, 1.0));
        let omega = DVec3::from_array(direction).normalize_or(DVec3::X);
        all.0.push(body);
        all.1
            .push(BodyState::default().with_body_angular_velocity(&body, omega));
    }
    Ok(all)
}

/// Median and largest attitude error \[rad\] of one step of `turn` = |ω|h.
fn errors<S: Integrate>(bodies: &[RigidBox], states: &[BodyState], turn: f64) -> (f64, f64) {
    let error = |(body, start): (&RigidBox, &BodyState)| {
        let mut state = *start;
        S::step(
            body,
            &mut state,
            &Gravity(DVec3::ZERO),
            turn,
            &mut IntegratorMemory::default(),
        );
        let exact = FreeRotation::new(body.inertia(), start.rotation, start.angular_momentum);
        let difference = exact.at(turn).0.conjugate() * state.rotation;
        2.0 * difference.xyz().length()
    };
    let mut all: Vec<f64> = bodies.iter().zip(states).map(error).collect();
    all.sort_by(f64::total_cmp);
    (all[BODIES / 2], all[BODIES - 1])
}

/// Cost in SIMD lanes [ns per body-step] over `steps` steps of 1/60 s.
fn cost<S: Integrate>(bodies: &[RigidBox], start: &[BodyState], steps: u32) -> f64 {
    let mut states = start.to_vec();
    let mut memories: Vec<_> = bodies.iter().map(|_| IntegratorMemory::default()).collect();
    let before = Instant::now();
    for _ in 0..steps {
        let mut group = Group {
            bodies,
            states: &mut states,
            memories: &mut memories,
            gravity: GravityField::Uniform(DVec3::NEG_Y * 9.81),
            faults: &mut Vec::new(),
            floor: None,
        };
        S::step_group(&mut group, 1.0 / 60.0);
    }
    before.elapsed().as_nanos() as f64 / f64::from(steps) / BODIES as f64
}

fn main() -> Result<(), InvalidValue> {
    println!("error of one step [rad], median and largest of {BODIES} bodies");
    for (kind, inertia) in KINDS {
        let (bodies, states) = bodies(inertia)?;
        println!("{kind}\n|ω|h   order 8           order 10          order 12");
        for turn in [0.1, 0.25, 0.3, 0.5, 1.0] {
            let cells = [
                errors::<Cut<2>>(&bodies, &states, turn),
                errors::<Cut<3>>(&bodies, &states, turn),
                errors::<Cut<4>>(&bodies, &states, turn),
            ]
            .map(|(median, largest)| format!("{median:.0e} {largest:.0e}"));
            println!(
                "{turn:<4}   {:<16}  {:<16}  {}",
                cells[0], cells[1], cells[2]
            );
        }
    }
    let (bodies, states) = bodies(KINDS[0].1)?;
    // In turns, with the minimum of many samples: disturbances only lengthen a sample.
    let mut least = [f64::INFINITY; 5];
    for _ in 0..400 {
        let samples = [
            cost::<Cut<2>>(&bodies, &states, 10),
            cost::<Cut<3>>(&bodies, &states, 10),
            cost::<Cut<4>>(&bodies, &states, 10),
            cost::<Split>(&bodies, &states, 10),
            cost::<Rk4>(&bodies, &states, 10),
        ];
        for (least, sample) in least.iter_mut().zip(samples) {
            *least = least.min(sample);
        }
    }
    let [order8, order10, order12, split, rk4] = least;
    println!("ns a body-step, {BODIES} bodies in lanes, with translation:");
    println!(
        "order 8 {order8:.1}, 10 {order10:.1}, 12 {order12:.1}; split {split:.1}, rk4 {rk4:.1}"
    );
    Ok(())
}
