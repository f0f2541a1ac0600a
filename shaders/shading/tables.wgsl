// Tables of a model's azimuthal functions (Hunz §3.3.4), made when its parameters change: rows of |θ| from 0 to π/2, columns
// of φ from 0 to π; one table for single scattering, and one averaged over half circles of lights for dual scattering.
// The model's file supplies `tabulated`.

@group(1) @binding(0) var<storage, read_write> shading_tables: array<u32>;

@compute @workgroup_size(64)
fn shading_tabulate(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = invocation.x + invocation.y * groups.x * 64u;
    let place = fibre_tables();
    let size = place.z;
    let each = size * size;
    let count = each * select(1u, 2u, FIBRE_DUAL);
    if number >= count { return; }
    let index = number % each;
    let theta = FIBRE_HALF_PI * f32(index / size) / f32(size - 1u);
    let phi = FIBRE_PI * f32(index % size) / f32(size - 1u);
    let lobes = tabulated(theta, phi, number >= each);
    let v = array<f32, 10>(lobes.r, lobes.tt.x, lobes.tt.y, lobes.tt.z, lobes.trt.x, lobes.trt.y, lobes.trt.z,
        lobes.residual.x, lobes.residual.y, lobes.residual.z);
    if FIBRE_TABLE_F16 {
        // 65504 is the largest; narrower lobes than that are no use in a table.
        for (var i = 0u; i < 5u; i++) {
            let pair = min(vec2f(v[2u * i], v[2u * i + 1u]), vec2f(65504.0));
            shading_tables[place.y + number * 5u + i] = pack2x16float(pair);
        }
    } else {
        for (var i = 0u; i < 10u; i++) { shading_tables[place.y + number * 10u + i] = bitcast<u32>(v[i]); }
    }
}
