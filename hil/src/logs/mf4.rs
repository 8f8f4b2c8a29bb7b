//! ASAM MDF 4 files with the frames of CAN buses, as loggers, CANape, asammdf and python-can write them.
//!
//! The crate `falcon_mdf` reads the file: sorted and unsorted data, lists of blocks, deflate with and without transposition. A group of
//! channels `CAN_DataFrame.ID`, `.DataBytes` and so on holds frames (ASAM MDF, Bus Logging, 1.0). Groups are often one for each bus
//! or kind of frame, so they are merged in the order of time. The time of a file may begin anywhere; here its first frame is at zero.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use falcon_mdf::blocks::ChannelType;
use falcon_mdf::{Channel, ChannelGroup, Mf4Error, Mf4File, OpenOptions, Signal, SignalValues};

use super::account::Account;
use super::error::LogError;
use super::frame::{Entry, FrameKind, LoggedFrame, Payload, identifier};
use super::source::{FrameSource, Sink};

/// Records that are decoded at once.
const RECORDS_AT_ONCE: usize = 1 << 14;
/// Bits of an identifier; loggers put flags above them.
const ID_BITS: u32 = 0x1FFF_FFFF;
/// Flag of an identifier of 29 bits, where no channel says so.
const EXTENDED_FLAG: u32 = 1 << 31;

/// The frames of an MF4 file.
pub struct Mf4 {
    file: Mf4File,
    path: PathBuf,
}

impl Mf4 {
    /// Opens a file.
    ///
    /// # Errors
    /// The file cannot be read, or is no MDF 4.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Self::of(Mf4File::open_with_options(path, options()), path)
    }

    /// A file in memory. `path` is the name that appears in errors.
    ///
    /// # Errors
    /// The bytes are no MDF 4.
    pub fn in_memory(bytes: Vec<u8>, path: &Path) -> Result<Self, LogError> {
        Self::of(Mf4File::from_bytes_with_options(bytes, options()), path)
    }

    fn of(file: Result<Mf4File, Mf4Error>, path: &Path) -> Result<Self, LogError> {
        Ok(Self {
            file: file.map_err(|error| refused(path, &error))?,
            path: path.to_path_buf(),
        })
    }
}

/// Writers make blocks of at most 4 MB; a damaged or hostile file may claim any size.
const LARGEST_BLOCK: usize = 64 << 20;

fn options() -> OpenOptions {
    OpenOptions {
        build_channels_db: false,
        parallel_parsing: false,
        max_alloc: LARGEST_BLOCK,
        max_decompressed: LARGEST_BLOCK as u64,
        ..OpenOptions::default()
    }
}

fn refused(path: &Path, error: &Mf4Error) -> LogError {
    let what = match error {
        Mf4Error::UnsupportedVersion { .. } => {
            format!("{error}; save the file as MDF 4 with asammdf: MDF(IN).convert(\"4.10\").save(OUT)")
        }
        Mf4Error::Unsupported { .. } => {
            format!("{error}; save the file once more with asammdf: MDF(IN).save(OUT, compression=1)")
        }
        _ => format!("{error}; the file is damaged or was cut off, copy it again from the logger"),
    };
    LogError::new(path, what)
}

impl FrameSource for Mf4 {
    fn read(&mut self, sink: &mut Sink) -> Result<Account, LogError> {
        let refused = |error: Mf4Error| refused(&self.path, &error);
        let groups = || self.file.data_groups().iter().flat_map(|group| &group.channel_groups);
        let mut account = Account::default();
        for group in groups().filter(|group| has(group, "CAN_ErrorFrame", "ID")) {
            account.entries += group.sample_count;
            account.error_frames += group.sample_count;
        }
        let mut readers = Vec::new();
        for group in groups().filter(|group| group.sample_count > 0) {
            if let Some(mut reader) = GroupReader::of(&self.file, group).map_err(refused)? {
                reader.refill().map_err(refused)?;
                readers.push(reader);
            }
        }
        if readers.is_empty() && account.entries == 0 {
            return Err(LogError::new(&self.path, self.without_frames()));
        }
        let first_s = readers
            .iter()
            .filter_map(GroupReader::time_s)
            .fold(f64::INFINITY, f64::min);
        loop {
            // The first of those that are equally early.
            let next = (readers.iter().enumerate())
                .filter_map(|(k, reader)| Some((k, reader.time_s()?)))
                .reduce(|best, next| if next.1 < best.1 { next } else { best });
            let Some((k, time_s)) = next else { break };
            let reader = &mut readers[k];
            account.entries += 1;
            account.remote_frames += u64::from(!reader.has_data);
            match reader.frame() {
                Some(frame) => {
                    let entry = Entry {
                        time_us: micros(time_s - first_s),
                        bus: reader.bus(),
                        frame,
                    };
                    if sink(entry) == ControlFlow::Break(()) {
                        break;
                    }
                }
                None => account.unreadable += 1,
            }
            reader.advance().map_err(refused)?;
        }
        Ok(account)
    }
}

impl Mf4 {
    /// What to say of a file without frames.
    fn without_frames(&self) -> String {
        const NAMED: usize = 5;
        let names: Vec<&str> = self.file.channels().map(|channel| channel.name.as_str()).collect();
        format!(
            "holds no CAN frames (no group with CAN_DataFrame.ID and .DataBytes), but {} channels{}; log the bus itself",
            names.len(),
            match names.is_empty() {
                true => String::new(),
                false => format!(" such as {}", names[..names.len().min(NAMED)].join(", ")),
            }
        )
    }
}

/// Microseconds, rounded; a time before the first is the first.
fn micros(seconds: f64) -> u64 {
    libm::round(seconds * 1e6) as u64
}

fn field<'f>(group: &'f ChannelGroup, frame: &str, name: &str) -> Option<&'f Channel> {
    group.find_channel(&format!("{frame}.{name}"))
}

fn has(group: &ChannelGroup, frame: &str, name: &str) -> bool {
    field(group, frame, name).is_some()
}

/// The fields of a frame, in the order in which they are read; the first two are in every file.
#[derive(Clone, Copy)]
enum Field {
    Id,
    DataLength,
    IsExtended,
    BusChannel,
    IsFd,
    IsSwitched,
    IsPassive,
}

/// Names of the fields in the file, in the order of [`Field`].
const FIELDS: [&str; 7] = ["ID", "DataLength", "IDE", "BusChannel", "EDL", "BRS", "ESI"];

/// The frames of one group.
struct GroupReader<'f> {
    batches: Box<dyn Iterator<Item = Result<Vec<Signal>, Mf4Error>> + 'f>,
    /// Whether the frames have data; those that have none are remote frames.
    has_data: bool,
    /// Position of each of [`FIELDS`] among the signals of a batch, where the file has it.
    places: [Option<usize>; FIELDS.len()],
    batch: Batch,
    /// Records that are still to come after the batch.
    to_come: u64,
    /// Name of the bus of the current record.
    bus: String,
    bus_number: u64,
}

/// Some records of a group, field by field.
#[derive(Default)]
struct Batch {
    time_s: Vec<f64>,
    fields: [Vec<f64>; FIELDS.len()],
    data: Option<SignalValues>,
    at: usize,
}

impl<'f> GroupReader<'f> {
    /// The reader of a group, if it holds data frames or remote frames.
    fn of(file: &'f Mf4File, group: &'f ChannelGroup) -> Result<Option<Self>, Mf4Error> {
        let kind = ["CAN_DataFrame", "CAN_RemoteFrame"]
            .into_iter()
            .find(|kind| has(group, kind, "ID"));
        let (Some(kind), Some(master)) = (kind, group.master_channel()) else {
            return Ok(None);
        };
        let data = field(group, kind, "DataBytes").filter(|_| kind == "CAN_DataFrame");
        let mut channels = vec![master];
        channels.extend(data);
        let places = FIELDS.map(|name| {
            channels.push(field(group, kind, name)?);
            Some(channels.len() - 1)
        });
        // Data of changing length in records of several groups can only be read at once: the crate looks for them anew in every part.
        let is_unsorted =
            (file.data_groups().get(group.data_group_index)).is_some_and(falcon_mdf::DataGroup::is_unsorted);
        let is_variable = data.is_some_and(|channel| channel.channel_type == ChannelType::VariableLength);
        let batches: Box<dyn Iterator<Item = _>> = if is_unsorted && is_variable {
            Box::new(std::iter::once(file.signals(&channels)))
        } else {
            Box::new(file.signals_chunks(&channels, RECORDS_AT_ONCE)?)
        };
        Ok(Some(Self {
            batches,
            has_data: data.is_some(),
            places,
            batch: Batch::default(),
            to_come: group.sample_count,
            bus: "1".to_owned(),
            bus_number: 1,
        }))
    }

    /// Reads records until there are some, or none are left.
    fn refill(&mut self) -> Result<(), Mf4Error> {
        while self.batch.at >= self.batch.time_s.len() {
            let Some(signals) = self.batches.next().transpose()? else {
                self.batch = Batch::default();
                if self.to_come > 0 {
                    let missing = format!("{} records of a group are missing", self.to_come);
                    return Err(Mf4Error::DataTypeConversion { message: missing });
                }
                return Ok(());
            };
            let numbers = |place: usize| signals.get(place).map_or(Ok(Vec::new()), Signal::values_f64);
            self.batch.time_s = numbers(0)?;
            self.to_come = self.to_come.saturating_sub(self.batch.time_s.len() as u64);
            for (place, field) in self.places.iter().zip(&mut self.batch.fields) {
                *field = place.map_or(Ok(Vec::new()), numbers)?;
            }
            self.batch.data = match (self.has_data, signals.get(1)) {
                (true, Some(data)) => Some(data.values()?),
                _ => None,
            };
            self.batch.at = 0;
        }
        self.name_bus();
        Ok(())
    }

    fn advance(&mut self) -> Result<(), Mf4Error> {
        self.batch.at += 1;
        self.refill()
    }

    /// Time of the current record, s.
    fn time_s(&self) -> Option<f64> {
        self.batch.time_s.get(self.batch.at).copied()
    }

    /// A field of the current record as a whole number.
    fn number(&self, field: Field) -> Option<u64> {
        let value = self.batch.fields.get(field as usize)?.get(self.batch.at)?;
        // A conversion of the file may make anything of a number.
        (0.0..=f64::from(u32::MAX)).contains(value).then_some(*value as u64)
    }

    fn name_bus(&mut self) {
        let number = self.number(Field::BusChannel).unwrap_or(1);
        if number != self.bus_number {
            self.bus_number = number;
            self.bus = number.to_string();
        }
    }

    fn bus(&self) -> &str {
        &self.bus
    }

    /// The current record as a frame; `None` if it is none.
    fn frame(&self) -> Option<LoggedFrame> {
        let raw = self.number(Field::Id)? as u32;
        let is_extended = match self.number(Field::IsExtended) {
            Some(flag) => flag != 0,
            None => raw & EXTENDED_FLAG != 0 || raw & ID_BITS > 0x7FF,
        };
        let id = identifier(raw & ID_BITS, is_extended)?;
        let length = self.number(Field::DataLength);
        let Some(data) = &self.batch.data else {
            return LoggedFrame::new(id, FrameKind::Remote(length.unwrap_or(0).min(8) as u8), Payload::EMPTY);
        };
        let bytes = data.bytes_at(self.batch.at)?;
        let bytes = match length {
            Some(length) => bytes.get(..usize::try_from(length).ok()?)?,
            None => bytes,
        };
        let flag = |field: Field| self.number(field).is_some_and(|flag| flag != 0);
        let kind = if flag(Field::IsFd) || bytes.len() > 8 {
            FrameKind::Fd(u8::from(flag(Field::IsSwitched)) | u8::from(flag(Field::IsPassive)) << 1)
        } else {
            FrameKind::Classic
        };
        LoggedFrame::new(id, kind, Payload::new(bytes)?)
    }
}
