//! One part of many runs: every n-th, which gives all parts the same mixture of runs.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Greatest number of parts.
const MOST: u32 = 100_000;
/// Word in place of a number that a job scheduler gives.
const AUTO: &str = "auto";

/// The `number`-th of `of` parts, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: u32,
    /// Parts in all.
    pub of: u32,
}

impl Shard {
    /// Part `number` of `of`, if there is one.
    pub fn new(number: u32, of: u32) -> Result<Self, String> {
        if (1..=MOST).contains(&of) && (1..=of).contains(&number) {
            return Ok(Self { number, of });
        }
        Err(format!(
            "there is no shard {number}/{of}; the first of 64 is 1/64, the last 64/64, and there are {MOST} at most"
        ))
    }

    /// The part that a run belongs to.
    pub fn of_run(run: usize, of: u32) -> Self {
        let number = 1 + u32::try_from(run % of.max(1) as usize).unwrap_or(0);
        Self { number, of }
    }

    /// Whether the shard makes this run.
    pub fn has(self, run: usize) -> bool {
        Self::of_run(run, self.of) == self
    }

    /// Reads `k/n`; or `auto` or `auto/n`, where Slurm or Kubernetes gives the number in a variable, which
    /// `variable` looks up.
    ///
    /// # Errors
    /// The text has none of these forms, or the scheduler's numbers do not fit.
    pub fn parse(text: &str, variable: &dyn Fn(&str) -> Option<String>) -> Result<Self, String> {
        let (number, of) = text
            .split_once('/')
            .map_or((text, None), |(k, n)| (k, Some(n)));
        let count = |text: &str| {
            (text.parse::<u32>()).map_err(|_| {
                format!("\"{text}\" is no number of shards; write 3/64, auto or auto/64")
            })
        };
        let of = of.map(count).transpose()?;
        match (number, of) {
            (AUTO, of) => from_scheduler(of, variable),
            (number, Some(of)) => Self::new(count(number)?, of),
            (_, None) => Err(format!(
                "\"{text}\" does not say of how many; write {text}/64"
            )),
        }
    }
}

/// The shard that variables of a job scheduler name.
fn from_scheduler(
    of: Option<u32>,
    variable: &dyn Fn(&str) -> Option<String>,
) -> Result<Shard, String> {
    let number = |name: &str| {
        let Some(text) = variable(name) else {
            return Ok(None);
        };
        let number = text.trim().parse::<u32>();
        number
            .map(Some)
            .map_err(|_| format!("{name} is \"{text}\", no number"))
    };
    if let Some(id) = number("SLURM_ARRAY_TASK_ID")? {
        if let Some(of) = of {
            return Shard::new(id, of).map_err(|why| {
                format!("SLURM_ARRAY_TASK_ID is {id}: {why}; submit with --array=1-{of}")
            });
        }
        let least = number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(1);
        let most = number("SLURM_ARRAY_TASK_MAX")?;
        let count = number("SLURM_ARRAY_TASK_COUNT")?
            .ok_or("SLURM_ARRAY_TASK_COUNT is not set; write --shard auto/64")?;
        // An array of which only some tasks were submitted again does not tell how many parts there are.
        if most.is_some_and(|most| u64::from(most) + 1 != u64::from(least) + u64::from(count)) {
            return Err(format!(
                "the array has {count} tasks with gaps between their numbers, so that it does not say how many \
                 shards there are; write --shard auto/64"
            ));
        }
        let place = id.checked_sub(least).and_then(|place| place.checked_add(1));
        return Shard::new(place.unwrap_or(0), count);
    }
    if let Some(index) = number("JOB_COMPLETION_INDEX")? {
        let of = match of {
            Some(of) => Some(of),
            None => number("JOB_COMPLETIONS")?,
        };
        let of = of.ok_or(
            "Kubernetes does not tell a pod how many completions its job has: write --shard auto/64, or set \
             JOB_COMPLETIONS in the job",
        )?;
        return Shard::new(index.saturating_add(1), of);
    }
    Err("neither SLURM_ARRAY_TASK_ID nor JOB_COMPLETION_INDEX is set; write --shard 3/64".into())
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::parse(text, &|name| std::env::var(name).ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: each scheduler's numbering, from 0, from 1 or from 5, and an array of which some tasks run again, gives
    /// the part that is meant or a refusal, never another part.
    #[test]
    fn a_shard_is_the_one_that_its_scheduler_means() {
        let slurm = [
            ("SLURM_ARRAY_TASK_ID", "7"),
            ("SLURM_ARRAY_TASK_MIN", "5"),
            ("SLURM_ARRAY_TASK_MAX", "8"),
            ("SLURM_ARRAY_TASK_COUNT", "4"),
        ];
        let gaps = [
            ("SLURM_ARRAY_TASK_ID", "40"),
            ("SLURM_ARRAY_TASK_MIN", "3"),
            ("SLURM_ARRAY_TASK_MAX", "40"),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
        ];
        let kubernetes = [("JOB_COMPLETION_INDEX", "0"), ("JOB_COMPLETIONS", "9")];
        let nothing = &[][..];
        for (text, set, expected) in [
            ("3/64", nothing, Ok((3, 64))),
            ("64/64", nothing, Ok((64, 64))),
            ("0/64", nothing, Err("no shard 0/64")),
            ("65/64", nothing, Err("no shard 65/64")),
            ("3", nothing, Err("of how many")),
            ("a/b", nothing, Err("\"b\" is no number")),
            ("auto", nothing, Err("neither SLURM_ARRAY_TASK_ID")),
            ("auto", &slurm[..], Ok((3, 4))),
            ("auto/64", &slurm, Ok((7, 64))),
            ("auto", &gaps, Err("gaps between")),
            ("auto/64", &gaps, Ok((40, 64))),
            ("auto/39", &gaps, Err("--array=1-39")),
            ("auto", &kubernetes, Ok((1, 9))),
            ("auto/5", &kubernetes, Ok((1, 5))),
            ("auto", &kubernetes[..1], Err("set JOB_COMPLETIONS")),
            ("auto", &[("SLURM_ARRAY_TASK_ID", "x")], Err("is \"x\"")),
        ] {
            let variable = |name: &str| {
                let found = set.iter().find(|(known, _)| *known == name);
                found.map(|(_, value)| (*value).to_owned())
            };
            match (Shard::parse(text, &variable), expected) {
                (Ok(Shard { number, of }), Ok(expected)) => {
                    assert_eq!((number, of), expected, "{text} with {set:?}");
                }
                (Err(why), Err(words)) => assert!(why.contains(words), "{text}: {why}"),
                (found, _) => panic!("{text} with {set:?}: {found:?}"),
            }
        }
    }

    #[test]
    fn every_run_belongs_to_one_shard() {
        for run in 0..20 {
            let of = (1..=7).filter(|number| {
                Shard {
                    number: *number,
                    of: 7,
                }
                .has(run)
            });
            assert_eq!(of.count(), 1, "{run}");
        }
    }
}
