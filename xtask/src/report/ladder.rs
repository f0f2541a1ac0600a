//! What is measured: the scenes, and each technique over a ladder of its settings.

use std::fmt;

use pelage::Raster;
use pelage::glam::Vec3;
use pelage::groom::BuiltinGroom;
use pelage::shading::{
    Chiang, KajiyaKay, Marschner, Precision, Roots, Sadeghi, Scheuermann, Shading, ShadingRate,
    Tables,
};
use pelage::shadow::{
    ApproximatedDeepShadowMap, DeepOpacityMap, KBufferVolume, MomentOpacityMap, OpacityShadowMaps,
    Shadow, ShadowMap,
};
use pelage::transparency::{ABuffer, DbkBuffer, Opaque, Storage, Transparency};
use serde_json::Value;

use super::Group;
use crate::scene_file::techniques;

/// A groom and a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Its name in rows.
    pub name: &'static str,
    /// The groom.
    pub groom: BuiltinGroom,
    /// How many strands.
    pub strands: usize,
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// The fibres' own opacity.
    pub opacity: f32,
    /// Whether `--quick` measures it.
    pub quick: bool,
}

/// The scenes of the report.
pub const SCENES: &[Scene] = &[
    Scene {
        name: "straight_10k",
        groom: BuiltinGroom::Straight,
        strands: 10_000,
        size: [328, 430],
        opacity: 0.5,
        quick: true,
    },
    Scene {
        name: "straight",
        groom: BuiltinGroom::Straight,
        strands: 50_000,
        size: [656, 861],
        opacity: 0.5,
        quick: false,
    },
    Scene {
        name: "straight_0.1",
        groom: BuiltinGroom::Straight,
        strands: 50_000,
        size: [656, 861],
        opacity: 0.1,
        quick: false,
    },
    Scene {
        name: "straight_0.3",
        groom: BuiltinGroom::Straight,
        strands: 50_000,
        size: [656, 861],
        opacity: 0.3,
        quick: false,
    },
    Scene {
        name: "straight_0.9",
        groom: BuiltinGroom::Straight,
        strands: 50_000,
        size: [656, 861],
        opacity: 0.9,
        quick: false,
    },
];

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
    /// Where the model is evaluated, in cases that compare rates: their truth is shaded at fragments.
    pub rate: Option<ShadingRate>,
    /// The pool as a part of what all fragments need; it becomes `pool_bytes` when that is known.
    pub pool: Option<f64>,
}

impl Case {
    /// The stem of the technique that is measured.
    pub fn technique(&self) -> &'static str {
        match self.group {
            Group::Shading => self.shading.stem(),
            Group::Shadow => self.shadow.stem(),
            Group::Transparency => self.transparency.stem(),
        }
    }

    /// The measured technique's settings, as in a scene file but for the stem.
    pub fn settings(&self) -> Value {
        let mut settings = match self.group {
            Group::Shading => techniques::shading_settings(&self.shading),
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

/// Every other model, directly and through tables of rising size.
fn fibre_models() -> Vec<Shading> {
    let tables = |size, precision| Some(Tables { size, precision });
    let ladder = [
        None,
        tables(32, Precision::F32),
        tables(64, Precision::F32),
        tables(128, Precision::F32),
        tables(256, Precision::F32),
        tables(512, Precision::F32),
        tables(64, Precision::F16),
        tables(256, Precision::F16),
    ];
    let marschner = Marschner::default();
    let sadeghi = Sadeghi {
        glint_angle: [0.65; 2],
        ..Sadeghi::default()
    };
    let mut models = vec![Shading::Scheuermann(Scheuermann::default())];
    models.extend(ladder.map(|tables| {
        Shading::Marschner(Marschner {
            tables,
            ..marschner
        })
    }));
    models.push(Shading::Marschner(Marschner {
        tables: None,
        roots: Roots::Cubic,
        ..marschner
    }));
    models.extend([false, true].map(|normalised| {
        Shading::Sadeghi(Sadeghi {
            normalised,
            ..sadeghi
        })
    }));
    models.extend([16, 128].map(|intervals| {
        Shading::Chiang(Chiang {
            tables: None,
            intervals,
            ..Chiang::default()
        })
    }));
    models.extend(ladder.into_iter().flatten().map(|tables| {
        Shading::Chiang(Chiang {
            tables: Some(tables),
            ..Chiang::default()
        })
    }));
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

/// Every case, in the order of the tables. `quick` leaves out the largest maps.
pub fn cases(quick: bool) -> Vec<Case> {
    let base = Case {
        group: Group::Shading,
        shading: white(0.09, 60.0),
        shadow: Shadow::None,
        transparency: Transparency::Opaque(Opaque::default()),
        rate: None,
        pool: None,
    };
    let mut cases = Vec::new();
    for exponent in [10.0, 60.0, 300.0] {
        cases.push(Case {
            shading: white(0.09, exponent),
            ..base.clone()
        });
    }
    cases.extend(fibre_models().into_iter().map(|shading| Case {
        shading,
        ..base.clone()
    }));
    cases.extend(shadows(quick).into_iter().map(|shadow| Case {
        group: Group::Shadow,
        shading: white(0.0, 60.0),
        shadow,
        ..base.clone()
    }));
    for shading in [
        white(0.09, 60.0),
        Shading::Marschner(Marschner::default()),
        Shading::Chiang(Chiang::default()),
    ] {
        cases.extend(
            [ShadingRate::Point, ShadingRate::Fragment].map(|rate| Case {
                shading,
                rate: Some(rate),
                ..base.clone()
            }),
        );
    }
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
    for epsilon in [1.0 / 16.0, 1.0 / 64.0, 1.0 / 256.0, 1.0 / 1024.0] {
        cases.push(Case {
            transparency: Transparency::DbkBuffer(DbkBuffer {
                epsilon,
                ..DbkBuffer::default()
            }),
            ..base.clone()
        });
    }
    cases
}
