#include "kluft/output/field_reader.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "kluft/core/diagnostics.hpp"
#include "kluft/output/atomic_file.hpp"
#include "kluft/output/field_series.hpp"
#include "output/hexagon_grid.hpp"
#include "output/temporary_directory.hpp"

namespace kluft {
namespace {

using testing::TemporaryDirectory;

FieldRecord fields_to_keep(const BlockSystem& system) {
    Mat2 gradient, stress;
    gradient << 1e-3, 2e-3, -3e-3, 4e-3;
    stress << -2e6, 3e5, 3e5, 1e5;
    FieldRecord fields = testing::affine_fields(system, gradient, stress);
    fields.stress_zz.assign(system.blocks.size(), -4e5);
    fields.interfaces[0] = {false, true, CrackMode::shear,  ContactState::sliding, -3e5, 1e5,
                            -1e-6, 3e-4, Vec2(3e-4, -1e-6), Vec2(2.0, -3.0)};
    return fields;
}

void keep(const TemporaryDirectory& directory, const BlockSystem& system) {
    FieldSeries::create(directory.path(), {}).add(system, fields_to_keep(system), StepRecord{});
}

TEST(FieldReader, ReadsBackWhatWasWritten) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(3, 2, 0.1, {1e5, 2e6});
    keep(directory, system);
    EXPECT_EQ(kept_steps(directory.path()), std::vector<int>{0});
    const FieldRecord written = fields_to_keep(system);
    const FieldRecord read = read_fields(directory.path(), 0, system);
    EXPECT_EQ(read.displacement, written.displacement);
    EXPECT_EQ(read.stress, written.stress);
    EXPECT_EQ(read.stress_zz, written.stress_zz);
    ASSERT_EQ(read.interfaces.size(), written.interfaces.size());
    const auto& interface = read.interfaces[0];
    EXPECT_TRUE(!interface.bonded && interface.broken);
    EXPECT_EQ(interface.mode, CrackMode::shear);
    EXPECT_EQ(interface.state, ContactState::sliding);
    EXPECT_EQ(interface.normal_traction, -3e5);
    EXPECT_EQ(interface.shear_traction, 1e5);
    EXPECT_EQ(interface.gap, -1e-6);
    EXPECT_EQ(interface.slip, 3e-4);
    EXPECT_EQ(interface.relative, Vec2(3e-4, -1e-6));
    EXPECT_EQ(interface.force, Vec2(2.0, -3.0));
    EXPECT_TRUE(read.interfaces[1].bonded);
}

TEST(FieldReader, RefusesFilesOfAnotherBody) {
    const TemporaryDirectory directory;
    keep(directory, testing::hexagon_grid(3, 2, 0.1));
    EXPECT_THROW((void)read_fields(directory.path(), 0, testing::hexagon_grid(3, 3, 0.1)), InputError);
    EXPECT_THROW((void)read_fields(directory.path(), 1, testing::hexagon_grid(3, 2, 0.1)), InputError);
}

// Each byte of a file in turn is another one, and each file ends early: it is read or refused, and nothing else happens.
TEST(FieldReader, ReadsOrRefusesDamagedFiles) {
    const TemporaryDirectory directory;
    const BlockSystem system = testing::hexagon_grid(2, 1, 0.1);
    keep(directory, system);
    int n_refused = 0;
    for (const char* name : {"fields/blocks_000000.vtu", "fields/interfaces_000000.vtu"}) {
        const std::string whole = read_file(directory / name);
        const auto is_refused = [&](const std::string& content) {
            std::ofstream(directory / name, std::ios::binary) << content;
            try {
                (void)read_fields(directory.path(), 0, system);
                return false;
            } catch (const InputError&) {
                return true;
            }
        };
        for (std::size_t i = 0; i < whole.size(); i += 3) {
            std::string damaged = whole;
            damaged[i] = static_cast<char>(damaged[i] ^ (i % 2 == 0 ? '\xff' : '\x01'));
            n_refused += is_refused(damaged);
            if (i % 24 == 0) n_refused += is_refused(whole.substr(0, i));
        }
        std::ofstream(directory / name, std::ios::binary) << whole;
    }
    EXPECT_GT(n_refused, 100);
    EXPECT_NO_THROW((void)read_fields(directory.path(), 0, system));
}

} // namespace
} // namespace kluft
