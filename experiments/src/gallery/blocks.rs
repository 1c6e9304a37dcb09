//! A picture's pixels in square blocks.

/// Side of a block \[pixels\].
pub const BLOCK: usize = 16;

/// The size of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// Columns of pixels.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
}

impl Grid {
    /// Number of pixels.
    pub fn pixels(self) -> usize {
        self.width * self.height
    }

    /// Column and row of every block; those at the right and lower rim may be narrower.
    pub fn blocks(self) -> impl Iterator<Item = (usize, usize)> {
        let columns = self.width.div_ceil(BLOCK);
        (0..self.height.div_ceil(BLOCK)).flat_map(move |y| (0..columns).map(move |x| (x, y)))
    }

    /// The fewest pixels of a block whose mean is compared: an eighth of a whole block. Below, one odd pixel is
    /// more than a thirtieth of the mean.
    pub fn fewest(self) -> usize {
        BLOCK * BLOCK / 8
    }

    /// Indices of a block's pixels that are kept.
    pub fn kept(self, (column, row): (usize, usize), keep: &[bool]) -> Vec<usize> {
        let xs = column * BLOCK..((column + 1) * BLOCK).min(self.width);
        let ys = row * BLOCK..((row + 1) * BLOCK).min(self.height);
        let all = ys.flat_map(|y| xs.clone().map(move |x| y * self.width + x));
        all.filter(|&i| keep[i]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_share_out_all_pixels() {
        for grid in [Grid { width: 40, height: 16 }, Grid { width: 5, height: 33 }] {
            let keep = vec![true; grid.pixels()];
            let mut all: Vec<usize> = grid.blocks().flat_map(|b| grid.kept(b, &keep)).collect();
            all.sort_unstable();
            assert_eq!(all, (0..grid.pixels()).collect::<Vec<_>>());
        }
    }
}
