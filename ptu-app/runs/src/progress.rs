//! Progress of many runs on stderr: a bar on a terminal, otherwise a line for each tenth.

use indicatif::{ProgressBar, ProgressStyle};

use crate::stdio;

/// Lines written where there is no terminal.
const LINES: usize = 10;

/// Tells how far many runs are.
pub struct Progress {
    bar: Option<ProgressBar>,
    what: String,
    count: usize,
    told: usize,
}

impl Progress {
    /// Progress of `count` runs; `what` is what the bar calls them.
    pub fn new(count: usize, what: String) -> Self {
        let bar = stdio::draws().then(|| {
            let style = "{bar:30} {pos}/{len} runs  {elapsed} (left {eta})  {msg}";
            ProgressBar::new(count as u64)
                .with_message(what.clone())
                .with_style(
                    ProgressStyle::with_template(style)
                        .unwrap_or_else(|_| ProgressStyle::default_bar()),
                )
        });
        Self {
            bar,
            what,
            count,
            told: 0,
        }
    }

    pub fn tell(&mut self, done: usize) {
        if let Some(bar) = &self.bar {
            bar.set_position(done as u64);
            return;
        }
        let tenth = done * LINES / self.count.max(1);
        if tenth > self.told {
            self.told = tenth;
            stdio::note(&format!("{}: {done} of {} runs", self.what, self.count));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
