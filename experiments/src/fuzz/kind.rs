//! Kinds of input.

use clap::ValueEnum;

/// Kinds of input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Scene files.
    Scenes,
    /// Grids, `.vol`.
    Vol,
    /// Textures, PNG.
    Png,
    /// Meshes, OBJ.
    Obj,
    /// Tables of phase functions.
    Tables,
    /// Cells of the laboratory.
    Cells,
    /// Tables of figures.
    Figures,
    /// Command lines of the program `turbid`, a word a line.
    Arguments,
}

/// Kinds by turns: scenes are half; figures, which take long to draw, and command lines, a process each, one in fifty.
pub const TURNS: [(Kind, u64); 8] = [
    (Kind::Scenes, 50),
    (Kind::Vol, 60),
    (Kind::Png, 70),
    (Kind::Obj, 80),
    (Kind::Tables, 88),
    (Kind::Cells, 96),
    (Kind::Figures, 98),
    (Kind::Arguments, 100),
];

impl Kind {
    /// The name that the command line knows.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Scenes => "scenes",
            Kind::Vol => "vol",
            Kind::Png => "png",
            Kind::Obj => "obj",
            Kind::Tables => "tables",
            Kind::Cells => "cells",
            Kind::Figures => "figures",
            Kind::Arguments => "arguments",
        }
    }

    /// How the names of its files end.
    pub fn ending(self) -> &'static str {
        match self {
            Kind::Scenes => "toml",
            Kind::Vol => "vol",
            Kind::Png => "png",
            Kind::Obj => "obj",
            Kind::Tables => "txt",
            Kind::Cells => "cell",
            Kind::Figures => "csv",
            Kind::Arguments => "args",
        }
    }

    /// The kind of a file of this name.
    pub fn of_file(name: &str) -> Option<Kind> {
        let ending = name.rsplit_once('.')?.1;
        TURNS.iter().map(|(kind, _)| *kind).find(|kind| kind.ending() == ending)
    }
}
