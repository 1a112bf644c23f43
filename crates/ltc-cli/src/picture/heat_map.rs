//! A grid of numbers as colours, with its axes.

use super::canvas::{Anchor, Canvas, INK};
use super::colour_scale::ColourScale;

/// Largest extent of a panel's grid in pixels, as far as whole pixels for each number allow.
const EXTENT: usize = 512;
/// Between tiles.
const GAP: i32 = 3;
/// Least room for a label beside its neighbour, in pixels.
const LABEL_ROOM: [i32; 2] = [42, 15];

/// One direction of a grid: the values of an outer axis and, where tiles hold grids of their own, of an inner one.
pub struct Direction {
    /// What the outer axis is called.
    pub name: &'static str,
    /// Its nodes, as they are written.
    pub labels: Vec<String>,
    /// Numbers in a tile, along the inner axis; 1 where there are no tiles.
    pub inner: usize,
}

impl Direction {
    fn cells(&self) -> usize {
        self.labels.len() * self.inner
    }

    fn gap(&self) -> i32 {
        if self.inner > 1 { GAP } else { 0 }
    }
}

/// A grid of numbers, the vertical direction slowest.
pub struct HeatMap {
    /// Upwards.
    pub vertical: Direction,
    /// To the right.
    pub horizontal: Direction,
    /// The numbers.
    pub values: Vec<f64>,
}

impl HeatMap {
    /// Pixels for each number.
    fn cell(&self) -> i32 {
        (EXTENT / self.vertical.cells().max(self.horizontal.cells()).max(1)).clamp(2, 24) as i32
    }

    /// Width and height of the grid.
    pub fn size(&self) -> [i32; 2] {
        [&self.horizontal, &self.vertical].map(|direction| {
            direction.cells() as i32 * self.cell() + (direction.labels.len() as i32 - 1) * direction.gap()
        })
    }

    /// Draws it with the grid's upper left corner at a point.
    pub fn draw(&self, canvas: &mut Canvas, [left, top]: [i32; 2], scale: &ColourScale) {
        let [width, height] = self.size();
        let cell = self.cell();
        let columns = self.horizontal.cells();
        for (i, value) in self.values.iter().enumerate() {
            let x = left + self.offset(&self.horizontal, i % columns);
            // Upwards: the first row is the lowest.
            let y = top + height - cell - self.offset(&self.vertical, i / columns);
            canvas.fill([x, y], [cell, cell], scale.colour(*value));
        }
        for (middle, label) in self.ticks(&self.horizontal, LABEL_ROOM[0]) {
            canvas.fill([left + middle, top + height + 2], [1, 4], INK);
            canvas.text([left + middle, top + height + 14], Anchor::Centre, label);
        }
        for (middle, label) in self.ticks(&self.vertical, LABEL_ROOM[1]) {
            let y = top + height - 1 - middle;
            canvas.fill([left - 6, y], [4, 1], INK);
            canvas.text([left - 9, y], Anchor::Right, label);
        }
        canvas.text([left + width / 2, top + height + 32], Anchor::Centre, self.horizontal.name);
        canvas.text([left - 50, top + height / 2], Anchor::Right, self.vertical.name);
    }

    /// Where a cell begins.
    fn offset(&self, direction: &Direction, index: usize) -> i32 {
        index as i32 * self.cell() + (index / direction.inner) as i32 * direction.gap()
    }

    /// The middles of nodes that have room for their labels: every node, or every second, and so on.
    fn ticks<'a>(&self, direction: &'a Direction, room: i32) -> impl Iterator<Item = (i32, &'a str)> {
        let tile = direction.inner as i32 * self.cell();
        let every = (room + tile - 1) / (tile + direction.gap()).max(1);
        let pitch = tile + direction.gap();
        let labels = direction.labels.iter().enumerate().step_by(every.max(1) as usize);
        labels.map(move |(i, label)| (i as i32 * pitch + tile / 2, label.as_str()))
    }
}

/// Draws the scale as a bar, its lower left corner at a point.
pub fn colour_bar(canvas: &mut Canvas, [left, bottom]: [i32; 2], height: i32, scale: &ColourScale) {
    const WIDTH: i32 = 18;
    for y in 0..height {
        let value = scale.end() * f64::from(y) / f64::from(height - 1);
        canvas.fill([left, bottom - 1 - y], [WIDTH, 1], scale.colour(value));
    }
    let digits = scale.ticks().nth(1).map_or(0, |step| (-step.log10().floor()).max(0.0) as usize);
    for tick in scale.ticks() {
        let y = bottom - 1 - (tick / scale.end() * f64::from(height - 1)).round() as i32;
        canvas.fill([left + WIDTH, y], [4, 1], INK);
        canvas.text([left + WIDTH + 8, y], Anchor::Left, &format!("{tick:.digits$}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::canvas::PAPER;

    fn direction(labels: usize, inner: usize) -> Direction {
        Direction { name: "x", labels: (0..labels).map(|i| i.to_string()).collect(), inner }
    }

    #[test]
    fn the_first_number_is_at_the_lower_left_and_tiles_are_apart() {
        let map = HeatMap {
            vertical: direction(2, 2),
            horizontal: direction(2, 3),
            values: (0..24).map(f64::from).collect(),
        };
        let scale = ColourScale::to(23.0);
        let [width, height] = map.size();
        assert_eq!([width, height], [6 * 24 + 3, 4 * 24 + 3]);
        let mut canvas = Canvas::new(400, 300);
        map.draw(&mut canvas, [100, 50], &scale);
        let at = |x: i32, y: i32| canvas.at((100 + x) as u32, (50 + y) as u32);
        assert_eq!(at(0, height - 1), scale.colour(0.0));
        assert_eq!(at(width - 1, height - 1), scale.colour(5.0));
        assert_eq!(at(0, height - 25), scale.colour(6.0));
        assert_eq!(at(width - 1, 0), scale.colour(23.0));
        assert_eq!(at(3 * 24 + 1, 5), PAPER, "between two tiles");
    }

    #[test]
    fn labels_keep_apart() {
        let map =
            HeatMap { vertical: direction(64, 1), horizontal: direction(64, 1), values: vec![0.0; 64 * 64] };
        let middles: Vec<i32> = map.ticks(&map.horizontal, 42).map(|(x, _)| x).collect();
        assert!(middles.len() > 5 && middles.windows(2).all(|w| w[1] - w[0] >= 42), "{middles:?}");
    }
}
