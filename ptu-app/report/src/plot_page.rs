//! A page with one drawing.

use crate::plot::Plot;
use crate::run::block::{Block, Tone};
use crate::run::{Paper, Printed};
use crate::words::Words;

/// A drawing with its title, and how it was made.
pub struct PlotPage {
    pub plot: Plot,
    /// Command that made the page, and time.
    pub made: String,
}

impl Printed for PlotPage {
    fn paper(&self, _words: &Words) -> Paper {
        Paper {
            short: self.plot.title.clone(),
            number: self.plot.y_label.clone(),
            program: format!("ptu {}", env!("CARGO_PKG_VERSION")),
            blocks: vec![
                Block::Title(self.plot.title.clone(), String::new()),
                Block::Plot(Box::new(self.plot.clone())),
                Block::Text(Tone::Soft, self.made.clone()),
            ],
            ..Paper::default()
        }
    }
}
