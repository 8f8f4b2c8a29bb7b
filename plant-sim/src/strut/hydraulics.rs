//! What is solved implicitly in a step of a strut: oil, gas and mount; of one strut, or of several side by side.
//!
//! Stiff by nature: the main chamber (about 1e-12 m3/Pa behind 1e8 to 4e9 Pa s/m3) settles in 0.1 to 4 ms, gas in seconds.
//! Method: SDIRK2 (Alexander, SIAM J. Numer. Anal. 14(6), 1977), second order, L-stable, stiffly accurate, two equal
//! stages of `gamma h`, `gamma = 1 - 1/sqrt 2`. Each stage is solved by the network.

use oleo_interface::{StrutValves, Valve};

use super::model::StrutModel;
use super::network::{LastSolution, Network, StageEnd, State};
use super::terms::{Mount, PackCooling};
use crate::lanes::{LANES, Number};

/// `1 - 1/sqrt 2`.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
/// Shortest time within which a step supplies what the steps before it have left, s.
const LEAST_CATCH_UP_S: f64 = 1e-4;

/// What of it does not change while a strut works.
#[derive(Debug, Clone)]
pub(super) struct Hydraulics<N: Number = f64> {
    pub network: Network<N>,
    mount: Mount<N>,
    pub cooling: Option<PackCooling<N>>,
}

/// What of it is carried from one step to the next.
#[derive(Debug, Clone)]
pub(super) struct Flowing<N: Number = f64> {
    pub state: State<N>,
    pub last: LastSolution<N>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [N; 4],
    /// Displacement that the speeds given to the network add up to, m. The difference to the true one is made good in the
    /// next step, so that no oil is gained or lost over an hour.
    pub supplied_m: N,
}

/// One step as it is known beforehand.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Step<N = f64> {
    /// Time at which it begins, s.
    pub begins_s: N,
    /// Its length, s.
    pub duration_s: N,
    /// Displacement of the actuator at its beginning, m.
    pub from_m: N,
    /// Gauge pressure p1 at its beginning, Pa.
    pub from_p1_pa: N,
    /// Displacement, m, and speed, m/s, of the actuator at the end of the first stage.
    pub middle: [N; 2],
    /// The same at its end.
    pub end: [N; 2],
    /// Openings of the valves at the ends of both stages.
    pub opening: [StrutValves<N>; 2],
    /// Friction of the rod, N.
    pub friction_n: N,
}

impl Flowing {
    /// Those of several struts side by side, `like` any number of their kind.
    #[inline(always)]
    pub fn side_by_side<N: Number>(each: &N::Each<&Self>, like: N) -> Flowing<N> {
        let all = each.as_ref();
        Flowing {
            state: State::side_by_side(N::each(|lane| &all[lane].state).as_ref(), like),
            last: LastSolution::side_by_side(&N::each(|lane| &all[lane].last), like),
            pressure_pa: [
                like.gather_from(all, |f| f.pressure_pa[0]),
                like.gather_from(all, |f| f.pressure_pa[1]),
                like.gather_from(all, |f| f.pressure_pa[2]),
                like.gather_from(all, |f| f.pressure_pa[3]),
            ],
            supplied_m: like.gather_from(all, |f| f.supplied_m),
        }
    }
}

impl<N: Number> Flowing<N> {
    /// What stands in a lane.
    #[inline(always)]
    pub fn part(&self, lane: usize) -> Flowing {
        Flowing {
            state: self.state.part(lane),
            last: self.last.part(lane),
            pressure_pa: self.pressure_in(lane),
            supplied_m: self.supplied_m.lane(lane),
        }
    }

    /// Gauge pressures p1 to p4 in a lane, Pa.
    #[inline(always)]
    pub fn pressure_in(&self, lane: usize) -> [f64; 4] {
        [
            self.pressure_pa[0].lane(lane),
            self.pressure_pa[1].lane(lane),
            self.pressure_pa[2].lane(lane),
            self.pressure_pa[3].lane(lane),
        ]
    }
}

impl Step<[f64; LANES]> {
    /// Puts a step into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, step: &Step) {
        self.begins_s[lane] = step.begins_s;
        self.duration_s[lane] = step.duration_s;
        self.from_m[lane] = step.from_m;
        self.from_p1_pa[lane] = step.from_p1_pa;
        for i in 0..2 {
            self.middle[i][lane] = step.middle[i];
            self.end[i][lane] = step.end[i];
            self.opening[i][Valve::Bypass1][lane] = step.opening[i][Valve::Bypass1];
            self.opening[i][Valve::Bypass2][lane] = step.opening[i][Valve::Bypass2];
            self.opening[i][Valve::Spring][lane] = step.opening[i][Valve::Spring];
        }
        self.friction_n[lane] = step.friction_n;
    }

    /// What stands in a lane.
    #[inline(always)]
    pub fn part(&self, lane: usize) -> Step {
        let opening = |i: usize| {
            StrutValves::new(
                self.opening[i][Valve::Bypass1][lane],
                self.opening[i][Valve::Bypass2][lane],
                self.opening[i][Valve::Spring][lane],
            )
        };
        Step {
            begins_s: self.begins_s[lane],
            duration_s: self.duration_s[lane],
            from_m: self.from_m[lane],
            from_p1_pa: self.from_p1_pa[lane],
            middle: [self.middle[0][lane], self.middle[1][lane]],
            end: [self.end[0][lane], self.end[1][lane]],
            opening: [opening(0), opening(1)],
            friction_n: self.friction_n[lane],
        }
    }

    /// The lanes in vectors, `like` any number of their kind.
    #[inline(always)]
    pub fn in_vectors<N: Number>(&self, like: N) -> Step<N> {
        let of = |lanes: &[f64; LANES]| like.gather(|lane| lanes[lane]);
        let opening = |i: usize| {
            StrutValves::new(
                of(&self.opening[i][Valve::Bypass1]),
                of(&self.opening[i][Valve::Bypass2]),
                of(&self.opening[i][Valve::Spring]),
            )
        };
        Step {
            begins_s: of(&self.begins_s),
            duration_s: of(&self.duration_s),
            from_m: of(&self.from_m),
            from_p1_pa: of(&self.from_p1_pa),
            middle: [of(&self.middle[0]), of(&self.middle[1])],
            end: [of(&self.end[0]), of(&self.end[1])],
            opening: [opening(0), opening(1)],
            friction_n: of(&self.friction_n),
        }
    }
}

impl Hydraulics {
    pub fn of(model: &StrutModel) -> Self {
        let effects = &model.effects;
        Self {
            network: Network::of(model),
            mount: (effects.mount_compliance.as_ref()).map_or_else(Mount::default, |mount| mount.mount()),
            cooling: effects.damping_fade.as_ref().map(|fade| fade.cooling()),
        }
    }

    /// Those of several struts side by side, `like` any number of their kind; none where they differ in kind.
    pub fn abreast<N: Number>(struts: &N::Each<&Self>, like: N) -> Option<Hydraulics<N>> {
        let all = struts.as_ref();
        let of = |value: fn(&Self) -> f64| like.gather(|lane| value(all[lane]));
        if all.iter().any(|one| one.cooling.is_some() != all[0].cooling.is_some()) {
            return None;
        }
        Some(Hydraulics {
            network: Network::abreast(&N::each(|lane| &all[lane].network), like)?,
            mount: Mount {
                flexibility_m_n: of(|one| one.mount.flexibility_m_n),
            },
            cooling: all[0].cooling.map(|_| PackCooling {
                time_s: of(|one| one.cooling.map_or(1.0, |cooling| cooling.time_s)),
            }),
        })
    }
}

impl<N: Number> Hydraulics<N> {
    /// One step.
    #[inline(always)]
    pub fn step(&self, flowing: &mut Flowing<N>, step: &Step<N>) {
        if self.network.has_laws {
            self.step_with::<true>(flowing, step);
        } else {
            self.step_with::<false>(flowing, step);
        }
    }

    /// One step. `LAWS` says whether laws without a name are looked for, which takes time where there are none.
    #[inline(always)]
    fn step_with<const LAWS: bool>(&self, flowing: &mut Flowing<N>, step: &Step<N>) {
        let h = step.duration_s;
        let supplied_s = [h * (1.0 - GAMMA), h * GAMMA];
        let ends = self.stage_ends::<LAWS>(flowing, step);
        let mut base = flowing.state;
        let mut k = 0;
        // A loop, so that the compiler lays down a stage once.
        let last = loop {
            flowing.supplied_m = flowing.supplied_m + supplied_s[k] * ends[k].speed_m_s;
            let stage = self.network.stage::<LAWS>(&base, &ends[k], &mut flowing.last);
            if k == 1 {
                break stage;
            }
            base = base.blend::<LAWS>(&stage.state, (1.0 - GAMMA) / GAMMA);
            k = 1;
        };
        // Without a law its memory stays where it is.
        let laws = if LAWS { last.state.laws } else { flowing.state.laws };
        flowing.state = State { laws, ..last.state };
        flowing.pressure_pa = last.pressure_pa;
        if let Some(cooling) = &self.cooling {
            let [heat1, heat2] = flowing.state.heat_j;
            flowing.state.heat_j = [cooling.cooled(heat1, h), cooling.cooled(heat2, h)];
        }
    }

    #[inline(always)]
    fn stage_ends<const LAWS: bool>(&self, flowing: &Flowing<N>, step: &Step<N>) -> [StageEnd<N>; 2] {
        let h = step.duration_s;
        let hg = h * GAMMA;
        // What the speeds have not supplied so far is supplied evenly over this step, but not within an instant: a micrometre within a step of
        // less than a microsecond, which ends at a kink of a valve's movement, would be a blow.
        let owed_m_s = (step.from_m - flowing.supplied_m) / h.at_least(h.of(LEAST_CATCH_UP_S));
        // The mount bends under what the force exceeds the static one.
        let over_pa = flowing.state.p1_pa - self.network.chamber.static_pa;
        let over_n = step.friction_n + self.network.chamber.area_m2 * over_pa;
        let mut bent_m = self.mount.deflection_m(over_n);
        if let Some((yields_m, _)) = self.network.chamber.mount_by_law::<LAWS>(over_n) {
            bent_m = bent_m + yields_m;
        }
        let [middle_m, middle_m_s] = step.middle;
        let [end_m, end_m_s] = step.end;
        let [opening_middle, opening_end] = step.opening;
        let first = StageEnd {
            duration_s: hg,
            since_last_s: hg,
            time_s: step.begins_s + hg,
            displacement_m: middle_m - bent_m,
            speed_m_s: middle_m_s + owed_m_s,
            opening: opening_middle,
        };
        let second = StageEnd {
            duration_s: hg,
            since_last_s: h - hg,
            time_s: step.begins_s + h,
            displacement_m: end_m - bent_m,
            speed_m_s: end_m_s + owed_m_s,
            opening: opening_end,
        };
        [first, second]
    }
}
