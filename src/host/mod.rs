//! Where devices and targets come from.

mod lost;
pub mod offscreen;
mod readback;
pub mod vulkan;
pub mod window;
mod write_depth;

pub use readback::Readback;

/// Makes a module of one of the library's own shaders, without the counters by which wgpu bounds every loop; all other
/// checks stay. The walks' loops are short and many, and the counters are work at every step of them.
pub(crate) fn shader_module(
    device: &wgpu::Device,
    label: &str,
    source: String,
) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    };
    let checks = wgpu::ShaderRuntimeChecks {
        force_loop_bounding: false,
        ..wgpu::ShaderRuntimeChecks::checked()
    };
    // SAFETY: every loop in shaders/ counts an integer towards an end that is fixed before it begins, or ends after
    // A_BUFFER_STEPS steps; none can run forever, which is all that the omitted check is for.
    unsafe { device.create_shader_module_trusted(descriptor, checks) }
}
