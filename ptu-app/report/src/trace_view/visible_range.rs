//! The part of the axis that is in view.

use super::Window;

/// Share of the axis that can be seen beyond either of its ends.
const BEYOND: f64 = 0.02;

/// Part of the axis in view, and its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleRange {
    window: Window,
    whole: Window,
    least: f64,
}

impl VisibleRange {
    pub fn window(&self) -> Window {
        self.window
    }

    /// The whole axis in view; a zoom ends at a range of the length `least`.
    pub fn new(whole: Window, least: f64) -> Self {
        let room = whole.length() * BEYOND;
        let whole = Window {
            from: whole.from - room,
            to: whole.to + room,
        };
        Self {
            window: whole,
            whole,
            least: least.min(whole.length()),
        }
    }

    pub fn fit(&mut self) {
        self.window = self.whole;
    }

    /// Makes the range this many times as long; the point at this share of the view stays in place.
    pub fn zoom(&mut self, share: f64, times: f64) {
        let fixed = self.window.at(share);
        let length = (self.window.length() * times).clamp(self.least, self.whole.length());
        self.set(fixed - share * length, length);
    }

    /// Brings back an earlier range.
    pub fn restore(&mut self, window: Window) {
        let length = window.length().clamp(self.least, self.whole.length());
        self.set(window.from, length);
    }

    /// Moves on by a share of what is in view.
    pub fn pan(&mut self, share: f64) {
        let length = self.window.length();
        self.set(self.window.from + share * length, length);
    }

    /// Puts this place in the middle of the view.
    pub fn centre(&mut self, place: f64) {
        let length = self.window.length();
        self.set(place - length / 2.0, length);
    }

    /// Shows a stretch, with some room around it.
    pub fn show(&mut self, from: f64, to: f64) {
        let length = ((to - from) * 1.2).clamp(self.least, self.whole.length());
        self.set(f64::midpoint(from, to) - length / 2.0, length);
    }

    fn set(&mut self, from: f64, length: f64) {
        // Not `clamp`: rounding may put the ends past each other.
        let from = from.min(self.whole.to - length).max(self.whole.from);
        self.window = Window {
            from,
            to: from + length,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> VisibleRange {
        VisibleRange::new(
            Window {
                from: 0.0,
                to: 100.0,
            },
            1.0,
        )
    }

    #[test]
    fn zooming_keeps_the_point_under_the_pointer() {
        let mut camera = camera();
        let under = camera.window.at(0.25);
        camera.zoom(0.25, 0.5);
        assert!((camera.window.at(0.25) - under).abs() < 1e-9);
        assert!((camera.window.length() - 52.0).abs() < 1e-9);
    }

    #[test]
    fn the_view_is_limited_to_the_trace_and_to_the_smallest_window() {
        let mut camera = camera();
        camera.zoom(0.0, 1e-9);
        assert!((camera.window.length() - 1.0).abs() < 1e-9);
        camera.pan(1e9);
        assert!((camera.window.to - 102.0).abs() < 1e-9);
        camera.zoom(0.5, 1e9);
        assert_eq!(camera.window.length(), 104.0);
        camera.show(10.0, 20.0);
        let window = camera.window;
        assert!((window.from - 9.0).abs() < 1e-9 && (window.to - 21.0).abs() < 1e-9);
        camera.fit();
        assert_eq!(camera.window.from, -2.0);
        // Ends that rounding puts past each other when all of it is in view.
        for length in 1..2000 {
            let to = f64::from(length) * 0.05;
            let mut camera = VisibleRange::new(Window { from: -10.0, to }, 0.4);
            camera.pan(0.1);
            camera.zoom(0.3, 7.0);
        }
    }
}
