//! Point queries: an environment is prepared once, then queried for any direction and roughness.

mod tiles;

use crate::analysis::oracle::Oracle;
use crate::common::direction::units;
use crate::common::error::{Error, Result, wrong};
use crate::common::frame::Frame;
use crate::common::once::Once;
use crate::common::parallel;
use crate::cpu::adaptive::Adaptive;
use crate::cpu::box_filter::BoxFilter;
use crate::cpu::cells::{Cells, SourceLight};
use crate::cpu::leaves::{LANES, Packet, Scratch};
use crate::cpu::table_bytes::{LIMIT, LobeRequest, SOURCE, Tables, at_most, largest_oem, largest_that};
use crate::cpu::{mirror, reparameterise};
use crate::geometry::source_texels::{SourceTexels, cells_across};
use crate::geometry::tent::Reconstruction;
use crate::light::environment::{Environment, Layout, Rgb};
use crate::light::light_scale::LightScale;
use crate::light::oem::{Oem, OemSize, bilinear_share};
use crate::light::sat::{Sat, Scan};
use crate::lobe::filter::{Answer, Bound, Filter};
use crate::lobe::kernel::Kernel;
use crate::lobe::{self, Lobe};
use crate::pyramid::{Levels, Pyramid, PyramidLobes};
use glam::{DMat3, DVec3};
use std::borrow::Cow;

/// Lobes of a smaller alpha are served as mirrors: float32 resolves no sharper ones, and beyond a texel even
/// of a 4096^2 OEM their tails hold less than 1e-5 of their energy.
const MIRROR_ALPHA: f64 = 5e-7;

/// Layout of a reflector. `Default` serves every query.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReflectorSettings {
    /// Texels along an edge of the OEM without its border; `None` for `default_oem_size`.
    pub oem_size: Option<u32>,
    /// Border of the OEM in texels; `None` for no border.
    pub border: Option<u32>,
    /// How the summed-area table is scanned; every choice gives the same bits.
    pub scan: Scan,
    /// The least roughness above 0 of later [`Filter::Adaptive`] queries, in \[0, 1\]: much finer cells are
    /// not kept.
    pub sharpest: f64,
    /// Whether [`Filter::Pyramid`] will be used: the default size is one that has a pyramid.
    pub pyramid: bool,
}

impl ReflectorSettings {
    /// The OEM size for a source of `layout`, and the texels along an edge of its finest cells.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an OEM of no texels, a `sharpest` outside [0, 1] and an invalid scan,
    /// [`Error::Limit`] if the tables do not fit.
    pub fn plan(&self, layout: Layout) -> Result<(OemSize, u32)> {
        self.scan.check()?;
        if !(0.0..=1.0).contains(&self.sharpest) {
            return wrong(format!("`sharpest` {} is outside [0, 1]", self.sharpest));
        }
        let border = self.border.unwrap_or(0);
        let inner = self.oem_size.unwrap_or_else(|| self.default_oem_size(layout));
        if inner == 0 {
            return wrong("an OEM of 0 texels: `oem_size` must be at least 1");
        }
        // Indices are 32 bits wide, and a table entry takes 32 bytes.
        let side = u64::from(inner) + 2 * u64::from(border);
        if side > 16384 {
            return Err(Error::Limit {
                what: format!("an OEM of {inner} texels with a border of {border}"),
                needed: side * side * 48,
                available: 16384 * 16384 * 48,
                remedy: "choose `oem_size` plus twice `border` of at most 16384".to_owned(),
            });
        }
        Ok((OemSize { inner, border }, self.block(inner)))
    }

    /// Checks that the OEM of a source of `layout` and the tables of the lobes `served` together take at most
    /// `limit` bytes.
    ///
    /// # Errors
    /// [`Error::Limit`], which names the largest size that fits; [`Error::Parameter`] for an OEM of no
    /// texels.
    pub fn check_memory(&self, what: &str, layout: Layout, served: &[LobeRequest], limit: u64) -> Result<()> {
        let bytes = |settings: &Self| {
            let (size, block) = settings.plan(layout)?;
            Ok(layout.texel_count() as u64 * SOURCE
                + Tables::new(layout, size, block, settings.scan, served).peak())
        };
        let needed = match bytes(self) {
            Ok(needed) if needed <= limit => return Ok(()),
            // Beyond 32-bit indices.
            Ok(needed) | Err(Error::Limit { needed, .. }) => needed,
            Err(other) => return Err(other),
        };
        let fits = |settings: &Self| bytes(settings).is_ok_and(|bytes| bytes <= limit);
        let narrowed =
            largest_that(0, self.border.unwrap_or(0), |border| fits(&Self { border: Some(border), ..*self }));
        let remedy = match narrowed {
            Some(border) => at_most("`border`", Some(border)),
            None => at_most("`oem_size`", self.largest_oem(layout, served, limit)),
        };
        Err(Error::Limit { what: what.to_owned(), needed, available: limit, remedy })
    }

    /// The largest OEM that takes at most `limit` bytes with the tables of the lobes `served` together.
    pub fn largest_oem(&self, layout: Layout, served: &[LobeRequest], limit: u64) -> Option<u32> {
        let source = layout.texel_count() as u64 * SOURCE;
        largest_oem(self.pyramid, |size| {
            let settings = Self { oem_size: Some(size), ..*self };
            let plan = settings.plan(layout);
            let peak = |(size, block)| source + Tables::new(layout, size, block, self.scan, served).peak();
            plan.is_ok_and(|plan| peak(plan) <= limit)
        })
    }

    /// Texels along an edge of the OEM for a source of `layout`, if none are asked for: as many as resolve
    /// lobes of roughness `sharpest` (0 for any) and above, at most twice the source's own, and at least the
    /// source's own up to 512, for suns smaller than any lobe; rounded up to a multiple of 64, at most 4096
    /// with its border. A pyramid's map has at most the source's own, or 2048.
    ///
    /// Finer texels cost time without benefit; coarser ones would widen the lobe. Energy is conserved at any
    /// size.
    pub(crate) fn default_oem_size(&self, layout: Layout) -> u32 {
        let own = source_oem_size(layout);
        let alpha = self.sharpest * self.sharpest;
        if self.pyramid {
            return Levels::size_for(own.min(Levels::texels_for(alpha).max(ENOUGH_FOR_SUNS)));
        }
        let asked = if alpha > 0.0 {
            let asked = (TEXELS_PER_ALPHA * 2.0 / alpha).min(2.0 * f64::from(own)) as u32;
            asked.max(own.min(ENOUGH_FOR_SUNS))
        } else {
            own
        };
        let most = LARGEST_DEFAULT.saturating_sub(2 * self.border.unwrap_or(0)).max(64);
        asked.min(most).next_multiple_of(64).min(most)
    }

    /// Texels along an edge of the finest cells of an OEM of `inner` texels.
    pub fn block(&self, inner: u32) -> u32 {
        // Cells of less than a third of the sharpest lobe's alpha: a texel is at least 2/n wide.
        let alpha = self.sharpest.min(KINKED).powi(2);
        let finest = alpha / 3.4 * f64::from(inner) / 2.0;
        if finest >= 2.0 { 1 << (finest.log2() as u32).min(6) } else { 1 }
    }
}

/// Even a wide lobe has sharp edges: a cone's edge, the kink at the horizon, and a Charlie lobe's point
/// around R. Cells are kept as for a peak of this roughness. Measured with hdr/sky.exr's sun near the horizon
/// of a lobe of roughness 1: an error of 0.4 %, against 2.3 % with cells for that roughness only.
const KINKED: f64 = 0.2;

/// An OEM resolves a lobe whose alpha is this many of its texels (2/n wide where they are narrowest).
const TEXELS_PER_ALPHA: f64 = 8.5;

/// At this OEM size a sun of one texel stays small compared with the lobes that need only a coarser OEM:
/// measured relRMSE 0.0025 at roughness 0.3, against 0.035 for 128.
const ENOUGH_FOR_SUNS: u32 = 512;

/// Most texels along an edge of a default OEM, border included.
const LARGEST_DEFAULT: u32 = 4096;

/// Texels along an edge of an OEM as fine as the source: a panorama's width, twice a cube's face, an
/// octahedral square's own edge.
pub(crate) const fn source_oem_size(layout: Layout) -> u32 {
    match layout {
        Layout::Panorama { width, .. } => width,
        Layout::Cube { size } => size.saturating_mul(2),
        Layout::Octahedral { size } => size,
    }
}

/// An environment's OEM and tables for queries. Tables are built on first use.
#[derive(Debug)]
pub struct Reflector<'a> {
    environment: Cow<'a, Environment>,
    /// Scale of the OEM's light.
    scale: LightScale,
    size: OemSize,
    oem: Once<Oem>,
    settings: ReflectorSettings,
    source: Once<Cells>,
    bilinear: Once<Cells>,
    sat: Once<Sat>,
    pyramid: Once<Pyramid>,
}

impl<'a> Reflector<'a> {
    /// Prepares `environment`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an OEM of no texels, a `sharpest` outside [0, 1] and an invalid scan,
    /// [`Error::Limit`] if building it takes more than 4 GiB, in WebAssembly 3 GiB.
    pub fn new(environment: &'a Environment, settings: &ReflectorSettings) -> Result<Self> {
        Self::prepared(Cow::Borrowed(environment), settings)
    }

    /// [`Reflector::new`] for an environment that the reflector owns.
    ///
    /// # Errors
    /// Those of [`Reflector::new`].
    pub fn owning(environment: Environment, settings: &ReflectorSettings) -> Result<Reflector<'static>> {
        Reflector::prepared(Cow::Owned(environment), settings)
    }

    /// A reflector over an existing OEM, built with `settings`. Answers are in the OEM's units.
    pub fn over(environment: &'a Environment, oem: Oem, settings: ReflectorSettings) -> Self {
        let size = oem.size();
        Self::with_parts(Cow::Borrowed(environment), LightScale::default(), size, Once::from(oem), settings)
    }

    fn prepared(environment: Cow<'a, Environment>, settings: &ReflectorSettings) -> Result<Self> {
        settings.check_memory("this reflector", environment.layout(), &[], LIMIT)?;
        let (size, _) = settings.plan(environment.layout())?;
        let scale = LightScale::new(&environment);
        // Cells of the source may be all that is used.
        let oem = match reparameterise::is_infallible(environment.layout(), size) {
            true => Once::new(),
            false => Once::from(reparameterise::oem_from_environment(&scale.scaled(&environment), size)?),
        };
        Ok(Self::with_parts(environment, scale, size, oem, *settings))
    }

    const fn with_parts(
        environment: Cow<'a, Environment>,
        scale: LightScale,
        size: OemSize,
        oem: Once<Oem>,
        settings: ReflectorSettings,
    ) -> Self {
        Self {
            environment,
            scale,
            size,
            oem,
            settings,
            source: Once::new(),
            bilinear: Once::new(),
            sat: Once::new(),
            pyramid: Once::new(),
        }
    }

    /// The environment.
    #[must_use]
    pub fn environment(&self) -> &Environment {
        &self.environment
    }

    /// The OEM, in the source's own space. Its light is that of the source times
    /// 2^[`LightScale::exponent`].
    pub(crate) fn map(&self) -> &Oem {
        self.oem.get_or_make(|| {
            let source = self.scale.scaled(&self.environment);
            reparameterise::oem_from_environment(&source, self.size).expect("checked when prepared")
        })
    }

    /// Size of the OEM.
    #[must_use]
    pub(crate) const fn size(&self) -> OemSize {
        self.size
    }

    /// Total energy of the light that lobes read, red, green and blue, in the source's own units: that of the
    /// cells of the source, or of the OEM.
    pub(crate) fn energy(&self) -> [f64; 3] {
        let energy = self.source.get().and_then(Cells::energy).unwrap_or_else(|| {
            let [red, green, blue, _] = self.map().totals();
            [red, green, blue]
        });
        self.scale.energies(energy)
    }

    /// The OEM's exact table.
    fn sat(&self) -> &Sat {
        let map = self.map();
        self.sat.get_or_make(|| Sat::new(map, self.settings.scan))
    }

    /// Cells of the source's texels, for lobes wider than the OEM's texels.
    fn source_cells(&self) -> &Cells {
        self.source.get_or_make(|| {
            let inner = self.size.inner;
            let layout = self.environment.layout();
            let width = cells_across(layout, inner.div_ceil(self.settings.block(inner)));
            Cells::of_source(SourceTexels::new(layout), self.light(), width)
        })
    }

    /// Cells of the OEM, interpolated bilinearly.
    fn bilinear_cells(&self) -> &Cells {
        let (map, block) = (self.map(), self.settings.block(self.size.inner));
        self.bilinear.get_or_make(|| Cells::new(map, block, Reconstruction::Bilinear))
    }

    /// The light of the source, scaled as the OEM's.
    fn light(&self) -> SourceLight<'_> {
        SourceLight::new(&self.environment, self.scale)
    }

    /// The map's pyramid. Its size must have one.
    fn pyramid(&self) -> &Pyramid {
        let map = self.map();
        self.pyramid.get_or_make(|| Pyramid::of_oem(map).expect("a checked size"))
    }

    /// Radiance that a surface reflects to the viewer of `frame`, in the world, out of the map's pyramid; see
    /// [`Pyramid::reflect`]. Its Fresnel term goes from `f0` to 1.
    pub fn reflect(&self, frame: &Frame, roughness: f32, anisotropy: f32, f0: f32) -> Rgb {
        let frame = Frame { axes: self.environment.source_from_world() * frame.axes, ..*frame };
        self.scale.radiance(self.pyramid().reflect(&frame, roughness, anisotropy, [f0; 3], 1.0))
    }

    /// Lobes of one family and roughness, evaluated by one filter.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a roughness outside [0, 1], an adaptive error outside [1e-6, 1), a filter
    /// that does not support the lobe, and an OEM whose size has no pyramid, for [`Filter::Pyramid`];
    /// [`Error::Limit`] if the lobes' tables take more than [`Reflector::new`] allows.
    pub fn lobes(&self, lobe: Lobe, roughness: f64, filter: Filter) -> Result<Lobes<'_>> {
        if !(0.0..=1.0).contains(&roughness) {
            return wrong(format!("roughness {roughness} is outside [0, 1]"));
        }
        filter.check(lobe, Some(self.size.inner))?;
        let settings = ReflectorSettings { oem_size: Some(self.size.inner), ..self.settings };
        let served = [LobeRequest { lobe, roughness, filter }];
        settings.check_memory("this reflector", self.environment.layout(), &served, LIMIT)?;
        let alpha = roughness * roughness;
        let mirror = lobe.has_mirror() && alpha < MIRROR_ALPHA;
        let method = match filter {
            Filter::Reference => Evaluation::Reference(Oracle::new(&self.environment), lobe, roughness),
            Filter::Box => Evaluation::Box(BoxFilter::new(self.sat(), lobe, alpha)),
            Filter::Pyramid => Evaluation::Pyramid(Box::new(self.pyramid().lobes(roughness as f32))),
            Filter::Adaptive(_) if mirror => Evaluation::Mirror(self.map(), self.map().least_radiance()),
            Filter::Adaptive(error) => {
                let share = bilinear_share(lobe, alpha, self.size.inner);
                let kernel = Kernel::new(lobe, alpha);
                let over = |cells| Adaptive::new(cells, kernel, error);
                Evaluation::Adaptive {
                    source: (share < 1.0)
                        .then(|| over(self.source_cells()).lit_by(self.light()).scaled(1.0 - share)),
                    bilinear: (share > 0.0).then(|| over(self.bilinear_cells()).scaled(share)),
                    widest: WIDEST_PACKET * lobe::full_width_at_half_maximum(lobe, alpha),
                }
            }
        };
        // The oracle integrates the source itself.
        let scale = if filter == Filter::Reference { LightScale::default() } else { self.scale };
        Ok(Lobes { source_from_world: self.environment.source_from_world(), scale, method })
    }

    /// [`Reflector::query`] for each of `directions`, on all threads.
    ///
    /// # Errors
    /// Those of [`Reflector::query`].
    pub fn query_all(
        &self,
        directions: &[DVec3],
        roughness: f64,
        lobe: Lobe,
        filter: Filter,
    ) -> Result<Vec<Answer>> {
        let lobes = self.lobes(lobe, roughness, filter)?;
        let directions = &units(directions)?[..];
        let block = |directions: &[DVec3]| {
            let mut answers = Vec::with_capacity(directions.len());
            lobes.evaluate_units(directions, &mut Workspace::default(), &mut answers);
            answers
        };
        let answers = parallel::map(directions.chunks(BLOCK), block).concat();
        check_answers(directions, &answers)?;
        Ok(answers)
    }

    /// Radiance of `lobe` at `roughness` in [0, 1] around `direction` (in world space, any length but zero).
    ///
    /// # Errors
    /// Those of [`Reflector::lobes`]; [`Error::Parameter`] for a direction that is zero or not finite.
    pub fn query(&self, direction: DVec3, roughness: f64, lobe: Lobe, filter: Filter) -> Result<Answer> {
        let directions = units(&[direction])?;
        let mut answers = Vec::with_capacity(1);
        let lobes = self.lobes(lobe, roughness, filter)?;
        lobes.evaluate_units(&directions, &mut Workspace::default(), &mut answers);
        check_answers(&directions, &answers)?;
        Ok(answers[0])
    }
}

/// For tests.
impl Reflector<'_> {
    /// The OEM.
    #[doc(hidden)]
    #[must_use]
    pub fn oem(&self) -> &Oem {
        self.map()
    }

    /// The exponent of the light in the OEM.
    #[doc(hidden)]
    #[must_use]
    pub const fn light_exponent(&self) -> i32 {
        self.scale.exponent()
    }
}

/// The least `roughness` above 0 as `lobe` is served, for [`ReflectorSettings::sharpest`]; 0 if all are
/// mirrors, `None` for none.
#[must_use]
pub fn sharpest(lobe: Lobe, roughness: &[f64]) -> Option<f64> {
    let served = roughness.iter().map(|roughness| lobe.served_roughness(*roughness));
    let least = served.clone().filter(|roughness| *roughness > 0.0).reduce(f64::min);
    least.or_else(|| served.reduce(f64::min))
}

/// Directions of one task of [`Reflector::query_all`].
const BLOCK: usize = 500;

/// Checks that all answers to a query are valid numbers.
///
/// # Errors
/// [`Error::NonFiniteResult`] naming the direction of the first radiance or bound that is NaN, infinite or
/// negative.
pub fn check_answers(directions: &[DVec3], answers: &[Answer]) -> Result<()> {
    for (direction, answer) in directions.iter().zip(answers) {
        if let Some(value) = answer.wrong_value() {
            return Err(Error::NonFiniteResult {
                place: format!("direction {}, {}, {}", direction.x, direction.y, direction.z),
                value: f64::from(value),
            });
        }
    }
    Ok(())
}

#[derive(Debug)]
enum Evaluation<'r> {
    Adaptive {
        source: Option<Adaptive<'r>>,
        bilinear: Option<Adaptive<'r>>,
        /// Greatest distance of directions that share a traversal.
        widest: f64,
    },
    Box(BoxFilter<'r>),
    Mirror(&'r Oem, Rgb),
    Pyramid(Box<PyramidLobes<'r>>),
    Reference(Oracle<'r>, Lobe, f64),
}

/// Greatest distance of directions that share a traversal, in widths of their lobe.
const WIDEST_PACKET: f64 = 64.0;

/// The greatest distance of one of `directions` from the first.
fn spread(directions: &[DVec3]) -> f64 {
    directions.iter().map(|d| d.distance(directions[0])).fold(0.0, f64::max)
}

/// The answer to which shares are added.
const NO_LIGHT: Answer =
    Answer { radiance: [0.0; 3], bound: Some(Bound { channels: [0.0; 3], luminance: 0.0 }) };

/// Lobes of one family, roughness and filter over a reflector.
#[derive(Debug)]
pub struct Lobes<'r> {
    source_from_world: DMat3,
    /// Scale of the light that `method` reads.
    scale: LightScale,
    method: Evaluation<'r>,
}

/// Buffers of evaluations, one per thread.
#[derive(Debug, Default)]
pub struct Workspace {
    scratch: Scratch,
    /// Leaves of the quadrature so far, each counted once per packet of directions.
    pub leaves: u64,
    /// Packets so far.
    pub packets: u64,
    /// Directions so far.
    pub directions: u64,
}

impl Lobes<'_> {
    /// Appends the answer for each of `directions` (unit vectors in world space). A few consecutive
    /// directions share one traversal if they are close to each other.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a direction that is no unit vector, to a millionth.
    pub fn evaluate(
        &self,
        directions: &[DVec3],
        workspace: &mut Workspace,
        answers: &mut Vec<Answer>,
    ) -> Result<()> {
        // NaN is none, too.
        let is_unit = |direction: &&DVec3| (direction.length_squared() - 1.0).abs() < 1e-6;
        if let Some(direction) = directions.iter().find(|direction| !is_unit(direction)) {
            return wrong(format!("the direction {direction} is no unit vector"));
        }
        self.evaluate_units(directions, workspace, answers);
        Ok(())
    }

    /// [`Lobes::evaluate`] of directions that are known to be unit vectors.
    pub(crate) fn evaluate_units(
        &self,
        directions: &[DVec3],
        workspace: &mut Workspace,
        answers: &mut Vec<Answer>,
    ) {
        let source_from_world = self.source_from_world;
        let first_answer = answers.len();
        let unbounded = |radiance: Rgb| Answer { radiance, bound: None };
        match &self.method {
            Evaluation::Adaptive { source, bilinear, widest } => {
                let mut turned = [DVec3::ZERO; LANES];
                // Directions many lobes apart share no leaves: a common cut would resolve the whole area
                // between them.
                let together = |group: &[DVec3]| if spread(group) <= *widest { LANES } else { 1 };
                for group in directions.chunks(LANES).flat_map(|group| group.chunks(together(group))) {
                    for (turned, direction) in turned.iter_mut().zip(group) {
                        *turned = source_from_world * *direction;
                    }
                    let packet = Packet::new(&turned[..group.len()]);
                    let first = answers.len();
                    answers.extend(group.iter().map(|_| NO_LIGHT));
                    for part in [source, bilinear].into_iter().flatten() {
                        let shares = part.evaluate(&packet, &mut workspace.scratch);
                        workspace.leaves += shares.leaves as u64;
                        tiles::add(&mut answers[first..], &shares);
                    }
                    workspace.packets += 1;
                    workspace.directions += group.len() as u64;
                }
            }
            Evaluation::Box(filter) => {
                answers.extend(directions.iter().map(|d| unbounded(filter.radiance(source_from_world * *d))))
            }
            Evaluation::Pyramid(lobes) => {
                answers.extend(directions.iter().map(|d| unbounded(lobes.around(source_from_world * *d))))
            }
            Evaluation::Mirror(oem, least) => answers.extend(
                directions.iter().map(|d| unbounded(mirror::radiance(oem, *least, source_from_world * *d))),
            ),
            Evaluation::Reference(oracle, lobe, roughness) => {
                let radiance = |d: &DVec3| oracle.reflected(*lobe, *roughness, *d).map(|c| c as f32);
                answers.extend(directions.iter().map(|d| unbounded(radiance(d))));
            }
        }
        for answer in &mut answers[first_answer..] {
            *answer = self.scale.answer(*answer);
        }
    }
}
