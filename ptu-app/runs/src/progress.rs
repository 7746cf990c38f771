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
            let form = "{bar:30} {pos}/{len} runs  {elapsed} (left {eta})  {msg}";
            bar(count as u64, form).with_message(what.clone())
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

/// A bar of this form, which is taken away where it is dropped.
pub fn bar(total: u64, form: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(form);
    ProgressBar::new(total).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
