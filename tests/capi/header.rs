//! `include/pelage.h` is what `src/capi` says.

use std::path::Path;

use pelage::capi::*;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A fresh header.
fn generate() -> String {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    let builder = cbindgen::Builder::new()
        .with_config(config)
        .with_src(root().join("src/capi/mod.rs"));
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    let end = "#ifdef __cplusplus\n}";
    let initialisers = format!("{}\n{end}", initialisers());
    String::from_utf8(text)
        .unwrap()
        .replace('…', "...")
        .replace(end, &initialisers)
}

#[test]
fn the_committed_header_is_what_the_source_says() {
    let path = root().join("include/pelage.h");
    let fresh = generate();
    if std::env::var_os("PELAGE_BLESS").is_some() {
        std::fs::create_dir_all(root().join("include")).unwrap();
        std::fs::write(&path, &fresh).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    if let Some((at, (old, new))) = committed
        .lines()
        .zip(fresh.lines())
        .enumerate()
        .find(|(_, (old, new))| old != new)
    {
        panic!(
            "include/pelage.h, line {}:\n- {old}\n+ {new}\nRun PELAGE_BLESS=1 cargo test header to write it.",
            at + 1
        );
    }
    assert!(
        committed == fresh,
        "include/pelage.h has another length: run PELAGE_BLESS=1 cargo test header to write it"
    );
}

/// The macros with which C programs begin their structs, from the structs' defaults.
fn initialisers() -> String {
    let mut text = String::from("/* What structs begin with. */\n");
    let mut macros = |name: &str, macro_name: &str, fields: &[String]| {
        text += &format!(
            "#define {macro_name} {{ sizeof({name}), {} }}\n",
            fields.join(", ")
        );
    };
    macro_rules! initialiser {
        ($type:ident, $macro:literal, $($field:ident),*) => {
            let value = $type::default();
            macros(stringify!($type), $macro, &[$(value.$field.c()),*]);
        };
    }
    initialiser!(
        PelageContextDescriptor,
        "PELAGE_CONTEXT_DESCRIPTOR_INIT",
        force_software,
        validation,
        reserved,
        byte_budget
    );
    initialiser!(PelageAdapter, "PELAGE_ADAPTER_INIT", software, name, driver);
    initialiser!(
        PelageStrands,
        "PELAGE_STRANDS_INIT",
        curve,
        positions,
        point_count,
        counts,
        strand_count,
        radii,
        colours,
        coordinates,
        root_radius,
        tip_radius
    );
    initialiser!(
        PelageInterpolationSettings,
        "PELAGE_INTERPOLATION_SETTINGS_INIT",
        seed,
        triangles,
        triangle_count,
        density,
        clump,
        stray_fraction,
        stray_strength
    );
    initialiser!(
        PelageClumpSettings,
        "PELAGE_CLUMP_SETTINGS_INIT",
        seed,
        followers,
        root_radius,
        tip_factor,
        stray_fraction,
        stray_strength,
        reserved
    );
    initialiser!(
        PelageFile,
        "PELAGE_FILE_INIT",
        curve,
        bytes,
        size,
        root_radius,
        tip_radius
    );
    initialiser!(
        PelageHairInfo,
        "PELAGE_HAIR_INFO_INIT",
        curve,
        strand_count,
        point_count,
        low,
        high
    );
    initialiser!(
        PelageKajiyaKay,
        "PELAGE_KAJIYA_KAY_INIT",
        diffuse,
        specular,
        exponent
    );
    initialiser!(
        PelageScheuermann,
        "PELAGE_SCHEUERMANN_INIT",
        diffuse,
        primary,
        secondary
    );
    initialiser!(
        PelageMarschner,
        "PELAGE_MARSCHNER_INIT",
        eta,
        sigma_a,
        alpha,
        beta,
        eccentricity,
        roots,
        remove_caustic,
        caustic_width,
        caustic_scale,
        caustic_fade,
        caustic_limit,
        tip_colour,
        table_size,
        table_precision,
        dual_scattering,
        forward_density,
        backward_density,
        roughness_strand,
        roughness_tip,
        lobe_tolerance,
        disorder
    );
    initialiser!(
        PelageSadeghi,
        "PELAGE_SADEGHI_INIT",
        r,
        tt,
        trt,
        tt_azimuthal_width,
        glint_intensity,
        glint_width,
        glint_angle,
        normalised,
        tip_colour,
        dual_scattering,
        forward_density,
        backward_density,
        roughness_strand,
        roughness_tip,
        lobe_tolerance,
        disorder
    );
    initialiser!(
        PelageChiang,
        "PELAGE_CHIANG_INIT",
        beta_m,
        beta_n,
        alpha,
        eta,
        sigma_a,
        tip_colour,
        intervals,
        table_size,
        table_precision,
        dual_scattering,
        forward_density,
        backward_density,
        roughness_strand,
        roughness_tip,
        lobe_tolerance,
        near_field,
        disorder
    );
    initialiser!(
        PelageShading,
        "PELAGE_SHADING_INIT",
        model,
        kajiya_kay,
        scheuermann,
        marschner,
        sadeghi,
        chiang,
        rate,
        reserved
    );
    initialiser!(
        PelageDeepOpacityMap,
        "PELAGE_DEEP_OPACITY_MAP_INIT",
        resolution,
        layers,
        pcf,
        depth,
        raster,
        transmitted
    );
    initialiser!(
        PelageMomentOpacityMap,
        "PELAGE_MOMENT_OPACITY_MAP_INIT",
        resolution,
        moments,
        pcf,
        transmitted,
        raster
    );
    initialiser!(
        PelageKBufferVolume,
        "PELAGE_K_BUFFER_VOLUME_INIT",
        resolution,
        k,
        pcf,
        tail,
        attenuation,
        eta,
        sigma_a,
        raster
    );
    initialiser!(
        PelageShadow,
        "PELAGE_SHADOW_INIT",
        technique,
        deep_opacity_map,
        shadow_map,
        approximated_deep_shadow_map,
        opacity_shadow_maps,
        moment_opacity_map,
        k_buffer_volume
    );
    initialiser!(
        PelageShadowMap,
        "PELAGE_SHADOW_MAP_INIT",
        resolution,
        pcf,
        strength,
        raster
    );
    initialiser!(
        PelageApproximatedDeepShadowMap,
        "PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT",
        resolution,
        pcf,
        opacity,
        spacing,
        raster
    );
    initialiser!(
        PelageOpacityShadowMaps,
        "PELAGE_OPACITY_SHADOW_MAPS_INIT",
        resolution,
        layers,
        unevenness,
        pcf,
        raster
    );
    initialiser!(PelageOpaque, "PELAGE_OPAQUE_INIT", raster);
    initialiser!(
        PelageABuffer,
        "PELAGE_A_BUFFER_INIT",
        storage,
        raster,
        reserved,
        pool_bytes
    );
    initialiser!(
        PelageWeightedBlended,
        "PELAGE_WEIGHTED_BLENDED_INIT",
        weight,
        falloff,
        raster
    );
    initialiser!(
        PelageDepthPeeling,
        "PELAGE_DEPTH_PEELING_INIT",
        peels,
        raster
    );
    initialiser!(
        PelageRandomSubsets,
        "PELAGE_RANDOM_SUBSETS_INIT",
        subsets,
        seed,
        exact_alpha,
        raster
    );
    initialiser!(
        PelageSortedBlending,
        "PELAGE_SORTED_BLENDING_INIT",
        bins,
        order,
        reuse,
        full_precision
    );
    initialiser!(
        PelageKBuffer,
        "PELAGE_K_BUFFER_INIT",
        k,
        rest,
        selection,
        storage,
        raster,
        pool_bytes
    );
    initialiser!(
        PelageKPlusBuffer,
        "PELAGE_K_PLUS_BUFFER_INIT",
        k,
        rest,
        atomics,
        raster
    );
    initialiser!(
        PelageKBufferSinglePass,
        "PELAGE_K_BUFFER_SINGLE_PASS_INIT",
        k,
        rest,
        retries,
        raster,
        reserved,
        pool_bytes
    );
    initialiser!(PelageMoment, "PELAGE_MOMENT_INIT", raster);
    initialiser!(
        PelageTransparency,
        "PELAGE_TRANSPARENCY_INIT",
        technique,
        opaque,
        a_buffer,
        dbk_buffer,
        weighted_blended,
        depth_peeling,
        random_subsets,
        sorted_blending,
        k_buffer,
        k_plus_buffer,
        k_buffer_single_pass,
        moment
    );
    initialiser!(
        PelageDbkBuffer,
        "PELAGE_DBK_BUFFER_INIT",
        epsilon,
        depth_shift,
        raster,
        pool_bytes,
        culling,
        reserved
    );
    initialiser!(
        PelageView,
        "PELAGE_VIEW_INIT",
        flags,
        view_from_world,
        clip_from_view,
        previous_view_from_world,
        previous_clip_from_view,
        jitter,
        previous_jitter,
        rectangle
    );
    initialiser!(
        PelageLight,
        "PELAGE_LIGHT_INIT",
        kind,
        direction,
        position,
        power,
        reserved,
        shadow,
        inner_angle,
        outer_angle
    );
    initialiser!(
        PelageFrame,
        "PELAGE_FRAME_INIT",
        hair_count,
        hairs,
        lights,
        view,
        transparency,
        light_count,
        ambient
    );
    initialiser!(
        PelageTargetDescriptor,
        "PELAGE_TARGET_DESCRIPTOR_INIT",
        width,
        height,
        format,
        with_depth,
        outputs
    );
    initialiser!(
        PelageMemoryEstimate,
        "PELAGE_MEMORY_ESTIMATE_INIT",
        reserved,
        bytes_total,
        bytes_added,
        bytes_geometry,
        bytes_shading,
        bytes_shadow,
        bytes_transparency,
        bytes_raster
    );
    initialiser!(
        PelageStatistics,
        "PELAGE_STATISTICS_INIT",
        reserved,
        strands,
        segments,
        fragments_produced,
        fragments_culled,
        fragments_stored,
        fragments_merged,
        covered_pixels,
        bytes_total,
        bytes_peak,
        shadow_maps_filled,
        shadow_maps_taken
    );
    initialiser!(
        PelageVulkanInstance,
        "PELAGE_VULKAN_INSTANCE_INIT",
        api_version,
        instance,
        get_instance_proc_addr,
        debug_utils,
        reserved
    );
    initialiser!(
        PelageVulkanRequirements,
        "PELAGE_VULKAN_REQUIREMENTS_INIT",
        queue_flags,
        features,
        device_extensions,
        device_extension_count,
        reserved,
        storage
    );
    initialiser!(
        PelageVulkanDevice,
        "PELAGE_VULKAN_DEVICE_INIT",
        queue_family,
        queue_index,
        extension_count,
        extensions,
        instance,
        physical_device,
        device,
        lock,
        unlock,
        lock_user,
        byte_budget
    );
    initialiser!(
        PelageVulkanImage,
        "PELAGE_VULKAN_IMAGE_INIT",
        format,
        image,
        width,
        height,
        usage,
        samples,
        layout_in,
        layout_out,
        array_layers,
        mip_levels,
        layer,
        mip_level,
        owner_before,
        owner_after
    );
    initialiser!(
        PelageVulkanView,
        "PELAGE_VULKAN_VIEW_INIT",
        flags,
        frame,
        colour,
        depth,
        nearest_depth,
        coverage,
        motion,
        ids,
        occluders,
        shadow_images,
        occluder_count,
        shadow_image_count
    );
    initialiser!(
        PelageVulkanOccluder,
        "PELAGE_VULKAN_OCCLUDER_INIT",
        light,
        depth,
        clip_from_world,
        flags,
        pcf,
        bias,
        reserved
    );
    initialiser!(
        PelageVulkanShadowImage,
        "PELAGE_VULKAN_SHADOW_IMAGE_INIT",
        light,
        image
    );
    initialiser!(
        PelageVulkanPoints,
        "PELAGE_VULKAN_POINTS_INIT",
        usage,
        buffer,
        size,
        offset,
        stride,
        low,
        high,
        owner_before,
        owner_after
    );
    initialiser!(
        PelageVulkanSemaphore,
        "PELAGE_VULKAN_SEMAPHORE_INIT",
        kind,
        semaphore,
        value
    );
    initialiser!(
        PelageVulkanSubmit,
        "PELAGE_VULKAN_SUBMIT_INIT",
        view_count,
        views,
        waits,
        signals,
        wait_count,
        signal_count
    );
    initialiser!(
        PelageWindow,
        "PELAGE_WINDOW_INIT",
        kind,
        display,
        window,
        screen,
        width,
        height,
        format,
        present_mode,
        force_software,
        validation,
        reserved,
        byte_budget
    );
    initialiser!(
        PelageWindowInfo,
        "PELAGE_WINDOW_INFO_INIT",
        width,
        height,
        format,
        present_mode,
        formats,
        present_modes
    );
    text
}

/// A value as C writes it.
trait C {
    fn c(&self) -> String;
}

impl C for u32 {
    fn c(&self) -> String {
        self.to_string()
    }
}

impl C for u64 {
    fn c(&self) -> String {
        self.to_string()
    }
}

impl C for i8 {
    fn c(&self) -> String {
        self.to_string()
    }
}

impl C for u8 {
    fn c(&self) -> String {
        self.to_string()
    }
}

impl C for f32 {
    fn c(&self) -> String {
        format!("{self:?}f")
    }
}

impl C for f64 {
    fn c(&self) -> String {
        format!("{self:?}")
    }
}

impl C for PelageHighlight {
    fn c(&self) -> String {
        format!(
            "{{ {}, {}, {} }}",
            self.colour.c(),
            self.exponent.c(),
            self.shift.c()
        )
    }
}

impl C for PelageLobe {
    fn c(&self) -> String {
        format!(
            "{{ {}, {}, {}, {} }}",
            self.colour.c(),
            self.intensity.c(),
            self.shift.c(),
            self.width.c()
        )
    }
}

impl<T> C for *const T {
    fn c(&self) -> String {
        assert!(self.is_null());
        "NULL".into()
    }
}

impl<T> C for *mut T {
    fn c(&self) -> String {
        assert!(self.is_null());
        "NULL".into()
    }
}

/// A function pointer.
impl<T> C for Option<T> {
    fn c(&self) -> String {
        assert!(self.is_none());
        "NULL".into()
    }
}

impl<T: C + PartialEq, const N: usize> C for [T; N] {
    fn c(&self) -> String {
        // A string is the one long array; all of it is zero where its first element is.
        if N > 16 {
            return "{ 0 }".into();
        }
        format!(
            "{{ {} }}",
            self.iter().map(C::c).collect::<Vec<_>>().join(", ")
        )
    }
}
