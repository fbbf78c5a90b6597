//! Coulomb's law at the corners of one floor, with direct solutions of the likely cases. Nine of ten problems are one
//! corner (`single`) or an edge (`edge`). If only two corners of a face approach, they are tried as an edge. Sticking
//! of all corners is a linear problem.

mod edge;
mod single;

use edge::Edge;
use glam::{DMat3, DVec3};

use super::geometry::{Corner3, mask};
use super::law::answered;
use super::operator::DelassusOperator;
use super::projection::Pair;

/// W of one or two corners.
#[expect(
    clippy::large_enum_variant,
    reason = "one on the stack for an impact or a segment"
)]
pub(super) enum Blocks {
    One(DMat3),
    Two(Pair),
    More,
}

impl Blocks {
    pub(super) fn of(operator: &DelassusOperator) -> Self {
        match operator.count {
            1 => Self::One(operator.block(0, &operator.swing(0))),
            2 => Self::Two(Pair::of(operator, 0, 1)),
            _ => Self::More,
        }
    }
}

/// Coulomb's law at a few corners of a body.
pub(super) struct Cone<'a> {
    pub(super) operator: &'a DelassusOperator,
    pub(super) friction: f64,
    /// Tolerance of the law in |w| [m/s].
    pub(super) target: f64,
}

impl Cone<'_> {
    /// Sets `p` to the impulses for the velocities `b`, if one of the cases applies. `near` is the solution of a
    /// similar problem, or zero.
    #[inline]
    pub(super) fn solve(
        &self,
        blocks: &Blocks,
        b: &Corner3,
        near: &Corner3,
        p: &mut Corner3,
    ) -> Option<()> {
        match blocks {
            Blocks::One(w) => p[0] = single::solve(w, b[0], self.friction, near[0])?,
            Blocks::Two(pair) => {
                let edge = Edge {
                    cone: self,
                    pair,
                    b: [b[0], b[1]],
                    near: [near[0], near[1]],
                };
                [p[0], p[1]] = edge.solve()?;
            }
            Blocks::More => {
                let two = self.two_alone(b);
                let two = two.inspect(|_| answered("face: two corners as an edge"));
                let stick = || self.all_stick(b);
                *p = two.or_else(|| stick().inspect(|_| answered("face: all stick")))?;
            }
        }
        Some(())
    }

    /// The smallest impulses that stop three or more corners, if they are in the cones. With the arms ρ_i from the
    /// center of the corners they are a + β × ρ_i. S = Σ (|ρ_i|² − ρ_iρ_iᵀ) determines β, and also the twist.
    fn all_stick(&self, b: &Corner3) -> Option<Corner3> {
        let (operator, n) = (self.operator, self.operator.count);
        let part = 1.0 / n as f64;
        let center = part * operator.lever[..n].iter().sum::<DVec3>();
        let mean = part * b[..n].iter().sum::<DVec3>();
        let (mut spread, mut turn) = (DMat3::ZERO, DVec3::ZERO);
        for i in 0..n {
            let r = operator.lever[i] - center;
            spread += DMat3::from_diagonal(DVec3::splat(r.length_squared()))
                - DMat3::from_cols(r * r.x, r * r.y, r * r.z);
            turn += r.cross(b[i] - mean);
        }
        let inverse = spread.inverse();
        let omega = -(inverse * turn);
        let force = (-mean - omega.cross(center)) / operator.inverse_mass;
        let torque = operator.inverse_inertia.inverse() * omega - center.cross(force);
        let beta = inverse * torque;
        let mut p = [DVec3::ZERO; 8];
        for i in 0..n {
            p[i] = part * force + beta.cross(operator.lever[i] - center);
            let t = (p[i].x * p[i].x + p[i].z * p[i].z).sqrt();
            if p[i].y <= 0.0 || t > self.friction * p[i].y {
                return None;
            }
        }
        let left = operator.largest(&operator.after(b, &p));
        (left <= self.target).then_some(p)
    }

    /// The impulses if exactly two corners approach and all others leave, as when a rocking box strikes with an edge.
    fn two_alone(&self, b: &Corner3) -> Option<Corner3> {
        let (n, target) = (self.operator.count, self.target);
        // Corners at rest approach by rounding errors.
        let fastest = b[..n].iter().fold(target, |a, b| a.max(-b.y));
        let strikes = mask(|i| i < n && b[i].y < -1e-6 * fastest);
        if strikes.count_ones() != 2 {
            return None;
        }
        let i = strikes.trailing_zeros() as usize;
        let j = 7 - strikes.leading_zeros() as usize;
        let mut p = [DVec3::ZERO; 8];
        let pair = Pair::of(self.operator, i, j);
        let part = self.operator.part(strikes.into());
        let alone = Cone {
            operator: &part,
            ..*self
        };
        let edge = Edge {
            cone: &alone,
            pair: &pair,
            b: [b[i], b[j]],
            near: [DVec3::ZERO; 2],
        };
        [p[i], p[j]] = edge.solve()?;
        let w = self.operator.after(b, &p);
        w[..n].iter().all(|w| w.y >= -target).then_some(p)
    }
}

#[cfg(test)]
mod tests;
