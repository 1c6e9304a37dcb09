//! `exact --cases`: a table of questions, each slab solved once.

use crate::kernel::{dimension, kernel};
use crate::slab::incidence;
use anyhow::{Context, Result, anyhow, bail};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io::Write;
use std::path::Path;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::slab_single::single_radiance;
use turbid_analytic::{AnisotropicSlab, Dimension, Incidence, IsotropicSlab, Kernel, Value};
use turbid_analytic::{blur, progressive, volumes};

const COLUMNS: [&str; 14] =
    ["id", "geometry", "tau", "a", "w", "g", "n", "mu0", "t", "r", "mu", "dphi", "extra", "quantity"];

/// An answer, or why there is none.
type Answer = std::result::Result<Value, String>;

/// One question: its fields by column name.
struct Row {
    line: u64,
    fields: [String; COLUMNS.len()],
}

impl Row {
    fn text(&self, column: &str) -> &str {
        COLUMNS.iter().position(|c| *c == column).map_or("", |i| self.fields[i].trim())
    }

    /// A number that must be there.
    fn number(&self, column: &str) -> Result<f64> {
        let text = self.text(column);
        text.parse().map_err(|_| anyhow!("{column} is '{text}'; allowed: a number"))
    }

    fn number_or(&self, column: &str, default: f64) -> Result<f64> {
        if self.text(column).is_empty() { Ok(default) } else { self.number(column) }
    }

    /// A `name=value` of the column `extra`.
    fn extra(&self, name: &str) -> Option<&str> {
        self.text("extra")
            .split(';')
            .filter_map(|pair| pair.split_once('='))
            .find(|p| p.0.trim() == name)
            .map(|p| p.1)
    }

    fn extra_number(&self, name: &str) -> Result<f64> {
        let text = self.extra(name).unwrap_or("");
        text.trim().parse().map_err(|_| anyhow!("{name} in extra is '{text}'; allowed: a number"))
    }

    fn dimension(&self) -> Result<Dimension> {
        dimension(self.extra("d").unwrap_or("")).map_err(|e| anyhow!("{e}"))
    }
}

/// Reads the questions, answers them, writes `id,value,error,note`.
pub fn answer(path: &Path, output: &mut impl Write) -> Result<()> {
    let name = path.display();
    let rows = read(path)?;
    // Slabs of one thickness share an operator: answer by thickness, print in the order of the file.
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&a, &b| rows[a].text("tau").cmp(rows[b].text("tau")));
    let mut answers: Vec<Option<Answer>> = rows.iter().map(|_| None).collect();
    let mut slabs = Slabs::default();
    for i in order {
        let row = &rows[i];
        let one = match row.text("geometry") {
            "slab" | "slabXY" => slab(row, &mut slabs),
            "kernel" => kernel_row(row),
            other => Ok(Err(format!("geometry {other} is not answered here"))),
        };
        answers[i] = Some(one.with_context(|| format!("{name}:{}", row.line))?);
    }
    let mut writer = csv::Writer::from_writer(output);
    writer.write_record(["id", "value", "error", "note"])?;
    for (row, answer) in rows.iter().zip(answers) {
        let id = row.text("id");
        match answer {
            Some(Ok(v)) => {
                writer.write_record([
                    id,
                    &format!("{:e}", v.value),
                    &format!("{:.3e}", v.error),
                    v.method,
                ])?;
            }
            Some(Err(note)) => writer.write_record([id, "", "", &note])?,
            None => bail!("{name}:{}: no answer was made", row.line),
        }
    }
    writer.flush()?;
    Ok(())
}

fn read(path: &Path) -> Result<Vec<Row>> {
    let name = path.display();
    let file = std::fs::File::open(path).with_context(|| format!("{name}"))?;
    let mut reader = csv::Reader::from_reader(file);
    let headers = reader.headers().with_context(|| format!("{name}"))?.clone();
    let mut places = [0; COLUMNS.len()];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = headers
            .iter()
            .position(|h| h.trim() == column)
            .ok_or_else(|| anyhow!("{name}:1: no column '{column}'; needed: {}", COLUMNS.join(",")))?;
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.with_context(|| format!("{name}"))?;
        let line = record.position().map_or(0, csv::Position::line);
        rows.push(Row { line, fields: places.map(|p| record.get(p).unwrap_or("").to_string()) });
    }
    Ok(rows)
}

/// The slabs of the thickness at hand.
#[derive(Default)]
struct Slabs {
    tau: f64,
    solved: HashMap<(u64, u64), IsotropicSlab>,
    anisotropic: HashMap<(u64, u64, u64), AnisotropicSlab>,
}

impl Slabs {
    fn get(&mut self, tau: f64, albedo: f64, incidence: Incidence) -> Result<&IsotropicSlab> {
        self.turn_to(tau);
        let key = (albedo.to_bits(), light_bits(incidence));
        if !self.solved.contains_key(&key) {
            let slab = match self.solved.values().next() {
                Some(other) => other.with(albedo, incidence)?,
                None => IsotropicSlab::new(tau, albedo, incidence)?,
            };
            self.solved.insert(key, slab);
        }
        self.solved.get(&key).context("the slab was just solved")
    }

    fn get_anisotropic(
        &mut self,
        tau: f64,
        albedo: f64,
        g: f64,
        incidence: Incidence,
    ) -> Result<&AnisotropicSlab> {
        self.turn_to(tau);
        let key = (albedo.to_bits(), g.to_bits(), light_bits(incidence));
        Ok(match self.anisotropic.entry(key) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(AnisotropicSlab::new(tau, albedo, g, incidence)?),
        })
    }

    fn turn_to(&mut self, tau: f64) {
        if tau.to_bits() != self.tau.to_bits() {
            self.solved.clear();
            self.anisotropic.clear();
            self.tau = tau;
        }
    }
}

fn light_bits(incidence: Incidence) -> u64 {
    match incidence {
        Incidence::Beam { mu0 } => mu0.to_bits(),
        Incidence::Diffuse => u64::MAX,
    }
}

fn slab(row: &Row, slabs: &mut Slabs) -> Result<Answer> {
    let quantity = row.text("quantity");
    let (tau, albedo) = (row.number("tau")?, row.number("w")?);
    let (g, index) = (row.number_or("g", 0.0)?, row.number_or("n", 1.0)?);
    let order = match row.extra("order") {
        Some(_) => Some(row.extra_number("order")?),
        None => None,
    };
    if index != 1.0 {
        return Ok(Err("refracting faces are not answered here".into()));
    }
    let radiance = matches!(quantity, "radiance_up" | "radiance_down_diffuse" | "radiance_total_diffuse");
    if radiance && order == Some(1.0) && row.text("mu0") != "diffuse" {
        let (mu0, t, mu) = (row.number("mu0")?, row.number("t")?, row.number("mu")?);
        return Ok(Ok(single_radiance(tau, albedo, g, mu0, t, mu, row.number_or("dphi", 0.0)?)?));
    }
    if g != 0.0 {
        if order.is_some()
            || !matches!(quantity, "R" | "T_total" | "T_diffuse" | "T_direct" | "A" | "fluence")
        {
            return Ok(Err(format!(
                "quantity {quantity} is not answered for anisotropic scattering, or not by order"
            )));
        }
        let light = incidence(row.text("mu0")).map_err(|e| anyhow!("{e}"))?;
        let slab = slabs.get_anisotropic(tau, albedo, g, light)?;
        return Ok(Ok(match quantity {
            "R" => slab.reflectance(),
            "T_total" => slab.transmittance(),
            "T_diffuse" => slab.transmittance_diffuse(),
            "T_direct" => slab.transmittance_direct(),
            "A" => slab.absorptance(),
            _ => slab.fluence(row.number("t")?)?,
        }));
    }
    // X and Y are functions of the cosine mu, and mu times the fluence on the two faces under a beam of that cosine.
    let chandrasekhar = matches!(quantity, "X" | "Y");
    let light = row.text(if chandrasekhar { "mu" } else { "mu0" });
    let light = incidence(light).map_err(|e| anyhow!("{e}"))?;
    let slab = slabs.get(tau, albedo, light)?;
    if let Some(n) = order {
        anyhow::ensure!(
            (0.0..=1000.0).contains(&n) && n.fract() == 0.0,
            "order is {n}; allowed: 0 to 1000, whole"
        );
        let n = n as u32;
        return Ok(match quantity {
            "R" => Ok(slab.reflectance_of_order(n)?),
            "T_total" => Ok(slab.transmittance_of_order(n)?),
            "fluence" => Ok(slab.fluence_of_order(n, row.number("t")?)?),
            other => Err(format!("quantity {other} is not answered by order")),
        });
    }
    let times_mu = |v: Value, mu: f64| Value { value: v.value * mu, error: v.error * mu, ..v };
    Ok(match quantity {
        "R" => Ok(slab.reflectance()),
        "T_total" => Ok(slab.transmittance()),
        "T_diffuse" => Ok(slab.transmittance_diffuse()),
        "T_direct" => Ok(slab.transmittance_direct()),
        "A" => Ok(slab.absorptance()),
        "fluence" => Ok(slab.fluence(row.number("t")?)?),
        _ if radiance => Ok(slab.radiance(row.number("t")?, row.number("mu")?)?),
        "X" => Ok(times_mu(slab.fluence(0.0)?, row.number("mu")?)),
        "Y" => Ok(times_mu(slab.fluence(tau)?, row.number("mu")?)),
        other => Err(format!("quantity {other} of a slab is not answered here")),
    })
}

/// Rows of kernels: parameters in `extra`, but for `a` and `r` (two radii) and `n` (passes of a progressive map).
fn kernel_row(row: &Row) -> Result<Answer> {
    let named = || kernel(row.extra("kernel").unwrap_or("")).map_err(|e| anyhow!("{e}"));
    let value = match row.text("quantity") {
        "m2" => named()?.moment(row.dimension()?, 2)?,
        "m4" => named()?.moment(row.dimension()?, 4)?,
        "roughness_R" => named()?.roughness(row.dimension()?)?,
        "bias_coeff_r2_laplacian" => named()?.bias_coefficient(row.dimension()?)?,
        "bias_coeff_r4_bilaplacian" => named()?.second_bias_coefficient(row.dimension()?)?,
        "jensen_gaussian_disc_mean_weight" => turbid_analytic::kernel::jensen_disc_mean_weight(),
        "equivalent_width_over_r" => blur::equivalent_width(row.dimension()?),
        "esf" => blur::edge_spread(row.dimension()?, row.extra_number("x_over_r")?)?,
        "lsf" => blur::line_spread(row.dimension()?, row.extra_number("x_over_r")?)?,
        "mtf" => blur::modulation_transfer(row.dimension()?, row.extra_number("q2pi_nu_r")?)?,
        "esf_10_90_width_over_r" => blur::rise_width(row.dimension()?),
        "lsf_std_over_r" => blur::line_deviation(row.dimension()?),
        "halfspace_missing_length_over_r" => blur::missing_length(row.dimension()?),
        "lens_volume" => volumes::lens_volume(row.number("a")?, row.number("r")?, row.extra_number("D")?)?,
        "ball_cap_slab_volume" => {
            volumes::ball_slab_volume(row.number("r")?, row.extra_number("h")?, row.extra_number("T")?)?
        }
        "progressive_r_n_over_r1" => {
            let n = row.number("n")?;
            anyhow::ensure!(
                (1.0..=1e6).contains(&n) && n.fract() == 0.0,
                "n is {n}; allowed: 1 to 1e6, whole"
            );
            let (d, alpha) = (row.dimension()?, row.extra_number("alpha")?);
            // Tables print the optimum, 2/3 or 4/7, to eight digits: mean it, and say so.
            let optimum = 4.0 / (f64::from(d.number()) + 4.0);
            let printed = alpha != optimum && (alpha - optimum).abs() <= 5e-9;
            let radius = progressive::progressive(d, if printed { optimum } else { alpha }, n as u32)?.radius;
            if printed {
                Value { method: "alpha read as 4/(d+4); product and sums", ..radius }
            } else {
                radius
            }
        }
        "ball_mean_of_exp_field_ratio" => {
            let kernel = if row.extra("kernel").is_some() { named()? } else { Kernel::Uniform };
            exponential_mean(kernel, row.dimension()?, row.extra_number("b_r")?)?
        }
        other => return Ok(Err(format!("quantity {other} of a kernel is not answered here"))),
    };
    Ok(Ok(value))
}
