//! Circles that are left, those of the referee.

/// Each by its files: no new one is added, and one that is cut is taken off.
pub const KNOWN: &[&[&str]] = &[
    &["analytic/asymptotics/mod.rs", "analytic/asymptotics/closed.rs", "analytic/asymptotics/ordinates.rs"],
    &["analytic/peierls/mesh.rs", "analytic/peierls/mod.rs", "analytic/peierls/weights.rs"],
    &[
        "analytic/slab_anisotropic/mod.rs",
        "analytic/slab_anisotropic/faces.rs",
        "analytic/slab_anisotropic/medium.rs",
        "analytic/slab_anisotropic/radiance.rs",
    ],
    &[
        "analytic/slab_fresnel/mod.rs",
        "analytic/slab_fresnel/direct.rs",
        "analytic/slab_fresnel/doubling.rs",
        "analytic/slab_fresnel/ordinates.rs",
    ],
    &["analytic/slab_isotropic/mod.rs", "analytic/slab_isotropic/orders.rs"],
    &[
        "analytic/sphere/mod.rs",
        "analytic/sphere/large.rs",
        "analytic/sphere/orders.rs",
        "analytic/sphere/shells.rs",
    ],
];
