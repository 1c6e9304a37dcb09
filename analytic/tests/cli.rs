//! The command `exact`: whole tables, single questions, and every way of asking wrongly.
#![allow(clippy::unwrap_used, reason = "tests")]

use assert_cmd::Command;
use std::collections::HashMap;
use std::io::Write;
use std::process::Stdio;

fn exact() -> Command {
    Command::new(env!("CARGO_BIN_EXE_exact"))
}

fn reference(name: &str) -> String {
    format!("{}/tests/reference/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn rows(text: &[u8]) -> Vec<HashMap<String, String>> {
    csv::Reader::from_reader(text).deserialize().map(|r| r.unwrap()).collect()
}

/// Every row of a table within 10^-(digits-1), its bound as small as promised and covering the deviation but for the table's last digits.
fn whole_table(name: &str, count: usize, promised: f64) {
    let path = reference(name);
    let output = exact().args(["--cases", &path]).assert().success().get_output().stdout.clone();
    let table = rows(&std::fs::read(&path).unwrap());
    let answers = rows(&output);
    assert_eq!((table.len(), answers.len()), (count, count));
    for (row, answer) in table.iter().zip(&answers) {
        assert_eq!(row["id"], answer["id"]);
        assert!(!answer["value"].is_empty(), "{answer:?}");
        let number = |text: &str| text.parse::<f64>().unwrap();
        let (want, digits) = (number(&row["value"]), number(&row["digits"]));
        let (got, error) = (number(&answer["value"]), number(&answer["error"]));
        let off = (got - want).abs();
        assert!(off <= libm::pow(10.0, 1.0 - digits) * want.abs(), "{answer:?} {want}");
        // The table's own last digits; 14 printed digits of a kernel's value may be half a unit off.
        let last = 2.0 * libm::pow(10.0, -digits) * want.abs();
        assert!(off <= error + last, "{answer:?} {want} off by {off:e}");
        assert!(error < promised * want.abs().max(1.0), "{answer:?}");
    }
}

#[test]
fn the_table_of_slabs_is_reproduced() {
    whole_table("slab_iso.csv", 223, 1e-12);
}

#[test]
fn the_table_of_anisotropic_slabs_is_reproduced() {
    whole_table("slab_hg_flux.csv", 208, 1e-9);
}

#[test]
fn an_anisotropic_slab_is_answered_in_fluxes_and_fluence() {
    let ask = |more: &[&str]| {
        let args = ["slab", "--tau", "2", "--albedo", "0.9", "--g", "0.75", "--depth", "1"];
        exact().args(args).args(more).assert()
    };
    let output = ask(&[]).success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    for part in ["9.7394638671", "6.609577001631", "1.2617229665303", "fluence t=1"] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    refused(ask(&["--mu", "1"]), &["g is 0.75", "allowed with --mu"]);
    refused(exact().args(["slab", "--tau", "2", "--albedo", "1", "--g", "0.995"]).assert(), &["g is 0.995"]);
}

#[test]
fn the_table_of_kernels_is_reproduced() {
    whole_table("kernel.csv", 51, 1e-12);
}

/// A file that lives as long as the handle.
fn file(text: &str) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
    file.write_all(text.as_bytes()).unwrap();
    file
}

const HEAD: &str = "id,geometry,tau,a,w,g,n,mu0,t,r,mu,dphi,extra,quantity\n";

fn cases(text: &str) -> assert_cmd::assert::Assert {
    let file = file(text);
    exact().arg("--cases").arg(file.path()).assert()
}

fn refused(assert: assert_cmd::assert::Assert, parts: &[&str]) {
    let output = assert.code(2).get_output().clone();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.starts_with("error: "), "{text}");
    for part in parts {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    assert!(output.stdout.is_empty());
}

#[test]
fn unanswered_rows_say_why() {
    let text = format!(
        "{HEAD}a,sphere,,1,0.9,0,,,,,,,,R\nb,slab,1,,0.9,0.5,,1,0,,1,,,radiance_up\nc,slab,1,,0.9,0,1.5,1,,,,,,R\n\
         d,slab,1,,0.9,0,,1,,,,,,colour\ne,slab,1,,0.9,0,,1,,,,,order=0,T_total\n"
    );
    let output = cases(&text).success().get_output().stdout.clone();
    let answers = rows(&output);
    for (answer, note) in
        answers.iter().zip(["geometry sphere", "anisotropic", "refracting", "quantity colour"])
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
        cases(&format!("{HEAD}a,slab,1,,1.5,0,,1,,,,,,R\n")),
        &[".csv:2", "albedo is 1.5; allowed: 0 to 1"],
    );
    refused(
        cases(&format!("{HEAD}a,slab,1,,0.5,0,,1,,,,,,R\nb,slab,x,,0.5,0,,1,,,,,,R\n")),
        &[".csv:3", "tau is 'x'"],
    );
    refused(cases(&format!("{HEAD}a,slab,1,,0.5,0,,up,,,,,,R\n")), &[".csv:2", "mu0 is 'up'", "diffuse"]);
    refused(cases(&format!("{HEAD}a,slab,1,,0.5,0,,1,2,,,,,fluence\n")), &[".csv:2", "t is 2"]);
    refused(
        cases(&format!("{HEAD}a,kernel,,,,,,,,,,,kernel=round;d=3,m2\n")),
        &[".csv:2", "kernel is 'round'"],
    );
    refused(cases(&format!("{HEAD}a,slab,1\n")), &[".csv"]);
}

#[test]
fn single_questions_are_answered_in_a_table() {
    let output = exact()
        .args([
            "slab", "--tau", "2", "--albedo", "0.9", "--mu0", "diffuse", "--depth", "0", "1", "--mu", "-0.5",
            "0",
        ])
        .args(["--order", "0", "2"])
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    let text = String::from_utf8(output).unwrap();
    assert!(text.starts_with("quantity"), "{text}");
    assert!(
        text.contains("fluence t=1") && text.contains("radiance t=1 mu=-0.5") && text.contains("order=2")
    );
    assert!(text.contains("Peierls equation, residual bound"));
    let output = exact()
        .args(["kernel", "--kernel", "uniform", "--gradient", "0.4", "--depth", "-0.5"])
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    let text = String::from_utf8(output).unwrap();
    assert!(text.contains("1.01609169996405") && text.contains("1.5625e-1"), "{text}");
}

#[test]
fn mistakes_on_the_command_line_are_one_line_and_code_2() {
    refused(
        exact().args(["slab", "--tau", "-1", "--albedo", "0.5"]).assert(),
        &["tau is -1; allowed: 1e-12 to 400"],
    );
    refused(exact().args(["slab", "--tau", "1", "--albedo", "nan"]).assert(), &["albedo is NaN"]);
    refused(
        exact().args(["slab", "--tau", "1", "--albedo", "0.5", "--depth", "3"]).assert(),
        &["t is 3; allowed: 0 to tau"],
    );
    // What cannot be parsed at all: the argument, what it got and what is allowed.
    refused(exact().args(["slab", "--tau", "1"]).assert(), &["required", "--albedo"]);
    refused(exact().args(["slab", "--tau", "x", "--albedo", "0.5"]).assert(), &["'x'", "--tau"]);
    refused(exact().args(["slab", "--tua", "1"]).assert(), &["'--tua'"]);
    refused(exact().args(["kernel", "--kernel", "square"]).assert(), &["square"]);
    refused(exact().arg("kernel").assert(), &["--kernel"]);
    refused(exact().arg("sphere").assert(), &["'sphere'"]);
    refused(exact().arg("--cases").assert(), &["--cases"]);
    refused(exact().assert(), &["nothing asked; allowed: --cases FILE.csv, slab, kernel"]);
}

#[test]
fn help_says_physics_and_units() {
    let output = exact().arg("--help").assert().success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    for word in ["mean free paths", "irradiance", "steradian", "--cases"] {
        assert!(text.contains(word), "{text}");
    }
    let version = exact().arg("--version").assert().success().get_output().clone();
    assert_eq!(version.stdout, format!("exact {}\n", env!("CARGO_PKG_VERSION")).into_bytes());
    assert!(version.stderr.is_empty());
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
