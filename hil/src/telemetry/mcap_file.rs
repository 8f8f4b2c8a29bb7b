//! An MCAP file: a channel with a JSON Schema for each topic, and a message for each topic and row.
//!
//! Nothing in it depends on the machine or on the time of day, so that a run gives the same bytes each time. Chunks are not compressed.

use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};

use super::topic::{Column, Topic, Value};

/// A file that is being written.
pub struct McapFile<W: Write + Seek> {
    writer: Writer<W>,
    runs: Vec<Vec<Channel>>,
    text: Vec<u8>,
}

struct Channel {
    id: u16,
    topic: Topic,
    messages: u32,
}

impl<W: Write + Seek> McapFile<W> {
    /// Begins a file. `program` is named in its head.
    ///
    /// # Errors
    /// The file cannot be written; here and below.
    pub fn new(out: W, program: &str) -> io::Result<Self> {
        let options = WriteOptions::new().compression(None).library(program);
        Ok(Self {
            writer: options.create(out).map_err(failed)?,
            runs: Vec::new(),
            text: Vec::new(),
        })
    }

    /// Adds the topics of a run with these columns. Runs are numbered from 0.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn add(&mut self, run: Option<&str>, columns: &[Column]) -> io::Result<()> {
        let channels: io::Result<Vec<Channel>> = Topic::of(run, columns)
            .into_iter()
            .map(|topic| {
                let schema = topic.json_schema();
                let schema = self.writer.add_schema(topic.schema, "jsonschema", schema.as_bytes());
                let schema = schema.map_err(failed)?;
                let id = self.writer.add_channel(schema, &topic.name, "json", &BTreeMap::new());
                Ok(Channel {
                    id: id.map_err(failed)?,
                    topic,
                    messages: 0,
                })
            })
            .collect();
        self.runs.push(channels?);
        Ok(())
    }

    /// Writes the messages of a row.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn row(&mut self, run: usize, time_ns: u64, row: &[Value]) -> io::Result<()> {
        for channel in self.runs.get_mut(run).into_iter().flatten() {
            self.text.clear();
            channel.topic.write(row, &mut self.text);
            let header = MessageHeader {
                channel_id: channel.id,
                sequence: channel.messages,
                log_time: time_ns,
                publish_time: time_ns,
            };
            channel.messages = channel.messages.wrapping_add(1);
            self.writer
                .write_to_known_channel(&header, &self.text)
                .map_err(failed)?;
        }
        Ok(())
    }

    /// Writes the index and ends the file.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map_err(failed)?;
        Ok(())
    }
}

fn failed(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut file = McapFile::new(Cursor::new(&mut bytes), "oleo").expect("memory");
        let columns = ["heave_m", "p1_front_left_Pa", "p1_rear_left_Pa"].map(Column::number);
        for run in ["soft", "stiff"] {
            file.add(Some(run), &columns).expect("memory");
        }
        for tick in 0..3_u64 {
            for run in 0..2 {
                let row = [1.0, 2.0, 3.0].map(|value| Value::Number(value * tick as f64));
                file.row(run, tick * 5_000_000, &row).expect("memory");
            }
        }
        file.finish().expect("memory");
        bytes
    }

    /// Read by the crate's own reader; another reader is in `tests/messages.py`.
    #[test]
    fn a_file_has_a_message_for_each_topic_and_row_and_the_same_bytes_each_time() {
        let bytes = written();
        assert_eq!(bytes, written());
        let messages: Vec<_> = (mcap::MessageStream::new(&bytes).expect("a file"))
            .map(|message| message.expect("a message"))
            .collect();
        assert_eq!(messages.len(), 18);
        let last = messages.last().expect("a message");
        assert_eq!(last.channel.topic, "/stiff/rear_left");
        assert_eq!((last.log_time, last.sequence), (10_000_000, 2));
        assert_eq!(String::from_utf8_lossy(&last.data), r#"{"p1_Pa":6.0}"#);
        let schema = last.channel.schema.as_ref().expect("a schema");
        assert_eq!(
            (schema.name.as_str(), schema.encoding.as_str()),
            ("oleo.Corner", "jsonschema")
        );
    }
}
