//! The walk: a compute pass in which one invocation walks the pixels of one segment.

use super::{Draw, Emission, Rasteriser};
use crate::error::Result;
use crate::gpu::{Gpu, Group, Passes, PipelineKey, spread_workgroups};
use crate::plan::Plan;
use crate::resources::Bound;

pub(super) fn record(
    gpu: &mut Gpu,
    passes: &mut Passes,
    bound: &Bound,
    emission: &Emission,
    draw: &Draw,
    plan: &Plan,
) -> Result<()> {
    let key = PipelineKey {
        rasteriser: Some(Rasteriser::Walk),
        variant: emission.variant(plan),
        ..PipelineKey::new(emission.label)
    };
    let groups = [Group::Frame, Group::Segments, emission.group];
    let pipeline = gpu.compute(key, "walk", &groups, || {
        emission.module("raster/walk", plan.shader.rate)
    })?;
    passes.compute(emission.label, |pass| {
        pass.set_pipeline(&pipeline);
        let (index, group) = bound.emission(emission.group);
        pass.set_bind_group(index, group, &[]);
        for ((run, drawing), groups) in plan.runs.iter().zip(draw.drawings).zip(bound.runs) {
            pass.set_bind_group(0, bound.frame, &[0, *drawing, run.material]);
            pass.set_bind_group(1, &groups.segments, &[]);
            if draw.on_overflow {
                pass.dispatch_workgroups_indirect(bound.arguments, super::WALK_ARGUMENTS);
            } else {
                let (x, y) = spread_workgroups(run.run.segments);
                pass.dispatch_workgroups(x, y, draw.splits);
            }
        }
    });
    Ok(())
}
