//! Handles and what they stand for.
//!
//! An id is a serial number, never given out twice, with the kind of its object in the lowest bits: each is a generation
//! of its own, so that a stale handle never meets a newer object. All objects live in their context, behind its lock; one
//! process-wide table says which context an id belongs to.
//!
//! Locks are taken in the order context, table; the table's is never held for longer than a look-up.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

use bytemuck::{Pod, Zeroable};

use crate::error::{Error, Result};
use crate::geometry::Hair;
use crate::host::Readback;
use crate::host::offscreen::{Image, Offscreen};
use crate::host::vulkan::Vulkan;
use crate::host::window::Window;
use crate::renderer::Renderer;
use crate::statistics::PassTime;

/// A device with everything made on it. All zero: no context.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct PelageContext {
    /// Opaque; 0 is NULL.
    pub id: u64,
}

/// A groom on the GPU, with how it is to be drawn. All zero: no hair.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct PelageHair {
    /// Opaque; 0 is NULL.
    pub id: u64,
}

/// An image to draw into, with an optional depth. All zero: no target.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct PelageTarget {
    /// Opaque; 0 is NULL.
    pub id: u64,
}

/// An image on its way back from the GPU. All zero: no readback.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct PelageReadback {
    /// Opaque; 0 is NULL.
    pub id: u64,
}

/// What the lowest bits of an id say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Context = 1,
    Hair = 2,
    Target = 3,
    Readback = 4,
}

const KIND_BITS: u32 = 3;

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Context => "context",
            Self::Hair => "hair",
            Self::Target => "target",
            Self::Readback => "readback",
        }
    }

    fn of(id: u64) -> Option<Self> {
        let bits = id & ((1 << KIND_BITS) - 1);
        [Self::Context, Self::Hair, Self::Target, Self::Readback]
            .into_iter()
            .find(|kind| *kind as u64 == bits)
    }
}

/// Whose device a context is on.
pub(super) enum Host {
    Offscreen(Box<Offscreen>),
    Vulkan(Box<Vulkan>),
    Window(Box<Window>),
}

impl Host {
    /// Runs `call` on the renderer, unless the device is lost.
    pub fn with_renderer<T>(&mut self, call: impl FnOnce(&mut Renderer) -> Result<T>) -> Result<T> {
        if let Self::Vulkan(vulkan) = self {
            return vulkan.with_renderer(call);
        }
        let offscreen = self.offscreen()?;
        let result = call(&mut offscreen.renderer);
        offscreen.settle(result)
    }

    /// Runs a call that uploads. On the host's device that is submitted with the next frame, on the library's own at once: it
    /// would be held for as long as none is drawn.
    pub fn upload<T>(&mut self, call: impl FnOnce(&mut Renderer) -> Result<T>) -> Result<T> {
        if let Self::Vulkan(vulkan) = self {
            return vulkan.with_renderer(call);
        }
        self.with_renderer(|renderer| {
            let value = call(renderer)?;
            renderer.queue().submit([]);
            Ok(value)
        })
    }

    /// Replaces a hair's points.
    pub fn update_points(&mut self, hair: &mut Hair, points: &[[f32; 3]]) -> Result<()> {
        if let Self::Vulkan(vulkan) = self {
            return vulkan.update(hair, |vulkan, hair| {
                vulkan.with_renderer(|renderer| renderer.update_points(hair, points))
            });
        }
        self.upload(|renderer| renderer.update_points(hair, points))
    }

    /// Moves a hair's guides.
    pub fn update_guides(&mut self, hair: &mut Hair, points: &[[f32; 3]]) -> Result<()> {
        if let Self::Vulkan(vulkan) = self {
            return vulkan.update(hair, |vulkan, hair| {
                vulkan
                    .record_ahead(|renderer, encoder| renderer.update_guides(encoder, hair, points))
            });
        }
        self.with_renderer(|renderer| {
            let mut encoder = renderer
                .device()
                .create_command_encoder(&Default::default());
            renderer.update_guides(&mut encoder, hair, points)?;
            renderer.queue().submit([encoder.finish()]);
            Ok(())
        })
    }

    pub fn adapter_info(&self) -> &wgpu::AdapterInfo {
        match self {
            Self::Offscreen(offscreen) => offscreen.adapter_info(),
            Self::Vulkan(vulkan) => vulkan.adapter_info(),
            Self::Window(window) => window.offscreen.adapter_info(),
        }
    }

    /// The library's own device, which alone has targets; an error once it is lost.
    pub fn offscreen(&mut self) -> Result<&mut Offscreen> {
        let offscreen = match self {
            Self::Offscreen(offscreen) => &mut **offscreen,
            Self::Window(window) => &mut window.offscreen,
            Self::Vulkan(_) => return Err(Error::Unsupported(
                "this context is on the host's Vulkan device, and draws into the host's images by pelage_vulkan_render"
                    .into(),
            )),
        };
        offscreen.alive()?;
        Ok(offscreen)
    }

    /// The host's device.
    pub fn vulkan(&mut self) -> Result<&mut Vulkan> {
        match self {
            Self::Vulkan(vulkan) => Ok(vulkan),
            Self::Offscreen(_) | Self::Window(_) => Err(Error::Unsupported(
                "this context has a device of its own, and draws into its targets by pelage_render"
                    .into(),
            )),
        }
    }

    /// The host's window.
    pub fn window(&mut self) -> Result<&mut Window> {
        match self {
            Self::Window(window) => Ok(window),
            Self::Offscreen(_) | Self::Vulkan(_) => Err(Error::Unsupported(
                "this context has no window; pelage_window_context_create makes one that has"
                    .into(),
            )),
        }
    }
}

/// What one context holds.
pub(super) struct State {
    pub host: Host,
    pub hairs: BTreeMap<u64, Hair>,
    pub targets: BTreeMap<u64, Image>,
    pub readbacks: BTreeMap<u64, Readback>,
    /// Of the latest timed frame.
    pub passes: Vec<PassTime>,
}

/// A context behind its lock: `None` once it has been destroyed.
type Shared = Arc<Mutex<Option<State>>>;

struct Table {
    next: u64,
    entries: BTreeMap<u64, Shared>,
}

static TABLE: Mutex<Table> = Mutex::new(Table {
    next: 1,
    entries: BTreeMap::new(),
});

fn table() -> MutexGuard<'static, Table> {
    TABLE
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Gives out an id.
fn register(kind: Kind, context: &Shared) -> u64 {
    let mut table = table();
    let id = table.next << KIND_BITS | kind as u64;
    table.next += 1;
    table.entries.insert(id, context.clone());
    id
}

/// The context that an id of `kind` belongs to.
fn find(id: u64, kind: Kind) -> Result<Shared> {
    let name = kind.name();
    let error = |what: String| Err(Error::InvalidHandle(what));
    if id == 0 {
        return error(format!("the {name}'s handle is NULL"));
    }
    let table = table();
    match (table.entries.get(&id), Kind::of(id)) {
        (Some(shared), Some(found)) if found == kind => Ok(shared.clone()),
        (_, Some(found)) if found != kind && id >> KIND_BITS < table.next => error(format!(
            "{name} handle {id:#x} is that of a {}",
            found.name()
        )),
        (None, Some(_)) if id >> KIND_BITS < table.next => error(stale(name, id)),
        _ => error(format!("{name} handle {id:#x} was never given out")),
    }
}

fn stale(name: &str, id: u64) -> String {
    format!("{name} handle {id:#x} is stale: it was destroyed, or its context was")
}

/// Runs `call` on a context's state, behind its lock.
fn enter<T>(
    shared: &Shared,
    kind: Kind,
    id: u64,
    call: impl FnOnce(&mut State) -> Result<T>,
) -> Result<T> {
    let Ok(mut locked) = shared.lock() else {
        return Err(Error::Internal(
            "an earlier call on this context met a fault; destroy the context".into(),
        ));
    };
    match &mut *locked {
        Some(state) => call(state),
        None => Err(Error::InvalidHandle(stale(kind.name(), id))),
    }
}

/// Where a context keeps one kind of object.
type Objects<T> = fn(&mut State) -> &mut BTreeMap<u64, T>;

/// Makes an object by `call` and registers it; its id.
fn add<T>(
    shared: &Shared,
    state: &mut State,
    kind: Kind,
    objects: Objects<T>,
    call: impl FnOnce(&mut State) -> Result<T>,
) -> Result<u64> {
    let object = call(state)?;
    let id = register(kind, shared);
    objects(state).insert(id, object);
    Ok(id)
}

impl PelageContext {
    /// Registers a new context.
    pub(super) fn register(host: Host) -> Self {
        let state = State {
            host,
            hairs: BTreeMap::new(),
            targets: BTreeMap::new(),
            readbacks: BTreeMap::new(),
            passes: Vec::new(),
        };
        Self {
            id: register(Kind::Context, &Arc::new(Mutex::new(Some(state)))),
        }
    }

    /// Checks the handle alone.
    pub(super) fn check(self) -> Result<()> {
        find(self.id, Kind::Context).map(|_| ())
    }

    /// Runs `call` behind the context's lock.
    pub(super) fn with<T>(self, call: impl FnOnce(&mut State) -> Result<T>) -> Result<T> {
        enter(&find(self.id, Kind::Context)?, Kind::Context, self.id, call)
    }

    /// Makes an object behind the context's lock; its id.
    pub(super) fn make<T>(
        self,
        kind: Kind,
        objects: Objects<T>,
        call: impl FnOnce(&mut State) -> Result<T>,
    ) -> Result<u64> {
        let shared = find(self.id, Kind::Context)?;
        enter(&shared, Kind::Context, self.id, |state| {
            add(&shared, state, kind, objects, call)
        })
    }

    /// Destroys the context and all that was made on it, when the calls under way on it have ended.
    pub(super) fn destroy(self) -> Result<()> {
        let shared = find(self.id, Kind::Context)?;
        // A context that met a fault can be destroyed like any other.
        let state = shared
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
            .take();
        let Some(state) = state else {
            return Err(Error::InvalidHandle(stale("context", self.id)));
        };
        table()
            .entries
            .retain(|_, owner| !Arc::ptr_eq(owner, &shared));
        drop(state);
        Ok(())
    }
}

/// An object among a context's own; an error says whether it is stale or another context's.
fn among<T>(objects: &BTreeMap<u64, T>, kind: Kind, id: u64) -> Result<&T> {
    if let Some(object) = objects.get(&id) {
        return Ok(object);
    }
    find(id, kind)?;
    Err(Error::InvalidHandle(format!(
        "{} handle {id:#x} belongs to another context",
        kind.name()
    )))
}

impl PelageHair {
    /// The hair among a context's own.
    pub(super) fn among(self, hairs: &BTreeMap<u64, Hair>) -> Result<&Hair> {
        among(hairs, Kind::Hair, self.id)
    }
}

impl PelageTarget {
    /// The target among a context's own.
    pub(super) fn among(self, targets: &BTreeMap<u64, Image>) -> Result<&Image> {
        among(targets, Kind::Target, self.id)
    }

    /// Sends an image of this target on its way, by `call`; the readback's id.
    pub(super) fn make_readback(
        self,
        call: impl FnOnce(&Image, &mut Offscreen) -> Result<Readback>,
    ) -> Result<u64> {
        let shared = find(self.id, Kind::Target)?;
        enter(&shared, Kind::Target, self.id, |state| {
            add(
                &shared,
                state,
                Kind::Readback,
                |state| &mut state.readbacks,
                |state| call(self.among(&state.targets)?, state.host.offscreen()?),
            )
        })
    }
}

/// Access to one kind of object by its handle.
macro_rules! object {
    ($handle:ident, $kind:expr, $objects:ident, $object:ty) => {
        impl $handle {
            /// Runs `call` on the object, with the rest of its context, behind the context's lock.
            pub(super) fn with<T>(
                self,
                call: impl FnOnce(&mut $object, &mut Host) -> Result<T>,
            ) -> Result<T> {
                enter(&find(self.id, $kind)?, $kind, self.id, |state| match state
                    .$objects
                    .get_mut(&self.id)
                {
                    Some(object) => call(object, &mut state.host),
                    None => Err(Error::InvalidHandle(stale($kind.name(), self.id))),
                })
            }

            /// Destroys the object.
            pub(super) fn destroy(self) -> Result<()> {
                enter(&find(self.id, $kind)?, $kind, self.id, |state| match state
                    .$objects
                    .remove(&self.id)
                {
                    Some(_) => {
                        table().entries.remove(&self.id);
                        Ok(())
                    }
                    None => Err(Error::InvalidHandle(stale($kind.name(), self.id))),
                })
            }
        }
    };
}

object!(PelageHair, Kind::Hair, hairs, Hair);
object!(PelageTarget, Kind::Target, targets, Image);
object!(PelageReadback, Kind::Readback, readbacks, Readback);

#[cfg(test)]
mod tests {
    use super::super::*;

    /// A panic in a call kills its context alone, which can still be destroyed.
    #[test]
    fn a_context_that_panicked_refuses_calls_and_can_be_destroyed() {
        let options = crate::host::offscreen::OffscreenOptions {
            force_software: true,
            validation: false,
        };
        let offscreen = crate::host::offscreen::Offscreen::new(&options).unwrap();
        let context = PelageContext::register(registry::Host::Offscreen(Box::new(offscreen)));
        assert_eq!(
            error::guard(|| context.with(|_| -> crate::Result<()> { panic!("a fault") })),
            PELAGE_PANIC
        );
        assert_eq!(pelage_wait(context), PELAGE_INTERNAL);
        assert_eq!(pelage_context_destroy(context), PELAGE_OK);
        assert_eq!(pelage_context_destroy(context), PELAGE_INVALID_HANDLE);
    }
}
