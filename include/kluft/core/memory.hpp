// What the program holds of the system's memory.
#pragma once

#include <cstddef>

namespace kluft {

/// Gives back to the system what the program has freed and its allocator still keeps, as after a job of many small
/// pieces. Does nothing where the C library has no call for it.
void return_freed_memory();

/// From now on pieces of four megabytes and more go back as soon as they are freed, and smaller ones once sixteen megabytes lie free at the
/// end of the heap. The GNU allocator would otherwise raise those limits with the largest piece freed so far. Does nothing elsewhere.
void return_large_pieces();

/// Asks for huge pages in a large piece of memory that is not in use yet. Does nothing for a small one and where the
/// system has no call for it.
void prefer_huge_pages(void* begin, std::size_t size);

/// The contents of a piece of memory are not needed any more: whole pages of a large one go back to the system until
/// they are written again. Does nothing where the system has no call for it.
void give_back_pages(void* begin, std::size_t size);

/// To be called by an allocator of the program that has not found memory where it should be.
void note_lack_of_memory() noexcept;
/// Whether it has been called: what still works then lives on a reserve and has to end soon.
[[nodiscard]] bool memory_ran_out() noexcept;
/// Throws ResourceError if memory ran out.
void require_memory();

} // namespace kluft
