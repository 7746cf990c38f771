//! A log ring over erase blocks.
//!
//! Blocks are filled in turn and erased in turn, so their numbers of erasures differ by one at most. The number of a
//! block in the order of use, its **turn**, stands in its header; entries have a fixed size, so turn and place give an
//! entry's **sequence number**, which goes on over power-ups and is never reused:
//!
//! ```text
//! block   header: magic, version, kind, slot size, turn, CRC | slot 0 | slot 1 | … | slot 100
//! slot    sequence, power-up count, content, CRC
//! ```
//! The block with the oldest entries is erased when the newest one is full. A slot that power-off left half
//! written is passed over; its number stays used. Where a header is damaged the turn is found from the entries.

use alloc::vec;
use alloc::vec::Vec;

use protocol::frame::fcs;

use super::{BLOCK_BYTES, BlockDevice, ERASED, FlashError};

/// First bytes of each block of a ring.
pub const MAGIC: [u8; 4] = *b"ATOF";
const VERSION: u8 = 1;
const HEADER_BYTES: usize = 16;
/// Bytes of an entry's content.
pub const CONTENT_BYTES: usize = 28;
const SLOT_BYTES: usize = 4 + 4 + CONTENT_BYTES + 4;
/// Entries of a block.
pub const SLOTS: u32 = ((BLOCK_BYTES - HEADER_BYTES) / SLOT_BYTES) as u32;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stored {
    pub sequence: u32,
    /// Number of the power-up in which the entry was written, from 1.
    pub power_up: u32,
    /// Content as the writer put it in; what the writer left out is [`ERASED`].
    pub content: [u8; CONTENT_BYTES],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    Empty,
    /// An entry whose CRC or sequence number is wrong.
    Damaged,
    Entry(Stored),
}

/// The ring's place in its part of a device.
#[derive(Debug)]
pub struct LogRing {
    kind: u8,
    first_block: usize,
    /// Turn of each block; `None`: no header that checks.
    turns: Vec<Option<u32>>,
    next: u32,
    /// Whether the block that `next` will lie in has its header.
    begun: bool,
    /// Power-up count of the newest entry; 0 if there is none.
    pub last_power_up: u32,
}

impl LogRing {
    /// Number the next entry gets.
    pub fn next(&self) -> u32 {
        self.next
    }

    /// Finds what stands in `blocks` blocks from `first_block` on, at least 2; writes nothing. Reads each header,
    /// the last block in use, and more only if that is damaged.
    ///
    /// # Errors
    /// The device cannot be read.
    pub fn mount(
        device: &dyn BlockDevice,
        kind: u8,
        first_block: usize,
        blocks: usize,
    ) -> Result<Self, FlashError> {
        let mut ring = Self {
            kind,
            first_block,
            turns: vec![None; blocks],
            next: 0,
            begun: false,
            last_power_up: 0,
        };
        for block in 0..blocks {
            ring.turns[block] = ring.read_turn(device, block)?;
        }
        ring.forget_strays();
        let Some(newest) = ring.turns.iter().flatten().max().copied() else {
            return Ok(ring);
        };
        // The next entry follows the last slot that is not empty: an entry that was cut off has used its number.
        let mut used = 0;
        for slot in 0..SLOTS {
            if ring.slot(device, newest * SLOTS + slot)? != Slot::Empty {
                used = slot + 1;
            }
        }
        ring.next = newest * SLOTS + used;
        ring.begun = used < SLOTS;
        ring.last_power_up = ring.find_last_power_up(device)?;
        Ok(ring)
    }

    /// Forgets turns too old to belong to the present lap: they are of a block that was to be erased next, or of a
    /// device that was put together from two.
    fn forget_strays(&mut self) {
        let Some(newest) = self.turns.iter().flatten().max().copied() else {
            return;
        };
        let lap = self.turns.len() as u32;
        for turn in &mut self.turns {
            *turn = turn.filter(|turn| newest - *turn < lap);
        }
    }

    fn find_last_power_up(&self, device: &dyn BlockDevice) -> Result<u32, FlashError> {
        let oldest = self.oldest();
        let mut sequence = self.next;
        while sequence > oldest {
            sequence -= 1;
            if let Slot::Entry(stored) = self.read(device, sequence)? {
                return Ok(stored.power_up);
            }
        }
        Ok(0)
    }

    /// Number of the oldest entry that is kept; [`next`](Self::next) if there is none.
    pub fn oldest(&self) -> u32 {
        let oldest = self.turns.iter().flatten().min();
        oldest.map_or(self.next, |turn| (turn * SLOTS).min(self.next))
    }

    /// The next entry will be the first of a block.
    pub fn at_block_begin(&self) -> bool {
        self.next.is_multiple_of(SLOTS)
    }

    /// Writes an entry: 40 bytes, and once in a block its header, with the erasing of the next one. After an
    /// error the slot counts as used.
    ///
    /// # Errors
    /// The device fails, or all numbers are used.
    pub fn append(
        &mut self,
        device: &mut dyn BlockDevice,
        power_up: u32,
        content: &[u8],
    ) -> Result<u32, FlashError> {
        let sequence = self.next;
        if sequence == u32::MAX {
            return Err(FlashError);
        }
        let (turn, slot) = (sequence / SLOTS, sequence % SLOTS);
        let block = self.block_of(turn);
        if !self.begun {
            self.begin_block(device, turn)?;
        }
        let mut bytes = [ERASED; SLOT_BYTES];
        bytes[..4].copy_from_slice(&sequence.to_be_bytes());
        bytes[4..8].copy_from_slice(&power_up.to_be_bytes());
        let kept = content.len().min(CONTENT_BYTES);
        bytes[8..8 + kept].copy_from_slice(&content[..kept]);
        let crc = fcs(&bytes[..SLOT_BYTES - 4]);
        bytes[SLOT_BYTES - 4..].copy_from_slice(&crc.to_be_bytes());
        self.next += 1;
        self.begun = slot + 1 < SLOTS;
        self.last_power_up = power_up;
        device.program(self.first_block + block, offset_of(slot), &bytes)?;
        Ok(sequence)
    }

    /// Erases the block, unless it is erased already, and writes its header.
    fn begin_block(&mut self, device: &mut dyn BlockDevice, turn: u32) -> Result<(), FlashError> {
        let block = self.block_of(turn);
        self.turns[block] = None;
        if !is_erased(device, self.first_block + block)? {
            device.erase(self.first_block + block)?;
        }
        device.program(self.first_block + block, 0, &self.header(turn))?;
        self.turns[block] = Some(turn);
        self.begun = true;
        Ok(())
    }

    /// Reads the entry with this number; `Empty` also for a number that is kept no more, or not
    /// yet.
    ///
    /// # Errors
    /// The device cannot be read.
    pub fn read(&self, device: &dyn BlockDevice, sequence: u32) -> Result<Slot, FlashError> {
        let turn = sequence / SLOTS;
        if self.turns[self.block_of(turn)] != Some(turn) || sequence >= self.next {
            return Ok(Slot::Empty);
        }
        self.slot(device, sequence)
    }

    fn slot(&self, device: &dyn BlockDevice, sequence: u32) -> Result<Slot, FlashError> {
        let mut bytes = [0; SLOT_BYTES];
        let block = self.first_block + self.block_of(sequence / SLOTS);
        device.read(block, offset_of(sequence % SLOTS), &mut bytes)?;
        if bytes.iter().all(|byte| *byte == ERASED) {
            return Ok(Slot::Empty);
        }
        if !checks(&bytes) || word(&bytes, 0) != sequence {
            return Ok(Slot::Damaged);
        }
        let mut content = [0; CONTENT_BYTES];
        content.copy_from_slice(&bytes[8..8 + CONTENT_BYTES]);
        Ok(Slot::Entry(Stored {
            sequence,
            power_up: word(&bytes, 4),
            content,
        }))
    }

    fn block_of(&self, turn: u32) -> usize {
        turn as usize % self.turns.len()
    }

    fn header(&self, turn: u32) -> [u8; HEADER_BYTES] {
        let mut header = [0; HEADER_BYTES];
        header[..4].copy_from_slice(&MAGIC);
        header[4] = VERSION;
        header[5] = self.kind;
        header[6..8].copy_from_slice(&(SLOT_BYTES as u16).to_be_bytes());
        header[8..12].copy_from_slice(&turn.to_be_bytes());
        let crc = fcs(&header[..HEADER_BYTES - 4]);
        header[HEADER_BYTES - 4..].copy_from_slice(&crc.to_be_bytes());
        header
    }

    /// The turn of a block: as its header says, or, if that is damaged, as its entries do.
    fn read_turn(&self, device: &dyn BlockDevice, block: usize) -> Result<Option<u32>, FlashError> {
        let mut header = [0; HEADER_BYTES];
        device.read(self.first_block + block, 0, &mut header)?;
        let fits = |turn: &u32| *turn < u32::MAX / SLOTS && self.block_of(*turn) == block;
        let turn = u32::from_be_bytes([header[8], header[9], header[10], header[11]]);
        if header == self.header(turn) {
            return Ok(Some(turn).filter(fits));
        }
        if header == [ERASED; HEADER_BYTES] {
            return Ok(None);
        }
        for slot in 0..SLOTS {
            let mut bytes = [0; SLOT_BYTES];
            device.read(self.first_block + block, offset_of(slot), &mut bytes)?;
            let sequence = word(&bytes, 0);
            let turn = sequence / SLOTS;
            if checks(&bytes) && sequence % SLOTS == slot && fits(&turn) {
                return Ok(Some(turn));
            }
        }
        Ok(None)
    }
}

fn word(bytes: &[u8; SLOT_BYTES], at: usize) -> u32 {
    u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// The CRC of a slot fits.
fn checks(bytes: &[u8; SLOT_BYTES]) -> bool {
    fcs(&bytes[..SLOT_BYTES - 4]) == word(bytes, SLOT_BYTES - 4)
}

fn offset_of(slot: u32) -> usize {
    HEADER_BYTES + slot as usize * SLOT_BYTES
}

fn is_erased(device: &dyn BlockDevice, block: usize) -> Result<bool, FlashError> {
    let mut bytes = [0; 256];
    for offset in (0..BLOCK_BYTES).step_by(bytes.len()) {
        device.read(block, offset, &mut bytes)?;
        if bytes.iter().any(|byte| *byte != ERASED) {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests;
