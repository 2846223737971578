//! Probes in shared buffers: what one look-up reads of any of them, against environments with buffers of
//! their own.

use crate::live::{Answer, look_ups as look_ups_of, shader_of};
use glam::DMat3;
use octagloss_core::common::error::Error;
use octagloss_core::light::environment::Layout;
use octagloss_fixtures::adapters::in_full;
use octagloss_fixtures::common::{Look, Random, environment, landmarks, texels};
use octagloss_gpu::Context;
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::live_probes::LiveProbes;

const SIZE: u32 = 64;
const COUNT: u32 = 3;

/// The mirror, sharp levels, wide ones, harmonics.
const ROUGHNESS: [f64; 5] = [0.0, 0.15, 0.4, 0.7, 0.9];

/// Answers of all probes by the look-up `source` at each of `roughness`, which shaders see as the expression
/// `seen`: probe by probe and roughness by roughness.
fn answers_of(
    context: &Context,
    source: &str,
    probes: &LiveProbes,
    (seen, roughness): (&str, &[f64]),
) -> Vec<Vec<Answer>> {
    let look_ups = format!(
        "for (var probe = 0u; probe < {COUNT}u; probe++) {{
            let own = at.x * {COUNT}u + probe;
            answers[own][0] = vec4<f32>(octagloss_radiance_of(probe, direction, {seen}), 1.0);
            answers[own][1] = vec4<f32>(octagloss_irradiance_of(probe, direction), 1.0);
        }}"
    );
    let source = source.to_owned() + &shader_of(1, &look_ups);
    let look_ups = look_ups_of(context, source, &[probes.bind_group_layout()], u64::from(COUNT));
    let at = |roughness| look_ups.answers(context, &[probes.bind_group()], &landmarks(), roughness);
    let found: Vec<Vec<Answer>> = roughness.iter().copied().map(at).collect();
    let of_probe = |probe| {
        let all = found.iter().flat_map(|found| found.iter().skip(probe).step_by(COUNT as usize));
        all.copied().collect()
    };
    (0..COUNT as usize).map(of_probe).collect()
}

fn update(context: &Context, live: &mut LiveEnvironment, texture: &wgpu::Texture, turn: f64) {
    live.set_rotation(DMat3::from_rotation_y(turn)).expect("a rotation");
    let mut encoder = context.device().create_command_encoder(&Default::default());
    live.update(&mut encoder, texture).expect("an environment");
    context.queue().submit([encoder.finish()]);
}

#[test]
fn one_look_up_reads_any_probe_as_if_it_were_alone() {
    in_full("probes in shared buffers", |context| {
        let mut random = Random::new(53);
        let layout = Layout::Cube { size: 16 };
        let mut light = || environment(layout, texels(&mut random, Look::Suns, layout));
        let lights = [light(), light(), light()];
        let turns = [0.0, 0.7, -2.0];
        let (device, queue) = (context.device(), context.queue());
        let mut alone = LiveEnvironment::new(device, queue, SIZE).expect("small tables");
        let textures = lights.each_ref().map(|light| alone.upload(light).expect("a small texture"));
        // With buffers of its own.
        let source = LiveEnvironment::wgsl(0);
        let look_up = "answers[at.x][0] = vec4<f32>(octagloss_radiance(direction, roughness), 1.0);
            answers[at.x][1] = vec4<f32>(octagloss_irradiance(direction), 1.0);";
        let source = source + &shader_of(1, look_up);
        let single = look_ups_of(context, source, &[alone.bind_group_layout()], 1);
        let at_all = |group: &wgpu::BindGroup| -> Vec<Answer> {
            let at = |roughness| single.answers(context, &[group], &landmarks(), roughness);
            ROUGHNESS.into_iter().flat_map(at).collect()
        };
        let expected: Vec<Vec<Answer>> = textures
            .iter()
            .zip(turns)
            .map(|(texture, turn)| {
                update(context, &mut alone, texture, turn);
                at_all(alone.bind_group())
            })
            .collect();
        assert!(expected[0] != expected[1] && expected[1] != expected[2], "the lights differ");

        let mut probes = LiveProbes::new(device, queue, SIZE, COUNT).expect("small tables");
        for probe in [2, 0, 1] {
            update(context, &mut probes[probe], &textures[probe], turns[probe]);
        }
        // The same code over the same words.
        let source = LiveProbes::wgsl(0);
        let all = ("roughness", &ROUGHNESS[..]);
        let found = answers_of(context, &source, &probes, all);
        assert!(found == expected, "on {}", context.describe());
        // By the group of each, a probe is an environment like any other.
        for (probe, expected) in probes.iter().zip(&expected) {
            assert!(at_all(probe.bind_group()) == *expected, "on {}", context.describe());
        }
        // An update leaves the others as they are.
        update(context, &mut probes[1], &textures[0], turns[0]);
        let found = answers_of(context, &source, &probes, all);
        assert!([&found[0], &found[1], &found[2]] == [&expected[0], &expected[0], &expected[2]]);
        // Wrong places of entries, layers, lights and rotations show.
        update(context, &mut probes[1], &textures[1], turns[1]);
        for (right, wrong, seen) in [
            ("octagloss_SQUARES * probe + layer", "layer", "0.0"),
            ("octagloss_SQUARES * probe + layer", "layer", "0.1"),
            ("octagloss_SQUARES * probe + layer", "layer", "0.4"),
            ("octagloss_lights[probe].suns", "octagloss_lights[0].suns", "0.4"),
            ("octagloss_lights[probe].harmonics", "octagloss_lights[0].harmonics", "0.4"),
            ("octagloss_lights[probe].world_from_source", "octagloss_lights[0].world_from_source", "0.0"),
        ] {
            assert!(source.contains(right), "{right}");
            let [good, bad] = [source.clone(), source.replace(right, wrong)]
                .map(|source| answers_of(context, &source, &probes, (seen, &[0.0])));
            assert!(good[0] == bad[0], "{wrong}: the first probe is at 0");
            assert!(good[1] != bad[1] && good[2] != bad[2], "{wrong}");
        }
    });
}

#[test]
fn probes_reflect_as_if_they_were_alone() {
    in_full("reflections of probes", |context| {
        let mut random = Random::new(54);
        let layout = Layout::Cube { size: 16 };
        let mut light = || environment(layout, texels(&mut random, Look::Suns, layout));
        let lights = [light(), light()];
        let (device, queue) = (context.device(), context.queue());
        let mut probes = LiveProbes::new(device, queue, SIZE, 2).expect("small tables");
        for (probe, light) in lights.iter().enumerate() {
            let texture = probes[probe].upload(light).expect("a small texture");
            update(context, &mut probes[probe], &texture, probe as f64);
        }
        // Views and tangents that differ from the normal, without anisotropy and with it.
        let asked = "direction, direction + vec3<f32>(0.3, 0.5, -0.2), vec3<f32>(0.8, 0.1, 0.6), roughness";
        let reflected = |call: &str, at: &str| {
            format!(
                "answers[{at}][0] = vec4<f32>({call}{asked}, 0.0, vec3<f32>(1.0), 1.0), 1.0);
                answers[{at}][1] = vec4<f32>({call}{asked}, 0.6, vec3<f32>(1.0), 1.0), 1.0);"
            )
        };
        let alone =
            LiveEnvironment::reflect_wgsl(0) + &shader_of(1, &reflected("octagloss_reflect(", "at.x"));
        let layout = probes.reflect_bind_group_layout();
        let single = look_ups_of(context, alone, &[&layout], 1);
        let expected = [0, 1].map(|probe| {
            let group = probes[probe].reflect_bind_group_of(&layout);
            single.answers(context, &[&group], &landmarks(), 0.4)
        });
        for (probe, expected) in expected.iter().enumerate() {
            let call = format!("octagloss_reflect_of({probe}u, ");
            let source = LiveProbes::reflect_wgsl(0) + &shader_of(1, &reflected(&call, "at.x"));
            let of_all = look_ups_of(context, source, &[&layout], 1);
            let group = probes.reflect_bind_group_of(&layout);
            let found = of_all.answers(context, &[&group], &landmarks(), 0.4);
            assert!(found == *expected, "probe {probe} on {}", context.describe());
            // The two reflections differ, but for normals along the tangent, and so do the lights.
            let brushed = found.iter().filter(|[round, brushed]| round != brushed).count();
            assert!(brushed > found.len() / 2, "{brushed} of {} with anisotropy", found.len());
        }
        assert!(expected[0] != expected[1], "the lights differ");
    });
}

#[test]
fn more_probes_than_a_binding_holds_are_refused() {
    in_full("too many probes", |context| {
        let new = |size, count| LiveProbes::new(context.device(), context.queue(), size, count);
        for count in [0, LiveProbes::MAX + 1] {
            let error = new(SIZE, count).expect_err("no such number");
            let message = format!("`count` is {count} environments; choose 1 to 64");
            assert!(matches!(&error, Error::Parameter(text) if *text == message), "{error}");
        }
        for size in [0, 2049, u32::MAX] {
            let error = new(size, 2).expect_err("no such map").to_string();
            assert!(error.contains(&format!("`size` is {size}; choose 1 to 2048")), "{error}");
        }
    });
}
