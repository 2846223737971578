//! A tree of cells over a map's texels: rectangles with their directions' mean, covariance and reach. It
//! depends on map and size only; energies come from the tables.

use glam::{DMat3, DVec2, DVec3};
use octagloss_core::geometry::exact::outer;
use octagloss_core::sphere::grid::Grid;

/// A rectangle of texels and the directions in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) component: u32,
    pub(super) low: [u32; 2],
    pub(super) high: [u32; 2],
    /// Mean and covariance of its directions, over the solid angle inside the domain.
    pub(super) mean: DVec3,
    pub(super) covariance: DMat3,
    /// No direction is farther from the mean.
    pub(super) reach: f64,
    /// Index of its first child and their number; none for a texel.
    pub(super) children: (u32, u32),
    solid_angle: f64,
}

impl Cell {
    pub(super) fn is_texel(&self) -> bool {
        self.high[0] - self.low[0] == 1 && self.high[1] - self.low[1] == 1
    }
}

/// The cells of a map; those without directions are left out.
#[derive(Clone, Debug)]
pub struct Cells {
    pub(super) grid: Grid,
    pub(super) cells: Vec<Cell>,
    pub(super) roots: Vec<u32>,
}

/// Points along a texel's edge in its moments.
const POINTS: u32 = 4;

impl Cells {
    /// The cells of `grid`.
    pub fn new(grid: Grid) -> Self {
        let mut tree = Self { grid, cells: Vec::new(), roots: Vec::new() };
        for component in 0..grid.map().components() {
            let root = tree.cell(component, [0, 0], grid.sides(component));
            if let Some(root) = root {
                tree.roots.push(u32::try_from(tree.cells.len()).expect("cells fit"));
                tree.cells.push(root);
            }
        }
        tree
    }

    /// The cell of the texels from `low` to `high`, after its children were added; `None` without
    /// directions.
    fn cell(&mut self, component: u32, low: [u32; 2], high: [u32; 2]) -> Option<Cell> {
        let [width, height] = [high[0] - low[0], high[1] - low[1]];
        if width == 1 && height == 1 {
            return texel(&self.grid, component, low);
        }
        // Halve the longer side of long cells, else both.
        let cuts = |axis: usize, is_cut: bool| {
            let middle = low[axis] + (high[axis] - low[axis]) / 2;
            if is_cut && middle > low[axis] {
                vec![[low[axis], middle], [middle, high[axis]]]
            } else {
                vec![[low[axis], high[axis]]]
            }
        };
        let (columns, rows) = (cuts(0, 2 * width > height), cuts(1, 2 * height > width));
        let mut children = Vec::new();
        for row in &rows {
            for column in &columns {
                children.extend(self.cell(component, [column[0], row[0]], [column[1], row[1]]));
            }
        }
        let solid_angle: f64 = children.iter().map(|child| child.solid_angle).sum();
        if children.is_empty() {
            return None;
        }
        let share = |child: &Cell| child.solid_angle / solid_angle;
        let mean: DVec3 = children.iter().map(|child| child.mean * share(child)).sum();
        let mut covariance = DMat3::ZERO;
        let mut reach: f64 = 0.0;
        for child in &children {
            let offset = child.mean - mean;
            covariance += (child.covariance + outer(offset)) * share(child);
            reach = reach.max(offset.length() + child.reach);
        }
        let first = u32::try_from(self.cells.len()).expect("cells fit");
        let count = children.len() as u32;
        self.cells.extend(children);
        Some(Cell { component, low, high, mean, covariance, reach, children: (first, count), solid_angle })
    }
}

/// Directions and solid angles of points of texel (`x`, `y`) of `component`, inside its domain, `count` along
/// each edge.
pub(super) fn points(
    grid: &Grid,
    component: u32,
    [x, y]: [u32; 2],
    count: u32,
) -> impl Iterator<Item = (DVec3, f64)> + use<> {
    let (map, grid) = (grid.map(), *grid);
    let area = grid.step(&map.component(component));
    (0..count * count).filter_map(move |k| {
        let share = |k: u32| (f64::from(k) + 0.5) / f64::from(count);
        let at = DVec2::new(f64::from(x) + share(k % count), f64::from(y) + share(k / count));
        let uv = grid.uv(component, at.x, at.y);
        let weight = map.density(component, uv) * area.x * area.y / f64::from(count * count);
        map.contains(component, uv).then(|| (map.direction(component, uv), weight))
    })
}

fn texel(grid: &Grid, component: u32, low: [u32; 2]) -> Option<Cell> {
    let map = grid.map();
    let area = grid.step(&map.component(component));
    let (x, y) = (f64::from(low[0]), f64::from(low[1]));
    let solid_angle =
        map.solid_angle(component, grid.uv(component, x, y), grid.uv(component, x + 1.0, y + 1.0));
    if solid_angle <= 0.0 {
        return None;
    }
    let samples: Vec<(DVec3, f64)> = points(grid, component, low, POINTS).collect();
    let total: f64 = samples.iter().map(|(_, weight)| weight).sum();
    let high = low.map(|k| k + 1);
    let centre = map.direction(component, grid.uv(component, x + 0.5, y + 0.5));
    let mean = if total > 0.0 {
        samples.iter().map(|(direction, weight)| *direction * (weight / total)).sum()
    } else {
        // A sliver between the points.
        centre
    };
    let covariance = samples
        .iter()
        .map(|(direction, weight)| outer(*direction - mean) * (weight / total))
        .fold(DMat3::ZERO, |sum, term| sum + term);
    // The farthest point lies on the rim; between eight points of it a texel's rim bends by far less than
    // the tenth that is added.
    let mut reach: f64 = 0.0;
    for k in 0..9 {
        let at = grid.uv(component, x + f64::from(k % 3) / 2.0, y + f64::from(k / 3) / 2.0);
        reach = reach.max(map.direction(component, at).distance(mean));
    }
    let reach = 1.1 * reach + 1e-9 * area.max_element();
    Some(Cell { component, low, high, mean, covariance, reach, children: (0, 0), solid_angle })
}
