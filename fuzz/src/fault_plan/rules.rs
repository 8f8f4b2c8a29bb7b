//! What must hold in every tick, whatever goes wrong.
//!
//! The rules are those of `docs/safety.md` and of the module `failsafe`, written down a second time from what an observer sees: mode,
//! fault, commanded and driven valves, and what was done to the controller. They do not call the code that they judge.

use oleo_controller::{FaultCode, Mode};

/// Ticks of a second and of a minute.
const SECOND: u32 = 200;
const MINUTE: u32 = 60 * SECOND;
const MOST_SWITCHINGS_A_SECOND: usize = 10;
const MOST_MODE_CHANGES_A_MINUTE: usize = 16;
/// Ticks without a frame that is accepted after which a message is lost.
pub const TIMEOUT: u32 = 4;
/// Ticks of missing readings after which a reading counts as missing.
const CONFIRM: u32 = 3;
/// First tick of a closed mode in which the output stage has closed whatever became of the commands: the last one of an open mode is
/// obeyed if it is at most 2 ticks late, and then for the time-out.
const SURELY_CLOSED: u32 = 2 + TIMEOUT;
/// The valves 3 in a word.
const SPRINGS: u16 = 0b100_100_100_100;
/// The valves of the front axle in a word.
const FRONT: u16 = 0b111_111;

/// A restart of the controller before a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restart {
    /// The latch, if there was one, was kept.
    Reset,
    /// Nothing was kept.
    PowerCycle,
    /// A latch for a failure of its own arithmetic was kept.
    AfterInternalFault,
}

/// What an observer sees of a tick, and what was done to the controller in it.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Number of the tick.
    pub tick: u32,
    /// Mode and fault that the controller states.
    pub mode: Mode,
    /// First cause of the mode.
    pub fault: FaultCode,
    /// Valves that the controller commands.
    pub commanded: u16,
    /// Valves that the output stage drives.
    pub driven: u16,
    /// Whether every estimate is a finite number.
    pub finite: bool,
    /// What happened before the tick.
    pub restart: Option<Restart>,
    /// The controller has heard a frame under an identifier of its own.
    pub own_identifier: bool,
    /// A solenoid pin has reported an error.
    pub solenoid_failed: bool,
    /// Number of ticks for which no sensor frame has reached the controller.
    pub sensors_silent: u32,
    /// Number of ticks for which no command has reached the output stage.
    pub commands_silent: u32,
    /// Largest number of ticks in a row for which a sensor has said that it has no value of one of its readings, on a bus that had been
    /// without faults for the time-out before: so long right frames may be refused because they do not follow from a wrong one.
    pub reading_missing: u32,
}

/// What must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// In a closed mode the controller commands all valves closed.
    ClosedModeIsClosed,
    /// The output stage has closed all valves a few ticks after a closed mode began.
    OutputStageCloses,
    /// Without commands for the time-out the output stage closes all valves.
    OutputStageTimesOut,
    /// In `Degraded` all springs and one axle are closed, and a command has twelve bits.
    WordIsLegal,
    /// The controller switches no valve more than ten times in a second.
    CommandDoesNotChatter,
    /// The output stage switches none more often either.
    DriveDoesNotChatter,
    /// The mode changes at most sixteen times in a minute.
    ModeDoesNotChatter,
    /// `Latched` ends with a power cycle and with nothing else, and keeps its fault.
    LatchHolds,
    /// A mode after the first `Normal` names its fault; `Normal` names none.
    FaultIsNamed,
    /// Every estimate is finite, so no arithmetic fails.
    ArithmeticIsFinite,
    /// Without sensor frames for the time-out the mode is closed.
    SilenceCloses,
    /// A frame under the controller's own identifier closes in the same tick.
    ForeignSenderCloses,
    /// A failed solenoid latches in the same tick.
    SolenoidLatches,
    /// A missing reading is not normal from its third tick on.
    MissingReadingRestricts,
}

impl Rule {
    /// All rules.
    pub const ALL: [Self; 14] = [
        Self::ClosedModeIsClosed,
        Self::OutputStageCloses,
        Self::OutputStageTimesOut,
        Self::WordIsLegal,
        Self::CommandDoesNotChatter,
        Self::DriveDoesNotChatter,
        Self::ModeDoesNotChatter,
        Self::LatchHolds,
        Self::FaultIsNamed,
        Self::ArithmeticIsFinite,
        Self::SilenceCloses,
        Self::ForeignSenderCloses,
        Self::SolenoidLatches,
        Self::MissingReadingRestricts,
    ];
}

/// A rule that did not hold, and what was seen then.
#[derive(Clone, Copy, Debug)]
pub struct Broken {
    /// The rule.
    pub rule: Rule,
    /// The tick in which it did not hold.
    pub seen: Observation,
}

/// The rules with what they must remember.
#[derive(Clone, Debug)]
pub struct Rules {
    before: Option<(Mode, FaultCode, u16, u16)>,
    /// Number of ticks for which the mode has been closed.
    closed: u32,
    commanded: [Last<{ MOST_SWITCHINGS_A_SECOND + 1 }>; 12],
    driven: [Last<{ MOST_SWITCHINGS_A_SECOND + 1 }>; 12],
    modes: Last<{ MOST_MODE_CHANGES_A_MINUTE + 1 }>,
}

/// The times of the last `N` occurrences.
#[derive(Clone, Copy, Debug)]
struct Last<const N: usize> {
    times: [Option<u32>; N],
    oldest: usize,
}

impl<const N: usize> Last<N> {
    const NONE: Self = Self {
        times: [None; N],
        oldest: 0,
    };

    /// Notes an occurrence; returns whether `N` of them lie within so many ticks.
    fn add(&mut self, tick: u32, span: u32) -> bool {
        self.times[self.oldest] = Some(tick);
        self.oldest = (self.oldest + 1) % N;
        self.times[self.oldest].is_some_and(|first| tick - first < span)
    }
}

fn is_closed(mode: Mode) -> bool {
    matches!(mode, Mode::StartUp | Mode::Safe | Mode::Latched)
}

/// Notes the valves that have switched; returns whether one of them did so too often.
fn chatters(valves: &mut [Last<{ MOST_SWITCHINGS_A_SECOND + 1 }>; 12], changed: u16, tick: u32) -> bool {
    let mut too_often = false;
    for (bit, last) in valves.iter_mut().enumerate() {
        too_often |= changed >> bit & 1 == 1 && last.add(tick, SECOND);
    }
    too_often
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            before: None,
            closed: 0,
            commanded: [Last::NONE; 12],
            driven: [Last::NONE; 12],
            modes: Last::NONE,
        }
    }
}

impl Rules {
    /// Judges a tick.
    ///
    /// # Errors
    /// The first rule that does not hold.
    pub fn check(&mut self, seen: &Observation) -> Result<(), Broken> {
        let (mode_before, fault_before, commanded_before, driven_before) =
            self.before.unwrap_or((Mode::StartUp, FaultCode::None, 0, 0));
        if seen.restart.is_some() {
            // The controller's own limits begin anew; those of the output stage do not.
            self.commanded = [Last::NONE; 12];
            self.modes = Last::NONE;
        }
        let commanded_before = if seen.restart.is_some() { 0 } else { commanded_before };
        self.closed = if is_closed(seen.mode) { self.closed + 1 } else { 0 };
        let latched = mode_before == Mode::Latched && seen.restart != Some(Restart::PowerCycle);
        let latch_holds = if latched {
            (seen.mode, seen.fault) == (Mode::Latched, fault_before)
        } else {
            seen.mode == Mode::Latched || seen.restart != Some(Restart::AfterInternalFault)
        };
        let mode_changed = seen.mode != mode_before && seen.restart.is_none();
        let legal_in_degraded =
            seen.commanded & SPRINGS == 0 && (seen.commanded & FRONT == 0 || seen.commanded & !FRONT == 0);
        // No input makes the controller's own arithmetic fail: that fault can only be kept from before.
        let kept_internal =
            seen.restart == Some(Restart::AfterInternalFault) || (latched && fault_before == seen.fault);
        let new_internal = seen.fault == FaultCode::Internal && !kept_internal;
        self.before = Some((seen.mode, seen.fault, seen.commanded, seen.driven));
        let holds = [
            (Rule::ClosedModeIsClosed, !is_closed(seen.mode) || seen.commanded == 0),
            (Rule::OutputStageCloses, self.closed < SURELY_CLOSED || seen.driven == 0),
            (
                Rule::OutputStageTimesOut,
                seen.commands_silent < TIMEOUT || seen.driven == 0,
            ),
            (
                Rule::WordIsLegal,
                seen.commanded >> 12 == 0
                    && seen.driven >> 12 == 0
                    && (seen.mode != Mode::Degraded || legal_in_degraded),
            ),
            (
                Rule::CommandDoesNotChatter,
                !chatters(&mut self.commanded, seen.commanded ^ commanded_before, seen.tick),
            ),
            (
                Rule::DriveDoesNotChatter,
                !chatters(&mut self.driven, seen.driven ^ driven_before, seen.tick),
            ),
            (
                Rule::ModeDoesNotChatter,
                !(mode_changed && self.modes.add(seen.tick, MINUTE)),
            ),
            (Rule::LatchHolds, latch_holds),
            (
                Rule::FaultIsNamed,
                match seen.mode {
                    Mode::StartUp => true,
                    Mode::Normal => seen.fault == FaultCode::None,
                    Mode::Degraded | Mode::Safe | Mode::Latched => seen.fault != FaultCode::None,
                },
            ),
            (Rule::ArithmeticIsFinite, seen.finite && !new_internal),
            (
                Rule::SilenceCloses,
                seen.sensors_silent < TIMEOUT || is_closed(seen.mode),
            ),
            (Rule::ForeignSenderCloses, !seen.own_identifier || is_closed(seen.mode)),
            (
                Rule::SolenoidLatches,
                !seen.solenoid_failed || seen.mode == Mode::Latched,
            ),
            (
                Rule::MissingReadingRestricts,
                seen.reading_missing < CONFIRM || seen.mode != Mode::Normal,
            ),
        ];
        match holds.into_iter().find(|(_, holds)| !holds) {
            Some((rule, _)) => Err(Broken { rule, seen: *seen }),
            None => Ok(()),
        }
    }
}
