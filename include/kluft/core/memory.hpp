// What the program holds of the system's memory.
#pragma once

namespace kluft {

/// Gives back to the system what the program has freed and its allocator still keeps, as after a job of many small
/// pieces. Does nothing where the C library has no call for it.
void return_freed_memory();

} // namespace kluft
