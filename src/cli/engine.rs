//! Engines: the CPU, or a GPU adapter.

use super::console::Console;
#[cfg(feature = "gpu")]
use super::console::with_options;
use super::outcome::{Outcome, usage};
#[cfg(feature = "gpu")]
use crate::Error;
use crate::queries::Query;
use crate::recipes::Baked;
#[cfg(feature = "gpu")]
use crate::wgpu;
use crate::{Answer, BakeSettings, Environment, OnProgress, Reflector, ReflectorSettings, bake_all};
use clap::{Args as ClapArgs, ValueEnum};
use octagloss_core::bake::memory;

/// Maximum of --threads.
pub(super) const MAX_THREADS: i64 = 256;

/// Options of the engine.
#[derive(Clone, Debug, ClapArgs)]
#[command(next_help_heading = "Engine")]
pub(super) struct EngineArgs {
    /// Engine: auto, cpu or gpu [default: auto]
    ///
    /// auto uses a hardware GPU if there is one, else the CPU, and prints the choice.
    #[arg(long, value_name = "ENGINE", default_value = "auto")]
    #[arg(hide_default_value = true, hide_possible_values = true)]
    pub(super) engine: EngineArg,
    /// GPU, by a part of its name
    ///
    /// octagloss info --adapters lists them.
    #[arg(long, value_name = "NAME")]
    pub(super) adapter: Option<String>,
    /// Threads, 1 to 256 [default: one per core]
    ///
    /// Does not affect the result.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS))]
    pub(super) threads: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum EngineArg {
    /// A hardware GPU if there is one, else the CPU
    Auto,
    /// The CPU, all cores
    Cpu,
    /// A GPU or a software adapter
    Gpu,
}

/// The chosen engine.
pub(super) enum Engine {
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu {
        engine: Box<octagloss_gpu::engine::Engine>,
        /// Whether to fall back to the CPU.
        may_fall_back: bool,
    },
}

/// The reason to fall back to the CPU after `error`: a feature or memory that the GPU lacks.
///
/// # Errors
/// Any other error, and every one if falling back is not allowed.
#[cfg(feature = "gpu")]
fn fallback(error: Error, may_fall_back: bool) -> crate::Result<String> {
    match error {
        Error::Limit { .. } | Error::Unsupported { .. } if may_fall_back => {
            Ok(with_options(&format!("{error}; falling back to the CPU")))
        }
        _ => Err(error),
    }
}

/// The first of `adapters` whose name contains `name`, or the best one; `remedy` is for none.
#[cfg(feature = "gpu")]
fn adapter_called<'a>(
    adapters: &'a [wgpu::Adapter],
    name: Option<&str>,
    remedy: &str,
) -> crate::Result<&'a wgpu::Adapter> {
    let names: Vec<_> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
    let wanted = name.unwrap_or_default().to_lowercase();
    let place = names.iter().position(|other| other.to_lowercase().contains(&wanted));
    let absent = || match name {
        None => format!("no adapter found; {remedy}"),
        Some(name) if names.is_empty() => format!("unknown adapter {name}; no adapters found"),
        Some(name) => format!("unknown adapter {name}; choose one of: {}", names.join(", ")),
    };
    place.map(|place| &adapters[place]).ok_or_else(|| Error::Gpu(absent()))
}

/// The adapter called `name`, or the best one.
#[cfg(feature = "gpu")]
pub(super) fn any_adapter(name: Option<&str>) -> Outcome<wgpu::Adapter> {
    let adapters = octagloss_gpu::block_on(None, octagloss_gpu::adapters())?;
    Ok(adapter_called(&adapters, name, "install a Vulkan driver, such as Mesa's")?.clone())
}

impl EngineArgs {
    /// Rejects contradicting options.
    pub(super) fn check(&self) -> Outcome {
        match (self.engine, &self.adapter) {
            (EngineArg::Cpu, Some(_)) => usage("--adapter names a GPU; omit --engine cpu"),
            _ => Ok(()),
        }
    }

    /// The requested engine. `auto` selects a hardware GPU if there is one, and prints the choice.
    #[cfg(feature = "gpu")]
    pub(super) fn choose(&self, console: &Console) -> Outcome<Engine> {
        use octagloss_gpu::device::context::{adapters, describe, is_hardware, may_have_hardware};
        use octagloss_gpu::{Context, block_on, engine};

        if self.engine == EngineArg::Cpu {
            return Ok(Engine::Cpu);
        }
        let on_cpu = || {
            console.note("no hardware GPU found; using the CPU");
            Ok(Engine::Cpu)
        };
        if self.engine == EngineArg::Auto && self.adapter.is_none() && !may_have_hardware() {
            return on_cpu();
        }
        let adapters = block_on(None, adapters())?;
        let may_fall_back = self.engine == EngineArg::Auto;
        let adapter = if may_fall_back && self.adapter.is_none() {
            match adapters.iter().find(|adapter| is_hardware(&adapter.get_info())) {
                Some(adapter) => adapter,
                None => return on_cpu(),
            }
        } else {
            let remedy = "use --engine cpu or install a Vulkan driver";
            adapter_called(&adapters, self.adapter.as_deref(), remedy)?
        };
        let opened =
            block_on(None, Context::new(adapter)).and_then(|context| context).and_then(engine::Engine::new);
        match opened {
            Ok(engine) => {
                if may_fall_back {
                    console.note(&format!("engine: gpu, {}", describe(&adapter.get_info())));
                }
                Ok(Engine::Gpu { engine: Box::new(engine), may_fall_back })
            }
            Err(error) if may_fall_back && self.adapter.is_none() => {
                console.warn(&format!("{error}; falling back to the CPU"));
                Ok(Engine::Cpu)
            }
            Err(error) => Err(error.into()),
        }
    }

    #[cfg(not(feature = "gpu"))]
    pub(super) fn choose(&self, console: &Console) -> Outcome<Engine> {
        if self.engine == EngineArg::Gpu || self.adapter.is_some() {
            return usage("built without the feature gpu; omit --engine and --adapter");
        }
        if self.engine == EngineArg::Auto {
            console.note("built without the gpu feature; using the CPU");
        }
        Ok(Engine::Cpu)
    }
}

impl Engine {
    /// Bakes once for each of `settings`; returns the engine that baked.
    pub(super) fn bake_all(
        &self,
        environment: &Environment,
        settings: &[BakeSettings],
        progress: OnProgress<'_>,
    ) -> crate::Result<Baked> {
        let on_cpu =
            |fallback| Ok(Baked { fallback, ..Baked::on_cpu(bake_all(environment, settings, progress)?) });
        match self {
            Self::Cpu => on_cpu(None),
            #[cfg(feature = "gpu")]
            Self::Gpu { engine, may_fall_back } => {
                let context = engine.context();
                let baked = engine.bake_all(environment, settings, progress);
                match octagloss_gpu::block_on(Some(context), baked)? {
                    Ok(bakes) => {
                        let adapter = Some(context.describe());
                        Ok(Baked { bakes, engine: "gpu", adapter, fallback: None })
                    }
                    Err(error) => on_cpu(Some(fallback(error, *may_fall_back)?)),
                }
            }
        }
    }

    /// Evaluates each direction independently; results depend only on the direction and `settings`.
    pub(super) fn query(
        &self,
        environment: &Environment,
        settings: &ReflectorSettings,
        query: &Query<'_>,
        #[cfg_attr(not(feature = "gpu"), expect(unused_variables, reason = "only a GPU falls back"))]
        console: &Console,
    ) -> crate::Result<Vec<Answer>> {
        for roughness in query.roughnesses() {
            memory::check_query(environment.layout(), settings, query.lobe, roughness, query.filter)?;
        }
        let on_cpu = || query.answered(&Reflector::new(environment, settings)?);
        match self {
            Self::Cpu => on_cpu(),
            #[cfg(feature = "gpu")]
            Self::Gpu { engine, may_fall_back } => {
                let on_gpu = async {
                    engine.check_fits(environment, settings, query.filter)?;
                    let reflector = octagloss_gpu::engine::GpuReflector::new(engine, environment, settings)?;
                    query.answers(&reflector).await
                };
                match octagloss_gpu::block_on(Some(engine.context()), on_gpu)? {
                    Ok(answers) => Ok(answers),
                    Err(error) => {
                        console.note(&fallback(error, *may_fall_back)?);
                        on_cpu()
                    }
                }
            }
        }
    }
}

/// One line per adapter, with its name for `--adapter`.
#[cfg(feature = "gpu")]
pub(super) fn list_adapters() -> Outcome<Vec<String>> {
    use octagloss_gpu::device::context::describe;
    use octagloss_gpu::{adapters, block_on};
    Ok(block_on(None, adapters())?.iter().map(|adapter| describe(&adapter.get_info())).collect())
}

#[cfg(not(feature = "gpu"))]
pub(super) fn list_adapters() -> Outcome<Vec<String>> {
    usage("built without the feature gpu")
}
