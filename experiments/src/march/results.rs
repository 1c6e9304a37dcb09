//! What the maps say of each case.

use super::cases::Case;
use crate::prediction::Compared;

/// One case with everything that is known of it; errors as fractions of the exact radiance.
pub type CaseResult = Compared<Case>;
