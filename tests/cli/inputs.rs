//! Files that a scene is read from are never written over, by whatever option.

use crate::{Folder, refuses_naming, succeeds, text};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What each file of a folder holds.
fn held(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    files.map(|file| (file.clone(), std::fs::read(file).unwrap())).collect()
}

#[test]
fn files_of_a_scene_are_not_written_over() {
    let folder = Folder::new();
    let at = |name: &str| folder.0.path().join(name);
    // A texture, a grid, a mesh, and a name for a scene that a picture may have.
    succeeds(&[
        "render",
        "fogbox",
        "-o",
        text(&at("paint.exr")),
        "--with",
        "paths",
        "--samples",
        "1",
        "--width",
        "4",
    ]);
    std::fs::remove_file(at("paint.exr")).unwrap();
    folder.grid("fog.vol", 1.0);
    folder.file(
        "room-object-0.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    );
    let scene = r#"camera = { position = [0, 0, 4], look_at = [0, 0, 0], fov = 40, width = 4, height = 4 }
[[regions]]
shape = { cuboid = { min = [0, 0, 0], max = [1, 1, 1] } }
sigma_t = 1
albedo = 0.5
g = 0
density = { grid = { file = "fog.vol" } }
[[objects]]
shape = { mesh = { file = "room-object-0.ply", at = [0, 0, -2] } }
surface = { lambertian = { reflectance = 0.5 } }
[[objects]]
shape = { rectangle = { corner = [-1, -1, -1], u = [2, 0, 0], v = [0, 2, 0] } }
surface = { lambertian = { reflectance = { image = { file = "paint.png" } } } }
[[lights]]
point = { position = [0, 0, 3], power = 1 }
[[sensors]]
name = "box"
measure = { mean-fluence = { min = [0, 0, 0], max = [1, 1, 1], cells = [2, 2, 2] } }
"#;
    let room = folder.file("room.toml", scene);
    // What is exported without a note.
    let plain = scene.replace(r#"{ image = { file = "paint.png" } }"#, "0.5");
    let plain = folder.file("plain.toml", plain.split("[[sensors]]").next().unwrap());
    let disguised = folder.file("room.exr", scene);
    let xml = folder.file(
        "in.xml",
        "<scene version='3.0.0'><integrator type='volpath'/><include filename='more.xml'/>
            <shape type='ply'><string name='filename' value='in-mesh-0.ply'/><bsdf type='diffuse'/></shape><emitter type='constant'/></scene>",
    );
    folder.file("more.xml", "<scene version='3.0.0'></scene>");
    std::fs::copy(at("room-object-0.ply"), at("in-mesh-0.ply")).unwrap();
    std::fs::copy(at("room-object-0.ply"), at("other.ply")).unwrap();
    let (none, set) =
        (at("none.exr"), format!("objects.0.shape.mesh.file={:?}", at("other.ply").display().to_string()));
    let kept = held(folder.0.path());
    let render = ["--with", "paths", "--samples", "1"];
    let measure = ["--with", "paths", "--samples", "100"];
    let map = ["--which", "medium", "--photons", "100"];
    for (command, file, more, option, output) in [
        ("render", &room, &render[..], "-o", "paint.exr"),
        ("render", &disguised, &render, "-o", "room.exr"),
        ("render", &room, &["--progressive", "--maps", "2", "-o", text(&none)], "--state", "fog.vol"),
        ("measure", &room, &measure, "--vol", "fog.vol"),
        ("measure", &xml, &["--set", &set, "--with", "paths"], "--out", "other.ply"),
        ("measure", &room, &measure, "--out", "room-object-0.ply"),
        ("measure", &room, &measure, "--npy", "room.toml"),
        ("map", &room, &map, "--ply", "room-object-0.ply"),
        ("map", &room, &map, "--npy", "fog.vol"),
        ("map", &room, &map, "-o", "paint.png"),
        ("export", &plain, &[], "--mitsuba", "room.xml"),
        ("import", &xml, &[], "-o", "in.toml"),
        ("measure", &xml, &measure, "--out", "more.xml"),
    ] {
        let output = at(output);
        let arguments = [&[command, text(file)], more, &[option, text(&output)]].concat();
        refuses_naming(&arguments, &["a file of the scene", "allowed: another"]);
        assert!(held(folder.0.path()) == kept, "{arguments:?}");
    }
    // By way of a link too, which is told.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(at("fog.vol"), at("link.vol")).unwrap();
        let link = at("link.vol");
        let arguments = [&["measure", text(&room)], &measure[..], &["--vol", text(&link)]].concat();
        refuses_naming(&arguments, &["link.vol, which is ", "fog.vol, a file of the scene"]);
        std::fs::remove_file(link).unwrap();
        assert!(held(folder.0.path()) == kept);
    }
}
