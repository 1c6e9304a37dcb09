//! The command `exact`: whole tables, single questions, and every way of asking wrongly.

use assert_cmd::Command;
use std::collections::HashMap;
use std::io::Write;
use std::process::Stdio;

pub fn exact() -> Command {
    Command::new(env!("CARGO_BIN_EXE_exact"))
}

fn reference(name: &str) -> String {
    format!("{}/../tests/reference/{name}", env!("CARGO_MANIFEST_DIR"))
}

pub fn rows(text: &[u8]) -> Vec<HashMap<String, String>> {
    csv::Reader::from_reader(text).deserialize().map(|r| r.unwrap()).collect()
}

#[test]
fn an_anisotropic_slab_is_answered_in_fluxes_fluence_and_radiance() {
    let args = ["slab", "--tau", "2", "--albedo", "0.9", "--g", "0.75", "--depth", "0", "--mu", "0.1"];
    let text = stdout(exact().args(args));
    // van de Hulst's table 35, and a radiance of another program.
    for part in ["0.097394638671", "0.660957700163", "0.04234949792"] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    refused(
        exact().args(args).args(["--order", "1", "--method", "peierls"]).assert(),
        &["g=0.75", "peierls"],
    );
    refused(exact().args(["slab", "--tau", "2", "--albedo", "1", "--g", "1.5"]).assert(), &["g is 1.5"]);
}

pub fn stdout(command: &mut Command) -> String {
    String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap()
}

/// A file that lives as long as the handle.
pub fn file(text: &str) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
    file.write_all(text.as_bytes()).unwrap();
    file
}

pub const HEAD: &str = "id,geometry,tau,a,w,g,n,mu0,t,r,mu,dphi,extra,quantity\n";

fn cases(text: &str) -> assert_cmd::assert::Assert {
    let file = file(text);
    exact().arg("--cases").arg(file.path()).assert()
}

pub fn refused(assert: assert_cmd::assert::Assert, parts: &[&str]) {
    let output = assert.code(2).get_output().clone();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("exact: error: ") && text.matches("os error").count() < 2, "{text}");
    for part in parts {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    assert!(output.stdout.is_empty());
}

/// Lists that begin with a negative number are lists, with commas as with blanks.
#[test]
fn lists_begin_with_negative_numbers_too() {
    let asked = |words: &str| {
        let run = exact().args(words.split(' ')).assert().success();
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let slab = "slab --tau 1 --albedo 0.5 --format csv --mu ";
    let blanks = asked(&format!("{slab}-1 -0.2 0.5"));
    assert_eq!(blanks.lines().filter(|line| line.contains("radiance")).count(), 3, "{blanks}");
    for list in ["-1,-0.2,0.5", "-1,-.2,.5", "-1,-0.2 0.5", "-1 -0.2,0.5"] {
        assert_eq!(asked(&format!("{slab}{list}")), blanks, "{list}");
    }
    refused(exact().args("slab --tau 1 --albedo 0.5 --mu -1,x".split(' ')).assert(), &["-1"]);
}

#[test]
fn unanswered_rows_say_why() {
    let text = format!(
        "{HEAD}a,cylinder,,1,0.9,0,,,,,,,,R\nb,slab,1,,0.9,0.5,,1,0,,1,,,flow\nc,slab,1,,0.9,0,,1,,,,,phase=fog,R\n\
         d,slab,1,,0.9,0,,1,,,,,,colour\ne,slab,1,,0.9,0,,1,,,,,order=0,T_total\n"
    );
    let output = cases(&text).success().get_output().stdout.clone();
    let answers = rows(&output);
    for (answer, note) in
        answers.iter().zip(["geometry cylinder", "here; allowed: R, ", "phase function", "quantity colour"])
    {
        assert!(answer["value"].is_empty() && answer["note"].contains(note), "{answer:?}");
    }
    let direct: f64 = answers[4]["value"].parse().unwrap();
    assert!((direct - libm::exp(-1.0)).abs() < 1e-15);
}

#[test]
fn single_scattering_of_any_phase_function_is_answered() {
    let text = format!("{HEAD}a,slab,1,,0.9,0.75,,1,0,,1,0,order=1,radiance_up\n");
    let output = cases(&text).success().get_output().stdout.clone();
    // Straight back: p = (1-g)/(4 pi (1+g)^2), I = albedo p (1 - e^-2)/2.
    let p = 0.25 / (4.0 * std::f64::consts::PI * 1.75 * 1.75);
    let want = 0.9 * p * -libm::expm1(-2.0) / 2.0;
    let got: f64 = rows(&output)[0]["value"].parse().unwrap();
    assert!((got / want - 1.0).abs() < 1e-14, "{got} {want}");
}

#[test]
fn mistakes_in_a_table_name_file_line_and_parameter() {
    refused(
        exact().args(["--cases", "/nowhere/at/all.csv"]).assert(),
        &["/nowhere/at/all.csv", "No such file"],
    );
    refused(cases("id,tau\n"), &[".csv:1", "no column 'geometry'"]);
    refused(
        cases(&format!("{HEAD}a,slab,1,,0.5,0,,1,,,,,,R\nb,slab,x,,0.5,0,,1,,,,,,R\n")),
        &[".csv:3", "tau is 'x'"],
    );
    refused(cases(&format!("{HEAD}a,slab,1,,0.5,0,,up,,,,,,R\n")), &[".csv:2", "mu0 is 'up'", "diffuse"]);
    refused(
        cases(&format!("{HEAD}a,kernel,,,,,,,,,,,kernel=round;d=3,m2\n")),
        &[".csv:2", "kernel is 'round'"],
    );
    refused(cases(&format!("{HEAD}a,slab,1\n")), &[".csv:2: 3 cells; allowed: 14"]);
}

#[test]
fn a_row_out_of_range_costs_no_other_row() {
    let text = format!(
        "{HEAD}a,slab,1,,1.5,0,,1,,,,,,R\nb,slab,1,,0.5,0,,1,,,,,,R\nc,slab,1,,0.5,0,,1,2,,,,,fluence\n\
         d,slab,nan,,0.5,0,,1,,,,,,R\n"
    );
    let output = cases(&text).code(2).get_output().clone();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(error.contains(".csv:2: albedo is 1.5; allowed: 0 to 1 (and 2 more"), "{error}");
    let answers = rows(&output.stdout);
    assert_eq!(answers.len(), 4);
    for (answer, note) in answers.iter().zip(["albedo is 1.5", "", "t is 2; allowed", "tau is NaN"]) {
        assert!(
            answer["note"].starts_with(note) && answer["value"].is_empty() != note.is_empty(),
            "{answer:?}"
        );
    }
}

#[test]
fn single_questions_are_answered_in_a_table() {
    let slab = [
        "slab", "--tau", "2", "--albedo", "0.9", "--mu0", "diffuse", "--depth", "0", "1", "--mu", "-0.5", "0",
    ];
    let text = stdout(exact().args(slab).args(["--order", "0", "2"]));
    assert!(
        text.starts_with("slab: tau = 2, albedo = 0.9, phase = isotropic, mu0 = diffuse\nquantity"),
        "{text}"
    );
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows[1], ["quantity", "t", "mu", "order", "value", "error", "unit", "how", "known"]);
    assert!(rows.iter().any(|row| row[..3] == ["radiance", "1", "-0.5"]), "{text}");
    assert!(rows.iter().any(|row| row[..3] == ["fluence_of_order", "1", "2"]), "{text}");
    assert!(text.contains("Peierls equation, residual bound"));
    let text =
        stdout(exact().args(["kernel", "--kernel", "uniform", "--gradient", "0.4", "--depth", "-0.5"]));
    assert!(text.contains("1.0160916999640") && text.contains("0.15625000000000"), "{text}");
}

/// The same question in three forms; CSV and JSON keep every bit.
#[test]
fn csv_and_json_say_the_same() {
    let ask = |format: &str| {
        let args = ["slab", "--tau", "1", "--albedo", "0.9", "--mu0", "0.5", "--depth", "0.3", "--mu", "0.7"];
        stdout(exact().args(args).args(["--format", format]))
    };
    let table = rows(ask("csv").as_bytes());
    let object: serde_json::Value = serde_json::from_str(&ask("json")).unwrap();
    assert_eq!(object["problem"], "slab");
    assert_eq!(object["parameters"]["tau"], 1.0);
    assert_eq!(object["parameters"]["phase"], "isotropic");
    let values = object["values"].as_array().unwrap();
    assert_eq!((table.len(), values.len()), (8, 8));
    for (row, value) in table.iter().zip(values) {
        assert_eq!((row["tau"].as_str(), row["albedo"].as_str(), row["mu0"].as_str()), ("1", "0.9", "0.5"));
        assert_eq!(row["quantity"], value["quantity"].as_str().unwrap());
        assert_eq!(row["method"], value["method"].as_str().unwrap());
        for name in ["value", "error"] {
            let bits = row[name].parse::<f64>().unwrap().to_bits();
            assert_eq!(bits, value[name].as_f64().unwrap().to_bits());
        }
        for name in ["t", "mu"] {
            assert_eq!(row[name].parse().ok(), value.get(name).and_then(serde_json::Value::as_f64));
        }
    }
    let radiance = &table[7];
    assert_eq!(
        (radiance["quantity"].as_str(), radiance["t"].as_str(), radiance["mu"].as_str()),
        ("radiance", "0.3", "0.7")
    );
}

#[test]
fn tables_of_cases_come_in_three_forms_too() {
    let file = file(&format!("{HEAD}a,slab,1,,0.9,0,,diffuse,,,,,,R\nb,slab,1,,0.9,0,,1,,,,,,colour\n"));
    let ask = |format: &str| stdout(exact().arg("--cases").arg(file.path()).args(["--format", format]));
    let table = rows(ask("csv").as_bytes());
    assert_eq!(
        (table[0]["tau"].as_str(), table[0]["mu0"].as_str(), table[0]["note"].as_str()),
        ("1", "diffuse", "")
    );
    assert!(table[1]["value"].is_empty() && table[1]["note"].contains("colour"));
    let list: serde_json::Value = serde_json::from_str(&ask("json")).unwrap();
    assert_eq!(
        list[0]["value"].as_f64().unwrap().to_bits(),
        table[0]["value"].parse::<f64>().unwrap().to_bits()
    );
    assert_eq!((&list[0]["w"], &list[0]["mu0"]), (&0.9.into(), &"diffuse".into()));
    assert!(list[1]["value"].is_null() && list[1]["note"].as_str().unwrap().contains("colour"));
    assert!(ask("table").lines().next().unwrap().starts_with("id"));
}

#[test]
fn files_appear_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    let ask = |more: &[&str]| exact().args(["slab", "--tau", "1", "--albedo", "0.9"]).args(more).assert();
    let (out, svg, png) = (place("a.json"), place("a.svg"), place("a.png"));
    let done = ask(&["--out", &out, "--plot", &svg, "--format", "json"]).success();
    assert!(done.get_output().stdout.is_empty());
    let object: serde_json::Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    assert_eq!(object["values"].as_array().unwrap().len(), 5);
    let drawn = std::fs::read_to_string(&svg).unwrap();
    well_formed(&drawn);
    assert!(drawn.contains("Slab τ = 1, albedo 0.9") && drawn.contains("Depth t [mean free paths]"));
    ask(&["--plot", &png]).success();
    assert!(std::fs::read(&png).unwrap().starts_with(b"\x89PNG\r\n\x1a\n"));
    // A failure leaves what was there, and nothing beside it.
    std::fs::write(&out, "old").unwrap();
    let count = || std::fs::read_dir(folder.path()).unwrap().count();
    let before = count();
    refused(ask(&["--out", &out, "--depth", "7"]), &["t is 7"]);
    refused(
        ask(&["--out", &out, "--plot", &place("b.pdf")]),
        &["--plot", "b.pdf", "allowed", ".svg or .png"],
    );
    refused(ask(&["--out", &out, "--plot", &place("nowhere/b.svg")]), &["cannot write", "nowhere/b.svg"]);
    refused(ask(&["--plot", &svg, "--out", &place("nowhere/b.csv")]), &["cannot write", "nowhere/b.csv"]);
    refused(ask(&["--out", &svg, "--plot", &svg]), &["--plot", "a.svg", "--out too"]);
    refused(ask(&["--out", folder.path().to_str().unwrap()]), &["cannot write", "it is a folder"]);
    assert_eq!((std::fs::read_to_string(&out).unwrap().as_str(), count()), ("old", before));
    let table = place("cases.csv");
    std::fs::write(&table, HEAD).unwrap();
    refused(exact().args(["--cases", &table, "--out", &table]).assert(), &["--out", "--cases too"]);
    refused(exact().args(["--cases", &table, "--plot", &svg]).assert(), &["--plot", "without --cases"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said() {
    let ask = ["slab", "--tau", "1", "--albedo", "0.9"];
    refused(exact().args(ask).args(["--out", "/dev/full"]).assert(), &["cannot write /dev/full", "No space"]);
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output =
        std::process::Command::new(env!("CARGO_BIN_EXE_exact")).args(ask).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("cannot write to standard output: No space"));
}

/// Tags that open are closed, in order.
fn well_formed(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, text) = tag.split_once('>').unwrap();
        assert!(!text.contains('>') && !tag.contains('&') || tag.contains("&amp;"), "{tag} {text}");
        let name = |t: &str| t.split_whitespace().next().unwrap().to_string();
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(closed), "{tag}");
        } else if !tag.ends_with('/') && !tag.starts_with(['?', '!']) {
            open.push(name(tag));
        }
    }
    assert!(open.is_empty() && svg.trim_end().ends_with("</svg>"));
}

/// Every command states its equation, source and ranges, and that its lengths are mean free paths or in radii.
#[test]
fn every_command_explains_itself() {
    let help = stdout(exact().arg("--help"));
    let commands = help.split_once("Commands:\n").unwrap().1.split_once("\n\n").unwrap().0;
    let mut count = 0;
    for line in commands.lines().filter(|line| !line.trim_start().starts_with("help")) {
        let command = line.split_whitespace().next().unwrap();
        let text = stdout(exact().args([command, "--help"]));
        let physics = text.split("Usage:").next().unwrap();
        for part in ["Source: ", " = "] {
            assert!(physics.contains(part), "{command}: {text} lacks '{part}'");
        }
        let options = text.split("Usage:").nth(1).unwrap();
        assert!(
            options.contains(" to ") && options.contains("--format") && options.contains("--plot"),
            "{text}"
        );
        let length =
            ["mean free path", "radii", "unit", "pass", "radius"].iter().any(|unit| text.contains(unit));
        assert!(length, "{command}: no unit of length");
        count += 1;
    }
    assert_eq!(count, 19, "{help}");
}

#[test]
fn mistakes_on_the_command_line_are_one_line_and_code_2() {
    refused(
        exact().args(["slab", "--tau", "-1", "--albedo", "0.5"]).assert(),
        &["tau is -1; allowed: 1e-12 to 1e9"],
    );
    refused(exact().args(["slab", "--tau", "1", "--albedo", "nan"]).assert(), &["albedo is NaN"]);
    refused(
        exact().args(["slab", "--tau", "1", "--albedo", "0.5", "--depth", "3"]).assert(),
        &["t is 3; allowed: 0 to tau"],
    );
    // What cannot be parsed at all: the argument, what it got and what is allowed.
    refused(exact().args(["slab", "--tau", "1"]).assert(), &["required", "--albedo"]);
    refused(exact().args(["slab", "--tau", "x", "--albedo", "0.5"]).assert(), &["'x'", "--tau"]);
    let whole = "allowed: a whole number, 0 to 4294967295";
    refused(
        exact().args(["slab", "--tau", "1", "--albedo", ""]).assert(),
        &["--albedo", "allowed: a number"],
    );
    for k in ["-1", "1e3", "", "1.5", "99999999999"] {
        refused(exact().args(["nearest", "--k", k]).assert(), &["--k", whole]);
    }
    refused(exact().args(["slab", "--tua", "1"]).assert(), &["'--tua'"]);
    refused(exact().args(["kernel", "--kernel", "square"]).assert(), &["square"]);
    refused(exact().arg("kernel").assert(), &["--kernel"]);
    refused(exact().arg("cylinder").assert(), &["'cylinder'"]);
    refused(exact().arg("--cases").assert(), &["--cases"]);
    refused(exact().assert(), &["nothing asked; allowed: --cases FILE.csv, slab, ", "kernel"]);
}

/// What is wrong with a parameter of any command is said in one line that names it, with its value and its range.
#[test]
fn every_command_names_the_parameter_that_is_wrong() {
    for (args, parts) in [
        ("slab --tau 1e300 --albedo 0.9 --g 0.5", ["tau is 1", "allowed"]),
        ("slab --tau 1 --albedo 0.9 --depth 2", ["t is 2", "0 to tau"]),
        ("slab --tau 1 --albedo 0.9 --g 0.5 --mu 1.5", ["mu is 1.5", "-1 to 1"]),
        ("slab --tau 1 --albedo 0.9 --g 0.5 --mu 1 --azimuth inf", ["dphi is inf", "allowed"]),
        ("slab --tau 1 --albedo 0.9 --g 0.5 --g2 0.1 --share 2", ["share is 2", "0 to 1"]),
        ("slab --tau 1 --albedo 0.9 --g 0.5 --rayleigh", ["--g", "--rayleigh"]),
        ("slab --tau 1 --albedo 0.9 --order 1001", ["order is 1001", "0 to 1000"]),
        ("slab --tau 1 --albedo 0.9 --index 0", ["index is 0", "allowed"]),
        ("slab --tau 1 --albedo 0.9 --index 1.5 --mu 1", ["--index is 1.5", "allowed with --mu"]),
        ("slab --tau 1 --albedo 0.9 --g 0.5 --method peierls", ["g=0.5", "isotropic"]),
        (
            "slab --tau 1 --albedo 0.9 --method magic",
            ["magic", "allowed: auto, peierls, ordinates, doubling"],
        ),
        ("slab --tau 1 --albedo 0.9 --moments nowhere.txt", ["nowhere.txt", "No such file"]),
        ("thick --albedo 0.01", ["albedo is 0.01", "0.1 to 1"]),
        ("two-stream --tau 1 --albedo 0.9 --g 1", ["g is 1", "allowed"]),
        ("half-space --albedo 1.1", ["albedo is 1.1", "0 to 1"]),
        ("half-space --albedo 0.9 --g 0.5 --milne", ["g=0.5", "isotropic"]),
        ("half-space --albedo 0.9 --mu 1e300", ["mu is 1", "0 to 1"]),
        ("xy --tau 0 --albedo 0.9", ["tau is 0", "1e-12"]),
        ("sphere --radius -1 --albedo 0.9", ["radius is -1", "allowed"]),
        ("sphere --radius 1 --albedo 0.9 --source centre --r 0", ["point source", "infinite"]),
        ("cuboid --sides 1,1,0 --albedo 1", ["side is 0", "1e-3 to 20"]),
        ("cuboid --sides 1 --albedo 1", ["--sides has 1", "2 of a duct"]),
        ("cuboid --sides 1,1 --albedo 1 --at 0.5", ["--at has 1", "allowed: 2"]),
        ("cuboid --sides 1,1 --albedo 1 --at 0.5,1.5", ["y is 1.5", "0 to the side"]),
        ("cuboid --sides 1,1 --albedo 1 --at 0.5,left", ["at is '0.5,left'", "numbers"]),
        ("emitting-cube --at 0.5,0.5,2", ["z is 2", "0 to 1"]),
        ("emitting-cube --peak 11 --at 0.5,0.5,0.5", ["peak is 11", "0 to 10"]),
        ("emitting-cube --at 0.5,0.5", ["--at has 2", "allowed: 3"]),
        ("nested --source x=0:1,y=0:1,z=0:1 --at 1,1", ["--at has 2", "allowed: 3"]),
        (
            "nested --source x=0:1e-9,y=0:1,z=0:1 --at 0,0.5,0.5",
            ["relative bound is", "too thin for a place so close"],
        ),
        ("nested --source x=0:1,y=0:1 --at 1,1,1", ["an extent is missing", "z=A:B"]),
        ("nested --source x=0:1,y=0:1,z=1:1 --at 1,1,1", ["no volume", "extents that rise"]),
        ("nested --source x=0:1,y=0:1,z=0:1,extinction=1 --at 1,1,1", ["extinction is that of", "allowed"]),
        (
            "nested --cuboid x=0:1,y=0:1,z=0:1 --source x=0:1,y=0:1,z=0:1 --at 1,1,1",
            ["no extinction", "allowed"],
        ),
        ("nested --source x=-1:1,y=0:1,z=0:1 --mirror x --at 1,1,1", ["is -1", "0 (the mirror)"]),
        ("nested --source x=0:1,y=0:1,z=0:1 --mirror w --at 1,1,1", ["mirror is 'w'", "x, y and z"]),
        ("cavity --wall-albedo 1", ["cavity", "absorbs nothing"]),
        ("critical --secondaries 1", ["secondaries is 1", "1 + 1e-12"]),
        ("path --shape cuboid --size 1", ["--size has 1", "3 for cuboid"]),
        ("path --shape cuboid --size 1 1 1 --albedo 0.5", ["--albedo is 0.5", "sphere and slab"]),
        ("infinite --albedo 0.9 --r 0", ["r is 0", "1e-12"]),
        ("kernel --kernel uniform --gradient 1e9", ["x is 1", "-500 to 500"]),
        ("beams --radius 0", ["radius is 0", "1e-60"]),
        ("nearest --k 1", ["k is 1", "2 to 1e6"]),
        ("progressive --alpha 0", ["alpha is 0", "above 0"]),
        ("boundary --radius nan", ["radius is NaN", "1e-12"]),
    ] {
        refused(exact().args(args.split(' ')).assert(), &parts);
    }
}

#[test]
fn moments_come_from_a_file() {
    let given = |text: &str| {
        let file = tempfile::NamedTempFile::with_suffix(".txt").unwrap();
        std::fs::write(file.path(), text).unwrap();
        file
    };
    let ask = ["slab", "--tau", "1", "--albedo", "0.9", "--format", "csv"];
    let rayleigh = stdout(exact().args(ask).arg("--rayleigh"));
    let file = given("# Rayleigh\n1, 0\n0.1\n");
    let by_file = stdout(exact().args(ask).arg("--moments").arg(file.path()));
    let values = |text: &str| rows(text.as_bytes()).iter().map(|r| r["value"].clone()).collect::<Vec<_>>();
    assert_eq!(values(&rayleigh), values(&by_file));
    let bad = given("1\n0.5\nx\n");
    refused(
        exact().args(ask).arg("--moments").arg(bad.path()).assert(),
        &[".txt:3", "chi_2 is 'x'", "-1 to 1"],
    );
    let negative = given("1 -1 -1");
    refused(
        exact().args(ask).arg("--moments").arg(negative.path()).assert(),
        &["phase function", "0 or more"],
    );
    refused(
        exact().args(ask).arg("--moments").arg(given("").path()).assert(),
        &["moments is 0", "1 to 2000"],
    );
}

/// The second method gives the same within both bounds.
#[test]
fn doubling_is_asked_by_name() {
    let ask = |method: &str| {
        let args = "slab --tau 1 --albedo 0.9 --g 0.5 --mu0 0.5 --depth 0.5 --mu 0.5 --azimuth 1 --format csv --method";
        rows(stdout(exact().args(args.split(' ')).arg(method)).as_bytes())
    };
    let (first, second) = (ask("ordinates"), ask("doubling"));
    let mut count = 0;
    for row in &first {
        let Some(other) = second.iter().find(|r| r["quantity"] == row["quantity"]) else {
            assert_eq!(row["quantity"], "flux");
            continue;
        };
        let number = |r: &HashMap<String, String>, name: &str| r[name].parse::<f64>().unwrap();
        let off = (number(row, "value") - number(other, "value")).abs();
        assert!(off <= number(row, "error") + number(other, "error"), "{row:?} {other:?}");
        count += 1;
    }
    assert_eq!(count, 7);
}

#[test]
fn help_says_physics_and_units() {
    let output = exact().arg("--help").assert().success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    for word in ["mean free paths", "irradiance", "steradian", "--cases", "--format", "--out", "--plot"] {
        assert!(text.contains(word), "{text}");
    }
    let version = exact().arg("--version").assert().success().get_output().clone();
    assert_eq!(version.stdout, format!("exact {}\n", env!("CARGO_PKG_VERSION")).into_bytes());
    assert!(version.stderr.is_empty());
}

/// A table as editors and spreadsheets write it: a mark in front, ends of line of two characters, quotes.
#[test]
fn tables_of_other_programs_are_read() {
    let row = "\"a, b\",\"slab\",1,,0.9,0,,1,,,,,,R\n";
    let plain = cases(&format!("{HEAD}{row}")).success().get_output().stdout.clone();
    let marked = cases(&format!("\u{feff}{HEAD}{row}").replace('\n', "\r\n"));
    assert_eq!(marked.success().get_output().stdout, plain);
    assert_eq!(rows(&plain)[0]["id"], "a, b");
}

/// Isotropic scattering by a table of its phase function, and by commas in place of blanks.
#[test]
fn phase_functions_are_read_from_tables() {
    let table = file("\u{feff}# cosine, value\n-1, 3\n0 3\n1;3\n");
    let ask = [
        "slab",
        "--tau",
        "1",
        "--albedo",
        "0.9",
        "--method",
        "ordinates",
        "--depth",
        "0,0.5",
        "--format",
        "csv",
    ];
    let values = |output: Vec<u8>| -> Vec<f64> {
        rows(&output).iter().map(|row| row["value"].parse().unwrap()).collect()
    };
    let isotropic = values(exact().args(ask).output().unwrap().stdout);
    let read = values(exact().args(ask).arg("--table").arg(table.path()).output().unwrap().stdout);
    assert_eq!(read.len(), 9);
    assert!(read.iter().zip(&isotropic).all(|(a, b)| (a - b).abs() < 1e-12), "{read:?} {isotropic:?}");
    for (text, part) in [
        ("", "allowed: 2 or more"),
        ("-1,1\n0\n1,1\n", ".csv:2: '0'; allowed: cosine,value"),
        ("-1,1\n0.5,1\n0,1\n1,1\n", "cosine is 0; allowed: in rising order"),
        ("-1,1\n1,-1\n", "value is -1; allowed: 0 to 1e100"),
    ] {
        let table = file(text);
        refused(exact().args(ask).arg("--table").arg(table.path()).assert(), &[part]);
    }
}

/// Values that laws know, for what is asked of estimates: best k and radii, walls, corners, chords, walks.
#[test]
fn what_the_library_knows_can_be_asked() {
    let value = |words: &str, quantity: &str, nth: usize| -> f64 {
        let output = exact().args(words.split_whitespace()).args(["--format", "csv"]).output().unwrap();
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        let rows = rows(&output.stdout);
        rows.iter().filter(|row| row["quantity"] == quantity).nth(nth).unwrap()["value"].parse().unwrap()
    };
    for (words, quantity, nth, want) in [
        // Flat: 1/(k-2), no bias.
        ("nearest --k 50 --curvature 0", "relative_mean_squared_error", 0, 1.0 / 48.0),
        // r^7 = 3 B/(4 A^2), A = c/10, B = 3/(4 pi).
        (
            "beams --curvature -0.2",
            "optimum_radius",
            0,
            libm::pow(1125.0 / (4.0 * std::f64::consts::PI) * 5.0, 1.0 / 7.0),
        ),
        ("boundary --body cuboid --size 2,3,4 --radius 1 --depth 0 --corner", "mean_uniform", 0, 0.125),
        ("boundary --body cuboid --size 2 --radius 1 --depth 0", "mean_uniform", 0, 0.5),
        // Half the ball sees the field in front, half that behind: (1 + 3)/2.
        ("boundary --depth 0 --behind 3", "mean_at_wall", 0, 2.0),
        ("boundary --depth 0 --behind 3", "mean_at_wall", 9, 1.0),
        ("path --shape slab --size 2 --chord 4", "chord_density", 0, 0.125),
        ("infinite --albedo 0.9 --g 0.5 --scatterings 1", "mean_square_distance", 0, 5.0),
        ("infinite --albedo 0 --wave 1", "transform", 0, std::f64::consts::FRAC_PI_4),
        ("half-space --albedo 0.75", "h_moment", 0, 4.0 / 3.0),
        ("sphere --radius 2 --albedo 0.5 --source centre", "escape_direct", 0, libm::exp(-2.0)),
    ] {
        let got = value(words, quantity, nth);
        assert!((got - want).abs() < 1e-12 * want, "{words}: {quantity} {got} {want}");
    }
    // What enters a denser body cannot all leave: n^2 (1 - r_inside) = 1 - r_outside.
    let index = "slab --tau 1 --albedo 0.9 --index 1.5";
    let (out, inside) =
        (value(index, "face_reflectance_outside", 0), value(index, "face_reflectance_inside", 0));
    assert!((2.25 * (1.0 - inside) - (1.0 - out)).abs() < 1e-13);
}

/// Every row of every answer has a unit, in every form.
#[test]
fn every_value_has_a_unit() {
    for (words, quantity, unit) in [
        ("slab --tau 1 --albedo 0.9 --depth 1 --mu 0", "radiance", "irradiance/sr"),
        ("half-space --albedo 0.9 --milne --depth 1", "fluence", "exitance"),
        ("half-space --albedo 0.9 --milne", "extrapolation_length", "mfp"),
        ("sphere --radius 1 --albedo 0.9 --r 0.5", "fluence", "power/mfp^2"),
        ("sphere --radius 1 --albedo 0.9 --source incident --r 0.5", "fluence", "irradiance"),
        ("infinite --albedo 0.9 --r 1", "decay", "1/mfp"),
        ("critical --secondaries 1.5", "size", "mfp"),
        ("cavity --wall-albedo 0.5", "irradiance_centre", "power/length^2"),
        ("kernel --kernel uniform", "m2", "radius^2"),
    ] {
        let ask = |form: &str| stdout(exact().args(words.split_whitespace()).args(["--format", form]));
        let table = rows(ask("csv").as_bytes());
        assert!(table.iter().all(|row| !row["unit"].is_empty()), "{words}");
        let row = table.iter().find(|row| row["quantity"] == quantity).unwrap();
        assert_eq!(row["unit"], unit, "{words}");
        let object: serde_json::Value = serde_json::from_str(&ask("json")).unwrap();
        let same = object["values"]
            .as_array()
            .unwrap()
            .iter()
            .any(|v| v["quantity"] == quantity && v["unit"] == unit);
        assert!(same && ask("table").contains(unit), "{words}");
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_exact"))
        .args(["--cases", &reference("slab_iso.csv")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Closed long before the table is solved.
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{:?}", output.status);
    assert!(output.stderr.is_empty());
}
