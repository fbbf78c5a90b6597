//! Impact at several planes: the velocities of all touching corners change at one instant.

use glam::DMat3;

use super::contacts::{Contacts, Each, Gaps, NONE, PAIRS, pairs};
use super::law::Law;
use super::step::Among;
use crate::floor::RestitutionLaw;
use crate::state::BodyState;

/// What an impact did.
pub(super) struct Hit {
    /// By pair \[N s\].
    pub(super) impulse: Each,
    /// Whether a solver ended at its cap.
    pub(super) capped: bool,
    /// The energy that Newton's law alone would have gained, if it was scaled down \[J\].
    pub(super) repaired: Option<f64>,
    pub(super) iterations: u32,
}

/// An impact at all touching contacts, as `resolve_impact` at the floor. The energy is bounded with the largest
/// restitution of those that are struck faster than the threshold.
pub(super) fn strike<F>(
    among: &Among<'_, F>,
    state: &mut BodyState,
    gaps: &Gaps,
    touching: u64,
    ordinary: bool,
) -> Hit {
    let (body, settings, planes) = (among.world.body, among.world.settings, among.planes);
    let attitude = DMat3::from_quat(state.rotation);
    let contacts = Contacts::new(planes, body, attitude, &gaps.lever, touching);
    let n = contacts.count;
    let before = contacts.slips((state.velocity, state.angular_velocity(body)));
    let mut friction = [0.0; PAIRS];
    let (mut e, mut approach) = (0.0_f64, [0.0; PAIRS]);
    let (mut fastest, mut extreme) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        let u = contacts.normal[i].dot(before[i]);
        (fastest, extreme) = (fastest.max(-u), extreme.max(u.abs()));
    }
    let bounces = ordinary && fastest > settings.restitution_threshold;
    for i in 0..n {
        let surface = &planes[usize::from(contacts.pair[i]) / 8].surface;
        friction[i] = surface.friction;
        let u = contacts.normal[i].dot(before[i]).min(0.0);
        if bounces && u < 0.0 {
            approach[i] = surface.restitution * u;
            if -u > settings.restitution_threshold {
                e = e.max(surface.restitution);
            }
        }
    }
    let law = Law::new(&contacts, 1.0, friction, settings);
    let newton = |part: f64| {
        let mut b = before;
        for i in 0..n {
            b[i] += contacts.normal[i] * (part * approach[i]);
        }
        law.solve(&b)
    };
    let response = |p: &Each| contacts.velocities(contacts.twist(p));
    let gain = |p: &Each| contacts.dot(p, &before) + 0.5 * contacts.dot(p, &response(p));

    let mut solution = newton(1.0);
    let (mut iterations, mut capped) = (solution.iterations, !solution.converged);
    let mut repaired = None;
    if bounces {
        let energetic = settings.restitution == RestitutionLaw::Energetic;
        let gained = gain(&solution.p);
        let tiny = 1e-12 * state.kinetic_energy(body);
        if energetic || gained > tiny {
            let plastic = newton(0.0);
            iterations += plastic.iterations;
            capped |= !plastic.converged;
            let lost = gain(&plastic.p).min(0.0);
            let allowed = if energetic { (1.0 - e * e) * lost } else { 0.0 };
            if gained > allowed + tiny {
                // p₀ + λd with the energy Aλ² + Bλ + C over what is allowed, as at the floor.
                let mut d = NONE;
                for i in 0..n {
                    d[i] = solution.p[i] - plastic.p[i];
                }
                let a = 0.5 * contacts.dot(&d, &response(&d));
                let b = contacts.dot(&d, &before) + contacts.dot(&d, &response(&plastic.p));
                let c = lost - allowed;
                let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
                let lambda = if b > 0.0 {
                    -2.0 * c / (b + root)
                } else if a > 0.0 {
                    (root - b) / (2.0 * a)
                } else {
                    0.0
                };
                for i in 0..n {
                    solution.p[i] = plastic.p[i] + lambda.clamp(0.0, 1.0) * d[i];
                }
                repaired = (!energetic).then_some(gained);
            }
        }
    }
    // As at the floor: after a landing on a face below the threshold, or the last impact allowed, what would still leave
    // a plane by rocking on it is taken too.
    let quiet = extreme < settings.restitution_threshold;
    let on_a_face = |pair: usize| (touching >> (8 * (pair / 8)) & 0xff).count_ones() >= 3;
    let stopped = touching & pairs(|pair| !ordinary || quiet && on_a_face(pair));
    contacts.apply(state, &solution.p);
    let mut impulse = NONE;
    for i in 0..n {
        impulse[usize::from(contacts.pair[i])] = solution.p[i];
    }
    if stopped != 0 {
        let contacts = Contacts::new(planes, body, attitude, &gaps.lever, stopped);
        let after = contacts.slips((state.velocity, state.angular_velocity(body)));
        let held = contacts.cancel(&after, 0);
        contacts.apply(state, &held);
        for i in 0..contacts.count {
            impulse[usize::from(contacts.pair[i])] += held[i];
        }
    }
    Hit {
        impulse,
        capped,
        repaired,
        iterations,
    }
}
