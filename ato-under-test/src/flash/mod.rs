//! Stored memory of the unit: event log and run record survive power off in flash memory [S0 §2].
//!
//! * [`BlockDevice`]: erase, program and read as a NOR flash does; [`RamFlash`] is one in working memory, `FileFlash` one in
//!   a file;
//! * `ring`: a log that fills the blocks in turn and finds its place again at power-up;
//! * `memory`: what the unit keeps in two such rings, and at which pace.

#[cfg(feature = "serve")]
mod file;
mod memory;
mod ram;
mod ring;

use core::fmt;

#[cfg(feature = "serve")]
pub use file::FileFlash;
pub(crate) use memory::{Memory, SetClockError};
pub use ram::RamFlash;
pub(crate) use ring::{LogRing, Slot};

/// Bytes of an erase block.
pub const BLOCK_BYTES: usize = 4096;
/// Erase blocks of the unit's flash, 1 MiB.
pub const BLOCKS: usize = 256;
/// A byte that is erased: programming clears bits of it.
pub const ERASED: u8 = 0xFF;

/// A flash memory of [`BLOCKS`] erase blocks of [`BLOCK_BYTES`]. Erasing sets all bytes of a block to [`ERASED`];
/// programming can only clear bits. Power may fail during either: the bytes not yet reached then keep their values.
pub trait BlockDevice: fmt::Debug + Send {
    /// Erases a block.
    ///
    /// # Errors
    /// The device does not do it; the block may hold anything.
    fn erase(&mut self, block: usize) -> Result<(), FlashError>;

    /// Programs `bytes` from `offset` of a block on; they lie within it.
    ///
    /// # Errors
    /// The device does not do it; these bytes may hold anything.
    fn program(&mut self, block: usize, offset: usize, bytes: &[u8]) -> Result<(), FlashError>;

    /// Reads from `offset` of a block on; what is read lies within it.
    ///
    /// # Errors
    /// The device does not do it.
    fn read(&self, block: usize, offset: usize, into: &mut [u8]) -> Result<(), FlashError>;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashError;
