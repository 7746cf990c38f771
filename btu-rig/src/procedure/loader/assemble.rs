//! From what a script declared to a procedure that can be run: names resolved, times computed.

use protocol::Duration;
use sha2::{Digest, Sha256};
use starlark::codemap::FileSpan;

use super::draft::{Declaration, ProcedureDraft, StepDraft};
use super::error::LoadError;
use super::suggest::hint;
use crate::procedure::plan::{
    Action, Condition, Expectation, Measure, Operand, Procedure, Step, TimeFrom, What, of_self_test,
};
use crate::procedure::worst_case::TIME_LIMIT_MARGIN;
use crate::stimulus::Stimulus;

/// Longest time a whole procedure may take: a week, in which all of a long line is run several times.
const LONGEST: Duration = Duration::from_ms(7 * 24 * 3600 * 1000);

/// A measurement that later steps may refer to.
struct NamedMeasurement {
    step: String,
    name: String,
    unit: &'static str,
}

/// Declarations of a script, each step complete but for the part to suspect.
#[derive(Default)]
struct Declared {
    head: Option<ProcedureDraft>,
    steps: Vec<Step>,
    /// Indices of steps that leave the part to suspect to the procedure.
    without_suspect: Vec<usize>,
    measurements: Vec<NamedMeasurement>,
    errors: Vec<LoadError>,
}

impl Declared {
    /// The declarations of the script at `path`, in its order.
    fn of(path: &str, declarations: Vec<(Declaration, Vec<FileSpan>)>) -> Self {
        let mut all = Self::default();
        for (declaration, places) in declarations {
            // The place in this file; a step may be declared by a function of a library.
            let place = places
                .iter()
                .find(|p| p.filename() == path)
                .or(places.first());
            let fail = |message: String| match place {
                Some(place) => LoadError::at(place, &message),
                None => LoadError::at_top(path, &message),
            };
            match declaration {
                Declaration::Procedure(_) if all.head.is_some() => {
                    all.errors
                        .push(fail("a second procedure() in one file".into()));
                }
                Declaration::Procedure(draft) => all.head = Some(draft),
                Declaration::Step(draft) => {
                    let line = place.map_or(0, |p| p.resolve_span().begin.line as u32 + 1);
                    all.step(draft, line, fail);
                }
            }
        }
        all
    }

    fn step(&mut self, draft: StepDraft, line: u32, fail: impl Fn(String) -> LoadError) {
        if self.steps.iter().any(|step| step.name == draft.step.name) {
            self.errors.push(fail(format!(
                "two steps are called \"{}\"",
                draft.step.name
            )));
        }
        if !draft.says_suspect {
            self.without_suspect.push(self.steps.len());
        }
        match step(draft, line, &mut self.measurements) {
            Ok(step) => self.steps.push(step),
            Err(message) => self.errors.push(fail(message)),
        }
    }
}

/// A procedure out of the declarations of the script at `path`.
pub(super) fn assemble(
    path: &str,
    text: &str,
    declared: Vec<(Declaration, Vec<FileSpan>)>,
) -> Result<Procedure, Vec<LoadError>> {
    let at_top = |message: &str| LoadError::at_top(path, message);
    let Declared {
        head,
        mut steps,
        without_suspect,
        measurements,
        mut errors,
    } = Declared::of(path, declared);
    if head.is_none() {
        errors.push(at_top("no procedure(title = …)"));
    }
    if steps.is_empty() && errors.is_empty() {
        errors.push(at_top("the procedure has no step"));
    }
    let (Some(mut head), true) = (head, errors.is_empty()) else {
        return Err(errors);
    };
    let no_earlier = |actions: &mut Vec<Action>| {
        resolve_actions(actions, &[]).map_err(|e| vec![at_top(&format!("setup or cleanup: {e}"))])
    };
    no_earlier(&mut head.procedure.setup)?;
    no_earlier(&mut head.procedure.cleanup)?;
    for index in without_suspect {
        steps[index].suspect.clone_from(&head.procedure.suspect);
    }
    for step in &mut steps {
        step.origin.fill(&head.sources);
    }
    let procedure = Procedure {
        id: path.strip_suffix(".star").unwrap_or(path).to_owned(),
        path: path.to_owned(),
        sha256: sha256(text),
        slots: measurements.len(),
        steps,
        ..head.procedure
    };
    if procedure.worst_case() > LONGEST {
        return Err(vec![at_top("the procedure can take longer than a week")]);
    }
    Ok(procedure)
}

fn sha256(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn step(draft: StepDraft, line: u32, known: &mut Vec<NamedMeasurement>) -> Result<Step, String> {
    let mut step = Step { line, ..draft.step };
    step.fill(&draft.sources);
    step.worst_case = step.compute_worst_case(draft.limit);
    step.time_limit = draft.limit.unwrap_or(step.worst_case + TIME_LIMIT_MARGIN);
    if tests_unit_itself(&step.actions) {
        step.measures.extend(of_self_test());
    }
    if step.lacks.is_none() && !checks(&step) {
        return Err(format!(
            "step \"{}\" checks nothing; give it an `expect` or a `measure`, or an until() or a prompt() in `do`",
            step.name
        ));
    }
    resolve_step(&mut step, known)?;
    for measure in &mut step.measures {
        measure.slot = known.len();
        known.push(NamedMeasurement {
            step: step.name.clone(),
            name: measure.name.clone(),
            unit: measure.unit(),
        });
    }
    Ok(step)
}

/// Whether anything can make the step fail.
fn checks(step: &Step) -> bool {
    let judges = |action: &Action| {
        let (action, _) = action.where_done(true);
        matches!(action, Action::Until { .. } | Action::Prompt { .. })
    };
    !step.expectations.is_empty() || !step.measures.is_empty() || step.actions.iter().any(judges)
}

/// Whether the actions ask for a self-test, whose items then are measurements of the step.
fn tests_unit_itself(actions: &[Action]) -> bool {
    let asks = |action: &Action| matches!(action, Action::Stimulus(Stimulus::PtuSelfTest));
    actions.iter().any(asks)
}

fn resolve_step(step: &mut Step, known: &[NamedMeasurement]) -> Result<(), String> {
    resolve_actions(&mut step.actions, known)?;
    for expectation in &mut step.expectations {
        match expectation {
            Expectation::Becomes { condition, .. }
            | Expectation::Holds { condition, .. }
            | Expectation::Never { condition } => resolve_condition(condition, known)?,
            Expectation::Logs { .. } | Expectation::NeverLogs { .. } => {}
        }
    }
    for measure in &mut step.measures {
        resolve_measure(measure, known)?;
    }
    match &mut step.when {
        Some(when) => resolve_condition(when, known),
        None => Ok(()),
    }
}

fn resolve_measure(measure: &mut Measure, known: &[NamedMeasurement]) -> Result<(), String> {
    let unit = measure.unit();
    for limit in [&mut measure.low, &mut measure.high].into_iter().flatten() {
        resolve(limit, unit, known)?;
    }
    match &mut measure.what {
        What::Time { from, to } => {
            if let TimeFrom::Condition(condition) = from {
                resolve_condition(condition, known)?;
            }
            resolve_condition(to, known)
        }
        What::At { when, .. } => resolve_condition(when, known),
        What::Value(_)
        | What::Maximum(_)
        | What::Minimum(_)
        | What::Change(_)
        | What::SelfTest { .. } => Ok(()),
    }
}

fn resolve_actions(actions: &mut [Action], known: &[NamedMeasurement]) -> Result<(), String> {
    for action in actions {
        match action {
            Action::Until { condition, .. } => resolve_condition(condition, known)?,
            Action::OnBench(action) | Action::OnTrain(action) => {
                resolve_actions(std::slice::from_mut(action), known)?;
            }
            _ => {}
        }
    }
    Ok(())
}

fn resolve_condition(condition: &mut Condition, known: &[NamedMeasurement]) -> Result<(), String> {
    condition.try_for_each_operand(&mut |signal, operand| {
        resolve(operand, signal.definition().unit, known)
    })
}

/// Finds the latest earlier measurement an operand names, as `name` or `step/name`.
fn resolve(operand: &mut Operand, unit: &str, known: &[NamedMeasurement]) -> Result<(), String> {
    let Operand::Measured { slot, name, .. } = operand else {
        return Ok(());
    };
    let is_meant =
        |k: &NamedMeasurement| k.name == *name || format!("{}/{}", k.step, k.name) == *name;
    let Some(at) = known.iter().rposition(is_meant) else {
        let hint = hint(name, known.iter().map(|k| k.name.as_str()));
        return Err(format!("no earlier step measures \"{name}\"{hint}"));
    };
    if known[at].unit != unit {
        let (have, want) = (word(known[at].unit), word(unit));
        return Err(format!(
            "\"{name}\" is measured in {have}, here {want} is needed"
        ));
    }
    *slot = at;
    Ok(())
}

fn word(unit: &str) -> &str {
    if unit.is_empty() {
        "plain numbers"
    } else {
        unit
    }
}
