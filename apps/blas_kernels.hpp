// The kernels of the BLAS for this processor.
#pragma once

namespace kluft {

/// To be called first. Starts the program again, in the same process, where the BLAS does not know the processor and
/// took kernels of long ago (products up to 4 times slower). Kernels that
/// compute wrongly here are left again. An OPENBLAS_CORETYPE of the user's own stays.
void choose_blas_kernels(char** words);

} // namespace kluft
