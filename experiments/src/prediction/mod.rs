//! What theory says of a case before it is measured: written down, read again, compared, and entered into the error
//! budget of the study, term by term.

mod compared;
mod error;
mod term;
mod written;

pub use compared::{Compared, amplitude};
pub use error::PredictedError;
pub use term::{Entry, Term};
pub use written::{Prediction, Predictions};
