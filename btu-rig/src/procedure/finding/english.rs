//! Findings as English sentences.

use std::fmt::{self, Display, Formatter};

use protocol::event::LOG_ENTRIES;
use protocol::message::{ArmRefusal, SelfTest};

use super::{Before, Finding, Findings, LimitMissed, LoggedEvent, WaitedFor, WhyNoValue};
use crate::procedure::EventSource;
use crate::procedure::describe::{bit_names, clock_wrong, limits, logged_text, meanings};
use crate::procedure::event_text;
use crate::procedure::names::{Name, Part};
use crate::procedure::plan::Condition;
use crate::procedure::runner::ATTEMPTS;
use crate::stimulus::text::number;

/// Beginning of a sentence: who logged which event.
impl Display for LoggedEvent {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let event = self.event();
        let name = event.map_or("unknown", |event| event.definition().name);
        let named = event.and_then(|event| event_text::named(event, self.parameter));
        let named = named.map_or(String::new(), |named| format!(", {named}"));
        write!(
            f,
            "{} logged {} ({}{named})",
            self.source.who(),
            Part(Name(name), f.alternate()),
            self.code
        )
    }
}

impl Display for Findings {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (place, found) in self.iter().enumerate() {
            if place > 0 {
                f.write_str("; ")?;
            }
            found.finding.fmt(f)?;
            if found.times > 1 {
                write!(f, " ({} times)", found.times)?;
            }
        }
        Ok(())
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let said = f.alternate();
        match self {
            Self::LimitMissed(LimitMissed {
                measurement,
                value,
                uncertainty,
                low,
                high,
                unit,
            }) => {
                let off = uncertainty.map_or(String::new(), |off| format!(" ± {}", number(off)));
                let (value, limits) = (number(*value), limits(low.map(number), high.map(number)));
                let name = Part(Name(measurement), said);
                let text = format!("{name} = {value}{off}, allowed {limits} {unit}");
                f.write_str(text.trim_end())
            }
            Self::NeverBecame {
                condition,
                within,
                seen,
                missing,
                said: reason,
            } => {
                write!(f, "{} did not come within {within}", Part(condition, said))?;
                if let Some((signal, names)) = seen.and_then(|bits| named_bits(condition, bits)) {
                    let [signal, names] =
                        [signal, names.as_str()].map(|name| Part(Name(name), said));
                    write!(f, " ({signal} = {names})")?;
                }
                because(f, missing.as_ref())?;
                because(f, reason.as_ref())
            }
            Self::HeldOnlyFor {
                condition,
                held,
                missing,
            } => {
                write!(f, "{} held only for {held}", Part(condition, said))?;
                because(f, missing.as_ref())
            }
            Self::CameTrue { condition } => write!(f, "{} came true", Part(condition, said)),
            Self::Unknown { condition, missing } => {
                let (missing, condition) = (Part(missing, said), Part(condition, said));
                write!(f, "{missing}, so never {condition} cannot be told")
            }
            Self::NotLogged {
                event,
                parameter,
                within,
            } => {
                let who = EventSource::of(*event).who();
                let entry = logged_text(*event, *parameter, said);
                write!(f, "{who} did not log {entry} within {within}")
            }
            Self::Logged { event } => {
                let who = EventSource::of(*event).who();
                write!(
                    f,
                    "{who} logged {}",
                    Part(Name(event.definition().name), said)
                )
            }
            Self::Unprovoked(event) => write!(f, "{}, which no step provoked", Part(event, said)),
            Self::BrakeApplied => {
                f.write_str("the emergency brake was applied, which this step does not ask for")
            }
            Self::SaidNo { question } => write!(f, "the operator said no: {question}"),
            Self::NoAnswer { question } => write!(f, "the operator did not answer: {question}"),
            Self::NeedsOperator { question } => write!(f, "needs an operator: {question}"),
            Self::NoValue {
                measurement,
                others,
                why,
            } => {
                Name(measurement).fmt(f)?;
                if *others > 0 {
                    write!(f, " and {others} more")?;
                }
                match why {
                    WhyNoValue::Missing(missing) => write!(f, ": {}", Part(missing, said)),
                    WhyNoValue::NotMeasured => f.write_str(": no value"),
                    WhyNoValue::NeverEnded(end) => {
                        write!(
                            f,
                            ": no value, {} did not come about in time",
                            Part(end, said)
                        )
                    }
                }
            }
            Self::LimitUnknown { measurement } => {
                let name = Part(Name(measurement), said);
                write!(f, "{name}: a limit refers to a measurement without a value")
            }
            Self::Refused { why } | Self::Told(why) | Self::Prevented { english: why, .. } => {
                f.write_str(why)
            }
            Self::NotToldByUnit { software, signals } => {
                f.write_str("this unit")?;
                if let Some(software) = software {
                    write!(f, ", software {software},")?;
                }
                write!(f, " does not tell {}", signals.join(", "))
            }
            Self::StartedAgain => {
                f.write_str("the unit was started again: its supply was interrupted")
            }
            Self::TestModeEnded { refusal } => {
                let why = session_end(ArmRefusal::from_code(*refusal));
                write!(f, "the unit ended test mode by itself: {why}")
            }
            Self::NotFinished { within } => {
                write!(f, "motion or tester request not finished within {within}")
            }
            Self::LineDisturbed { event } => {
                match event {
                    Some(event) => event.fmt(f)?,
                    None => f.write_str("the emergency brake was applied")?,
                }
                f.write_str(
                    " while frames between tester and unit did not come through: check the line and run this \
                     again",
                )
            }
            Self::FramesLost { frames } => write!(
                f,
                "{frames} frames between tester and unit did not come through meanwhile: check the line and \
                 run this again"
            ),
            Self::LogNotRead { within } => write!(
                f,
                "the unit's log could not be read within {within}, so what it logged is not known"
            ),
            Self::LogNotReadToEnd { within } => {
                write!(f, "the unit's log was not read to its end within {within}")
            }
            Self::TimeLimit { limit, waiting } => {
                write!(f, "took longer than its time limit of {limit}")?;
                match waiting {
                    None => Ok(()),
                    Some(WaitedFor::Actions) => f.write_str(" in its actions"),
                    Some(WaitedFor::Expectation(expectation)) => {
                        write!(f, " waiting for: {}", Part(expectation, said))
                    }
                }
            }
            Self::LinkLost { why } if why.is_of_the_bench() => write!(f, "{why}"),
            Self::LinkLost { why } => write!(f, "link to the unit: {why}"),
            Self::StoodStill { by, attempt } => {
                write!(
                    f,
                    "not tested in attempt {attempt} of {ATTEMPTS}: the tester's computer or the link stood still for \
                     {:.2} s, which says nothing about the unit; ",
                    by.as_secs()
                )?;
                match *attempt < ATTEMPTS {
                    true => write!(f, "the step is repeated ({} of {ATTEMPTS})", attempt + 1),
                    false => {
                        f.write_str("end other programs, look after the link and run this again")
                    }
                }
            }
            Self::BeforeStandstill(what) => {
                write!(
                    f,
                    "before the tester's computer or the link stood still: {}",
                    Part(what, said)
                )
            }
            Self::InSetUp(what) => write!(f, "setup: {}", Part(what, said)),
            Self::InCleanUp(what) => write!(f, "clean-up: {}", Part(what, said)),
            Self::CleanUpTooLong { within } => write!(f, "clean-up took longer than {within}"),
            Self::CleanUpCutShort => f.write_str("clean-up cut short by the operator"),
            Self::NotSafe { within } => {
                write!(f, "outputs are not confirmed safe after {within}")
            }
            Self::Stopped => f.write_str("stopped by the operator"),
            Self::NotRun(why) => write!(f, "not run, {}", Part(why, said)),
            Self::NotBegun(why) => write!(f, "not begun, {}", Part(why, said)),
            Self::NotPassed { step } => write!(f, "\"{step}\" did not pass"),
            Self::NotTestedBefore { step } => {
                write!(f, "it continues from \"{step}\", which was not tested")
            }
            Self::NeedsHarness => {
                f.write_str("needs the bench harness, and only the maintenance port is connected")
            }
            Self::ConditionFalse { said: reason } => {
                f.write_str(reason.as_deref().unwrap_or("its condition does not hold"))
            }
            Self::ConditionUnknown { missing } => {
                write!(f, "its condition: {}", Part(missing, said))
            }
            Self::NoStepToRun => f.write_str("no step to run"),
            Self::NoStepRun => f.write_str("no step was run"),
            Self::ProgramFailed => f.write_str("the program failed in this run"),
            Self::LinkLostAt {
                run,
                of,
                left,
                instrument,
                bench,
            } => {
                match (instrument, bench) {
                    (Some(name), Some(bench)) => {
                        write!(f, "instrument {name} of bench {bench} failed")?;
                    }
                    (Some(name), None) => write!(f, "instrument {name} of the bench failed")?,
                    (None, _) => f.write_str("link lost")?,
                }
                match run {
                    0 => write!(f, " before the first of {of} steps"),
                    _ => write!(f, " at step {run} of {of}; {left} not run"),
                }
            }
            Self::NotAcceptance { run, of } => {
                write!(f, "not an acceptance: {run} of {of} steps run, all passed")
            }
            Self::SelfTestFailed { items } => {
                let items = meanings(&SelfTest::SPEC, *items);
                write!(f, "the unit says its self-test failed: {items}")
            }
            Self::TooManyEvents { more } => write!(
                f,
                "the unit logged more than {LOG_ENTRIES} events that no step provoked, and {more} more \
                 entries, not stored"
            ),
            Self::ClockWrong { by_permille } => f.write_str(&clock_wrong(*by_permille)),
            Self::FoundBefore { fault, before } => {
                let before = match before {
                    Before::FirstStep => "the first step",
                    Before::RepeatedStep => "the repetition of a step",
                    Before::Repetition => "the next repetition",
                };
                write!(f, "found before {before}: {}", Part(Name(fault), said))
            }
            Self::Event {
                event,
                speed_kmh,
                limit_kmh,
                time_s,
            } => {
                let who = event.source.who().trim_start_matches("the ");
                write!(f, "{} at {speed_kmh:.1} km/h", happened(event))?;
                write!(f, ", limit {limit_kmh:.1} km/h, {who} time {time_s:.3} s")
            }
            Self::CheckFailed {
                procedure,
                step,
                turn,
                turns,
                findings,
            } => {
                let findings = Part(findings, said);
                match turns {
                    1 => write!(f, "{procedure}, {step}: {findings}"),
                    _ => write!(f, "{procedure}, {step} ({turn}/{turns}): {findings}"),
                }
            }
            Self::More { n } => write!(f, "and {n} more"),
        }
    }
}

/// Actual states of the bits in a condition, with the name of their signal; `None` where the signal has no set of
/// bits.
fn named_bits(condition: &Condition, bits: u16) -> Option<(&'static str, String)> {
    let Condition::Compare { signal, .. } = condition else {
        return None;
    };
    Some((signal.name(), bit_names(*signal, bits)?))
}

/// Event, with its parameter, as text.
fn happened(logged: &LoggedEvent) -> String {
    let Some(event) = logged.event() else {
        let (code, parameter) = (logged.code, logged.parameter);
        return format!("event {code} is not in the dictionary (parameter {parameter})");
    };
    let said = event_text::parameter(event, logged.parameter);
    match said.is_empty() {
        true => event.definition().text.to_owned(),
        false => format!("{} ({said})", event.definition().text),
    }
}

fn because(f: &mut Formatter<'_>, why: Option<&impl Display>) -> fmt::Result {
    let said = f.alternate();
    why.map_or(Ok(()), |why| write!(f, ": {}", Part(why, said)))
}

/// Why a unit ends a session, in words a technician can act on.
fn session_end(refusal: ArmRefusal) -> &'static str {
    match refusal {
        ArmRefusal::KeyOff => "the maintenance key was turned off",
        ArmRefusal::Moving | ArmRefusal::TrainMoved => "the train moved",
        ArmRefusal::CodeChanged => "the speed code in the rail changed",
        ArmRefusal::ModeChanged => "the mode switch was turned",
        ArmRefusal::BrakesReleased => "the train does not prove that its brakes are applied",
        ArmRefusal::TesterSilent => "it did not hear the tester for a second",
        other => other.label(),
    }
}
