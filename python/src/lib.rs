//! The Python module `octagloss._octagloss`; `octagloss/__init__.py` names what users import.

mod arrays;
mod bake;
mod choices;
mod environment;
mod errors;
mod maps;
mod options;
mod output;
mod query;
mod reference;
mod sun;
mod work;

/// The compiled part of octagloss; import `octagloss` instead.
#[pyo3::pymodule]
mod _octagloss {
    #[pymodule_export]
    use crate::bake::{Bake, Level, bake, dfg};
    #[pymodule_export]
    use crate::environment::Environment;
    #[pymodule_export]
    use crate::maps::{
        cube_from_direction, direction_from_cube, direction_from_equirect, direction_from_map,
        direction_from_oct, equirect_from_direction, map_components, map_density, map_from_direction,
        map_names, oct_from_direction,
    };
    #[pymodule_export]
    use crate::reference::reference;
    #[pymodule_export]
    use crate::sun::Sun;
    #[pymodule_export]
    use crate::work::set_threads;

    /// Version of the library.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
