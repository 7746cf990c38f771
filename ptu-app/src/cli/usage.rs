//! Says in Korean why a command line cannot be read; clap says it in English alone.

use std::error::Error as _;

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Korean text: what is wrong, similar words, and the usage. `None` for help, and for errors that have no Korean text.
pub fn korean(error: &clap::Error) -> Option<String> {
    let told = |kind| error.get(kind).map(|value| listed(value, ", "));
    let of = |kind| told(kind).unwrap_or_default();
    let option = of(ContextKind::InvalidArg);
    let value = of(ContextKind::InvalidValue);
    let said = match error.kind() {
        ErrorKind::UnknownArgument => format!("없는 옵션 또는 인수입니다: {option}"),
        ErrorKind::InvalidSubcommand => {
            format!("없는 명령입니다: {}", of(ContextKind::InvalidSubcommand))
        }
        ErrorKind::MissingSubcommand => "명령이 빠졌습니다".to_owned(),
        ErrorKind::InvalidValue if value.is_empty() => format!("{option}의 값이 빠졌습니다"),
        ErrorKind::InvalidValue => format!("{option}에 쓸 수 없는 값입니다: {value}"),
        ErrorKind::ValueValidation => {
            let why = error.source().map(|why| format!(" ({why})"));
            let why = why.unwrap_or_default();
            format!("{option}에 쓸 수 없는 값입니다: {value}{why}")
        }
        ErrorKind::NoEquals => format!("{option}의 값은 = 뒤에 붙여 쓰십시오"),
        ErrorKind::TooManyValues => format!("{option}의 값이 너무 많습니다: {value}"),
        ErrorKind::TooFewValues | ErrorKind::WrongNumberOfValues => {
            format!("{option}의 값의 수가 맞지 않습니다")
        }
        ErrorKind::ArgumentConflict => match told(ContextKind::PriorArg) {
            Some(prior) if prior != option => format!("함께 쓸 수 없습니다: {option}, {prior}"),
            _ => format!("한 번만 쓸 수 있습니다: {option}"),
        },
        ErrorKind::MissingRequiredArgument => format!("빠진 인수: {option}"),
        ErrorKind::InvalidUtf8 => "인수가 UTF-8 문자가 아닙니다".to_owned(),
        _ => return None,
    };
    let mut lines = vec![format!("오류: {said}")];
    let hints = [
        ("쓸 수 있는 값", ContextKind::ValidValue),
        ("혹시", ContextKind::SuggestedArg),
        ("혹시", ContextKind::SuggestedSubcommand),
        ("혹시", ContextKind::SuggestedValue),
    ];
    let hints = hints.into_iter().filter_map(|(what, kind)| {
        let hint = told(kind).filter(|hint| !hint.is_empty())?;
        Some(format!("  {what}: {hint}"))
    });
    lines.extend(hints);
    if let Some(usage) = told(ContextKind::Usage) {
        lines.push(format!("\n{}", usage.replacen("Usage:", "사용법:", 1)));
    }
    lines.push("\n자세한 내용: --help".to_owned());
    Some(lines.join("\n"))
}

fn listed(value: &ContextValue, by: &str) -> String {
    match value {
        ContextValue::String(one) => one.clone(),
        ContextValue::Strings(all) => all.join(by),
        ContextValue::StyledStr(one) => one.to_string(),
        ContextValue::StyledStrs(all) => {
            let all = all.iter().map(ToString::to_string);
            all.collect::<Vec<_>>().join(by)
        }
        ContextValue::Number(one) => one.to_string(),
        ContextValue::Bool(one) => one.to_string(),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::cli::Cli;

    /// Goal: who reads Korean is told in Korean why a command line cannot be read. Method: command lines that are wrong in
    /// several ways; each is told with the word that is wrong, and what is near to it.
    #[test]
    fn a_wrong_command_line_is_told_in_korean() {
        let wrong = [
            ("ptu rnu", "오류: 없는 명령입니다: rnu\n  혹시: run"),
            (
                "ptu run --seeed 1",
                "오류: 없는 옵션 또는 인수입니다: --seeed\n  혹시: --seed",
            ),
            ("ptu run --harness none3", "오류: --harness"),
            (
                "ptu run --jobs 0",
                "오류: --jobs <N>에 쓸 수 없는 값입니다: 0",
            ),
            ("ptu run --list --csv --json", "오류: 없는"),
            (
                "ptu runs list --csv --json",
                "오류: 함께 쓸 수 없습니다: --csv, --json",
            ),
            ("ptu diagnose", "오류: 빠진 인수: <RUN>..."),
            ("ptu run --seed", "오류: --seed <SEED>의 값이 빠졌습니다"),
        ];
        for (line, said) in wrong {
            let error = Cli::try_parse_from(line.split(' ')).expect_err(line);
            let korean = korean(&error).expect(line);
            assert!(korean.starts_with(said), "{line}: {korean}");
            assert!(
                korean.ends_with("\n\n자세한 내용: --help"),
                "{line}: {korean}"
            );
        }
        let help = Cli::try_parse_from(["ptu", "--help"]).expect_err("help");
        assert_eq!(korean(&help), None);
    }
}
