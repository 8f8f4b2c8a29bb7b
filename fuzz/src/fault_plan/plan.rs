//! Bytes to a plan. Every sequence of bytes is one, and a byte more or less changes one event only, so that a fuzzer can improve it.

use oleo_controller::{Axle, Corner, PressurePoint, SensorMessage, Strategy};

/// Bytes that describe the drive.
pub const BYTES_OF_HEADER: usize = 3;
/// Bytes that describe an event.
pub const BYTES_OF_EVENT: usize = 7;
/// Most events of a plan.
const MOST_EVENTS: usize = 24;
/// Ticks before the first event can begin: a healthy vehicle is in normal mode after 31.
const HEALTHY_TICKS: u32 = 40;
/// Longest plan, ticks. Five entries into `Safe`, which latch, take 17,000.
const MOST_TICKS: u32 = 24_000;

/// What a drive is like, and what happens in it.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The strategy of the controller.
    pub strategy: Strategy,
    /// Amplitude of the road, m, 0 to 0.03.
    pub road_m: f32,
    /// Displacement by which bends lean the body, m, 0 to 0.03.
    pub lean_m: f32,
    /// Length, ticks, 100 to 24,000.
    pub ticks: u32,
    /// What happens, in order of its beginning.
    pub events: Vec<Event>,
}

/// Something that goes wrong for some ticks, once or again and again.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    /// What goes wrong.
    pub what: What,
    /// The corner or, with `point`, the reading that it concerns.
    pub corner: Corner,
    /// The pressure that it concerns; none for the displacement.
    pub point: Option<PressurePoint>,
    /// The message that it concerns; none for all.
    pub message: Option<SensorMessage>,
    /// First tick.
    pub first: u32,
    /// Number of ticks for which it is present.
    pub on: u32,
    /// Number of ticks until it is present again.
    pub off: u32,
    /// Number of times it is present.
    pub times: u32,
    /// How much, 0 to 255. What it means depends on what goes wrong.
    pub size: u8,
}

macro_rules! kinds {
    ($($(#[$attribute:meta])* $kind:ident,)*) => {
        /// What can go wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum What {
            $($(#[$attribute])* $kind,)*
        }

        impl What {
            /// All that can go wrong.
            pub const ALL: &'static [Self] = &[$(Self::$kind,)*];
        }
    };
}

kinds! {
    /// A sensor says that it has no value.
    Missing,
    /// A reading outside its range.
    OutOfRange,
    /// A reading that jumps to and fro within its range.
    Jumping,
    /// A reading with noise.
    Noisy,
    /// A reading that stays where it was.
    Stuck,
    /// The same with a little noise.
    StuckWithNoise,
    /// A reading with an offset.
    Offset,
    /// A reading that drifts away.
    Drift,
    /// A reading with a wrong gain.
    Gain,
    /// A reading with the wrong sign.
    Reversed,
    /// A reading that is some ticks old.
    Delayed,
    /// The readings of two corners in each other's place.
    Swapped,
    /// Valve 3 stays open.
    ValveStuckOpen,
    /// Valve 3 stays closed.
    ValveStuckClosed,
    /// A sensor message is lost.
    Dropped,
    /// A sensor message is held up.
    Late,
    /// A sensor message comes twice.
    Repeated,
    /// A bit of a sensor message is wrong.
    Corrupted,
    /// A sensor message is too short or too long.
    WrongLength,
    /// Somebody else sends the same message beside the right one, with right check values.
    ForgedBeside,
    /// Somebody else sends the message in place of the right one, with right check values.
    ForgedInstead,
    /// A recording is played in place of the right messages.
    Replayed,
    /// Two pressure messages under each other's identifiers.
    Misnamed,
    /// The sender's tick stands still while its counters run.
    FrozenTick,
    /// The sender answers a wrong challenge.
    WrongAnswer,
    /// Frames of other identifiers.
    Strangers,
    /// No frame crosses the bus in any direction.
    Silence,
    /// The controller hears a frame under an identifier of its own.
    OwnIdentifier,
    /// The output stage hears a frame under an identifier of the sensors' node.
    SensorIdentifier,
    /// The command is lost.
    CommandDropped,
    /// The command is held up.
    CommandLate,
    /// A bit of the command is wrong.
    CommandCorrupted,
    /// The command comes twice.
    CommandRepeated,
    /// Somebody else commands open valves beside the right command, with right check values.
    CommandForged,
    /// A solenoid pin reports an error.
    SolenoidFails,
    /// The controller is reset, and keeps its latch as the firmware does.
    Reset,
    /// The supply of the controller is switched off and on.
    PowerCycle,
    /// The controller is reset after its own arithmetic has failed, which the firmware keeps as a latch. No input leads to that.
    ResetAfterInternalFault,
}

/// A number of ticks from a byte, about one part in sixteen apart: 1 to 63,488.
fn ticks(byte: u8) -> u32 {
    ((16 + u32::from(byte & 15)) << (byte >> 4)) >> 4
}

impl Plan {
    /// The plan that some bytes are, if they are enough for a drive.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (&[strategy, ways, length], rest) = bytes.split_first_chunk::<BYTES_OF_HEADER>()?;
        let mut first = HEALTHY_TICKS;
        let events = rest
            .as_chunks::<BYTES_OF_EVENT>()
            .0
            .iter()
            .take(MOST_EVENTS)
            .map(|bytes| {
                let event = Event::from_bytes(bytes, first);
                first = event.first;
                event
            });
        Some(Self {
            strategy: [
                Strategy::RoadAndCornering,
                Strategy::RideHandling,
                Strategy::AlwaysSoft,
                Strategy::AlwaysStiff,
            ][usize::from(strategy & 3)],
            road_m: f32::from(ways & 15) * 0.002,
            lean_m: f32::from(ways >> 4) * 0.002,
            ticks: ticks(length).clamp(100, MOST_TICKS),
            events: events.collect(),
        })
    }
}

impl Event {
    /// An event that begins some ticks after another one.
    fn from_bytes(&[what, place, gap, on, off, times, size]: &[u8; BYTES_OF_EVENT], after: u32) -> Self {
        let messages = SensorMessage::ALL;
        Self {
            what: What::ALL[usize::from(what) % What::ALL.len()],
            corner: Corner::ALL[usize::from(place & 3)],
            // Two of six: displacements are fewer, and as important.
            point: PressurePoint::ALL.get(usize::from(place >> 2) % 6).copied(),
            message: messages.get(usize::from(place >> 2) % (messages.len() + 1)).copied(),
            first: after.saturating_add(ticks(gap) - 1),
            on: ticks(on),
            off: ticks(off),
            times: 1 + u32::from(times % 32),
            size,
        }
    }

    /// Number of ticks for which the event has been present, if it is.
    pub fn present(&self, tick: u32) -> Option<u32> {
        let since = tick.checked_sub(self.first)?;
        let period = self.on + self.off;
        (since / period < self.times && since % period < self.on).then_some(since % period)
    }

    /// The axle of the event's corner.
    pub fn axle(&self) -> Axle {
        self.corner.axle()
    }
}
