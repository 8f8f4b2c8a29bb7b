//! The hydraulics of four struts in the vectors of the processor, and the way into them and out.

use pulp::Simd;

use super::hydraulics::{Flowing, Hydraulics, Step};
use super::integrator::Strut;
use crate::lanes::{Four, LANES, Number, each_lane};

/// Four struts, as far as their oil and gas go.
#[derive(Debug, Clone)]
pub(super) struct SideBySide<S: Simd> {
    simd: S,
    hydraulics: Hydraulics<Four<S>>,
    flowing: Flowing<Four<S>>,
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

    /// Takes the steps.
    #[inline(always)]
    pub fn step(&mut self) {
        self.simd.vectorize(TakeSteps {
            hydraulics: &self.hydraulics,
            like: Four::zero(self.simd),
            flowing: &mut self.flowing,
            steps: &self.steps,
        });
    }
}

fn gathered<S: Simd>(simd: S, struts: &[&Strut; LANES]) -> Flowing<Four<S>> {
    Flowing::side_by_side(&each_lane(|lane| &struts[lane].flowing), Four::zero(simd))
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
