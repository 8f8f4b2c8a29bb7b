//! The objects of a BLF file, taken out of their containers one container at a time.

use std::io::{self, Read};

use flate2::read::ZlibDecoder;

use super::object::{BASE_HEAD, CONTAINER, SIGNATURE, number};

/// What every object begins with.
const OBJECT: &[u8] = b"LOBJ";
/// Most bytes between two objects: they are filled up to a multiple of four or eight, by rules that differ between kinds and writers.
const MOST_BETWEEN: usize = 8;
/// Bytes of the head of a container behind that of every object: how it is packed, and its size unpacked.
const CONTAINER_HEAD: usize = 16;
/// Writers make containers of 128 KiB, some of a few MB; a damaged or hostile file may claim any size.
const LARGEST: u64 = 64 << 20;
/// Bytes for which room is made because a container claims to hold so many.
const ROOM: usize = 1 << 20;

/// Why no more objects can be read.
pub enum Fault {
    /// The file cannot be read.
    Io(io::Error),
    /// The file ends in the container that begins at this byte.
    CutOff { container: u64 },
    /// The container that begins at this byte is none.
    Damaged { container: u64, what: &'static str },
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// The objects of a file. Its memory is that of a container, and of an object that did not fit in one.
pub struct Containers {
    source: Box<dyn Read>,
    /// Bytes of the file before the container that is being read.
    container: u64,
    /// Bytes of the file that have been read.
    position: u64,
    /// Bytes of a container as they are in the file.
    packed: Vec<u8>,
    /// Objects that are unpacked.
    objects: Vec<u8>,
    /// How many bytes of them were given already.
    given: usize,
}

impl Containers {
    /// A file of which nothing has been read.
    pub fn new(source: Box<dyn Read>) -> Self {
        Self {
            source,
            container: 0,
            position: 0,
            packed: Vec::new(),
            objects: Vec::new(),
            given: 0,
        }
    }

    /// The next object that is no container, from its head to its end; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<&[u8]>, Fault> {
        if self.position == 0 {
            self.read_file_head()?;
        }
        loop {
            if let Some((from, to)) = self.next_whole()? {
                self.given = to;
                return Ok(self.objects.get(from..to));
            }
            self.objects.drain(..self.given);
            self.given = 0;
            if self.objects.len() as u64 > LARGEST {
                return Err(self.damaged("has an object of more than 64 MiB"));
            }
            if !self.unpack_next()? {
                return Ok(None);
            }
        }
    }

    /// Whether an object was begun, and its end is in no container. Asked at the end of the file.
    pub fn ends_within_an_object(&self) -> bool {
        self.objects.iter().skip(self.given).any(|byte| *byte != 0)
    }

    /// Where the next object begins and ends in what is unpacked; `None` if its end is not there yet.
    fn next_whole(&self) -> Result<Option<(usize, usize)>, Fault> {
        let rest = self.objects.get(self.given..).unwrap_or(&[]);
        let Some(over) = begin_of_object(rest) else {
            return match rest.len() < MOST_BETWEEN + OBJECT.len() {
                true => Ok(None),
                false => Err(self.damaged("has no object where one should begin")),
            };
        };
        let Some(size) = size_of(&rest[over..]) else {
            return Ok(None);
        };
        if size < BASE_HEAD {
            return Err(self.damaged("has an object that is shorter than its head"));
        }
        let end = over.saturating_add(size);
        Ok((end <= rest.len()).then_some((self.given + over, self.given.saturating_add(end))))
    }

    fn read_file_head(&mut self) -> Result<(), Fault> {
        let mut head = [0; 8];
        let size = match self.fill(&mut head)? {
            8 if head.starts_with(SIGNATURE) => number(&head, 4).map(u32::from_le_bytes),
            _ => None,
        };
        let rest = u64::from(size.unwrap_or(0)).saturating_sub(8);
        let passed = io::copy(&mut self.source.by_ref().take(rest), &mut io::sink())?;
        self.position += passed;
        match size {
            Some(size) if size >= 8 && passed == rest => Ok(()),
            _ => Err(Fault::CutOff { container: 0 }),
        }
    }

    /// Reads the next container or object of the file and unpacks it; `false` at the end of the file.
    fn unpack_next(&mut self) -> Result<bool, Fault> {
        self.container = self.position;
        let mut head = [0; BASE_HEAD];
        let there = self.fill(&mut head)?;
        if there < BASE_HEAD && head.iter().all(|byte| *byte == 0) {
            return Ok(false);
        }
        let Some(over) = begin_of_object(&head[..there]) else {
            return Err(match there < BASE_HEAD {
                true => self.cut_off(),
                false => self.damaged("has no object where one should begin"),
            });
        };
        head.copy_within(over.., 0);
        let kept = there - over;
        self.container += over as u64;
        if kept + self.fill(&mut head[kept..])? < BASE_HEAD {
            return Err(self.cut_off());
        }
        let (Some(size), Some(kind)) = (size_of(&head), number(&head, 12).map(u32::from_le_bytes)) else {
            return Err(self.cut_off());
        };
        let Some(rest) = size.checked_sub(BASE_HEAD).filter(|rest| *rest as u64 <= LARGEST) else {
            return Err(self.damaged("has an object of an impossible size"));
        };
        // Objects that are in no container are read as if they were in one that is not packed.
        let (into, before) = if kind == CONTAINER {
            self.packed.clear();
            (&mut self.packed, 0)
        } else {
            self.objects.extend(head);
            (&mut self.objects, BASE_HEAD)
        };
        let read = self.source.by_ref().take(rest as u64).read_to_end(into)?;
        self.position += read as u64;
        if read < rest {
            // What is there of it is no object.
            into.truncate(into.len().saturating_sub(read + before));
            return Err(self.cut_off());
        }
        if kind == CONTAINER {
            self.unpack()?;
        }
        Ok(true)
    }

    /// Unpacks the container that was read.
    fn unpack(&mut self) -> Result<(), Fault> {
        let method = number(&self.packed, 0).map(u16::from_le_bytes);
        let claimed = number(&self.packed, 8).map(u32::from_le_bytes);
        let (Some(method), Some(claimed), Some(packed)) = (method, claimed, self.packed.get(CONTAINER_HEAD..)) else {
            return Err(self.damaged("has too few bytes"));
        };
        match method {
            0 => self.objects.extend(packed),
            2 => {
                self.objects.reserve((claimed as usize).min(ROOM));
                let unpacked = ZlibDecoder::new(packed).take(LARGEST).read_to_end(&mut self.objects);
                match unpacked {
                    Ok(bytes) if (bytes as u64) < LARGEST => {}
                    _ => return Err(self.damaged("has packed bytes that cannot be unpacked")),
                }
            }
            _ => return Err(self.damaged("has bytes that are packed in another way than with zlib")),
        }
        Ok(())
    }

    /// Reads until the bytes are full or the file ends, and says how many there are.
    fn fill(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut read = 0;
        while let Some(rest) = bytes.get_mut(read..).filter(|rest| !rest.is_empty()) {
            match self.source.read(rest) {
                Ok(0) => break,
                Ok(more) => read += more,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.position += read as u64;
        Ok(read)
    }

    fn cut_off(&self) -> Fault {
        Fault::CutOff {
            container: self.container,
        }
    }

    fn damaged(&self, what: &'static str) -> Fault {
        Fault::Damaged {
            container: self.container,
            what,
        }
    }
}

/// Where the first object begins, after the bytes that fill up the one before.
fn begin_of_object(bytes: &[u8]) -> Option<usize> {
    (0..=MOST_BETWEEN).find(|over| bytes.get(*over..).is_some_and(|bytes| bytes.starts_with(OBJECT)))
}

/// Bytes of an object with its head, as its head says.
fn size_of(object: &[u8]) -> Option<usize> {
    usize::try_from(u32::from_le_bytes(number(object, 8)?)).ok()
}
