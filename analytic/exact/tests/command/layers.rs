//! `exact layers`: what it answers, and what it refuses.

use crate::cli::{exact, refused, stdout};

#[test]
fn layers_are_answered_in_fluxes_fluence_and_radiance() {
    let args = ["layers", "--layer", "tau=0.5,albedo=0.9,g=0.75", "--layer", "tau=1.5,albedo=0.9,g=0.75"];
    // Two layers alike are the slab of van de Hulst's table 35.
    let text = stdout(exact().args(args).args(["--depth", "0", "2", "--mu", "0.1,-0.5", "--format", "csv"]));
    for part in ["reflectance", "0.0973946386", "0.6609577001", "mean_fluence", "flux_down", "radiance"] {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    let other = stdout(exact().args(args).args(["--method", "ordinates"]));
    assert!(other.contains("0.0973946386") && other.contains("discrete ordinates in layers"), "{other}");
    // All that is the same temperature is uniform.
    let furnace = [
        "layers",
        "--layer",
        "tau=1,albedo=0.75,emission=1",
        "--layer",
        "tau=3,albedo=0.5,phase=rayleigh,emission=2",
    ];
    let text = stdout(exact().args(furnace).args([
        "--ground",
        "0.5",
        "--exitance",
        "0.5",
        "--mu0",
        "diffuse",
        "--depth",
        "1",
    ]));
    assert!(text.contains("4.0000000000"), "{text}");
}

#[test]
fn plates_are_answered_with_their_specular_parts() {
    let glass = ["--layer", "tau=0,albedo=0,index=1.5"];
    let tissue = ["--layer", "tau=2,albedo=0.9,index=1.4"];
    let text = stdout(exact().arg("layers").args(glass).args(tissue).args(glass).args(["--format", "csv"]));
    for part in ["specular,,0.0400000", "reflectance_direct", "reflectance_diffuse", "clear plate index 1.5"]
    {
        assert!(text.contains(part), "{text} lacks {part}");
    }
    // Paint without a gap of air under glass, and a mirror that keeps half of the light.
    let ground = ["--ground", "0.8", "--ground-index", "1.5"];
    let text = stdout(exact().arg("layers").args(glass).args(ground).args(["--mu0", "diffuse"]));
    // Saunderson's correction of 0.8: 0.0918 + 0.9082 0.4037 0.8/(1 - 0.5963 0.8).
    assert!(text.contains("0.6526"), "{text}");
    let text = stdout(exact().arg("layers").args(glass).args(["--ground", "mirror=0.5"]));
    assert!(text.contains("ground = mirror 0.5"), "{text}");
}

#[test]
fn mistakes_name_layer_and_parameter() {
    let layer = ["layers", "--layer", "tau=1,albedo=0.5"];
    for (more, parts) in [
        (&["--layer", "tau=1,albedo=1.5"][..], &["layer 2: albedo is 1.5; allowed: 0 to 1"][..]),
        (&["--layer", "tau=0,albedo=1"], &["layer 2: tau is 0"]),
        (&["--layer", "tau=1e-9,albedo=1,emission=1"], &["layer 2: tau is", "emits"]),
        (&["--layer", "tau=1,albedo=1,moments=/nowhere"], &["layer 2", "/nowhere", "No such file"]),
        (&["--layer", "tau=1,colour=1"], &["'colour=1'; allowed: tau=T"]),
        (&["--layer", "tau=1,g=0"], &["no albedo"]),
        (&["--layer", "tau=1,tau=2,albedo=1"], &["said twice"]),
        (&["--ground", "1.5"], &["ground is 1.5; allowed: 0 to 1"]),
        (&["--ground", "snow"], &["ground is 'snow'", "mirror"]),
        (&["--ground", "mirror", "--exitance", "1"], &["--exitance is 1"]),
        (&["--ground", "mirror=2"], &["mirror is 2; allowed: 0 to 1"]),
        (&["--ground", "mirrors"], &["ground is 'mirrors'"]),
        (&["--ground-index", "9"], &["--ground-index: index is 9; allowed: 0.25 to 4"]),
        (&["--layer", "tau=1,albedo=1,index=0"], &["layer 2: index is 0"]),
        (&["--layer", "tau=0,albedo=0.5,index=1.5"], &["layer 2: tau is 0", "clear plate"]),
        (&["--mu0", "0"], &["mu0 is 0"]),
        (&["--mu0", "up"], &["mu0 is 'up'", "none"]),
        (&["--depth", "1.5"], &["t is 1.5"]),
        (&["--mu", "0"], &["mu is 0"]),
        (&["--mu", "1", "--method", "ordinates"], &["--mu: adding"]),
    ] {
        refused(exact().args(layer).args(more).assert(), parts);
    }
}
