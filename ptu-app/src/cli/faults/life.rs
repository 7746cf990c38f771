//! `ptu faults life`: what is stored about a unit, a train or a part by its serial number.

use clap::Args;
use fault_db::{Life, Store};
use protocol::display_text::line;

use crate::cli::{Json, ScriptsOption, at_least_one, print_json, print_out};
use ptu_report::life;
use ptu_report::naming::PartNames;
use ptu_report::words::{Words, fill};
use ptu_runs::clock::local;
use ptu_runs::failure::{Asked, Exit, Failure, did_you_mean_number};
use ptu_runs::table::Table;

/// Tell everything stored about a unit, a train or a part, by its serial number
///
/// Examples:
///   ptu faults life SG-0142
///   ptu faults life SN-77 --lang ko
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct LifeArguments {
    /// Serial number of a unit or of a part that a repair put in or took out, or number of a train
    serial: String,
    /// At most N entries, the latest
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = at_least_one())]
    limit: u32,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl LifeArguments {
    pub fn tell(&self, store: &Store) -> Result<Exit, Failure> {
        let lives = store.lives(&self.serial)?;
        if lives.is_empty() {
            return Err(self.unknown(store)?);
        }
        if self.json.is_asked() {
            return print_json(&lives.iter().map(life::json).collect::<Vec<_>>());
        }
        let names = PartNames::of(&self.scripts.find()?);
        let told = lives.iter().map(|life| self.told(life, &names));
        print_out(told.collect::<Vec<_>>().join("\n").trim_end())
    }

    fn told(&self, told: &Life, parts: &PartNames) -> String {
        let words = Words::shown();
        let mut text = format!("{}\n", line(&life::title(told, words)));
        if !told.stays.is_empty() {
            let of = words.life.stays(told.of);
            let headings = [of, words.life.from, words.life.until, words.life.runs];
            let mut stays = Table::headed(&headings).right([3]);
            for stay in &told.stays {
                stays.row(life::stay(told.of, stay, words, parts));
            }
            text.push_str(&format!("\n{}\n", stays.render()));
        }
        let earlier = told.events.len().saturating_sub(self.limit as usize);
        text.push_str(&format!("\n{}", events(told, earlier, words, parts)));
        if earlier > 0 {
            let said = fill(words.life.earlier, &[("n", &earlier)]);
            text.push_str(&format!("\n… {said}; --limit"));
        }
        text.push('\n');
        text
    }

    fn unknown(&self, store: &Store) -> Result<Failure, Failure> {
        let mut known = store.known_units()?;
        known.extend(store.known_trains()?);
        known.extend(store.known_part_serials()?);
        let hint = did_you_mean_number(&self.serial, known.iter().map(String::as_str));
        Ok(Failure::usage(Asked::NoLife(self.serial.clone(), hint)))
    }
}

fn events(told: &Life, earlier: usize, words: &Words, parts: &PartNames) -> String {
    let mut rows = Table::headed(&[words.faults.at, words.common.unit, words.life.what]);
    for entry in &told.events[earlier..] {
        let what = life::happened(entry, words, parts);
        rows.row([local(entry.at_us), entry.unit.clone(), what]);
    }
    rows.render()
}
