//! Blocks of MDF 4: a head with an identifier and the length, links to other blocks, and data (ASAM MDF 4.1).

use std::io::{self, Write};

/// Bytes of the head of a block.
const HEAD: usize = 24;
/// Blocks begin at a multiple of this.
const ALIGNMENT: u64 = 8;

/// A file of blocks that is written from front to back.
pub struct BlockFile<W> {
    out: W,
    position: u64,
}

impl<W: Write> BlockFile<W> {
    /// A file in which nothing has been written.
    pub fn new(out: W) -> Self {
        Self { out, position: 0 }
    }

    /// Writes bytes that are no block.
    pub fn raw(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.position += bytes.len() as u64;
        self.out.write_all(bytes)
    }

    /// Writes a block and gives its place, to which other blocks link.
    pub fn block(&mut self, id: [u8; 2], links: &[u64], data: &[&[u8]]) -> io::Result<u64> {
        let over = self.position % ALIGNMENT;
        if over > 0 {
            self.raw(&[0; ALIGNMENT as usize][..(ALIGNMENT - over) as usize])?;
        }
        let at = self.position;
        let length = HEAD + 8 * links.len() + data.iter().map(|part| part.len()).sum::<usize>();
        let head = [b'#', b'#', id[0], id[1], 0, 0, 0, 0];
        self.raw(&head)?;
        for number in [length as u64, links.len() as u64].iter().chain(links) {
            self.raw(&number.to_le_bytes())?;
        }
        for part in data {
            self.raw(part)?;
        }
        Ok(at)
    }

    /// Writes a block of text: `TX`, or `MD` for XML.
    pub fn text(&mut self, id: [u8; 2], text: &str) -> io::Result<u64> {
        // Ended by a zero, and filled up to a whole number of eight bytes.
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize((bytes.len() + 1).next_multiple_of(ALIGNMENT as usize), 0);
        self.block(id, &[], &[&bytes])
    }

    /// What is written to, for links that become known at the end.
    pub fn into_inner(self) -> W {
        self.out
    }
}

/// Place of a link in the file: that of the block, and the number of the link in it.
pub const fn place_of_link(block: u64, link: u64) -> u64 {
    block + HEAD as u64 + 8 * link
}
