//! Runs a shading model's WGSL over many directions on the device, its tables made as a frame makes them.

use pelage::glam::{DVec3, Vec3};
use pelage::shading::Shading;
use pelage::{testing, wgpu};
use pelage_reference::fibre::{Direction, FibreModel};

use crate::common::Device;

/// One evaluation.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub tangent: DVec3,
    pub wi: DVec3,
    pub wo: DVec3,
    /// Fibres towards the light; the light that comes straight is e^-fibres.
    pub fibres: f64,
    pub strand: u32,
    /// Root-to-tip coordinate.
    pub coordinate: f64,
    /// The part of the fibre's width that is seen.
    pub across: [f64; 2],
}

/// The fibre's tangent and the first axis of its section, far from any axis of space.
pub fn frame() -> [DVec3; 2] {
    let tangent = DVec3::new(0.48, -0.6, 0.64).as_vec3().as_dvec3();
    [
        tangent,
        DVec3::new(0.8, 0.64, 0.0)
            .reject_from(tangent.normalize())
            .normalize(),
    ]
}

/// A direction by inclination and azimuth, as f32, as the device is given it.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let [tangent, first] = frame();
    let tangent = tangent.normalize();
    let second = tangent.cross(first);
    let v = Direction::new(theta, phi).to_vector();
    (tangent * v.x + first * v.y + second * v.z)
        .as_vec3()
        .as_dvec3()
}

/// The direction as the reference sees it.
pub fn seen(v: DVec3) -> Direction {
    let [tangent, first] = frame();
    Direction::in_frame(v, tangent.normalize(), first)
}

/// Light and eye at these angles, unshadowed.
pub fn case(theta_i: f64, theta_o: f64, phi: f64) -> Case {
    Case {
        tangent: frame()[0],
        wi: direction(theta_i, 0.2),
        wo: direction(theta_o, 0.2 + phi),
        fibres: 0.0,
        strand: 0,
        coordinate: 0.0,
        across: [-1.0, 1.0],
    }
}

/// Directions whose part across the tangent is smaller have no azimuth that an f32 could tell (6e-8 of 1): what they give must
/// be what the reference gives at some azimuth.
const ALONG: f64 = 1e-4;

/// Inclinations from end to end, the tangent itself and what is next to it, every azimuth that is special; and the mirror
/// cones of lobes at these sums of inclinations.
pub fn hard_cases(sums: &[f64]) -> Vec<Case> {
    let right = std::f64::consts::FRAC_PI_2;
    let pi = std::f64::consts::PI;
    let thetas = [
        -right,
        -right + 1e-6,
        -1.5,
        -0.9,
        -0.2,
        0.0,
        0.4,
        1.2,
        right - 1e-3,
        right,
    ];
    let phis = [0.0, 1e-4, 0.3, 1.0, 0.5 * pi, 2.0, 2.8, pi - 1e-3, pi];
    let mut cases = Vec::new();
    for theta_i in thetas {
        let mirrored = sums
            .iter()
            .map(|sum| sum - theta_i)
            .filter(|t| t.abs() <= right);
        for theta_o in thetas.into_iter().chain(mirrored) {
            // Along the tangent there is no azimuth.
            let phis = if theta_i.cos().min(theta_o.cos()) < ALONG {
                &phis[..1]
            } else {
                &phis[..]
            };
            cases.extend(phis.iter().map(|&phi| case(theta_i, theta_o, phi)));
        }
    }
    cases
}

fn bound(binding: u32, buffer: &wgpu::Buffer) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry {
        binding,
        resource: buffer.as_entire_binding(),
    }
}

/// Pipelines of one model, for any parameters.
pub struct Evaluator {
    gpu: wgpu::Device,
    queue: wgpu::Queue,
    evaluate: wgpu::ComputePipeline,
    tabulate: Option<wgpu::ComputePipeline>,
    has_tables: bool,
    /// Azimuths at which the reference is asked what a direction along the tangent may give; Chiang's far field, which is slow, has
    /// but R's wide lobe there.
    azimuths: u32,
}

impl Evaluator {
    pub fn new(device: &mut Device, shading: &Shading) -> Self {
        let entry = "
            @group(1) @binding(4) var<storage, read> cases: array<vec4f>;
            @group(1) @binding(5) var<storage, read_write> values: array<vec4f>;
            @group(1) @binding(6) var<storage, read> shading_tables: array<u32>;
            @compute @workgroup_size(64)
            fn evaluate(@builtin(global_invocation_id) invocation: vec3u,
                @builtin(num_workgroups) groups: vec3u) {
                let i = invocation.x + invocation.y * groups.x * 64u;
                if i * 4u >= arrayLength(&cases) { return; }
                let own = cases[4u * i + 3u];
                let fibre = Fibre(cases[4u * i].xyz, vec3f(1.0), own.y, u32(own.x), own.zw);
                let wo = cases[4u * i + 2u].xyz;
                let shadow = ShadowSample(vec3f(cases[4u * i + 1u].w), cases[4u * i].w);
                values[2u * i] = vec4f(scatter(fibre, cases[4u * i + 1u].xyz, wo, shadow), 0.0);
                values[2u * i + 1u] = vec4f(scatter_uniform(fibre, wo), 0.0);
            }";
        let gpu = device.renderer.device().clone();
        let pipeline = |label: &str, entry: &str, source: String| {
            let module = gpu.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
            gpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: None,
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        let has_tables = !matches!(shading, Shading::KajiyaKay(_) | Shading::Scheuermann(_));
        let tabulates = matches!(shading, Shading::Marschner(_) | Shading::Chiang(_));
        Self {
            evaluate: pipeline(
                "test.evaluate",
                "evaluate",
                testing::shading_source(shading) + entry,
            ),
            tabulate: tabulates.then(|| {
                pipeline(
                    "test.tabulate",
                    "shading_tabulate",
                    testing::tables_source(shading),
                )
            }),
            gpu: gpu.clone(),
            queue: device.renderer.queue().clone(),
            has_tables,
            azimuths: if matches!(shading, Shading::Chiang(_)) {
                8
            } else {
                64
            },
        }
    }

    fn buffer(&self, bytes: &[u8], size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.gpu.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size.max(256),
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        if !bytes.is_empty() {
            self.queue.write_buffer(&buffer, 0, bytes);
        }
        buffer
    }

    /// `scatter` and `scatter_uniform` of every case.
    pub fn run(&self, shading: &Shading, cases: &[Case]) -> Vec<[DVec3; 2]> {
        shading.validate().unwrap();
        use wgpu::BufferUsages as Usage;
        let (place, words, size) = testing::tables_of(shading, true);
        let mut material = testing::material_bytes(shading);
        let end = material.len();
        material[end - 16..].copy_from_slice(bytemuck::cast_slice(&place));
        let uniform = self.buffer(&material, material.len() as u64, Usage::UNIFORM);
        let tables = self.buffer(bytemuck::cast_slice(&words), size * 4, Usage::STORAGE);
        let input: Vec<[f32; 4]> = cases
            .iter()
            .flat_map(|case| {
                let straight = (-case.fibres).exp();
                let own = DVec3::new(f64::from(case.strand), case.coordinate, case.across[0]);
                [
                    (case.tangent, case.fibres),
                    (case.wi, straight),
                    (case.wo, 0.0),
                    (own, case.across[1]),
                ]
                .map(|(v, w)| v.as_vec3().extend(w as f32).into())
            })
            .collect();
        let inputs = self.buffer(
            bytemuck::cast_slice(&input),
            input.len() as u64 * 16,
            Usage::STORAGE,
        );
        let bytes = cases.len() as u64 * 32;
        let outputs = self.buffer(&[], bytes, Usage::STORAGE | Usage::COPY_SRC);
        let returned = self.buffer(&[], bytes, Usage::MAP_READ);
        let group = |pipeline: &wgpu::ComputePipeline, index, entries: &[wgpu::BindGroupEntry]| {
            self.gpu.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(index),
                entries,
            })
        };
        let mut encoder = self.gpu.create_command_encoder(&Default::default());
        if let Some(pipeline) = self.tabulate.as_ref().filter(|_| place[2] > 0) {
            let groups = [
                group(pipeline, 0, &[bound(2, &uniform)]),
                group(pipeline, 1, &[bound(0, &tables)]),
            ];
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &groups[0], &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            let entries = 2 * (place[2] & 0xffff).pow(2);
            pass.dispatch_workgroups(entries.div_ceil(64), 1, 1);
        }
        {
            let mut entries = vec![bound(4, &inputs), bound(5, &outputs)];
            if self.has_tables {
                entries.push(bound(6, &tables));
            }
            let groups = [
                group(&self.evaluate, 0, &[bound(2, &uniform)]),
                group(&self.evaluate, 1, &entries),
            ];
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.evaluate);
            pass.set_bind_group(0, &groups[0], &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            let columns = (cases.len() as u32).div_ceil(64);
            let rows = columns.div_ceil(32768);
            pass.dispatch_workgroups(columns.min(32768), rows, 1);
        }
        encoder.copy_buffer_to_buffer(&outputs, 0, &returned, 0, Some(bytes));
        self.queue.submit([encoder.finish()]);
        returned.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.gpu.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let values: Vec<f32> =
            bytemuck::pod_collect_to_vec(&returned.get_mapped_range(..).unwrap());
        values
            .chunks_exact(8)
            .take(cases.len())
            .map(|v| {
                [
                    Vec3::from_slice(&v[..3]).as_dvec3(),
                    Vec3::from_slice(&v[4..7]).as_dvec3(),
                ]
            })
            .collect()
    }

    /// The worst error of `scatter` against a model of the reference over unshadowed cases, of the largest value among them;
    /// and the case. Every value must be finite and not negative.
    pub fn worst(
        &self,
        name: &str,
        shading: &Shading,
        cases: &[Case],
        model: &impl FibreModel,
    ) -> f64 {
        let values = self.run(shading, cases);
        let (mut worst, mut at, mut peak) = (0.0f64, None, 0.0f64);
        for (case, [value, _]) in cases.iter().zip(values) {
            assert!(
                value.is_finite() && value.min_element() >= 0.0,
                "{name}: {value} at {case:?}"
            );
            let (wi, wo) = (seen(case.wi), seen(case.wo));
            let mut expected = model.scatter(wi, wo);
            if wi.cos_theta().min(wo.cos_theta()) < ALONG {
                let (mut low, mut high) = (expected, expected);
                for i in 0..=self.azimuths {
                    let phi =
                        wi.phi + std::f64::consts::PI * f64::from(i) / f64::from(self.azimuths);
                    let there = model.scatter(wi, Direction::new(wo.theta, phi));
                    (low, high) = (low.min(there), high.max(there));
                }
                expected = value.clamp(low, high);
            }
            peak = peak.max(expected.max_element());
            let off = (value - expected).abs().max_element();
            if off > worst {
                (worst, at) = (off, Some((wi, wo, value, expected)));
            }
        }
        let error = worst / peak;
        let place = at.map(|(wi, wo, value, expected)| {
            format!(
                "θ_i {:.4} θ_o {:.4} φ {:.4}: {value:.5} for {expected:.5}",
                wi.theta,
                wo.theta,
                wo.phi - wi.phi
            )
        });
        eprintln!(
            "{name}: worst {error:.2e} of the peak {peak:.3e} at {}",
            place.unwrap_or_default()
        );
        error
    }

    /// ∫ scatter dω_i at a view's inclination, by midpoints in both angles.
    pub fn furnace(&self, shading: &Shading, theta_o: f64, nodes: [usize; 2]) -> DVec3 {
        use std::f64::consts::{FRAC_PI_2, PI, TAU};
        let mut cases = Vec::new();
        let mut weights = Vec::new();
        for i in 0..nodes[0] {
            let theta = PI * (i as f64 + 0.5) / nodes[0] as f64 - FRAC_PI_2;
            for j in 0..nodes[1] {
                let phi = TAU * (j as f64 + 0.5) / nodes[1] as f64;
                cases.push(Case {
                    wi: direction(theta, phi),
                    ..case(0.0, theta_o, 0.0)
                });
                weights.push(theta.cos() * PI / nodes[0] as f64 * TAU / nodes[1] as f64);
            }
        }
        self.run(shading, &cases)
            .iter()
            .zip(weights)
            .map(|([value, _], weight)| *value * weight)
            .sum()
    }
}
