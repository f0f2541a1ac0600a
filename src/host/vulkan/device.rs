//! The host's instance and device in wgpu's terms.

use std::cell::Cell;
use std::ffi::{CStr, c_char};
use std::sync::Arc;

use ash::{ext, khr, vk};

use super::barrier::Families;
use super::image::Formats;
use super::queue::QueueLock;
use super::requirements::{self, Requirements};
use crate::error::{Error, Result, invalid};

type Hal = wgpu::hal::api::Vulkan;
type HalAdapter = wgpu::hal::ExposedAdapter<Hal>;

/// The host's instance.
#[derive(Clone, Copy)]
pub struct HostInstance {
    /// The host's way to Vulkan's functions.
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    /// The host's.
    pub instance: vk::Instance,
    /// `VkApplicationInfo::apiVersion` with which it was made: 1.3 or newer.
    pub api_version: u32,
    /// Whether it was made with `VK_EXT_debug_utils`: passes then bear their labels in GPU debuggers.
    pub debug_utils: bool,
}

/// The host's device.
pub struct DeviceDescriptor<'a> {
    /// The instance.
    pub instance: HostInstance,
    /// A physical device of the instance.
    pub physical_device: vk::PhysicalDevice,
    /// A device of the physical device.
    pub device: vk::Device,
    /// The family of the queue to submit to.
    pub queue_family: u32,
    /// The queue's number within its family.
    pub queue_index: u32,
    /// The extensions that the device was made with.
    pub extensions: &'a [&'a CStr],
    /// Held around every use of the queue. `None` where no other thread uses it.
    pub lock: Option<Arc<dyn QueueLock>>,
}

thread_local! {
    /// The host whose instance is being imported on this thread.
    static HOST: Cell<Option<vk::PFN_vkGetInstanceProcAddr>> = const { Cell::new(None) };
}

/// wgpu asks for the functions of VK_KHR_get_physical_device_properties2 by the names that they had before Vulkan 1.1.
/// They are the same functions under their later names, for which no extension need be enabled.
unsafe extern "system" fn promoted(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    let host = HOST.get()?;
    // SAFETY: the caller passes a name as Vulkan wants it.
    let asked = unsafe { CStr::from_ptr(name) }.to_bytes();
    if let Some(core) = asked.strip_suffix(b"KHR") {
        let mut core = core.to_vec();
        core.push(0);
        // SAFETY: the host's function, as Vulkan specifies it, and a name that ends with a NUL.
        let function = unsafe { host(instance, core.as_ptr().cast()) };
        if function.is_some() {
            return function;
        }
    }
    // SAFETY: as above.
    unsafe { host(instance, name) }
}

/// A physical device as wgpu and ash see it.
pub(super) struct Physical {
    pub raw: ash::Instance,
    pub hal: wgpu::hal::vulkan::Instance,
    pub adapter: HalAdapter,
    pub properties: vk::PhysicalDeviceProperties,
    pub families: Vec<vk::QueueFamilyProperties>,
    pub extensions: Vec<vk::ExtensionProperties>,
}

/// The features of wgpu that the library uses where a device has them. None of them takes a feature of Vulkan's.
const WANTED: wgpu::Features = wgpu::Features::FLOAT32_BLENDABLE
    .union(wgpu::Features::RG11B10UFLOAT_RENDERABLE)
    .union(wgpu::Features::DEPTH32FLOAT_STENCIL8);

impl Physical {
    pub fn features(&self) -> wgpu::Features {
        self.adapter.features & WANTED
    }

    pub fn name(&self) -> String {
        let name = self.properties.device_name_as_c_str().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// Looks at a physical device of the host's.
    ///
    /// # Safety
    /// The handles are valid, and stay so for as long as what is returned.
    pub unsafe fn inspect(host: &HostInstance, device: vk::PhysicalDevice) -> Result<Self> {
        if host.instance == vk::Instance::null() {
            return invalid!("instance is NULL");
        }
        if device == vk::PhysicalDevice::null() {
            return invalid!("physical_device is NULL");
        }
        version_fits("the instance", host.api_version)?;
        for name in [c"vkGetDeviceProcAddr", c"vkEnumeratePhysicalDevices"] {
            // SAFETY: the host's function, as Vulkan specifies it.
            if unsafe { (host.get_instance_proc_addr)(host.instance, name.as_ptr()) }.is_none() {
                return invalid!(
                    "get_instance_proc_addr does not know {}",
                    name.to_string_lossy()
                );
            }
        }
        let functions = |get_instance_proc_addr| ash::StaticFn {
            get_instance_proc_addr,
        };
        // SAFETY: the host's instance is valid.
        let raw =
            unsafe { ash::Instance::load(&functions(host.get_instance_proc_addr), host.instance) };
        let failed = |what, error| Err(Error::Unsupported(format!("{what}: {error}")));
        // SAFETY: as above.
        match unsafe { raw.enumerate_physical_devices() } {
            Ok(devices) if devices.contains(&device) => {}
            Ok(_) => return invalid!("physical_device is not one of the instance's"),
            Err(error) => return failed("vkEnumeratePhysicalDevices", error),
        }
        // SAFETY: the physical device is the instance's.
        let (properties, families, extensions) = unsafe {
            (
                raw.get_physical_device_properties(device),
                raw.get_physical_device_queue_family_properties(device),
                raw.enumerate_device_extension_properties(device),
            )
        };
        let extensions = match extensions {
            Ok(extensions) => extensions,
            Err(error) => return failed("vkEnumerateDeviceExtensionProperties", error),
        };
        version_fits("the device", properties.api_version)?;
        // wgpu wants it so, whatever the family in use.
        let first = families.first().map(|family| family.queue_flags);
        if !first.is_some_and(|flags| flags.contains(vk::QueueFlags::GRAPHICS)) {
            return Err(Error::Unsupported(
                "the device's queue family 0 offers no graphics".into(),
            ));
        }
        let mut known = vec![khr::get_physical_device_properties2::NAME];
        if host.debug_utils {
            known.push(ext::debug_utils::NAME);
        }
        HOST.set(Some(host.get_instance_proc_addr));
        // SAFETY: the functions are the host's; the instance is valid, and kept by the drop callback.
        let hal = unsafe {
            wgpu::hal::vulkan::Instance::from_raw(
                ash::Entry::from_static_fn(functions(promoted)),
                raw.clone(),
                host.api_version,
                0,
                None,
                known,
                wgpu::InstanceFlags::empty(),
                wgpu::MemoryBudgetThresholds::default(),
                false,
                Some(Box::new(|| ())),
            )
        };
        HOST.set(None);
        let hal = hal.map_err(|error| Error::Unsupported(format!("the instance: {error}")))?;
        let Some(adapter) = hal.expose_adapter(device) else {
            return Err(Error::Unsupported(
                "the device's driver does not conform to Vulkan".into(),
            ));
        };
        Ok(Self {
            raw,
            hal,
            adapter,
            properties,
            families,
            extensions,
        })
    }
}

fn version_fits(whose: &str, version: u32) -> Result<()> {
    if version < super::API_VERSION {
        let (major, minor) = (
            vk::api_version_major(version),
            vk::api_version_minor(version),
        );
        return Err(Error::Unsupported(format!(
            "{whose} has Vulkan {major}.{minor}; 1.3 is needed"
        )));
    }
    Ok(())
}

/// What a context is made of.
pub(super) struct Opened {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub raw: ash::Device,
    pub formats: Formats,
    pub families: Families,
    pub info: wgpu::AdapterInfo,
}

/// Opens the host's device.
///
/// # Safety
/// As of [`super::Vulkan::new`].
pub(super) unsafe fn open(descriptor: &DeviceDescriptor) -> Result<Opened> {
    // SAFETY: the host's promise is passed on.
    let physical = unsafe { Physical::inspect(&descriptor.instance, descriptor.physical_device) }?;
    let required = requirements::of(&physical)?;
    check(descriptor, &physical, &required)?;
    let features = physical.features();
    let limits = physical.adapter.capabilities.limits.clone();
    let formats = Formats::of(
        &physical.adapter.adapter,
        features,
        &physical.raw,
        descriptor.physical_device,
    );
    let families = Families {
        own: descriptor.queue_family,
        count: physical.families.len() as u32,
        foreign: descriptor
            .extensions
            .contains(&ext::queue_family_foreign::NAME),
    };
    // SAFETY: the device belongs to the instance.
    let raw = unsafe { ash::Device::load(physical.raw.fp_v1_0(), descriptor.device) };
    // SAFETY: the device was made with what `requirements` said; the drop callback keeps it.
    let opened = unsafe {
        physical.adapter.adapter.device_from_raw(
            raw.clone(),
            Some(Box::new(|| ())),
            &required.extensions,
            features,
            &limits,
            &wgpu::MemoryHints::default(),
            descriptor.queue_family,
            descriptor.queue_index,
        )
    };
    let opened = opened.map_err(|error| match error {
        wgpu::hal::DeviceError::OutOfMemory => Error::OutOfMemory(format!("the device: {error}")),
        wgpu::hal::DeviceError::Lost => Error::DeviceLost(error.to_string()),
        other => Error::Internal(format!("the device: {other}")),
    })?;
    let info = physical.adapter.info.clone();
    let wanted = wgpu::DeviceDescriptor {
        label: Some("pelage"),
        required_features: features,
        required_limits: limits,
        ..Default::default()
    };
    // SAFETY: adapter and device come from this instance, and the features are the adapter's.
    let made = unsafe {
        let instance = wgpu::Instance::from_hal::<Hal>(physical.hal);
        let adapter = instance.create_adapter_from_hal(physical.adapter);
        adapter.create_device_from_hal(opened, &wanted)
    };
    let (device, queue) =
        made.map_err(|error| Error::Unsupported(format!("the device: {error}")))?;
    Ok(Opened {
        device,
        queue,
        raw,
        formats,
        families,
        info,
    })
}

/// Checks what can be checked of a device that has been made.
fn check(
    descriptor: &DeviceDescriptor,
    physical: &Physical,
    required: &Requirements,
) -> Result<()> {
    if descriptor.device == vk::Device::null() {
        return invalid!("device is NULL");
    }
    let (family, index) = (descriptor.queue_family, descriptor.queue_index);
    let Some(properties) = physical.families.get(family as usize) else {
        return invalid!(
            "queue_family {family}: the device has {} families",
            physical.families.len()
        );
    };
    if !properties.queue_flags.contains(requirements::QUEUE_FLAGS) {
        return invalid!("queue_family {family} does not offer both graphics and compute");
    }
    if index >= properties.queue_count {
        return invalid!(
            "queue_index {index}: queue family {family} has {} queues",
            properties.queue_count
        );
    }
    for extension in &required.extensions {
        if !descriptor.extensions.contains(extension) {
            return invalid!(
                "the device's extensions lack {}, which pelage requires on it",
                extension.to_string_lossy()
            );
        }
    }
    Ok(())
}
