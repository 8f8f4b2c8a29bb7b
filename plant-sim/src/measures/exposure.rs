//! Exposure to vertical vibration: weighted RMS, vibration dose value and motion sickness dose value, sample by sample.

use super::weighting::{WB, WF, WK, WeightingsAbreast};

/// Vertical vibration that a seat has been exposed to so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RideMeasures {
    /// Time over which the exposure was measured, s.
    pub duration_s: f64,
    /// RMS of the acceleration itself, m/s2.
    pub rms_m_s2: f64,
    /// BS 6841: RMS of the Wb-weighted acceleration, m/s2. The seed report's measure of ride comfort.
    pub weighted_rms_m_s2: f64,
    /// ISO 2631-1: RMS of the Wk-weighted acceleration, m/s2.
    pub wk_rms_m_s2: f64,
    /// BS 6841: vibration dose value of the Wb-weighted acceleration, `(int a^4 dt)^(1/4)`, m/s^1.75.
    pub vdv_m_s1_75: f64,
    /// BS 6841: motion sickness dose value of the Wf-weighted acceleration, `(int a^2 dt)^(1/2)`, m/s^1.5.
    pub msdv_m_s1_5: f64,
    /// Largest magnitude of the acceleration, m/s2.
    pub peak_m_s2: f64,
}

/// Takes the vertical acceleration of a seat one sample at a time; stores no history.
#[derive(Debug, Clone)]
pub struct RideMeter {
    step_s: f64,
    /// Wb, Wk, Wf.
    weightings: WeightingsAbreast<3>,
    samples: u64,
    square: f64,
    wb_square: f64,
    wb_fourth: f64,
    wk_square: f64,
    wf_square: f64,
    peak: f64,
}

impl RideMeter {
    /// For samples `step_s` apart (at most 5 ms: 200 Hz).
    pub fn new(step_s: f64) -> Self {
        Self {
            step_s,
            weightings: WeightingsAbreast::new([&WB, &WK, &WF], 1.0 / step_s),
            samples: 0,
            square: 0.0,
            wb_square: 0.0,
            wb_fourth: 0.0,
            wk_square: 0.0,
            wf_square: 0.0,
            peak: 0.0,
        }
    }

    /// One sample that does not count yet, m/s2: only the filters see it, so that their own start is over when counting
    /// begins.
    pub fn settle(&mut self, acceleration_m_s2: f64) {
        self.weightings.filter(acceleration_m_s2);
    }

    /// One sample of the vertical acceleration without gravity, m/s2.
    pub fn add(&mut self, acceleration_m_s2: f64) {
        let a = acceleration_m_s2;
        let [b, k, f] = self.weightings.filter(a);
        self.samples += 1;
        self.square += a * a;
        self.wb_square += b * b;
        self.wb_fourth += b * b * b * b;
        self.wk_square += k * k;
        self.wf_square += f * f;
        self.peak = self.peak.max(a.abs());
    }

    /// The measures of all samples so far.
    pub fn measures(&self) -> RideMeasures {
        if self.samples == 0 {
            return RideMeasures::default();
        }
        let count = self.samples as f64;
        RideMeasures {
            duration_s: count * self.step_s,
            rms_m_s2: (self.square / count).sqrt(),
            weighted_rms_m_s2: (self.wb_square / count).sqrt(),
            wk_rms_m_s2: (self.wk_square / count).sqrt(),
            vdv_m_s1_75: (self.wb_fourth * self.step_s).sqrt().sqrt(),
            msdv_m_s1_5: (self.wf_square * self.step_s).sqrt(),
            peak_m_s2: self.peak,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    /// For a sine: RMS = a W / sqrt 2, VDV = a W (3 T / 8)^(1/4), MSDV = a W sqrt(T / 2).
    #[test]
    fn a_sine_has_the_closed_form_s_measures() {
        for (step_s, f) in [(1e-3, 8.0), (5e-3, 8.0), (1e-3, 0.2)] {
            let mut meter = RideMeter::new(step_s);
            let duration = 600.0;
            let amplitude = 2.0;
            for i in 0..(duration / step_s).round() as u64 {
                meter.add(amplitude * libm::sin(2.0 * PI * f * i as f64 * step_s));
            }
            let m = meter.measures();
            assert!((m.duration_s - duration).abs() < 1e-6);
            assert!((m.rms_m_s2 - amplitude / 2f64.sqrt()).abs() < 1e-3);
            let close =
                |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 0.01, "{value} {expected}");
            close(m.weighted_rms_m_s2, amplitude * WB.magnitude(f) / 2f64.sqrt());
            close(m.wk_rms_m_s2, amplitude * WK.magnitude(f) / 2f64.sqrt());
            close(
                m.vdv_m_s1_75,
                amplitude * WB.magnitude(f) * libm::pow(3.0 * duration / 8.0, 0.25),
            );
            if f < 1.0 {
                close(m.msdv_m_s1_5, amplitude * WF.magnitude(f) * (duration / 2.0).sqrt());
            }
        }
    }

    #[test]
    fn nothing_measured_is_nothing() {
        assert_eq!(RideMeter::new(1e-3).measures(), RideMeasures::default());
    }

    /// Quarter car 420/85 kg, 33 and 230 kN/m, 2.5 kN s/m at 60 km/h, weighted Wb, on ISO 8608 roads: the numbers of the
    /// project's vehicle data, from the spectrum in the frequency domain.
    #[test]
    fn linear_quarter_car_gives_the_stated_comfort() {
        for (density_m3, stated) in [(256e-6, 1.14), (1024e-6, 2.29), (4096e-6, 4.57), (6.1e-3, 5.58)] {
            let weighted = quarter_car_spectrum(density_m3);
            assert!((weighted / stated - 1.0).abs() < 0.01, "{weighted} {stated}");
        }
    }

    const SPEED_M_S: f64 = 60.0 / 3.6;
    const MASS: (f64, f64) = (420.0, 85.0);
    const RATE: (f64, f64) = (33e3, 230e3);
    const DAMPING: f64 = 2500.0;

    /// `sqrt(int |Wb H|^2 G df)`, G(f) = Gd(0.1) 0.1^2 v / f^2.
    fn quarter_car_spectrum(density_m3: f64) -> f64 {
        let step = 0.005;
        let mut square = 0.0;
        for i in 1..40_000 {
            let f = step * f64::from(i);
            let w = 2.0 * PI * f;
            // (m_s s^2 + c s + k) z_s = (c s + k) z_u; (m_u s^2 + c s + k + k_t) z_u = k_t z + (c s + k) z_s
            let link = rustfft::num_complex::Complex::new(RATE.0, w * DAMPING);
            let body = link - w * w * MASS.0;
            let wheel = link - w * w * MASS.1 + RATE.1;
            let transfer = link * RATE.1 / (body * wheel - link * link);
            let acceleration = transfer.norm() * w * w * WB.magnitude(f);
            square += acceleration * acceleration * density_m3 * 0.01 * SPEED_M_S / (f * f) * step;
        }
        square.sqrt()
    }

    /// The same through a synthesised road, an integrator and the digital filter.
    #[test]
    fn time_domain_agrees_with_the_frequency_domain() {
        use crate::road::{
            Road,
            iso8608::{Class, iso8608},
        };
        let road = iso8608(Class::D, 2000.0, 5).unwrap();
        let step = 5e-4;
        let mut meter = RideMeter::new(1e-3);
        let (mut zs, mut zu, mut vs, mut vu) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..240_000 {
            let z = road.height_m(SPEED_M_S * step * f64::from(i), 0.743);
            let link = RATE.0 * (zu - zs) + DAMPING * (vu - vs);
            let body = link / MASS.0;
            let wheel = (RATE.1 * (z - zu) - link) / MASS.1;
            vs += step * body;
            vu += step * wheel;
            zs += step * vs;
            zu += step * vu;
            if i % 2 == 0 {
                meter.add(body);
            }
        }
        // Made up to 10 cycles/m and with one realisation of 2 km: a few per cent.
        let ratio = meter.measures().weighted_rms_m_s2 / quarter_car_spectrum(1024e-6);
        assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
    }
}
