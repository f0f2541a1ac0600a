// A shading model at single directions, without hair: what `Evaluator` runs. The model's file supplies `scatter` and
// `scatter_uniform`.

@group(1) @binding(0) var<storage, read> samples: array<Sample>;
@group(1) @binding(1) var<storage, read_write> values: array<vec4f>;
@group(1) @binding(2) var<storage, read> shading_tables: array<u32>;

fn evaluate_fibre(sample: Sample) -> Fibre {
    return Fibre(sample.tangent, sample.colour, sample.coordinate, sample.strand, sample.across);
}

@compute @workgroup_size(64)
fn evaluate_scatter(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= arrayLength(&samples) { return; }
    let sample = samples[index];
    let shadow = ShadowSample(vec3f(sample.transmittance), sample.fibres);
    values[index] = vec4f(scatter(evaluate_fibre(sample), sample.to_light, sample.to_eye, shadow), 0.0);
}

@compute @workgroup_size(64)
fn evaluate_uniform(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= arrayLength(&samples) { return; }
    let sample = samples[index];
    values[index] = vec4f(scatter_uniform(evaluate_fibre(sample), sample.to_eye), 0.0);
}
