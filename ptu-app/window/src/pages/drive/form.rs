//! Form of a drive: line, section, controller, train and day.

use btu_rig::drive::Load;
use eframe::egui::Ui;
use protocol::config::ControllerKind;

use crate::DataPaths;
use crate::parts::{caption, pick};
use ptu_report::words::Words;
use ptu_runs::drive::{Fixed, Request, S1, SectionChoice};
use ptu_runs::failure::Failure;

/// First choices of the form; they are the defaults of the command line, too.
const LINE: &str = "line8";
const SECTION: u16 = 61;
const TRAIN: &str = "line6";
const CONFIG: &str = "sg100";
const SEED: u64 = 1;

/// Lines with their sections, and trains.
pub struct Offered {
    /// Lines with their sections.
    lines: Vec<(String, Vec<u16>)>,
    trains: Vec<String>,
}

impl Offered {
    pub fn read(paths: &DataPaths) -> Result<Self, Failure> {
        let scripts = &paths.scripts;
        let sections = |name: String| {
            let line = scripts.line(&name)?.content;
            let numbers = line.sections.iter().map(|section| section.section);
            Ok((name, numbers.collect()))
        };
        let lines = scripts.line_names().into_iter().map(sections);
        Ok(Self {
            lines: lines.collect::<Result<_, Failure>>()?,
            trains: scripts.train_names(),
        })
    }
}

#[derive(Clone, Debug)]
pub struct Form {
    line: String,
    section: SectionChoice,
    controllers: Vec<ControllerKind>,
    train: String,
    full: bool,
    disturbed: bool,
}

impl Default for Form {
    fn default() -> Self {
        Self {
            line: LINE.to_owned(),
            section: SectionChoice::One(SECTION),
            controllers: Vec::new(),
            train: TRAIN.to_owned(),
            full: false,
            disturbed: false,
        }
    }
}

impl Form {
    /// Draws the lists to choose from.
    pub fn show(&mut self, ui: &mut Ui, words: &Words, offered: &Offered) {
        let said = &words.drive;
        let line = self.line.clone();
        let lines = offered.lines.iter().map(|(name, _)| (name.clone(), name));
        choose(ui, said.line, &mut self.line, lines);
        let of_line = offered.lines.iter().find(|(name, _)| *name == self.line);
        let sections = of_line.map_or(&[][..], |(_, sections)| sections);
        if line != self.line {
            self.section = sections
                .first()
                .map_or(SectionChoice::All, |first| SectionChoice::One(*first));
        }
        let one = |number: &u16| (SectionChoice::One(*number), number.to_string());
        let all = (SectionChoice::All, said.all_sections.to_owned());
        let sections = sections.iter().map(one).chain([all]);
        choose(ui, said.section, &mut self.section, sections);
        let one = |kind: ControllerKind| (vec![kind], kind.name());
        let controllers = ControllerKind::ALL.map(one).into_iter();
        let controllers = [(Vec::new(), said.configured)]
            .into_iter()
            .chain(controllers)
            .chain([(ControllerKind::ALL.to_vec(), said.side_by_side)]);
        choose(ui, said.controller, &mut self.controllers, controllers);
        let trains = offered.trains.iter().map(|name| (name.clone(), name));
        choose(ui, said.train, &mut self.train, trains);
        let loads = [(false, said.empty), (true, said.full)];
        choose(ui, said.load, &mut self.full, loads);
        let disturbances = [(false, said.no_disturbance), (true, said.s1)];
        choose(ui, said.disturbance, &mut self.disturbed, disturbances);
    }

    /// Request for a drive, as `ptu drive` would make it.
    pub fn request(&self) -> Result<Request, Failure> {
        let disturbance = self.disturbed.then_some(S1);
        Ok(Request {
            line: Some(self.line.clone()),
            sections: Some(self.section),
            controllers: self.controllers.clone(),
            train: self.train.clone(),
            mass_kg: None,
            load: self.full.then_some(Load::Full),
            fixed: Fixed {
                disturbance,
                ..Fixed::default()
            },
            code: None,
            unit_config: CONFIG.to_owned(),
            settings: Vec::new(),
            seed: SEED,
        })
    }
}

/// A list with its name above it.
fn choose<T: Clone + PartialEq>(
    ui: &mut Ui,
    name: &str,
    chosen: &mut T,
    offered: impl IntoIterator<Item = (T, impl Into<String>)>,
) {
    caption(ui, name);
    let wide = ui.available_width();
    pick(ui, (name, wide), chosen, offered);
}
