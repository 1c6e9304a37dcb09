//! Photons in files: what `map` writes, what `measure` reads of it and of other programs' files, and what it refuses.

use crate::{Folder, refuses, refuses_naming, succeeds, text, turbid};
use std::path::{Path, PathBuf};

/// A ball of fog with a lamp beside it, which is read in every way that maps answer.
const BALL: &str = "[[regions]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\nsigma_t = [2, 3, 4]\nalbedo = 0.8\ng = 0.5\n\
    [[lights]]\npoint = { position = [0.2, 0, 2], power = [1, 2, 3] }\n\
    [[sensors]]\nname = \"middle\"\nmeasure = { fluence = { at = [0, 0, 0.1] } }\n\
    [[sensors]]\nname = \"later\"\nmin_order = 1\nmax_order = 3\nmeasure = { fluence = { at = [0.3, 0, 0] } }\n\
    [[sensors]]\nname = \"along\"\nmeasure = { radiance = { origin = [-3, 0.1, 0], dir = [1, 0, 0.1] } }\n\
    [[sensors]]\nname = \"boxes\"\nmeasure = { mean-fluence = { min = [-0.5, -0.5, -0.5], max = [0.5, 0.5, 0.5], cells = [2, 1, 2] } }\n";

fn at(folder: &Folder, name: &str) -> PathBuf {
    folder.0.path().join(name)
}

/// Standard output of a run that may say notes, and those.
fn run(arguments: &[&str]) -> (String, String) {
    let output = turbid(arguments).output().unwrap();
    let [out, notes] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success(), "{arguments:?}: {notes}");
    (out, notes)
}

/// A column of the rows that maps answer.
fn column(table: &str, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let at = |name: &str| table.lines().next().unwrap().split(',').position(|column| column == name).unwrap();
    let (quantity, at) = (at("quantity"), at(name));
    let is_of_maps =
        |row: &csv::StringRecord| row[quantity].contains("fluence") || row[quantity].contains("radiance");
    reader.records().map(Result::unwrap).filter(is_of_maps).map(|row| row[at].to_string()).collect()
}

/// A column of numbers.
fn numbers(table: &str, name: &str) -> Vec<f64> {
    column(table, name).iter().map(|number| number.parse().unwrap()).collect()
}

/// What is written is what the measurement sends out: the same seed gives the same bits, by both formats, whatever is asked; another
/// seed gives others.
#[test]
fn photons_that_are_written_read_back_to_the_same_bits() {
    let folder = Folder::new();
    let ball = folder.file("ball.toml", BALL);
    let slab = PathBuf::from("slab");
    for (scene, photons) in [(&ball, "8000"), (&slab, "5000")] {
        let (npy, ply) = (at(&folder, "photons.npy"), at(&folder, "photons.ply"));
        let seed = ["--seed", "7"];
        let map = ["map", text(scene), "--photons", photons, "--npy", text(&npy), "--ply", text(&ply)];
        let said = succeeds(&[&map[..], &seed].concat());
        let count: usize = said.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!(count > 1000, "{said}");
        let measure = ["measure", text(scene), "--with", "photons", "--format", "csv"];
        let own = ["--photons", photons, "--maps", "1"];
        for asked in [
            &[][..],
            &["--k", "20", "--kernel", "cone", "--boundary", "none"],
            &["--radius", "0.3", "--kernel", "epanechnikov", "--boundary", "reflection"],
            &["--radius", "0.2", "--boundary", "local-linear", "--orders", "1.."],
        ] {
            let (table, _) = run(&[&measure[..], &own, &seed, asked].concat());
            let expected = column(&table, "mean");
            assert!(expected.len() > 4 && numbers(&table, "mean").iter().all(|mean| *mean > 0.0), "{table}");
            for file in [&npy, &ply] {
                let from = ["--photons-from", text(file)];
                let (table, _) = run(&[&measure[..], &from, &seed, asked].concat());
                assert_eq!(column(&table, "mean"), expected, "{}, {asked:?}", file.display());
            }
        }
        let other = [
            "map",
            text(scene),
            "--which",
            "medium",
            "--photons",
            photons,
            "--npy",
            text(&npy),
            "--seed",
            "8",
        ];
        succeeds(&other);
        let [of_ply, of_npy] =
            [&ply, &npy].map(|file| run(&[&measure[..], &["--photons-from", text(file)]].concat()).0);
        assert_ne!(of_ply, of_npy);
        // Two files are two maps, with an error between them.
        let both = ["--photons-from", text(&ply), "--photons-from", text(&npy)];
        let (table, notes) = run(&[&measure[..], &both].concat());
        assert!(
            column(&table, "n").iter().all(|n| n == "2")
                && numbers(&table, "std_error").iter().all(|e| *e > 0.0),
            "{table}"
        );
        assert_eq!(notes.contains("left out, since photons of a file"), *scene == slab, "{notes}");
        assert_eq!(notes.contains(" reflectance, "), *scene == slab, "{notes}");
    }
}

/// A photon: position, direction, power, order, class.
type Given = ([f64; 3], [f64; 3], [f64; 3], u64, u8);

/// Photons in a cube of fog: two within 0.5 of its middle, the second in blue alone, one beyond.
const GIVEN: [Given; 3] = [
    ([0.25, 0.0, 0.125], [0.0, 0.0, 1.0], [0.5, 0.25, 1.0], 0, 0),
    ([0.0, -0.25, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0], 3, 4),
    ([0.75, 0.0, 0.0], [-1.0, 0.0, 0.0], [8.0, 8.0, 8.0], 1, 4),
];

const CUBE: &str = "[[regions]]\nshape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 1] } }\nsigma_t = [2, 4, 8]\nalbedo = 0.5\ng = 0\n\
    [[lights]]\npoint = { position = [0, 0, 2], power = 1 }\n\
    [[sensors]]\nname = \"middle\"\nmeasure = { fluence = { at = [0, 0, 0] } }\n";

/// As another program may write it: single precision, signed numbers of another size, in another order, a field of its own.
fn npy(photons: &[Given], emitted: Option<u64>) -> Vec<u8> {
    let column = if emitted.is_some() { "('emitted', '<i4'), " } else { "" };
    let count = photons.len();
    npy_of(
        &format!(
            "[('order', '<i8'), ('power', '<f4', (3,)), {column}('depth', '>f2'), ('position', '<f8', (3,)), ('direction', '<f4', (3,))]"
        ),
        &format!("({count},)"),
        photons
            .iter()
            .flat_map(|(position, direction, power, order, _)| {
                let floats =
                    |v: &[f64; 3]| v.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect::<Vec<u8>>();
                let mut record = order.to_le_bytes().to_vec();
                record.extend(floats(power));
                record.extend(emitted.iter().flat_map(|n| (*n as i32).to_le_bytes()));
                record.extend([0, 0]);
                record.extend(position.iter().flat_map(|x| x.to_le_bytes()));
                record.extend(floats(direction));
                record
            })
            .collect(),
    )
}

/// An array with this type and shape; the header in version 2.
fn npy_of(descr: &str, shape: &str, body: Vec<u8>) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x02\x00".to_vec();
    bytes.extend((header.len() as u32).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes.extend(body);
    bytes
}

/// A PLY header: format, lines before the vertices, properties in place of the usual ones.
fn ply_header(format: &str, count: &str, comment: &str, extra: &str) -> String {
    let names = ["x", "y", "z", "dir_x", "dir_y", "dir_z", "power_r", "power_g", "power_b"];
    let floats: String = names.iter().map(|name| format!("property float {name}\n")).collect();
    format!(
        "ply\nformat {format} 1.0\n{comment}element vertex {count}\n{floats}property int order\nproperty uchar class\n{extra}end_header\n"
    )
}

fn ply_text(photons: &[Given], comment: &str) -> Vec<u8> {
    let mut text = ply_header("ascii", &photons.len().to_string(), comment, "");
    for (p, d, w, order, class) in photons {
        let numbers: Vec<String> = [p, d, w].into_iter().flatten().map(f64::to_string).collect();
        text += &format!("{} {order} {class}\n", numbers.join(" "));
    }
    text.into_bytes()
}

fn ply_binary(photons: &[Given], comment: &str) -> Vec<u8> {
    let mut bytes = ply_header("binary_little_endian", &photons.len().to_string(), comment, "").into_bytes();
    for (p, d, w, order, class) in photons {
        bytes.extend([p, d, w].into_iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()));
        bytes.extend((*order as i32).to_le_bytes());
        bytes.push(*class);
    }
    bytes
}

fn write(folder: &Folder, name: &str, bytes: &[u8]) -> PathBuf {
    let path = at(folder, name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Photons of other programs, made byte by byte, give what the definition of the estimate says: the power within the radius over the
/// number emitted, the extinction, and the ball.
#[test]
fn photons_of_others_are_estimates_by_hand() {
    let folder = Folder::new();
    let cube = folder.file("cube.toml", CUBE);
    // Named as they are not: the first bytes count.
    let files = [
        write(&folder, "a.ply", &npy(&GIVEN, Some(4))),
        write(&folder, "b.npy", &ply_text(&GIVEN, "comment emitted 4\n")),
        write(&folder, "c", &ply_binary(&GIVEN, "obj_info none\ncomment by hand\ncomment emitted 4\n")),
    ];
    let without = [
        write(&folder, "d.npy", &npy(&GIVEN, None)),
        write(&folder, "e.ply", &ply_text(&GIVEN, "")),
        write(&folder, "f.ply", &ply_binary(&GIVEN, "")),
    ];
    let lines_of_two =
        String::from_utf8(ply_text(&GIVEN, "comment emitted 4\n")).unwrap().replace('\n', "\r\n");
    let windows = write(&folder, "g.ply", lines_of_two.as_bytes());
    let measure = ["measure", text(&cube), "--with", "photons", "--radius", "0.5", "--format", "csv"];
    let means = |more: &[&str]| -> (Vec<f64>, String, String) {
        let (table, notes) = run(&[&measure[..], more].concat());
        (numbers(&table, "mean"), table, notes)
    };
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.5f64.powi(3);
    let expected = |emitted: f64, powers: [f64; 3]| -> Vec<f64> {
        powers
            .iter()
            .zip([2.0, 4.0, 8.0])
            .map(|(power, sigma_t)| power / (emitted * sigma_t * ball))
            .collect()
    };
    // Sums of a few numbers of single precision.
    let is_close = |a: &[f64], b: &[f64]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs())
    };
    for file in files.iter().chain([&windows]) {
        let (found, table, notes) = means(&["--photons-from", text(file)]);
        assert!(is_close(&found, &expected(4.0, [0.5, 0.25, 3.0])), "{}: {table}", file.display());
        assert!(table.lines().nth(1).unwrap().contains(",,1") && notes.is_empty(), "{table}{notes}");
        let (found, ..) = means(&["--photons-from", text(file), "--orders", "1..3"]);
        assert!(is_close(&found, &expected(4.0, [0.0, 0.0, 2.0])), "{}", file.display());
    }
    for file in &without {
        let (found, ..) = means(&["--photons-from", text(file), "--emitted", "2"]);
        assert!(is_close(&found, &expected(2.0, [0.5, 0.25, 3.0])), "{}", file.display());
        let arguments = [&measure[..], &["--photons-from", text(file)]].concat();
        refuses_naming(&arguments, &["does not say how many photons were emitted", "--emitted N"]);
    }
    // A map of its own each: mean and error of two, the second of which has the first photon alone.
    let second = write(&folder, "second.npy", &npy(&GIVEN[..1], Some(2)));
    let (found, table, _) = means(&["--photons-from", text(&files[0]), "--photons-from", text(&second)]);
    let (a, b) = (expected(4.0, [0.5, 0.25, 3.0]), expected(2.0, [0.5, 0.25, 1.0]));
    let middle: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 0.5 * (a + b)).collect();
    assert!(is_close(&found, &middle), "{table}");
    let errors = numbers(&table, "std_error");
    let half: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 0.5 * (a - b).abs()).collect();
    assert!(is_close(&errors, &half), "{table}");
    // Uncollided light that is missing is told; a file of none is a map without photons.
    let scattered = write(&folder, "scattered.ply", &ply_text(&GIVEN[1..], "comment emitted 4\n"));
    assert!(means(&["--photons-from", text(&scattered)]).2.contains("no photon of order 0"));
    assert!(!means(&["--photons-from", text(&scattered), "--orders", "1.."]).2.contains("of order 0"));
    let empty = write(&folder, "empty.npy", &npy(&[], Some(1)));
    let (found, table, _) = means(&["--photons-from", text(&empty), "--emitted", "5"]);
    assert!(found == [0.0; 3], "{table}");
}

/// Photons as far apart as this, and some about the middle: positions in single precision tell balls of 10^-6 of the extent apart,
/// smaller ones are refused, given or found, whoever sends the photons.
#[test]
fn balls_far_smaller_than_the_map_are_refused() {
    let folder = Folder::new();
    let cube = folder.file("cube.toml", CUBE);
    let placed = |x: f64| -> Given { ([x, 0.0, 0.0], GIVEN[0].1, GIVEN[0].2, 0, 0) };
    let file = |name: &str, near: f64| {
        write(&folder, name, &npy(&[placed(-1.0), placed(near), placed(-1.25 * near), placed(1.0)], Some(4)))
    };
    let (apart, close) = (file("apart.npy", 4e-6), file("close.npy", 4e-7));
    let measure = ["measure", text(&cube), "--with", "photons", "--format", "csv", "--photons-from"];
    let words = "in a map whose photons reach 1.000e0 L from its middle, at positions in single precision; allowed: at least \
                 1.000e-6 L, 10^-6 of that";
    let refused = |file: &Path, how: &[&str], radius: &str| {
        let radius = format!("a gather radius of {radius}");
        refuses_naming(&[&measure[..], &[text(file)], how].concat(), &[&radius, words]);
    };
    for (radius, is_fine) in [("0.5", true), ("1.01e-6", true), ("9.9e-7", false), ("1e-12", false)] {
        match is_fine {
            true => drop(run(&[&measure[..], &[text(&apart), "--radius", radius]].concat())),
            false => refused(&apart, &["--radius", radius], &format!("{radius} L")),
        }
        match is_fine {
            true => drop(run(&[&measure[..], &[text(&apart), "--k", "2", "--max-radius", radius]].concat())),
            false => refused(&apart, &["--k", "2", "--max-radius", radius], &format!("{radius} L")),
        }
    }
    // The second nearest lies at 5e-6, which is far enough, or at 5e-7.
    run(&[&measure[..], &[text(&apart), "--k", "2", "--max-radius", "0.5"]].concat());
    refused(&close, &["--k", "2", "--max-radius", "0.5"], "");
    // The same photons alone are told apart.
    let alone = write(&folder, "alone.npy", &npy(&[placed(4e-7), placed(-5e-7)], Some(4)));
    run(&[&measure[..], &[text(&alone), "--k", "2", "--max-radius", "0.5"]].concat());
    // Our own photons, in numbers and in a picture.
    let ball = folder.file("ball.toml", BALL);
    let own = ["measure", text(&ball), "--with", "photons", "--photons", "1000", "--radius", "1e-7"];
    refuses_naming(&own, &["a gather radius of 1e-7 L in a map whose photons reach", "10^-6 of that"]);
    let picture = at(&folder, "picture.exr");
    let sizes = ["--width", "2", "--height", "2", "--samples", "1", "--global", "1000", "--volume", "1000"];
    let render = ["render", "fogbox", "-o", text(&picture), "--radius", "1e-9"];
    refuses_naming(
        &[&render[..], &sizes].concat(),
        &["map: a gather radius of 1e-9 L in a map whose photons"],
    );
    assert!(!picture.exists());
}

/// In a periodic cell photons anywhere are those of the cell, as our own are.
#[test]
fn positions_wrap_in_a_periodic_cell() {
    let folder = Folder::new();
    let scene = folder.file(
        "slab.toml",
        "cell = 2.0\n[[regions]]\nshape = { slab = { top = -1, thickness = 2 } }\nsigma_t = 1\nalbedo = 0.5\ng = 0\n\
         [[lights]]\nbeam = { dir = [0, 0, 1], irradiance = 1, section = \"unbounded\" }\n\
         [[sensors]]\nname = \"s\"\nmeasure = { fluence = { at = [0.125, 1.75, 0] } }\n",
    );
    let moved = |by: [f64; 2]| {
        let photons = GIVEN.map(|(p, d, w, o, c)| ([p[0] + by[0], p[1] + by[1], p[2]], d, w, o, c));
        let file = write(&folder, "moved.npy", &npy(&photons, Some(4)));
        let measure = ["measure", text(&scene), "--with", "photons", "--radius", "0.5", "--format", "csv"];
        run(&[&measure[..], &["--photons-from", text(&file)]].concat()).0
    };
    let here = moved([0.0, 0.0]);
    // The first two, the second across the edge.
    assert!(numbers(&here, "mean")[0] > 0.0, "{here}");
    for by in [[2.0, 0.0], [-6.0, 2.0], [1024.0, -2048.0]] {
        assert_eq!(moved(by), here);
    }
    assert_ne!(moved([1.0, 0.0]), here);
}

/// What a file may get wrong: one line that names the file, the photon where it is one, and what is allowed.
#[test]
fn files_of_photons_that_cannot_be_read() {
    let folder = Folder::new();
    let cube = folder.file("cube.toml", CUBE);
    let refuse = |name: &str, bytes: &[u8], words: &[&str]| {
        let file = write(&folder, name, bytes);
        let arguments = ["measure", text(&cube), "--with", "photons", "--photons-from", text(&file)];
        refuses_naming(&arguments, &[&[name][..], words].concat());
    };
    let changed = |change: &dyn Fn(&mut Given)| {
        let mut photons = GIVEN;
        change(&mut photons[1]);
        photons
    };
    // Photons.
    type Case<'a> = (&'a dyn Fn(&mut Given), &'a str);
    let cases: [Case; 11] = [
        (&|g| g.0[2] = f64::NAN, "photon 1: position is (0, -0.25, NaN); allowed: finite"),
        (&|g| g.0[0] = f64::INFINITY, "photon 1: position is (inf"),
        (&|g| g.2[1] = -1.0, "photon 1: power is (0, -1, 2); allowed: at least 0"),
        (&|g| g.2[1] = f64::NAN, "photon 1: power is (0, NaN, 2)"),
        (&|g| g.2[1] = f64::INFINITY, "photon 1: power is (0, inf, 2)"),
        (&|g| g.1 = [0.0; 3], "photon 1: direction is (0, 0, 0); allowed: a unit vector"),
        (&|g| g.1[1] = 1.0025, "photon 1: direction is (0, 1.0025"),
        (&|g| g.1[1] = f64::NAN, "photon 1: direction is (0, NaN, 0)"),
        (&|g| g.3 = u64::MAX, "photon 1: order is -1; allowed: whole numbers from 0"),
        (&|g| g.4 = 12, "photon 1: class is 12: it lies on a surface; allowed: photons of media"),
        (&|g| g.4 = 99, "photon 1: class is 99; allowed: whole numbers from 0 to 7"),
    ];
    for (change, words) in cases {
        refuse("bad.ply", &ply_binary(&changed(change), "comment emitted 4\n"), &[words]);
        if !words.contains("class") {
            refuse("bad.npy", &npy(&changed(change), Some(4)), &[words]);
        }
    }
    refuse(
        "half.ply",
        &ply_text(&GIVEN, "comment emitted 4\n")
            .iter()
            .map(|b| if *b == b'3' { b'z' } else { *b })
            .collect::<Vec<_>>(),
        &["line 4: z vertices; allowed: a whole number"],
    );
    let with = |from: &str, to: &str| {
        String::from_utf8(ply_text(&GIVEN, "comment emitted 4\n")).unwrap().replacen(from, to, 1).into_bytes()
    };
    refuse("order.ply", &with(" 3 4\n", " 3.5 4\n"), &["photon 1: order is 3.5; allowed: whole numbers"]);
    refuse("word.ply", &with(" 3 4\n", " three 4\n"), &["photon 1: three in its line; allowed: numbers"]);
    refuse("short.ply", &with(" 3 4\n", " 3\n"), &["photon 1: its line has 10 numbers; allowed: 11"]);
    refuse("long.ply", &with(" 3 4\n", " 3 4 5\n"), &["photon 1: its line has 12 numbers; allowed: 11"]);
    refuse(
        "endless.ply",
        &with(" 3 4\n", &" ".repeat(10_000)),
        &["photon 1: its line has more than 4096 bytes"],
    );
    refuse(
        "more.ply",
        &[&ply_text(&GIVEN, "comment emitted 4\n")[..], b"1 2 3\n"].concat(),
        &["more follows its photons"],
    );
    // Numbers emitted.
    for (number, words) in [
        ("0", "emitted is 0; allowed: whole numbers from 1 to 9e15"),
        ("-3", "emitted is -3"),
        ("1.5", "emitted is 1.5"),
        ("1e16", "emitted is"),
        ("nan", "emitted is NaN"),
        ("many", "emitted is many; allowed: a number"),
    ] {
        refuse(
            "emitted.ply",
            &ply_text(&GIVEN, &format!("comment emitted {number}\n")),
            &["line 3: ", words],
        );
    }
    refuse(
        "twice.ply",
        &ply_text(&GIVEN, "comment emitted 4\ncomment emitted 5\n"),
        &["line 4: emitted for the second time"],
    );
    refuse("emitted.npy", &npy(&GIVEN, Some(0)), &["photon 0: emitted is 0; allowed: whole numbers from 1"]);
    let mut mixed = npy(&GIVEN, Some(4));
    let second = mixed.len() - 2 * 62 + 20;
    mixed[second] = 5;
    refuse(
        "mixed.npy",
        &mixed,
        &["photon 1: is one of 5 emitted, those before it of 4; allowed: the photons of one map"],
    );
    // Headers of PLY.
    let header = |format: &str, count: &str, extra: &str| {
        ply_header(format, count, "comment emitted 4\n", extra).into_bytes()
    };
    refuse(
        "big.ply",
        &header("binary_big_endian", "3", ""),
        &["format is binary_big_endian; allowed: binary_little_endian, ascii"],
    );
    for (format, size) in
        [("binary_little_endian", "of 41 bytes, 5 bytes follow"), ("ascii", "5 bytes follow")]
    {
        for count in ["1099511627776", "18446744073709551615", "1"] {
            let file = [&header(format, count, "")[..], b"12345"].concat();
            refuse("huge.ply", &file, &[&format!("promises {count} photons"), size]);
        }
        refuse("count.ply", &header(format, "-1", ""), &["-1 vertices; allowed: a whole number"]);
        refuse("list.ply", &header(format, "1", "property list uchar int near\n"), &["a vertex has a list"]);
        refuse(
            "type.ply",
            &header(format, "1", "property quad far\n"),
            &["property far is of the unknown type quad"],
        );
    }
    let whole = ply_binary(&GIVEN, "comment emitted 4\n");
    refuse("cut.ply", &whole[..whole.len() - 1], &["promises 3 photons of 41 bytes, 122 bytes follow"]);
    refuse(
        "behind.ply",
        &[&whole[..], b"1"].concat(),
        &["1 bytes follow its 3 photons of 41 bytes; allowed: none"],
    );
    refuse("header.ply", &whole[..100], &["ends after 100 bytes, within its header"]);
    refuse(
        "order.ply",
        &with("property int order\n", "property int ordre\n"),
        &["the property order is missing"],
    );
    refuse(
        "ints.ply",
        &with("property float power_g", "property int power_g"),
        &["power_g is a whole number; allowed: float or double"],
    );
    refuse("first.ply", &with("element vertex", "element face"), &["element face; allowed: vertex first"]);
    refuse(
        "line.ply",
        &with("comment emitted", "remark emitted"),
        &["line 3: `remark emitted 4` is no line of a header"],
    );
    // Headers of NumPy.
    let plain =
        "[('position', '<f8', (3,)), ('direction', '<f8', (3,)), ('power', '<f8', (3,)), ('order', '<u2')]";
    let of = |descr: &str, shape: &str, size: usize| npy_of(descr, shape, vec![0; size]);
    for count in ["1099511627776", "18446744073709551615"] {
        refuse(
            "huge.npy",
            &of(plain, &format!("({count},)"), 148),
            &[&format!("promises {count} photons of 74 bytes, 148 bytes follow")],
        );
    }
    refuse("cut.npy", &of(plain, "(2,)", 147), &["promises 2 photons of 74 bytes, 147 bytes follow"]);
    refuse("behind.npy", &of(plain, "(2,)", 149), &["1 bytes follow its 2 photons"]);
    refuse("axes.npy", &of(plain, "(1, 2)", 148), &["has 2 axes; allowed: one"]);
    refuse(
        "plain.npy",
        &of("'<f8'", "(2,)", 16),
        &["numbers of type '<f8'; allowed: records with the fields position"],
    );
    refuse(
        "big.npy",
        &of(&plain.replacen("'<f8'", "'>f8'", 1), "(2,)", 148),
        &["position is 3 of type '>f8'; allowed: 3 of '<f4' or '<f8'"],
    );
    refuse("two.npy", &of(&plain.replacen("(3,)", "(2,)", 1), "(2,)", 132), &["position is 2 of type '<f8'"]);
    refuse(
        "ints.npy",
        &of(&plain.replacen("'<f8'", "'<i8'", 1), "(2,)", 148),
        &["position is 3 of type '<i8'"],
    );
    refuse(
        "text.npy",
        &of(&plain.replace("'<u2'", "'<U4'"), "(2,)", 176),
        &["order is 1 of type '<U4'; allowed: one number"],
    );
    refuse(
        "odd.npy",
        &of(&plain.replace("'<u2'", "'<q2'"), "(2,)", 148),
        &["order is of the unknown type '<q2'"],
    );
    refuse(
        "none.npy",
        &of(&plain.replace("'order'", "'ordre'"), "(2,)", 148),
        &["the field order is missing"],
    );
    refuse(
        "nested.npy",
        &of(&plain.replace("'<u2'", "[('a', '<u2')]"), "(2,)", 148),
        &["the field order has fields itself"],
    );
    refuse(
        "wide.npy",
        &of(&plain.replacen("(3,)", "(4294967296, 4294967296, 4294967296)", 1), "(2,)", 0),
        &["the field position is too large"],
    );
    let fortran = String::from_utf8_lossy(&of(plain, "(2,)", 0)[12..]).replace("False", "True ");
    let fortran =
        [&b"\x93NUMPY\x02\x00"[..], &(fortran.len() as u32).to_le_bytes(), fortran.as_bytes(), &[0; 148]]
            .concat();
    refuse("fortran.npy", &fortran, &["is in Fortran order; allowed: 'fortran_order': False"]);
    refuse(
        "version.npy",
        b"\x93NUMPY\x09\x00\x00\x00\x00\x00",
        &["NumPy array of version 9.0; allowed: 1, 2 and 3"],
    );
    refuse("long.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\xff", &["has a header of 4294967295 bytes"]);
    refuse("ends.npy", b"\x93NUMPY\x01\x00\xff\xff{", &["ends after 11 bytes, within its header of 65535"]);
    refuse("stub.npy", b"\x93NUM", &["ends after 4 bytes, within its header"]);
    refuse("deep.npy", &npy_of(&"[".repeat(1000), "(2,)", vec![]), &["too deep"]);
    refuse("other.npy", b"\x93NUMXY\x01\x00\x00\x00", &["does not begin as a NumPy array"]);
    for bytes in [&b""[..], b"p", b"plywood\n", b"PK\x03\x04zip"] {
        refuse("other", bytes, &["is neither PLY nor a NumPy array; allowed: photons as .ply or .npy"]);
    }
    assert_eq!(
        std::fs::read_dir(folder.0.path())
            .unwrap()
            .filter(|e| e.as_ref().unwrap().file_name().to_string_lossy().starts_with(".turbid"))
            .count(),
        0
    );
}

/// What is no fault of one photon: files that are not there, of other things, twice, too large; sensors that no map answers; options.
#[test]
fn photons_from_that_cannot_be() {
    let folder = Folder::new();
    let cube = folder.file("cube.toml", CUBE);
    let file = write(&folder, "a.npy", &npy(&GIVEN, Some(4)));
    let measure = ["measure", text(&cube), "--with", "photons", "--photons-from"];
    let refuse = |more: &[&str], words: &[&str]| refuses_naming(&[&measure[..], more].concat(), words);
    refuse(&[text(&at(&folder, "none.npy"))], &["none.npy: cannot read it: No such file"]);
    refuse(&[text(folder.0.path())], &["a folder, a device or a pipe; allowed: a file"]);
    refuse(
        &[text(&file), "--photons-from", text(&file)],
        &["--photons-from names ", " twice; allowed: independent maps"],
    );
    refuse(
        &[text(&file), "--emitted", "4"],
        &["a.npy: says how many photons were emitted; allowed: --emitted only for"],
    );
    refuse(&[text(&file), "--emitted", "0"], &["--emitted", "allowed: whole numbers from 1"]);
    refuse(
        &[text(&file), "--maps", "2"],
        &["--maps says nothing to --photons-from; allowed: with --with photons"],
    );
    refuse(
        &[text(&file), "--photons", "2"],
        &["--photons says nothing to --photons-from; allowed: with --with photons or --with light"],
    );
    refuses_naming(
        &["measure", "slab", "--with", "photons", "--emitted", "3"],
        &["--emitted says nothing to --with photons; allowed: with --photons-from"],
    );
    refuses_naming(
        &["measure", text(&cube), "--with", "light", "--photons-from", text(&file)],
        &["--photons-from says nothing to --with light; allowed: with --with photons"],
    );
    // Twenty gigabytes, none of which is there.
    let many = at(&folder, "many.npy");
    let start = npy_of(
        "[('position', '<f8', (3,)), ('direction', '<f8', (3,)), ('power', '<f8', (3,)), ('order', '<u2'), ('emitted', '<u8')]",
        "(268435456,)",
        vec![],
    );
    std::fs::write(&many, &start).unwrap();
    std::fs::OpenOptions::new()
        .write(true)
        .open(&many)
        .unwrap()
        .set_len(start.len() as u64 + 82 * 268_435_456)
        .unwrap();
    let line = refuses(&[&measure[..], &[text(&many), "--memory", "2G"]].concat());
    assert!(
        line.contains("a map of 268435456 photons takes about")
            && line.contains("allowed: files of at most "),
        "{line}"
    );
    let outflow = "[[sensors]]\nname = \"out\"\nmeasure = { outflow = { shape = { cuboid = { min = [-1, -1, -1], max = [1, 1, 1] } }, face = \"top\" } }\n";
    let tally = folder.file("tally.toml", &format!("{}{outflow}", CUBE.split("[[sensors]]").next().unwrap()));
    let arguments = ["measure", text(&tally), "--with", "photons", "--photons-from", text(&file)];
    refuses_naming(&arguments, &["tally.toml: photons of a file answer none of the sensors (out "]);
}

/// Files of `map`: for any scene, with or without a camera, on any number of threads; what several maps hold is told apart.
#[test]
fn photons_go_into_files() {
    let folder = Folder::new();
    let [npy, ply, png] = ["a.npy", "a.ply", "a.png"].map(|name| at(&folder, name));
    refuses_naming(
        &["map", "slab"],
        &["no file to write; allowed: --output FILE.png, --ply FILE.ply, --npy FILE"],
    );
    refuses_naming(&["map", "slab", "-o", text(&png)], &["no [camera]"]);
    refuses_naming(&["map", "slab", "--npy", text(&npy), "--importance"], &["no [camera]"]);
    refuses_naming(
        &["map", "slab", "--npy", text(&npy), "--ply", text(&ply), "--photons", "1e9", "--memory", "50M"],
        &["photons of media takes about", "allowed: --photons "],
    );
    let scene = folder.file("scene.npy", &succeeds(&["scenes", "slab", "--resolved"]));
    refuses_naming(&["map", text(&scene), "--npy", text(&scene)], &["--npy names a file of the scene"]);
    let both = at(&folder, "b.ply");
    refuses_naming(&["map", "slab", "--npy", text(&both), "--ply", text(&both)], &["lead to one file"]);
    let bytes = |threads: &str| {
        let map = ["map", "slab", "--npy", text(&npy), "--ply", text(&ply), "--photons", "10000"];
        succeeds(&[&map[..], &["--threads", threads]].concat());
        [&npy, &ply].map(|file| std::fs::read(file).unwrap())
    };
    let [one, cloud] = bytes("1");
    assert!([one.clone(), cloud.clone()] == bytes("3"));
    // Every collision is there, those of uncollided light too, which is as much as it meets.
    let header = String::from_utf8_lossy(&one[..256]);
    let count: usize = header.split("'shape': (").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert_eq!(one.len(), 256 + 83 * count);
    let records: Vec<&[u8]> = one[256..].chunks(83).collect();
    let double = |record: &[u8], at: usize| f64::from_le_bytes(record[at..at + 8].try_into().unwrap());
    let uncollided = records.iter().filter(|record| record[72..75] == [0, 0, 0]).count() as f64;
    // Of 10,000 photons, on 2 mean free paths, as many as 1 - exp(-2) collide: within five standard deviations.
    let part = 1.0 - libm::exp(-2.0);
    assert!((uncollided / 1e4 - part).abs() < 5.0 * (part * (1.0 - part) / 1e4).sqrt(), "{uncollided}");
    for record in &records {
        assert!(record[75..83] == 10_000u64.to_le_bytes() && double(record, 16) >= 0.0);
        // The beam of irradiance 1 on a cell of 4 x 4.
        assert!((double(record, 48) - 16.0).abs() < 1e-5, "{}", double(record, 48));
    }
    assert!(String::from_utf8_lossy(&cloud[..300]).contains("\ncomment emitted 10000\n"));
    // Photons on surfaces say so, and cannot be read as those of a medium.
    let map = [
        "map",
        "fogbox",
        "--global",
        "2000",
        "--volume",
        "emit:3000",
        "--ply",
        text(&ply),
        "--npy",
        text(&npy),
    ];
    succeeds(&map);
    let measure = |file: &Path, words: &[&str]| {
        let cube = folder.file("cube.toml", CUBE);
        refuses_naming(&["measure", text(&cube), "--with", "photons", "--photons-from", text(file)], words);
    };
    measure(&npy, &["photon 0: class is ", "it lies on a surface"]);
    measure(&ply, &["photon 0: class is ", "it lies on a surface"]);
    assert!(
        String::from_utf8_lossy(&std::fs::read(&ply).unwrap()[..700]).contains("property double emitted\n")
    );
    succeeds(&["map", "fogbox", "--which", "volume", "--volume", "emit:3000", "--ply", text(&ply)]);
    assert!(String::from_utf8_lossy(&std::fs::read(&ply).unwrap()[..700]).contains("comment emitted 3000\n"));
}

/// Where a phase function is peaked, errors of radiances from few maps come with a warning: here most of the light is brought by photons
/// that 16 maps do not meet.
#[test]
fn few_maps_do_not_tell_tails() {
    let folder = Folder::new();
    let scene = |g: &str, measure: &str| {
        format!(
            "[[regions]]\nshape = {{ sphere = {{ center = [0, 0, 0], radius = 1 }} }}\nsigma_t = 2\nalbedo = 0.9\ng = {g}\n\
             [[lights]]\npoint = {{ position = [2, 2, 1], power = 1 }}\n\
             [[sensors]]\nname = \"s\"\nmeasure = {{ {measure} }}\n"
        )
    };
    let radiance = "radiance = { origin = [0.1, 0.3, 0.1], dir = [-1, -0.1, 0.5] }";
    for (g, measure, maps, is_told) in [
        ("0.9", radiance, "16", true),
        ("-0.9", radiance, "16", true),
        ("0.5", radiance, "16", false),
        ("0.9", radiance, "100", false),
        ("0.9", "fluence = { at = [0.1, 0.3, 0.1] }", "16", false),
    ] {
        let file = folder.file("scene.toml", &scene(g, measure));
        let arguments =
            ["measure", text(&file), "--with", "photons", "--photons", "1000", "--k", "5", "--maps", maps];
        let done = turbid(&arguments).output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(done.status.success(), "{said}");
        assert_eq!(said.contains("peak of a phase function"), is_told, "{g} {measure} {maps}: {said}");
    }
    // Nor one image in each face where the radius is larger than the medium.
    let file = folder.file("scene.toml", &scene("0", "fluence = { at = [0.1, 0.3, 0.1] }"));
    let within = ["measure", text(&file), "--with", "photons", "--photons", "1000", "--radius"];
    for (more, is_told) in [
        (["3", "--boundary", "reflection"], true),
        (["1.9", "--boundary", "reflection"], false),
        (["3", "--boundary", "clipped"], false),
    ] {
        let done = turbid(&[&within[..], &more].concat()).output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(done.status.success(), "{said}");
        assert_eq!(
            said.contains("no images of images: within 3 L of a place in a medium 2 L across"),
            is_told,
            "{said}"
        );
    }
    // Neither do few paths where hardly any turns.
    let fluence = "fluence = { at = [0.1, 0.3, 0.1] }";
    for (g, measure, is_told) in [
        ("0.999", radiance, true),
        ("-0.999", radiance, true),
        ("0.9", radiance, false),
        ("0.999", fluence, false),
    ] {
        let file = folder.file("scene.toml", &scene(g, measure));
        for with in ["paths", "bidirectional"] {
            let done =
                turbid(&["measure", text(&file), "--with", with, "--samples", "1e4"]).output().unwrap();
            let said = String::from_utf8(done.stderr).unwrap();
            assert!(done.status.success(), "{said}");
            assert_eq!(said.contains("--samples 4e5 or more tells"), is_told, "{with} {g} {measure}: {said}");
        }
    }
}

/// Media that fill bodies are media to notes, to advice and to pictures, as those of regions are.
#[test]
fn media_in_bodies_are_told_of_as_regions() {
    let folder = Folder::new();
    let rest = "\n[[lights]]\nisotropic = { shape = { sphere = { center = [0, 0, 0], radius = 2 } }, faces = 'both', radiance = 1 }\n\
         [camera]\nposition = [0, 0, -1.5]\nlook_at = [0, 0, 0]\nfov = 40\nwidth = 8\nheight = 8\n\
         [[sensors]]\nname = 's'\nmeasure = { fluence = { at = [0.05, 0.1, 0] } }\n";
    let shape = "shape = { sphere = { center = [0, 0, 0], radius = 0.3 } }";
    let matter = "sigma_t = 2.0, albedo = 0.9, g = 0.0";
    let region = format!("[[regions]]\n{shape}\n{}{rest}", matter.replace(", ", "\n"));
    let body = format!(
        "interiors = [{{ name = 'milk', index = 1.0, {matter} }}]\n[[objects]]\n{shape}\nsurface = {{ dielectric = {{ inside = 'milk' }} }}{rest}"
    );
    let told = |scene: &str| {
        let file = folder.file("scene.toml", scene);
        let said = |arguments: &[&str]| {
            let done = turbid(&[&[arguments[0], text(&file)], &arguments[1..]].concat()).output().unwrap();
            let said = String::from_utf8(done.stderr).unwrap();
            assert!(done.status.success(), "{said}");
            (String::from_utf8(done.stdout).unwrap(), said)
        };
        let reflected = ["--radius", "0.7", "--boundary", "reflection"];
        let measured =
            said(&[&["measure", "--with", "photons", "--photons", "1000"][..], &reflected].concat());
        assert!(measured.1.contains("in a medium 0.6 L across"), "{}", measured.1);
        let output = folder.0.path().join("picture.exr");
        let rendered =
            said(&["render", "-o", text(&output), "--samples", "1", "--volume", "2000", "--radius", "0.5"]);
        assert!(rendered.1.contains("the smallest medium is 6.00e-1 L across"), "{}", rendered.1);
        let advised = said(&["advise", "--target", "20%", "--pilot", "1e5", "--samples", "100"]).0;
        // As far as the medium's boundary.
        advised.lines().find(|line| line.starts_with("radius")).unwrap().to_owned()
    };
    assert_eq!(told(&region), told(&body));
}
