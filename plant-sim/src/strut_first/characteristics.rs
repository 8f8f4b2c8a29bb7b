//! The five tables of the first-generation model, calculated from a strut's geometry, fillings and damper packs.

use oleo_interface::{Absolute, Gauge};

use crate::model_file::{Checked, InvalidValue};
use crate::strut::StrutModel;

use super::look_up::LookUpTable;

/// Which gas is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spring {
    /// Valve 3 open: both accumulators.
    Soft,
    /// Valve 3 closed: accumulator 1 alone.
    Stiff,
}

/// The three damping levels of the report (3.5.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damping {
    /// Both dampers bypassed; of valves 1 and 2 the open ones take the oil.
    Low,
    /// No bypass, both dampers in parallel.
    HighSoft,
    /// No bypass, damper 1 alone: damper 2 is inactive with valve 3 closed.
    HighStiff,
}

/// Travel that the tables cover, m from the static position: the 300 mm of the report, 180 in rebound.
const TRAVEL_M: (f64, f64) = (-0.180, 0.120);
/// Spacing of the spring tables, m.
const SPRING_STEP_M: f64 = 5e-4;
/// Speed that the damping tables cover, m/s: the report's 2 m/s.
const SPEED_M_S: f64 = 2.0;
const DAMPING_INTERVALS: usize = 400;
/// Part of the gas volume that the stiff table uses up; beyond it the table goes on straight.
const USABLE_GAS: f64 = 0.95;

/// The tables, force in N over displacement in m or speed in m/s; all compression positive.
#[derive(Debug, Clone, PartialEq)]
pub struct Characteristics {
    soft_spring: LookUpTable,
    stiff_spring: LookUpTable,
    low: LookUpTable,
    high_soft: LookUpTable,
    high_stiff: LookUpTable,
}

impl Characteristics {
    /// Calculates the tables. Springs: isothermal compression of an ideal gas, `p V = const`, `F = (p - p_atm) A`, oil taken as
    /// incompressible. Damping: the pressure drop at which the paths together pass the flow `A v`, the pressures of both
    /// accumulators being equal, times `A`.
    ///
    /// # Errors
    /// Impossible values in the model, such as one that lets no oil pass.
    pub fn of(model: &StrutModel) -> Result<Self, InvalidValue> {
        // Among others that tables are increasing, as the paths below need.
        model.check()?;
        let area_m2 = model.piston_area_m2();
        let static_pa = model.cylinder.static_pressure_pa;
        let small = model.accumulator[0].static_gas_volume_m3;
        let large = small + model.accumulator[1].static_gas_volume_m3;
        let spring = |volume_m3: f64| {
            let end = TRAVEL_M.1.min(USABLE_GAS * volume_m3 / area_m2);
            let intervals = ((end - TRAVEL_M.0) / SPRING_STEP_M).ceil() as usize;
            LookUpTable::tabulate(TRAVEL_M.0, end, intervals, |x| {
                isothermal_force_n(static_pa, volume_m3, area_m2, x)
            })
        };
        let damping = |level: Damping| {
            LookUpTable::tabulate(-SPEED_M_S, SPEED_M_S, DAMPING_INTERVALS, |speed| {
                area_m2 * drop_at_flow(model, level, area_m2 * speed)
            })
        };
        Ok(Self {
            soft_spring: spring(large),
            stiff_spring: spring(small),
            low: damping(Damping::Low),
            high_soft: damping(Damping::HighSoft),
            high_stiff: damping(Damping::HighStiff),
        })
    }

    /// Spring force over displacement.
    #[must_use]
    pub fn spring(&self, spring: Spring) -> &LookUpTable {
        match spring {
            Spring::Soft => &self.soft_spring,
            Spring::Stiff => &self.stiff_spring,
        }
    }

    /// Damper force over speed.
    #[must_use]
    pub fn damping(&self, level: Damping) -> &LookUpTable {
        match level {
            Damping::Low => &self.low,
            Damping::HighSoft => &self.high_soft,
            Damping::HighStiff => &self.high_stiff,
        }
    }
}

/// Boyle's law at a displacement, N; atmosphere acts on the outside of the piston.
pub(crate) fn isothermal_force_n(static_pa: f64, volume_m3: f64, area_m2: f64, displacement_m: f64) -> f64 {
    let absolute = Gauge(static_pa).absolute().pa() * volume_m3 / (volume_m3 - area_m2 * displacement_m);
    Absolute(absolute).gauge().pa() * area_m2
}

/// Flow at a pressure drop from the cylinder to the accumulators, m3/s; increasing.
fn flow_at_drop(model: &StrutModel, level: Damping, drop_pa: f64) -> f64 {
    let transition = model.orifice.transition_pressure_pa;
    let orifice = |coefficient: f64, drop: f64| coefficient * drop / (drop.abs() + transition).sqrt();
    let pack = |index: usize, drop: f64| {
        let table = &model.damper[index];
        table.characteristic().value(drop)
    };
    let bypassed = level == Damping::Low;
    let first = |index: usize, drop: f64| {
        let bypass = if bypassed {
            orifice(model.valve[index].total_flow_coefficient(), drop)
        } else {
            0.0
        };
        pack(index, drop) + bypass
    };
    let path_1 = first(0, drop_pa);
    if level == Damping::HighStiff {
        return path_1;
    }
    // Path 2 shares its drop between damper 2 with its bypass and valve 3: find the share at which both pass the same.
    let share = root(
        |share| first(1, share * drop_pa) - orifice(model.valve[2].total_flow_coefficient(), (1.0 - share) * drop_pa),
        drop_pa < 0.0,
    );
    path_1 + first(1, share * drop_pa)
}

/// Pressure drop, Pa, that drives a flow, m3/s.
fn drop_at_flow(model: &StrutModel, level: Damping, flow: f64) -> f64 {
    if flow == 0.0 {
        return 0.0;
    }
    let mut bound = model.orifice.transition_pressure_pa.copysign(flow);
    while flow_at_drop(model, level, bound).abs() < flow.abs() && bound.abs() < 1e12 {
        bound *= 2.0;
    }
    bound * root(|share| flow_at_drop(model, level, share * bound) - flow, flow < 0.0)
}

/// Zero in 0..1 of a function that increases (or, where `falling`, decreases), by bisection down to rounding.
fn root(law: impl Fn(f64) -> f64, falling: bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (law(middle) > 0.0) != falling {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preset() -> (StrutModel, Characteristics) {
        let model = StrutModel::defender110(8000.0);
        let characteristics = Characteristics::of(&model).expect("the preset is possible");
        (model, characteristics)
    }

    #[test]
    fn spring_tables_are_boyles_law_within_one_per_mille_over_the_measured_range() {
        let (model, tables) = preset();
        let (area, p0) = (model.piston_area_m2(), model.static_pressure().absolute().pa());
        for (spring, volume) in [(Spring::Soft, 5e-4), (Spring::Stiff, 1e-4)] {
            for i in -1005..=400 {
                let x = f64::from(i) * 1e-4;
                let exact = Absolute(p0 * volume / (volume - area * x)).gauge().pa() * area;
                let table = tables.spring(spring).at(x);
                assert!(
                    (table / exact - 1.0).abs() < 1e-3,
                    "{spring:?} {x}: {table} N, {exact} N"
                );
            }
        }
    }

    #[test]
    fn rates_at_static_are_those_computed_in_the_vehicle_notes() {
        // vehicle.md: 8 kN is 4.18 MPa absolute, 32.2 kN/m with 0.5 l and 161 kN/m with 0.1 l; 38 kN at +40 mm with 0.1 l.
        let (_, tables) = preset();
        let rate = |spring| (tables.spring(spring).at(1e-3) - tables.spring(spring).at(-1e-3)) / 2e-3;
        assert!((rate(Spring::Soft) / 32.2e3 - 1.0).abs() < 5e-3);
        assert!((rate(Spring::Stiff) / 161e3 - 1.0).abs() < 5e-3);
        assert!((tables.spring(Spring::Stiff).at(0.04) / 38e3 - 1.0).abs() < 0.01);
    }

    #[test]
    fn springs_meet_at_the_reference_position_only() {
        let (_, tables) = preset();
        let gap = |x| tables.spring(Spring::Stiff).at(x) - tables.spring(Spring::Soft).at(x);
        assert!(gap(0.0).abs() < 5.0 && gap(0.02) > 1000.0 && gap(-0.02) < -1000.0);
    }

    #[test]
    fn damper_1_alone_is_its_pack_read_backwards() {
        let (model, tables) = preset();
        let area = model.piston_area_m2();
        for (&flow, &drop) in model.damper[0].flow_m3_s.iter().zip(&model.damper[0].pressure_drop_pa) {
            let force = tables.damping(Damping::HighStiff).at(flow / area);
            assert!(
                (force - drop * area).abs() < 0.01 * drop.abs() * area + 2.0,
                "{force} N at {flow} m3/s"
            );
        }
    }

    #[test]
    fn three_levels_are_in_order_at_every_speed() {
        let (_, tables) = preset();
        for i in 1..=40 {
            let speed = 0.05 * f64::from(i);
            for v in [speed, -speed] {
                let force = |level| tables.damping(level).at(v) * v.signum();
                let (low, soft, stiff) = (force(Damping::Low), force(Damping::HighSoft), force(Damping::HighStiff));
                assert!(
                    0.0 < low && low < soft && soft < stiff,
                    "{v} m/s: {low} {soft} {stiff} N"
                );
            }
        }
    }

    #[test]
    fn the_tables_go_on_beyond_their_ends() {
        let (_, tables) = preset();
        let stiff = tables.spring(Spring::Stiff);
        assert!(stiff.at(0.2).is_finite() && stiff.at(0.2) > stiff.at(0.1));
        assert!(tables.damping(Damping::Low).at(5.0) > tables.damping(Damping::Low).at(2.0));
    }
}
