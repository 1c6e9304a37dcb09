//! The tree over photon positions: blocks of sixteen in kd order, boxes sixteen wide above them.

mod along;
mod block;
mod boxes;
mod columns;
mod cylinder;
mod facing;
mod nearest;
mod order;
mod radii;
mod scratch;
mod units;
mod within;

use super::{Flags, Photon, Photons};
use crate::error::{Error, Result};
use crate::transport::{NoProgress, Progress};
use block::BLOCK;
use columns::{Columns, Entry, rows};
use glam::{DVec3, Vec3};
use wide::f32x8;

pub use block::ROW;
pub(in crate::photons) use block::{Row, cross, dot};
pub(in crate::photons) use boxes::{Boxes, Extent, levels_of};
pub(in crate::photons) use cylinder::Cylinder;
pub use facing::Tangent;
pub use nearest::{Counted, Nearest, Shell};
pub use radii::Radii;
pub(in crate::photons) use units::Units;
pub(crate) use within::bits;
pub use within::{Neighbors, Visit};

/// Photons, ordered so that neighbours in space are neighbours in memory; the only copy of them.
///
/// Positions are held in single precision relative to the centre of the map's box, in a power-of-two unit u
/// with u/2 < half the longest edge <= u: a stored coordinate differs by at most 2^-25 u, see
/// [`PhotonTree::resolution`], and a query point by as much. Distances are computed in single precision, with
/// a relative error below 4 x 2^-24 beyond that. Directions and powers are held as they came.
///
/// A search takes the same sum over the same photons in the same order whatever the processor, the number of
/// threads and the order the photons came in.
#[derive(Debug)]
pub struct PhotonTree {
    units: Units,
    stored: usize,
    identity: u64,
    positions: Vec<[Row; 2]>,
    dirs: Vec<Row>,
    /// None in a tree of photons of media alone.
    normals: Vec<Row>,
    powers: Vec<Row>,
    histories: Vec<(u16, Flags)>,
    levels: Vec<Vec<Boxes>>,
}

impl PhotonTree {
    /// The tree over `photons`, built by the calling thread.
    ///
    /// # Errors
    /// [`Error::NonFinite`] if a position, direction, normal or power is not finite; [`Error::OutOfRange`] beyond
    /// 2^32 photons.
    pub fn new(photons: impl Into<Photons>) -> Result<Self> {
        Self::build(vec![photons.into()], false, &NoProgress)
    }

    /// The same tree, bit for bit, built by the threads of the current pool.
    ///
    /// # Errors
    /// As [`PhotonTree::new`].
    pub fn new_parallel(photons: impl Into<Photons>) -> Result<Self> {
        Self::new_watched(photons, &NoProgress)
    }

    /// The same, and `progress` is told of every photon that is in its place.
    ///
    /// # Errors
    /// As [`PhotonTree::new`].
    pub fn new_watched(photons: impl Into<Photons>, progress: &dyn Progress) -> Result<Self> {
        Self::of_parts(vec![photons.into()], progress)
    }

    /// The same tree, bit for bit, of photons in parts; each is gone when the next is taken.
    ///
    /// # Errors
    /// As [`PhotonTree::new`].
    pub fn of_parts(parts: Vec<Photons>, progress: &dyn Progress) -> Result<Self> {
        Self::build(parts, true, progress)
    }

    fn build(parts: Vec<Photons>, is_parallel: bool, progress: &dyn Progress) -> Result<Self> {
        let stored = parts.iter().map(Photons::len).sum::<usize>();
        if u32::try_from(stored).is_err() {
            return Err(Error::out_of_range("the number of photons in one map", stored as f64, "below 2^32"));
        }
        let units = Units::of(&parts, is_parallel)?;
        let (mut entries, columns) = Columns::of(parts, &units);
        if stored > 0 {
            order::kd_order(&mut entries, &columns, is_parallel, progress);
        }
        let positions: Vec<[Row; 2]> = entries.chunks(BLOCK).map(block_of).collect();
        let mut order: Vec<u32> = entries.into_iter().map(|entry| entry.index).collect();
        // The numbers were collected in the entries' memory, of which they need a quarter.
        order.shrink_to_fit();
        // One column after the other, each gone before the next comes.
        let Columns { dirs, normals, powers, histories } = columns;
        let dirs = rows(dirs, &order, is_parallel);
        let normals = rows(normals, &order, is_parallel);
        let powers = rows(powers, &order, is_parallel);
        let histories = order.iter().map(|index| histories[*index as usize]).collect();
        let levels = boxes::levels(&positions, stored);
        let identity = scratch::new_identity();
        Ok(PhotonTree { units, stored, identity, positions, dirs, normals, powers, histories, levels })
    }

    /// Number of photons.
    pub fn len(&self) -> usize {
        self.stored
    }

    /// Whether there are no photons.
    pub fn is_empty(&self) -> bool {
        self.stored == 0
    }

    /// Largest error of a stored coordinate \[L\], beyond that of an f64 of its size.
    pub fn resolution(&self) -> f64 {
        self.units.stretch(1.0 / f64::from(1u32 << 25))
    }

    /// The farthest that a photon's coordinate lies from that of the box's centre \[L\].
    pub fn extent(&self) -> f64 {
        self.units.extent()
    }

    /// Memory that the photons and the boxes above them occupy \[bytes\].
    pub fn bytes(&self) -> usize {
        let boxes: usize = self.levels.iter().map(Vec::len).sum();
        self.dirs.len() * size_of::<[Row; 3]>()
            + self.normals.len() * size_of::<Row>()
            + self.histories.len() * size_of::<(u16, Flags)>()
            + boxes * size_of::<Boxes>()
    }

    /// The photon of a place in the tree's order, below [`PhotonTree::len`]; its position as it is stored.
    pub fn photon(&self, place: usize) -> Photon {
        let (row, lane) = (place / ROW, place % ROW);
        let vector = |row: &Row| [0, 1, 2].map(|axis| row[axis].as_array()[lane]);
        let (order, flags) = self.histories[place];
        Photon {
            position: self.position(place),
            dir: Vec3::from_array(vector(&self.dirs[row])),
            normal: self.normals.get(row).map_or(Vec3::ZERO, |row| Vec3::from_array(vector(row))),
            power: Vec3::from_array(vector(&self.powers[row])),
            order,
            flags,
        }
    }

    /// Where the photon at a place in the tree's order is \[L\].
    pub fn position(&self, place: usize) -> DVec3 {
        let (row, lane) = (place / ROW, place % ROW);
        let positions = &self.positions[row / 2][row % 2];
        self.units.absolute([0, 1, 2].map(|axis| positions[axis].as_array()[lane]))
    }

    /// A point relative to the middle of the map, in its unit ([`PhotonTree::unit`]).
    pub(crate) fn relative(&self, point: DVec3) -> DVec3 {
        self.units.relative(point)
    }

    /// Every photon, in the tree's order.
    pub fn photons(&self) -> impl Iterator<Item = Photon> + '_ {
        (0..self.stored).map(|place| self.photon(place))
    }
}

/// The positions of a block, whose padding lies infinitely far away, farther than any radius, and carries nothing.
fn block_of(entries: &[Entry]) -> [Row; 2] {
    let mut position = [[f32::INFINITY; BLOCK]; 3];
    for (lane, entry) in entries.iter().enumerate() {
        position.iter_mut().zip(entry.position).for_each(|(row, x)| row[lane] = x);
    }
    [row(&position, 0), row(&position, ROW)]
}

/// Eight of a block's sixteen vectors.
fn row(lanes: &[[f32; BLOCK]; 3], first: usize) -> Row {
    [0, 1, 2].map(|axis| f32x8::from(&lanes[axis][first..first + ROW]))
}
