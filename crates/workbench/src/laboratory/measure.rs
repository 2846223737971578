//! Compares maps as carriers of tables: errors of lobes against exhaustive integration over the source.

use super::boxes::{LobeAnswer, stack};
use super::charts::Charts;
use super::light::{Light, lamps};
use super::subject::{Carrier, SUBJECTS, Subject};
use glam::{DMat3, DQuat, DVec2, DVec3};
use octagloss_core::analysis::delivered::even_directions;
use octagloss_core::analysis::oracle::Oracle;
use octagloss_core::common::error::{Result, wrong};
use octagloss_core::common::names::named;
use octagloss_core::cpu::box_filter::{StackedBox, single_box};
use octagloss_core::light::environment::{Environment, exact_luminance};
use octagloss_core::lobe::Lobe;
use octagloss_core::sphere::map::Place;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// How a lobe is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The paper's single box.
    Box,
    /// [`STACK`] nested boxes.
    Stack,
    /// Adaptive quadrature to [`Settings::error`].
    Adaptive,
}

/// Boxes of [`Method::Stack`].
pub const STACK: u32 = 8;

named!(Method { Box = "box", Stack = "stack", Adaptive = "adaptive" });

impl Subject {
    /// Whether it has a row for `method`: adaptive queries read no border.
    fn has(&self, method: Method) -> bool {
        !(self.with_border && method == Method::Adaptive)
    }
}

/// Measured quantities.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Texels along the octahedral square; the other maps have as many texels in all. 8 to `MAX_SIZE`.
    pub size: u32,
    /// Rotations of the environment.
    pub turns: u32,
    /// Directions over the sphere, for the root mean square.
    pub directions: usize,
    /// Roughnesses of GGX.
    pub roughnesses: Vec<f64>,
    /// Error aimed at by adaptive queries.
    pub error: f64,
    /// Rows measured.
    pub subjects: Vec<Subject>,
    /// Filters measured.
    pub methods: Vec<Method>,
    /// Whether poles, cone points and seams are measured, too; else their errors are 0.
    pub regions: bool,
}

/// The largest [`Settings::size`].
const MAX_SIZE: u32 = 1024;

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: 128,
            turns: 3,
            directions: 300,
            roughnesses: vec![0.2, 0.35, 0.5, 0.75, 1.0],
            error: 0.01,
            subjects: SUBJECTS.to_vec(),
            methods: Method::ALL.to_vec(),
            regions: true,
        }
    }
}

/// A part of the sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Anywhere, evenly.
    Sphere,
    /// Within 8 degrees of +Y or -Y.
    Poles,
    /// Within 8 degrees of +-X or +-Z: the octahedral map's cone points.
    Cones,
    /// On an edge of the map's own components.
    Seams,
}

named!(Region { Sphere = "sphere", Poles = "poles", Cones = "cones", Seams = "seams" });

/// Errors of luminance at one roughness, relative to the mean over the sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorAt {
    /// Roughness.
    pub roughness: f64,
    /// Root mean square over each of [`Region::ALL`].
    pub rms: [f64; 4],
    /// The greatest of all.
    pub worst: f64,
    /// Its direction and region.
    pub worst_at: (DVec3, Region),
    /// Mean and greatest number of table entries read.
    pub reads: [f64; 2],
    /// At each of [`Settings::directions`] the root mean square over all rotations of the environment.
    pub field: Vec<f64>,
}

/// A row of the comparison.
#[derive(Clone, Debug)]
pub struct Row {
    /// The map.
    pub subject: Subject,
    /// The filter.
    pub method: Method,
    /// Texels of its maps, without borders.
    pub texels: usize,
    /// Bytes of the tables that the filter reads.
    pub bytes: usize,
    /// Least seconds to resample the light and to scan it, for all its tables.
    pub seconds: [f64; 2],
    /// Errors by roughness.
    pub errors: Vec<ErrorAt>,
}

/// Directions on the seams of a map.
const SEAMS: usize = 48;

/// A direction of a map and its region.
pub type Site = (DVec3, Region);

/// The environment of the comparison if none is given.
///
/// # Errors
/// None at this size.
pub fn default_environment() -> Result<Environment> {
    lamps(48)
}

/// Directions at and around the poles and the cone points.
fn special_sites() -> Vec<Site> {
    let mut sites = Vec::new();
    for (axis, region) in [
        (DVec3::Y, Region::Poles),
        (DVec3::NEG_Y, Region::Poles),
        (DVec3::X, Region::Cones),
        (DVec3::NEG_X, Region::Cones),
        (DVec3::Z, Region::Cones),
        (DVec3::NEG_Z, Region::Cones),
    ] {
        let (a, b) = axis.any_orthonormal_pair();
        sites.push((axis, region));
        for (degrees, count) in [(3.0_f64, 6), (8.0, 10)] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            sites.extend((0..count).map(|k| {
                let (y, x) = (std::f64::consts::TAU * (f64::from(k) + 0.3) / f64::from(count)).sin_cos();
                (axis * cos + (a * x + b * y) * sin, region)
            }));
        }
    }
    sites
}

/// Points along the edges of the map's components, found by bisection between directions that lie far apart
/// in the map.
pub fn seam_sites(charts: &dyn Charts, count: usize) -> Vec<Site> {
    let map = charts.named().map();
    let is_apart = |a: Place, b: Place, angle: f64| {
        // No map here stretches by more than 4, except panoramas next to their poles.
        let scale = DVec2::splat(4.0 * angle);
        a.component != b.component || (a.uv - b.uv).abs().cmpgt(scale).any()
    };
    let mut sites = Vec::new();
    let sources = even_directions(96 * count);
    for k in 0..sources.len() {
        if sites.len() == count {
            break;
        }
        // In an order that is even over the sphere from the start: the directions run from +Y to -Y.
        let from = sources[k * 949 % sources.len()];
        let (a, b) = from.any_orthonormal_pair();
        let (sin, cos) = (k as f64 * 2.4).sin_cos();
        let (mut from, mut to) = (from, (from + (a * cos + b * sin) * 0.3).normalize());
        if from.y.abs().max(to.y.abs()) > 0.95
            || !is_apart(map.locate(from), map.locate(to), from.distance(to))
        {
            continue;
        }
        for _ in 0..40 {
            let middle = (from + to).normalize();
            if is_apart(map.locate(from), map.locate(middle), from.distance(middle)) {
                to = middle;
            } else {
                from = middle;
            }
        }
        // Bisection loses a jump that is only stretch.
        if is_apart(map.locate(from), map.locate(to), 1e-6) {
            sites.push((from, Region::Seams));
        }
    }
    sites
}

/// Rotation `k` of the environment, about axes that no map's symmetry shares.
fn turn(k: u32) -> DMat3 {
    let k = f64::from(k) + 1.0;
    let axis = DVec3::new((1.1 * k).sin(), (1.7 * k).cos(), (2.3 * k).sin()).normalize();
    DMat3::from_quat(DQuat::from_axis_angle(axis, 0.9 * k))
}

/// Sums over directions.
#[derive(Clone, Debug)]
struct Sums {
    squares: [f64; 4],
    counts: [f64; 4],
    worst: (f64, Site),
    reads: f64,
    most_reads: usize,
    /// Squares by even direction.
    field: Vec<f64>,
}

impl Sums {
    fn new(directions: usize) -> Self {
        Self {
            squares: [0.0; 4],
            counts: [0.0; 4],
            worst: (0.0, (DVec3::X, Region::Sphere)),
            reads: 0.0,
            most_reads: 0,
            field: vec![0.0; directions],
        }
    }

    /// Adds the error at site `number`; the even directions come first.
    fn add(&mut self, number: usize, site: Site, error: f64, reads: usize) {
        let region = site.1 as usize;
        self.squares[region] += error * error;
        self.counts[region] += 1.0;
        if error.abs() > self.worst.0 {
            self.worst = (error.abs(), site);
        }
        self.reads += reads as f64;
        self.most_reads = self.most_reads.max(reads);
        if let Some(square) = self.field.get_mut(number) {
            *square += error * error;
        }
    }

    fn result(&self, roughness: f64, mean: f64, turns: u32) -> ErrorAt {
        let count: f64 = self.counts.iter().sum();
        ErrorAt {
            roughness,
            rms: std::array::from_fn(|k| (self.squares[k] / self.counts[k].max(1.0)).sqrt() / mean),
            worst: self.worst.0 / mean,
            worst_at: self.worst.1,
            reads: [self.reads / count, self.most_reads as f64],
            field: self.field.iter().map(|square| (square / f64::from(turns)).sqrt() / mean).collect(),
        }
    }
}

/// A lobe with its boxes.
struct Prepared {
    roughness: f64,
    single: Vec<StackedBox>,
    stack: Vec<StackedBox>,
}

impl Prepared {
    fn new(roughness: f64) -> Self {
        let alpha = roughness * roughness;
        Self { roughness, single: vec![single_box(Lobe::Ggx, alpha)], stack: stack(Lobe::Ggx, alpha, STACK) }
    }

    fn answer(&self, carrier: &Carrier, method: Method, error: f64, direction: DVec3) -> LobeAnswer {
        match method {
            Method::Box => carrier.boxes(&self.single, direction),
            Method::Stack => carrier.boxes(&self.stack, direction),
            Method::Adaptive => {
                carrier.adaptive(Lobe::Ggx, self.roughness * self.roughness, error, direction)
            }
        }
    }
}

/// Luminance of GGX at every roughness around every site under the environment of `oracle` turned by `turn`.
fn luminances(
    oracle: &Oracle<'_>,
    lobes: &[Prepared],
    sites: &[Site],
    turn: DMat3,
    count: &Count<'_>,
) -> Vec<Vec<f64>> {
    let one = |direction: DVec3| -> Vec<f64> {
        let direction = turn.transpose() * direction;
        let luminance = |lobe: &Prepared| {
            let luminance = exact_luminance(oracle.reflected(Lobe::Ggx, lobe.roughness, direction));
            count.one();
            luminance
        };
        lobes.iter().map(luminance).collect()
    };
    sites.par_iter().map(|(direction, _)| one(*direction)).collect()
}

/// The greatest solid angle of any box, whatever filters are measured: a row has the same border, and so the
/// same texels, with other filters and alone.
fn widest(lobes: &[Prepared]) -> f64 {
    let boxes = lobes.iter().flat_map(|lobe| lobe.single.iter().chain(&lobe.stack));
    boxes.map(|one| one.solid_angle).fold(0.0, f64::max)
}

impl Settings {
    /// Checks that everything can be measured.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Parameter`] for a size, a roughness or an error that cannot be
    /// measured.
    pub fn check(&self) -> Result<()> {
        let Self { size, turns, directions, roughnesses, error, subjects, methods, .. } = self;
        if !(8..=MAX_SIZE).contains(size) {
            return wrong(format!(
                "`size` {size} must be 8 to {MAX_SIZE} texels along the octahedral square"
            ));
        }
        if let Some(roughness) = roughnesses.iter().find(|r| !(0.1..=1.0).contains(*r)) {
            return wrong(format!("`roughness` {roughness} must be 0.1 to 1"));
        }
        let counts = [
            ("turns", *turns as usize),
            ("directions", *directions),
            ("roughnesses", roughnesses.len()),
            ("subjects", subjects.len()),
            ("methods", methods.len()),
        ];
        if let Some((name, _)) = counts.iter().find(|(_, count)| *count == 0) {
            return wrong(format!("no `{name}`; choose at least one"));
        }
        if !(1e-6..1.0).contains(error) {
            return wrong(format!("`error` {error}; choose from 1e-6 to 1"));
        }
        self.check_grids()
    }

    /// Checks that every row has texels left inside the border of its widest box.
    fn check_grids(&self) -> Result<()> {
        let lobes = self.lobes();
        let widest = widest(&lobes);
        let without = |size: u32| {
            let lacks = |subject: &&Subject| subject.grid(size as usize * size as usize, widest).is_err();
            self.subjects.iter().find(lacks)
        };
        let Some(subject) = without(self.size) else { return Ok(()) };
        let remedy = match (self.size..=MAX_SIZE).find(|size| without(*size).is_none()) {
            Some(least) => format!("choose {least} to {MAX_SIZE}, or leave the map out"),
            None => "leave the map out".to_owned(),
        };
        wrong(format!(
            "`size` {} leaves no texel to {} (map {}) inside the border of its widest box; {remedy}",
            self.size,
            subject.title,
            subject.charts.name()
        ))
    }

    fn lobes(&self) -> Vec<Prepared> {
        self.roughnesses.iter().map(|roughness| Prepared::new(*roughness)).collect()
    }
}

/// Checks that `environment` has light: errors are relative to its mean luminance.
///
/// # Errors
/// [`octagloss_core::common::error::Error::Parameter`] if it is black.
pub fn check_light(environment: &Environment) -> Result<()> {
    if environment.texels().iter().all(|texel| exact_luminance(*texel) == 0.0) {
        return wrong(
            "the environment is black, and errors are relative to its mean luminance; give one with light",
        );
    }
    Ok(())
}

/// Called with the number of finished exhaustive integrations and that of all; from any thread, in any order.
pub type Progress<'a> = &'a (dyn Fn(u64, u64) + Sync);

/// Counts exhaustive integrations.
struct Count<'a> {
    done: AtomicU64,
    total: u64,
    progress: Progress<'a>,
}

impl Count<'_> {
    fn one(&self) {
        (self.progress)(self.done.fetch_add(1, Ordering::Relaxed) + 1, self.total);
    }
}

/// Measures every row over `environment`.
///
/// # Errors
/// As [`Settings::check`], [`check_light`] and [`Light::new`].
pub fn measure(settings: &Settings, environment: &Environment, progress: Progress<'_>) -> Result<Vec<Row>> {
    settings.check()?;
    check_light(environment)?;
    let lobes = settings.lobes();
    let oracle = Oracle::new(environment);
    let even = even_directions(settings.directions).into_iter().map(|d| (d, Region::Sphere));
    let special = if settings.regions { special_sites() } else { Vec::new() };
    let common: Vec<Site> = even.chain(special).collect();
    // Every row with its sums by lobe. Rows of the same map share its seams.
    let mut rows: Vec<(Row, Vec<Sums>)> = Vec::new();
    let mut seams: BTreeMap<&str, Vec<Site>> = BTreeMap::new();
    for subject in &settings.subjects {
        let count = if settings.regions { SEAMS } else { 0 };
        seams.entry(subject.charts.name()).or_insert_with(|| seam_sites(subject.charts, count));
        for method in settings.methods.iter().filter(|method| subject.has(**method)) {
            let (subject, method, errors) = (*subject, *method, Vec::new());
            let row = Row { subject, method, texels: 0, bytes: 0, seconds: [f64::INFINITY; 2], errors };
            rows.push((row, vec![Sums::new(settings.directions); lobes.len()]));
        }
    }
    let sites = (common.len() + seams.values().map(Vec::len).sum::<usize>()) * lobes.len();
    let count = Count { done: AtomicU64::new(0), total: u64::from(settings.turns) * sites as u64, progress };
    let texels = settings.size as usize * settings.size as usize;
    let mut means = vec![0.0; lobes.len()];
    for k in 0..settings.turns {
        let turn = turn(k);
        let light = Light::new(environment, turn)?;
        let luminances = |sites: &[Site]| luminances(&oracle, &lobes, sites, turn, &count);
        let expected = luminances(&common);
        for luminances in &expected[..settings.directions] {
            for (mean, luminance) in means.iter_mut().zip(luminances) {
                *mean += luminance / (settings.directions as f64 * f64::from(settings.turns));
            }
        }
        let at_seams: BTreeMap<&str, Vec<Vec<f64>>> =
            seams.iter().map(|(map, sites)| (*map, luminances(sites))).collect();
        for of_map in rows.chunk_by_mut(|(a, _), (b, _)| a.subject.name == b.subject.name) {
            let subject = of_map[0].0.subject;
            let carrier = Carrier::new(subject, texels, widest(&lobes), &light)?;
            let map = subject.charts.name();
            let expected = expected.iter().chain(&at_seams[map]);
            let sites: Vec<(Site, &Vec<f64>)> =
                common.iter().chain(&seams[map]).copied().zip(expected).collect();
            for (row, sums) in of_map {
                row.texels = carrier.texels();
                row.bytes = carrier.bytes()[usize::from(row.method == Method::Adaptive)];
                for (least, time) in row.seconds.iter_mut().zip(carrier.times) {
                    *least = least.min(time.as_secs_f64());
                }
                for (index, (sums, lobe)) in sums.iter_mut().zip(&lobes).enumerate() {
                    let answer =
                        |(site, _): &(Site, _)| lobe.answer(&carrier, row.method, settings.error, site.0);
                    let answers: Vec<LobeAnswer> = sites.par_iter().map(answer).collect();
                    for (number, ((site, expected), answer)) in sites.iter().zip(answers).enumerate() {
                        let error = exact_luminance(answer.radiance) - expected[index];
                        sums.add(number, *site, error, answer.reads);
                    }
                }
            }
        }
    }
    if let Some((_, roughness)) = means.iter().zip(&settings.roughnesses).find(|(mean, _)| **mean == 0.0) {
        return wrong(format!(
            "the environment is black at roughness {roughness} along all {} directions, and errors are \
             relative to its mean luminance; give one with more light",
            settings.directions
        ));
    }
    let finished = |(row, sums): (Row, Vec<Sums>)| {
        let sums = sums.iter().zip(&lobes).zip(&means);
        let errors =
            sums.map(|((sums, lobe), mean)| sums.result(lobe.roughness, *mean, settings.turns)).collect();
        Row { errors, ..row }
    };
    Ok(rows.into_iter().map(finished).collect())
}
