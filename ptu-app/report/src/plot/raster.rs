//! Cells behind the curves of a plot, each of a shade: a spectrum over time.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::mark::Mark;
use super::scale::Scale;

/// Colours of the least shade, the greatest, and between them at equal distances: in the order of their lightness, which
/// colour-blind readers see, too (viridis).
const COLOURS: [[u8; 3]; 6] = [
    [68, 1, 84],
    [65, 68, 135],
    [42, 120, 142],
    [34, 168, 132],
    [122, 209, 81],
    [253, 231, 37],
];

/// Cells.
#[derive(Clone, Debug)]
pub struct Raster {
    /// From where to where on the horizontal axis.
    pub x: (f64, f64),
    /// From where to where on the vertical axis.
    pub y: (f64, f64),
    /// Cells in a row.
    pub columns: usize,
    /// Shades from the upper left corner on, row by row.
    pub shades: Vec<u8>,
}

impl Raster {
    pub(super) fn mark(&self, x: &Scale, y: &Scale) -> Mark {
        let (left, right) = (x.at(self.x.0), x.at(self.x.1));
        let (top, bottom) = (y.at(self.y.1), y.at(self.y.0));
        Mark::Raster {
            at: (left, top),
            size: (right - left, bottom - top),
            columns: self.columns,
            shades: self.shades.clone(),
        }
    }
}

pub fn colour(shade: u8) -> [u8; 3] {
    let place = f32::from(shade) / 255.0 * (COLOURS.len() - 1) as f32;
    let below = (place as usize).min(COLOURS.len() - 2);
    let part = place - below as f32;
    let (low, high) = (COLOURS[below], COLOURS[below + 1]);
    std::array::from_fn(|of| {
        let (low, high) = (f32::from(low[of]), f32::from(high[of]));
        (low + part * (high - low)).round() as u8
    })
}

/// The cells as a picture within a page; none if there are no cells.
pub(super) fn address(columns: usize, shades: &[u8]) -> Option<String> {
    let rows = shades.len().checked_div(columns).filter(|rows| *rows > 0)?;
    let mut picture = Vec::new();
    let mut encoder = png::Encoder::new(&mut picture, columns as u32, rows as u32);
    encoder.set_color(png::ColorType::Indexed);
    let palette: Vec<_> = (0..=255).flat_map(colour).collect();
    encoder.set_palette(palette);
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(&shades[..rows * columns]).ok()?;
    writer.finish().ok()?;
    Some(format!(
        "data:image/png;base64,{}",
        STANDARD.encode(picture)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spectrum's least and greatest level are told apart by lightness alone.
    #[test]
    fn a_greater_shade_is_lighter() {
        let light = |shade| colour(shade).map(u32::from).iter().sum::<u32>();
        assert!((0..15).all(|step| light(step * 17) < light((step + 1) * 17)));
    }

    #[test]
    fn no_cells_are_no_picture() {
        assert_eq!(address(0, &[]), None);
        assert_eq!(address(4, &[1, 2]), None);
        let address = address(2, &[0, 255, 3, 4]).expect("a picture");
        assert!(address.starts_with("data:image/png;base64,iVBOR"));
    }
}
