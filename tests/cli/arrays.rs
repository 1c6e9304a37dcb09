//! Densities from NumPy arrays: the same grids as `.vol` files, and every way in which the arrays can be wrong.

use crate::{Folder, refuses_naming, succeeds, text};
use glam::DVec3;
use turbid::medium::{Density, Grid};
use turbid::rng::{Purpose, Stream};
use turbid::scene::SceneFile;

const COUNT: [usize; 3] = [3, 4, 5];
const BOX: &str = ", min = [-1.0, 0.5, 2.0], max = [2.0, 1.0, 7.0]";

fn scene(keys: &str) -> String {
    format!(
        "[[regions]]\nshape = {{ cuboid = {{ min = [-9, -9, -9], max = [9, 9, 9] }} }}\nsigma_t = 1\nalbedo = 0.5\ng = 0\n\
         density = {{ grid = {{ {keys} }} }}\n[[lights]]\npoint = {{ position = [9.5, 0, 0], power = 1 }}\n"
    )
}

/// A value that singles out its place, exact in single precision.
fn value(i: usize, j: usize, k: usize) -> f64 {
    (1 + i + 10 * j + 100 * k) as f64 / 128.0
}

/// An array with this header in this version.
fn npy(version: u8, header: &str, body: &[u8]) -> Vec<u8> {
    let size = (header.len() as u32).to_le_bytes();
    let size = if version == 1 { &size[..2] } else { &size[..] };
    [b"\x93NUMPY", &[version, 0][..], size, header.as_bytes(), body].concat()
}

fn header(descr: &str, fortran: &str, shape: &str) -> String {
    format!("{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
}

/// The array of [`value`], as `numpy.save` writes it.
fn array(version: u8, is_double: bool, is_fortran: bool) -> Vec<u8> {
    let [nx, ny, nz] = COUNT;
    let mut places = Vec::new();
    if is_fortran {
        (0..nz).for_each(|k| (0..ny).for_each(|j| (0..nx).for_each(|i| places.push((i, j, k)))));
    } else {
        (0..nx).for_each(|i| (0..ny).for_each(|j| (0..nz).for_each(|k| places.push((i, j, k)))));
    }
    let mut body = Vec::new();
    for (i, j, k) in places {
        let value = value(i, j, k);
        match is_double {
            true => body.extend(value.to_le_bytes()),
            false => body.extend((value as f32).to_le_bytes()),
        }
    }
    let descr = if is_double { "'<f8'" } else { "'<f4'" };
    npy(version, &header(descr, if is_fortran { "True" } else { "False" }, "(3, 4, 5)"), &body)
}

fn density(folder: &Folder, keys: &str) -> Density {
    let scene = SceneFile::from_toml(&scene(keys)).unwrap().scene(folder.0.path()).unwrap();
    scene.regions()[0].medium.density().unwrap().clone()
}

/// Index [i, j, k] is x, y, z in either order of the bytes and of either type: the densities are those of the `.vol` file, to
/// the bit, at random points of the box and around it; exported, both are the same grid.
#[test]
fn arrays_are_the_grids_of_their_values() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name);
    let corners = (DVec3::new(-1.0, 0.5, 2.0), DVec3::new(2.0, 1.0, 7.0));
    // The order of a grid: x fastest.
    let n = COUNT[0] * COUNT[1];
    let values = (0..n * COUNT[2]).map(|at| value(at % COUNT[0], at % n / COUNT[0], at / n) as f32);
    let grid = Grid::new(corners, COUNT, 1, values.collect()).unwrap();
    std::fs::write(path("fog.vol"), grid.to_bytes()).unwrap();
    let exported = |name: &str, keys: &str| {
        let camera =
            "camera = { position = [0, 0, 20], look_at = [0, 0, 0], fov = 40, width = 2, height = 2 }\n";
        let file = folder.file("scene.toml", &format!("{camera}{}", scene(keys)));
        let xml = path(&format!("{name}.xml"));
        succeeds(&["export", text(&file), "--mitsuba", text(&xml)]);
        let is_grid = |file: &str| file.starts_with(name) && file.ends_with(".vol");
        let files = std::fs::read_dir(folder.0.path()).unwrap().map(|entry| entry.unwrap());
        let grids: Vec<Vec<u8>> = files
            .filter(|entry| is_grid(entry.file_name().to_str().unwrap()))
            .map(|entry| std::fs::read(entry.path()).unwrap())
            .collect();
        assert_eq!(grids.len(), 1);
        (std::fs::read_to_string(xml).unwrap().replace(name, "NAME"), grids)
    };
    let of_vol = exported("of-vol", &format!("file = \"fog.vol\"{BOX}"));
    for version in 1..=3 {
        for is_double in [false, true] {
            for is_fortran in [false, true] {
                std::fs::write(path("fog.npy"), array(version, is_double, is_fortran)).unwrap();
                for more in ["", ", scale = 0.3", ", interpolation = \"blocks\""] {
                    let [a, b] = ["fog.npy", "fog.vol"]
                        .map(|file| density(&folder, &format!("file = \"{file}\"{BOX}{more}")));
                    let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
                    for _ in 0..200 {
                        let p = DVec3::new(stream.unit(), stream.unit(), stream.unit());
                        let p = corners.0 + (corners.1 - corners.0) * (1.5 * p - 0.25);
                        assert_eq!(
                            a.at(p).to_bits(),
                            b.at(p).to_bits(),
                            "{is_double} {is_fortran} {more} {p}"
                        );
                    }
                }
            }
        }
        assert_eq!(exported("of-npy", &format!("file = \"fog.npy\"{BOX}")), of_vol);
    }
    // The middle of a cell, by hand.
    let middle = corners.0 + (corners.1 - corners.0) * DVec3::new(2.5 / 3.0, 1.5 / 4.0, 3.5 / 5.0);
    let found = density(&folder, &format!("file = \"fog.npy\"{BOX}")).at(middle);
    assert!((found - value(2, 1, 3)).abs() < 1e-12, "{found}");
    let said =
        succeeds(&["check", text(&folder.file("s.toml", &scene(&format!("file = \"fog.npy\"{BOX}"))))]);
    assert!(said.contains("grid of 3 x 4 x 5 samples"), "{said}");
}

#[test]
fn wrong_arrays() {
    let folder = Folder::new();
    let file = folder.file("scene.toml", &scene(&format!("file = \"fog.npy\"{BOX}")));
    let right = array(1, false, false);
    let start = right.len() - 240;
    let refuse = |bytes: &[u8], words: &str| {
        std::fs::write(folder.0.path().join("fog.npy"), bytes).unwrap();
        refuses_naming(&["check", text(&file)], &["fog.npy", words]);
    };
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = right.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let of = |descr: &str, shape: &str| npy(1, &header(descr, "False", shape), &[0; 240]);
    refuse(b"", "ends after 0 bytes, within its header");
    refuse(b"VOL\x03aaaaaaaaaa", "does not begin as a NumPy array");
    refuse(&changed(6, &[9]), "NumPy array of version 9.0; allowed: 1, 2 and 3");
    refuse(&right[..40], "ends after 40 bytes, within its header of");
    refuse(&right[..start + 239], "239 bytes follow its header; allowed: 240, which it states");
    refuse(&[&right[..], b"\n"].concat(), "241 bytes follow its header; allowed: 240, which it states");
    for kind in [">f4", ">f8", "|O", "<f2", "<i4", "|u1", "<c8", "=f4", "f4"] {
        let words = format!("has numbers of type '{kind}'; allowed: '<f4' and '<f8', little endian");
        refuse(&of(&format!("'{kind}'"), "(3, 4, 5)"), &words);
    }
    refuse(&of("[('a', '<f4')]", "(3, 4, 5)"), "has records; allowed: numbers of type '<f4' or '<f8'");
    refuse(&of("'<f4'", "(60,)"), "has 1 axes; allowed: 3, along x, y and z");
    refuse(&of("'<f4'", "()"), "has 0 axes");
    refuse(&of("'<f4'", "(3, 4, 5, 1)"), "has 4 axes");
    refuse(&of("'<f4'", "(3, 0, 5)"), "samples along y are 0; allowed: 1 to 1048576");
    refuse(&of("'<f4'", "(1099511627776, 1, 1)"), "samples along x are 1099511627776");
    refuse(&of("'<f4'", "(1048576, 1048576, 1)"), "1048576 x 1048576 x 1 samples; allowed: up to 1073741824");
    refuse(&of("'<f4'", "(1048576, 1048576, 1048576)"), "allowed: up to 1073741824");
    refuse(&of("'<f4'", "(1024, 1024, 1024)"), "240 bytes follow its header; allowed: 4294967296");
    refuse(&of("'<f4'", "(3, -4, 5)"), "`-` in the header's dictionary");
    refuse(&of("'<f4'", "(3, '4', 5)"), "a `shape` of other things than whole numbers");
    refuse(&of("'<f4'", "12"), "no tuple `shape`");
    refuse(&npy(1, "{'descr': '<f4', 'shape': (3, 4, 5)}", &[0; 240]), "no truth `fortran_order`");
    refuse(&npy(1, "{'fortran_order': False, 'shape': (3, 4, 5)}", &[0; 240]), "no type `descr`");
    refuse(&npy(1, &"[".repeat(1000), &[0; 240]), "too deep");
    refuse(&npy(1, "\u{0}", &[0; 240]), "in the header's dictionary");
    refuse(b"\x93NUMPY\x02\x00\xff\xff\xff\xff", "has a header of 4294967295 bytes; allowed: up to 1048576");
    // Element [0, 1, 2] is the eighth.
    for (value, words) in [
        (-1.0, "element [0, 1, 2] is -1; allowed: at least 0"),
        (f32::NAN, "element [0, 1, 2] is NaN"),
        (f32::INFINITY, "element [0, 1, 2] is inf"),
    ] {
        refuse(&changed(start + 28, &value.to_le_bytes()), words);
    }
    let mut double = array(1, true, false);
    let at = double.len() - 480 + 56;
    double[at..at + 8].copy_from_slice(&1e39f64.to_le_bytes());
    refuse(&double, "element [0, 1, 2] is 1e39; allowed: at least 0, and what single precision holds");
    std::fs::remove_file(folder.0.path().join("fog.npy")).unwrap();
    refuses_naming(&["check", text(&file)], &["fog.npy: No such file"]);
    std::fs::create_dir(folder.0.path().join("fog.npy")).unwrap();
    refuses_naming(&["check", text(&file)], &["fog.npy: a folder, a device or a pipe; allowed: a file"]);
    for keys in ["", ", min = [0, 0, 0]", ", scale = 2"] {
        let file = folder.file("scene.toml", &scene(&format!("file = \"fog.npy\"{keys}")));
        refuses_naming(
            &["check", text(&file)],
            &["fog.npy without min and max, which a NumPy array does not state; allowed: both"],
        );
    }
}

/// What headers are made of.
const SIGNS: &[u8] = b"0123456789(),'[]{}:TF <>fO\n";

/// Whatever stands in a file is a grid or a refusal.
#[test]
fn arrays_of_any_bytes_are_grids_or_refused() {
    let folder = Folder::new();
    let path = folder.0.path().join("any.npy");
    let right = array(1, false, true);
    let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..3000 {
        let mut bytes = right.clone();
        for _ in 0..1 + stream.index(3) {
            let at = stream.index(bytes.len());
            match stream.index(3) {
                0 => bytes[at] = stream.index(256) as u8,
                1 => bytes.truncate(at.max(1)),
                _ => bytes.insert(at, SIGNS[stream.index(SIGNS.len())]),
            }
        }
        std::fs::write(&path, bytes).unwrap();
        match Grid::read_npy(&path, (DVec3::ZERO, DVec3::ONE)) {
            Ok(grid) => {
                assert!(grid.high().is_finite());
                read += 1;
            }
            Err(error) => {
                assert_eq!(error.to_string().lines().count(), 1, "{error}");
                refused += 1;
            }
        }
    }
    assert!(read > 100 && refused > 1000, "{read} {refused}");
}
