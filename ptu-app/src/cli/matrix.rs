//! `ptu matrix`: the cheapest order of tests of any dependency matrix.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use matrix::{
    DEFAULT_CONFIDENCE, Leaf, Matrix, MatrixError, Method, Node, Outcome, Plan, PlanOptions,
    Posterior, plan, read_outcomes,
};

use super::{Json, ScriptsOption, print_out};
use ptu_report::json_safe;
use ptu_runs::failure::{DriveTrouble, Exit, Failure, FileTrouble, Why, did_you_mean};
use ptu_runs::stdio;
use ptu_runs::table::Table;
use ptu_runs::whole_file::read_within;

/// Most states that a table shows; JSON has all.
const SHOWN_STATES: usize = 20;
/// Longest file of a matrix or of outcomes, bytes.
const LONGEST_FILE: u64 = 64 << 20;

/// Find the cheapest order of tests of any dependency matrix, and what outcomes leave of its states
///
/// Examples:
///   ptu matrix pump.json                            cheapest order of tests
///   ptu matrix pump.csv --outcomes flow=low         a table with a column for each test
///   ptu matrix six_by_six                           an example that comes with the program
///   ptu matrix pump.json --outcomes flow=1,noise=0  the states that these outcomes leave possible
///   ptu matrix pump.json --outcomes found.json --json
///
/// Exit codes: 0 answered, 2 wrong matrix or outcomes.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct MatrixArguments {
    /// Dependency matrix of states and tests: a file, or NAME for matrices/NAME.json of the scripts; its format is in the
    /// manual's chapter on dictionaries
    #[arg(value_name = "FILE|NAME")]
    file: PathBuf,
    /// Outcomes found: TEST=0,TEST=1 (0 pass, 1 fail, or its word), or a file {"TEST": 0 | 1 | "pass" | "fail" | "WORD"}
    #[arg(long, value_name = "OUTCOMES")]
    outcomes: Option<String>,
    /// How the tree is made [default: optimal if it can be found, else greedy]
    #[arg(long, value_enum)]
    tree: Option<TreeMethod>,
    /// Probability that an answer must have where tests may err, above 0.5 and at most 1
    #[arg(long, value_name = "P", default_value_t = DEFAULT_CONFIDENCE)]
    confidence: f64,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scripts: ScriptsOption,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TreeMethod {
    /// The cheapest there is: 20 states × 20 tests always, larger ones up to 64 × 64 only if the search ends in time
    Optimal,
    /// At each step the test with most information for its cost, each choice checked by the tests that follow it
    Greedy,
}

impl MatrixArguments {
    /// Reads the matrix, plans the tests and prints the answer.
    pub fn run(self) -> Result<Exit, Failure> {
        let place = self.file.display();
        let content = self.text()?;
        let is_table = (self.file.extension()).is_some_and(|end| end.eq_ignore_ascii_case("csv"));
        let matrix = match is_table {
            true => Matrix::from_csv(content.trim_start_matches('\u{feff}')),
            false => Matrix::from_json(&content),
        };
        let matrix = matrix.map_err(|error| wrong(&place, &error))?;
        let known = match &self.outcomes {
            Some(given) => known(&matrix, given)?,
            None => Posterior::prior(&matrix),
        };
        let asked = PlanOptions {
            method: self.tree.map(|method| match method {
                TreeMethod::Optimal => Method::Optimal,
                TreeMethod::Greedy => Method::Greedy,
            }),
            confidence: self.confidence,
        };
        let plan = plan(&matrix, &known, asked).map_err(|error| match error {
            MatrixError::Confidence(_) => wrong(&"--confidence", &error),
            _ => wrong(&place, &error),
        })?;
        if self.json.is_asked() {
            let text = plan
                .to_json(&matrix, &known)
                .map_err(|error| Failure::bench(FileTrouble::NotPrinted("JSON", Why::of(error))))?;
            stdio::document(&json_safe(&text))?;
            return Ok(Exit::Passed);
        }
        print_out(&text(&matrix, &known, &plan, self.outcomes.is_some()))
    }

    /// Text of the named file, or else of matrices/NAME.json of the scripts.
    fn text(&self) -> Result<String, Failure> {
        let named = format!("matrices/{}.json", self.file.display());
        let directory = match self.file.exists() {
            true => None,
            false => Some(self.scripts.find()?).filter(|directory| directory.has(&named)),
        };
        directory.map_or_else(|| read(&self.file), |directory| directory.text(&named))
    }
}

fn read(file: &Path) -> Result<String, Failure> {
    read_within(file, LONGEST_FILE)
}

fn wrong(place: &impl Display, error: &MatrixError) -> Failure {
    Failure::usage(FileTrouble::wrong(place, error))
}

/// Probabilities of the states after the outcomes given, in a file or on the command line.
fn known(matrix: &Matrix, given: &str) -> Result<Posterior, Failure> {
    let file = Path::new(given);
    let (place, outcomes) = if given.contains('=') && !file.exists() {
        ("--outcomes".to_owned(), inline(given)?)
    } else {
        let outcomes = read_outcomes(&read(file)?).map_err(|error| wrong(&given, &error))?;
        (given.to_owned(), outcomes)
    };
    Posterior::given(matrix, &outcomes).map_err(|error| match &error {
        MatrixError::OutcomeUnknown { test } => {
            let names = matrix.tests().iter().map(|test| test.id.as_str());
            let hint = did_you_mean(test, names);
            Failure::usage(FileTrouble::wrong(place, format!("{error}{hint}")))
        }
        _ => wrong(&place, &error),
    })
}

fn inline(given: &str) -> Result<Vec<(String, Outcome)>, Failure> {
    let one = |part: &str| {
        let given = (part.rsplit_once('=')).filter(|(_, word)| !word.trim().is_empty());
        let (test, word) =
            given.ok_or_else(|| Failure::usage(DriveTrouble::Outcome(part.to_owned())))?;
        Ok((test.trim().to_owned(), Outcome::parse(word.trim())))
    };
    given
        .split(',')
        .filter(|part| !part.trim().is_empty())
        .map(one)
        .collect()
}

/// Answer for a person: a numbered table of tests that says where each outcome leads, as in maintenance manuals; it
/// stays readable however deep the tree is.
fn text(matrix: &Matrix, known: &Posterior, plan: &Plan, with_posterior: bool) -> String {
    let mut parts = Vec::new();
    if with_posterior {
        parts.push(posterior(matrix, known));
    }
    let next = match plan.tree.first_test() {
        Some(test) => format!("next test {}", matrix.tests()[test].id),
        None => "no test left that tells more".into(),
    };
    let cut = plan.tree.cut_probability() > 0.0;
    parts.push(format!(
        "{next}\nexpected cost {}{:.4} ({})",
        if cut { "at least " } else { "" },
        plan.expected_cost,
        match (plan.optimal, cut) {
            (true, _) => "optimal: no order of tests costs less",
            (false, false) => "greedy: another order may cost less",
            (false, true) => "greedy, and not grown to its ends",
        }
    ));
    parts.push(steps(matrix, plan));
    if !plan.warnings.is_empty() {
        let lines: Vec<_> = plan
            .warnings
            .iter()
            .map(|warning| format!("note: {warning}"))
            .collect();
        parts.push(lines.join("\n"));
    }
    parts.join("\n\n")
}

fn posterior(matrix: &Matrix, known: &Posterior) -> String {
    let mut table = Table::new(&["STATE", "PROBABILITY"]);
    let ranked = known.ranked();
    for (state, p) in ranked.iter().take(SHOWN_STATES) {
        table.row([matrix.states()[*state].id.clone(), format!("{p:.6}")]);
    }
    match ranked.len().checked_sub(SHOWN_STATES + 1) {
        Some(more) => format!("{}\n… {} more", table.render(), more + 1),
        None => table.render(),
    }
}

fn steps(matrix: &Matrix, plan: &Plan) -> String {
    let nodes = &plan.tree.nodes[..];
    let mut numbers = vec![0; nodes.len()];
    let mut count = 0;
    for (number, node) in numbers.iter_mut().zip(nodes) {
        if matches!(node, Node::Test { .. }) {
            count += 1;
            *number = count;
        }
    }
    let leads = |place: usize| match &nodes[place] {
        Node::Test { .. } => format!("step {}", numbers[place]),
        Node::Leaf(leaf) => answer(matrix, leaf),
    };
    if let [Node::Leaf(leaf)] = nodes {
        return format!("answer {}", answer(matrix, leaf));
    }
    let headings = ["STEP", "TEST", "COST", "REACHED"];
    let has_words = (0..matrix.tests().len()).any(|test| !matrix.words(test).is_empty());
    let by_outcome: &[&str] = match has_words {
        true => &["BY OUTCOME"],
        false => &["IF IT PASSES", "IF IT FAILS"],
    };
    let mut table = Table::new(&[&headings, by_outcome].concat());
    for (number, node) in numbers.iter().zip(nodes) {
        if let Node::Test {
            test,
            reached,
            ways,
        } = node
        {
            let of = &matrix.tests()[*test];
            let (cost, reached) = (of.cost.to_string(), format!("{:.2} %", reached * 100.0));
            let mut row = vec![number.to_string(), of.id.clone(), cost, reached];
            let led = ways.iter().map(|(outcome, node)| match has_words {
                true => format!("{}: {}", matrix.outcome(*test, *outcome), leads(*node)),
                false => leads(*node),
            });
            let led: Vec<_> = led.collect();
            match has_words {
                true => row.push(led.join("; ")),
                false => row.extend(led),
            }
            table.row(row);
        }
    }
    table.render()
}

fn answer(matrix: &Matrix, leaf: &Leaf) -> String {
    const SHOWN: usize = 5;
    let names = leaf.states.iter().map(|s| matrix.states()[*s].id.as_str());
    let mut text = names.take(SHOWN).collect::<Vec<_>>().join(" or ");
    if let Some(more) = leaf.states.len().checked_sub(SHOWN + 1) {
        text.push_str(&format!(" or {} more", more + 1));
    }
    if leaf.p < 1.0 {
        text.push_str(&format!(" (p {:.4})", leaf.p));
    }
    if leaf.cut {
        text.push_str(" (cut)");
    }
    text
}
