//! Opens a written file with the desktop's program for its type, which can also print it.

use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

use ptu_runs::failure::{Asked, Failure, RunTrouble};

/// Command that opens files here, and its arguments before the file's name.
const OPENER: (&str, &[&str]) = if cfg!(windows) {
    // `cmd /c start` would misread a file name with special characters.
    ("explorer", &[])
} else if cfg!(target_os = "macos") {
    ("open", &[])
} else {
    ("xdg-open", &[])
};

/// Opens a file, and returns without waiting for the viewer.
///
/// # Errors
/// The desktop has no program that opens files.
pub fn open_file(path: &Path) -> Result<(), Failure> {
    open_with(OPENER, path)
}

fn open_with((program, before): (&str, &[&str]), path: &Path) -> Result<(), Failure> {
    let mut command = Command::new(program);
    command.args(before).arg(path);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    match command.spawn() {
        Ok(mut child) => {
            // The thread waits for the opener, so that no zombie process is left; the viewer runs on.
            std::thread::spawn(move || child.wait());
            Ok(())
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Err(Failure::bench(
            Asked::OpensByHand(program.to_string(), path.display().to_string()),
        )),
        Err(error) => Err(Failure::bench(RunTrouble::NotStarted(
            program.to_owned(),
            error.to_string(),
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_desktop_without_an_opener_is_said_with_the_file() {
        let failure = open_with(("no-such-opener", &[]), Path::new("/a/sheet.pdf"));
        let said = failure.expect_err("there is none").to_string();
        assert!(
            said.contains("no-such-opener") && said.contains("/a/sheet.pdf"),
            "{said}"
        );
    }
}
