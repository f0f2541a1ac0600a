//! The C ABI, as a C host sees it.

mod frames;
mod grooms;
mod handles;
mod header;
mod hosts;
mod lost;
mod outputs;
mod pointers;
mod programs;
mod rendering;
mod spirv;
mod support;
mod threads;
mod vulkan;
mod window;
