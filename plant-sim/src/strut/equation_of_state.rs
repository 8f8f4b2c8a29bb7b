//! How the gas of an accumulator departs from the ideal gas: by an equation of nitrogen, by a law without a name, or by both.
//!
//! `p = rho R T + rho^2 f`, where `f` is the sum of what the two say.

use oleo_interface::Absolute;

use super::nitrogen::{Nitrogen, State};
use super::settled::settled;
use super::terms::Compressibility;

/// Specific gas constant of nitrogen, J/kg/K (recordings README).
pub const NITROGEN_R_J_KG_K: f64 = 296.8;

/// Steps of Newton's method for a density.
const ROUNDS: usize = 20;

/// The equation of state of a gas that is not ideal.
#[derive(Debug, Clone)]
pub(super) struct EquationOfState {
    nitrogen: Option<Nitrogen>,
    law: Option<Placed>,
}

/// A law of a gas whose density at rest is known.
#[derive(Debug, Clone)]
struct Placed {
    law: Compressibility,
    static_density: f64,
    ambient_k: f64,
}

impl EquationOfState {
    /// The equation of a gas that is at a pressure and the ambient temperature (K) at rest; none for an ideal one.
    pub fn of(
        nitrogen: Option<Nitrogen>,
        law: Option<Compressibility>,
        at_rest: Absolute<f64>,
        ambient_k: f64,
    ) -> Option<Self> {
        let Some(law) = law else {
            return nitrogen.map(|nitrogen| Self {
                nitrogen: Some(nitrogen),
                law: None,
            });
        };
        // At rest the law has one value, so that its density follows from that of the gas without it.
        let known = Self { nitrogen, law: None };
        let added = known.gas_constant() * ambient_k * (law.factor(1.0).0 - 1.0);
        let static_density = known.density_with(at_rest, ambient_k, added);
        Some(Self {
            law: Some(Placed {
                law,
                static_density,
                ambient_k,
            }),
            ..known
        })
    }

    /// Gas constant of the equation, J/kg/K.
    pub fn gas_constant(&self) -> f64 {
        self.nitrogen.as_ref().map_or(NITROGEN_R_J_KG_K, Nitrogen::gas_constant)
    }

    /// `f = (p - rho R T) / rho^2`, Pa m6/kg2, and its derivatives by density (kg/m3) and temperature (K).
    pub fn excess(&self, density: f64, temperature_k: f64) -> (f64, f64, f64) {
        let known = (self.nitrogen.as_ref()).map_or((0.0, 0.0, 0.0), |gas| gas.excess(density, temperature_k));
        let Some(placed) = &self.law else {
            return known;
        };
        // p = rho R (T (y + a x) - a x T_0 sqrt(T_0/T)).
        let relative = density / placed.static_density;
        let (factor, slope) = placed.law.factor(relative);
        let ratio = placed.ambient_k / temperature_k;
        let attracted = placed.law.attraction() * relative;
        let attraction_k = attracted * placed.ambient_k * ratio.sqrt();
        let r = self.gas_constant() / density;
        let excess = r * (temperature_k * (factor - 1.0 + attracted) - attraction_k);
        let by_relative = temperature_k * (slope * relative + attracted) - attraction_k;
        let by_density = (r * by_relative - excess) / density;
        let by_temperature = r * (factor - 1.0 + attracted + 0.5 * attracted * ratio * ratio.sqrt());
        (known.0 + excess, known.1 + by_density, known.2 + by_temperature)
    }

    /// Pressure and derivatives at a density (kg/m3) and temperature (K).
    pub fn state(&self, density: f64, temperature_k: f64) -> State {
        let (f, f_density, f_temperature) = self.excess(density, temperature_k);
        let (rt, rho2) = (self.gas_constant() * temperature_k, density * density);
        State {
            pressure: Absolute(density * rt + rho2 * f),
            dp_drho_pa_m3_kg: rt + 2.0 * density * f + rho2 * f_density,
            dp_dt_pa_k: density * self.gas_constant() + rho2 * f_temperature,
        }
    }

    /// Density at a pressure and a temperature (K), kg/m3.
    pub fn density(&self, pressure: Absolute<f64>, temperature_k: f64) -> f64 {
        match (&self.nitrogen, &self.law) {
            (Some(gas), None) => gas.density(pressure, temperature_k),
            _ => self.density_with(pressure, temperature_k, 0.0),
        }
    }

    /// The same where the pressure over the density has a further part (Pa m3/kg). By Newton's method; a step never takes more than half of
    /// the density, so that an equation that a fit tries cannot lead to a density that is none.
    fn density_with(&self, pressure: Absolute<f64>, temperature_k: f64, added: f64) -> f64 {
        let ideal = pressure.pa() / (self.gas_constant() * temperature_k);
        settled(ideal, ROUNDS, |density| {
            let at = self.state(density, temperature_k);
            let missing = pressure.pa() - at.pressure.pa() - added * density;
            let step = missing / (at.dp_drho_pa_m3_kg + added);
            density + step.max(-0.5 * density).min(density)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::flow_path::FlowPath;
    use crate::strut::terms::{LawArgument, LawPlace, UnlistedLaw};

    const AMBIENT_K: f64 = 293.15;
    const AT_REST: Absolute<f64> = Absolute(4.3e6);

    /// `1 / (1 - b x) - a x`, as densely as a table needs to be the curve.
    fn redlich_kwong(b: f64, a: f64) -> Compressibility {
        let argument: Vec<f64> = (0..=1000).map(|k| 5e-3 * f64::from(k)).collect();
        let law = UnlistedLaw {
            place: LawPlace::Accumulators,
            depends_on: LawArgument::RelativeDensity,
            value: argument.iter().map(|x| 1.0 / (1.0 - b * x) - a * x).collect(),
            argument,
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: Some(a),
        };
        Compressibility::at(&[law], FlowPath::One).unwrap()
    }

    fn with(nitrogen: Option<Nitrogen>, b: f64, a: f64) -> EquationOfState {
        EquationOfState::of(nitrogen, Some(redlich_kwong(b, a)), AT_REST, AMBIENT_K).unwrap()
    }

    #[test]
    fn an_ideal_gas_has_none_and_nitrogen_its_own() {
        assert!(EquationOfState::of(None, None, AT_REST, AMBIENT_K).is_none());
        let gas = EquationOfState::of(Some(Nitrogen::reference()), None, AT_REST, AMBIENT_K).unwrap();
        let reference = Nitrogen::reference();
        assert_eq!(gas.excess(80.0, 320.0), reference.excess(80.0, 320.0));
        assert_eq!(gas.density(AT_REST, 300.0), reference.density(AT_REST, 300.0));
    }

    #[test]
    fn the_law_is_the_equation_of_redlich_and_kwong() {
        let (b, a) = (0.045, 0.069);
        let gas = with(None, b, a);
        let rho_0 = AT_REST.pa() / (NITROGEN_R_J_KG_K * AMBIENT_K * (1.0 / (1.0 - b) - a));
        assert!((gas.density(AT_REST, AMBIENT_K) / rho_0 - 1.0).abs() < 1e-9);
        for (x, t) in [(0.4, 260.0), (1.0, AMBIENT_K), (2.3, 400.0), (3.1, 330.0)] {
            let rt = |t: f64| x * rho_0 * NITROGEN_R_J_KG_K * t;
            let expected = rt(t) / (1.0 - b * x) - a * x * rt(AMBIENT_K) * (AMBIENT_K / t).sqrt();
            let got = gas.state(x * rho_0, t).pressure.pa();
            assert!((got / expected - 1.0).abs() < 1e-6, "{x} {t}: {got} {expected}");
        }
    }

    /// Two numbers are enough for nitrogen: within a thousandth of the reference equation wherever a strut's gas goes.
    #[test]
    fn two_numbers_are_nitrogen_to_a_thousandth() {
        let (gas, reference) = (with(None, 0.06, 0.069), Nitrogen::reference());
        let rest = [gas.density(AT_REST, AMBIENT_K), reference.density(AT_REST, AMBIENT_K)];
        for (x, t) in [
            (0.6, 250.0),
            (0.8, 293.0),
            (1.0, 300.0),
            (1.5, 320.0),
            (2.0, 360.0),
            (2.8, 400.0),
        ] {
            let [a, b] = [gas.state(x * rest[0], t), reference.state(x * rest[1], t)];
            let (pressure, heating) = (a.pressure.pa() / b.pressure.pa(), a.dp_dt_pa_k / b.dp_dt_pa_k);
            assert!((pressure - 1.0).abs() < 1e-3, "{x} {t}: {pressure}");
            assert!((heating * rest[1] / rest[0] - 1.0).abs() < 1e-2, "{x} {t}: {heating}");
        }
    }

    #[test]
    fn its_derivatives_are_difference_quotients_with_and_without_nitrogen() {
        for nitrogen in [None, Some(Nitrogen::reference())] {
            let gas = with(nitrogen, 0.05, 0.08);
            let (rho, t) = (77.3, 341.0);
            let (_, by_density, by_temperature) = gas.excess(rho, t);
            let f = |rho: f64, t: f64| gas.excess(rho, t).0;
            let (d_rho, d_t) = (
                (f(rho * 1.01, t) - f(rho * 0.99, t)) / (0.02 * rho),
                (f(rho, t + 0.1) - f(rho, t - 0.1)) / 0.2,
            );
            assert!((by_density / d_rho - 1.0).abs() < 2e-2, "{by_density} {d_rho}");
            assert!((by_temperature / d_t - 1.0).abs() < 1e-4, "{by_temperature} {d_t}");
        }
    }

    #[test]
    fn beside_nitrogen_the_law_adds_and_the_pressure_at_rest_stays() {
        let gas = with(Some(Nitrogen::reference()), 0.02, 0.0);
        let at_rest = gas.density(AT_REST, AMBIENT_K);
        assert!((gas.state(at_rest, AMBIENT_K).pressure.pa() / AT_REST.pa() - 1.0).abs() < 1e-9);
        assert!(at_rest < Nitrogen::reference().density(AT_REST, AMBIENT_K));
    }
}
