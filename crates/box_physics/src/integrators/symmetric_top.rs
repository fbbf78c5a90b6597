//! `symmetric-top`: free rotation by Fassò's splitting, order 2. It was called `split` until 2026.

use super::flows::{FreeRotationFlow, kick_drift_kick};
use super::{
    Conserved, EnergyBehavior, Evaluations, Integrate, IntegratorInfo, Limit, MemorySlot,
    MenuGroup, Order, Orders, Stability, StepOutcome,
};
use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::Trigonometry;
use crate::rotation::free_rotation_strang;
use crate::state::BodyState;

/// Strang's composition with the free rotation by the symmetric-top splitting.
///
/// The exact rotation with the middle moment is followed by two planar rotations a and c as ½ a, c, ½ a. The result is
/// exact for cubes and symmetric bodies. For others it has order 2, with a bounded energy error at any step.
pub struct SymmetricTop;

impl Integrate for SymmetricTop {
    const INFO: IntegratorInfo = IntegratorInfo {
        id: "symmetric-top",
        name: "Symmetric top",
        group: MenuGroup::Ours,
        summary: "A symplectic splitting of order 2: exact for cubes and symmetric bodies, bounded energy for all at any step.",
        source: "Strang 1968; Fassò, J. Comput. Phys. 189 (2003) 527; McLachlan, Perlmutter 2001 (damping)",
        orders: Orders {
            gravity: Order::Exact,
            linear_drag: Order::Exact,
            angular_damping: Order::Exact,
            ..Orders::all(2)
        },
        evaluations: Evaluations::fixed(1, 2),
        stability: Stability {
            rotation: Limit::None,
            drag: Limit::None,
            damper: Limit::None,
            oscillator: Limit::Below(2.0),
        },
        conserved: Conserved::all_else(EnergyBehavior::Bounded),
    };

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
        let evaluations = kick_drift_kick(body, state, force, h, &mut Strang(trigonometry));
        StepOutcome::plain(evaluations)
    }
}

/// The symmetric-top splitting with a given sine and cosine.
struct Strang<'a, T>(&'a mut T);

impl<T: Trigonometry> FreeRotationFlow for Strang<'_, T> {
    #[inline(always)]
    fn flow(&mut self, body: &RigidBox, state: &mut BodyState, h: f64) {
        free_rotation_strang(body, state, h, self.0);
    }
}
