//! Normals of smooth meshes: between corners, where they cannot be, in files, and what a ball of glass makes of them.

use crate::support::scenes::{dielectric, faceted_ball, point_light, sphere};
use glam::DVec3;
use std::path::Path;
use turbid::Spectrum;
use turbid::geometry::{Mesh, Shape};
use turbid::math::{Ray, warp};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Interior, Object, Scene, SceneFile, SceneParts};
use turbid::transport::{Roulette, Step, Visitor, Walker, walk};

fn stream() -> Stream {
    Stream::new(1, Purpose::Synthetic, 0, 0)
}

/// An ellipsoid's gradient, in ever finer triangles: the interpolated normal is wrong by the square of their size, the triangle's
/// own by the size. On a ball it is exact.
#[test]
fn normals_tend_to_the_exact_one() {
    let axes = DVec3::new(1.0, 0.6, 1.5);
    let worst = |times: u32| {
        let Shape::Mesh(ball) = faceted_ball(DVec3::ZERO, 1.0, times, true) else { unreachable!() };
        let triangles: Vec<[DVec3; 3]> = (0..ball.len() as u32).map(|i| ball.triangle(i)).collect();
        let positions: Vec<DVec3> = triangles.iter().flatten().map(|p| *p * axes).collect();
        let numbers: Vec<[u32; 3]> = (0..ball.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let normals: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|p| p / axes)).collect();
        let body = Mesh::smooth(&positions, &numbers, None, &normals).unwrap();
        let mut stream = stream();
        let mut worst = [0.0f64; 3];
        for _ in 0..2000 {
            let dir = warp::square_to_sphere(stream.pair()).normalize();
            let ray = Ray::new(DVec3::ZERO, dir);
            let found = body.hit(&ray, None).unwrap();
            let exact = (ray.at(found.t) / (axes * axes)).normalize();
            let round = ball.hit(&ray, None).unwrap();
            let off =
                [found.shading.distance(exact), found.normal.distance(exact), round.shading.distance(dir)];
            worst = [0, 1, 2].map(|i| worst[i].max(off[i]));
        }
        worst
    };
    let [coarse, fine] = [worst(3), worst(4)];
    assert!((3.0..5.0).contains(&(coarse[0] / fine[0])), "{coarse:?} {fine:?}");
    assert!((1.6..2.4).contains(&(coarse[1] / fine[1])), "{coarse:?} {fine:?}");
    assert!(fine[0] < 0.1 * fine[1] && fine[2] < 1e-14, "{fine:?}");
}

/// Where a ray leaves, after it was refracted twice and reflected never.
fn through(scene: &Scene, ray: Ray) -> DVec3 {
    struct Exit(Option<DVec3>);
    impl Visitor for Exit {
        fn visit(&mut self, walker: &Walker, step: Step, _stream: &mut Stream) {
            if let Step::Escaped(_) = step {
                // Three flights: to the ball, through it, and away.
                self.0 = (walker.events == 3).then_some(walker.ray.dir);
            }
        }
    }
    (0..)
        .find_map(|history| {
            let mut stream = Stream::new(2, Purpose::Synthetic, 0, history);
            let mut exit = Exit(None);
            let start = Walker::new(ray, Spectrum::ONE);
            walk(scene, start, Roulette::below(0.0), None, &mut stream, &mut exit);
            exit.0
        })
        .unwrap()
}

/// Rays through a ball of glass of 2048 triangles leave as through the exact one, ten times as nearly where the normals are
/// interpolated as where they are not (root mean square).
#[test]
fn glass_turns_rays_as_a_ball_does() {
    let scene = |shape: Shape| {
        Scene::new(SceneParts {
            interiors: vec![
                Interior::surroundings(),
                Interior { name: "glass".into(), index: 1.5, medium: None },
            ],
            objects: vec![Object { shape, surface: dielectric(1, 0) }],
            lights: vec![point_light(DVec3::splat(9.0), Spectrum::ONE)],
            ..SceneParts::default()
        })
        .unwrap()
    };
    let exact = scene(sphere(DVec3::ZERO, 1.0));
    let [flat, smooth] = [false, true].map(|is_smooth| scene(faceted_ball(DVec3::ZERO, 1.0, 4, is_smooth)));
    let mut stream = stream();
    let mut sums = [0.0; 2];
    for _ in 0..500 {
        let p = 0.8 * warp::square_to_sphere(stream.pair());
        let ray = Ray::new(DVec3::new(p.x, p.y, -3.0), DVec3::Z);
        let expected = through(&exact, ray);
        for (sum, scene) in sums.iter_mut().zip([&flat, &smooth]) {
            *sum += through(scene, ray).distance_squared(expected) / 500.0;
        }
    }
    let [flat, smooth] = sums.map(f64::sqrt);
    assert!(smooth < 0.1 * flat && smooth > 0.0, "{flat} {smooth}");
}

/// Normals that are 0 or not finite, or lie on both sides, leave a triangle flat; all behind it they are turned.
#[test]
fn what_cannot_be_interpolated_is_flat() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let shading = |normals: [DVec3; 3]| {
        let mesh = Mesh::smooth(&corners, &[[0, 1, 2]], None, &[normals]).unwrap();
        let found = mesh.hit(&Ray::new(DVec3::new(0.25, 0.25, 1.0), DVec3::NEG_Z), None).unwrap();
        assert_eq!(found.normal, DVec3::Z);
        found.shading
    };
    let slant = DVec3::new(1.0, 0.0, 2.0);
    assert!(shading([slant, slant * 1e300, slant * 1e-300]).distance(slant.normalize()) < 1e-15);
    assert!(shading([-slant; 3]).distance(slant.normalize()) < 1e-15);
    for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::X, -slant] {
        assert_eq!(shading([slant, bad, slant]), DVec3::Z, "{bad}");
    }
    let said = Mesh::smooth(&corners, &[[0, 1, 2]], None, &[]).unwrap_err().to_string();
    assert_eq!(said, "a smooth mesh needs three normals for every triangle");
}

fn scene(folder: &Path, keys: &str) -> Result<Scene, String> {
    let text = format!(
        "[[lights]]\npoint = {{ position = [9, 9, 9], power = 1 }}\n[[objects]]\nshape = {{ mesh = {{ {keys} }} }}\nsurface = \"black\"\n"
    );
    let file = SceneFile::from_toml(&text).map_err(|e| e.to_string())?;
    assert_eq!(SceneFile::from_toml(&file.to_toml().unwrap()).unwrap(), file);
    file.scene(folder).map_err(|e| e.to_string())
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                   property float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
                   property list uchar int vertex_indices\nend_header\n\
                   0 0 0 0 0.6 0.8\n1 0 0 0 0.6 0.8\n0 1 0 0 0.6 0.8\n3 0 1 2\n";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nf 1//1 2//-1 3//1\n";

/// Normals of both kinds of files are read where the scene asks, and turn with the body; written meshes have them.
#[test]
fn files_have_normals() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a.ply", PLY), ("a.obj", OBJ)] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let shading = |more: &str, from: DVec3, dir: DVec3| {
            let scene = scene(folder.path(), &format!("file = \"{name}\"{more}")).unwrap();
            scene.objects()[0].shape.hit(&Ray::new(from, dir), None).unwrap().shading
        };
        let above = DVec3::new(0.2, 0.2, 1.0);
        for flat in ["", ", normals = \"flat\""] {
            assert_eq!(shading(flat, above, DVec3::NEG_Z), DVec3::Z);
        }
        let expected = DVec3::new(0.0, 0.6, 0.8);
        let smooth = ", normals = \"smooth\", scale = 2";
        // The numbers of the PLY file are of single precision.
        assert!(shading(smooth, above, DVec3::NEG_Z).distance(expected) < 1e-7);
        let turned = format!("{smooth}, rotate = {{ axis = [1, 0, 0], degrees = 90 }}, at = [0, 0, 1]");
        let found = shading(&turned, DVec3::new(0.2, -3.0, 1.2), DVec3::Y);
        assert!(found.distance(DVec3::new(0.0, -0.8, 0.6)) < 1e-7, "{found}");
        let same = |p: DVec3| p;
        let mesh = Mesh::read(&folder.path().join(name), same, Some(&same)).unwrap();
        std::fs::write(folder.path().join("again.ply"), mesh.to_ply()).unwrap();
        let again = Mesh::read(&folder.path().join("again.ply"), same, Some(&same)).unwrap();
        assert!(again.is_smooth() && again.normals(0)[1].distance(mesh.normals(0)[1]) < 1e-15);
    }
}

/// Wrong normals are one line where they are asked for, and passed over where they are not.
#[test]
fn wrong_normals_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("a.obj", OBJ.replace("0 3 4", "0 nan 4"), "a.obj:4: `nan` is not a finite number"),
        ("a.obj", OBJ.replace("0 3 4", "0 3"), "a.obj:4: a normal `vn` of 2 numbers; allowed: x y z"),
        ("a.obj", OBJ.replace("3//1", "3//2"), "a face names vn 2; allowed: 1 to 1, or -1 to -1"),
        ("a.obj", OBJ.replace("//-1", "").replace("//1", ""), "has none at its corners"),
        ("a.ply", PLY.replacen("0.6", "inf", 1), "the normal of vertex 0 is not finite"),
        ("a.ply", PLY.replace("float nz", "float mz"), "has none at its corners"),
    ];
    for (name, text, expected) in cases {
        std::fs::write(folder.path().join(name), text).unwrap();
        let said = scene(folder.path(), &format!("file = \"{name}\", normals = \"smooth\"")).unwrap_err();
        assert!(said.contains(expected) && !said.contains('\n'), "{said}");
        scene(folder.path(), &format!("file = \"{name}\"")).unwrap();
    }
    // One corner without: a flat triangle.
    std::fs::write(folder.path().join("a.obj"), OBJ.replace("3//1", "3")).unwrap();
    scene(folder.path(), "file = \"a.obj\", normals = \"smooth\"").unwrap();
    let said = scene(folder.path(), "file = \"a.obj\", normals = \"round\"").unwrap_err();
    assert!(said.contains("flat") && said.contains("smooth"), "{said}");
}
