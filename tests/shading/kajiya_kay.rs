//! The WGSL of Kajiya-Kay, run over many directions, against the reference in f64.

use pelage::glam::{DVec3, Vec3, Vec4};
use pelage::shading::{KajiyaKay, Shading};
use pelage::{testing, wgpu};
use pelage_reference::kajiya_kay;

use crate::common::{Device, device};

/// One evaluation: tangent, to the light, to the eye.
type Case = [DVec3; 3];

fn bound(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry {
        binding,
        resource: buffer.as_entire_binding(),
    }
}

/// Runs `scatter` (xyz of the first) and `scatter_uniform` (the second) for every case.
fn evaluate(device: &mut Device, model: &KajiyaKay, cases: &[Case]) -> Vec<[Vec4; 2]> {
    let entry = "
        @group(1) @binding(4) var<storage, read> cases: array<vec4f>;
        @group(1) @binding(5) var<storage, read_write> values: array<vec4f>;
        @compute @workgroup_size(64)
        fn evaluate(@builtin(global_invocation_id) invocation: vec3u) {
            let i = invocation.x;
            if i * 3u >= arrayLength(&cases) { return; }
            let fibre = Fibre(cases[3u * i].xyz, vec3f(1.0, 0.5, 0.25), 0.0, 0u, vec2f(-1.0, 1.0));
            let wo = cases[3u * i + 2u].xyz;
            let lit = ShadowSample(vec3f(1.0), 0.0);
            values[2u * i] = vec4f(scatter(fibre, cases[3u * i + 1u].xyz, wo, lit), 0.0);
            values[2u * i + 1u] = vec4f(scatter_uniform(fibre, wo), 0.0);
        }";
    let source = testing::shading_source(&Shading::KajiyaKay(*model)) + entry;
    let input: Vec<[f32; 4]> = cases
        .iter()
        .flatten()
        .map(|v| v.as_vec3().extend(0.0).into())
        .collect();
    let gpu = device.renderer.device().clone();
    let queue = device.renderer.queue().clone();
    let module = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test.kajiya_kay"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = gpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("test.kajiya_kay"),
        layout: None,
        module: &module,
        entry_point: Some("evaluate"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |size: usize, usage| {
        gpu.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    use wgpu::BufferUsages as Usage;
    let material = testing::material_bytes(&Shading::KajiyaKay(*model));
    let uniform = buffer(material.len(), Usage::UNIFORM | Usage::COPY_DST);
    queue.write_buffer(&uniform, 0, &material);
    let inputs = buffer(input.len() * 16, Usage::STORAGE | Usage::COPY_DST);
    queue.write_buffer(&inputs, 0, bytemuck::cast_slice(&input));
    let outputs = buffer(cases.len() * 32, Usage::STORAGE | Usage::COPY_SRC);
    let returned = buffer(cases.len() * 32, Usage::MAP_READ | Usage::COPY_DST);
    let group = |index, entries: &[wgpu::BindGroupEntry]| {
        let layout = pipeline.get_bind_group_layout(index);
        gpu.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries,
        })
    };
    let groups = [
        group(0, &[bound(2, &uniform)]),
        group(1, &[bound(4, &inputs), bound(5, &outputs)]),
    ];
    let mut encoder = gpu.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &groups[0], &[]);
        pass.set_bind_group(1, &groups[1], &[]);
        pass.dispatch_workgroups(cases.len().div_ceil(64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&outputs, 0, &returned, 0, None);
    queue.submit([encoder.finish()]);
    returned.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    gpu.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(&returned.get_mapped_range(..).unwrap());
    values
        .chunks_exact(8)
        .map(|v| [Vec4::from_slice(&v[..4]), Vec4::from_slice(&v[4..])])
        .collect()
}

/// The exponents that the model takes, from end to end.
const EXPONENTS: [f32; 7] = [1.0, 2.0, 10.0, 60.0, 1e3, 1e4, 1e5];

/// Off the fibre by an angle, around it by another; as f32, as the GPU is given it.
fn direction(inclination: f64, azimuth: f64) -> DVec3 {
    let d = DVec3::new(
        inclination.sin() * azimuth.cos(),
        inclination.cos(),
        inclination.sin() * azimuth.sin(),
    );
    d.as_vec3().as_dvec3()
}

fn model(exponent: f32) -> KajiyaKay {
    KajiyaKay {
        diffuse: Vec3::new(0.3, 0.2, 0.1),
        specular: Vec3::new(0.05, 0.1, 0.4),
        exponent,
    }
}

/// An f32 direction is exact to 6e-8, an f32 cosine to 1.2e-7. sin = √(1 - cos²) near the tangent turns that into
/// √2.4e-7 = 5e-4 of the diffuse term; (1 - e)^m with e = 2.4e-7 and m = 1e5 into 2.4 % of the lobe.
fn tolerance(exponent: f32, sin_l: f64, sin_e: f64) -> f64 {
    let sine = |sin: f64| (1.2e-7 / sin.max(3.5e-4)).min(5e-4);
    let steepness = f64::from(exponent) * (2.4e-7 + sine(sin_l) * sin_e + sine(sin_e) * sin_l);
    1e-6 + 0.3 * sine(sin_l) + 0.4 * steepness.min(1.0)
}

#[test]
fn scatter_is_the_model_at_every_angle_and_exponent() {
    let Some(mut device) = device() else { return };
    let pi = std::f64::consts::PI;
    // Every tenth of π, and within a hair's breadth of the tangent.
    let near = [0.0, 1e-6, 1e-4, 1e-2];
    let inclinations: Vec<f64> = (1..10)
        .map(|i| f64::from(i) * 0.1 * pi)
        .chain(near)
        .chain(near.map(|angle| pi - angle))
        .chain([0.5 * pi + 1e-3])
        .collect();
    let mut cases = Vec::new();
    for &l in &inclinations {
        // Around the mirror cone too, where the lobe is.
        for e in inclinations
            .iter()
            .copied()
            .chain([pi - l + 1e-3, pi - l - 1e-2])
        {
            cases.extend(
                [0.0, 1.0, 3.0]
                    .map(|azimuth| [DVec3::Y, direction(l, 0.3), direction(e, 0.3 + azimuth)]),
            );
        }
    }
    let colour = [1.0, 0.5, 0.25];
    for exponent in EXPONENTS {
        let model = model(exponent);
        let mut worst = 0.0f64;
        for (case, [value, _]) in cases.iter().zip(evaluate(&mut device, &model, &cases)) {
            let [tangent, l, e] = *case;
            for channel in 0..3 {
                let own = kajiya_kay::KajiyaKay {
                    diffuse: f64::from(model.diffuse[channel]) * colour[channel],
                    specular: f64::from(model.specular[channel]),
                    exponent: f64::from(exponent),
                };
                let expected = kajiya_kay::scatter(tangent, l, e, &own);
                let off = (f64::from(value[channel]) - expected).abs();
                worst = worst.max(off);
                let allowed = tolerance(
                    exponent,
                    tangent.cross(l).length(),
                    tangent.cross(e).length(),
                );
                assert!(
                    off <= allowed,
                    "m {exponent}, {case:?}: {} is not {expected} to {allowed:e}",
                    value[channel]
                );
            }
        }
        eprintln!("kajiya_kay m {exponent}: worst {worst:e}");
    }
}

/// The term leaves out the lobe's cut at grazing angles, k_s 2π cos θ_o ∫₀^θ_o sin^(m+1), at most k_s 2π / (m + 2).
/// (That is 0.4/√m of the lobe's greatest integral.) All else is f32's own rounding.
fn uniform_tolerance(expected: f64, specular: f64, exponent: f32) -> f64 {
    1e-4 * expected + specular * 2.0 * std::f64::consts::PI / f64::from(exponent + 2.0)
}

#[test]
fn the_ambient_term_is_the_integral_of_the_model_over_the_sphere() {
    let Some(mut device) = device() else { return };
    let pi = std::f64::consts::PI;
    let eyes: Vec<f64> = [0.0, 0.02, 0.1, 0.3, 0.7, 1.0, 1.3, 0.5 * pi].to_vec();
    let cases: Vec<Case> = eyes
        .iter()
        .map(|&e| [DVec3::Y, DVec3::X, direction(e, 0.4)])
        .collect();
    for exponent in EXPONENTS {
        let model = model(exponent);
        let values = evaluate(&mut device, &model, &cases);
        let mut worst = 0.0f64;
        for (case, [_, value]) in cases.iter().zip(values) {
            let channel = 2;
            let own = kajiya_kay::KajiyaKay {
                diffuse: f64::from(model.diffuse[channel]) * 0.25,
                specular: f64::from(model.specular[channel]),
                exponent: f64::from(exponent),
            };
            // The model does not depend on azimuth: ∫ f dω = 2π ∫ f sin θ dθ, by the midpoint rule, which with a
            // lobe of width 1/√m takes many points.
            let steps = 400_000;
            let step = pi / f64::from(steps);
            let expected: f64 = (0..steps)
                .map(|i| {
                    let theta = (f64::from(i) + 0.5) * step;
                    let l = DVec3::new(theta.sin(), theta.cos(), 0.0);
                    kajiya_kay::scatter(case[0], l, case[2], &own) * theta.sin()
                })
                .sum::<f64>()
                * step
                * 2.0
                * pi;
            let off = f64::from(value[channel]) - expected;
            let allowed = uniform_tolerance(expected, own.specular, exponent);
            worst = worst.max(off.abs() / expected);
            assert!(
                off.abs() <= allowed,
                "m {exponent}, eye {:?}: {} is not {expected}",
                case[2],
                value[channel]
            );
        }
        eprintln!("kajiya_kay ambient, m {exponent}: worst {worst:e} of the integral");
    }
}
