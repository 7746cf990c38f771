//! Flash in working memory, for units in simulation: it lasts as long as its owner.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use super::{BLOCK_BYTES, BLOCKS, BlockDevice, ERASED, FlashError};

/// Blocks are made when they are first programmed: a unit that is simulated for seconds uses two.
#[derive(Clone, Debug)]
pub struct RamFlash {
    blocks: Vec<Option<Box<[u8]>>>,
    erased: Vec<u32>,
    /// Bytes that may still be erased or programmed before the power fails.
    power_left: Option<usize>,
}

impl Default for RamFlash {
    /// A new device, erased.
    fn default() -> Self {
        Self {
            blocks: vec![None; BLOCKS],
            erased: vec![0; BLOCKS],
            power_left: None,
        }
    }
}

impl RamFlash {
    /// Lets the power fail after this number of bytes is erased or programmed; nothing is done from then on, until
    /// the next call with `None`.
    pub fn fail_after(&mut self, bytes: Option<usize>) {
        self.power_left = bytes;
    }

    /// Times each block was erased.
    pub fn erase_counts(&self) -> &[u32] {
        &self.erased
    }

    /// Bytes of a block, for a test to damage.
    pub fn block_mut(&mut self, block: usize) -> &mut [u8] {
        self.blocks[block].get_or_insert_with(|| vec![ERASED; BLOCK_BYTES].into_boxed_slice())
    }

    /// Bytes of `wanted` that are reached before the power fails.
    fn reached(&mut self, wanted: usize) -> Result<usize, usize> {
        let Some(left) = &mut self.power_left else {
            return Ok(wanted);
        };
        let reached = wanted.min(*left);
        *left -= reached;
        if reached == wanted {
            Ok(wanted)
        } else {
            Err(reached)
        }
    }
}

impl BlockDevice for RamFlash {
    fn erase(&mut self, block: usize) -> Result<(), FlashError> {
        let reached = self.reached(BLOCK_BYTES);
        let cells = self.blocks.get_mut(block).ok_or(FlashError)?;
        match reached {
            Ok(_) => {
                *cells = None;
                self.erased[block] += 1;
                Ok(())
            }
            Err(reached) => {
                if let Some(cells) = cells {
                    cells[..reached].fill(ERASED);
                }
                Err(FlashError)
            }
        }
    }

    fn program(&mut self, block: usize, offset: usize, bytes: &[u8]) -> Result<(), FlashError> {
        let reached = self.reached(bytes.len());
        let cells = self.blocks.get_mut(block).ok_or(FlashError)?;
        let cells = cells.get_or_insert_with(|| vec![ERASED; BLOCK_BYTES].into_boxed_slice());
        let end = offset + bytes.len();
        let cells = cells.get_mut(offset..end).ok_or(FlashError)?;
        let count = reached.unwrap_or_else(|reached| reached);
        for (cell, byte) in cells.iter_mut().zip(bytes).take(count) {
            *cell &= byte;
        }
        reached.map(|_| ()).map_err(|_| FlashError)
    }

    fn read(&self, block: usize, offset: usize, into: &mut [u8]) -> Result<(), FlashError> {
        let end = offset + into.len();
        match self.blocks.get(block).ok_or(FlashError)? {
            Some(cells) => into.copy_from_slice(cells.get(offset..end).ok_or(FlashError)?),
            None => into.fill(ERASED),
        }
        Ok(())
    }
}
