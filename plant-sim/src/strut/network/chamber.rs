//! The main chamber: the volume that it takes up when its pressure changes.
//!
//! Oil, undissolved air, the mount and an unmodelled compliance take up volume. Oil and air are counted in one of two
//! ways ([`OilCount`]), so the chamber's volume has two parts: one that is held (a function of pressure and displacement,
//! which comes back exactly) and one that is counted at the chamber's density of the moment.

use oleo_interface::Gauge;

use super::state::State;
use crate::lanes::{Mask, Number};
use crate::strut::model::StrutModel;
use crate::strut::terms::{
    Bubbles, ChamberLaws, EntrainedAir, OilCount, held_at_static_density, taken_up_at_chamber_density,
};

/// The main chamber as the network sees it.
#[derive(Debug, Clone)]
pub(in crate::strut) struct Chamber<N: Number = f64> {
    /// Area of the piston, m2.
    pub area_m2: N,
    /// Oil volume at displacement zero, m3.
    pub oil_volume_m3: N,
    /// One over the bulk modulus, 1/Pa; 0 for rigid oil.
    pub compressibility_1_pa: N,
    /// Gauge pressure at which the strut stands, Pa.
    pub static_pa: N,
    counts_at_static_density: bool,
    air: Option<Bubbles<N>>,
    /// Volume that the mount's deflection adds, m3/Pa.
    mount_m3_pa: N,
    /// Unmodelled laws; `None` where the model has none.
    laws: Option<Box<ChamberLaws<N>>>,
}

/// What the chamber does between the beginning of a stage and a trial pressure at its end.
pub(super) struct TakenUp<N> {
    /// Volume taken up since the beginning of the stage, m3.
    pub volume_m3: N,
    /// Its derivative by the pressure, m3/Pa.
    pub slope: N,
    /// `State::held_m3` at the end.
    pub held_m3: N,
    /// Its derivative by the pressure, m3/Pa.
    pub held_slope: N,
    /// `State::compressed` at the end.
    pub compressed: N,
    /// Its derivative by the pressure, 1/Pa.
    pub compressed_slope: N,
}

impl Chamber {
    pub fn of(model: &StrutModel) -> Self {
        let effects = &model.effects;
        let oil = effects.oil_compressibility.as_ref();
        let area_m2 = model.piston_area_m2();
        Self {
            area_m2,
            oil_volume_m3: model.cylinder.oil_volume_m3,
            compressibility_1_pa: oil.map_or(0.0, |oil| 1.0 / oil.bulk_modulus_pa),
            static_pa: model.cylinder.static_pressure_pa,
            counts_at_static_density: oil.is_some_and(|oil| oil.counted_at == OilCount::Static),
            air: effects.entrained_air.as_ref().map(EntrainedAir::bubbles),
            mount_m3_pa: (effects.mount_compliance.as_ref())
                .map_or(0.0, |mount| mount.mount().volume_per_pressure_m3_pa(area_m2)),
            laws: (!effects.unlisted.is_empty()).then(|| Box::new(ChamberLaws::of(&effects.unlisted))),
        }
    }

    /// The chambers of several struts side by side, `like` any number of their kind; none where they differ in kind.
    pub fn abreast<N: Number>(chambers: &N::Each<&Self>, like: N) -> Option<Chamber<N>> {
        let all = chambers.as_ref();
        let of = |value: fn(&Self) -> f64| like.gather(|lane| value(all[lane]));
        let same = |kind: fn(&Self) -> bool| all.iter().all(|chamber| kind(chamber) == kind(all[0]));
        let alike = same(|chamber| chamber.counts_at_static_density) && same(|chamber| chamber.air.is_some());
        if !alike {
            return None;
        }
        let without = ChamberLaws::of(&[]);
        let laws = N::each(|lane| all[lane].laws.as_deref().unwrap_or(&without));
        let has_laws = all.iter().any(|chamber| chamber.laws.is_some());
        Some(Chamber {
            area_m2: of(|chamber| chamber.area_m2),
            oil_volume_m3: of(|chamber| chamber.oil_volume_m3),
            compressibility_1_pa: of(|chamber| chamber.compressibility_1_pa),
            static_pa: of(|chamber| chamber.static_pa),
            counts_at_static_density: all[0].counts_at_static_density,
            air: all[0].air.map(|_| Bubbles {
                volume_fraction: of(|chamber| chamber.air.map_or(0.0, |air| air.volume_fraction)),
                polytropic_exponent: of(|chamber| chamber.air.map_or(1.0, |air| air.polytropic_exponent)),
            }),
            mount_m3_pa: of(|chamber| chamber.mount_m3_pa),
            laws: has_laws.then(|| Box::new(ChamberLaws::abreast(&laws, like))),
        })
    }
}

impl<N: Number> Chamber<N> {
    #[inline(always)]
    fn laws<const LAWS: bool>(&self) -> Option<&ChamberLaws<N>> {
        if LAWS { self.laws.as_deref() } else { None }
    }

    /// Flow that the piston supplies to the chamber at a speed (m/s), less what the chamber loses at the time (s) and at the
    /// gauge pressure from which the stage starts, m3/s.
    #[inline(always)]
    pub fn supply_m3_s<const LAWS: bool>(&self, speed_m_s: N, p1_pa: N, time_s: N) -> N {
        let supply = self.area_m2 * speed_m_s;
        match self.laws::<LAWS>() {
            Some(laws) => supply - laws.loss(p1_pa, time_s),
            None => supply,
        }
    }

    /// Volume that the chamber holds at a gauge pressure beyond what it holds at static pressure, m3, and its derivative.
    #[inline(always)]
    pub fn held_m3<const LAWS: bool>(&self, p1_pa: N, displacement_m: N) -> (N, N) {
        let over = p1_pa - self.static_pa;
        let (mut volume, mut slope) = (self.mount_m3_pa * over, self.mount_m3_pa);
        if let Some((yields, by_force)) = self.mount_by_law::<LAWS>(self.area_m2 * over) {
            volume = volume + self.area_m2 * yields;
            slope = slope + self.area_m2 * self.area_m2 * by_force;
        }
        if self.counts_at_static_density {
            let oil = self.oil_volume_m3 - self.area_m2 * displacement_m;
            let (held, by_pressure) = held_at_static_density(oil, over, self.compressibility_1_pa);
            volume = volume + held;
            slope = slope + by_pressure;
            if let Some(air) = &self.air {
                let (left, shrinking) = air.volume(Gauge(p1_pa));
                volume = volume - self.oil_volume_m3 * left;
                slope = slope + self.oil_volume_m3 * shrinking;
            }
            if let Some((taken_up, by_pressure)) = self.volume_by_laws::<LAWS>(p1_pa) {
                volume = volume + taken_up;
                slope = slope + by_pressure;
            }
        }
        (volume, slope)
    }

    /// Fraction by which the chamber's content has been compressed at a gauge pressure, beyond what a constant bulk
    /// modulus makes of it, and its derivative, 1/Pa: undissolved air and an unmodelled compliance, where they are counted
    /// as the recordings' equation counts oil.
    #[inline(always)]
    pub fn compressed<const LAWS: bool>(&self, p1_pa: N) -> (N, N) {
        let (mut fraction, mut slope) = (p1_pa.of(0.0), p1_pa.of(0.0));
        if !self.counts_at_static_density {
            if let Some(air) = &self.air {
                let (left, shrinking) = air.volume(Gauge(p1_pa));
                fraction = fraction - left;
                slope = slope + shrinking;
            }
            if let Some((taken_up, by_pressure)) = self.volume_by_laws::<LAWS>(p1_pa) {
                fraction = fraction + taken_up / self.oil_volume_m3;
                slope = slope + by_pressure / self.oil_volume_m3;
            }
        }
        (fraction, slope)
    }

    /// By how much an unmodelled law lets the mount yield under a force above the static one (N), m, and its derivative, m/N.
    #[inline(always)]
    pub fn mount_by_law<const LAWS: bool>(&self, force_n: N) -> Option<(N, N)> {
        self.laws::<LAWS>()?.mount_m(force_n)
    }

    #[inline(always)]
    fn volume_by_laws<const LAWS: bool>(&self, p1_pa: N) -> Option<(N, N)> {
        self.laws::<LAWS>()?.volume(p1_pa)
    }

    /// What the chamber takes up from `base` to a gauge pressure. Differences of volumes: exact however far it moves.
    #[inline(always)]
    pub(super) fn taken_up<const LAWS: bool>(&self, base: &State<N>, p1_pa: N, displacement_m: N) -> TakenUp<N> {
        let (held_m3, held_slope) = self.held_m3::<LAWS>(p1_pa, displacement_m);
        let (mut volume_m3, mut slope) = (held_m3 - base.held_m3, held_slope);
        if !self.counts_at_static_density {
            let oil = self.oil_volume_m3 - self.area_m2 * displacement_m;
            let (taken_up, by_pressure) =
                taken_up_at_chamber_density(oil, p1_pa - base.p1_pa, self.compressibility_1_pa);
            volume_m3 = volume_m3 + taken_up;
            slope = slope + by_pressure;
        }
        let (compressed, compressed_slope) = self.compressed::<LAWS>(p1_pa);
        // Compressing takes up volume; where nothing but oil of constant bulk modulus is counted here, the slope is zero.
        let compresses = compressed_slope.abs().above(slope.of(0.0));
        if compresses.any() {
            let content = self.oil_volume_m3 - self.area_m2 * displacement_m;
            let more = volume_m3 + content * (compressed - base.compressed);
            volume_m3 = N::choose(compresses, more, volume_m3);
            slope = N::choose(compresses, slope + content * compressed_slope, slope);
        }
        TakenUp {
            volume_m3,
            slope,
            held_m3,
            held_slope,
            compressed,
            compressed_slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::gas::GasState;
    use crate::strut::network::law_memory::LawMemory;
    use crate::strut::terms::OilCompressibility;

    fn chamber(counted_at: OilCount) -> Chamber {
        let mut model = StrutModel::defender110(8000.0);
        model.effects.oil_compressibility = Some(OilCompressibility {
            bulk_modulus_pa: 1.5e9,
            counted_at,
        });
        Chamber::of(&model)
    }

    fn at(chamber: &Chamber, p1_pa: f64) -> State {
        let gas = GasState {
            volume_m3: 1e-4,
            temperature_k: 293.15,
        };
        State {
            p1_pa,
            gas: [gas; 2],
            held_m3: chamber.held_m3::<true>(p1_pa, 0.0).0,
            compressed: chamber.compressed::<true>(p1_pa).0,
            q2_m3_s: 0.0,
            shear: [0.0; 2],
            heat_j: [0.0; 2],
            laws: LawMemory::at_rest([1.0; 2]),
        }
    }

    #[test]
    fn both_ways_of_counting_take_up_the_same_for_a_small_rise_and_the_slope_is_that_of_the_volume() {
        for counted_at in [OilCount::Chamber, OilCount::Static] {
            let chamber = chamber(counted_at);
            let base = at(&chamber, chamber.static_pa);
            let volume = |p: f64| chamber.taken_up::<true>(&base, p, 0.0).volume_m3;
            assert_eq!(volume(base.p1_pa), 0.0);
            // Oil alone would be V dp / beta; half a per cent of air at 4 MPa adds less than a thousandth.
            let stiff = chamber.oil_volume_m3 * 1e4 / 1.5e9;
            assert!((volume(base.p1_pa + 1e4) / stiff - 1.0).abs() < 0.05);
            let h = 1e2;
            let quotient = (volume(base.p1_pa + h) - volume(base.p1_pa - h)) / (2.0 * h);
            assert!((chamber.taken_up::<true>(&base, base.p1_pa, 0.0).slope / quotient - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn what_is_counted_at_static_density_comes_back() {
        let chamber = chamber(OilCount::Static);
        let base = at(&chamber, chamber.static_pa);
        let up = chamber.taken_up::<true>(&base, 9e6, 0.04);
        let there = State {
            p1_pa: 9e6,
            held_m3: up.held_m3,
            compressed: up.compressed,
            ..base
        };
        let down = chamber.taken_up::<true>(&there, base.p1_pa, 0.0);
        assert!((up.volume_m3 + down.volume_m3).abs() < 1e-18);
    }
}
