//! A picture's pixels in square blocks.

use turbid::Spectrum;

/// Side of a block \[pixels of the half-size grid\]: sixteen pixels of the picture.
pub const BLOCK: usize = 8;

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

    /// The grid of half the width and height, on which pictures are compared: means over its blocks are those over blocks of
    /// twice the side, and cost a quarter of the pixels.
    pub fn halved(self) -> Grid {
        Grid { width: self.width / 2, height: self.height / 2 }
    }

    /// Means over two by two pixels: a picture on the half-size grid.
    pub fn reduced(self, picture: &[Spectrum]) -> Vec<Spectrum> {
        let half = self.halved();
        let mean = |i: usize| {
            let at = 2 * (i / half.width) * self.width + 2 * (i % half.width);
            let pairs =
                picture[at] + picture[at + 1] + picture[at + self.width] + picture[at + self.width + 1];
            pairs * 0.25
        };
        (0..half.pixels()).map(mean).collect()
    }

    /// Means over every whole block.
    pub fn means(self, picture: &[Spectrum]) -> Vec<Spectrum> {
        let keep = vec![true; self.pixels()];
        let whole = self.blocks().map(|place| self.kept(place, &keep)).filter(|p| p.len() == BLOCK * BLOCK);
        let mean = |pixels: Vec<usize>| {
            let sum = pixels.iter().fold(Spectrum::ZERO, |sum, &i| sum + picture[i]);
            sum * (1.0 / pixels.len() as f64)
        };
        whole.map(mean).collect()
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
    fn a_halved_picture_has_the_same_means() {
        let grid = Grid { width: 6, height: 4 };
        let picture: Vec<Spectrum> = (0..24).map(|i| Spectrum::rgb(f64::from(i), 1.0, 0.0)).collect();
        let half = grid.reduced(&picture);
        assert_eq!((half.len(), grid.halved()), (6, Grid { width: 3, height: 2 }));
        assert_eq!(half[4], Spectrum::rgb((14 + 15 + 20 + 21) as f64 / 4.0, 1.0, 0.0));
    }

    #[test]
    fn means_are_of_whole_blocks() {
        let grid = Grid { width: 2 * BLOCK + 3, height: BLOCK };
        let picture: Vec<Spectrum> = (0..grid.pixels())
            .map(|i| Spectrum::grey(if i % grid.width >= BLOCK { 1.0 } else { 0.0 }))
            .collect();
        assert_eq!(grid.means(&picture), [Spectrum::ZERO, Spectrum::ONE]);
    }

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
