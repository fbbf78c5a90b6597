//! Impact at several planes: the velocities of all touching corners change at one instant.

use glam::DMat3;

use super::among::Among;
use super::contacts::{Each, Gaps, NONE, PAIRS};
use super::law::Law;
use crate::floor::RestitutionLaw;
use crate::floor::geometry::set;
use crate::floor::ground::Ground;
use crate::floor::impact::{ImpactKind, ImpactOutcome, part_of_way};
use crate::force::ForceModel;
use crate::state::BodyState;

/// An impact at all touching contacts, as `resolve_impact` at the floor. The energy is bounded with the largest
/// restitution of those that are struck faster than the threshold.
pub(super) fn strike<F: ForceModel>(
    among: &Among<'_, F>,
    state: &mut BodyState,
    gaps: &Gaps,
    touching: u64,
    kind: ImpactKind,
) -> ImpactOutcome<PAIRS> {
    let (settings, planes) = (among.world.context.settings, among.planes);
    let attitude = DMat3::from_quat(state.rotation);
    let operator = among.operator(attitude, &gaps.lever, touching);
    let n = operator.count;
    let place = |i: usize| usize::from(operator.place[i]);
    let before = among.velocities(&operator, state);
    let (mut e, mut approach) = (0.0_f64, [0.0; PAIRS]);
    let (mut fastest, mut extreme) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        let u = among.normal(place(i)).dot(before[i]);
        (fastest, extreme) = (fastest.max(-u), extreme.max(u.abs()));
    }
    let ordinary = kind == ImpactKind::Ordinary;
    let bounces = ordinary && fastest > settings.restitution_threshold;
    for i in 0..n {
        let surface = among.surface(place(i));
        let u = among.normal(place(i)).dot(before[i]).min(0.0);
        if bounces && u < 0.0 {
            approach[i] = surface.restitution * u;
            if -u > settings.restitution_threshold {
                e = e.max(surface.restitution);
            }
        }
    }
    let law = Law::new(&operator, planes, |floor| floor.friction, settings);
    let newton = |part: f64| {
        let mut b = before;
        for i in 0..n {
            b[i] += among.normal(place(i)) * (part * approach[i]);
        }
        law.solve(&b)
    };
    let gain = |p: &Each| operator.dot(p, &before) + 0.5 * operator.dot(p, &operator.response(p));

    let mut solution = newton(1.0);
    let (mut iterations, mut capped) = (solution.iterations, !solution.converged);
    let mut repaired = None;
    if bounces {
        let energetic = settings.restitution == RestitutionLaw::Energetic;
        let gained = gain(&solution.p);
        let tiny = 1e-12 * state.kinetic_energy(among.world.context.body);
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
                let a = 0.5 * operator.dot(&d, &operator.response(&d));
                let b =
                    operator.dot(&d, &before) + operator.dot(&d, &operator.response(&plastic.p));
                let part = part_of_way(a, b, lost - allowed);
                for i in 0..n {
                    solution.p[i] = plastic.p[i] + part * d[i];
                }
                repaired = (!energetic).then_some(gained);
            }
        }
    }
    // As at the floor: after a landing on a face below the threshold, or the last impact allowed, what would still leave
    // a plane by rocking on it is taken too.
    let quiet = extreme < settings.restitution_threshold;
    let on_a_face = |pair: usize| (touching >> (8 * (pair / 8)) & 0xff).count_ones() >= 3;
    let stopped = touching & set::<PAIRS>(|pair| !ordinary || quiet && on_a_face(pair));
    operator.apply(state, &solution.p);
    let mut impulse = operator.by_place(&solution.p);
    if stopped != 0 {
        let operator = among.operator(attitude, &gaps.lever, stopped);
        let held = among.cancel(&operator, &among.velocities(&operator, state), 0);
        operator.apply(state, &held);
        operator.add_to(&mut impulse, &held);
    }
    ImpactOutcome {
        impulse,
        capped,
        repaired,
        iterations,
    }
}
