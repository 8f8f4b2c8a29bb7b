//! Compares the pressures of one strut with each other.
//!
//! At rest p1, p2 and p3 are equal, and p4 too behind an open valve 3, because dampers and orifices cause a pressure drop only
//! while oil moves. In motion the *means* over a second still agree, except for the asymmetry of the damper packs (rebound takes
//! about twice as much as jounce, estimated 0.4 MPa at 0.5 m/s). So lagged pressures are compared, and one that differs by more
//! than 1 MPa from two that agree is wrong. An offset of `d` is seen after `tau ln(d / (d - 1 MPa))` and 0.2 s of
//! confirmation, which is 1.1 s for 1.7 MPa and 0.5 s for 4 MPa. After a start the lag is the mean of what was seen, and nothing is
//! called wrong in its first second. This check calls no pressure wrong that is off by less.
//!
//! A p1 that is off by less is taken for what the strut carries, though, and four of them for a bend. So what p1 shows beyond the
//! median of p1, p2 and p3 in the mean is taken off it where the force of the strut is estimated ([`Vote::p1_offset_pa`]): one of the
//! three that is wrong never is the median of the three. What motion alone can make of it stays: [`EXPLAINED_PA`].

use oleo_interface::{Gauge, PressurePoint, StrutPressures};

use super::turn::{TURN_S, turns};
use super::verdict::{Place, Verdicts};
use crate::failsafe::FaultCode;
use crate::filter::LowPass;

const DISAGREE_PA: f32 = 1.0e6;
/// A pressure that was outvoted is believed again when it is this near to another one. For p4 that takes an open valve 3: a
/// verdict about it stays until it can be compared again.
const AGREE_PA: f32 = 0.6e6;
const CONFIRM_TURNS: u8 = turns(200);
/// Time constant of the mean in which p1 and the others agree, s. Rolling into a bend through closed dampers, p1 and p2 are 1 to
/// 2 MPa apart for half a second, which is no offset.
const OFFSET_S: f32 = 2.0;
/// Turns after a start in which nothing is called wrong. Until then the lagged pressures are the means of what was seen: through closed
/// dampers two samples of a strut in motion are 2 MPa apart, and the means over a second are not.
const KNOWN_TURNS: u8 = turns(1_000);
/// Turns of a corner from one look at the offset to the next: a mean over 2 s needs no more.
pub const OFFSET_TURNS: u8 = 4;
/// Difference of p1 in the mean that the asymmetry of the dampers explains, Pa.
const EXPLAINED_PA: f32 = 0.1e6;

/// The lag of the compared pressures, and that of the offset of p1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    lag: LowPass,
    offset: LowPass,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            lag: LowPass::sampled(TURN_S, 1.0),
            offset: LowPass::sampled(OFFSET_TURNS as f32 * TURN_S, OFFSET_S),
        }
    }
}

/// State of the vote on one strut.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Vote {
    lagged: StrutPressures<Gauge<f32>>,
    /// What p1 shows beyond the median, in the mean, Pa.
    p1_beyond_pa: f32,
    outvoted: StrutPressures<u8>,
    flagged: StrutPressures<bool>,
    /// Turns since all four pressures are measured, up to [`KNOWN_TURNS`].
    turns: u8,
    /// Looks at the offset since the controller has started; it saturates.
    looks: u8,
}

impl Vote {
    pub const INITIAL: Self = Self {
        lagged: StrutPressures::splat(Gauge(0.0)),
        p1_beyond_pa: 0.0,
        outvoted: StrutPressures::splat(0),
        flagged: StrutPressures::splat(false),
        turns: 0,
        looks: 0,
    };

    /// One turn. `p4_follows` says whether valve 3 has been open for so long that p4 follows p1.
    pub fn step(
        &mut self,
        parameters: &Parameters,
        pressure: &StrutPressures<Gauge<f32>>,
        p4_follows: bool,
        verdict: &mut Verdicts,
    ) {
        if !verdict.pressures_are_good() {
            // A replaced value says nothing about the others: start again when all four are measured. A verdict that was
            // reached before stays.
            self.turns = 0;
        } else {
            if self.turns < KNOWN_TURNS {
                self.turns += 1;
            }
            let part = parameters.lag.growing(f32::from(self.turns));
            for (Gauge(lagged), pressure) in self.lagged.each_mut().zip(*pressure).into_array() {
                *lagged += part * (pressure.pa() - *lagged);
            }
            // Behind a closed valve 3 the pressure p4 need not agree; when the valve has opened, the comparison starts again.
            if !p4_follows {
                self.lagged.p4 = self.lagged.p3;
            }
        }
        let StrutPressures { p1, p2, p3, p4 } = self.lagged;
        let apart = |a: Gauge<f32>, b: Gauge<f32>| (a - b).abs() > DISAGREE_PA;
        let (d12, d13, d23) = (apart(p1, p2), apart(p1, p3), apart(p2, p3));
        let wrong = StrutPressures {
            p1: d12 && d13 && !d23,
            p2: d12 && d23 && !d13,
            p3: d13 && d23 && !d12,
            p4: p4_follows && apart(p4, p3) && !(d13 && d23),
        };
        // Most turns end here: no pressure is or was outvoted. A flag falls when its count reaches 0, so none is set.
        let known = self.turns == KNOWN_TURNS;
        if self.outvoted == StrutPressures::splat(0) && !(known && wrong != StrutPressures::splat(false)) {
            return;
        }
        *verdict = self.judge(known, p4_follows, wrong, *verdict);
    }

    /// One of [`OFFSET_TURNS`] turns, after the step; returns what p1 shows in the mean beyond what it measures, Pa.
    #[inline(never)]
    pub fn p1_offset_pa(&mut self, parameters: &Parameters) -> f32 {
        if self.turns > 0 {
            let StrutPressures { p1, p2, p3, .. } = self.lagged;
            let beyond_pa = p1.pa() - median(p1.pa(), p2.pa(), p3.pa());
            self.looks = self.looks.saturating_add(1);
            let part = parameters.offset.growing(f32::from(self.looks));
            self.p1_beyond_pa += part * (beyond_pa - self.p1_beyond_pa);
        }
        if self.p1_beyond_pa.abs() < EXPLAINED_PA {
            return 0.0;
        }
        self.p1_beyond_pa - EXPLAINED_PA.copysign(self.p1_beyond_pa)
    }

    /// Counts for and against each pressure, where one is or was outvoted; returns the verdict with what that leads to.
    #[inline(never)]
    fn judge(&mut self, known: bool, p4_follows: bool, wrong: StrutPressures<bool>, mut verdict: Verdicts) -> Verdicts {
        let StrutPressures { p1, p2, p3, p4 } = self.lagged;
        let near = |a: Gauge<f32>, b: Gauge<f32>| (a - b).abs() < AGREE_PA;
        let agrees = StrutPressures {
            p1: near(p1, p2) || near(p1, p3),
            p2: near(p2, p1) || near(p2, p3),
            p3: near(p3, p1) || near(p3, p2),
            p4: p4_follows && near(p4, p3),
        };
        for point in PressurePoint::ALL {
            let (count, flagged) = (&mut self.outvoted[point], &mut self.flagged[point]);
            if known {
                count_votes(count, flagged, wrong[point], agrees[point]);
            }
            if *flagged {
                verdict.blame(Place::of(point), FaultCode::SensorVote);
            }
        }
        verdict
    }
}

/// Counts the turns in which a pressure was outvoted, and those in which it was not, until it is called wrong or believed again.
#[inline(never)]
fn count_votes(count: &mut u8, flagged: &mut bool, wrong: bool, agrees: bool) {
    *count = if wrong {
        count.saturating_add(1).min(CONFIRM_TURNS)
    } else if !*flagged || agrees {
        count.saturating_sub(1)
    } else {
        *count
    };
    if *count == CONFIRM_TURNS {
        *flagged = true;
    } else if *count == 0 {
        *flagged = false;
    }
}

/// The one of three numbers that is neither the greatest nor the least.
fn median(a: f32, b: f32, c: f32) -> f32 {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    if c < low {
        low
    } else if c > high {
        high
    } else {
        c
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outvoted(verdict: &Verdicts) -> bool {
        Verdicts::gravest(&[*verdict]) == FaultCode::SensorVote
    }

    /// The first turn in which a pressure is outvoted, on a strut that is shaken through closed dampers: p1 swings by 2 MPa
    /// about p2 at 8 Hz, and p3 has an offset.
    fn shaken(vote: &mut Vote, turns: core::ops::Range<u16>, offset_pa: f32) -> Option<u16> {
        let parameters = Parameters::default();
        for turn in turns {
            let swing = 2.0e6 * libm::cosf(2.0 * core::f32::consts::PI * 8.0 * f32::from(turn) * TURN_S);
            let mut verdict = Verdicts::GOOD;
            let pressure = StrutPressures {
                p1: 4.0e6 + swing,
                p2: 4.0e6,
                p3: 4.0e6 + offset_pa,
                p4: 4.0e6,
            };
            vote.step(&parameters, &pressure.map(Gauge), false, &mut verdict);
            if outvoted(&verdict) {
                return Some(turn);
            }
        }
        None
    }

    #[test]
    fn a_strut_in_motion_is_no_disagreement_whenever_the_vote_begins() {
        for phase in 0..25 {
            let mut vote = Vote::INITIAL;
            assert_eq!(shaken(&mut vote, phase..phase + 1000, 0.0), None, "phase {phase}");
        }
    }

    /// What is taken off p1 after 30 s on a strut that is shaken through closed dampers, Pa, with an offset of each of p1 to p3.
    fn taken_off_pa(offset_pa: [f32; 3]) -> f32 {
        let (parameters, mut vote, mut taken_off_pa) = (Parameters::default(), Vote::INITIAL, 0.0);
        let [p1, p2, p3] = offset_pa.map(|offset_pa| 4.0e6 + offset_pa);
        for turn in 0..1500_u16 {
            let swing = 2.0e6 * libm::cosf(2.0 * core::f32::consts::PI * 8.0 * f32::from(turn) * TURN_S);
            let pressure = StrutPressures {
                p1: p1 + swing,
                p2,
                p3,
                p4: p3,
            };
            let mut verdict = Verdicts::GOOD;
            vote.step(&parameters, &pressure.map(Gauge), false, &mut verdict);
            assert!(!outvoted(&verdict), "{offset_pa:?} in turn {turn}");
            if turn % u16::from(OFFSET_TURNS) == 0 {
                taken_off_pa = vote.p1_offset_pa(&parameters);
            }
        }
        taken_off_pa
    }

    #[test]
    fn a_small_offset_of_p1_is_taken_off_and_none_of_the_others() {
        for offset_pa in [0.5e6, 0.9e6, -0.5e6, -0.9e6] {
            let sign = f32::signum(offset_pa);
            let off_pa = taken_off_pa([offset_pa, 0.0, 0.0]);
            assert!(
                (off_pa - offset_pa + sign * EXPLAINED_PA).abs() < 0.05e6,
                "{offset_pa}: {off_pa}"
            );
            assert_eq!(taken_off_pa([0.0, offset_pa, 0.0]), 0.0);
            assert_eq!(taken_off_pa([0.0, 0.0, offset_pa]), 0.0);
            assert_eq!(taken_off_pa([offset_pa; 3]), 0.0);
        }
        assert_eq!(taken_off_pa([0.05e6, 0.0, 0.0]), 0.0);
    }

    /// On a vehicle at rest the first look is enough.
    #[test]
    fn an_offset_from_power_on_is_known_at_once() {
        let (parameters, mut vote) = (Parameters::default(), Vote::INITIAL);
        // Before all pressures are measured there is nothing to look at.
        assert_eq!(vote.p1_offset_pa(&parameters), 0.0);
        for _ in 0..3 {
            turn(&mut vote, &resting(PressurePoint::P1, 0.9e6), false);
            assert!((vote.p1_offset_pa(&parameters) - (0.9e6 - EXPLAINED_PA)).abs() < 1.0);
        }
    }

    #[test]
    fn the_median_is_neither_the_greatest_nor_the_least() {
        for [a, b, c] in [
            [1.0, 2.0, 3.0],
            [1.0, 3.0, 2.0],
            [2.0, 1.0, 3.0],
            [2.0, 3.0, 1.0],
            [3.0, 1.0, 2.0],
            [3.0, 2.0, 1.0],
        ] {
            assert_eq!(median(a, b, c), 2.0);
        }
        assert_eq!(median(1.0, 1.0, 5.0), 1.0);
    }

    #[test]
    fn begins_again_from_agreement_after_silence() {
        let parameters = Parameters::default();
        let mut vote = Vote::INITIAL;
        assert_eq!(shaken(&mut vote, 0..500, 0.0), None);
        let mut silent = Verdicts::GOOD;
        for point in PressurePoint::ALL {
            silent.blame(Place::of(point), FaultCode::MessageLost);
        }
        vote.step(&parameters, &StrutPressures::default(), false, &mut silent);
        assert_eq!(shaken(&mut vote, 0..1000, 0.0), None);
    }

    #[test]
    fn an_offset_is_seen_within_the_documented_time() {
        // tau ln(d / (d - 1 MPa)) with tau = 1 s, and 0.2 s: 1.09 s for 1.7 MPa.
        let seen = shaken(&mut { Vote::INITIAL }, 0..1000, 1.7e6);
        assert!(seen.is_some_and(|turn| (50..75).contains(&turn)), "{seen:?}");
    }

    #[test]
    fn oil_trapped_behind_valve_3_is_no_disagreement_when_the_valve_has_opened() {
        let parameters = Parameters::default();
        let mut vote = Vote::INITIAL;
        for turn in 0..375 {
            // Trapped 3 MPa apart for 2.5 s; equal once the valve is settled open.
            let open = turn >= 125;
            let p4 = if open { 4.0e6 } else { 7.0e6 };
            let mut verdict = Verdicts::GOOD;
            let pressure = StrutPressures {
                p4,
                ..StrutPressures::splat(4.0e6)
            };
            vote.step(&parameters, &pressure.map(Gauge), open, &mut verdict);
            assert!(!outvoted(&verdict), "turn {turn}");
        }
    }

    /// Pressures at rest, of which one has an offset.
    fn resting(point: PressurePoint, offset_pa: f32) -> StrutPressures<Gauge<f32>> {
        let mut pressure = StrutPressures::splat(Gauge(4.0e6));
        pressure[point] = Gauge(4.0e6 + offset_pa);
        pressure
    }

    /// What the vote says in a turn.
    fn turn(vote: &mut Vote, pressure: &StrutPressures<Gauge<f32>>, p4_follows: bool) -> Verdicts {
        let mut verdict = Verdicts::GOOD;
        vote.step(&Parameters::default(), pressure, p4_follows, &mut verdict);
        verdict
    }

    /// The verdict that blames one pressure alone.
    fn only(point: PressurePoint) -> Verdicts {
        let mut verdict = Verdicts::GOOD;
        verdict.blame(Place::of(point), FaultCode::SensorVote);
        verdict
    }

    /// Turns until the verdict is as wanted; before, it is always as it was.
    fn turns_until(wanted: Verdicts, before: Verdicts, mut step: impl FnMut() -> Verdicts) -> Option<u16> {
        (1..2000).find(|turn| {
            let said = step();
            assert!(said == wanted || said == before, "turn {turn}: {said:?}");
            said == wanted
        })
    }

    /// A vote that has agreed for a while.
    fn agreeing() -> Vote {
        let mut vote = Vote::INITIAL;
        for _ in 0..100 {
            assert_eq!(turn(&mut vote, &resting(PressurePoint::P1, 0.0), true), Verdicts::GOOD);
        }
        vote
    }

    /// `ln(d / (d - 1 MPa))` seconds and 0.2 s, for each pressure and both signs. Below 1 MPa never.
    #[test]
    fn each_pressure_is_outvoted_alone_and_in_time() {
        for point in PressurePoint::ALL {
            for offset_pa in [1.05e6, 1.7e6, 4.0e6] {
                let expected_s = libm::logf(offset_pa / (offset_pa - 1.0e6)) + 0.2;
                for offset_pa in [offset_pa, -offset_pa] {
                    let mut vote = agreeing();
                    let found = turns_until(only(point), Verdicts::GOOD, || {
                        turn(&mut vote, &resting(point, offset_pa), true)
                    });
                    let found_s = f32::from(found.unwrap()) * TURN_S;
                    assert!(
                        (found_s - expected_s).abs() < 0.06,
                        "{point:?} {offset_pa}: {found_s} of {expected_s} s"
                    );
                }
            }
            let mut vote = agreeing();
            assert!((0..2000).all(|_| turn(&mut vote, &resting(point, 0.95e6), true) == Verdicts::GOOD));
        }
    }

    /// It stays so above 0.6 MPa, and ends `ln((d - e) / (0.6 MPa - e))` seconds and 0.2 s after the offset has become `e`.
    #[test]
    fn an_outvoted_pressure_is_believed_when_it_agrees_again() {
        for point in PressurePoint::ALL {
            let mut vote = agreeing();
            for _ in 0..400 {
                turn(&mut vote, &resting(point, 1.5e6), true);
            }
            assert!(
                (0..1000).all(|_| turn(&mut vote, &resting(point, 0.7e6), true) == only(point)),
                "{point:?}"
            );
            let back = turns_until(Verdicts::GOOD, only(point), || {
                turn(&mut vote, &resting(point, 0.4e6), true)
            });
            let (back_s, expected_s) = (f32::from(back.unwrap()) * TURN_S, libm::logf(0.3 / 0.2) + 0.2);
            assert!(
                (back_s - expected_s).abs() < 0.06,
                "{point:?}: {back_s} of {expected_s} s"
            );
        }
    }

    #[test]
    fn p4_is_compared_behind_an_open_valve_only_and_its_verdict_waits_for_one() {
        let mut vote = agreeing();
        assert!((0..500).all(|_| turn(&mut vote, &resting(PressurePoint::P4, 3.0e6), false) == Verdicts::GOOD));
        let p4 = only(PressurePoint::P4);
        assert!(
            turns_until(p4, Verdicts::GOOD, || turn(
                &mut vote,
                &resting(PressurePoint::P4, 3.0e6),
                true
            ))
            .is_some()
        );
        assert!((0..500).all(|_| turn(&mut vote, &resting(PressurePoint::P4, 0.0), false) == p4));
        assert!(
            turns_until(Verdicts::GOOD, p4, || turn(
                &mut vote,
                &resting(PressurePoint::P4, 0.0),
                true
            ))
            .is_some()
        );
    }

    #[test]
    fn where_no_two_agree_nobody_is_outvoted() {
        let mut vote = agreeing();
        let apart = StrutPressures::from_array([4.0e6, 6.0e6, 8.0e6, 4.0e6]).map(Gauge);
        assert!((0..1000).all(|_| turn(&mut vote, &apart, false) == Verdicts::GOOD));
    }

    /// A pressure that is found wrong otherwise ends the comparison, and what was said before stays.
    #[test]
    fn a_verdict_outlives_a_gap_in_the_measurement() {
        let mut vote = agreeing();
        for _ in 0..400 {
            turn(&mut vote, &resting(PressurePoint::P2, 1.5e6), true);
        }
        for _ in 0..500 {
            let mut verdict = Verdicts::GOOD;
            verdict.blame(Place::P1, FaultCode::SensorRange);
            vote.step(
                &Parameters::default(),
                &resting(PressurePoint::P2, 0.0),
                true,
                &mut verdict,
            );
            assert!(!verdict.is_good(Place::P2));
        }
    }

    /// p1, p2, p3 in MPa above p4.
    fn spread(mpa: [f32; 3]) -> StrutPressures<Gauge<f32>> {
        let [p1, p2, p3] = mpa.map(|mpa| 4.0e6 + 1.0e6 * mpa);
        StrutPressures { p1, p2, p3, p4: 4.0e6 }.map(Gauge)
    }

    const POINTS: [PressurePoint; 3] = [PressurePoint::P1, PressurePoint::P2, PressurePoint::P3];

    /// A pair that disagrees does not say which of the two is wrong.
    #[test]
    fn one_pair_apart_outvotes_nobody() {
        for middle in 0..3 {
            for sign in [1.0, -1.0] {
                let mut mpa = [0.65 * sign, -0.65 * sign, 0.0];
                mpa.rotate_right(middle);
                let mut vote = agreeing();
                assert!(
                    (0..1000).all(|_| turn(&mut vote, &spread(mpa), false) == Verdicts::GOOD),
                    "{mpa:?}"
                );
            }
        }
    }

    /// One neighbour that is near is enough to be believed again.
    #[test]
    fn an_outvoted_pressure_needs_one_that_agrees() {
        for (n, point) in POINTS.into_iter().enumerate() {
            for near in (0..3).filter(|near| *near != n) {
                let far = 3 - n - near;
                let mut vote = agreeing();
                let mut mpa = [0.0; 3];
                mpa[n] = 1.5;
                for _ in 0..400 {
                    turn(&mut vote, &spread(mpa), false);
                }
                (mpa[n], mpa[far]) = (0.45, -0.45);
                assert_eq!(turn(&mut vote, &spread(mpa), false), only(point));
                assert!(
                    (0..400).any(|_| turn(&mut vote, &spread(mpa), false) == Verdicts::GOOD),
                    "{point:?} near {near}"
                );
            }
        }
    }

    /// p3 stands against p1, but p2 agrees with it: p4 is compared with p3 all the same.
    #[test]
    fn p4_is_outvoted_beside_another_one() {
        let mut vote = agreeing();
        let mut pressure = resting(PressurePoint::P4, 2.0e6);
        pressure.p1 = Gauge(1.0e6);
        let said = (0..200)
            .map(|_| turn(&mut vote, &pressure, true))
            .last()
            .unwrap_or_default();
        assert_eq!(
            (
                Verdicts::count(&[said]),
                said.is_good(Place::P1),
                said.is_good(Place::P4)
            ),
            (2, false, false)
        );
        // Where p3 is the one that stands alone, p4 is not.
        let mut vote = agreeing();
        for _ in 0..500 {
            let said = turn(&mut vote, &resting(PressurePoint::P3, 2.0e6), true);
            assert!(said == Verdicts::GOOD || said == only(PressurePoint::P3));
        }
    }

    /// What was lagged before a gap says nothing: the comparison begins again, and is sure after a second and 0.2 s.
    #[test]
    fn a_gap_forgets_the_disagreement_before_it() {
        let mut vote = agreeing();
        for _ in 0..500 {
            assert_eq!(
                turn(&mut vote, &resting(PressurePoint::P2, 0.95e6), false),
                Verdicts::GOOD
            );
        }
        let mut verdict = Verdicts::GOOD;
        verdict.blame(Place::P1, FaultCode::SensorRange);
        vote.step(
            &Parameters::default(),
            &resting(PressurePoint::P2, 0.95e6),
            false,
            &mut verdict,
        );
        let found = turns_until(only(PressurePoint::P2), Verdicts::GOOD, || {
            turn(&mut vote, &resting(PressurePoint::P2, 1.05e6), false)
        });
        assert_eq!(found, Some(u16::from(KNOWN_TURNS + CONFIRM_TURNS) - 1));
    }
}
