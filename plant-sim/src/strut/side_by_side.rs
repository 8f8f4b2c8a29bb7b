//! The hydraulics and the dry friction of four struts in the vectors of the processor, and the way into them and out.

use pulp::Simd;

use super::hydraulics::{Flowing, Hydraulics, Step};
use super::integrator::Strut;
use super::rod_friction::{RodFriction, Stroke};
use crate::lanes::{Four, LANES, Number, each_lane};

/// Four struts, as far as their oil, gas and dry friction go.
#[derive(Debug, Clone)]
pub(super) struct SideBySide<S: Simd> {
    simd: S,
    hydraulics: Hydraulics<Four<S>>,
    flowing: Flowing<Four<S>>,
    /// What rubs at the rods; none where nothing does, or in one of them a law without a name.
    friction: Option<RodFriction<Four<S>>>,
    friction_n: [f64; LANES],
    /// The steps that are taken next, or were taken last.
    pub steps: Step<[f64; LANES]>,
}

impl<S: Simd> SideBySide<S> {
    /// Four struts in their present states; none where they differ in kind.
    pub fn of(simd: S, struts: &[&Strut; LANES]) -> Option<Self> {
        let hydraulics = Hydraulics::abreast(&struts.map(|strut| &strut.hydraulics), Four::zero(simd))?;
        Some(Self {
            simd,
            hydraulics,
            flowing: gathered(simd, struts),
            friction: friction_abreast(simd, struts),
            friction_n: [0.0; LANES],
            steps: Step::default(),
        })
    }

    /// Takes the states of the struts in.
    pub fn take_in(&mut self, struts: &[&Strut; LANES]) {
        self.flowing = gathered(self.simd, struts);
    }

    /// Gives a strut the state of a lane.
    pub fn take_out(&self, lane: usize, strut: &mut Strut) {
        strut.flowing = self.flowing.part(lane);
    }

    /// Tells a strut what it reads between steps of the state of a lane.
    #[inline(always)]
    pub fn tell(&self, lane: usize, strut: &mut Strut) {
        strut.flowing.pressure_pa = self.flowing.pressure_in(lane);
        strut.flowing.state.q2_m3_s = self.flowing.state.q2_m3_s.lane(lane);
    }

    /// Friction of a lane's rod after the step, N, where it was worked out here.
    #[inline(always)]
    pub fn friction_n(&self, lane: usize) -> Option<f64> {
        self.friction.as_ref().map(|_| self.friction_n[lane])
    }

    /// Takes the steps. A step is long, and compiled once for all who take one.
    #[inline(never)]
    pub fn step(&mut self) {
        self.simd.vectorize(TakeSteps {
            hydraulics: &self.hydraulics,
            like: Four::zero(self.simd),
            flowing: &mut self.flowing,
            steps: &self.steps,
        });
        if let Some(friction) = &self.friction {
            self.friction_n = self.simd.vectorize(Rub {
                friction,
                area_m2: self.hydraulics.network.chamber.area_m2,
                p1_pa: self.flowing.pressure_pa[0],
                steps: &self.steps,
            });
        }
    }
}

fn gathered<S: Simd>(simd: S, struts: &[&Strut; LANES]) -> Flowing<Four<S>> {
    Flowing::side_by_side(&each_lane(|lane| &struts[lane].flowing), Four::zero(simd))
}

fn friction_abreast<S: Simd>(simd: S, struts: &[&Strut; LANES]) -> Option<RodFriction<Four<S>>> {
    let [a, b, c, d] = struts.map(|strut| strut.rod.lawless_friction());
    let all = [a?, b?, c?, d?];
    (all.iter().any(|one| !one.is_none())).then(|| RodFriction::abreast(&all, Four::zero(simd)))
}

/// One step in each lane.
struct TakeSteps<'a, S: Simd> {
    hydraulics: &'a Hydraulics<Four<S>>,
    like: Four<S>,
    flowing: &'a mut Flowing<Four<S>>,
    steps: &'a Step<[f64; LANES]>,
}

impl<S: Simd> pulp::NullaryFnOnce for TakeSteps<'_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let step = self.steps.in_vectors(self.like);
        self.hydraulics.step(self.flowing, &step);
    }
}

/// What rubs during the step in each lane.
struct Rub<'a, S: Simd> {
    friction: &'a RodFriction<Four<S>>,
    area_m2: Four<S>,
    p1_pa: Four<S>,
    steps: &'a Step<[f64; LANES]>,
}

impl<S: Simd> pulp::NullaryFnOnce for Rub<'_, S> {
    type Output = [f64; LANES];

    #[inline(always)]
    fn call(self) -> [f64; LANES] {
        let of = |lanes: &[f64; LANES]| self.p1_pa.gather(|lane| lanes[lane]);
        let displacement_m = of(&self.steps.end[0]);
        let rod = Stroke {
            stroke_m: displacement_m - of(&self.steps.from_m),
            duration_s: of(&self.steps.duration_s),
            displacement_m,
            oil_forces_n: [of(&self.steps.from_p1_pa), self.p1_pa].map(|p1_pa| self.area_m2 * p1_pa),
        };
        self.friction.after_n(of(&self.steps.friction_n), &rod).into_array()
    }
}
