//! Where a table is good and where it is not.

use ltc_table::{Axis, Quantity, Table};

use super::canvas::{Anchor, Canvas};
use super::colour_scale::ColourScale;
use super::heat_map::{Direction, HeatMap, colour_bar};

/// Room around and between the panels.
const LEFT: i32 = 84;
const TOP: i32 = 80;
const BETWEEN: i32 = 90;
const RIGHT: i32 = 110;
const BOTTOM: i32 = 72;

/// Total variation at every entry, and beside it at the centre of every cell between entries (`centre_tv`, in C order).
/// A 4D table is drawn as tiles: θ upwards and α to the right, in each tile φ upwards and λ to the right.
pub fn error_map(title: &str, table: &Table, centre_tv: &[f64]) -> Canvas {
    let nodes = |axis: &Axis| axis.nodes();
    let centres = |axis: &Axis| {
        let ends = axis.nodes().into_iter().map(|x| axis.mapping.coordinate(x)).collect::<Vec<_>>();
        ends.windows(2).map(|w| axis.mapping.value(0.5 * (w[0] + w[1]))).collect()
    };
    let panels = [panel(table.axes(), nodes, &table.cells().tv), panel(table.axes(), centres, centre_tv)];
    let max = table.cells().tv.iter().chain(centre_tv).copied().fold(0.0, f64::max);
    let scale = ColourScale::to(max);
    let [first, second] = panels.each_ref().map(HeatMap::size);
    let height = first[1].max(second[1]);
    let mut canvas =
        Canvas::new((LEFT + first[0] + BETWEEN + second[0] + RIGHT) as u32, (TOP + height + BOTTOM) as u32);
    canvas.heading([LEFT, 24], Anchor::Left, &format!("{title}: total variation between table and BRDF"));
    let second_left = LEFT + first[0] + BETWEEN;
    canvas.text([LEFT, TOP - 16], Anchor::Left, &summary("at the entries", &table.cells().tv));
    canvas.text([second_left, TOP - 16], Anchor::Left, &summary("half-way between entries", centre_tv));
    panels[0].draw(&mut canvas, [LEFT, TOP + height - first[1]], &scale);
    panels[1].draw(&mut canvas, [second_left, TOP + height - second[1]], &scale);
    colour_bar(&mut canvas, [second_left + second[0] + 24, TOP + height], height, &scale);
    if let Some(tiles) = tile_caption(table.axes()) {
        canvas.text([LEFT, TOP + height + 54], Anchor::Left, &tiles);
    }
    canvas
}

/// One panel: the numbers over some values of the axes.
fn panel(axes: &[Axis], values: impl Fn(&Axis) -> Vec<f64>, numbers: &[f64]) -> HeatMap {
    let direction = |outer: Option<&Axis>, inner: Option<&Axis>| Direction {
        name: outer.map_or("", |axis| letter(axis.quantity)),
        labels: outer.map_or_else(Vec::new, |axis| {
            values(axis).into_iter().map(|value| label(axis.quantity, value)).collect()
        }),
        inner: inner.map_or(1, |axis| values(axis).len()),
    };
    // θ, α or θ, φ, α, λ: the vertical axes come first, and are the slower ones in the array too.
    let (vertical, horizontal) = axes.split_at(axes.len() / 2);
    HeatMap {
        vertical: direction(vertical.first(), vertical.get(1)),
        horizontal: direction(horizontal.first(), horizontal.get(1)),
        values: numbers.to_vec(),
    }
}

/// What stands above a panel.
fn summary(place: &str, numbers: &[f64]) -> String {
    let mean = numbers.iter().sum::<f64>() / numbers.len().max(1) as f64;
    let max = numbers.iter().copied().fold(0.0, f64::max);
    format!("{place}: mean {mean:.4}, largest {max:.3}")
}

fn tile_caption(axes: &[Axis]) -> Option<String> {
    let [_, phi, _, lambda] = axes else { return None };
    let range = |axis: &Axis| {
        let [low, high] = axis.domain.map(|value| label(axis.quantity, value));
        format!("{} from {low} to {high}", letter(axis.quantity))
    };
    Some(format!("in each tile: {} upwards, {} to the right", range(phi), range(lambda)))
}

fn letter(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Theta => "θ",
        Quantity::Phi => "φ",
        Quantity::Alpha => "α",
        Quantity::Lambda => "λ",
    }
}

fn label(quantity: Quantity, value: f64) -> String {
    match quantity {
        Quantity::Theta | Quantity::Phi => format!("{:.0}°", value.to_degrees()),
        Quantity::Alpha | Quantity::Lambda if value < 0.1 => format!("{value:.3}"),
        Quantity::Alpha | Quantity::Lambda => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltc_table::{CellStats, Mapping};

    fn table(axes: Vec<Axis>) -> Table {
        let n: usize = axes.iter().map(|a| a.len).product();
        let tv = (0..n).map(|i| 0.4 * i as f64 / n as f64).collect();
        let cells = CellStats { tv, leak: vec![0.0; n], condition: vec![1.0; n] };
        Table::new(axes, vec![glam::DMat3::IDENTITY; n], vec![1.0; n], vec![0.0; n], cells).unwrap()
    }

    #[test]
    fn tables_of_any_shape_are_drawn() {
        use Quantity::{Alpha, Lambda, Phi, Theta};
        for (quantities, lens) in [
            (&[Theta, Alpha][..], &[2_usize, 2][..]),
            (&[Theta, Alpha], &[64, 40]),
            (&[Theta, Alpha], &[4, 1000]),
            (&[Theta, Phi, Alpha, Lambda], &[8, 8, 8, 8]),
            (&[Theta, Phi, Alpha, Lambda], &[2, 5, 3, 2]),
        ] {
            let axes: Vec<Axis> =
                quantities.iter().zip(lens).map(|(q, len)| Axis::full(*q, Mapping::Linear, *len)).collect();
            let centres: usize = lens.iter().map(|len| len - 1).product();
            let canvas = error_map("a table", &table(axes), &vec![0.1; centres]);
            assert!(canvas.png().unwrap().len() > 1000, "{lens:?}");
        }
    }
}
