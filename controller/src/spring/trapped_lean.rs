//! Lets out, within a bend, a lean that was trapped as the springs closed.
//!
//! The springs close as soon as a bend is recognised. On a rough road the body sways just then, and the bend has pushed it outwards for a
//! while. Accumulator 2 of a strut on the outer side then holds more oil than at the static position, and the strut stays compressed by
//! as much for as long as its valve 3 is closed; on the inner side it is the other way round. But the road goes on to compress and to
//! extend the struts, and with each swing oil could flow back. So valve 3 of a strut works like a check valve:
//!
//! ```text
//!   open while   s x_t > 8 mm (to open: 16 mm)    more trapped than a closing in comfort may leave
//!   and          s dF  > 10 % of static load      oil would flow out of accumulator 2 on the outer side, into it on the inner side
//!                                                 s = 1 on the outer side, -1 on the inner
//! ```
//!
//! with the shift of the ride height `x_t` and the force step `dF` of [`super`]. While the valve is open, `dF` is what the pressure drop of
//! the flow would do, so that the valve closes before the flow turns. The road does the work; the controller
//! only rectifies it. Each strut is looked at in every fourth tick, and a valve that has closed rests for 50 ms, about the time that it
//! needs to move.
//!
//! On a flat road nothing flows, and no valve opens. `docs/controller.md` has what it earns.

use oleo_interface::{Corner, Corners, Side};

use super::{Parameters, Springs};
use crate::timing::ticks;

/// Shortest time from a closing to the next opening.
pub(super) const DWELL_TICKS: u32 = ticks(50) as u32;

impl Springs {
    /// One tick of a bend that pushes the body to this side: moves the valve of the strut that has been looked at in this tick.
    #[inline(never)]
    pub(super) fn let_lean_out(&mut self, c: &Parameters, static_load_n: &Corners<f32>, corner: Corner, outer: Side) {
        let is_open = self.is_open(corner);
        let (mut shift_m, mut step_n) = (self.trapped_shift_m[corner], self.valves[corner].opening_step_n);
        if corner.side() != outer {
            (shift_m, step_n) = (-shift_m, -step_n);
        }
        let least_m = if is_open { 1.0 } else { 2.0 } * c.trapped_shift_m;
        let lets_out = shift_m > least_m && step_n > 2.0 * c.opening_step_share * static_load_n[corner];
        if is_open != lets_out && (is_open || self.since(corner) >= DWELL_TICKS) {
            self.toggle(corner);
        }
    }
}
