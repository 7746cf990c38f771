//! The driver of a SCPI instrument, `instruments/NAME.toml`: templates of commands, questions, ranges.

use std::collections::BTreeMap;

use btu_rig::rig::InstrumentFault;
use serde::Deserialize;
use toml::Spanned;

use super::error::PlacesError;

/// Values of a stimulus by name.
pub(super) type Values = BTreeMap<&'static str, f64>;

/// A driver whose names and values were checked.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Text that the instrument's answer to `*IDN?` holds.
    pub idn: String,
    /// The question for the next entry of its error queue, whose answer begins with a number, 0 for none.
    pub error: String,
    /// Commands after connecting.
    #[serde(default)]
    pub begin: Vec<String>,
    /// Commands that switch all its outputs off.
    #[serde(default)]
    pub off: Vec<String>,
    /// Commands for stimuli, by act: `code`, `pulses` or `supply`.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Act>")]
    pub acts: BTreeMap<String, Spanned<Act>>,
    /// Questions of the instrument, by the names that readings give.
    #[serde(default)]
    pub reads: BTreeMap<String, Read>,
    /// Least and greatest value that the instrument takes, by name of the value.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, [f64; 2]>")]
    pub ranges: BTreeMap<String, Spanned<[f64; 2]>>,
}

/// Commands for a stimulus.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Act {
    /// Commands that make the stimulus with its values.
    #[schemars(with = "Vec<String>")]
    pub on: Vec<Spanned<String>>,
    /// Commands for a carrier without a code rate; none: the instrument cannot make one.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub unmodulated: Vec<Spanned<String>>,
    /// Commands that end the stimulus.
    #[schemars(with = "Vec<String>")]
    pub off: Vec<Spanned<String>>,
}

/// A question to an instrument, and where the value is in its answer.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Read {
    /// The line that is sent.
    pub ask: String,
    /// Which of the numbers of the answer, counted from 0.
    #[serde(default)]
    pub field: usize,
}

/// Acts and their values.
const ACTS: [(&str, &[&str]); 3] = [
    (
        "code",
        &[
            "channel",
            "carrier_hz",
            "rate_hz",
            "period_s",
            "level_mv",
            "level_v",
        ],
    ),
    ("pulses", &["channel", "hz", "backward"]),
    ("supply", &["channel", "volts"]),
];

impl Model {
    /// Reads a driver.
    ///
    /// # Errors
    /// The driver is wrong, in a line that is named.
    pub fn from_toml(text: &str) -> Result<Self, PlacesError> {
        let model: Self = toml::from_str(text)?;
        for (name, act) in &model.acts {
            let Some((_, values)) = ACTS.iter().find(|(known, _)| known == name) else {
                return Err(PlacesError::at(
                    text,
                    &act.span(),
                    format!("no act \"{name}\": it is code, pulses or supply"),
                ));
            };
            let act = act.get_ref();
            for command in act.on.iter().chain(&act.unmodulated).chain(&act.off) {
                let used = command.get_ref().split('{').skip(1);
                let mut used = used.map(|rest| rest.split('}').next().unwrap_or(rest));
                if let Some(other) = used.find(|value| !values.contains(value)) {
                    let known = values.join(", ");
                    return Err(PlacesError::at(
                        text,
                        &command.span(),
                        format!("no value \"{other}\" of {name}: {known}"),
                    ));
                }
            }
        }
        for (name, range) in &model.ranges {
            let mut known = ACTS.iter().flat_map(|(_, values)| *values);
            if !known.any(|known| known == name) {
                let why = format!("range of {name}: no act has this value");
                return Err(PlacesError::at(text, &range.span(), why));
            }
            let [low, high] = range.get_ref();
            if !(low.is_finite() && low < high) {
                return Err(PlacesError::at(
                    text,
                    &range.span(),
                    format!("range of {name}: [least, greatest]"),
                ));
            }
        }
        Ok(model)
    }

    /// The value that is out of range, if one is.
    pub fn out_of_range(&self, values: &Values) -> Option<InstrumentFault> {
        // A carrier that is not modulated has no rate.
        let given = |(what, value): &(&&str, &f64)| {
            !["rate_hz", "period_s"].contains(what) || **value > 0.0
        };
        values.iter().filter(given).find_map(|(what, value)| {
            let [low, high] = self.ranges.get(*what)?.get_ref();
            (!(*low..=*high).contains(value)).then(|| InstrumentFault::OutOfRange {
                what: (*what).to_owned(),
                value: value.to_string(),
                low: low.to_string(),
                high: high.to_string(),
            })
        })
    }
}

/// Values of an antenna signal.
pub(super) fn code_values(carrier_hz: f64, rate_hz: f64, level_mv: f64) -> Values {
    // Without a carrier there is no signal, whatever level is asked for.
    let level_mv = if carrier_hz > 0.0 { level_mv } else { 0.0 };
    Values::from([
        ("carrier_hz", carrier_hz),
        ("rate_hz", rate_hz),
        ("period_s", if rate_hz > 0.0 { 1.0 / rate_hz } else { 0.0 }),
        ("level_mv", level_mv),
        ("level_v", level_mv / 1000.0),
    ])
}

/// A command with its values.
pub(super) fn filled(template: &str, values: &Values) -> String {
    let mut command = template.to_owned();
    for (name, value) in values {
        command = command.replace(&format!("{{{name}}}"), &value.to_string());
    }
    command
}
