//! What is measured: each technique over a ladder of its settings.

use std::fmt;

use pelage::Raster;
use pelage::glam::Vec3;
use pelage::shading::{
    Chiang, DualScattering, KajiyaKay, Marschner, Precision, Roots, Sadeghi, Scheuermann, Shading,
    ShadingRate, Tables,
};
use pelage::shadow::{
    ApproximatedDeepShadowMap, DeepOpacityMap, KBufferVolume, MomentOpacityMap, OpacityShadowMaps,
    Shadow, ShadowMap,
};
use pelage::transparency::{
    ABuffer, Atomics, BlendOrder, Culling, DbkBuffer, DepthPeeling, KBuffer, KBufferSinglePass,
    KPlusBuffer, Moment, Opaque, RandomSubsets, Rest, Selection, SortedBlending, Storage,
    Transparency, Weight, WeightedBlended,
};
use serde_json::Value;

use super::Group;
use super::scenes::{Extent, Scene};
use crate::scene_file::techniques;

/// Tolerances of the DBK-buffer; of each the reference knows the fewest fragments.
pub const EPSILONS: [f32; 4] = [1.0 / 16.0, 1.0 / 64.0, 1.0 / 256.0, 1.0 / 1024.0];

/// What pictures of transparency are shaded by.
pub fn picture_shading() -> Shading {
    white(0.09, 60.0)
}

/// One technique with its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The kind of technique.
    pub group: Group,
    /// The shading model.
    pub shading: Shading,
    /// The shadow technique of the light.
    pub shadow: Shadow,
    /// The transparency technique.
    pub transparency: Transparency,
    /// Where the model is evaluated, in cases that compare rates: a picture's truth is then shaded at fragments.
    pub rate: Option<ShadingRate>,
    /// The pool as a part of what all fragments need; it becomes `pool_bytes` when that is known.
    pub pool: Option<f64>,
    /// The depth shift as a part of the groom's extent along the view; it becomes `depth_shift` when that is known.
    pub shift: Option<f64>,
    /// Whether frames take the shadow maps of those before them, as they do of themselves; in cases that time whole frames.
    pub reuse: bool,
}

impl Case {
    /// The stem of the technique that is measured.
    pub fn technique(&self) -> &'static str {
        match self.group {
            Group::Shading | Group::Samples | Group::Frames => self.shading.stem(),
            Group::Shadow => self.shadow.stem(),
            Group::Transparency => self.transparency.stem(),
        }
    }

    /// The measured technique's settings, as in a scene file but for the stem.
    pub fn settings(&self) -> Value {
        let mut settings = match self.group {
            Group::Shading | Group::Samples | Group::Frames => {
                techniques::shading_settings(&self.shading)
            }
            Group::Shadow => techniques::shadow_settings(&self.shadow),
            Group::Transparency => techniques::transparency_settings(&self.transparency),
        };
        if let Value::Object(map) = &mut settings {
            map.shift_remove("technique");
            map.shift_remove("model");
            map.retain(|_, value| !value.is_null());
            if let Some(rate) = self.rate {
                map.insert("rate".into(), techniques::rate_setting(rate));
            }
            if let Some(part) = self.pool {
                map.insert("pool_part".into(), part.into());
            }
            if let Some(part) = self.shift {
                map.insert("shift_part".into(), part.into());
            }
            if self.group == Group::Frames {
                map.insert("shadow".into(), self.shadow.stem().into());
            }
            if self.reuse {
                map.insert("shadow_reuse".into(), true.into());
            }
        }
        settings
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} {}", self.technique(), self.settings())
    }
}

/// White fibres of even brightness, so that errors are parts of white.
fn white(specular: f32, exponent: f32) -> Shading {
    Shading::KajiyaKay(KajiyaKay {
        diffuse: Vec3::splat(std::f32::consts::FRAC_1_PI),
        specular: Vec3::splat(specular),
        exponent,
    })
}

/// Table sizes and Chiang's intervals of a ladder of models.
struct Steps<'a> {
    tables: &'a [(u32, Precision)],
    intervals: &'a [u32],
}

/// Of pictures: enough to see that tables of the usual size are no worse than no tables.
const PICTURE_STEPS: Steps = Steps {
    tables: &[
        (32, Precision::F32),
        (64, Precision::F32),
        (128, Precision::F32),
        (256, Precision::F32),
        (512, Precision::F32),
        (64, Precision::F16),
        (256, Precision::F16),
    ],
    intervals: &[16, 128],
};

/// Of samples: every size in both formats.
const SAMPLE_STEPS: Steps = Steps {
    tables: &[
        (32, Precision::F32),
        (64, Precision::F32),
        (128, Precision::F32),
        (256, Precision::F32),
        (512, Precision::F32),
        (32, Precision::F16),
        (64, Precision::F16),
        (128, Precision::F16),
        (256, Precision::F16),
        (512, Precision::F16),
    ],
    intervals: &[8, 16, 32, 64, 128],
};

fn marschner(tables: Option<Tables>) -> Marschner {
    Marschner {
        tables,
        ..Marschner::default()
    }
}

fn chiang(tables: Option<Tables>) -> Chiang {
    Chiang {
        tables,
        ..Chiang::default()
    }
}

/// Sadeghi's model with one glint angle for all strands, as the reference has it.
fn sadeghi(normalised: bool) -> Sadeghi {
    Sadeghi {
        glint_angle: [0.65; 2],
        normalised,
        ..Sadeghi::default()
    }
}

/// Every model but Kajiya-Kay's, directly and through tables.
fn fibre_models(steps: &Steps) -> Vec<Shading> {
    let tables = || {
        let table = |&(size, precision): &(u32, Precision)| Tables { size, precision };
        steps.tables.iter().map(table)
    };
    let cubic = Marschner {
        roots: Roots::Cubic,
        ..marschner(None)
    };
    let mut models = vec![
        Shading::Scheuermann(Scheuermann::default()),
        Shading::Marschner(marschner(None)),
    ];
    models.extend(tables().map(|t| Shading::Marschner(marschner(Some(t)))));
    models.push(Shading::Marschner(cubic));
    models.extend([false, true].map(|normalised| Shading::Sadeghi(sadeghi(normalised))));
    models.extend(steps.intervals.iter().map(|&intervals| {
        Shading::Chiang(Chiang {
            intervals,
            ..chiang(None)
        })
    }));
    models.extend(tables().map(|t| Shading::Chiang(chiang(Some(t)))));
    models
}

/// Where a model may be evaluated.
const RATES: [ShadingRate; 2] = [ShadingRate::Point, ShadingRate::Fragment];

/// The models that are measured at both rates: the cheapest, and two through tables of the usual size.
fn rated_models(dual_scattering: Option<DualScattering>) -> [Shading; 3] {
    let tables = Some(Tables::default());
    [
        white(0.09, 60.0),
        Shading::Marschner(Marschner {
            dual_scattering,
            ..marschner(tables)
        }),
        Shading::Chiang(Chiang {
            dual_scattering,
            ..chiang(tables)
        }),
    ]
}

/// Every model as a host has it without asking for more, and directly, where it has tables; the first is that to which all
/// are held. With `dual_scattering` those that have it.
fn frame_models(dual_scattering: Option<DualScattering>) -> Vec<Shading> {
    let [kajiya_kay, by_tables, chiang_by_tables] = rated_models(dual_scattering);
    let mut models = vec![kajiya_kay];
    if dual_scattering.is_none() {
        models.push(Shading::Scheuermann(Scheuermann::default()));
    }
    models.extend([
        by_tables,
        Shading::Marschner(Marschner {
            dual_scattering,
            ..marschner(None)
        }),
        Shading::Sadeghi(Sadeghi {
            dual_scattering,
            ..sadeghi(true)
        }),
        chiang_by_tables,
        Shading::Chiang(Chiang {
            dual_scattering,
            ..chiang(None)
        }),
    ]);
    models
}

/// Every shadow technique.
fn shadows(quick: bool) -> Vec<Shadow> {
    let resolutions: &[u32] = if quick {
        &[256, 512]
    } else {
        &[128, 256, 512, 1024]
    };
    let mut shadows = Vec::new();
    for &resolution in resolutions {
        for pcf in [1, 3, 5] {
            shadows.push(Shadow::ShadowMap(ShadowMap {
                resolution,
                pcf,
                ..ShadowMap::default()
            }));
        }
    }
    // The strength that Hunz (§6.2.1) ends up with.
    shadows.push(Shadow::ShadowMap(ShadowMap {
        strength: 0.6,
        ..ShadowMap::default()
    }));
    for &resolution in resolutions {
        for pcf in [1, 3, 5] {
            shadows.push(Shadow::ApproximatedDeepShadowMap(
                ApproximatedDeepShadowMap {
                    resolution,
                    pcf,
                    ..ApproximatedDeepShadowMap::default()
                },
            ));
        }
    }
    for &resolution in resolutions {
        // As many planes as one binding of a software driver holds.
        let fits = |layers: &u32| resolution.pow(2) * layers <= 1 << 25;
        for layers in [16, 64, 256].into_iter().filter(fits) {
            for pcf in [1, 3] {
                shadows.push(Shadow::OpacityShadowMaps(OpacityShadowMaps {
                    resolution,
                    layers,
                    pcf,
                    ..OpacityShadowMaps::default()
                }));
            }
        }
    }
    for layers in [16, 64] {
        shadows.push(Shadow::OpacityShadowMaps(OpacityShadowMaps {
            layers,
            unevenness: 0.5,
            ..OpacityShadowMaps::default()
        }));
    }
    for &resolution in resolutions {
        for layers in [2, 4, 8, 16] {
            for pcf in [1, 3] {
                shadows.push(Shadow::DeepOpacityMap(DeepOpacityMap {
                    resolution,
                    layers,
                    pcf,
                    ..DeepOpacityMap::default()
                }));
            }
        }
    }
    shadows.extend(volume_shadows(resolutions));
    shadows
}

/// Moment opacity maps and k-buffer volumes over their settings.
fn volume_shadows(resolutions: &[u32]) -> Vec<Shadow> {
    let mut shadows = Vec::new();
    for &resolution in resolutions {
        for pcf in [1, 3] {
            shadows.extend([4, 6].map(|moments| {
                Shadow::MomentOpacityMap(MomentOpacityMap {
                    resolution,
                    moments,
                    pcf,
                    ..MomentOpacityMap::default()
                })
            }));
        }
        // 64 events of 1024² texels are more than a binding holds.
        for k in [4, 8, 16, 64]
            .into_iter()
            .filter(|k| resolution * resolution * k <= 1 << 24)
        {
            shadows.extend([false, true].map(|tail| {
                Shadow::KBufferVolume(KBufferVolume {
                    resolution,
                    k,
                    tail,
                    ..KBufferVolume::default()
                })
            }));
        }
    }
    shadows
}

/// The cases of a scene, in the order of the tables. `quick` leaves out the slowest.
pub fn cases(scene: &Scene, quick: bool) -> Vec<Case> {
    let of = |extent| move |case: &Case| scene.extent(case.group) == Some(extent);
    let large = scene.fragments > SMALL_SCENE;
    let by_walk = |case: &Case| {
        of(Extent::LadderByWalk)(case) && case.transparency.raster() != Raster::Ribbons
    };
    let mut cases: Vec<Case> = ladder(quick)
        .into_iter()
        .filter(|case| of(Extent::Ladder)(case) || by_walk(case))
        .filter(|case| !(large && is_slow(case)))
        .collect();
    cases.extend(defaults().into_iter().filter(of(Extent::Defaults)));
    cases
}

/// Millions of fragments of a scene on which even the slowest settings are measured.
const SMALL_SCENE: f64 = 5.0;

/// Whether a frame takes many seconds on a large scene.
fn is_slow(case: &Case) -> bool {
    match case.transparency {
        Transparency::DepthPeeling(settings) => settings.peels > 8,
        Transparency::KBufferSinglePass(settings) => settings.k > 16,
        _ => false,
    }
}

/// Every shadow and transparency technique with its default settings.
fn defaults() -> Vec<Case> {
    let base = Case {
        group: Group::Transparency,
        shading: picture_shading(),
        shadow: Shadow::None,
        transparency: Transparency::default(),
        rate: None,
        pool: None,
        shift: None,
        reuse: false,
    };
    let shadow = Case {
        group: Group::Shadow,
        shading: white(0.0, 60.0),
        shadow: Shadow::default(),
        transparency: Transparency::Opaque(Opaque::default()),
        ..base.clone()
    };
    let shadows = default_shadows().into_iter();
    let mut cases: Vec<Case> = shadows
        .map(|technique| Case {
            shadow: technique,
            ..shadow.clone()
        })
        .collect();
    cases.extend(default_techniques().map(|transparency| Case {
        transparency,
        ..base.clone()
    }));
    cases
}

/// Every shadow technique as a host has it without asking for more.
fn default_shadows() -> [Shadow; 6] {
    [
        Shadow::ShadowMap(ShadowMap::default()),
        Shadow::ApproximatedDeepShadowMap(ApproximatedDeepShadowMap::default()),
        Shadow::OpacityShadowMaps(OpacityShadowMaps::default()),
        Shadow::DeepOpacityMap(DeepOpacityMap::default()),
        Shadow::KBufferVolume(KBufferVolume::default()),
        Shadow::MomentOpacityMap(MomentOpacityMap::default()),
    ]
}

/// Every transparency technique as a host has it without asking for more.
fn default_techniques() -> impl Iterator<Item = Transparency> {
    [
        Transparency::Opaque(Opaque::default()),
        Transparency::WeightedBlended(WeightedBlended::default()),
        Transparency::RandomSubsets(RandomSubsets::default()),
        Transparency::SortedBlending(SortedBlending::default()),
        Transparency::Moment(Moment::default()),
        Transparency::DepthPeeling(DepthPeeling::default()),
        Transparency::KPlusBuffer(KPlusBuffer::default()),
        Transparency::KBufferSinglePass(KBufferSinglePass::default()),
        Transparency::KBuffer(KBuffer::default()),
        Transparency::ABuffer(ABuffer::default()),
        Transparency::DbkBuffer(DbkBuffer::default()),
        Transparency::DbkBuffer(DbkBuffer {
            culling: Culling::Always,
            ..DbkBuffer::default()
        }),
    ]
    .into_iter()
}

/// Every technique over the ladder of its settings.
fn ladder(quick: bool) -> Vec<Case> {
    let base = Case {
        group: Group::Shading,
        shading: picture_shading(),
        shadow: Shadow::None,
        transparency: Transparency::Opaque(Opaque::default()),
        rate: None,
        pool: None,
        shift: None,
        reuse: false,
    };
    let mut cases = Vec::new();
    for exponent in [10.0, 60.0, 300.0] {
        cases.push(Case {
            shading: white(0.09, exponent),
            ..base.clone()
        });
    }
    let opaque = |group, shading, shadow, rate| Case {
        group,
        shading,
        shadow,
        rate,
        ..base.clone()
    };
    cases.extend(
        fibre_models(&PICTURE_STEPS)
            .into_iter()
            .map(|shading| opaque(Group::Shading, shading, Shadow::None, None)),
    );
    for shading in rated_models(None) {
        cases.extend(RATES.map(|rate| opaque(Group::Shading, shading, Shadow::None, Some(rate))));
    }
    cases.extend(
        std::iter::once(base.shading)
            .chain(fibre_models(&SAMPLE_STEPS))
            .map(|shading| opaque(Group::Samples, shading, Shadow::None, None)),
    );
    cases.extend(
        shadows(quick)
            .into_iter()
            .map(|shadow| opaque(Group::Shadow, white(0.0, 60.0), shadow, None)),
    );
    for (dual, shadow) in [
        (None, Shadow::None),
        (
            Some(DualScattering::default()),
            Shadow::DeepOpacityMap(DeepOpacityMap::default()),
        ),
    ] {
        for shading in frame_models(dual) {
            let rates = RATES.map(Some);
            let rates = if rated_models(dual).contains(&shading) {
                &rates[..]
            } else {
                &rates[..1]
            };
            let rated = |rate: &Option<ShadingRate>| opaque(Group::Frames, shading, shadow, *rate);
            cases.extend(rates.iter().map(rated));
        }
    }
    // What moving nothing but the camera costs, beside the same frame with everything new.
    cases.push(Case {
        reuse: true,
        ..opaque(
            Group::Frames,
            rated_models(Some(DualScattering::default()))[0],
            Shadow::DeepOpacityMap(DeepOpacityMap::default()),
            Some(ShadingRate::Point),
        )
    });
    let base = Case {
        group: Group::Transparency,
        ..base
    };
    for raster in [Raster::Walk, Raster::Ribbons] {
        cases.push(Case {
            transparency: Transparency::Opaque(Opaque { raster }),
            ..base.clone()
        });
    }
    for storage in [Storage::Counted, Storage::Lists] {
        for raster in [Raster::Walk, Raster::Ribbons] {
            let a_buffer = ABuffer {
                storage,
                raster,
                pool_bytes: None,
            };
            cases.push(Case {
                transparency: Transparency::ABuffer(a_buffer),
                ..base.clone()
            });
        }
        for pool in [0.5, 0.1] {
            let a_buffer = ABuffer {
                storage,
                raster: Raster::Walk,
                pool_bytes: None,
            };
            cases.push(Case {
                transparency: Transparency::ABuffer(a_buffer),
                pool: Some(pool),
                ..base.clone()
            });
        }
    }
    cases.extend(k_buffers().into_iter().map(|(k_buffer, pool)| Case {
        transparency: Transparency::KBuffer(k_buffer),
        pool,
        ..base.clone()
    }));
    cases.extend(k_plus_buffers().into_iter().map(|k_plus_buffer| Case {
        transparency: Transparency::KPlusBuffer(k_plus_buffer),
        ..base.clone()
    }));
    cases.extend(single_passes().into_iter().map(|(single_pass, pool)| Case {
        transparency: Transparency::KBufferSinglePass(single_pass),
        pool,
        ..base.clone()
    }));
    for raster in [Raster::Walk, Raster::Ribbons] {
        cases.push(Case {
            transparency: Transparency::Moment(Moment { raster }),
            ..base.clone()
        });
    }
    cases.push(Case {
        transparency: Transparency::DbkBuffer(DbkBuffer::default()),
        ..base.clone()
    });
    for epsilon in EPSILONS {
        cases.push(Case {
            transparency: Transparency::DbkBuffer(DbkBuffer {
                culling: Culling::Always,
                epsilon,
                ..DbkBuffer::default()
            }),
            ..base.clone()
        });
    }
    for shift in [0.1, 0.25, 0.5] {
        cases.push(Case {
            transparency: Transparency::DbkBuffer(DbkBuffer::default()),
            shift: Some(shift),
            ..base.clone()
        });
    }
    let others = blended(quick);
    cases.extend(others.into_iter().map(|transparency| Case {
        transparency,
        ..base.clone()
    }));
    cases
}

/// The techniques that keep a bounded part of a pixel's fragments, or none.
fn blended(quick: bool) -> Vec<Transparency> {
    let mut ladder = Vec::new();
    let weights = [2.0, 4.0, 8.0, 16.0].map(|falloff| Weight::Exponential { falloff });
    for weight in [Weight::Uniform, Weight::Cubic].into_iter().chain(weights) {
        ladder.push(Transparency::WeightedBlended(WeightedBlended {
            weight,
            ..Default::default()
        }));
    }
    let peels: &[u32] = if quick {
        &[1, 4]
    } else {
        &[1, 2, 4, 8, 16, 64, 256]
    };
    for &peels in peels {
        ladder.push(Transparency::DepthPeeling(DepthPeeling {
            peels,
            ..Default::default()
        }));
    }
    for subsets in [2, 4, 8, 16] {
        for exact_alpha in [false, true] {
            ladder.push(Transparency::RandomSubsets(RandomSubsets {
                subsets,
                exact_alpha,
                ..Default::default()
            }));
        }
    }
    for bins in [16, 64, 256, 1024, 4096] {
        ladder.push(Transparency::SortedBlending(SortedBlending {
            bins,
            ..Default::default()
        }));
    }
    for (order, full_precision, reuse) in [
        (BlendOrder::FrontToBack, false, 0),
        (BlendOrder::BackToFront, true, 0),
        (BlendOrder::BackToFront, false, 1_000_000),
    ] {
        ladder.push(Transparency::SortedBlending(SortedBlending {
            order,
            full_precision,
            reuse,
            ..Default::default()
        }));
    }
    ladder
}

/// The k⁺-buffer over K by 64-bit atomics, at its own K by 32-bit ones, and with what becomes of the rest.
fn k_plus_buffers() -> Vec<KPlusBuffer> {
    let base = KPlusBuffer {
        raster: Raster::Walk,
        ..KPlusBuffer::default()
    };
    let mut ladder: Vec<_> = [2, 4, 8, 16, 32, 64]
        .map(|k| KPlusBuffer { k, ..base })
        .into();
    ladder.push(KPlusBuffer {
        atomics: Atomics::Bits32,
        ..base
    });
    ladder.extend([Rest::Merged, Rest::Dropped].map(|rest| KPlusBuffer { rest, ..base }));
    ladder
}

/// The single-pass k-buffer over K, and with small pools.
fn single_passes() -> Vec<(KBufferSinglePass, Option<f64>)> {
    let base = KBufferSinglePass {
        raster: Raster::Walk,
        ..KBufferSinglePass::default()
    };
    let mut ladder: Vec<_> = [2, 4, 8, 16, 32, 64]
        .map(|k| (KBufferSinglePass { k, ..base }, None))
        .into();
    ladder.extend([0.5, 0.1].map(|pool| (base, Some(pool))));
    ladder
}

/// The k-buffer over K, with what becomes of the rest, by each selection (Yu et al. 2012, §6.1), and with small pools.
fn k_buffers() -> Vec<(KBuffer, Option<f64>)> {
    let base = KBuffer {
        raster: Raster::Walk,
        ..KBuffer::default()
    };
    let mut ladder = Vec::new();
    for k in [2, 4, 8, 16, 32, 64] {
        ladder.push((KBuffer { k, ..base }, None));
        if k == 16 || k == 64 {
            let others = [Selection::Rounds, Selection::Sort];
            ladder.extend(others.map(|selection| {
                (
                    KBuffer {
                        k,
                        selection,
                        ..base
                    },
                    None,
                )
            }));
        }
    }
    for rest in [Rest::Alpha, Rest::Dropped] {
        ladder.extend([4, 8, 16].map(|k| (KBuffer { k, rest, ..base }, None)));
    }
    ladder.extend([0.5, 0.1].map(|pool| (base, Some(pool))));
    ladder
}
