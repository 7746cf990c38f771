//! The script language as Python stubs, which language servers for Starlark read to complete and explain its words.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use protocol::signal::Signal;

use super::param_type::ParamType;
use super::verb::{self, Param, Verb};

/// The words that a script knows without loading them, besides verbs and signals.
const NAMES: [(&str, &str); 7] = [
    ("codes", "speed codes of the unit configuration"),
    ("unit", "the unit configuration"),
    ("line", "the line's track database"),
    ("consist", "the train's data"),
    ("cuts", "what cuts the power"),
    ("eb_by", "what applies the emergency brake"),
    ("lamp", "lamps of the display"),
];

/// Text of each stub file by its name: `__init__.py`, and `tacho.py` for the verbs of a namespace.
pub fn stubs() -> BTreeMap<String, String> {
    let mut files: BTreeMap<String, String> = BTreeMap::new();
    let file = |space: &str| format!("{space}.py");
    for verb in verb::all() {
        let (space, name) = verb.name.split_once('.').unwrap_or(("__init__", verb.name));
        let text = files.entry(file(space)).or_default();
        text.push_str(&stub(verb, name));
    }
    let all = files.entry(file("__init__")).or_default();
    for (name, what) in NAMES {
        let _ = writeln!(all, "{name} = None\n\"\"\"{what}\"\"\"\n");
    }
    for signal in Signal::ALL {
        let _ = writeln!(
            all,
            "{} = None\n\"\"\"a recorded signal\"\"\"\n",
            signal.name()
        );
    }
    files
}

fn stub(verb: &Verb, name: &str) -> String {
    let variadic = |param: &Param| matches!(param.want, ParamType::Conditions);
    let (mut may_be_left_out, mut by_name) = (false, false);
    let params = verb.params.iter().map(|param| {
        may_be_left_out |= !param.required;
        // In Python a parameter that must be given stands before those that may be left out, or is given by its name.
        let marks = param.required && may_be_left_out && !std::mem::replace(&mut by_name, true);
        let mark = if marks { "*, " } else { "" };
        match param.required {
            _ if variadic(param) => format!("*{}", param.name),
            true => format!("{mark}{}", param.name),
            false => format!("{} = None", param.name),
        }
    });
    let params: Vec<_> = params.collect();
    let mut text = format!(
        "def {name}({}):\n    \"\"\"`{}`",
        params.join(", "),
        verb.name
    );
    if !verb.params.is_empty() {
        text.push_str("\n\n    Args:\n");
        for param in verb.params {
            let may = if param.required {
                ""
            } else {
                " (may be left out)"
            };
            let _ = writeln!(text, "      {}: {}{may}", param.name, param.want.wanted());
        }
        text.push_str("    ");
    }
    text.push_str("\"\"\"\n    pass\n\n");
    text
}

#[cfg(test)]
mod tests {
    use protocol::config::UnitConfig;
    use protocol::line::Line;

    use super::*;
    use crate::procedure::loader::context::Context;
    use crate::procedure::loader::globals::predeclared;
    use crate::train::TrainData;

    #[test]
    fn every_word_a_script_knows_is_in_the_stubs() {
        let files = stubs();
        for verb in verb::all() {
            let (space, name) = verb.name.split_once('.').unwrap_or(("__init__", verb.name));
            let text = &files[&format!("{space}.py")];
            assert!(text.contains(&format!("def {name}(")), "{}", verb.name);
        }
        let unit = UnitConfig::from_toml(include_str!("../../../../scripts/units/sg100.toml"));
        let line = Line::from_toml(include_str!("../../../../scripts/lines/line8.toml"));
        let train = TrainData::from_toml(include_str!("../../../../scripts/trains/line6.toml"));
        let context = Context::new(
            unit.expect("shipped"),
            line.expect("shipped"),
            train.expect("shipped"),
        );
        for name in predeclared(&context).into_keys() {
            let is_there = files["__init__.py"].contains(&format!("{name} = None"))
                || files["__init__.py"].contains(&format!("def {name}("))
                || files.contains_key(&format!("{name}.py"));
            assert!(is_there, "{name}");
        }
    }
}
