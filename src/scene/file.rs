//! scene files
/// x
pub struct SceneFile;
/// x
pub struct Parameters;
