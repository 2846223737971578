//! What computes: the CPU, or an adapter.

use super::console::Talk;
use super::outcome::{Outcome, usage};
use super::shared_args::EngineArgs;
use super::values::EngineArg;
use glam::DVec3;
use octagloss::Environment;
#[cfg(feature = "gpu")]
use octagloss::Error;
use octagloss::bake::{Bake, BakeSettings, Progress, bake_all};
use octagloss::filter::{Answer, Filter};
use octagloss::lobe::Lobe;
use octagloss::memory;
use octagloss::reflector::{Reflector, ReflectorSettings, Workspace};
#[cfg(feature = "gpu")]
use octagloss::wgpu;
use rayon::prelude::*;
use std::cell::OnceCell;

/// An engine, chosen.
pub(super) enum Engine {
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu {
        engine: Box<octagloss::gpu::engine::Engine>,
        /// Whether the CPU may take what the adapter cannot.
        may_fall_back: bool,
    },
}

/// A lobe to be asked for.
#[derive(Clone, Copy)]
pub(super) struct Query {
    pub(super) lobe: Lobe,
    pub(super) roughness: f64,
    pub(super) filter: Filter,
}

/// Who baked, as the report has it.
pub(super) struct Baker {
    pub(super) engine: &'static str,
    pub(super) adapter: Option<String>,
}

/// What the GPU answered; or the CPU's answer, where the GPU was asked for more than it has and
/// `may_fall_back`.
#[cfg(feature = "gpu")]
fn or_on_cpu<T>(
    on_gpu: octagloss::Result<T>,
    may_fall_back: bool,
    talk: &Talk,
    on_cpu: impl FnOnce() -> octagloss::Result<T>,
) -> octagloss::Result<T> {
    match on_gpu {
        Err(error @ (Error::Limit { .. } | Error::Parameter(_))) if may_fall_back => {
            talk.note(&format!("{error}; the CPU takes over"));
            on_cpu()
        }
        answered => answered,
    }
}

/// The first of `adapters` that has `name` in its own.
#[cfg(feature = "gpu")]
fn adapter_called<'a>(adapters: &'a [wgpu::Adapter], name: &str) -> octagloss::Result<&'a wgpu::Adapter> {
    let names: Vec<_> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    let place = names.iter().position(|other| other.to_lowercase().contains(&name.to_lowercase()));
    place.map(|place| &adapters[place]).ok_or_else(|| {
        let there = if names.is_empty() {
            "there are none".to_owned()
        } else {
            format!("there are: {}", names.join(", "))
        };
        Error::Gpu(format!("no adapter is called {name}; {there}"))
    })
}

/// The adapter called `name`, or the best there is.
#[cfg(feature = "view")]
pub(super) fn any_adapter(name: Option<&str>) -> Outcome<wgpu::Adapter> {
    let adapters = octagloss::gpu::block_on(None, octagloss::gpu::adapters())?;
    let adapter = match name {
        Some(name) => adapter_called(&adapters, name)?,
        None => adapters
            .first()
            .ok_or_else(|| Error::Gpu("no adapter; install a Vulkan driver, such as Mesa's".to_owned()))?,
    };
    Ok(adapter.clone())
}

impl EngineArgs {
    /// Options that contradict each other.
    pub(super) fn check(&self) -> Outcome {
        match (self.engine, &self.adapter) {
            (EngineArg::Cpu, Some(_)) => usage("--adapter names a GPU; leave --engine cpu out"),
            _ => Ok(()),
        }
    }

    /// The engine in `engine`, or the one asked for: chosen once an input was read, so that one that cannot
    /// be is answered by its error alone.
    pub(super) fn chosen<'a>(&self, engine: &'a OnceCell<Engine>, talk: &Talk) -> Outcome<&'a Engine> {
        if let Some(engine) = engine.get() {
            return Ok(engine);
        }
        let chosen = self.choose(talk)?;
        Ok(engine.get_or_init(|| chosen))
    }

    /// The engine asked for; under `auto` a hardware GPU where there is one, which is said.
    #[cfg(feature = "gpu")]
    pub(super) fn choose(&self, talk: &Talk) -> Outcome<Engine> {
        use octagloss::gpu::device::context::{adapters, describe, is_hardware, may_have_hardware};
        use octagloss::gpu::{Context, block_on, engine};

        if self.engine == EngineArg::Cpu {
            return Ok(Engine::Cpu);
        }
        let on_cpu = || {
            talk.note("no hardware GPU found; using the CPU");
            Ok(Engine::Cpu)
        };
        if self.engine == EngineArg::Auto && self.adapter.is_none() && !may_have_hardware() {
            return on_cpu();
        }
        let adapters = block_on(None, adapters())?;
        let adapter = match (&self.adapter, self.engine) {
            (Some(name), _) => adapter_called(&adapters, name)?,
            (None, EngineArg::Gpu) => adapters.first().ok_or_else(|| {
                Error::Gpu("no adapter; use --engine cpu or install a Vulkan driver".to_owned())
            })?,
            (None, _) => match adapters.iter().find(|adapter| is_hardware(&adapter.get_info())) {
                Some(adapter) => adapter,
                None => return on_cpu(),
            },
        };
        let may_fall_back = self.engine == EngineArg::Auto;
        let opened =
            block_on(None, Context::new(adapter)).and_then(|context| context).and_then(engine::Engine::new);
        match opened {
            Ok(engine) => {
                if may_fall_back {
                    talk.note(&format!("engine: gpu, {}", describe(&adapter.get_info())));
                }
                Ok(Engine::Gpu { engine: Box::new(engine), may_fall_back })
            }
            Err(error) if may_fall_back && self.adapter.is_none() => {
                talk.warn(&format!("{error}; the CPU takes over"));
                Ok(Engine::Cpu)
            }
            Err(error) => Err(error.into()),
        }
    }

    #[cfg(not(feature = "gpu"))]
    pub(super) fn choose(&self, talk: &Talk) -> Outcome<Engine> {
        if self.engine == EngineArg::Gpu || self.adapter.is_some() {
            return usage("this program was built without the feature gpu; leave --engine and --adapter out");
        }
        if self.engine == EngineArg::Auto {
            talk.note("built without the gpu feature; using the CPU");
        }
        Ok(Engine::Cpu)
    }
}

impl Engine {
    /// Bakes once for each of `settings`, and says who did.
    pub(super) fn bake_all(
        &self,
        environment: &Environment,
        settings: &[BakeSettings],
        #[cfg_attr(not(feature = "gpu"), expect(unused_variables, reason = "only a GPU falls back"))]
        talk: &Talk,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> octagloss::Result<(Vec<Bake>, Baker)> {
        let on_cpu =
            || Ok((bake_all(environment, settings, progress)?, Baker { engine: "cpu", adapter: None }));
        match self {
            Self::Cpu => on_cpu(),
            #[cfg(feature = "gpu")]
            Self::Gpu { engine, may_fall_back } => {
                let context = engine.context();
                let baked = engine.bake_all(environment, settings, progress);
                let baked = octagloss::gpu::block_on(Some(context), baked).and_then(|baked| {
                    Ok((baked?, Baker { engine: "gpu", adapter: Some(context.describe()) }))
                });
                or_on_cpu(baked, *may_fall_back, talk, on_cpu)
            }
        }
    }

    /// [`Engine::bake_all`] for one.
    pub(super) fn bake(
        &self,
        environment: &Environment,
        settings: &BakeSettings,
        talk: &Talk,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> octagloss::Result<(Bake, Baker)> {
        let (mut bakes, baker) =
            self.bake_all(environment, std::slice::from_ref(settings), talk, progress)?;
        Ok((bakes.pop().expect("one bake for one settings"), baker))
    }

    /// Answers to each of `directions` on its own, so that none depends on what else is asked.
    pub(super) fn query(
        &self,
        environment: &Environment,
        settings: &ReflectorSettings,
        directions: &[DVec3],
        query: Query,
        #[cfg_attr(not(feature = "gpu"), expect(unused_variables, reason = "only a GPU falls back"))]
        talk: &Talk,
    ) -> octagloss::Result<Vec<Answer>> {
        let Query { lobe, roughness, filter } = query;
        memory::check_query(environment.layout(), settings, lobe, roughness, filter)?;
        let on_cpu = || {
            let reflector = Reflector::new(environment, settings)?;
            let lobes = reflector.lobes(lobe, roughness, filter)?;
            let answer = |(workspace, answers): &mut (Workspace, Vec<Answer>), direction: &DVec3| {
                answers.clear();
                lobes.evaluate(&[*direction], workspace, answers);
                answers[0]
            };
            Ok(directions
                .par_iter()
                .map_init(|| (Workspace::default(), Vec::with_capacity(1)), answer)
                .collect())
        };
        match self {
            Self::Cpu => on_cpu(),
            #[cfg(feature = "gpu")]
            Self::Gpu { engine, may_fall_back } => {
                let on_gpu = async {
                    engine.check_fits(environment, settings, filter)?;
                    let reflector = octagloss::gpu::engine::Reflector::new(engine, environment, settings)?;
                    reflector.query(directions, lobe, roughness, filter).await
                };
                let answers =
                    octagloss::gpu::block_on(Some(engine.context()), on_gpu).and_then(|answers| answers);
                or_on_cpu(answers, *may_fall_back, talk, on_cpu)
            }
        }
    }
}

/// A line for each adapter, as `--adapter` names it.
#[cfg(feature = "gpu")]
pub(super) fn list_adapters() -> Outcome<Vec<String>> {
    use octagloss::gpu::device::context::describe;
    use octagloss::gpu::{adapters, block_on};
    Ok(block_on(None, adapters())?.iter().map(|adapter| describe(&adapter.get_info())).collect())
}

#[cfg(not(feature = "gpu"))]
pub(super) fn list_adapters() -> Outcome<Vec<String>> {
    usage("this program was built without the feature gpu")
}
