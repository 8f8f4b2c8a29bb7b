//! Frames, one after the other, from a log to a file of another format.

use std::io::{Seek, Write};
use std::ops::ControlFlow;
use std::path::Path;

use oleo_hil::logs::{self, Account, AscWriter, BlfWriter, Entry, Format, LogError, Mf4Writer, candump};
use oleo_report::OutputFile;

use crate::failure::Failure;

/// Writes the frames of a log, and says what is in it.
pub fn write(input: &Path, staged: OutputFile, format: Format) -> Result<String, Failure> {
    let mut log = logs::open(input)?;
    let mut account = Account::default();
    let mut frames: u64 = 0;
    let written = staged.stream(|out| {
        let mut write_error = None;
        let mut writer = FrameWriter::of(format, out);
        let read = log.read(&mut |entry| match writer.write(&entry) {
            Ok(()) => {
                frames += 1;
                ControlFlow::Continue(())
            }
            Err(error) => {
                write_error = Some(error);
                ControlFlow::Break(())
            }
        });
        if let Some(error) = write_error {
            return Err(error);
        }
        writer.finish()?;
        Ok(read.map(|read| account = read).and_then(|()| some_frame(frames, input)))
    })??;
    Ok(format!(
        "{frames} frames of {} entries; {} error frames, {} unreadable entries.\n{}\n",
        account.entries,
        account.error_frames,
        account.unreadable,
        written.display()
    ))
}

/// Refuses a log without a frame, which is most often a file of another kind.
fn some_frame(frames: u64, input: &Path) -> Result<(), LogError> {
    match frames {
        0 => Err(LogError::new(
            input,
            "holds no frame; give a log of candump -L, Vector ASC or BLF, or MDF 4",
        )),
        _ => Ok(()),
    }
}

/// Writes frames in one of the formats.
enum FrameWriter<W: Write + Seek> {
    Candump(W),
    Asc(AscWriter<W>),
    Blf(BlfWriter<W>),
    Mf4(Box<Mf4Writer<W>>),
}

impl<W: Write + Seek> FrameWriter<W> {
    fn of(format: Format, out: W) -> Self {
        match format {
            Format::Candump => Self::Candump(out),
            Format::Asc => Self::Asc(AscWriter::new(out)),
            Format::Blf => Self::Blf(BlfWriter::new(out)),
            Format::Mf4 => Self::Mf4(Box::new(Mf4Writer::new(out))),
        }
    }

    fn write(&mut self, entry: &Entry) -> std::io::Result<()> {
        match self {
            // Where buses have numbers, the interfaces are called as those of SocketCAN.
            Self::Candump(out) if entry.bus.bytes().all(|b| b.is_ascii_digit()) => {
                candump::write_line(out, entry.time_us, &format!("can{}", entry.bus), entry.frame)
            }
            Self::Candump(out) => candump::write_line(out, entry.time_us, entry.bus, entry.frame),
            Self::Asc(writer) => writer.write(entry),
            Self::Blf(writer) => writer.write(entry),
            Self::Mf4(writer) => writer.write(entry),
        }
    }

    fn finish(self) -> std::io::Result<()> {
        match self {
            Self::Candump(_) => Ok(()),
            Self::Asc(writer) => writer.finish().map(|_| ()),
            Self::Blf(writer) => writer.finish().map(|_| ()),
            Self::Mf4(writer) => writer.finish().map(|_| ()),
        }
    }
}
