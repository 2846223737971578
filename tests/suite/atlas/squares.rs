//! Allocation of squares in a square: a buddy system in two dimensions.

use std::collections::BTreeSet;

/// The free squares of a square. Sides are powers of two; every square lies at a multiple of its side.
#[derive(Clone, Debug)]
pub(super) struct Squares {
    side: u32,
    /// Corners (column, row) of the free squares, by the logarithm of their side. Four free squares that
    /// form a larger one are that one.
    free: Vec<BTreeSet<[u32; 2]>>,
}

impl Squares {
    /// One free square of `side` texels, a power of two.
    pub(super) fn new(side: u32) -> Self {
        let mut free = vec![BTreeSet::new(); side.ilog2() as usize + 1];
        free[side.ilog2() as usize].insert([0, 0]);
        Self { side, free }
    }

    /// Takes a square of `side` texels, a power of two, and returns its corner. Splits the smallest free
    /// square that is large enough; `None` if there is none.
    pub(super) fn take(&mut self, side: u32) -> Option<[u32; 2]> {
        let needed = side.ilog2() as usize;
        let found = (needed..self.free.len()).find(|level| !self.free[*level].is_empty())?;
        let [x, y] = self.free[found].pop_first()?;
        for level in needed..found {
            let half = 1 << level;
            self.free[level].extend([[x + half, y], [x, y + half], [x + half, y + half]]);
        }
        Some([x, y])
    }

    /// Gives back a square that was taken, and merges it with its neighbours.
    pub(super) fn give(&mut self, mut corner: [u32; 2], side: u32) {
        let mut level = side.ilog2() as usize;
        while 1 << level < self.side {
            let whole = corner.map(|c| c >> (level + 1) << (level + 1));
            let quarters = [[0, 0], [1, 0], [0, 1], [1, 1]]
                .map(|[i, j]: [u32; 2]| [whole[0] + (i << level), whole[1] + (j << level)]);
            let is_free = |quarter: &[u32; 2]| *quarter == corner || self.free[level].contains(quarter);
            if !quarters.iter().all(is_free) {
                break;
            }
            for quarter in quarters {
                self.free[level].remove(&quarter);
            }
            corner = whole;
            level += 1;
        }
        self.free[level].insert(corner);
    }

    /// Texels of the free squares.
    pub(super) fn area(&self) -> u64 {
        (0..).zip(&self.free).map(|(level, squares)| (squares.len() as u64) << (2 * level)).sum()
    }
}
