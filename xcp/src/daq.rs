//! Lists of measured quantities that are sent by themselves, every tick or every n-th tick.
//!
//! A tool allocates lists, in a list ODTs (one frame each), and in an ODT entries (an address with a number of bytes), as the
//! protocol layer specification says of dynamic configuration. Everything has a fixed place in memory.
//!
//! Lists are sampled all in the same tick and wait in a queue, from which only as many frames leave in a tick as the bus has room
//! for. A list is started only if all lists together need no more in the mean. Then at most one frame for each ODT waits: in `n`
//! ticks a list with `o` ODTs and prescaler `p` adds at most `o (n / p + 1)`, and `n` times the budget leave. A tool that starts and stops
//! lists all the time could exceed this; a sample that finds no room for all its frames is left out as a whole and counted.

use heapless::{Deque, Vec};

use crate::memory::Memory;
use crate::packet::{LAST_DATA_PID, MOST_BYTES, Packet, Refusal};

/// Most lists.
pub(crate) const MOST_LISTS: usize = 8;
/// Most ODTs of all lists together.
const MOST_ODTS: usize = 32;
/// Most entries of all ODTs together: in each ODT seven of one byte.
const MOST_ENTRIES: usize = MOST_ODTS * MOST_ENTRY_BYTES;
/// Most bytes of an entry: what a frame has beside its identifier.
pub(crate) const MOST_ENTRY_BYTES: usize = MOST_BYTES - 1;
/// Bytes of the time stamp in the first frame of a sample.
const STAMP_BYTES: usize = 2;

const _: () = assert!(
    MOST_ODTS <= LAST_DATA_PID as usize + 1,
    "each ODT has an identifier of its own"
);

/// Bit of a list's mode: the first frame of a sample has a time stamp.
const MODE_STAMPED: u8 = 0x10;
/// Bit of a list's state, as GET_DAQ_LIST_MODE tells it.
const STATE_SELECTED: u8 = 0x01;
const STATE_RUNNING: u8 = 0x40;

#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    address: u32,
    bytes: u8,
}

/// A range in one of the tables below.
#[derive(Clone, Copy, Debug, Default)]
struct Range {
    first: u8,
    count: u8,
}

impl Range {
    fn of<T>(self, table: &[T]) -> &[T] {
        let first = usize::from(self.first);
        table.get(first..first + usize::from(self.count)).unwrap_or(&[])
    }
}

#[derive(Clone, Copy, Debug)]
struct List {
    odts: Range,
    prescaler: u8,
    stamped: bool,
    has_event: bool,
    selected: bool,
    running: bool,
}

impl List {
    const NEW: Self = Self {
        odts: Range { first: 0, count: 0 },
        prescaler: 1,
        stamped: false,
        has_event: false,
        selected: false,
        running: false,
    };
}

/// What is allocated last; each step may follow itself and the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Allocated {
    Nothing,
    Freed,
    Lists,
    Odts,
    Entries,
}

/// Where WRITE_DAQ writes next.
#[derive(Clone, Copy, Debug)]
struct Pointer {
    list: u16,
    odt: u8,
    entry: u8,
}

/// All lists, and the frames that wait.
#[derive(Clone, Debug)]
pub(crate) struct Daq {
    frames_a_tick: usize,
    allocated: Allocated,
    lists: Vec<List, MOST_LISTS>,
    odts: Vec<Range, MOST_ODTS>,
    entries: Vec<Entry, MOST_ENTRIES>,
    pointer: Option<Pointer>,
    waiting: Deque<Packet, MOST_ODTS>,
    left_out: u32,
}

impl Daq {
    pub fn new(frames_a_tick: usize) -> Self {
        Self {
            frames_a_tick,
            allocated: Allocated::Nothing,
            lists: Vec::new(),
            odts: Vec::new(),
            entries: Vec::new(),
            pointer: None,
            waiting: Deque::new(),
            left_out: 0,
        }
    }

    /// Forgets all lists.
    pub fn free(&mut self) {
        *self = Self {
            allocated: Allocated::Freed,
            left_out: self.left_out,
            ..Self::new(self.frames_a_tick)
        };
    }

    /// Whether an allocation may follow, which is the case after `before` and after itself.
    fn follows(&mut self, step: Allocated, before: Allocated) -> Result<(), Refusal> {
        if self.is_running() {
            return Err(Refusal::DaqActive);
        }
        if self.allocated != before && self.allocated != step {
            return Err(Refusal::Sequence);
        }
        Ok(())
    }

    pub fn allocate_lists(&mut self, count: u16) -> Result<(), Refusal> {
        self.follows(Allocated::Lists, Allocated::Freed)?;
        if usize::from(count) > MOST_LISTS - self.lists.len() {
            return Err(Refusal::MemoryOverflow);
        }
        for _ in 0..count {
            // There is room.
            let _ = self.lists.push(List::NEW);
        }
        self.allocated = Allocated::Lists;
        Ok(())
    }

    pub fn allocate_odts(&mut self, list: u16, count: u8) -> Result<(), Refusal> {
        self.follows(Allocated::Odts, Allocated::Lists)?;
        if usize::from(count) > MOST_ODTS - self.odts.len() {
            return Err(Refusal::MemoryOverflow);
        }
        let first = self.odts.len() as u8;
        let list = self.lists.get_mut(usize::from(list)).ok_or(Refusal::OutOfRange)?;
        if list.odts.count > 0 {
            return Err(Refusal::Sequence);
        }
        list.odts = Range { first, count };
        for _ in 0..count {
            let _ = self.odts.push(Range::default());
        }
        self.allocated = Allocated::Odts;
        Ok(())
    }

    pub fn allocate_entries(&mut self, list: u16, odt: u8, count: u8) -> Result<(), Refusal> {
        self.follows(Allocated::Entries, Allocated::Odts)?;
        if usize::from(count) > MOST_ENTRY_BYTES {
            return Err(Refusal::OutOfRange);
        }
        if usize::from(count) > MOST_ENTRIES - self.entries.len() {
            return Err(Refusal::MemoryOverflow);
        }
        let first = self.entries.len() as u8;
        let place = self.place_of(list, odt)?;
        let odt = self.odts.get_mut(place).ok_or(Refusal::OutOfRange)?;
        if odt.count > 0 {
            return Err(Refusal::Sequence);
        }
        *odt = Range { first, count };
        for _ in 0..count {
            let _ = self.entries.push(Entry::default());
        }
        self.allocated = Allocated::Entries;
        Ok(())
    }

    fn list(&mut self, list: u16) -> Result<&mut List, Refusal> {
        self.lists.get_mut(usize::from(list)).ok_or(Refusal::OutOfRange)
    }

    /// Place of an ODT in the table of all.
    fn place_of(&self, list: u16, odt: u8) -> Result<usize, Refusal> {
        let odts = self.lists.get(usize::from(list)).ok_or(Refusal::OutOfRange)?.odts;
        if odt < odts.count {
            Ok(usize::from(odts.first) + usize::from(odt))
        } else {
            Err(Refusal::OutOfRange)
        }
    }

    /// Place of an entry in the table of all.
    fn entry_of(&self, at: Pointer) -> Result<usize, Refusal> {
        let entries = self
            .odts
            .get(self.place_of(at.list, at.odt)?)
            .ok_or(Refusal::OutOfRange)?;
        if at.entry < entries.count {
            Ok(usize::from(entries.first) + usize::from(at.entry))
        } else {
            Err(Refusal::OutOfRange)
        }
    }

    pub fn point(&mut self, list: u16, odt: u8, entry: u8) -> Result<(), Refusal> {
        let pointer = Pointer { list, odt, entry };
        self.entry_of(pointer)?;
        if self.list(list)?.running {
            return Err(Refusal::DaqActive);
        }
        self.pointer = Some(pointer);
        Ok(())
    }

    /// Says what the entry is that was pointed to, and points to the next one.
    pub fn write(&mut self, memory: &Memory, bit: u8, bytes: u8, address: u32) -> Result<(), Refusal> {
        let pointer = self.pointer.ok_or(Refusal::OutOfRange)?;
        let place = self.entry_of(pointer)?;
        if self.list(pointer.list)?.running {
            return Err(Refusal::DaqActive);
        }
        // Single bits can only be written to a slave, which this one does not support.
        if bit != 0xFF || bytes == 0 || usize::from(bytes) > MOST_ENTRY_BYTES {
            return Err(Refusal::OutOfRange);
        }
        memory.read(address, bytes.into())?;
        if let Some(entry) = self.entries.get_mut(place) {
            *entry = Entry { address, bytes };
        }
        self.pointer = Some(Pointer {
            entry: pointer.entry.saturating_add(1),
            ..pointer
        });
        Ok(())
    }

    pub fn set_mode(&mut self, list: u16, mode: u8, prescaler: u8) -> Result<(), Refusal> {
        let list = self.list(list)?;
        if list.running {
            return Err(Refusal::DaqActive);
        }
        if mode & !MODE_STAMPED != 0 {
            return Err(Refusal::ModeNotValid);
        }
        if prescaler == 0 {
            return Err(Refusal::OutOfRange);
        }
        list.stamped = mode & MODE_STAMPED != 0;
        list.prescaler = prescaler;
        list.has_event = true;
        Ok(())
    }

    /// Mode and state of a list, and its prescaler.
    pub fn mode(&mut self, list: u16) -> Result<(u8, u8), Refusal> {
        let list = self.list(list)?;
        let mode = if list.stamped { MODE_STAMPED } else { 0 };
        let state = if list.selected { STATE_SELECTED } else { 0 } | if list.running { STATE_RUNNING } else { 0 };
        Ok((mode | state, list.prescaler))
    }

    /// Identifier of a list's first ODT.
    pub fn first_identifier(&mut self, list: u16) -> Result<u8, Refusal> {
        Ok(self.list(list)?.odts.first)
    }

    pub fn select(&mut self, list: u16) -> Result<(), Refusal> {
        self.list(list)?.selected = true;
        Ok(())
    }

    pub fn start(&mut self, list: u16) -> Result<(), Refusal> {
        self.list(list)?;
        self.start_those(|at, list_| at == usize::from(list) || list_.running)
    }

    pub fn start_selected(&mut self) -> Result<(), Refusal> {
        self.start_those(|_, list| list.selected || list.running)
    }

    /// Lets these lists run, if each can be sent and the bus has room for all of them.
    fn start_those(&mut self, runs: impl Fn(usize, &List) -> bool) -> Result<(), Refusal> {
        // Frames a tick, over a common denominator of the prescalers: exact, and far from the end of u64.
        let mut needed = (0_u64, 1_u64);
        for (_, list) in self.lists.iter().enumerate().filter(|(at, list)| runs(*at, list)) {
            if !list.has_event || list.odts.count == 0 {
                return Err(Refusal::Sequence);
            }
            for (at, odt) in list.odts.of(&self.odts).iter().enumerate() {
                let bytes: usize = odt.of(&self.entries).iter().map(|entry| usize::from(entry.bytes)).sum();
                let stamp = if at == 0 && list.stamped { STAMP_BYTES } else { 0 };
                if bytes + stamp > MOST_ENTRY_BYTES {
                    return Err(Refusal::DaqConfiguration);
                }
            }
            let (prescaler, frames) = (u64::from(list.prescaler), u64::from(list.odts.count));
            needed = (needed.0 * prescaler + frames * needed.1, needed.1 * prescaler);
        }
        if u128::from(needed.0) > self.frames_a_tick as u128 * u128::from(needed.1) {
            return Err(Refusal::DaqConfiguration);
        }
        for (at, list) in self.lists.iter_mut().enumerate() {
            list.running = runs(at, list);
            list.selected = false;
        }
        Ok(())
    }

    pub fn stop(&mut self, list: u16) -> Result<(), Refusal> {
        self.list(list)?.running = false;
        self.forget_if_idle();
        Ok(())
    }

    pub fn stop_selected(&mut self) {
        for list in self.lists.iter_mut().filter(|list| list.selected) {
            list.running = false;
            list.selected = false;
        }
        self.forget_if_idle();
    }

    pub fn stop_all(&mut self) {
        for list in &mut self.lists {
            list.running = false;
            list.selected = false;
        }
        self.forget_if_idle();
    }

    /// A tool that has stopped everything expects nothing more.
    fn forget_if_idle(&mut self) {
        if !self.is_running() {
            self.waiting.clear();
        }
    }

    pub fn is_running(&self) -> bool {
        self.lists.iter().any(|list| list.running)
    }

    /// Number of samples that were left out.
    pub fn left_out(&self) -> u32 {
        self.left_out
    }

    /// Samples the lists whose turn it is in this tick.
    pub fn sample(&mut self, memory: &Memory, tick: u32) {
        for list in &self.lists {
            if !list.running || !tick.is_multiple_of(list.prescaler.into()) {
                continue;
            }
            if usize::from(list.odts.count) > self.waiting.capacity() - self.waiting.len() {
                self.left_out = self.left_out.wrapping_add(1);
                continue;
            }
            for (at, odt) in list.odts.of(&self.odts).iter().enumerate() {
                let mut packet = Packet::new();
                // All of this fits, as `start_those` has seen.
                let _ = packet.push(list.odts.first + at as u8);
                if at == 0 && list.stamped {
                    let _ = packet.extend_from_slice(&(tick as u16).to_le_bytes());
                }
                for entry in odt.of(&self.entries) {
                    if let Ok(bytes) = memory.read(entry.address, entry.bytes.into()) {
                        let _ = packet.extend_from_slice(bytes);
                    }
                }
                let _ = self.waiting.push_back(packet);
            }
        }
    }

    /// Hands over the frames that may be sent in this tick.
    pub fn send(&mut self, mut take: impl FnMut(Packet)) {
        for _ in 0..self.frames_a_tick {
            let Some(packet) = self.waiting.pop_front() else { return };
            take(packet);
        }
    }
}
