// The threads that the BLAS starts when it is loaded.
#pragma once

namespace kluft {

/// To be called at the start of a program with its words. Ends the threads of the BLAS, which a run gives no work. Where there is
/// no address space for their work spaces they cannot be ended: they try for ever to take them, and whoever starts another process or
/// ends this one waits for them. The program then starts again, in the same process, with a BLAS that has none. Throws
/// ResourceError where it cannot.
void do_without_blas_threads(char** words);

} // namespace kluft
