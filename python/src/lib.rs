//! The Python module `turbid._turbid`: what the package `turbid` asks of the library and of the referee. Arrays cross as bytes
//! of the machine's own order, which NumPy reads in place.

mod arrays;
mod choices;
mod error;
mod exact;
mod measure;
mod photons;
mod readout;
mod render;
mod scene;
mod study;
mod work;

use pyo3::prelude::*;

/// Functions and the exception of the module; its Python side says what they mean.
#[pymodule]
fn _turbid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    work::silence_panics();
    module.add("Error", module.py().get_type::<error::Error>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(exact::problems, module)?)?;
    module.add_function(wrap_pyfunction!(exact::ask, module)?)?;
    module.add_function(wrap_pyfunction!(scene::resolve, module)?)?;
    module.add_function(wrap_pyfunction!(scene::builtin, module)?)?;
    module.add_function(wrap_pyfunction!(measure::measure, module)?)?;
    module.add_function(wrap_pyfunction!(render::render, module)?)?;
    module.add_function(wrap_pyfunction!(photons::photons, module)?)?;
    module.add_function(wrap_pyfunction!(study::study, module)?)?;
    Ok(())
}
