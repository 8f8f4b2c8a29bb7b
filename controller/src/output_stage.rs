//! The receiver of the command in the output stage: it decides which commands the solenoids may obey.
//!
//! It trusts the command no more than the controller trusts its sensors. A command opens valves only if it is the only one in its
//! tick, right and in sequence, from a message that is trusted, an answer to readings that are at most 2 ticks old, and if the
//! mode that it names permits those valves. A right command of which anything else is doubtful may still close valves, because a
//! closing is never delayed; of several in a tick each closes what it wants closed. How often a valve opens again is limited as in
//! the controller. Without a command to obey for the contract's `timeout_ticks` all valves close.
//!
//! The plant's tick has 8 bits, so that a recording of commands that is played again and again answers a fresh tick now and then.
//! After an answer that was older than readings can be in any mode but a closed one, the stage therefore opens nothing until a
//! fresh command has closed everything. A controller that was without readings for so long sends that first.
//!
//! The protection finds faults and careless senders, not attackers: its check value has public numbers, so that whoever knows them
//! can also silence the right sender and take its place. `docs/safety.md` says what would help.

use crate::can::{COMMAND, CheckStatus, CommandMessage, FRAME_BYTES};
use crate::failsafe;
use crate::receiver::Receiver;
use crate::switching::SwitchingLimit;
use crate::valves::ValveCommand;

/// Number of ticks by which the readings that a command answers may be older than the present tick.
const OLDEST_ECHO_TICKS: u8 = 2;

/// Age of an answered tick at which the controller must have closed all valves: it has been without both displacement messages
/// for twice their time-out.
const SURELY_CLOSED_TICKS: u8 = 2 * COMMAND.timeout_ticks;

/// Reception of the valve command.
///
/// ```
/// use oleo_controller::can::{COMMAND, CommandMessage, Protector};
/// use oleo_controller::{Mode, OutputStage, ValveCommand};
/// let (mut controller, mut stage) = (Protector::new(&COMMAND), OutputStage::new());
/// let mut obeyed = |tick: u8, mode: Mode| {
///     let message = CommandMessage { command: ValveCommand::SOFT, echo_tick: tick, mode, ..CommandMessage::default() };
///     let mut data = message.encode();
///     controller.protect(&mut data);
///     stage.receive(&data);
///     stage.end_of_tick(tick)
/// };
/// assert_eq!(obeyed(1, Mode::Normal), ValveCommand::SAFE); // the first command is only compared with
/// assert_eq!(obeyed(2, Mode::Normal), ValveCommand::SOFT);
/// assert_eq!(obeyed(3, Mode::Latched), ValveCommand::SAFE); // the mode does not permit open valves
/// ```
#[derive(Clone, Copy, Debug)]
pub struct OutputStage {
    receiver: Receiver,
    /// Number of frames of this tick, right or wrong; it saturates.
    frames: u8,
    /// What the right ones say.
    heard: Option<Heard>,
    command: ValveCommand,
    switching: SwitchingLimit,
    /// An answer was far too old, and no fresh command has closed everything since.
    answered_late: bool,
    errors: u32,
}

/// The commands of a tick that passed their check.
#[derive(Clone, Copy, Debug)]
struct Heard {
    youngest: CommandMessage,
    /// The valves that all of them, and their modes, want or permit open.
    permitted: ValveCommand,
}

impl Heard {
    fn new(content: CommandMessage, before: Option<Self>) -> Self {
        // What the mode does not permit is never obeyed, whatever else is right.
        let permitted = failsafe::permitted_in(content.mode, content.command);
        Self {
            youngest: content,
            permitted: before.map_or(permitted, |before| both(before.permitted, permitted)),
        }
    }
}

/// The valves that two commands have open.
fn both(one: ValveCommand, other: ValveCommand) -> ValveCommand {
    ValveCommand::from_word(one.word() & other.word())
}

impl Default for OutputStage {
    fn default() -> Self {
        Self::new()
    }
}

impl OutputStage {
    /// A stage that has received nothing: all valves are closed.
    pub fn new() -> Self {
        Self {
            receiver: Receiver::INITIAL,
            frames: 0,
            heard: None,
            command: ValveCommand::SAFE,
            switching: SwitchingLimit::INITIAL,
            answered_late: false,
            errors: 0,
        }
    }

    /// Takes the data of a frame with the command's identifier, and returns the outcome of its check.
    pub fn receive(&mut self, data: &[u8]) -> CheckStatus {
        // A frame of the wrong length cannot carry the right CRC: it has the same consequence.
        let data = <&[u8; FRAME_BYTES]>::try_from(data).unwrap_or(&[0xFF; FRAME_BYTES]);
        let status = self.receiver.receive(&COMMAND, data);
        self.frames = self.frames.saturating_add(1);
        if status.is_error() {
            self.errors = self.errors.wrapping_add(1);
        }
        if status.is_usable() {
            match CommandMessage::decode(data) {
                Some(content) => self.heard = Some(Heard::new(content, self.heard)),
                None => self.distrust(),
            }
        }
        status
    }

    /// Notes that the bus is not to be trusted in this tick, for a reason that no command shows.
    pub fn distrust(&mut self) {
        self.errors = self.errors.wrapping_add(1);
        self.receiver.distrust();
    }

    /// Ends a tick, with its number modulo 256 as the displacement messages carry it; returns the command to obey.
    pub fn end_of_tick(&mut self, plant_tick: u8) -> ValveCommand {
        let heard = self.heard.take();
        let alone = core::mem::take(&mut self.frames) == 1;
        if let Some(Heard { youngest, .. }) = heard {
            let age = plant_tick.wrapping_sub(youngest.echo_tick);
            self.answered_late |= age > SURELY_CLOSED_TICKS;
            if age > OLDEST_ECHO_TICKS || failsafe::permitted_in(youngest.mode, youngest.command) != youngest.command {
                self.distrust();
            }
        }
        let new = self.receiver.end_of_tick(&COMMAND).is_some();
        let wanted = match heard {
            _ if self.receiver.is_lost(&COMMAND) => ValveCommand::SAFE,
            Some(heard) => {
                let obeyed = new && alone;
                if obeyed && heard.permitted == ValveCommand::SAFE {
                    self.answered_late = false;
                }
                if obeyed && !self.answered_late {
                    heard.permitted
                } else {
                    both(self.command, heard.permitted)
                }
            }
            None => self.command,
        };
        self.command = self.switching.step(wanted);
        self.command
    }

    /// The command that is obeyed at present.
    pub fn command(&self) -> ValveCommand {
        self.command
    }

    /// Number of ticks since a command was last obeyed; it saturates at 255, which also means that none ever was.
    pub fn ticks_without_command(&self) -> u8 {
        self.receiver.age()
    }

    /// Number of commands that failed their check or that contradict themselves, and of ticks with another reason for distrust. It
    /// wraps.
    pub fn errors(&self) -> u32 {
        self.errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::can::Protector;
    use crate::failsafe::Mode;

    /// A controller and a stage, 20 ticks into a quiet drive with open valves.
    struct Pair {
        controller: Protector,
        stage: OutputStage,
        tick: u8,
    }

    impl Pair {
        fn new() -> Self {
            let mut pair = Self {
                controller: Protector::new(&COMMAND),
                stage: OutputStage::default(),
                tick: 0,
            };
            for _ in 0..20 {
                pair.step(ValveCommand::SOFT, Mode::Normal, 0);
            }
            assert_eq!(pair.stage.command(), ValveCommand::SOFT);
            pair
        }

        fn send(&mut self, command: ValveCommand, mode: Mode, echo_late: u8) {
            let message = CommandMessage {
                command,
                mode,
                echo_tick: self.tick.wrapping_sub(echo_late),
                ..CommandMessage::default()
            };
            let mut data = message.encode();
            self.controller.protect(&mut data);
            self.stage.receive(&data);
        }

        fn end(&mut self) -> ValveCommand {
            let command = self.stage.end_of_tick(self.tick);
            self.tick = self.tick.wrapping_add(1);
            command
        }

        fn step(&mut self, command: ValveCommand, mode: Mode, echo_late: u8) -> ValveCommand {
            self.send(command, mode, echo_late);
            self.end()
        }
    }

    #[test]
    fn a_closed_mode_closes_at_once_whatever_the_word_says() {
        for mode in [Mode::StartUp, Mode::Safe, Mode::Latched] {
            assert_eq!(
                Pair::new().step(ValveCommand::SOFT, mode, 0),
                ValveCommand::SAFE,
                "{mode:?}"
            );
        }
        let springs_closed = ValveCommand::from_word(0b011_011_011_011);
        assert_eq!(Pair::new().step(ValveCommand::SOFT, Mode::Degraded, 0), springs_closed);
    }

    #[test]
    fn old_readings_open_nothing_and_their_answer_may_close() {
        let one = ValveCommand::from_word(1);
        for late in 0..=2 {
            let mut pair = Pair::new();
            pair.step(ValveCommand::SAFE, Mode::Normal, 0);
            assert_eq!(pair.step(ValveCommand::SOFT, Mode::Normal, late), ValveCommand::SOFT);
        }
        let mut pair = Pair::new();
        pair.step(ValveCommand::SAFE, Mode::Normal, 0);
        assert_eq!(pair.step(ValveCommand::SOFT, Mode::Normal, 3), ValveCommand::SAFE);
        assert_eq!(pair.step(ValveCommand::SOFT, Mode::Normal, 8), ValveCommand::SAFE);
        assert_eq!(
            pair.step(ValveCommand::SOFT, Mode::Normal, 0),
            ValveCommand::SOFT,
            "that was not too old"
        );
        // After an answer that was far too old, a fresh one must close everything first.
        let mut pair = Pair::new();
        pair.step(one, Mode::Normal, 9);
        assert_eq!(pair.step(ValveCommand::SOFT, Mode::Normal, 0), one);
        assert_eq!(pair.step(ValveCommand::SAFE, Mode::Normal, 0), ValveCommand::SAFE);
        assert_eq!(pair.step(ValveCommand::SOFT, Mode::Normal, 0), ValveCommand::SOFT);
        let mut pair = Pair::new();
        assert_eq!(pair.step(one, Mode::Normal, 3), one, "closes eleven");
        assert_eq!(pair.step(ValveCommand::SOFT, Mode::Normal, 200), one, "opens none");
        assert_eq!(
            pair.step(one, Mode::Normal, 3),
            ValveCommand::SAFE,
            "and is no longer trusted"
        );
    }

    #[test]
    fn two_commands_in_a_tick_open_nothing() {
        let mut pair = Pair::new();
        pair.step(ValveCommand::SAFE, Mode::Normal, 0);
        for _ in 0..50 {
            pair.send(ValveCommand::SAFE, Mode::Safe, 0);
            pair.send(ValveCommand::SOFT, Mode::Normal, 0);
            assert_eq!(pair.end(), ValveCommand::SAFE);
        }
        assert_eq!(
            pair.step(ValveCommand::SOFT, Mode::Normal, 0),
            ValveCommand::SAFE,
            "not trusted for 16 ticks"
        );
    }

    /// Just after a lost command the frame count alone does not tell a forged one from one that was held up.
    #[test]
    fn two_commands_after_a_lost_one_open_nothing_and_close() {
        for forged_first in [false, true] {
            let mut pair = Pair::new();
            pair.step(ValveCommand::SAFE, Mode::Latched, 0);
            pair.controller.protect(&mut [0; FRAME_BYTES]);
            pair.end();
            for forged in [forged_first, !forged_first] {
                let mode = if forged { Mode::Normal } else { Mode::Latched };
                pair.send(if forged { ValveCommand::SOFT } else { ValveCommand::SAFE }, mode, 0);
            }
            assert_eq!(pair.end(), ValveCommand::SAFE, "{forged_first}");

            let mut pair = Pair::new();
            pair.controller.protect(&mut [0; FRAME_BYTES]);
            pair.end();
            for forged in [forged_first, !forged_first] {
                let word = if forged { 0xFFF } else { 0x010 };
                pair.send(ValveCommand::from_word(word), Mode::Normal, 0);
            }
            assert_eq!(pair.end().word(), 0x010, "the closing is not delayed");

            // A forged one that is ahead of the right one makes it look out of sequence.
            let mut pair = Pair::new();
            pair.step(ValveCommand::SAFE, Mode::Latched, 0);
            pair.controller.protect(&mut [0; FRAME_BYTES]);
            pair.end();
            let right = pair.controller;
            pair.controller.protect(&mut [0; FRAME_BYTES]);
            pair.send(ValveCommand::SOFT, Mode::Normal, 0);
            pair.controller = right;
            pair.send(ValveCommand::SAFE, Mode::Latched, 0);
            assert_eq!(pair.end(), ValveCommand::SAFE);
        }
    }

    #[test]
    fn forged_closings_make_no_valve_chatter() {
        let mut pair = Pair::new();
        let (mut switchings, mut before) = (0, ValveCommand::SOFT);
        for n in 0..200 {
            // Two of sixteen ticks are crowded, which trust outlives.
            pair.send(ValveCommand::SOFT, Mode::Normal, 0);
            if n % 8 == 0 {
                pair.send(ValveCommand::SAFE, Mode::Safe, 0);
            }
            let command = pair.end();
            switchings += u32::from(core::mem::replace(&mut before, command) != command);
        }
        assert!((5..=10).contains(&switchings), "{switchings}");
    }

    #[test]
    fn silence_and_repetition_close_after_the_time_out() {
        let mut pair = Pair::new();
        for n in 1..8 {
            let expected = if n < COMMAND.timeout_ticks {
                ValveCommand::SOFT
            } else {
                ValveCommand::SAFE
            };
            assert_eq!(pair.end(), expected, "tick {n}");
            assert_eq!(pair.stage.ticks_without_command(), n);
        }
        let mut pair = Pair::new();
        let before = pair.controller;
        for n in 1..8 {
            pair.controller = before;
            let command = pair.step(ValveCommand::SOFT, Mode::Normal, 0);
            assert_eq!(command == ValveCommand::SAFE, n > COMMAND.timeout_ticks, "tick {n}");
        }
        assert_eq!(pair.stage.errors(), 6);
    }

    #[test]
    fn a_word_that_its_complement_contradicts_is_an_error() {
        let mut pair = Pair::new();
        let mut data = CommandMessage::default().encode();
        data[2] ^= 1;
        pair.controller.protect(&mut data);
        pair.stage.receive(&data);
        assert_eq!((pair.end(), pair.stage.errors()), (ValveCommand::SOFT, 1));
    }
}
