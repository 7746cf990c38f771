//! Reads files that a user names: regular files only, up to a length limit.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;

use crate::files::platform;

/// Opens a regular file. Nothing else is even opened: a pipe would block until somebody writes to it, and a
/// device may never end or act on being opened.
///
/// # Errors
/// The system's error, or that the path is no regular file, and what it is instead.
pub fn open_regular_file(path: &Path) -> Result<File> {
    must_be_file(&std::fs::metadata(path)?)?;
    let file = File::open(path)?;
    // The path may lead to something else by now.
    must_be_file(&file.metadata()?)?;
    Ok(file)
}

/// Reads all of a regular file of at most `most` bytes.
///
/// # Errors
/// As [`open_regular_file`]; or the file is longer.
pub fn read_regular_file(path: &Path, most: u64) -> Result<Vec<u8>> {
    let file = open_regular_file(path)?;
    let mut bytes = Vec::new();
    // The file may grow while it is read.
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let what = format!("it is longer than {most} bytes");
        return Err(Error::new(ErrorKind::FileTooLarge, what));
    }
    Ok(bytes)
}

fn must_be_file(about: &Metadata) -> Result<()> {
    if about.is_file() {
        return Ok(());
    }
    let what = format!("it is {}, no regular file", kind(about));
    Err(Error::new(ErrorKind::InvalidInput, what))
}

fn kind(about: &Metadata) -> &'static str {
    let other = || platform::special_kind(about.file_type()).unwrap_or("something else");
    if about.is_dir() { "a folder" } else { other() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_opened_and_only_so_much_of_them_is_read() {
        let dir = tempfile::tempdir().expect("a directory");
        let file = dir.path().join("a.toml");
        std::fs::write(&file, "12345").expect("written");
        assert_eq!(read_regular_file(&file, 5).expect("read"), b"12345");
        let told = |path: &Path, most| {
            read_regular_file(path, most)
                .expect_err("refused")
                .to_string()
        };
        assert_eq!(told(&file, 4), "it is longer than 4 bytes");
        assert_eq!(told(dir.path(), 9), "it is a folder, no regular file");
        assert_eq!(
            told(Path::new("/dev/zero"), 9),
            "it is a device, no regular file"
        );
        let pipe = dir.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo starts").success());
        // Nobody writes to it: opening it would block.
        assert_eq!(told(&pipe, 9), "it is a pipe, no regular file");
        let _socket = std::os::unix::net::UnixListener::bind(dir.path().join("s")).expect("bound");
        assert_eq!(
            told(&dir.path().join("s"), 9),
            "it is a socket, no regular file"
        );
        let missing = read_regular_file(&dir.path().join("none"), 9).expect_err("missing");
        assert_eq!(missing.kind(), ErrorKind::NotFound);
    }
}
