//! Flash in a file, for units that programs serve: it lasts from one start of the program to the next.

extern crate std;

use std::format;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::string::String;
use std::vec;

use super::ring::MAGIC;
use super::{BLOCK_BYTES, BLOCKS, BlockDevice, ERASED, FlashError};

const BYTES: usize = BLOCKS * BLOCK_BYTES;

/// A file as long as the flash, made when it is not there.
#[derive(Debug)]
pub struct FileFlash {
    file: File,
}

impl FileFlash {
    /// Opens a flash, or makes an erased one where there is no file, or an empty one. A file that holds anything
    /// else is left as it is.
    ///
    /// # Errors
    /// The file cannot be used as a flash; the reason in words.
    pub fn open(path: &Path) -> Result<Self, String> {
        let cannot = |why: &dyn core::fmt::Display| {
            format!("cannot use {} as a unit's memory: {why}", path.display())
        };
        // To open a pipe would wait for its other end.
        if let Ok(about) = std::fs::metadata(path)
            && !about.is_file()
        {
            return Err(cannot(&"it is no regular file"));
        }
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(|error| cannot(&error))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(cannot(&"another unit has it")),
            Err(TryLockError::Error(error)) => return Err(cannot(&error)),
        }
        let length = file.metadata().map_err(|error| cannot(&error))?.len();
        if length == 0 {
            make(&mut file).map_err(|error| cannot(&error))?;
            return Ok(Self { file });
        }
        if length != BYTES as u64 {
            return Err(cannot(&format!(
                "it is {length} bytes long, and a unit's memory {BYTES}: it is something else, or was cut off; it \
                 is left as it is, name another file"
            )));
        }
        let flash = Self { file };
        match flash.is_ours() {
            Ok(true) => Ok(flash),
            Ok(false) => Err(cannot(
                &"it holds something else; it is left as it is, name another file",
            )),
            Err(FlashError) => Err(cannot(&"it cannot be read")),
        }
    }

    /// Whether the flash holds a block of a unit, or is erased as a whole.
    fn is_ours(&self) -> Result<bool, FlashError> {
        let mut block = vec![0; BLOCK_BYTES];
        let mut erased = true;
        for number in 0..BLOCKS {
            self.read(number, 0, &mut block)?;
            if block.starts_with(&MAGIC) {
                return Ok(true);
            }
            erased &= block.iter().all(|byte| *byte == ERASED);
        }
        Ok(erased)
    }

    fn seek(&self, block: usize, offset: usize) -> io::Result<&File> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start((block * BLOCK_BYTES + offset) as u64))?;
        Ok(file)
    }
}

/// Makes an erased flash, with all its room on the disk at once. A file that cannot be made whole is emptied again.
fn make(file: &mut File) -> io::Result<()> {
    let made = file
        .write_all(&vec![ERASED; BYTES])
        .and_then(|()| file.sync_all());
    made.inspect_err(|_| {
        let _ = file.set_len(0);
    })
}

/// Checks that the bytes lie within a block of the device.
fn check(block: usize, offset: usize, bytes: usize) -> Result<(), FlashError> {
    let within = block < BLOCKS && offset + bytes <= BLOCK_BYTES;
    within.then_some(()).ok_or(FlashError)
}

fn failed(_: io::Error) -> FlashError {
    FlashError
}

impl BlockDevice for FileFlash {
    fn erase(&mut self, block: usize) -> Result<(), FlashError> {
        check(block, 0, BLOCK_BYTES)?;
        let mut file = self.seek(block, 0).map_err(failed)?;
        file.write_all(&[ERASED; BLOCK_BYTES]).map_err(failed)
    }

    fn program(&mut self, block: usize, offset: usize, bytes: &[u8]) -> Result<(), FlashError> {
        let mut cells = vec![0; bytes.len()];
        self.read(block, offset, &mut cells)?;
        for (cell, byte) in cells.iter_mut().zip(bytes) {
            *cell &= byte;
        }
        let mut file = self.seek(block, offset).map_err(failed)?;
        file.write_all(&cells).map_err(failed)
    }

    fn read(&self, block: usize, offset: usize, into: &mut [u8]) -> Result<(), FlashError> {
        check(block, offset, into.len())?;
        let mut file = self.seek(block, offset).map_err(failed)?;
        file.read_exact(into).map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    /// A path of this test's own.
    fn path(name: &str) -> PathBuf {
        let name = format!("unit-flash-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = std::fs::remove_file(&path);
        path
    }

    #[test]
    fn a_file_is_made_and_what_was_programmed_is_there_when_it_is_opened_again() {
        let path = path("again");
        let mut flash = FileFlash::open(&path).expect("made");
        flash.program(3, 10, &[0x0F; 2]).expect("programmed");
        flash.program(3, 11, &[0xF3; 1]).expect("bits cleared");
        let mut block = MAGIC.to_vec();
        block.resize(BLOCK_BYTES, 0);
        flash.program(9, 0, &block).expect("programmed");
        let taken = FileFlash::open(&path).expect_err("one unit has it");
        assert!(taken.contains("another unit has it"), "{taken}");
        drop(flash);
        let mut flash = FileFlash::open(&path).expect("opened");
        let mut cells = [0; 4];
        flash.read(3, 9, &mut cells).expect("read");
        assert_eq!(cells, [0xFF, 0x0F, 0x03, 0xFF]);
        flash.erase(3).expect("erased");
        flash.read(3, 9, &mut cells).expect("read");
        assert_eq!(cells, [0xFF; 4]);
        let outside = [
            flash.read(BLOCKS, 0, &mut cells),
            flash.program(0, BLOCK_BYTES - 1, &[0; 2]),
        ];
        assert_eq!(outside, [Err(FlashError); 2]);
        std::fs::remove_file(&path).expect("removed");
    }

    #[test]
    fn a_file_that_is_something_else_is_refused_and_left_as_it_is() {
        for (name, bytes, why) in [
            ("short", vec![0; 1000], "is 1000 bytes long"),
            ("long", vec![ERASED; BYTES + 1], "is 1048577 bytes long"),
            ("foreign", vec![b'x'; BYTES], "holds something else"),
        ] {
            let path = path(name);
            std::fs::write(&path, &bytes).expect("written");
            let error = FileFlash::open(&path).expect_err(name);
            assert!(error.contains(why), "{error}");
            assert_eq!(std::fs::read(&path).expect("there"), bytes);
            std::fs::remove_file(&path).expect("removed");
        }
        let directory = FileFlash::open(&std::env::temp_dir()).expect_err("no file");
        assert!(directory.contains("no regular file"), "{directory}");
        let nowhere = FileFlash::open(Path::new("/nowhere/at/all")).expect_err("no directory");
        assert!(nowhere.contains("/nowhere/at/all"), "{nowhere}");
    }
}
