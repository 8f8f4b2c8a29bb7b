//! Turbulent orifices: bypass valves, valve 3, leaks.
//!
//! `Q = c dp / sqrt(|dp| + p_t)` (recordings README): the square-root law `Q = c sqrt(dp)` made smooth and laminar
//! below the transition pressure `p_t`, so that it has a finite slope at rest. `c` in m3/s/sqrt(Pa).

use crate::lanes::Number;

/// `dp / sqrt(|dp| + p_t)` and its derivative; flow per unit of flow coefficient.
#[inline(always)]
#[must_use]
pub fn unit_flow<N: Number>(drop_pa: N, transition_pa: N) -> (N, N) {
    let a = drop_pa.abs() + transition_pa;
    // One division for both: 1 / a^(3/2).
    let steep = (a * a.sqrt()).recip();
    (drop_pa * a * steep, (drop_pa.abs() * 0.5 + transition_pa) * steep)
}

/// The pressure drop that drives `flow / coefficient = q`, and its derivative by `q`: the root of
/// `dp^2 = q^2 (|dp| + p_t)` with the sign of `q`.
#[inline(always)]
#[must_use]
pub fn unit_drop<N: Number>(q: N, transition_pa: N) -> (N, N) {
    // |dp| = q (q + r) / 2 with r = sqrt(q^2 + 4 p_t), whose derivative by q is q / r; at q = 0 the slope is sqrt(p_t).
    let size = q.abs();
    let root = (q * q + transition_pa * 4.0).sqrt();
    (q * 0.5 * (size + root), size + (root + q * q / root) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn drop_inverts_flow(dp in -2e7..2e7f64) {
            let (q, dq) = unit_flow(dp, 2e4);
            let (back, ddp) = unit_drop(q, 2e4);
            proptest::prop_assert!((back - dp).abs() <= 1e-9 * dp.abs() + 1e-6);
            proptest::prop_assert!((ddp * dq - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn turbulent_and_laminar_limits() {
        let (q, _) = unit_flow(1e8, 2e4);
        assert!((q / 1e4 - 1.0).abs() < 2e-4, "square-root law far above the transition");
        let (q, slope) = unit_flow(0.0, 2e4);
        assert!(q == 0.0 && (slope * 2e4_f64.sqrt() - 1.0).abs() < 1e-12);
    }
}
