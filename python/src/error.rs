//! Errors on their way to Python: one exception, one line.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use turbid::output::one_line;

create_exception!(
    turbid,
    Error,
    PyValueError,
    "A request that was refused: what is wrong, and what is allowed."
);

/// The exception of an error with all its contexts.
pub fn refused(error: &anyhow::Error) -> PyErr {
    Error::new_err(one_line(&format!("{error:#}")))
}

/// The exception of a text.
pub fn refuse(text: impl AsRef<str>) -> PyErr {
    Error::new_err(one_line(text.as_ref()))
}
