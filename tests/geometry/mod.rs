//! Shapes of many parts, meshes and lathes, against shapes of one part, brute force and closed forms.

mod distance;
mod files;
mod height_field;
mod lathe;
mod meshes;
mod shading;
mod solids;
