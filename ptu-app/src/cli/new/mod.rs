//! `ptu new`: commented files to begin with, in the user's own scripts.

use ptu_report::words::{Words, fill};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use script_files::{Layer, own_folder};

use super::{ScriptsOption, print_out};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Asked, Exit, Failure, FileTrouble, Unknown};
use ptu_runs::run::select;
use ptu_runs::whole_file::write_text;

/// Begin a procedure, unit configuration, line, train or fault mode of your own
///
/// Writes a file with comments that is valid as it is: `ptu run --check` accepts it. Without --in the file goes where
/// the program reads: into the folder of scripts if only one is read, as in a source tree, else into your own scripts,
/// which replace the program's scripts file by file. An existing file is not changed.
///
/// Examples:
///   ptu new procedure door/depot_doors
///   ptu new procedure depot/doors --like door/interlocks
///   ptu new unit sg200
///   ptu new line line9
///   ptu new train emu9
///   ptu new fault eb_relay.late_when_cold
///   ptu new stubs --in ~/ptu-stubs      the script language, for editors that complete and explain it
///   ptu new schemas --in ~/my-scripts   the keys of every data file, for editors that complete and explain them
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct NewArguments {
    /// What to begin
    #[arg(value_enum)]
    what: What,
    /// Name of the new file: FOLDER/NAME for a procedure, PART.NAME for a fault mode, else NAME
    #[arg(required_if_eq_any([("what", "procedure"), ("what", "unit"), ("what", "line"), ("what", "train"), ("what", "fault")]))]
    name: Option<String>,
    /// Begin with a copy of this procedure: its path, a folder or a glob; of several procedures the first is copied
    #[arg(long, value_name = "PROCEDURE")]
    like: Option<String>,
    /// Scripts directory to write into [default: the only one that is read, else the user's own]
    #[arg(long = "in", value_name = "DIR")]
    into: Option<PathBuf>,
    #[command(flatten)]
    scripts: ScriptsOption,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    /// Check procedure, `FOLDER/NAME.star`
    Procedure,
    /// Unit configuration, `units/NAME.toml`
    Unit,
    /// Line with its sections, `lines/NAME.toml`
    Line,
    /// Train of cars, `trains/NAME.toml`
    Train,
    /// Fault mode to inject, `faults/PART.NAME.toml`
    Fault,
    /// The words of the script language as Python stubs, for editors
    Stubs,
    /// JSON Schemas of every kind of data file, for editors
    Schemas,
}

impl NewArguments {
    /// Writes the new file, and says how to check and use it.
    pub fn run(self) -> Result<Exit, Failure> {
        let scripts = self.scripts.find()?;
        // Where only one folder of scripts is read, the new file goes there: it would not be read from elsewhere.
        let read_alone = match scripts.places() {
            [Layer::Folder(folder)] => Some(folder.clone()),
            _ => own_folder(),
        };
        let Some(folder) = self.into.clone().or(read_alone) else {
            return Err(Failure::usage(FileTrouble::NoUserFolder("--in")));
        };
        match self.what {
            What::Stubs => return stubs(&folder),
            What::Schemas => return schemas(&folder),
            _ => {}
        }
        let name = self.name.clone().unwrap_or_default();
        let name = name.trim_end_matches(".star").trim_end_matches(".toml");
        self.check_name(name)?;
        let (file, text) = self.begun(&scripts, name)?;
        let file = folder.join(file);
        write_new(&file, &text)?;
        let check = match &self.into {
            Some(folder) => format!("ptu run --check --scripts {}", folder.display()),
            None => "ptu run --check".to_owned(),
        };
        let next = self.next(name);
        let terminal = &Words::shown().terminal;
        let written = fill(terminal.files_written, &[("files", &file.display())]);
        let of = [("check", &check as _), ("next", &next as _)];
        print_out(&format!("{written}\n{}", fill(terminal.change_it, &of)))
    }

    /// Refuses a name that is not made of lower-case letters, digits and `_`; a procedure's may have folders.
    fn check_name(&self, name: &str) -> Result<(), Failure> {
        let is_word = |word: &str| {
            word.starts_with(|first: char| first.is_ascii_lowercase())
                && (word.bytes()).all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
        };
        let (words, form): (Vec<_>, _) = match self.what {
            What::Procedure => (name.split('/').collect(), "FOLDER/NAME"),
            What::Fault => (name.split('.').collect(), "PART.NAME"),
            _ => (vec![name], "NAME"),
        };
        // `split` gives one word at least.
        let count = self.what != What::Fault || words.len() == 2;
        match count && words.iter().all(|word| is_word(word)) {
            true => Ok(()),
            false => Err(Failure::usage(Asked::NoNewName(name.to_owned(), form))),
        }
    }

    /// Path of the new file under the scripts directory, and its text.
    fn begun(&self, scripts: &ScriptsDirectory, name: &str) -> Result<(String, String), Failure> {
        Ok(match self.what {
            What::Procedure => {
                let title = name.rsplit('/').next().unwrap_or(name).replace('_', " ");
                let text = match &self.like {
                    Some(like) => retitled(&like_of(scripts, like)?, &title),
                    None => include_str!("procedure.star").replace("{title}", &title),
                };
                (format!("{name}.star"), text)
            }
            What::Unit => (
                format!("units/{name}.toml"),
                renamed(&scripts.text("units/sg100.toml")?, "sg100", name),
            ),
            What::Line => {
                let text = renamed(&scripts.text("lines/test_track.toml")?, "test_track", name);
                (format!("lines/{name}.toml"), summed(&text))
            }
            What::Train => (
                format!("trains/{name}.toml"),
                renamed(&scripts.text("trains/line6.toml")?, "line6", name),
            ),
            What::Fault => {
                let part = name.split('.').next().unwrap_or(name);
                let parts = scripts.faults()?.lrus;
                if !parts.iter().any(|lru| lru.id.as_str() == part) {
                    let parts = parts.iter().map(|lru| lru.id.as_str());
                    return Err(Failure::usage(Unknown::Part(
                        part.to_owned(),
                        ptu_runs::failure::did_you_mean(part, parts),
                    )));
                }
                let text = include_str!("fault.toml")
                    .replace("{id}", name)
                    .replace("{part}", part);
                (format!("faults/{name}.toml"), text)
            }
            What::Stubs | What::Schemas => unreachable!("have no name and are written before"),
        })
    }

    /// Command that uses the new file.
    fn next(&self, name: &str) -> String {
        match self.what {
            What::Procedure => format!("ptu run {name}"),
            What::Unit => format!("ptu run --unit-config {name}"),
            What::Line => format!("ptu run --line {name}"),
            What::Train => format!("ptu run --train {name}"),
            What::Fault => format!("ptu run --inject {name}"),
            What::Stubs | What::Schemas => String::new(),
        }
    }
}

/// Text of the first procedure that `like` (a path, folder or glob) names.
fn like_of(scripts: &ScriptsDirectory, like: &str) -> Result<String, Failure> {
    let (mut texts, order) = select::scripts(scripts, &[like.to_owned()])?;
    let text = order.first().and_then(|path| texts.remove(path));
    Ok(text.unwrap_or_default())
}

/// Text of a procedure with another title, and without its Korean title.
fn retitled(text: &str, title: &str) -> String {
    let mut lines = String::new();
    for line in text.lines() {
        match line.strip_prefix("    title") {
            Some(rest) if rest.starts_with(" = ") => {
                lines += &format!("    title = \"{title}\",\n")
            }
            Some(rest) if rest.starts_with("_ko = ") => {}
            _ => lines += &format!("{line}\n"),
        }
    }
    lines
}

/// Text of a shipped file with its own name replaced, below a note that says what it was copied from.
fn renamed(text: &str, from: &str, to: &str) -> String {
    let quoted = |name: &str| format!("\"{name}\"");
    let begin = format!(
        "# {to}: begun as a copy of {from}. Its values are those of {from} until they are changed; name the source of \
         each.\n#\n"
    );
    begin + &text.replacen(&quoted(from), &quoted(to), usize::MAX)
}

/// Text of a line file with its checksum calculated again; a unit reports this checksum of its track database.
fn summed(text: &str) -> String {
    let sum = protocol::line::checksum(text);
    let line = |line: &str| match line.starts_with("checksum = ") {
        true => format!(
            "# Of all other lines. After a change, `ptu run --check` says the new one.\nchecksum = \"{sum:08x}\"\n"
        ),
        false => format!("{line}\n"),
    };
    let with_note: String = text.lines().map(line).collect();
    let sum_now = protocol::line::checksum(&with_note);
    with_note.replace(&format!("{sum:08x}"), &format!("{sum_now:08x}"))
}

fn write_new(file: &Path, text: &str) -> Result<(), Failure> {
    if file.exists() {
        return Err(Failure::usage(Asked::NewExists(file.display().to_string())));
    }
    write_text(file, text)
}

/// Writes a stub file for each namespace of the script language, and one for the words outside all namespaces.
fn stubs(folder: &Path) -> Result<Exit, Failure> {
    for (name, text) in btu_rig::procedure::loader::stubs() {
        write_text(&folder.join(name), text)?;
    }
    print_out(&format!(
        "written: {}\nname this folder to the editor's Starlark server, for instance `starlark-lsp start \
         --builtin-paths {}`",
        folder.display(),
        folder.display()
    ))
}

/// Writes a schema for each kind of data file, and `.taplo.toml`, which tells editors the schema of each file.
fn schemas(folder: &Path) -> Result<Exit, Failure> {
    let mut rules = String::new();
    let into = folder.join("schemas");
    for one in ptu_runs::schemas::all() {
        let name = format!("{}.schema.json", one.name);
        let text = format!("{:#}\n", one.schema.as_value());
        write_text(&into.join(&name), &text)?;
        rules.push_str(&format!(
            "[[rule]]\ninclude = {:?}\nexclude = {:?}\nschema.path = \"schemas/{name}\"\n\n",
            one.files, one.except
        ));
    }
    write_text(&folder.join(".taplo.toml"), &rules)?;
    print_out(&format!(
        "written: {} and {}",
        into.display(),
        folder.join(".taplo.toml").display()
    ))
}
