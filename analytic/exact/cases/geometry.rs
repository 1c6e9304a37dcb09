//! How rows become the arguments of commands: columns are options, quantities are what the answers call them.

use super::row::{COLUMNS, Row};
use anyhow::{Result, bail, ensure};

/// One kind of question of a table.
pub struct Geometry {
    /// As the table calls it.
    pub name: &'static str,
    /// As notes call it.
    called: &'static str,
    /// The command.
    command: &'static str,
    /// Columns, or names in `extra`, and the options that they are.
    columns: &'static [(&'static str, &'static str)],
    scattering: Scattering,
    quantities: &'static [Quantity],
}

/// Which phase functions a geometry has.
enum Scattering {
    /// By `g`, or by `phase` in `extra`.
    Any,
    /// Isotropic, though the command may know others.
    Isotropic,
    /// It scatters nothing, or in a way of its own.
    None,
}

/// Names in the column `quantity`, what the command calls it, options that it has in any case (a name in braces stands for
/// the cell of that name, after a bar for an empty one), and the cells that it needs.
type Quantity = (&'static [&'static str], &'static str, &'static [&'static str], &'static [&'static str]);

/// All that can be asked.
pub const GEOMETRIES: [Geometry; 10] = [
    Geometry { name: "slab", ..SLAB },
    Geometry { name: "slabXY", ..SLAB },
    Geometry {
        name: "slab_fresnel",
        called: "a slab between refracting faces",
        command: "slab",
        columns: &[("tau", "tau"), ("w", "albedo"), ("n", "index"), ("mu0", "mu0"), ("t", "depth")],
        scattering: Scattering::Any,
        quantities: &[
            (&["Rspec"], "specular", &[FACES], &["mu0"]),
            (&["Rdiff"], "reflectance_diffuse", &[FACES], &["mu0"]),
            (&["Rtot", "R"], "reflectance", &[FACES], &["mu0"]),
            (&["Tcoll", "T_direct"], "transmittance_direct", &[FACES], &["mu0"]),
            (&["Tdiff", "T_diffuse"], "transmittance_diffuse", &[FACES], &["mu0"]),
            (&["Ttot", "T_total"], "transmittance", &[FACES], &["mu0"]),
            // Of Lambertian light, whatever the beam of the other rows.
            (&["Rs"], "reflectance", &[FACES, "--mu0=diffuse"], &[]),
            (&["Ts"], "transmittance", &[FACES, "--mu0=diffuse"], &[]),
            (&["A"], "absorptance", &[FACES], &["mu0"]),
            (&["fluence"], "fluence", &[FACES], &["mu0", "t"]),
        ],
    },
    Geometry {
        name: "layers",
        called: "a stratified slab",
        command: "layers",
        columns: &[
            ("layers", "layer"),
            ("ground", "ground"),
            ("ground_index", "ground-index"),
            ("mu0", "mu0"),
            ("t", "depth"),
            ("mu", "mu"),
        ],
        scattering: Scattering::None,
        quantities: &[
            (&["R", "Rtot"], "reflectance", &[], &["layers", "mu0"]),
            (&["Rspec"], "specular", &[], &["layers", "mu0"]),
            (&["R_direct"], "reflectance_direct", &[], &["layers", "mu0"]),
            (&["Rdiff"], "reflectance_diffuse", &[], &["layers", "mu0"]),
            (&["T_total", "Ttot"], "transmittance", &[], &["layers", "mu0"]),
            (&["T_direct", "Tcoll"], "transmittance_direct", &[], &["layers", "mu0"]),
            (&["T_diffuse", "Tdiff"], "transmittance_diffuse", &[], &["layers", "mu0"]),
            (&["A_ground"], "absorptance_ground", &[], &["layers", "mu0"]),
            (&["fluence"], "fluence", &[], &["layers", "mu0", "t"]),
            (&["flux"], "flux", &[], &["layers", "mu0", "t"]),
            (&["flux_down"], "flux_down", &[], &["layers", "mu0", "t"]),
            (&["flux_up"], "flux_up", &[], &["layers", "mu0", "t"]),
            (&["radiance"], "radiance", &[], &["layers", "mu0", "t", "mu"]),
        ],
    },
    Geometry {
        name: "halfspace",
        called: "a half-space",
        command: "half-space",
        columns: &[("w", "albedo"), ("mu0", "mu0"), ("t", "depth"), ("mu", "mu")],
        scattering: Scattering::Isotropic,
        quantities: &[
            (&["H"], "h", &[], &["mu"]),
            (&["R_plane", "R"], "reflectance", &[], &["mu0"]),
            (&["R_spherical"], "reflectance", &["--mu0=diffuse"], &[]),
            (&["A"], "absorptance", &[], &["mu0"]),
            (&["radiance_up"], "radiance", &[], &["mu0", "mu"]),
            (&["radiance_up_mu0_1_unit_irradiance"], "radiance", &["--mu0=1"], &["mu"]),
            (&["fluence"], "fluence", &[], &["mu0", "t"]),
            (&["flux"], "flux", &[], &["mu0", "t"]),
            (&["extrapolation_length"], "extrapolation_length", &["--milne"], &[]),
            (&["diffusion_exponent_k"], "decay", &["--milne"], &[]),
        ],
    },
    Geometry {
        name: "sphere",
        called: "a sphere",
        command: "sphere",
        columns: &[("a", "radius"), ("w", "albedo"), ("r", "r"), ("mu", "mu")],
        scattering: Scattering::Isotropic,
        quantities: &[
            (&["escape_uniform_source"], "escape", &["--source=uniform"], &[]),
            (&["escape_central_point"], "escape", &["--source=centre"], &[]),
            (&["escape_iso_incidence"], "escape", &["--source=incident"], &[]),
            (&["absorbed_uniform_source"], "absorptance", &["--source=uniform"], &[]),
            (&["absorbed_central_point"], "absorptance", &["--source=centre"], &[]),
            (&["absorbed_iso_incidence"], "absorptance", &["--source=incident"], &[]),
            (&["fluence_uniform_source_unit_power"], "fluence", &["--source=uniform"], &["r"]),
            (&["fluence_central_point"], "fluence", &["--source=centre"], &["r"]),
            (&["fluence_iso_incidence_unit_irradiance"], "fluence", &["--source=incident"], &["r"]),
            (&["exit_radiance_uniform_unit_power"], "exit_radiance", &["--source=uniform"], &["mu"]),
            (&["exit_radiance_central_point"], "exit_radiance", &["--source=centre"], &["mu"]),
            (&["exit_radiance_iso_incidence"], "exit_radiance", &["--source=incident"], &["mu"]),
            (&["escape_first_flight_uniform"], "escape_direct", &["--source=uniform"], &[]),
            (&["escape_first_flight_from"], "escape_direct_from", &[], &["r"]),
        ],
    },
    Geometry {
        name: "infinite",
        called: "an infinite medium",
        command: "infinite",
        columns: &[("w", "albedo"), ("r", "r"), ("s", "wave")],
        scattering: Scattering::Any,
        quantities: &[
            (&["diffusion_exponent_k"], "decay", &[], &[]),
            (&["fluence_point"], "fluence", &[], &["r"]),
            (&["flux_point"], "flux", &[], &["r"]),
            (&["fluence_point_asymptotic_mode"], "asymptotic_fluence", &[], &["r"]),
            (&["fluence_point_P1_diffusion"], "diffusion_fluence", &[], &["r"]),
            (&["mean_square_r_fluence_weighted"], "mean_square_radius", &[], &[]),
            (&["total_fluence"], "total_fluence", &[], &[]),
            (&["transform"], "transform", &[], &["s"]),
        ],
    },
    Geometry {
        name: "critical_slab",
        quantities: &[
            (&["half_thickness_or_radius_mfp"], "size", &["--shape=slab"], &[]),
            (&["flux_ratio"], "flux_ratio", &["--shape=slab"], &["r"]),
        ],
        ..CRITICAL
    },
    Geometry {
        name: "critical_sphere",
        quantities: &[
            (&["half_thickness_or_radius_mfp"], "size", &["--shape=sphere"], &[]),
            (&["flux_ratio"], "flux_ratio", &["--shape=sphere"], &["r"]),
        ],
        ..CRITICAL
    },
    Geometry {
        name: "kernel",
        called: "a kernel",
        command: "kernel",
        columns: &[("kernel", "kernel"), ("d", "dimension"), ("b_r", "gradient"), ("x_over_r", "depth")],
        scattering: Scattering::None,
        quantities: &[
            (&["m2"], "m2", &[], &["kernel", "d"]),
            (&["m4"], "m4", &[], &["kernel", "d"]),
            (&["roughness_R"], "roughness", &[], &["kernel", "d"]),
            (&["bias_coeff_r2_laplacian"], "bias_per_r2_laplacian", &[], &["kernel", "d"]),
            (&["bias_coeff_r4_bilaplacian"], "bias_per_r4_bilaplacian", &[], &["kernel", "d"]),
            (&["equivalent_width_over_r"], "equivalent_width", &[UNIFORM], &["d"]),
            (&["esf"], "edge_spread", &[UNIFORM], &["d", "x_over_r"]),
            (&["lsf"], "line_spread", &[UNIFORM], &["d", "x_over_r"]),
            (&["esf_10_90_width_over_r"], "rise_width_10_90", &[UNIFORM], &["d"]),
            (&["lsf_std_over_r"], "line_deviation", &[UNIFORM], &["d"]),
            (&["halfspace_missing_length_over_r"], "missing_length", &[UNIFORM], &["d"]),
            (
                &["ball_mean_of_exp_field_ratio"],
                "exponential_mean",
                &["--kernel={kernel|uniform}"],
                &["d", "b_r"],
            ),
        ],
    },
];

const FACES: &str = "--between-refracting-faces";

const UNIFORM: &str = "--kernel=uniform";

const SLAB: Geometry = Geometry {
    name: "slab",
    called: "a slab",
    command: "slab",
    columns: &[
        ("tau", "tau"),
        ("w", "albedo"),
        ("mu0", "mu0"),
        ("t", "depth"),
        ("mu", "mu"),
        ("dphi", "azimuth"),
        ("order", "order"),
    ],
    scattering: Scattering::Any,
    quantities: &[
        (&["R"], "reflectance", &[], &["mu0"]),
        (&["T_total"], "transmittance", &[], &["mu0"]),
        (&["T_diffuse"], "transmittance_diffuse", &[], &["mu0"]),
        (&["T_direct"], "transmittance_direct", &[], &["mu0"]),
        (&["A"], "absorptance", &[], &["mu0"]),
        (&["fluence"], "fluence", &[], &["mu0", "t"]),
        (&["flux"], "flux", &[], &["mu0", "t"]),
        (
            &["radiance", "radiance_up", "radiance_down_diffuse", "radiance_total_diffuse"],
            "radiance",
            &[],
            &["mu0", "t", "mu"],
        ),
        (&["X"], "x", &["--mu0={mu}"], &["mu"]),
        (&["Y"], "y", &["--mu0={mu}"], &["mu"]),
        (&["R by order"], "reflectance_of_order", &[], &["mu0"]),
        (&["T_total by order"], "transmittance_of_order", &[], &["mu0"]),
        (&["fluence by order"], "fluence_of_order", &[], &["mu0", "t"]),
        (
            &[
                "radiance by order",
                "radiance_up by order",
                "radiance_down_diffuse by order",
                "radiance_total_diffuse by order",
            ],
            "radiance_of_order",
            &[],
            &["mu0", "t", "mu"],
        ),
    ],
};

const CRITICAL: Geometry = Geometry {
    name: "critical",
    called: "a critical body",
    command: "critical",
    columns: &[("w", "secondaries"), ("r", "x")],
    scattering: Scattering::None,
    quantities: &[],
};

/// The words of a command line, and the quantity of its answer that is wanted.
pub struct Words {
    /// Program, command, options.
    pub words: Vec<String>,
    /// As the answer calls it.
    pub wanted: &'static str,
    /// What is said where the answer has no such value.
    pub absent: String,
}

/// A number in the shortest words, whole ones without a point; other text as it is.
fn plain(text: &str) -> String {
    text.parse::<f64>().map_or_else(|_| text.to_string(), |number| number.to_string())
}

impl Geometry {
    /// All quantities by name.
    #[cfg(test)]
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.quantities.iter().flat_map(|quantity| quantity.0).copied()
    }

    /// All columns that become options.
    #[cfg(test)]
    pub fn column_names(&self) -> impl Iterator<Item = &'static str> {
        self.columns.iter().map(|column| column.0)
    }

    /// What a row asks of the command, or a note why it cannot.
    pub fn words(&self, row: &Row) -> Result<std::result::Result<Words, String>> {
        let (called, quantity) = (self.called, row.text("quantity"));
        if let Some(unknown) = row.extras().find(|name| !is_known(name)) {
            return Ok(Err(format!("no question has '{unknown}' in extra")));
        }
        let knows_orders = self.columns.iter().any(|column| column.0 == "order");
        let ordered = row.extra("order").is_some() && knows_orders;
        if row.extra("order").is_some() && !knows_orders {
            return Ok(Err(format!("{called} is not answered by order here")));
        }
        let name = if ordered { format!("{quantity} by order") } else { quantity.to_string() };
        let found = self.quantities.iter().find(|(names, ..)| names.contains(&name.as_str()));
        let by_order = format!("quantity {quantity} is not answered by order");
        let Some((_, wanted, options, needed)) = found else {
            let own = self
                .quantities
                .iter()
                .flat_map(|(names, ..)| names.iter())
                .filter(|name| !name.ends_with(" by order"));
            let allowed = own.copied().collect::<Vec<_>>().join(", ");
            let elsewhere =
                format!("quantity {quantity} of {called} is not answered here; allowed: {allowed}");
            return Ok(Err(if ordered { by_order } else { elsewhere }));
        };
        let absent = if ordered { by_order } else { format!("there is no {quantity} for these parameters") };
        if self.command == "slab" && self.name != "slab_fresnel" && row.number_or("n", 1.0)? != 1.0 {
            return Ok(Err("refracting faces are asked by geometry slab_fresnel".into()));
        }
        let mut words = vec!["exact".to_string(), self.command.to_string()];
        for option in *options {
            words.push(filled(option, row)?);
        }
        match self.scattering {
            Scattering::Any => match phase(row) {
                Ok(options) => words.extend(options),
                Err(note) => return Ok(Err(note)),
            },
            Scattering::Isotropic => {
                if row.number_or("g", 0.0)? != 0.0 || row.extra("phase").is_some() {
                    return Ok(Err(format!("{called} is answered here with isotropic scattering only")));
                }
            }
            Scattering::None => {}
        }
        for (column, option) in self.columns {
            let (cell, option) = (row.text(column), format!("--{option}="));
            if *column == "layers" {
                ensure!(
                    cell.contains("tau="),
                    "{column} in extra is '{cell}'; allowed: tau=T,albedo=W and so on, | between layers"
                );
            } else if cell.contains(',') {
                bail!("{column} is '{cell}'; allowed: one value");
            }
            let given = options.iter().find_map(|given| given.strip_prefix(&option));
            if let ("kernel", Some(only), false) = (*column, given, cell.is_empty())
                && !only.starts_with('{')
                && only != cell
            {
                return Ok(Err(format!("quantity {quantity} is answered here with kernel={only} only")));
            }
            let is_asked = needed.contains(column) || !cell.is_empty() || ordered && *column == "order";
            if given.is_none() && is_asked {
                words.push(option + &plain(cell));
            }
        }
        Ok(Ok(Words { words, wanted, absent }))
    }

    /// What is allowed of a count.
    pub fn counts(column: &str) -> &'static str {
        match column {
            "order in extra" => "a whole number, 0 to 1000",
            "d in extra" => "1, 2 or 3",
            _ => "a whole number",
        }
    }

    /// The column that an option came from, or the name in `extra`.
    pub fn column(&self, option: &str) -> Option<String> {
        let phase = ["g", "g2", "share"].into_iter().find(|name| *name == option);
        let found = self.columns.iter().find(|column| column.1 == option).map(|column| column.0).or(phase)?;
        Some(if COLUMNS.contains(&found) { found.to_string() } else { format!("{found} in extra") })
    }
}

/// An option with a cell in the place of its name.
fn filled(option: &str, row: &Row) -> Result<String> {
    let Some((front, name)) = option.strip_suffix('}').and_then(|option| option.split_once('{')) else {
        return Ok(option.to_string());
    };
    let (name, empty) = name.split_once('|').unwrap_or((name, ""));
    let cell = Some(row.text(name)).filter(|cell| !cell.is_empty()).unwrap_or(empty);
    ensure!(!cell.is_empty(), "{name} is ''; allowed: a number");
    Ok(format!("{front}{}", plain(cell)))
}

/// Names in `extra` of questions that have no command: see `closed`.
const CLOSED: [&str; 5] = ["q2pi_nu_r", "D", "h", "T", "alpha"];

/// Whether some question has a name in `extra`.
fn is_known(name: &str) -> bool {
    let columns = GEOMETRIES.iter().flat_map(|geometry| geometry.columns);
    ["phase", "g2", "share"].contains(&name)
        || CLOSED.contains(&name)
        || columns.map(|column| column.0).any(|column| column == name)
}

/// The phase function of a row: Henyey-Greenstein by its column, others by name in `extra`.
fn phase(row: &Row) -> std::result::Result<Vec<String>, String> {
    let option = |name: &str| format!("--{name}={}", plain(row.text(name)));
    match row.extra("phase") {
        None if row.text("g").is_empty() => Ok(Vec::new()),
        None => Ok(vec![option("g")]),
        Some("rayleigh") => Ok(vec!["--rayleigh".into()]),
        Some("two_term") => Ok(["g", "g2", "share"].map(option).to_vec()),
        Some(other) => {
            Err(format!("phase function {other} is not known here; allowed: rayleigh, two_term, or none"))
        }
    }
}
