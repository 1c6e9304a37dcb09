//! Polygons in triangles.

/// Cuts a convex polygon into triangles. Every second corner is cut off, and again what is left: a fan about one corner would be
/// hundreds of triangles that lie over each other seen from everywhere but in front, and no tree would part them.
pub(super) fn cut<T: Copy>(corners: Vec<T>, mut triangle: impl FnMut([T; 3])) {
    let mut ring = corners;
    while ring.len() > 2 {
        ring.windows(3).step_by(2).for_each(|cut| triangle([cut[0], cut[1], cut[2]]));
        if let ([first, .., before, last], true) = (&ring[..], ring.len().is_multiple_of(2)) {
            triangle([*first, *before, *last]);
        }
        ring = ring.into_iter().step_by(2).collect();
    }
}
