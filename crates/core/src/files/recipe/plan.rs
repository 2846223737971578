//! Recipes as plans: files to write, and the settings of their bake.

use super::Recipe;
use crate::bake::{BakeSettings, Skybox};
use crate::common::error::{Error, Result, wrong};
use crate::files::format::container::Container;
use crate::files::format::{OutputLayout, Pixel};
use crate::files::target::{Diffuse, Target, TargetPlan, UNTARGETED};
use crate::light::chain::ChainKind;
use crate::light::environment::{Layout, Map};
use crate::lobe::Lobe;
use crate::lobe::filter::Filter;
use crate::lobe::ladder::Ladder;

/// Files to write, and the settings of their bake.
#[derive(Clone, Debug)]
pub struct BakePlan {
    /// The recipe of this plan alone, with its defaults filled in: the recipe of the same plan.
    pub recipe: Recipe,
    /// The files.
    pub plan: TargetPlan,
    /// The bake.
    pub settings: BakeSettings,
    /// A costly choice of ladder or levels.
    pub warning: Option<String>,
}

impl BakePlan {
    /// Resolves the skybox for a source of `layout`.
    #[must_use]
    pub fn settled(&self, layout: Layout) -> Self {
        let edge = self.recipe.skybox.map(|skybox| skybox.edge(layout));
        Self {
            recipe: Recipe { skybox: edge.map(Skybox::Edge), ..self.recipe.clone() },
            settings: BakeSettings { skybox: edge, ..self.settings.clone() },
            ..self.clone()
        }
    }

    /// Whether its levels are one file, called by the name of the output, and not a folder.
    #[must_use]
    pub const fn is_file(&self) -> bool {
        !self.plan.is_targeted() && self.plan.is_single()
    }
}

impl Recipe {
    /// One plan a target, or one without a target.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options out of range, and for those that contradict each other or the target.
    pub fn plans(&self) -> Result<Vec<BakePlan>> {
        self.check()?;
        match &self.target[..] {
            [] => Ok(vec![self.untargeted()?]),
            targets => targets.iter().map(|target| self.targeted(target)).collect(),
        }
    }

    /// The plan `plan` with `settings`, and the recipe of it.
    fn plan(&self, plan: TargetPlan, settings: BakeSettings, warning: Option<String>) -> Result<BakePlan> {
        let (target, is_targeted) = (plan.target, plan.is_targeted());
        let mut recipe = Self {
            // The preset without its map.
            target: Target::named(target.name).filter(|_| is_targeted).into_iter().collect(),
            size: Some(settings.size),
            ladder: Some(settings.ladder),
            chain: Some(settings.chain()),
            filter: settings.filter,
            sh_order: Some(settings.sh_order),
            ..self.clone()
        };
        recipe.map = target.has_pyramid().then(|| self.map.unwrap_or_default());
        recipe.levels = Some(settings.level_specs()?.len() as u32).filter(|_| target.map != Map::Panorama);
        recipe.table.scan = settings.filter.reads_sat().then_some(settings.scan);
        recipe.input.rotate_y.get_or_insert(0.0);
        recipe.input.scale.get_or_insert(1.0);
        if target.has_container() {
            recipe.format = Some(plan.container);
            recipe.pixel = Some(plan.pixel).filter(|pixel| Pixel::CHOICES.contains(pixel));
        }
        if !is_targeted {
            recipe.out_layout = Some(plan.layout);
        } else if target.has_container() {
            (recipe.diffuse, recipe.irradiance) = (Some(plan.diffuse), settings.irradiance);
        }
        if is_targeted && target.map == Map::Cube {
            recipe.flip = Some(plan.flip);
        }
        Ok(BakePlan { recipe, plan, settings, warning })
    }

    /// The plan of one file, or of a folder of images: the given container, else the layout's, and pixels
    /// that it can hold.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that contradict each other.
    pub fn untargeted(&self) -> Result<BakePlan> {
        if self.flip.is_some() || self.diffuse.is_some() {
            return wrong("`flip` and `diffuse` are for targets; choose a `target`, or omit them");
        }
        if self.map.is_some() {
            return wrong("`map` is for pyramids; choose `target` pyramid, or omit it");
        }
        let settings = self.untargeted_settings()?;
        let layout = self.out_layout.unwrap_or_default();
        let (name, map) = (layout.name(), layout.map());
        let images = layout != OutputLayout::Faces;
        if self.bounds && images {
            return wrong(format!("`bounds` is for `out_layout` faces, not {name}"));
        }
        if self.irradiance.is_some() && map != Map::Cube {
            return wrong(format!("`irradiance` is a cube; omit it or `out_layout` {name}"));
        }
        if self.skybox.is_some() && map != Map::Cube {
            return wrong(format!("`skybox` is a cube; omit it or `out_layout` {name}"));
        }
        let container = self.format.unwrap_or(if images { Container::Exr } else { Container::Ktx2 });
        let is_one_exr = matches!(layout, OutputLayout::Parts | OutputLayout::Mips);
        if is_one_exr && container != Container::Exr {
            return wrong(format!("`out_layout` {name} is an exr file, not {container}"));
        }
        if images && container.is_single() {
            return wrong(format!("`out_layout` {name} is for exr and hdr, not {container}"));
        }
        let pixel = container.pixel(self.pixel, container.default_pixel(layout))?;
        let diffuse = if self.irradiance.is_some() { Diffuse::Cube } else { Diffuse::None };
        let skybox = self.skybox.is_some();
        let plan = TargetPlan { container, pixel, layout, diffuse, skybox, ..TargetPlan::new(&UNTARGETED) };
        let size = settings.size;
        let warning =
            self.costly(&settings, &Ladder::ALL.map(|ladder| (ladder, ladder.default_levels(map, size))));
        self.plan(plan, settings, warning)
    }

    /// The settings of [`Recipe::untargeted`], without what files of several images cannot hold.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that contradict each other.
    pub fn untargeted_settings(&self) -> Result<BakeSettings> {
        if self.lobe == Lobe::Cosine && self.levels.is_some_and(|levels| levels > 1) {
            return wrong("`lobe` cosine has no roughness and bakes one level; omit `levels`");
        }
        if let Some(kind) = self.chain.filter(|kind| self.bounds && *kind != ChainKind::Sampled) {
            let name = kind.name();
            return wrong(format!("`bounds` needs sampled texels; omit `chain` {name} or `bounds`"));
        }
        if self.bounds && !matches!(self.filter, Filter::Adaptive(_)) {
            return wrong("`bounds` needs `filter` adaptive:E; other filters have no certified bounds");
        }
        let layout = self.out_layout.unwrap_or_default();
        let map = layout.map();
        let ladder = self.ladder.unwrap_or_default();
        // The format requires every level down to one texel.
        let every_level = layout == OutputLayout::Mips;
        let size = self.size.unwrap_or(if every_level { 256 } else { ladder.default_size(map, self.lobe) });
        let settings = BakeSettings {
            map,
            size,
            levels: self.levels.or_else(|| every_level.then(|| map.most_levels(size))),
            ladder,
            bounds: self.bounds,
            irradiance: self.irradiance,
            ..self.settings()
        };
        settings.level_specs()?;
        Ok(settings)
    }

    /// The preset of `target` with these options.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that contradict each other or the target.
    pub fn targeted(&self, target: &'static Target) -> Result<BakePlan> {
        let target = match self.map {
            Some(map) => target.on(map)?,
            None => target,
        };
        let mut plan = TargetPlan::new(target);
        let name = target.name;
        if self.bounds {
            return wrong("`bounds` needs a bake with no `target`; omit one");
        }
        if self.out_layout.is_some() {
            return wrong("`out_layout` cannot be combined with `target`; omit one");
        }
        if self.lobe == Lobe::Cosine {
            return wrong("`lobe` cosine cannot be combined with `target`; `diffuse` cube adds irradiance");
        }
        let fixed = |option: &str| wrong(format!("target {name} has a fixed format; omit {option}"));
        if !target.has_container() {
            if self.format.is_some() {
                return fixed("`format`");
            }
            if self.pixel.is_some() {
                return fixed("`pixel`");
            }
            if self.diffuse.is_some() || self.irradiance.is_some() {
                return fixed("`diffuse` and `irradiance`");
            }
        }
        plan.container = self.format.unwrap_or(plan.container);
        if plan.container == Container::Hdr {
            return wrong(
                "`format` hdr is a folder of faces and cannot be combined with `target`; use ktx2, ktx, \
                 dds or exr",
            );
        }
        if target.has_pyramid() && plan.container != Container::Ktx2 {
            let container = plan.container.name();
            return wrong(format!("target {name}: `format` {container} holds no pyramids; use ktx2"));
        }
        if target.map == Map::Octahedral && !matches!(plan.container, Container::Ktx2 | Container::Exr) {
            let container = plan.container.name();
            return wrong(format!("target {name}: `format` {container} is for cubes; use ktx2 or exr"));
        }
        if target.map != Map::Cube && self.flip.is_some() {
            let why = if target.has_pyramid() { "is read by shaders of its own" } else { "has no cube" };
            return wrong(format!("target {name} {why}; omit `flip`"));
        }
        if target.map == Map::Panorama && self.levels.is_some() {
            return wrong(format!("target {name} has one level; omit `levels`"));
        }
        plan.pixel = self.pixel.unwrap_or(plan.pixel);
        plan.flip = self.flip.unwrap_or(plan.flip);
        plan.diffuse = self.diffuse_of(plan.diffuse)?;
        if target.has_pyramid() && plan.diffuse != Diffuse::None {
            return wrong(format!("target {name} holds its irradiance; omit `diffuse` and `irradiance`"));
        }
        plan.skybox |= self.skybox.is_some();
        let filter = if target.has_pyramid() { Filter::Pyramid } else { self.filter };
        filter.check(self.lobe, self.table.oem_size)?;
        plan.check()?;
        let size = self.size.unwrap_or(target.size);
        let irradiance = self.irradiance.unwrap_or(target.irradiance_size);
        let settings = BakeSettings {
            map: target.map,
            size,
            levels: Some(self.levels.unwrap_or_else(|| target.levels(size))),
            ladder: self.ladder.unwrap_or(target.ladder),
            chain: self.chain.or(target.chain),
            irradiance: plan.diffuse.has_cube().then_some(irradiance),
            sheen: target.has_sheen(),
            pyramid: target.has_pyramid(),
            filter,
            ..self.settings()
        };
        let check = || plan.check_levels(size, settings.level_specs()?.len() as u32, settings.ladder);
        check().map_err(|error| Error::Parameter(format!("target {name}: {error}")))?;
        let warning = self.costly(&settings, &[(target.ladder, target.levels(size))]);
        self.plan(plan, settings, warning)
    }

    /// The diffuse light of a target whose own is `own`: with a cube, if its size was given.
    fn diffuse_of(&self, own: Diffuse) -> Result<Diffuse> {
        let diffuse = self.diffuse.unwrap_or(own);
        if self.irradiance.is_none() || diffuse.has_cube() {
            return Ok(diffuse);
        }
        match self.diffuse {
            Some(_) => wrong(format!(
                "`irradiance` requests a cube but `diffuse` {} has none; omit one",
                diffuse.name()
            )),
            None if diffuse == Diffuse::Sh => Ok(Diffuse::Both),
            None => Ok(Diffuse::Cube),
        }
    }

    /// The settings that all plans share.
    fn settings(&self) -> BakeSettings {
        BakeSettings {
            lobe: self.lobe,
            filter: self.filter,
            oem_size: self.table.oem_size,
            border: self.table.border,
            scan: self.table.scan.unwrap_or_default(),
            chain: self.chain,
            sh_order: self.sh_order.unwrap_or(2),
            sh_window: self.sh_window,
            ..BakeSettings::default()
        }
    }

    /// A warning if the given ladder or number of levels costs more than twice the best of `choices`, by the
    /// estimated error of look-ups.
    fn costly(&self, settings: &BakeSettings, choices: &[(Ladder, u32)]) -> Option<String> {
        let &BakeSettings { map, size, ladder, lobe, .. } = settings;
        let levels = settings.levels.unwrap_or_else(|| ladder.default_levels(map, size));
        // One level is not looked up by roughness.
        if lobe != Lobe::Ggx || levels == 1 || (self.ladder.is_none() && self.levels.is_none()) {
            return None;
        }
        let own = ladder.look_up_error(map, size, levels);
        let (best, best_ladder, best_levels) = choices
            .iter()
            .map(|&(ladder, levels)| (ladder.look_up_error(map, size, levels), ladder, levels))
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        (own > COSTLY * best).then(|| {
            format!(
                "trilinear look-ups at roughness 0.6 to 1 are up to {:.0} % off by estimate with {levels} \
                 levels of the {} ladder; {:.0} % with `ladder` {} and `levels` {best_levels}",
                100.0 * own,
                ladder.name(),
                100.0 * best,
                best_ladder.name()
            )
        })
    }
}

/// Ratio of estimated errors above which a choice is warned about.
const COSTLY: f64 = 2.0;
