//! A sensor's bins as arrays: `.npy` files, and grids for `.vol` files.

use super::npy::npy_header;
use crate::error::{Error, Result};
use crate::geometry::Voxels;
use crate::medium::Grid;
use crate::sensor::Measurement;

/// The bytes of a `.npy` file (version 1.0) of one sensor's measurements, `count` bins along each axis: little-endian
/// doubles of shape (i, j, k, channel, 2), the last index the slowest to be left out: 0 for the mean and 1 for its standard
/// error, which is not a number where there is none. Channels are 1 or 3.
///
/// # Arguments
/// `rows` in the order in which sensors give them: channel fastest, then i, j and k
///
/// # Source
/// NEP 1, A Simple File Format for NumPy Arrays
pub fn npy(rows: &[&Measurement], count: [usize; 3]) -> Vec<u8> {
    let [ni, nj, nk] = count;
    let channels = rows.len() / (ni * nj * nk);
    let mut bytes = npy_header("'<f8'", &format!("({ni}, {nj}, {nk}, {channels}, 2)"));
    bytes.reserve(16 * rows.len());
    for i in 0..ni {
        for j in 0..nj {
            for k in 0..nk {
                let first = channels * (i + ni * (j + nj * k));
                for row in &rows[first..first + channels] {
                    bytes.extend(row.mean.to_le_bytes());
                    bytes.extend(row.std_error.unwrap_or(f64::NAN).to_le_bytes());
                }
            }
        }
    }
    bytes
}

/// The means of one sensor's voxels as a grid, whose bytes are a `.vol` file: single precision, channel fastest.
///
/// # Errors
/// `Error::OutOfRange` for a mean that single precision cannot hold
pub fn voxel_grid(rows: &[&Measurement], voxels: &Voxels) -> Result<Grid> {
    let channels = rows.len() / voxels.count().iter().product::<usize>();
    let values: Vec<f32> = rows.iter().map(|row| row.mean as f32).collect();
    if let Some(row) = rows.iter().find(|row| row.mean.abs() > f64::from(f32::MAX)) {
        return Err(Error::out_of_range("a mean for a .vol file", row.mean, "what single precision holds"));
    }
    Grid::new((voxels.cuboid().min(), voxels.cuboid().max()), voxels.count(), channels, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Cuboid;
    use glam::DVec3;

    fn row(mean: f64, std_error: Option<f64>) -> Measurement {
        Measurement {
            sensor: String::new(),
            quantity: String::new(),
            unit: "1",
            mean,
            std_error,
            n: 1,
            no_error: None,
            bin: None,
            spread: crate::sensor::Spread::default(),
        }
    }

    /// Byte by byte what `numpy.save` writes of the array [[[[[1, 0.5]], [[3, 0.25]]]], [[[[2, nan]], [[4, 0]]]]], (2, 1, 2, 1, 2).
    #[test]
    fn an_array_as_numpy_writes_it() {
        let rows = [row(1.0, Some(0.5)), row(2.0, None), row(3.0, Some(0.25)), row(4.0, Some(0.0))];
        let bytes = npy(&rows.each_ref(), [2, 1, 2]);
        let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        expected.extend(b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 1, 2, 1, 2), }");
        expected.resize(127, b' ');
        expected.push(b'\n');
        for number in [1.0, 0.5, 3.0, 0.25, 2.0, f64::NAN, 4.0, 0.0] {
            expected.extend(number.to_le_bytes());
        }
        assert_eq!(bytes, expected);
    }

    #[test]
    fn voxels_as_a_grid() {
        let cuboid = Cuboid::new(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0)).unwrap();
        let voxels = Voxels::new(cuboid, [2, 1, 1]).unwrap();
        let channels: Vec<Measurement> = (0..6).map(|i| row(f64::from(i), None)).collect();
        let grid =
            Grid::from_bytes(&voxel_grid(&channels.iter().collect::<Vec<_>>(), &voxels).unwrap().to_bytes())
                .unwrap();
        assert_eq!((grid.count(), grid.channels()), ([2, 1, 1], 3));
        assert_eq!(grid.values(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(grid.corners(), (DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0)));
        assert!(voxel_grid(&[&row(1e39, None), &row(1.0, None)], &voxels).is_err());
    }
}
