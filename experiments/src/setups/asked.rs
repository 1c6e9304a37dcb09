//! What is asked of a scene once is asked once a study, not once a cell.

use std::sync::{Mutex, PoisonError};
use turbid::photons::check_end;
use turbid::scene::Scene;

/// The scene, with the answer whether its light ends, which takes histories, from an equal scene where there has been one.
pub fn asked(scene: Scene) -> Scene {
    static SCENES: Mutex<Vec<Scene>> = Mutex::new(Vec::new());
    let mut scenes = SCENES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = scenes.iter().find(|known| **known == scene) {
        return known.clone();
    }
    // The scene keeps the answer; whoever follows photons in it is told.
    let _ = check_end(&scene);
    scenes.push(scene.clone());
    scene
}
