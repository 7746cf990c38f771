//! Reads line files (TOML). An error names the line of the file; a checksum detects unintended changes.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use serde::Deserialize;
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::rules::LineEntry;
use super::{Broken, Line, Section};
use crate::config;

/// Why a line file is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LineError {
    /// The text does not parse, or an entry is missing; the message has line and column.
    #[error("{0}")]
    Syntax(String),
    /// The data of the line are impossible.
    #[error("line {line}: {reason}")]
    Data {
        /// Line of the file, from 1.
        line: usize,
        /// Defect of the data.
        reason: String,
    },
}

/// Content of a line file.
#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[schemars(with = "Option<String>")]
    checksum: Option<Spanned<String>>,
    loops_m: Option<[f64; 2]>,
    sections: Vec<Section>,
}

/// Reads and checks a line file.
pub(super) fn read(text: &str) -> Result<Line, LineError> {
    let file: File = toml::from_str(text).map_err(|e| LineError::Syntax(e.to_string()))?;
    let mut line = Line {
        name: file.name,
        loops_m: file.loops_m,
        sections: file.sections,
    };
    line.check().map_err(|broken| located(text, broken))?;
    line.sections.iter_mut().for_each(Section::send_limits);
    match file.checksum {
        Some(given) => check_sum(text, &given).map(|()| line),
        None => Ok(line),
    }
}

/// JSON schema of a line file.
pub fn file_schema() -> schemars::Schema {
    schemars::SchemaGenerator::default().into_root_schema_for::<File>()
}

/// CRC-32 of a line file, its own `checksum = "…"` line left out: what the unit reports of its
/// track database.
pub fn checksum(text: &str) -> u32 {
    let at = DeTable::parse(text)
        .ok()
        .and_then(|file| Some(file.get_ref().get_key_value("checksum")?.0.span().start));
    let Some((before, rest)) = at.and_then(|at| text.split_at_checked(at)) else {
        return config::checksum(text);
    };
    let before = before.rfind('\n').map_or("", |end| &before[..=end]);
    let after = rest.find('\n').map_or("", |end| &rest[end + 1..]);
    config::checksum(&[before, after].concat())
}

fn check_sum(text: &str, given: &Spanned<String>) -> Result<(), LineError> {
    let found = format!("{:08x}", checksum(text));
    if given.get_ref().eq_ignore_ascii_case(&found) {
        return Ok(());
    }
    Err(LineError::Data {
        line: line_at(text, given.span().start),
        reason: format!(
            "checksum \"{}\" is wrong, the file's is \"{found}\": undo what was changed, or enter it",
            given.get_ref()
        ),
    })
}

fn located(text: &str, broken: Broken) -> LineError {
    let start = broken.place.and_then(|place| start_of(text, place));
    LineError::Data {
        line: line_at(text, start.unwrap_or(0)),
        reason: broken.reason,
    }
}

/// Where an entry begins in the text; for an entry that is missing, where its section begins.
fn start_of(text: &str, place: LineEntry) -> Option<usize> {
    let file = DeTable::parse(text).ok()?;
    let section = file
        .get_ref()
        .get("sections")?
        .get_ref()
        .get(place.section)?;
    let entry = section.get_ref().get(place.key);
    let item = entry.and_then(|entry| entry.get_ref().get(place.item?));
    let spanned: &Spanned<DeValue<'_>> = item.or(entry).unwrap_or(section);
    Some(spanned.span().start)
}

/// Line of the byte at `at`, from 1.
fn line_at(text: &str, at: usize) -> usize {
    let before = text.as_bytes().get(..at).unwrap_or_default();
    before.iter().filter(|&&byte| byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE8: &str = include_str!("../../../scripts/lines/line8.toml");
    const LINE6: &str = include_str!("../../../scripts/lines/line6.toml");
    const TEST_TRACK: &str = include_str!("../../../scripts/lines/test_track.toml");

    /// A good section from line 2 on, with one entry replaced.
    fn section(entry: &str, instead: &str) -> String {
        let section = "\
name = \"x\"
[[sections]]
section = 61
route = 8
length_m = 850.03
from_station = 823
from_loop = 8231
to_station = 824
to_loop = 8241
start_m = 0.0
stop_m = 850.03
markers_m = [304.03, 741.53, 829.03, 846.53]
door_side = \"right\"
gradients = [
    { at_m = 0.0, permille = 0.0 },
    { at_m = 200.0, permille = -3.0 },
]
curves = [
    { at_m = 100.0, radius_m = 300.0 },
    { at_m = 300.0, radius_m = 0.0 },
]
speed_codes = [
    { at_m = 0.0, code = \"65\" },
    { at_m = 300.0, code = \"55\" },
]
";
        assert!(section.contains(entry), "{entry}");
        section.replace(entry, instead)
    }

    #[test]
    fn the_lines_that_are_delivered_are_good() {
        for text in [LINE8, LINE6, TEST_TRACK] {
            read(text).unwrap();
        }
        assert!(read(&section("", "")).is_ok());
    }

    /// Section 61 as printed [S0 §4].
    #[test]
    fn section_61_is_as_printed() {
        let line = read(LINE8).unwrap();
        let section = line.section(61).unwrap();
        assert_eq!(section.length_m, 850.03);
        assert_eq!(section.markers_m, [304.03, 741.53, 829.03, 846.53]);
        assert_eq!((section.gradients.len(), section.curves.len()), (4, 0));
        let numbers: Vec<_> = line.sections.iter().map(|s| s.section).collect();
        assert_eq!(numbers, (54..=65).collect::<Vec<u16>>());
    }

    /// What is wrong, at which line, in which words.
    #[test]
    fn an_impossible_line_is_refused_and_its_place_in_the_file_is_named() {
        let rows = include_str!("wrong_lines.txt").lines().skip(1);
        for row in rows.map(|row| row.replace("\\n", "\n")) {
            let [entry, instead, at, words] = row.split(" | ").collect::<Vec<_>>()[..] else {
                panic!("{row}")
            };
            let said = read(&section(entry, instead)).unwrap_err().to_string();
            assert!(said.contains(words), "{instead}: {said}");
            assert!(at == "0" || said.contains(&format!("line {at}")), "{said}");
        }
    }

    /// Goal: limits of public data are sent as codes. Method: a curve of 60 km/h between a limit of 80 and one of 50.
    #[test]
    fn limits_by_position_and_of_curves_become_codes() {
        let codes = "speed_codes = [\n    { at_m = 0.0, code = \"65\" },\n    { at_m = 300.0, code = \"55\" },\n]\n";
        let limits = "limits = [{ at_m = 0.0, kmh = 80 }, { at_m = 400.0, kmh = 50 }]\n";
        let text =
            section(codes, limits).replace("radius_m = 300.0", "radius_m = 300.0, limit_kmh = 60");
        let line = read(&text).unwrap();
        let sent = &line.sections[0].speed_codes;
        let sent: Vec<_> = sent.iter().map(|c| (c.at_m, c.code.as_str())).collect();
        let wanted = [(0.0, "≤80"), (100.0, "≤60"), (300.0, "≤80"), (400.0, "≤50")];
        assert_eq!(sent, wanted);
        line.check().unwrap();
        let said = read(&text.replace("kmh = 80", "kmh = 300")).unwrap_err();
        assert!(said.to_string().contains("a limit of 300 km/h"), "{said}");
    }

    #[test]
    fn sections_must_fit_together() {
        let second = LINE8.find("# Sujin").unwrap();
        let twice = LINE8.replacen("section = 55", "section = 54", 1);
        let astray = LINE8.replacen("from_station = 817", "from_station = 717", 1);
        let line = |key: &str| line_at(LINE8, second + LINE8[second..].find(key).unwrap());
        for (text, key, words) in [
            (&twice, "section =", "section 54 is listed twice"),
            (
                &astray,
                "from_station",
                "section 55: from_station 717 must be to_station 817 of section 54",
            ),
        ] {
            let expected = format!("line {}: {words}", line(key));
            assert_eq!(read(text).unwrap_err().to_string(), expected);
        }
        assert!(read("name = \"x\"\nsections = []").is_err());
    }

    /// Goal: the checksum is that of everything but its own line, wherever that stands.
    #[test]
    fn a_wrong_checksum_is_refused_and_the_right_one_told() {
        let plain = section("", "");
        let crc = checksum(&plain);
        assert_eq!(crc, config::checksum(&plain));
        let with = |sum: &str| {
            section(
                "[[sections]]",
                &format!("checksum = \"{sum}\" # guard\n[[sections]]"),
            )
        };
        assert_eq!(checksum(&with("?")), crc);
        assert!(read(&with(&format!("{crc:08X}"))).is_ok());
        let said = read(&with("00000000")).unwrap_err().to_string();
        assert!(
            said.starts_with("line 2: checksum \"00000000\" is wrong"),
            "{said}"
        );
        assert!(said.contains(&format!("\"{crc:08x}\"")), "{said}");
        let changed = with(&format!("{crc:08x}")).replace("850.03", "850.04");
        assert!(read(&changed).is_err());
    }

    /// Goal: no text panics, cut or changed anywhere.
    #[test]
    fn a_damaged_file_never_panics() {
        let text = section("", "checksum = \"0\"\n");
        for at in (0..text.len()).step_by(11) {
            let (before, after) = (&text[..at], &text[at + 1..]);
            for damaged in [
                before.to_string(),
                format!("{before}9{after}"),
                format!("{before}\n{after}"),
            ] {
                let _ = (read(&damaged), checksum(&damaged));
            }
        }
    }
}
