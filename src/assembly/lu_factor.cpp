#include "kluft/assembly/lu_factor.hpp"

#include <cmath>
#include <numeric>

#include <umfpack.h>

#include "kluft/core/diagnostics.hpp"

namespace kluft {

struct LuFactor::Umfpack {
    Umfpack() {
        umfpack_dl_defaults(control);
        control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
        control[UMFPACK_PRL] = 0;
        control[UMFPACK_IRSTEP] = 0; // Newton corrects
    }
    ~Umfpack() { forget(); }
    Umfpack(const Umfpack&) = delete;
    Umfpack& operator=(const Umfpack&) = delete;

    void forget() {
        if (numeric != nullptr) umfpack_dl_free_numeric(&numeric);
        if (symbolic != nullptr) umfpack_dl_free_symbolic(&symbolic);
        numeric = nullptr;
        symbolic = nullptr;
        columns = BlockColumns();
    }

    const BlockPattern* pattern = nullptr;
    const std::vector<int>* position = nullptr;
    BlockColumns columns;
    double control[UMFPACK_CONTROL]{};
    double info[UMFPACK_INFO]{};
    void* symbolic = nullptr;
    void* numeric = nullptr;
};

LuFactor::LuFactor() : umfpack_(std::make_unique<Umfpack>()) {}
LuFactor::~LuFactor() = default;

void LuFactor::analyze(const BlockPattern& pattern, const std::vector<int>& position) {
    forget();
    umfpack_->pattern = &pattern;
    umfpack_->position = &position;
}

void LuFactor::forget() { umfpack_->forget(); }

void LuFactor::gather(const BlockMatrix& matrix) {
    Umfpack& u = *umfpack_;
    if (u.symbolic == nullptr) u.columns = BlockColumns(*u.pattern, *u.position, BlockColumns::Part::all);
    u.columns.gather(matrix);
}

bool LuFactor::factorize() {
    Umfpack& u = *umfpack_;
    const auto n = u.columns.size();
    const auto* starts = u.columns.starts().data();
    const auto* rows = u.columns.rows().data();
    const double* values = u.columns.values().data();
    if (u.symbolic == nullptr) {
        std::vector<std::int64_t> identity(n);
        std::iota(identity.begin(), identity.end(), 0);
        const auto status =
            umfpack_dl_qsymbolic(n, n, starts, rows, values, identity.data(), &u.symbolic, u.control, u.info);
        if (status == UMFPACK_ERROR_out_of_memory) throw ResourceError("out of memory in the analysis");
        if (status != UMFPACK_OK) return false;
    }
    if (u.numeric != nullptr) umfpack_dl_free_numeric(&u.numeric);
    const auto status = umfpack_dl_numeric(starts, rows, values, u.symbolic, &u.numeric, u.control, u.info);
    if (status == UMFPACK_ERROR_out_of_memory) throw ResourceError("out of memory in the factorization");
    return status == UMFPACK_OK && std::isfinite(u.info[UMFPACK_RCOND]);
}

bool LuFactor::has_negative_determinant() const {
    double mantissa = 0.0;
    double exponent = 0.0;
    Umfpack& u = *umfpack_;
    const auto status = umfpack_dl_get_determinant(&mantissa, &exponent, u.numeric, u.info);
    return status == UMFPACK_OK && mantissa < 0.0;
}

void LuFactor::solve(std::vector<double>& b, std::vector<double>& x) {
    Umfpack& u = *umfpack_;
    x.resize(b.size());
    umfpack_dl_solve(UMFPACK_A, u.columns.starts().data(), u.columns.rows().data(), u.columns.values().data(), x.data(),
                     b.data(), u.numeric, u.control, u.info);
}

} // namespace kluft
