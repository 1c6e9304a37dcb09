#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]
use turbid::integrators::{Layer, Layers, light_tracing, path};
use turbid::photons::Emitter;
use turbid::rng::{Purpose, Stream};
fn main() {
    let text = std::path::Path::new("/tmp/s/scene.toml");
    let file: turbid::scene::SceneFile = toml::from_str(&std::fs::read_to_string(text).unwrap()).unwrap();
    let scene = file.scene(text.parent().unwrap()).unwrap();
    let camera = scene.camera().unwrap().clone();
    let within = scene.interior_at(camera.position());
    let (w, h) = (camera.width(), camera.height());
    let n: u64 = 40000;
    println!("paths");
    for y in 0..h {
        for x in 0..w {
            if x < 8 || y < 6 {
                continue;
            }
            let mut s = [0.0; 3];
            let mut big = 0.0f64;
            for i in 0..n {
                let mut st = Stream::new(5, Purpose::Paths, 0, ((y * w + x) as u64) << 32 | i);
                let ray = camera.sample(x, y, st.pair());
                let (l, _) = path::layers(&scene, ray, None, within, &mut st);
                for c in 0..3 {
                    s[c] += l[Layer::Direct][c];
                }
                big = big.max(l[Layer::Direct][1]);
            }
            print!("{:9.2e}/{:7.1e}", s[1] / n as f64, big);
        }
        println!();
    }
    println!("light");
    let mut img = vec![[0.0; 3]; (w * h) as usize];
    let e = Emitter::by_power(&scene);
    let m = 20_000_000u64;
    for i in 0..m {
        let mut st = Stream::new(5, Purpose::LightTracing, 0, i);
        light_tracing(&scene, &camera, &e, &mut st, |sp| {
            if sp.layer == Layer::Direct {
                for (p, d) in camera.pixels(sp.at) {
                    for c in 0..3 {
                        img[p][c] += sp.value[c] * d;
                    }
                }
            }
        });
    }
    for y in 6..h {
        for x in 8..w {
            print!("{:9.2e} ", img[(y * w + x) as usize][1] / m as f64);
        }
        println!();
    }
    let _ = Layers::ZERO;
}
