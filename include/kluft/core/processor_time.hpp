// Processor time of this program.
#pragma once

namespace kluft {

/// Processor time that this program has taken so far in all its threads, that of the system for it included (s).
[[nodiscard]] double processor_seconds();

} // namespace kluft
