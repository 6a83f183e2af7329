#include <dlfcn.h>

#include <cholmod.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kluft/assembly/blas.hpp"

namespace kluft {
namespace {

// CHOLMOD calls whichever dgemm_ and dpotrf_ the dynamic linker finds first; the reference BLAS is 2-5 times slower.
TEST(Blas, ThatTheFactorizationCallsIsOpenBlas) {
    int version[3] = {};
    ASSERT_GE(cholmod_l_version(version), 3000);
    for (const char* const name : {"dgemm_", "dsyrk_", "dtrsm_", "dpotrf_"}) {
        void* const symbol = dlsym(RTLD_DEFAULT, name);
        ASSERT_NE(symbol, nullptr) << name;
        Dl_info found{};
        ASSERT_NE(dladdr(symbol, &found), 0) << name;
        EXPECT_THAT(found.dli_fname, testing::HasSubstr("openblas")) << name;
    }
}

// Kernels for another processor than this one may compute nonsense; the loops that they are held against are the test's oracle.
TEST(Blas, ComputesAsPlainLoopsDo) { EXPECT_TRUE(blas_computes_rightly()); }

TEST(Blas, WiderKernelsAreOthersThanThoseInUse) {
    EXPECT_FALSE(blas_core().empty());
    EXPECT_NE(wider_blas_core(), blas_core());
}

} // namespace
} // namespace kluft
