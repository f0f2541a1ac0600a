//! What the library requires of a device, before the host makes it.
//!
//! wgpu takes what a physical device supports as enabled, so that what it would enable itself must be enabled by the host:
//! robust buffer access above all. The features are merged into the host's own chain: a bit is set in the host's struct
//! where the chain has one that holds it, and a struct is appended where it has none.

use std::ffi::CStr;
use std::mem::{offset_of, size_of};

use ash::{ext, khr, vk};

use super::device::{HostInstance, Physical};
use crate::error::{Error, Result, invalid};
use crate::gpu;

/// What the queue's family must offer.
pub(super) const QUEUE_FLAGS: vk::QueueFlags =
    vk::QueueFlags::from_raw(vk::QueueFlags::GRAPHICS.as_raw() | vk::QueueFlags::COMPUTE.as_raw());

/// Words in which appended structs live, the first of which counts the others in use.
pub const FEATURE_STORAGE: usize = 128;

/// What a physical device must be opened with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Requirements {
    /// The device's extensions. Of the instance none is required.
    pub extensions: Vec<&'static CStr>,
    /// What the queue's family must offer.
    pub queue_flags: vk::QueueFlags,
    /// The index of each boolean of `VkPhysicalDeviceFeatures` that must be set.
    core: Vec<usize>,
    /// The same of the structs behind it.
    others: Vec<(&'static Known, Vec<usize>)>,
}

/// A struct of features: a header, then booleans.
#[derive(Debug, PartialEq, Eq)]
struct Known {
    s_type: vk::StructureType,
    /// How many booleans it has.
    count: usize,
    /// Its successor, one struct for all features of a version of Vulkan, and where that has these booleans.
    successor: Option<(vk::StructureType, &'static [usize])>,
}

/// Where the booleans begin in every struct of features but the first.
const HEADER: usize = offset_of!(
    vk::PhysicalDeviceTimelineSemaphoreFeatures,
    timeline_semaphore
);

/// How many booleans `VkPhysicalDeviceFeatures` has.
const CORE: usize = size_of::<vk::PhysicalDeviceFeatures>() / size_of::<vk::Bool32>();

macro_rules! within {
    ($type:ident: $($field:ident),*) => {
        Some((
            <vk::$type as vk::TaggedStructure>::STRUCTURE_TYPE,
            &[$((offset_of!(vk::$type, $field) - HEADER) / size_of::<vk::Bool32>()),*],
        ))
    };
}

/// The structs in which wgpu sets a bit for the features that the library asks of it.
const KNOWN: [Known; 8] = [
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES,
        count: 1,
        successor: within!(PhysicalDeviceVulkan12Features: timeline_semaphore),
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_SHADER_FLOAT16_INT8_FEATURES,
        count: 2,
        successor: within!(PhysicalDeviceVulkan12Features: shader_float16, shader_int8),
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_IMAGE_ROBUSTNESS_FEATURES,
        count: 1,
        successor: within!(PhysicalDeviceVulkan13Features: robust_image_access),
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_ZERO_INITIALIZE_WORKGROUP_MEMORY_FEATURES,
        count: 1,
        successor: within!(PhysicalDeviceVulkan13Features: shader_zero_initialize_workgroup_memory),
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES,
        count: 2,
        successor: within!(PhysicalDeviceVulkan13Features: subgroup_size_control, compute_full_subgroups),
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_SHADER_INTEGER_DOT_PRODUCT_FEATURES,
        count: 1,
        successor: within!(PhysicalDeviceVulkan13Features: shader_integer_dot_product),
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_ROBUSTNESS_2_FEATURES_EXT,
        count: 3,
        successor: None,
    },
    Known {
        s_type: vk::StructureType::PHYSICAL_DEVICE_PORTABILITY_SUBSET_FEATURES_KHR,
        count: 15,
        successor: None,
    },
];

/// Structs that wgpu chains without a bit set in them, for the features that the library asks of it.
const EMPTY: [(vk::StructureType, usize); 5] = [
    (
        vk::StructureType::PHYSICAL_DEVICE_VULKAN_MEMORY_MODEL_FEATURES,
        3,
    ),
    (vk::StructureType::PHYSICAL_DEVICE_MULTIVIEW_FEATURES, 3),
    (
        vk::StructureType::PHYSICAL_DEVICE_SHADER_ATOMIC_INT64_FEATURES,
        2,
    ),
    (vk::StructureType::PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES, 1),
    (
        vk::StructureType::PHYSICAL_DEVICE_SHADER_DRAW_PARAMETERS_FEATURES,
        1,
    ),
];

/// A struct of Vulkan's, as all begin.
#[repr(C)]
struct Header {
    s_type: vk::StructureType,
    next: *mut Header,
}

const _: () = assert!(size_of::<Header>() == HEADER);
/// Words of `VkPhysicalDeviceFeatures2`.
const HEAD_WORDS: usize = size_of::<vk::PhysicalDeviceFeatures2>().div_ceil(8);

/// Words that one merge takes at most.
const MOST_WORDS: usize = {
    let mut words = HEAD_WORDS;
    let mut at = 0;
    while at < KNOWN.len() {
        words += node_words(KNOWN[at].count);
        at += 1;
    }
    words
};

const _: () = assert!(MOST_WORDS < FEATURE_STORAGE);

/// Words of eight bytes that a struct of so many booleans takes.
const fn node_words(count: usize) -> usize {
    (HEADER + count * size_of::<vk::Bool32>()).div_ceil(8)
}

/// The booleans of a struct behind its header.
///
/// # Safety
/// `node` points to a struct of features with `count` booleans.
unsafe fn booleans<'a>(node: *mut Header, count: usize) -> &'a mut [vk::Bool32] {
    // SAFETY: the caller's promise; booleans follow the header without a gap, and have no invalid values.
    unsafe { std::slice::from_raw_parts_mut(node.cast::<u8>().add(HEADER).cast(), count) }
}

/// What a physical device must be opened with.
///
/// # Errors
/// A device that falls short, with the reason; a handle that is null or not the instance's.
///
/// # Safety
/// The handles are valid.
pub unsafe fn requirements(
    instance: &HostInstance,
    device: vk::PhysicalDevice,
) -> Result<Requirements> {
    // SAFETY: the host's promise is passed on.
    of(&unsafe { Physical::inspect(instance, device) }?)
}

pub(super) fn of(physical: &Physical) -> Result<Requirements> {
    let short = |what: &str| Err(Error::Unsupported(format!("{} {what}", physical.name())));
    let mut families = physical.families.iter();
    if !families.any(|family| family.queue_flags.contains(QUEUE_FLAGS)) {
        return short("has no queue family that offers both graphics and compute");
    }
    gpu::check_limits(&physical.adapter.capabilities.limits)?;
    let downlevel = physical.adapter.capabilities.downlevel.flags;
    if !downlevel.contains(wgpu::DownlevelFlags::FRAGMENT_WRITABLE_STORAGE) {
        return short("lacks the feature fragmentStoresAndAtomics");
    }

    let offered = |name: &&'static CStr| {
        let mut offered = physical.extensions.iter();
        offered.any(|extension| extension.extension_name_as_c_str() == Ok(*name))
    };
    let extensions: Vec<_> = [ext::robustness2::NAME, khr::portability_subset::NAME]
        .into_iter()
        .filter(offered)
        .collect();

    let adapter = &physical.adapter.adapter;
    let mut features = adapter.physical_device_features(&extensions, physical.features());
    let info = features.add_to_device_create(vk::DeviceCreateInfo::default());
    let set = |booleans: &[vk::Bool32]| -> Vec<usize> {
        (0..booleans.len())
            .filter(|at| booleans[*at] != vk::FALSE)
            .collect()
    };
    // SAFETY: wgpu has set the pointer to its own features, which live as long as `features`.
    let core = set(unsafe { std::slice::from_raw_parts(info.p_enabled_features.cast(), CORE) });
    let mut others = Vec::new();
    let mut node = info.p_next.cast_mut().cast::<Header>();
    while !node.is_null() {
        // SAFETY: wgpu's chain, of structs of `features`.
        let (s_type, next) = unsafe { ((*node).s_type, (*node).next) };
        let known = KNOWN.iter().find(|known| known.s_type == s_type);
        let empty = EMPTY.iter().find(|(empty, _)| *empty == s_type);
        let count = known
            .map(|known| known.count)
            .or(empty.map(|(_, count)| *count));
        // SAFETY: both tables say how many booleans the struct has.
        let bits = count.map(|count| set(unsafe { booleans(node, count) }));
        match (known, bits) {
            (Some(known), Some(bits)) if !bits.is_empty() => others.push((known, bits)),
            (_, Some(bits)) if bits.is_empty() => {}
            _ => {
                return Err(Error::Internal(format!(
                    "wgpu asks for features of {s_type:?}, which the library cannot pass on"
                )));
            }
        }
        node = next;
    }
    // Timeline semaphores are Vulkan's own since 1.2, and wgpu's fences are made of them.
    let timeline = |(known, _): &(&Known, Vec<usize>)| {
        known.s_type == vk::StructureType::PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES
    };
    if !others.iter().any(timeline) {
        return short("lacks the feature timelineSemaphore");
    }
    Ok(Requirements {
        extensions,
        queue_flags: QUEUE_FLAGS,
        core,
        others,
    })
}

impl Requirements {
    /// Sets what is required in the host's own chain of features, `chain`, and keeps all that the host has set. What the
    /// chain has no struct for is appended to it, out of `storage`; where there is no chain, one is made there. Its head,
    /// for `VkDeviceCreateInfo::pNext`.
    ///
    /// # Errors
    /// A storage that earlier merges have filled.
    ///
    /// # Safety
    /// `chain` is null or a valid chain of structs of Vulkan that may be written to; `storage` is writable, zero before its
    /// first use, and neither moves before the device has been made.
    pub unsafe fn merge(
        &self,
        chain: *mut vk::PhysicalDeviceFeatures2<'static>,
        storage: *mut [u64; FEATURE_STORAGE],
    ) -> Result<*mut vk::PhysicalDeviceFeatures2<'static>> {
        let storage = storage.cast::<u64>();
        // SAFETY: the storage is writable, and its first word is a count.
        let used = unsafe { &mut *storage };
        if *used > (FEATURE_STORAGE - 1 - MOST_WORDS) as u64 {
            return invalid!(
                "the requirements have been used before; begin them anew for each device"
            );
        }
        let mut take = |words: usize, s_type: vk::StructureType| -> *mut Header {
            // SAFETY: there is room for all that one merge may take, as was checked above; it is aligned to words.
            unsafe {
                let node = storage.add(1 + *used as usize);
                *used += words as u64;
                node.write_bytes(0, words);
                (*node.cast::<Header>()).s_type = s_type;
                node.cast()
            }
        };
        let chain = if chain.is_null() {
            take(HEAD_WORDS, vk::StructureType::PHYSICAL_DEVICE_FEATURES_2)
        } else {
            chain.cast()
        };
        // SAFETY: the first struct is `VkPhysicalDeviceFeatures2`: a header and the core features.
        let core = unsafe { booleans(chain, CORE) };
        self.core.iter().for_each(|at| core[*at] = vk::TRUE);
        for (known, bits) in &self.others {
            // SAFETY: the host's chain is valid, and what has been appended to it too.
            let found = |s_type| unsafe { find(chain, s_type) };
            let successor = known
                .successor
                .and_then(|(s_type, places)| found(s_type).map(|node| (node, places)));
            if let Some((node, places)) = successor {
                for bit in bits {
                    // SAFETY: the successor has a boolean at each of its places.
                    unsafe { booleans(node, places[*bit] + 1)[places[*bit]] = vk::TRUE };
                }
                continue;
            }
            let node = found(known.s_type).unwrap_or_else(|| {
                let node = take(node_words(known.count), known.s_type);
                // SAFETY: the last struct of the chain gets a successor, which lives in the storage.
                unsafe { (*last(chain)).next = node };
                node
            });
            // SAFETY: the struct has as many booleans as the table says.
            let booleans = unsafe { booleans(node, known.count) };
            bits.iter().for_each(|bit| booleans[*bit] = vk::TRUE);
        }
        Ok(chain.cast())
    }
}

/// The struct of a kind in a chain.
///
/// # Safety
/// The chain is valid.
unsafe fn find(chain: *mut Header, s_type: vk::StructureType) -> Option<*mut Header> {
    let mut node = chain;
    while !node.is_null() {
        // SAFETY: the caller's promise.
        let header = unsafe { &*node };
        if header.s_type == s_type {
            return Some(node);
        }
        node = header.next;
    }
    None
}

/// The last struct of a chain.
///
/// # Safety
/// The chain is valid and not empty.
unsafe fn last(chain: *mut Header) -> *mut Header {
    let mut node = chain;
    // SAFETY: the caller's promise.
    while let Some(next) = unsafe { (*node).next.as_mut() } {
        node = next;
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;

    fn required(others: &[(usize, &[usize])]) -> Requirements {
        Requirements {
            extensions: Vec::new(),
            queue_flags: QUEUE_FLAGS,
            core: vec![0, CORE - 1],
            others: others
                .iter()
                .map(|(known, bits)| (&KNOWN[*known], bits.to_vec()))
                .collect(),
        }
    }

    fn merge(
        required: &Requirements,
        chain: *mut vk::PhysicalDeviceFeatures2<'static>,
        storage: &mut [u64; FEATURE_STORAGE],
    ) -> *mut vk::PhysicalDeviceFeatures2<'static> {
        // SAFETY: the tests' chains are valid.
        unsafe { required.merge(chain, storage) }.unwrap()
    }

    /// The types of a chain's structs.
    fn types(chain: *mut vk::PhysicalDeviceFeatures2) -> Vec<vk::StructureType> {
        let mut found = Vec::new();
        let mut node = chain.cast::<Header>();
        while !node.is_null() {
            // SAFETY: the tests' chains are valid.
            unsafe {
                found.push((*node).s_type);
                node = (*node).next;
            }
        }
        found
    }

    #[test]
    fn without_a_chain_one_is_made() {
        let mut storage = [u64::MAX; FEATURE_STORAGE];
        storage[0] = 0;
        let every: Vec<(usize, &[usize])> = (0..KNOWN.len()).map(|at| (at, &[0][..])).collect();
        let chain = merge(&required(&every), std::ptr::null_mut(), &mut storage);
        // SAFETY: made just now, in `storage`.
        let features = unsafe { (*chain).features };
        assert_eq!(features.robust_buffer_access, vk::TRUE);
        assert_eq!(features.inherited_queries, vk::TRUE);
        assert_eq!(features.geometry_shader, vk::FALSE);
        let mut expected = vec![vk::StructureType::PHYSICAL_DEVICE_FEATURES_2];
        expected.extend(KNOWN.iter().map(|known| known.s_type));
        assert_eq!(types(chain), expected);
    }

    #[test]
    fn what_the_host_has_set_is_kept_and_its_own_structs_are_used() {
        let mut of_1_2 = vk::PhysicalDeviceVulkan12Features::default().draw_indirect_count(true);
        let mut robustness =
            vk::PhysicalDeviceRobustness2FeaturesEXT::default().null_descriptor(true);
        let mut features = vk::PhysicalDeviceFeatures2::default()
            .features(vk::PhysicalDeviceFeatures::default().geometry_shader(true))
            .push_next(&mut of_1_2)
            .push_next(&mut robustness);
        let mut storage = [0; FEATURE_STORAGE];
        let pointer = (&raw mut features).cast();
        let chain = merge(
            &required(&[(0, &[0]), (1, &[1]), (2, &[0]), (6, &[0, 1])]),
            pointer,
            &mut storage,
        );
        assert_eq!(chain, pointer);
        assert_eq!(
            types(chain),
            [
                vk::StructureType::PHYSICAL_DEVICE_FEATURES_2,
                vk::StructureType::PHYSICAL_DEVICE_ROBUSTNESS_2_FEATURES_EXT,
                vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                vk::StructureType::PHYSICAL_DEVICE_IMAGE_ROBUSTNESS_FEATURES,
            ]
        );
        // SAFETY: the chain's head is `features`.
        let core = unsafe { (*chain).features };
        assert_eq!((core.geometry_shader, core.robust_buffer_access), (1, 1));
        assert_eq!(
            (of_1_2.draw_indirect_count, of_1_2.timeline_semaphore),
            (1, 1)
        );
        assert_eq!((of_1_2.shader_int8, of_1_2.shader_float16), (1, 0));
        assert_eq!(of_1_2.imageless_framebuffer, 0);
        assert_eq!(
            (robustness.robust_buffer_access2, robustness.null_descriptor),
            (1, 1)
        );
        assert_eq!(robustness.robust_image_access2, 1);
    }

    #[test]
    fn merging_twice_changes_nothing_more() {
        let required = required(&[(0, &[0]), (6, &[1])]);
        let (mut storage, mut more) = ([0; FEATURE_STORAGE], [0; FEATURE_STORAGE]);
        let chain = merge(&required, std::ptr::null_mut(), &mut storage);
        let once = types(chain);
        assert_eq!(merge(&required, chain, &mut more), chain);
        assert_eq!(types(chain), once);
        assert!(more == [0; FEATURE_STORAGE]);
    }

    #[test]
    fn a_storage_that_is_full_is_refused_and_not_written_beyond() {
        let every: Vec<(usize, &[usize])> = (0..KNOWN.len()).map(|at| (at, &[0][..])).collect();
        let mut storage = [0; FEATURE_STORAGE];
        let mut merge = || {
            // SAFETY: no chain, and a storage of its own.
            unsafe { required(&every).merge(std::ptr::null_mut(), &mut storage) }
        };
        let merges = (0..10).take_while(|_| merge().is_ok()).count();
        assert_eq!(merges, (FEATURE_STORAGE - 1) / MOST_WORDS);
        assert!(merge().unwrap_err().to_string().contains("used before"));
    }
}
