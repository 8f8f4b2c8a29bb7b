//! Point or line contact of a tyre: the road height below it and the force on it.
//!
//! Appendix A's tyre touches the road in a point. Stallmann & Els found that such a tyre "can't be used for ride
//! simulations" over obstacles shorter than its contact patch, so the height can be averaged over the contact length
//! instead (the moving-average form of an enveloping filter): a sine of wavelength `w` is passed with the gain
//! `sin(pi L / w) / (pi L / w)`, and wavelengths of L vanish.

use std::sync::Arc;

use crate::road::Road;

/// Points cached at a time; 16 m at 1 cm, filled in some tens of microseconds.
const BLOCK: i64 = 1600;
/// Spacing of the averaged profile, m, at most.
const SPACING_M: f64 = 0.01;

/// The road as one wheel feels it: point contact, or averaged over the contact length.
pub(super) struct Contact {
    road: Arc<dyn Road>,
    lateral_m: f64,
    envelope: Option<Envelope>,
}

/// Averaged heights along the wheel's path, a block at a time, linearly interpolated.
struct Envelope {
    spacing_m: f64,
    /// Intervals in half a contact length.
    half: usize,
    block: Option<i64>,
    raw: Vec<f64>,
    mean: Vec<f64>,
}

impl Contact {
    /// `contact_length_m` = 0 gives point contact.
    pub(super) fn new(road: Arc<dyn Road>, lateral_m: f64, contact_length_m: f64) -> Self {
        let envelope = (contact_length_m > 0.0).then(|| {
            let half = (0.5 * contact_length_m / SPACING_M).ceil().max(1.0);
            Envelope {
                spacing_m: 0.5 * contact_length_m / half,
                half: half as usize,
                block: None,
                raw: Vec::new(),
                mean: Vec::new(),
            }
        });
        Self {
            road,
            lateral_m,
            envelope,
        }
    }

    /// Height felt with the wheel centre above `station_m`, m.
    pub(super) fn height_m(&mut self, station_m: f64) -> f64 {
        let Some(envelope) = &mut self.envelope else {
            return self.road.height_m(station_m, self.lateral_m);
        };
        let place = station_m / envelope.spacing_m;
        let cell = place.floor();
        let fraction = place - cell;
        let cell = cell as i64;
        let block = cell.div_euclid(BLOCK);
        if envelope.block != Some(block) {
            envelope.fill(block, self.road.as_ref(), self.lateral_m);
        }
        let index = cell.rem_euclid(BLOCK) as usize;
        match (envelope.mean.get(index), envelope.mean.get(index + 1)) {
            (Some(low), Some(high)) => low + fraction * (high - low),
            _ => 0.0,
        }
    }
}

impl Envelope {
    /// Averages `BLOCK + 1` points from `block * BLOCK` on by the trapezoidal rule over the contact length.
    fn fill(&mut self, block: i64, road: &dyn Road, lateral_m: f64) {
        let first = block * BLOCK - self.half as i64;
        let window = 2 * self.half;
        let count = BLOCK as usize + 1 + window;
        let spacing_m = self.spacing_m;
        self.raw.clear();
        self.raw
            .extend((0..count).map(|i| road.height_m((first + i as i64) as f64 * spacing_m, lateral_m)));
        self.mean.clear();
        self.mean.extend(self.raw.windows(window + 1).map(|heights| {
            let ends = 0.5 * (heights[0] + heights[window]);
            let inner: f64 = heights[1..window].iter().sum();
            (ends + inner) / window as f64
        }));
        self.block = Some(block);
    }
}

/// A tyre in the vertical direction: a spring and damper that push and never pull.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tyre {
    /// Vertical stiffness of the tyre, N/m.
    pub(super) stiffness_n_m: f64,
    /// Vertical damping of the tyre, N s/m.
    pub(super) damping_n_s_m: f64,
    /// Force at zero deflection change (static), N.
    pub(super) static_load_n: f64,
}

impl Tyre {
    /// Force on the wheel, N, for a deflection and rate counted from the static state (compression positive).
    ///
    /// The wheel is off the ground once it has risen by its whole static deflection; in contact the damper may
    /// lighten the load but not hold the road.
    pub(super) fn force_n(&self, deflection_m: f64, rate_m_s: f64) -> f64 {
        let elastic = self.static_load_n + self.stiffness_n_m * deflection_m;
        if elastic <= 0.0 {
            return 0.0;
        }
        (elastic + self.damping_n_s_m * rate_m_s).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    struct Sine {
        wavelength_m: f64,
    }
    impl Road for Sine {
        fn height_m(&self, station_m: f64, _lateral_m: f64) -> f64 {
            libm::sin(2.0 * PI * station_m / self.wavelength_m)
        }
    }

    #[test]
    fn averaging_passes_a_sine_with_the_gain_of_the_closed_form() {
        for wavelength_m in [0.2, 0.35, 0.5, 2.0] {
            let length_m = 0.2;
            let mut contact = Contact::new(Arc::new(Sine { wavelength_m }), 0.0, length_m);
            let x = PI * length_m / wavelength_m;
            let gain = libm::sin(x) / x;
            for i in -3000..3000 {
                let station_m = f64::from(i) * 0.0173;
                let expected = gain * libm::sin(2.0 * PI * station_m / wavelength_m);
                assert!(
                    (contact.height_m(station_m) - expected).abs() < 0.02,
                    "{wavelength_m} {station_m}"
                );
            }
        }
    }

    #[test]
    fn point_contact_is_the_road_itself() {
        let mut contact = Contact::new(Arc::new(Sine { wavelength_m: 0.7 }), 0.0, 0.0);
        let road = Sine { wavelength_m: 0.7 };
        assert_eq!(contact.height_m(1.234).to_bits(), road.height_m(1.234, 0.0).to_bits());
    }

    #[test]
    fn tyre_never_pulls() {
        let tyre = Tyre {
            stiffness_n_m: 2e5,
            damping_n_s_m: 700.0,
            static_load_n: 5000.0,
        };
        assert_eq!(tyre.force_n(0.0, 0.0), 5000.0);
        assert_eq!(tyre.force_n(-0.026, 100.0), 0.0);
        assert_eq!(tyre.force_n(-0.02, -100.0), 0.0);
        assert!(tyre.force_n(-0.0249, 0.0) > 0.0);
    }
}
