//! `ptu-window`: the technician's window. `ptu gui` starts it with the same options.

#[path = "../../../scripts/embedded.rs"]
mod embedded;

use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser};
use fault_db::Store;
use ptu_options::{WindowOptions, presets, refuse_password, settings_file};
use ptu_report::words::tell;
use ptu_runs::failure::{Asked, Exit, Failure, Trouble};
use ptu_runs::platform::{leave_own_console, ready_output, running_program, survive_file_limit};
use ptu_runs::run::loading;
use ptu_runs::stop::Stop;
use ptu_window::{DataPaths, Options, Settings, open};

#[derive(Debug, Parser)]
#[command(name = "ptu-window", version)]
struct CommandLine {
    #[command(flatten)]
    options: WindowOptions,
}

fn main() -> ExitCode {
    script_files::embed(embedded::FILES);
    survive_file_limit();
    ready_output();
    match run() {
        Ok(exit) => ExitCode::from(exit.code()),
        Err(failure) => {
            tell(&failure);
            ExitCode::from(failure.exit.code())
        }
    }
}

/// Opens the window; or, as a helper process of a window, loads scripts for it.
fn run() -> Result<Exit, Failure> {
    if std::env::args_os()
        .nth(1)
        .is_some_and(|word| word == loading::WORD)
    {
        return loading::serve().map(|()| Exit::Passed);
    }
    refuse_password()?;
    let command = presets::applied(CommandLine::command(), &presets::presets()?, &[]);
    let asked = CommandLine::from_arg_matches(&command.get_matches());
    let asked = asked.unwrap_or_else(|error| error.exit()).options;
    loading::load_apart(running_program());
    open(options(asked)?)?;
    Ok(Exit::Passed)
}

/// Options of the window: the saved settings, overridden by the command line.
fn options(asked: WindowOptions) -> Result<Options, Failure> {
    if !asked.create {
        asked.database.check_named().map_err(|why| {
            Failure::bench(Trouble::All(vec![why.message, Asked::Creates.into()]))
        })?;
    }
    let settings_file = settings_file("window.json").ok();
    let mut settings = settings_file
        .as_deref()
        .map(Settings::load)
        .unwrap_or_default();
    settings.language = asked.lang.unwrap_or(settings.language);
    settings.page = asked.page.unwrap_or(settings.page);
    let scripts = asked.scripts.find()?;
    let paths = match asked.database.server()? {
        Some(_) if asked.unit.is_some() => {
            return Err(Failure::usage(Asked::ServerIsRead));
        }
        Some(server) => {
            // Before there is a window to say it in.
            Store::connect_read_only(&server)?;
            DataPaths::of_server(server, scripts)
        }
        None => DataPaths::new(asked.database.file()?, scripts),
    };
    settings.unit.harness = asked.harness.unwrap_or(settings.unit.harness);
    if let Some(unit) = &asked.unit {
        settings.unit.endpoint = unit.to_string();
        settings.unit.faults = asked.inject;
        // Before there is a window to say it in.
        settings
            .unit
            .clone()
            .with_offered_faults()
            .setup(&paths.scripts)?;
    }
    leave_own_console();
    Ok(Options {
        paths,
        settings,
        settings_file,
        connect: asked.unit.is_some(),
        interrupted: Stop::default(),
    })
}
