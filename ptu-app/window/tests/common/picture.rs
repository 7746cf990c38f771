//! Pictures of the window: of a display, or painted from what a window without a screen has laid out.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use eframe::egui::epaint::{Primitive, Vertex};
use eframe::egui::{
    Color32, ColorImage, Context, FullOutput, ImageData, Pos2, Rect, Rgba, TextureId,
    TexturesDelta, pos2,
};
use egui_kittest::TestRenderer;

/// Pixels of a screen.
#[derive(PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<u8>,
}

/// The textures of a window, its letters above all.
#[derive(Clone, Default)]
pub struct Textures(Rc<RefCell<HashMap<TextureId, ColorImage>>>);

impl TestRenderer for Textures {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut all = self.0.borrow_mut();
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                let ImageData::Color(new) = delta.image;
                match (delta.pos, all.get_mut(&id)) {
                    (Some([left, top]), Some(old)) => {
                        let rows = new.pixels.chunks_exact(new.size[0]);
                        for (y, row) in (top..).zip(rows) {
                            let place = y * old.size[0] + left;
                            old.pixels[place..place + row.len()].copy_from_slice(row);
                        }
                    }
                    _ => drop(all.insert(id, (*new).clone())),
                }
            }
        }
        for id in delta.free.drain() {
            all.remove(&id);
        }
    }
}

impl Textures {
    /// What the last frame looks like on this ground, one pixel a point.
    pub fn picture(&self, context: &Context, seen: &FullOutput, ground: [f32; 4]) -> Picture {
        let size = context.content_rect().max;
        let [wide, high] = [size.x as usize, size.y as usize];
        let [r, g, b, a] = ground;
        let mut pixels = vec![Rgba::from_rgba_premultiplied(r, g, b, a); wide * high];
        let all = self.0.borrow();
        for part in context.tessellate(seen.shapes.clone(), 1.0) {
            let Primitive::Mesh(mesh) = part.primitive else {
                continue;
            };
            let Some(texture) = all.get(&mesh.texture_id) else {
                continue;
            };
            let clip = part
                .clip_rect
                .intersect(Rect::from_min_max([0.0; 2].into(), size));
            for corners in mesh.indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|place| &mesh.vertices[corners[place] as usize]);
                triangle(corners, clip.round(), |x, y, colour, uv| {
                    let [w, h] = texture.size;
                    let u = (uv[0] * w as f32) as usize;
                    let v = (uv[1] * h as f32) as usize;
                    let texel = texture.pixels[v.min(h - 1) * w + u.min(w - 1)];
                    let over = shares(texel) * colour;
                    let below = &mut pixels[y * wide + x];
                    *below = over + *below * (1.0 - over.a());
                });
            }
        }
        let bytes = |pixel: Rgba| [pixel.r(), pixel.g(), pixel.b()];
        let byte = |share: f32| (share * 255.0).round() as u8;
        Picture {
            width: wide as u32,
            height: high as u32,
            rgb: pixels.into_iter().flat_map(bytes).map(byte).collect(),
        }
    }
}

/// A colour as it is blended: its bytes as shares, without a change of their scale.
fn shares(colour: Color32) -> Rgba {
    let [r, g, b, a] = colour.to_array().map(|byte| f32::from(byte) / 255.0);
    Rgba::from_rgba_premultiplied(r, g, b, a)
}

/// Paints the pixels whose middle is in a triangle: where, its colour there, and its place in the texture.
fn triangle(
    corners: [&Vertex; 3],
    clip: Rect,
    mut paint: impl FnMut(usize, usize, Rgba, [f32; 2]),
) {
    let [a, b, c] = corners.map(|corner| corner.pos);
    let area = (b - a).rot90().dot(c - a);
    if area == 0.0 {
        return;
    }
    let around = Rect::from_points(&[a, b, c]).intersect(clip);
    let whole = |from: f32, to: f32| from.max(0.0).floor() as usize..to.max(0.0).ceil() as usize;
    for y in whole(around.top(), around.bottom()) {
        for x in whole(around.left(), around.right()) {
            let at = pos2(x as f32 + 0.5, y as f32 + 0.5);
            // The one edge of a pair of triangles is the other's, too: of it one has the pixels.
            let share = |from: Pos2, to: Pos2| {
                let share = (to - from).rot90().dot(at - from) / area;
                let edge = (to - from) * area.signum();
                let is_mine = edge.y > 0.0 || (edge.y == 0.0 && edge.x > 0.0);
                (share > 0.0 || (share == 0.0 && is_mine)).then_some(share)
            };
            let (Some(of_a), Some(of_b), Some(of_c)) = (share(b, c), share(c, a), share(a, b))
            else {
                continue;
            };
            if !clip.contains(at) {
                continue;
            }
            let of = [of_a, of_b, of_c];
            let colour = |place: usize| shares(corners[place].color) * of[place];
            let uv = |axis: usize| {
                (0..3)
                    .map(|place| corners[place].uv[axis] * of[place])
                    .sum()
            };
            paint(x, y, colour(0) + colour(1) + colour(2), [uv(0), uv(1)]);
        }
    }
}

impl Picture {
    /// How many pixels have a channel that differs by more than this; all of them if the sizes do.
    pub fn other_pixels(&self, other: &Self, by: u8) -> usize {
        if (self.width, self.height) != (other.width, other.height) {
            return usize::MAX;
        }
        let pixels = self.rgb.chunks_exact(3).zip(other.rgb.chunks_exact(3));
        let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > by);
        pixels.filter(differs).count()
    }

    pub fn write(&self, file: &Path) {
        let file = std::fs::File::create(file).expect("file");
        let mut encoder = png::Encoder::new(file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("header");
        writer.write_image_data(&self.rgb).expect("pixels");
    }
}
