//! The grid's points and neighbours.

use glam::DVec2;
use octagloss::internals::realtime::tables::triangle::{CONE_REACH, Grid};

/// Column and row of a node.
pub(crate) type Node = (usize, usize);

/// What the fit asks of a [`Grid`].
pub(crate) trait Nodes: Copy {
    /// The point of the triangle at column `i`, row `j`, between nodes too.
    fn point(self, at: [f64; 2]) -> DVec2;

    /// Which of the sides v = 0, u = v and u + v = 1 node (`i`, `j`) lies on.
    fn on_sides(self, i: usize, j: usize) -> [bool; 3];

    /// Node (`i`, `j`), or `None` beyond the grid.
    fn node_at(self, i: Option<usize>, j: Option<usize>) -> Option<Node>;

    /// The up to six nodes next to node (`i`, `j`).
    fn neighbours(self, i: usize, j: usize) -> impl Iterator<Item = Node> {
        let around = [(-1, -1), (-1, 0), (0, -1), (0, 1), (1, 0), (1, 1)];
        around
            .into_iter()
            .filter_map(move |(di, dj)| self.node_at(i.checked_add_signed(di), j.checked_add_signed(dj)))
    }

    /// The up to six cells around node (`i`, `j`), each by its other two nodes.
    fn cells_around(self, i: usize, j: usize) -> impl Iterator<Item = (Node, Node)> {
        let around = [(1_isize, 0_isize), (1, 1), (0, 1), (-1, 0), (-1, -1), (0, -1)];
        let at = move |k: usize| {
            let (di, dj) = around[k % 6];
            self.node_at(i.checked_add_signed(di), j.checked_add_signed(dj))
        };
        (0..6).filter_map(move |k| at(k).zip(at(k + 1)))
    }
}

impl Nodes for Grid {
    fn point(self, [i, j]: [f64; 2]) -> DVec2 {
        let most = self.intervals() as f64;
        match self {
            Self::Triangle => DVec2::new(i + j, i - j) / (2.0 * most),
            Self::Cone => {
                let (e, a) = (i * i.max(1.0), j * i.max(1.0));
                let scale = CONE_REACH / (most * most);
                DVec2::X + scale * DVec2::new(-e - a, e - a) / 2.0
            }
        }
    }

    fn on_sides(self, i: usize, j: usize) -> [bool; 3] {
        match self {
            Self::Triangle => [i == j, j == 0, i == self.intervals()],
            Self::Cone => [i == j, false, j == 0],
        }
    }

    fn node_at(self, i: Option<usize>, j: Option<usize>) -> Option<Node> {
        let (i, j) = (i?, j?);
        (i <= self.intervals() && j <= i).then_some((i, j))
    }
}
