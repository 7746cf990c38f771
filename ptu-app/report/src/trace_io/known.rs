//! Signals by the names and words that they have in files: found at once, however many there are.

use std::collections::{HashMap, HashSet};

use fault_db::{Channel, ChannelKind};

use super::column::column_name;
use super::series::plain;
use super::times::number;

/// Longest word of a signal, bytes.
const MAX_WORD: usize = 1024;

/// Stands behind the name of a column where a person named another column for the signal of this name.
pub(super) const OWN: &str = " (own column)";

/// A signal, and the numbers of its words.
#[derive(Clone)]
pub(super) struct Known {
    pub channel: Channel,
    words: HashMap<String, f64>,
    /// Whether traces have the signal; else the signal is a number with the name of a column.
    pub is_of_a_trace: bool,
}

#[derive(Default)]
pub(super) struct KnownSignals {
    signals: Vec<Known>,
    places: HashMap<String, usize>,
    /// Names of signals for which another column was named: a column of such a name is a number of its own.
    replaced: HashSet<String>,
}

impl Known {
    fn new(channel: Channel) -> Self {
        let mut words = HashMap::new();
        if let ChannelKind::Enum { labels } = &channel.kind {
            for (number, word) in labels {
                words.entry(word.clone()).or_insert(*number as f64);
            }
        }
        Self {
            channel,
            words,
            is_of_a_trace: true,
        }
    }

    /// Number of a word of the signal; `None` for any other word.
    pub fn number(&self, word: &str) -> Option<f64> {
        self.words.get(word).copied()
    }

    /// Sample of a cell: a number, with a decimal comma if there may be one, or a word of this signal.
    pub fn sample(&self, cell: &str, comma: bool) -> Result<f64, String> {
        if cell.is_empty() {
            return Ok(f64::NAN);
        }
        if cell.len() > MAX_WORD {
            return Err(format!("a text of {} bytes is no sample", cell.len()));
        }
        if let Some(number) = number(cell, comma) {
            return Ok(number);
        }
        match &self.channel.kind {
            ChannelKind::Bit if cell.eq_ignore_ascii_case("true") => Ok(1.0),
            ChannelKind::Bit if cell.eq_ignore_ascii_case("false") => Ok(0.0),
            ChannelKind::Enum { labels } => self.number(cell).ok_or_else(|| {
                let words: Vec<_> = labels.values().map(String::as_str).collect();
                format!("\"{cell}\" is none of {}", words.join(", "))
            }),
            _ => Err(format!("\"{cell}\" is no number")),
        }
    }
}

impl KnownSignals {
    /// Signals of these lists; of several with one name the first counts. `called` has headings of a file and the
    /// signals that they stand for.
    pub fn of(lists: &[&[Channel]], called: &[(String, String)]) -> Self {
        let mut all = Self::default();
        for channel in lists.iter().copied().flatten() {
            for name in [channel.name.clone(), column_name(channel)] {
                all.places.entry(name).or_insert(all.signals.len());
            }
            all.signals.push(Known::new(channel.clone()));
        }
        let place = |signal| all.places.get(signal).copied();
        let called: Vec<_> = (called.iter())
            .filter_map(|(heading, signal)| Some((heading, place(signal)?)))
            .collect();
        for (_, replaced) in &called {
            let all_names = all.places.iter().filter(|(_, place)| *place == replaced);
            all.replaced.extend(all_names.map(|(name, _)| name.clone()));
        }
        all.places.retain(|name, _| !all.replaced.contains(name));
        for (heading, place) in called {
            all.replaced.remove(heading);
            all.places.insert(heading.clone(), place);
        }
        all
    }

    /// The signal that files call by this name.
    pub fn named(&self, name: &str) -> Option<&Known> {
        self.places.get(name).map(|place| &self.signals[*place])
    }

    /// The signal of this name; else a number of this name.
    pub fn signal(&self, name: &str) -> Known {
        let known = self.named(name).cloned();
        let own = || match self.replaced.contains(name) {
            true => plain(&format!("{name}{OWN}")),
            false => plain(name),
        };
        known.unwrap_or_else(|| Known {
            is_of_a_trace: false,
            ..Known::new(own())
        })
    }
}
