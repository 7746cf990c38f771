//! The QR code on a sheet: the run's id and its seal's digest. By it the paper leads to the run in the history, and to
//! its certificate.

use fault_db::RunDetail;
use maud::{Markup, html as markup};
use qrcode::{Color, EcLevel, QrCode};

/// Width of the light margin around the code, in dots, as scanners want it.
const QUIET: usize = 4;

/// A QR code.
#[derive(Clone, Debug)]
pub struct Code {
    /// Text for a scanner, as `ptu verify` takes it.
    pub text: String,
    /// Dots along an edge, with the margin on both sides.
    pub width: usize,
    /// Dark stretches: from the left, from above, and their length, in dots.
    pub dark: Vec<(usize, usize, usize)>,
}

impl Code {
    /// The code of a run; none before its end, when it has no seal.
    pub fn of(run: &RunDetail) -> Option<Self> {
        let seal = run.seal.as_ref()?;
        Self::new(format!("ptu:{}/{}", run.run.id, seal.digest))
    }

    fn new(text: String) -> Option<Self> {
        let code = QrCode::with_error_correction_level(&text, EcLevel::M).ok()?;
        let width = code.width();
        let mut dark: Vec<(usize, usize, usize)> = Vec::new();
        for (place, color) in code.to_colors().into_iter().enumerate() {
            if color == Color::Light {
                continue;
            }
            let (x, y) = (QUIET + place % width, QUIET + place / width);
            match dark.last_mut() {
                Some((from, of, length)) if (*of, *from + *length) == (y, x) => *length += 1,
                _ => dark.push((x, y, 1)),
            }
        }
        Some(Self {
            text,
            width: width + 2 * QUIET,
            dark,
        })
    }

    /// Drawing of the code, dark on light also where the page is dark.
    pub fn svg(&self) -> Markup {
        let stretch =
            |(x, y, length): &(usize, usize, usize)| format!("M{x} {y}h{length}v1h-{length}z");
        let dark: String = self.dark.iter().map(stretch).collect();
        let size = format!("0 0 {0} {0}", self.width);
        markup! {
            svg viewBox=(size) role="img" aria-label=(self.text) shape-rendering="crispEdges" {
                rect width=(self.width) height=(self.width) fill="#fff" {}
                path d=(dark) fill="#000" {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a scanner reads what was meant. Method: the drawn stretches, four points a dot, by another implementation.
    #[test]
    fn a_scanner_reads_the_code() {
        const POINTS: usize = 4;
        let text = format!(
            "ptu:{}/{}",
            "01a219d9-141c-72d2-8124-295819f2052c",
            "5af6bd7f".repeat(8)
        );
        let code = Code::new(text.clone()).expect("a code");
        let is_dark = |x: usize, y: usize| {
            let of_row = code.dark.iter().filter(|(_, row, _)| *row == y / POINTS);
            of_row
                .into_iter()
                .any(|(from, _, length)| (*from..from + length).contains(&(x / POINTS)))
        };
        let size = code.width * POINTS;
        let mut seen = rqrr::PreparedImage::prepare_from_greyscale(size, size, |x, y| {
            if is_dark(x, y) { 0 } else { 255 }
        });
        let [found] = &seen.detect_grids()[..] else {
            panic!("one code");
        };
        assert_eq!(found.decode().expect("it is read").1, text);
    }
}
